//! A contact that lasts: how fast the masses meet once the motion has settled.

use std::f64::consts::TAU;

use super::entry::{Entries, Verdict};
use super::ours;
use super::rivals::{Kind, penalty, sprung};
use super::scene_b::spring;
use super::task::{Fault, Task, Told};
use crate::Error;
use crate::compare::precision::{Family, Scene};
use crate::model::{Compliance, Excitation, Rig, Sine, orbits, softened};

/// Cycles until the motion is read: the slowest multiplier of the rigid orbit, 0.970, is then below 1e-16.
const CYCLES: f64 = 1250.0;
/// Impacts whose mean speed is read.
const READ: usize = 16;

/// Mean approach speed of the last impacts.
fn speed(told: &Told) -> Option<f64> {
    let n = told.impacts.len();
    (n > READ).then(|| told.impacts[n - READ..].iter().map(|i| i.1).sum::<f64>() / READ as f64)
}

/// Measures every method with a contact of `stiffness` (N/m) that rebounds with the rig's restitution.
///
/// # Errors
/// If the truth cannot be integrated, or the exact modes do not agree with it.
pub fn scene(stiffness: f64, quick: bool) -> crate::Result<Scene> {
    let rig = Rig::thesis();
    let frequency = 2.1 * (rig.k1 / rig.m1).sqrt() / TAU;
    let task = Task::sine(rig, 0.5, frequency, CYCLES / frequency);
    let contact = spring(&rig, stiffness);
    let excitation = Excitation::Sine(Sine { force: 0.5, frequency });
    let share = Compliance::new(&rig, stiffness, None)?.duration * frequency;
    let lost = |fault: Fault| Error::refused(format!("the truth of the soft contact: {fault}"));
    let integrated = sprung(&task, &contact, Kind::Dop853(1e-13)).map_err(lost)?;
    let truth = speed(&integrated).ok_or_else(|| Error::refused("the soft contact is not met"))?;
    let exact = ours::kelvin_voigt(&task, &contact).map_err(lost)?;
    let apart = speed(&exact).map_or(f64::INFINITY, |v| (v / truth - 1.0).abs());
    if apart > 1e-9 {
        return Err(Error::refused(format!(
            "exact modes and integration differ by {apart:.1e} with a contact of {stiffness:.0e} N/m"
        )));
    }
    let off = |speed: f64| -> Verdict {
        let error = (speed / truth - 1.0).abs();
        if error < 100.0 {
            Ok(error.max(1e-16))
        } else {
            Err("the steps are too long: it grows beyond all bounds".to_owned())
        }
    };
    let judge = |told: &Told| speed(told).map_or_else(|| Err("no impacts".to_owned()), off);
    let judge_speed = |speed: &f64| off(*speed);
    let mut entries = Entries::new(quick);
    let few = |all: &[f64]| if quick { all[..1].to_vec() } else { all.to_vec() };
    let missing = || Fault::Refused("no orbit with one impact a cycle".to_owned());
    entries.ours(
        "closed form",
        "",
        || Ok(orbits(&rig, 0.5, frequency)?.orbits.first().ok_or_else(missing)?.approach_velocity),
        judge_speed,
    );
    entries.ours(
        "soft-corrected closed form",
        "",
        || {
            let found = orbits(&rig, 0.5, frequency)?;
            let compliance = Compliance::new(&rig, stiffness, None)?;
            let soft = softened(&rig, &excitation, &found, &compliance)?;
            Ok(soft.first().copied().flatten().ok_or_else(missing)?.approach_velocity)
        },
        judge_speed,
    );
    entries.ours("exact flights, rigid", "", || ours::flights(&task), judge);
    entries.ours("exact Kelvin–Voigt", "", || ours::kelvin_voigt(&task, &contact), judge);
    for r in few(&[1e-3, 1e-6, 1e-9]) {
        let kind = Kind::Rk45(r);
        entries.rival("RK45 straight through", &kind.setting(), || penalty(&task, &contact, kind), judge);
    }
    for n in few(&[1e3, 1e4]) {
        let kind = Kind::Rk4(n);
        entries.rival("RK4 straight through", &kind.setting(), || penalty(&task, &contact, kind), judge);
    }
    for r in few(&[1e-3, 1e-6, 1e-9, 1e-12]) {
        let kind = Kind::Rk45(r);
        entries.rival("RK45, touch to parting", &kind.setting(), || sprung(&task, &contact, kind), judge);
    }
    for r in few(&[1e-6, 1e-9, 1e-12]) {
        let kind = Kind::Dop853(r);
        entries.rival("DOP853, touch to parting", &kind.setting(), || sprung(&task, &contact, kind), judge);
    }
    Ok(Scene {
        name: format!("soft contact {stiffness:.0e} N m⁻¹"),
        family: Family::Models,
        says: format!(
            "Spring and damper in the contact, {:.2} % of the period in contact: the approach speed once the motion has settled \
             ({CYCLES} cycles).",
            100.0 * share
        ),
        error_of: "relative error of the settled approach speed".to_owned(),
        truth: format!(
            "order 8 from touch to parting, tolerance 1e-13; exact modes differ from it by {apart:.0e}"
        ),
        bound: None,
        methods: entries.done(),
    })
}

//! A contact that lasts: how fast the masses meet once the motion has settled.

use std::f64::consts::TAU;

use super::entry::{Entries, Verdict};
use super::ours;
#[cfg(feature = "diffsol")]
use super::rivals::{Diffsol, contacts};
use super::rivals::{Kind, penalty, sprung};
use super::scene_b::spring;
use super::task::{Fault, Task, Told};
use super::truth::settled;
use crate::{Family, Scene};
use vibro_model::{Compliance, Excitation, Rig, Sine, orbits, softened};
use vibro_record::Error;

/// Cycles until the motion is read: the slowest multiplier of the rigid orbit, 0.970, is then below 1e-16; with a contact of 7 % of the
/// period it is −0.9945, and what is left turns round from impact to impact: the mean of sixteen keeps 2.6e-3 of it, 2e-10 of the start.
const CYCLES: [f64; 2] = [1250.0, 3000.0];
/// Part of the period in contact from which it takes the longer.
const LASTING: f64 = 0.02;
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
/// If the motion does not settle.
pub fn scene(stiffness: f64, quick: bool) -> vibro_record::Result<Scene> {
    let rig = Rig::thesis();
    let frequency = 2.1 * (rig.k1 / rig.m1).sqrt() / TAU;
    let share = Compliance::new(&rig, stiffness, None)?.duration * frequency;
    let cycles = CYCLES[usize::from(share > LASTING)];
    let task = Task { most: 100_000_000, ..Task::sine(rig, 0.5, frequency, cycles / frequency) };
    let contact = spring(&rig, stiffness);
    let excitation = Excitation::Sine(Sine { force: 0.5, frequency });
    let lost =
        |why: &str| Error::refused(format!("the truth of the soft contact of {stiffness:.0e} N/m: {why}"));
    let truth = settled(&task, Some(&contact), 2000.0)
        .map_err(|why| lost(&why))?
        .ok_or_else(|| lost("the motion does not settle"))?
        .speed();
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
    #[cfg(feature = "diffsol")]
    for r in few(&[1e-4, 1e-6, 1e-9, 1e-12]) {
        for (name, how) in
            [("diffsol TSIT45, sign test", Diffsol::Tsit45(r)), ("diffsol BDF, sign test", Diffsol::Bdf(r))]
        {
            entries.rival(name, &how.setting(), || contacts(&task, how, &contact), judge);
        }
    }
    Ok(Scene {
        name: format!("soft contact {stiffness:.0e} N m⁻¹"),
        family: Family::Models,
        says: format!(
            "Spring and damper in the contact, {:.2} % of the period in contact: the approach speed once the motion has settled \
             ({cycles} cycles).",
            100.0 * share
        ),
        error_of: "relative error of the settled approach speed".to_owned(),
        truth: "the motion that repeats, by Newton's method on matrix exponentials, to 1e-12".to_owned(),
        bound: None,
        methods: entries.done(),
    })
}

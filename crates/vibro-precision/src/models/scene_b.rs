//! Scene B: impacts from rest that are crossed at speed.

use std::f64::consts::TAU;

use super::entry::{Entries, Verdict};
use super::ours;
#[cfg(feature = "diffsol")]
use super::rivals::{Diffsol, impacts};
use super::rivals::{Events, Kind, Loop, Spring, events, marched, moreau, penalty};
use super::task::{Task, Told};
use super::truth;
use crate::{Family, Scene};
use vibro_model::Rig;
use vibro_model::contact::conversion::damping_ratio;
use vibro_record::Error;

/// Number, time in s and approach speed in m/s of impacts, by arithmetic with 40 digits (Newton on the equations of motion).
pub(crate) const GOLDEN: [(usize, f64, f64); 5] = [
    (1, 0.030_744_282_246_676_34, 0.078_330_829_224_466_23),
    (2, 0.144_162_776_471_947_4, 0.147_727_906_853_932_83),
    (3, 0.237_270_475_783_159_57, 0.233_773_950_612_516_77),
    (22, 1.970_065_574_977_416, 0.283_306_967_791_457_3),
    (1098, 99.932_500_537_538_15, 0.287_669_247_580_228_4),
];

/// The motion from rest.
pub(crate) fn task(until: f64) -> Task {
    let rig = Rig::thesis();
    Task::sine(rig, 0.5, 2.1 * (rig.k1 / rig.m1).sqrt() / TAU, until)
}

/// How far the truth of all impacts may be off, in s: ten times what its own test finds up to 2 s, behind which errors die away.
const FOLLOWED: f64 = 1e-11;

/// Largest error in s of the times of the golden impacts up to `until`, and of all others beyond what `truth` may be off.
fn judge(told: &Told, truth: &Told, until: f64) -> Verdict {
    let golden: Vec<_> = GOLDEN.iter().filter(|g| g.1 < until).collect();
    // Up to half a cycle behind the last golden one.
    let last = golden.last().map_or(until, |g| g.1 + 0.5 / 10.98);
    let upto = |told: &Told| told.impacts.iter().filter(|i| i.0 < last).count();
    let (count, expected) = (upto(told), golden.last().map_or(0, |g| g.0));
    if count != expected || upto(truth) != expected {
        return Err(format!("{count} impacts up to {last:.2} s instead of {expected}: not the same motion"));
    }
    let golden = golden.iter().map(|g| (told.impacts[g.0 - 1].0 - g.1).abs());
    let all = (0..count).map(|i| (told.impacts[i].0 - truth.impacts[i].0).abs() - FOLLOWED);
    // No time is known better than to its rounding.
    Ok(golden.chain(all).fold(f64::EPSILON * until / 2.0, f64::max))
}

/// A spring that rebounds as the rig does; at R = 0, which no damper gives, with the critical one, as is usual: it rebounds with e⁻².
pub fn spring(rig: &Rig, stiffness: f64) -> Spring {
    let mass = rig.reduced_mass();
    let ratio = damping_ratio(rig.restitution).unwrap_or(1.0);
    Spring { stiffness, damping: 2.0 * ratio * (stiffness * mass).sqrt() }
}

/// Measures every method over `seconds`.
///
/// # Errors
/// If the truth cannot be followed.
pub fn scene(seconds: f64, quick: bool) -> vibro_record::Result<Scene> {
    let task = task(seconds);
    let truth = truth::motion(&task, None)
        .map_err(|why| Error::refused(format!("the truth of scene B over {seconds} s: {why}")))?;
    let judge = |told: &Told| judge(told, &truth, seconds);
    let mut entries = Entries::new(quick);
    entries.ours("exact flights", "", || ours::flights(&task), judge);
    let few = |all: &[f64]| if quick { all[..2].to_vec() } else { all.to_vec() };
    for n in few(&[100.0, 1e3, 1e4]) {
        entries.rival("Euler loop", &steps(n), || marched(&task, Loop::Euler, n), judge);
    }
    for n in few(&[100.0, 1e3, 1e4]) {
        entries.rival("RK4 loop", &steps(n), || marched(&task, Loop::Rk4, n), judge);
    }
    for n in few(&[100.0, 1e3, 1e4]) {
        entries.rival("Moreau time stepping", &steps(n), || moreau(&task, n), judge);
    }
    for n in few(&[30.0, 100.0, 300.0, 1e3]) {
        let how = Events::ends(Kind::Rk4(n));
        entries.rival("RK4, sign test", &how.kind.setting(), || events(&task, &how), judge);
    }
    for r in few(&[1e-3, 1e-6, 1e-9, 1e-12]) {
        let how = Events::ends(Kind::Rk45(r));
        entries.rival("RK45, sign test", &how.kind.setting(), || events(&task, &how), judge);
    }
    for r in few(&[1e-3, 1e-6, 1e-9, 1e-12]) {
        let how = Events::dense(Kind::Rk45(r));
        entries.rival("RK45, dense events", &how.kind.setting(), || events(&task, &how), judge);
    }
    for r in few(&[1e-6, 1e-9, 1e-12, 1e-14]) {
        let how = Events::dense(Kind::Dop853(r));
        entries.rival("DOP853, dense events", &how.kind.setting(), || events(&task, &how), judge);
    }
    #[cfg(feature = "diffsol")]
    for how in few(&[1e-4, 1e-6, 1e-9, 1e-12]).into_iter().map(Diffsol::Tsit45) {
        entries.rival("diffsol TSIT45, sign test", &how.setting(), || impacts(&task, how, None), judge);
    }
    for k in few(&[1e5, 1e6, 1e8]) {
        let spring = spring(&task.rig, k);
        let setting = format!("k₃ {k:.0e} N/m");
        entries.rival("stiff spring, RK45", &setting, || penalty(&task, &spring, Kind::Rk45(1e-8)), judge);
    }
    Ok(Scene {
        name: format!("scene B, {seconds} s"),
        family: Family::Models,
        says: format!(
            "From rest under 0.5 N at ν 2.1, every impact crossed at speed: the times of the impacts up to {seconds} s."
        ),
        error_of: "largest error of an impact time (s)".to_owned(),
        truth: format!(
            "impacts 1, 2, 3, 22 and 1098: Newton's method on the equations of motion with 40 digits; all others: matrix exponentials in \
             short steps, beyond {FOLLOWED:.0e} s; smaller errors than {:.0e} s, the rounding of the time, are told as that",
            f64::EPSILON * seconds / 2.0
        ),
        bound: None,
        methods: entries.done(),
    })
}

/// Steps a cycle in words.
pub fn steps(n: f64) -> String {
    format!("{n} steps a cycle")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::models::ours;

    #[test]
    fn every_impact_counts_and_the_truth_is_that_of_40_digits() {
        for until in [2.0, 100.0] {
            let task = task(until);
            let truth = truth::motion(&task, None).unwrap();
            for (number, time, _) in GOLDEN.into_iter().filter(|g| g.1 < until) {
                assert!((truth.impacts[number - 1].0 - time).abs() < FOLLOWED, "{number}");
            }
            let told = ours::flights(&task).unwrap();
            assert!(judge(&told, &truth, until).unwrap() < 1e-13);
            // One that no golden number tells.
            let mut late = told.clone();
            late.impacts[10].0 += 1e-6;
            assert!((judge(&late, &truth, until).unwrap() - 1e-6).abs() < 2.0 * FOLLOWED);
        }
    }
}

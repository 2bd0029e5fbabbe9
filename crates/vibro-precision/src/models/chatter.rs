//! Scene C: impacts that accumulate, rest, and release.

use std::f64::consts::TAU;

use super::entry::{Entries, Verdict};
use super::ours;
#[cfg(feature = "diffsol")]
use super::rivals::{Diffsol, impacts};
use super::rivals::{Events, Kind, Loop, events, marched, moreau};
use super::scene_b::steps;
use super::task::{Task, Told};
use crate::{Family, Scene};
use vibro_model::{Rig, State};

/// End of the first chatter, release, and end of the second chatter in s, by arithmetic with 40 digits.
pub(crate) const GOLDEN: [f64; 3] =
    [0.152_721_089_353_360_45, 0.220_247_418_265_660_51, 0.574_521_373_816_090_7];

/// The pre-loaded rig from x₁ = −2 mm.
pub(crate) fn task() -> Task {
    let rig = Rig { gap: -5e-4, ..Rig::thesis() };
    let frequency = 0.45 * (rig.k1 / rig.m1).sqrt() / TAU;
    Task { start: State { x1: -2e-3, ..State::REST }, most: 500_000, ..Task::sine(rig, 0.35, frequency, 0.6) }
}

/// Largest error in s of the three golden times.
pub fn judge(told: &Told) -> Verdict {
    let (Some(first), Some(second)) = (told.sticks.first(), told.sticks.get(1)) else {
        return Err(format!(
            "{} impacts, and {} times at rest against each other instead of 2",
            told.impacts.len(),
            told.sticks.len()
        ));
    };
    let found = [first[0], first[1], second[0]];
    Ok(found.iter().zip(&GOLDEN).map(|(f, g)| (f - g).abs()).fold(1e-17, f64::max))
}

/// Measures every method.
pub fn scene(quick: bool) -> Scene {
    let task = task();
    let mut entries = Entries::new(quick);
    let few = |all: &[f64]| if quick { all[..2].to_vec() } else { all.to_vec() };
    entries.ours("exact flights", "", || ours::flights(&task), judge);
    for n in few(&[1e3, 1e4, 1e5]) {
        entries.rival("Euler loop", &steps(n), || marched(&task, Loop::Euler, n), judge);
    }
    for n in few(&[1e3, 1e4, 1e5]) {
        entries.rival("RK4 loop", &steps(n), || marched(&task, Loop::Rk4, n), judge);
    }
    for n in few(&[1e3, 1e4, 1e5]) {
        entries.rival("Moreau time stepping", &steps(n), || moreau(&task, n), judge);
    }
    let plain = Events::ends(Kind::Rk45(1e-6));
    entries.rival("RK45, no rule for rest", &plain.kind.setting(), || events(&task, &plain), judge);
    // At rest below the speed at which a bounce is as high as the integrator's error, 1 mm times its tolerance.
    let rule = |relative: f64| (0.02 * relative).sqrt();
    for n in few(&[100.0, 1e3]) {
        let how = Events::ends(Kind::Rk4(n)).sticking(rule(Kind::Rk4(n).relative()).max(1e-7));
        entries.rival("RK4, sign test", &how.kind.setting(), || events(&task, &how), judge);
    }
    for r in few(&[1e-3, 1e-6, 1e-9, 1e-12]) {
        let how = Events::ends(Kind::Rk45(r)).sticking(rule(r));
        entries.rival("RK45, sign test", &how.kind.setting(), || events(&task, &how), judge);
    }
    for r in few(&[1e-3, 1e-6, 1e-9, 1e-12]) {
        let how = Events::dense(Kind::Rk45(r)).sticking(rule(r));
        entries.rival("RK45, dense events", &how.kind.setting(), || events(&task, &how), judge);
    }
    for r in few(&[1e-6, 1e-9, 1e-12, 1e-14]) {
        let how = Events::dense(Kind::Dop853(r)).sticking(rule(r));
        entries.rival("DOP853, dense events", &how.kind.setting(), || events(&task, &how), judge);
    }
    #[cfg(feature = "diffsol")]
    for how in few(&[1e-4, 1e-6, 1e-9, 1e-12]).into_iter().map(Diffsol::Tsit45) {
        let rests = Some(rule(how.relative()));
        entries.rival("diffsol TSIT45, sign test", &how.setting(), || impacts(&task, how, rests), judge);
    }
    Scene {
        name: "scene C".to_owned(),
        family: Family::Models,
        says: "Pressed together by their springs, the masses chatter to rest, are released and chatter again: the times of both ends \
               and of the release. Methods with events let the masses rest below the speed that their tolerance resolves."
            .to_owned(),
        error_of: "largest error of the three times (s)".to_owned(),
        truth: "arithmetic with 40 digits".to_owned(),
        bound: None,
        methods: entries.done(),
    }
}

//! The backbone: how frequency and amplitude of the free vibro-impact motion belong together.

use super::Orbit;
use super::conditions::{Conditions, Root};
use super::course::Course;
use super::drive::Drive;
use super::stretch::Stretch;
use crate::Rig;
use num_complex::Complex64;
use vibro_record::{Error, Result};

/// The motion with one impact a cycle at `frequency` (Hz) that the rig would keep up without force, dampers and losses in the impact;
/// `None` where there is none.
///
/// Without losses P = 0, any size goes with the impact law, and the masses meet where Δ + JC = 0 (Babitsky, *Theory of Vibro-Impact
/// Systems* (1998)). Resonances of the driven rig lie along this curve.
///
/// # Errors
/// If a parameter is impossible, or the frequency is a whole part of a natural frequency.
pub fn backbone(rig: &Rig, frequency: f64) -> Result<Option<Orbit>> {
    rig.check()?;
    if !(frequency.is_finite() && frequency > 0.0) {
        return Err(Error::usage(format!("frequency is {frequency} Hz"), "a finite value above 0"));
    }
    let lossless = Rig { c1: 0.0, c2: 0.0, restitution: 1.0, ..*rig };
    let conditions = Conditions::new(&lossless, frequency, 1)?;
    let impulse = -rig.gap / conditions.c;
    if !(impulse.is_finite() && impulse > 0.0) {
        return Ok(None);
    }
    let [first, second] = &conditions.greens;
    let root = Root {
        impulse,
        timing: 0.0,
        force_phase: 0.0,
        sensitivity: 1.0 / conditions.c.abs(),
        size: rig.gap.abs(),
        upper: false,
    };
    let stretch = Stretch {
        oscillators: lossless.oscillators(),
        free: [
            (-impulse * first.start, -impulse * first.slope_after),
            (impulse * second.start, impulse * second.slope_after),
        ],
        forced: Complex64::ZERO,
        omega: 0.0,
        rest: 0.0,
        gap: rig.gap,
    };
    let course = Course::Smooth { stretch, period: conditions.period() };
    Ok(Some(conditions.orbit(&root, &course, Drive::None)))
}

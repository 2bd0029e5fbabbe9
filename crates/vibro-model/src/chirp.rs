//! Frequency sweep at a constant rate, in steps of constant frequency that are short enough to be
//! negligible.

use super::motion::{Motion, Piece};
use super::scales;
use std::f64::consts::PI;
use vibro_record::{Error, Result};

/// A sweep at a constant rate.
///
/// The frequency changes in steps of duration h, each at the frequency of its middle. The phase is exact at
/// both ends of a step and deviates by at most π|rate|h²/4 within it; a sine force deviates by that fraction
/// of its amplitude.
///
/// ```
/// use vibro_model::{Chirp, Motion, Rig, Simulation, Sine};
/// let mut motion = Simulation::new(&Rig::thesis(), &Sine { force: 0.1, frequency: 3.0 })?;
/// Chirp::new(0.02).advance(&mut motion, 50.0, &mut |_| {})?;
/// assert!((motion.frequency() - 4.0).abs() < 1e-12);
/// # Ok::<(), vibro_record::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Chirp {
    /// Rate in Hz/s, negative for a sweep down.
    pub rate: f64,
    /// Largest deviation of the phase within a step, in rad; it sets the length of the steps.
    pub deviation: f64,
}

impl Chirp {
    /// Sweep with `rate` in Hz/s, whose phase is exact to 1e-4 rad within the steps.
    pub fn new(rate: f64) -> Chirp {
        Chirp { rate, deviation: 1e-4 }
    }

    /// The longest step in s within the deviation; infinite for a rate of 0.
    pub fn step(&self) -> f64 {
        (4.0 * self.deviation / (PI * self.rate.abs())).sqrt()
    }

    /// Sweeps a motion from its present frequency to the time `until` (s); calls `visit` with each piece, the
    /// last of each step with [`super::Event::Reached`].
    ///
    /// # Errors
    /// If rate or deviation is impossible, more than 1e8 steps are needed, the frequency does not stay above
    /// 0, or as [`Motion::advance`].
    pub fn advance(
        &self,
        motion: &mut dyn Motion,
        until: f64,
        visit: &mut dyn FnMut(Piece<'_>),
    ) -> Result<()> {
        if !(self.rate.is_finite() && self.deviation > 0.0 && self.deviation.is_finite()) {
            return Err(Error::usage(
                format!("a sweep of {} Hz/s with a deviation of {} rad", self.rate, self.deviation),
                "a finite rate, and a finite deviation above 0",
            ));
        }
        let (start, first) = (motion.time(), motion.frequency());
        scales::check_time(start, until)?;
        let count = ((until - start) / self.step()).ceil().max(1.0);
        scales::check_work(count)?;
        let h = (until - start) / count;
        for i in 0..count as u64 {
            motion.set_frequency(first + self.rate * h * (i as f64 + 0.5))?;
            let end = if i + 1 == count as u64 { until } else { start + h * (i + 1) as f64 };
            motion.advance(end, visit)?;
        }
        motion.set_frequency(first + self.rate * (until - start))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::excitation::Sine;
    use crate::flow::State;
    use crate::rig::Rig;
    use crate::simulate::Simulation;
    use std::f64::consts::TAU;

    fn far() -> Simulation {
        // The gap is never closed: the motion stays linear.
        let rig = Rig { gap: 1.0, ..Rig::thesis() };
        Simulation::new(&rig, &Sine { force: 0.1, frequency: 3.0 }).unwrap()
    }

    #[test]
    fn the_phase_is_that_of_a_linear_sweep() {
        for rate in [0.02, -0.05, 0.7] {
            let mut motion = far();
            Chirp::new(rate).advance(&mut motion, 20.0, &mut |_| {}).unwrap();
            let turns: f64 = 3.0 * 20.0 + rate * 200.0;
            let error = (motion.phase() - TAU * turns.fract()).abs();
            // Each step rounds a phase below 2π, and its change of up to 5 rad.
            let steps = (20.0 / Chirp::new(rate).step()).ceil();
            assert!(error.min(TAU - error) < steps * 16.0 * f64::EPSILON + 400.0 * f64::EPSILON, "{error:e}");
            assert!((motion.frequency() - (3.0 + 20.0 * rate)).abs() < 1e-14 * 20.0);
        }
    }

    #[test]
    fn finer_steps_change_no_more_than_their_bound() {
        let state = |deviation: f64| {
            let mut motion = far();
            Chirp { rate: 0.1, deviation }.advance(&mut motion, 40.0, &mut |_| {}).unwrap();
            motion.state()
        };
        let (coarse, fine) = (state(1e-3), state(1e-7));
        // A constant force error of F₀·1e-3 moves mass 1 at most as much as at resonance: F₀·1e-3/(c₁Ω₁).
        let rig = Rig::thesis();
        let bound = 0.1 * 1e-3 / (rig.c1 * (rig.k1 / rig.m1).sqrt());
        assert!((coarse.x1 - fine.x1).abs() < bound, "{coarse:?} {fine:?}");
        assert!(coarse != fine && coarse.x2 == State::REST.x2);
    }

    #[test]
    fn impossible_sweeps_are_refused() {
        let mut motion = far();
        for (rate, deviation, until) in [
            (f64::NAN, 1e-4, 1.0),
            (0.1, 0.0, 1.0),
            (0.1, 1e-4, f64::NAN),
            (-1.0, 1e-4, 4.0),
            (0.1, 1e-30, 1e9),
        ] {
            assert!(
                Chirp { rate, deviation }.advance(&mut motion, until, &mut |_| {}).is_err(),
                "{rate} {until}"
            );
        }
    }
}

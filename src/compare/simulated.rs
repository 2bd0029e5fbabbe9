//! Simulates a rig through the points of a sweep one after another, as in the measurement.

use crate::error::{Error, Result};
use crate::model::regime::Watch;
use crate::model::sweep::{Gauge, Observable};
use crate::model::{Compliant, Event, Excitation, Law, Motion, Regime, Rig, Simulation, Sine, State};
use std::f64::consts::TAU;

/// Simulated duration at each point of a sweep, in excitation cycles.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Pace {
    /// Cycles before the motion is read, in which the transient decays.
    pub settle: u32,
    /// Cycles over which the motion is read; patterns longer than a ninth of them count as irregular.
    pub measure: u32,
}

/// Simulated motion at a point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Simulated {
    /// Peak amplitudes in m of the fundamentals of x₁ and x₂, over all cycles read.
    pub amplitude: [f64; 2],
    /// Standard deviations of these from cycle to cycle in m.
    pub scatter: [f64; 2],
    /// Impacts and cycles of the motion's pattern.
    pub regime: Regime,
}

/// Simulates a rig through `points` (frequency in Hz, force amplitude in N) in this order, from rest at the
/// first. State and phase of the force continue from point to point. The contact follows `law`, or is rigid
/// with the rig's restitution.
///
/// Each point has its own result: an error where a parameter is impossible or the motion has too many
/// events to follow. After an error the sweep continues from the state reached, or from rest where the motion
/// could not start or its state is not finite.
pub fn simulated(rig: &Rig, law: Option<Law>, points: &[(f64, f64)], pace: Pace) -> Vec<Result<Simulated>> {
    let rigid = |sine: Sine, state, phase| Simulation::from_state(rig, &sine, state, phase);
    let Some(law) = law else { return swept(rig, points, |motion| read(motion, pace), rigid) };
    let soft = |sine, state, phase| Compliant::new(rig, &Excitation::Sine(sine), law, state, phase);
    swept(rig, points, |motion| read(motion, pace), soft)
}

/// As [`simulated`] with rigid contacts, but refuses a point with more than 100 impacts per cycle: a fit may
/// try parameters with which one point would take minutes.
pub(super) fn simulated_briefly(rig: &Rig, points: &[(f64, f64)], pace: Pace) -> Vec<Result<Simulated>> {
    let rigid = |sine: Sine, state, phase| Simulation::from_state(rig, &sine, state, phase);
    swept(rig, points, |motion| plain(motion).and_then(|()| read(motion, pace)), rigid)
}

/// Excitation cycles in each of two consecutive checks for too many impacts: the second also finds a motion
/// that becomes busy only after the first transient.
const CHECKED: u32 = 8;
/// Mean number of flights per cycle above which a motion is refused: it is chatter, or the rig has wrong
/// parameters.
const BUSY: u32 = 100;

/// Refuses a motion with more than 100 flights per cycle.
fn plain(motion: &mut Simulation) -> Result<()> {
    for _ in 0..2 {
        let until = motion.time() + f64::from(CHECKED) / motion.frequency();
        let mut flights = 0;
        while motion.fly(until)?.event != Event::Reached {
            flights += 1;
            if flights > BUSY * CHECKED {
                return Err(Error::refused(format!("the masses meet more than {BUSY} times a cycle")));
            }
        }
    }
    Ok(())
}

fn swept<M: Motion>(
    rig: &Rig,
    points: &[(f64, f64)],
    read: impl Fn(&mut M) -> Result<Simulated>,
    make: impl Fn(Sine, State, f64) -> Result<M>,
) -> Vec<Result<Simulated>> {
    let rest = (Simulation::at_rest(rig), 0.0);
    let mut now = rest;
    let one = |&(frequency, force): &(f64, f64)| {
        let (state, phase) = std::mem::replace(&mut now, rest);
        let mut motion = make(Sine { force, frequency }, state, phase)?;
        let found = read(&mut motion);
        // A sweep continues after a point without an answer.
        let state = motion.state();
        if [state.x1, state.v1, state.x2, state.v2].iter().all(|v| v.is_finite()) {
            now = (state, motion.phase());
        }
        found
    };
    points.iter().map(one).collect()
}

/// Lets a motion settle, then reads its amplitudes and its pattern.
fn read(motion: &mut dyn Motion, pace: Pace) -> Result<Simulated> {
    let frequency = motion.frequency();
    motion.advance(motion.time() + f64::from(pace.settle) / frequency, &mut |_| {})?;
    let (mut gauge, mut watch) = (Gauge::new(Observable::Fundamental, motion.rig()), Watch::new(motion));
    let omega = TAU * frequency;
    for _ in 0..pace.measure {
        let (start, begun) = (motion.time(), motion.phase());
        motion.advance(start + 1.0 / frequency, &mut |piece| {
            gauge.take(piece.path, piece.duration, begun + omega * (piece.start - start), omega);
            watch.take(&piece);
        })?;
        gauge.close_cycle();
    }
    let read = gauge.read();
    Ok(Simulated { amplitude: read.map(|r| r.0), scatter: read.map(|r| r.1), regime: watch.pattern().regime })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::orbits;

    const PACE: Pace = Pace { settle: 300, measure: 64 };

    #[test]
    fn a_sweep_up_reaches_the_motions_of_the_closed_form() {
        let rig = Rig::thesis();
        let points: Vec<(f64, f64)> = (0..8).map(|i| (10.5 + 0.25 * f64::from(i), 0.5)).collect();
        let found = simulated(&rig, None, &points, PACE);
        for (at, point) in found.iter().zip(&points) {
            let at = at.as_ref().unwrap();
            let all = orbits(&rig, point.1, point.0).unwrap();
            let real = all.orbits.iter().find(|o| o.validity.admissible && o.validity.stable == Some(true));
            let Some(orbit) = real else { continue };
            assert_eq!(at.regime, Regime::Periodic { impacts: 1, cycles: 1 }, "{point:?}");
            for mass in 0..2 {
                // After 300 cycles the transient is below 0.95^300 = 2e-7 (multipliers up to 0.97 near a
                // flip leave 1e-4); the gauge errs by 3e-6.
                let radius = orbit.spectral_radius().unwrap();
                let left = radius.powi(300) + 2e-5;
                let expected = orbit.fundamental[mass].norm();
                assert!((at.amplitude[mass] / expected - 1.0).abs() < left, "{point:?}: {at:?} {expected}");
            }
        }
        assert!(found.iter().flatten().any(|f| f.regime == Regime::Periodic { impacts: 1, cycles: 1 }));
    }

    #[test]
    fn a_stiff_contact_moves_as_an_instantaneous_one() {
        let rig = Rig::thesis();
        let points = [(11.0, 0.5), (11.2, 0.5)];
        let law = Law::kelvin_voigt(1e9, rig.restitution, rig.reduced_mass()).unwrap();
        let [hard, stiff] = [None, Some(law)].map(|law| simulated(&rig, law, &points, PACE));
        for (a, b) in hard.iter().flatten().zip(stiff.iter().flatten()) {
            // The contact lasts π√(M/k) = 2.3e-5 s, 2.5e-4 of the cycle. Near the clapping resonance its
            // effect is some thirty times that (0.74 % of the cycle changes the impact speed by 21 %).
            assert!((a.amplitude[0] / b.amplitude[0] - 1.0).abs() < 30.0 * 2.5e-4, "{a:?} {b:?}");
        }
    }

    #[test]
    fn too_small_a_force_leaves_the_second_mass_at_rest() {
        let rig = Rig::thesis();
        let found = simulated(&rig, None, &[(20.0, 0.1), (21.0, 0.2)], PACE);
        assert_eq!(found.iter().flatten().count(), 2);
        assert!(found.iter().flatten().all(|f| f.regime == Regime::NoImpact && f.amplitude[1] == 0.0));
    }

    #[test]
    fn a_point_that_cannot_be_is_refused_alone() {
        let rig = Rig::thesis();
        let found = simulated(&rig, None, &[(20.0, 0.1), (-1.0, 0.1), (21.0, 0.1)], PACE);
        assert_eq!(found.iter().map(Result::is_ok).collect::<Vec<_>>(), [true, false, true]);
    }
}

//! Starts of simulations: a sweep that leads to the excitation, or states in all directions.

use crate::contact::Compliant;
use crate::excitation::Excitation;
use crate::flow::State;
use crate::law::Law;
use crate::motion::Motion;
use crate::orbit::{Orbits, no_impact, orbits_of};
use crate::rig::Rig;
use crate::simulate::Simulation;
use crate::steady::Steady;
use serde::Serialize;
use std::f64::consts::TAU;
use vibro_record::{Direction, Result};

/// Ratio of successive frequencies of the sweep.
const STEP: f64 = 1.01;
/// Fewest and most steps of the sweep: a change of the frequency by 28 % to a factor of 4.
const STEPS: (i32, i32) = (25, 140);
/// Excitation cycles at the first frequency of the sweep, and at each later one.
const CYCLES: (f64, f64) = (300.0, 60.0);
/// Number of start states.
const STARTS: u32 = 8;
/// Smallest and largest size of a start state, in units of the gap or of the displacement of mass 1 without
/// impacts, the larger.
const SIZES: (f64, f64) = (1.0, 6.0);

/// Sweep up or down to an excitation in steps of 1 %, from a frequency at which only one motion is known.
#[derive(Debug)]
pub struct Approach {
    rig: Rig,
    first: Excitation,
    /// State at the beginning, at phase 0: of the motion without impacts where there is one, else at rest.
    state: State,
    /// Frequencies in Hz after the first.
    then: Vec<f64>,
}

impl Approach {
    /// The sweep that reaches `excitation` in this direction.
    ///
    /// # Errors
    /// If a parameter is impossible, or an undamped mass is driven at resonance.
    pub fn new(rig: &Rig, excitation: &Excitation, direction: Direction) -> Result<Approach> {
        let sign = if direction == Direction::Up { -1 } else { 1 };
        let at = |n: i32| excitation.at_frequency(excitation.frequency() * STEP.powi(sign * n));
        // The sweep cannot begin where the pulse would last longer than a cycle.
        let end = (1..=STEPS.1).take_while(|n| at(*n).check().is_ok()).last().unwrap_or(0);
        let is_single = |n: &i32| !orbits_of(rig, &at(*n), 1).is_ok_and(|found| several(&found));
        let first = (STEPS.0..end).find(is_single).unwrap_or(end);
        let then = (0..first).rev().map(|n| at(n).frequency()).collect();
        Ok(Approach { rig: *rig, first: at(first), state: outset(rig, &at(first))?, then })
    }

    /// The simulation at the end of the sweep, with rigid impacts.
    ///
    /// # Errors
    /// As [`Simulation::run`].
    pub fn rigid(&self) -> Result<Simulation> {
        self.lead(Simulation::from_state(&self.rig, &self.first, self.state, 0.0)?)
    }

    /// The simulation at the end of the sweep, with a compliant contact.
    ///
    /// # Errors
    /// As [`Compliant::new`] and [`Motion::advance`].
    pub fn with(&self, law: Law) -> Result<Compliant> {
        self.lead(Compliant::new(&self.rig, &self.first, law, self.state, 0.0)?)
    }

    fn lead<M: Motion>(&self, mut motion: M) -> Result<M> {
        motion.advance(CYCLES.0 / motion.frequency(), &mut |_| {})?;
        for frequency in &self.then {
            motion.set_frequency(*frequency)?;
            motion.advance(motion.time() + CYCLES.1 / motion.frequency(), &mut |_| {})?;
        }
        Ok(motion)
    }
}

/// Whether the motion without impacts and one with impacts are both possible. An unstable one counts too:
/// after a flip or a Neimark–Sacker bifurcation another motion with impacts exists near it.
pub fn several(found: &Orbits) -> bool {
    found.no_impact.possible && found.orbits.iter().any(|o| o.validity.admissible)
}

/// The state at phase 0 of the motion without impacts where there is one, else at rest.
fn outset(rig: &Rig, excitation: &Excitation) -> Result<State> {
    if let Excitation::Sine(sine) = excitation {
        let steady = Steady::new(rig, sine)?;
        if steady.amplitude() < rig.gap {
            let x = steady.response;
            return Ok(State { x1: x.re, v1: -steady.omega * x.im, ..State::REST });
        }
    }
    Ok(Simulation::at_rest(rig))
}

/// Number of start states, besides rest, of the search for other motions.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct Followed {
    /// States that were simulated.
    pub states: u32,
    /// All states. Fewer are simulated once a second motion is found, where the search takes too many cycles,
    /// or where a motion cannot be simulated.
    pub of: u32,
}

/// Start states at phase 0 of the excitation, of rising size and in evenly spread directions (the additive
/// recurrence of the generalised golden ratio, M. Roberts, 2018). An overlap is mirrored at the contact, so
/// that the masses are apart by as much.
pub fn starts(rig: &Rig, excitation: &Excitation) -> impl Iterator<Item = (State, f64)> {
    let unit = no_impact(rig, excitation).map_or(0.0, |free| free.largest).max(rig.gap.abs());
    let omega = TAU * excitation.frequency();
    // φ⁵ = φ + 1, the ratio for four dimensions.
    let golden = (0..64).fold(1.0_f64, |phi, _| (1.0 + phi).powf(0.2));
    let (gap, wall) = (rig.gap, rig.has_wall());
    (0..STARTS).filter(move |_| unit.is_finite() && unit > 0.0).map(move |n| {
        let part = f64::from(n) / f64::from(STARTS - 1);
        let size = unit * (SIZES.0 + part * (SIZES.1 - SIZES.0));
        let [x1, v1, x2, v2] =
            [1, 2, 3, 4].map(|k| size * (2.0 * (0.5 + f64::from(n + 1) / golden.powi(k)).fract() - 1.0));
        let [x2, v2] = if wall { [0.0; 2] } else { [x2, v2] };
        let overlap = (x1 - x2 - gap).max(0.0);
        (State { x1: x1 - 2.0 * overlap, v1: omega * v1, x2, v2: omega * v2 }, 0.0)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::excitation::Sine;
    use crate::simulate::Simulation;

    #[test]
    fn states_are_apart_and_grow_in_all_directions() {
        let sine: Excitation = Sine { force: 0.3, frequency: 12.97 }.into();
        for (gap, m2) in [(1e-3, 0.094), (0.0, 0.094), (-5e-4, 0.094), (1e-3, f64::INFINITY)] {
            let rig = Rig { m2, gap, ..Rig::thesis() };
            let all: Vec<State> = starts(&rig, &sine).map(|s| s.0).collect();
            assert_eq!(all.len(), STARTS as usize);
            // `from_state` refuses overlapping masses and a moving wall.
            assert!(all.iter().all(|s| Simulation::from_state(&rig, &sine, *s, 0.0).is_ok()));
            // x₁ may have one sign only: it cannot lie far beyond the contact.
            assert!(all.iter().any(|s| s.v1 > 0.0) && all.iter().any(|s| s.v1 < 0.0));
            let size = |s: &State| s.v1.abs().max(s.v2.abs()) / (TAU * 12.97);
            let unit = no_impact(&rig, &sine).unwrap().largest.max(gap.abs());
            assert!(all.iter().all(|s| size(s) <= SIZES.1 * unit) && size(&all[0]) <= SIZES.0 * unit);
        }
    }
}

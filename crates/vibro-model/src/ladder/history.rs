//! Which of several motions a rig is in, by the way it came there.

use crate::{Compliant, Excitation, Law, Motion, Orbits, Rig, Simulation, State, Steady, orbits_of};
use vibro_record::{Direction, Result};

/// Ratio of one frequency to the next.
const STEP: f64 = 1.01;
/// Steps at least and at most: 28 % to a factor of 4.
const STEPS: (i32, i32) = (25, 140);
/// Cycles at the beginning, and at each step.
const CYCLES: (f64, f64) = (300.0, 60.0);

/// The way to an excitation after its frequency rose or fell to it: from where only one motion is known, in steps of 1 %.
#[derive(Debug)]
pub struct Way {
    rig: Rig,
    first: Excitation,
    /// State at the beginning, at phase 0: of the motion without impacts where there is one, else at rest.
    state: State,
    /// Frequencies in Hz after the first.
    then: Vec<f64>,
}

impl Way {
    /// # Errors
    /// If a parameter is impossible, or an undamped mass is driven at resonance.
    pub fn new(rig: &Rig, excitation: &Excitation, direction: Direction) -> Result<Way> {
        let frequency = excitation.frequency();
        let at = |n: i32| {
            let n = if direction == Direction::Up { -n } else { n };
            excitation.at_frequency(frequency * STEP.powi(n))
        };
        // A pulse that is longer than a cycle ends the way.
        let end = (1..=STEPS.1).take_while(|n| at(*n).check().is_ok()).last().unwrap_or(0);
        let one = |n: &i32| {
            *n == end || (*n >= STEPS.0 && !orbits_of(rig, &at(*n), 1).is_ok_and(|found| several(&found)))
        };
        let first = (0..=end).find(one).unwrap_or(end);
        let then = (0..first).rev().map(|n| at(n).frequency()).collect();
        Ok(Way { rig: *rig, first: at(first), state: outset(rig, &at(first))?, then })
    }

    /// The motion at its end, with impacts at once.
    ///
    /// # Errors
    /// As [`Simulation::run`].
    pub fn rigid(&self) -> Result<Simulation> {
        self.lead(Simulation::from_state(&self.rig, &self.first, self.state, 0.0)?)
    }

    /// The motion at its end, with a contact that gives way.
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

/// Whether the motion without impacts and one with impacts are both possible. One that has lost its stability counts: round it lies
/// another motion with impacts, as behind a flip or a Neimark–Sacker loss.
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

//! Which of several motions a rig is in, by the way it came there.

use crate::error::Result;
use crate::model::{Excitation, Motion, Orbits, Rig, Simulation, State, Steady, orbits_of};
use crate::record::Direction;

/// Ratio of one frequency to the next.
const STEP: f64 = 1.01;
/// Steps at least and at most: 28 % to a factor of 4.
const STEPS: (i32, i32) = (25, 140);
/// Cycles at the beginning, and at each step.
const CYCLES: (f64, f64) = (300.0, 60.0);

/// The motion at this excitation after its frequency rose or fell to it: from where only one motion is known, in steps of 1 %, followed
/// from impact to impact.
///
/// # Errors
/// As [`Simulation::run`].
pub fn arrived(rig: &Rig, excitation: &Excitation, direction: Direction) -> Result<Simulation> {
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
    let mut motion = outset(rig, &at(first))?;
    motion.run(CYCLES.0 / motion.frequency(), |_| {})?;
    for n in (0..first).rev() {
        motion.set_frequency(at(n).frequency())?;
        let until = motion.time() + CYCLES.1 / Motion::frequency(&motion);
        motion.run(until, |_| {})?;
    }
    Ok(motion)
}

/// Whether the motion without impacts and one with impacts are both possible. One that has lost its stability counts: round it lies
/// another motion with impacts, as behind a flip or a Neimark–Sacker loss.
pub fn several(found: &Orbits) -> bool {
    found.no_impact.possible && found.orbits.iter().any(|o| o.validity.admissible)
}

/// The motion without impacts where there is one, else from rest.
fn outset(rig: &Rig, excitation: &Excitation) -> Result<Simulation> {
    if let Excitation::Sine(sine) = excitation {
        let steady = Steady::new(rig, sine)?;
        if steady.amplitude() < rig.gap {
            let x = steady.response;
            let state = State { x1: x.re, v1: -steady.omega * x.im, ..State::REST };
            return Simulation::from_state(rig, excitation, state, 0.0);
        }
    }
    Simulation::new(rig, excitation)
}

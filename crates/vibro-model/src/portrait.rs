//! Portrait of a motion over some cycles: its impacts, its pattern, its traces, and its Poincaré section.

use super::flow::State;
use super::impact::Impact;
use super::motion::{Event, Motion, Piece};
use super::reaction::{Reaction, Tally};
use super::regime::{Pattern, Watch};
use std::f64::consts::TAU;
use vibro_record::{Error, Result};

/// Largest number of cycles of a portrait: every impact and one state per cycle are kept in memory.
pub(crate) const MOST_CYCLES: u32 = 100_000;

/// A motion over some cycles of its excitation.
#[derive(Debug, Clone, PartialEq)]
pub struct Portrait {
    /// Impacts in order.
    pub impacts: Vec<Impact>,
    /// Number of times the masses came to rest against each other.
    pub sticks: u64,
    /// The pattern of the impacts.
    pub pattern: Pattern,
    /// Peak, root mean square and impulse of the force between the masses.
    pub reaction: Reaction,
    /// Time (s) and force (N) in the contacts of the last, sampled cycles; empty for rigid impacts.
    pub force: Vec<(f64, f64)>,
    /// Sampling times in s, in the last cycles.
    pub time: Vec<f64>,
    /// States at these times.
    pub states: Vec<State>,
    /// Time in s of each impact in the sampled cycles, and the states just before and just after it.
    pub jumps: Vec<(f64, State, State)>,
    /// Start times of the cycles in s.
    pub beginnings: Vec<f64>,
    /// States at the beginning of each cycle (phase 0): a Poincaré section.
    pub section: Vec<State>,
}

/// Length and sampling of a portrait.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct PortraitOptions {
    /// Number of cycles.
    pub cycles: u32,
    /// Samples per cycle of the traces.
    pub samples: u32,
    /// Number of cycles at the end that are sampled.
    pub shown: u32,
}

impl Portrait {
    /// Follows `motion` for these cycles and records it.
    ///
    /// # Errors
    /// If there are no cycles or more than `MOST_CYCLES`, or as [`Motion::advance`].
    pub fn take(motion: &mut dyn Motion, sitting: &PortraitOptions) -> Result<Portrait> {
        if !(1..=MOST_CYCLES).contains(&sitting.cycles) {
            return Err(Error::usage(
                format!("{} cycles to be looked at", sitting.cycles),
                format!("1 to {MOST_CYCLES}; a motion can be given more to settle before"),
            ));
        }
        let (start, period) = (motion.time(), 1.0 / motion.frequency());
        let end = start + f64::from(sitting.cycles) * period;
        let shown = sitting.shown.min(sitting.cycles);
        let first = end - f64::from(shown) * period;
        let whole = start + (TAU - motion.phase()) / TAU % 1.0 * period;
        let mut samples = Samples::new(first, period / f64::from(sitting.samples.max(1)), end);
        let mut section = Samples::new(whole, period, end);
        let mut watch = Watch::new(motion);
        let mut tally = Tally::new(motion, first);
        let (mut impacts, mut sticks) = (Vec::new(), 0);
        let mut jumps = Vec::new();
        let mut struck: Option<(f64, State)> = None;
        motion.advance(end, &mut |piece| {
            if let Some((time, before)) = struck.take() {
                jumps.push((time, before, piece.path.state(0.0)));
            }
            let over = piece.start + piece.duration;
            if matches!(piece.event, Event::Impact(_)) && over > first {
                struck = Some((over, piece.path.state(piece.duration)));
            }
            watch.take(&piece);
            tally.take(&piece);
            samples.take(&piece);
            section.take(&piece);
            match piece.event {
                Event::Impact(impact) => impacts.push(impact),
                Event::Stick => sticks += 1,
                _ => {}
            }
        })?;
        Ok(Portrait {
            impacts,
            sticks,
            pattern: watch.pattern(),
            reaction: tally.read(sitting.cycles),
            force: tally.trace,
            time: samples.time,
            states: samples.states,
            jumps,
            beginnings: section.time,
            section: section.states,
        })
    }
}

/// Equally spaced samples of a motion.
#[derive(Debug, Clone)]
pub struct Samples {
    first: f64,
    step: f64,
    end: f64,
    /// Times in s.
    pub time: Vec<f64>,
    /// States at these times; at an impact, the state after it.
    pub states: Vec<State>,
}

impl Samples {
    /// Samples every `step` seconds from `first` to before `end` (s).
    pub fn new(first: f64, step: f64, end: f64) -> Samples {
        Samples { first, step, end, time: Vec::new(), states: Vec::new() }
    }

    /// Adds the samples of a piece; a sample at its end belongs to the next piece.
    pub fn take(&mut self, piece: &Piece<'_>) {
        loop {
            let time = self.first + self.step * self.time.len() as f64;
            // The end is excluded: a time within 1e-6 of a step before it equals the end up to rounding.
            if time >= piece.start + piece.duration || time > self.end - 1e-6 * self.step {
                return;
            }
            self.time.push(time);
            self.states.push(piece.path.state((time - piece.start).max(0.0)));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::excitation::Sine;
    use crate::rig::Rig;
    use crate::simulate::Simulation;

    #[test]
    fn samples_and_sections_are_states_of_the_motion() {
        let sine = Sine { force: 0.5, frequency: 11.0 };
        let mut motion = Simulation::new(&Rig::thesis(), &sine).unwrap();
        motion.run(0.33, |_| {}).unwrap();
        let mut again = motion.clone();
        let sitting = PortraitOptions { cycles: 30, samples: 50, shown: 4 };
        let portrait = Portrait::take(&mut motion, &sitting).unwrap();
        assert_eq!((portrait.time.len(), portrait.states.len(), portrait.section.len()), (200, 200, 30));
        for (time, state) in portrait.time.iter().zip(&portrait.states).step_by(17) {
            again.run(*time, |_| {}).unwrap();
            let other = again.state();
            // The simulation restarted at each sample has rounding errors: of 10 mm, 0.5 m/s, and phases up
            // to 300 rad.
            assert!((other.x1 - state.x1).abs() < 1e-13 && (other.v2 - state.v2).abs() < 1e-11);
        }
        // One impact a cycle, wherever the portrait begins.
        assert!((29..=31).contains(&portrait.impacts.len()), "{}", portrait.impacts.len());
        let mut fresh = Simulation::new(&Rig::thesis(), &sine).unwrap();
        fresh.run(5.0 / 11.0, |_| {}).unwrap();
        // First point of the section: phase 0 is passed at 4/11 s.
        let mut fourth = Simulation::new(&Rig::thesis(), &sine).unwrap();
        fourth.run(4.0 / 11.0, |_| {}).unwrap();
        assert!((fourth.state().x1 - portrait.section[0].x1).abs() < 1e-14);
        assert!((fresh.state().v1 - portrait.section[1].v1).abs() < 1e-12);
    }

    #[test]
    fn the_states_around_an_impact_stand_where_the_masses_meet() {
        let rig = Rig::thesis();
        let mut motion = Simulation::new(&rig, &Sine { force: 0.5, frequency: 11.0 }).unwrap();
        let portrait =
            Portrait::take(&mut motion, &PortraitOptions { cycles: 30, samples: 50, shown: 30 }).unwrap();
        assert_eq!(portrait.jumps.len(), portrait.impacts.len());
        assert!(!portrait.jumps.is_empty());
        for ((time, before, after), impact) in portrait.jumps.iter().zip(&portrait.impacts) {
            assert!((time - impact.time).abs() < 1e-12);
            // The displacements are equal to the rounding of the contact search, and the impulse changes the
            // momenta.
            for mass in [before.x1 - after.x1, before.x2 - after.x2, before.x1 - before.x2 - rig.gap] {
                assert!(mass.abs() < 1e-15, "{before:?} {after:?}");
            }
            assert!((rig.m1 * (before.v1 - after.v1) / impact.impulse - 1.0).abs() < 1e-12);
            assert!((rig.m2 * (after.v2 - before.v2) / impact.impulse - 1.0).abs() < 1e-12);
        }
    }

    #[test]
    fn no_cycles_and_too_many_are_refused() {
        let mut motion = Simulation::new(&Rig::thesis(), &Sine { force: 0.5, frequency: 11.0 }).unwrap();
        for cycles in [0, MOST_CYCLES + 1] {
            assert!(Portrait::take(&mut motion, &PortraitOptions { cycles, samples: 10, shown: 1 }).is_err());
        }
    }
}

//! Sweeps: the excitation of a motion changes in steps or slowly, up or down; each point starts from the
//! state at the end of the one before.

mod gauge;

pub use gauge::Gauge;
#[cfg(test)]
use gauge::LOW_PASS;
pub use gauge::{Observable, STILL};

use super::motion::Motion;
use super::reaction::{Reaction, Tally};
use super::scales;
use serde::Serialize;
use std::f64::consts::{FRAC_PI_2, TAU};
use vibro_record::{Direction, Error, Result};

/// Steps of constant frequency per cycle of a continuous sweep. A step has the frequency at its middle, so
/// the phase is exact at both ends of a step. Inside it errs by at most 2πrh²/8, with the rate r in Hz/s and
/// the step h in s: 7e-6 rad at 3 Hz and 0.02 Hz/s.
const STEPS_PER_CYCLE: u32 = 16;

/// How a sweep passes from one value to the next.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Pace {
    /// `points` equally spaced values; at each `settle` cycles pass before `measure` cycles are read.
    Steps {
        /// Values, both ends included.
        points: usize,
        /// Cycles before reading.
        settle: u32,
        /// Cycles read.
        measure: u32,
    },
    /// The frequency changes by `rate` Hz/s; whole cycles are read, in about `points` groups.
    Rate {
        /// Rate in Hz/s, above 0 in both directions.
        rate: f64,
        /// Wanted number of points; at most one a cycle.
        points: usize,
    },
}

/// Range, pace and observable of a sweep.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Plan {
    /// Lower end (Hz, or N for a sweep of the force).
    pub from: f64,
    /// Upper end.
    pub to: f64,
    /// Steps or rate.
    pub pace: Pace,
    /// The observable that is read.
    pub observable: Observable,
}

/// One point of a sweep.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Point {
    /// Excitation frequency in Hz: the mean over the cycles read.
    pub frequency: f64,
    /// Force amplitude in N, or the size of another excitation.
    pub force: f64,
    /// The observable of x₁ in m.
    pub x1: f64,
    /// The observable of x₂ in m.
    pub x2: f64,
    /// Standard deviation in m of x₁'s observable from cycle to cycle: 0 where all cycles are equal.
    pub x1_scatter: f64,
    /// The same of x₂.
    pub x2_scatter: f64,
    /// Phase in rad of x₂ against x₁ at the excitation frequency: 0 in phase, ±π in antiphase; `None` where a
    /// mass stands still.
    pub relative_phase: Option<f64>,
    /// [`Gauge::unrest`] of x₁ and x₂ in m.
    #[serde(skip)]
    pub unrest: [f64; 2],
    /// Time in s from the start of the motion to the end of this point.
    #[serde(skip)]
    pub time: f64,
    /// The force between the masses over the cycles read.
    pub reaction: Reaction,
}

/// Most swings of a mass in a cycle for which a sweep is simulated: a hundred cycles at each of a hundred
/// points then take a minute.
const MOST_SWINGS: f64 = 1e4;

impl Plan {
    /// Checks the plan.
    ///
    /// # Errors
    /// If an end is not a value that can be swept, there are no points or cycles, or more than 1e8 cycles.
    pub fn check(&self) -> Result<()> {
        let Plan { from, to, .. } = *self;
        if !(from.is_finite() && to.is_finite() && from >= 0.0 && to > from) {
            return Err(Error::usage(
                format!("a sweep between {from} and {to}"),
                "finite ends, the lower one first and not negative",
            ));
        }
        let cycles = match self.pace {
            Pace::Steps { points, settle, measure } => {
                if points < 2 || measure == 0 {
                    let found = format!("{points} points of {measure} cycles each");
                    return Err(Error::usage(found, "at least 2 points and 1 cycle read at each"));
                }
                points as f64 * (f64::from(settle) + f64::from(measure))
            }
            Pace::Rate { rate, points } => {
                if !(rate.is_finite() && rate > 0.0 && from > 0.0 && points > 0) {
                    let found = format!("a rate of {rate} Hz/s from {from} Hz with {points} points");
                    return Err(Error::usage(found, "a rate and a lower end above 0, and at least 1 point"));
                }
                (to * to - from * from) / (2.0 * rate)
            }
        };
        scales::check_work(cycles)
    }

    /// Sweeps the frequency of `motion`, whose force has the size `force`, from one end to the other; with a
    /// rate, each cycle has several steps of constant frequency.
    ///
    /// # Errors
    /// As [`Plan::check`] and [`Motion::advance`].
    pub fn frequency(&self, motion: &mut dyn Motion, force: f64, direction: Direction) -> Result<Vec<Point>> {
        self.check()?;
        if self.from > 0.0 {
            scales::check_swings(motion.rig(), self.from, MOST_SWINGS)?;
        }
        let Pace::Rate { rate, points } = self.pace else {
            return self.steps(motion, direction, |motion, value| {
                motion.set_frequency(value)?;
                Ok((value, force))
            });
        };
        let (start, end, rate) = match direction {
            Direction::Up => (self.from, self.to, rate),
            Direction::Down => (self.to, self.from, -rate),
        };
        // The phase after the time t is f₀t + rt²/2 cycles, so the frequency f is reached after (f² − f₀²)/2r
        // cycles.
        let all = ((end * end - start * start) / (2.0 * rate)).floor().max(1.0) as u64;
        let group = all.div_ceil(points as u64);
        let at = |cycle: f64| (start * start + 2.0 * rate * cycle).max(0.0).sqrt();
        let mut gauge = Gauge::new(self.observable, motion.rig());
        let mut found = Vec::with_capacity((all / group) as usize + 1);
        let mut cycle = 0;
        while cycle < all {
            let until = (cycle + group).min(all);
            gauge.clear();
            let mut tally = Tally::new(motion, f64::INFINITY);
            for c in cycle..until {
                for step in 0..STEPS_PER_CYCLE {
                    let begun = c as f64 + f64::from(step) / f64::from(STEPS_PER_CYCLE);
                    // The mean frequency of the step: the phases at its ends are 1/STEPS_PER_CYCLE cycles
                    // apart.
                    let ends = [at(begun), at(begun + 1.0 / f64::from(STEPS_PER_CYCLE))];
                    motion.set_frequency(f64::midpoint(ends[0], ends[1]))?;
                    pass(motion, 1.0 / f64::from(STEPS_PER_CYCLE), &mut gauge, Some(&mut tally))?;
                }
                gauge.close_cycle();
            }
            let (first, last) = (at(cycle as f64), at(until as f64));
            let reaction = tally.read((until - cycle) as u32);
            found.push(point(&gauge, f64::midpoint(first, last), force, motion.time(), reaction));
            cycle = until;
        }
        Ok(found)
    }

    /// Sweeps any parameter in steps: `set` changes it, and returns the frequency (Hz) and the force (N)
    /// after the change.
    ///
    /// # Errors
    /// As [`Plan::check`] and [`Motion::advance`], if the pace is a rate, and the errors of `set`.
    pub fn steps(
        &self,
        motion: &mut dyn Motion,
        direction: Direction,
        mut set: impl FnMut(&mut dyn Motion, f64) -> Result<(f64, f64)>,
    ) -> Result<Vec<Point>> {
        self.check()?;
        let Pace::Steps { points, settle, measure } = self.pace else {
            return Err(Error::usage("a sweep of the force with a rate", "steps"));
        };
        let mut gauge = Gauge::new(self.observable, motion.rig());
        let last = (points - 1) as f64;
        (0..points)
            .map(|i| {
                let share = i as f64 / last;
                let share = if direction == Direction::Up { share } else { 1.0 - share };
                let (frequency, force) = set(motion, self.from + share * (self.to - self.from))?;
                if self.observable == Observable::Rms {
                    // The running mean must include the settling cycles.
                    for _ in 0..settle {
                        pass(motion, 1.0, &mut gauge, None)?;
                    }
                } else if settle > 0 {
                    motion.advance(motion.time() + f64::from(settle) / frequency, &mut |_| {})?;
                }
                gauge.restart();
                let mut tally = Tally::new(motion, f64::INFINITY);
                for _ in 0..measure {
                    pass(motion, 1.0, &mut gauge, Some(&mut tally))?;
                    gauge.close_cycle();
                }
                Ok(point(&gauge, frequency, force, motion.time(), tally.read(measure)))
            })
            .collect()
    }
}

/// Follows the motion for `cycles` at the present frequency, and reads it.
fn pass(
    motion: &mut dyn Motion,
    cycles: f64,
    gauge: &mut Gauge,
    mut tally: Option<&mut Tally>,
) -> Result<()> {
    let (start, phase, frequency) = (motion.time(), motion.phase(), motion.frequency());
    let omega = TAU * frequency;
    motion.advance(start + cycles / frequency, &mut |piece| {
        gauge.take(piece.path, piece.duration, phase + omega * (piece.start - start), omega);
        if let Some(tally) = &mut tally {
            tally.take(&piece);
        }
    })
}

fn point(gauge: &Gauge, frequency: f64, force: f64, time: f64, reaction: Reaction) -> Point {
    let [(x1, x1_scatter), (x2, x2_scatter)] = gauge.read();
    let (relative_phase, unrest) = (gauge.relative_phase(), gauge.unrest());
    Point { frequency, force, x1, x2, x1_scatter, x2_scatter, relative_phase, unrest, time, reaction }
}

/// Largest change from cycle to cycle, over the amplitude, of a motion that counts as periodic.
const REGULAR: f64 = 0.05;

impl Point {
    /// Amplitudes of both masses in m.
    pub fn amplitudes(&self) -> [f64; 2] {
        [self.x1, self.x2]
    }

    /// Whether both masses, where they move by more than `floor` (m), repeat within four cycles.
    pub fn is_regular(&self, floor: f64) -> bool {
        self.amplitudes().into_iter().zip(self.unrest).all(|(x, unrest)| x <= floor || unrest <= REGULAR * x)
    }
}

/// Whether masses with this phase of x₂ against x₁ (rad) move in phase, rather than in antiphase.
pub fn in_phase(relative_phase: f64) -> bool {
    relative_phase.abs() < FRAC_PI_2
}

/// The value, or 0 where it is smaller than the floor of rounding.
pub fn above_floor(value: f64, floor: f64) -> f64 {
    if value.abs() < floor { 0.0 } else { value }
}

/// A sweep up and one down.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct Swept {
    /// Points of the sweep up, in the order of time; empty without one.
    pub up: Vec<Point>,
    /// Points of the sweep down, in the order of time; empty without one.
    pub down: Vec<Point>,
}

impl Swept {
    /// Amplitude in m below which a mass stands still.
    pub fn floor(&self) -> f64 {
        let all = self.up.iter().chain(&self.down).flat_map(Point::amplitudes);
        STILL * all.fold(0.0, f64::max)
    }

    /// Sets amplitudes below [`Swept::floor`] to 0: they are rounding, or the remains of an earlier motion.
    pub fn without_dust(mut self) -> Swept {
        let floor = self.floor();
        for p in self.up.iter_mut().chain(&mut self.down) {
            for (x, scatter) in [(&mut p.x1, &mut p.x1_scatter), (&mut p.x2, &mut p.x2_scatter)] {
                if *x < floor {
                    (*x, *scatter) = (0.0, 0.0);
                }
            }
        }
        self
    }
}

/// Runs `one` for each of the directions, in parallel.
///
/// # Errors
/// Those of `one`.
pub fn apart(
    directions: &[Direction],
    one: impl Fn(Direction) -> Result<Vec<Point>> + Sync,
) -> Result<Swept> {
    let wanted = |direction| if directions.contains(&direction) { one(direction) } else { Ok(Vec::new()) };
    let (up, down) = rayon::join(|| wanted(Direction::Up), || wanted(Direction::Down));
    Ok(Swept { up: up?, down: down? })
}

#[cfg(test)]
mod tests;

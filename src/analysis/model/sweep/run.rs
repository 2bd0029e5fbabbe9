//! Runs of a sweep from its start, and from the same state at other phases of the excitation.

use super::Moving;
use crate::error::{Error, Result};
use crate::model::portrait::{Portrait, PortraitOptions};
use crate::model::sweep::{Plan, Point, Swept, in_phase};
use crate::model::{Excitation, Motion, Regime, State};
use crate::record::{Direction, Finding};
use rayon::iter::Either;
use rayon::prelude::*;
use serde::Serialize;
use std::f64::consts::TAU;

/// Further phases of the excitation at which the sweep is started, in cycles after the stated phase.
const OTHER_PHASES: [f64; 3] = [0.25, 0.5, 0.75];

/// Cycles over which the motion at the end is read, and those that are drawn.
const END: PortraitOptions = PortraitOptions { cycles: 60, samples: 200, shown: 4 };

/// The motion at the end of a direction.
#[derive(Debug, Clone, Serialize)]
pub(super) struct End {
    pub direction: Direction,
    pub frequency: f64,
    /// Phase of the excitation in rad.
    pub phase: f64,
    #[serde(flatten)]
    pub state: State,
    pub regime: Regime,
    /// As [`Point::relative_phase`].
    pub relative_phase: Option<f64>,
}

impl End {
    /// Relative motion of the masses: in phase or antiphase.
    pub fn masses(&self) -> Option<&'static str> {
        self.relative_phase.map(|phase| if in_phase(phase) { "in phase" } else { "antiphase" })
    }
}

/// One direction of a sweep.
#[derive(Debug, Clone)]
pub(super) struct Leg {
    pub direction: Direction,
    pub points: Vec<Point>,
    pub end: End,
    /// The motion after the end.
    pub portrait: Portrait,
}

/// Neighbouring points of a sweep with the same property, with their largest amplitudes in m.
#[derive(Debug, Clone, Serialize)]
pub(super) struct Range {
    pub direction: Direction,
    pub from: f64,
    pub to: f64,
    pub points: usize,
    pub x1: f64,
    pub x2: f64,
}

/// A sweep from its start, and those from other phases.
#[derive(Debug)]
pub(super) struct Runs {
    legs: Vec<Leg>,
    /// Points of the sweeps from other phases, for each of the same legs; `None` where there was none.
    others: Option<Vec<Vec<Vec<Point>>>>,
    /// Errors of sweeps from other phases.
    failed: Vec<Error>,
    over_force: bool,
}

impl Runs {
    /// Sweeps motions that `make` creates from an excitation, a state and a phase (rad), over the force at
    /// `frequency` (Hz) if that is given. They begin at the stated state and phase, and again at later
    /// phases, of which one that fails is left out. If at most half of the points are regular, no other phase
    /// is tried: irregular motions cannot be told apart.
    pub fn of(
        make: impl Fn(&Excitation, State, f64) -> Result<Moving> + Sync,
        (state, phase): (State, f64),
        excitation: &Excitation,
        plan: &Plan,
        frequency: Option<f64>,
        sweeps: &[&[Direction]],
    ) -> Result<Runs> {
        let at = |value| match frequency {
            Some(_) => excitation.at_size(value),
            None => excitation.at_frequency(value),
        };
        let points = |motion: &mut dyn Motion, direction| match frequency {
            None => plan.frequency(motion, excitation.size(), direction),
            Some(frequency) => plan.steps(motion, direction, |motion, value| {
                motion.set_excitation(&excitation.at_size(value))?;
                Ok((frequency, value))
            }),
        };
        let run = |(later, directions): (f64, &[Direction])| -> Result<Vec<Leg>> {
            let first = if directions.first() == Some(&Direction::Down) { plan.to } else { plan.from };
            let mut motion = make(&at(first), state, phase + later * TAU)?;
            let one = |direction: &Direction| {
                let points = points(&mut *motion, *direction)?;
                // The motion after the end is that of a copy: the next direction begins at the end.
                let last = if *direction == Direction::Up { plan.to } else { plan.from };
                let mut copy = make(&at(last), motion.state(), motion.phase())?;
                copy.set_frequency(motion.frequency())?;
                leg(points, &mut *copy, *direction)
            };
            directions.iter().map(one).collect()
        };
        let legs = sweeps.par_iter().map(|s| run((0.0, s))).collect::<Result<Vec<_>>>()?.concat();
        let all = |phase: f64| -> Result<Vec<Vec<Point>>> {
            let legs: Vec<_> = sweeps.par_iter().map(|s| run((phase, s))).collect::<Result<_>>()?;
            Ok(legs.into_iter().flatten().map(|leg| leg.points).collect())
        };
        let mut runs = Runs { legs, others: None, failed: Vec::new(), over_force: frequency.is_some() };
        if runs.mostly_regular() {
            let (others, failed) = OTHER_PHASES.into_par_iter().map(all).partition_map(|run| match run {
                Ok(points) => Either::Left(points),
                Err(error) => Either::Right(error),
            });
            let others: Vec<_> = others;
            (runs.others, runs.failed) = (Some(others).filter(|all| !all.is_empty()), failed);
        }
        Ok(runs)
    }

    /// Caution on sweeps from other phases that failed.
    pub fn starts_failed(&self) -> Option<Finding> {
        let why = self.failed.first()?.why();
        let found = Finding::caution("sweep-starts-failed").count("n", self.failed.len());
        Some(found.count("all", OTHER_PHASES.len()).name("why", why.trim_end_matches('.')))
    }

    /// Cautions on the largest amplitudes of masses, above `floor` (m), that belong to irregular motion.
    pub fn irregular_maxima(&self, floor: f64) -> Vec<Finding> {
        let unit = if self.over_force { "N" } else { "Hz" };
        let maximum = |(leg, mass): (&Leg, usize)| {
            let size = |p: &&Point| p.amplitudes()[mass];
            let largest = leg.points.iter().max_by(|a, b| size(a).total_cmp(&size(b)))?;
            let found = Finding::caution("sweep-maximum-irregular").count("mass", mass + 1);
            let found = found.name("direction", leg.direction.name()).number("amplitude", size(&largest));
            let found = found.number("at", self.value(largest)).name("unit", unit);
            (size(&largest) > floor && !largest.is_regular(floor)).then_some(found)
        };
        self.legs.iter().flat_map(|leg| [(leg, 0), (leg, 1)]).filter_map(maximum).collect()
    }

    /// The swept value of a point: its force in N or its frequency in Hz.
    fn value(&self, point: &Point) -> f64 {
        if self.over_force { point.force } else { point.frequency }
    }

    /// The sweeps from the start.
    pub fn legs(&self) -> impl Iterator<Item = &Leg> {
        self.legs.iter()
    }

    /// Their points.
    pub fn swept(&self) -> Swept {
        let of = |direction| {
            self.legs
                .iter()
                .find(|leg| leg.direction == direction)
                .map_or_else(Vec::new, |l| l.points.clone())
        };
        Swept { up: of(Direction::Up), down: of(Direction::Down) }
    }

    /// Whether more than half of the points are regular.
    fn mostly_regular(&self) -> bool {
        let floor = self.swept().floor();
        let points = || self.legs.iter().flat_map(|leg| &leg.points);
        2 * points().filter(|p| p.is_regular(floor)).count() > points().count()
    }

    /// Ranges in which the motion, where larger than `floor` (m), does not repeat within four cycles.
    pub fn irregular(&self, floor: f64) -> Vec<Range> {
        self.ranges(|_, points, i| !points[i].is_regular(floor))
    }

    /// Ranges in which a start at another phase leads to another regular motion; amplitudes below `floor` (m)
    /// are alike. `None` where no other start was made.
    pub fn by_chance(&self, floor: f64) -> Option<Vec<Range>> {
        let others = self.others.as_ref()?;
        let mut found = self.ranges(|leg, points, i| {
            let same = |other: &Point| {
                let pairs = points[i].amplitudes().into_iter().zip(other.amplitudes());
                pairs.into_iter().all(|(a, b)| (a - b).abs() <= (ALIKE * a.max(b)).max(floor))
            };
            let others = || others.iter().filter_map(|legs| legs[leg].get(i));
            points[i].is_regular(floor) && others().any(|p| p.is_regular(floor) && !same(p))
        });
        found.retain(|range| range.points >= FEWEST);
        Some(found)
    }

    /// Ranges of points for which `is` holds, given the leg, its points and the index.
    fn ranges(&self, is: impl Fn(usize, &[Point], usize) -> bool) -> Vec<Range> {
        let value = |p: &Point| self.value(p);
        let mut found: Vec<Range> = Vec::new();
        for (k, Leg { direction, points, .. }) in self.legs.iter().enumerate() {
            let (mut last, begun) = (None, found.len());
            for i in (0..points.len()).filter(|i| is(k, points, *i)) {
                let p = &points[i];
                let near = last.is_some_and(|last| i - last <= NEAR);
                last = Some(i);
                match found.get_mut(begun..).and_then(<[Range]>::last_mut).filter(|_| near) {
                    Some(range) => {
                        (range.to, range.points) = (value(p), range.points + 1);
                        (range.x1, range.x2) = (range.x1.max(p.x1), range.x2.max(p.x2));
                    }
                    None => found.push(Range {
                        direction: *direction,
                        from: value(p),
                        to: value(p),
                        points: 1,
                        x1: p.x1,
                        x2: p.x2,
                    }),
                }
            }
        }
        found
    }
}

/// Amplitudes that differ by less, over the larger, belong to one motion.
const ALIKE: f64 = 0.05;
/// Fewest points of a range in which motions coexist: at the edge of irregular motion single points differ.
const FEWEST: usize = 3;
/// Ranges that are fewer points apart are one.
const NEAR: usize = 4;

/// The points of one direction, and the motion after the end.
fn leg(points: Vec<Point>, motion: &mut dyn Motion, direction: Direction) -> Result<Leg> {
    let (frequency, phase, state) = (motion.frequency(), motion.phase(), motion.state());
    let portrait = Portrait::take(motion, &END)?;
    let relative_phase = points.last().and_then(|p| p.relative_phase);
    let end = End { direction, frequency, phase, state, regime: portrait.pattern.regime, relative_phase };
    Ok(Leg { direction, points, end, portrait })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::sweep::{Observable, Pace};
    use crate::model::{Rig, Simulation, Sine};
    use crate::record::Fact;
    use std::f64::consts::PI;

    /// Starts half a cycle later and beyond fail: two of the three other phases.
    #[test]
    fn starts_at_other_phases_that_fail_are_counted() {
        let (rig, start) = (Rig::thesis(), State::default());
        let make = |excitation: &Excitation, state: State, phase: f64| -> Result<Moving> {
            if state == start && phase >= PI {
                return Err(Error::refused("the masses stick."));
            }
            Ok(Box::new(Simulation::from_state(&rig, excitation, state, phase)?))
        };
        let pace = Pace::Steps { points: 2, settle: 5, measure: 5 };
        let plan = Plan { from: 3.0, to: 3.5, pace, observable: Observable::Fundamental };
        let excitation = Sine { force: 0.01, frequency: 3.0 }.into();
        let runs = |make: &(dyn Fn(&Excitation, State, f64) -> Result<Moving> + Sync)| {
            Runs::of(make, (start, 0.0), &excitation, &plan, None, &[&[Direction::Up]]).unwrap()
        };
        let found = runs(&make).starts_failed().unwrap();
        assert_eq!((found.get("n"), found.get("all")), (Some(2.0), Some(3.0)));
        assert_eq!(found.fact("why"), Some(&Fact::Name("the masses stick".to_owned())));
        let whole = |excitation: &Excitation, state: State, phase: f64| -> Result<Moving> {
            Ok(Box::new(Simulation::from_state(&rig, excitation, state, phase)?))
        };
        assert_eq!(runs(&whole).starts_failed(), None);
    }
}

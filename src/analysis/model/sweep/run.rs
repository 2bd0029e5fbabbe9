//! Runs of a sweep from its start, and from the same state at other phases of the excitation.

use super::Moving;
use crate::error::Result;
use crate::model::portrait::{Portrait, PortraitOptions};
use crate::model::sweep::{Plan, Point, Swept, in_phase};
use crate::model::{Excitation, Motion, Regime, State};
use crate::record::Direction;
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
    over_force: bool,
}

/// Sweeps a motion in one direction.
type Sweep<'a> = &'a dyn Fn(&mut dyn Motion, Direction) -> Result<Vec<Point>>;

impl Runs {
    /// Sweeps motions that `make` creates from an excitation and a shift of the start phase (rad), over the
    /// force at `frequency` (Hz) if that is given. A start from another phase that fails is left out. If at
    /// most half of the points are regular, no other phase is tried: irregular motions cannot be told
    /// apart.
    pub fn of(
        make: impl Fn(&Excitation, f64) -> Result<Moving> + Sync,
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
        let run = |(phase, directions): (f64, &[Direction])| -> Result<Vec<Leg>> {
            let first = if directions.first() == Some(&Direction::Down) { plan.to } else { plan.from };
            let mut motion = make(&at(first), phase * TAU)?;
            directions.iter().map(|direction| leg(&mut *motion, *direction, &points)).collect()
        };
        let legs = sweeps.par_iter().map(|s| run((0.0, s))).collect::<Result<Vec<_>>>()?.concat();
        let all = |phase: f64| -> Option<Vec<Vec<Point>>> {
            let legs: Vec<_> = sweeps.par_iter().map(|s| run((phase, s)).ok()).collect::<Option<_>>()?;
            Some(legs.into_iter().flatten().map(|leg| leg.points).collect())
        };
        let mut runs = Runs { legs, others: None, over_force: frequency.is_some() };
        if runs.mostly_regular() {
            runs.others = Some(OTHER_PHASES.into_par_iter().filter_map(all).collect());
        }
        Ok(runs)
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
        let value = |p: &Point| if self.over_force { p.force } else { p.frequency };
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

/// Sweeps in one direction, and reads the motion after the end.
fn leg(motion: &mut dyn Motion, direction: Direction, sweep: Sweep<'_>) -> Result<Leg> {
    let points = sweep(motion, direction)?;
    let (frequency, phase, state) = (motion.frequency(), motion.phase(), motion.state());
    let portrait = Portrait::take(motion, &END)?;
    let relative_phase = points.last().and_then(|p| p.relative_phase);
    let end = End { direction, frequency, phase, state, regime: portrait.pattern.regime, relative_phase };
    Ok(Leg { direction, points, end, portrait })
}

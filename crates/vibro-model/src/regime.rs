//! Regime of a motion: the number of impacts and cycles in its repeating pattern.
//!
//! States are compared: p impacts repeat if state and phase at each impact equal those at the p-th impact
//! before it. A count of impacts alone could not distinguish two different impacts in two cycles from one
//! impact in one cycle.

use super::flow::State;
use super::motion::{Event, Motion, Piece};
use serde::{Serialize, Serializer};
use serde_json::json;
use std::collections::VecDeque;
use std::f64::consts::{PI, TAU};
use std::fmt;
use std::ops::Range;
use vibro_record::Result;

/// Longest pattern that is searched, in impacts and in cycles.
pub const LONGEST: u32 = 32;
/// Two impacts are equal if their phases (in cycles) and states differ by less than this. States are
/// velocities and ω × displacements, divided by the largest speed.
pub const SAME: f64 = 1e-6;
/// A pattern counts as settling if its repetitions differ by less than this and the differences fall.
const SETTLING_DISTANCE: f64 = 1e-2;
/// Differences fall if the largest in each third of the watched impacts is at most this share of that in the
/// third before.
const FALLING_RATIO: f64 = 0.95;
/// Largest number of impacts in memory: ten times the longest pattern, to see whether differences fall.
const MOST_STRIKES: usize = 320;

/// Regime of a motion.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Regime {
    /// `impacts` impacts repeat every `cycles` cycles.
    Periodic {
        /// Impacts in the pattern.
        impacts: u32,
        /// Cycles of the excitation in the pattern.
        cycles: u32,
    },
    /// The masses do not meet.
    NoImpact,
    /// Chatter: the masses come to rest against each other by ever smaller impacts, and part again.
    Chatter {
        /// Cycles in the pattern; `None` where it does not repeat.
        cycles: Option<u32>,
    },
    /// No pattern of up to [`LONGEST`] impacts or cycles.
    Irregular,
}

impl fmt::Display for Regime {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Regime::Periodic { impacts, cycles } => write!(f, "{impacts}/{cycles}"),
            Regime::NoImpact => f.write_str("no impact"),
            Regime::Chatter { cycles: Some(cycles) } => write!(f, "chatter/{cycles}"),
            Regime::Chatter { cycles: None } => f.write_str("chatter"),
            Regime::Irregular => f.write_str("irregular"),
        }
    }
}

/// `{"impacts": p, "cycles": q}` for a pattern, else a word.
impl Serialize for Regime {
    fn serialize<S: Serializer>(&self, serializer: S) -> std::result::Result<S::Ok, S::Error> {
        match self {
            Regime::Periodic { impacts, cycles } => {
                json!({ "impacts": impacts, "cycles": cycles }).serialize(serializer)
            }
            other => serializer.collect_str(other),
        }
    }
}

/// An impact, with the values that are compared.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Strike {
    /// Time in s.
    pub time: f64,
    /// Phase of the excitation in rad.
    pub phase: f64,
    /// State just before a rigid impact; for a compliant contact, the state at its end.
    pub before: State,
    /// Impulse in N s; 0 where the masses begin to move together.
    pub impulse: f64,
    /// Approach speed in m/s.
    pub approach_velocity: f64,
}

impl Strike {
    /// Distance from another impact: the largest of the differences of the phase in cycles, and of velocities
    /// and ω × displacements divided by `speed`.
    fn distance(&self, other: &Strike, omega: f64, speed: f64) -> f64 {
        let turn = (self.phase - other.phase + PI).rem_euclid(TAU) - PI;
        let (a, b) = (&self.before, &other.before);
        let moved = [(a.x1 - b.x1) * omega, a.v1 - b.v1, a.v2 - b.v2];
        moved.iter().fold(turn.abs() / TAU, |far, d| far.max(d.abs() / speed))
    }
}

/// A regime, and how closely its pattern repeats.
#[derive(Debug, Clone, PartialEq)]
pub struct Pattern {
    /// The regime.
    pub regime: Regime,
    /// Whether the pattern repeats within [`SAME`]. Near the stability limit settling takes thousands of
    /// cycles, so a pattern is also reported unsettled, if its differences are below 1e-2 and fall.
    pub settled: bool,
    /// Largest difference between the last two repetitions, of phases (in cycles) and of states divided by
    /// the largest speed; `None` without a pattern.
    pub distance: Option<f64>,
    /// The impacts of the last repetition.
    pub strikes: Vec<Strike>,
}

/// Collects the impacts of a motion under an excitation of one frequency.
#[derive(Debug, Clone)]
pub struct Watch {
    frequency: f64,
    start: f64,
    now: f64,
    phase: f64,
    /// The last impacts, oldest first.
    pub(crate) strikes: VecDeque<Strike>,
    sticks: VecDeque<Strike>,
}

impl Watch {
    /// Watches `motion` from now on.
    pub fn new(motion: &dyn Motion) -> Watch {
        let (frequency, start, phase) = (motion.frequency(), motion.time(), motion.phase());
        let (strikes, sticks) = (VecDeque::with_capacity(MOST_STRIKES), VecDeque::new());
        Watch { frequency, start, now: start, phase, strikes, sticks }
    }

    /// Adds the next piece of the motion.
    pub fn take(&mut self, piece: &Piece<'_>) {
        self.now = piece.start + piece.duration;
        let (events, time, phase, impulse, approach_velocity) = match piece.event {
            Event::Impact(i) => (&mut self.strikes, i.time, i.phase, i.impulse, i.approach_velocity),
            Event::Stick => {
                let phase = self.phase + TAU * self.frequency * (self.now - self.start);
                (&mut self.sticks, self.now, phase, 0.0, 0.0)
            }
            _ => return,
        };
        if events.len() == MOST_STRIKES {
            events.pop_front();
        }
        let before = piece.path.state(piece.duration);
        events.push_back(Strike { time, phase, before, impulse, approach_velocity });
    }

    /// The regime of the motion, from all pieces added.
    pub fn pattern(&self) -> Pattern {
        let watched = self.now - self.start;
        let quiet = |strikes: &VecDeque<Strike>| {
            strikes.back().is_none_or(|last| self.now - last.time > watched / 2.0)
        };
        let pattern = |regime, settled| Pattern { regime, settled, distance: None, strikes: Vec::new() };
        let chatters = !quiet(&self.sticks);
        if !chatters && quiet(&self.strikes) {
            return pattern(Regime::NoImpact, self.strikes.is_empty());
        }
        let Some(found) = self.repeated(if chatters { &self.sticks } else { &self.strikes }) else {
            let regime = if chatters { Regime::Chatter { cycles: None } } else { Regime::Irregular };
            return pattern(regime, !chatters);
        };
        let Repeated { impacts, cycles, distance } = found;
        let (regime, strikes) = if chatters {
            (Regime::Chatter { cycles: Some(cycles) }, Vec::new())
        } else {
            let strikes = self.strikes.range(self.strikes.len() - impacts..).copied().collect();
            (Regime::Periodic { impacts: impacts as u32, cycles }, strikes)
        };
        Pattern { regime, settled: distance <= SAME, distance: Some(distance), strikes }
    }

    /// The shortest pattern that repeats or settles.
    fn repeated(&self, strikes: &VecDeque<Strike>) -> Option<Repeated> {
        let compared = ComparedStrikes::new(strikes, self.frequency);
        let longest = (LONGEST as usize).min(strikes.len() / 2);
        let repeats = |p| compared.last(p).filter(|r| r.distance <= SAME || compared.falls(p));
        let found = (1..=longest).find_map(repeats)?;
        // Two impacts that alternate about one, ever less, may pass the test for two before that for one.
        let left = compared.left(found.impacts);
        let part =
            |d: usize| Some(d).filter(|d| found.impacts.is_multiple_of(*d)).and_then(|d| compared.last(d));
        let shorter = (1..found.impacts).filter_map(part).find(|shorter| shorter.distance <= 2.0 * left);
        Some(shorter.unwrap_or(found))
    }
}

/// Impacts to be compared with each other.
struct ComparedStrikes<'a> {
    strikes: &'a VecDeque<Strike>,
    frequency: f64,
    speed: f64,
}

impl ComparedStrikes<'_> {
    fn new(strikes: &VecDeque<Strike>, frequency: f64) -> ComparedStrikes<'_> {
        let fastest = |v: f64, s: &Strike| v.max(s.before.v1.abs()).max(s.before.v2.abs());
        ComparedStrikes { strikes, frequency, speed: strikes.iter().fold(f64::MIN_POSITIVE, fastest) }
    }

    /// Largest distance of the impacts in `range` from those `p` impacts before.
    fn largest(&self, range: Range<usize>, p: usize) -> f64 {
        let omega = TAU * self.frequency;
        let far = |i: usize| self.strikes[i].distance(&self.strikes[i - p], omega, self.speed);
        range.map(far).fold(0.0, f64::max)
    }

    /// Compares the last `p` impacts with the `p` before them; `None` if they differ by more than
    /// [`SETTLING_DISTANCE`], or take no whole cycle or more than [`LONGEST`].
    fn last(&self, p: usize) -> Option<Repeated> {
        let n = self.strikes.len();
        // A quick test: the last impact alone rules out most patterns.
        if self.largest(n - 1..n, p) > SETTLING_DISTANCE {
            return None;
        }
        let cycles = ((self.strikes[n - 1].time - self.strikes[n - 1 - p].time) * self.frequency).round();
        let distance = self.largest(n - p..n, p);
        let counts = (1.0..=f64::from(LONGEST)).contains(&cycles) && distance <= SETTLING_DISTANCE;
        counts.then_some(Repeated { impacts: p, cycles: cycles as u32, distance })
    }

    /// Remaining change of the impacts of a pattern of `p`. If its differences fall by the ratio ρ from one
    /// repetition to the next, it is 1/(1 − ρ) times the last; ρ is that of the largest in both halves of the
    /// watched impacts, which cannot show a slower fall than over all their repetitions.
    fn left(&self, p: usize) -> f64 {
        let n = self.strikes.len();
        let half = ((n - p) / 2).max(1);
        let [before, last] = [p..n - half, n - half..n].map(|range| self.largest(range, p));
        let ratio = (last / before).powf(p as f64 / half as f64);
        let repetitions = n as f64 / p as f64;
        last * if ratio < 1.0 { (1.0 - ratio).recip().min(repetitions) } else { repetitions }
    }

    /// Whether the differences over `p` impacts fall. The largest of each third of the watched impacts are
    /// compared, so that oscillating differences (complex multipliers) also count.
    fn falls(&self, p: usize) -> bool {
        let n = self.strikes.len();
        let third = (n - p) / 3;
        let [a, b, c] = [3, 2, 1].map(|k| n - k * third).map(|from| self.largest(from..from + third, p));
        third >= p.max(3) && b <= FALLING_RATIO * a && c <= FALLING_RATIO * b
    }
}

/// A pattern that repeats.
struct Repeated {
    impacts: usize,
    cycles: u32,
    distance: f64,
}

/// Lets `motion` settle for `settle` cycles, watches it for `cycles` more, and returns its pattern.
///
/// # Errors
/// As [`Motion::advance`].
pub fn regime(motion: &mut dyn Motion, settle: u32, cycles: u32) -> Result<Pattern> {
    motion.advance(motion.time() + f64::from(settle) / motion.frequency(), &mut |_| {})?;
    let mut watch = Watch::new(motion);
    motion
        .advance(motion.time() + f64::from(cycles) / motion.frequency(), &mut |piece| watch.take(&piece))?;
    Ok(watch.pattern())
}

#[cfg(test)]
mod tests;

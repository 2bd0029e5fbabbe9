//! Crossings of a level in a sampled signal; edges of a reference signal; the turns between them: which are
//! whole, how fast, how evenly.

use super::faults::State;
use crate::Estimate;
use crate::mean::Mean;
use vibro_math::border;
use vibro_record::{Error, Result, median};

/// Intervals on each side whose median is the expected interval: a machine that runs up changes little over
/// them.
const AROUND: usize = 15;
/// An interval shorter than this fraction of the expected one ends in a false edge.
const SHORT: f64 = 0.6;
/// An interval longer than this many expected ones lacks edges.
const LONG: f64 = 1.5;
/// An interval longer than this many expected ones is a pause: edges are not counted across it.
const PAUSE: f64 = 4.0;

/// One turn: from an edge to the edge one turn of pulses later.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Turn {
    /// First edge, in samples from the first sample of the record.
    pub start: f64,
    /// Last edge, in samples from the first sample of the record.
    pub end: f64,
}

impl Turn {
    /// Whether no sample of the turn is lost.
    pub fn is_measured(self, states: &[State]) -> bool {
        !states[self.start as usize..=self.end.ceil() as usize].contains(&State::Lost)
    }
}

/// Edges numbered as an even series, since a pick-up misses pulses and picks up interference.
pub(crate) struct Numbered {
    /// Number and time in samples of each edge; a pause begins a new run.
    pub runs: Vec<Vec<(usize, f64)>>,
    /// Missing edges.
    pub missing: usize,
    /// False edges, which are ignored.
    pub extra: usize,
}

impl Numbered {
    /// Numbers each edge by the median interval around it. Of two edges within an interval, the one farther
    /// from its expected time is ignored.
    pub fn new(edges: &[f64]) -> Numbered {
        let intervals: Vec<f64> = edges.windows(2).map(|e| e[1] - e[0]).collect();
        let (mut missing, mut extra) = (0, 0);
        let mut runs = vec![edges.iter().take(1).map(|e| (0, *e)).collect::<Vec<(usize, f64)>>()];
        for (i, &edge) in edges.iter().enumerate().skip(1) {
            let near = i.saturating_sub(AROUND + 1)..(i + AROUND).min(intervals.len());
            let expected = median(&intervals[near]);
            let Some(run) = runs.last_mut() else { continue };
            let Some(&(place, last)) = run.last() else { continue };
            let ratio = |edge: f64| (edge - last) / expected;
            let off = |edge: f64| (ratio(edge) - steps(ratio(edge)) as f64).abs();
            let better = |next: &f64| next - edge < SHORT * expected && off(*next) < off(edge);
            if ratio(edge) < SHORT || edges.get(i + 1).is_some_and(better) {
                extra += 1;
            } else if ratio(edge) > PAUSE {
                runs.push(vec![(0, edge)]);
            } else {
                missing += steps(ratio(edge)) - 1;
                run.push((place + steps(ratio(edge)), edge));
            }
        }
        Numbered { runs, missing, extra }
    }
}

/// Number of intervals in a time of `ratio` expected intervals.
fn steps(ratio: f64) -> usize {
    if ratio > LONG { ratio.round() as usize } else { 1 }
}

/// The whole turns of a record.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Turns {
    /// Turns in which no edge is missing.
    pub whole: Vec<Turn>,
    /// Missing edges.
    pub missing: usize,
    /// False edges, which are ignored.
    pub extra: usize,
    /// Stretches without an edge: the machine stood still, or the reference was lost.
    pub pauses: usize,
}

impl Turns {
    /// Turns of `pulses` edges each. With several pulses, a pause loses which pulse is the first of a turn:
    /// then only the longest stretch between pauses is used.
    ///
    /// # Errors
    /// If there are fewer edges than a turn needs, or no whole turn between them.
    pub fn new(edges: &[f64], pulses: usize) -> Result<Turns> {
        let refused = |why: String| {
            let error = Error::refused(why).hint("check the reference channel, its edge and its level");
            Err(["reference", "edge", "pulses_per_turn", "level"].into_iter().fold(error, Error::setting))
        };
        if pulses == 0 || edges.len() <= pulses {
            let found = match edges.len() {
                0 => "no edge".to_owned(),
                1 => "one edge".to_owned(),
                n => format!("{n} edges"),
            };
            return refused(format!("{found} in the reference channel; a turn needs more than {pulses}"));
        }
        let Numbered { runs, missing, extra } = Numbered::new(edges);
        let whole = |run: &Vec<(usize, f64)>| -> Vec<Turn> {
            run.windows(pulses + 1)
                .filter(|w| w[0].0 % pulses == 0 && w[pulses].0 - w[0].0 == pulses)
                .map(|w| Turn { start: w[0].1, end: w[pulses].1 })
                .collect()
        };
        let stretches = runs.iter().map(whole);
        let whole = if pulses == 1 {
            stretches.flatten().collect()
        } else {
            stretches.max_by_key(Vec::len).unwrap_or_default()
        };
        if whole.is_empty() {
            return refused("no whole turn between the edges of the reference channel".to_owned());
        }
        Ok(Turns { whole, missing, extra, pauses: runs.len() - 1 })
    }

    /// Speed in turns a second at `rate` samples a second: the inverse of the mean duration of a turn. Also
    /// whether the durations drift so slowly that the uncertainty may be too small.
    ///
    /// The standard uncertainty combines that of a mean of serially correlated durations ([`Mean`]) and the
    /// uncertainty `edge` of an edge, in samples. Neighbouring durations share their edges, so only the first
    /// and the last edge of each stretch without a gap count. `None` for fewer than four turns.
    pub fn speed(&self, rate: f64, edge: f64) -> (Estimate, bool) {
        let durations: Vec<f64> = self.whole.iter().map(|t| t.end - t.start).collect();
        let mean = Mean::of(&durations);
        let stretches = 1 + self.whole.windows(2).filter(|t| t[0].end != t[1].start).count();
        let edges = edge * (2.0 * stretches as f64).sqrt() / durations.len() as f64;
        let std = mean.std.map(|s| rate / mean.value * s.hypot(edges) / mean.value);
        let method = "inverse mean duration of whole turns; serial correlation accounted for";
        (Estimate::new(rate / mean.value, std, "Hz", mean.n, method), mean.wanders)
    }
}

/// Which edge of the pulse counts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Edge {
    /// From low to high.
    Rising,
    /// From high to low.
    Falling,
}

/// Fraction of the pulse height by which the signal must pass the middle on both sides before an edge
/// counts: ringing of a pick-up is smaller.
const HYSTERESIS: f64 = 0.2;

/// An edge is sharp if two neighbouring samples lie at least this many margins of the hysteresis below and
/// above the middle: a step of 60 % of the height. The samples do not show where between them it lies.
const SHARP: f64 = 1.5;

/// Edges of a reference signal, and how well their times are known.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Edges {
    /// Positions in samples from the first sample.
    pub at: Vec<f64>,
    /// Whether most edges rise between two samples, so that their positions in between are unknown.
    pub sharp: bool,
    /// Mean step between the samples around an edge, in the unit of the signal.
    slope: f64,
}

impl Edges {
    /// Edges between two levels.
    ///
    /// An edge is where the signal crosses the middle of the two; it counts once it has come from beyond a
    /// fifth of the height on one side and goes beyond a fifth on the other. Noise may make it cross
    /// several times: then the mean of the first and the last crossing is taken.
    pub fn of(signal: &[f64], (low, high): (f64, f64), edge: Edge) -> Edges {
        let sign = if edge == Edge::Rising { 1.0 } else { -1.0 };
        let (middle, margin) = (0.5 * (low + high), HYSTERESIS * (high - low).abs());
        let (mut at, mut sharp, mut slopes) = (Vec::new(), 0, 0.0);
        // `crossed`: first and last crossing of an edge, and the samples on both sides of the last.
        let (mut armed, mut crossed) = (false, None::<(f64, f64, f64, f64)>);
        for (i, step) in signal.windows(2).enumerate() {
            let (from, to) = (sign * (step[0] - middle), sign * (step[1] - middle));
            if from < -margin {
                (armed, crossed) = (true, None);
            }
            if armed
                && from < 0.0
                && let Some(place) = between(signal, i, middle)
            {
                let first = crossed.map_or(place, |(first, ..)| first);
                crossed = Some((first, place, from, to));
            }
            if armed && to > margin {
                armed = false;
                if let Some((first, last, from, to)) = crossed.take() {
                    at.push(0.5 * (first + last));
                    sharp += usize::from(from < -SHARP * margin && to > SHARP * margin);
                    slopes += to - from;
                }
            }
        }
        Edges { sharp: 2 * sharp > at.len(), slope: slopes / at.len().max(1) as f64, at }
    }

    /// Standard uncertainty of an edge in samples, where the reference carries noise of standard deviation
    /// `noise`.
    pub fn std(&self, noise: f64) -> f64 {
        // A crossing at s between two samples weighs them 1 − s and s; (1 − s)² + s² has the mean 2/3.
        let variance = if self.slope > 0.0 { 2.0 / 3.0 * (noise / self.slope).powi(2) } else { 0.0 };
        (variance + if self.sharp { 1.0 / 12.0 } else { 0.0 }).sqrt()
    }
}

/// Lagrange's cubic through four samples at −1, 0, 1 and 2.
fn cubic([before, a, b, after]: [f64; 4], s: f64) -> f64 {
    let (m, p, q) = (s + 1.0, s - 1.0, s - 2.0);
    -before * s * p * q / 6.0 + a * m * p * q / 2.0 - b * m * s * q / 2.0 + after * m * s * p / 6.0
}

/// The four samples around the step from sample `i`; `None` at the ends of the record.
fn around(values: &[f64], i: usize) -> Option<[f64; 4]> {
    values.get(i.checked_sub(1)?..i + 3)?.try_into().ok()
}

/// Position in samples of the crossing of `level` between samples `i` and `i + 1`, on the cubic through the
/// four samples around it (a straight line beside the ends of the record and missing samples). `None` unless
/// the level lies between the two samples.
pub(super) fn between(values: &[f64], i: usize, level: f64) -> Option<f64> {
    let (a, b) = (values.get(i)? - level, values.get(i + 1)? - level);
    if !(a.is_finite() && b.is_finite()) || a == b || a * b > 0.0 {
        return None;
    }
    let Some(four) = around(values, i).filter(|four| four.iter().all(|v| v.is_finite())) else {
        return Some(i as f64 + a / (a - b));
    };
    let four = four.map(|v| v - level);
    // The cubic passes through both samples, so it changes its sign between 0 and 1.
    Some(i as f64 + border(0.0, 1.0, |s| cubic(four, s) * a > 0.0))
}

/// Value at a position between samples, on the cubic through the four samples around it; a straight line at
/// the ends. `None` outside the record.
pub(crate) fn value(values: &[f64], at: f64) -> Option<f64> {
    let i = at.floor();
    if i < 0.0 {
        return None;
    }
    let (i, s) = (i as usize, at - i);
    let a = *values.get(i)?;
    match (around(values, i), values.get(i + 1)) {
        (Some(four), _) => Some(cubic(four, s)),
        (None, Some(b)) => Some(a + s * (b - a)),
        (None, None) => (s == 0.0).then_some(a),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;
    use vibro_math::Noise;

    #[test]
    fn missing_and_extra_edges_and_pauses() {
        let mut edges: Vec<f64> = (0..40).map(|k| f64::from(k) * 100.0).collect();
        edges.remove(10);
        edges.insert(20, 2050.0);
        edges.extend((0..5).map(|k| 9000.0 + f64::from(k) * 100.0));
        let turns = Turns::new(&edges, 1).unwrap();
        assert_eq!((turns.missing, turns.extra, turns.pauses), (1, 1, 1));
        // 39 intervals less the two at the missing edge, and 4 after the pause.
        assert_eq!(turns.whole.len(), 37 + 4);
        assert!(turns.whole.iter().all(|t| t.end - t.start == 100.0));
        let speed = turns.speed(5000.0, 0.1).0;
        // Three stretches without a gap, each with two edges.
        let std = 50.0 * 6f64.sqrt() * 0.1 / 41.0 / 100.0;
        assert!(speed.value == 50.0 && (speed.std.unwrap() / std - 1.0).abs() < 1e-12, "{speed:?}");
        // Two pulses a turn: the turns at the missing edge are lost, the others keep their edges. After the
        // pause it is unknown which pulse is the first of a turn.
        let pairs = Turns::new(&edges, 2).unwrap();
        assert!(pairs.whole.iter().all(|t| t.end - t.start == 200.0 && t.start % 200.0 == 0.0));
        // 19 pairs less the two that meet at the missing edge; 2 after the pause are left out.
        assert_eq!(pairs.whole.len(), 17);
    }

    #[test]
    fn too_few_edges_are_refused_by_name() {
        let why = |edges: &[f64], pulses| Turns::new(edges, pulses).unwrap_err().to_string();
        assert!(why(&[], 1).starts_with("no edge"));
        assert!(why(&[5.0], 1).starts_with("one edge"));
        assert!(why(&[5.0, 6.0], 2).starts_with("2 edges"));
        assert!(why(&[5.0, 6.0], usize::MAX - 1).starts_with("2 edges"));
        assert!(Turns::new(&[5.0, 6.0], 0).is_err() && Turns::new(&[5.0, 6.0], usize::MAX).is_err());
    }

    #[test]
    fn jitter_of_edges_telescopes() {
        let mut noise = Noise::new(11);
        let mut uniform = || noise.uniform() - 0.5;
        // Edges of n turns that jitter by σ = 1/√12: the mean duration by √2 σ/n. Each of K cosines sees the
        // jitter of the first and of the last edge whole and that between by πj/n: E c_j² = (2/n) σ²
        // (2 + π²j²/(2n)), which is 2 (1 + π²(K + 1)(2K + 1)/(24 n)) times the true variance, and
        // K/(K − 2) of Student's distribution; K = 6 at 60 and 19 at 1000. Sums of independent durations
        // would be √n, 8 and 32 times the truth.
        for (n, cosines) in [(60, 6.0), (1000, 19.0)] {
            let truth = (2.0f64 / 12.0).sqrt() / f64::from(n);
            let share = 1.0 + PI * PI * (cosines + 1.0) * (2.0 * cosines + 1.0) / (24.0 * f64::from(n));
            let expected = (2.0 * share * cosines / (cosines - 2.0)).sqrt();
            let squares: f64 = (0..200)
                .map(|_| {
                    let edges: Vec<f64> = (0..=n).map(|k| f64::from(k) * 100.0 + uniform()).collect();
                    let speed = Turns::new(&edges, 1).unwrap().speed(1e4, 0.0).0;
                    (speed.std.unwrap() / truth / (1e4 / 100.0 / 100.0)).powi(2)
                })
                .sum();
            let found = (squares / 200.0).sqrt();
            println!("{n} turns with edges that jitter: {found:.2} times the truth, {expected:.2} expected");
            // Two edges, the same for all cosines, make the variance of each case scatter by 1; 200 cases: 7
            // % and half of it in the root; three times that.
            assert!((found / expected - 1.0).abs() < 0.11 && found < 2.4, "{found} {expected}");
        }
    }

    #[test]
    fn false_edges_anywhere_in_a_turn_are_passed_over() {
        // Turns of 100 samples with false edges in any part of a turn but its middle: 149 turns, as without
        // them.
        for part in [0.05, 0.2, 0.45, 0.55, 0.65, 0.7, 0.8, 0.95] {
            let mut edges: Vec<f64> =
                (0..150).map(|k| f64::from(k) * 100.0 + f64::from(k * k % 7) * 0.1).collect();
            for k in [0.0, 40.0, 90.0, 91.0, 148.0] {
                edges.push(100.0 * (k + part));
            }
            edges.sort_by(f64::total_cmp);
            let turns = Turns::new(&edges, 1).unwrap();
            assert_eq!(
                (turns.whole.len(), turns.extra, turns.missing, turns.pauses),
                (149, 5, 0, 0),
                "{part}"
            );
            assert!(turns.whole.iter().all(|t| (t.end - t.start - 100.0).abs() < 0.7), "{part}");
        }
        // A false edge 0.45 turns after a missing one.
        let mut edges: Vec<f64> = (0..40).map(|k| f64::from(k) * 100.0).collect();
        edges[21] = 2145.0;
        let turns = Turns::new(&edges, 1).unwrap();
        assert_eq!((turns.whole.len(), turns.extra, turns.missing), (37, 1, 1));
        assert!(turns.whole.iter().all(|t| t.end - t.start == 100.0));
    }

    #[test]
    fn scatter_of_durations_counts_whole() {
        let mut noise = Noise::new(7);
        let mut at = 0.0;
        let edges: Vec<f64> = (0..=1000)
            .map(|_| {
                at += 99.5 + noise.uniform();
                at
            })
            .collect();
        let speed = Turns::new(&edges, 1).unwrap().speed(1e4, 0.0).0;
        let expected = (1.0f64 / 12.0 / 1000.0).sqrt() / 100.0 * 100.0 * (19.0f64 / 17.0).sqrt();
        // 19 squares scatter by √(2/19), half of it in the root; three times that.
        assert!((speed.std.unwrap() / expected - 1.0).abs() < 0.49, "{speed:?} {expected}");
    }
}

#[cfg(test)]
mod edges {
    use super::*;

    fn pulses(rate: f64, shift: f64) -> (Vec<f64>, Vec<f64>) {
        let (period, n) = (737.3 / rate, 20_000);
        let truth: Vec<f64> = (0..27).map(|k| (f64::from(k) + shift) * period * rate).collect();
        let rise = |s: f64| 0.5 + 0.5 * (s / 4.0).tanh();
        let values = (0..n)
            .map(|i| truth.iter().map(|t| rise(f64::from(i) - t) - rise(f64::from(i) - t - 60.0)).sum())
            .collect();
        (values, truth)
    }

    fn found(values: &[f64], edge: Edge) -> Edges {
        Edges::of(values, (0.0, 1.0), edge)
    }

    #[test]
    fn edges_are_where_they_are() {
        let (values, truth) = pulses(102.4e3, 0.37);
        let whole = found(&values, Edge::Rising);
        assert_eq!(whole.at.len(), truth.len());
        for (found, truth) in whole.at.iter().zip(&truth) {
            // The fourth derivative of tanh(s/4)/2 is at most 4.1/2/4⁴ = 0.008; a cubic through samples at a
            // distance of 1 is off by 9/16/24 of it, 2e-4, and the slope there is 1/8.
            assert!((found - truth).abs() < 1.6e-3, "{found} {truth}");
        }
        let falling = found(&values, Edge::Falling);
        for (found, truth) in falling.at.iter().zip(&truth) {
            assert!((found - truth - 60.0).abs() < 1.6e-3);
        }
        assert!(!whole.sharp && (whole.slope - 0.125).abs() < 0.01);
    }

    #[test]
    fn chatter_missing_samples_and_half_pulses_are_no_edges() {
        let half = [0.0, 0.0, 0.6, 0.0, 0.0];
        let chatter = [0.0, 0.0, 0.55, 0.45, 0.6, 1.0, 1.0, 0.0];
        let lost = [0.0, 0.0, f64::NAN, 1.0, 1.0, 0.0];
        let found = found(&[&half[..], &chatter, &lost].concat(), Edge::Rising);
        assert_eq!(found.at.len(), 1, "{found:?}");
        // Between the crossing in the second and the one in the fourth step of the chatter.
        assert!(found.at[0] > 6.5 && found.at[0] < 8.7, "{found:?}");
        let sharp = Edges::of(&[0.0, 0.0, 1.0, 1.0, 0.0, 0.0, 1.0, 1.0], (0.0, 1.0), Edge::Rising);
        assert!(sharp.sharp && (sharp.std(0.0) - 12f64.sqrt().recip()).abs() < 1e-12);
    }
}

#[cfg(test)]
mod crossings {
    use super::*;

    #[test]
    fn a_cubic_is_crossed_where_it_is_crossed() {
        let cubic = |t: f64| 0.1 * t * t * t - 0.4 * t * t + 2.0 * t - 3.0;
        let values: Vec<f64> = (0..6).map(|i| cubic(f64::from(i))).collect();
        let at = between(&values, 1, 0.0).unwrap();
        // Exact but for the halving: 2⁻³¹ of a sample times the slope of about 2.
        assert!(cubic(at).abs() < 2e-9, "{at}");
        assert!((value(&values, 2.3).unwrap() - cubic(2.3)).abs() < 1e-14);
        assert_eq!(between(&values, 3, 0.0), None);
        assert_eq!(between(&values, 9, 0.0), None);
        assert_eq!(
            (value(&values, 5.0), value(&values, 5.5), value(&values, -0.5)),
            (Some(values[5]), None, None)
        );
    }

    #[test]
    fn missing_neighbours_leave_a_straight_line() {
        assert_eq!(between(&[f64::NAN, 0.0, 4.0, 9.0], 1, 1.0), Some(1.25));
        assert_eq!(between(&[0.0, f64::NAN], 0, 1.0), None);
        assert_eq!(value(&[0.0, 2.0], 0.5), Some(1.0));
    }
}

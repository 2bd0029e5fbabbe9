//! From reference edges to turns: which are whole, how fast, how evenly.

use super::survey::median;
use crate::Estimate;
use crate::mean::Mean;
use vibro_record::{Error, Result};

/// Neighbours on each side whose median is the expected interval: a machine that runs up changes little over them.
const AROUND: usize = 15;
/// An interval shorter than this part of the expected one ends in a false edge; one longer than the second lacks edges.
const SHORT: f64 = 0.6;
const LONG: f64 = 1.5;
/// Beyond this many intervals the machine stood still, and edges cannot be counted on.
const PAUSE: f64 = 4.0;

/// One turn, from an edge to the edge that is as many pulses later as there are in a turn.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Turn {
    /// First edge, in samples from the first sample of the record.
    pub start: f64,
    /// Last edge.
    pub end: f64,
}

/// Edges with their places in an even series: a pick-up misses pulses and catches sparks.
pub(crate) struct Numbered {
    /// Place and time of each edge; a pause begins a new run.
    pub runs: Vec<Vec<(usize, f64)>>,
    /// Missing edges.
    pub missing: usize,
    /// False edges, which are ignored.
    pub extra: usize,
}

impl Numbered {
    /// Numbers edges, each by the median interval around it. Of two edges within an interval the one farther from where the edge before lets
    /// it be expected is ignored.
    pub fn new(edges: &[f64]) -> Numbered {
        let intervals: Vec<f64> = edges.windows(2).map(|e| e[1] - e[0]).collect();
        let (mut missing, mut extra) = (0, 0);
        let mut runs = vec![edges.iter().take(1).map(|e| (0, *e)).collect::<Vec<(usize, f64)>>()];
        for (i, &edge) in edges.iter().enumerate().skip(1) {
            let near = i.saturating_sub(AROUND + 1)..(i + AROUND).min(intervals.len());
            let expected = median(intervals[near].iter().copied());
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

/// Intervals in a time of so many expected ones.
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
    /// Stretches without an edge in which the machine stood still, or the reference was lost.
    pub pauses: usize,
}

impl Turns {
    /// Turns of `pulses` edges each. With several pulses a pause loses which of them comes first: then the longest stretch between
    /// pauses is all that is taken.
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

    /// Turns a second at `rate` samples a second, the inverse of the mean duration of a turn; and whether the durations change so slowly
    /// that its uncertainty may be too small.
    ///
    /// The standard uncertainty is that of the mean of durations that may depend on each other ([`Mean`]), and of the uncertainty
    /// `edge` of an edge, in samples: durations that follow each other share their edges, so only the first and the last edge of each
    /// stretch without a gap count. `None` for fewer than four turns.
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
#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    #[test]
    fn missing_and_extra_edges_and_pauses() {
        let mut edges: Vec<f64> = (0..40).map(|k| f64::from(k) * 100.0).collect();
        edges.remove(10);
        edges.insert(20, 2050.0);
        edges.extend((0..5).map(|k| 9000.0 + f64::from(k) * 100.0));
        let turns = Turns::new(&edges, 1).unwrap();
        assert_eq!((turns.missing, turns.extra, turns.pauses), (1, 1, 1));
        // 39 intervals less the two at the missing edge, and 4 behind the pause.
        assert_eq!(turns.whole.len(), 37 + 4);
        assert!(turns.whole.iter().all(|t| t.end - t.start == 100.0));
        let speed = turns.speed(5000.0, 0.1).0;
        // Three stretches without a gap, each with two edges.
        let std = 50.0 * 6f64.sqrt() * 0.1 / 41.0 / 100.0;
        assert!(speed.value == 50.0 && (speed.std.unwrap() / std - 1.0).abs() < 1e-12, "{speed:?}");
        // Two pulses a turn: the turns at the missing edge are lost, the pairs stay as they were, and behind the pause nobody
        // knows which pulse is the first of a turn.
        let pairs = Turns::new(&edges, 2).unwrap();
        assert!(pairs.whole.iter().all(|t| t.end - t.start == 200.0 && t.start % 200.0 == 0.0));
        // 19 pairs less the two that meet at the missing edge; 2 behind the pause are left out.
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
        let mut state = 11u64;
        let mut uniform = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            (state >> 11) as f64 / (1u64 << 53) as f64 - 0.5
        };
        // Edges of n turns that jitter by σ = 1/√12: the mean duration by √2 σ/n. Each of K cosines sees the jitter of the first and of
        // the last edge whole and that between by πj/n: E c_j² = (2/n) σ² (2 + π²j²/(2n)), which is 2 (1 + π²(K + 1)(2K + 1)/(24 n)) times the
        // true variance, and K/(K − 2) of Student's distribution; K = 6 at 60 and 19 at 1000. Sums of independent durations would be √n, 8 and 32 times the truth.
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
            // Two edges, the same for all cosines, make the variance of each case scatter by 1; 200 cases: 7 % and half of it in the root;
            // three times that.
            assert!((found / expected - 1.0).abs() < 0.11 && found < 2.4, "{found} {expected}");
        }
    }

    #[test]
    fn false_edges_anywhere_in_a_turn_are_passed_over() {
        // Turns of 100 with their third in each place but one half: 148 turns, as without the false edges.
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
        // A false edge at 1.45 where the edge at 1 is missing.
        let mut edges: Vec<f64> = (0..40).map(|k| f64::from(k) * 100.0).collect();
        edges[21] = 2145.0;
        let turns = Turns::new(&edges, 1).unwrap();
        assert_eq!((turns.whole.len(), turns.extra, turns.missing), (37, 1, 1));
        assert!(turns.whole.iter().all(|t| t.end - t.start == 100.0));
    }

    #[test]
    fn scatter_of_durations_counts_whole() {
        let mut noise = 7u64;
        let mut at = 0.0;
        let edges: Vec<f64> = (0..=1000)
            .map(|_| {
                noise = noise.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
                at += 100.0 + (noise >> 11) as f64 / (1u64 << 53) as f64 - 0.5;
                at
            })
            .collect();
        let speed = Turns::new(&edges, 1).unwrap().speed(1e4, 0.0).0;
        let expected = (1.0f64 / 12.0 / 1000.0).sqrt() / 100.0 * 100.0 * (19.0f64 / 17.0).sqrt();
        // 19 squares scatter by √(2/19), half of it in the root; three times that.
        assert!((speed.std.unwrap() / expected - 1.0).abs() < 0.49, "{speed:?} {expected}");
    }
}

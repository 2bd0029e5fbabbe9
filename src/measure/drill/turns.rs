//! From reference edges to turns: which are whole, how fast, how evenly.

use super::survey::median;
use crate::error::{Error, Result};
use crate::measure::Estimate;

/// Neighbours on each side whose median is the interval to be expected.
const AROUND: usize = 15;
/// An interval shorter than this part of its neighbours ends in an edge too many; one longer than the second lacks edges.
const SHORT: f64 = 0.6;
const LONG: f64 = 1.5;
/// Beyond this many intervals the machine stood still.
const PAUSE: f64 = 4.0;

/// One turn, from an edge to the edge that is as many pulses later as there are in a turn.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Turn {
    /// First edge, in samples from the first sample of the record.
    pub start: f64,
    /// Last edge.
    pub end: f64,
}

/// The whole turns of a record.
#[derive(Debug, Clone, PartialEq)]
pub struct Turns {
    /// Turns in which no edge is missing.
    pub turns: Vec<Turn>,
    /// Edges that are not there.
    pub missing: usize,
    /// Edges that should not be there; they are passed over.
    pub extra: usize,
    /// Stretches without an edge in which the machine stood still, or the reference was lost.
    pub pauses: usize,
    /// Turns that are left out because a pause lies between them and the rest.
    pub apart: usize,
}

/// Edges with their places in an even series.
pub(crate) struct Numbered {
    /// Place and time of each edge; a pause begins a new run.
    pub(crate) runs: Vec<Vec<(usize, f64)>>,
    /// Edges that are not there.
    pub(crate) missing: usize,
    /// Edges that should not be there; they are passed over.
    pub(crate) extra: usize,
    /// Stretches without an edge.
    pub(crate) pauses: usize,
}

impl Numbered {
    /// Numbers edges, each by the median interval around it.
    pub(crate) fn new(edges: &[f64]) -> Numbered {
        let intervals: Vec<f64> = edges.windows(2).map(|e| e[1] - e[0]).collect();
        let (mut missing, mut extra, mut pauses) = (0, 0, 0);
        let mut runs: Vec<Vec<(usize, f64)>> = vec![edges.iter().take(1).map(|e| (0, *e)).collect()];
        for (i, &edge) in edges.iter().enumerate().skip(1) {
            let near =
                intervals[(i - 1).saturating_sub(AROUND)..(i + AROUND).min(intervals.len())].iter().copied();
            let (Some(run), expected) = (runs.last_mut(), median(near)) else { continue };
            let Some(&(place, last)) = run.last() else { continue };
            let ratio = (edge - last) / expected;
            if ratio < SHORT {
                extra += 1;
            } else if ratio > PAUSE {
                pauses += 1;
                runs.push(vec![(0, edge)]);
            } else {
                let steps = if ratio > LONG { ratio.round() as usize } else { 1 };
                missing += steps - 1;
                run.push((place + steps, edge));
            }
        }
        Numbered { runs, missing, extra, pauses }
    }
}

impl Turns {
    /// Turns of `pulses` edges each. With several pulses nobody knows behind a pause which of them comes first: then the
    /// longest stretch between pauses is all that is taken.
    ///
    /// # Errors
    /// If there is no whole turn.
    pub fn new(edges: &[f64], pulses: usize) -> Result<Turns> {
        let needed = format!("a turn needs {}", pulses + 1);
        let hint = "check --reference, --edge, --pulses-per-turn and --level, the level of the edge";
        match edges.len() {
            0 => return Err(Error::refused("no edge in the reference channel").hint(hint)),
            1 => {
                return Err(Error::refused(format!("one edge in the reference channel; {needed}")).hint(hint));
            }
            n if n <= pulses => {
                return Err(
                    Error::refused(format!("{n} edges in the reference channel; {needed}")).hint(hint)
                );
            }
            _ => {}
        }
        let Numbered { runs, missing, extra, pauses } = Numbered::new(edges);
        let whole = |run: &Vec<(usize, f64)>| -> Vec<Turn> {
            run.windows(pulses + 1)
                .filter(|w| w[0].0 % pulses == 0 && w[pulses].0 - w[0].0 == pulses)
                .map(|w| Turn { start: w[0].1, end: w[pulses].1 })
                .collect()
        };
        let stretches: Vec<Vec<Turn>> = runs.iter().map(whole).collect();
        let all: usize = stretches.iter().map(Vec::len).sum();
        let turns = if pulses == 1 {
            stretches.concat()
        } else {
            stretches.into_iter().max_by_key(Vec::len).unwrap_or_default()
        };
        if turns.is_empty() {
            return Err(Error::refused("no whole turn between the edges of the reference channel").hint(hint));
        }
        Ok(Turns { apart: all - turns.len(), turns, missing, extra, pauses })
    }

    /// Turns a second at `rate` samples a second: the inverse of the mean duration of a turn.
    ///
    /// The standard uncertainty is that of the mean of durations that depend on each other: their long-run variance with
    /// Bartlett's weights up to the cube root of their number (W. Newey & K. West, Econometrica 55 (1987) 703), and at least
    /// what the uncertainty `edge` of the first and the last edge, in samples, leaves open.
    pub fn speed(&self, rate: f64, edge: f64) -> Estimate {
        let durations: Vec<f64> = self.turns.iter().map(|t| t.end - t.start).collect();
        let n = durations.len() as f64;
        let mean = durations.iter().sum::<f64>() / n;
        let method = "inverse mean duration of whole turns; serial correlation accounted for";
        let variance = if durations.len() < 4 { f64::NAN } else { mean_variance(&durations, mean) };
        let variance = variance.max(2.0 * edge * edge / (n * n)) + 0.0 * variance;
        Estimate::new(rate / mean, Some(rate / mean * variance.sqrt() / mean), "Hz", durations.len(), method)
    }

    /// Speed of each turn in Hz.
    pub fn speeds(&self, rate: f64) -> impl Iterator<Item = f64> {
        self.turns.iter().map(move |t| rate / (t.end - t.start))
    }
}

/// Variance of the mean of values that may depend on their neighbours.
pub(super) fn mean_variance(values: &[f64], mean: f64) -> f64 {
    let n = values.len() as f64;
    let reach = n.cbrt().floor() as usize;
    let covariance =
        |lag: usize| values.iter().zip(&values[lag..]).map(|(a, b)| (a - mean) * (b - mean)).sum::<f64>() / n;
    // Where no neighbour is seen to matter, sums over neighbours would add nothing but their own scatter.
    let independent = (1..=reach).all(|k| covariance(k).abs() < 3.0 / n.sqrt() * covariance(0));
    let reach = if independent { 0 } else { reach };
    let weighted = |k: usize| 2.0 * (1.0 - k as f64 / (reach + 1) as f64) * covariance(k);
    let long_run = covariance(0) + (1..=reach).map(weighted).sum::<f64>();
    // Deviations from the mean of the sample are smaller than those from the true one.
    long_run.max(0.0) / n / (1.0 - (reach + 1) as f64 / n)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn missing_and_extra_edges_and_pauses() {
        let mut edges: Vec<f64> = (0..40).map(|k| f64::from(k) * 100.0).collect();
        edges.remove(10);
        edges.insert(20, 2050.0);
        edges.extend((0..5).map(|k| 9000.0 + f64::from(k) * 100.0));
        let turns = Turns::new(&edges, 1).unwrap();
        assert_eq!((turns.missing, turns.extra, turns.pauses), (1, 1, 1));
        // 39 intervals less the two at the missing edge, and 4 behind the pause.
        assert_eq!(turns.turns.len(), 37 + 4);
        assert!(turns.turns.iter().all(|t| t.end - t.start == 100.0));
        let speed = turns.speed(5000.0, 0.1);
        assert_eq!((speed.value, speed.std), (50.0, Some(50.0 * 2f64.sqrt() * 0.1 / 41.0 / 100.0)));
        // Two pulses a turn: the turns at the missing edge are lost, the pairs stay as they were, and behind the pause nobody
        // knows which pulse is the first of a turn.
        let pairs = Turns::new(&edges, 2).unwrap();
        assert!(pairs.turns.iter().all(|t| t.end - t.start == 200.0 && t.start % 200.0 == 0.0));
        // 19 pairs less the two that meet at the missing edge; 2 behind the pause are left out.
        assert_eq!((pairs.turns.len(), pairs.apart, turns.apart), (17, 2, 0));
    }

    #[test]
    fn too_few_edges_are_refused_by_name() {
        let why = |edges: &[f64], pulses| Turns::new(edges, pulses).unwrap_err().to_string();
        assert!(why(&[], 1).starts_with("no edge"));
        assert!(why(&[5.0], 1).starts_with("one edge"));
        assert!(why(&[5.0, 6.0], 2).starts_with("2 edges"));
    }

    #[test]
    fn jitter_of_edges_telescopes_and_scatter_of_durations_does_not() {
        let mut state = 11u64;
        let mut uniform = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            (state >> 11) as f64 / (1u64 << 53) as f64 - 0.5
        };
        let jitter: Vec<f64> = (0..=1000).map(|k| f64::from(k) * 100.0 + uniform()).collect();
        let steps: Vec<f64> = (0..1000).map(|_| 100.0 + uniform()).collect();
        let differences: Vec<f64> = jitter.windows(2).map(|w| w[1] - w[0]).collect();
        let mean = |v: &[f64]| v.iter().sum::<f64>() / v.len() as f64;
        let independent = mean_variance(&steps, mean(&steps)) * 1000.0;
        // 1/12 for uniform steps; Bartlett's sum over 10 lags would scatter by √(4·10/3/1000) = 12 %; three times that.
        assert!((independent * 12.0 - 1.0).abs() < 0.36, "{independent}");
        // Edges that jitter: 1/6 a step if they were independent, a tenth of it or less as they are.
        assert!(mean_variance(&differences, mean(&differences)) * 1000.0 < 0.1 / 6.0 * 1.5);
    }
}

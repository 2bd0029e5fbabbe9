//! Impacts against the cycle of the excitation: phase, and impacts per cycle.

use super::burst::median;
use crate::error::{Error, Result};
use serde::Serialize;
use std::f64::consts::TAU;

/// Impacts per excitation cycles, in lowest terms.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct PerCycle {
    /// Impacts…
    pub impacts: usize,
    /// … in this many excitation cycles.
    pub cycles: usize,
}

/// Mean phase of one impact of the pattern.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Phase {
    /// Circular mean, in cycles from 0 to the cycles of the pattern.
    pub mean: f64,
    /// Circular standard deviation of single impacts, in cycles.
    pub spread: f64,
    /// Impacts behind it.
    pub n: usize,
}

/// Most impacts and cycles of a pattern.
const LARGEST: usize = 8;
/// A pattern repeats where n impacts take m cycles within this part of a cycle (root mean square).
pub const REPEATS: f64 = 0.1;
/// The rate of impacts must agree with a fraction within this part of it, and twice its uncertainty.
pub const FITS: f64 = 0.02;

/// The simplest fraction n/m of impacts per cycle that the impacts repeat, `None` where none up to 8/8 does: irregular.
///
/// `cycles` are the times of the impacts counted in excitation cycles, `rate` impacts a cycle with its standard uncertainty.
pub fn per_cycle(cycles: &[f64], rate: f64, std: f64) -> Option<PerCycle> {
    let mut fractions: Vec<PerCycle> = (1..=LARGEST)
        .flat_map(|cycles| (1..=LARGEST).map(move |impacts| PerCycle { impacts, cycles }))
        .filter(|f| (2..=f.impacts.min(f.cycles)).all(|d| f.impacts % d != 0 || f.cycles % d != 0))
        .collect();
    fractions.sort_by_key(|f| (f.impacts + f.cycles, f.cycles));
    let std = if std.is_finite() { std } else { 0.0 };
    fractions.into_iter().find(|f| {
        let fraction = f.impacts as f64 / f.cycles as f64;
        let spans: Vec<f64> = cycles.windows(f.impacts + 1).map(|w| w[f.impacts] - w[0]).collect();
        if spans.len() < 2 || (rate - fraction).abs() > FITS * fraction + 2.0 * std {
            return false;
        }
        let off: Vec<f64> = spans.iter().map(|s| (s - f.cycles as f64).powi(2)).collect();
        // Spans over a missed impact are the few that are far off; the median knows them not. √(median of χ²₁) = 0.6745.
        (median(&off) / 0.454_936).sqrt() <= REPEATS
    })
}

/// Phases of the impacts in a pattern of `pattern.cycles` cycles, one a place of the pattern.
///
/// Impacts are told apart by their phase: the widest pauses between phases part the places.
pub fn phases(cycles: &[f64], pattern: PerCycle) -> Vec<Phase> {
    let length = pattern.cycles as f64;
    let mut phase: Vec<f64> = cycles.iter().map(|c| c.rem_euclid(length)).collect();
    phase.sort_by(f64::total_cmp);
    if phase.is_empty() {
        return Vec::new();
    }
    let gap = |i: usize| (phase[(i + 1) % phase.len()] - phase[i]).rem_euclid(length);
    let mut cuts: Vec<usize> = (0..phase.len()).collect();
    cuts.sort_by(|a, b| gap(*b).total_cmp(&gap(*a)));
    cuts.truncate(pattern.impacts);
    cuts.sort_unstable();
    let mut places: Vec<Phase> = Vec::new();
    for (k, cut) in cuts.iter().enumerate() {
        let from = cut + 1;
        let to = cuts.get(k + 1).map_or(cuts[0] + 1 + phase.len(), |next| next + 1);
        let members: Vec<f64> = (from..to).map(|i| phase[i % phase.len()]).collect();
        places.push(circular(&members, length));
    }
    places.sort_by(|a, b| a.mean.total_cmp(&b.mean));
    places
}

/// Circular mean and standard deviation (Mardia 1972) on a circle of `length`.
fn circular(values: &[f64], length: f64) -> Phase {
    let n = values.len() as f64;
    let (s, c) = values.iter().fold((0.0, 0.0), |(s, c), v| {
        let (y, x) = (TAU * v / length).sin_cos();
        (s + y / n, c + x / n)
    });
    let spread = (-2.0 * s.hypot(c).min(1.0).ln()).sqrt() * length / TAU;
    Phase { mean: (s.atan2(c) / TAU * length).rem_euclid(length), spread, n: values.len() }
}

/// Rising edges of a reference channel, in samples: where it passes the middle of its range, with a quarter of the range as hysteresis.
///
/// # Errors
/// Where there are fewer than two.
pub fn edges(reference: &[f64]) -> Result<Vec<f64>> {
    let (low, high) =
        reference.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(*v), h.max(*v)));
    let (middle, arm) = (f64::midpoint(low, high), 0.125 * (high - low));
    let mut edges = Vec::new();
    let (mut armed, mut crossing) = (false, None);
    for (i, pair) in reference.windows(2).enumerate() {
        if pair[0] < middle - arm {
            armed = true;
        }
        if armed && pair[0] < middle && pair[1] >= middle {
            crossing = Some(i as f64 + (middle - pair[0]) / (pair[1] - pair[0]));
        }
        if armed && pair[1] > middle + arm {
            edges.extend(crossing.take());
            armed = false;
        }
    }
    if edges.len() < 2 {
        return Err(Error::refused(format!(
            "the reference channel has {} rising edge{}: a cycle needs two",
            edges.len(),
            if edges.len() == 1 { "" } else { "s" }
        ))
        .hint("choose another --reference, or give --excitation in Hz"));
    }
    Ok(edges)
}

/// Position `t` counted in cycles between `edges`; beyond the first and last by the mean cycle.
pub fn counted(t: f64, edges: &[f64]) -> f64 {
    let after = edges.partition_point(|e| *e <= t);
    match (after.checked_sub(1).and_then(|i| edges.get(i)), edges.get(after)) {
        (Some(a), Some(b)) => (after - 1) as f64 + (t - a) / (b - a),
        (None, Some(first)) => (t - first) / mean_cycle(edges),
        (Some(last), None) => (edges.len() - 1) as f64 + (t - last) / mean_cycle(edges),
        (None, None) => f64::NAN,
    }
}

/// Mean distance of edges.
pub fn mean_cycle(edges: &[f64]) -> f64 {
    match edges {
        [first, .., last] => (last - first) / (edges.len() - 1) as f64,
        _ => f64::NAN,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pattern_of_two_impacts_in_three_cycles() {
        let cycles: Vec<f64> =
            (0..40).map(|k| f64::from(k / 2) * 3.0 + if k % 2 == 0 { 0.3 } else { 1.9 }).collect();
        let found = per_cycle(&cycles, 2.0 / 3.0, 1e-3).unwrap();
        assert_eq!(found, PerCycle { impacts: 2, cycles: 3 });
        let places = phases(&cycles, found);
        assert_eq!(places.len(), 2);
        // Means of equal numbers, a few roundings.
        assert!((places[0].mean - 0.3).abs() < 1e-12 && (places[1].mean - 1.9).abs() < 1e-12, "{places:?}");
        assert!(places[0].spread < 1e-6, "{places:?}");
    }

    #[test]
    fn impacts_that_repeat_nothing_are_irregular() {
        // Golden-ratio steps never repeat within eight impacts, at a rate of one a cycle.
        let cycles: Vec<f64> = (0..60).map(|k| f64::from(k) + 0.8 * (f64::from(k) * 0.618).fract()).collect();
        assert_eq!(per_cycle(&cycles, 1.0, 0.0), None);
    }

    #[test]
    fn edges_of_a_noisy_sine_are_counted_once_a_cycle() {
        let sine: Vec<f64> = (0..1000)
            .map(|i| (TAU * f64::from(i) / 100.0 - 1.0).sin() + 0.05 * (f64::from(i) * 2.7).sin())
            .collect();
        let found = edges(&sine).unwrap();
        assert_eq!(found.len(), 10);
        // The ripple moves a crossing of slope 0.063 a sample by 0.05/0.063 = 0.8 samples at most; ten of them 1.6/9.
        assert!((mean_cycle(&found) - 100.0).abs() < 0.18, "{found:?}");
        assert!((counted(found[3] + 50.0, &found) - 3.5).abs() < 0.02);
        assert!(edges(&[0.0; 9]).is_err());
    }
}

//! Impacts against the cycle of the excitation: phase, and impacts per cycle.

use super::burst::median;
use super::interval::{Scatter, interval};
use crate::drill::{Edge, Edges, Numbered, Survey};
use serde::Serialize;
use std::f64::consts::TAU;
use vibro_record::{Error, Result};

/// Impacts per excitation cycles; 2/2 where impacts come once a cycle, but every second one alike (period doubling).
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

impl PerCycle {
    /// In lowest terms, where that is another fraction.
    fn reduced(self) -> Option<PerCycle> {
        let by = (2..=self.impacts.min(self.cycles))
            .rev()
            .find(|d| self.impacts.is_multiple_of(*d) && self.cycles.is_multiple_of(*d))?;
        Some(PerCycle { impacts: self.impacts / by, cycles: self.cycles / by })
    }
}

/// A multiple of a fraction counts where its places scatter by less than this part of what those of the fraction do.
const DOUBLED: f64 = 0.5;
/// Most impacts and cycles of a pattern.
const LARGEST: usize = 8;
/// A pattern repeats where n impacts take m cycles within this part of a cycle (root mean square).
pub const REPEATS: f64 = 0.1;
/// Fractions further than this part of them from the rate are not looked at.
pub const FITS: f64 = 0.02;

/// How impacts go with the excitation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Locking {
    /// They repeat with it.
    Locked(PerCycle),
    /// They come close to a fraction, but slip by this many impacts a cycle of the excitation (negative: too few).
    Drifting(PerCycle, f64),
    /// No fraction fits.
    Irregular,
}

/// Whether impacts repeat the simplest fraction n/m of impacts per cycle, up to 8/8, that is near their rate: 2/2 where 1/1 does not repeat.
///
/// `cycles` are the times of the impacts counted in excitation cycles, `index` their places in the series without missed ones, and
/// `std` is the relative standard uncertainty of the frequency of the excitation. A fraction holds where the slope of `cycles` over
/// `index` is m/n within three standard uncertainties and every place of the pattern keeps its phase within [`REPEATS`]: what is
/// merely near a fraction wanders through all phases.
pub fn locking(cycles: &[f64], index: &[usize], std: f64) -> Locking {
    let Some(step) = interval(cycles, index, Scatter::Unknown).filter(|s| s.mean > 0.0) else {
        return Locking::Irregular;
    };
    let rate = step.mean.recip();
    let own = if step.std.is_finite() { rate * step.std / step.mean } else { 0.0 };
    let std = own.hypot(rate * std);
    let mut fractions: Vec<PerCycle> = (1..=LARGEST)
        .flat_map(|cycles| (1..=LARGEST).map(move |impacts| PerCycle { impacts, cycles }))
        .collect();
    fractions.sort_by_key(|f| (f.impacts + f.cycles, f.cycles));
    let slip = |f: &PerCycle| rate - f.impacts as f64 / f.cycles as f64;
    fractions.retain(|f| {
        let spans: Vec<f64> = cycles.windows(f.impacts + 1).map(|w| w[f.impacts] - w[0]).collect();
        let off: Vec<f64> = spans.iter().map(|s| (s - f.cycles as f64).powi(2)).collect();
        // Spans over a missed impact are the few that are far off; the median knows them not. √(median of χ²₁) = 0.6745.
        spans.len() >= 2
            && slip(f).abs() <= FITS * (rate - slip(f)) + 2.0 * own
            && (median(&off) / 0.454_936).sqrt() <= REPEATS
    });
    // Of cycles that were counted, roundings alone are left.
    let widest = |f: PerCycle| phases(cycles, f).iter().map(|p| p.spread).fold(0.0, f64::max);
    let holds = |f: &&PerCycle| {
        let spread = widest(**f);
        // 2/2 is no 1/1 seen twice: its places are told apart by more than they scatter.
        let own = f.reduced().is_none_or(|r| spread <= DOUBLED * widest(r));
        slip(f).abs() <= 3.0 * std + 1e-9 && spread <= REPEATS && own
    };
    match (fractions.iter().find(holds), fractions.first()) {
        (Some(f), _) => Locking::Locked(*f),
        (None, Some(f)) => Locking::Drifting(*f, slip(f)),
        (None, None) => Locking::Irregular,
    }
}

/// A number as it was typed, and its standard uncertainty by its digits, zeros at its end included: 8.400 is surer than 8.4. `None` where `text` is
/// no number.
pub fn typed(text: &str) -> Option<(f64, f64)> {
    let value: f64 = text.trim().parse().ok().filter(|v: &f64| v.is_finite())?;
    let (digits, power) = text.trim().split_once(['e', 'E']).unwrap_or((text.trim(), "0"));
    let behind = digits.split_once('.').map_or(0, |(_, d)| d.len());
    let last = power.parse::<i32>().ok()?.checked_sub(i32::try_from(behind).ok()?)?;
    Some((value, 0.5 * 10f64.powi(last) / 3f64.sqrt()))
}

/// Standard uncertainty of a number that was typed: half a unit of its last digit, evenly spread (JCGM 100:2008, 4.3.7).
pub fn of_digits(value: f64) -> f64 {
    let digits = value.to_string().split_once('.').map_or(0, |(_, d)| d.len());
    0.5 * 10f64.powi(-i32::try_from(digits).unwrap_or(i32::MAX)) / 3f64.sqrt()
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

/// Relative standard uncertainty of a mean interval whose first and last edge, so many samples apart, each lie anywhere within one
/// sample: 1/√6 over that distance.
///
/// Where the interval is near a whole number of samples, all edges lie alike between theirs: the scatter of the intervals does not
/// show it, and no number of edges averages it.
pub fn quantised(samples: f64) -> f64 {
    1.0 / (6f64.sqrt() * samples)
}

/// Cycles of the excitation as a reference channel shows them.
pub struct Reference {
    /// Cycle that each rising edge begins, and its place in samples; at least two.
    edges: Vec<(usize, f64)>,
    /// Edges that are not there.
    pub missing: usize,
    /// Edges that should not be there; they are passed over.
    pub extra: usize,
    /// Whether they rise within one sample, so that nothing is known of them between samples.
    sharp: bool,
}

impl Reference {
    /// Rising edges of a channel, numbered in cycles.
    ///
    /// # Errors
    /// Where there are fewer than two, or where they pause, so that cycles cannot be counted.
    pub fn new(channel: &[f64]) -> Result<Reference> {
        let mut survey = Survey::default();
        survey.push(channel);
        let hint = "choose another --reference, or give --excitation in Hz";
        let Some((low, high)) = survey.levels() else {
            return Err(
                Error::refused("the reference channel has one level only: it shows no cycle").hint(hint)
            );
        };
        let mut edges = Edges::new(low, high, Edge::Rising);
        edges.push(channel);
        let found = edges.finish();
        let Numbered { mut runs, missing, extra, pauses } = Numbered::new(&found.edges);
        let edges = runs.pop().unwrap_or_default();
        if pauses > 0 {
            return Err(Error::refused(format!(
                "the reference channel has {pauses} stretch{} in which more than three edges are missing: cycles cannot be counted across",
                if pauses == 1 { "" } else { "es" }
            ))
            .hint(hint));
        }
        if edges.len() < 2 {
            return Err(Error::refused(format!(
                "the reference channel has {} rising edge{}: a cycle needs two",
                edges.len(),
                if edges.len() == 1 { "" } else { "s" }
            ))
            .hint(hint));
        }
        Ok(Reference { edges, missing, extra, sharp: found.sharp })
    }

    /// Position `t` in samples, counted in cycles; beyond the first and last edge by the mean cycle.
    pub fn counted(&self, t: f64) -> f64 {
        let after = self.edges.partition_point(|e| e.1 <= t);
        let before = after.checked_sub(1).and_then(|i| self.edges.get(i));
        match (before, self.edges.get(after)) {
            (Some(a), Some(b)) => a.0 as f64 + (b.0 - a.0) as f64 * (t - a.1) / (b.1 - a.1),
            (Some(e), None) | (None, Some(e)) => e.0 as f64 + (t - e.1) / self.mean_cycle(),
            (None, None) => f64::NAN,
        }
    }

    /// Relative standard uncertainty of the mean cycle from samples that stand still to it: see [`quantised`].
    pub fn std(&self) -> f64 {
        match self.edges.as_slice() {
            [first, .., last] if self.sharp => quantised(last.1 - first.1),
            _ => 0.0,
        }
    }

    /// Mean length of a cycle in samples.
    pub fn mean_cycle(&self) -> f64 {
        match self.edges.as_slice() {
            [first, .., last] => (last.1 - first.1) / (last.0 - first.0) as f64,
            _ => f64::NAN,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pattern_of_two_impacts_in_three_cycles() {
        let cycles: Vec<f64> =
            (0..40).map(|k| f64::from(k / 2) * 3.0 + if k % 2 == 0 { 0.3 } else { 1.9 }).collect();
        let index: Vec<usize> = (0..40).collect();
        let found = PerCycle { impacts: 2, cycles: 3 };
        assert_eq!(locking(&cycles, &index, 1e-4), Locking::Locked(found));
        let places = phases(&cycles, found);
        assert_eq!(places.len(), 2);
        // Means of equal numbers, a few roundings.
        assert!((places[0].mean - 0.3).abs() < 1e-12 && (places[1].mean - 1.9).abs() < 1e-12, "{places:?}");
        assert!(places[0].spread < 1e-6, "{places:?}");
    }

    #[test]
    fn a_doubled_period_is_two_impacts_in_two_cycles() {
        let index: Vec<usize> = (0..40).collect();
        let doubled: Vec<f64> =
            (0..40).map(|k| f64::from(k) + if k % 2 == 0 { 0.835 } else { 0.669 }).collect();
        let found = PerCycle { impacts: 2, cycles: 2 };
        assert_eq!(locking(&doubled, &index, 1e-4), Locking::Locked(found));
        let places: Vec<f64> = phases(&doubled, found).iter().map(|p| p.mean).collect();
        // Means of equal numbers, a few roundings.
        assert!((places[0] - 0.835).abs() < 1e-12 && (places[1] - 1.669).abs() < 1e-12, "{places:?}");
        let quadrupled: Vec<f64> =
            (0..40).map(|k| f64::from(k) + [0.1, 0.4, 0.1, 0.7][k as usize % 4]).collect();
        assert_eq!(locking(&quadrupled, &index, 1e-4), Locking::Locked(PerCycle { impacts: 4, cycles: 4 }));
        let even: Vec<f64> = (0..40).map(|k| f64::from(k) + 0.01 * (f64::from(k) * 2.4).sin()).collect();
        assert_eq!(locking(&even, &index, 1e-4), Locking::Locked(PerCycle { impacts: 1, cycles: 1 }));
    }

    #[test]
    fn impacts_that_repeat_nothing_are_irregular() {
        // Steps that grow by the golden ratio repeat nothing, at a rate of one a cycle.
        let cycles: Vec<f64> =
            (0..60).map(|k| f64::from(k) + 0.8 * (f64::from(k * k) * 0.618_034).fract()).collect();
        assert_eq!(locking(&cycles, &(0..60).collect::<Vec<_>>(), 0.0), Locking::Irregular);
    }

    #[test]
    fn edges_of_a_noisy_sine_are_counted_once_a_cycle() {
        let sine: Vec<f64> = (0..1000)
            .map(|i| (TAU * f64::from(i) / 100.0 - 1.0).sin() + 0.05 * (f64::from(i) * 2.7).sin())
            .collect();
        let found = Reference::new(&sine).unwrap();
        assert_eq!((found.edges.len(), found.missing, found.extra), (10, 0, 0));
        // The ripple moves a crossing of slope 0.063 a sample by 0.05/0.063 = 0.8 samples at most; ten of them 1.6/9.
        assert!((found.mean_cycle() - 100.0).abs() < 0.18, "{:?}", found.edges);
        assert!((found.counted(found.edges[3].1 + 50.0) - 3.5).abs() < 0.02);
        assert!(Reference::new(&[0.0; 9]).is_err());
    }

    #[test]
    fn a_lost_pulse_and_a_glitch_leave_the_cycles_as_they_are() {
        let mut pulses: Vec<f64> = (0..15_000).map(|i| if i % 100 < 20 { 1.0 } else { 0.0 }).collect();
        pulses[5_000..5_020].fill(0.0);
        pulses[7_350] = 9.0;
        let found = Reference::new(&pulses).unwrap();
        assert_eq!((found.missing, found.extra), (1, 1));
        // All edges are between samples 99 and 100: equal but for roundings of the bisection (1e-6 of a sample).
        assert!((found.mean_cycle() - 100.0).abs() < 1e-5, "{}", found.mean_cycle());
        // The record begins high, so the first edge is at 99.5.
        assert!((found.counted(12_049.5) - 119.5).abs() < 1e-5, "{}", found.counted(12_049.5));
        pulses[5_000..6_000].fill(0.0);
        let why = Reference::new(&pulses).err().map(|e| e.to_string()).unwrap_or_default();
        assert!(why.contains("cannot be counted"), "{why}");
    }

    #[test]
    fn a_train_that_slips_through_all_phases_is_not_locked() {
        let index: Vec<usize> = (0..150).collect();
        let one = PerCycle { impacts: 1, cycles: 1 };
        for frequency in [14.75, 14.85, 15.15] {
            let cycles: Vec<f64> = (0..150).map(|k| 0.2 + 15.0 / frequency * f64::from(k)).collect();
            for std in [1e-6, of_digits(15.0) / 15.0] {
                let Locking::Drifting(near, slip) = locking(&cycles, &index, std) else {
                    panic!("{frequency} Hz is not seen to drift")
                };
                assert_eq!(near, one);
                assert!((15.0 * slip - (frequency - 15.0)).abs() < 1e-9, "{slip}");
            }
        }
        // A slip of 0.1 cycle in all is within a tenth of a cycle, but not within 1e-6 of the rate.
        let slow: Vec<f64> = (0..150).map(|k| 1.0007 * f64::from(k)).collect();
        assert!(matches!(locking(&slow, &index, 1e-6), Locking::Drifting(..)));
        assert_eq!(locking(&slow, &index, 1e-3), Locking::Locked(one));
    }

    #[test]
    fn typed_numbers_are_as_sure_as_their_digits() {
        // Half a unit of the last digit over √3.
        for (text, unit) in [("15", 1.0), ("8.4", 0.1), ("8.400", 1e-3), ("8.4e2", 10.0), ("840.0", 0.1)] {
            let (value, std) = typed(text).unwrap();
            assert!((std / (0.5 * unit / 3f64.sqrt()) - 1.0).abs() < 1e-12, "{text}: {value} ± {std}");
        }
        assert!(typed("inf").is_none() && typed("fast").is_none() && typed("1e999999999999").is_none());
        assert!((of_digits(15.0) - 0.288_675).abs() < 1e-6 && (of_digits(11.25) - 0.002_886_75).abs() < 1e-8);
    }
}

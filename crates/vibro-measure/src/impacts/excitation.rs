//! Impacts against their excitation: their phases, the fraction of impacts per cycle to which they are
//! locked, or the beat by which they miss it.

use super::interval::CountedImpacts;
use super::interval::interval;
use super::{Impacts, ImpactsOptions};
use crate::Estimate;
use crate::drill::{Edge, Edges, Numbered, levels};
use num_complex::Complex64;
use serde::Serialize;
use std::f64::consts::TAU;
use vibro_record::{Error, Finding, Result, median, sort_by_number};

/// Impacts per excitation cycles; 2/2 where impacts come once a cycle, but every second one alike (period
/// doubling).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct PerCycle {
    /// Number of impacts in the pattern.
    pub impacts: usize,
    /// Number of excitation cycles in the pattern.
    pub cycles: usize,
}

/// Mean phase of one impact of the pattern.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Phase {
    /// Circular mean, in cycles from 0 to the cycles of the pattern.
    pub mean: f64,
    /// Circular standard deviation of single impacts, in cycles.
    pub spread: f64,
    /// Number of impacts in the mean.
    pub n: usize,
}

/// Adds to `answer` the relation of the impacts to the excitation; nothing where no excitation is known. The
/// record begins at `start` in s and has a sampling `rate` in Hz.
///
/// # Errors
/// As [`Reference::new`].
pub fn compare(
    answer: &mut Impacts,
    counted: &CountedImpacts,
    (start, rate): (f64, f64),
    options: &ImpactsOptions,
) -> Result<()> {
    let (frequency, part, at): (f64, f64, Vec<f64>) = match (&options.reference, options.excitation) {
        (Some(channel), _) => {
            let reference = Reference::new(channel)?;
            let Reference { missing, extra, .. } = reference;
            let odd = Finding::caution("reference-edges").count("missing", missing).count("extra", extra);
            answer.findings.extend((missing + extra > 0).then_some(odd));
            // First and last edge each lie anywhere within a sample.
            let [first, last] = reference.ends();
            let part = 1.0 / (6f64.sqrt() * (last.1 - first.1));
            let at = answer.times.iter().map(|t| reference.counted((t - start) * rate)).collect();
            (rate / reference.mean_cycle(), part, at)
        }
        (None, Some(f)) => (f, last_digit(f) / f, answer.times.iter().map(|t| t * f).collect()),
        (None, None) => return Ok(()),
    };
    let kept: Vec<f64> = counted.kept.iter().map(|i| at[*i]).collect();
    // The interval between impacts adds its own uncertainty.
    let part = part.hypot(answer.interval.std.map_or(0.0, |std| std / answer.interval.value));
    let locking = locking(&kept, &counted.index, part);
    answer.excitation = Some(frequency);
    answer.phase = at.iter().map(|c| c.rem_euclid(1.0)).collect();
    answer.regular = matches!(locking, Locking::Locked(_));
    match locking {
        Locking::Locked(fraction) => {
            answer.per_cycle = Some(fraction);
            answer.phases = phases(&kept, &counted.index, fraction);
        }
        Locking::Drifting(near, slip) => {
            let beat = (slip * frequency).abs();
            let method = format!("impacts a second less {}/{} of the excitation", near.impacts, near.cycles);
            answer.beat = Some(Estimate::new(beat, answer.frequency.std, "Hz", kept.len(), method));
            answer.findings.push(
                Finding::caution("impacts-drift")
                    .count("impacts", near.impacts)
                    .count("cycles", near.cycles)
                    .number("excitation", frequency)
                    .number("beat", beat),
            );
        }
        // Two impacts cannot show a fraction.
        Locking::Irregular if kept.len() < 3 => {}
        Locking::Irregular => answer.findings.push(Finding::caution("no-fraction-fits")),
    }
    Ok(())
}

/// A multiple of a fraction, as 2/2 of 1/1, counts where its phases scatter by less than this fraction of
/// the scatter about the fraction itself.
const DOUBLED: f64 = 0.5;
/// Most impacts, and most cycles, of a pattern.
const LARGEST: usize = 8;
/// Largest scatter of a pattern in cycles (root mean square): of n impacts about m cycles, and of each phase.
const REPEATS: f64 = 0.1;
/// Largest distance of a locked fraction from the rate (impacts per cycle), in standard uncertainties.
const AGREES: f64 = 3.0;
/// Largest relative distance of a candidate fraction from the rate (impacts per cycle).
const FITS: f64 = 0.02;

/// Standard uncertainty in Hz of a stated frequency: anywhere within half a unit of its last digit.
fn last_digit(frequency: f64) -> f64 {
    let decimals = frequency.to_string().split_once('.').map_or(0, |(_, decimals)| decimals.len());
    0.5 * 10f64.powi(-(decimals as i32)) / 3f64.sqrt()
}

/// Relation of the impacts to the excitation.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Locking {
    /// They are locked to this fraction of impacts per cycle.
    Locked(PerCycle),
    /// They come close to a fraction, but slip by this many impacts a cycle of the excitation (negative: too
    /// few).
    Drifting(PerCycle, f64),
    /// No fraction fits.
    Irregular,
}

/// The simplest fraction n/m of impacts per cycle, up to 8/8, that is near the rate of the impacts and that
/// they keep: 2/2 where 1/1 does not repeat.
///
/// `cycles` are the times of the impacts in excitation cycles, `index` their numbers in the train, with gaps
/// for missed ones. `part` is the relative standard uncertainty of the ratio of both frequencies. Impacts
/// keep a fraction that agrees with their rate where every place of the pattern keeps its phase within
/// [`REPEATS`]; impacts merely near a fraction wander through all phases.
fn locking(cycles: &[f64], index: &[usize], part: f64) -> Locking {
    let Some(step) = interval(cycles, index).filter(|s| s.mean > 0.0) else {
        return Locking::Irregular;
    };
    let rate = step.mean.recip();
    let own = if step.std.is_finite() { rate * step.std / step.mean } else { 0.0 };
    let mut fractions: Vec<PerCycle> = (1..=LARGEST)
        .flat_map(|cycles| (1..=LARGEST).map(move |impacts| PerCycle { impacts, cycles }))
        .collect();
    fractions.sort_by_key(|f| (f.impacts + f.cycles, f.cycles));
    let slip = |f: &PerCycle| rate - f.impacts as f64 / f.cycles as f64;
    fractions.retain(|f| {
        let spans: Vec<f64> = cycles.windows(f.impacts + 1).map(|w| w[f.impacts] - w[0]).collect();
        let off: Vec<f64> = spans.iter().map(|s| (s - f.cycles as f64).powi(2)).collect();
        // Spans over a missed impact are few and far off: the median leaves them out. The median of χ²₁ is
        // 0.4549.
        spans.len() >= 2
            && slip(f).abs() <= FITS * (rate - slip(f)) + 2.0 * own
            && (median(&off) / 0.454_936).sqrt() <= REPEATS
    });
    let widest = |f: PerCycle| phases(cycles, index, f).iter().map(|p| p.spread).fold(0.0, f64::max);
    let holds = |f: &&PerCycle| {
        let spread = widest(**f);
        // 2/2 is not 1/1 seen twice: its phases differ by more than they scatter.
        let same = |r: &&PerCycle| r.impacts * f.cycles == f.impacts * r.cycles && r.impacts < f.impacts;
        let single = fractions.iter().find(same).is_none_or(|r| spread <= DOUBLED * widest(*r));
        // The last term allows for rounding of the counted cycles.
        let agrees = slip(f).abs() <= AGREES * own.max(rate * part) + 1e-9 * rate;
        spread <= REPEATS && single && agrees
    };
    match (fractions.iter().find(holds), fractions.first()) {
        (Some(f), _) => Locking::Locked(*f),
        (None, Some(f)) => Locking::Drifting(*f, slip(f)),
        (None, None) => Locking::Irregular,
    }
}

/// Rising edges of a reference channel, one a cycle.
struct Reference {
    /// Number of the cycle that each rising edge begins, and its position in samples; at least two edges.
    edges: Vec<(usize, f64)>,
    /// Number of missing edges.
    missing: usize,
    /// Number of false edges, which are ignored.
    extra: usize,
}

impl Reference {
    /// Rising edges of a channel, numbered in cycles.
    ///
    /// # Errors
    /// Where there are fewer than two, or where they pause, so that cycles cannot be counted.
    fn new(channel: &[f64]) -> Result<Reference> {
        let found = Edges::of(channel, levels(channel).unwrap_or_default(), Edge::Rising);
        let Numbered { mut runs, missing, extra } = Numbered::new(&found.at);
        let edges = runs.pop().unwrap_or_default();
        let why = match (runs.len(), edges.len()) {
            (0, 2..) => return Ok(Reference { edges, missing, extra }),
            (0, n) => format!("rising edges of the reference channel: {n}, a cycle needs two"),
            (n, _) => format!(
                "the reference channel misses more than three edges in a row, {n} times: cycles cannot be counted across"
            ),
        };
        Err(Error::refused(why)
            .hint("name another reference channel, or state the frequency of the excitation")
            .setting("reference")
            .setting("excitation"))
    }

    fn ends(&self) -> [(usize, f64); 2] {
        [self.edges[0], self.edges[self.edges.len() - 1]]
    }

    /// Converts the position `t` in samples to cycles; beyond the first and last edge by the mean cycle.
    fn counted(&self, t: f64) -> f64 {
        let after = self.edges.partition_point(|e| e.1 <= t);
        let [first, last] = self.ends();
        let [a, b] = match self.edges.get(after) {
            _ if after == 0 => return first.0 as f64 + (t - first.1) / self.mean_cycle(),
            None => return last.0 as f64 + (t - last.1) / self.mean_cycle(),
            Some(b) => [self.edges[after - 1], *b],
        };
        a.0 as f64 + (b.0 - a.0) as f64 * (t - a.1) / (b.1 - a.1)
    }

    /// Mean length of a cycle in samples.
    fn mean_cycle(&self) -> f64 {
        let [first, last] = self.ends();
        (last.1 - first.1) / (last.0 - first.0) as f64
    }
}

/// Phases of the impacts of a pattern, in cycles: circular mean and standard deviation (Mardia 1972) on a
/// circle of all cycles of the pattern.
fn phases(cycles: &[f64], index: &[usize], pattern: PerCycle) -> Vec<Phase> {
    let length = pattern.cycles as f64;
    let phase = |place: usize| {
        let same = cycles.iter().zip(index).filter(|(_, i)| *i % pattern.impacts == place);
        let sum: Complex64 = same.clone().map(|(c, _)| Complex64::cis(TAU * c / length)).sum();
        let n = same.count();
        let mean = (sum.arg() / TAU * length).rem_euclid(length);
        let spread = (-2.0 * (sum.norm() / n as f64).min(1.0).ln()).sqrt() * length / TAU;
        Phase { mean, spread, n }
    };
    let mut phases: Vec<Phase> = (0..pattern.impacts).map(phase).collect();
    sort_by_number(&mut phases, |a| a.mean);
    phases
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
        assert_eq!(locking(&cycles, &index, 1e-3), Locking::Locked(found));
        let places = phases(&cycles, &index, found);
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
        assert_eq!(locking(&doubled, &index, 1e-3), Locking::Locked(found));
        let places: Vec<f64> = phases(&doubled, &index, found).iter().map(|p| p.mean).collect();
        // Means of equal numbers, a few roundings.
        assert!((places[0] - 0.835).abs() < 1e-12 && (places[1] - 1.669).abs() < 1e-12, "{places:?}");
        let quadrupled: Vec<f64> =
            (0..40).map(|k| f64::from(k) + [0.1, 0.4, 0.1, 0.7][k as usize % 4]).collect();
        assert_eq!(locking(&quadrupled, &index, 1e-3), Locking::Locked(PerCycle { impacts: 4, cycles: 4 }));
        let even: Vec<f64> = (0..40).map(|k| f64::from(k) + 0.01 * (f64::from(k) * 2.4).sin()).collect();
        assert_eq!(locking(&even, &index, 1e-3), Locking::Locked(PerCycle { impacts: 1, cycles: 1 }));
    }

    #[test]
    fn impacts_that_repeat_nothing_are_irregular() {
        // Shifts that follow the golden ratio repeat nothing, at a rate of one impact a cycle.
        let cycles: Vec<f64> =
            (0..60).map(|k| f64::from(k) + 0.8 * (f64::from(k * k) * 0.618_034).fract()).collect();
        assert_eq!(locking(&cycles, &(0..60).collect::<Vec<_>>(), 1e-3), Locking::Irregular);
    }

    #[test]
    fn a_train_that_slips_through_all_phases_is_not_locked() {
        let index: Vec<usize> = (0..150).collect();
        let one = PerCycle { impacts: 1, cycles: 1 };
        for frequency in [14.75, 14.85, 15.15] {
            let cycles: Vec<f64> = (0..150).map(|k| 0.2 + 15.0 / frequency * f64::from(k)).collect();
            let Locking::Drifting(near, slip) = locking(&cycles, &index, 1e-4) else {
                panic!("{frequency} Hz is not seen to drift")
            };
            assert_eq!(near, one);
            assert!((15.0 * slip - (frequency - 15.0)).abs() < 1e-9, "{slip}");
        }
        // A slip of 0.1 cycle over the record is within a tenth of a cycle: whether it counts as slip depends
        // on how well the excitation is known.
        let slow: Vec<f64> = (0..150).map(|k| 1.0007 * f64::from(k)).collect();
        assert_eq!(locking(&slow, &index, 1e-3), Locking::Locked(one));
        assert!(matches!(locking(&slow, &index, 1e-5), Locking::Drifting(..)));
    }

    #[test]
    fn a_stated_frequency_is_as_sure_as_its_digits() {
        for (frequency, expected) in [(15.0, 0.5), (7.4, 0.05), (8.43, 0.005)] {
            assert!((last_digit(frequency) * 3f64.sqrt() - expected).abs() < 1e-12, "{frequency}");
        }
    }

    #[test]
    fn edges_of_a_noisy_sine_are_counted_once_a_cycle() {
        let sine: Vec<f64> = (0..1000)
            .map(|i| (TAU * f64::from(i) / 100.0 - 1.0).sin() + 0.05 * (f64::from(i) * 2.7).sin())
            .collect();
        let found = Reference::new(&sine).unwrap();
        assert_eq!((found.edges.len(), found.missing, found.extra), (10, 0, 0));
        // The ripple moves a crossing of slope 0.063 a sample by 0.05/0.063 = 0.8 samples at most; the mean
        // of nine cycles by 1.6/9.
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
        // All edges are between samples 99 and 100: equal but for roundings of the bisection (1e-6 of a
        // sample).
        assert!((found.mean_cycle() - 100.0).abs() < 1e-5, "{}", found.mean_cycle());
        // The record begins high, so the first edge is at 99.5.
        assert!((found.counted(12_049.5) - 119.5).abs() < 1e-5, "{}", found.counted(12_049.5));
        pulses[5_000..6_000].fill(0.0);
        let why = Reference::new(&pulses).err().map(|e| e.to_string()).unwrap_or_default();
        assert!(why.contains("cannot be counted"), "{why}");
    }
}

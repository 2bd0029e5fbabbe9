//! Impacts against their excitation: phases, the fraction that they keep, or the beat by which they miss it.

use super::background::median;
use super::count::Counted;
use super::interval::interval;
use super::reference::Reference;
use super::{Impacts, ImpactsOptions};
use crate::Estimate;
use num_complex::Complex64;
use serde::Serialize;
use std::f64::consts::TAU;
use vibro_record::{Finding, Result};

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

/// Adds to `answer` how the impacts go with the excitation; nothing where none is known. The record begins at `start` in s and has a
/// sampling `rate` in Hz; `sampled` is the relative standard uncertainty of the interval from onsets that lie anywhere within a sample.
///
/// # Errors
/// As [`Reference::new`].
pub fn compare(
    answer: &mut Impacts,
    counted: &Counted,
    (start, rate, sampled): (f64, f64, f64),
    options: &ImpactsOptions,
) -> Result<()> {
    let (frequency, std, at): (f64, f64, Vec<f64>) = if let Some(channel) = &options.reference {
        let reference = Reference::new(channel)?;
        answer.findings.extend(reference.finding());
        let frequency = rate / reference.mean_cycle();
        let at = answer.times.iter().map(|t| reference.counted((t - start) * rate)).collect();
        (frequency, frequency * reference.std(), at)
    } else if let Some(frequency) = options.excitation {
        let at = answer.times.iter().map(|t| t * frequency).collect();
        (frequency, options.excitation_std.unwrap_or_else(|| digits(frequency)), at)
    } else {
        return Ok(());
    };
    let kept: Vec<f64> = counted.kept.iter().map(|i| at[*i]).collect();
    let locking = locking(&kept, &counted.index, sampled.hypot(std / frequency));
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
            let part = near.impacts as f64 / near.cycles as f64;
            let u = answer.frequency.std.map(|s| s.hypot(part * std));
            let method = format!("impacts a second less {}/{} of the excitation", near.impacts, near.cycles);
            answer.beat = Some(Estimate::new(beat, u, "Hz", kept.len(), method));
            answer.findings.push(
                Finding::caution("impacts-drift")
                    .count("impacts", near.impacts)
                    .count("cycles", near.cycles)
                    .number("excitation", frequency)
                    .number("beat", beat),
            );
        }
        Locking::Irregular => answer.findings.push(Finding::caution("no-fraction-fits")),
    }
    Ok(())
}

/// Standard uncertainty of a number by the digits it is written with: half a unit of the last, evenly spread (JCGM 100:2008, 4.3.7).
fn digits(value: f64) -> f64 {
    let behind = value.to_string().split_once('.').map_or(0, |(_, digits)| digits.len());
    0.5 * 0.1f64.powi(behind as i32) / 3f64.sqrt()
}

/// A multiple of a fraction counts where its places scatter by less than this part of what those of the fraction do.
const DOUBLED: f64 = 0.5;
/// Most impacts and cycles of a pattern.
const LARGEST: usize = 8;
/// A pattern repeats where n impacts take m cycles within this part of a cycle (root mean square).
const REPEATS: f64 = 0.1;
/// Fractions within this part of them from the rate are candidates.
const FITS: f64 = 0.02;

/// How impacts go with the excitation.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Locking {
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
fn locking(cycles: &[f64], index: &[usize], std: f64) -> Locking {
    let Some(step) = interval(cycles, index).filter(|s| s.mean > 0.0) else {
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
        // Spans over a missed impact are few and far off: the median leaves them out. The median of χ²₁ is 0.4549.
        spans.len() >= 2
            && slip(f).abs() <= FITS * (rate - slip(f)) + 2.0 * own
            && (median(&off) / 0.454_936).sqrt() <= REPEATS
    });
    let widest = |f: PerCycle| phases(cycles, index, f).iter().map(|p| p.spread).fold(0.0, f64::max);
    let holds = |f: &&PerCycle| {
        let spread = widest(**f);
        // 2/2 is no 1/1 seen twice: its places differ by more than they scatter.
        let same = |r: &&PerCycle| r.impacts * f.cycles == f.impacts * r.cycles && r.impacts < f.impacts;
        let single = fractions.iter().find(same).is_none_or(|r| spread <= DOUBLED * widest(*r));
        // Of cycles that were counted, roundings alone are left.
        slip(f).abs() <= 3.0 * std + 1e-9 && spread <= REPEATS && single
    };
    match (fractions.iter().find(holds), fractions.first()) {
        (Some(f), _) => Locking::Locked(*f),
        (None, Some(f)) => Locking::Drifting(*f, slip(f)),
        (None, None) => Locking::Irregular,
    }
}

/// Phases of the places of a pattern: circular mean and standard deviation (Mardia 1972) on a circle of its cycles.
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
    phases.sort_by(|a, b| a.mean.total_cmp(&b.mean));
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
        assert_eq!(locking(&cycles, &index, 1e-4), Locking::Locked(found));
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
        assert_eq!(locking(&doubled, &index, 1e-4), Locking::Locked(found));
        let places: Vec<f64> = phases(&doubled, &index, found).iter().map(|p| p.mean).collect();
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
    fn a_train_that_slips_through_all_phases_is_not_locked() {
        let index: Vec<usize> = (0..150).collect();
        let one = PerCycle { impacts: 1, cycles: 1 };
        for frequency in [14.75, 14.85, 15.15] {
            let cycles: Vec<f64> = (0..150).map(|k| 0.2 + 15.0 / frequency * f64::from(k)).collect();
            for std in [1e-6, digits(15.0) / 15.0] {
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
    fn written_numbers_are_as_sure_as_their_digits() {
        // Half a unit of the last digit over √3.
        for (value, unit) in [(15.0, 1.0), (8.4, 0.1), (840.0, 1.0), (11.25, 0.01)] {
            assert!((digits(value) / (0.5 * unit / 3f64.sqrt()) - 1.0).abs() < 1e-12, "{value}");
        }
    }
}

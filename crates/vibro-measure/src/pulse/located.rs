//! Finds the largest pulse of a record.

use crate::converter::{rounding, step};
use crate::swings;
use vibro_record::{Error, Result, median};

/// The largest pulse of a record.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Located {
    /// Value without a pulse.
    pub baseline: f64,
    /// Largest excursion from it, with its sign.
    pub height: f64,
    /// Positions of the flanks at half the height, in samples.
    pub flanks: (f64, f64),
    /// Index of the sample where the falling flank has come down to a fifth of the height.
    pub low: usize,
    /// Indices of the samples of a flat top.
    pub clipped: Vec<usize>,
    /// Step of the converter.
    pub quantum: f64,
}

/// Number of samples by which a flat top must exceed three times the length of a round one.
const FLAT: f64 = 3.0;

/// Samples within this many standard deviations of the noise of the largest count as equal to it.
const BAND: f64 = 8.0;

/// Least height of a pulse above the baseline, in standard deviations of the noise: white noise of 10⁶
/// samples reaches 5.
const LEAST: f64 = 6.0;

impl Located {
    /// Index of the first sample above half the height beyond the pulse: the record has another one.
    pub fn another(&self, values: &[f64]) -> Option<usize> {
        let (begin, end) = self.flanks;
        // A half sine is above half its height for two thirds of its length.
        let place = |i: usize| (i as f64 - begin) / (1.5 * (end - begin));
        let mut beyond = (0..values.len()).filter(|i| !(-0.5..=2.0).contains(&place(*i)));
        beyond.find(|i| (values[*i] - self.baseline) / self.height > 0.5)
    }
}

/// Finds the largest pulse.
///
/// # Errors
/// If no pulse stands out of the noise, or its onset or end is not in the record.
pub(super) fn locate(values: &[f64]) -> Result<Located> {
    let mut sorted: Vec<f64> = values.iter().copied().filter(|v| v.is_finite()).collect();
    sorted.sort_by(f64::total_cmp);
    let (Some(least), Some(most)) = (sorted.first(), sorted.last()) else {
        return Err(Error::refused("the record holds no value"));
    };
    if least == most {
        return Err(Error::refused(format!("all samples are {least}: there is no pulse"))
            .hint("choose the channel that holds the pulse")
            .setting("channel"));
    }
    let baseline = mode(&sorted);
    // 1.4826: from the median of absolute values to the standard deviation of a normal distribution. √2:
    // from the standard deviation of a difference to that of a value.
    let differences = values.windows(2).map(|w| (w[1] - w[0]).abs());
    let noise = 1.4826 * median(differences).max(0.0) / f64::sqrt(2.0);
    let quantum = step(&sorted);
    let far = |v: &f64| if v.is_finite() { (v - baseline).abs() } else { -1.0 };
    let peak = (0..values.len()).max_by(|a, b| far(&values[*a]).total_cmp(&far(&values[*b]))).unwrap_or(0);
    let height = values[peak] - baseline;
    if height.abs() < LEAST * noise {
        let why = format!(
            "no pulse stands out: the largest excursion is {:.1} times the noise, {LEAST} times are needed",
            height.abs() / noise
        );
        let hint = "choose a record with one clean pulse and its baseline";
        return Err(Error::refused(why).hint(hint));
    }
    let part = |i: usize| (values[i] - baseline) / height;
    let before = (0..peak).rev().find(|i| part(*i) < 0.5);
    let after = (peak + 1..values.len()).find(|i| part(*i) < 0.5);
    let missing = |which: &str, end: &str| {
        Error::refused(format!("the record {which} inside the pulse: its {end} is missing"))
            .hint("record with a pre-trigger, and long enough")
    };
    let Some(before) = before else { return Err(missing("begins", "onset")) };
    let Some(after) = after else { return Err(missing("stops", "end")) };
    let cross = |a: usize, b: usize| a as f64 + (0.5 - part(a)) / (part(b) - part(a)) * (b as f64 - a as f64);
    let low = (after..values.len()).find(|i| part(*i) < 0.2).unwrap_or(after);
    let flanks = (cross(before, before + 1), cross(after - 1, after));
    let depth = BAND * noise.max(rounding(quantum));
    let near = |i: &usize| height.abs() * (1.0 - part(*i)) <= depth;
    let from = (before..=peak).rev().take_while(near).last().unwrap_or(peak);
    let to = (peak..after).take_while(near).last().unwrap_or(peak);
    let run = (to + 1 - from) as f64;
    let is_flat = flat(run, flanks.1 - flanks.0, depth / height.abs());
    let clipped = if is_flat { (from..=to).collect() } else { Vec::new() };
    let located = Located { baseline, height, flanks, low, clipped, quantum };
    match swings::back_and_forth(values, baseline, height, flanks) {
        Some(rings) => Err(rings),
        None => Ok(located),
    }
}

/// Whether `run` samples within `depth` (a part of the height) of the largest are a flat top of a pulse
/// `width` samples wide at half its height.
///
/// The top of a half sine, 1.5 widths long, is within a part x of its height for (3/π) acos(1 − x) widths.
/// No contact stays there for three times that and for more than an eighth of the width.
fn flat(run: f64, width: f64, depth: f64) -> bool {
    let round = 3.0 / std::f64::consts::PI * (1.0 - depth).max(-1.0).acos() * width;
    run > 3.0 * round + FLAT && run > width / 8.0
}

/// Middle of the shortest interval that holds a quarter of the sorted values: the baseline, also of a record
/// that is mostly pulse.
fn mode(sorted: &[f64]) -> f64 {
    let quarter = (sorted.len() / 4).clamp(1, sorted.len().max(2) - 1);
    sorted
        .windows(quarter + 1)
        .min_by(|a, b| (a[quarter] - a[0]).total_cmp(&(b[quarter] - b[0])))
        .map_or(f64::NAN, |w| w[w.len() / 2])
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A half sine of height `h` over 40 samples, on a baseline of 2, after 60 samples of baseline and
    /// before 30.
    fn record(h: f64) -> Vec<f64> {
        let half = |i: i32| {
            if (0..=40).contains(&i) { (f64::from(i) * std::f64::consts::PI / 40.0).sin() } else { 0.0 }
        };
        (-60..70).map(|i| 2.0 + h * half(i) + 1e-4 * f64::from(i % 3)).collect()
    }

    #[test]
    fn a_pulse_of_either_sign_over_a_baseline() {
        for h in [5.0, -5.0] {
            let found = locate(&record(h)).unwrap();
            assert!(
                (found.baseline - 2.0).abs() < 1e-3 && (found.height / h - 1.0).abs() < 1e-3,
                "{found:?}"
            );
            // A half sine is above half its height from 1/6 to 5/6 of its length.
            let (rise, fall) = found.flanks;
            assert!(
                (rise - 60.0 - 40.0 / 6.0).abs() < 0.1 && (fall - 60.0 - 200.0 / 6.0).abs() < 0.1,
                "{found:?}"
            );
            assert!(found.clipped.is_empty());
        }
    }

    #[test]
    fn a_flat_top_is_seen() {
        let clipped: Vec<f64> = record(5.0).iter().map(|v| v.min(6.0)).collect();
        let found = locate(&clipped).unwrap();
        // sin > 0.8 from 0.295 to 0.705 of 40 samples.
        assert!((16..=18).contains(&found.clipped.len()), "{found:?}");
    }

    #[test]
    fn a_flat_top_with_noise_is_seen_and_a_round_one_is_not() {
        // A deterministic noise of 0.05 % of the height; the pulse 200 samples long.
        let noise = |i: i32| 2.5e-3 * (f64::from(i * i) * 0.7).sin() * f64::sqrt(2.0);
        let half = |i: i32| {
            if (0..=200).contains(&i) { (f64::from(i) * std::f64::consts::PI / 200.0).sin() } else { 0.0 }
        };
        let record =
            |limit: f64| (-200..400).map(|i| (5.0 * half(i)).min(limit) + noise(i)).collect::<Vec<f64>>();
        assert!(locate(&record(9.0)).unwrap().clipped.is_empty());
        // With this noise 11 samples of a round top count as equal to its peak; a flat top three times as
        // long, by a cut of 4 %, is detected.
        for part in [0.8, 0.9] {
            let n = locate(&record(5.0 * part)).unwrap().clipped.len() as f64;
            // 200/π · 2 acos(part) samples at the limit, and those within eight deviations of noise and their
            // own noise beside them.
            let flat = 400.0 / std::f64::consts::PI * f64::acos(part);
            assert!(n > 0.9 * flat && n < flat + 20.0, "{part}: {n} {flat}");
        }
    }

    #[test]
    fn records_without_a_whole_pulse_are_refused() {
        assert!(locate(&[3.0; 50]).unwrap_err().to_string().contains("all samples are 3"));
        assert!(locate(&[f64::NAN; 5]).is_err() && locate(&[]).is_err());
        assert!(locate(&record(5.0)[80..]).unwrap_err().to_string().contains("onset"));
        assert!(locate(&record(5.0)[..80]).unwrap_err().to_string().contains("end is missing"));
        let noise: Vec<f64> = (0..200).map(|i| f64::from(i * 7919 % 201)).collect();
        assert!(locate(&noise).unwrap_err().to_string().contains("stands out"));
    }
}

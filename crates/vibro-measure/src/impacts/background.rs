//! Level and noise of a trace between its impacts; its bursts, each with the ringing after an impact.

use crate::converter::analogue_step;
use std::f64::consts::PI;
use std::ops::Range;
use vibro_record::lanes::{Survey, survey};
use vibro_record::{median, quantile};

/// Least height of an impact over the remaining ringing of the one before.
const RISE: f64 = 2.0;
/// Least height of an impact over the echo before it, which follows the impact before by more than the pause.
/// Ringing falls; where it beats, it hardly rises above all that the pause before it holds.
const OVER_ECHO: f64 = 1.1;
/// Ratio of one candidate decay time to the one before.
const STEP: f64 = 1.25;
/// Relative difference up to which two numbers of bursts count as equal.
const SAME: f64 = 0.02;

/// Bursts of samples farther than `reach` from 0, one for each impact. With `pause`, stretches that follow
/// within `pause` samples are joined, but for an impact after an echo ([`paused`]). Without it, a burst lasts
/// until the signal rises above the envelope of its ringing. The second value is then the factor by which the
/// assumed decay of the ringing may change without changing the number of bursts.
pub fn bursts(values: &[f64], reach: f64, pause: Option<usize>) -> (Vec<Range<usize>>, Option<f64>) {
    let runs = runs(values, reach);
    let (firsts, stable) = match pause {
        Some(pause) => (paused(values, &runs, pause), None),
        None => most_stable(values, &runs),
    };
    let ends = firsts.iter().skip(1).copied().chain([runs.len()]);
    let whole = |(first, next): (&usize, usize)| runs[*first].start..runs[next - 1].end;
    (firsts.iter().zip(ends).map(whole).collect(), stable)
}

/// Indices of the runs that begin an impact where no impact follows another within `pause` samples. A run
/// does so behind a pause without runs. It also does so where it begins later than `pause` after the impact
/// before, and rises above [`OVER_ECHO`] times all runs within `pause` before it: those are an echo.
fn paused(values: &[f64], runs: &[Range<usize>], pause: usize) -> Vec<usize> {
    let height = |run: &Range<usize>| values[run.clone()].iter().fold(0.0, |h: f64, v| h.max(v.abs()));
    let heights: Vec<f64> = runs.iter().map(height).collect();
    let mut found: Vec<usize> = Vec::new();
    for (j, run) in runs.iter().enumerate() {
        let is_near = |k: &usize| run.start + 1 - runs[*k].end < pause;
        let later = || found.last().is_none_or(|first| run.start - runs[*first].start >= pause);
        let rises = || (0..j).rev().take_while(is_near).all(|k| heights[j] > OVER_ECHO * heights[k]);
        let alone = j == 0 || !is_near(&(j - 1));
        if alone || later() && rises() {
            found.push(j);
        }
    }
    found
}

/// Stretches of samples beyond the noise limit `reach`. An envelope may ring until the next impact: a
/// stretch that rises again from a valley is split there; each part ends where it has fallen from its peak
/// by the factor [`RISE`].
fn runs(values: &[f64], reach: f64) -> Vec<Range<usize>> {
    let beyond: Vec<usize> = (0..values.len()).filter(|i| values[*i].abs() > reach).collect();
    let mut found: Vec<Range<usize>> = Vec::new();
    for run in beyond.chunk_by(|a, b| a + 1 == *b) {
        let (mut start, mut valley, mut peak, mut fallen) = (run[0], run[0], 0.0f64, None);
        for i in run.iter().copied() {
            let height = values[i].abs();
            if let Some(end) = fallen.filter(|_| height > RISE * values[valley].abs()) {
                found.push(start..end);
                (start, peak, fallen) = (valley, 0.0, None);
            }
            if height > peak {
                (peak, valley) = (height, i);
            } else if height < values[valley].abs() {
                valley = i;
            }
            if fallen.is_none() && RISE * height < peak {
                fallen = Some(i);
            }
        }
        let parted = found.last().is_some_and(|last| last.end > run[0]);
        let end = run[0] + run.len();
        found.push(start..if parted { fallen.unwrap_or(end) } else { end });
    }
    found
}

/// Indices of the runs that begin an impact, if ringing decays by the factor e in `decay` samples. Their
/// peaks exceed [`RISE`] times an envelope that follows every peak and decays with that time. Runs that
/// follow within the same time belong to the rise of the impact.
fn firsts(values: &[f64], runs: &[Range<usize>], decay: f64) -> Vec<usize> {
    let keep = (-1.0 / decay).exp();
    let (mut envelope, mut at) = (0.0f64, 0);
    let mut found: Vec<usize> = Vec::new();
    for (j, run) in runs.iter().enumerate() {
        // The rising flank before a run belongs to the run, not to the ringing before it.
        let rises = |i: &usize| values[i - 1].abs() < values[*i].abs();
        let foot = (at + 1..=run.start).rev().take_while(rises).last().unwrap_or(run.start);
        for v in &values[at..foot] {
            envelope = (envelope * keep).max(v.abs());
        }
        envelope *= keep.powi((run.start - foot) as i32);
        at = run.start;
        let own = found.last().is_some_and(|f| (at - runs[*f].start) as f64 <= decay);
        let height = values[run.clone()].iter().fold(0.0, |h: f64, v| h.max(v.abs()));
        if !own && height > RISE * envelope {
            found.push(j);
        }
    }
    found
}

/// Indices of the runs that begin an impact, for the decay whose choice matters least, and the factor by
/// which this decay may change without changing their number.
///
/// The envelope follows each peak of the ringing, so it may fall faster than the ringing does. For decays
/// from a few half waves up to the pause between impacts, the number of bursts is the same. A number that
/// first appears far beyond the half waves belongs to a rest in the record, and is not taken.
fn most_stable(values: &[f64], runs: &[Range<usize>]) -> (Vec<usize>, Option<f64>) {
    // Length of a half wave, or of a pulse: half of all samples beyond the noise lie in runs no longer.
    let mut lengths: Vec<usize> = runs.iter().flat_map(|r| vec![r.len(); r.len()]).collect();
    lengths.sort_unstable();
    let Some(length) = lengths.get(lengths.len().saturating_sub(1) / 2) else { return (Vec::new(), None) };
    let length = *length as f64;
    let counts: Vec<(f64, usize)> =
        std::iter::successors(Some((0.5 * length).max(1.0)), |decay| Some(decay * STEP))
            .take_while(|decay| *decay < 0.5 * values.len() as f64)
            .map(|decay| (decay, firsts(values, runs, decay).len()))
            .take_while(|(_, n)| *n > 1)
            .collect();
    let mut best = (0.0, 0.5 * length.max(2.0));
    for (i, (from, n)) in counts.iter().enumerate().take_while(|(_, (from, _))| *from <= 8.0 * length + 4.0) {
        let same = |m: &usize| m.abs_diff(*n) as f64 <= SAME * *n as f64;
        let to = counts[i..].iter().take_while(|(_, m)| same(m)).last().map_or(*from, |t| t.0);
        if to / from > best.0 {
            best = (to / from, (from * to).sqrt());
        }
    }
    (firsts(values, runs, best.1), Some(best.0))
}

/// Level and noise between impacts.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Background {
    /// Median of the quiet samples, in the unit of the trace.
    pub level: f64,
    /// Standard deviation of its noise.
    pub sigma: f64,
    /// Noise limit: the distance from the level that noise alone reaches in fewer than one of a thousand
    /// such records.
    pub reach: f64,
}

impl Background {
    /// Background of the envelope of the same samples less their level. The noise of an envelope has
    /// Rayleigh's distribution: its mean is √(π/2)σ, its variance (2 − π/2)σ², and its probability to exceed
    /// zσ has the same bound exp(−z²/2). Samples of the envelope at a distance of `apart` samples are nearly
    /// independent.
    pub fn of_envelope(self, envelope: &[f64], apart: f64) -> Background {
        let stretch = ((STRETCH * apart) as usize).max(1);
        let power = |part: &[f64]| 0.5 * part.iter().map(|v| v * v).sum::<f64>() / part.len() as f64;
        let lowest = quantile(envelope.chunks(stretch).map(power), QUIETEST).sqrt();
        // Where impacts ring until the next one, σ contains the ringing, and the quietest stretches show the
        // noise. They are used where they are below half of σ, which chance does not give.
        let part = if lowest < 0.5 * self.sigma { lowest / self.sigma } else { 1.0 };
        let (sigma, level) = (part * self.sigma, (0.5 * PI).sqrt() * part * self.sigma);
        Background { level, sigma: (2.0 - 0.5 * PI).sqrt() * sigma, reach: part * self.reach - level }
    }
}

/// Independent samples of an envelope in a stretch whose mean square is taken.
const STRETCH: f64 = 4.0;
/// Share of the stretches that count as quiet. In noise, a tenth of all stretches of 4 independent samples
/// (χ² with 8 degrees of freedom) shows less than 0.66 σ, so chance does not give 0.5 σ.
const QUIETEST: f64 = 0.1;

/// Lower quartile of |N(0, 1)|.
const QUARTILE: f64 = 0.318_639_363_964_375;
/// Median of |N(0, 1)|.
const MEDIAN: f64 = 0.674_489_750_196_081_7;

/// Level and noise of the samples between impacts.
///
/// Starts from the median and the lower quartile of the distances from it, so that impacts may fill half of
/// the record; then leaves out the samples beyond the noise limit with their neighbours, and repeats.
pub fn background(values: &[f64]) -> Background {
    let Survey { low, high, .. } = survey(values);
    let step = analogue_step(values);
    // P(|x| > zσ) < exp(−z²/2), for each of n samples.
    let z = (2.0 * (values.len().max(1) as f64 / 1e-3).ln()).sqrt();
    let of = |quiet: &[f64], part: f64, normal: f64| {
        let level = median(quiet);
        // The converter hides up to half a step of a distance.
        let sigma = (quantile(quiet.iter().map(|v| (v - level).abs()), part) + step / 2.0) / normal;
        // A digital trace has σ = 0: the limit is at least a thousandth of the range.
        Background { level, sigma, reach: (z * sigma).max(1e-3 * (high - low)) }
    };
    let mut found = of(values, 0.25, QUARTILE);
    for _ in 0..4 {
        let out = |i: usize| (values[i] - found.level).abs() > found.reach;
        let beside = |i: usize| i.saturating_sub(1)..(i + 2).min(values.len());
        let quiet: Vec<f64> = (0..values.len()).filter(|i| !beside(*i).any(out)).map(|i| values[i]).collect();
        if quiet.len() < 8 {
            break;
        }
        found = of(&quiet, 0.5, MEDIAN);
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_long_rest_does_not_join_the_impacts_beside_it() {
        let mut values = vec![0.0; 20_000];
        for i in 0..50 {
            values[100 + i * 20] = 1.0;
            values[15_000 + i * 20] = 1.0;
        }
        assert_eq!(bursts(&values, 0.5, None).0.len(), 100);
    }

    #[test]
    fn a_given_pause_parts_bursts_and_nothing_else_does() {
        let mut values = vec![0.0; 100];
        for i in [10, 13, 20, 21, 60] {
            values[i] = 1.0;
        }
        assert_eq!(bursts(&values, 0.5, Some(5)).0, [10..14, 20..22, 60..61]);
        assert_eq!(bursts(&values, 0.5, Some(20)).0, [10..22, 60..61]);
        assert!(bursts(&values, 2.0, None).0.is_empty());
    }

    /// Echoes 30 samples behind impacts that are 50 apart: a pause of 40 is longer than the rest between an
    /// echo and the next impact. Ringing, which falls, begins no impact.
    #[test]
    fn an_impact_behind_an_echo_is_one() {
        let mut values = vec![0.0; 400];
        for k in 0..5 {
            values[20 + 50 * k] = 1.0;
            values[50 + 50 * k] = 0.7;
        }
        assert_eq!(bursts(&values, 0.1, Some(40)).0.len(), 5);
        for (i, value) in values[300..400].iter_mut().enumerate() {
            *value = if i % 4 == 0 { 1.0 - 0.008 * i as f64 } else { 0.0 };
        }
        assert_eq!(bursts(&values, 0.1, Some(40)).0.len(), 6);
    }
}

#[cfg(test)]
mod levels {
    use super::*;
    use vibro_math::Noise;

    #[test]
    fn impacts_that_fill_two_fifths_of_a_record_do_not_move_its_background() {
        let mut noise = Noise::new(7);
        let values: Vec<f64> =
            (0..4000).map(|i| 3.0 + 0.1 * noise.normal() + if i % 10 < 4 { 5.0 } else { 0.0 }).collect();
        let found = background(&values);
        // 1200 quiet samples with quiet neighbours: the median scatters by 1.25·0.1/√1200 = 0.004, its
        // deviation by 3 %.
        assert!((found.level - 3.0).abs() < 0.02, "{found:?}");
        assert!((found.sigma / 0.1 - 1.0).abs() < 0.15, "{found:?}");
    }

    /// Noise of a third of a converter's step: most samples equal the level, and those one step away are no
    /// impacts.
    #[test]
    fn the_last_digit_of_a_converter_is_no_impact() {
        let (mut noise, step) = (Noise::new(8), 1.0 / 2048.0);
        let values: Vec<f64> = (0..20_000)
            .map(|i| (0.33 * noise.normal()).round() * step + if i % 4000 == 2000 { 1.0 } else { 0.0 })
            .collect();
        let found = background(&values);
        // Noise of a third of a step reaches two steps.
        assert!(found.reach > 2.5 * step && found.reach < 8.0 * step, "{found:?}");
        assert_eq!(bursts(&values, found.reach, None).0.len(), 5);
        // A switch has two values and no noise.
        let switch: Vec<f64> = (0..1000).map(|i| if i % 100 < 3 { 5.0 } else { 0.0 }).collect();
        assert!(background(&switch).reach < 0.1);
    }
}

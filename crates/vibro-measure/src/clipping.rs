//! Finds samples that are clipped at the ends of an instrument's range.

use crate::chance::normal_beyond;
use nalgebra::{Matrix3, Vector3};
use num_complex::Complex64;
use std::f64::consts::{PI, TAU};

/// Indices of clipped samples, which all have the largest or the smallest value (an end). `period` is that
/// of the signal in samples. A sine with noise of few converter steps is clipped at an end if the fitted
/// sine exceeds this end. Any other signal is clipped at an end in two cases: samples stay there longer than
/// a crest of this period stays within three steps, or the end has more samples, compared with the step next
/// to it, than a crest puts there.
pub fn clipped(values: &[f64], period: f64) -> Vec<usize> {
    let (low, high) =
        values.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(*v), h.max(*v)));
    let at = |end: f64| values.iter().filter(|v| **v == end).count();
    let repeated: Vec<f64> = [low, high].into_iter().filter(|end| at(*end) > 1).collect();
    if low == high || repeated.is_empty() {
        return Vec::new();
    }
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let steps = sorted.windows(2).map(|w| w[1] - w[0]).filter(|step| *step > 0.0);
    let step = steps.clone().fold(f64::INFINITY, f64::min);
    // Values that hardly ever repeat were not rounded.
    let rounded = (steps.count() as f64) < UNROUNDED * values.len() as f64;
    if let Some(ends) = passed(values, period, step, &repeated) {
        return (0..values.len()).filter(|i| ends.contains(&values[*i])).collect();
    }
    let crest = |run: usize| 0.5 * (high - low) * (1.0 - (PI * (run as f64 / period).min(0.5)).cos());
    let rests = |end: f64| {
        let runs = values.chunk_by(|a, b| a == b).filter(|run| run[0] == end && run.len() > 1);
        // Three steps are far more than the half step by which rounding moves a value.
        runs.into_iter().any(|run| crest(run.len() - 1) > 3.0 * step)
    };
    let crowds = |end: f64| {
        // Samples at the end, or one step from it.
        let near = |v: &&f64| (**v - end).abs() <= 1.5 * step;
        let (at, near) = (at(end) as f64, values.iter().filter(near).count() as f64);
        let beside = near - at;
        // The crest of a rounded sine puts 2.4 times as many samples in the last step as in the one before.
        // More than three times as many mean clipping. Four standard deviations allow for chance: `at − 3
        // beside` has the variance `at + 9 beside` (Poisson).
        if rounded { at > 3.0 * beside + 4.0 * (at + 9.0 * beside).sqrt() } else { at > 2.0 }
    };
    let ends: Vec<f64> = repeated.into_iter().filter(|end| rests(*end) || crowds(*end)).collect();
    (0..values.len()).filter(|i| ends.contains(&values[*i])).collect()
}

/// Distinct values over all values; below this fraction the values were rounded to converter steps.
const UNROUNDED: f64 = 0.8;

/// Largest standard deviation of the residuals of a sine, in converter steps: with more, the values are no
/// sine with little noise.
const NOISE: f64 = 3.0;
/// Standard deviation of the residuals in steps, above which the fit gives up. It is larger than [`NOISE`],
/// as the first round does not allow for clipping: a sine of 2000 steps clipped at 97 % then has 20.
const FAR: f64 = 100.0;
/// Smallest standard deviation of the noise in steps: a fit of rounded values is off by as much.
const LEAST: f64 = 0.05;
/// Number of bins of the phase of the sine. Rounding errors repeat with the phase. Noise of σ steps reduces
/// this repetition to e^(−2π²σ²) (Widrow & Kollár, Quantization Noise, 2008).
const PHASES: usize = 1024;
/// Largest second or third harmonic of the residuals beyond noise, in steps. It is half of the half step
/// that rounding hides at an end, so that no such harmonic moves a crest past an end.
const SLIGHT: f64 = 0.25;
/// Most iterations; each multiplies the error by the fraction of samples that lie at the ends.
const ROUNDS: usize = 30;
/// Number of its standard uncertainties by which the fitted sine must exceed an end.
const SURE: f64 = 3.0;
/// Least logarithm of the likelihood ratio of a clipped end, ln 10⁶: chance exceeds it in fewer than one of
/// 10⁶ cases (Markov's inequality).
const RATIO: f64 = 13.8;

/// Ends that the fitted sine exceeds, at which samples are therefore clipped. The fit is a censored
/// regression: a sample at an end states only that the sine was there or beyond (Tobin, Econometrica 26
/// (1958) 24, by expectation maximization). `None` if the values are not a sine with noise of few steps.
fn passed(values: &[f64], period: f64, step: f64, ends: &[f64]) -> Option<Vec<f64>> {
    let n = values.len();
    let centre = 0.5 * (ends[0] + ends[ends.len() - 1]);
    let middle = values.iter().sum::<f64>() / n as f64;
    let y = |i: usize| (values[i] - centre) / step;
    let side = |i: usize| if values[i] > middle { 1.0 } else { -1.0 };
    let row = |i: usize| {
        let (sin, cos) = (TAU * i as f64 / period).sin_cos();
        Vector3::new(cos, sin, 1.0)
    };
    let (at, kept): (Vec<usize>, Vec<usize>) = (0..n).partition(|i| ends.contains(&values[*i]));
    let normal = |of: &[usize]| of.iter().map(|i| row(*i) * row(*i).transpose()).sum::<Matrix3<f64>>();
    let right = kept.iter().map(|i| row(*i) * y(*i)).sum::<Vector3<f64>>();
    let all = (normal(&kept) + normal(&at)).cholesky()?;
    let mut p = all.solve(&(right + at.iter().map(|i| row(*i) * y(*i)).sum::<Vector3<f64>>()));
    let (mut sigma, mut noise) = (0.0, 0.0);
    for _ in 0..ROUNDS {
        let squares: f64 = kept.iter().map(|i| (y(*i) - p.dot(&row(*i))).powi(2)).sum();
        sigma = (squares / kept.len().saturating_sub(3).max(1) as f64).sqrt();
        if sigma > FAR {
            return None;
        }
        noise = (sigma * sigma - 1.0 / 12.0).max(LEAST * LEAST).sqrt();
        let beyond = |i: &usize| {
            let expected = p.dot(&row(*i));
            let z = (side(*i) * (y(*i) - expected) - 0.5) / noise;
            row(*i) * (expected + side(*i) * noise * normal_beyond(z))
        };
        let next = all.solve(&(right + at.iter().map(beyond).sum::<Vector3<f64>>()));
        let moved = (next - p).norm();
        p = next;
        if moved < 1e-3 {
            break;
        }
    }
    let mut phases = [false; PHASES];
    (0..n).for_each(|i| phases[((i as f64 / period).fract() * PHASES as f64) as usize % PHASES] = true);
    let told = phases.iter().filter(|p| **p).count().min(n) as f64;
    let bound = (-2.0 * (PI * noise).powi(2)).exp();
    let repeats = bound * n as f64 / told + 1.0 - bound;
    let harmonic = |k: f64| {
        let turn = |i: &usize| Complex64::cis(k * TAU * *i as f64 / period) * (y(*i) - p.dot(&row(*i)));
        kept.iter().map(turn).sum::<Complex64>().norm() * 2.0 / n as f64
    };
    let shown = SLIGHT + 5.0 * sigma * (2.0 * repeats / n as f64).sqrt();
    if sigma > NOISE || [2.0, 3.0].into_iter().any(|k| harmonic(k) > shown) {
        return None;
    }
    // If the samples between the ends do not determine a sine, no end counts as clipped.
    let Some(kept) = normal(&kept).cholesky() else { return Some(Vec::new()) };
    let passes = |end: &&f64| {
        let ratio = |i: &usize| {
            let own = row(*i);
            let off = SURE * sigma * (own.dot(&kept.solve(&own)) * repeats).sqrt();
            let over = side(*i) * (p.dot(&own) - y(*i)) - off;
            // Probability that a value known to lie at this end or beyond is within the step of the end. It
            // is small where the sine exceeds the end.
            -(1.0 - above((0.5 - over) / noise) / above((-0.5 - over) / noise).max(1e-300)).max(1e-12).ln()
        };
        at.iter().filter(|i| values[**i] == **end).map(ratio).sum::<f64>() > RATIO * repeats
    };
    Some(ends.iter().filter(passes).copied().collect())
}

/// Upper bound e^(−z²/2)/2 of P(x > z) of N(0, 1) for z above 0. It weighs a value just inside its end more
/// than the exact probability does. With the exact one, one of 4000 clipped sines is missed: a cut that
/// rounding almost hides.
fn above(z: f64) -> f64 {
    let beyond = 0.5 * (-0.5 * z * z).exp();
    if z > 0.0 { beyond } else { 1.0 - beyond }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::HashSet;
    use vibro_math::Noise;

    #[test]
    fn crests_of_coarse_steps_are_not_clipped() {
        let tone = |i: i32, period: f64| (TAU * f64::from(i) / period).cos();
        for period in [23.7, 37.3, 200.0] {
            // Eight bits: a crest stays on its last step for some samples.
            let coarse: Vec<f64> = (0..2000).map(|i| (127.0 * tone(i, period)).round()).collect();
            assert!(clipped(&coarse, period).is_empty(), "{period}");
            let cut: Vec<f64> = coarse.iter().map(|v| v.min(110.0)).collect();
            let found = clipped(&cut, period);
            assert_eq!(found.len(), coarse.iter().filter(|v| **v >= 110.0).count(), "{period}");
        }
        assert!(clipped(&[1.0; 50], 10.0).is_empty());
    }

    /// Clipping cuts a crest of the sum for only one or two samples. Their number shows it, not their
    /// duration.
    #[test]
    fn sums_of_fast_sines_are_clipped_where_many_samples_share_the_end() {
        let sum = |i: i32| {
            let [a, b] = [3.1, 4.7].map(|period| (TAU * f64::from(i) / period).cos());
            a + 0.6 * b
        };
        for step in [1e-9, 1.0 / 1024.0] {
            let whole: Vec<f64> = (0..4000).map(|i| (sum(i) / step).round() * step).collect();
            assert!(clipped(&whole, 3.1).is_empty(), "{step}");
            let cut: Vec<f64> = whole.iter().map(|v| v.min(1.25)).collect();
            assert_eq!(clipped(&cut, 3.1).len(), whole.iter().filter(|v| **v >= 1.25).count(), "{step}");
        }
    }

    /// A sine in steps of the converter, with noise; with `cut`, clipped at this fraction of its amplitude.
    /// Returns its samples and its period.
    fn stepped(noise: &mut Noise, amplitude: f64, cut: Option<f64>) -> (Vec<f64>, f64) {
        let periods = noise.between(8.0, 200.0);
        let exact = noise.between(0.0, 1.0) < 0.5;
        let whole = |noise: &mut Noise, low: f64, high: f64| noise.between(low, high).floor();
        // Half of the sines have a rational period: the same few phases are sampled again and again.
        let period = if exact {
            whole(noise, 8.0, 100.0) / whole(noise, 1.0, 4.0)
        } else {
            10f64.powf(noise.between(0.5, 2.3))
        };
        let level = if noise.between(0.0, 1.0) < 0.3 { 0.0 } else { noise.between(0.0, 2.0) };
        let (phase, offset) = (noise.between(0.0, TAU), noise.between(-9.0, 9.0));
        let value = |i: usize| {
            let sine = amplitude * (TAU * i as f64 / period + phase).cos() + level * noise.normal();
            (cut.map_or(sine, |cut| sine.min(cut * amplitude)) + offset).round()
        };
        ((0..((periods * period) as usize).max(200)).map(value).collect(), period)
    }

    /// Seeds of unclipped sines that are reported as clipped, and of sines clipped at 97 % of their
    /// amplitude that are missed. A miss counts only under three conditions. The amplitude is at least 20
    /// steps, so that the cut exceeds the rounding. Clipping changes at least 4 % of the samples. At least
    /// 256 phases occur, which give the amplitude to 0.29·√(3/256) = 0.03 steps.
    fn wrong(draws: u64) -> (Vec<u64>, Vec<u64>) {
        let draw = |seed: u64, cut: Option<f64>, least: f64| {
            let mut noise = Noise::new(seed);
            let amplitude = 10f64.powf(noise.between(least.log10(), 3.3));
            stepped(&mut noise, amplitude, cut)
        };
        let found = |(values, period): &(Vec<f64>, f64)| !clipped(values, *period).is_empty();
        let good = (0..draws).filter(|seed| found(&draw(*seed, None, 5.0)));
        let lost = (0..draws).filter(|seed| {
            let (whole, cut) = (draw(*seed, None, 20.0), draw(*seed, Some(0.97), 20.0));
            let differ = whole.0.iter().zip(&cut.0).filter(|(a, b)| a != b).count();
            let phase = |i: usize| ((i as f64 / cut.1).fract() * 1e6).round() as usize % 1_000_000;
            let phases: HashSet<usize> = (0..cut.0.len()).map(phase).collect();
            phases.len() >= 256 && differ * 25 >= whole.0.len() && !found(&cut)
        });
        (good.collect(), lost.collect())
    }

    #[test]
    fn sines_of_few_steps_are_clipped_where_they_are() {
        assert_eq!(wrong(200), (vec![], vec![]));
    }

    #[test]
    #[ignore = "Monte Carlo: cargo test --release -- --ignored"]
    fn of_thousands_of_sines_few_are_called_clipped_that_are_not() {
        let (good, lost) = wrong(4000);
        // Less than one in a thousand.
        assert!(good.len() < 4 && lost.is_empty(), "{good:?} {lost:?}");
    }
}

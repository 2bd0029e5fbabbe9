//! The mean interval of impacts and its uncertainty, where onsets carry noise and intervals jitter.
//!
//! Let the k-th impact be at `t₀ + kT + w_k + e_k` with e white (onset noise, σ) and w a random walk
//! (cycle-to-cycle jitter, s). Differences d of times `m_j` indices apart then have the covariance Σ with
//! `m_j s² + 2σ²` on the diagonal and −σ² beside it, and T̂ = mᵀΣ⁻¹d/mᵀΣ⁻¹m with variance 1/mᵀΣ⁻¹m (Aitken
//! 1935). s = 0 gives the straight line through (index, time), σ = 0 the telescoping mean `(t_last −
//! t_first)/(n − 1)`.
//!
//! The ratio r = s/σ is not known, and few intervals say little about it. T̂ and its variance are therefore
//! averaged over r, weighted with the restricted likelihood (Patterson and Thompson 1971) and a prior: jitter
//! alone with a probability of 3/4, otherwise r half-Cauchy with scale 1/2 (Gelman 2006). The variance is the
//! mean of the variances plus the variance of the means. Each variance is that of a Student distribution of n
//! − 2 degrees of freedom, as the scale of Σ is estimated too.
//!
//! Coverage of the true T by the intervals ±1.96 u, in per cent (2000 simulated records each, standard error
//! 0.6 or less):
//!
//! | n  | r = 0 | 0.1 | 0.3 | 1 | 3 | ∞ |
//! |----|-------|-----|-----|---|---|---|
//! | 8  | 100 | 100 | 99.9 | 99.0 | 95.0 | 94.1 |
//! | 20 | 100 | 100 | 99.9 | 97.6 | 95.8 | 95.2 |
//! | 60 | 100 | 99.2 | 93.2 | 94.6 | 96.7 | 96.2 |
//!
//! Without jitter, u is about three times the uncertainty of a straight line, at any n. The margin is needed:
//! jitter of r = 7/n, which n impacts hardly show, more than doubles the uncertainty of a straight line.
//!
//! Neither noise of the onsets nor jitter makes neighbouring intervals positively correlated; a speed that
//! wanders does. Where neighbouring intervals are positively correlated, u is at least the standard
//! uncertainty of the mean of serially correlated values (Müller 2007). For 60 intervals with a correlation
//! of 0.3, 0.5 and 0.7, ±1.96 u then covers T in 93.8, 93.8 and 92.6 %; with 0.9 in 89 %, and most of these
//! are reported to wander.

use crate::mean::{Mean, average, mixture};
use crate::residuals::widened;
use std::f64::consts::FRAC_PI_2;
use vibro_record::median;

/// Mean interval between impacts, with its uncertainty.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Interval {
    /// Mean interval T in s.
    pub mean: f64,
    /// Standard uncertainty of the mean in s; NaN for only two impacts.
    pub std: f64,
    /// Serial correlation of neighbouring intervals: −1/2 for onset noise, 0 for jitter; NaN for fewer than
    /// four impacts.
    pub correlation: f64,
    /// Whether the intervals drift so slowly that `std` may be too small.
    pub wanders: bool,
}

/// The mean interval of impacts at `times` in s. Their `indices` increase; missed impacts leave gaps in them.
///
/// `None` for fewer than two.
pub fn interval(times: &[f64], indices: &[usize]) -> Option<Interval> {
    let d: Vec<f64> = times.windows(2).map(|w| w[1] - w[0]).collect();
    let m: Vec<f64> = indices.windows(2).map(|w| (w[1] - w[0]) as f64).collect();
    if d.is_empty() || m.len() != d.len() {
        return None;
    }
    if d.len() == 1 {
        return Some(Interval { mean: d[0] / m[0], std: f64::NAN, correlation: f64::NAN, wanders: false });
    }
    let widened = widened(d.len() - 1).powi(2);
    let fits = nodes(&d, &m).into_iter().map(|g| (g.likelihood, g.mean, widened * g.variance * g.cofactor));
    let (mean, variance) = mixture(&fits.collect::<Vec<_>>());
    let correlation = correlation(&d, &m);
    let each: Vec<f64> = d.iter().zip(&m).map(|(d, m)| d / m).collect();
    let slow = (correlation > 0.0).then(|| Mean::of(&each));
    let least = slow.and_then(|s| s.std).unwrap_or(0.0);
    let wanders = slow.is_some_and(|s| s.wanders);
    Some(Interval { mean, std: variance.sqrt().max(least), correlation, wanders })
}

/// Prior probability that intervals jitter and onsets carry no noise. A larger one widens the uncertainty of
/// a train without jitter; a smaller one covers less where noise hides the jitter.
const JITTER_ALONE: f64 = 0.75;
/// Prior median of the ratio of jitter to onset noise, where both are present.
const SCALE: f64 = 0.5;
/// Number of finite ratios above 0: so few give the same average as thousands, within 1 % of the
/// uncertainty.
const RATIOS: usize = 23;
/// Largest finite ratio: beyond it onset noise does not show in the mean.
const LARGEST: f64 = 30.0;
/// Logarithm of a ratio's weight over the largest weight, below which the ratio is left out.
const NEGLIGIBLE: f64 = -9.0;

/// Smallest step of the logarithm of the ratio; no record needs a finer one.
const FINEST: f64 = 0.005;

/// Fits at ratios of jitter to onset noise from 0 to ∞. Finite ratios are spaced evenly in the logarithm,
/// over the range in which the likelihood counts. Each likelihood includes the prior probability of its
/// ratio.
fn nodes(d: &[f64], m: &[f64]) -> Vec<Gls> {
    let node = |ratio: f64, prior: f64| {
        let fit = gls(d, m, ratio.atan());
        Gls { likelihood: prior.ln() + fit.likelihood, ..fit }
    };
    // Smallest ratio above 0: below it jitter does not show in the mean.
    let least = 0.3 / (m.iter().sum::<f64>() + 1.0);
    let below = |ratio: f64| (1.0 - JITTER_ALONE) * (ratio / SCALE).atan() / FRAC_PI_2;
    let (mut from, mut to) = (least.ln(), LARGEST.ln());
    let mut all = loop {
        let step = (to - from) / (RATIOS - 1) as f64;
        let at = |i: f64| (from + i.clamp(0.0, (RATIOS - 1) as f64) * step).exp();
        let between: Vec<Gls> = (0..RATIOS)
            .map(|i| i as f64)
            .map(|i| node(at(i), below(at(i + 0.5)) - below(at(i - 0.5))))
            .collect();
        let highest = between.iter().map(|n| n.likelihood).fold(f64::NEG_INFINITY, f64::max);
        let counts = |n: &Gls| n.likelihood > highest + NEGLIGIBLE;
        let first = between.iter().position(counts).unwrap_or(0).saturating_sub(1);
        let last = (between.iter().rposition(counts).unwrap_or(RATIOS) + 1).min(RATIOS - 1);
        // A long record has a narrow likelihood: narrow the range of ratios to it.
        if last - first > RATIOS / 2 || step < FINEST {
            break between;
        }
        (from, to) = (from + first as f64 * step, from + last as f64 * step);
    };
    all.push(node(0.0, below(least)));
    all.push(node(f64::INFINITY, 1.0 - below(LARGEST)));
    all
}

/// Serial correlation of neighbouring intervals, none of them over a missed impact: the mean product of
/// neighbouring deviations over the variance. Without a gap it is the usual quotient of sums, which has one
/// product fewer than squares.
fn correlation(d: &[f64], m: &[f64]) -> f64 {
    let single: Vec<f64> = d.iter().zip(m).filter(|(_, m)| **m == 1.0).map(|(d, _)| *d).collect();
    let (n, mean) = (single.len() as f64, average(&single));
    let squares: f64 = single.iter().map(|d| (d - mean).powi(2)).sum();
    let neighbours = d.windows(2).zip(m.windows(2)).filter(|(_, m)| m[0] == 1.0 && m[1] == 1.0);
    let (pairs, products) =
        neighbours.fold((0.0, 0.0), |(n, sum), (d, _)| (n + 1.0, sum + (d[0] - mean) * (d[1] - mean)));
    if pairs >= 2.0 && squares > 0.0 { products / squares * (n - 1.0) / pairs } else { f64::NAN }
}

#[derive(Debug, Clone, Copy)]
struct Gls {
    mean: f64,
    /// 1/mᵀΣ⁻¹m for unit variance.
    cofactor: f64,
    /// Estimated variance factor of Σ, in s².
    variance: f64,
    /// Restricted log-likelihood, up to a constant.
    likelihood: f64,
}

/// Generalised least squares at one ratio of jitter to onset noise, given as its arctangent `angle`; one pass
/// down the bidiagonal factor of `Σ = LDLᵀ`.
fn gls(d: &[f64], m: &[f64], angle: f64) -> Gls {
    let (s2, sigma2) = (angle.sin().powi(2), angle.cos().powi(2));
    let (mut pivot, mut before) = (f64::INFINITY, (0.0, 0.0));
    let (mut mm, mut md, mut dd, mut log_det) = (0.0, 0.0, 0.0, 0.0);
    // Fit deviations from the median interval, so that long records lose no digits.
    let near = median(d.iter().zip(m).map(|(d, m)| d / m));
    for (d, m) in d.iter().zip(m) {
        let l = -sigma2 / pivot;
        let now = (m - l * before.0, d - near * m - l * before.1);
        pivot = m * s2 + 2.0 * sigma2 + l * sigma2;
        mm += now.0 * now.0 / pivot;
        md += now.0 * now.1 / pivot;
        dd += now.1 * now.1 / pivot;
        log_det += pivot.ln();
        before = now;
    }
    let free = d.len() as f64 - 1.0;
    let variance = ((dd - md * md / mm) / free).max(0.0);
    // A variance below the rounding of the interval carries no information on the ratio.
    let least = (f64::EPSILON * near).powi(2).max(f64::MIN_POSITIVE);
    let likelihood = -0.5 * (free * variance.max(least).ln() + log_det + mm.ln());
    Gls { mean: near + md / mm, cofactor: 1.0 / mm, variance, likelihood }
}

/// Impacts that count, numbered as if none were missed.
pub struct CountedImpacts {
    /// Indices of the impacts that count, in the list of all.
    pub kept: Vec<usize>,
    /// Their numbers in the train; missed impacts leave gaps.
    pub index: Vec<usize>,
    /// Number of impacts missing from intervals of several times the median.
    pub missed: usize,
    /// Number of impacts that follow another too soon; they do not count.
    pub doubled: usize,
}

/// Robust standard deviations from the median beyond which the length of an interval is not chance.
const OUTSIDE: f64 = 5.0;
/// Largest share of odd intervals that counts as missed or doubled impacts. More belong to the motion: two
/// impacts a cycle at uneven distances make half of the intervals odd.
const ACCIDENTS: f64 = 0.4;

/// Numbers the impacts at `times` in s, whose intervals are `steps` in s. With `complete` every interval
/// counts as one.
///
/// An interval below half of the median ends with an extra impact; one above 1.5 medians lacks impacts. Where
/// intervals scatter as far as that, or too many are odd, both are unknown, and every interval counts as one.
pub fn count(times: &[f64], steps: &[f64], complete: bool) -> CountedImpacts {
    let typical = median(steps);
    let off: Vec<f64> = steps.iter().map(|d| (d - typical).abs()).collect();
    let scatter = OUTSIDE * median(&off) / 0.674_5;
    let odd = |d: f64| (d - typical).abs() > scatter.max(0.5 * typical);
    let accidents = steps.iter().filter(|d| odd(**d)).count() as f64 <= ACCIDENTS * steps.len() as f64;
    let judged = !complete && accidents && scatter <= 0.5 * typical;
    let mut counted = CountedImpacts { kept: vec![0], index: vec![0], missed: 0, doubled: 0 };
    let (mut last, mut at) = (0, 0);
    for i in 1..times.len() {
        let step = times[i] - times[last];
        let odd = judged && odd(step);
        if odd && step < typical {
            counted.doubled += 1;
            continue;
        }
        let intervals = if odd { (step / typical).round().clamp(1.0, 1e9) as usize } else { 1 };
        counted.missed += intervals - 1;
        (last, at) = (i, at + intervals);
        counted.kept.push(i);
        counted.index.push(at);
    }
    counted
}

/// Intervals are alike where they differ by less than this fraction of the shorter.
const ALIKE: f64 = 0.1;
/// Most impacts in one round of a pattern.
const LONGEST: usize = 8;
/// Fewest rounds of a pattern in a record.
const SEEN: usize = 3;
/// One unlike interval in a round of p makes 2/p of all neighbours unlike. A pattern needs this fraction of
/// that number, as the ends of a record may lack one.
const UNLIKE: f64 = 0.8;

/// Number of impacts after which all intervals repeat although neighbours differ, as for two impacts a cycle;
/// `None` where there is no such number.
pub fn pattern(steps: &[f64]) -> Option<usize> {
    let unlike = |lag: usize| {
        let pairs = steps.iter().zip(steps.iter().skip(lag));
        pairs.filter(|(a, b)| (*a - *b).abs() > ALIKE * a.min(**b)).count()
    };
    let part = unlike(1) as f64 / steps.len() as f64;
    let repeats = |p: &usize| unlike(*p) == 0 && part >= UNLIKE * 2.0 / *p as f64;
    (2..=LONGEST).take_while(|p| steps.len() >= SEEN * p).find(repeats)
}

/// Times less the mean shift of each impact within a pattern of `length` impacts: an even train.
pub fn evened(times: &[f64], length: usize) -> Vec<f64> {
    let rounds: f64 = times.windows(length + 1).map(|w| w[length] - w[0]).sum();
    let interval = rounds / (length * (times.len() - length)) as f64;
    let shifts: Vec<f64> = times.iter().enumerate().map(|(i, t)| t - interval * i as f64).collect();
    let mean = |place: usize| {
        let same = shifts.iter().skip(place).step_by(length);
        same.clone().sum::<f64>() / same.count() as f64
    };
    let means: Vec<f64> = (0..length).map(mean).collect();
    let common = means.iter().sum::<f64>() / length as f64;
    times.iter().enumerate().map(|(i, t)| t - means[i % length] + common).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{DMatrix, DVector};
    use vibro_math::Noise;

    const TIMES: [f64; 6] = [0.1, 1.2, 1.9, 3.05, 3.9, 5.2];

    fn parts() -> (Vec<f64>, Vec<f64>) {
        (TIMES.windows(2).map(|w| w[1] - w[0]).collect(), vec![1.0; 5])
    }

    #[test]
    fn jitter_alone_gives_the_telescoping_mean() {
        let (d, m) = parts();
        let fit = gls(&d, &m, FRAC_PI_2);
        // A few roundings of numbers of size 5.
        assert!((fit.mean - 5.1 / 5.0).abs() < 1e-14, "{fit:?}");
        let s2 = d.iter().map(|d| (d - 1.02).powi(2)).sum::<f64>() / 4.0;
        assert!((fit.variance * fit.cofactor - s2 / 5.0).abs() < 1e-14, "{fit:?}");
    }

    #[test]
    fn onset_noise_alone_gives_the_straight_line() {
        let (d, m) = parts();
        let fit = gls(&d, &m, 0.0);
        // The textbook line through (0, t₀) … (5, t₅).
        let (k, t) = (2.5, TIMES.iter().sum::<f64>() / 6.0);
        let sxx: f64 = (0..6).map(|i| (f64::from(i) - k).powi(2)).sum();
        let sxy: f64 = TIMES.iter().enumerate().map(|(i, x)| (i as f64 - k) * (x - t)).sum();
        let slope = sxy / sxx;
        let rest: f64 = TIMES.iter().enumerate().map(|(i, x)| (x - t - slope * (i as f64 - k)).powi(2)).sum();
        assert!((fit.mean - slope).abs() < 1e-14, "{fit:?} {slope}");
        assert!((fit.variance * fit.cofactor - rest / 4.0 / sxx).abs() < 1e-14, "{fit:?}");
    }

    #[test]
    fn a_missed_impact_counts_in_the_index() {
        let times: Vec<f64> = [0.0, 1.0, 3.0, 4.0, 6.0].iter().map(|k| 2.0 + 0.5 * k).collect();
        let found = interval(&times, &[0, 1, 3, 4, 6]).unwrap();
        assert!((found.mean - 0.5).abs() < 1e-15 && found.std < 1e-15, "{found:?}");
        assert_eq!(interval(&[1.0], &[0]), None);
    }

    #[test]
    fn intervals_beside_a_missed_impact_are_no_neighbours() {
        // Deviations 0.1, 0.2, −0.1 and −0.2 from a mean of 1, with a gap before the third.
        let d = [1.1, 1.2, 3.0, 0.9, 0.8];
        let m = [1.0, 1.0, 3.0, 1.0, 1.0];
        // Products 0.02 and 0.02, squares of 0.1 in all, n − 1 = 3 over two pairs; few roundings of numbers
        // near 1.
        assert!((correlation(&d, &m) - 0.04 / 0.1 * 3.0 / 2.0).abs() < 1e-13);
        assert!(correlation(&[1.1, 0.9, 2.0, 1.2], &[1.0, 1.0, 2.0, 1.0]).is_nan());
    }

    #[test]
    fn one_pass_is_aitken_by_whole_matrices() {
        let d = DVector::from_vec(TIMES.windows(2).map(|w| w[1] - w[0]).collect());
        // Two impacts are missed.
        let m = DVector::from_vec(vec![1.0, 2.0, 1.0, 1.0, 2.0]);
        for ratio in [0.0, 0.2, 1.0, 4.0, f64::INFINITY] {
            let (s2, sigma2) = (ratio.atan().sin().powi(2), ratio.atan().cos().powi(2));
            let sigma = DMatrix::from_fn(5, 5, |i, j| match i.abs_diff(j) {
                0 => m[i] * s2 + 2.0 * sigma2,
                1 => -sigma2,
                _ => 0.0,
            });
            let inverse = sigma.clone().try_inverse().unwrap();
            let mm = (m.transpose() * &inverse * &m)[0];
            let mean = (m.transpose() * &inverse * &d)[0] / mm;
            let rest = &d - &m * mean;
            let variance = (rest.transpose() * &inverse * &rest)[0] / 4.0;
            let likelihood = -0.5 * (4.0 * variance.ln() + sigma.determinant().ln() + mm.ln());
            let found = gls(d.as_slice(), m.as_slice(), ratio.atan());
            // Condition numbers are below 20.
            for (a, b) in [
                (found.mean, mean),
                (found.cofactor, 1.0 / mm),
                (found.variance, variance),
                (found.likelihood, likelihood),
            ] {
                assert!((a - b).abs() < 1e-13 * (1.0 + b.abs()), "{ratio}: {a} {b}");
            }
        }
    }

    /// Reference: mean and standard uncertainty, averaged over even steps of the prior probability of ratios
    /// from 0 to ∞.
    fn plain(d: &[f64], m: &[f64], steps: usize) -> (f64, f64) {
        let mut fits = vec![(0.75, gls(d, m, FRAC_PI_2))];
        for i in 0..steps {
            let share = (i as f64 + 0.5) / steps as f64;
            let ratio = 0.5 * (FRAC_PI_2 * share).tan();
            fits.push((0.25 / steps as f64, gls(d, m, ratio.atan())));
        }
        let most = fits.iter().map(|f| f.1.likelihood).fold(f64::NEG_INFINITY, f64::max);
        let parts: Vec<f64> = fits.iter().map(|(p, f)| p * (f.likelihood - most).exp()).collect();
        let total: f64 = parts.iter().sum();
        let free = d.len() as f64 - 1.0;
        let mean = fits.iter().zip(&parts).map(|(f, p)| p * f.1.mean).sum::<f64>() / total;
        let each = |f: &Gls| f.variance * f.cofactor * free / (free - 2.0) + (f.mean - mean).powi(2);
        let variance = fits.iter().zip(&parts).map(|(f, p)| p * each(&f.1)).sum::<f64>() / total;
        (mean, variance.sqrt())
    }

    #[test]
    fn few_ratios_average_as_many_do() {
        for (n, seed) in [(8, 1), (20, 2), (60, 3), (2000, 4)] {
            for (onset, jitter) in [(0.02, 0.0), (0.02, 0.004), (0.02, 0.02), (0.0, 0.02)] {
                let mut noise = Noise::new(seed);
                let mut walk = 0.0;
                let times: Vec<f64> = (0..n)
                    .map(|_| {
                        walk += 1.0 + jitter * noise.normal();
                        walk + onset * noise.normal()
                    })
                    .collect();
                let d: Vec<f64> = times.windows(2).map(|w| w[1] - w[0]).collect();
                let (mean, plain_std) = plain(&d, &vec![1.0; n - 1], 4000);
                let found = interval(&times, &(0..n).collect::<Vec<_>>()).unwrap();
                // Where chance correlates the intervals, the uncertainty is at least that of a mean of
                // correlated values.
                let least = if found.correlation > 0.0 { Mean::of(&d).std.unwrap() } else { 0.0 };
                let std = plain_std.max(least);
                // Error of the quadrature: half steps of the logarithm of the ratio, 0.2 or less, squared and
                // over 24, and the ends that are cut off.
                let case = format!("n {n}, seed {seed}, {onset} {jitter}: {found:?}, plain {mean} {std}");
                assert!((found.mean - mean).abs() < 0.01 * plain_std, "{case}");
                assert!((found.std / std - 1.0).abs() < 0.01, "{case}");
            }
        }
    }
}

#[cfg(test)]
mod counts {
    use super::*;
    use vibro_math::Noise;

    #[test]
    fn intervals_that_repeat_are_a_pattern_and_chance_is_none() {
        let twin: Vec<f64> = (0..30).map(|i| if i % 2 == 0 { 0.03 } else { 0.09 }).collect();
        assert_eq!((pattern(&twin), pattern(&twin[1..])), (Some(2), Some(2)));
        let three: Vec<f64> = (0..30).map(|i| [0.1, 0.1, 0.2][i % 3]).collect();
        assert_eq!(pattern(&three), Some(3));
        assert_eq!(pattern(&[0.1; 30]), None);
        for seed in 0..500 {
            let mut noise = Noise::new(seed);
            // First case: one impact in five is missed by chance. Second case: exponentially distributed
            // intervals.
            let missing: Vec<f64> = (0..40).map(|_| if noise.uniform() < 0.2 { 0.2 } else { 0.1 }).collect();
            assert_eq!(pattern(&missing), None, "seed {seed}");
            let any: Vec<f64> = (0..40).map(|_| -noise.uniform().max(1e-9).ln()).collect();
            assert_eq!(pattern(&any), None, "seed {seed}");
        }
    }

    #[test]
    fn evened_times_are_even() {
        let times: Vec<f64> = (0..20).map(|i| 0.06 * i as f64 + [0.0, -0.03][i % 2]).collect();
        for (i, t) in evened(&times, 2).iter().enumerate() {
            // The mean shift of −0.015 remains; a few roundings of numbers near 1.
            assert!((t - (0.06 * i as f64 - 0.015)).abs() < 1e-14, "{t}");
        }
    }

    /// One missing impact breaks a pattern: none is found, and no impact counts as missed.
    #[test]
    fn a_broken_pattern_misses_nothing() {
        let mut times: Vec<f64> =
            (0..100).map(|i| 0.12 * f64::from(i / 2) + if i % 2 == 1 { 0.03 } else { 0.0 }).collect();
        times.remove(21);
        let steps: Vec<f64> = times.windows(2).map(|w| w[1] - w[0]).collect();
        let found = count(&times, &steps, false);
        assert_eq!((pattern(&steps), found.kept.len(), found.missed, found.doubled), (None, 99, 0, 0));
    }
}

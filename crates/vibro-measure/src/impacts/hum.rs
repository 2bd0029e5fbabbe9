//! Mains hum: a sine of 50 or 60 Hz with its harmonics, fitted between the impacts and removed.

use super::background::{background, median};
use super::ringing::bursts;
use nalgebra::{DMatrix, DVector};
use serde::Serialize;
use std::f64::consts::TAU;
use vibro_record::Finding;

/// A fitted mains sine.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[non_exhaustive]
pub struct Hum {
    /// Frequency in Hz, the mean where the record was fitted in pieces.
    pub frequency: f64,
    /// Amplitude of the fundamental, in the unit of the trace.
    pub amplitude: f64,
    /// Harmonics that were fitted, the fundamental counted.
    pub harmonics: usize,
}

/// Highest harmonic that is fitted.
const HARMONICS: usize = 7;
/// Mains frequencies stay within this of their nominal value, in Hz.
const TOLERANCE: f64 = 0.5;
/// Mains frequencies wander, so longer records are fitted in pieces of this length, in s.
const PIECE: f64 = 10.0;
/// The noise between impacts must fall to this part of what it was, or it was no hum.
const WORTH: f64 = 0.8;

/// What was done about hum.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Treated {
    /// Hum that was removed.
    pub removed: Option<Hum>,
    /// How far hum that was kept and noise reach from the level.
    pub reach: Option<f64>,
}

/// Removes the hum from `values`, sampled at `rate` in Hz, where there is any that matters; with `keep` it stays, and its reach is given.
///
/// Each piece of at least five cycles is fitted by least squares with bisquare weights (Beaton and Tukey 1974), so impacts do not
/// count; nothing is removed where that does not lower the noise between impacts by a fifth. Where impacts come as often as the hum
/// or half as often, a sine with its harmonics fits them as well: the hum stays, and a finding says so.
pub fn remove(values: &mut [f64], rate: f64, keep: bool, findings: &mut Vec<Finding>) -> Treated {
    let piece = (PIECE * rate).min(values.len() as f64) as usize;
    if (piece as f64) < 0.1 * rate || piece < 32 {
        return Treated::default();
    }
    let mut cleaned = Vec::with_capacity(values.len());
    let mut highest = 0.0f64;
    let mut hums: Vec<Hum> = Vec::new();
    let mut rest: &[f64] = values;
    while !rest.is_empty() {
        // A short remainder goes with the piece before it.
        let take = if rest.len() < 2 * piece { rest.len() } else { piece };
        let (now, later) = rest.split_at(take);
        match fitted(now, rate) {
            Some((hum, model)) => {
                highest = model.iter().fold(highest, |h, m| h.max(m.abs()));
                cleaned.extend(now.iter().zip(model).map(|(v, m)| v - m));
                hums.push(hum);
            }
            None => cleaned.extend_from_slice(now),
        }
        rest = later;
    }
    if hums.is_empty() {
        return Treated::default();
    }
    // A sine ends at its amplitude: what exceeds hum and noise together is neither.
    let kept = Treated { removed: None, reach: Some(highest + background(&cleaned).reach) };
    let mean = |f: &dyn Fn(&Hum) -> f64| hums.iter().map(f).sum::<f64>() / hums.len() as f64;
    let frequency = mean(&|h| h.frequency);
    if keep {
        return kept;
    }
    if let Some(impacts) = burst_rate(&cleaned, rate).filter(|r| shares_lines(*r, frequency)) {
        findings.push(
            Finding::caution("hum-or-impacts").number("frequency", frequency).number("impacts", impacts),
        );
        return kept;
    }
    values.copy_from_slice(&cleaned);
    let harmonics = hums.iter().map(|h| h.harmonics).max().unwrap_or(1);
    let removed = Hum { frequency, amplitude: mean(&|h| h.amplitude), harmonics };
    Treated { removed: Some(removed), reach: None }
}

/// Bursts a second in what remains without the hum, from the median of their distances.
fn burst_rate(cleaned: &[f64], rate: f64) -> Option<f64> {
    let found = background(cleaned);
    let centred: Vec<f64> = cleaned.iter().map(|v| v - found.level).collect();
    let starts: Vec<f64> = bursts(&centred, found.reach, None).each.iter().map(|b| b.start as f64).collect();
    let steps: Vec<f64> = starts.windows(2).map(|w| w[1] - w[0]).collect();
    (steps.len() > 1).then(|| rate / median(&steps))
}

/// Whether a train of so many impacts a second has spectral lines where the hum has its own.
fn shares_lines(impacts: f64, hum: f64) -> bool {
    impacts > 0.9 * hum || (impacts / hum - 0.5).abs() < 0.01
}

/// The sine that lowers the noise most, and its samples without the offset.
fn fitted(values: &[f64], rate: f64) -> Option<(Hum, Vec<f64>)> {
    let before = background(values);
    let limited: Vec<f64> =
        values.iter().map(|v| (v - before.level).clamp(-3.0 * before.sigma, 3.0 * before.sigma)).collect();
    let length = values.len() as f64 / rate;
    let (frequency, power) = [50.0, 60.0]
        .into_iter()
        .filter(|nominal| nominal + TOLERANCE < 0.5 * rate)
        .flat_map(|nominal| {
            let steps = (TOLERANCE * 4.0 * length).ceil().max(1.0) as i64;
            (-steps..=steps).map(move |k| nominal + TOLERANCE * k as f64 / steps as f64)
        })
        .map(|f| (f, power(&limited, f / rate)))
        .max_by(|a, b| a.1.total_cmp(&b.1))?;
    // A sine of amplitude 2√power/n has half its square of the variance; a tenth cannot lower the noise by a fifth.
    let n = values.len() as f64;
    if 2.0 * power / n < 0.1 * limited.iter().map(|v| v * v).sum::<f64>() {
        return None;
    }
    let orders = HARMONICS.min((0.5 * rate / frequency * 0.98) as usize).max(1);
    let (frequency, model) = refined(values, frequency, rate, orders)?;
    let amplitude = model.0[1].hypot(model.0[2]);
    let after: Vec<f64> = values.iter().zip(&model.1).map(|(v, m)| v - m).collect();
    (background(&after).sigma < WORTH * before.sigma)
        .then_some((Hum { frequency, amplitude, harmonics: orders }, model.1))
}

/// Squared amplitude of the sine of `f` cycles a sample.
fn power(values: &[f64], f: f64) -> f64 {
    let turn = num_complex::Complex64::cis(-TAU * f);
    let mut z = num_complex::Complex64::new(1.0, 0.0);
    let mut sum = num_complex::Complex64::default();
    for v in values {
        sum += z * v;
        z *= turn;
    }
    sum.norm_sqr()
}

type Model = (DVector<f64>, Vec<f64>);

/// Weighted linear fits at a frequency that a Gauss-Newton step refines with each change of the weights.
fn refined(values: &[f64], mut frequency: f64, rate: f64, orders: usize) -> Option<(f64, Model)> {
    let p = 2 * orders + 2;
    let mut weights = vec![1.0; values.len()];
    let mut model = None;
    for _ in 0..8 {
        // Offset, cosine and sine of each order, and the derivative of the fundamental by frequency after the first fit.
        let (a, b) = model.as_ref().map_or((0.0, 0.0), |(c, _): &Model| (c[1], c[2]));
        let columns = if a == 0.0 && b == 0.0 { p - 1 } else { p };
        let row = |i: usize| -> Vec<f64> {
            let t = (i as f64 - 0.5 * values.len() as f64) / rate;
            let mut row = Vec::with_capacity(columns);
            row.push(1.0);
            for order in 1..=orders {
                let (s, c) = (TAU * frequency * order as f64 * t).sin_cos();
                row.extend([c, s]);
            }
            if columns == p {
                let (c, s) = (row[1], row[2]);
                row.push(TAU * t * (b * c - a * s));
            }
            row
        };
        let mut normal = DMatrix::<f64>::zeros(columns, columns);
        let mut right = DVector::<f64>::zeros(columns);
        for (i, (v, w)) in values.iter().zip(&weights).enumerate().filter(|(_, (_, w))| **w > 0.0) {
            let row = row(i);
            for (j, x) in row.iter().enumerate() {
                right[j] += w * x * v;
                for (k, y) in row.iter().enumerate().take(j + 1) {
                    normal[(j, k)] += w * x * y;
                }
            }
        }
        normal.fill_upper_triangle_with_lower_triangle();
        let solved = normal.cholesky()?.solve(&right);
        let samples: Vec<f64> = (0..values.len())
            .map(|i| row(i).iter().zip(solved.iter()).skip(1).map(|(x, c)| x * c).sum())
            .collect();
        let residual: Vec<f64> = values.iter().zip(&samples).map(|(v, m)| v - m - solved[0]).collect();
        let spread = 4.685 * median(&residual.iter().map(|r| r.abs()).collect::<Vec<f64>>()) / 0.674_5;
        if spread > 0.0 {
            weights = residual.iter().map(|r| (1.0 - (r / spread).powi(2)).max(0.0).powi(2)).collect();
        }
        if columns == p {
            frequency += solved[p - 1].clamp(-TOLERANCE, TOLERANCE);
        }
        model = Some((solved, samples));
    }
    model.filter(|_| frequency > 0.0).map(|m| (frequency, m))
}

#[cfg(test)]
mod tests {
    use super::*;
    use vibro_math::Noise;

    #[test]
    fn hum_larger_than_the_impacts_goes_and_the_impacts_stay() {
        let rate = 1000.0;
        let mut noise = Noise::new(3);
        let clean: Vec<f64> =
            (0..4000).map(|i| 0.01 * noise.normal() + if i % 133 < 4 { 1.0 } else { 0.0 }).collect();
        let hum = |i: usize| {
            let x = TAU * 50.07 * i as f64 / rate;
            1.5 * (x + 0.4).sin() + 0.3 * (3.0 * x).cos()
        };
        let mut values: Vec<f64> = clean.iter().enumerate().map(|(i, v)| v + hum(i)).collect();
        let found = remove(&mut values, rate, false, &mut Vec::new()).removed.unwrap();
        // A sine of amplitude A in N samples of noise σ: u(f) = √6 σ/(π A T √N) = 2e-5 Hz, u(A) = σ√(2/N) = 2.2e-4.
        // Bisquare weights cost 5 %, impacts in the tails of the weights more: five times as much.
        assert!((found.frequency - 50.07).abs() < 1e-4, "{found:?}");
        assert!((found.amplitude - 1.5).abs() < 1.1e-3, "{found:?}");
        let worst = values.iter().zip(&clean).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        // Sixteen parameters of u = 2.2e-4 each at their worst: 16·2.2e-4.
        assert!(worst < 4e-3, "{worst}");
    }

    #[test]
    fn impacts_without_hum_are_left_alone() {
        let mut noise = Noise::new(4);
        let values: Vec<f64> =
            (0..4000).map(|i| 0.01 * noise.normal() + if i % 125 < 4 { 1.0 } else { 0.0 }).collect();
        let mut after = values.clone();
        assert_eq!(remove(&mut after, 1000.0, false, &mut Vec::new()), Treated::default());
        assert_eq!(values, after);
    }

    #[test]
    fn a_train_at_the_frequency_of_the_mains_is_no_hum() {
        // Decaying pulses of 20 ms, one every 20 ms: there is no quiet background.
        let rate = 5000.0;
        let mut noise = Noise::new(6);
        let values: Vec<f64> =
            (0..10_000).map(|i| 0.01 * noise.normal() + (-f64::from(i % 100) / 20.0).exp()).collect();
        let (mut after, mut findings) = (values.clone(), Vec::new());
        assert_eq!(remove(&mut after, rate, false, &mut findings).removed, None);
        assert_eq!(values, after);
        assert!(findings.iter().any(|f| f.code == "hum-or-impacts"), "{findings:?}");
    }
}

//! Mains hum: a sine of 50 or 60 Hz with its harmonics, fitted between the impacts and removed.

use super::background::{background, bursts};
use crate::mains::{HARMONICS, Hum, MAINS};
use nalgebra::{DMatrix, DVector};
use num_complex::Complex64;
use std::f64::consts::TAU;
use vibro_record::{Finding, median};

/// Largest deviation of a mains frequency from its nominal value, in Hz.
const TOLERANCE: f64 = 0.5;
/// Mains frequencies wander, so longer records are fitted in pieces of this length, in s.
const PIECE: f64 = 10.0;
/// Frequency of impacts over that of the hum, above which none of its harmonics fits the impacts.
const FASTER: f64 = 1.5 * HARMONICS as f64;
/// Largest noise between impacts after the removal of hum, over that before; with more it was no hum.
const WORTH: f64 = 0.8;

/// Removes the hum from `values` in a `unit`, sampled at `rate` in Hz, if it is significant, and returns it.
///
/// Each piece of at least five cycles is fitted by least squares with bisquare weights (Beaton and Tukey
/// 1974), so impacts get no weight. Nothing is removed where that lowers the noise between impacts by less
/// than a fifth. Where impacts come as often as the hum or half as often, a sine with its harmonics fits
/// them as well: the hum stays, and a finding reports it.
pub fn remove(values: &mut [f64], (rate, unit): (f64, &str), findings: &mut Vec<Finding>) -> Option<Hum> {
    let piece = (PIECE * rate).min(values.len() as f64) as usize;
    if (piece as f64) < 0.1 * rate || piece < 32 {
        return None;
    }
    let mut cleaned = values.to_vec();
    let mut hums: Vec<Hum> = Vec::new();
    // A remainder shorter than a piece joins the last piece.
    let pieces = values.len() / piece;
    for k in 0..pieces {
        let end = if k + 1 == pieces { values.len() } else { (k + 1) * piece };
        let now = &mut cleaned[k * piece..end];
        if let Some((hum, model)) = fitted(now, rate) {
            now.iter_mut().zip(model).for_each(|(v, m)| *v -= m);
            hums.push(hum);
        }
    }
    let harmonics = hums.iter().map(|h| h.harmonics).max()?;
    let mean = |f: fn(&Hum) -> f64| hums.iter().map(f).sum::<f64>() / hums.len() as f64;
    let found = Hum { frequency: mean(|h| h.frequency), amplitude: mean(|h| h.amplitude), harmonics };
    if let Some(impacts) = burst_rate(&cleaned, rate, 1.0 / (FASTER * found.frequency))
        && (impacts > 0.9 * found.frequency || (impacts / found.frequency - 0.5).abs() < 0.01)
    {
        let either = Finding::caution("hum-or-impacts").number("frequency", found.frequency);
        findings.push(either.number("impacts", impacts));
        return None;
    }
    values.copy_from_slice(&cleaned);
    findings.push(found.removed(unit));
    Some(found)
}

/// Bursts a second in the values without hum, from the median of their distances. Bursts that follow another
/// within a `pause` in s are its ringing.
fn burst_rate(cleaned: &[f64], rate: f64, pause: f64) -> Option<f64> {
    let found = background(cleaned);
    let centred: Vec<f64> = cleaned.iter().map(|v| v - found.level).collect();
    let pause = Some((pause * rate) as usize);
    let starts: Vec<f64> = bursts(&centred, found.reach, pause).0.iter().map(|b| b.start as f64).collect();
    let steps: Vec<f64> = starts.windows(2).map(|w| w[1] - w[0]).collect();
    (steps.len() > 1).then(|| rate / median(&steps))
}

/// The mains sine with its harmonics that fits best, and its samples without the offset; `None` where it does
/// not lower the noise enough.
fn fitted(values: &[f64], rate: f64) -> Option<(Hum, Vec<f64>)> {
    let before = background(values);
    let limit = 3.0 * before.sigma;
    let limited: Vec<f64> = values.iter().map(|v| (v - before.level).clamp(-limit, limit)).collect();
    let nominal = MAINS.into_iter().filter(|nominal| nominal + TOLERANCE < 0.5 * rate);
    let (frequency, _) =
        nominal.map(|nominal| strongest(&limited, nominal, rate)).max_by(|a, b| a.1.total_cmp(&b.1))?;
    let power = power(&limited, frequency / rate);
    // A sine of amplitude A = 2√power/n adds A²/2 to the variance; less than a tenth of it cannot lower the
    // noise by a fifth.
    let n = values.len() as f64;
    if 2.0 * power / n < 0.1 * limited.iter().map(|v| v * v).sum::<f64>() {
        return None;
    }
    let harmonics = HARMONICS.min((0.5 * rate / frequency * 0.98) as usize).max(1);
    let (hum, model) = refined(values, frequency, rate, harmonics)?;
    let after: Vec<f64> = values.iter().zip(&model).map(|(v, m)| v - m).collect();
    (background(&after).sigma < WORTH * before.sigma).then_some((hum, model))
}

/// The frequency in Hz near a nominal one whose Fourier sum is largest, and about its squared magnitude.
///
/// Sums at the nominal frequency over stretches of a twentieth of a second are turned to the others: within a
/// stretch a sine [`TOLERANCE`] away turns by 0.16, which takes 0.1 % of its amplitude.
fn strongest(values: &[f64], nominal: f64, rate: f64) -> (f64, f64) {
    let stretch = ((0.05 * rate) as usize).max(1);
    let turn = Complex64::cis(-TAU * nominal / rate);
    let mut z = Complex64::ONE;
    let mut sum_of = |part: &[f64]| {
        part.iter().fold(Complex64::ZERO, |sum, v| {
            let next = sum + z * v;
            z *= turn;
            next
        })
    };
    let sums: Vec<Complex64> = values.chunks(stretch).map(&mut sum_of).collect();
    let steps = (TOLERANCE * 4.0 * values.len() as f64 / rate).ceil().max(1.0) as i64;
    let of = |k: i64| {
        let off = TOLERANCE * k as f64 / steps as f64;
        let turn = Complex64::cis(-TAU * off * stretch as f64 / rate);
        let turned =
            sums.iter().fold((Complex64::ZERO, Complex64::ONE), |(sum, z), s| (sum + z * s, z * turn));
        (nominal + off, turned.0.norm_sqr())
    };
    (-steps..=steps).map(of).max_by(|a, b| a.1.total_cmp(&b.1)).unwrap_or((nominal, 0.0))
}

/// Squared magnitude of the Fourier sum at `f` cycles a sample; a sine has the amplitude 2√power/n.
fn power(values: &[f64], f: f64) -> f64 {
    let turn = Complex64::cis(-TAU * f);
    let (mut z, mut sum) = (Complex64::ONE, Complex64::ZERO);
    for v in values {
        sum += z * v;
        z *= turn;
    }
    sum.norm_sqr()
}

/// Weighted linear fits; after each, a Gauss-Newton step refines the frequency, and the weights change.
fn refined(values: &[f64], mut frequency: f64, rate: f64, harmonics: usize) -> Option<(Hum, Vec<f64>)> {
    let mut weights = vec![1.0; values.len()];
    let mut found: Option<(DVector<f64>, Vec<f64>)> = None;
    for _ in 0..8 {
        // Offset, cosine and sine of each order, and after the first fit the derivative of the fundamental by
        // frequency.
        let fundamental = found.as_ref().map(|(c, _)| (c[1], c[2]));
        let columns = 2 * harmonics + 1 + usize::from(fundamental.is_some());
        let fill = |i: usize, row: &mut DVector<f64>| {
            let t = (i as f64 - 0.5 * values.len() as f64) / rate;
            let turn = Complex64::cis(TAU * frequency * t);
            let mut z = turn;
            row[0] = 1.0;
            for order in 1..=harmonics {
                (row[2 * order - 1], row[2 * order]) = (z.re, z.im);
                z *= turn;
            }
            if let Some((a, b)) = fundamental {
                row[columns - 1] = TAU * t * (b * turn.re - a * turn.im);
            }
        };
        let (mut normal, mut right) = (DMatrix::zeros(columns, columns), DVector::zeros(columns));
        let mut row = DVector::zeros(columns);
        for (i, (v, w)) in values.iter().zip(&weights).enumerate().filter(|(_, (_, w))| **w > 0.0) {
            fill(i, &mut row);
            normal.syger(*w, &row, &row, 1.0);
            right.axpy(w * v, &row, 1.0);
        }
        let solved = normal.cholesky()?.solve(&right);
        let mut modelled = |i: usize| {
            fill(i, &mut row);
            row.dot(&solved) - solved[0]
        };
        let model: Vec<f64> = (0..values.len()).map(&mut modelled).collect();
        let residual = values.iter().zip(&model).map(|(v, m)| v - m - solved[0]);
        let residual: Vec<f64> = residual.map(f64::abs).collect();
        let spread = 4.685 * median(&residual) / 0.674_5;
        if spread > 0.0 {
            weights = residual.iter().map(|r| (1.0 - (r / spread).powi(2)).max(0.0).powi(2)).collect();
        }
        if fundamental.is_some() {
            frequency += solved[columns - 1].clamp(-TOLERANCE, TOLERANCE);
        }
        found = Some((solved, model));
    }
    let (solved, model) = found.filter(|_| frequency > 0.0)?;
    Some((Hum { frequency, amplitude: solved[1].hypot(solved[2]), harmonics }, model))
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
        let found = remove(&mut values, (rate, "V"), &mut Vec::new()).unwrap();
        // A sine of amplitude A in N samples of noise σ: u(f) = √6 σ/(π A T √N) = 2e-5 Hz, u(A) = σ√(2/N) =
        // 2.2e-4. Bisquare weights cost 5 %, impacts in the tails of the weights more: five times as
        // much.
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
        assert_eq!(remove(&mut after, (1000.0, "V"), &mut Vec::new()), None);
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
        assert_eq!(remove(&mut after, (rate, "V"), &mut findings), None);
        assert_eq!(values, after);
        assert!(findings.iter().any(|f| f.code == "hum-or-impacts"), "{findings:?}");
    }
}

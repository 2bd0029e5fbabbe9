//! Estimators as people write them in scripts and spreadsheets, a few lines each: the toolkit's precision is
//! compared with theirs.

use num_complex::Complex64;
use std::f64::consts::TAU;
use vibro_math::least_squares;
use vibro_record::{Trace, Window, sort_by_number};
use vibro_signal::fft::Transform;
use vibro_signal::window;

/// Peak amplitudes of the spectral lines, by a Fourier transform of the windowed record.
pub fn lines(trace: &Trace, shape: Window) -> Vec<f64> {
    let n = trace.values.len();
    let weights = window::samples(shape, n);
    let weighted: Vec<f64> = trace.values.iter().zip(&weights).map(|(v, w)| v * w).collect();
    let sum: f64 = weights.iter().sum();
    Transform::new(n).forward(&weighted).iter().map(|x| 2.0 * x.norm() / sum).collect()
}

/// Spacing of the spectral lines in Hz.
pub fn spacing(trace: &Trace) -> f64 {
    trace.rate().unwrap_or(f64::NAN) / trace.values.len() as f64
}

/// Index of the largest line, 0 Hz included.
pub fn largest(lines: &[f64]) -> usize {
    (0..lines.len()).max_by(|a, b| lines[*a].total_cmp(&lines[*b])).unwrap_or(0)
}

/// Index of the second largest local maximum.
pub fn second(lines: &[f64]) -> Option<usize> {
    let mut peaks: Vec<usize> = (1..lines.len().saturating_sub(1))
        .filter(|k| lines[*k] > lines[k - 1] && lines[*k] >= lines[k + 1])
        .collect();
    sort_by_number(&mut peaks, |a| -lines[*a]);
    peaks.get(1).copied()
}

/// Position, in lines, of the maximum of a parabola through line `k` and its neighbours; `k` at the ends.
pub fn parabola(lines: &[f64], k: usize) -> f64 {
    let (Some(left), Some(right)) = (k.checked_sub(1).map(|i| lines[i]), lines.get(k + 1)) else {
        return k as f64;
    };
    k as f64 - 0.5 * (right - left) / (left + right - 2.0 * lines[k])
}

/// Times of the upward crossings of a level, in samples, interpolated linearly.
pub fn passages(values: &[f64], level: f64) -> Vec<f64> {
    let up = |(i, w): (usize, &[f64])| {
        (w[0] < level && w[1] >= level).then(|| i as f64 + (level - w[0]) / (w[1] - w[0]))
    };
    values.windows(2).enumerate().filter_map(up).collect()
}

/// Half of the highest value.
pub fn half(values: &[f64]) -> f64 {
    0.5 * values.iter().copied().fold(f64::NEG_INFINITY, f64::max)
}

/// First sample after each upward crossing of half the highest value.
pub fn threshold(values: &[f64]) -> Vec<f64> {
    passages(values, half(values)).iter().map(|t| t.ceil()).collect()
}

/// Mean rate of events per sample, from the first and last of these times in samples.
pub fn mean_rate(times: &[f64]) -> f64 {
    match times {
        [first, .., last] => (times.len() - 1) as f64 / (last - first),
        _ => f64::NAN,
    }
}

/// Mean of the values.
pub fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

/// Running sums over the sampling rate: an integral whose constant is ignored.
pub fn sums(trace: &Trace) -> Vec<f64> {
    let (rate, mut sum) = (trace.rate().unwrap_or(f64::NAN), 0.0);
    let add = |v: &f64| {
        sum += v / rate;
        sum
    };
    trace.values.iter().map(add).collect()
}

/// Values minus their least-squares straight line (`detrend`).
pub fn detrended(values: &[f64]) -> Vec<f64> {
    let (n, mean) = (values.len() as f64, mean(values));
    let middle = 0.5 * (n - 1.0);
    let slope = values.iter().enumerate().map(|(i, v)| (i as f64 - middle) * (v - mean)).sum::<f64>()
        / (n * (n * n - 1.0) / 12.0);
    values.iter().enumerate().map(|(i, v)| v - mean - slope * (i as f64 - middle)).collect()
}

/// Half the peak-to-peak value.
pub fn half_swing(values: &[f64]) -> f64 {
    let (low, high) =
        values.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(*v), h.max(*v)));
    0.5 * (high - low)
}

/// Magnitudes of the lines, index of the largest, half-power level, and indices of the nearest lines on
/// either side below that level.
fn peak(values: &[Complex64]) -> Option<(Vec<f64>, usize, f64, usize, usize)> {
    let size: Vec<f64> = values.iter().map(|v| v.norm()).collect();
    let at = largest(&size);
    let level = size.get(at)? / f64::sqrt(2.0);
    let under = |i: &usize| size[*i] < level;
    let (left, right) = ((0..at).rev().find(under)?, (at + 1..size.len()).find(under)?);
    Some((size, at, level, left, right))
}

/// ζ by the half-power bandwidth of the largest line. Its ends are interpolated with `between`, else they are
/// the nearest lines.
pub fn half_power(frequency: &[f64], values: &[Complex64], between: bool) -> f64 {
    let Some((size, at, level, left, right)) = peak(values) else { return f64::NAN };
    let cross = |out: usize, inside: usize| {
        let part = if between { (level - size[out]) / (size[inside] - size[out]) } else { 0.0 };
        frequency[out] + part * (frequency[inside] - frequency[out])
    };
    (cross(right, right - 1) - cross(left, left + 1)) / (2.0 * frequency[at])
}

/// ζ from a circle through the mobility at the lines above half power and two more on either side (Kåsa
/// 1976). α₁ and α₂ are the angles on the circle from the largest line ωᵣ to the first and last line ω₁, ω₂:
/// ζ = (ω₂² − ω₁²)/(2ωᵣ(ω₁ tan(α₁/2) + ω₂ tan(α₂/2))).
pub fn circle(frequency: &[f64], values: &[Complex64]) -> f64 {
    let Some((size, at, _, left, right)) = peak(values) else { return f64::NAN };
    let (low, high) = (left.saturating_sub(1), (right + 1).min(size.len() - 1));
    let points: Vec<Complex64> = (low..=high)
        .map(|i| values[i] * Complex64::new(0.0, TAU * frequency[i]) / size[at] / (TAU * frequency[at]))
        .collect();
    // x² + y² = 2ax + 2by + c is linear in a, b and c.
    let residuals = |p: &[f64], out: &mut [f64]| {
        for (out, z) in out.iter_mut().zip(&points) {
            *out = z.norm_sqr() - 2.0 * (p[0] * z.re + p[1] * z.im) - p[2];
        }
    };
    let Ok(fit) = least_squares(residuals, points.len(), &[0.5, 0.0, 0.0], &[1.0; 3]) else {
        return f64::NAN;
    };
    let centre = Complex64::new(fit.parameters[0], fit.parameters[1]);
    let turn = |i: usize| ((points[i] - centre) / (points[at - low] - centre)).arg().abs();
    let (below, above) = (turn(0), turn(points.len() - 1));
    let [w1, w2, own] = [frequency[low], frequency[high], frequency[at]];
    (w2 * w2 - w1 * w1) / (2.0 * own * (w1 * (0.5 * below).tan() + w2 * (0.5 * above).tan()))
}

/// Rise time over duration of a pulse, as read from a screen. The baseline is the mean of the first tenth of
/// the record, the peak the highest sample; the pulse starts and ends at 3 % of its height.
pub fn instants(values: &[f64]) -> f64 {
    let level = mean(&values[..(values.len() / 10).max(1)]);
    let peak = largest(values);
    let foot = level + 0.03 * (values[peak] - level);
    let start = (0..peak).rev().find(|i| values[*i] < foot).unwrap_or(0);
    let end = (peak..values.len()).find(|i| values[*i] < foot).unwrap_or(values.len());
    (peak - start) as f64 / (end - start) as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A mode of ζ = 0.01 without noise, with 20 lines in its bandwidth. The error of half power is that of
    /// the line spacing; the circle is exact for one mode if the largest line is at the resonance.
    #[test]
    fn methods_of_paper_and_pencil_find_a_clean_mode() {
        let (own, zeta) = (100.0, 0.01);
        let frequency: Vec<f64> = (0..800).map(|i| 60.0 + 0.1 * f64::from(i)).collect();
        let mode = |f: &f64| 1.0 / Complex64::new(own * own - f * f, 2.0 * zeta * own * f);
        let values: Vec<Complex64> = frequency.iter().map(mode).collect();
        let near = |found: f64, within: f64| assert!((found / zeta - 1.0).abs() < within, "{found}");
        near(half_power(&frequency, &values, true), 0.02);
        near(half_power(&frequency, &values, false), 0.15);
        near(circle(&frequency, &values), 1e-6);
    }

    #[test]
    fn no_line_has_no_damping() {
        assert!(half_power(&[], &[], true).is_nan() && circle(&[], &[]).is_nan());
    }

    #[test]
    fn a_parabola_is_found_exactly() {
        let lines: Vec<f64> = (0..9).map(|k| 5.0 - (f64::from(k) - 4.3).powi(2)).collect();
        assert!((parabola(&lines, largest(&lines)) - 4.3).abs() < 1e-12);
    }
}

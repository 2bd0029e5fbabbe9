//! The noise floor around a spectral line, and the upper limit of a sine that noise hides.

use super::line::interpolate;
use vibro_math::border;
use vibro_record::{Window, upper_median};
use vibro_signal::window::line_shape;

/// Lines read on either side of a peak for its noise floor: over these the noise is taken as white.
pub const REACH: usize = 40;

/// Lines on either side of a peak that are left out of the floor: they belong to the peak.
const GUARD: usize = 4;

/// Median of | |L + noise| − L | for a line of height L, both in units of the noise of one component: √(2 ln
/// 2) for noise alone (Rayleigh), 0.6745 where the line is high (normal). Quantiles of the Rice distribution
/// (S. O. Rice, Bell Syst. Tech. J. 24 (1945) 46); linear interpolation is within 1 %.
const HEIGHTS: [f64; 10] = [0.0, 0.35, 0.5, 0.7, 0.8, 0.9, 1.0, 2.0, 4.0, 10.0];
const MEDIANS: [f64; 10] = [1.1774, 0.8636, 0.7516, 0.6273, 0.5972, 0.5848, 0.5826, 0.6484, 0.669, 0.6745];

/// Standard deviation of the noise in one component (real or imaginary) of a line, from the magnitudes of the
/// lines `reach` on either side of `centre`, not nearer than four lines to it and not below line 2.
///
/// The leakage of the sine at `centre` under `window` is subtracted first: without a window, or under
/// Hamming's, it is far above the noise. The floor is a median, so a few further peaks do not move it.
/// Leakage of the sine's negative frequency, of lines elsewhere, and all leakage of an unknown window cannot
/// be subtracted and counts as noise. It disturbs the sine's own lines as much as those beside it, so
/// uncertainties from this floor have its size.
///
/// `None` where fewer than eight lines are left.
pub fn around(magnitudes: &[f64], centre: usize, reach: usize, window: Option<Window>) -> Option<f64> {
    let lines = beside(magnitudes, centre, reach, window);
    (lines.len() >= FEWEST).then(|| floor(&lines))
}

/// As [`around`], for noise that may fall or rise as a power of the frequency. Its exponent comes from the
/// floors below and above `centre`, and from what is known of noise: most has one about 0, with a standard
/// deviation of [`EXPONENT`].
pub fn sloping(magnitudes: &[f64], centre: usize, reach: usize, window: Option<Window>) -> Option<f64> {
    let lines = beside(magnitudes, centre, reach, window);
    if lines.len() < FEWEST {
        return None;
    }
    let all = floor(&lines);
    let (below, above): (Vec<Line>, Vec<Line>) = lines.iter().partition(|line| line.at < centre);
    if below.len() < FEW || above.len() < FEW || centre == 0 {
        return Some(all);
    }
    // Logarithm of the middle of some lines.
    let middle = |lines: &[Line]| lines.iter().map(|l| (l.at as f64).ln()).sum::<f64>() / lines.len() as f64;
    let width = middle(&above) - middle(&below);
    let variance = SCATTER * [&below, &above].map(|side| 1.0 / side.len() as f64).iter().sum::<f64>();
    let known = (EXPONENT * width).powi(2);
    let exponent = (floor(&above) / floor(&below)).ln() / width * known / (known + variance);
    let here = (exponent * ((centre as f64).ln() - middle(&lines))).exp();
    Some(if here.is_finite() { all * here } else { all })
}

/// Fewest lines of a floor, and of one on each side of a peak.
const FEWEST: usize = 8;
const FEW: usize = 4;
/// Standard deviation of the exponent of the amplitude of noise over frequency: 1/f noise has −½, that of a
/// drifting offset −1.
const EXPONENT: f64 = 0.5;
/// Variance of the logarithm of a floor, times its number of lines: 1/(2 ln 2)² for the median of lines of
/// noise alone, twice for the correlation of neighbours under a window.
const SCATTER: f64 = 1.04;

/// A line beside a peak.
#[derive(Clone, Copy)]
struct Line {
    at: usize,
    /// Leakage of the sine of the peak, and the line's magnitude without it.
    leakage: f64,
    rest: f64,
}

/// Lines `reach` on either side of `centre`, as in [`around`].
fn beside(magnitudes: &[f64], centre: usize, reach: usize, window: Option<Window>) -> Vec<Line> {
    let low = centre.saturating_sub(reach).max(2);
    let high = centre.saturating_add(reach + 1).min(magnitudes.len());
    let sine = window.zip(sine(magnitudes, centre, window));
    (low..high)
        .filter(|k| k.abs_diff(centre) > GUARD && magnitudes[*k].is_finite())
        .map(|k| {
            let leakage = sine.map_or(0.0, |(window, (position, amplitude))| {
                amplitude * line_shape(window, k as f64 - position).abs()
            });
            Line { at: k, leakage, rest: (magnitudes[k] - leakage).abs() }
        })
        .collect()
}

/// Standard deviation of the noise in one component of these lines, by their median.
fn floor(lines: &[Line]) -> f64 {
    let mut scaled = vec![0.0; lines.len()];
    let mut noise = f64::INFINITY;
    // The expected rest of a line depends weakly on its height over the noise: the slope of the logarithm of
    // the median over that of the height is at most 0.75. So each iteration leaves at most 0.75 of the
    // error, and 40 leave 1e-5.
    for _ in 0..40 {
        for (scaled, Line { leakage, rest, .. }) in scaled.iter_mut().zip(lines) {
            *scaled = rest / rice_median(leakage / noise);
        }
        let found = upper_median(&mut scaled);
        let settled = (found - noise).abs() <= 1e-6 * found;
        noise = found;
        if settled || noise == 0.0 {
            break;
        }
    }
    noise
}

/// Position and amplitude of the sine whose largest line is beside `centre`.
fn sine(magnitudes: &[f64], centre: usize, window: Option<Window>) -> Option<(f64, f64)> {
    let beside = centre.saturating_sub(1)..=centre.saturating_add(1).min(magnitudes.len().checked_sub(1)?);
    let top = beside.max_by(|a, b| magnitudes[*a].total_cmp(&magnitudes[*b]))?;
    interpolate(magnitudes, top, window, None).map(|sine| (sine.position, sine.amplitude))
}

/// [`MEDIANS`] for a line of this height over the noise, by linear interpolation.
fn rice_median(height: f64) -> f64 {
    let x = height.clamp(0.0, 10.0);
    let k = HEIGHTS.partition_point(|h| *h < x).clamp(1, 9);
    let (a, b) = ((HEIGHTS[k - 1], MEDIANS[k - 1]), (HEIGHTS[k], MEDIANS[k]));
    a.1 + (b.1 - a.1) * (x - a.0) / (b.0 - a.0)
}

/// Largest probability that the true amplitude lies above the limit.
const MISSED: f64 = 0.05;

/// Upper limit (95 % confidence) of the amplitude of a sine, from the magnitude of its line and the noise of
/// one component.
///
/// The magnitude is Rice distributed (S. O. Rice, Bell Syst. Tech. J. 24 (1945) 46). The limit ν solves P(M
/// ≤ m | ν) = 0.05 P(M ≤ m | 0) (A. L. Read, J. Phys. G 28 (2002) 2693). The division keeps the limit from
/// falling to 0 where noise happens to be small: it is never below 2.45 `noise`. The true amplitude lies
/// above the limit in less than 5 % of all cases.
///
/// These 5 % refer to all readings, faint and strong. If only faint readings get a limit, still no more than
/// 5 % of all readings exceed it. But a sine whose reading is faint by chance exceeds its limit more often.
/// `None` where one of the two is not a number, there is no noise, or the magnitude is above 20 `noise`.
pub fn upper_limit(magnitude: f64, noise: f64) -> Option<f64> {
    let m = magnitude / noise;
    // Far above the noise no limit is needed, and the series below would be long.
    if !(noise > 0.0 && (0.0..=20.0).contains(&m)) {
        return None;
    }
    // Below this the limit does not change in its first five digits, and the sums would cancel.
    let m = m.max(1e-3);
    let wanted = MISSED * below(m, 0.0);
    // Ten standard deviations above the magnitude the probability is negligible.
    Some(noise * border(0.0, m + 10.0, |height| below(m, height) > wanted))
}

/// P(M ≤ m) of a Rice distributed magnitude of height ν in noise of one unit a component: a sum of gamma
/// distributions with Poisson weights, since M² is noncentral χ² of two degrees of freedom.
pub(super) fn below(m: f64, nu: f64) -> f64 {
    let (y, lambda) = (m * m / 2.0, nu * nu / 2.0);
    // Poisson probabilities of j for means λ and y, and the latter's tail above j.
    let (mut weight, mut term, mut tail) = ((-lambda).exp(), (-y).exp(), -(-y).exp_m1());
    let (mut sum, mut j) = (weight * tail, 0.0);
    // Terms fall from j = y on; the sum ends where they no longer count.
    while j < y || term > 1e-18 {
        j += 1.0;
        weight *= lambda / j;
        term *= y / j;
        tail = (tail - term).max(0.0);
        sum += weight * tail;
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::noise::below;
    use crate::synthetic::spectrum;
    use num_complex::Complex64;
    use vibro_math::Noise;

    #[test]
    fn rayleigh_noise_is_recovered_beside_a_strong_peak() {
        // Quantiles of the Rayleigh distribution with σ = 2 as a sample without randomness, shuffled by a
        // stride.
        let n = 81;
        let mut lines = vec![0.0; n];
        for i in 0..n {
            let p = (i as f64 + 0.5) / n as f64;
            lines[(i * 37) % n] = 2.0 * (-2.0 * (1.0 - p).ln()).sqrt();
        }
        for line in &mut lines[38..=42] {
            *line = 1e3;
        }
        let sigma = around(&lines, 40, REACH, Some(Window::Hann)).unwrap();
        // The median of 70 draws scatters by about 7 %; the stride leaves it within twice that.
        assert!((sigma / 2.0 - 1.0).abs() < 0.15, "{sigma}");
    }

    #[test]
    fn medians_between_those_of_the_table_are_those_of_rice() {
        for i in 0..=1200 {
            let height = f64::from(i) * 0.01;
            let rest = border(0.0, 5.0, |rest| {
                let inner = if rest < height { below(height - rest, height) } else { 0.0 };
                below(height + rest, height) - inner < 0.5
            });
            let ratio = rice_median(height) / rest;
            assert!((ratio - 1.0).abs() < 0.01, "{height}: {ratio}");
        }
    }

    #[test]
    fn too_few_lines_give_no_floor() {
        assert_eq!(around(&[1.0; 12], 6, REACH, None), None);
    }

    /// Ratios of the observed scatter to the stated uncertainty, of position and amplitude, in [`DRAWS`]
    /// spectra of a sine at line `truth` and its negative frequency at `image`; `None` where one states no
    /// uncertainty.
    fn scatter(
        window: Window,
        truth: f64,
        image: Option<f64>,
        sigma: f64,
        normal: &mut Noise,
    ) -> Option<[f64; 2]> {
        let mut sums = [0.0; 4];
        for _ in 0..DRAWS {
            let phase = Complex64::cis(std::f64::consts::TAU * normal.uniform());
            let mut sines = vec![(truth, phase)];
            sines.extend(image.map(|at| (at, phase.conj())));
            let lines = spectrum(window, &sines, sigma, normal);
            let top = if lines[81] > lines[80] { 81 } else { 80 };
            let noise = around(&lines, top, REACH, Some(window)).unwrap();
            let found = interpolate(&lines, top, Some(window), Some(noise)).unwrap();
            sums[0] += (found.position - truth).powi(2);
            sums[1] += found.position_std?.powi(2);
            sums[2] += (found.amplitude - 1.0).powi(2);
            sums[3] += found.amplitude_std?.powi(2);
        }
        Some([(sums[0] / sums[1]).sqrt(), (sums[2] / sums[3]).sqrt()])
    }

    const DRAWS: u32 = 600;

    #[test]
    fn stated_uncertainties_are_the_scatter_seen() {
        assert_eq!(judged(&[Window::Hann], &[40]), 3);
    }

    #[test]
    #[ignore = "Monte Carlo: cargo test --release -- --ignored"]
    fn stated_uncertainties_are_the_scatter_seen_under_every_window() {
        let judged = judged(&Window::ALL, &[20, 40, 60, 80]);
        // All windows at all levels, less cases without a window near a line or in strong noise.
        assert!(judged >= 66, "{judged} of 72");
    }

    /// Number of cases (three positions between lines, these windows and levels) that state an uncertainty;
    /// asserts that the observed scatter agrees with it.
    fn judged(windows: &[Window], decibels: &[i32]) -> u32 {
        let mut normal = Noise::new(0x5eed);
        let mut judged = 0;
        for &window in windows {
            for &decibel in decibels {
                for part in [0.12, 0.3, 0.47] {
                    let sigma = 10f64.powf(-f64::from(decibel) / 20.0);
                    // Without a window a sine near a line states no uncertainty where noise chooses the
                    // neighbour.
                    let Some(ratios) = scatter(window, 80.0 + part, None, sigma, &mut normal) else {
                        continue;
                    };
                    judged += 1;
                    for ratio in ratios {
                        // A standard deviation from 600 draws scatters by 2.9 %, four times that; 1 % of the
                        // table of medians; and 2 % of the mean square of a floor
                        // from 72 lines, which scatters by up to 20 % where neighbours correlate.
                        assert!((ratio - 1.0).abs() < 0.16, "{window:?} {decibel} dB {part}: {ratios:?}");
                    }
                }
            }
        }
        judged
    }

    #[test]
    fn the_leakage_of_the_negative_frequency_is_covered() {
        // The leakage bends the sine's own lines, unlike white noise; a floor raised by leakage beside the
        // sine must cover that. Without a window, 80 dB: its leakage 1/(160π) is twenty times the noise.
        let mut normal = Noise::new(0x1a6e);
        for window in [Window::Rectangular, Window::Hamming] {
            for part in [0.3, 0.47] {
                let ratios = scatter(window, 80.0 + part, Some(-80.0 - part), 1e-4, &mut normal).unwrap();
                println!("{window:?} {part}: {ratios:?}");
                // Errors no larger than stated; a standard deviation from 600 draws scatters by 2.9 %, four
                // times that.
                assert!(ratios.iter().all(|r| *r < 1.12), "{window:?} {part}: {ratios:?}");
            }
        }
    }
}

#[cfg(test)]
mod limits {
    use super::*;

    /// Slow reference: midpoint rule over the density x exp(−(x² + ν²)/2) I₀(xν), with I₀ as a mean over
    /// angles.
    fn by_integration(m: f64, nu: f64) -> f64 {
        let (n, angles) = (2000, 64);
        let step = m / f64::from(n);
        let density = |x: f64| {
            let mean: f64 = (0..angles)
                .map(|i| {
                    let c = (std::f64::consts::TAU * (f64::from(i) + 0.5) / f64::from(angles)).cos();
                    (-(x * x + nu * nu) / 2.0 + x * nu * c).exp()
                })
                .sum();
            x * mean / f64::from(angles)
        };
        (0..n).map(|i| step * density((f64::from(i) + 0.5) * step)).sum()
    }

    #[test]
    fn the_distribution_is_that_of_rice() {
        for m in [0.05_f64, 0.7, 1.5, 3.0, 5.5] {
            for nu in [0.0, 0.4, 1.7, 3.0, 6.0] {
                // Midpoint rule: m³/24n² times a second derivative of order one.
                let tolerance = m.powi(3) / 24.0 / 4e6 * 4.0 + 1e-14;
                let (sum, slow) = (below(m, nu), by_integration(m, nu));
                assert!((sum - slow).abs() < tolerance, "{m} {nu}: {sum} {slow}");
            }
        }
    }

    #[test]
    fn limits_far_from_and_deep_in_the_noise() {
        // exp(−ν²/2) = 0.05 for a magnitude of 0; the m²/8 of the next order is 1e-7.
        assert!((upper_limit(0.0, 2.0).unwrap() / 2.0 - (2.0 * 20f64.ln()).sqrt()).abs() < 1e-5);
        // High above the noise the magnitude is normal about √(ν² + 1): 1.645 standard deviations, less 1/2ν.
        let m = 15.0;
        let expected = m + 1.644_85 - 1.0 / (2.0 * (m + 1.644_85));
        // Next order of the expansion of the Rice quantile: 1/ν².
        assert!((upper_limit(m, 1.0).unwrap() - expected).abs() < 1.0 / (m * m));
        assert_eq!(upper_limit(f64::NAN, 1.0), None);
        assert_eq!(upper_limit(1.0, 0.0), None);
    }
}

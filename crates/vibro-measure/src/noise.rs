//! The noise floor around a spectral line.

use super::line::interpolate;
use vibro_record::Window;
use vibro_signal::window::line_shape;

/// Lines on either side that are read where noise is taken for white.
pub const REACH: usize = 40;

/// Lines next to the peak that are left out: they belong to it.
const GUARD: usize = 4;

/// Median of | |L + noise| − L | for a line of height L, both in units of the noise of one component: √(2 ln 2) for noise
/// alone (Rayleigh), 0.6745 where the line is high (normal). Quantiles of the Rice distribution (S. O. Rice, Bell Syst.
/// Tech. J. 24 (1945) 46); straight lines between these are within 1 %.
const MEDIAN: [(f64, f64); 10] = [
    (0.0, 1.1774),
    (0.35, 0.8636),
    (0.5, 0.7516),
    (0.7, 0.6273),
    (0.8, 0.5972),
    (0.9, 0.5848),
    (1.0, 0.5826),
    (2.0, 0.6484),
    (4.0, 0.669),
    (10.0, 0.6745),
];

/// Standard deviation of the noise in one component (real or imaginary) of a line, from the magnitudes of the lines
/// `reach` on either side of `centre`, not nearer than four lines to it and not below line 2.
///
/// What the sine at `centre` spreads over these lines under `window` is taken out: without a window, or under Hamming's, it is
/// far above the noise. The median of the rest is not moved by a few further peaks. What cannot be taken out counts as
/// noise: leakage of the sine's negative frequency and of lines elsewhere, and all leakage of an unknown window. It bends the
/// sine's own lines as much as those beside it, so the uncertainty made of this floor is of its size.
///
/// `None` where fewer than eight lines are left.
pub fn around(magnitudes: &[f64], centre: usize, reach: usize, window: Option<Window>) -> Option<f64> {
    let low = centre.saturating_sub(reach).max(2);
    let high = centre.saturating_add(reach + 1).min(magnitudes.len());
    let sine = window.zip(sine(magnitudes, centre, window));
    // Leakage of each line, and what is left of it.
    let lines: Vec<(f64, f64)> = (low..high)
        .filter(|k| k.abs_diff(centre) > GUARD && magnitudes[*k].is_finite())
        .map(|k| {
            let leakage = sine.map_or(0.0, |(window, (position, amplitude))| {
                amplitude * line_shape(window, k as f64 - position).abs()
            });
            (leakage, (magnitudes[k] - leakage).abs())
        })
        .collect();
    if lines.len() < 8 {
        return None;
    }
    let mut scaled = vec![0.0; lines.len()];
    let mut noise = f64::INFINITY;
    // What a line's rest should be depends on its height over the noise, weakly: the slope of ln MEDIAN over ln x is at most
    // 0.75, so each turn leaves no more than that of the error, and 40 turns 1e-5.
    for _ in 0..40 {
        for (scaled, (leakage, rest)) in scaled.iter_mut().zip(&lines) {
            *scaled = rest / median(leakage / noise);
        }
        let middle = scaled.len() / 2;
        let (_, found, _) = scaled.select_nth_unstable_by(middle, f64::total_cmp);
        let settled = (*found - noise).abs() <= 1e-6 * *found;
        noise = *found;
        if settled || noise == 0.0 {
            break;
        }
    }
    Some(noise)
}

/// Position and amplitude of the sine whose largest line is beside `centre`.
fn sine(magnitudes: &[f64], centre: usize, window: Option<Window>) -> Option<(f64, f64)> {
    let beside = centre.saturating_sub(1)..=centre.saturating_add(1).min(magnitudes.len().checked_sub(1)?);
    let top = beside.max_by(|a, b| magnitudes[*a].total_cmp(&magnitudes[*b]))?;
    interpolate(magnitudes, top, window, None).map(|sine| (sine.position, sine.amplitude))
}

/// [`MEDIAN`] at a height of `x`.
fn median(x: f64) -> f64 {
    let above = MEDIAN.partition_point(|m| m.0 < x);
    match (above.checked_sub(1).and_then(|i| MEDIAN.get(i)), MEDIAN.get(above)) {
        (Some(a), Some(b)) => a.1 + (b.1 - a.1) * (x - a.0) / (b.0 - a.0),
        (Some(end), None) | (None, Some(end)) => end.1,
        (None, None) => MEDIAN[0].1,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::limit::below;
    use crate::synthetic::{Normal, spectrum};
    use num_complex::Complex64;

    #[test]
    fn rayleigh_noise_is_recovered_beside_a_strong_peak() {
        // Quantiles of the Rayleigh distribution with σ = 2 as a sample without randomness, shuffled by a stride.
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
            let (mut low, mut high) = (0.0, 5.0);
            for _ in 0..50 {
                let rest = f64::midpoint(low, high);
                let inner = if rest < height { below(height - rest, height) } else { 0.0 };
                if below(height + rest, height) - inner < 0.5 { low = rest } else { high = rest }
            }
            let ratio = median(height) / low;
            assert!((ratio - 1.0).abs() < 0.01, "{height}: {ratio}");
        }
    }

    #[test]
    fn too_few_lines_give_no_floor() {
        assert_eq!(around(&[1.0; 12], 6, REACH, None), None);
    }

    /// Ratios of the scatter seen to the uncertainty stated, of position and amplitude, in `draws` spectra of a sine at `truth`
    /// and its negative frequency at `image`; `None` where not all state one.
    fn scatter(
        window: Window,
        truth: f64,
        image: Option<f64>,
        sigma: f64,
        normal: &mut Normal,
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
        // All windows at all levels, less those without a window near a line or in much noise.
        assert!(judged >= 66, "{judged} of 72");
    }

    /// How many of three places under these windows at these levels state an uncertainty; all that do state the scatter.
    fn judged(windows: &[Window], decibels: &[i32]) -> u32 {
        let mut normal = Normal(0x5eed);
        let mut judged = 0;
        for &window in windows {
            for &decibel in decibels {
                for part in [0.12, 0.3, 0.47] {
                    let sigma = 10f64.powf(-f64::from(decibel) / 20.0);
                    // Without a window a sine near a line states no uncertainty where noise chooses the neighbour.
                    let Some(ratios) = scatter(window, 80.0 + part, None, sigma, &mut normal) else {
                        continue;
                    };
                    judged += 1;
                    for ratio in ratios {
                        // A standard deviation from 600 draws scatters by 2.9 %, four times that; 1 % of the table of medians; and
                        // 2 % of the mean square of a floor from 72 lines, which scatters by up to 20 % where neighbours correlate.
                        assert!((ratio - 1.0).abs() < 0.16, "{window:?} {decibel} dB {part}: {ratios:?}");
                    }
                }
            }
        }
        judged
    }

    #[test]
    fn the_leakage_of_the_negative_frequency_is_covered() {
        // It bends the sine's own lines, which is no scatter of white noise; what it leaves beside the sine must make up for it. Without
        // a window, 80 dB: its leakage 1/(160π) is twenty times the noise.
        let mut normal = Normal(0x1a6e);
        for window in [Window::Rectangular, Window::Hamming] {
            for part in [0.3, 0.47] {
                let ratios = scatter(window, 80.0 + part, Some(-80.0 - part), 1e-4, &mut normal).unwrap();
                println!("{window:?} {part}: {ratios:?}");
                // Errors no larger than stated; a standard deviation from 600 draws scatters by 2.9 %, four times that.
                assert!(ratios.iter().all(|r| *r < 1.12), "{window:?} {part}: {ratios:?}");
            }
        }
    }
}

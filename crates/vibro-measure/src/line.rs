//! Frequency and amplitude of a sine between the lines of a spectrum.

use vibro_math::border;
use vibro_record::Window;
use vibro_signal::window::{line_shape, noise_correlation};

/// A sine found in a magnitude spectrum.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SubLine {
    /// Position in lines: the largest line plus the interpolated distance from it.
    pub position: f64,
    /// Standard uncertainty of the position in lines; `None` where the noise or the window is not known.
    pub position_std: Option<f64>,
    /// Amplitude without scalloping loss, in the unit of the spectrum.
    pub amplitude: f64,
    /// Standard uncertainty of the amplitude, in the same unit.
    pub amplitude_std: Option<f64>,
}

/// Largest distance of a sine from its largest line, in lines: noise can push it that far, but never a whole
/// line.
const LIMIT: f64 = 0.99;

/// Frequency and amplitude of the sine whose largest line is `k`, from three magnitudes.
///
/// For a window with a main lobe of four lines or more, the distance δ from line `k` solves (m₊ − m₋)/(m₋ +
/// 2m₀ + m₊) = (W(1−δ) − W(1+δ))/(W(1+δ) + 2W(δ) + W(1−δ)), which for Hann is δ = 2(m₊ − m₋)/(m₋ + 2m₀ + m₊)
/// (T. Grandke, IEEE Trans. Instrum. Meas. 32 (1983) 350, in its three-line form); both are exact for a clean
/// sine in a long record. Without a window the larger neighbour alone is used, δ = m₊/(m₀ + m₊) (Rife &
/// Vincent 1970). An unknown `window` leaves a parabola through the log magnitudes, without an uncertainty.
///
/// `noise` is the standard deviation of one component of a line. `None` if `k` has no neighbour on a side or
/// the lines there are missing or zero.
pub fn interpolate(
    magnitudes: &[f64],
    k: usize,
    window: Option<Window>,
    noise: Option<f64>,
) -> Option<SubLine> {
    let lines = three(magnitudes, k)?;
    let [left, middle, right] = lines;
    if !lines.iter().all(|m| *m >= 0.0) || middle == 0.0 {
        return None;
    }
    let (delta, amplitude) = window.map_or_else(|| log_parabola(lines), |window| solve(lines, window));
    let known = window.zip(noise).filter(|(window, noise)| {
        // At the limit the lines do not have the shape of one sine, and derivatives mean nothing. Without a
        // window noise may choose the wrong neighbour, and a small uncertainty would be wrong: the difference
        // of two lines has √2 of the noise, so 6 times the noise is more than four of its standard
        // deviations.
        delta.abs() < LIMIT && (*window != Window::Rectangular || (right - left).abs() >= 6.0 * noise)
    });
    let [position_std, amplitude_std] =
        known.map_or([None; 2], |(window, noise)| propagate(lines, window, noise).map(Some));
    Some(SubLine { position: k as f64 + delta, position_std, amplitude, amplitude_std })
}

/// Line `k` and its neighbours; `None` where one is missing.
fn three(magnitudes: &[f64], k: usize) -> Option<[f64; 3]> {
    let lines: [f64; 3] = magnitudes.get(k.checked_sub(1)?..=k.checked_add(1)?)?.try_into().ok()?;
    lines.iter().all(|m| m.is_finite()).then_some(lines)
}

/// The largest deviation of the lines within `reach` of line `k` from the shape of the sine through the three
/// in the middle. Noise, another sine near by, the sine's own image at the ends of the band, or a wrong
/// window cause it. `None` as in [`interpolate`].
pub fn deviation(magnitudes: &[f64], k: usize, reach: usize, window: Window) -> Option<f64> {
    let lines = three(magnitudes, k)?;
    let (delta, amplitude) = solve(lines, window);
    let off = |i: usize| {
        let shape = line_shape(window, i as f64 - k as f64 - delta).abs();
        (magnitudes[i] - amplitude * shape).abs()
    };
    let near = k.saturating_sub(reach)..(k + reach + 1).min(magnitudes.len());
    let largest = near.map(off).fold(0.0, f64::max);
    (lines[1] > 0.0 && largest.is_finite()).then_some(largest)
}

/// Amplitude of a sine at a known `position` in lines, with its standard uncertainty: the three nearest lines
/// against the window's shape there. `None` where they do not exist or are missing.
pub(crate) fn amplitude_at(
    magnitudes: &[f64],
    position: f64,
    window: Option<Window>,
    noise: Option<f64>,
) -> Option<(f64, Option<f64>)> {
    if !(position >= 0.5 && position < magnitudes.len() as f64) {
        return None;
    }
    let k = position.round() as usize;
    let lines = three(magnitudes, k)?;
    let Some(window) = window else { return Some((lines[1], None)) };
    let weights = weights(window);
    let shape = shapes(window, position - k as f64);
    let gain = dot(weights, shape);
    Some((dot(weights, lines) / gain, noise.map(|noise| noise * spread(weights, window) / gain)))
}

/// Magnitude of the line nearest to a known `position` in lines, and its height over the amplitude of a sine
/// there: 1 under an unknown window. `None` where it does not exist or is missing.
pub fn nearest(magnitudes: &[f64], position: f64, window: Option<Window>) -> Option<(f64, f64)> {
    let k = position.round();
    let line = magnitudes.get(k as usize).filter(|m| k >= 0.0 && m.is_finite())?;
    Some((*line, window.map_or(1.0, |w| line_shape(w, position - k).abs())))
}

/// Weights of the three lines in an amplitude. Without a window the neighbours hold no more than leakage.
fn weights(window: Window) -> [f64; 3] {
    if window == Window::Rectangular { [0.0, 1.0, 0.0] } else { [1.0, 2.0, 1.0] }
}

fn shapes(window: Window, delta: f64) -> [f64; 3] {
    [-1.0, 0.0, 1.0].map(|step| line_shape(window, step - delta).abs())
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// Standard deviation of a weighted sum of three neighbouring lines in noise of one unit a component.
fn spread(weights: [f64; 3], window: Window) -> f64 {
    let pairs = (0..3).flat_map(|i| (0..3).map(move |j| (i, j)));
    let variance: f64 =
        pairs.map(|(i, j)| weights[i] * weights[j] * noise_correlation(window, i.abs_diff(j))).sum();
    variance.sqrt()
}

/// Distance of a sine from the middle line, in lines, and its amplitude.
fn solve(lines: [f64; 3], window: Window) -> (f64, f64) {
    let [left, middle, right] = lines;
    let delta = match window {
        Window::Hann => 2.0 * (right - left) / (left + 2.0 * middle + right),
        Window::Rectangular if right >= left => right / (middle + right),
        Window::Rectangular => -left / (middle + left),
        _ => {
            let target = (right - left) / (left + 2.0 * middle + right);
            border(-LIMIT, LIMIT, |delta| {
                let [l, m, r] = shapes(window, delta);
                (r - l) / (l + 2.0 * m + r) < target
            })
        }
    };
    let delta = delta.clamp(-LIMIT, LIMIT);
    let weights = weights(window);
    (delta, dot(weights, lines) / dot(weights, shapes(window, delta)))
}

/// Standard uncertainties of distance and amplitude: first-order propagation of the noise of three correlated
/// lines.
fn propagate(lines: [f64; 3], window: Window, noise: f64) -> [f64; 2] {
    // A step small against the line and large against rounding.
    let step = 1e-6 * lines[1];
    let mut slopes = [[0.0; 3]; 2];
    for i in 0..3 {
        let (mut up, mut down) = (lines, lines);
        up[i] += step;
        down[i] = (down[i] - step).max(0.0);
        let width = up[i] - down[i];
        let (a, b) = (solve(up, window), solve(down, window));
        (slopes[0][i], slopes[1][i]) = ((a.0 - b.0) / width, (a.1 - b.1) / width);
    }
    slopes.map(|s| noise * spread(s, window))
}

/// Vertex of the parabola through the logarithms of three lines: its distance from the middle one, at most
/// half a line, and the height there. A flat top in noise has its vertex anywhere.
fn log_parabola(lines: [f64; 3]) -> (f64, f64) {
    let [l, m, r] = lines.map(f64::ln);
    let curvature = l - 2.0 * m + r;
    if !curvature.is_finite() || curvature >= 0.0 {
        return (0.0, lines[1]);
    }
    let delta = (0.5 * (l - r) / curvature).clamp(-0.5, 0.5);
    (delta, (m - 0.25 * (l - r) * delta).exp())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Magnitudes of a clean sine in a long record.
    fn clean(window: Window, position: f64, amplitude: f64) -> Vec<f64> {
        (0..64).map(|k| amplitude * line_shape(window, f64::from(k) - position).abs()).collect()
    }

    #[test]
    fn a_clean_sine_is_found_exactly_wherever_it_lies() {
        for window in Window::ALL {
            for step in 0..=40 {
                let truth = 30.0 + f64::from(step) * 0.0249 - 0.498;
                let lines = clean(window, truth, 2.5);
                let k = truth.round() as usize;
                let found = interpolate(&lines, k, Some(window), None).unwrap();
                // A handful of operations on numbers of order one; bisection and the flat top's shallow slope
                // cost up to a factor of 1e3 in δ.
                assert!((found.position - truth).abs() < 1e-12, "{window:?} {truth}: {}", found.position);
                assert!(
                    (found.amplitude / 2.5 - 1.0).abs() < 1e-12,
                    "{window:?} {truth}: {}",
                    found.amplitude
                );
                let (amplitude, _) = amplitude_at(&lines, truth, Some(window), None).unwrap();
                assert!((amplitude / 2.5 - 1.0).abs() < 1e-13, "{window:?}");
            }
        }
    }

    #[test]
    fn the_wrong_window_does_not_fit() {
        for truth in [30.0, 30.2, 30.45] {
            let lines = clean(Window::Hann, truth, 1.0);
            assert!(deviation(&lines, 30, 1, Window::Hann).unwrap() < 1e-12 * lines[30]);
            for window in [Window::Rectangular, Window::FlatTop, Window::BlackmanHarris] {
                assert!(deviation(&lines, 30, 1, window).unwrap() > 0.02 * lines[30], "{window:?} {truth}");
            }
        }
    }

    #[test]
    fn two_equal_lines_are_half_way() {
        let lines = clean(Window::Hann, 10.5, 1.0);
        for k in [10, 11] {
            let found = interpolate(&lines, k, Some(Window::Hann), None).unwrap();
            assert!((found.position - 10.5).abs() < 1e-14 && (found.amplitude - 1.0).abs() < 1e-14);
        }
    }

    #[test]
    fn missing_lines_give_nothing() {
        assert_eq!(interpolate(&[1.0, 2.0], 1, Some(Window::Hann), None), None);
        assert_eq!(interpolate(&[1.0, f64::NAN, 1.0], 1, Some(Window::Hann), None), None);
        assert_eq!(interpolate(&[0.0; 3], 1, Some(Window::Hann), None), None);
        assert_eq!(amplitude_at(&[1.0; 5], f64::NAN, Some(Window::Hann), None), None);
        assert_eq!(amplitude_at(&[1.0; 5], 1e300, Some(Window::Hann), None), None);
    }

    #[test]
    fn an_unknown_window_is_a_flagged_parabola() {
        let lines = clean(Window::Hann, 10.2, 1.0);
        let found = interpolate(&lines, 10, None, Some(0.1)).unwrap();
        assert!((found.position - 10.2).abs() < 0.05 && found.position_std.is_none());
    }
}

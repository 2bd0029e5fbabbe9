//! Windows: samples, and the shape of a spectral line.
//!
//! All windows here are sums of cosines, w(n) = Σ (−1)ᵏ aₖ cos(2πkn/N), in the periodic form that an FFT
//! analyser uses; their coefficients and sums belong to [`Window`].

use std::f64::consts::PI;
use vibro_record::Window;

/// The `n` samples of the periodic window.
pub fn samples(window: Window, n: usize) -> Vec<f64> {
    let a = window.coefficients();
    (0..n)
        .map(|i| {
            let phase = 2.0 * PI * i as f64 / n as f64;
            a.iter().enumerate().map(|(k, a)| sign(k) * a * (k as f64 * phase).cos()).sum()
        })
        .collect()
}

/// Signed height of the spectral line of a unit sine at a distance of `offset` lines, for long records:
/// W(δ) = Σ aₖ (sinc(δ−k) + sinc(δ+k))/2 / a₀.
///
/// In the main lobe the sign alternates from line to line, as the phases of a DFT do; W(0) = 1.
pub fn line_shape(window: Window, offset: f64) -> f64 {
    let a = window.coefficients();
    // Each cosine term is half a Dirichlet kernel at δ − k and half at δ + k; (−1)ᵏ of the window cancels
    // (−1)ᵏ of the shift.
    let kernel = |k: f64| f64::midpoint(sinc(offset - k), sinc(offset + k));
    a.iter().enumerate().map(|(k, ak)| ak * kernel(k as f64)).sum::<f64>() / a[0]
}

/// sin(πx)/(πx).
fn sinc(x: f64) -> f64 {
    if x.abs() < 1e-9 { 1.0 } else { (PI * x).sin() / (PI * x) }
}

fn sign(k: usize) -> f64 {
    if k.is_multiple_of(2) { 1.0 } else { -1.0 }
}

/// Correlation of white noise in two lines that are `distance` apart, with the alternating sign of the main
/// lobe: 1, 2/3, 1/6, 0 … for Hann.
pub fn noise_correlation(window: Window, distance: usize) -> f64 {
    let a = window.coefficients();
    // Weights of the window over lines without a window: a₀ in the middle, (−1)ᵏ aₖ/2 at ±k.
    let weight = |k: i64| {
        let m = k.unsigned_abs() as usize;
        a.get(m).map_or(0.0, |ak| sign(m) * if m == 0 { *ak } else { ak / 2.0 })
    };
    let reach = a.len() as i64;
    let sum = |d: i64| (-reach..=reach).map(|k| weight(k) * weight(k + d)).sum::<f64>();
    sign(distance) * sum(distance as i64) / sum(0)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Slow oracle: one line of the windowed DFT of a sine of complex amplitude 1.
    fn line_by_dft(window: Window, n: usize, offset: f64) -> f64 {
        let w = samples(window, n);
        let sum: f64 = w.iter().sum();
        let (re, im) = w.iter().enumerate().fold((0.0, 0.0), |(re, im), (i, w)| {
            let phase = 2.0 * PI * offset * i as f64 / n as f64;
            (re + w * phase.cos(), im + w * phase.sin())
        });
        f64::hypot(re, im) / sum
    }

    #[test]
    fn line_shapes_are_those_of_the_dft() {
        let n = 4096;
        for window in Window::ALL {
            for step in -20..=20 {
                let offset = f64::from(step) * 0.137;
                let shape = line_shape(window, offset).abs();
                let dft = line_by_dft(window, n, offset);
                // Continuous against discrete kernel: a relative difference of (πδ/N)²/6 in terms of order
                // one.
                let tolerance = 10.0 * (PI * 3.0 / n as f64).powi(2) + 1e-13 * n as f64;
                assert!((shape - dft).abs() < tolerance, "{window:?} {offset}: {shape} against {dft}");
            }
        }
    }

    #[test]
    fn sums_agree_with_the_samples() {
        for window in Window::ALL {
            let w = samples(window, 64);
            let sum: f64 = w.iter().sum();
            let squares: f64 = w.iter().map(|w| w * w).sum();
            assert!((sum / 64.0 - window.coherent_gain()).abs() < 1e-14, "{window:?}");
            assert!((squares * 64.0 / (sum * sum) - window.enbw()).abs() < 1e-13, "{window:?}");
        }
        // Harris 1978, table I, to the digits printed there.
        let table = [
            (Window::Rectangular, 1.0, 1.00),
            (Window::Hann, 0.5, 1.50),
            (Window::Hamming, 0.54, 1.36),
            (Window::Blackman, 0.42, 1.73),
            (Window::BlackmanHarris, 0.36, 2.00),
        ];
        for (window, gain, enbw) in table {
            assert!((window.coherent_gain() - gain).abs() < 5.1e-3, "{window:?}");
            assert!((window.enbw() - enbw).abs() < 5.1e-3, "{window:?}");
        }
        // scipy 1.17, flattop of 64 samples.
        assert!((Window::FlatTop.enbw() - 3.770_246_447_443_428).abs() < 1e-14);
    }

    #[test]
    fn worst_scalloping_of_hann_and_none() {
        let decibel = |w| -20.0 * line_shape(w, 0.5).log10();
        assert!((decibel(Window::Hann) - 1.42).abs() < 5e-3);
        assert!((decibel(Window::Rectangular) - 3.92).abs() < 5e-3);
    }

    #[test]
    fn noise_of_neighbouring_hann_lines() {
        let c = |d| noise_correlation(Window::Hann, d);
        assert!((c(1) - 2.0 / 3.0).abs() < 1e-15 && (c(2) - 1.0 / 6.0).abs() < 1e-15 && c(3).abs() < 1e-15);
        assert_eq!(noise_correlation(Window::Rectangular, 1), 0.0);
    }
}

//! Spectra of sines in noise whose truth is known, for tests.

use num_complex::Complex64;
use vibro_math::Noise;
use vibro_record::units::Unit;
use vibro_record::{Axis, Meta, Trace, Window};
use vibro_signal::window::line_shape;

/// A displacement sampled at 1 kHz.
pub fn trace(values: Vec<f64>) -> Trace {
    let meta = Meta::new("a", Unit::parse("m").unwrap());
    Trace { meta, axis: Axis::time(0.0, 1e-3, values.len()), values }
}

fn pair(noise: &mut Noise, scale: f64) -> Complex64 {
    Complex64::new(scale * noise.normal(), scale * noise.normal())
}

/// Number of lines of a spectrum.
pub const LINES: usize = 161;

/// Magnitudes of sines (position in lines, complex amplitude) in white noise of `sigma` a component of a
/// line: noise of lines without a window, then the window's weights over neighbouring lines.
pub fn spectrum(window: Window, sines: &[(f64, Complex64)], sigma: f64, normal: &mut Noise) -> Vec<f64> {
    let a = window.coefficients();
    let reach = a.len() - 1;
    let scale = sigma * a[0] / (a[0] * a[0] * window.enbw()).sqrt();
    let raw: Vec<Complex64> = (0..LINES + 2 * reach).map(|_| pair(normal, scale)).collect();
    (0..LINES)
        .map(|k| {
            let mut line = a[0] * raw[k + reach];
            for (m, a) in a.iter().enumerate().skip(1) {
                let sign = if m % 2 == 0 { 0.5 } else { -0.5 };
                line += sign * a * (raw[k + reach - m] + raw[k + reach + m]);
            }
            line /= a[0];
            let sign = if k % 2 == 0 { 1.0 } else { -1.0 };
            for (position, amplitude) in sines {
                line += sign * amplitude * line_shape(window, k as f64 - position);
            }
            line.norm()
        })
        .collect()
}

/// 1/f noise of standard deviation 1 down to one period of `n` samples: first-order processes an octave
/// apart.
pub(crate) fn pink(noise: &mut Noise, n: usize) -> Vec<f64> {
    let keep: Vec<f64> = (0..n.ilog2()).map(|k| (-2.0 * 2f64.powi(-(k as i32))).exp()).collect();
    let mut states: Vec<f64> = keep.iter().map(|_| noise.normal()).collect();
    let mut next = || {
        for (state, keep) in states.iter_mut().zip(&keep) {
            *state = keep * *state + (1.0 - keep * keep).sqrt() * noise.normal();
        }
        states.iter().sum::<f64>() / (keep.len() as f64).sqrt()
    };
    (0..n).map(|_| next()).collect()
}

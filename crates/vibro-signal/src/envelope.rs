//! The envelope of a signal: its amplitude at each instant, whatever the phase.

use crate::fft::Transform;
use num_complex::Complex64;

/// √(x² + x̂²) with the Hilbert transform x̂, which delays each line by a quarter of a turn (Gabor, J. IEE 93
/// III (1946) 429).
///
/// ```
/// let swing = |i: i32| f64::from(i) * std::f64::consts::TAU / 16.0;
/// let tone: Vec<f64> = (0..256).map(|i| 3.0 * swing(i).cos()).collect();
/// assert!(vibro_signal::envelope::envelope(&tone).iter().all(|v| (v - 3.0).abs() < 1e-12));
/// ```
pub fn envelope(values: &[f64]) -> Vec<f64> {
    let transform = Transform::new(values.len());
    let behind = |line: Complex64| line * Complex64::new(0.0, -1.0);
    let turned: Vec<Complex64> = transform.forward(values).into_iter().map(behind).collect();
    values.iter().zip(transform.inverse(&turned)).map(|(x, y)| x.hypot(y)).collect()
}

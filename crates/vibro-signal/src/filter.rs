//! Filters: Butterworth as second-order sections, causal or without phase, and exponential smoothing.
//!
//! Analogue Butterworth poles lie on a half circle; the bilinear transform with pre-warped corners takes them
//! to the z plane (Oppenheim & Schafer, Discrete-Time Signal Processing, 3rd ed., sections 7.2 and 7.3). Each
//! section holds one pair of poles, so that high orders keep their digits.

use num_complex::Complex64;
use std::f64::consts::PI;
use vibro_record::units::notation::shortest;
use vibro_record::{Error, Result};

/// Highest order: above it, rounding and ringing dominate the output.
const MOST: usize = 16;

/// One section, H(z) = (b₀ + b₁z⁻¹ + b₂z⁻²)/(1 + a₁z⁻¹ + a₂z⁻²).
#[derive(Debug, Clone, Copy, PartialEq)]
struct Section {
    b: [f64; 3],
    a: [f64; 2],
}

/// A filter for one sampling rate.
///
/// At the corner frequency one pass has a gain of 1/√2 (−3 dB). [`Filter::zero_phase`] passes twice: its
/// gain at the corner is one half, and its order is doubled.
///
/// ```
/// use vibro_signal::filter::Filter;
/// let filter = Filter::low_pass(100.0, 4, 1000.0)?;
/// assert!((filter.response(100.0).norm() - 0.5f64.sqrt()).abs() < 1e-12);
/// let step: Vec<f64> = (0..200).map(|i| if i < 100 { 0.0 } else { 1.0 }).collect();
/// let smooth = filter.zero_phase(&step)?;
/// assert!((smooth[99] + smooth[100] - 1.0).abs() < 1e-6); // half way in the middle: no delay
/// # Ok::<(), vibro_record::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Filter {
    /// Kind, order and corner of the filter, as printed.
    name: String,
    rate: f64,
    sections: Vec<Section>,
}

impl Filter {
    /// Butterworth low-pass of this corner and sampling rate in Hz.
    ///
    /// # Errors
    /// If the corner does not lie between 0 and half the sampling rate, or the order is not 1 to 16.
    pub fn low_pass(corner: f64, order: usize, rate: f64) -> Result<Filter> {
        butterworth("low-pass", |w| ([w * w, 0.0, 0.0], [w, 0.0]), (corner, order, rate))
    }

    /// Butterworth high-pass of this corner and sampling rate in Hz.
    ///
    /// # Errors
    /// As [`Filter::low_pass`].
    pub fn high_pass(corner: f64, order: usize, rate: f64) -> Result<Filter> {
        butterworth("high-pass", |_| ([0.0, 0.0, 1.0], [0.0, 1.0]), (corner, order, rate))
    }

    /// Exponential smoothing yₙ = yₙ₋₁ + α(xₙ − yₙ₋₁), α such that the corner lies at `corner` Hz exactly.
    ///
    /// # Errors
    /// As [`Filter::low_pass`].
    pub fn smoothing(corner: f64, rate: f64) -> Result<Filter> {
        warped(corner, rate)?;
        // |H|² = α²/(α² + 2(1 − α)(1 − cos ω)) = 1/2, solved for α; 1 − cos ω = 2 sin²(ω/2).
        let c = 2.0 * (PI * corner / rate).sin().powi(2);
        let alpha = (c * c + 2.0 * c).sqrt() - c;
        let sections = vec![Section { b: [alpha, 0.0, 0.0], a: [alpha - 1.0, 0.0] }];
        Ok(Filter { name: format!("exponential smoothing, corner {} Hz", shortest(corner)), rate, sections })
    }

    /// Complex gain of one pass for a sine of `frequency` Hz.
    pub fn response(&self, frequency: f64) -> Complex64 {
        let z = Complex64::cis(-2.0 * PI * frequency / self.rate);
        let one = |s: &Section| (s.b[0] + z * (s.b[1] + z * s.b[2])) / (1.0 + z * (s.a[0] + z * s.a[1]));
        self.sections.iter().map(one).product()
    }

    /// Filters forwards, in place, as if the input had always been `before`; 0 for a filter at rest.
    pub fn causal(&self, values: &mut [f64], before: f64) {
        let mut level = before;
        for Section { b, a } in &self.sections {
            let out = level * (b[0] + b[1] + b[2]) / (1.0 + a[0] + a[1]);
            let mut second = b[2] * level - a[1] * out;
            let mut first = b[1] * level - a[0] * out + second;
            level = out;
            for v in &mut *values {
                let out = b[0] * *v + first;
                first = b[1] * *v - a[0] * out + second;
                second = b[2] * *v - a[1] * out;
                *v = out;
            }
        }
    }

    /// Filters forwards and backwards, so that nothing is delayed. Both ends are continued by their mirror
    /// image about the end point, as scipy's `sosfiltfilt` does (Gustafsson, IEEE Trans. Signal Process.
    /// 44 (1996) 988 on why ends matter).
    ///
    /// # Errors
    /// If the trace is not longer than three times the number of coefficients, or a sample is missing.
    pub fn zero_phase(&self, values: &[f64]) -> Result<Vec<f64>> {
        let pad = self.padding();
        let n = values.len();
        if n <= pad {
            let why =
                format!("{n} samples are too few for the zero-phase {self}: more than {pad} are needed");
            return Err(Error::refused(why).hint("filter a longer record, or with a lower order"));
        }
        if let Some(i) = values.iter().position(|v| !v.is_finite()) {
            return Err(Error::refused(format!("sample {i} is missing: a filter would spread it"))
                .hint("bridge the gap, or filter the parts between gaps"));
        }
        let (first, last) = (values[0], values[n - 1]);
        let mut out = Vec::with_capacity(n + 2 * pad);
        out.extend(values[1..=pad].iter().rev().map(|v| 2.0 * first - v));
        out.extend_from_slice(values);
        out.extend(values[n - 1 - pad..n - 1].iter().rev().map(|v| 2.0 * last - v));
        for _ in 0..2 {
            let before = out[0];
            self.causal(&mut out, before);
            out.reverse();
        }
        out.truncate(n + pad);
        out.drain(..pad);
        Ok(out)
    }

    /// Samples by which [`Filter::zero_phase`] continues both ends: three times the number of coefficients.
    fn padding(&self) -> usize {
        let zeros = |zero: fn(&Section) -> bool| self.sections.iter().filter(|s| zero(s)).count();
        let spare = zeros(|s| s.b[2] == 0.0).min(zeros(|s| s.a[1] == 0.0));
        3 * (2 * self.sections.len() + 1 - spare)
    }
}

impl std::fmt::Display for Filter {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&self.name)
    }
}

/// A Butterworth filter from the numerators of its pairs of poles and of the real pole of an odd order, which
/// depend on the pre-warped corner.
fn butterworth(
    kind: &str,
    numerators: fn(f64) -> ([f64; 3], [f64; 2]),
    (corner, order, rate): (f64, usize, f64),
) -> Result<Filter> {
    let w = warped(corner, rate)?;
    if !(1..=MOST).contains(&order) {
        return Err(Error::usage(format!("a filter of order {order}"), format!("an order of 1 to {MOST}")));
    }
    let (pair, real) = numerators(w);
    let cosine = |k: usize| (PI * (2 * k + order - 1) as f64 / (2 * order) as f64).cos();
    let pairs = (1..=order / 2).rev().map(|k| section(pair, [w * w, -2.0 * cosine(k) * w, 1.0]));
    let real = (order % 2 == 1).then(|| first(real, [w, 1.0]));
    let name = format!("Butterworth {kind} of order {order}, corner {} Hz", shortest(corner));
    Ok(Filter { name, rate, sections: real.into_iter().chain(pairs).collect() })
}

/// Pre-warped corner, tan(π·corner/rate), in the analogue plane of s = (1 − z⁻¹)/(1 + z⁻¹).
fn warped(corner: f64, rate: f64) -> Result<f64> {
    if !(corner > 0.0 && corner < rate / 2.0 && rate.is_finite()) {
        return Err(Error::usage(
            format!("a corner of {} Hz at a sampling rate of {} Hz", shortest(corner), shortest(rate)),
            format!("a corner above 0 and below {} Hz", shortest(rate / 2.0)),
        ));
    }
    Ok((PI * corner / rate).tan())
}

/// Bilinear transform of (b₀ + b₁s + b₂s²)/(a₀ + a₁s + a₂s²).
fn section(b: [f64; 3], a: [f64; 3]) -> Section {
    let gain = 1.0 / (a[0] + a[1] + a[2]);
    let z = |c: [f64; 3]| [c[0] + c[1] + c[2], 2.0 * (c[0] - c[2]), c[0] - c[1] + c[2]].map(|v| v * gain);
    let [_, a1, a2] = z(a);
    Section { b: z(b), a: [a1, a2] }
}

/// Bilinear transform of (b₀ + b₁s)/(a₀ + a₁s).
fn first(b: [f64; 2], a: [f64; 2]) -> Section {
    let gain = 1.0 / (a[0] + a[1]);
    Section { b: [(b[0] + b[1]) * gain, (b[0] - b[1]) * gain, 0.0], a: [(a[0] - a[1]) * gain, 0.0] }
}

#[cfg(test)]
mod tests;

//! The low-pass of an instrument.

use super::linear::Linear;
use num_complex::Complex64;
use std::f64::consts::{PI, TAU};
use vibro_math::border;
use vibro_record::{Error, Result};

/// Causal analog Butterworth low-pass.
#[derive(Debug, Clone, PartialEq)]
pub struct LowPass {
    /// Frequency of −3 dB in Hz.
    pub corner: f64,
    /// Number of poles.
    pub order: usize,
    /// Its poles and residues; nothing passes it directly.
    pub(super) linear: Linear,
}

/// Highest order: beyond it the residues cancel to fewer than ten digits.
const HIGHEST_ORDER: usize = 10;

impl LowPass {
    /// A low-pass of −3 dB at `corner` in Hz; poles at ω e^{iπ(2k + N − 1)/2N}, k = 1…N (Butterworth 1930).
    ///
    /// # Errors
    /// If the corner is not above 0 or the order not between 1 and 10.
    pub fn new(corner: f64, order: usize) -> Result<LowPass> {
        if !(corner.is_finite() && corner > 0.0) {
            let found = format!("a low-pass corner of {corner} Hz");
            return Err(Error::usage(found, "a finite number of hertz above 0"));
        }
        if !(1..=HIGHEST_ORDER).contains(&order) {
            let found = format!("a low-pass of order {order}");
            return Err(Error::usage(found, format!("an order between 1 and {HIGHEST_ORDER}")));
        }
        let n = order as f64;
        let on_circle = |k: usize| Complex64::cis(PI * (2.0 * k as f64 + n - 1.0) / (2.0 * n));
        let real = |k: usize| 2 * k == order + 1;
        let pole = |k: usize| if real(k) { Complex64::new(-1.0, 0.0) } else { on_circle(k) };
        let unit: Vec<Complex64> = (1..=order).map(pole).collect();
        let part = |(k, pole): (usize, &Complex64)| {
            let others = unit.iter().enumerate().filter(|(j, _)| *j != k);
            let product: Complex64 = others.map(|(_, other)| pole - other).product();
            (pole * TAU * corner, TAU * corner / product)
        };
        let parts = unit.iter().enumerate().map(part).collect();
        Ok(LowPass { corner, order, linear: Linear { direct: 0.0, parts } })
    }

    /// Magnitude of the response at `frequency` in Hz, `1/√(1 + (f/f_c)^2N)`.
    pub fn gain(&self, frequency: f64) -> f64 {
        1.0 / (1.0 + (frequency / self.corner).powi(2 * self.order as i32)).sqrt()
    }

    /// Covariance of the output at two instants `apart` in s, for white noise of the one-sided spectral
    /// density 1 per Hz at the input: ½∫h(t)h(t + τ)dt.
    pub fn autocovariance(&self, apart: f64) -> f64 {
        let parts = &self.linear.parts;
        let of = |(p, r): &(Complex64, Complex64)| {
            let with: Complex64 = parts.iter().map(|(other, residue)| -residue / (p + other)).sum();
            r * (p * apart.abs()).exp() * with
        };
        0.5 * parts.iter().map(of).sum::<Complex64>().re
    }

    /// Delay at low frequency in s: −dφ/dω at 0.
    pub fn delay(&self) -> f64 {
        self.linear.parts.iter().map(|(p, _)| -1.0 / p).sum::<Complex64>().re
    }

    /// Times in s of the largest value and of the first zero after it in the response to an impulse: no
    /// pulse filtered by this low-pass has them earlier. `None` for order 1, whose response has no zero.
    pub fn alone(&self) -> Option<[f64; 2]> {
        if self.order == 1 {
            return None;
        }
        let value = |t: f64| self.linear.parts.iter().map(|(p, r)| r * (p * t).exp()).sum::<Complex64>().re;
        let slope =
            |t: f64| self.linear.parts.iter().map(|(p, r)| r * p * (p * t).exp()).sum::<Complex64>().re;
        // Poles lie within ω of 0: a step of 1/(100·corner) turns none by more than 4°.
        let step = 0.01 / self.corner;
        let after = |from: f64, f: &dyn Fn(f64) -> f64| {
            let ends = (1..=1000).map(|i| from + step * f64::from(i)).find(|t| f(*t) < 0.0)?;
            Some(border(ends - step, ends, |t| f(t) > 0.0))
        };
        let peak = after(0.0, &slope)?;
        Some([peak, after(peak, &value)?])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The step response of order 2 is 1 − √2 e^{−ωt/√2} sin(ωt/√2 + π/4), that of order 1 is 1 − e^{−ωt}.
    #[test]
    fn step_responses_have_their_closed_forms() {
        let omega = TAU * 30e3;
        for t in [1e-9, 1e-6, 7e-6, 40e-6] {
            let step = |order| {
                let filter = LowPass::new(30e3, order).unwrap();
                filter.linear.exponential(Complex64::I, Complex64::ZERO, 1.0, &[t])[0]
            };
            let turned = omega * t / f64::sqrt(2.0);
            // 1 − (…) cancels to a rounding of 1, and the residues are of order ω/pole = 1.
            let second = 1.0 - f64::sqrt(2.0) * (-turned).exp() * (turned + PI / 4.0).sin();
            assert!((step(2) - second).abs() < 1e-14, "{t} {} {second}", step(2));
            assert!((step(1) + (-omega * t).exp_m1()).abs() < 1e-14);
        }
    }

    /// The impulse response of order 2 is proportional to e^{−at} sin at with a = ω/√2: its peak is at π/4a,
    /// its zero at π/a.
    #[test]
    fn the_response_to_an_impulse_has_its_times() {
        let a = TAU * 30e3 / f64::sqrt(2.0);
        let found = LowPass::new(30e3, 2).unwrap().alone().unwrap();
        for (time, expected) in found.iter().zip([PI / 4.0 / a, PI / a]) {
            // Values of order ω are rounded, and cross zero at a slope of order ω².
            assert!((time / expected - 1.0).abs() < 1e-13, "{time} {expected}");
        }
        assert!((3..=10).all(|order| LowPass::new(30e3, order).unwrap().alone().is_some()));
        assert_eq!(LowPass::new(30e3, 1).unwrap().alone(), None);
    }

    /// Order 1 passes noise as if to π/2 of its corner, and its covariance decays as e^{−ωτ}; the integral of
    /// the squared gain is the variance for any order.
    #[test]
    fn noise_behind_the_filter_has_its_closed_form() {
        let first = LowPass::new(100.0, 1).unwrap();
        for apart in [0.0, 1e-3, 5e-3] {
            let expected = 0.5 * PI * 100.0 * (-TAU * 100.0 * apart).exp();
            assert!((first.autocovariance(apart) / expected - 1.0).abs() < 1e-12);
        }
        for order in [2, 5, 8] {
            let filter = LowPass::new(100.0, order).unwrap();
            // Gain² falls as (f/f_c)^−4 or faster: beyond 10⁴ Hz lie 10⁻⁶·f_c/3. The midpoint rule errs by
            // less.
            let sum: f64 = (0..100_000).map(|i| 0.1 * filter.gain(0.1 * (f64::from(i) + 0.5)).powi(2)).sum();
            assert!((filter.autocovariance(0.0) / sum - 1.0).abs() < 1e-6, "{order}");
        }
    }

    #[test]
    fn a_ramp_is_the_integral_of_the_step() {
        let filter = LowPass::new(1.0, 4).unwrap();
        let times: Vec<f64> = (0..400).map(|i| f64::from(i) * 0.01).collect();
        let ramp = filter.linear.straight_lines(&[0.0, 1.5, 3.0, 4.5], 1.5, &times);
        let step = filter.linear.exponential(Complex64::I, Complex64::ZERO, 9.0, &times);
        let mut sum = 0.0;
        for i in 1..times.len() {
            sum += 0.005 * (step[i] + step[i - 1]);
            // The trapezoid errs by h²/12 times the change of slope, at most a few ω, of order 10.
            assert!((ramp[i] - sum).abs() < 1e-4 / 12.0 * 10.0, "{} {} {sum}", times[i], ramp[i]);
        }
        // Once settled, the output lags a ramp by exactly the delay.
        let late = times[399] - ramp[399];
        assert!((late - filter.delay()).abs() < 1e-4, "{late} {}", filter.delay());
    }

    #[test]
    fn a_pole_that_the_signal_shares_does_not_divide_by_nothing() {
        let filter = LowPass::new(1.0, 1).unwrap();
        let s = Complex64::new(-TAU, 0.0);
        for off in [0.0, 1e-12, 1e-5, 9.9e-4, 1.1e-3, 1e-2] {
            let found = filter.linear.exponential(Complex64::I, s * (1.0 + off), 5.0, &[0.4])[0];
            // ∫ω e^{−ω(t−τ)} e^{−ω(1+ε)τ} dτ = e^{−ωt}(1 − e^{−εωt})/ε, to second order in ε.
            let x = TAU * 0.4;
            let expected = (-x).exp() * x * (1.0 - off * x / 2.0 + (off * x).powi(2) / 6.0);
            // The next term of the series is (εωt)³/24; the difference of exponentials loses two digits.
            assert!(
                (found - expected).abs() < (off * x).powi(3) / 24.0 * x + 1e-13,
                "{off} {found} {expected}"
            );
        }
    }

    #[test]
    fn what_is_no_filter_is_refused() {
        assert!(
            LowPass::new(0.0, 2).is_err() && LowPass::new(1.0, 0).is_err() && LowPass::new(1.0, 11).is_err()
        );
    }
}

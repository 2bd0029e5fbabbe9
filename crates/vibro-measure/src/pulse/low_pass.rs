//! The low-pass of an instrument, applied to a model in closed form.

use num_complex::Complex64;
use std::f64::consts::{PI, TAU};
use vibro_math::border;
use vibro_record::{Error, Result};

/// Causal analog Butterworth low-pass as a sum of first-order parts: h(t) = Σ rₖ e^{pₖt}.
#[derive(Debug, Clone, PartialEq)]
pub struct LowPass {
    /// Frequency of −3 dB in Hz.
    pub corner: f64,
    /// Number of poles.
    pub order: usize,
    /// Poles pₖ in 1/s and residues rₖ in 1/s.
    parts: Vec<(Complex64, Complex64)>,
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
        let unit: Vec<Complex64> =
            (1..=order).map(|k| Complex64::cis(PI * (2.0 * k as f64 + n - 1.0) / (2.0 * n))).collect();
        let part = |(k, pole): (usize, &Complex64)| {
            let others = unit.iter().enumerate().filter(|(j, _)| *j != k);
            let product: Complex64 = others.map(|(_, other)| pole - other).product();
            (pole * TAU * corner, TAU * corner / product)
        };
        let parts = unit.iter().enumerate().map(part).collect();
        Ok(LowPass { corner, order, parts })
    }

    /// Delay at low frequency in s: −dφ/dω at 0.
    pub fn delay(&self) -> f64 {
        self.parts.iter().map(|(p, _)| -1.0 / p).sum::<Complex64>().re
    }

    /// Times in s of the largest value and of the first zero after it in the response to an impulse: no
    /// pulse filtered by this low-pass has them earlier. `None` for order 1, whose response has no zero.
    pub fn alone(&self) -> Option<[f64; 2]> {
        if self.order == 1 {
            return None;
        }
        let value = |t: f64| self.parts.iter().map(|(p, r)| r * (p * t).exp()).sum::<Complex64>().re;
        let slope = |t: f64| self.parts.iter().map(|(p, r)| r * p * (p * t).exp()).sum::<Complex64>().re;
        // Poles lie within ω of 0: a step of 1/(100·corner) turns none by more than 4°.
        let step = 0.01 / self.corner;
        let after = |from: f64, f: &dyn Fn(f64) -> f64| {
            let ends = (1..=1000).map(|i| from + step * f64::from(i)).find(|t| f(*t) < 0.0)?;
            Some(border(ends - step, ends, |t| f(t) > 0.0))
        };
        let peak = after(0.0, &slope)?;
        Some([peak, after(peak, &value)?])
    }

    /// Response at `t` in s to c e^{st} from 0 to `length` in s, and to 0 elsewhere.
    pub(super) fn exponential(&self, c: Complex64, s: Complex64, length: f64, t: f64) -> Complex64 {
        if t <= 0.0 {
            return Complex64::new(0.0, 0.0);
        }
        let (inside, after) = (t.min(length), (t - length).max(0.0));
        let driven = (s * inside).exp();
        let one = |(p, r): &(Complex64, Complex64)| {
            let z = (s - p) * inside;
            // (e^{su} − e^{pu})/(s − p) loses digits where the exponents are near each other.
            let sum = if z.norm() < 1e-2 {
                (p * inside).exp() * inside * mean_exponentials(z).0
            } else {
                (driven - (p * inside).exp()) / (s - p)
            };
            if after > 0.0 { r * sum * (p * after).exp() } else { r * sum }
        };
        let sum: Complex64 = self.parts.iter().map(one).sum();
        sum * c
    }

    /// Response at each of the rising `times` to values at 0, `step`, 2·`step`, … joined by straight lines, 0
    /// elsewhere; exact for such an input.
    pub(super) fn straight_lines(&self, input: &[f64], step: f64, times: &[f64]) -> Vec<f64> {
        let mut out = vec![0.0; times.len()];
        let pieces = input.len().saturating_sub(1);
        for (p, r) in &self.parts {
            let whole = Advance::over(*p, step);
            let mut state = Complex64::new(0.0, 0.0);
            let mut done = 0;
            for (t, out) in times.iter().zip(&mut out) {
                if *t <= 0.0 {
                    continue;
                }
                let piece = ((t / step) as usize).min(pieces);
                while done < piece {
                    state = whole.apply(state, input[done], input[done + 1]);
                    done += 1;
                }
                let rest = t - done as f64 * step;
                let now = if done == pieces {
                    state * (p * rest).exp()
                } else {
                    let end = input[done] + (input[done + 1] - input[done]) * rest / step;
                    Advance::over(*p, rest).apply(state, input[done], end)
                };
                *out += (r * now).re;
            }
        }
        out
    }
}

/// One step of y′ = py + u for u on a straight line.
struct Advance {
    decay: Complex64,
    first: Complex64,
    second: Complex64,
}

impl Advance {
    fn over(p: Complex64, h: f64) -> Advance {
        let z = p * h;
        let (first, second) = mean_exponentials(z);
        Advance { decay: z.exp(), first: h * (first - second), second: h * second }
    }

    fn apply(&self, state: Complex64, from: f64, to: f64) -> Complex64 {
        self.decay * state + self.first * from + self.second * to
    }
}

/// (e^z − 1)/z and (e^z − 1 − z)/z², by their series for small z, where the differences lose digits.
fn mean_exponentials(z: Complex64) -> (Complex64, Complex64) {
    if z.norm() < 0.1 {
        let second =
            0.5 + z * (1.0 / 6.0 + z * (1.0 / 24.0 + z * (1.0 / 120.0 + z * (1.0 / 720.0 + z / 5040.0))));
        (1.0 + z * second, second)
    } else {
        let first = (z.exp() - 1.0) / z;
        (first, (first - 1.0) / z)
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
                filter.exponential(Complex64::new(1.0, 0.0), Complex64::new(0.0, 0.0), 1.0, t).re
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

    #[test]
    fn a_ramp_is_the_integral_of_the_step() {
        let filter = LowPass::new(1.0, 4).unwrap();
        let times: Vec<f64> = (0..400).map(|i| f64::from(i) * 0.01).collect();
        let ramp = filter.straight_lines(&[0.0, 1.5, 3.0, 4.5], 1.5, &times);
        let (one, zero) = (Complex64::new(1.0, 0.0), Complex64::new(0.0, 0.0));
        let step: Vec<f64> = times.iter().map(|t| filter.exponential(one, zero, 9.0, *t).re).collect();
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
            let found = filter.exponential(Complex64::new(1.0, 0.0), s * (1.0 + off), 5.0, 0.4).re;
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

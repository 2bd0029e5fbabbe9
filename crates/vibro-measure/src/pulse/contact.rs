//! Contact of spring and damper side by side.

use super::LowPass;
use super::linear::Linear;
use num_complex::Complex64;
use std::f64::consts::{PI, TAU};

/// Contact of damping ratio ξ and undamped frequency f, with approach at unit velocity and separation at
/// zero force.
///
/// With ω = 2πf, sin θ = ξ, Ω = ω cos θ and h = ωξ the deceleration is a(t) = (ω/cos θ) e^{−ht} sin(Ωt + 2θ)
/// from 0 to (π − 2θ)/Ω: it begins with a jump to 2ξω.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct KelvinVoigt {
    theta: f64,
    omega: f64,
}

impl KelvinVoigt {
    /// A contact; a fit to noise may need a slightly negative ξ, so −0.5 < ξ < 1 is allowed. `None` outside,
    /// and where f is not above 0.
    pub fn new(xi: f64, frequency: f64) -> Option<KelvinVoigt> {
        let possible = xi > -0.5 && xi < 1.0 && frequency > 0.0 && frequency.is_finite();
        possible.then(|| KelvinVoigt { theta: xi.asin(), omega: TAU * frequency })
    }

    /// The contact of ξ that lasts `duration` seconds: ω = (π − 2θ)/(t cos θ).
    pub fn lasting(duration: f64, xi: f64) -> Option<KelvinVoigt> {
        let theta = xi.asin();
        KelvinVoigt::new(xi, (PI - 2.0 * theta) / (TAU * duration * theta.cos()))
    }

    /// ξ.
    pub fn xi(&self) -> f64 {
        self.theta.sin()
    }

    /// f = ω/2π in Hz.
    pub fn frequency(&self) -> f64 {
        self.omega / TAU
    }

    /// Time to zero force in s.
    pub fn duration(&self) -> f64 {
        (PI - 2.0 * self.theta) / (self.omega * self.theta.cos())
    }

    /// Time to the largest force in s; `None` for ξ ≥ 1/2, where the force is largest at the beginning.
    pub fn time_to_peak(&self) -> Option<f64> {
        let angle = PI / 2.0 - 3.0 * self.theta;
        (self.xi() < 0.5).then(|| angle / (self.omega * self.theta.cos()))
    }

    /// Largest deceleration in m/s² for each m/s of approach: that at the onset for ξ ≥ 1/2.
    pub(super) fn peak(&self) -> f64 {
        self.unbounded(self.time_to_peak().unwrap_or(0.0))
    }

    /// Velocity after over velocity before: exp(−(π − 2θ) tan θ).
    pub fn restitution(&self) -> f64 {
        (-(PI - 2.0 * self.theta) * self.theta.tan()).exp()
    }

    /// Deceleration at `t` in s, in m/s² for each m/s of approach, continued smoothly before 0 and after the
    /// duration.
    pub(crate) fn unbounded(&self, t: f64) -> f64 {
        let (h, turn) = (self.omega * self.theta.sin(), self.omega * self.theta.cos());
        self.omega / self.theta.cos() * (-h * t).exp() * (turn * t + 2.0 * self.theta).sin()
    }

    /// Deceleration at `t` in s, in m/s² for each m/s of approach, as an instrument with this low-pass shows
    /// it.
    pub fn filtered(&self, filter: &LowPass, t: f64) -> f64 {
        self.through(&filter.linear, &[t])[0]
    }

    /// Deceleration at each of the `times` in s, in m/s² for each m/s of approach, as the parts of an
    /// instrument show it.
    pub(super) fn through(&self, instrument: &Linear, times: &[f64]) -> Vec<f64> {
        let s = Complex64::new(-self.omega * self.theta.sin(), self.omega * self.theta.cos());
        let c = Complex64::cis(2.0 * self.theta) * (self.omega / self.theta.cos());
        instrument.exponential(c, s, self.duration(), times)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use vibro_math::Oscillator;

    /// The free motion of mass, spring and damper at unit velocity, by the kernels of `math::Oscillator`.
    #[test]
    fn the_deceleration_is_that_of_a_free_oscillator() {
        for xi in [0.0, 0.05, 0.18, 0.5, 0.9] {
            let contact = KelvinVoigt::new(xi, 25e3).unwrap();
            let omega = TAU * 25e3;
            let oscillator = Oscillator::new(1.0, 2.0 * xi * omega, omega * omega);
            for part in 0..=10 {
                let t = contact.duration() * f64::from(part) / 10.0;
                let (x, v) = oscillator.free(0.0, 1.0, t);
                let found = contact.unbounded(t);
                // ω/cos θ times a few roundings of an angle of order 1.
                let tolerance = 64.0 * f64::EPSILON * omega / (1.0 - xi * xi);
                assert!((found + oscillator.acceleration(x, v)).abs() < tolerance, "{xi} {t}");
            }
            let (x, v) = oscillator.free(0.0, 1.0, contact.duration());
            assert!(oscillator.acceleration(x, v).abs() < 1e-13 * omega, "{xi}");
            assert!((v + contact.restitution()).abs() < 1e-13, "{xi} {v}");
        }
    }

    #[test]
    fn the_peak_is_where_the_slope_vanishes() {
        for xi in [-0.1, 0.0, 0.2, 0.49] {
            let contact = KelvinVoigt::new(xi, 1.0).unwrap();
            let t = contact.time_to_peak().unwrap();
            let h = 1e-5;
            let slope = (contact.unbounded(t + h) - contact.unbounded(t - h)) / (2.0 * h);
            // A central difference errs by h²ω⁴/6 = 3e-8 and by rounding, ωε/h.
            assert!(slope.abs() < 1e-6, "{xi} {slope}");
        }
        assert_eq!(KelvinVoigt::new(0.5, 1.0).and_then(|c| c.time_to_peak()), None);
    }

    /// A numerical convolution with the impulse response of order 2, ω√2 e^{−ωt/√2} sin(ωt/√2).
    #[test]
    fn the_filtered_pulse_is_a_convolution() {
        let contact = KelvinVoigt::new(0.2, 25e3).unwrap();
        let filter = LowPass::new(30e3, 2).unwrap();
        let omega = TAU * 30e3 / f64::sqrt(2.0);
        let n = 20_000;
        for t in [2e-6, 9e-6, 17e-6, 30e-6, 80e-6] {
            let end = contact.duration().min(t);
            let h = end / f64::from(n);
            let sum: f64 = (0..n)
                .map(|i| {
                    let tau = (f64::from(i) + 0.5) * h;
                    let ago = t - tau;
                    contact.unbounded(tau) * 2.0 * omega * (-omega * ago).exp() * (omega * ago).sin() * h
                })
                .sum();
            // The midpoint rule errs by h²/24 of the second derivative, about (3e5)² of the value: below
            // 1e-7.
            assert!((contact.filtered(&filter, t) - sum).abs() < 1e-7 * 25e3 * TAU, "{t}");
        }
    }
}

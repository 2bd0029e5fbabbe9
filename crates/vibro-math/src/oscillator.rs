//! Free motion of one damped oscillator, evaluated exactly, whatever its damping.
//!
//! With b = c/2m, Ω² = k/m and λ² = Ω² − b², every free motion of m ẍ + c ẋ + k x = 0 is
//! x(t) = x₀ C(t) + (v₀ + b x₀) S(t), C = e^{−bt} cos λt, S = e^{−bt} sin(λt)/λ.
//! Above critical damping λ is imaginary and C, S are sums of two decays; at critical damping S = t e^{−bt}.

use std::f64::consts::PI;

/// One damped oscillator. Its free motion depends on c/m and k/m only, so the mass is not stored.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Oscillator {
    /// b = c/2m in 1/s.
    b: f64,
    /// Ω² = k/m in 1/s².
    omega2: f64,
    /// λ² in 1/s², negative above critical damping.
    lambda2: f64,
    /// |λ| in 1/s.
    lambda: f64,
    /// b + √(b² + Ω²) in 1/s, see [`Oscillator::gain`].
    gain: f64,
    /// 1/Ω² in s².
    compliance: f64,
    /// Slowest decay rate in 1/s: b, or b − |λ| above critical damping. The latter is computed as
    /// Ω²/(b + |λ|), which loses no digits by cancellation.
    slow: f64,
}

/// Value of |λ²|t² below which the kernels C and S are summed as series of three terms. The first term that
/// is left out is then below 1e-18/720.
const SERIES: f64 = 1e-6;

impl Oscillator {
    /// Oscillator of mass `m` > 0 in kg, damping `c` ≥ 0 in N s/m and stiffness `k` ≥ 0 in N/m.
    pub fn new(m: f64, c: f64, k: f64) -> Oscillator {
        let (b, omega2) = (c / (2.0 * m), k / m);
        let lambda2 = omega2 - b * b;
        let lambda = lambda2.abs().sqrt();
        let slow = if lambda2 < 0.0 { omega2 / (b + lambda) } else { b };
        let gain = b + (b * b + omega2).sqrt();
        Oscillator { b, omega2, lambda2, lambda, gain, compliance: 1.0 / omega2, slow }
    }

    /// b = c/2m in 1/s.
    pub fn decay(&self) -> f64 {
        self.b
    }

    /// The slowest rate in 1/s at which the free motion decays: b, or above critical damping the slower of
    /// its two decays.
    pub fn slowest(&self) -> f64 {
        self.slow
    }

    /// Ω² = k/m in 1/s².
    pub fn omega2(&self) -> f64 {
        self.omega2
    }

    /// b + √(b² + Ω²) in 1/s: largest ratio of the bound on the derivative of a motion to the bound on the
    /// motion itself, see [`Oscillator::bound`].
    ///
    /// In the norm √(v² + Ω²x²) the derivative is the matrix [[0, Ω], [−Ω, −2b]], whose singular values are
    /// √(b² + Ω²) ± b.
    #[inline]
    pub fn gain(&self) -> f64 {
        self.gain
    }

    /// C(t) = e^{−bt} cos λt and S(t) = e^{−bt} sin(λt)/λ (in s), `t` ≥ 0 in s.
    #[inline]
    pub fn kernels(&self, t: f64) -> (f64, f64) {
        let z = self.lambda2 * t * t;
        if z.abs() < SERIES {
            let e = (-self.b * t).exp();
            (e * (1.0 - z / 2.0 + z * z / 24.0), e * t * (1.0 - z / 6.0 + z * z / 120.0))
        } else if z > 0.0 {
            let e = (-self.b * t).exp();
            let (sin, cos) = super::cis::sin_cos(self.lambda * t);
            (e * cos, e * sin / self.lambda)
        } else {
            let e = (-self.slow * t).exp();
            // e^{−2|λ|t} − 1.
            let decayed = (-2.0 * self.lambda * t).exp_m1();
            (e * (1.0 + decayed / 2.0), -e * decayed / (2.0 * self.lambda))
        }
    }

    /// Displacement and velocity at `t` ≥ 0 in s after displacement `x` in m and velocity `v` in m/s.
    #[inline]
    pub fn free(&self, x: f64, v: f64, t: f64) -> (f64, f64) {
        let (c, s) = self.kernels(t);
        (x * c + (v + self.b * x) * s, v * c - (self.omega2 * x + self.b * v) * s)
    }

    /// Acceleration in free motion at displacement `x` and velocity `v`.
    #[inline]
    pub fn acceleration(&self, x: f64, v: f64) -> f64 {
        -self.omega2 * x - 2.0 * self.b * v
    }

    /// Bound on |x| at all later times after displacement `x` and velocity `v`.
    ///
    /// The energy v² + Ω²x² of a free motion never grows, so x² ≤ x₀² + (v₀/Ω)² at any damping, also for λ
    /// near zero. Derivatives of a free motion are free motions, too, so the formula bounds them as well.
    /// Without a spring the result is infinite if there is a velocity.
    #[inline]
    pub fn bound(&self, x: f64, v: f64) -> f64 {
        if v == 0.0 { x.abs() } else { (x * x + v * v * self.compliance).sqrt() }
    }

    /// Times in `0 < t < until` in s at which the free motion from displacement `x` and velocity `v` passes
    /// through zero, in their order.
    ///
    /// x₀ cos λt + (v₀ + bx₀) sin(λt)/λ = 0 gives tan λt = −x₀λ/(v₀ + bx₀). Below critical damping the
    /// passages are π/λ apart; from critical damping on there is at most one.
    pub fn passages(&self, x: f64, v: f64, until: f64) -> impl Iterator<Item = f64> + use<> {
        let (lambda, w) = (self.lambda, v + self.b * x);
        let (first, apart) = if x == 0.0 && w == 0.0 {
            (f64::INFINITY, f64::INFINITY)
        } else if self.lambda2 > 0.0 {
            (f64::atan2(x * lambda, -w).rem_euclid(PI) / lambda, PI / lambda)
        } else if lambda == 0.0 {
            (-x / w, f64::INFINITY)
        } else {
            ((-x * lambda / w).atanh() / lambda, f64::INFINITY)
        };
        let passage = move |n: u32| if n == 0 { first } else { first + f64::from(n) * apart };
        // Comparisons with NaN are false: NaN ends the list.
        (0..).map(passage).take_while(move |t| *t < until).filter(|t| *t > 0.0)
    }

    /// 1 − C(T) and det(I − Φ(T)) = (1 − C)² + λ²S² for a period T in s. Φ is the matrix of the free motion.
    /// Neither loses digits by cancellation at small damping.
    ///
    /// The determinant vanishes only without damping and with λT a whole multiple of 2π.
    pub fn closing(&self, period: f64) -> (f64, f64) {
        let z = self.lambda2 * period * period;
        if self.lambda2 < 0.0 && z.abs() >= SERIES {
            let slow = -(-self.slow * period).exp_m1();
            let fast = -(-(self.b + self.lambda) * period).exp_m1();
            return (f64::midpoint(slow, fast), slow * fast);
        }
        let lost = -(-self.b * period).exp_m1();
        let versine = if z.abs() < SERIES {
            z / 2.0 * (1.0 - z / 12.0)
        } else {
            2.0 * (self.lambda * period / 2.0).sin().powi(2)
        };
        let turn = (1.0 - lost) * versine;
        (lost + turn, lost * lost + 2.0 * turn)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Slow oracle: the Taylor series of exp(At) with scaling and squaring, for A = [[0, 1], [−Ω², −2b]].
    fn exponential(omega2: f64, b: f64, t: f64) -> [[f64; 2]; 2] {
        let halvings = 40;
        let h = t / f64::powi(2.0, halvings);
        let product = |p: [[f64; 2]; 2], q: [[f64; 2]; 2]| {
            let mut r = [[0.0; 2]; 2];
            for (i, row) in r.iter_mut().enumerate() {
                for (j, cell) in row.iter_mut().enumerate() {
                    *cell = p[i][0] * q[0][j] + p[i][1] * q[1][j];
                }
            }
            r
        };
        // exp − I is squared as (I + E)² − I = 2E + E², so that the small step keeps its digits.
        let a = [[0.0, h], [-omega2 * h, -2.0 * b * h]];
        let a2 = product(a, a);
        let mut e = [[0.0; 2]; 2];
        for i in 0..2 {
            for j in 0..2 {
                e[i][j] = a[i][j] + a2[i][j] / 2.0;
            }
        }
        for _ in 0..halvings {
            let square = product(e, e);
            for i in 0..2 {
                for j in 0..2 {
                    e[i][j] = 2.0 * e[i][j] + square[i][j];
                }
            }
        }
        e[0][0] += 1.0;
        e[1][1] += 1.0;
        e
    }

    #[test]
    fn free_motion_is_the_matrix_exponential_at_any_damping() {
        let (m, k) = (0.125, 135.0);
        let critical = 2.0 * f64::sqrt(k * m);
        for factor in [0.0, 0.012, 0.9, 1.0 - 1e-9, 1.0, 1.0 + 1e-9, 1.1, 30.0] {
            let c = factor * critical;
            let oscillator = Oscillator::new(m, c, k);
            for t in [1e-4, 0.01, 0.1, 0.5] {
                let phi = exponential(k / m, c / (2.0 * m), t);
                // The oracle squares 40 times, each time adding a few roundings of numbers up to Ω in size;
                // a rounding early on is doubled with the exponent, so about 40 of them reach the end.
                let tolerance = 400.0 * f64::EPSILON * (k / m).sqrt() * (1.0 + factor);
                let (x, v) = oscillator.free(1.0, 0.0, t);
                assert!((x - phi[0][0]).abs() < tolerance, "{factor} {t} {x} {}", phi[0][0]);
                assert!((v - phi[1][0]).abs() < tolerance * (k / m).sqrt(), "{factor} {t}");
                let (x, v) = oscillator.free(0.0, 1.0, t);
                assert!((x - phi[0][1]).abs() < tolerance, "{factor} {t}");
                assert!((v - phi[1][1]).abs() < tolerance, "{factor} {t}");
            }
        }
    }

    #[test]
    fn the_series_joins_the_closed_forms() {
        // λ²t² on both sides of the switch, under- and overdamped: C and S change by no more than λ²t² does.
        for sign in [1.0, -1.0] {
            let b = 3.0;
            let make = |z: f64| Oscillator::new(1.0, 2.0 * b, b * b + sign * z);
            let (inside, outside) = (make(SERIES * 0.999_999), make(SERIES * 1.000_001));
            let ((c0, s0), (c1, s1)) = (inside.kernels(1.0), outside.kernels(1.0));
            let change = SERIES * 2e-6;
            // λ² = Ω² − b² itself is rounded to about 2ε·b².
            let tolerance = change + 8.0 * f64::EPSILON * b * b;
            assert!((c0 - c1).abs() < tolerance && (s0 - s1).abs() < tolerance);
        }
    }

    #[test]
    fn the_energy_bound_holds_and_is_reached() {
        let undamped = Oscillator::new(2.0, 0.0, 8.0);
        let bound = undamped.bound(0.3, 0.8);
        let largest =
            (0..4000).map(|i| undamped.free(0.3, 0.8, f64::from(i) * 1e-3).0.abs()).fold(0.0, f64::max);
        // Sampled at 1 ms, a crest of curvature Ω²·bound is missed by at most Ω²·bound·(0.5 ms)²/2.
        assert!(largest <= bound * (1.0 + 1e-15) && largest > bound * (1.0 - 4.0 * 0.25e-6 / 2.0));
        for c in [0.1, 8.0, 100.0] {
            let damped = Oscillator::new(2.0, c, 8.0);
            let bound = damped.bound(-0.3, 2.0);
            assert!((0..4000).all(|i| damped.free(-0.3, 2.0, f64::from(i) * 1e-3).0.abs() <= bound));
        }
    }

    #[test]
    fn closing_matches_its_definition() {
        for c in [0.0, 0.1, 2.0 * f64::sqrt(135.0 * 0.125), 40.0] {
            let oscillator = Oscillator::new(0.125, c, 135.0);
            for period in [0.05, 0.19, 0.7] {
                let (less, determinant) = oscillator.closing(period);
                let (cosine, sine) = oscillator.kernels(period);
                // The definition cancels to a rounding of 1 (of (λS)² near 1): compare absolutely.
                assert!((less - (1.0 - cosine)).abs() < 8.0 * f64::EPSILON);
                let plain = (1.0 - cosine).powi(2) + oscillator.lambda2 * sine * sine;
                assert!(
                    (determinant - plain).abs() < 64.0 * f64::EPSILON,
                    "{c} {period} {determinant} {plain}"
                );
            }
        }
    }

    #[test]
    fn passages_are_zeros_and_none_is_left_out() {
        let critical = 2.0 * f64::sqrt(0.125 * 135.0);
        for c in [0.0, 0.1, 3.0, 0.999_999_9 * critical, critical, 1.000_000_1 * critical, 2.0 * critical] {
            let oscillator = Oscillator::new(0.125, c, 135.0);
            for (x, v) in [(1e-3, 0.2), (1e-3, -0.5), (-2e-3, 0.01), (0.0, 0.3), (1e-3, 0.0), (0.0, 0.0)] {
                let found: Vec<f64> = oscillator.passages(x, v, 1.0).collect();
                for t in &found {
                    // Allowed: the rounding of λt times the speed, and that of the size of the motion.
                    let (at, speed) = oscillator.free(x, v, *t);
                    let size = oscillator.bound(x, v);
                    assert!(at.abs() <= 64.0 * f64::EPSILON * (size + speed.abs() * t), "c {c}: {at} at {t}");
                }
                // Counts changes of sign between samples 0.1 ms apart; the period is 0.19 s.
                let at = |i: u32| oscillator.free(x, v, f64::from(i) * 1e-4).0;
                let changes = (1..10_000).filter(|i| at(*i) * at(i + 1) < 0.0).count();
                assert_eq!(found.len(), changes, "c {c}, {x} m, {v} m/s: {found:?}");
            }
        }
    }
}

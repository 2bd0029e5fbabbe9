//! Passages of a free motion through its rest, in closed form.

use super::Oscillator;

/// Times in `0 < t < until` at which the free motion from displacement `x` and velocity `v` passes through zero, in their order.
///
/// x₀ cos λt + (v₀ + bx₀) sin(λt)/λ = 0, so tan λt = −x₀λ/(v₀ + bx₀): equal distances π/λ below critical damping, at most one passage
/// from there on.
pub fn passages(oscillator: &Oscillator, x: f64, v: f64, until: f64) -> impl Iterator<Item = f64> + use<> {
    let (lambda2, w) = (oscillator.lambda2(), v + oscillator.decay() * x);
    let lambda = lambda2.abs().sqrt();
    let rest = x == 0.0 && w == 0.0;
    let (first, apart) = if rest {
        (f64::INFINITY, f64::INFINITY)
    } else if lambda2 > 0.0 {
        let turn = f64::atan2(x * lambda, -w).rem_euclid(std::f64::consts::PI);
        (turn / lambda, std::f64::consts::PI / lambda)
    } else if lambda == 0.0 {
        (-x / w, f64::INFINITY)
    } else {
        ((-x * lambda / w).atanh() / lambda, f64::INFINITY)
    };
    let mut n = 0.0;
    std::iter::from_fn(move || {
        loop {
            let t = if n == 0.0 { first } else { first + n * apart };
            n += 1.0;
            // The last also where there is none, or it is not a number.
            if t < until {
                if t > 0.0 {
                    return Some(t);
                }
                if apart.is_infinite() {
                    return None;
                }
            } else {
                return None;
            }
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn passages_are_zeros_and_none_is_left_out() {
        let critical = 2.0 * f64::sqrt(0.125 * 135.0);
        for c in [0.0, 0.1, 3.0, 0.999_999_9 * critical, critical, 1.000_000_1 * critical, 2.0 * critical] {
            let oscillator = Oscillator::new(0.125, c, 135.0);
            for (x, v) in [(1e-3, 0.2), (1e-3, -0.5), (-2e-3, 0.01), (0.0, 0.3), (1e-3, 0.0), (0.0, 0.0)] {
                let found: Vec<f64> = passages(&oscillator, x, v, 1.0).collect();
                for t in &found {
                    // Rounding of λt, times the speed, against the size of the motion.
                    let (at, speed) = oscillator.free(x, v, *t);
                    let size = oscillator.bound(x, v);
                    assert!(at.abs() <= 64.0 * f64::EPSILON * (size + speed.abs() * t), "c {c}: {at} at {t}");
                }
                // Signs between samples 0.1 ms apart, where the period is 0.19 s.
                let at = |i: u32| oscillator.free(x, v, f64::from(i) * 1e-4).0;
                let changes = (1..10_000).filter(|i| at(*i) * at(i + 1) < 0.0).count();
                assert_eq!(found.len(), changes, "c {c}, {x} m, {v} m/s: {found:?}");
            }
        }
    }
}

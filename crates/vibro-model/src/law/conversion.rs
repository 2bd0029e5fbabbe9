//! Conversion between contact laws and restitution, for a rebound without other forces.
//!
//! Kelvin–Voigt with ζ = c₃/2√(k₃M) and ω₀² = k₃/M, which ends where its force vanishes: with sin ψ = ζ the
//! contact lasts (π − 2ψ)/(ω₀ cos ψ) and R = exp(−(π − 2ψ) tan ψ); for ζ = 1 it lasts 2/ω₀ and R = e⁻²;
//! for ζ > 1 it lasts 2 acosh ζ/(ω₀√(ζ² − 1)) and R = exp(−2ζ acosh ζ/√(ζ² − 1)). Derived from the free
//! motion of mass, spring and damper; the first also in Anagnostopoulos (2004) and Nagurka & Huang (2004).
//! R falls with ζ, to 1/(4ζ²) for large ζ.
//!
//! The restitution of Hunt–Crossley F = kδⁿ(1 + αδ̇) depends only on αv, not on k, n and mass (Hunt &
//! Crossley 1975; exact, by integrating v dv/(1 + αv) over the contact): αv(1 + R) = ln((1 + αv)/(1 − Rαv)).
//!
//! Hertz F = kδ^{3/2} (Johnson 1985, 11.22 to 11.24): largest indentation (5Mv²/4k)^{2/5}, duration 2.9432
//! times this over v.

use vibro_math::bisected;
use vibro_record::{Error, Result};

/// Duration of a contact times √(k₃/M), for a damping ratio ζ ≥ 0.
///
/// Near ζ = 1 both closed forms tend to 0/0; there the series of their common analytic function is summed, up
/// to a last term below 1e-19.
fn turn(ratio: f64) -> f64 {
    let x = (1.0 - ratio) / (1.0 + ratio);
    // With tan(π/4 − ψ/2) = √((1 − ζ)/(1 + ζ)) =: √x, π − 2ψ = 4 atan √x and √(1 − ζ²) = (1 + ζ)√x.
    let arc = if x.abs() < 0.02 {
        (0_u32..=10).rev().fold(0.0, |sum, n| 1.0 / f64::from(2 * n + 1) - x * sum)
    } else if x > 0.0 {
        x.sqrt().atan() / x.sqrt()
    } else {
        // atanh √y with 1 − √y free of cancellation: (1 + √y)²/(1 − y), 1 − y = 2/(1 + ζ).
        let root = (-x).sqrt();
        ((1.0 + root) * f64::midpoint(1.0, ratio).sqrt()).ln() / root
    };
    4.0 * arc / (1.0 + ratio)
}

/// R of a Kelvin–Voigt contact of damping ratio ζ ≥ 0; NaN for a negative one.
pub fn restitution(damping_ratio: f64) -> f64 {
    if damping_ratio >= 0.0 { (-damping_ratio * turn(damping_ratio)).exp() } else { f64::NAN }
}

/// Duration in s of a Kelvin–Voigt contact of damping ratio ζ ≥ 0, of stiffness `stiffness` (N/m) and reduced
/// mass `mass` (kg).
pub fn duration(damping_ratio: f64, stiffness: f64, mass: f64) -> f64 {
    if damping_ratio >= 0.0 { turn(damping_ratio) / (stiffness / mass).sqrt() } else { f64::NAN }
}

/// ζ of a Kelvin–Voigt contact with the restitution R, by bisection of ln R to the last digit.
///
/// # Errors
/// If R is outside 0 < R ≤ 1: with finite damping there is always a rebound.
pub fn damping_ratio(restitution: f64) -> Result<f64> {
    let wanted = check(restitution)?;
    // −ln R rises with ζ without limit.
    let exact = |ratio: f64| ratio * turn(ratio);
    let mut high = 1.0;
    while exact(high) < wanted && high < 1e160 {
        high *= 2.0;
    }
    Ok(solve(0.0, high, wanted, exact))
}

/// αv of a Hunt–Crossley contact with the restitution R at the approach speed v.
///
/// # Errors
/// If R is outside 0 < R ≤ 1.
pub fn loss(restitution: f64) -> Result<f64> {
    check(restitution)?;
    let r = restitution;
    if r == 1.0 {
        return Ok(0.0);
    }
    // The energy balance over (αv)² rises from −(1 − R²)/2 at 0 and crosses zero once before its pole at αv =
    // 1/R.
    let balance = |a: f64| if a >= 1.0 / r { f64::INFINITY } else { less(a) - less(-r * a) };
    Ok(solve(0.0, 1.0 / r, 0.0, balance))
}

/// ln(1 + x) − x without cancellation; the truncation of the series is below 0.05¹⁵/15 of x.
fn less(x: f64) -> f64 {
    if x.abs() < 0.05 {
        let mut sum = 0.0;
        for n in (2..=14).rev() {
            let sign = if n % 2 == 0 { -1.0 } else { 1.0 };
            sum = sum * x + sign / f64::from(n);
        }
        sum * x * x
    } else {
        x.ln_1p() - x
    }
}

/// Largest indentation (5Mv²/4k)^{2/5} in m of a Hertz contact at the approach speed `speed` (m/s), with the
/// reduced mass `mass` (kg).
pub(crate) fn hertz_depth(stiffness: f64, mass: f64, speed: f64) -> f64 {
    (1.25 * mass * speed * speed / stiffness).powf(0.4)
}

/// Duration in s of a Hertz contact: 2.9432 times its largest indentation over the speed, the factor being
/// (4√π/5)Γ(2/5)/Γ(9/10).
pub(crate) fn hertz_duration(stiffness: f64, mass: f64, speed: f64) -> f64 {
    2.943_275_184_324_705 * hertz_depth(stiffness, mass, speed) / speed
}

/// −ln R, for 0 < R ≤ 1.
fn check(restitution: f64) -> Result<f64> {
    if restitution > 0.0 && restitution <= 1.0 {
        return Ok(-restitution.ln());
    }
    Err(Error::usage(
        format!("restitution is {restitution}"),
        "a value above 0 (no finite damping stops a rebound altogether) and up to 1 (no loss)",
    ))
}

/// Root of f = `wanted` between `low` and `high`, to the last digit; f crosses it once, upwards.
fn solve(low: f64, high: f64, wanted: f64, f: impl Fn(f64) -> f64) -> f64 {
    bisected(low, high, usize::MAX, |x| f(x) < wanted).1
}

#[cfg(test)]
mod tests {
    use super::*;
    use vibro_math::Oscillator;

    #[test]
    fn golden_numbers_of_kelvin_voigt() {
        assert_eq!(restitution(0.0), 1.0);
        // ζ = 1: e⁻², by the limit of both closed forms; the contact lasts 2/ω₀.
        assert!((restitution(1.0) - (-2.0_f64).exp()).abs() < 2.0 * f64::EPSILON);
        assert!((duration(1.0, 400.0, 4.0) - 0.2).abs() < f64::EPSILON);
        for ratio in [1e-6, 0.05, 0.181, 0.5, 0.9, 0.95, 0.97, 0.999] {
            let psi = f64::asin(ratio);
            let turn = (std::f64::consts::PI - 2.0 * psi) / (1.0 - ratio * ratio).sqrt();
            // The formula without the series loses digits as 1 − ζ² becomes small.
            let lost = 16.0 * f64::EPSILON / (1.0 - ratio);
            assert!((restitution(ratio) - (-ratio * turn).exp()).abs() < lost, "{ratio}");
            assert!((duration(ratio, 1.0, 1.0) - turn).abs() < 4.0 * lost);
        }
        for ratio in [1.001, 1.03, 1.05, 2.0, 100.0] {
            let expected = (-2.0 * ratio * f64::acosh(ratio) / (ratio * ratio - 1.0_f64).sqrt()).exp();
            let lost = 32.0 * f64::EPSILON / (ratio - 1.0).min(1.0);
            assert!((restitution(ratio) / expected - 1.0).abs() < lost, "{ratio}");
        }
        // For large ζ, R = 1/(2ζ)².
        assert!((restitution(1e8) * 4e16 - 1.0).abs() < 1e-6);
        assert!(restitution(-0.1).is_nan() && restitution(f64::NAN).is_nan());
    }

    #[test]
    fn the_force_vanishes_after_the_duration_and_the_rebound_is_r() {
        for ratio in [0.0, 0.1, 0.7, 0.99, 1.0, 1.01, 3.0] {
            let oscillator = Oscillator::new(1.0, 2.0 * ratio, 1.0);
            let (x, v) = oscillator.free(0.0, 1.0, duration(ratio, 1.0, 1.0));
            // Rounding of numbers of order 1, and of 2ζ times them.
            let tolerance = 16.0 * f64::EPSILON * (1.0 + ratio);
            assert!(oscillator.acceleration(x, v).abs() < tolerance, "{ratio}");
            assert!((v + restitution(ratio)).abs() < tolerance, "{ratio} {v}");
        }
    }

    #[test]
    fn restitution_and_damping_go_round() {
        for r in [1.0, 1.0 - 1e-9, 0.999, 0.9, 0.7, 0.2112, 0.2, 0.135, 0.136, 0.01, 1e-6, 1e-300] {
            let back = restitution(damping_ratio(r).unwrap());
            assert!((back / r - 1.0).abs() < 1e-12, "{r} {back}");
        }
        for zeta in [1e-9, 0.01, 0.5, 0.999_999, 1.0, 1.000_001, 5.0] {
            let back = damping_ratio(restitution(zeta)).unwrap();
            // Near R = 1, R = 1 − πζ: the rounding of R limits ζ.
            assert!((back - zeta).abs() < 1e-12 * (1.0 + zeta), "{zeta} {back}");
        }
        for impossible in [0.0, -0.1, 1.1, f64::NAN] {
            assert!(damping_ratio(impossible).is_err() && loss(impossible).is_err());
        }
    }

    #[test]
    fn hunt_and_crossley_balance() {
        for r in [0.99, 0.7, 0.3, 0.05] {
            let a = loss(r).unwrap();
            let right = ((1.0 + a) / (1.0 - r * a)).ln();
            // For αv near 1/R, 1 − Rαv is a small difference that keeps the rounding error of 1.
            assert!(
                (a * (1.0 + r) - right).abs() < 8.0 * f64::EPSILON * (1.0 + a + 1.0 / (1.0 - r * a)),
                "{r}"
            );
        }
        // Small losses: R = 1 − 2αv/3 (Hunt & Crossley 1975).
        assert!((loss(1.0 - 1e-6).unwrap() - 1.5e-6).abs() < 1e-11);
    }
}

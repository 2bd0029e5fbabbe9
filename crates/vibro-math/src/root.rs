//! Roots of functions with bounded curvature, found by steps that cannot pass a root.
//!
//! A function with value f ≥ 0, slope ḟ and |f̈| ≤ M for all later arguments stays above f + ḟh − Mh²/2, so
//! the first root of that parabola, h = 2f/(√(ḟ² + 2Mf) − ḟ) for ḟ < 0 and (ḟ + √(ḟ² + 2Mf))/M otherwise, is
//! a step that cannot pass a root of f. Near a simple root it is Newton's step, so it converges
//! quadratically, always from one side.

/// Value and slope of a function, and a bound on its curvature from here on.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bounded {
    /// f(t).
    pub value: f64,
    /// df/dt.
    pub slope: f64,
    /// A bound on |d²f/dt²| at `t` and everywhere later.
    pub curvature: f64,
}

impl Bounded {
    /// The longest step that cannot pass a root, for a value that is not negative (or negative by rounding
    /// only).
    #[inline]
    pub(super) fn step(self) -> f64 {
        fall(self.value.max(0.0), self.slope, self.curvature)
    }
}

/// A function with its first three derivatives.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bent {
    /// f(t).
    pub value: f64,
    /// df/dt.
    pub slope: f64,
    /// d²f/dt².
    pub bend: f64,
    /// d³f/dt³.
    pub jerk: f64,
}

/// Bounds on derivatives of a function from an argument on.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Limits {
    /// A bound on |d²f/dt²|.
    pub curvature: f64,
    /// On |d³f/dt³|.
    pub jerk: f64,
    /// On |d⁴f/dt⁴|.
    pub snap: f64,
    /// On |d⁶f/dt⁶|.
    pub sixth: f64,
}

impl Bent {
    /// A step that cannot pass a root.
    ///
    /// Over the next H, f bends down by no more than K, the least of M₂, M₃H − f̈ and M₄H²/2 − f⃛H − f̈ (or
    /// −f̈), so the parabola with K in place of M₂ is below f over H. Near a simple root K is nearly −f̈ and
    /// the steps converge with the third order.
    #[inline]
    fn step(self, limits: Limits) -> f64 {
        let value = self.value.max(0.0);
        let safe = fall(value, self.slope, limits.curvature);
        // Near a root it lies within twice Newton's step; that reach is tried first.
        let mut reach = if self.slope < 0.0 { -2.0 * value / self.slope } else { 2.0 * safe };
        let mut step = safe;
        for _ in 0..3 {
            let lost = (0.5 * limits.snap * reach - self.jerk).max(0.0).min(limits.jerk) * reach;
            let bend = lost - self.bend;
            if bend >= limits.curvature {
                break;
            }
            let further = fall(value, self.slope, bend);
            step = step.max(further.min(reach));
            if further < reach {
                break;
            }
            reach *= 1.5;
        }
        step
    }

    /// The root of f + ḟh + f̈h²/2 for ḟ < 0, where the slope at the root is at least half of ḟ.
    #[inline]
    fn clear_root(self) -> Option<f64> {
        let root = fall(self.value, self.slope, -self.bend);
        (self.slope + self.bend * root <= 0.5 * self.slope).then_some(root)
    }
}

/// The first root of f + ḟh − Kh²/2 after 0, for f ≥ 0; ∞ if there is none.
#[inline]
fn fall(value: f64, slope: f64, bend: f64) -> f64 {
    let square = slope * slope + 2.0 * bend * value;
    if slope < 0.0 {
        // A parabola without a root, and NaN, set no limit.
        if square >= 0.0 { 2.0 * value / (square.sqrt() - slope) } else { f64::INFINITY }
    } else if bend > 0.0 {
        (slope + square.sqrt()) / bend
    } else {
        f64::INFINITY
    }
}

/// As [`first_fall`], for a function whose derivatives are known: it needs fewer calls, and none at the root.
///
/// Returns the last argument at which `f` was called and the step from there to the root. Over twice this
/// step a Taylor series with five derivatives errs in f's slope by less than `rounding` (the error of f's
/// values) times M₃/M₂, and in f by less than `rounding`. The step is the root of the parabola through value,
/// slope and bend, for the caller to refine. `limits` gives bounds from an argument on, or `None` where f
/// stays above 0 for ever.
#[inline]
pub fn first_landing(
    from: f64,
    to: f64,
    rounding: f64,
    mut f: impl FnMut(f64) -> Bent,
    mut limits: impl FnMut(f64) -> Option<Limits>,
) -> Option<(f64, f64)> {
    /// Calls after which the bounds are computed again: they fall as free vibrations decay.
    const FRESH: u32 = 6;
    let mut bounds = limits(from)?;
    let mut calls = 0;
    walk(from, to, |t| {
        let here = f(t);
        if here.slope < 0.0 && here.value <= 0.0 {
            return RootAhead::Root(0.0);
        }
        calls += 1;
        if calls % FRESH == 0 {
            match limits(t) {
                Some(fresh) => bounds = fresh,
                None => return RootAhead::Never,
            }
        }
        if here.slope < 0.0 {
            // M₆(2h)⁵/5! of the slope, at twice Newton's step h.
            let newton = here.value / here.slope;
            let square = newton * newton;
            let error = bounds.sixth * bounds.curvature * square * square * -newton * (32.0 / 120.0);
            if error <= rounding * bounds.jerk
                && let Some(last) = here.clear_root()
            {
                return if t + last <= to { RootAhead::Root(last) } else { RootAhead::Never };
            }
        }
        RootAhead::Step { step: here.step(bounds), falls: here.slope < 0.0 }
    })
}

/// What the value and the derivatives at one argument tell of the next root.
pub(super) enum RootAhead {
    /// A root at this distance ahead.
    Root(f64),
    /// There is no further root.
    Never,
    /// No root within `step`; `falls` tells whether the function falls.
    Step { step: f64, falls: bool },
}

/// Goes from `from` to `to` by steps that pass no root. Returns the last argument looked at, and the distance
/// from there to the root.
#[inline]
pub(super) fn walk(from: f64, to: f64, mut look: impl FnMut(f64) -> RootAhead) -> Option<(f64, f64)> {
    let mut t = from;
    loop {
        let (step, falls) = match look(t) {
            RootAhead::Root(ahead) => return Some((t, ahead)),
            RootAhead::Never => return None,
            RootAhead::Step { step, falls } => (step, falls),
        };
        let next = t + step;
        if next <= t {
            if falls {
                return Some((t, 0.0));
            }
            // At rest on zero to the last digit: goes on by one digit, until the curvature shows its sign.
            t += f64::EPSILON * t.abs().max(to - from);
        } else {
            t = next;
        }
        // Also ends where the function is not a number.
        if t > to || t.is_nan() {
            return None;
        }
    }
}

/// The first argument in `from..=to` at which `f`, not negative at `from`, falls to zero.
///
/// `noise` is the rounding error of f's values: a value below it counts as zero. A touch from above that does
/// not fall below `noise` is no root. Error of the root: that of f over its slope there.
#[inline]
pub fn first_fall(from: f64, to: f64, noise: f64, f: impl Fn(f64) -> Bounded) -> Option<f64> {
    let look = |t| {
        let here = f(t);
        let falls = here.slope < 0.0;
        if falls && here.value <= noise {
            RootAhead::Root(0.0)
        } else {
            RootAhead::Step { step: here.step(), falls }
        }
    };
    walk(from, to, look).map(|(t, _)| t)
}

/// Root of `f` (value and slope) between `a` and `b`, where its values have opposite signs: Newton's steps,
/// halving where one would leave the bracket or shrink it too slowly. Ends when no number lies between, or
/// after 200 steps.
pub fn bracketed(mut a: f64, mut b: f64, f: impl Fn(f64) -> (f64, f64)) -> f64 {
    let falling = f(a).0 > 0.0;
    let mut t = f64::midpoint(a, b);
    let mut width = (b - a).abs();
    for _ in 0..200 {
        let (value, slope) = f(t);
        if value == 0.0 {
            return t;
        }
        if (value > 0.0) == falling {
            a = t;
        } else {
            b = t;
        }
        let (low, high) = (a.min(b), a.max(b));
        let step = value / slope;
        let next = t - step;
        // Newton's last steps move less than the last digit.
        if step.abs() <= f64::EPSILON * t.abs() && next >= low && next <= high {
            return next;
        }
        let slow = high - low > 0.5 * width && step.abs() > 0.25 * width;
        width = high - low;
        t = if next > low && next < high && !slow { next } else { f64::midpoint(low, high) };
        if t <= low || t >= high {
            return t;
        }
    }
    t
}

#[cfg(test)]
mod tests {
    use super::*;

    /// f = a + Σ amplitude cos(ωt + φ), with its crude constant bound.
    fn sum(a: f64, terms: &[(f64, f64, f64)], t: f64) -> Bounded {
        let mut b = Bounded { value: a, slope: 0.0, curvature: 0.0 };
        for (amplitude, omega, phase) in terms {
            let (sin, cos) = (omega * t + phase).sin_cos();
            b.value += amplitude * cos;
            b.slope -= amplitude * omega * sin;
            b.curvature += amplitude.abs() * omega * omega;
        }
        b
    }

    #[test]
    fn simple_roots_are_found_to_rounding() {
        // cos t falls through zero at π/2, then at 5π/2.
        let f = |t: f64| sum(0.0, &[(1.0, 1.0, 0.0)], t);
        let root = first_fall(0.0, 10.0, 0.0, f).unwrap();
        assert!((root - std::f64::consts::FRAC_PI_2).abs() <= 4.0 * f64::EPSILON);
        let root = first_fall(5.0, 10.0, 0.0, f).unwrap();
        assert!((root - 2.5 * std::f64::consts::PI).abs() <= 16.0 * f64::EPSILON);
        assert_eq!(first_fall(5.0, 7.0, 0.0, f), None);
    }

    #[test]
    fn a_near_touch_is_passed_and_a_slight_dip_is_not() {
        for (lift, expected) in [(1e-12, false), (-1e-12, true)] {
            let f = |t: f64| sum(1.0 + lift, &[(1.0, 1.0, 0.0)], t);
            let root = first_fall(0.0, 6.0, 0.0, f);
            assert_eq!(root.is_some(), expected, "{lift}");
            if let Some(root) = root {
                // 1 + cos t ≈ (t − π)²/2 dips 1e-12 below zero within √2e-6 of π.
                assert!((root - (std::f64::consts::PI - 2e-12_f64.sqrt())).abs() < 1e-9);
            }
        }
    }

    #[test]
    fn a_function_that_is_not_a_number_ends_the_search() {
        let f = |_| Bounded { value: f64::NAN, slope: f64::NAN, curvature: f64::NAN };
        assert_eq!(first_fall(0.0, 1.0, 0.0, f), None);
    }

    #[test]
    fn simple_and_flat_roots() {
        let root = bracketed(0.0, 2.0, |t| (t * t - 2.0, 2.0 * t));
        assert!((root - std::f64::consts::SQRT_2).abs() <= 2.0 * f64::EPSILON);
        let root = bracketed(3.0, 0.0, |t| (1.0 - t, -1.0));
        assert!((root - 1.0).abs() <= f64::EPSILON);
        // Newton alone runs away from the root of the arctangent.
        let root = bracketed(-50.0, 80.0, |t: f64| (t.atan(), 1.0 / (1.0 + t * t)));
        assert!(root.abs() < 1e-12, "{root}");
        // Flat at the root: t³, where halving takes over; its value is below 1e-40 within 1e-13.
        let root = bracketed(-1.0, 1.5, |t: f64| (t.powi(3), 3.0 * t * t));
        assert!(root.abs() < 1e-13, "{root}");
    }
}

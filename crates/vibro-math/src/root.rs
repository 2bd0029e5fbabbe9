//! Roots of functions with bounded curvature, found by steps that cannot pass a root.
//!
//! A function has the value f ≥ 0, the slope ḟ and |f̈| ≤ M at all later arguments. At a distance h it is at
//! least f + ḟh − Mh²/2. So a step to the first root of this parabola cannot pass a root of the function: h
//! = 2f/(√(ḟ² + 2Mf) − ḟ) for ḟ < 0, else h = (ḟ + √(ḟ² + 2Mf))/M. Near a simple root this is Newton's step:
//! it converges quadratically, always from one side.

/// Value and slope of a function at an argument, and a bound on its curvature there and later.
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
    /// The longest step that cannot pass a root. The value must not be negative, except by rounding.
    #[inline]
    pub(super) fn step(self) -> f64 {
        fall(self.value.max(0.0), self.slope, self.curvature)
    }
}

/// Value of a function at an argument, with its first three derivatives.
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

/// Bounds on derivatives of a function at an argument and later.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Limits {
    /// Bound on |d²f/dt²|, M₂.
    pub curvature: f64,
    /// Bound on |d³f/dt³|, M₃.
    pub jerk: f64,
    /// Bound on |d⁴f/dt⁴|, M₄.
    pub snap: f64,
    /// Bound on |d⁶f/dt⁶|, M₆.
    pub sixth: f64,
}

impl Bent {
    /// A step that cannot pass a root.
    ///
    /// Up to a distance H ahead, −f̈ is at most K: the least of M₂, M₃H − f̈ and M₄H²/2 − f⃛H − f̈ (−f̈ if
    /// that is larger). So up to H the parabola with K in place of M₂ is not above f. Near a simple root K
    /// is nearly −f̈, and the steps converge with the third order.
    #[inline]
    fn step(self, limits: Limits) -> f64 {
        let value = self.value.max(0.0);
        let safe = fall(value, self.slope, limits.curvature);
        // H is tried with twice Newton's step first: a near root lies within it.
        let mut reach = if self.slope < 0.0 { -2.0 * value / self.slope } else { 2.0 * safe };
        let mut step = safe;
        for _ in 0..3 {
            let bent = (0.5 * limits.snap * reach - self.jerk).max(0.0).min(limits.jerk) * reach;
            let bend = bent - self.bend;
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

    /// The root h of the parabola f + ḟh + f̈h²/2 for ḟ < 0; `None` if the parabola falls there at less than
    /// half the rate −ḟ.
    #[inline]
    fn clear_root(self) -> Option<f64> {
        let root = fall(self.value, self.slope, -self.bend);
        (self.slope + self.bend * root <= 0.5 * self.slope).then_some(root)
    }
}

/// The first root h ≥ 0 of value + slope·h − bend·h²/2, for a value that is not negative; ∞ if there is none.
#[inline]
fn fall(value: f64, slope: f64, bend: f64) -> f64 {
    let square = slope * slope + 2.0 * bend * value;
    if slope < 0.0 {
        // A parabola without a root sets no limit to the step, nor does NaN.
        if square >= 0.0 { 2.0 * value / (square.sqrt() - slope) } else { f64::INFINITY }
    } else if bend > 0.0 {
        (slope + square.sqrt()) / bend
    } else {
        f64::INFINITY
    }
}

/// As [`first_fall`], for a function whose first three derivatives are known: it needs fewer calls, and none
/// at the root.
///
/// Returns the last argument at which `f` was called, and the step from there to the root, for the caller to
/// refine: the step is that to the root of the parabola with the value and the first two derivatives. The
/// caller can use a Taylor series with five derivatives. Up to twice the step that series errs by less than
/// `rounding` (the rounding error of f's values) in f, and by less than `rounding`·M₃/M₂ in its slope.
/// `limits` gives bounds at an argument and later, or `None` if f stays above 0 from there on.
#[inline]
pub fn first_landing(
    from: f64,
    to: f64,
    rounding: f64,
    mut f: impl FnMut(f64) -> Bent,
    mut limits: impl FnMut(f64) -> Option<Limits>,
) -> Option<(f64, f64)> {
    /// Number of calls of `f` after which the bounds are computed anew: they decrease as free vibrations
    /// decay.
    const CALLS_PER_BOUND: u32 = 6;
    let mut bounds = limits(from)?;
    let mut calls = 0;
    walk(from, to, |t| {
        let here = f(t);
        if here.slope < 0.0 && here.value <= 0.0 {
            return RootAhead::Root(0.0);
        }
        calls += 1;
        if calls % CALLS_PER_BOUND == 0 {
            match limits(t) {
                Some(fresh) => bounds = fresh,
                None => return RootAhead::Never,
            }
        }
        if here.slope < 0.0 {
            // Error of the series in the slope at twice Newton's step h, M₆(2h)⁵/5!, times M₂.
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

/// What is known about the next root from value and derivatives at one argument.
pub(super) enum RootAhead {
    /// A root at this distance ahead.
    Root(f64),
    /// There is no further root.
    Never,
    /// No root within `step`; `falls`: whether the function falls at this argument.
    Step { step: f64, falls: bool },
}

/// Goes from `from` to `to` by steps that pass no root. Returns the last argument that was examined, and the
/// distance from there to the root; `None` if there is no root.
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
            // The value is zero to the last digit and does not fall: goes on by one unit in the last digit,
            // until the function rises or falls.
            t += f64::EPSILON * t.abs().max(to - from);
        } else {
            t = next;
        }
        // Ends, too, if the function is not a number.
        if t > to || t.is_nan() {
            return None;
        }
    }
}

/// The first argument in `from..=to` at which `f` falls to zero; its value at `from` must not be negative.
///
/// `noise` is the rounding error of f's values: a value up to it counts as zero. A minimum above `noise` is
/// no root. The error of the root is the error of f divided by its slope there.
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

/// Root of `f` (value and slope) between `a` and `b`, where its values have opposite signs. Takes Newton's
/// steps, and halves the bracket if such a step would leave it or shrink it too slowly. Ends when no double
/// lies inside the bracket, or after 200 steps.
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
        // Converged: Newton's step is smaller than the last digit.
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

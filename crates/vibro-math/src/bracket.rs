//! A root between two arguments of opposite sign, to the last digit.

/// Root of `f` (value and slope) between `a` and `b`, where its values have opposite signs: Newton's steps, halving where one would
/// leave the bracket or shrink it too slowly. Ends when no number lies between, or after 200 steps.
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

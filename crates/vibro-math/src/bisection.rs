//! Bisection: finds the border between arguments at which a condition holds and those at which it does not.

/// Number of halvings that finds a border to rounding: 52 for the binary digits of a double, and eight for a
/// border up to 256 times smaller than the interval.
const TO_ROUNDING: usize = 60;

/// Halves the interval from `inside`, where `holds` is true, to `outside`, where it is not, `halvings` times.
/// Returns the ends of the last interval, in the same order; either may be the larger. Ends early when no
/// double lies between them.
///
/// ```
/// use vibro_math::bisected;
/// let (below, above) = bisected(1.0, 2.0, 10, |x| x * x < 2.0);
/// assert!(below * below < 2.0 && above * above >= 2.0 && above - below == 1.0 / 1024.0);
/// ```
pub fn bisected(
    inside: f64,
    outside: f64,
    halvings: usize,
    mut holds: impl FnMut(f64) -> bool,
) -> (f64, f64) {
    try_bisected(inside, outside, halvings, |x| Some(holds(x))).unwrap_or((inside, outside))
}

/// As [`bisected`]; `None` as soon as `holds` returns `None`.
pub fn try_bisected(
    mut inside: f64,
    mut outside: f64,
    halvings: usize,
    mut holds: impl FnMut(f64) -> Option<bool>,
) -> Option<(f64, f64)> {
    for _ in 0..halvings {
        let middle = f64::midpoint(inside, outside);
        if middle == inside || middle == outside {
            break;
        }
        if holds(middle)? {
            inside = middle;
        } else {
            outside = middle;
        }
    }
    Some((inside, outside))
}

/// The border between `inside`, where `holds` is true, and `outside`, where it is not, to rounding.
///
/// ```
/// let root = vibro_math::border(1.0, 2.0, |x| x * x < 2.0);
/// assert!((root - 2f64.sqrt()).abs() <= f64::EPSILON);
/// ```
pub fn border(inside: f64, outside: f64, holds: impl FnMut(f64) -> bool) -> f64 {
    let (inside, outside) = bisected(inside, outside, TO_ROUNDING, holds);
    f64::midpoint(inside, outside)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn either_end_may_be_the_larger() {
        // Halving an interval between whole numbers is exact.
        assert_eq!(bisected(0.0, 1.0, 3, |x| x < 0.3), (0.25, 0.375));
        assert_eq!(bisected(1.0, 0.0, 3, |x| x > 0.3), (0.375, 0.25));
    }

    #[test]
    fn it_ends_where_no_number_lies_between() {
        let mut calls = 0;
        let (below, above) = bisected(1.0, 2.0, usize::MAX, |x| {
            calls += 1;
            x < 1.5
        });
        // 52 binary digits between 1 and 2, one for each halving.
        assert!(below.next_up() == above && calls == 52, "{below} {above} {calls}");
    }

    #[test]
    fn what_cannot_be_told_ends_it() {
        assert_eq!(try_bisected(0.0, 1.0, 20, |x| (x < 0.4).then_some(true)), None);
    }
}

//! Where a sampled signal crosses a level, and its value, between samples.

use crate::bisection::border;

/// Lagrange's cubic through four samples at −1, 0, 1 and 2.
fn cubic([before, a, b, after]: [f64; 4], s: f64) -> f64 {
    let (m, p, q) = (s + 1.0, s - 1.0, s - 2.0);
    -before * s * p * q / 6.0 + a * m * p * q / 2.0 - b * m * s * q / 2.0 + after * m * s * p / 6.0
}

/// The four samples around the step from sample `i`; `None` at the ends of the record.
fn around(values: &[f64], i: usize) -> Option<[f64; 4]> {
    values.get(i.checked_sub(1)?..i + 3)?.try_into().ok()
}

/// Place of the crossing of `level` between samples `i` and `i + 1`, on the cubic through the four samples around it (a
/// straight line beside the ends of the record and missing samples). `None` unless the level lies between the two samples.
pub(super) fn between(values: &[f64], i: usize, level: f64) -> Option<f64> {
    let (a, b) = (values.get(i)? - level, values.get(i + 1)? - level);
    if !(a.is_finite() && b.is_finite()) || a == b || a * b > 0.0 {
        return None;
    }
    let Some(four) = around(values, i).filter(|four| four.iter().all(|v| v.is_finite())) else {
        return Some(i as f64 + a / (a - b));
    };
    let four = four.map(|v| v - level);
    // A change of sign between 0 and 1 is certain.
    Some(i as f64 + border(0.0, 1.0, |s| cubic(four, s) * a > 0.0))
}

/// Value at a place between samples, on the cubic through the four samples around it; a straight line at the ends. `None`
/// outside the record.
pub(super) fn value(values: &[f64], at: f64) -> Option<f64> {
    let i = at.floor();
    if i < 0.0 {
        return None;
    }
    let (i, s) = (i as usize, at - i);
    let a = *values.get(i)?;
    match (around(values, i), values.get(i + 1)) {
        (Some(four), _) => Some(cubic(four, s)),
        (None, Some(b)) => Some(a + s * (b - a)),
        (None, None) => (s == 0.0).then_some(a),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cubic_is_crossed_where_it_is_crossed() {
        let cubic = |t: f64| 0.1 * t * t * t - 0.4 * t * t + 2.0 * t - 3.0;
        let values: Vec<f64> = (0..6).map(|i| cubic(f64::from(i))).collect();
        let at = between(&values, 1, 0.0).unwrap();
        // Exact but for the halving: 2⁻³¹ of a sample times the slope of about 2.
        assert!(cubic(at).abs() < 2e-9, "{at}");
        assert!((value(&values, 2.3).unwrap() - cubic(2.3)).abs() < 1e-14);
        assert_eq!(between(&values, 3, 0.0), None);
        assert_eq!(between(&values, 9, 0.0), None);
        assert_eq!(
            (value(&values, 5.0), value(&values, 5.5), value(&values, -0.5)),
            (Some(values[5]), None, None)
        );
    }

    #[test]
    fn missing_neighbours_leave_a_straight_line() {
        assert_eq!(between(&[f64::NAN, 0.0, 4.0, 9.0], 1, 1.0), Some(1.25));
        assert_eq!(between(&[0.0, f64::NAN], 0, 1.0), None);
        assert_eq!(value(&[0.0, 2.0], 0.5), Some(1.0));
    }
}

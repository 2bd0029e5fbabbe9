//! Where a sampled signal crosses a level, between samples.

/// Place of the crossing of `level` between samples `i` and `i + 1`, on the cubic through the four samples around it (a
/// straight line at the ends of the record). `None` unless the level lies between the two samples.
pub fn between(values: &[f64], i: usize, level: f64) -> Option<f64> {
    let (a, b) = (values.get(i)? - level, values.get(i + 1)? - level);
    if !(a.is_finite() && b.is_finite()) || a == b || a * b > 0.0 {
        return None;
    }
    let around = i.checked_sub(1).and_then(|before| Some((values.get(before)?, values.get(i + 2)?)));
    let Some((before, after)) = around.filter(|(b, a)| b.is_finite() && a.is_finite()) else {
        return Some(i as f64 + a / (a - b));
    };
    let (before, after) = (before - level, after - level);
    // Lagrange's cubic at the nodes −1, 0, 1, 2.
    let cubic = |s: f64| {
        let (m, p, q) = (s + 1.0, s - 1.0, s - 2.0);
        -before * s * p * q / 6.0 + a * m * p * q / 2.0 - b * m * s * q / 2.0 + after * m * s * p / 6.0
    };
    let (mut low, mut high) = (0.0f64, 1.0f64);
    // Halved to 1e-9 of a sample, far below any noise; a change of sign between 0 and 1 is certain.
    for _ in 0..30 {
        let middle = 0.5 * (low + high);
        if cubic(middle) * a > 0.0 { low = middle } else { high = middle }
    }
    Some(i as f64 + 0.5 * (low + high))
}

/// Value at a place between samples, on the cubic through the four samples around it; a straight line at the ends. `None`
/// outside the record.
pub fn value(values: &[f64], at: f64) -> Option<f64> {
    let i = at.floor();
    if i < 0.0 {
        return None;
    }
    let (i, s) = (i as usize, at - i);
    let (a, b) = (*values.get(i)?, values.get(i + 1).copied());
    let Some(b) = b else { return (s == 0.0).then_some(a) };
    let Some((before, after)) = i.checked_sub(1).and_then(|k| Some((values.get(k)?, values.get(i + 2)?)))
    else {
        return Some(a + s * (b - a));
    };
    let (m, p, q) = (s + 1.0, s - 1.0, s - 2.0);
    Some(-before * s * p * q / 6.0 + a * m * p * q / 2.0 - b * m * s * q / 2.0 + after * m * s * p / 6.0)
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

//! An abscissa that a file prints or stores value by value.

use crate::record::{Axis, AxisKind, Grid};

/// Axis of `values` (SI) and a sentence where it is uneven or was printed with too few digits.
///
/// `resolution` is half a unit in the last digit, `what` names the values in the sentence, e.g. `The column "t"`.
pub(super) fn from_values(
    kind: AxisKind,
    values: Vec<f64>,
    resolution: f64,
    what: &str,
) -> (Axis, Option<String>) {
    let unit = match kind {
        AxisKind::Time => " s",
        AxisKind::Frequency => " Hz",
        AxisKind::Index | AxisKind::Other(_) => "",
    };
    let steps: Vec<f64> = values.windows(2).map(|w| w[1] - w[0]).collect();
    let (smallest, largest) =
        steps.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), d| (a.min(*d), b.max(*d)));
    let long = steps.iter().filter(|d| **d > f64::midpoint(smallest, largest)).count();
    let range = format!(
        "steps from {} to {}{unit}, {long} of {} near the largest",
        short(smallest),
        short(largest),
        steps.len()
    );
    // Steps of one and of two units in the last digit: rounding of 1.25 ms to whole ones, or a sample that was lost.
    let doubled = smallest > 0.0 && largest > 1.5 * smallest;
    let axis = if doubled && !is_rounding(&steps, f64::midpoint(smallest, largest)) {
        Axis { kind, grid: Grid::Uneven(values) }
    } else {
        Axis::from_values(kind, values, resolution)
    };
    let doubt = match axis.step() {
        _ if axis.len() < 2 => None,
        // Steps may differ by rounding in binary; a thousandth of a step is visible.
        Some(step) if largest - smallest > 2e-3 * step => Some(format!(
            "{what} has too few digits ({range}): the step is taken as (last - first)/(n - 1) = {}{unit}.",
            short(step)
        )),
        Some(_) => None,
        None if smallest > 0.0 => Some(format!("{what} is uneven: {range}.")),
        None => Some(format!("{what} is uneven and does not always rise: {range}.")),
    };
    (axis, doubt)
}

/// Whether the longer steps come as regularly as rounding an even grid makes them: the distances between them differ by one
/// at most. Fewer than three of them prove nothing.
fn is_rounding(steps: &[f64], middle: f64) -> bool {
    let long: Vec<usize> = steps.iter().enumerate().filter(|(_, d)| **d > middle).map(|(i, _)| i).collect();
    let gaps = long.windows(2).map(|w| w[1] - w[0]);
    let (least, most) = gaps.fold((usize::MAX, 0), |(a, b), gap| (a.min(gap), b.max(gap)));
    long.len() >= 3 && most - least <= 1
}

/// Six digits are enough for a sentence.
pub(super) fn short(value: f64) -> f64 {
    format!("{value:.5e}").parse().unwrap_or(value)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_what_a_person_must_know_is_said() {
        let of = |values: &[f64], resolution| {
            from_values(AxisKind::Time, values.to_vec(), resolution, "The column \"t\"")
        };
        let (axis, doubt) = of(&[0.0, 0.1, 0.2, 0.300_000_000_000_000_04], 0.0);
        assert_eq!((axis.step().is_some(), doubt), (true, None));
        // Steps of 1.25 ms, printed in whole milliseconds: every fourth is longer.
        let printed: Vec<f64> = (0..16).map(|i| (1.25 * f64::from(i)).round() / 1e3).collect();
        let (axis, doubt) = of(&printed, 0.5e-3);
        // Both ends are rounded by half a millisecond at most.
        assert!((axis.step().unwrap() - 0.00125).abs() <= 1e-3 / 15.0);
        let doubt = doubt.unwrap();
        assert!(doubt.contains("too few digits (steps from 0.001 to 0.002 s, 4 of 15 near"), "{doubt}");
        let (_, doubt) = of(&[0.0, 1.0, 3.0], 0.0);
        assert_eq!(
            doubt.as_deref(),
            Some("The column \"t\" is uneven: steps from 1 to 2 s, 1 of 2 near the largest.")
        );
        let (_, doubt) = of(&[0.0, 2.0, 1.0], 0.0);
        assert!(doubt.unwrap().contains("does not always rise: steps from -1 to 2 s,"));
        assert_eq!(of(&[1.0], 0.0).1, None);
        assert_eq!(of(&[], 0.0).1, None);
    }

    #[test]
    fn lost_samples_are_not_taken_for_rounding() {
        for lost in [vec![3], vec![5, 20], vec![5, 6, 30, 70]] {
            let times: Vec<f64> =
                (0..100).filter(|i| !lost.contains(i)).map(|i| f64::from(i) / 1e3).collect();
            let (axis, doubt) = from_values(AxisKind::Time, times.clone(), 0.5e-3, "The column \"t\"");
            assert_eq!(axis.values(), times, "{lost:?}");
            assert!(doubt.unwrap().contains("is uneven: steps from 0.001"), "{lost:?}");
        }
    }
}

//! An abscissa that a file prints or stores value by value.

use crate::record::{Axis, AxisKind};

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
    let axis = Axis::from_values(kind, values, resolution);
    let doubt = match axis.step() {
        _ if axis.len() < 2 => None,
        // Steps may differ by rounding in binary; a thousandth of a step is visible.
        Some(step) if largest - smallest > 2e-3 * step => Some(format!(
            "{what} has too few digits, or lost samples ({range}): the step is taken as (last - first)/(n - 1) = {}{unit}.",
            short(step)
        )),
        Some(_) => None,
        None if smallest > 0.0 => Some(format!("{what} is uneven: {range}.")),
        None => Some(format!("{what} is uneven and does not always rise: {range}.")),
    };
    (axis, doubt)
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
        // Steps of 1.25 ms, printed in whole milliseconds.
        let (axis, doubt) = of(&[0.0, 0.001, 0.003, 0.004, 0.005], 0.5e-3);
        assert_eq!(axis.step(), Some(0.00125));
        let doubt = doubt.unwrap();
        assert!(
            doubt.contains("from 0.001 to 0.002 s, 1 of 4 near") && doubt.ends_with("0.00125 s."),
            "{doubt}"
        );
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
}

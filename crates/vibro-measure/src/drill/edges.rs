//! Where a sampled signal crosses a level, and its value, between samples; edges of a reference signal.

use crate::noise::border;
/// Which edge of the pulse counts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Edge {
    /// From low to high.
    Rising,
    /// From high to low.
    Falling,
}

/// Part of the height by which the signal must pass the middle on both sides before an edge counts: ringing of a pick-up stays below.
const HYSTERESIS: f64 = 0.2;

/// Edges of a reference signal, and what is known of their times.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Edges {
    /// Places in samples from the first.
    pub at: Vec<f64>,
    /// Whether most edges rise within one sample, so that nothing between samples is known.
    pub sharp: bool,
    /// Mean rise a sample at the edges.
    slope: f64,
}

impl Edges {
    /// Edges between two levels.
    ///
    /// An edge is where the signal crosses the middle of the two; it counts once it has come from beyond a fifth of the height on one
    /// side and goes beyond a fifth on the other. Noise may make it cross several times: then the mean of the first and the last
    /// crossing is taken.
    pub fn of(signal: &[f64], (low, high): (f64, f64), edge: Edge) -> Edges {
        let sign = if edge == Edge::Rising { 1.0 } else { -1.0 };
        let (middle, margin) = (0.5 * (low + high), HYSTERESIS * (high - low).abs());
        let (mut at, mut sharp, mut slopes) = (Vec::new(), 0, 0.0);
        // First and last crossing of an edge, and the samples around the last.
        let (mut armed, mut crossed) = (false, None::<(f64, f64, f64, f64)>);
        for (i, step) in signal.windows(2).enumerate() {
            let (from, to) = (sign * (step[0] - middle), sign * (step[1] - middle));
            if from < -margin {
                (armed, crossed) = (true, None);
            }
            if armed
                && from < 0.0
                && let Some(place) = between(signal, i, middle)
            {
                let first = crossed.map_or(place, |(first, ..)| first);
                crossed = Some((first, place, from, to));
            }
            if armed && to > margin {
                armed = false;
                if let Some((first, last, from, to)) = crossed.take() {
                    at.push(0.5 * (first + last));
                    sharp += usize::from(from < -1.5 * margin && to > 1.5 * margin);
                    slopes += to - from;
                }
            }
        }
        Edges { sharp: 2 * sharp > at.len(), slope: slopes / at.len().max(1) as f64, at }
    }

    /// Standard uncertainty of an edge in samples, where the reference carries noise of standard deviation `noise`.
    pub fn std(&self, noise: f64) -> f64 {
        // Two samples share the crossing; over a sample's length their mean square weight is 2/3.
        let variance = if self.slope > 0.0 { 2.0 / 3.0 * (noise / self.slope).powi(2) } else { 0.0 };
        (variance + if self.sharp { 1.0 / 12.0 } else { 0.0 }).sqrt()
    }
}

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

    fn pulses(rate: f64, shift: f64) -> (Vec<f64>, Vec<f64>) {
        let (period, n) = (737.3 / rate, 20_000);
        let truth: Vec<f64> = (0..27).map(|k| (f64::from(k) + shift) * period * rate).collect();
        let rise = |s: f64| 0.5 + 0.5 * (s / 4.0).tanh();
        let values = (0..n)
            .map(|i| truth.iter().map(|t| rise(f64::from(i) - t) - rise(f64::from(i) - t - 60.0)).sum())
            .collect();
        (values, truth)
    }

    fn found(values: &[f64], edge: Edge) -> Edges {
        Edges::of(values, (0.0, 1.0), edge)
    }

    #[test]
    fn edges_are_where_they_are() {
        let (values, truth) = pulses(102.4e3, 0.37);
        let whole = found(&values, Edge::Rising);
        assert_eq!(whole.at.len(), truth.len());
        for (found, truth) in whole.at.iter().zip(&truth) {
            // The fourth derivative of tanh(s/4)/2 is at most 4.1/2/4⁴ = 0.008; a cubic through samples at a distance of 1 is
            // off by 9/16/24 of it, 2e-4, and the slope there is 1/8.
            assert!((found - truth).abs() < 1.6e-3, "{found} {truth}");
        }
        let falling = found(&values, Edge::Falling);
        for (found, truth) in falling.at.iter().zip(&truth) {
            assert!((found - truth - 60.0).abs() < 1.6e-3);
        }
        assert!(!whole.sharp && (whole.slope - 0.125).abs() < 0.01);
    }

    #[test]
    fn chatter_missing_samples_and_half_pulses_are_no_edges() {
        let half = [0.0, 0.0, 0.6, 0.0, 0.0];
        let chatter = [0.0, 0.0, 0.55, 0.45, 0.6, 1.0, 1.0, 0.0];
        let lost = [0.0, 0.0, f64::NAN, 1.0, 1.0, 0.0];
        let found = found(&[&half[..], &chatter, &lost].concat(), Edge::Rising);
        assert_eq!(found.at.len(), 1, "{found:?}");
        // Between the crossing in the second and the one in the fourth step of the chatter.
        assert!(found.at[0] > 6.5 && found.at[0] < 8.7, "{found:?}");
        let sharp = Edges::of(&[0.0, 0.0, 1.0, 1.0, 0.0, 0.0, 1.0, 1.0], (0.0, 1.0), Edge::Rising);
        assert!(sharp.sharp && (sharp.std(0.0) - 12f64.sqrt().recip()).abs() < 1e-12);
    }
}

#[cfg(test)]
mod crossings {
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

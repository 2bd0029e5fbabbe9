//! The abscissa of a record.

use std::ops::Range;

/// Quantity of the abscissa.
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
pub enum AxisKind {
    /// Seconds.
    Time,
    /// Hertz.
    Frequency,
    /// Bare index: the file does not state its abscissa.
    Index,
    /// Another quantity, named with its unit, e.g. `temperature [K]`.
    Other(String),
}

/// Values of the abscissa.
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
pub enum Grid {
    /// Value `i` is `start + i·step`.
    Even {
        /// First value.
        start: f64,
        /// Distance between neighbours.
        step: f64,
        /// Number of values.
        n: usize,
    },
    /// Values at any distances, each one stored.
    Uneven(Vec<f64>),
}

/// Abscissa: kind and grid, in SI (s or Hz).
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Axis {
    /// Quantity of the abscissa.
    pub kind: AxisKind,
    /// Values in s or Hz.
    pub grid: Grid,
}

impl Axis {
    /// Even time axis with sampling interval `step` in s.
    pub fn time(start: f64, step: f64, n: usize) -> Axis {
        Axis { kind: AxisKind::Time, grid: Grid::Even { start, step, n } }
    }

    /// Even frequency axis with line distance `step` in Hz.
    pub fn frequency(start: f64, step: f64, n: usize) -> Axis {
        Axis { kind: AxisKind::Frequency, grid: Grid::Even { start, step, n } }
    }

    /// Axis that counts 0, 1, 2, …
    pub fn index(n: usize) -> Axis {
        Axis { kind: AxisKind::Index, grid: Grid::Even { start: 0.0, step: 1.0, n } }
    }

    /// Axis from printed abscissa values, which may carry too few digits.
    ///
    /// The grid is even, with step (last − first)/(n − 1), if every value lies within twice `resolution` of
    /// it, plus rounding; otherwise all values are kept. `resolution` is half a unit in the last printed
    /// digit.
    pub fn from_values(kind: AxisKind, values: Vec<f64>, resolution: f64) -> Axis {
        let n = values.len();
        if n >= 2 {
            let start = values[0];
            let step = (values[n - 1] - start) / (n - 1) as f64;
            let scale = start.abs().max(values[n - 1].abs());
            let tolerance = resolution * 1.000_001 + 4.0 * f64::EPSILON * scale;
            // The end points of the grid are rounded like the value itself, hence twice the resolution.
            let near = |(i, v): (usize, &f64)| (v - (start + i as f64 * step)).abs() <= 2.0 * tolerance;
            if step.is_finite() && step > 0.0 && values.iter().enumerate().all(near) {
                return Axis { kind, grid: Grid::Even { start, step, n } };
            }
        }
        Axis { kind, grid: Grid::Uneven(values) }
    }

    /// Number of values.
    pub fn len(&self) -> usize {
        match &self.grid {
            Grid::Even { n, .. } => *n,
            Grid::Uneven(values) => values.len(),
        }
    }

    /// Whether the axis has no values.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Value `i`.
    ///
    /// # Panics
    /// On an uneven axis, if `i` is not below [`Axis::len`].
    pub fn at(&self, i: usize) -> f64 {
        match &self.grid {
            Grid::Even { start, step, .. } => start + i as f64 * step,
            Grid::Uneven(values) => values[i],
        }
    }

    /// First value; 0 for an empty uneven axis.
    pub fn start(&self) -> f64 {
        match &self.grid {
            Grid::Even { start, .. } => *start,
            Grid::Uneven(values) => values.first().copied().unwrap_or(0.0),
        }
    }

    /// Distance between neighbours; `None` if uneven.
    pub fn step(&self) -> Option<f64> {
        match &self.grid {
            Grid::Even { step, .. } => Some(*step),
            Grid::Uneven(_) => None,
        }
    }

    /// Every `step`-th value from `first` on.
    pub fn every(&self, first: usize, step: usize) -> Axis {
        let n = self.len().saturating_sub(first).div_ceil(step.max(1));
        let grid = match &self.grid {
            Grid::Even { step: own, .. } => Grid::Even { start: self.at(first), step: own * step as f64, n },
            Grid::Uneven(values) => {
                Grid::Uneven(values.iter().skip(first).step_by(step.max(1)).copied().collect())
            }
        };
        Axis { kind: self.kind.clone(), grid }
    }

    /// Indices of the values from `from` (included) to `to` (excluded). On an even axis a value within 1e-9
    /// of a step of a bound counts as equal to the bound.
    ///
    /// ```
    /// use vibro_record::Axis;
    /// let axis = Axis::time(0.0, 0.1, 100);
    /// assert_eq!(axis.between(0.3, 0.6), 3..6);
    /// assert_eq!(axis.between(9.0, 99.0), 90..100);
    /// assert!(axis.between(10.0, 99.0).is_empty());
    /// ```
    pub fn between(&self, from: f64, to: f64) -> Range<usize> {
        let before = |bound: f64| match &self.grid {
            Grid::Even { start, step, n } => {
                (((bound - start) / step - 1e-9).ceil().max(0.0) as usize).min(*n)
            }
            Grid::Uneven(values) => values.partition_point(|value| *value < bound),
        };
        before(from)..before(to)
    }

    /// The values with these indices.
    ///
    /// # Panics
    /// On an uneven axis, if the indices do not lie below [`Axis::len`].
    pub fn part(&self, indices: Range<usize>) -> Axis {
        let grid = match &self.grid {
            Grid::Even { step, .. } => {
                Grid::Even { start: self.at(indices.start), step: *step, n: indices.len() }
            }
            Grid::Uneven(values) => Grid::Uneven(values[indices].to_vec()),
        };
        Axis { kind: self.kind.clone(), grid }
    }

    /// All values.
    pub fn values(&self) -> Vec<f64> {
        (0..self.len()).map(|i| self.at(i)).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_printed_with_too_few_digits_are_even() {
        let dt = 1.0 / 1024.0;
        let printed: Vec<f64> = (0..5000).map(|i| (f64::from(i) * dt * 1e3).round() / 1e3).collect();
        let axis = Axis::from_values(AxisKind::Time, printed, 0.5e-3);
        // The last value is rounded by half a millisecond at most, spread over 4999 steps.
        assert!((axis.step().unwrap() - dt).abs() <= 0.5e-3 / 4999.0);
    }

    #[test]
    fn a_gap_is_uneven() {
        let axis = Axis::from_values(AxisKind::Time, vec![0.0, 0.1, 0.2, 0.4, 0.5], 0.005);
        assert_eq!(axis.step(), None);
        assert_eq!(axis.at(3), 0.4);
    }

    #[test]
    fn repeated_or_falling_values_are_uneven() {
        assert_eq!(Axis::from_values(AxisKind::Time, vec![1.0, 1.0], 0.0).step(), None);
        assert_eq!(Axis::from_values(AxisKind::Time, vec![2.0, 1.0], 0.0).step(), None);
    }
}

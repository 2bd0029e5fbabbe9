//! Spectra behind each other: frequency to the right, excitation frequency to the back, amplitude up.

use super::axis::{Axis, AxisSpec, Extent, Room};
use super::heatmap::ascending;
use super::path::Point;
use ndarray::ArrayRef2;
use vibro_record::{Error, Result};

/// A waterfall in the unit cube: frequency to the right, excitation to the back, magnitude up.
#[derive(Debug, Clone)]
pub(super) struct Cube {
    pub x: Axis,
    pub depth: Axis,
    pub up: Axis,
    /// Depth of each spectrum, from front to back, and its line; NaN where it is missing.
    pub spectra: Vec<(f64, Vec<Point>)>,
    /// Depth of each peak, and its place over the front edge.
    pub peaks: Vec<(f64, Point)>,
}

/// Spectra in oblique projection with hidden lines, one for each excitation frequency.
#[derive(Debug, Clone, PartialEq)]
pub struct Waterfall {
    /// Title; empty for none.
    pub title: String,
    /// Axis to the right.
    pub x: AxisSpec,
    /// Axis to the back.
    pub depth: AxisSpec,
    /// Axis upwards.
    pub height: AxisSpec,
    /// Peaks to be marked by a dot where they are not hidden.
    pub peaks: Vec<Peak>,
    frequency: Vec<f64>,
    rows: Vec<(f64, Vec<f64>)>,
}

/// A peak of a spectrum.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Peak {
    /// Frequency in Hz.
    pub frequency: f64,
    /// Excitation frequency of its spectrum in Hz.
    pub excitation: f64,
    /// Magnitude in the unit of the spectra.
    pub magnitude: f64,
}

impl Waterfall {
    /// Spectra `magnitude`, one row for each of `excitation` and one column for each of `frequency` (both in
    /// Hz), in the unit of `height`. A missing line is NaN and leaves a gap; rows stand in the order of their
    /// excitation.
    ///
    /// # Errors
    /// If the shape of `magnitude` is not (excitations, frequencies), or the frequencies do not ascend.
    pub fn new(
        frequency: &[f64],
        excitation: &[f64],
        magnitude: &ArrayRef2<f64>,
        height: AxisSpec,
    ) -> Result<Waterfall> {
        if magnitude.dim() != (excitation.len(), frequency.len()) {
            let (rows, columns) = magnitude.dim();
            return Err(Error::usage(
                format!("a waterfall of {rows} spectra with {columns} lines"),
                format!("{} spectra with {} lines, as its axes have", excitation.len(), frequency.len()),
            ));
        }
        ascending(frequency, "line frequencies of a waterfall (Hz)")?;
        let mut rows: Vec<(f64, Vec<f64>)> = excitation
            .iter()
            .zip(magnitude.rows())
            .filter(|(e, _)| e.is_finite())
            .map(|(e, row)| (*e, row.to_vec()))
            .collect();
        rows.sort_by(|a, b| a.0.total_cmp(&b.0));
        Ok(Waterfall {
            title: String::new(),
            x: AxisSpec::frequency(),
            depth: AxisSpec::new("Excitation frequency", "Hz"),
            height,
            peaks: Vec::new(),
            frequency: frequency.to_vec(),
            rows,
        })
    }

    /// Shows this range of frequencies (Hz) only.
    pub fn frequencies(mut self, low: f64, high: f64) -> Waterfall {
        self.x = self.x.limits(low, high);
        self
    }

    /// Sets the title.
    pub fn title(mut self, title: impl Into<String>) -> Waterfall {
        self.title = title.into();
        self
    }

    /// Marks a peak.
    pub fn peak(mut self, peak: Peak) -> Waterfall {
        self.peaks.push(peak);
        self
    }

    /// Settles the axes and brings everything to their scale; `None` where there is nothing to show.
    pub(super) fn cube(&self) -> Option<Cube> {
        let extent = |spec: &AxisSpec, values: &mut dyn Iterator<Item = f64>| {
            let mut extent = Extent::NONE;
            extent.include(values.map(|v| spec.scale.of(v)));
            extent
        };
        let x = Axis::new(&self.x, extent(&self.x, &mut self.frequency.iter().copied()), Room::Tight)?;
        let depths = extent(&self.depth, &mut self.rows.iter().map(|r| r.0));
        // Not on the axes, so that the outer spectra can be read.
        let depth = Axis::new(&self.depth, depths, Room::Margin)?;
        let shown = |axis: &Axis, value: f64| Some(axis.at(value)).filter(|at| (0.0..=1.0).contains(at));
        let rows: Vec<(f64, Vec<(f64, f64)>)> = self
            .rows
            .iter()
            .filter_map(|(excitation, row)| {
                let values = self.frequency.iter().zip(row).filter_map(|(f, v)| Some((shown(&x, *f)?, *v)));
                Some((shown(&depth, *excitation)?, values.collect()))
            })
            .collect();
        let mut heights = rows.iter().flat_map(|(_, row)| row.iter().map(|(_, v)| *v));
        let up = Axis::new(&self.height, extent(&self.height, &mut heights), Room::Floor)?;
        // NaN stays NaN: a gap.
        let height = |value: f64| up.at(value).clamp(0.0, 1.0);
        let spectra =
            rows.iter().map(|(at, row)| (*at, row.iter().map(|(x, v)| (*x, height(*v))).collect())).collect();
        let place =
            |p: &Peak| Some((shown(&depth, p.excitation)?, (shown(&x, p.frequency)?, height(p.magnitude))));
        let peaks = self.peaks.iter().filter_map(place).collect();
        Some(Cube { x, depth, up, spectra, peaks })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use ndarray::Array2;

    #[test]
    fn rows_stand_in_the_order_of_their_excitation() {
        let (a, b) = (vec![0.0, 5.0, 0.0], vec![0.0, 1.0, 0.0]);
        let rows =
            |first: &[f64], second: &[f64]| Array2::from_shape_vec((2, 3), [first, second].concat()).unwrap();
        let spec = || AxisSpec::new("a", "m");
        let up = Waterfall::new(&[1.0, 2.0, 3.0], &[4.0, 5.0], &rows(&a, &b), spec()).unwrap();
        let down = Waterfall::new(&[1.0, 2.0, 3.0], &[5.0, 4.0], &rows(&b, &a), spec()).unwrap();
        assert_eq!(up, down);
    }

    #[test]
    fn nothing_to_show_is_no_cube() {
        let of = |frequency: &[f64], excitation: &[f64], magnitude: &Array2<f64>| {
            Waterfall::new(frequency, excitation, magnitude, AxisSpec::new("a", "m")).unwrap().cube()
        };
        assert!(of(&[], &[], &Array2::zeros((0, 0))).is_none());
        assert!(of(&[1.0, 2.0], &[4.0], &Array2::from_elem((1, 2), f64::NAN)).is_none());
        assert!(of(&[1.0, 2.0], &[f64::NAN], &Array2::zeros((1, 2))).is_none());
        assert!(of(&[1.0], &[4.0], &Array2::zeros((1, 1))).is_some());
    }

    #[test]
    fn shapes_and_orders_that_do_not_fit_are_refused() {
        let spec = || AxisSpec::new("a", "m");
        let values = Array2::zeros((2, 3));
        assert!(Waterfall::new(&[1.0, 2.0], &[1.0, 2.0], &values, spec()).is_err());
        assert!(Waterfall::new(&[1.0, 1.0, 2.0], &[1.0, 2.0], &values, spec()).is_err());
        assert!(Waterfall::new(&[1.0, 2.0, 3.0], &[1.0, f64::NAN], &values, spec()).is_ok());
    }
}

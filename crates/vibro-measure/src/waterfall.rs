//! All response spectra of a sweep as one matrix, as the thesis' script sinesw computes it.

use super::response::{Response, ResponseOptions};
use ndarray::Array2;
use std::f64::consts::PI;
use vibro_record::{Finding, Sweep};

/// Spectra over excitation frequency.
#[derive(Debug, Clone, PartialEq)]
pub struct Waterfall {
    /// Name of the sweep.
    pub name: String,
    /// Frequencies of the lines in Hz, one a column.
    pub frequency: Vec<f64>,
    /// Excitation frequencies in Hz in the order of the sweep, one a row.
    pub excitation: Vec<f64>,
    /// Magnitudes, points × lines; NaN below the cut-off.
    pub magnitude: Array2<f64>,
    /// Quantity of the magnitudes.
    pub quantity: vibro_record::units::Quantity,
    /// SI unit of the magnitudes.
    pub unit: String,
    /// Cut-off in Hz; 0 where nothing was cut off.
    pub fmin: f64,
    /// Findings of the sweep, and lines left out.
    pub findings: Vec<Finding>,
}

/// Gathers the matrix of a sweep whose response is known. Where the spectra were or are integrated, lines
/// below the response's cut-off hold noise divided by frequency and are left out; otherwise all lines are
/// kept unless the options give a cut-off.
pub fn waterfall(sweep: &Sweep, options: &ResponseOptions, response: &Response) -> Waterfall {
    let times = options.times(sweep);
    let integrated = times > 0 || sweep.analyser_integrated > 0;
    let fmin = if integrated { response.fmin } else { options.fmin.unwrap_or(0.0) };
    let frequency = sweep.axis.values();
    let mut magnitude = Array2::from_elem((sweep.points.len(), frequency.len()), f64::NAN);
    for (mut row, point) in magnitude.rows_mut().into_iter().zip(&sweep.points) {
        for (k, (cell, f)) in row.iter_mut().zip(&frequency).enumerate() {
            let divisor = (2.0 * PI * f).powi(i32::from(times));
            if *f >= fmin && divisor != 0.0 && k < point.response.values.len() {
                *cell = point.response.values.magnitude(k) / divisor;
            }
        }
    }
    let unit = sweep.unit().times_seconds(times);
    let cut = (fmin > 0.0).then(|| Finding::note("lines-below-cutoff").number("fmin", fmin));
    Waterfall {
        name: sweep.name.clone(),
        frequency,
        excitation: response.points.iter().map(|p| p.excitation).collect(),
        magnitude,
        quantity: unit.quantity(),
        unit: unit.symbol().to_owned(),
        fmin,
        findings: sweep.findings.iter().cloned().chain(cut).collect(),
    }
}

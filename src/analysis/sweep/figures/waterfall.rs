//! Spectra of a sweep as a waterfall, and as a map.

use crate::error::{Error, Result};
use crate::measure::waterfall::Waterfall as Matrix;
use crate::record::sort_by_number;
use crate::report::layout::capital;
use crate::report::{AxisSpec, Figure, Heatmap, Legend, Plot, Waterfall};
use crate::units::decibel;
use ndarray::Axis;

/// Reference of levels in SI units: 1 µm, 1 µm/s, …
const REFERENCE: f64 = 1e-6;
/// Range of a map in dB, that of a 16-bit analyser.
const RANGE: f64 = 90.0;

/// Waterfall from the cut-off to `fmax` in Hz; with `None`, to the last visible line.
///
/// # Errors
/// If the matrix and its axes do not fit, or `fmax` is not above the cut-off.
pub fn waterfall(matrix: &Matrix, fmax: Option<f64>) -> Result<Figure> {
    let height = AxisSpec::new(format!("{} amplitude", capital(matrix.quantity.name())), matrix.unit.clone());
    let ShownRange { low, high, left_out } = shown(matrix, fmax, SHOWN_PART)?;
    let scene = Waterfall::new(&matrix.frequency, &matrix.excitation, &matrix.magnitude, height)?
        .frequencies(low, high)
        .of(&matrix.name);
    Ok(Figure::double(format!("Waterfall, {}", matrix.name)).height(120.0).panel(scene).caption(left_out))
}

/// Map of the level in dB over frequency and excitation.
///
/// # Errors
/// If the matrix and its axes do not fit, or `fmax` is not above the cut-off.
pub fn map(matrix: &Matrix, fmax: Option<f64>) -> Result<Figure> {
    let mut order: Vec<usize> = (0..matrix.excitation.len()).collect();
    sort_by_number(&mut order, |a| matrix.excitation[*a]);
    // A map has one row a position: of repeated excitations the first stays.
    order.dedup_by(|a, b| matrix.excitation[*a] <= matrix.excitation[*b]);
    let ShownRange { low, high, left_out } = shown(matrix, fmax, SHOWN_PART_IN_COLOUR)?;
    let columns: Vec<usize> =
        (0..matrix.frequency.len()).filter(|k| (low..=high).contains(&matrix.frequency[*k])).collect();
    let x: Vec<f64> = columns.iter().map(|k| matrix.frequency[*k]).collect();
    let y: Vec<f64> = order.iter().map(|i| matrix.excitation[*i]).collect();
    let values = matrix.magnitude.select(Axis(0), &order).select(Axis(1), &columns);
    let key = AxisSpec::new(format!("{} level", capital(matrix.quantity.name())), matrix.unit.clone())
        .db(REFERENCE);
    // A level needs a reference; a millionth of the unit is the usual one for vibration amplitudes.
    let largest = values.iter().copied().filter(|v| v.is_finite()).fold(REFERENCE, f64::max);
    let top = (decibel(largest, REFERENCE) / 10.0).ceil() * 10.0;
    let key = key.limits(top - RANGE, top);
    let caption = format!("{left_out} Colours span {RANGE:.0} dB below the highest level. White: no value.");
    let heatmap = Heatmap::new(&x, &y, &values, key)?;
    let frequency = AxisSpec::frequency().limits(low, high);
    let plot = Plot::new(frequency, AxisSpec::new("Excitation frequency", "Hz"))
        .heatmap(heatmap)
        .legend(Legend::Hidden);
    Ok(Figure::double(format!("Map, {}", matrix.name)).height(100.0).panel(plot).caption(caption))
}

/// Range of a picture in Hz, and a sentence on what it leaves out.
struct ShownRange {
    low: f64,
    high: f64,
    left_out: String,
}

/// Range up to `fmax`, else to the last line at which a spectrum reaches `part` of the largest.
fn shown(matrix: &Matrix, fmax: Option<f64>, part: f64) -> Result<ShownRange> {
    let last = matrix.frequency.last().copied().unwrap_or(1.0);
    let high = fmax.unwrap_or_else(|| highest_visible(matrix, part)).min(last);
    if high <= matrix.fmin {
        return Err(Error::usage(
            format!("a picture from {:.3} Hz (the cut-off) to {high:.3} Hz", matrix.fmin),
            "an upper frequency above the cut-off",
        )
        .hint("raise the upper frequency, or lower the cut-off")
        .setting("fmax")
        .setting("fmin"));
    }
    let mut words = Vec::new();
    if matrix.fmin > 0.0 {
        words.push(format!("Lines below {:.2} Hz are left out.", matrix.fmin));
    }
    if fmax.is_none() && high < last {
        words.push(format!("Lines above {high:.0} Hz are below {} % of the largest.", 100.0 * part));
    }
    Ok(ShownRange { low: matrix.fmin, high, left_out: words.join(" ") })
}

/// Part of the largest line that lines at the upper end must reach to be shown, unless `fmax` is stated.
const SHOWN_PART: f64 = 0.01;
/// The same for a map, whose colours in dB show weaker lines.
const SHOWN_PART_IN_COLOUR: f64 = 1e-3;
/// Factor on the highest excitation up to which lines are always shown: includes its second harmonic.
const HARMONICS: f64 = 2.5;

/// Upper end of the visible lines, in Hz.
fn highest_visible(matrix: &Matrix, part: f64) -> f64 {
    let finite = |v: &&f64| v.is_finite();
    // The line at 0 Hz is the mean, not a motion.
    let lines = || (0..matrix.frequency.len()).filter(|k| matrix.frequency[*k] > 0.0);
    let largest_at = |k: usize| matrix.magnitude.column(k).iter().filter(finite).copied().fold(0.0, f64::max);
    let largest = lines().map(largest_at).fold(0.0, f64::max);
    let is_visible = |k: &usize| largest_at(*k) >= part * largest;
    let last = lines().rev().find(is_visible).map_or(f64::INFINITY, |k| matrix.frequency[k]);
    let excitation = matrix.excitation.iter().filter(finite).copied().fold(0.0, f64::max);
    (1.1 * last).max(HARMONICS * excitation)
}

//! Frequency response functions: magnitude and phase.

use super::response::capital;
use crate::record::Frf;
use crate::report::{AxisSpec, Figure, Plot, Series};

/// Magnitude (logarithmic) over phase in degrees; `peaks` are marked.
pub fn frf(title: &str, frf: &Frf, peaks: &[(f64, f64)]) -> Figure {
    let f = frf.axis.values();
    let magnitude: Vec<f64> = frf.values.iter().map(|v| v.norm()).collect();
    let phase: Vec<f64> = frf.values.iter().map(|v| v.arg().to_degrees()).collect();
    let y = AxisSpec::new(capital(frf.meta.quantity.name()), frf.meta.unit.symbol()).log();
    let mut above = Plot::new(AxisSpec::frequency(), y).with(Series::line("", f.clone(), magnitude));
    if !peaks.is_empty() {
        let (x, y): (Vec<f64>, Vec<f64>) = peaks.iter().copied().unzip();
        above = above.with(Series::points("peaks", x, y));
    }
    let below = Plot::new(AxisSpec::frequency(), AxisSpec::new("Phase", "°").limits(-180.0, 180.0))
        .with(Series::line("", f, phase));
    Figure::double(title).height(110.0).shared_x().panel(above).panel(below)
}

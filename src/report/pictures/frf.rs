//! Frequency response functions: magnitude and phase.

use super::response::capital;
use crate::record::Frf;
use crate::report::{AxisSpec, Figure, Plot, Series};
use num_complex::Complex64;

/// Magnitude (logarithmic) over phase in degrees; `peaks` are marked. The line at 0 Hz is no response to a vibration, and
/// neither is a zero: both are left out.
pub fn frf(title: &str, frf: &Frf, peaks: &[(f64, f64)]) -> Figure {
    let lines =
        frf.axis.values().into_iter().zip(&frf.values).skip_while(|(f, v)| *f <= 0.0 || v.norm() == 0.0);
    let of = |v: &Complex64, shown: f64| if v.norm() > 0.0 { shown } else { f64::NAN };
    let (f, values): (Vec<f64>, Vec<Complex64>) = lines.unzip();
    let magnitude: Vec<f64> = values.iter().map(|v| of(v, v.norm())).collect();
    let phase: Vec<f64> = values.iter().map(|v| of(v, v.arg().to_degrees())).collect();
    let y = AxisSpec::new(capital(frf.meta.quantity.name()), frf.meta.unit.symbol()).log();
    let mut above = Plot::new(AxisSpec::frequency(), y).with(Series::line("", f.clone(), magnitude));
    if !peaks.is_empty() {
        let (x, y): (Vec<f64>, Vec<f64>) = peaks.iter().copied().unzip();
        above = above.with(Series::points("peaks", x, y));
    }
    let below = Plot::new(AxisSpec::frequency(), AxisSpec::new("Phase", "°").limits(-180.0, 180.0))
        .with(Series::phase("", &f, &phase));
    Figure::double(title).height(110.0).shared_x().panel(above).panel(below)
}

//! Frequency response functions: magnitude and phase.

use super::lettered;
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
    let (phase, (low, high)) = fitted(&phase);
    let below = Plot::new(AxisSpec::frequency(), AxisSpec::new("Phase", "°").limits(low, high))
        .with(Series::phase("", &f, &phase));
    lettered(Figure::double(title).height(120.0).shared_x().panel(above).panel(below))
}

/// A phase in degrees on the turn that breaks it least, and the limits of its axis: multiples of 45°, of 90° where it covers
/// more than half a turn.
fn fitted(phase: &[f64]) -> (Vec<f64>, (f64, f64)) {
    let mut sorted: Vec<f64> = phase.iter().copied().filter(|p| p.is_finite()).collect();
    sorted.sort_by(f64::total_cmp);
    let (Some(&first), Some(&last)) = (sorted.first(), sorted.last()) else {
        return (phase.to_vec(), (-180.0, 180.0));
    };
    // The turn is cut in its widest empty part; at ±180° where none is wider than a step of the axis.
    let around = first + 360.0 - last;
    let gaps = sorted.windows(2).map(|w| (w[1] - w[0], w[0], w[1]));
    let cut = gaps.max_by(|a, b| a.0.total_cmp(&b.0)).filter(|gap| gap.0 > around.max(45.0));
    let (from, low, high) =
        cut.map_or((first, first, last), |(_, below, above)| (above, above, below + 360.0));
    let back = if low + high > 360.0 { 360.0 } else { 0.0 };
    let turned = phase.iter().map(|p| if *p < from { p + 360.0 - back } else { p - back }).collect();
    let (low, high) = (low - back, high - back);
    let step = if high - low > 180.0 { 90.0 } else { 45.0 };
    let (bottom, top) = ((low / step).floor() * step, (high / step).ceil() * step);
    (turned, (bottom, if top > bottom { top } else { bottom + step }))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_phase_axis_is_no_longer_than_the_phase() {
        assert_eq!(fitted(&[-3.0, f64::NAN, -100.0]).1, (-135.0, 0.0));
        // Round ±180°: shown without a break.
        let (turned, limits) = fitted(&[-179.0, 170.0, 100.0]);
        assert_eq!((turned, limits), (vec![181.0, 170.0, 100.0], (90.0, 225.0)));
        // All the turn: as it is.
        let all: Vec<f64> = (0..36).map(|i| f64::from(i) * 10.0 - 175.0).collect();
        assert_eq!(fitted(&all), (all.clone(), (-180.0, 180.0)));
        // The lower of two equal places.
        assert_eq!(fitted(&[-10.0, -179.0, 175.0]).1, (-225.0, 0.0));
        assert_eq!(fitted(&[f64::NAN]).1, (-180.0, 180.0));
        assert_eq!(fitted(&[90.0]).1, (90.0, 135.0));
    }
}

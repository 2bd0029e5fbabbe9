//! Frequency response functions: magnitude and phase with the fitted modes, and the Nyquist plane.

use crate::measure::modal::{Measured, Mode};
use crate::record::Meta;
use crate::report::layout::capital;
use crate::report::layout::lettered;
use crate::report::{AxisSpec, Figure, Ink, Legend, Marker, Plot, Series, Stroke};

/// Magnitude (logarithmic) over phase in degrees, with the fitted response over the lines of each mode.
pub fn frf(title: &str, meta: &Meta, measured: &Measured, modes: &[Mode]) -> Figure {
    let f = &measured.frequency;
    let magnitude: Vec<f64> = measured.values.iter().map(|v| v.norm()).collect();
    let y = AxisSpec::new(capital(meta.quantity.name()), meta.unit.symbol()).log();
    let mut above = Plot::new(AxisSpec::frequency(), y)
        .with(Series::line("measured", f.clone(), magnitude).ink(Ink::Grey).stroke(Stroke::Solid));
    // Modes that were fitted together have one curve.
    let (mut x, mut y, mut angle) = (Vec::new(), Vec::new(), Vec::new());
    let mut last = None;
    for mode in modes.iter().filter(|m| last.replace(m.lines) != Some(m.lines)) {
        x.extend(mode.picture.fitted.iter().map(|p| p.0).chain([f64::NAN]));
        y.extend(mode.picture.fitted.iter().map(|p| p.1.hypot(p.2)).chain([f64::NAN]));
        angle.extend(mode.picture.fitted.iter().map(|p| p.2.atan2(p.1).to_degrees()).chain([f64::NAN]));
    }
    if !x.is_empty() {
        above =
            above.with(Series::line("fitted modes", x.clone(), y).ink(Ink::Nth(0)).stroke(Stroke::Dashed));
    }
    for mode in modes {
        above = above.with(Series::vertical(format!("{:.2} Hz", mode.frequency.value), mode.frequency.value));
    }
    let figure = Figure::double(title).caption(
        "Frequency response function with the modes fitted to it; vertical lines are natural frequencies.",
    );
    if measured.magnitude_only {
        return figure.panel(above);
    }
    let known = |i: usize| measured.coherence.as_ref().is_none_or(|c| c[i] >= TOLD);
    let phase: Vec<f64> = measured
        .values
        .iter()
        .enumerate()
        .map(|(i, v)| if known(i) { v.arg().to_degrees() } else { f64::NAN })
        .collect();
    let label = phase_label(phase.iter().any(|p| p.is_nan()));
    let (phase, (low, high)) = fitted(&phase);
    let mut below = Plot::new(AxisSpec::frequency(), AxisSpec::new(label, "°").limits(low, high))
        .with(Series::phase("", f, &phase).ink(Ink::Grey).stroke(Stroke::Solid));
    if !x.is_empty() {
        // On the same turn as the measured phase, as far as the axis goes.
        for a in &mut angle {
            *a = low + (*a - low).rem_euclid(360.0);
        }
        below = below.with(Series::phase("", &x, &angle).ink(Ink::Nth(0)).stroke(Stroke::Dashed));
    }
    lettered(figure.height(110.0).shared_x().panel(above).panel(below))
}

/// A phase is drawn where the coherence is this or more: below it only fills the frame.
pub(crate) const TOLD: f64 = 0.5;

/// Name of the axis of a phase of which `some` is not drawn.
pub(crate) fn phase_label(some: bool) -> &'static str {
    if some { "Phase where γ² ≥ 0.5" } else { "Phase" }
}

/// The Nyquist plane around the modes, at most four, with the circle where one was fitted; `None` without phases or modes.
pub fn nyquist(title: &str, measured: &Measured, modes: &[Mode]) -> Option<Figure> {
    let mut largest: Vec<&Mode> = modes.iter().filter(|m| m.picture.circle.is_some()).collect();
    largest.sort_by(|a, b| b.modal_constant.value.abs().total_cmp(&a.modal_constant.value.abs()));
    largest.truncate(4);
    largest.sort_by(|a, b| a.frequency.value.total_cmp(&b.frequency.value));
    if measured.magnitude_only || largest.is_empty() {
        return None;
    }
    let columns = largest.len().min(2);
    let rows = largest.len().div_ceil(2);
    let mut figure = if columns == 1 { Figure::single(title).height(80.0) } else { Figure::double(title).height(85.0 * rows as f64) }
        .columns(columns)
        .square()
        .caption("Mobility in the Nyquist plane around each mode: lines that were fitted, the circle through them, and the resonance (diamond). Whatever the kind of the function, the mobility is shown, which runs on a circle.");
    for mode in largest {
        let Some(circle) = &mode.picture.circle else { continue };
        let (re, im): (Vec<f64>, Vec<f64>) = circle.points.iter().map(|p| (p.1.re, p.1.im)).unzip();
        let turn = (0..=180).map(|i| f64::from(i) * std::f64::consts::TAU / 180.0);
        let (x, y): (Vec<f64>, Vec<f64>) = turn
            .map(|a| (circle.centre.re + circle.radius * a.cos(), circle.centre.im + circle.radius * a.sin()))
            .unzip();
        // At the resonance the mobility stands a diameter A/(2ζωᵣ) from the origin of the mode, along A.
        let at =
            circle.centre + num_complex::Complex64::from_polar(circle.radius, circle.pole.constant.arg());
        let axis = |label: &str, centre: f64| {
            let reach = 1.15 * circle.radius;
            AxisSpec::new(label, "(m/s)/N").limits(centre - reach, centre + reach)
        };
        let plot = Plot::new(
            axis("Mobility, real part", circle.centre.re),
            axis("Mobility, imaginary part", circle.centre.im),
        )
        .title(format!("{:.2} Hz", mode.frequency.value))
        .with(Series::line("circle", x, y).ink(Ink::Nth(0)).stroke(Stroke::Solid))
        .with(Series::points("lines", re, im).ink(Ink::Black).marker(Marker::Circle))
        .with(Series::points("resonance", [at.re], [at.im]).ink(Ink::Nth(1)).marker(Marker::Diamond))
        .legend(Legend::Hidden);
        figure = figure.panel(plot);
    }
    Some(lettered(figure))
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

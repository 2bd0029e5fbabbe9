//! Frequency response functions: magnitude and phase with the fitted modes, and the Nyquist plane.

use crate::measure::modal::{Measured, Mode};
use crate::record::Meta;
use crate::report::layout::{capital, lettered};
use crate::report::{AxisSpec, Figure, Ink, Legend, Marker, Plot, Series, Stroke};
use num_complex::Complex64;

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
        let gap = [(f64::NAN, f64::NAN, f64::NAN)];
        for (f, re, im) in mode.picture.fitted.iter().copied().chain(gap) {
            x.push(f);
            y.push(re.hypot(im));
            angle.push(im.atan2(re).to_degrees());
        }
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
    let coherence = measured.coherence.as_deref().unwrap_or_default();
    let mut below = phase_plot(f, measured.values.iter().copied(), coherence, Ink::Grey);
    if !x.is_empty() {
        below = below.with(Series::phase("", &x, &angle).ink(Ink::Nth(0)).stroke(Stroke::Dashed));
    }
    lettered(figure.height(110.0).shared_x().panel(above).panel(below))
}

/// The phase of a function over its frequencies, where the coherence, if known, is 0.5 or more: below it only fills the frame.
pub(crate) fn phase_plot(
    f: &[f64],
    values: impl Iterator<Item = Complex64>,
    coherence: &[f64],
    ink: Ink,
) -> Plot {
    let known = coherence.iter().map(|c| *c >= 0.5).chain(std::iter::repeat(true));
    let phase: Vec<f64> =
        values.zip(known).map(|(v, known)| if known { v.arg().to_degrees() } else { f64::NAN }).collect();
    let some = phase.iter().any(|p| p.is_nan());
    let label = if some { "Phase where γ² ≥ 0.5" } else { "Phase" };
    Plot::new(AxisSpec::frequency(), AxisSpec::new(label, "°").limits(-180.0, 180.0))
        .with(Series::phase("", f, &phase).ink(ink).stroke(Stroke::Solid))
}

/// The Nyquist plane around the modes, at most four, with the circle where one was fitted; `None` without a circle.
pub fn nyquist(title: &str, modes: &[Mode]) -> Option<Figure> {
    let mut largest: Vec<_> = modes.iter().filter_map(|m| Some((m, m.picture.circle.as_ref()?))).collect();
    largest.sort_by(|a, b| b.0.modal_constant.value.abs().total_cmp(&a.0.modal_constant.value.abs()));
    largest.truncate(4);
    largest.sort_by(|a, b| a.0.frequency.value.total_cmp(&b.0.frequency.value));
    let (columns, rows) = (largest.len().min(2), largest.len().div_ceil(2));
    let figure = match columns {
        0 => return None,
        1 => Figure::single(title).height(80.0),
        _ => Figure::double(title).height(85.0 * rows as f64),
    };
    let mut figure = figure
        .columns(columns)
        .square()
        .caption("Mobility in the Nyquist plane around each mode: lines that were fitted, the circle through them, and the resonance (diamond). Whatever the kind of the function, the mobility is shown, which runs on a circle.");
    for (mode, circle) in largest {
        let (re, im): (Vec<f64>, Vec<f64>) = circle.points.iter().map(|p| (p.1.re, p.1.im)).unzip();
        let turn = (0..=180).map(|i| f64::from(i) * std::f64::consts::TAU / 180.0);
        let along = |angle: f64| circle.centre + Complex64::from_polar(circle.radius, angle);
        let (x, y): (Vec<f64>, Vec<f64>) = turn.map(along).map(|z| (z.re, z.im)).unzip();
        // At the resonance the mobility stands a diameter A/(2ζωᵣ) from the origin of the mode, along A.
        let at = along(circle.pole.constant.arg());
        let axis = |label: &str, centre: f64| {
            let reach = 1.15 * circle.radius;
            AxisSpec::new(label, "(m/s)/N").limits(centre - reach, centre + reach)
        };
        let (real, imaginary) = (
            axis("Mobility, real part", circle.centre.re),
            axis("Mobility, imaginary part", circle.centre.im),
        );
        let plot = Plot::new(real, imaginary)
            .title(format!("{:.2} Hz", mode.frequency.value))
            .with(Series::line("circle", x, y).ink(Ink::Nth(0)).stroke(Stroke::Solid))
            .with(Series::points("lines", re, im).ink(Ink::Black).marker(Marker::Circle))
            .with(Series::points("resonance", [at.re], [at.im]).ink(Ink::Nth(1)).marker(Marker::Diamond))
            .legend(Legend::Hidden);
        figure = figure.panel(plot);
    }
    Some(lettered(figure))
}

//! Frequency response functions: magnitude and phase with the fitted modes.

use crate::measure::modal::{Measured, Mode};
use crate::record::Meta;
use crate::report::layout::{capital, lettered};
use crate::report::{AxisSpec, Figure, Ink, Plot, Series, Stroke};
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
        for (f, re, im) in mode.fitted.iter().copied().chain(gap) {
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

//! Frequency response functions: magnitude and phase with the fitted modes.

use crate::measure::modal::{Measured, Mode};
use crate::record::Meta;
use crate::report::layout::{capital, lettered};
use crate::report::{AxisSpec, Figure, Ink, Marker, Plot, Series, Stroke};
use num_complex::Complex64;
use std::f64::consts::TAU;

/// Most spectral lines that are drawn as dots; more are drawn as a curve.
const DOTS: usize = 150;
/// Fewest points of a smooth curve.
const SMOOTH: usize = 300;

/// Magnitude (logarithmic) over phase in degrees, with the fitted response over the lines of each mode.
pub fn frf(title: &str, meta: &Meta, measured: &Measured, modes: &[Mode]) -> Figure {
    let f = &measured.frequency;
    let magnitude: Vec<f64> = measured.values.iter().map(|v| v.norm()).collect();
    let y = AxisSpec::new(capital(meta.quantity.name()), meta.unit.symbol()).log();
    let lines = if f.len() <= DOTS {
        Series::points("measured", f.clone(), magnitude).marker(Marker::Circle)
    } else {
        Series::line("measured", f.clone(), magnitude).stroke(Stroke::Solid)
    };
    let mut above = Plot::new(AxisSpec::frequency(), y).with(lines.ink(Ink::Grey));
    // Modes that were fitted together have one curve.
    let (mut x, mut y, mut angle) = (Vec::new(), Vec::new(), Vec::new());
    for together in modes.chunk_by(|a, b| a.lines == b.lines) {
        for (f, value) in curve(measured, together, meta.added_decay().is_some() || measured.window.is_some())
            .into_iter()
            .chain([(f64::NAN, Complex64::from(f64::NAN))])
        {
            x.push(f);
            y.push(value.norm());
            angle.push(value.arg().to_degrees());
        }
    }
    if !x.is_empty() {
        above =
            above.with(Series::line("fitted modes", x.clone(), y).ink(Ink::Nth(0)).stroke(Stroke::Dashed));
    }
    for mode in modes {
        above = above.with(Series::vertical(format!("{:.2} Hz", mode.frequency.value), mode.frequency.value));
    }
    let fitted = " with the modes fitted to it; vertical lines are natural frequencies";
    let fitted = if modes.is_empty() { "" } else { fitted };
    let figure =
        Figure::double(format!("Function, {title}")).caption(format!("Frequency response function{fitted}."));
    if measured.magnitude_only {
        return figure.panel(above);
    }
    let coherence = measured.coherence.as_deref().unwrap_or_default();
    let mut below = phase_plot(f, measured.values.iter().copied(), coherence, Ink::Grey);
    if !x.is_empty() {
        below = below.with(Series::phase("", &x, &angle).ink(Ink::Nth(0)).stroke(Stroke::Dashed));
    }
    let figure = figure.height(110.0).shared_x().panel(above).panel(below);
    let seen = match &measured.coherence {
        Some(_) => " The phase is drawn where the coherence is 0.5 or more.",
        None => "",
    };
    let caption = format!("{}{seen}", figure.caption);
    let figure = figure.caption(caption);
    lettered(match &measured.coherence {
        Some(coherence) => figure.height(145.0).panel(coherence_plot(f, coherence, Ink::Grey)),
        None => figure,
    })
}

/// The fitted response at its lines and, where these are few, between them. Between two lines it is the sum
/// of the modes, with the other terms of the fit interpolated linearly. The effect of a window on the modes
/// is known at the lines only.
fn curve(measured: &Measured, modes: &[Mode], windowed: bool) -> Vec<(f64, Complex64)> {
    let fitted = modes.first().map(|mode| mode.fitted.as_slice()).unwrap_or_default();
    let at_lines = fitted.iter().map(|(f, re, im)| (*f, Complex64::new(*re, *im)));
    if windowed || measured.magnitude_only || fitted.len() >= SMOOTH {
        return at_lines.collect();
    }
    let modal = |f: f64| {
        let omega = TAU * f;
        let of = |mode: &Mode| {
            let (own, angle) = (TAU * mode.frequency.value, mode.phase.as_ref().map_or(0.0, |p| p.value));
            let constant = Complex64::from_polar(mode.modal_constant.value.abs(), angle.to_radians());
            constant / Complex64::new(own * own - omega * omega, 2.0 * mode.zeta.value * own * omega)
        };
        Complex64::new(0.0, omega).powi(measured.power()) * modes.iter().map(of).sum::<Complex64>()
    };
    let between = SMOOTH.div_ceil(fitted.len().saturating_sub(1).max(1));
    let rest: Vec<(f64, Complex64)> = at_lines.map(|(f, value)| (f, value - modal(f))).collect();
    let piece = |pair: &[(f64, Complex64)]| {
        let ((a, from), (b, to)) = (pair[0], pair[1]);
        let at = |k: usize| {
            let part = k as f64 / between as f64;
            let f = a + part * (b - a);
            (f, modal(f) + from + (to - from) * part)
        };
        (0..between).map(at).collect::<Vec<_>>()
    };
    let last = rest.last().map(|(f, rest)| (*f, modal(*f) + rest));
    rest.windows(2).flat_map(piece).chain(last).collect()
}

/// The coherence of a function over its frequencies.
pub(crate) fn coherence_plot(f: &[f64], coherence: &[f64], ink: Ink) -> Plot {
    Plot::new(AxisSpec::frequency(), AxisSpec::new("Coherence", "").limits(0.0, 1.0))
        .with(Series::line("", f, coherence).ink(ink).stroke(Stroke::Solid))
}

/// The phase of a function over its frequencies, where the coherence, if known, is 0.5 or more: below that
/// the phase is noise that fills the frame.
pub(crate) fn phase_plot(
    f: &[f64],
    values: impl Iterator<Item = Complex64>,
    coherence: &[f64],
    ink: Ink,
) -> Plot {
    let known = coherence.iter().map(|c| *c >= 0.5).chain(std::iter::repeat(true));
    let phase: Vec<f64> =
        values.zip(known).map(|(v, known)| if known { v.arg().to_degrees() } else { f64::NAN }).collect();
    let shown = if f.len() <= DOTS {
        Series::points("", f, phase).marker(Marker::Circle)
    } else {
        Series::phase("", f, &phase).stroke(Stroke::Solid)
    };
    Plot::new(AxisSpec::frequency(), AxisSpec::new("Phase", "°").limits(-180.0, 180.0)).with(shown.ink(ink))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measure::modal::{ModalOptions, modal};
    use crate::units::Quantity;

    /// Two modes at twelve lines: the curve goes through them, and between them as the modes do.
    #[test]
    fn the_curve_of_few_lines_is_that_of_the_modes_between_them() {
        let truth = |f: f64| -> Complex64 {
            let of = |(own, zeta, a): (f64, f64, f64)| {
                let (own, w) = (TAU * own, TAU * f);
                a / Complex64::new(own * own - w * w, 2.0 * zeta * own * w)
            };
            [(12.0, 0.02, 0.5), (25.0, 0.03, 0.4)].into_iter().map(of).sum()
        };
        let f = [9.0, 11.0, 12.0, 12.6, 13.2, 14.5, 17.5, 22.0, 24.2, 25.3, 26.6, 30.0];
        let measured = Measured::new(f.to_vec(), f.iter().map(|f| truth(*f)).collect(), Quantity::Receptance);
        let options = ModalOptions { band: Some((9.0, 30.0)), ..ModalOptions::default() };
        let found = modal(&measured, &options).unwrap();
        assert_eq!(found.modes.len(), 2);
        let curve = curve(&measured, &found.modes, false);
        assert!(curve.len() > SMOOTH && curve.windows(2).all(|w| w[0].0 < w[1].0));
        for (f, value) in curve {
            // A fit ends once a step reduces the residual by less than 1e-8 of itself; the residual of exact
            // lines is rounding.
            assert!((value - truth(f)).norm() < 1e-5 * truth(f).norm(), "{f}: {value} {}", truth(f));
        }
    }
}

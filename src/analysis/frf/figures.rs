//! Frequency response functions: magnitude and phase with the fitted modes.

use crate::measure::modal::{Measured, Mode, OrderedPole};
use crate::record::{Meta, sort_by_number};
use crate::report::layout::{capital, lettered};
use crate::report::{AxisSpec, Figure, Ink, Marker, Plot, Series, Stroke};
use num_complex::Complex64;
use std::f64::consts::TAU;

/// Most spectral lines that are drawn as dots; more are drawn as a curve.
const DOTS: usize = 150;
/// Least coherence of a line whose phase is drawn: below it, the phase is mostly noise.
pub(crate) const COHERENT: f64 = 0.5;
/// Fewest points of a smooth curve over frequency.
const SMOOTH: usize = 300;
/// Fewest points of a smooth circle, which is passed within a few bandwidths.
const SMOOTH_CIRCLE: usize = 3000;

/// The part of the frequencies that is drawn, in units of that up to the last line of a mode.
const SHOWN: f64 = 2.5;

/// Frequency at which the figures of a function end, and the number of lines up to there: its last line,
/// unless all modes lie in its lower part.
fn end_of(f: &[f64], modes: &[Mode]) -> (f64, usize) {
    let last = f.last().copied().unwrap_or(f64::NAN);
    let of_modes = modes.iter().map(|mode| SHOWN * mode.lines.1.max(mode.frequency.value));
    let end = of_modes.reduce(f64::max).map_or(last, |end| end.min(last));
    (end, f.partition_point(|at| *at <= end))
}

/// The caption, with what is not drawn of a function.
fn cut_off(caption: String, f: &[f64], end: f64) -> String {
    match f.last() {
        Some(last) if end < *last => {
            format!("{caption} Drawn up to {end:.0} Hz; the function goes on to {last:.0} Hz.")
        }
        _ => caption,
    }
}

/// A curve over frequency that breaks where lines of an even grid are left out.
fn broken(f: &[f64], y: &[f64]) -> (Vec<f64>, Vec<f64>) {
    let step = f.windows(2).map(|w| w[1] - w[0]).fold(f64::INFINITY, f64::min);
    let is_even = f.windows(2).all(|w| {
        let steps = (w[1] - w[0]) / step;
        (steps - steps.round()).abs() < 0.01 * steps
    });
    let (mut x, mut values) = (Vec::with_capacity(f.len()), Vec::with_capacity(f.len()));
    for (k, (at, value)) in f.iter().zip(y).enumerate() {
        if is_even && k > 0 && at - f[k - 1] > 1.5 * step {
            x.push(f[k - 1] + step);
            values.push(f64::NAN);
        }
        x.push(*at);
        values.push(*value);
    }
    (x, values)
}

/// Magnitude (logarithmic) over phase in degrees, with the fitted response over the lines of each mode.
pub fn frf(title: &str, meta: &Meta, measured: &Measured, modes: &[Mode]) -> Figure {
    let f = &measured.frequency;
    let (end, part) = end_of(f, modes);
    let (f, coherence) = (&f[..part], measured.coherence.as_deref().map(|c| &c[..part]));
    let magnitude: Vec<f64> = measured.values[..part].iter().map(|v| v.norm()).collect();
    let lines = if f.len() <= DOTS {
        Series::points("measured", f, magnitude).marker(Marker::Circle)
    } else {
        let (x, y) = broken(f, &magnitude);
        Series::line("measured", x, y).stroke(Stroke::Solid)
    };
    let mut above = Plot::new(AxisSpec::frequency(), magnitude_axis(meta)).with(lines.ink(Ink::Grey));
    // Modes that were fitted together have one curve.
    let (mut x, mut y, mut angle) = (Vec::new(), Vec::new(), Vec::new());
    for together in modes.chunk_by(|a, b| a.lines == b.lines) {
        let fitted = curve(measured, together, is_windowed(meta, measured), SMOOTH);
        for (f, value) in fitted.into_iter().chain([(f64::NAN, Complex64::from(f64::NAN))]) {
            x.push(f);
            y.push(value.norm());
            angle.push(value.arg().to_degrees());
        }
    }
    if !x.is_empty() {
        above =
            above.with(Series::line("fitted modes", x.clone(), y).ink(Ink::Nth(0)).stroke(Stroke::Dashed));
    }
    let above = named_modes(above, modes);
    let fitted = " with the modes fitted to it; vertical lines are natural frequencies";
    let fitted = if modes.is_empty() { "" } else { fitted };
    let caption = cut_off(format!("Frequency response function{fitted}."), &measured.frequency, end);
    let figure = Figure::double(format!("Function, {title}")).caption(caption);
    if measured.magnitude_only {
        return figure.panel(above);
    }
    let values = measured.values[..part].iter().copied();
    let mut below = phase_plot(f, values, coherence.unwrap_or_default(), Ink::Grey);
    if !x.is_empty() {
        below = below.with(Series::phase("", &x, &angle).ink(Ink::Nth(0)).stroke(Stroke::Dashed));
    }
    let figure = figure.height(110.0).shared_x().panel(above).panel(below);
    let seen = match coherence {
        Some(_) => " The phase is drawn where the coherence is 0.5 or more.",
        None => "",
    };
    let caption = format!("{}{seen}", figure.caption);
    let figure = figure.caption(caption);
    lettered(match coherence {
        Some(coherence) => figure.height(145.0).panel(coherence_plot(f, coherence, Ink::Grey)),
        None => figure,
    })
}

/// Axis of the magnitude of a function.
fn magnitude_axis(meta: &Meta) -> AxisSpec {
    AxisSpec::new(capital(meta.quantity.name()), meta.unit.symbol()).log()
}

/// The plot with a vertical line at the frequency of each mode, named by it.
fn named_modes(plot: Plot, modes: &[Mode]) -> Plot {
    let line = |f: f64| Series::vertical(format!("{f:.2} Hz"), f);
    modes.iter().fold(plot, |plot, mode| plot.with(line(mode.frequency.value)))
}

/// Stabilisation diagram: the poles of models of rising order below the magnitude, with the fitted modes.
/// `None` without poles.
pub fn stabilisation(
    title: &str,
    meta: &Meta,
    measured: &Measured,
    poles: &[OrderedPole],
    modes: &[Mode],
) -> Option<Figure> {
    let (end, part) = end_of(&measured.frequency, modes);
    let (f, values) = (&measured.frequency[..part], &measured.values[..part]);
    let (first, last) = (*f.first()?, *f.last()?);
    let x = || AxisSpec::frequency().limits(first, last);
    let highest = poles.iter().map(|pole| pole.order).max()?;
    let magnitude: Vec<f64> = values.iter().map(|v| v.norm()).collect();
    let (at, magnitude) = broken(f, &magnitude);
    let lines = Series::line("", at, magnitude).stroke(Stroke::Solid).ink(Ink::Grey);
    let above = named_modes(Plot::new(x(), magnitude_axis(meta)).with(lines), modes);
    let those = |name: &str, is: &dyn Fn(&OrderedPole) -> bool| {
        let chosen = || poles.iter().filter(|pole| pole.frequency <= end && is(pole));
        let x: Vec<f64> = chosen().map(|pole| pole.frequency).collect();
        let y: Vec<f64> = chosen().map(|pole| pole.order as f64).collect();
        Series::points(name, x, y)
    };
    let both = those("same frequency and damping", &|p| p.damping_stays);
    let frequency = those("same frequency", &|p| p.frequency_stays && !p.damping_stays);
    let new = those("new", &|p| !p.frequency_stays);
    let order = AxisSpec::new("Order", "").limits(0.0, highest as f64 + 1.0);
    let mut below = Plot::new(x(), order)
        .with(both.marker(Marker::Circle).ink(Ink::Nth(0)))
        .with(frequency.marker(Marker::OpenCircle).ink(Ink::Nth(1)))
        .with(new.marker(Marker::Saltire).ink(Ink::Grey));
    for mode in modes {
        below = below.with(Series::vertical("", mode.frequency.value));
    }
    let caption = "Poles of models of rising order. A pole of the structure keeps its frequency (to 1 %) and damping \
                   ratio (to 5 %) from one order to the next; vertical lines are the fitted modes. Damping of low peaks beside high ones is too small at low orders.";
    let caption = cut_off(caption.to_owned(), &measured.frequency, end);
    let figure = Figure::double(format!("Stabilisation diagram, {title}")).caption(caption);
    Some(lettered(figure.height(150.0).shared_x().panel(above).panel(below)))
}

/// Most groups of modes whose circles are drawn, those with the largest response.
const MOST_CIRCLES: usize = 6;

/// Argand diagram: imaginary over real part of the lines of each mode, with the fitted response. Modes that
/// were fitted together share a panel. `None` without modes or phases.
pub fn argand(title: &str, meta: &Meta, measured: &Measured, modes: &[Mode]) -> Option<Figure> {
    let groups: Vec<&[Mode]> = modes.chunk_by(|a, b| a.lines == b.lines).collect();
    if groups.is_empty() || measured.magnitude_only {
        return None;
    }
    let windowed = is_windowed(meta, measured);
    let mut circles: Vec<_> =
        groups.iter().map(|group| (*group, curve(measured, group, windowed, SMOOTH_CIRCLE))).collect();
    let size = |curve: &[(f64, Complex64)]| curve.iter().map(|(_, value)| value.norm()).fold(0.0, f64::max);
    sort_by_number(&mut circles, |a| -size(&a.1));
    circles.truncate(MOST_CIRCLES);
    sort_by_number(&mut circles, |a| a.0[0].lines.0);
    let columns = circles.len().min(3);
    let rows = circles.len().div_ceil(columns);
    let figure = if columns == 1 { Figure::single("") } else { Figure::double("").columns(columns) };
    let height = [92.0, 88.0, 8.0 + 64.0 * rows as f64][columns - 1];
    let mut figure = Figure { title: format!("Argand diagram, {title}"), ..figure.height(height) };
    for (number, (group, curve)) in circles.iter().enumerate() {
        figure = figure.panel(circle(meta, measured, group, curve, number == 0));
    }
    let left_out = match groups.len() - circles.len() {
        0 => String::new(),
        n => format!(" Left out: {n} with a smaller response."),
    };
    let caption = "Imaginary over real part of the lines around each mode, with the modes fitted to them.";
    Some(lettered(figure).caption(format!("{caption}{left_out}")))
}

/// The lines of modes that were fitted together in the complex plane; `named` gives them a legend.
fn circle(meta: &Meta, measured: &Measured, modes: &[Mode], curve: &[(f64, Complex64)], named: bool) -> Plot {
    let name = |name: &'static str| if named { name } else { "" };
    let (from, to, _) = modes[0].lines;
    let coherent = |k: &usize| measured.coherence.as_ref().is_none_or(|c| c[*k] >= COHERENT);
    let (re, im): (Vec<f64>, Vec<f64>) = (0..measured.frequency.len())
        .filter(|k| (from..=to).contains(&measured.frequency[*k]) && coherent(k))
        .map(|k| (measured.values[k].re, measured.values[k].im))
        .unzip();
    let lines = locus(name("measured"), re, im).ink(Ink::Grey);
    let (re, im): (Vec<f64>, Vec<f64>) = curve.iter().map(|(_, value)| (value.re, value.im)).unzip();
    let fitted = Series::line(name("fitted modes"), re, im).ink(Ink::Nth(0)).stroke(Stroke::Dashed);
    let mut plot = complex_plane(meta).with(lines).with(fitted);
    let own: Vec<(f64, Complex64)> =
        modes.iter().filter_map(|mode| at(curve, mode.frequency.value)).collect();
    for (f, value) in &own {
        plot = plot.note(format!("{f:.2} Hz"), value.re, value.im);
    }
    let (re, im): (Vec<f64>, Vec<f64>) = own.iter().map(|(_, value)| (value.re, value.im)).unzip();
    plot.with(Series::points(name("natural frequency"), re, im).marker(Marker::OpenCircle).ink(Ink::Nth(1)))
}

/// A point of a curve at a frequency, between two of its points.
fn at(curve: &[(f64, Complex64)], f: f64) -> Option<(f64, Complex64)> {
    let pair = curve.windows(2).find(|pair| (pair[0].0..=pair[1].0).contains(&f))?;
    let part = (f - pair[0].0) / (pair[1].0 - pair[0].0);
    Some((f, pair[0].1 + (pair[1].1 - pair[0].1) * part))
}

/// Values in the complex plane: dots, or a curve where they are many.
pub(crate) fn locus(name: &str, re: Vec<f64>, im: Vec<f64>) -> Series {
    if re.len() <= DOTS {
        return Series::points(name, re, im).marker(Marker::Circle);
    }
    Series::line(name, re, im).stroke(Stroke::Solid)
}

/// Axes of the complex plane of a function, with lines through its origin.
pub(crate) fn complex_plane(meta: &Meta) -> Plot {
    let axis = |label: &str| AxisSpec::new(label, meta.unit.symbol());
    Plot::new(axis("Real part"), axis("Imaginary part"))
        .square()
        .with(Series::vertical("", 0.0))
        .with(Series::horizontal("", 0.0))
}

/// Whether a window of the segments or of the response shapes the lines.
fn is_windowed(meta: &Meta, measured: &Measured) -> bool {
    meta.added_decay().is_some() || measured.window.is_some()
}

/// The fitted response at its lines and, where these are fewer than `smooth`, between them. Between two lines
/// it is the sum of the modes, with the other terms of the fit interpolated linearly. The effect of a window
/// on the modes is known at the lines only.
fn curve(measured: &Measured, modes: &[Mode], windowed: bool, smooth: usize) -> Vec<(f64, Complex64)> {
    let fitted = modes.first().map(|mode| mode.fitted.as_slice()).unwrap_or_default();
    let at_lines = fitted.iter().map(|(f, re, im)| (*f, Complex64::new(*re, *im)));
    if windowed || measured.magnitude_only || fitted.len() >= smooth {
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
    let between = smooth.div_ceil(fitted.len().saturating_sub(1).max(1));
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
    let (x, y) = broken(f, coherence);
    Plot::new(AxisSpec::frequency(), AxisSpec::new("Coherence", "").limits(0.0, 1.0))
        .with(Series::line("", x, y).ink(ink).stroke(Stroke::Solid))
}

/// The phase of a function over its frequencies, where the coherence, if known, is 0.5 or more: below that
/// the phase is noise that fills the frame.
pub(crate) fn phase_plot(
    f: &[f64],
    values: impl Iterator<Item = Complex64>,
    coherence: &[f64],
    ink: Ink,
) -> Plot {
    let known = coherence.iter().map(|c| *c >= COHERENT).chain(std::iter::repeat(true));
    let phase: Vec<f64> =
        values.zip(known).map(|(v, known)| if known { v.arg().to_degrees() } else { f64::NAN }).collect();
    let shown = if f.len() <= DOTS {
        Series::points("", f, phase).marker(Marker::Circle)
    } else {
        let (x, y) = broken(f, &phase);
        Series::phase("", &x, &y).stroke(Stroke::Solid)
    };
    Plot::new(AxisSpec::frequency(), AxisSpec::new("Phase", "°").limits(-180.0, 180.0)).with(shown.ink(ink))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measure::modal::{ModalOptions, modal};
    use crate::report::Panel;
    use crate::units::Quantity;

    /// Lines 3 and 4 of an even grid are left out: the curve breaks once. Uneven frequencies are no gaps.
    #[test]
    fn a_curve_breaks_where_lines_are_left_out() {
        let (x, y) = broken(&[1.0, 1.5, 3.0, 3.5], &[0.0, 1.0, 2.0, 3.0]);
        assert_eq!(x, [1.0, 1.5, 2.0, 3.0, 3.5]);
        assert!(y[2].is_nan() && y.iter().filter(|v| v.is_nan()).count() == 1);
        assert_eq!(broken(&[1.0, 1.3, 3.0], &[0.0; 3]).0, [1.0, 1.3, 3.0]);
    }

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
        let curve = curve(&measured, &found.modes, false, SMOOTH);
        assert!(curve.len() > SMOOTH && curve.windows(2).all(|w| w[0].0 < w[1].0));
        for (f, value) in curve {
            // A fit ends once a step reduces the residual by less than 1e-8 of itself; the residual of exact
            // lines is rounding.
            assert!((value - truth(f)).norm() < 1e-5 * truth(f).norm(), "{f}: {value} {}", truth(f));
        }
    }

    /// The mobility of a viscous mode is a circle through the origin with its diameter A/(2ζω₀) on the real
    /// axis: (H − r)² = r² for every line, with the natural frequency opposite the origin (Ewins 1984).
    #[test]
    fn a_mode_is_a_circle_in_the_complex_plane() {
        let (own, zeta, constant) = (TAU * 5.23, 0.02, 8.0);
        let mobility = |f: f64| {
            let omega = TAU * f;
            Complex64::new(0.0, omega * constant)
                / Complex64::new(own * own - omega * omega, 2.0 * zeta * own * omega)
        };
        let f: Vec<f64> = (0..40).map(|k| 4.25 + 0.05 * f64::from(k)).collect();
        let measured = Measured::new(f.clone(), f.iter().map(|f| mobility(*f)).collect(), Quantity::Mobility);
        let found = modal(&measured, &ModalOptions::default()).unwrap();
        let meta = Meta::new("v", crate::units::Unit::parse_or_opaque("(m/s)/N"));
        let figure = argand("one", &meta, &measured, &found.modes).unwrap();
        let [Panel::Plot(plot)] = figure.panels.as_slice() else { panic!("{} panels", figure.panels.len()) };
        let radius = constant / (2.0 * zeta * own) / 2.0;
        // The other series are the lines through the origin and the mark of the natural frequency.
        for name in ["measured", "fitted modes"] {
            let series = plot.series.iter().find(|series| series.name == name).unwrap();
            assert!(series.x.len() > 4);
            for (re, im) in series.x.iter().zip(&series.y) {
                // Errors of the fit, as in the test above, and of the line between two points of the curve.
                assert!(
                    ((re - radius).hypot(*im) - radius).abs() < 1e-4 * radius,
                    "{}: {re} {im}",
                    series.name
                );
            }
        }
        let [note] = plot.notes.as_slice() else { panic!("{:?}", plot.notes) };
        assert_eq!(note.text, "5.23 Hz");
        assert!((note.x - 2.0 * radius).abs() < 1e-4 * radius && note.y.abs() < 1e-4 * radius, "{note:?}");
        assert!(plot.square);
        let magnitudes = Measured { magnitude_only: true, ..measured };
        assert!(argand("one", &meta, &magnitudes, &found.modes).is_none());
        assert!(argand("one", &meta, &magnitudes, &[]).is_none());
    }
}

//! Spectra, and frequency response functions with their band and coherence.

use crate::analysis::frf::figures::{COHERENT, coherence_plot, complex_plane, locus, phase_plot};
use crate::measure::spectral::{Lines, SpectralResult};
use crate::record::{Scaling, Spectrum};
use crate::report::layout::{capital, lettered};
use crate::report::{AxisSpec, Figure, Ink, Legend, Marker, Plot, Series, Stroke};
use crate::signal::transfer::Transfer;
use crate::units::Quantity;
use crate::units::notation::significant;

/// A spectrum, or a frequency response function.
pub fn lines(title: &str, result: &SpectralResult) -> Figure {
    match &result.found {
        Lines::Transfer(found) if result.level_unit.is_none() => transfer(title, found, &conditions(result)),
        _ => spectrum_figure(title, drawn(result), result),
    }
}

/// Several spectra of one unit over the same axes, or the magnitudes of functions.
pub fn together(results: &[(String, SpectralResult)]) -> Option<Figure> {
    let (_, first) = results.first()?;
    let mut plot = drawn(first).0;
    let mut caption = vec![conditions(first)];
    if results.iter().any(|(_, result)| conditions(result) != conditions(first)) {
        let of_each = results.iter().map(|(name, result)| format!("{name}: {}", conditions(result)));
        caption = of_each.collect();
    }
    for (name, result) in results {
        let (lines, group_size) = resolved(drawn(result).1);
        plot = plot.with(Series::line(name.as_str(), lines.0, lines.1));
        if group_size > 1 {
            caption.push(format!("{name}: each point is the largest of {group_size} neighbouring lines."));
        }
    }
    let names: Vec<&str> = results.iter().map(|(name, _)| name.as_str()).collect();
    let title = format!("Spectra, {}", names.join(", "));
    Some(Figure::double(title).panel(plot.legend(Legend::Above)).caption(caption.join(" ")))
}

/// Axes of a result and its lines above 0 Hz: levels where there is a reference, else values.
fn drawn(result: &SpectralResult) -> (Plot, (Vec<f64>, Vec<f64>)) {
    match (&result.level_unit, &result.found) {
        (Some(unit), _) => {
            let plot = Plot::new(AxisSpec::frequency(), AxisSpec::new("Level", unit.clone()));
            (plot, above_zero(&result.frequency, &result.level))
        }
        (None, Lines::Spectrum(found)) => axes(found),
        (None, Lines::Transfer(_)) => {
            let y = AxisSpec::new(capital(result.quantity), result.unit.as_str()).log();
            (Plot::new(AxisSpec::frequency(), y), above_zero(&result.frequency, &result.value))
        }
    }
}

/// Lines above 0 Hz.
fn above_zero(f: &[f64], values: &[f64]) -> (Vec<f64>, Vec<f64>) {
    f.iter().zip(values).filter(|line| *line.0 > 0.0).unzip()
}

/// Most spectral lines that print can resolve: a curve through more would fill the frame.
const MOST_LINES: usize = 4000;

/// Figure of a spectrum, with marks at the fitted sines.
fn spectrum_figure(title: &str, drawn: (Plot, (Vec<f64>, Vec<f64>)), result: &SpectralResult) -> Figure {
    let (plot, (f, v)) = drawn;
    let line_height = |at: f64| {
        // The mark of a sine is drawn at the height of the higher of its two neighbouring lines.
        let next = f.partition_point(|f| *f < at);
        v[next.saturating_sub(1)..v.len().min(next + 1)].iter().copied().fold(f64::NAN, f64::max)
    };
    let tones = result.tones.iter().map(|t| t.frequency.value);
    let (at, heights): (Vec<f64>, Vec<f64>) = tones.map(|at| (at, line_height(at))).unzip();
    let ((x, y), group_size) = resolved((f, v));
    let mut plot = plot.with(Series::line("", x, y));
    let mut caption = vec![conditions(result)];
    if !at.is_empty() {
        plot = plot.with(Series::points("", at, heights).marker(Marker::OpenCircle).ink(Ink::Nth(1)));
        caption.push("Circles mark the sines that were fitted.".to_owned());
    }
    if group_size > 1 {
        caption.push(format!("Each point is the largest of {group_size} neighbouring lines."));
    }
    Figure::double(format!("Spectrum, {title}")).panel(plot).caption(caption.join(" "))
}

/// The largest of each group of neighbouring lines, and the number of lines of a group, 1 for at most
/// [`MOST_LINES`].
fn resolved((f, v): (Vec<f64>, Vec<f64>)) -> ((Vec<f64>, Vec<f64>), usize) {
    let group_size = f.len().div_ceil(MOST_LINES).max(1);
    let largest = |(f, v): (&[f64], &[f64])| {
        let lines = f.iter().copied().zip(v.iter().copied()).filter(|line| !line.1.is_nan());
        lines.max_by(|a, b| a.1.total_cmp(&b.1)).unwrap_or((f[0], f64::NAN))
    };
    (f.chunks(group_size).zip(v.chunks(group_size)).map(largest).unzip(), group_size)
}

/// Window, averages and scaling, as a caption states them.
fn conditions(result: &SpectralResult) -> String {
    let averages = match result.averages {
        1 => "one average".to_owned(),
        n => format!("{n} averages"),
    };
    let scaling = match result.found {
        Lines::Spectrum(_) => format!(", scaling {}", result.scaling),
        Lines::Transfer(_) => String::new(),
    };
    format!("{} window, {averages}{scaling}.", capital(result.window))
}

/// The axes of a spectrum, and its lines.
fn axes(spectrum: &Spectrum) -> (Plot, (Vec<f64>, Vec<f64>)) {
    // A quantity without a name is left out of the label.
    let quantity = match spectrum.meta.quantity {
        Quantity::Other => String::new(),
        quantity => format!("{} ", quantity.name()),
    };
    let label = match spectrum.scaling {
        Scaling::Peak => format!("{quantity}amplitude"),
        Scaling::Rms => format!("{quantity}RMS"),
        Scaling::Psd => format!("{quantity}density"),
        _ => format!("{quantity}{}", spectrum.scaling.name()),
    };
    let y = AxisSpec::new(capital(&label), spectrum.meta.unit.symbol().replace("^2", "²")).log();
    // The line at 0 Hz is a mean, often lost or huge: it would stretch a logarithmic axis.
    let lines = spectrum.axis.values().into_iter().zip(spectrum.values.magnitudes());
    (Plot::new(AxisSpec::frequency(), y), lines.filter(|line| line.0 > 0.0).unzip())
}

/// Magnitude with a band of two standard deviations, phase (where the coherence is 0.5 or more), coherence.
fn transfer(title: &str, transfer: &Transfer, conditions: &str) -> Figure {
    let frf = &transfer.frf;
    let f = frf.axis.values();
    let magnitude: Vec<f64> = frf.values.iter().map(|v| v.norm()).collect();
    // At least 5 % of the magnitude, since a logarithmic axis has no place for zero or less.
    let edge = |by: f64| -> Vec<f64> {
        let lines = magnitude.iter().zip(&transfer.magnitude_std);
        let of = |edge: f64, least: f64| if edge < least { least } else { edge };
        lines.map(|(m, std)| of(m + by * std, 0.05 * m)).collect()
    };
    let y = AxisSpec::new(capital(frf.meta.quantity.name()), frf.meta.unit.symbol()).log();
    let above = Plot::new(AxisSpec::frequency(), y)
        .with(Series::band("two standard deviations", f.clone(), edge(-2.0), edge(2.0)).ink(Ink::Nth(0)))
        .with(Series::line("", f.clone(), magnitude).ink(Ink::Nth(0)))
        .legend(Legend::Above);
    let middle = phase_plot(&f, frf.values.iter().copied(), &transfer.coherence, Ink::Nth(0));
    let below = coherence_plot(&f, &transfer.coherence, Ink::Nth(0));
    let figure =
        Figure::double(format!("Function, {title}")).height(140.0).shared_x().panel(above).panel(middle);
    if transfer.coherence.is_empty() {
        return lettered(figure).caption(format!("{conditions} Of one blow: without coherence."));
    }
    lettered(figure.panel(below))
        .caption(format!("{conditions} The phase is drawn where the coherence is 0.5 or more."))
}

/// Most peaks of a function whose frequencies are written in its Argand diagram.
const NAMED_PEAKS: usize = 3;
/// Least magnitude, relative to the largest, of lines that get a dot or a name in an Argand diagram.
const LEAST_NAMED: f64 = 0.05;

/// Argand diagram of a frequency response function, without lines of a coherence below 0.5: imaginary over
/// real part. `None` for a spectrum.
pub fn argand(title: &str, result: &SpectralResult) -> Option<Figure> {
    let Lines::Transfer(found) = &result.found else { return None };
    let (f, values, coherence) = (found.frf.axis.values(), &found.frf.values, &found.coherence);
    let is_drawn = |k: &usize| values[*k].is_finite() && coherence.get(*k).is_none_or(|c| *c >= COHERENT);
    let drawn: Vec<usize> = (0..f.len()).filter(is_drawn).collect();
    let least = LEAST_NAMED * drawn.iter().map(|k| values[*k].norm()).fold(0.0, f64::max);
    let large = |k: &usize| values[*k].norm() >= least;
    let parts = |lines: &[usize]| lines.iter().map(|k| (values[*k].re, values[*k].im)).unzip();
    let ((re, im), (dots_re, dots_im)) =
        (parts(&drawn), parts(&drawn.iter().copied().filter(large).collect::<Vec<_>>()));
    let mut plot = complex_plane(&found.frf.meta)
        .with(Series::line("", re, im).ink(Ink::Nth(0)).stroke(Stroke::Thin))
        .with(locus("", dots_re, dots_im).ink(Ink::Nth(0)));
    for k in result.peaks(NAMED_PEAKS).into_iter().filter(|k| is_drawn(k) && large(k)) {
        plot = plot.note(format!("{} Hz", significant(f[k], 4)), values[k].re, values[k].im);
    }
    let coherent = if coherence.is_empty() { "" } else { " Lines with a coherence below 0.5 are left out." };
    let caption = format!("Imaginary over real part, with the frequencies of the largest peaks.{coherent}");
    Some(Figure::single(format!("Argand diagram, {title}")).height(80.0).panel(plot).caption(caption))
}

//! Spectra, and frequency response functions with their band and coherence.

use super::response::capital;
use crate::measure::spectral::{Lines, SpectralResult};
use crate::record::{Scaling, Spectrum};
use crate::report::{AxisSpec, Figure, Ink, Legend, Plot, Series};
use crate::signal::transfer::Transfer;
use crate::units::Quantity;
use num_complex::Complex64;

/// A spectrum, or a frequency response function.
pub fn lines(title: &str, result: &SpectralResult) -> Figure {
    if let Some(unit) = &result.level_unit {
        let (f, level): (Vec<f64>, Vec<f64>) =
            result.frequency.iter().zip(&result.level).filter(|line| *line.0 > 0.0).unzip();
        let plot = Plot::new(AxisSpec::frequency(), AxisSpec::new("Level", unit.clone()));
        return Figure::double(title).panel(plot.with(Series::line("", f, level)));
    }
    match &result.found {
        Lines::Spectrum(found) => spectrum(title, found),
        Lines::Transfer(found) => transfer(title, found),
    }
}

/// Lines of a spectrum over a logarithmic axis.
pub fn spectrum(title: &str, spectrum: &Spectrum) -> Figure {
    // A quantity of no name goes without.
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
    let (f, values): (Vec<f64>, Vec<f64>) = lines.filter(|line| line.0 > 0.0).unzip();
    let plot = Plot::new(AxisSpec::frequency(), y).with(Series::line("", f, values));
    Figure::double(title).panel(plot)
}

/// Magnitude with a band of two standard deviations, phase (where the coherence is 0.5 or more), coherence.
pub fn transfer(title: &str, transfer: &Transfer) -> Figure {
    let frf = &transfer.frf;
    let f = frf.axis.values();
    let magnitude: Vec<f64> = frf.values.iter().map(|v| v.norm()).collect();
    let edge = |sign: f64| -> Vec<f64> {
        magnitude
            .iter()
            .zip(&transfer.magnitude_std)
            .map(|(m, std)| (m + sign * 2.0 * std).max(0.05 * m))
            .collect()
    };
    // A phase that says nothing only fills the frame.
    let shown =
        |(v, coherence): (&Complex64, &f64)| if *coherence < 0.5 { f64::NAN } else { v.arg().to_degrees() };
    let phase: Vec<f64> = frf.values.iter().zip(&transfer.coherence).map(shown).collect();
    let y = AxisSpec::new(capital(frf.meta.quantity.name()), frf.meta.unit.symbol()).log();
    let above = Plot::new(AxisSpec::frequency(), y)
        .with(Series::band("two standard deviations", f.clone(), edge(-1.0), edge(1.0)).ink(Ink::Nth(0)))
        .with(Series::line("", f.clone(), magnitude).ink(Ink::Nth(0)))
        .legend(Legend::Above);
    let middle = Plot::new(AxisSpec::frequency(), AxisSpec::new("Phase", "°").limits(-180.0, 180.0))
        .with(Series::phase("", &f, &phase).ink(Ink::Nth(0)));
    let below = Plot::new(AxisSpec::frequency(), AxisSpec::new("Coherence", "").limits(0.0, 1.0))
        .with(Series::line("", f, transfer.coherence.clone()).ink(Ink::Nth(0)));
    Figure::double(title)
        .height(140.0)
        .shared_x()
        .panel(above)
        .panel(middle)
        .panel(below)
        .caption("The phase is drawn where the coherence is 0.5 or more.")
}

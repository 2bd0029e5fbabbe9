//! What a spectrum or a frequency response function says.

use super::coherence;
use crate::tones::Tone;
use serde::Serialize;
use vibro_record::units::notation;
use vibro_record::{Axis, Finding, Frf, Grid, Record, Scaling, Spectrum, Values, Window};
use vibro_signal::impact::Blow;
use vibro_signal::transfer::{Estimator, Transfer};

/// Lines, and what they mean. Magnitudes of a frequency response function where there is a reference.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SpectralResult {
    /// Name of the channel, or of both.
    pub name: String,
    /// Frequencies in Hz.
    pub frequency: Vec<f64>,
    /// Values in `unit`; NaN (null in JSON) where there are none.
    pub value: Vec<f64>,
    /// Their standard deviations; NaN where not known.
    pub value_std: Vec<f64>,
    /// What a line means.
    pub scaling: &'static str,
    /// Unit.
    pub unit: String,
    /// Quantity.
    pub quantity: &'static str,
    /// Levels in `level_unit`; empty where no reference was given.
    pub level: Vec<f64>,
    /// `dB re` the reference.
    pub level_unit: Option<String>,
    /// Window.
    pub window: &'static str,
    /// Equivalent noise bandwidth in lines.
    pub enbw: f64,
    /// What was taken out first.
    pub detrend: &'static str,
    /// Segments or blows.
    pub averages: usize,
    /// What a function has beside its magnitude.
    #[serde(flatten)]
    pub response: Option<Response>,
    /// Sines fitted to the whole record, the strongest first; empty where none were asked for.
    pub tones: Vec<Tone>,
    /// What was left out, and what limits the lines.
    pub findings: Vec<Finding>,
    /// The lines as they were found.
    #[serde(skip)]
    pub found: Lines,
}

/// Lines of one channel or of two.
#[derive(Debug, Clone, PartialEq)]
pub enum Lines {
    /// Of one.
    Spectrum(Spectrum),
    /// Of one over the other.
    Transfer(Transfer),
}

/// What a frequency response function has beside its magnitude.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Response {
    /// `h1`, `h2` or `hv`.
    pub estimator: &'static str,
    /// Degrees.
    pub phase: Vec<f64>,
    /// Degrees.
    pub phase_std: Vec<f64>,
    /// Coherence γ².
    pub coherence: Vec<f64>,
    /// Every blow of a hammer, also those left out.
    pub blows: Vec<Blow>,
}

impl SpectralResult {
    /// Of a spectrum, with the standard deviations of its lines over their values.
    pub(super) fn lines(
        spectrum: Spectrum,
        averages: usize,
        scatter: &[f64],
        detrend: &'static str,
        findings: Vec<Finding>,
    ) -> SpectralResult {
        let value = spectrum.values.magnitudes();
        SpectralResult {
            name: spectrum.meta.name.clone(),
            frequency: spectrum.axis.values(),
            value_std: value.iter().zip(scatter).map(|(v, part)| v * part).collect(),
            value,
            scaling: spectrum.scaling.name(),
            unit: spectrum.meta.unit.symbol().to_owned(),
            quantity: spectrum.meta.quantity.name(),
            level: Vec::new(),
            level_unit: None,
            window: spectrum.window.map_or("unknown", Window::name),
            enbw: spectrum.enbw.unwrap_or(f64::NAN),
            detrend,
            averages,
            response: None,
            tones: Vec::new(),
            findings,
            found: Lines::Spectrum(spectrum),
        }
    }

    pub(super) fn response(
        found: Transfer,
        estimator: Estimator,
        window: (&'static str, f64),
        detrend: &'static str,
        blows: Vec<Blow>,
        findings: Vec<Finding>,
    ) -> SpectralResult {
        let degrees = |v: &f64| v.to_degrees();
        SpectralResult {
            name: found.frf.meta.name.clone(),
            frequency: found.frf.axis.values(),
            value: found.frf.values.iter().map(|v| v.norm()).collect(),
            value_std: found.magnitude_std.clone(),
            scaling: "frf",
            unit: found.frf.meta.unit.symbol().to_owned(),
            quantity: found.frf.meta.quantity.name(),
            level: Vec::new(),
            level_unit: None,
            window: window.0,
            enbw: window.1,
            detrend,
            averages: found.averages,
            response: Some(Response {
                estimator: estimator.name(),
                phase: found.frf.values.iter().map(|v| v.arg().to_degrees()).collect(),
                phase_std: found.phase_std.iter().map(degrees).collect(),
                coherence: found.coherence.clone(),
                blows,
            }),
            tones: Vec::new(),
            findings: [findings, found.findings.clone()].concat(),
            found: Lines::Transfer(found),
        }
    }

    /// Adds levels over a reference: 20 lg of amplitudes, 10 lg of powers over its square (ISO 1683).
    pub(super) fn over(&mut self, reference: f64) {
        let power = match &self.found {
            Lines::Spectrum(spectrum) => matches!(spectrum.scaling, Scaling::Power | Scaling::Psd),
            Lines::Transfer(_) => false,
        };
        let level = |v: &f64| {
            let level = if power {
                10.0 * (v / (reference * reference)).log10()
            } else {
                20.0 * (v / reference).log10()
            };
            if level.is_finite() { level } else { f64::NAN }
        };
        self.level = self.value.iter().map(level).collect();
        let unit = match self.unit.strip_prefix('(').and_then(|u| u.split_once(")²")) {
            Some((base, rest)) if power => format!("({})²{rest}", notation::reference(reference, base)),
            _ if power => match self.unit.split_once('²') {
                Some((base, rest)) => format!("({})²{rest}", notation::reference(reference, base)),
                None => format!("{reference}² {}", self.unit),
            },
            _ => notation::reference(reference, &self.unit),
        };
        self.level_unit = Some(format!("dB re {unit}"));
    }

    /// Notes which lines an integration leaves out.
    pub(super) fn left_out(&mut self, integrated: i8, fmin: f64) {
        if integrated > 0 {
            // Integrated they would be noise divided by the frequency.
            self.findings.push(Finding::note("lines-below-cutoff").number("fmin", fmin));
        }
    }

    /// Spectrum, or function and coherence, without the lines that have no value: files have no word for them.
    pub fn records(&self) -> Vec<Record> {
        match &self.found {
            Lines::Spectrum(spectrum) => vec![known(Record::Spectrum(spectrum.clone()))],
            Lines::Transfer(found) => {
                let coherence = coherence(&found.frf.axis, &found.coherence);
                vec![known(Record::Frf(found.frf.clone())), known(coherence)]
            }
        }
    }

    /// Indices of the largest peaks, at most so many, in order of frequency.
    pub fn peaks(&self, most: usize) -> Vec<usize> {
        let at = |k: Option<usize>| {
            k.and_then(|k| self.value.get(k)).copied().filter(|v| v.is_finite()).unwrap_or(0.0)
        };
        let is_peak = |k: &usize| at(Some(*k)) > at(k.checked_sub(1)) && at(Some(*k)) >= at(Some(k + 1));
        let mut largest: Vec<usize> = (0..self.value.len()).filter(is_peak).collect();
        largest.sort_by(|a, b| at(Some(*b)).total_cmp(&at(Some(*a))));
        largest.truncate(most);
        largest.sort_unstable();
        largest
    }
}

/// The record without lines that have no value.
fn known(record: Record) -> Record {
    match record {
        Record::Frf(frf) => {
            let (axis, values) = finite(&frf.axis, &frf.values, |v| v.is_finite());
            Record::Frf(Frf { axis, values, ..frf })
        }
        Record::Spectrum(spectrum) => {
            let (axis, values) = match &spectrum.values {
                Values::Real(v) => {
                    let (axis, values) = finite(&spectrum.axis, v, |v| v.is_finite());
                    (axis, Values::Real(values))
                }
                Values::Complex(v) => {
                    let (axis, values) = finite(&spectrum.axis, v, |v| v.is_finite());
                    (axis, Values::Complex(values))
                }
            };
            Record::Spectrum(Spectrum { axis, values, ..spectrum })
        }
        Record::Trace(trace) => Record::Trace(trace),
    }
}

/// Lines with a value, evenly spaced where none is missing between them.
fn finite<T: Copy>(axis: &Axis, values: &[T], is_finite: impl Fn(&T) -> bool) -> (Axis, Vec<T>) {
    let kept: Vec<usize> = (0..values.len()).filter(|k| is_finite(&values[*k])).collect();
    let [first, last] = [kept.first(), kept.last()].map(|k| k.copied().unwrap_or(0));
    let grid = match axis.step() {
        Some(step) if last + 1 - first == kept.len() => {
            Grid::Even { start: axis.at(first), step, n: kept.len() }
        }
        _ => Grid::Uneven(kept.iter().map(|k| axis.at(*k)).collect()),
    };
    (Axis { kind: axis.kind.clone(), grid }, kept.iter().map(|k| values[*k]).collect())
}

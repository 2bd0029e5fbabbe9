//! Results of a spectrum or a frequency response function.

use super::SpectralOptions;
use crate::tones::Tone;
use serde::Serialize;
use vibro_record::units::Unit;
use vibro_record::units::notation;
use vibro_record::{
    Axis, Finding, Frf, Grid, Meta, Record, Scaling, Spectrum, Uncertain, Values, sort_by_number,
};
use vibro_signal::impact::Blow;
use vibro_signal::transfer::{Estimator, Transfer};

/// Lines of a spectrum, or with a reference channel magnitudes of a frequency response function; and their
/// meaning.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SpectralResult {
    /// Name of the channel, or of both.
    pub name: String,
    /// Frequencies in Hz.
    pub frequency: Vec<f64>,
    /// Values in `unit`; NaN (null in JSON) where there are none.
    pub value: Vec<f64>,
    /// Their standard uncertainties; NaN where not known.
    pub value_std: Vec<f64>,
    /// Scaling of the lines by name; `frf` for functions.
    pub scaling: &'static str,
    /// Unit of the values.
    pub unit: String,
    /// Quantity of the values.
    pub quantity: &'static str,
    /// Levels in `level_unit`; empty where no reference was given.
    pub level: Vec<f64>,
    /// `dB re` the reference.
    pub level_unit: Option<String>,
    /// Window, by name.
    pub window: &'static str,
    /// Equivalent noise bandwidth in lines.
    pub enbw: f64,
    /// What was subtracted before the transform.
    pub detrend: &'static str,
    /// Number of segments or blows averaged.
    pub averages: usize,
    /// Data of a function besides its magnitude, such as phase and coherence.
    #[serde(flatten)]
    pub response: Option<FrfDetails>,
    /// Sines fitted to the whole record, the strongest first; empty if none were requested.
    pub tones: Vec<Tone>,
    /// Probability that noise alone shows a peak or a tone; null for functions.
    pub false_alarms: Option<f64>,
    /// Whether each line is a peak above the noise; empty for functions.
    #[serde(skip)]
    pub clear: Vec<bool>,
    /// Findings: what was left out, and what limits the lines.
    pub findings: Vec<Finding>,
    /// The lines as a spectrum or function.
    #[serde(skip)]
    pub found: Lines,
}

impl Uncertain for SpectralResult {
    fn doubt(&mut self) {
        self.doubt_scale();
        self.response.iter_mut().for_each(|response| response.phase_std.fill(f64::NAN));
        if let Lines::Transfer(function) = &mut self.found {
            function.phase_std.fill(f64::NAN);
        }
        self.tones.doubt();
    }

    fn doubt_scale(&mut self) {
        self.value_std.fill(f64::NAN);
        if let Lines::Transfer(function) = &mut self.found {
            function.magnitude_std.fill(f64::NAN);
        }
        self.tones.doubt_scale();
    }
}

/// Lines of one channel or of two.
#[derive(Debug, Clone, PartialEq)]
pub enum Lines {
    /// Of one channel.
    Spectrum(Spectrum),
    /// Of one channel over the other.
    Transfer(Transfer),
}

/// Phase, coherence and blows of a frequency response function.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct FrfDetails {
    /// `h1`, `h2` or `hv`.
    pub estimator: &'static str,
    /// Phase in degrees.
    pub phase: Vec<f64>,
    /// Its standard uncertainty in degrees.
    pub phase_std: Vec<f64>,
    /// Coherence γ²; null for one blow alone.
    pub coherence: Option<Vec<f64>>,
    /// Every blow of a hammer, also those left out.
    pub blows: Vec<Blow>,
}

impl SpectralResult {
    pub(super) fn of(
        found: Lines,
        options: &SpectralOptions,
        fmin: f64,
        mut findings: Vec<Finding>,
    ) -> SpectralResult {
        let response = |found: &Transfer| FrfDetails {
            estimator: options.estimator.map_or("", Estimator::name),
            phase: found.frf.values.iter().map(|v| v.arg().to_degrees()).collect(),
            phase_std: found.phase_std.iter().map(|v| v.to_degrees()).collect(),
            coherence: Some(found.coherence.clone()).filter(|coherence| !coherence.is_empty()),
            blows: Vec::new(),
        };
        let (meta, axis, value, scaling, enbw, function) = match &found {
            Lines::Spectrum(s) => (&s.meta, &s.axis, s.values.magnitudes(), s.scaling.name(), s.enbw, None),
            Lines::Transfer(function) => {
                let (frf, enbw) = (&function.frf, options.window().enbw());
                let value = frf.values.iter().map(|v| v.norm()).collect();
                (&frf.meta, &frf.axis, value, "frf", Some(enbw), Some(function))
            }
        };
        findings.extend(function.iter().flat_map(|found| found.findings.iter().cloned()));
        // After integration, lines below `fmin` would be noise divided by the frequency.
        let below = Finding::note("lines-below-cutoff").number("fmin", fmin);
        findings.extend((options.integrate > 0).then_some(below));
        SpectralResult {
            name: meta.name.clone(),
            frequency: axis.values(),
            value,
            value_std: function.map_or_else(Vec::new, |found| found.magnitude_std.clone()),
            scaling,
            unit: meta.unit.symbol().to_owned(),
            quantity: meta.quantity.name(),
            level: Vec::new(),
            level_unit: None,
            window: options.window().name(),
            enbw: enbw.unwrap_or(f64::NAN),
            detrend: if options.detrended() { "mean" } else { "none" },
            averages: function.map_or(0, |found| found.averages),
            response: function.map(response),
            tones: Vec::new(),
            false_alarms: None,
            clear: Vec::new(),
            findings,
            found,
        }
    }

    /// Adds levels over a reference: 20 lg of amplitudes in `unit`, 10 lg of powers over its square (ISO
    /// 1683).
    pub(super) fn over(&mut self, reference: f64, unit: &str) {
        let power = ["power", "psd"].contains(&self.scaling);
        let factor = if power { 10.0 } else { 20.0 };
        let over = if power { reference * reference } else { reference };
        let level = self.value.iter().map(|v| factor * (v / over).log10());
        self.level = level.map(|level| if level.is_finite() { level } else { f64::NAN }).collect();
        let reference = notation::reference(reference, unit);
        self.level_unit = Some(match self.scaling {
            "power" => format!("dB re ({reference})²"),
            "psd" => format!("dB re ({reference})²/Hz"),
            _ => format!("dB re {reference}"),
        });
    }

    /// Spectrum, or function and coherence, as records for a file. Lines without a value are left out, since
    /// files cannot state them.
    pub fn records(&self) -> Vec<Record> {
        let known = |spectrum: Spectrum| {
            let (axis, kept) = finite(&spectrum.axis, |k| spectrum.values.magnitude(k).is_finite());
            let values = match &spectrum.values {
                Values::Real(v) => Values::Real(kept.iter().map(|k| v[*k]).collect()),
                Values::Complex(v) => Values::Complex(kept.iter().map(|k| v[*k]).collect()),
            };
            Record::Spectrum(Spectrum { axis, values, ..spectrum })
        };
        match &self.found {
            Lines::Spectrum(spectrum) => vec![known(spectrum.clone())],
            Lines::Transfer(found) => {
                let frf = found.frf.clone();
                let coherence = Spectrum {
                    meta: Meta::new("coherence", Unit::parse_or_opaque("1")),
                    axis: frf.axis.clone(),
                    values: Values::Real(found.coherence.clone()),
                    scaling: Scaling::Coherence,
                    window: None,
                    enbw: None,
                };
                let (axis, kept) = finite(&frf.axis, |k| frf.values[k].is_finite());
                let values = kept.iter().map(|k| frf.values[*k]).collect();
                let function = Record::Frf(Frf { axis, values, ..frf });
                let coherence = (!found.coherence.is_empty()).then(|| known(coherence));
                std::iter::once(function).chain(coherence).collect()
            }
        }
    }

    fn height(&self, k: usize) -> f64 {
        self.value.get(k).copied().filter(|v| v.is_finite()).unwrap_or(0.0)
    }

    pub(super) fn is_peak(&self, k: usize) -> bool {
        let height = self.height(k);
        height > self.height(k.wrapping_sub(1)) && height >= self.height(k + 1)
    }

    /// Indices of at most `most` largest peaks, in order of frequency; of a spectrum those above the noise.
    pub fn peaks(&self, most: usize) -> Vec<usize> {
        let listed = |k: &usize| self.clear.get(*k).copied().unwrap_or_else(|| self.is_peak(*k));
        let mut largest: Vec<usize> = (0..self.value.len()).filter(listed).collect();
        sort_by_number(&mut largest, |a| -self.height(*a));
        largest.truncate(most);
        largest.sort_unstable();
        largest
    }
}

/// Axis of the lines with a value, evenly spaced where none is missing between them, and their indices.
fn finite(axis: &Axis, is_finite: impl Fn(usize) -> bool) -> (Axis, Vec<usize>) {
    let kept: Vec<usize> = (0..axis.len()).filter(|k| is_finite(*k)).collect();
    let [first, last] = [kept.first(), kept.last()].map(|k| k.copied().unwrap_or(0));
    let grid = match axis.step() {
        Some(step) if last + 1 - first == kept.len() => {
            Grid::Even { start: axis.at(first), step, n: kept.len() }
        }
        _ => Grid::Uneven(kept.iter().map(|k| axis.at(*k)).collect()),
    };
    (Axis { kind: axis.kind.clone(), grid }, kept)
}

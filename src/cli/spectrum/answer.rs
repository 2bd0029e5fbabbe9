//! What `vibro spectrum` says.

use crate::error::Result;
use crate::record::{Axis, Frf, Grid, Record, Spectrum, Values, Window};
use crate::report::{Figure, Output, files};
use crate::signal::impact::Blow;
use crate::signal::transfer::{Estimator, Transfer};
use crate::write::{Storage, Target};
use serde::Serialize;
use std::fmt::Write as _;
use std::path::Path;

/// Most lines that a terminal shows.
const SHOWN: usize = 12;

/// Lines, and what they mean. Magnitudes of a frequency response function where there is a reference.
#[derive(Serialize)]
pub struct Answer {
    pub name: String,
    pub frequency: Vec<f64>,
    pub value: Vec<f64>,
    pub value_std: Vec<f64>,
    pub scaling: &'static str,
    pub unit: String,
    pub quantity: &'static str,
    pub window: &'static str,
    pub enbw: f64,
    pub detrend: &'static str,
    pub averages: usize,
    #[serde(flatten)]
    pub response: Option<Response>,
    pub files: Vec<String>,
    pub warnings: Vec<String>,
}

/// What a frequency response function has beside its magnitude.
#[derive(Serialize)]
pub struct Response {
    estimator: &'static str,
    /// Degrees.
    phase: Vec<f64>,
    phase_std: Vec<f64>,
    coherence: Vec<f64>,
    blows: Vec<Blow>,
}

impl Answer {
    /// Of a spectrum, with the standard deviations of its lines over their values.
    pub fn lines(
        spectrum: &Spectrum,
        averages: usize,
        scatter: &[f64],
        detrend: &'static str,
        warnings: Vec<String>,
    ) -> Answer {
        let value = spectrum.values.magnitudes();
        Answer {
            name: spectrum.meta.name.clone(),
            frequency: spectrum.axis.values(),
            value_std: value.iter().zip(scatter).map(|(v, part)| v * part).collect(),
            value,
            scaling: spectrum.scaling.name(),
            unit: spectrum.meta.unit.symbol().to_owned(),
            quantity: spectrum.meta.quantity.name(),
            window: spectrum.window.map_or("unknown", Window::name),
            enbw: spectrum.enbw.unwrap_or(f64::NAN),
            detrend,
            averages,
            response: None,
            files: Vec::new(),
            warnings,
        }
    }

    pub fn response(
        found: &Transfer,
        estimator: Estimator,
        window: (&'static str, f64),
        detrend: &'static str,
        blows: &[Blow],
        mut warnings: Vec<String>,
    ) -> Answer {
        warnings.extend(found.warnings.iter().cloned());
        let degrees = |v: &f64| v.to_degrees();
        Answer {
            name: found.frf.meta.name.clone(),
            frequency: found.frf.axis.values(),
            value: found.frf.values.iter().map(|v| v.norm()).collect(),
            value_std: found.magnitude_std.clone(),
            scaling: "frf",
            unit: found.frf.meta.unit.symbol().to_owned(),
            quantity: found.frf.meta.quantity.name(),
            window: window.0,
            enbw: window.1,
            detrend,
            averages: found.averages,
            response: Some(Response {
                estimator: estimator.name(),
                phase: found.frf.values.iter().map(|v| v.arg().to_degrees()).collect(),
                phase_std: found.phase_std.iter().map(degrees).collect(),
                coherence: found.coherence.clone(),
                blows: blows.to_vec(),
            }),
            files: Vec::new(),
            warnings,
        }
    }

    /// Says which lines an integration leaves out.
    pub fn left_out(&mut self, integrated: i8, fmin: f64) {
        if integrated > 0 {
            self.warnings.push(format!(
                "Lines below {fmin:.6} Hz are left out: integrated, they would be noise divided by the frequency. Choose with --fmin."
            ));
        }
    }

    /// Writes figure and lines as files.
    pub fn write(&mut self, folder: &Path, name: &str, figure: Figure, records: &[Record]) -> Result<()> {
        let records: Vec<Record> = records.iter().map(known).collect();
        let mut output = Output::new(folder)?;
        files::figures(&mut output, &[(name.to_owned(), figure)], &|| ())?;
        for target in [Target::Csv, Target::Uff] {
            let mut bytes = Vec::new();
            target.write(&records, Storage::default(), &mut bytes)?;
            output.write(&format!("{name}.{}", target.name()), bytes)?;
        }
        self.files = output.written().to_vec();
        Ok(())
    }

    /// The largest lines, for a terminal.
    pub fn text(&self) -> String {
        let mut text = format!(
            "{}: {} lines, {} [{}], window {}, ENBW {:.4} lines, detrend {}, {} average(s)\n",
            self.name,
            self.frequency.len(),
            self.scaling,
            self.unit,
            self.window,
            self.enbw,
            self.detrend,
            self.averages
        );
        let mut largest: Vec<usize> = (0..self.value.len()).filter(|k| self.is_peak(*k)).collect();
        largest.sort_by(|a, b| self.value[*b].total_cmp(&self.value[*a]));
        largest.truncate(SHOWN);
        largest.sort_unstable();
        text.push_str("largest peaks (all lines: --json or --out):\n");
        for k in largest {
            let _ = write!(text, "{:>14.6} Hz {:>14.6e}", self.frequency[k], self.value[k]);
            if self.value_std[k].is_finite() {
                let _ = write!(text, " ± {:<10.2e}", self.value_std[k]);
            }
            if let Some(r) = &self.response {
                let _ = write!(text, " {:>8.2}° γ² {:.4}", r.phase[k], r.coherence[k]);
            }
            text.push('\n');
        }
        for file in &self.files {
            let _ = writeln!(text, "wrote {file}");
        }
        text
    }

    fn is_peak(&self, k: usize) -> bool {
        let at = |k: Option<usize>| {
            k.and_then(|k| self.value.get(k)).copied().filter(|v| v.is_finite()).unwrap_or(0.0)
        };
        self.value[k] > at(k.checked_sub(1)) && self.value[k] >= at(Some(k + 1))
    }
}

/// The record without lines that have no value: files have no word for them.
fn known(record: &Record) -> Record {
    match record {
        Record::Frf(frf) => {
            let (axis, values) = finite(&frf.axis, &frf.values, |v| v.is_finite());
            Record::Frf(Frf { axis, values, ..frf.clone() })
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
            Record::Spectrum(Spectrum { axis, values, ..spectrum.clone() })
        }
        Record::Trace(_) => record.clone(),
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

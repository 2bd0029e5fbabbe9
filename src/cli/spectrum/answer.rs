//! What `vibro spectrum` says.

use crate::error::Result;
use crate::record::{Record, Spectrum, Window};
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
    pub scaling: &'static str,
    pub unit: String,
    pub quantity: &'static str,
    pub window: &'static str,
    pub enbw: f64,
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
    value_std: Vec<f64>,
    /// Degrees.
    phase: Vec<f64>,
    phase_std: Vec<f64>,
    coherence: Vec<f64>,
    blows: Vec<Blow>,
}

impl Answer {
    pub fn lines(spectrum: &Spectrum, averages: usize, warnings: Vec<String>) -> Answer {
        Answer {
            name: spectrum.meta.name.clone(),
            frequency: spectrum.axis.values(),
            value: spectrum.values.magnitudes(),
            scaling: spectrum.scaling.name(),
            unit: spectrum.meta.unit.symbol().to_owned(),
            quantity: spectrum.meta.quantity.name(),
            window: spectrum.window.map_or("unknown", Window::name),
            enbw: spectrum.enbw.unwrap_or(f64::NAN),
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
        blows: &[Blow],
        mut warnings: Vec<String>,
    ) -> Answer {
        warnings.extend(found.warnings.iter().cloned());
        let degrees = |v: &f64| v.to_degrees();
        Answer {
            name: found.frf.meta.name.clone(),
            frequency: found.frf.axis.values(),
            value: found.frf.values.iter().map(|v| v.norm()).collect(),
            scaling: "frf",
            unit: found.frf.meta.unit.symbol().to_owned(),
            quantity: found.frf.meta.quantity.name(),
            window: window.0,
            enbw: window.1,
            averages: found.averages,
            response: Some(Response {
                estimator: estimator.name(),
                value_std: found.magnitude_std.clone(),
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
        let mut output = Output::new(folder)?;
        files::figures(&mut output, &[(name.to_owned(), figure)], &|| ())?;
        for target in [Target::Csv, Target::Uff] {
            let mut bytes = Vec::new();
            target.write(records, Storage::default(), &mut bytes)?;
            output.write(&format!("{name}.{}", target.name()), bytes)?;
        }
        self.files = output.written().to_vec();
        Ok(())
    }

    /// The largest lines, for a terminal.
    pub fn text(&self) -> String {
        let mut text = format!(
            "{}: {} lines, {} [{}], window {}, ENBW {:.4} lines, {} average(s)\n",
            self.name,
            self.frequency.len(),
            self.scaling,
            self.unit,
            self.window,
            self.enbw,
            self.averages
        );
        let mut largest: Vec<usize> = (0..self.value.len()).filter(|k| self.is_peak(*k)).collect();
        largest.sort_by(|a, b| self.value[*b].total_cmp(&self.value[*a]));
        largest.truncate(SHOWN);
        largest.sort_unstable();
        text.push_str("largest peaks (all lines: --json or --out):\n");
        for k in largest {
            let _ = write!(text, "{:>14.6} Hz {:>14.6e}", self.frequency[k], self.value[k]);
            if let Some(r) = &self.response {
                let _ = write!(
                    text,
                    " ± {:<10.2e} {:>8.2}° γ² {:.4}",
                    r.value_std[k], r.phase[k], r.coherence[k]
                );
            }
            text.push('\n');
        }
        for file in &self.files {
            let _ = writeln!(text, "wrote {file}");
        }
        text
    }

    fn is_peak(&self, k: usize) -> bool {
        let at = |k: Option<usize>| k.and_then(|k| self.value.get(k)).copied().unwrap_or(0.0);
        self.value[k] > at(k.checked_sub(1)) && self.value[k] >= at(Some(k + 1))
    }
}

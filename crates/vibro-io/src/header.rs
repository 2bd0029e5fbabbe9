//! What `vibro info` says of a record, gathered without holding its values.

use vibro_record::{Axis, Finding, Meta, Record};

/// One record of a file, without its values.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct Header {
    /// Channel or record name.
    pub name: String,
    /// `trace`, `spectrum` or `frf`.
    pub kind: &'static str,
    /// Quantity by name.
    pub quantity: &'static str,
    /// SI unit.
    pub unit: String,
    /// Number of values present.
    pub n: usize,
    /// Number of values that the file declares.
    pub declared_n: Option<usize>,
    /// First abscissa value, in s or Hz.
    pub x0: f64,
    /// Distance of abscissa values; `None` if uneven.
    pub dx: Option<f64>,
    /// Whether values are complex.
    pub complex: bool,
    /// Largest magnitude in SI units; `None` where the values were not read or are all missing.
    pub max_abs: Option<f64>,
    /// Abscissa of the largest magnitude.
    pub max_at: Option<f64>,
    /// Header lines that were kept and not understood, and what the text was read as: encoding, decimal mark.
    pub notes: Vec<String>,
    /// What a person must know before trusting the values.
    pub findings: Vec<Finding>,
}

impl Header {
    /// Header of a record that is in memory.
    pub fn of(record: &Record) -> Header {
        let (meta, axis) = (record.meta(), record.axis());
        let max = record.max_abs();
        Header {
            name: meta.name.clone(),
            kind: record.kind(),
            quantity: meta.quantity.name(),
            unit: meta.unit.symbol().to_owned(),
            n: record.len(),
            declared_n: meta.declared_n,
            x0: axis.start(),
            dx: axis.step(),
            complex: record.is_complex(),
            max_abs: max.map(|(_, m)| m),
            max_at: max.map(|(i, _)| axis.at(i)),
            notes: notes(meta),
            findings: meta.findings.clone(),
        }
    }

    /// The same with what a pass over the values found.
    pub(crate) fn summed(mut self, summary: &Summary, axis: &Axis) -> Header {
        self.n = summary.n;
        self.max_abs = summary.max.map(|(_, m)| m);
        self.max_at = summary.max.filter(|(i, _)| *i < axis.len()).map(|(i, _)| axis.at(i));
        self
    }
}

/// Header lines, then the arguments of the step `read` that say how text was read.
fn notes(meta: &Meta) -> Vec<String> {
    let lines = meta.notes.iter().map(
        |(key, value)| {
            if key.is_empty() { value.clone() } else { format!("{key}: {value}") }
        },
    );
    let how = meta.history.iter().filter(|step| step.name == "read").flat_map(|step| &step.arguments);
    let how = how.filter(|(key, _)| matches!(key.as_str(), "encoding" | "decimal mark"));
    lines.chain(how.map(|(key, value)| format!("{key}: {value}"))).collect()
}

/// Count and largest magnitude of a stream of values.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(crate) struct Summary {
    /// Values seen.
    pub n: usize,
    /// Index and magnitude of the largest; the first of equals.
    pub max: Option<(usize, f64)>,
}

impl Summary {
    /// Takes one more magnitude; NaN counts as a value but never as the largest.
    pub fn push(&mut self, magnitude: f64) {
        if !magnitude.is_nan() && self.max.is_none_or(|(_, m)| magnitude > m) {
            self.max = Some((self.n, magnitude));
        }
        self.n += 1;
    }
}

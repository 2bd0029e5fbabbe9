//! What `vibro info` says of a record, gathered without holding its values.

use vibro_record::{Finding, Meta, Record};

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

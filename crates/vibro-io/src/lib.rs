//! Files to records: one file a format, one ordered sniff table.
//!
//! ```no_run
//! use vibro_io::Reader;
//! let recording = Reader::new().from_path("TRACE01.DAT")?;
//! for record in &recording.records {
//!     println!("{} {} {}", record.meta().name, record.len(), record.meta().unit);
//! }
//! # Ok::<(), vibro_record::Error>(())
//! ```

mod assemble;
mod axis;
mod choose;
mod decibel;
mod format;
mod header;
mod mat;
mod missing;
mod reader;
mod source;
mod stream;
mod sweep;
mod sweep_list;
mod text;
mod uff;
mod uff58;
pub(crate) mod wav;

pub mod number;
pub mod write;

pub use format::Format;
pub use header::{Header, Summary};
pub use reader::{Options, Reader, Recording};
pub use source::Source;
pub use sweep::SweepReader;
pub use sweep_list::{SweepList, inside};
pub use wav::WavStream;

#[cfg(test)]
mod tests {
    use vibro_record::{Fact, Finding};

    /// Findings as text, numbers with six digits: `axis-uneven column=column "t" smallest=0.1`.
    pub fn told(findings: &[Finding]) -> Vec<String> {
        let fact = |(name, fact): &(&str, Fact)| match fact {
            Fact::Number(value) => format!("{name}={}", crate::axis::short(*value)),
            Fact::Numbers(values) => format!("{name}={values:?}"),
            Fact::Name(text) => format!("{name}={text}"),
        };
        let facts = |found: &Finding| found.facts.iter().map(fact).collect::<Vec<_>>().join(" ");
        findings.iter().map(|found| format!("{} {}", found.code, facts(found))).collect()
    }

    /// Whether one of the findings, as text, begins with `code` and holds all `facts`.
    pub fn says(findings: &[Finding], code: &str, facts: &[&str]) -> bool {
        told(findings).iter().any(|t| t.split(' ').next() == Some(code) && facts.iter().all(|f| t.contains(f)))
    }
}

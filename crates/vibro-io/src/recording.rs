//! What a file holds.

use crate::format::Format;
use std::path::PathBuf;
use vibro_record::{Finding, Record};

/// Everything a file holds.
#[derive(Debug, Clone, PartialEq)]
pub struct Recording {
    /// Path of the file.
    pub path: PathBuf,
    /// Its format.
    pub format: Format,
    /// Its records, in the order of the file.
    pub records: Vec<Record>,
    /// Findings on the file as a whole: what was skipped or assumed.
    pub findings: Vec<Finding>,
}

impl Recording {
    /// All findings: the file's, then those of the records, see [`Finding::gathered`].
    pub fn all_findings(&self) -> Vec<Finding> {
        let mut all = self.findings.clone();
        let records: Vec<_> =
            self.records.iter().map(|r| (r.meta().name.as_str(), r.meta().findings.as_slice())).collect();
        all.extend(Finding::gathered(&records));
        all
    }
}

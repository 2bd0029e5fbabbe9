//! Files that tables of a campaign name.

use std::path::PathBuf;

/// Largest number of files that a sentence names one by one.
const SHOWN: usize = 5;

/// Names of a few files, and how many more there are.
pub(crate) fn few<S: AsRef<str>>(names: &[S]) -> String {
    let shown: Vec<&str> = names.iter().take(SHOWN).map(AsRef::as_ref).collect();
    let more = names.len().saturating_sub(SHOWN);
    shown.join(", ") + &if more > 0 { format!(" and {more} more") } else { String::new() }
}

/// A file that a table names.
#[derive(Debug)]
pub(crate) struct NamedFile {
    /// The file.
    pub file: PathBuf,
    /// Section of the table.
    pub section: &'static str,
    /// Name of the table.
    pub table: String,
    /// Statements of the table on the record: channels, and settings for reading.
    pub record: String,
}

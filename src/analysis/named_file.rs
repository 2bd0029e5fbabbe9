//! Files named by the tables of a campaign.

use std::path::PathBuf;

/// Largest number of files that a sentence names one by one.
const SHOWN: usize = 5;

/// Names of a few files, and how many more there are.
pub(crate) fn few<S: AsRef<str>>(names: &[S]) -> String {
    let shown: Vec<&str> = names.iter().take(SHOWN).map(AsRef::as_ref).collect();
    let more = names.len().saturating_sub(SHOWN);
    shown.join(", ") + &if more > 0 { format!(" and {more} more") } else { String::new() }
}

/// A file named by a table.
#[derive(Debug)]
pub(crate) struct NamedFile {
    /// The file.
    pub file: PathBuf,
    /// Section of the table.
    pub section: &'static str,
    /// Name of the table.
    pub table: String,
    /// Channels and settings for reading as one text: the same for tables that read the same values of a
    /// file.
    pub record: String,
}

//! Files that tables of a campaign name, and those that two tables name.

use super::{file_name, of_kinds, sweep};
use crate::analysis::Analysis;
use crate::campaign::Campaign;
use crate::error::Result;
use crate::record::Finding;
use std::collections::BTreeMap;
use std::path::PathBuf;

/// Files that a sentence names one by one.
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
    /// What the table states of the record: channels, and how the file is read.
    pub record: String,
}

impl NamedFile {
    /// Whether two tables of one file count one record twice: it is the same of the same kind, or a step of a
    /// sweep and a record of its own.
    fn is_again(&self, first: &NamedFile) -> bool {
        let steps = [first, self].map(|named| named.section == sweep::Keys::SECTION);
        steps[0] != steps[1] || self.section == first.section && self.record == first.record
    }
}

/// Tables that name files of another table, one finding for two tables.
///
/// # Errors
/// As [`super::open`].
pub(crate) fn twice(campaign: &Campaign) -> Result<Vec<Finding>> {
    let named = of_kinds(|kind| (kind.records)(campaign))?;
    let mut by_file: BTreeMap<&PathBuf, Vec<&NamedFile>> = BTreeMap::new();
    let mut pairs: BTreeMap<(&str, &str), Vec<String>> = BTreeMap::new();
    for one in &named {
        let known = by_file.entry(&one.file).or_default();
        if let Some(first) = known.iter().find(|first| one.is_again(first)) {
            pairs.entry((&first.table, &one.table)).or_default().push(file_name(&one.file));
        }
        known.push(one);
    }
    let finding = |((first, second), files): ((&str, &str), Vec<String>)| {
        let found = Finding::caution("file-named-twice").about(second).name("first", first);
        found.count("n", files.len()).name("files", few(&files))
    };
    Ok(pairs.into_iter().map(finding).collect())
}

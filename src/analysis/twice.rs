//! Files that two tables of a campaign name.

use super::kind::Analysis;
use super::kinds::of_kinds;
use super::named_file::{NamedFile, few};
use super::source::file_name;
use super::sweep;
use crate::campaign::Campaign;
use crate::error::Result;
use crate::record::Finding;
use std::collections::BTreeMap;
use std::path::PathBuf;

/// Cautions on files that two tables name, one for each two tables.
///
/// # Errors
/// As [`super::open`].
pub(crate) fn twice(campaign: &Campaign) -> Result<Vec<Finding>> {
    let named = of_kinds(|kind| (kind.records)(campaign))?;
    let mut by_file: BTreeMap<&PathBuf, Vec<&NamedFile>> = BTreeMap::new();
    let mut pairs: BTreeMap<(&str, &str), Vec<String>> = BTreeMap::new();
    for one in &named {
        let known = by_file.entry(&one.file).or_default();
        if let Some(first) = known.iter().find(|first| is_again(one, first)) {
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

/// Whether two tables of one file count one record twice. Either both have the same kind and the same
/// record, or only one of them takes the file as a step of a sweep.
fn is_again(one: &NamedFile, first: &NamedFile) -> bool {
    let steps = [first, one].map(|named| named.section == sweep::Keys::SECTION);
    steps[0] != steps[1] || one.section == first.section && one.record == first.record
}

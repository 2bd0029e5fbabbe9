//! Files that two tables of a campaign use.

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

/// Cautions on files that two tables use, one for each pair of tables.
///
/// # Errors
/// As [`super::open`].
pub(crate) fn double_use(campaign: &Campaign) -> Result<Vec<Finding>> {
    let named = of_kinds(|kind| (kind.records)(campaign))?;
    let mut by_file: BTreeMap<&PathBuf, Vec<&NamedFile>> = BTreeMap::new();
    let mut pairs: BTreeMap<(&str, &str), Vec<String>> = BTreeMap::new();
    for one in &named {
        let tables = by_file.entry(&one.file).or_default();
        if let Some(first) = tables.iter().find(|first| is_double_use(one, first)) {
            pairs.entry((&first.table, &one.table)).or_default().push(file_name(&one.file));
        }
        tables.push(one);
    }
    let finding = |((first, second), files): ((&str, &str), Vec<String>)| {
        let found = Finding::caution("file-named-twice").about(second).name("first", first);
        found.count("n", files.len()).name("files", few(&files))
    };
    Ok(pairs.into_iter().map(finding).collect())
}

/// Whether two tables use one file twice. Either both have the same kind and the same record, or one table
/// measures by itself a file that another takes as a step of a sweep.
fn is_double_use(one: &NamedFile, first: &NamedFile) -> bool {
    let is_step = [first, one].map(|named| named.section == sweep::Keys::SECTION);
    is_step[0] != is_step[1] || one.section == first.section && one.record == first.record
}

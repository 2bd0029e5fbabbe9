//! Keys of an entry that cannot be, or not together.

use super::record::Common;
use super::{Campaign, locate};
use crate::error::{Error, Result};
use std::ops::Range;

/// What is wrong with an entry.
pub(super) struct Fault {
    /// The key at whose line the complaint points; empty for the entry's own.
    pub key: &'static str,
    pub found: String,
    pub expected: String,
}

/// A fault at a key.
pub(super) fn fault(key: &'static str, found: impl Into<String>, expected: impl Into<String>) -> Fault {
    Fault { key, found: found.into(), expected: expected.into() }
}

impl Campaign {
    /// Checks impacts, drops and pulses, before anything is measured.
    pub(super) fn check_contacts(&self) -> Result<()> {
        for (i, entry) in self.impacts.iter().enumerate() {
            entry.check_keys().map_err(|f| self.point("impacts", i, &f))?;
        }
        for (i, entry) in self.drop.iter().enumerate() {
            let alone = needs_file(entry).and_then(|()| entry.check_keys());
            let earlier = self.drop.get(..i).unwrap_or_default();
            alone.and_then(|()| entry.check_series(earlier)).map_err(|f| self.point("drop", i, &f))?;
        }
        for (i, entry) in self.pulse.iter().enumerate() {
            let checked = needs_file(entry).and_then(|()| entry.check_keys());
            checked.map_err(|f| self.point("pulse", i, &f))?;
        }
        Ok(())
    }

    /// A complaint about the entry number `index` of a section.
    fn point(&self, section: &str, index: usize, fault: &Fault) -> Error {
        let line = self.entry(section, index);
        let key = Some(fault.key).filter(|k| !k.is_empty());
        let span = key.map(|k| locate::find(&self.text, k, Some(line.end))).filter(|s| !s.is_empty());
        let found = format!("[[{section}]]: {}", fault.found);
        self.at(span.unwrap_or(line), found).hint(fault.expected.as_str())
    }

    /// Where the head of the entry number `index` of a section stands; the start of the file where it is not written as a head.
    fn entry(&self, section: &str, index: usize) -> Range<usize> {
        let head = format!("[[{section}]]");
        let mut at = 0;
        let starts = self.text.split_inclusive('\n').filter_map(|line| {
            let start = at;
            at += line.len();
            let squeezed: String = line.chars().filter(|c| !c.is_whitespace()).collect();
            squeezed.starts_with(&head).then(|| start..start + line.trim_end().len())
        });
        starts.into_iter().nth(index).unwrap_or(0..0)
    }
}

/// Refuses what says how a file is read where there is none.
fn needs_file(entry: &impl Common) -> std::result::Result<(), Fault> {
    match entry.without_file() {
        Some(key) => Err(fault(key, format!("{key} without a file"), "file, too, or leave it out")),
        None => Ok(()),
    }
}

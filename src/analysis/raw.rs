//! The raw record of a table of a campaign, as its analysis reads it.

use super::recordings::matching;
use crate::campaign::{Campaign, Entry};
use crate::error::{Error, Result};
use crate::read::Recording;
use crate::record::Trace;
use std::path::PathBuf;

/// The trace of a table of records, counted from 1, read with the settings that it states; of a pattern,
/// the trace of its `file`-th file, counted from 0. Also the names of all its files.
///
/// # Errors
/// If the table names no file, the file cannot be read, or holds no trace.
pub fn raw_trace(campaign: &Campaign, table: (&str, usize), file: usize) -> Result<(Trace, Vec<PathBuf>)> {
    let (section, number) = table;
    let all = campaign.entries::<toml::Table>(section, true, &[])?;
    let no_table = || Error::usage(format!("no table {number} of [[{section}]]"), "a table with a file");
    let entry: Entry<toml::Table> = all.into_iter().nth(number.wrapping_sub(1)).ok_or_else(no_table)?.0;
    let name = entry.file.clone().ok_or_else(|| Error::usage("a table without a file", "one with a file"))?;
    let files = matching(campaign.within(), &name)?;
    let chosen = files.get(file).ok_or_else(no_table)?;
    let path = campaign.file(&entry, "file", chosen)?;
    let reader = entry.reading.reader()?.within(campaign.within()).rate_of_base_band();
    let recording: Recording = reader.from_path(path)?;
    let trace = recording.trace(entry.channel.channel.as_deref(), entry.channel.calibration)?;
    Ok((trace, files))
}

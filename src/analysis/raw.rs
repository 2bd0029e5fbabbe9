//! The raw record of a table of a campaign, as its analysis reads it, and the sounds in it.

use super::recordings::matching;
use super::{drop, impacts};
use crate::campaign::{Campaign, Entry};
use crate::error::{Error, Result};
use crate::measure::impacts::{HeardSounds, ImpactsOptions, heard};
use crate::read::Recording;
use crate::record::Trace;
use std::path::PathBuf;

/// The trace of a table of records, counted from 1, read with the settings that it states; of a pattern,
/// the trace of its `file`-th file, counted from 0. Also the names of all its files.
///
/// # Errors
/// If the table names no file, the file cannot be read, or holds no trace.
pub fn raw_trace(campaign: &Campaign, table: (&str, usize), file: usize) -> Result<(Trace, Vec<PathBuf>)> {
    let no_table = || no_table(table);
    let entry = entry(campaign, table)?;
    let name = entry.file.clone().ok_or_else(|| Error::usage("a table without a file", "one with a file"))?;
    let files = matching(campaign.within(), &name)?;
    let chosen = files.get(file).ok_or_else(no_table)?;
    let path = campaign.file(&entry, "file", chosen)?;
    let reader = entry.reading.reader()?.within(campaign.within()).rate_of_base_band();
    let recording: Recording = reader.from_path(path)?;
    // The record of a drill is its velocity.
    let velocity = entry.keys.get("velocity").and_then(toml::Value::as_str);
    let trace = recording.trace(entry.channel.channel.as_deref().or(velocity), entry.channel.calibration)?;
    Ok((trace, files))
}

/// The sounds of such a trace, among which the analysis of the table chooses its impacts; `None` for a kind
/// without impacts, and where a band or an envelope is searched, whose levels are not those of the trace.
///
/// # Errors
/// As [`raw_trace`] and [`heard`].
pub fn raw_sounds(campaign: &Campaign, table: (&str, usize), file: usize) -> Result<Option<HeardSounds>> {
    let keys = entry(campaign, table)?.keys;
    let options = match table.0 {
        "impacts" => keys.try_into().ok().map(|keys: impacts::Keys| ImpactsOptions {
            band: keys.band,
            envelope: keys.envelope,
            keep_hum: keys.keep_hum,
            ..ImpactsOptions::default()
        }),
        "drop" => keys
            .try_into()
            .ok()
            .map(|keys: drop::Keys| ImpactsOptions { keep_hum: keys.keep_hum, ..ImpactsOptions::default() }),
        _ => None,
    };
    let Some(options) = options.filter(|options| options.band.is_none() && !options.envelope) else {
        return Ok(None);
    };
    let (trace, _) = raw_trace(campaign, table, file)?;
    heard(&trace, &options, table.0 == "drop").map(Some)
}

/// The table of this number, from 1.
fn entry(campaign: &Campaign, (section, number): (&str, usize)) -> Result<Entry<toml::Table>> {
    let all = campaign.entries::<toml::Table>(section, true, &[])?;
    let chosen = all.into_iter().nth(number.wrapping_sub(1));
    Ok(chosen.ok_or_else(|| no_table((section, number)))?.0)
}

fn no_table((section, number): (&str, usize)) -> Error {
    Error::usage(format!("no table {number} of [[{section}]]"), "a table with a file")
}

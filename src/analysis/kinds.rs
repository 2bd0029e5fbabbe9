//! The kinds of analysis, one for each section of a campaign file, and what applies each of them to all of
//! its tables. A table is one `[[section]]` entry.

use super::answer::{LEFT_OUT, left_out};
use super::entries::{check, entries};
use super::job::Job;
#[cfg(feature = "cli")]
use super::kind::FileCommand;
use super::kind::{Analysis, AnalysisKind, name_of};
use super::named_file::NamedFile;
use crate::campaign::{Campaign, Entry, Fault, KeyRange};
use crate::error::{Error, Result};
use crate::read::{Folder, plain};
use crate::record::{find_channel, shown};
#[cfg(feature = "cli")]
use crate::report::files::Names;
use std::path::{Path, PathBuf};

/// All kinds of analysis, in the order in which they are measured and shown.
pub(crate) const KINDS: &[AnalysisKind] = &[
    row::<super::sweep::Keys>(),
    row::<super::spectrum::Keys>(),
    row::<super::frf::Keys>(),
    row::<super::drill::Keys>(),
    row::<super::impacts::Keys>(),
    row::<super::drop::Keys>(),
    row::<super::decay::Keys>(),
    row::<super::pulse::Keys>(),
];

/// Names of the sections of a campaign, in the order in which they are measured and shown.
pub fn sections() -> impl Iterator<Item = &'static str> {
    KINDS.iter().map(|kind| kind.section)
}

/// What the tables of a section give, in words: `Restitution` for `drop`.
pub fn title(section: &str) -> Option<&'static str> {
    KINDS.iter().find(|kind| kind.section == section).map(|kind| kind.title)
}

/// Ranges of the numbers of keys, of all kinds.
#[cfg(any(feature = "cli", test))]
pub(crate) fn key_ranges() -> impl Iterator<Item = &'static KeyRange> {
    KINDS.iter().flat_map(|kind| kind.ranges)
}

/// Commands that measure the record of one file, with the names of the files that each writes.
#[cfg(feature = "cli")]
pub(crate) fn commands() -> impl Iterator<Item = (FileCommand, Names)> {
    KINDS.iter().filter_map(|kind| Some((kind.command?, kind.names)))
}

/// Reads a campaign and checks all its tables. A table with an impossible value is left out: see
/// [`Campaign::faults`].
///
/// # Errors
/// If it is not TOML, has an unknown key, or an impossible value outside the tables of records; each error
/// points at its line.
pub fn open(path: impl AsRef<Path>) -> Result<Campaign> {
    open_in(&Folder::default(), path.as_ref())
}

/// As [`open`], from a disk or from memory. File names may lead outside the folder of the campaign where
/// `within` allows it.
///
/// # Errors
/// As [`open`].
pub fn open_in(within: &Folder, path: &Path) -> Result<Campaign> {
    checked(Campaign::from_path(within, path, &sections().collect::<Vec<_>>())?)
}

/// Checks the text of a campaign and all its records, as if it were in a file.
///
/// # Errors
/// As [`open`].
pub fn parse(within: &Folder, path: &Path, text: String) -> Result<Campaign> {
    checked(Campaign::parse(within, path, text, &sections().collect::<Vec<_>>())?)
}

/// The campaign without the tables that have impossible values.
fn checked(campaign: Campaign) -> Result<Campaign> {
    let faults = faults(&campaign)?;
    Ok(campaign.without(faults))
}

/// Tables of a campaign with impossible values.
pub(super) fn faults(campaign: &Campaign) -> Result<Vec<Fault>> {
    of_kinds(|kind| (kind.check)(campaign))
}

/// All errors in the tables of a campaign: impossible values, missing or unreadable files, channels that a
/// file does not have.
///
/// # Errors
/// As [`open`].
pub fn errors(campaign: &Campaign) -> Result<Vec<Error>> {
    let of_tables = faults(campaign)?.into_iter().map(|fault| fault.error);
    Ok(of_tables.chain(of_kinds(|kind| (kind.channels)(campaign))?).collect())
}

/// The recordings that the tables of a campaign name. A table is skipped if one of its files is outside the
/// folder or does not exist.
///
/// # Errors
/// As [`open`].
pub fn files(campaign: &Campaign) -> Result<Vec<PathBuf>> {
    of_kinds(|kind| (kind.files)(campaign))
}

/// Joins the lists of all kinds of records.
pub(crate) fn of_kinds<T>(each: impl Fn(&AnalysisKind) -> Result<Vec<T>>) -> Result<Vec<T>> {
    Ok(KINDS.iter().map(each).collect::<Result<Vec<_>>>()?.into_iter().flatten().collect())
}

/// Entry of [`KINDS`] for one analysis.
const fn row<A: Analysis>() -> AnalysisKind {
    AnalysisKind {
        section: A::SECTION,
        title: A::TITLE,
        names: A::FILES,
        ranges: A::RANGES,
        #[cfg(feature = "cli")]
        command: A::COMMAND,
        check: check::<A>,
        files: files_of::<A>,
        channels: channel_errors::<A>,
        records: records_of::<A>,
        run: run_all::<A>,
    }
}

/// Errors about the channels that the tables of a kind name.
fn channel_errors<A: Analysis>(campaign: &Campaign) -> Result<Vec<Error>> {
    Ok(entries::<A>(campaign)?.iter().filter_map(|entry| channels_in(campaign, entry).err()).collect())
}

/// Checks that the file of a table has the channels that the table names.
fn channels_in<A: Analysis>(campaign: &Campaign, entry: &Entry<A>) -> Result<()> {
    let files = A::files(campaign, entry)?;
    let named = entry.channel.channel.iter().map(|name| ("channel", name));
    let named: Vec<_> = named.chain(entry.keys.channels()).collect();
    let Some(path) = files.first().filter(|_| entry.file.is_some() || !named.is_empty()) else {
        return Ok(());
    };
    let surveyed = entry.reading.reader()?.within(campaign.within()).survey(path);
    // An error in a line of the file points there; otherwise the table is at fault.
    let at = |error: Error| if error.line().is_some() { error } else { campaign.fault(entry, error) };
    let (_, headers, _) = surveyed.map_err(at)?;
    // Traces with a constant step but no sampling rate: the error asks for the rate.
    if headers.iter().all(|h| h.kind == "trace" && h.rate.is_none() && h.dx.is_some()) {
        let error = Error::usage(format!("{} has no sampling rate", shown(path)), "rate = HZ");
        return Err(campaign.fault(entry, error.setting("rate").setting("file")));
    }
    let names = headers.iter().map(|h| (h.name.as_str(), h.quantity));
    named.into_iter().try_for_each(|(key, name)| {
        find_channel(path, name, names.clone()).map(drop).map_err(|e| campaign.fault(entry, e.setting(key)))
    })
}

/// The recordings that the tables of a kind name.
fn files_of<A: Analysis>(campaign: &Campaign) -> Result<Vec<PathBuf>> {
    // A table with missing files reports that itself.
    let files = entries::<A>(campaign)?.into_iter().filter_map(|entry| A::files(campaign, &entry).ok());
    Ok(files.flatten().collect())
}

/// The files that the tables of a kind name, each with a key of its channels and reading options: equal
/// keys mean the same data.
fn records_of<A: Analysis>(campaign: &Campaign) -> Result<Vec<NamedFile>> {
    let mut all = Vec::new();
    for entry in &entries::<A>(campaign)? {
        let files: Vec<PathBuf> = match &entry.file {
            Some(file) => vec![campaign.folder().join(file)],
            None if A::OF_FILES => Vec::new(),
            None => A::measured(campaign, entry).unwrap_or_default(),
        };
        let (channel, others) = (&entry.channel.channel, entry.keys.channels());
        let record = format!("{channel:?} {others:?} {:?}", entry.reading.stated());
        let (section, table) = (A::SECTION, name_of(entry));
        let named = |file: PathBuf| NamedFile {
            file: plain(&file),
            section,
            table: table.clone(),
            record: record.clone(),
        };
        all.extend(files.into_iter().map(named));
    }
    Ok(all)
}

/// Runs the analysis of all tables of a kind; tables with a fault give findings.
fn run_all<A: Analysis>(job: &mut Job<'_>) -> Result<()> {
    for fault in job.campaign.faults().iter().filter(|fault| fault.section == A::SECTION) {
        job.found.add(&fault.name, [left_out(LEFT_OUT, &fault.error)]);
    }
    let entries = entries::<A>(job.campaign)?;
    if A::TOGETHER && !entries.is_empty() {
        // One answer for all tables together.
        return job.together(A::SECTION, |job| A::run(&entries, job));
    }
    A::run(&entries, job)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::campaign::{KeyMeaning, SHARED};

    #[test]
    fn every_key_stands_once_and_lets_in_no_value_that_is_no_number() {
        let keys: Vec<&str> = key_ranges().chain(SHARED).flat_map(|range| range.keys).copied().collect();
        for (i, key) in keys.iter().enumerate() {
            assert!(!keys[..i].contains(key), "{key} stands twice");
            for value in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1e-300, -1e300] {
                let range = KeyRange::of(key, key_ranges()).expect("a range");
                let said = range.check(key, value).unwrap_err().to_string();
                assert!(said.starts_with(&format!("{key} is ")) && said.contains("expected "), "{said}");
            }
        }
        let lets_in =
            |key, value| KeyRange::of(key, key_ranges()).expect("a range").check(key, value).is_ok();
        assert!(lets_in("band", 0.0) && lets_in("delay", -1e-3));
        assert!(!lets_in("band", 1e51) && !lets_in("mass", 0.0) && !lets_in("overlap", 1.5));
    }

    /// Other spellings of `fit`, `beam_from` and `noise`.
    const SPELT_OTHERWISE: [&str; 3] = ["fit_duration", "from", "noise_record"];

    /// The keys that a section takes are those that the error about an unknown key lists.
    #[test]
    fn each_key_of_each_section_has_a_meaning_and_no_other_has() {
        for section in sections() {
            let text = format!("[[{section}]]\nname = \"a\"\nno_such_key = 1\n");
            let error = parse(&Folder::default(), Path::new("campaign.toml"), text).unwrap_err();
            let listed = error.to_string();
            let (_, listed) = listed.split_once("keys known here: ").expect("a list of keys");
            let mut known: Vec<&str> =
                listed.lines().next().unwrap_or_default().split(", ").map(str::trim).collect();
            known.retain(|key| {
                !SPELT_OTHERWISE.contains(key) && !KeyMeaning::REFUSED.contains(&(section, key))
            });
            let mut described: Vec<&str> = KeyMeaning::of(section).map(|one| one.key).collect();
            known.sort_unstable();
            described.sort_unstable();
            assert_eq!(described, known, "docs/campaign.md, [[{section}]]");
            for one in KeyMeaning::of(section) {
                assert!(!one.meaning.is_empty() && !one.left_out.is_empty(), "{one:?}");
                let unit = KeyRange::of(one.key, key_ranges()).map_or("", KeyRange::unit);
                // The mass of a sweep is a number, 1 or 2.
                let is_number = (section, one.key) == ("sweep", "mass");
                assert!(is_number || unit.is_empty() || unit == one.unit, "{one:?}: numbers in {unit}");
            }
        }
    }
}

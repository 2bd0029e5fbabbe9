//! Analyses, one folder a kind of record: its keys, its run, its figures, its tables.
//!
//! A table of a campaign and a command line fill the same keys: `[[impacts]] refractory = 0.005` and `vibro
//! impacts --refractory 0.005` run one function. A new kind of record is a folder here and a row in `KINDS`.

pub(crate) mod answer;
pub(crate) mod decay;
pub(crate) mod drill;
pub(crate) mod drop;
pub(crate) mod evidence;
pub(crate) mod frf;
pub(crate) mod impacts;
mod inputs;
pub(crate) mod job;
mod kept;
pub(crate) mod model;
mod named;
pub(crate) mod precision;
pub(crate) mod pulse;
mod recordings;
pub(crate) mod source;
pub(crate) mod spectrum;
pub(crate) mod sweep;
pub(crate) mod tone;

pub(crate) mod headline;
mod page;

pub use answer::Answer;
pub use evidence::Evidence;
pub use job::{CampaignOutcome, INPUTS, Progress, REPORT, RESULTS, answers, run};
pub use kept::AnswerCache;
pub(crate) use recordings::{OWN, Recordings, in_order, is_pattern, matching, recordings, unnamed};
pub use sweep::modelled::fit;
pub use sweep::{named, responses};

pub(crate) use job::Job;
pub(crate) use named::{NamedFile, few, twice};
pub(crate) use source::{Source, file_name, name_of};

/// Figures of results, as data.
pub mod figures {
    pub use super::decay::figures::decay;
    pub use super::drill::figures::drill;
    pub use super::frf::figures::frf;
    pub use super::impacts::figures::{drop, drops, impacts};
    pub use super::model::figures::{
        branches, forces, ladder, orbit, phase_plane, poincare, regimes, sweep, traces,
    };
    pub use super::pulse::figures::pulse;
    pub use super::spectrum::figures::lines;
    pub use super::sweep::figures::{fit, map, overlay, receptance, response, waterfall};
}

use crate::campaign::{Campaign, Entry, Fault};
use crate::error::{Error, Result};
use crate::read::{Folder, plain};
use crate::record::{find_channel, shown};
use crate::report::files::Names;
use serde::de::DeserializeOwned;
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

/// The keys of a kind of record.
pub(crate) trait Analysis: Clone + DeserializeOwned {
    /// Its section of a campaign: `impacts` for `[[impacts]]`.
    const SECTION: &'static str;
    /// Its heading in the report.
    const TITLE: &'static str;
    /// Whether records lie in files: their tables then have the keys of how a file is read.
    const OF_FILES: bool = true;

    /// Names of the files that it writes.
    const FILES: Names;

    /// Whether its tables are answered together, not each by itself.
    const TOGETHER: bool = false;
    /// Other sections that tables without a file name.
    const RESTS_ON: &'static [&'static str] = &[];

    /// Whether a table can be, after those before it and before anything is measured. An error names the key
    /// at fault as its setting.
    ///
    /// # Errors
    /// If keys contradict each other, are impossible, or one is missing.
    fn check(entry: &Entry<Self>, earlier: &[Entry<Self>]) -> Result<()>;

    /// The name that a table states.
    fn stated_name(entry: &Entry<Self>) -> Option<String> {
        entry.name.clone()
    }

    /// Keys that name files beside that of the record.
    fn beside(&self) -> Option<(&'static str, &PathBuf)> {
        None
    }

    /// Keys that name channels of its first file beside `channel`.
    fn channels(&self) -> Vec<(&'static str, &String)> {
        Vec::new()
    }

    /// The files of a table.
    ///
    /// # Errors
    /// If one leads outside the folder or does not exist.
    fn files(campaign: &Campaign, entry: &Entry<Self>) -> Result<Vec<PathBuf>> {
        named_in(campaign, entry)
    }

    /// Those of its files that hold what it measures: a force may be that of several records.
    ///
    /// # Errors
    /// As [`Analysis::files`].
    fn measured(campaign: &Campaign, entry: &Entry<Self>) -> Result<Vec<PathBuf>> {
        Self::files(campaign, entry)
    }

    /// Measures the records of all tables.
    ///
    /// # Errors
    /// If a file cannot be read. A record that allows no answer is left out.
    fn run(entries: &[Entry<Self>], job: &mut Job<'_>) -> Result<()>;
}

/// Keys of a kind of record that lies alone in a file.
pub(crate) trait OfFile {
    /// Measures the record.
    ///
    /// # Errors
    /// If the file cannot be read, or its record allows no answer.
    fn measure(&self, source: &Source<'_>) -> Result<Answer>;
}

/// A row of the table of kinds.
#[derive(Clone, Copy)]
pub(crate) struct AnalysisKind {
    section: &'static str,
    title: &'static str,
    names: Names,
    check: fn(&Campaign) -> Result<Vec<Fault>>,
    files: fn(&Campaign) -> Result<Vec<PathBuf>>,
    channels: fn(&Campaign) -> Result<Vec<Error>>,
    records: fn(&Campaign) -> Result<Vec<NamedFile>>,
    run: fn(&mut Job<'_>) -> Result<()>,
}

impl AnalysisKind {
    const fn of<A: Analysis>() -> AnalysisKind {
        AnalysisKind {
            section: A::SECTION,
            title: A::TITLE,
            names: A::FILES,
            check: check::<A>,
            files: files_of::<A>,
            channels: channels_of::<A>,
            records: records_of::<A>,
            run: run_all::<A>,
        }
    }
}

/// All kinds of records, in the order in which they are measured and shown.
pub(crate) const KINDS: &[AnalysisKind] = &[
    AnalysisKind::of::<sweep::Keys>(),
    AnalysisKind::of::<spectrum::Keys>(),
    AnalysisKind::of::<frf::Keys>(),
    AnalysisKind::of::<drill::Keys>(),
    AnalysisKind::of::<impacts::Keys>(),
    AnalysisKind::of::<drop::Keys>(),
    AnalysisKind::of::<decay::Keys>(),
    AnalysisKind::of::<pulse::Keys>(),
];

/// Names of the sections of a campaign, in the order in which they are measured and shown.
pub(crate) fn sections() -> impl Iterator<Item = &'static str> {
    KINDS.iter().map(|kind| kind.section)
}

/// Reads a campaign and checks all its records. A table with a value that cannot be is left out:
/// [`Campaign::faults`].
///
/// # Errors
/// If it is not TOML, has an unknown key, or a value that cannot be outside of the tables of records; each
/// points at its line.
pub fn open(path: impl AsRef<Path>) -> Result<Campaign> {
    open_in(&Folder::default(), path.as_ref())
}

/// As [`open`], of a disk or a memory; names may lead outside the folder of the campaign where `within`
/// allows it.
///
/// # Errors
/// As [`open`].
pub fn open_in(within: &Folder, path: &Path) -> Result<Campaign> {
    checked(Campaign::from_path(within, path, &sections().collect::<Vec<_>>())?)
}

/// Checks the text of a campaign and all its records, as if it stood in a file.
///
/// # Errors
/// As [`open`].
pub fn parse(within: &Folder, path: &Path, text: String) -> Result<Campaign> {
    checked(Campaign::parse(within, path, text, &sections().collect::<Vec<_>>())?)
}

fn checked(campaign: Campaign) -> Result<Campaign> {
    let faults = faults(&campaign)?;
    Ok(campaign.without(faults))
}

/// The tables of a campaign that cannot be.
fn faults(campaign: &Campaign) -> Result<Vec<Fault>> {
    of_kinds(|kind| (kind.check)(campaign))
}

/// All that is wrong with the tables of a campaign: values that cannot be, files that do not exist or cannot
/// be read, channels that a file does not have.
///
/// # Errors
/// As [`open`].
pub fn errors(campaign: &Campaign) -> Result<Vec<Error>> {
    let of_tables = faults(campaign)?.into_iter().map(|fault| fault.error);
    Ok(of_tables.chain(of_kinds(|kind| (kind.channels)(campaign))?).collect())
}

/// The recordings that the tables of a campaign name, but for those of a table that names one that is outside
/// its folder or does not exist.
///
/// # Errors
/// As [`open`].
pub fn files(campaign: &Campaign) -> Result<Vec<PathBuf>> {
    of_kinds(|kind| (kind.files)(campaign))
}

/// What all kinds of records have, one behind the other.
pub(crate) fn of_kinds<T>(each: impl Fn(&AnalysisKind) -> Result<Vec<T>>) -> Result<Vec<T>> {
    Ok(KINDS.iter().map(each).collect::<Result<Vec<_>>>()?.into_iter().flatten().collect())
}

/// The tables of a kind of record as they are written, one of each file that a pattern matches, with what is
/// wrong with the table.
fn written<A: Analysis>(campaign: &Campaign) -> Result<Vec<(Entry<A>, Result<()>)>> {
    let folder = campaign.within();
    let each = |(entry, checked): (Entry<A>, Result<()>)| {
        let pattern = entry.file.clone().filter(|file| checked.is_ok() && is_pattern(folder, file));
        let Some(pattern) = pattern else { return vec![(entry, checked)] };
        let files = match matching(folder, &pattern) {
            Ok(files) => files,
            Err(error) => {
                let error = campaign.fault(&entry, error.setting("file"));
                return vec![(entry, Err(error))];
            }
        };
        let one = |file: PathBuf| {
            let own = |name: &String| {
                if A::TOGETHER { name.clone() } else { format!("{name}, {}", shown(&file)) }
            };
            let mut one = entry.clone();
            one.name = entry.name.as_ref().map(own);
            one.file = Some(file);
            (one, Ok(()))
        };
        files.into_iter().map(one).collect()
    };
    Ok(campaign.entries(A::SECTION, A::OF_FILES)?.into_iter().flat_map(each).collect())
}

/// The tables of a kind of record that can be; one whose file is a pattern stands for one of each file that
/// it matches.
///
/// # Errors
/// As [`Campaign::entries`].
pub(crate) fn entries<A: Analysis>(campaign: &Campaign) -> Result<Vec<Entry<A>>> {
    let faults: BTreeSet<_> = campaign.faults().iter().map(|fault| &fault.place).collect();
    let all = written::<A>(campaign)?.into_iter().map(|(entry, _)| entry);
    Ok(all.filter(|entry| !faults.contains(&entry.place())).collect())
}

/// As [`entries`], where none may be left out.
///
/// # Errors
/// That of the first table that cannot be.
pub(crate) fn all_entries<A: Analysis>(campaign: &Campaign) -> Result<Vec<Entry<A>>> {
    check::<A>(campaign)?.into_iter().next().map_or(Ok(()), |fault| Err(fault.error))?;
    entries(campaign)
}

fn check<A: Analysis>(campaign: &Campaign) -> Result<Vec<Fault>> {
    let (mut usable, mut faults): (Vec<Entry<A>>, Vec<Fault>) = (Vec::new(), Vec::new());
    for (entry, checked) in written::<A>(campaign)? {
        let reads = entry.reads().filter(|_| A::OF_FILES && entry.file.is_none());
        let without =
            |key| Error::usage(format!("{key} without a file"), "file, too, or leave it out").setting(key);
        let checked = checked.and_then(|()| match reads {
            Some(key) => Err(campaign.fault(&entry, without(key))),
            None => (entry.reading.reader().and_then(|_| A::check(&entry, &usable)))
                .map_err(|e| campaign.fault(&entry, e)),
        });
        match checked {
            Ok(()) => usable.push(entry),
            Err(error) => {
                let (section, name, place) = (A::SECTION, name_of(&entry), entry.place());
                faults.push(Fault { section, name, place, error });
            }
        }
    }
    Ok(faults)
}

fn channels_of<A: Analysis>(campaign: &Campaign) -> Result<Vec<Error>> {
    Ok(entries::<A>(campaign)?.iter().filter_map(|entry| channels_in(campaign, entry).err()).collect())
}

/// Looks for the channels that a table names in its file.
fn channels_in<A: Analysis>(campaign: &Campaign, entry: &Entry<A>) -> Result<()> {
    let files = A::files(campaign, entry)?;
    let named = entry.channel.channel.iter().map(|name| ("channel", name));
    let named: Vec<_> = named.chain(entry.keys.channels()).collect();
    let Some(path) = files.first().filter(|_| entry.file.is_some() || !named.is_empty()) else {
        return Ok(());
    };
    let surveyed = entry.reading.reader()?.within(campaign.within()).survey(path);
    // What is wrong in a line of the file is said of that line; what is stated is at fault otherwise.
    let at = |error: Error| if error.line().is_some() { error } else { campaign.fault(entry, error) };
    let (_, headers, _) = surveyed.map_err(at)?;
    // Values that are numbered, as a step without a rate shows.
    if headers.iter().all(|h| h.kind == "trace" && h.rate.is_none() && h.dx.is_some()) {
        let error = Error::usage(format!("{} has no sampling rate", shown(path)), "rate = HZ");
        return Err(campaign.fault(entry, error.setting("rate").setting("file")));
    }
    let names = headers.iter().map(|h| (h.name.as_str(), h.quantity));
    named.into_iter().try_for_each(|(key, name)| {
        find_channel(path, name, names.clone()).map(drop).map_err(|e| campaign.fault(entry, e.setting(key)))
    })
}

fn files_of<A: Analysis>(campaign: &Campaign) -> Result<Vec<PathBuf>> {
    // A table whose files are not there says so itself.
    let files = entries::<A>(campaign)?.into_iter().filter_map(|entry| A::files(campaign, &entry).ok());
    Ok(files.flatten().collect())
}

fn records_of<A: Analysis>(campaign: &Campaign) -> Result<Vec<NamedFile>> {
    let mut all = Vec::new();
    for entry in &entries::<A>(campaign)? {
        let files: Vec<PathBuf> = match &entry.file {
            Some(file) => vec![campaign.folder().join(file)],
            None if A::OF_FILES => Vec::new(),
            None => A::measured(campaign, entry).unwrap_or_default(),
        };
        let (own, also) = (&entry.channel.channel, entry.keys.channels());
        let record = format!("{own:?} {also:?} {:?}", entry.reading.stated());
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

fn run_all<A: Analysis>(job: &mut Job<'_>) -> Result<()> {
    for fault in job.campaign.faults().iter().filter(|fault| fault.section == A::SECTION) {
        job.found.add(&fault.name, [answer::left_out("left-out", &fault.error)]);
    }
    let entries = entries::<A>(job.campaign)?;
    if A::TOGETHER && !entries.is_empty() {
        return job.together(A::SECTION, |job| A::run(&entries, job));
    }
    A::run(&entries, job)
}

/// The file of a table, and those beside it.
fn named_in<A: Analysis>(campaign: &Campaign, entry: &Entry<A>) -> Result<Vec<PathBuf>> {
    let own = entry.file.as_ref().map(|file| ("file", file));
    let all = own.into_iter().chain(entry.keys.beside());
    all.map(|(key, file)| campaign.file(entry, key, file)).collect()
}

/// The error of a table that must name a file.
fn no_file() -> Error {
    Error::usage("the key file is missing", "").hint("add file = …")
}

#[cfg(test)]
mod tests;

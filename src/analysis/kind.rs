//! A kind of record: its keys and its analysis.

use super::answer::Answer;
use super::job::Job;
use super::named_file::NamedFile;
use super::source::{Source, file_name};
use crate::campaign::{Campaign, Entry, Fault, KeyRange};
use crate::error::{Error, Result};
use crate::report::files::Names;
use serde::de::DeserializeOwned;
use std::path::PathBuf;

/// Keys of a kind of record, with its analysis.
pub(crate) trait Analysis: Clone + DeserializeOwned {
    /// Section of a campaign: `impacts` for `[[impacts]]`.
    const SECTION: &'static str;
    /// Heading in the report.
    const TITLE: &'static str;
    /// Whether each record is in a file of its table, which then also has the keys for reading a file.
    const OF_FILES: bool = true;

    /// Names of the files that the analysis writes.
    const FILES: Names;

    /// Whether all tables together give one answer, instead of one each.
    const TOGETHER: bool = false;
    /// Other sections that a table without a file may refer to by name.
    const RESTS_ON: &'static [&'static str] = &[];

    /// Ranges of the numbers of keys that no other kind has.
    const RANGES: &'static [KeyRange] = &[];

    /// The command that measures the record of one file. `None` where the command line has one of its own,
    /// which takes more than that.
    #[cfg(feature = "cli")]
    const COMMAND: Option<FileCommand> = None;

    /// Checks a table before anything is measured, given the tables before it. The error names the key at
    /// fault as its setting.
    ///
    /// # Errors
    /// If keys contradict each other, are impossible, or one is missing.
    fn check(entry: &Entry<Self>, earlier: &[Entry<Self>]) -> Result<()>;

    /// The name that a table states.
    fn stated_name(entry: &Entry<Self>) -> Option<String> {
        entry.name.clone()
    }

    /// A key that names another file beside that of the record.
    fn beside(&self) -> Option<(&'static str, &PathBuf)> {
        None
    }

    /// Keys besides `channel` that name channels of the first file.
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

    /// Files of a table that hold what is measured, without force files: several records may share these.
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

/// A command on the record of one file: what is typed, and how its options become keys.
#[cfg(feature = "cli")]
#[derive(Clone, Copy)]
pub(crate) struct FileCommand {
    /// Example of what is typed after `vibro`; its first word is the name of the command.
    pub(crate) example: &'static str,
    pub(crate) about: &'static str,
    /// Adds the options of the keys to a command.
    pub(crate) options: fn(clap::Command) -> clap::Command,
    /// The keys of typed options.
    pub(crate) keys: fn(&clap::ArgMatches) -> std::result::Result<Box<dyn OfFile>, clap::Error>,
}

#[cfg(feature = "cli")]
impl FileCommand {
    pub(super) const fn of<K: clap::Args + OfFile + 'static>(
        example: &'static str,
        about: &'static str,
    ) -> FileCommand {
        FileCommand {
            example,
            about,
            options: K::augment_args,
            keys: |typed| Ok(Box::new(K::from_arg_matches(typed)?)),
        }
    }
}

/// A row of the table of kinds: names and functions of one kind.
#[derive(Clone, Copy)]
pub(crate) struct AnalysisKind {
    pub(super) section: &'static str,
    pub(super) title: &'static str,
    pub(super) names: Names,
    pub(super) ranges: &'static [KeyRange],
    #[cfg(feature = "cli")]
    pub(super) command: Option<FileCommand>,
    pub(super) check: fn(&Campaign) -> Result<Vec<Fault>>,
    pub(super) files: fn(&Campaign) -> Result<Vec<PathBuf>>,
    pub(super) channels: fn(&Campaign) -> Result<Vec<Error>>,
    pub(super) records: fn(&Campaign) -> Result<Vec<NamedFile>>,
    pub(super) run: fn(&mut Job<'_>) -> Result<()>,
}

/// Name of a table for people: the stated name, else that of its file, else its section with its number.
pub(crate) fn name_of<K: Analysis>(entry: &Entry<K>) -> String {
    let name = K::stated_name(entry).or_else(|| entry.file.as_deref().map(file_name));
    name.unwrap_or_else(|| format!("{} {}", K::SECTION, entry.number))
}

/// The file of a table, and other files that it names.
pub(super) fn named_in<A: Analysis>(campaign: &Campaign, entry: &Entry<A>) -> Result<Vec<PathBuf>> {
    let record = entry.file.as_ref().map(|file| ("file", file));
    let all = record.into_iter().chain(entry.keys.beside());
    all.map(|(key, file)| campaign.file(entry, key, file)).collect()
}

/// The error of a table that must name a file.
pub(super) fn no_file() -> Error {
    Error::usage("the key file is missing", "").hint("add file = …")
}

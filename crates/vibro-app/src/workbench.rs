//! The files of a page, its campaign, and its results, all in memory.

use crate::archive::{LeftOut, packed, unpacked};
use crate::{Picture, Reply, Request, SeenRecording, SeenTable, words};
use serde_json::{Value, json};
use std::path::{Path, PathBuf};
use vibroimpact::analysis::{self, AnswerCache, Progress};
use vibroimpact::campaign::{Campaign, Reading, WrittenTable};
use vibroimpact::error::{Error, Result};
use vibroimpact::proposal::Proposal;
use vibroimpact::read::{Folder, Manifest, Owner, Reader};
use vibroimpact::record::Severity;
use vibroimpact::report::words::{About, Voice, sentence};
use vibroimpact::report::{Cell, Output, Table};

/// Files that a person gave, the campaign for them, and the results of its last run.
#[derive(Debug)]
pub struct Workbench {
    folder: Folder,
    /// What was proposed for files that came without a campaign, and for those that were added.
    proposals: Vec<Proposal>,
    text: String,
    /// What was computed for the proposal: the first run needs most of it.
    tried: Option<AnswerCache>,
    /// Folder and names of the results.
    results: (PathBuf, Vec<String>),
    /// Files of archives that were left out, with the reason.
    left: LeftOut,
}

impl Default for Workbench {
    fn default() -> Workbench {
        Workbench::named("")
    }
}

/// Levels of folders that an archive has at most.
const DEEPEST: usize = 64;

/// Columns of the small picture of a record.
const COLUMNS: usize = 160;

/// First line of a campaign that the page proposes.
const HEAD: &str =
    "# Proposed by vibro.html from the files. Check what is guessed, fill in what is missing.\n";

/// The error of a number that no table has.
fn no_table() -> Error {
    Error::usage("no such table", "one of the list")
}

/// An error as the page shows it.
pub(crate) fn problem(error: &Error) -> Value {
    json!({ "text": words::error(error), "line": error.line() })
}

impl Workbench {
    /// An empty one for a folder of this name.
    pub fn named(name: &str) -> Workbench {
        let folder = Folder::memory(name, <[(&str, Vec<u8>); 0]>::default());
        let (text, results, left) = (String::new(), (PathBuf::new(), Vec::new()), Vec::new());
        Workbench { folder, proposals: Vec::new(), text, tried: None, results, left }
    }

    /// Adds a file by its name in the folder, in place of one of the same name.
    ///
    /// # Errors
    /// If the name leads outside the folder.
    pub fn add(&mut self, name: &str, bytes: Vec<u8>) -> Result<()> {
        self.folder.hold(Path::new(name), bytes)
    }

    /// Answers a request of the page.
    ///
    /// # Errors
    /// If there is no answer; the error is for people.
    pub fn answer(&mut self, request: &Request, progress: &dyn Progress) -> Result<Reply> {
        Ok(Reply::Json(match request {
            Request::Example { name } => self.example(name)?,
            Request::Unpack { path } => self.unpack(path)?,
            Request::Look => self.look(progress)?,
            Request::Propose { known } => self.propose(known.as_deref(), progress)?,
            Request::Edit { text } => {
                text.clone_into(&mut self.text);
                self.state()
            }
            Request::State { table, key, value, also } => {
                self.set(*table, (key, value), also)?;
                self.state()
            }
            Request::Kind { table, section } => {
                self.change_kind(*table, section)?;
                self.state()
            }
            Request::Run => self.run(progress)?,
            Request::Try { table, key, value } => self.tried_with(*table, (key, value), progress)?,
            Request::Pictures { path } => self.pictures(path)?,
            Request::Trace { table, file, from, to, columns } => {
                self.trace(*table, *file, (*from, *to), *columns)?
            }
            Request::Sounds { table, file } => self.sounds(*table, *file)?,
            Request::File { name } => return Ok(Reply::Bytes(self.file(name)?)),
            Request::Archive => return Ok(Reply::Bytes(self.archive()?)),
        }))
    }

    fn example(&mut self, name: &str) -> Result<Value> {
        let demo = vibro_demo::DEMOS.iter().find(|demo| demo.name == name);
        let demo = demo.ok_or_else(|| Error::usage(format!("no example {name:?}"), "one that there is"))?;
        *self = Workbench::named(name);
        demo.make(&mut |name, bytes| self.add(name, bytes.to_vec()))?;
        Ok(json!({}))
    }

    fn unpack(&mut self, path: &str) -> Result<Value> {
        let file = self.folder.path(Path::new(path))?;
        let bytes = self.folder.read(&file)?;
        self.folder.remove(&file)?;
        let (members, left) = unpacked(Path::new(path), bytes)?;
        let beside = Path::new(path).parent().unwrap_or(Path::new(""));
        // An archive of one folder has the files of that folder.
        let top = common_folder(members.iter().map(|(name, _)| name.as_str()));
        for (name, bytes) in members {
            let name = beside.join(name.strip_prefix(&top).unwrap_or(&name));
            self.folder.hold(&name, bytes)?;
        }
        self.left.extend(left);
        Ok(json!({}))
    }

    /// Path of the campaign.
    fn path(&self) -> PathBuf {
        self.folder.root().join(Proposal::FILE)
    }

    fn campaign(&self) -> Result<Campaign> {
        analysis::parse(&self.folder, &self.path(), self.text.clone())
    }

    /// Lists the files.
    fn look(&self, progress: &dyn Progress) -> Result<Value> {
        let found = analysis::recordings(&self.folder)?;
        progress.start("reading files", found.files.len());
        let seen = |path: &PathBuf| {
            let seen = SeenRecording::of(&self.folder, path);
            progress.step();
            seen
        };
        let recordings: Vec<SeenRecording> = found.files.iter().map(seen).collect();
        Ok(json!({ "recordings": recordings }))
    }

    /// Takes the campaign among the files, else proposes one. The `known` text is extended.
    fn propose(&mut self, known: Option<&str>, progress: &dyn Progress) -> Result<Value> {
        let own = || self.folder.own_file(Proposal::FILE);
        let empty = analysis::recordings(&self.folder)?.files.is_empty();
        let (mut none, mut is_own) = (None, false);
        if known.is_none() {
            self.proposals.clear();
        }
        if let (None, Some(bytes)) = (known, own()) {
            is_own = true;
            self.text = String::from_utf8(bytes).map_err(|_| {
                Error::usage("campaign.toml is not UTF-8", "text in UTF-8")
                    .hint("save the file as UTF-8 in your editor")
            })?;
        } else if empty {
            none = Some("no recording among these files".to_owned());
        } else {
            match self.proposed(known, progress) {
                Ok((text, proposal)) => {
                    self.text = text;
                    self.proposals.push(proposal);
                }
                Err(error) => {
                    known.unwrap_or_default().clone_into(&mut self.text);
                    none = Some(words::error(&error));
                }
            }
        }
        let of_proposal = self.proposals.last().into_iter().flat_map(|one| &one.left);
        let said = |(file, why): &(String, String)| (file.clone(), words::as_kinds(why));
        let unnamed = if is_own { self.unnamed().unwrap_or_default() } else { Vec::new() };
        let left: Vec<_> = self.left.iter().chain(&unnamed).chain(of_proposal).map(said).collect();
        Ok(joined(json!({ "left": left, "none": none, "own": is_own }), self.state()))
    }

    /// Recordings that the campaign does not name, each with that as the reason why it is not used.
    fn unnamed(&self) -> Result<LeftOut> {
        let files = analysis::unnamed(&self.campaign()?, &analysis::recordings(&self.folder)?.files)?;
        let name =
            |path: &PathBuf| path.strip_prefix(self.folder.root()).unwrap_or(path).display().to_string();
        Ok(files.iter().map(|path| (name(path), "the campaign does not name it".to_owned())).collect())
    }

    /// The text of a proposed campaign: the known one with tables for further files, else a new one.
    fn proposed(&mut self, known: Option<&str>, progress: &dyn Progress) -> Result<(String, Proposal)> {
        let campaign = known.map(|text| analysis::parse(&self.folder, &self.path(), text.to_owned()));
        let campaign = campaign.transpose()?;
        let kept = AnswerCache::none(&self.folder);
        let proposal = Proposal::of(&self.folder, &Reading::default(), campaign.as_ref(), &kept, progress)?;
        self.tried = Some(kept);
        let text = match known {
            Some(known) => format!("{}\n{}", known.trim_end(), proposal.tables()),
            None => proposal.below(HEAD),
        };
        Ok((text, proposal))
    }

    /// The text of the campaign, its tables, and its errors.
    fn state(&self) -> Value {
        let tables = match WrittenTable::all(&self.text) {
            Ok(written) => SeenTable::all(&self.text, &written, &self.proposals),
            Err(_) => Vec::new(),
        };
        let problems: Vec<Value> = match self.campaign() {
            Ok(campaign) => campaign.faults().iter().map(|fault| problem(&fault.error)).collect(),
            Err(error) => vec![problem(&error)],
        };
        json!({ "text": self.text, "tables": tables, "problems": problems, "kinds": kinds() })
    }

    /// The table of this number in the list, from 0.
    fn table(&self, table: usize) -> Result<SeenTable> {
        let all = SeenTable::all(&self.text, &WrittenTable::all(&self.text)?, &self.proposals);
        all.into_iter().nth(table).ok_or_else(no_table)
    }

    /// The text with this table, its section and its number there. A table that lacks a value is a comment
    /// as a whole: the marks of the comment are taken away.
    fn with_table(&self, table: usize) -> Result<(String, String, usize)> {
        let seen = self.table(table)?;
        if let Some(number) = seen.number {
            return Ok((self.text.clone(), seen.section, number));
        }
        let (i, k) = seen.proposed.ok_or_else(no_table)?;
        let text = self.text.replacen(&self.proposals[i].block(k), &self.proposals[i].opened(k), 1);
        let written = WrittenTable::all(&text)?;
        let all = SeenTable::all(&text, &written, &self.proposals);
        let number = all.iter().find(|one| one.proposed == Some((i, k))).and_then(|one| one.number);
        Ok((text, seen.section, number.ok_or_else(no_table)?))
    }

    /// Sets a key of a table, together with values that were refused without it where they go with it. A
    /// value is refused if the key does not take it, so that no table could be read, or if it needs another
    /// key: the record keeps the answer that it has.
    fn set(&mut self, table: usize, one: (&str, &str), also: &[(String, String)]) -> Result<()> {
        let (text, section, number) = self.with_table(table)?;
        let state = |text: &str, (key, value): (&str, &str)| {
            Campaign::text_with(text, (&section, number), key, value)
        };
        let alone = state(&text, one)?;
        let mut others = also.iter().map(|(key, value)| (key.as_str(), value.as_str()));
        let together = others.try_fold(alone.clone(), |text, other| state(&text, other));
        let is_whole = |text: &str| matches!(self.lacks(text), Ok(None));
        self.text = match (together, self.lacks(&alone)) {
            (Ok(text), _) if !also.is_empty() && is_whole(&text) => text,
            (_, Ok(Some(why))) if is_whole(&text) => return Err(Error::refused(why)),
            // An error that was there before is no reason against this value.
            (_, Err(error)) if self.campaign().is_ok() => return Err(error),
            _ => alone,
        };
        Ok(())
    }

    /// In words, the first fault of a text by which a table states a key without another one that goes with
    /// it.
    fn lacks(&self, text: &str) -> Result<Option<String>> {
        let campaign = analysis::parse(&self.folder, &self.path(), text.to_owned())?;
        let stated = WrittenTable::all(text)?;
        let with_open = |error: &Error| {
            let at = error.line().unwrap_or(0);
            let table = stated.iter().rev().find(|table| table.line as u64 <= at)?;
            let key = error.settings().find(|key| table.value(key).is_none())?;
            Some(format!("{}\n  try: set `{key}`, too", words::error(error)))
        };
        Ok(campaign.faults().iter().find_map(|fault| with_open(&fault.error)))
    }

    /// Gives a table another kind.
    fn change_kind(&mut self, table: usize, to: &str) -> Result<()> {
        let (text, section, number) = self.with_table(table)?;
        self.text = Campaign::text_of_kind(&text, (&section, number), to)?;
        Ok(())
    }

    /// Runs the campaign, and keeps its results in memory.
    fn run(&mut self, progress: &dyn Progress) -> Result<Value> {
        let campaign = self.campaign()?;
        let results = campaign.within().at(campaign.out());
        let kept = self.tried.take().unwrap_or_else(|| AnswerCache::of(&results));
        let mut output = Output::new(results, Owner::Run)?.replace(true);
        let outcome = analysis::run(&campaign, &kept, &mut output, progress)?;
        output.commit()?;
        self.results = (campaign.out(), outcome.files.clone());
        let of_all = outcome.answer.findings.iter().filter(|(_, finding)| finding.code == analysis::LEFT_OUT);
        let said = |finding| words::as_kinds(&sentence(finding, Voice::Campaign));
        let refused: Vec<_> = of_all.map(|(name, finding)| (name, said(finding))).collect();
        // What was found of each record, and what makes it less certain.
        let numbers: Vec<_> = outcome.answer.headlines.iter().flat_map(by_record).collect();
        let uncertain =
            |(_, finding): &&About| finding.severity() > Severity::Note && finding.code != analysis::LEFT_OUT;
        let doubts: Vec<_> = outcome.answer.findings.iter().filter(uncertain).collect();
        let doubts: Vec<_> =
            doubts.into_iter().map(|(name, one)| (name, one.severity().name(), said(one))).collect();
        let (answered, files) = (outcome.answered, outcome.files);
        Ok(json!({
            "answered": answered, "files": files, "refused": refused, "numbers": numbers, "doubts": doubts
        }))
    }

    /// The results as they would be with this key: nothing is changed.
    fn tried_with(&self, table: usize, (key, value): (&str, &str), progress: &dyn Progress) -> Result<Value> {
        let (text, section, number) = self.with_table(table)?;
        let text = Campaign::text_with(&text, (&section, number), key, value)?;
        let campaign = analysis::parse(&self.folder, &self.path(), text)?;
        let kept = AnswerCache::of(&campaign.within().at(campaign.out()));
        let answered = analysis::answers(&campaign, &kept, progress)?;
        Ok(answered.map_or_else(|_| json!({}), |answer| json!(answer.result)))
    }

    fn pictures(&self, path: &str) -> Result<Value> {
        let path = self.folder.path(Path::new(path))?;
        let recording = Reader::new().within(&self.folder).allow_missing(true).from_path(path)?;
        let pictures: Vec<Picture> =
            recording.records.iter().map(|record| Picture::of_record(record, COLUMNS)).collect();
        Ok(json!(pictures))
    }

    fn trace(
        &self,
        table: usize,
        file: usize,
        part: (Option<f64>, Option<f64>),
        columns: usize,
    ) -> Result<Value> {
        let (text, section, number) = self.with_table(table)?;
        // All of the record, also where a part of it is used: its ends are dragged.
        let text = Campaign::text_with(&text, (&section, number), "span", "")?;
        let campaign = analysis::parse(&self.folder, &self.path(), text)?;
        let (trace, files) = analysis::raw_trace(&campaign, (&section, number), file)?;
        let n = trace.axis.len();
        let (first, last) = (trace.axis.at(0), trace.axis.at(n.saturating_sub(1)));
        let (from, to) = (part.0.unwrap_or(first).max(first), part.1.unwrap_or(last).min(last));
        let picture = Picture::of_trace(&trace, from, to, columns.min(4096));
        let spectrum = Picture::of_spectrum(&trace, from, to, columns.min(4096));
        let files: Vec<String> = files.iter().map(|file| file.display().to_string()).collect();
        let (name, unit) = (&trace.meta.name, trace.meta.unit.symbol());
        let about =
            json!({ "first": first, "last": last, "n": n, "name": name, "unit": unit, "files": files });
        Ok(joined(about, json!({ "picture": picture, "spectrum": spectrum })))
    }

    /// The sounds of the part of a trace that is used; null where the kind has none.
    fn sounds(&self, table: usize, file: usize) -> Result<Value> {
        let (text, section, number) = self.with_table(table)?;
        let campaign = analysis::parse(&self.folder, &self.path(), text)?;
        Ok(json!(analysis::raw_sounds(&campaign, (&section, number), file)?))
    }

    /// A file of the results.
    fn file(&self, name: &str) -> Result<Vec<u8>> {
        if name == Proposal::FILE {
            return Ok(self.text.clone().into_bytes());
        }
        let known = self.results.1.iter().any(|known| known == name);
        if !known {
            return Err(Error::usage(format!("no result {name:?}"), "a file of the results"));
        }
        self.folder.read(&self.results.0.join(name))
    }

    /// The folder as it is: what was given, the campaign, and the results in their folder, with the list by
    /// which they are known as results.
    fn archive(&self) -> Result<Vec<u8>> {
        let given = self.folder.walk(self.folder.root(), DEEPEST)?.files;
        let given = given.into_iter().filter(|path| *path != self.path());
        let names = self.results.1.iter().map(String::as_str).chain([Manifest::FILE]);
        let results = names.map(|name| self.results.0.join(name)).filter(|path| self.folder.is_file(path));
        let campaign = (Proposal::FILE.to_owned(), self.text.clone().into_bytes());
        // One file after another: together they may fill the memory.
        let file = |path: PathBuf| {
            let name = path.strip_prefix(self.folder.root()).unwrap_or(&path);
            Ok((name.to_string_lossy().into_owned(), self.folder.read(&path)?))
        };
        packed(std::iter::once(Ok(campaign)).chain(given.chain(results).map(file)))
    }
}

/// The rows of each record in a table of main numbers: its name, and heads and cells as text.
fn by_record(table: &Table) -> Vec<(String, Vec<Vec<String>>)> {
    let mut all: Vec<(String, Table)> = Vec::new();
    for row in &table.rows {
        let Some(Cell::Text(name)) = row.first() else { continue };
        // The remark of a row points to the doubts, which stand below it.
        let cells = row[1..row.len() - 1].to_vec();
        if let Some((_, own)) = all.iter_mut().find(|(known, _)| known == name) {
            own.rows.push(cells);
        } else {
            let columns = table.columns[1..table.columns.len() - 1].to_vec();
            all.push((name.clone(), Table { columns, rows: vec![cells], ..Table::default() }));
        }
    }
    all.into_iter().map(|(name, table)| (name, table.in_words())).collect()
}

/// Section and title of each kind of record. A sweep has several files, so no record becomes one.
fn kinds() -> Vec<(&'static str, &'static str)> {
    let titled = |section| Some((section, analysis::title(section)?));
    analysis::sections().filter(|section| *section != "sweep").filter_map(titled).collect()
}

/// Two objects as one.
fn joined(mut one: Value, other: Value) -> Value {
    if let (Value::Object(one), Value::Object(other)) = (&mut one, other) {
        one.extend(other);
    }
    one
}

/// The folder that all names begin with, with its `/`; empty if there is none.
fn common_folder<'a>(mut names: impl Iterator<Item = &'a str>) -> String {
    let Some(top) = names.next().and_then(|name| name.split_once('/')).map(|(top, _)| format!("{top}/"))
    else {
        return String::new();
    };
    if names.all(|name| name.starts_with(&top)) { top } else { String::new() }
}

#[cfg(test)]
mod tests;

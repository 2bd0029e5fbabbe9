//! Proposes a campaign for the recordings of a folder: keys that were found or guessed, and those that are
//! missing.
//!
//! A record of unknown kind is tried: the first analysis with a plausible answer and no doubt is proposed.

mod alike;
mod folder;
mod found;
mod frequency_response;
mod joined;
mod notes;
mod trial;
mod workload;

use folder::{FileSeries, Inventory};
pub use joined::more_steps;
use notes::Note;

use crate::analysis::{self, AnswerCache, Progress};
use crate::campaign::{Campaign, Reading};
use crate::error::{Error, Place, Result};
use crate::read::Folder;
use crate::record::shown;
use serde::Serialize;
use serde_json::Value;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

/// A proposed campaign for a folder.
#[derive(Debug, Clone, Serialize)]
pub struct Proposal {
    /// The folder.
    #[serde(skip)]
    pub folder: Folder,
    /// Tables in the order of a campaign.
    pub tables: Vec<Table>,
    /// Files in no table, each with the reason.
    pub left: Vec<(String, String)>,
    /// Lines of notes in the folder that may state a key.
    notes: Vec<Note>,
}

/// A table of a campaign.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Table {
    /// `sweep` for `[[sweep]]`.
    pub section: &'static str,
    /// Files of the table, in words.
    pub files: String,
    /// Kind of these files, in words.
    pub about: &'static str,
    /// Whether the kind is a guess.
    pub guess: bool,
    /// Keys in order.
    pub rows: Vec<TableKey>,
    /// Why its records give no answer yet; `None` where they do.
    pub refused: Option<Refusal>,
}

/// Why records give no answer.
#[derive(Debug, Default, Clone, PartialEq, Serialize)]
pub struct Refusal {
    /// Code of the refusal; empty where it has none.
    pub code: String,
    /// Reason in words.
    pub why: String,
    /// Hint; empty where there is none.
    pub hint: String,
}

impl Refusal {
    /// The reason with the hint.
    pub fn in_words(&self) -> String {
        if self.hint.is_empty() { self.why.clone() } else { format!("{}; try: {}", self.why, self.hint) }
    }
}

/// A key of a table.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct TableKey {
    /// Its name.
    pub key: &'static str,
    /// Its value as TOML; empty where it is missing.
    pub value: String,
    /// Where the value comes from.
    pub known: KeyStatus,
}

/// Longest `key = value`, in characters, that the column of comments makes room for; the comment of a
/// longer one follows it directly.
const WIDEST: usize = 60;

/// Keys that say which part of a file is read.
const OF_PART: [&str; 3] = ["allow_missing", "span", "stretch"];

/// How the value of a key is known.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum KeyStatus {
    /// The files state it.
    Found,
    /// It was inferred; the reason.
    Guessed(&'static str),
    /// Optional and not stated: a person may add it for a fuller answer; a description.
    Open(&'static str),
    /// Required and not stated: a person must add it; a description.
    Missing(&'static str),
}

impl KeyStatus {
    /// Reason of a guess, or description of a key that is not stated.
    pub fn why(self) -> Option<&'static str> {
        match self {
            KeyStatus::Found => None,
            KeyStatus::Guessed(why) | KeyStatus::Open(why) | KeyStatus::Missing(why) => Some(why),
        }
    }
}

impl Table {
    /// A table without keys.
    fn new(section: &'static str, about: &'static str, files: &str) -> Table {
        let (files, refused) = (files.to_owned(), None);
        Table { section, about, files, guess: false, rows: Vec::new(), refused }
    }

    /// The same table, with the kind of its files marked as a guess: it was found by a trial, not stated by
    /// the files.
    fn surmised(self) -> Table {
        Table { guess: true, ..self }
    }

    /// Files and their kind, in words.
    pub fn in_words(&self) -> String {
        let guess = if self.guess { ", guessed" } else { "" };
        format!("{}: {}{guess}", self.files, self.about)
    }

    /// Adds a key with a value.
    fn with(mut self, key: &'static str, value: impl Serialize, known: KeyStatus) -> Table {
        // Strings, numbers, booleans and lists of these are written alike in JSON and TOML.
        let value = serde_json::to_string(&value).unwrap_or_default();
        self.rows.push(TableKey { key, value, known });
        self
    }

    /// Adds a key whose value the files state.
    fn found(self, key: &'static str, value: impl Serialize) -> Table {
        self.with(key, value, KeyStatus::Found)
    }

    /// Adds a key whose value was inferred, with the reason.
    fn guessed(self, key: &'static str, value: impl Serialize, why: &'static str) -> Table {
        self.with(key, value, KeyStatus::Guessed(why))
    }

    /// Adds a key that may be stated, with a placeholder for a trial of the table, or none.
    fn open(self, key: &'static str, instead: &str, what: &'static str) -> Table {
        self.without(key, instead, KeyStatus::Open(what))
    }

    /// Adds a key that must be stated, with a placeholder for a trial of the table.
    fn missing(self, key: &'static str, instead: &str, what: &'static str) -> Table {
        self.without(key, instead, KeyStatus::Missing(what))
    }

    /// Adds a key without a value, with a placeholder for a trial.
    fn without(mut self, key: &'static str, instead: &str, known: KeyStatus) -> Table {
        self.rows.push(TableKey { key, value: instead.to_owned(), known });
        self
    }

    /// The same table with placeholders as values of keys that are not stated, for a trial.
    fn tried(mut self) -> Table {
        for row in &mut self.rows {
            if matches!(row.known, KeyStatus::Open(_) | KeyStatus::Missing(_)) && !row.value.is_empty() {
                row.known = KeyStatus::Found;
            }
        }
        self
    }

    /// Adds the settings for reading that `reading` states, if the table has a key for them. Those of a
    /// `part` are a guess, with this reason.
    fn stated(&self, reading: &Reading, part: Option<&'static str>) -> Table {
        let has = |key| self.rows.iter().any(|row| row.key == key);
        let of_traces = |key: &str, value: &Value| key == "rate" || key == "unit" && value.is_string();
        let takes = |key: &str, value: &Value| has("file") || has("traces") && of_traces(key, value);
        let stated = reading.stated().into_iter().filter(|(key, value)| takes(key, value));
        let known = |key| match part.filter(|_| OF_PART.contains(&key)) {
            Some(why) => KeyStatus::Guessed(why),
            None => KeyStatus::Found,
        };
        stated.fold(self.clone(), |table, (key, value)| table.with(key, value, known(key)))
    }

    /// Whether a required key is missing: the table cannot run before it is filled in.
    pub fn lacks(&self) -> bool {
        self.rows.iter().any(|row| matches!(row.known, KeyStatus::Missing(_)))
    }

    /// Its name in the report.
    pub fn name(&self) -> &str {
        let name = self.value("name");
        if name.is_empty() { self.value("sweep") } else { name }
    }

    /// Value of a key without quotes; empty where there is none.
    fn value(&self, key: &str) -> &str {
        self.rows.iter().find(|row| row.key == key).map_or("", |row| bare(&row.value))
    }

    /// Whether a line of notes may state this open key. The `mass` of a sweep is a number, not a weight in
    /// kg.
    fn asks(&self, row: &TableKey, note: &Note) -> bool {
        let open = matches!(row.known, KeyStatus::Open(_) | KeyStatus::Missing(_));
        open && note.is_of(row.key) && (self.section, row.key) != ("sweep", "mass")
    }

    /// The table as TOML, with what notes state of its open keys; commented out where a required key is
    /// missing.
    fn toml(&self, notes: &[Note]) -> String {
        if !self.lacks() {
            return self.opened(notes);
        }
        let text = self.rows_of_toml(notes, "");
        let rows = text.trim_end().replace('\n', "\n#");
        let rows = format!("#{}\n", rows.trim_end_matches('#').trim_end());
        let refused = self.refused.iter().map(|refused| format!("# {}\n", shown(refused.in_words())));
        format!("{}{}# {}\n{rows}", self.above(), refused.collect::<String>(), Campaign::FILL_IN)
    }

    /// The table as TOML, in which a key that must be stated is a comment. Why it gave no answer before it
    /// was stated is told no more.
    fn opened(&self, notes: &[Note]) -> String {
        self.above() + &self.rows_of_toml(notes, "# ")
    }

    /// Comment above the table: its description.
    fn above(&self) -> String {
        format!("# {}\n", shown(self.in_words()))
    }

    /// Its head and keys; `missing` stands before a key that must be stated.
    fn rows_of_toml(&self, notes: &[Note], missing: &str) -> String {
        let stated = |row: &TableKey| {
            let of_key = notes.iter().filter(|note| self.asks(row, note));
            of_key.fold(String::new(), |text, note| format!("{text}; {}: {}", note.place, note.text))
        };
        let mut text = format!("[[{}]]\n", self.section);
        let row = |row: &TableKey| match row.known {
            KeyStatus::Open(_) => format!("# {} =", row.key),
            KeyStatus::Missing(_) => format!("{missing}{} =", row.key),
            _ => format!("{} = {}", row.key, row.value),
        };
        let commented = self.rows.iter().filter(|row| row.known.why().is_some());
        let wide = commented.map(|r| row(r).chars().count()).filter(|n| *n <= WIDEST).max().unwrap_or(0);
        for one in &self.rows {
            let row = row(one);
            let _ = match one.known {
                KeyStatus::Found => writeln!(text, "{row}"),
                KeyStatus::Guessed(why) => writeln!(text, "{row:wide$}   # guessed: {why}"),
                KeyStatus::Open(what) => writeln!(text, "{row:wide$}   # open: {what}{}", stated(one)),
                KeyStatus::Missing(what) => writeln!(text, "{row:wide$}   # missing: {what}{}", stated(one)),
            };
        }
        text
    }
}

impl Proposal {
    /// Name of the file of a campaign in a folder.
    pub const FILE: &str = analysis::OWN;

    /// Proposes a campaign for the recordings in a folder and up to two levels below, without those that
    /// the campaign `known` already names.
    ///
    /// # Errors
    /// If it is no folder, cannot be listed, or holds no recording.
    pub fn of(
        within: &Folder,
        reading: &Reading,
        known: Option<&Campaign>,
        kept: &AnswerCache,
        progress: &dyn Progress,
    ) -> Result<Proposal> {
        let folder = within.root();
        if !within.is_folder(folder) {
            return Err(if within.exists(folder) {
                Error::input(Place::file(folder), "this is a file", "a folder of recordings")
                    .hint("name the folder that holds it")
            } else {
                Error::absent(format!("there is no folder {}", shown(folder)), Path::new(""), folder)
            });
        }
        let found = Inventory::of(within, reading, known, progress)?;
        let notes = Note::all(within);
        let mut proposal = Proposal { folder: within.clone(), tables: Vec::new(), left: found.left, notes };
        for (name, path) in found.lists {
            let table =
                Table::new("sweep", "the list of a sweep", &path).found("name", name).found("list", path);
            let table = table.open("mass", "", "1 excited, 2 passive; names the resonances");
            let table = table.open("quantity", "", "\"displacement\", \"velocity\" or \"acceleration\"");
            let table = table.open("window", "", "\"hann\", \"flat-top\", ... as the analyser was set");
            proposal.tables.push(table.open("scaling", "", "\"peak\" or \"rms\""));
        }
        let all = joined::join_all(found.series, within, kept);
        for series in alike::tables_of_each(&all, within, kept, progress) {
            proposal.tables.extend(series.tables);
            proposal.left.extend(series.left);
        }
        if proposal.tables.is_empty() && known.is_none() {
            let nothing = |found: &str| Error::input(Place::file(folder), found, "files of an instrument");
            return Err(match proposal.left.first() {
                None => nothing("no recording in this folder").hint("another folder, or vibro demo"),
                Some((file, why)) => nothing("no recording that can be measured")
                    .aside(format!("{file}: {why}"))
                    .hint(format!("`vibro info {}/FILE` tells what is in a file", shown(folder))),
            });
        }
        if let Some(known) = known {
            proposal.join(known)?;
        }
        let place = |table: &Table| analysis::sections().position(|section| section == table.section);
        proposal.tables.sort_by_key(place);
        Ok(proposal)
    }

    /// Copies to each table what the known campaign states of a file whose name differs only in a number.
    /// Gives each sweep a name of its own.
    fn join(&mut self, known: &Campaign) -> Result<()> {
        let of = |rows: &[(String, String)], key: &str| {
            rows.iter().find(|row| row.0 == key).map_or_else(String::new, |row| bare(&row.1).to_owned())
        };
        let sweeps: Vec<String> = known.written("sweep")?.iter().map(|rows| of(rows, "name")).collect();
        for table in &mut self.tables {
            let file = table.value("file").to_owned();
            let all = known.written(table.section)?;
            let like = all.iter().find(|rows| folder::alike(&file, &of(rows, "file")));
            for (key, value) in like.into_iter().flatten() {
                // Drops of one series share a name.
                let same = key != "file" && (key != "name" || table.section == "drop");
                for row in table.rows.iter_mut().filter(|row| same && row.key == key) {
                    (row.value, row.known) = (value.clone(), KeyStatus::Found);
                }
            }
            let name = table.value(if table.section == "sweep" { "name" } else { "sweep" }).to_owned();
            let free =
                (2..=sweeps.len() + 2).map(|n| format!("{name} {n}")).find(|name| !sweeps.contains(name));
            for row in table.rows.iter_mut().filter(|row| sweeps.contains(&name) && bare(&row.value) == name)
            {
                row.value = serde_json::to_string(&free).unwrap_or_default();
            }
        }
        Ok(())
    }

    /// The campaign as TOML.
    pub fn toml(&self) -> String {
        self.below(&format!(
            "# Proposed by `vibro init`. Check what is guessed, fill in what is missing, then: vibro run {}\n# docs/campaign.md lists every key.\n",
            Proposal::FILE
        ))
    }

    /// The campaign as TOML, below comments that say where it comes from.
    pub fn below(&self, head: &str) -> String {
        let root = self.folder.root();
        let folder = root.canonicalize().unwrap_or_else(|_| root.to_owned());
        let name = folder.file_name().map_or_else(|| "Campaign".into(), shown);
        let name = serde_json::to_string(&name).unwrap_or_default();
        let mut text = format!("{head}name = {name}\n");
        let beside =
            |note: &Note| self.tables.iter().any(|table| table.rows.iter().any(|row| table.asks(row, note)));
        for note in self.notes.iter().filter(|note| !beside(note)) {
            let _ = writeln!(text, "# {}: {}", note.place, note.text);
        }
        text += &self.tables();
        text
    }

    /// The tables as TOML, and the files that are not used.
    pub fn tables(&self) -> String {
        let mut text = String::new();
        for table in &self.tables {
            text += "\n";
            text += &table.toml(&self.notes);
        }
        if !self.left.is_empty() {
            text += "\n# Not used:\n";
        }
        for (file, why) in &self.left {
            let _ = writeln!(text, "# {}", shown(format!("{file}: {why}")));
        }
        text
    }

    /// Text of one table in [`Proposal::toml`].
    ///
    /// # Panics
    /// If there are not so many tables.
    pub fn block(&self, table: usize) -> String {
        self.tables[table].toml(&self.notes)
    }

    /// The same table without the marks of a comment; what is missing stays a comment.
    ///
    /// # Panics
    /// If there are not so many tables.
    pub fn opened(&self, table: usize) -> String {
        self.tables[table].opened(&self.notes)
    }

    /// The campaign, as if its file lay in the folder.
    ///
    /// # Errors
    /// As [`analysis::parse`].
    pub fn campaign(&self) -> Result<Campaign> {
        analysis::parse(&self.folder, &self.folder.root().join(Proposal::FILE), self.toml())
    }
}

/// A value of TOML without its quotes.
fn bare(value: &str) -> &str {
    value.trim_matches(['"', '\''])
}

/// Proposes a campaign of one sweep for time traces, one file a step.
///
/// # Errors
/// If the first file cannot be read, or holds no force and response.
pub fn of_steps(within: &Folder, files: &[PathBuf], reading: &Reading) -> Result<Proposal> {
    let first = files.first().ok_or_else(|| Error::usage("no file", "the files of a sweep"))?;
    let (_, headers, _) = reading.reader()?.within(within).survey(first)?;
    let channels: Vec<String> = headers.iter().map(|h| format!("{} [{}]", h.name, h.unit)).collect();
    let names: Vec<String> = files.iter().map(|file| file.display().to_string()).collect();
    let (name, reading) = (folder::name(&names), reading.clone());
    let series = FileSeries { name, files: names, headers, pattern: None, alike: false, reading, part: None };
    let table = series.sweep().ok_or_else(|| {
        let found = format!("the channels {}", channels.join(", "));
        Error::input(Place::file(first), found, "a force in N and a displacement, velocity or acceleration")
            .hint("name them in a campaign: [[sweep]] with traces, force and response; docs/campaign.md shows one")
    })?;
    let tables = vec![table.stated(&series.reading, None)];
    Ok(Proposal { folder: within.at("."), tables, left: Vec::new(), notes: Vec::new() })
}

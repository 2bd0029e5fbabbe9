//! A table of the campaign as the page shows it: its keys, those that are missing, and where it stands.

use crate::words;
use serde::Serialize;
use vibroimpact::campaign::{KeyMeaning, WrittenKey, WrittenTable};
use vibroimpact::proposal::{KeyStatus, Proposal, Table, TableKey};

/// A table of records.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SeenTable {
    /// `sweep` for `[[sweep]]`.
    pub section: String,
    /// Its files in words.
    pub files: String,
    /// Kind of its files in words.
    pub about: String,
    /// Whether the kind is a guess.
    pub guess: bool,
    /// Its first line in the text, from 1; `None` while it lacks a value and is a comment.
    pub line: Option<usize>,
    /// Why its records give no answer yet.
    pub refused: Option<String>,
    /// Its keys.
    pub keys: Vec<SeenKey>,
    /// Its number in its section, from 1, while it is no comment.
    #[serde(skip)]
    pub number: Option<usize>,
    /// Number of its proposal, and its number there.
    #[serde(skip)]
    pub proposed: Option<(usize, usize)>,
}

/// A key of a table.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SeenKey {
    /// Its name.
    pub key: String,
    /// Its value as TOML; empty where it has none.
    pub value: String,
    /// `stated`, `found`, `guessed`, `open`, `missing`, or `possible` for a key that nobody asks for.
    pub known: &'static str,
    /// Reason of a guess, or what to state.
    pub why: String,
    /// Its line in the text, from 1.
    pub line: Option<usize>,
    /// What it means.
    #[serde(flatten)]
    pub meaning: Option<KeyMeaning>,
}

impl SeenKey {
    fn stated(key: &str, value: &str) -> SeenKey {
        let (key, value) = (key.to_owned(), value.to_owned());
        SeenKey { key, value, known: "stated", why: String::new(), line: None, meaning: None }
    }
}

/// Keys by which the table of a proposal is found again in the text; the first that both have decides.
const NAMES: [&str; 5] = ["file", "list", "traces", "force", "name"];

/// A key of a proposal. What stands for an open key in its trial is no value.
fn key_of(row: &TableKey) -> SeenKey {
    let (known, value) = match row.known {
        KeyStatus::Found => ("found", row.value.clone()),
        KeyStatus::Guessed(_) => ("guessed", row.value.clone()),
        KeyStatus::Open(_) => ("open", String::new()),
        KeyStatus::Missing(_) => ("missing", String::new()),
    };
    let why = row.known.why().unwrap_or_default().to_owned();
    SeenKey { key: row.key.to_owned(), value, known, why, line: None, meaning: None }
}

impl SeenTable {
    /// The tables of a text, then those of the proposals that are comments in it.
    pub fn all(text: &str, written: &[WrittenTable], proposals: &[Proposal]) -> Vec<SeenTable> {
        let of_one = |(i, proposal): (usize, &'_ Proposal)| -> Vec<((usize, usize), Table)> {
            let tables = proposal.tables.iter().enumerate();
            tables.map(|(k, table)| ((i, k), table.clone())).collect()
        };
        let mut open: Vec<((usize, usize), Table)> = proposals.iter().enumerate().flat_map(of_one).collect();
        let mut all: Vec<SeenTable> = Vec::new();
        for table in written {
            let known = open.iter().position(|(_, one)| is_of(one, table)).map(|k| open.remove(k));
            all.push(SeenTable::written(table, known.as_ref().map(|(place, table)| (*place, table))));
        }
        for ((i, k), table) in open {
            if table.lacks() && text.contains(&proposals[i].block(k)) {
                all.push(SeenTable::proposed((i, k), &table));
            }
        }
        all.iter_mut().for_each(SeenTable::explain);
        all
    }

    /// Adds what the keys mean, and the further keys that the section knows. A table that runs lacks only
    /// what is required.
    fn explain(&mut self) {
        let runs = self.line.is_some();
        for meaning in KeyMeaning::of(&self.section) {
            let required = meaning.left_out == "required";
            if let Some(row) = self.keys.iter_mut().find(|row| row.key == meaning.key) {
                row.why = meaning.beyond(&row.why).to_owned();
                row.meaning = Some(meaning);
                if runs && row.known == "missing" && !required {
                    (row.known, row.why) = ("open", String::new());
                }
                continue;
            }
            let known = if required { "missing" } else { "possible" };
            let key = SeenKey::stated(meaning.key, "");
            self.keys.push(SeenKey { known, meaning: Some(meaning), ..key });
        }
    }

    fn proposed(place: (usize, usize), table: &Table) -> SeenTable {
        SeenTable {
            section: table.section.to_owned(),
            files: table.files.clone(),
            about: table.about.to_owned(),
            guess: table.guess,
            line: None,
            refused: table.refused.as_ref().map(|why| words::as_kinds(&why.in_words())),
            keys: table.rows.iter().map(key_of).collect(),
            number: None,
            proposed: Some(place),
        }
    }

    fn written(table: &WrittenTable, known: Option<((usize, usize), &Table)>) -> SeenTable {
        let stated = |WrittenKey { key, value, line, .. }: &WrittenKey| {
            let row = known.and_then(|(_, known)| known.rows.iter().find(|row| row.key == key));
            let same = row.map(key_of).filter(|row| row.value == *value);
            SeenKey { line: Some(*line), ..same.unwrap_or_else(|| SeenKey::stated(key, value)) }
        };
        let mut keys: Vec<SeenKey> = table.keys.iter().map(stated).collect();
        let open = known.into_iter().flat_map(|(_, known)| &known.rows).map(key_of);
        keys.extend(open.filter(|row| row.value.is_empty() && table.value(&row.key).is_none()));
        let files = NAMES.iter().find_map(|name| table.value(name)).unwrap_or_default();
        let files = files.trim_matches('"').to_owned();
        let of_text = SeenTable {
            section: table.section.clone(),
            files,
            about: vibroimpact::analysis::title(&table.section).unwrap_or(&table.section).to_owned(),
            guess: false,
            line: None,
            refused: None,
            keys: Vec::new(),
            number: None,
            proposed: None,
        };
        let base = known.map_or(of_text, |(place, known)| SeenTable::proposed(place, known));
        SeenTable { line: Some(table.line), number: Some(table.number), keys, ..base }
    }
}

/// Whether a table of the text is this one of a proposal.
fn is_of(proposed: &Table, written: &WrittenTable) -> bool {
    let value = |key: &str| proposed.rows.iter().find(|row| row.key == key).map(|row| row.value.as_str());
    let both = NAMES.iter().find_map(|name| value(name).zip(written.value(name)));
    let channels = value("channel").zip(written.value("channel"));
    proposed.section == written.section
        && both.is_some_and(|(a, b)| a == b)
        && channels.is_none_or(|(a, b)| a == b)
}

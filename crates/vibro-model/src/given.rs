//! Keys and values from a TOML file, and those that are set later, such as on a command line.

use std::path::{Path, PathBuf};
use toml::de::{DeTable, DeValue};
use toml::{Spanned, Table, Value};
use vibro_record::{Error, Place, Result};

/// Keys and their values; a value set later replaces an earlier one. Keys of a table have a dot.
#[derive(Debug, Clone, Default)]
pub(crate) struct Given {
    pub path: Option<PathBuf>,
    pub text: String,
    pub table: Table,
    /// Keys that were set after the text was read.
    later: Vec<String>,
}

impl Given {
    /// The text of a file. `expected` says what the file is.
    ///
    /// # Errors
    /// If it cannot be read or is not UTF-8.
    pub fn read(path: &Path, expected: &str) -> Result<String> {
        let bytes = std::fs::read(path).map_err(|e| Error::io("open", path, e))?;
        String::from_utf8(bytes).map_err(|e| {
            let place = Place::byte(path, e.utf8_error().valid_up_to() as u64);
            Error::input(place, "bytes that are not UTF-8", expected)
        })
    }

    /// Keys of a text.
    pub fn new(path: Option<PathBuf>, text: String, table: Table) -> Given {
        Given { path, text, table, later: Vec::new() }
    }

    /// Takes `key=value` as it is typed, in the table `within` (with its dot, empty for the top). Words need
    /// no quotes. `checked` reads TOML text.
    ///
    /// # Errors
    /// If it is no assignment, or `checked` refuses its text.
    pub fn set(
        &mut self,
        assignment: &str,
        within: &str,
        checked: impl Fn(&str) -> Result<Table>,
    ) -> Result<()> {
        let (key, value) = assignment.split_once('=').unwrap_or_default();
        let (key, value) = (key.trim(), value.trim());
        if key.is_empty() || value.is_empty() || value.contains('\n') {
            let expected = "KEY=VALUE, such as gap=0.5e-3 or excitation.force=0.5";
            return Err(Error::usage(format!("{assignment:?} sets no key"), expected));
        }
        // `.3` and `5.` are numbers here, though not in TOML; text that is neither TOML nor a number is a
        // word.
        let key = if key.starts_with(within) { key.to_owned() } else { format!("{within}{key}") };
        let plain = format!("{key} = {value}");
        let text = match value.parse::<f64>() {
            _ if DeTable::parse(&plain).is_ok() => plain,
            Ok(number) => format!("{key} = {number:?}"),
            Err(_) => format!("{key} = {value:?}"),
        };
        let given = checked(&text).map_err(|e| e.aside(format!("in the assignment {assignment}")))?;
        for (key, value) in leaves("", given) {
            self.put(&key, value);
        }
        Ok(())
    }

    /// Sets a key to a value, unchecked.
    pub fn put(&mut self, key: &str, value: impl Into<Value>) {
        self.later.push(key.to_owned());
        let mut table = &mut self.table;
        let mut rest = key;
        while let Some((section, inner)) = rest.split_once('.') {
            let section = table.entry(section).or_insert_with(|| Value::Table(Table::new()));
            // A section that is not a table has been refused before.
            let Value::Table(section) = section else { return };
            (table, rest) = (section, inner);
        }
        table.insert(rest.to_owned(), value.into());
    }

    /// The value of a key.
    pub fn get(&self, key: &str) -> Option<&Value> {
        let (first, rest) = key.split_once('.').map_or((key, None), |(first, rest)| (first, Some(rest)));
        rest.into_iter()
            .flat_map(|rest| rest.split('.'))
            .try_fold(self.table.get(first)?, |at, key| at.get(key))
    }

    /// Adds the line of the file to an error, if the value of the key comes from the file.
    pub fn at(&self, key: &str, error: Error) -> Error {
        let is_later = self.later.iter().any(|later| later == key);
        let parsed = DeTable::parse(&self.text).ok().filter(|_| !is_later);
        match parsed.and_then(|all| span(all.get_ref(), key)) {
            Some(span) => self.path.iter().fold(error.excerpt(&self.text, span), Error::in_file),
            None => error,
        }
    }
}

/// Bytes of a key in a parsed text.
fn span(table: &DeTable<'_>, key: &str) -> Option<std::ops::Range<usize>> {
    let Some((section, inner)) = key.split_once('.') else {
        return table.keys().find(|name| name.get_ref() == key).map(Spanned::span);
    };
    match table.get(section)?.get_ref() {
        DeValue::Table(section) => span(section, inner),
        _ => None,
    }
}

/// Keys with dots and values of a table, those of nested tables one by one.
pub(crate) fn leaves(before: &str, table: Table) -> Vec<(String, Value)> {
    let nested = table.into_iter().map(|(name, value)| (format!("{before}{name}"), value));
    nested
        .flat_map(|(key, value)| match value {
            Value::Table(inner) => leaves(&format!("{key}."), inner),
            value => vec![(key, value)],
        })
        .collect()
}

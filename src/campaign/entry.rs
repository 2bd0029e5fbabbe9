//! One table of a section of a campaign: `[[impacts]]`.

use super::{Campaign, Channel, KeyRange, Reading, locate};
use crate::error::{Error, Result};
use serde::Deserialize;
use serde::de::DeserializeOwned;
use std::borrow::Cow;
use std::ops::Range;
use std::path::PathBuf;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// A table with the keys `K` of its analysis.
#[derive(Debug, Clone)]
pub struct Entry<K> {
    /// Name in the report.
    pub name: Option<String>,
    /// File.
    pub file: Option<PathBuf>,
    /// Channel of the file and its calibration.
    pub channel: Channel,
    /// Settings for reading that the file does not state.
    pub reading: Reading,
    /// Keys of the analysis.
    pub keys: K,
    /// Number of the table in its section, from 1.
    pub number: usize,
    head: Range<usize>,
    places: Vec<(String, Range<usize>)>,
}

/// Keys that name a record.
#[derive(Debug, Default, Deserialize)]
#[serde(default, deny_unknown_fields)]
struct Named {
    name: Option<String>,
    file: Option<PathBuf>,
}

const NAMED: [&str; 2] = ["name", "file"];

impl<K> Entry<K> {
    /// Byte at which the table begins, and its file: together they identify it in the campaign.
    pub fn place(&self) -> (usize, Option<PathBuf>) {
        (self.head.start, self.file.clone())
    }

    /// The first stated key that sets how a file is read, if any.
    pub fn reads(&self) -> Option<&'static str> {
        let mut keys = Reading::KEYS.into_iter().chain(Channel::KEYS);
        keys.find(|key| self.places.iter().any(|(name, _)| name == key))
    }
}

impl Campaign {
    /// The tables of a section in their order, each with the error of a number outside its range, if any:
    /// one of `ranges`, or one of the keys that all sections share.
    /// With `of_a_file` they also have the keys `name` and `file`, and those of `Reading` and `Channel`.
    ///
    /// # Errors
    /// If one has an unknown key, or a value of the wrong kind.
    pub(crate) fn entries<K: DeserializeOwned>(
        &self,
        section: &str,
        of_a_file: bool,
        ranges: &[KeyRange],
    ) -> Result<Vec<(Entry<K>, Result<()>)>> {
        let Some(all) = self.table()?.remove(section) else { return Ok(Vec::new()) };
        let several = |span: Range<usize>| {
            let found = format!("{section} is not a list of tables");
            let error = Error::usage(found, "one table for each, with double brackets");
            self.pointed(error.hint(format!("write [[{section}]]")), span)
        };
        let span = all.span();
        let DeValue::Array(all) = all.into_inner() else { return Err(several(span)) };
        let one = |(number, table): (usize, Spanned<DeValue<'_>>)| match (table.span(), table.into_inner()) {
            (head, DeValue::Table(rows)) => self.entry(number, rows, head, of_a_file, ranges),
            (span, _) => Err(several(span)),
        };
        (1..).zip(all).map(one).collect()
    }

    /// A table that stands once, such as `[instrument]`; as [`Campaign::entries`].
    ///
    /// # Errors
    /// If it has an unknown key, or a value of the wrong kind, or stands in double brackets.
    pub(crate) fn single<K: DeserializeOwned>(
        &self,
        section: &str,
        ranges: &[KeyRange],
    ) -> Result<Option<(Entry<K>, Result<()>)>> {
        let Some(table) = self.table()?.remove(section) else { return Ok(None) };
        let head = table.span();
        let DeValue::Table(rows) = table.into_inner() else {
            let error =
                Error::usage(format!("[[{section}]]"), "one table").hint(format!("write [{section}]"));
            return Err(self.pointed(error, head));
        };
        self.entry(1, rows, head, false, ranges).map(Some)
    }

    /// The tables of a section as written in the file: keys and values.
    ///
    /// # Errors
    /// If the campaign is not TOML.
    pub(crate) fn written(&self, section: &str) -> Result<Vec<Vec<(String, String)>>> {
        let Some(DeValue::Array(all)) = self.table()?.remove(section).map(Spanned::into_inner) else {
            return Ok(Vec::new());
        };
        let row = |(key, value): (&Spanned<Cow<'_, str>>, &Spanned<DeValue<'_>>)| {
            (key.get_ref().to_string(), self.text[value.span()].to_owned())
        };
        let rows = |table: &Spanned<DeValue<'_>>| {
            table.get_ref().as_table().map(|rows| rows.iter().map(row).collect())
        };
        Ok(all.iter().filter_map(rows).collect())
    }

    fn entry<K: DeserializeOwned>(
        &self,
        number: usize,
        mut rows: DeTable<'_>,
        head: Range<usize>,
        of_a_file: bool,
        ranges: &[KeyRange],
    ) -> Result<(Entry<K>, Result<()>)> {
        let places =
            rows.iter().map(|(k, v)| (k.get_ref().to_string(), k.span().start..v.span().end)).collect();
        let beside: Vec<&str> =
            if of_a_file { [&NAMED[..], &Channel::KEYS, &Reading::KEYS].concat() } else { Vec::new() };
        // An error about the kind of a value is reported before one about its range.
        let in_range = rows.iter().try_for_each(|(key, value)| {
            let span = || key.span().start..value.span().end;
            let Some(range) = KeyRange::of(key.get_ref(), ranges) else { return Ok(()) };
            range.check_all(key.get_ref(), value.get_ref()).map_err(|e| self.pointed(e, span()))
        });
        let mut part = |keys: &[&str]| -> DeTable<'_> {
            keys.iter().filter(|key| beside.contains(key)).filter_map(|key| rows.remove_entry(*key)).collect()
        };
        let (named, channel, reading) = (part(&NAMED), part(&Channel::KEYS), part(&Reading::KEYS));
        let text = locate::written(&self.text, &beside);
        let complaint = |e: Error| e.in_file(self.path());
        let keys = text.read(&rows, head.clone()).map_err(complaint)?;
        let Named { name, file } = text.read(&named, head.clone()).map_err(complaint)?;
        let channel = text.read(&channel, head.clone()).map_err(complaint)?;
        let reading = text.read(&reading, head.clone()).map_err(complaint)?;
        Ok((Entry { name, file, channel, reading, keys, number, head, places }, in_range))
    }

    /// The text of all keys and values of a table.
    pub(crate) fn stated_in<K>(&self, entry: &Entry<K>) -> String {
        let words = entry.places.iter().map(|(_, span)| &self.text[span.clone()]);
        words.collect::<Vec<&str>>().join("\n")
    }

    /// An error about a table. It points at the line of the key that the error has as its setting, else at
    /// the table.
    pub(crate) fn fault<K>(&self, entry: &Entry<K>, error: Error) -> Error {
        let place = |key| entry.places.iter().find(|(name, _)| name == key);
        let span = error.settings().find_map(place).map_or(&entry.head, |(_, span)| span).clone();
        self.pointed(error, span)
    }

    /// The error with its line in the file.
    pub(super) fn pointed(&self, error: Error, span: Range<usize>) -> Error {
        error.named_in(self.path()).excerpt(&self.text, span)
    }
}

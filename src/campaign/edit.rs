//! The text of a campaign changed in one place, with all else as it was written.

use super::locate::written;
use super::{Campaign, KeyMeaning};
use crate::error::{Error, Result};
use crate::record::shown;
use std::ops::Range;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// A table of records as it is written in a campaign.
#[derive(Debug, Clone, PartialEq, Eq, serde::Serialize)]
pub struct WrittenTable {
    /// `sweep` for `[[sweep]]`.
    pub section: String,
    /// Its number in the section, from 1.
    pub number: usize,
    /// Its first line, from 1.
    pub line: usize,
    /// Its keys.
    pub keys: Vec<WrittenKey>,
}

/// A key of a table as it is written.
#[derive(Debug, Clone, PartialEq, Eq, serde::Serialize)]
pub struct WrittenKey {
    /// Its name.
    pub key: String,
    /// Its value as TOML.
    pub value: String,
    /// Its line, from 1.
    pub line: usize,
    /// Bytes of the key with its value.
    #[serde(skip)]
    row: Range<usize>,
}

impl WrittenTable {
    /// The tables of records of a text, in its order.
    ///
    /// # Errors
    /// If it is not TOML.
    pub fn all(text: &str) -> Result<Vec<WrittenTable>> {
        let mut tables = Vec::new();
        for (section, all) in &written(text, &[]).parse()? {
            let DeValue::Array(all) = all.get_ref() else { continue };
            for (number, table) in (1..).zip(all) {
                let Some(keys) = table.get_ref().as_table() else { continue };
                let begins = table.span().start;
                tables.push((begins, WrittenTable::of(text, section.get_ref(), number, begins, keys)));
            }
        }
        tables.sort_by_key(|(begins, _)| *begins);
        Ok(tables.into_iter().map(|(_, table)| table).collect())
    }

    fn of(text: &str, section: &str, number: usize, begins: usize, keys: &DeTable<'_>) -> WrittenTable {
        let line = |at: usize| 1 + text[..at].matches('\n').count();
        let mut all = Vec::new();
        for (key, value) in keys {
            let row = key.span().start..value.span().end;
            let (key, value) = (key.get_ref().to_string(), text[Spanned::span(value)].to_owned());
            all.push(WrittenKey { key, value, line: line(row.start), row });
        }
        all.sort_by_key(|one| one.row.start);
        WrittenTable { section: section.to_owned(), number, line: line(begins), keys: all }
    }

    /// The value of a key as TOML.
    pub fn value(&self, key: &str) -> Option<&str> {
        self.keys.iter().find(|one| one.key == key).map(|one| one.value.as_str())
    }

    /// The text with a key of the table set to a value in TOML; without a value it becomes the comment
    /// `# KEY =`, or a comment as a whole where its value has several lines. `# KEY =` in the table makes
    /// room for its key.
    fn with(&self, text: &str, key: &str, value: &str) -> String {
        let line = format!("{key} = {value}");
        let newline = if text.contains("\r\n") { "\r\n" } else { "\n" };
        let ends = |at: usize| text[at..].find('\n').map_or(text.len(), |n| at + n + 1);
        let replaced =
            |range: Range<usize>, by: &str| format!("{}{by}{}", &text[..range.start], &text[range.end..]);
        if let Some(WrittenKey { row, .. }) = self.keys.iter().find(|one| one.key == key) {
            let own = &text[row.clone()];
            let emptied = if own.contains('\n') { commented(own) } else { format!("# {key} =") };
            return replaced(row.clone(), if value.is_empty() { &emptied } else { &line });
        }
        if value.is_empty() {
            return text.to_owned();
        }
        let head = ends(text.split_inclusive('\n').take(self.line - 1).map(str::len).sum());
        let last = self.keys.iter().map(|one| ends(one.row.end)).max().unwrap_or(head);
        // Its comments: from the head to the first blank line or table behind the last key.
        let mut at = head;
        for row in text[head..].split_inclusive('\n') {
            let plain = row.trim_start();
            if at >= last && (plain.is_empty() || plain.trim_start_matches(['#', ' ']).starts_with('[')) {
                break;
            }
            let comment = row.strip_prefix('#').and_then(|row| row.trim_start().strip_prefix(key));
            let rest = comment.and_then(|rest| rest.trim_start().strip_prefix('='));
            if let Some(note) = rest.map(str::trim).filter(|rest| rest.is_empty() || rest.starts_with('#')) {
                // What a proposal says of a key without a value holds no longer.
                let own =
                    !note.is_empty() && !["# missing", "# open"].iter().any(|own| note.starts_with(own));
                let note = if own { format!("  {note}") } else { String::new() };
                return replaced(at..at + row.len(), &format!("{line}{note}{newline}"));
            }
            at += row.len();
        }
        let broken = if text[..last].ends_with('\n') { "" } else { newline };
        replaced(last..last, &format!("{broken}{line}{newline}"))
    }

    /// The text with the table in another section; it ends before the line `next`. Keys that the section does
    /// not know become comments. Those of one line name the section they are of; where an earlier move made
    /// such comments of keys of this section, they are keys again.
    fn moved(&self, text: &str, section: &str, next: Option<usize>) -> String {
        let known: Vec<&str> = KeyMeaning::of(section).map(|one| one.key).collect();
        let mut text = text.to_owned();
        for WrittenKey { row, .. } in self.keys.iter().rev().filter(|one| !known.contains(&one.key.as_str()))
        {
            let own = &text[row.clone()];
            let of = format!("# {own}  # of [[{}]]", self.section);
            let comment = if own.contains('\n') { commented(own) } else { of };
            text.replace_range(row.clone(), &comment);
        }
        let mark = format!("  # of [[{section}]]");
        let again = |row: &str| {
            let (key, note) = row.trim_start().strip_prefix("# ")?.split_once(&mark)?;
            let name = key.split('=').next().unwrap_or_default().trim();
            self.value(name).is_none().then(|| format!("{key}{note}"))
        };
        let row = |(number, row): (usize, &str)| match () {
            () if number == self.line => row.replacen(&self.section, section, 1),
            () if number < self.line || next.is_some_and(|next| number >= next) => row.to_owned(),
            () => again(row).unwrap_or_else(|| row.to_owned()),
        };
        (1..).zip(text.split_inclusive('\n')).map(row).collect()
    }
}

/// Rows of TOML as a comment.
fn commented(rows: &str) -> String {
    format!("# {}", rows.replace('\n', "\n# "))
}

impl Campaign {
    /// The text of a campaign with a key of one table of records set to a value in TOML. An empty value
    /// leaves the key as a comment without a value. All else stays as it is written.
    ///
    /// ```
    /// use vibroimpact::campaign::Campaign;
    /// let text = "[[decay]]\nfile = \"a.csv\"   # let go\n# band =\n\n[[pulse]]\nduration = 1e-3\n";
    /// let with = Campaign::text_with(text, ("decay", 1), "band", "[40, 80]")?;
    /// assert_eq!(with, text.replace("# band =", "band = [40, 80]"));
    /// # Ok::<(), vibroimpact::Error>(())
    /// ```
    ///
    /// # Errors
    /// If the text or the value is not TOML, or there is no such table.
    pub fn text_with(text: &str, table: (&str, usize), key: &str, value: &str) -> Result<String> {
        let (section, number) = table;
        let changed = Campaign::written_table(text, table)?.with(text, key, value);
        // A value such as `1\nfile = 2` would be more than a value.
        let rest = |text: &str| -> Result<(toml::Table, Option<toml::Value>)> {
            let whole = written(text, &[]);
            let mut all: toml::Table = whole.read(&whole.parse()?, 0..0)?;
            let tables = all.get_mut(section).and_then(toml::Value::as_array_mut);
            let table = tables.and_then(|tables| tables.get_mut(number - 1)?.as_table_mut());
            let own = table.and_then(|table| table.remove(key));
            Ok((all, own))
        };
        let ((before, _), (after, own)) = (rest(text)?, rest(&changed)?);
        if before != after || own.is_none() != value.is_empty() {
            let found = format!("{key} = {}", shown(value));
            return Err(Error::usage(found, "one value: a number, true, \"text\" or [1, 2]"));
        }
        Ok(changed)
    }

    /// The text of a campaign with one table of records in another section. Keys that this section does not
    /// know become comments, and those of one line keys again when the table moves back. All else stays as it
    /// is written.
    ///
    /// ```
    /// use vibroimpact::campaign::Campaign;
    /// let text = "[[impacts]]\nfile = \"a.csv\"\nenvelope = true\n";
    /// let moved = Campaign::text_of_kind(text, ("impacts", 1), "drop")?;
    /// assert_eq!(moved, "[[drop]]\nfile = \"a.csv\"\n# envelope = true  # of [[impacts]]\n");
    /// assert_eq!(Campaign::text_of_kind(&moved, ("drop", 1), "impacts")?, text);
    /// # Ok::<(), vibroimpact::Error>(())
    /// ```
    ///
    /// # Errors
    /// If the text is not TOML, or there is no such table or section.
    pub fn text_of_kind(text: &str, table: (&str, usize), section: &str) -> Result<String> {
        if KeyMeaning::of(section).next().is_none() {
            return Err(Error::usage(format!("no kind [[{}]]", shown(section)), "a kind of record"));
        }
        let found = Campaign::written_table(text, table)?;
        let head = text.lines().nth(found.line - 1).unwrap_or_default();
        if !head.trim_start().starts_with("[[") {
            return Err(Error::usage(shown(head), format!("a table that begins with [[{}]]", table.0)));
        }
        let lines = WrittenTable::all(text)?.into_iter().map(|table| table.line);
        let moved = found.moved(text, section, lines.filter(|line| *line > found.line).min());
        WrittenTable::all(&moved)?;
        Ok(moved)
    }

    fn written_table(text: &str, (section, number): (&str, usize)) -> Result<WrittenTable> {
        let mut all = WrittenTable::all(text)?.into_iter();
        let found = all.find(|table| (table.section.as_str(), table.number) == (section, number));
        found.ok_or_else(|| {
            Error::usage(format!("no table {number} of [[{}]]", shown(section)), "a table of the campaign")
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_table_moves_to_another_section_with_the_keys_that_it_knows() {
        let moved = Campaign::text_of_kind(TEXT, ("drop", 2), "decay").unwrap();
        let (head, tail) = TEXT.rsplit_once("[[drop]]").unwrap();
        assert_eq!(moved, format!("{head}[[decay]]{tail}"));
        let noted = TEXT.replace("height = 1", "height = 1  # weighed");
        let there = Campaign::text_of_kind(&noted, ("drop", 1), "decay").unwrap();
        assert_eq!(Campaign::text_of_kind(&there, ("decay", 1), "drop").unwrap(), noted);
        let moved = Campaign::text_of_kind(TEXT, ("drop", 1), "decay").unwrap();
        let expected =
            TEXT.replacen("[[drop]]", "[[decay]]", 1).replace("height = 1", "# height = 1  # of [[drop]]");
        assert_eq!(moved, expected);
        assert_eq!(Campaign::text_of_kind(&moved, ("decay", 1), "drop").unwrap(), TEXT);
        let lines = "[[drop]]\nheight = 1\nfile = \"a\"\nintervals = [\n  1,\n  2,\n]\nmasses = [1, 2]\n";
        let moved = Campaign::text_of_kind(lines, ("drop", 1), "pulse").unwrap();
        assert_eq!(
            moved,
            "[[pulse]]\n# height = 1  # of [[drop]]\nfile = \"a\"\n# intervals = [\n#   1,\n#   2,\n# ]\n# masses = [1, 2]  # of [[drop]]\n"
        );
        // A drill has a key of its own for its channel.
        let heard = "[[impacts]]\nfile = \"a\"\nchannel = \"b\"\n";
        let moved = Campaign::text_of_kind(heard, ("impacts", 1), "drill").unwrap();
        assert_eq!(moved, "[[drill]]\nfile = \"a\"\n# channel = \"b\"  # of [[impacts]]\n");
        assert_eq!(Campaign::text_of_kind(&moved, ("drill", 1), "impacts").unwrap(), heard);
        // A key that was set meanwhile stays, and so does what another table has as a comment.
        let twice = "[[impacts]]\nfile = \"a\"\nthreshold = 0.2\n# threshold = 0.1  # of [[drop]]\n  [[decay]]\n# band = 1  # of [[drop]]\n";
        let moved = Campaign::text_of_kind(twice, ("impacts", 1), "drop").unwrap();
        assert_eq!(moved, twice.replacen("impacts", "drop", 1));
        assert!(Campaign::text_of_kind(TEXT, ("drop", 1), "bell").is_err());
        let inline = "drop = [{ file = \"a\" }, { file = \"b\" }]\n";
        assert!(Campaign::text_of_kind(inline, ("drop", 2), "decay").is_err());
    }

    const TEXT: &str = "name = \"x\"\n\n[[drop]]\nfile = \"a.csv\"  # first\nheight = 1\n\n# of the second\n[[drop]]\nfile = \"b.csv\"";

    #[test]
    fn a_key_is_set_in_its_table_and_nothing_else_changes() {
        let set = |number, key, value| Campaign::text_with(TEXT, ("drop", number), key, value);
        assert_eq!(set(1, "height", "0.5").unwrap(), TEXT.replace("height = 1", "height = 0.5"));
        assert_eq!(set(1, "height", "").unwrap(), TEXT.replace("height = 1\n", "# height =\n"));
        let noted = "[[drop]]\nfile = \"a\"  # first\nintervals = [1,\n 2]  # both\n";
        let emptied = Campaign::text_with(noted, ("drop", 1), "intervals", "").unwrap();
        assert_eq!(emptied, "[[drop]]\nfile = \"a\"  # first\n# intervals = [1,\n#  2]  # both\n");
        let windows = "[[drop]]\r\nheight = 1  # by tape\r\n";
        let emptied = Campaign::text_with(windows, ("drop", 1), "height", "").unwrap();
        assert_eq!(emptied, windows.replace("height = 1", "# height ="));
        assert_eq!(Campaign::text_with(&emptied, ("drop", 1), "height", "1").unwrap(), windows);
        assert_eq!(set(2, "height", "0.5").unwrap(), format!("{TEXT}\nheight = 0.5\n"));
        assert_eq!(
            set(1, "contact_time", "1e-3").unwrap(),
            TEXT.replace("height = 1\n", "height = 1\ncontact_time = 1e-3\n")
        );
        assert_eq!(set(1, "band", "").unwrap(), TEXT);
    }

    /// A comment of the next table, or one that a person wrote, is not taken for the place of a key.
    #[test]
    fn only_an_empty_comment_of_the_table_makes_room() {
        let text = "[[drop]]\nfile = \"a\"\n# height =   # missing: m\n\n#[[drop]]\n#file = \"b\"\n#height =   # missing\n";
        let set = |text: &str, value| Campaign::text_with(text, ("drop", 1), "height", value);
        let filled = set(text, "1").unwrap();
        assert_eq!(filled, text.replace("# height =   # missing: m", "height = 1"));
        let again = set(&set(&filled, "").unwrap(), "2").unwrap();
        assert!(again.contains("height = 2\n") && again.contains("#height =   # missing\n"), "{again}");
        let noted = "[[drop]]\nfile = \"a\"\n# height = 1 was too low\n";
        assert_eq!(set(noted, "2").unwrap(), noted.replace("\n# h", "\nheight = 2\n# h"));
        assert!(Campaign::text_with("drop = [{ file = \"a\" }]\n", ("drop", 1), "height", "1").is_err());
        let indented = "[[drop]]\r\nfile = \"a\"\r\n  [[drop]]\r\n# height =\r\n";
        assert!(set(indented, "1").is_ok_and(|text| text.contains("\"a\"\r\nheight = 1\r\n  [[drop]]")));
    }

    #[test]
    fn what_is_no_value_is_refused() {
        for value in ["1\nfile = 2", "0,5", "\"", "1 [[drop]]", "1\n[[decay]]\nfile = \"c\""] {
            assert!(Campaign::text_with(TEXT, ("drop", 1), "height", value).is_err(), "{value:?}");
        }
        assert!(Campaign::text_with(TEXT, ("drop", 3), "height", "1").is_err());
    }

    #[test]
    fn tables_are_listed_as_they_are_written() {
        let all = WrittenTable::all(TEXT).unwrap();
        let seen: Vec<_> =
            all.iter().map(|t| (t.section.as_str(), t.number, t.line, t.value("file"))).collect();
        assert_eq!(seen, [("drop", 1, 3, Some("\"a.csv\"")), ("drop", 2, 8, Some("\"b.csv\""))]);
    }
}

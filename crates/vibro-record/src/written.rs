//! Values that a person writes as TOML. Errors name the place and the kind of value that is expected; the
//! parser's own messages are replaced wherever the cause is known.

mod node;

use crate::kind::{Kind, meant_number};
use crate::{Error, nearest};
pub use node::named;
use node::{Node, What};
use serde::de::DeserializeOwned;
use std::ops::Range;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// A TOML text, with the names that are known in it.
#[derive(Debug, Clone, Copy, Default)]
pub struct Written<'a> {
    /// The whole text.
    pub text: &'a str,
    /// Keys that are allowed beside those of the type.
    pub beside: &'a [&'a str],
    /// Words that a user may write, with the tables that they mean.
    pub meant: &'a [(&'a str, &'a str)],
}

impl<'a> Written<'a> {
    /// Parses the text into keys and values.
    ///
    /// # Errors
    /// If the text is no TOML: with its line, and what to write instead.
    pub fn parse(&self) -> Result<DeTable<'a>, Error> {
        DeTable::parse(self.text)
            .map(Spanned::into_inner)
            .map_err(|error| self.no_toml(error.message(), error.span().unwrap_or(0..0)))
    }

    /// The error of a text that is no TOML, with what to write instead.
    fn no_toml(&self, why: &str, span: Range<usize>) -> Error {
        if let Some(open) = self.unclosed(span.start) {
            return open;
        }
        let line = line_at(self.text, span.start);
        let head = with_number(line).unwrap_or(uncommented(line));
        let told = |found: &str, expected: &str, hint: String| {
            Error::usage(found, expected).excerpt(self.text, span.clone()).hint(hint)
        };
        let before = &self.text[..start_of_line(self.text, span.start)];
        let stands_twice = is_toml(line) && !line.is_empty() && is_toml(before);
        if stands_twice {
            told(line, "every key once in a table", "remove this line, or the other one".to_owned())
        } else if let Some(meant) = head_of_tables(head) {
            told(line, "two brackets on both sides", format!("write {meant}"))
        } else if let Some(key) = head.strip_suffix('=') {
            let key = key.trim_end();
            told(&format!("{key} has no value"), "", format!("put # in front of it: # {key} ="))
        } else if let Some((expected, meant)) = respelt(head) {
            told(head, &expected, format!("write {meant}"))
        } else {
            told(why, "", String::new())
        }
    }

    /// For a list without its closing bracket, which the parser misses only further down, at `at`: the error
    /// at the line that opens the list.
    fn unclosed(&self, at: usize) -> Option<Error> {
        let begin = start_of_line(self.text, at.min(self.text.len()));
        let (above, line) = (self.text[..begin].trim_end(), line_at(self.text, begin));
        if is_toml(above) || !(line.is_empty() || is_toml(uncommented(line))) {
            return None;
        }
        let starts = above.rmatch_indices('\n').map(|(end, _)| end + 1).chain([0]);
        let open = starts.into_iter().find(|start| is_toml(&self.text[..*start]))?;
        let head = uncommented(line_at(self.text, open));
        let meant = if start_of_line(above, above.len()) == open { respelt(head) } else { None };
        let closed =
            || is_toml(&format!("{above}\n]")).then(|| ("a bracket that closes the list".to_owned(), "]"));
        let (expected, hint) = match meant {
            Some((expected, meant)) => (expected, format!("write {meant}")),
            None => closed().map(|(expected, mark)| {
                (expected, format!("write {mark} in a line of its own before {line}"))
            })?,
        };
        Some(Error::usage(head, expected).excerpt(self.text, open..open + head.len()).hint(hint))
    }

    /// Reads a table, at the bytes `span`, as a type.
    ///
    /// # Errors
    /// With the line of an unknown or missing key or of a value of the wrong kind, and what to write instead;
    /// that has been tried, so the type accepts it.
    pub fn read<T: DeserializeOwned>(&self, table: &DeTable<'a>, span: Range<usize>) -> Result<T, Error> {
        T::deserialize(Node::table(table.clone(), &span)).map_err(|fault| {
            let at = fault.span.clone().unwrap_or_default();
            let takes = |meant: &str| {
                let text = format!("x = {meant}");
                let mut table: DeTable<'_> = table.clone();
                let parsed = DeTable::parse(&text).ok().and_then(|parsed| parsed.into_inner().remove("x"));
                let changed = parsed.and_then(|value| put(&mut table, &at, value.into_inner()));
                let again = T::deserialize(Node::table(table, &span)).err().and_then(|fault| fault.span);
                changed.is_some() && again.is_none_or(|span| span.start > at.end || span.end < at.start)
            };
            self.told(fault.what, at.clone(), takes)
        })
    }

    /// The error for a fault at these bytes.
    fn told(&self, what: What, at: Range<usize>, takes: impl Fn(&str) -> bool) -> Error {
        let line = line_at(self.text, at.start);
        let (stated, head) = (&self.text[at.clone()], uncommented(line));
        let told = |found: &str, expected: &str, hint: String| {
            Error::usage(found, expected).excerpt(self.text, at.clone()).hint(hint)
        };
        // The line with another text at this place.
        let with = |meant: &str| {
            let before = self.text[start_of_line(self.text, at.start)..at.start].trim_start();
            let behind = self.text[at.end..].lines().next().map_or("", uncommented);
            format!("write {before}{meant}{behind}")
        };
        match what {
            What::UnknownKey(key, known) => self.unknown_key(&key, known, line, told),
            What::UnknownName(name, kind) => {
                let near = kind.meant("", &name).map(|near| format!("did you mean `{near}`?"));
                told(&format!("the name `{name}`"), &kind.words("\""), near.unwrap_or_default())
            }
            What::MissingKey(key) => {
                told(&format!("the key `{key}` is missing"), "", format!("add {key} = …"))
            }
            What::Twice(key) => {
                told(&format!("{key} stands twice"), "every key once in a table", "remove one".to_owned())
            }
            What::Value(Kind::Table) if line.starts_with("[[") => {
                let single = head.replace("[[", "[").replace("]]", "]");
                told(
                    &format!("{head} begins one table of several"),
                    "a single table",
                    format!("write {single}"),
                )
            }
            What::Value(_) if stated.contains('\n') => told(line, "", String::new()),
            What::Value(kind) => {
                let key = head.split_once('=').map_or("", |(key, _)| key.trim());
                let meant = values(key, stated, Some(&kind)).into_iter().find(|(_, meant)| takes(meant));
                let (expected, hint) = meant.map(|(expected, meant)| (expected, with(&meant))).unzip();
                let huge =
                    matches!(kind, Kind::Whole(..)) && stated.parse::<f64>().is_ok_and(|n| n.abs() > 1e15);
                let none = || if huge { format!("put # in front of it: # {head}") } else { String::new() };
                let expected = expected.unwrap_or_else(|| kind.words("\""));
                told(head, &expected, hint.unwrap_or_else(none))
            }
            What::Other(words) => told(&words, "", String::new()),
        }
    }

    fn unknown_key(
        &self,
        key: &str,
        known: &[&str],
        line: &str,
        told: impl Fn(&str, &str, String) -> Error,
    ) -> Error {
        let known = [self.beside, known].concat();
        let (what, meant) = if line.starts_with('[') { ("table", self.meant) } else { ("key", &[][..]) };
        let called = meant.iter().find(|(word, _)| *word == key);
        let called = called.map(|(_, table)| format!("write [[{table}]]"));
        let near = || nearest(key, known.iter().copied()).map(|near| format!("did you mean `{near}`?"));
        let all = || format!("{what}s known here: {}", known.join(", "));
        told(&format!("unknown {what} `{key}`"), "", called.or_else(near).unwrap_or_else(all))
    }
}

/// Puts another value at a place; `None` where no value is there.
fn put<'i>(table: &mut DeTable<'i>, at: &Range<usize>, value: DeValue<'i>) -> Option<()> {
    let mut left: Vec<&mut Spanned<DeValue<'i>>> = table.iter_mut().map(|(_, value)| value).collect();
    while let Some(one) = left.pop() {
        if one.span() == *at {
            *one.get_mut() = value;
            return Some(());
        }
        match one.get_mut() {
            DeValue::Array(all) => left.extend(all.iter_mut()),
            DeValue::Table(rows) => left.extend(rows.iter_mut().map(|(_, value)| value)),
            _ => {}
        }
    }
    None
}

/// Values that may be meant by a text, in the order in which they are tried, each with the kind that was
/// expected. For text that is no TOML the kind is not known.
fn values(key: &str, stated: &str, kind: Option<&Kind>) -> Vec<(String, String)> {
    let bare = stated.trim_matches(['"', '\'', '“', '”']).trim();
    let word = bare.to_lowercase();
    let is = |words: [&str; 4]| words.contains(&&*word);
    let is_name = bare.starts_with(char::is_alphabetic);
    let number = meant_number(key, bare);
    let of_number = match &number {
        Some(meant) if bare.contains(',') && !meant.contains('.') => "digits without commas between them",
        _ if bare.contains(',') => "a number with a decimal point",
        _ if bare.starts_with('.') => "a digit before the point",
        _ if bare.ends_with('.') => "a digit behind the point",
        _ if bare.parse::<f64>().is_ok() => "a number without quotes",
        _ => "a number in the unit of this key, without it",
    };
    let words = kind.map_or_else(String::new, |kind| kind.words("\""));
    let list = stated.strip_prefix('[').map(|rest| rest.strip_suffix(']').unwrap_or(rest).trim());
    let closed = |inner: String| format!("[{inner}]");
    let between_blanks = |inner: &&str| !inner.contains([',', ';', '"', '\'']) && inner.contains(' ');
    let by_blanks = |inner: &str| closed(inner.split_whitespace().collect::<Vec<_>>().join(", "));
    let none = kind.is_none() && key.ends_with("_pass") && is(["no", "off", "none", "false"]);
    let two = bare.split_once([':', '-', ';']).map(|(low, high)| format!("[{low}, {high}]"));
    let first = if let Some(Kind::Names(names)) = kind { names.first() } else { None };
    let quoted = |text: String| format!("\"{text}\"");
    let is_text = matches!(kind, Some(Kind::Text));
    let whole = matches!(kind, Some(Kind::Whole(..)));
    let near = kind.filter(|_| !whole).and_then(|kind| kind.meant(key, bare)).map(quoted);
    let all = [
        (&*words, near),
        ("no mark behind a value", stated.strip_suffix([',', ';']).map(str::to_owned)),
        ("a whole number", kind.filter(|_| whole).and_then(|kind| kind.meant(key, bare))),
        (of_number, number.clone()),
        (CORNER, none.then(|| quoted("none".to_owned()))),
        ("true or false", is(["yes", "on", "1", "true"]).then(|| "true".to_owned())),
        ("true or false", is(["no", "off", "0", "false"]).then(|| "false".to_owned())),
        (&words, is(["no", "off", "0", "false"]).then(|| quoted("none".to_owned()))),
        ("commas between values", stated.starts_with('[').then(|| stated.replace(';', ","))),
        ("commas between values", list.filter(between_blanks).map(by_blanks)),
        ("a bracket that closes the list", list.map(|inner| closed(inner.replace(';', ",")))),
        ("two values between square brackets", two),
        ("a path between single quotes", bare.contains('\\').then(|| format!("'{bare}'"))),
        ("text between quotes", (is_name || is_text).then(|| quoted(bare.to_owned()))),
        (&words, matches!(kind, Some(Kind::List)).then(|| format!("[{stated}]"))),
        (&words, first.map(|first| quoted((*first).to_owned()))),
    ];
    all.into_iter().filter_map(|(expected, meant)| Some((expected.to_owned(), meant?))).collect()
}

/// Value of a key for a low-pass.
const CORNER: &str = "a corner in Hz, or \"none\"";

/// The line that may be meant by one that is no TOML, with what was expected.
fn respelt(line: &str) -> Option<(String, String)> {
    let at = line.find(['=', ':'])?;
    let (key, stated) = (line[..at].trim(), line[at + 1..].trim());
    let own = key.replace(' ', "_");
    let mut all = values(key, stated, None);
    if own != key || line[at..].starts_with(':') {
        let expected = "an equals sign behind a key of one word";
        for (known, _) in &mut all {
            expected.clone_into(known);
        }
        all.insert(0, (expected.to_owned(), stated.to_owned()));
    }
    let lines = all.into_iter().map(|(expected, meant)| (expected, format!("{own} = {meant}")));
    lines.into_iter().find(|(_, meant)| is_toml(meant))
}

fn is_toml(text: &str) -> bool {
    DeTable::parse(text).is_ok()
}

/// A line, or part of one, without the comment at its end.
fn uncommented(line: &str) -> &str {
    let (mut open, mut escaped) = (None, false);
    let is_comment = |c: char| {
        match open {
            None if matches!(c, '"' | '\'') => open = Some(c),
            Some(quote) if c == quote && !escaped => open = None,
            _ => {}
        }
        escaped = c == '\\' && open == Some('"') && !escaped;
        c == '#' && open.is_none()
    };
    line.split(is_comment).next().unwrap_or_default().trim_end()
}

/// A line whose value is a word with a number after it, `name = Run #1`: the number is no comment.
fn with_number(line: &str) -> Option<&str> {
    let (before, number) = line.rsplit_once(" #")?;
    let (_, word) = before.split_once('=')?;
    let is_number = !number.is_empty() && number.bytes().all(|b| b.is_ascii_digit());
    (is_number && word.trim_start().starts_with(char::is_alphabetic)).then_some(line)
}

/// The correct head, in double brackets, for a line whose brackets do not match.
fn head_of_tables(head: &str) -> Option<String> {
    let name = head.trim_start_matches('[').trim_end_matches(']');
    let outside = head.len() - name.len();
    let odd = !name.contains(['[', ']', '=']) && (head.starts_with("[[") || head.ends_with("]]"));
    (odd && outside == 3).then(|| format!("[[{}]]", name.trim()))
}

/// Start of the line that contains byte `at`.
fn start_of_line(text: &str, at: usize) -> usize {
    text.get(..at).and_then(|before| before.rfind('\n')).map_or(0, |end| end + 1)
}

/// The line that contains byte `at`, without blanks at its ends.
fn line_at(text: &str, at: usize) -> &str {
    text.get(start_of_line(text, at)..).and_then(|rest| rest.lines().next()).unwrap_or_default().trim()
}

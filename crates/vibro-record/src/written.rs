//! Values that a person writes as TOML. Errors name the place and the kind of value that is expected; the
//! parser's own messages are replaced wherever the cause is known.

mod node;

use crate::kind::{Kind, meant_number};
use crate::{Error, nearest};
pub use node::named;
use node::{FaultKind, Node};
use serde::de::DeserializeOwned;
use std::ops::Range;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// A TOML text, with the names that it may use beside those of the type that is read.
#[derive(Debug, Clone, Copy, Default)]
pub struct Written<'a> {
    /// The whole text.
    pub text: &'a str,
    /// Keys that are known beside those of the type: the error for an unknown key lists and suggests them,
    /// too.
    pub extra_keys: &'a [&'a str],
    /// (Word that a user may write as the name of a table, correct name of that table.)
    pub table_synonyms: &'a [(&'a str, &'a str)],
}

impl<'a> Written<'a> {
    /// Parses the text into keys and values.
    ///
    /// # Errors
    /// If the text is no TOML: with its line, and what to write instead.
    pub fn parse(&self) -> Result<DeTable<'a>, Error> {
        DeTable::parse(self.text)
            .map(Spanned::into_inner)
            .map_err(|error| self.syntax_error(error.message(), error.span().unwrap_or(0..0)))
    }

    /// Error for a text that is no TOML, with the correct line where one is found. `why` is the parser's
    /// message, `span` are the bytes that it reports.
    fn syntax_error(&self, why: &str, span: Range<usize>) -> Error {
        if let Some(error) = self.unclosed_list(span.start) {
            return error;
        }
        let line = line_at(self.text, span.start);
        let head = with_number(line).unwrap_or(uncommented(line));
        let error = |found: &str, expected: &str, hint: String| {
            Error::usage(found, expected).excerpt(self.text, span.clone()).hint(hint)
        };
        let before = &self.text[..start_of_line(self.text, span.start)];
        // The line is correct by itself, and so is the text before it: together they define a key twice.
        let is_repeated = is_toml(line) && !line.is_empty() && is_toml(before);
        if is_repeated {
            error(line, "every key once in a table", "remove this line, or the other one".to_owned())
        } else if let Some(repaired) = head_of_tables(head) {
            error(line, "two brackets on both sides", format!("write {repaired}"))
        } else if let Some(key) = head.strip_suffix('=') {
            let key = key.trim_end();
            error(&format!("{key} has no value"), "", format!("put # in front of it: # {key} ="))
        } else if let Some((expected, repaired)) = repaired_line(head) {
            error(head, &expected, format!("write {repaired}"))
        } else {
            error(why, "", String::new())
        }
    }

    /// Error for a list that is never closed, shown at the line that opens it. The parser reports it at a
    /// later byte, `at`. `None` if no list is open.
    fn unclosed_list(&self, at: usize) -> Option<Error> {
        let begin = start_of_line(self.text, at.min(self.text.len()));
        let (above, line) = (self.text[..begin].trim_end(), line_at(self.text, begin));
        if is_toml(above) || !(line.is_empty() || is_toml(uncommented(line))) {
            return None;
        }
        let starts = above.rmatch_indices('\n').map(|(end, _)| end + 1).chain([0]);
        let open = starts.into_iter().find(|start| is_toml(&self.text[..*start]))?;
        let head = uncommented(line_at(self.text, open));
        let has_one_line = start_of_line(above, above.len()) == open;
        let repaired = if has_one_line { repaired_line(head) } else { None };
        let closed =
            || is_toml(&format!("{above}\n]")).then(|| ("a bracket that closes the list".to_owned(), "]"));
        let (expected, hint) = match repaired {
            Some((expected, repaired)) => (expected, format!("write {repaired}")),
            None => closed().map(|(expected, mark)| {
                (expected, format!("write {mark} in a line of its own before {line}"))
            })?,
        };
        Some(Error::usage(head, expected).excerpt(self.text, open..open + head.len()).hint(hint))
    }

    /// Reads a table, which fills the bytes `span` of the text, as the type `T`.
    ///
    /// # Errors
    /// With the line of an unknown or missing key or of a value of the wrong kind, and its correction. A
    /// value is suggested only if the table reads without a fault at that place once it is put in.
    pub fn read<T: DeserializeOwned>(&self, table: &DeTable<'a>, span: Range<usize>) -> Result<T, Error> {
        T::deserialize(Node::table(table.clone(), &span)).map_err(|fault| {
            let at = fault.span.clone().unwrap_or_default();
            let accepts = |replacement: &str| {
                let text = format!("x = {replacement}");
                let mut table: DeTable<'_> = table.clone();
                let parsed = DeTable::parse(&text).ok().and_then(|parsed| parsed.into_inner().remove("x"));
                let changed = parsed.and_then(|value| put(&mut table, &at, value.into_inner()));
                let again = T::deserialize(Node::table(table, &span)).err().and_then(|fault| fault.span);
                changed.is_some() && again.is_none_or(|span| span.start > at.end || span.end < at.start)
            };
            self.error_for(fault.what, at.clone(), &accepts)
        })
    }

    /// Error for a fault at the bytes `span`. `accepts` tries a replacement text in place of the value.
    fn error_for(&self, fault: FaultKind, span: Range<usize>, accepts: &dyn Fn(&str) -> bool) -> Error {
        let line = line_at(self.text, span.start);
        let (stated, head) = (&self.text[span.clone()], uncommented(line));
        let error = |found: &str, expected: &str, hint: String| {
            Error::usage(found, expected).excerpt(self.text, span.clone()).hint(hint)
        };
        let hint_with = |replacement: &str| {
            let before = self.text[start_of_line(self.text, span.start)..span.start].trim_start();
            let behind = self.text[span.end..].lines().next().map_or("", uncommented);
            format!("write {before}{replacement}{behind}")
        };
        match fault {
            FaultKind::UnknownKey(key, known) => self.unknown_key(&key, known, line, error),
            FaultKind::UnknownName(name, kind) => {
                let near = kind.meant("", &name).map(|near| format!("did you mean `{near}`?"));
                error(&format!("the name `{name}`"), &kind.words("\""), near.unwrap_or_default())
            }
            FaultKind::MissingKey(key) => {
                error(&format!("the key `{key}` is missing"), "", format!("add {key} = …"))
            }
            FaultKind::Twice(key) => {
                error(&format!("{key} stands twice"), "every key once in a table", "remove one".to_owned())
            }
            FaultKind::WrongValue(Kind::Table) if line.starts_with("[[") => {
                let single = head.replace("[[", "[").replace("]]", "]");
                error(
                    &format!("{head} begins one table of several"),
                    "a single table",
                    format!("write {single}"),
                )
            }
            FaultKind::WrongValue(_) if stated.contains('\n') => error(line, "", String::new()),
            FaultKind::WrongValue(kind) => {
                let key = head.split_once('=').map_or("", |(key, _)| key.trim());
                let repair =
                    repairs(key, stated, Some(&kind)).into_iter().find(|(_, repaired)| accepts(repaired));
                let (expected, hint) =
                    repair.map(|(expected, repaired)| (expected, hint_with(&repaired))).unzip();
                let huge =
                    matches!(kind, Kind::Whole(..)) && stated.parse::<f64>().is_ok_and(|n| n.abs() > 1e15);
                let unrepaired =
                    || if huge { format!("put # in front of it: # {head}") } else { String::new() };
                let expected = expected.unwrap_or_else(|| kind.words("\""));
                error(head, &expected, hint.unwrap_or_else(unrepaired))
            }
            FaultKind::Other(words) => error(&words, "", String::new()),
        }
    }

    /// Error for an unknown key or table, with the nearest of the `known` ones, else with all of them. `line`
    /// contains the key; `error` builds an error from (found, expected, hint).
    fn unknown_key(
        &self,
        key: &str,
        known: &[&str],
        line: &str,
        error: impl Fn(&str, &str, String) -> Error,
    ) -> Error {
        let known = [self.extra_keys, known].concat();
        let (what, synonyms) =
            if line.starts_with('[') { ("table", self.table_synonyms) } else { ("key", &[][..]) };
        let synonym = synonyms.iter().find(|(word, _)| *word == key);
        let synonym = synonym.map(|(_, table)| format!("write [[{table}]]"));
        let near = || nearest(key, known.iter().copied()).map(|near| format!("did you mean `{near}`?"));
        let all = || format!("{what}s known here: {}", known.join(", "));
        error(&format!("unknown {what} `{key}`"), "", synonym.or_else(near).unwrap_or_else(all))
    }
}

/// Replaces the value at the bytes `at`, in this table or in one nested in it; `None` if there is none.
fn put<'i>(table: &mut DeTable<'i>, at: &Range<usize>, value: DeValue<'i>) -> Option<()> {
    let mut unsearched: Vec<&mut Spanned<DeValue<'i>>> = table.iter_mut().map(|(_, value)| value).collect();
    while let Some(one) = unsearched.pop() {
        if one.span() == *at {
            *one.get_mut() = value;
            return Some(());
        }
        match one.get_mut() {
            DeValue::Array(all) => unsearched.extend(all.iter_mut()),
            DeValue::Table(rows) => unsearched.extend(rows.iter_mut().map(|(_, value)| value)),
            _ => {}
        }
    }
    None
}

/// Possible corrections of a mistyped value, likeliest first: (what the message says was expected, the
/// corrected text). `stated` is the value as typed. `kind` is the expected kind; it is unknown if the text
/// is no TOML.
fn repairs(key: &str, stated: &str, kind: Option<&Kind>) -> Vec<(String, String)> {
    let bare = stated.trim_matches(['"', '\'', '“', '”']).trim();
    let word = bare.to_lowercase();
    let is = |words: [&str; 4]| words.contains(&&*word);
    let is_name = bare.starts_with(char::is_alphabetic);
    // A count has no unit: `5 s` may mean the samples of five seconds.
    let whole = matches!(kind, Some(Kind::Whole(..)));
    let has_unit = bare.contains(char::is_alphabetic) && bare.parse::<f64>().is_err();
    let number = meant_number(key, bare).filter(|_| !(whole && has_unit));
    let of_number = match &number {
        Some(number) if bare.contains(',') && !number.contains('.') => "digits without commas between them",
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
    // A low-pass or high-pass that is switched off.
    let no_filter = kind.is_none() && key.ends_with("_pass") && is(["no", "off", "none", "false"]);
    let two = bare.split_once([':', '-', ';']).map(|(low, high)| format!("[{low}, {high}]"));
    let first = if let Some(Kind::Names(names)) = kind { names.first() } else { None };
    let quoted = |text: String| format!("\"{text}\"");
    let is_text = matches!(kind, Some(Kind::Text));
    let near = kind.filter(|_| !whole).and_then(|kind| kind.meant(key, bare)).map(quoted);
    let all = [
        (&*words, near),
        ("no mark behind a value", stated.strip_suffix([',', ';']).map(str::to_owned)),
        ("a whole number", kind.filter(|_| whole && !has_unit).and_then(|kind| kind.meant(key, bare))),
        (of_number, number.clone()),
        (CORNER, no_filter.then(|| quoted("none".to_owned()))),
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
    all.into_iter().filter_map(|(expected, repaired)| Some((expected.to_owned(), repaired?))).collect()
}

/// Expected value of a key for the corner frequency of a filter, such as `low_pass`.
const CORNER: &str = "a corner in Hz, or \"none\"";

/// The likeliest correction of a line that is no TOML: (what was expected, the corrected line).
fn repaired_line(line: &str) -> Option<(String, String)> {
    let at = line.find(['=', ':'])?;
    let (typed_key, stated) = (line[..at].trim(), line[at + 1..].trim());
    let key = typed_key.replace(' ', "_");
    let mut all = repairs(typed_key, stated, None);
    if key != typed_key || line[at..].starts_with(':') {
        let expected_here = "an equals sign behind a key of one word";
        for (expected, _) in &mut all {
            expected_here.clone_into(expected);
        }
        all.insert(0, (expected_here.to_owned(), stated.to_owned()));
    }
    let lines = all.into_iter().map(|(expected, repaired)| (expected, format!("{key} = {repaired}")));
    lines.into_iter().find(|(_, repaired)| is_toml(repaired))
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

/// The whole line if its value is text that ends in `#` and a number, `name = Run #1`: the number belongs to
/// the text and is no comment.
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

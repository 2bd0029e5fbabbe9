//! Errors of TOML with their place, a caret, and the nearest key that exists.

use crate::error::{Error, Place};
use std::ops::Range;
use std::path::Path;

/// The parser's complaint as ours.
///
/// `beside` are keys that are known, too.
pub(crate) fn toml_error(path: &Path, text: &str, error: &toml::de::Error, beside: &[&str]) -> Error {
    let span = error.span().unwrap_or(0..0);
    let Told { found, expected, hint } = tell(error.message(), line_at(text, span.start), beside);
    Error::input(Place::file(path), found, expected).excerpt(text, span).hint(hint)
}

/// A complaint in the words of a campaign file.
#[derive(Debug, Default, PartialEq)]
struct Told {
    found: String,
    expected: String,
    hint: String,
}

fn tell(message: &str, line: &str, beside: &[&str]) -> Told {
    if let Some((key, value)) = line.split_once('=')
        && let Some((whole, decimals)) = value.split('#').next().unwrap_or_default().trim().split_once(',')
        && [whole.trim_start_matches(['+', '-']), decimals]
            .iter()
            .all(|d| d.starts_with(|c: char| c.is_ascii_digit()))
        && decimals.chars().all(|c| c.is_ascii_digit() || "eE+-".contains(c))
    {
        let key = key.trim();
        return Told {
            found: format!("{key} = {whole},{decimals}"),
            expected: "a number with a decimal point".to_owned(),
            hint: format!("write {key} = {whole}.{decimals}"),
        };
    }
    let names: Vec<&str> = message.split('`').skip(1).step_by(2).collect();
    if message.starts_with("unknown field")
        && let Some((wrong, known)) = names.split_first()
    {
        return unknown_key(wrong, &[beside, known].concat());
    }
    if message.starts_with("unknown variant")
        && let Some((wrong, known)) = names.split_first()
    {
        let (_, expected) = message.split_once(", expected ").unwrap_or_default();
        let hint = nearest(wrong, known).map(|near| format!("did you mean `{near}`?"));
        return Told {
            found: format!("the name `{wrong}`"),
            expected: expected.to_owned(),
            hint: hint.unwrap_or_default(),
        };
    }
    if message == "duplicate key" {
        return Told {
            found: "this name a second time".to_owned(),
            expected: "each key and each table once".to_owned(),
            hint: "put what belongs to it in one place".to_owned(),
        };
    }
    if let Some(key) = message.strip_prefix("missing field ") {
        let hint = format!("add {} = …", key.trim_matches('`'));
        return Told { found: format!("the key {key} is missing"), hint, ..Told::default() };
    }
    // The parser calls a table that is no list a map, and its names are those of Rust.
    if message.starts_with("invalid type: map") {
        if let Some(name) = line.strip_prefix("[[").and_then(|l| l.split(']').next()) {
            return Told {
                found: format!("[[{name}]] begins one table of several"),
                expected: "a single table".to_owned(),
                hint: format!("write [{name}]"),
            };
        }
        if let Some(name) = line.strip_prefix('[').and_then(|l| l.split(']').next()) {
            return Told {
                found: format!("[{name}] is a single table"),
                expected: "one table for each, with double brackets".to_owned(),
                hint: format!("write [[{name}]]"),
            };
        }
    }
    if message.starts_with("wanted string") {
        let (key, value) = line.split_once('=').unwrap_or((line, ""));
        let value = value.split('#').next().unwrap_or_default();
        let expected = match key.trim() {
            "direction" => "\"up\" or \"down\"",
            "scaling" => "\"peak\" or \"rms\"",
            "kind" => "\"sine\"",
            _ => "a name between quotes",
        };
        let found = format!("{} = {}", key.trim(), value.trim());
        return Told { found, expected: expected.to_owned(), hint: String::new() };
    }
    let (found, expected) = message.split_once(", expected ").unwrap_or((message, ""));
    let found = match found.split_once(": ") {
        Some(("invalid type" | "invalid value", what)) => format!("found the {what}"),
        _ => match found.strip_prefix("invalid length ") {
            Some(length) => format!("found a list of {length}"),
            None => found.to_owned(),
        },
    };
    let expected = match expected {
        "u8" => "a small whole number",
        "usize" | "u64" => "a whole number, 0 or more",
        "f64" => "a number",
        "a string" | "path string" => "text between quotes",
        "an array of length 2" => "two values between square brackets",
        "a sequence" => "a list between square brackets, or tables with double brackets",
        "a boolean" => "true or false",
        other => other,
    };
    Told { found, expected: expected.to_owned(), hint: String::new() }
}

/// The line that holds byte `at`, without the blanks around it.
fn line_at(text: &str, at: usize) -> &str {
    let start = text.get(..at).and_then(|before| before.rfind('\n')).map_or(0, |end| end + 1);
    text.get(start..).and_then(|rest| rest.lines().next()).unwrap_or_default().trim()
}

fn unknown_key(wrong: &str, known: &[&str]) -> Told {
    let hint = match nearest(wrong, known) {
        Some(near) => format!("did you mean `{near}`?"),
        None => format!("keys known here: {}", known.join(", ")),
    };
    Told { found: format!("unknown key `{wrong}`"), hint, ..Told::default() }
}

/// The complaint about a key at the top that is none.
pub fn unknown(
    path: &Path,
    text: &str,
    key: &toml::Spanned<toml::de::DeString<'_>>,
    known: &[&str],
) -> Error {
    let Told { found, hint, .. } = unknown_key(key.get_ref(), known);
    Error::input(Place::file(path), found, "").excerpt(text, key.span()).hint(hint)
}

/// Where a key stands in a table or in one of its tables.
pub fn find(table: &toml::de::DeTable<'_>, key: &str) -> Option<Range<usize>> {
    table.iter().find_map(|(name, value)| match value.get_ref() {
        _ if name.get_ref() == key => Some(name.span().start..value.span().end),
        toml::de::DeValue::Table(inner) => find(inner, key),
        _ => None,
    })
}

/// The known name at the smallest edit distance, if that is small.
fn nearest<'a>(wrong: &str, known: &[&'a str]) -> Option<&'a str> {
    known
        .iter()
        .map(|k| (distance(wrong, k), *k))
        .min()
        .filter(|(d, k)| *d <= 1 + k.len() / 4)
        .map(|(_, k)| k)
}

/// Levenshtein's edit distance.
fn distance(a: &str, b: &str) -> usize {
    let b: Vec<char> = b.chars().collect();
    let mut row: Vec<usize> = (0..=b.len()).collect();
    for (i, ca) in a.chars().enumerate() {
        let mut diagonal = row[0];
        row[0] = i + 1;
        for (j, cb) in b.iter().enumerate() {
            let substitute = diagonal + usize::from(ca != *cb);
            diagonal = row[j + 1];
            row[j + 1] = substitute.min(diagonal + 1).min(row[j] + 1);
        }
    }
    row[b.len()]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn near_names() {
        assert_eq!(distance("kitten", "sitting"), 3);
        assert_eq!(nearest("calibraton", &["calibration", "window"]), Some("calibration"));
        assert_eq!(nearest("xyz", &["calibration", "window"]), None);
    }

    #[test]
    fn a_key_is_found_in_the_table_that_has_it() {
        let text = "b = 1\n[x]\n  a = 2\n";
        let table = toml::de::DeTable::parse(text).unwrap();
        assert_eq!(find(table.get_ref(), "a").map(|span| &text[span]), Some("a = 2"));
        assert_eq!(find(table.get_ref(), "c"), None);
    }

    #[test]
    fn the_parsers_words_are_told_in_those_of_a_campaign() {
        for (text, found, expected, hint) in [
            ("prior.gap = [1e-3]", "a list of 1", "two values between square brackets", ""),
            (
                "prior.gap = 1e-3",
                "found the floating point `0.001`",
                "two values between square brackets",
                "",
            ),
            (
                "prior.gapp = [1e-3, 1e-5]",
                "the name `gapp`",
                "one of `force`, `restitution`, `c1`",
                "did you mean `gap`?",
            ),
            (
                "starts = 3\nstarts = 4",
                "this name a second time",
                "each key and each table once",
                "in one place",
            ),
        ] {
            let error = toml::from_str::<crate::campaign::FitEntry>(text).unwrap_err();
            let told = tell(error.message(), text.lines().next().unwrap(), &[]);
            assert!(told.found.contains(found), "{text}: {told:?}");
            assert!(told.expected.contains(expected) && told.hint.contains(hint), "{text}: {told:?}");
        }
    }
}

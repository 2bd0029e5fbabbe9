//! Errors of TOML with their place, a caret, and the nearest key that exists.

use crate::error::{Error, Place};
use std::ops::Range;
use std::path::Path;

/// The parser's complaint as ours.
///
/// `beside` are keys that are known, too.
pub(crate) fn toml_error(path: &Path, text: &str, error: &toml::de::Error, beside: &[&str]) -> Error {
    let (span, message) = (error.span().unwrap_or(0..0), error.message());
    let line = line_at(text, span.start);
    let (found, expected, hint) = decimal_comma(line).unwrap_or_else(|| {
        let (found, expected) = message.split_once(", expected ").unwrap_or((message, ""));
        let names: Vec<&str> = message.split('`').skip(1).step_by(2).collect();
        match names.split_first() {
            Some((wrong, known)) if message.starts_with("unknown field") => {
                let (found, hint) = unknown_key(wrong, &[beside, known].concat());
                (found, String::new(), hint)
            }
            Some((wrong, known)) if message.starts_with("unknown variant") => {
                let hint = nearest(wrong, known).map(|near| format!("did you mean `{near}`?"));
                (format!("the name `{wrong}`"), expected.to_owned(), hint.unwrap_or_default())
            }
            Some((key, _)) if message.starts_with("missing field") => {
                (found.to_owned(), String::new(), format!("add {key} = …"))
            }
            _ if message.starts_with("wanted string") => {
                let stated = line.split('#').next().unwrap_or_default().trim_end();
                (stated.to_owned(), "a name between quotes".to_owned(), String::new())
            }
            _ if message.starts_with("invalid type: map") && line.starts_with("[[") => {
                let single = line.replace("[[", "[").replace("]]", "]");
                (
                    format!("{line} begins one table of several"),
                    "a single table".into(),
                    format!("write {single}"),
                )
            }
            _ => (found.to_owned(), plain(expected).to_owned(), String::new()),
        }
    });
    Error::input(Place::file(path), found, expected).excerpt(text, span).hint(hint)
}

/// A number with a decimal comma on this line: what was found, what was expected, what to write.
fn decimal_comma(line: &str) -> Option<(String, String, String)> {
    let (key, value) = line.split_once('=')?;
    let (whole, decimals) = value.split('#').next()?.trim().split_once(',')?;
    let digit = |text: &str| text.starts_with(|c: char| c.is_ascii_digit());
    let is_number = digit(whole.trim_start_matches(['+', '-']))
        && digit(decimals)
        && decimals.chars().all(|c| c.is_ascii_digit() || "eE+-".contains(c));
    let (key, expected) = (key.trim(), "a number with a decimal point".to_owned());
    is_number.then(|| {
        (format!("{key} = {whole},{decimals}"), expected, format!("write {key} = {whole}.{decimals}"))
    })
}

/// What the parser expects, without the names of Rust's types.
fn plain(expected: &str) -> &str {
    match expected {
        "u8" | "u32" | "usize" | "u64" => "a whole number, 0 or more",
        "f64" => "a number",
        "a string" | "path string" => "text between quotes",
        "an array of length 2" => "two values between square brackets",
        "a sequence" => "a list between square brackets, or tables with double brackets",
        "a boolean" => "true or false",
        other => other,
    }
}

/// The line that holds byte `at`, without the blanks around it.
fn line_at(text: &str, at: usize) -> &str {
    let start = text.get(..at).and_then(|before| before.rfind('\n')).map_or(0, |end| end + 1);
    text.get(start..).and_then(|rest| rest.lines().next()).unwrap_or_default().trim()
}

/// What to say of an unknown key, and what to write instead.
fn unknown_key(wrong: &str, known: &[&str]) -> (String, String) {
    let hint = match nearest(wrong, known) {
        Some(near) => format!("did you mean `{near}`?"),
        None => format!("keys known here: {}", known.join(", ")),
    };
    (format!("unknown key `{wrong}`"), hint)
}

/// The complaint about a key at the top that is none.
pub fn unknown(
    path: &Path,
    text: &str,
    key: &toml::Spanned<toml::de::DeString<'_>>,
    known: &[&str],
) -> Error {
    let (found, hint) = unknown_key(key.get_ref(), known);
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
        for (text, expected) in [
            ("prior.gap = [1e-3]", &["invalid length 1", "two values between square brackets"][..]),
            ("prior.gap = 1e-3", &["floating point `0.001`", "two values between square brackets"]),
            ("prior.gapp = [1e-3, 1e-5]", &["the name `gapp`", "one of `force`", "did you mean `gap`?"]),
            ("starts = 3\nstarts = 4", &["duplicate key"]),
            ("scatter = 0,01", &["scatter = 0,01", "a number with a decimal point", "write scatter = 0.01"]),
        ] {
            let error = toml::from_str::<crate::campaign::FitEntry>(text).unwrap_err();
            let said = toml_error(Path::new("campaign.toml"), text, &error, &[]).to_string();
            assert!(expected.iter().all(|part| said.contains(part)), "{text}: {said}");
        }
    }
}

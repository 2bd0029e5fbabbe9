//! Errors of TOML with their place, a caret, and the nearest key that exists.

use crate::error::{Error, Place};
use std::ops::Range;
use std::path::Path;

/// The parser's complaint as ours.
pub fn toml_error(path: &Path, text: &str, error: &toml::de::Error) -> Error {
    let message = error.message();
    let names: Vec<&str> = message.split('`').skip(1).step_by(2).collect();
    let (found, expected) = match message.split_once(", expected ") {
        Some((found, _)) if message.starts_with("unknown field") => {
            (found.replace("unknown field", "unknown key"), String::new())
        }
        Some((found, expected)) => (found.to_owned(), expected.to_owned()),
        None => (message.to_owned(), String::new()),
    };
    let hint = match names.split_first() {
        Some((wrong, known)) if message.starts_with("unknown field") => match nearest(wrong, known) {
            Some(near) => format!("did you mean `{near}`?"),
            None => format!("keys known here: {}", known.join(", ")),
        },
        _ => String::new(),
    };
    let span = error.span().unwrap_or(0..0);
    Error::input(Place::file(path), found, expected).excerpt(text, span).hint(hint)
}

/// The first line of `text` that sets `key`, at top level or behind the byte `from`.
pub fn find(text: &str, key: &str, from: Option<usize>) -> Range<usize> {
    let from = from.unwrap_or(0);
    let mut at = 0;
    for line in text.split_inclusive('\n') {
        let trimmed = line.trim_start();
        if at >= from && trimmed.strip_prefix(key).is_some_and(|rest| rest.trim_start().starts_with('=')) {
            return at..at + line.trim_end().len();
        }
        at += line.len();
    }
    from..from
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
    fn a_key_is_found_behind_a_place() {
        let text = "a = 1\n[x]\n  a = 2\n";
        assert_eq!(find(text, "a", None), 0..5);
        assert_eq!(&text[find(text, "a", Some(6))], "  a = 2");
    }
}

//! Errors of TOML with their place, a caret, and the nearest key that exists.

use super::value::without_unit;
use crate::error::{Error, Place};
use crate::record::nearest;
use serde::de::{DeserializeOwned, IntoDeserializer};
use std::ops::Range;
use std::path::Path;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// The parser's complaint as ours.
///
/// `beside` are keys that are known, too.
pub fn toml_error(path: &Path, text: &str, error: &toml::de::Error, beside: &[&str]) -> Error {
    let (span, message) = (error.span().unwrap_or(0..0), error.message());
    let line = line_at(text, span.start);
    let complaint = |found: &str, expected: &str, hint: String| {
        Error::input(Place::file(path), found, expected).excerpt(text, span.clone()).hint(hint)
    };
    let (found, expected) = match message.strip_prefix("expected ") {
        Some(expected) => (line, expected),
        None => message.split_once(", expected ").unwrap_or((message, "")),
    };
    let names: Vec<&str> = message.split('`').skip(1).step_by(2).collect();
    let (named, known) = names.split_first().map_or(("", &[][..]), |(first, rest)| (*first, rest));
    let meant =
        |known: &[&str]| nearest(named, known.iter().copied()).map(|near| format!("did you mean `{near}`?"));
    let begins = |with: &str| message.starts_with(with);
    if begins("unknown field") {
        let known = [beside, known].concat();
        let (what, table) = if line.starts_with('[') { ("table", TABLES) } else { ("key", &[][..]) };
        let called =
            table.iter().find(|(word, _)| *word == named).map(|(_, table)| format!("write [[{table}]]"));
        let all = || format!("{what}s known here: {}", known.join(", "));
        complaint(&format!("unknown {what} `{named}`"), "", called.or(meant(&known)).unwrap_or_else(all))
    } else if begins("unknown variant") {
        let of_value = line.split_once('=').filter(|(_, value)| value.contains(named));
        let near = nearest(named, known.iter().copied()).or(known.first().copied());
        let write = of_value.zip(near).map(|((key, _), near)| format!("write {} = \"{near}\"", key.trim()));
        let found = of_value.map_or_else(|| format!("the name `{named}`"), |_| line.to_owned());
        complaint(&found, &expected.replace('`', "\""), write.or(meant(known)).unwrap_or_default())
    } else if begins("missing field") {
        complaint(found, "", format!("add {named} = …"))
    } else if begins("duplicate key") {
        complaint(line, "every key once in a table", "remove this line, or the other one".to_owned())
    } else if line.starts_with("[[") && (begins("invalid type: map") || begins("wanted exactly 1 element")) {
        let single = line.replace("[[", "[").replace("]]", "]");
        complaint(&format!("{line} begins one table of several"), "a single table", format!("write {single}"))
    } else if let Some(head) = head_of_tables(line) {
        complaint(line, "two brackets on both sides", format!("write {head}"))
    } else if let Some(key) = uncommented(line).strip_suffix('=') {
        let key = key.trim_end();
        complaint(&format!("{key} has no value"), "", format!("put # in front of it: # {key} ="))
    } else if let Some((key, expected, meant)) = mended(line, expected) {
        complaint(uncommented(line), expected, format!("write {} = {meant}", key.replace(' ', "_")))
    } else if begins("wanted string") {
        complaint(uncommented(line), "a name between quotes", String::new())
    } else {
        complaint(found, plain(expected), String::new())
    }
}

/// A line that is no TOML, or has a value of another kind: its key, what was to stand there, and the value
/// that is meant.
fn mended<'a>(line: &'a str, expected: &'a str) -> Option<(&'a str, &'a str, String)> {
    let (key, value) = line.split_once('=').or_else(|| line.split_once(':'))?;
    let stated = uncommented(value).trim();
    if expected == "`=`" {
        return Some((key.trim(), "an equals sign behind a key of one word", stated.to_owned()));
    }
    let bare = stated.trim_matches(['"', '\'', '“', '”']).trim();
    let number = |text: &str| text.trim().parse::<f64>().is_ok_and(f64::is_finite);
    let point = bare.replacen(',', ".", 1);
    let word = bare.to_lowercase();
    let truth = expected == "a boolean";
    let whole = ["u8", "u32", "usize", "u64"].contains(&expected);
    let is = |words: [&str; 2], more: [&str; 2]| {
        !stated.starts_with('"') && words.contains(&&*word)
            || truth && (words.contains(&&*word) || more.contains(&&*word))
    };
    let near = nearest(bare, expected.split('"').skip(1).step_by(2));
    let (expected, meant) = if let Some(near) = near {
        (expected, format!("\"{near}\""))
    } else if let Some(value) = stated.strip_suffix([',', ';']) {
        ("no mark behind a value", value.to_owned())
    } else if point != bare && number(&point) {
        ("a number with a decimal point", point)
    } else if is(["yes", "on"], ["1", "true"]) || stated == "True" {
        ("true or false", "true".to_owned())
    } else if is(["no", "off"], ["0", "false"]) || stated == "False" {
        ("true or false", "false".to_owned())
    } else if stated.starts_with('[') && stated.contains(';') {
        ("commas between values", stated.replace(';', ","))
    } else if bare.starts_with('.') && number(bare) {
        ("a digit before the point", format!("0{bare}"))
    } else if whole && bare.parse::<f64>().is_ok_and(|v| v >= 0.0 && v.fract() == 0.0) {
        ("a whole number", format!("{:.0}", bare.parse::<f64>().ok()?))
    } else if bare == stated && number(bare) && ["a string", "path string"].contains(&expected) {
        (plain(expected), format!("\"{bare}\""))
    } else if bare != stated && number(bare) {
        ("a number without quotes", bare.to_owned())
    } else if let Some((low, high)) =
        bare.split_once([':', '-']).filter(|(low, high)| number(low) && number(high))
    {
        ("two values between square brackets", format!("[{low}, {high}]"))
    } else if let Some(meant) = without_unit(key.trim(), bare) {
        ("a number in the unit of this key, without it", meant.to_string())
    } else if stated.starts_with('"') && bare.contains('\\') {
        ("a path between single quotes", format!("'{bare}'"))
    } else if bare.starts_with(char::is_alphabetic) && bare.len() + 2 != stated.len() {
        ("text between quotes", format!("\"{bare}\""))
    } else {
        return None;
    };
    Some((key.trim(), expected, meant))
}

/// A line or a part of one without the comment at its end.
fn uncommented(line: &str) -> &str {
    let mut quotes = 0;
    let is_comment = |c: char| {
        quotes += usize::from(c == '"');
        c == '#' && quotes % 2 == 0
    };
    line.split(is_comment).next().unwrap_or_default().trim_end()
}

/// Words of the field, and the tables that are meant by them.
const TABLES: &[(&str, &str)] = &[
    ("modal", "frf"),
    ("hammer", "frf"),
    ("response", "sweep"),
    ("restitution", "drop"),
    ("bounce", "drop"),
    ("contact", "pulse"),
];

/// The head of one of several tables that is meant by a line whose brackets are no pairs.
fn head_of_tables(line: &str) -> Option<String> {
    let head = uncommented(line);
    let name = head.trim_start_matches('[').trim_end_matches(']');
    let outside = head.len() - name.len();
    let odd = !name.contains(['[', ']', '=']) && (head.starts_with("[[") || head.ends_with("]]"));
    (odd && outside == 3).then(|| format!("[[{}]]", name.trim()))
}

/// What the parser expects, without the names of Rust's types.
fn plain(expected: &str) -> &str {
    match expected {
        "u8" | "u32" | "usize" | "u64" => "a whole number, 0 or more",
        "f64" => "a number",
        "a string" | "path string" => "text between quotes",
        "an array of length 2" | "a tuple of size 2" => "two values between square brackets",
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

/// The keys of a table that stands there.
pub fn keys<T: DeserializeOwned>(table: DeTable<'_>, span: Range<usize>) -> Result<T, toml::de::Error> {
    T::deserialize(Spanned::new(span, DeValue::Table(table)).into_deserializer())
}

/// Where a key stands in a table or in one of its tables.
pub fn find(table: &DeTable<'_>, key: &str) -> Option<Range<usize>> {
    table.iter().find_map(|(name, value)| match value.get_ref() {
        _ if name.get_ref() == key => Some(name.span().start..value.span().end),
        DeValue::Table(inner) => find(inner, key),
        _ => None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_key_is_found_in_the_table_that_has_it() {
        let text = "b = 1\n[x]\n  a = 2\n";
        let table = DeTable::parse(text).unwrap();
        assert_eq!(find(table.get_ref(), "a").map(|span| &text[span]), Some("a = 2"));
        assert_eq!(find(table.get_ref(), "c"), None);
    }

    #[test]
    fn the_parsers_words_are_told_in_those_of_a_campaign() {
        for (text, expected) in [
            ("prior.gap = [1e-3]", &["invalid length 1", "two values between square brackets"][..]),
            ("prior.gap = 1e-3", &["floating point `0.001`", "two values between square brackets"]),
            (
                "prior.gapp = [1e-3, 1e-5]",
                &[
                    "the name `gapp`",
                    "\"k2\", \"c1\", \"c2\", \"gap\", \"restitution\", \"force\"",
                    "did you mean `gap`?",
                ],
            ),
            ("starts = 3\nstarts = 4", &["every key once", "remove this line"]),
            ("scatter = 0,01", &["scatter = 0,01", "a number with a decimal point", "write scatter = 0.01"]),
            ("scatter = 35k", &["write scatter = 35000"]),
            ("scatter = 40000,", &["no mark behind a value", "write scatter = 40000"]),
            ("scatter = 3.5 ms", &["scatter = 3.5 ms", "without it", "write scatter = 0.0035"]),
            ("scatter = \"40 cm\"", &["write scatter = 0.4"]),
            ("prior.gap = \"20-30\"", &["write prior.gap = [20, 30]"]),
            ("scatter = \"0.1\"", &["a number without quotes", "write scatter = 0.1"]),
            ("starts =   # missing: how many", &["starts has no value", "# starts"]),
            ("starts = 1.5e1", &["write starts = 15"]),
            ("starts : 3", &["write starts = 3"]),
            ("scatter = .01", &["write scatter = 0.01"]),
            ("scatter = .5 # a \"#\" ", &["scatter = .5;", "write scatter = 0.5"]),
            ("prior.gap = [1; 2]", &["write prior.gap = [1, 2]"]),
            ("starts = three", &["text between quotes", "write starts = \"three\""]),
            ("prior.gap = 1:2", &["two values between square brackets", "write prior.gap = [1, 2]"]),
        ] {
            let error = toml::from_str::<crate::campaign::FitEntry>(text).unwrap_err();
            let said = toml_error(Path::new("campaign.toml"), text, &error, &[]).to_string();
            assert!(expected.iter().all(|part| said.contains(part)), "{text}: {said}");
        }
    }
}

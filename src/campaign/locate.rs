//! The text of a campaign: terms of the field for its tables, and the positions of its keys.

use crate::record::Written;
use std::ops::Range;
use toml::de::{DeTable, DeValue};

/// Pairs of a term of the field that is not a table name, and the table that the user probably wants.
const TABLE_SYNONYMS: &[(&str, &str)] = &[
    ("modal", "frf"),
    ("hammer", "frf"),
    ("response", "sweep"),
    ("restitution", "drop"),
    ("bounce", "drop"),
    ("contact", "pulse"),
];

/// The text of a campaign; `extra_keys` are accepted beside the keys of the type that is read.
pub fn written<'a>(text: &'a str, extra_keys: &'a [&'a str]) -> Written<'a> {
    Written { text, extra_keys, table_synonyms: TABLE_SYNONYMS }
}

/// Bytes of a key and its value in a table or its subtables.
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
    fn what_is_wrong_is_told_with_what_can_be_written() {
        for (text, expected) in [
            ("prior.gap = [1e-3]", &["prior.gap = [1e-3];", "two values between square brackets"][..]),
            ("prior.gap = 1e-3", &["prior.gap = 1e-3;", "two values between square brackets"]),
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
            ("starts = \"5 s\"", &["starts = \"5 s\"", "a whole number"]),
            ("starts : 3", &["write starts = 3"]),
            ("scatter = .01", &["write scatter = 0.01"]),
            ("scatter = .5 # a \"#\" ", &["scatter = .5;", "write scatter = 0.5"]),
            ("prior.gap = [1; 2]", &["write prior.gap = [1, 2]"]),
            ("parameters = ['#gap']", &["parameters = ['#gap'];"]),
            ("starts = three", &["text between quotes", "write starts = \"three\""]),
            ("prior.gap = [1; 2\nstarts = 3", &["prior.gap = [1; 2;", "write prior.gap = [1, 2]"]),
            ("prior.gap = [1, 2", &["prior.gap = [1, 2;", "write prior.gap = [1, 2]"]),
            ("prior.gap = [1 2]", &["commas between values", "write prior.gap = [1, 2]"]),
            (
                "parameters = [\n  \"gap\",\n  \"k2\"\nstarts = 3",
                &[
                    "parameters = [;",
                    "a bracket that closes",
                    "write ] in a line of its own before starts = 3",
                ],
            ),
            ("parameters = Run #1", &["parameters = Run #1;", "write parameters = \"Run #1\""]),
            ("starts = three #1st", &["write starts = \"three\""]),
            ("starts = 99999999999999999999999", &["a whole number", "put # in front"]),
            ("scatter = 51,200.5", &["write scatter = 51200.5"]),
            (
                "low_pass = no",
                &["low_pass = no;", "a corner in Hz, or \"none\"", "write low_pass = \"none\""],
            ),
            ("prior.gap = 1:2", &["two values between square brackets", "write prior.gap = [1, 2]"]),
        ] {
            let read = written(text, &[]);
            let entry = read.parse().and_then(|table| read.read::<crate::campaign::FitEntry>(&table, 0..0));
            let said = entry.unwrap_err().to_string();
            assert!(expected.iter().all(|part| said.contains(part)), "{text}: {said}");
        }
    }
}

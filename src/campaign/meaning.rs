//! What each key of a table of records means, as `docs/campaign.md` lists it.

use serde::Serialize;

/// A key of a table of records.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct KeyMeaning {
    /// Its name.
    #[serde(skip)]
    pub key: &'static str,
    /// Unit of its numbers; empty where it has none.
    pub unit: &'static str,
    /// What it states.
    pub meaning: &'static str,
    /// What holds without it.
    pub left_out: &'static str,
}

impl KeyMeaning {
    /// The keys of the tables of a section. In `docs/campaign.md` they stand below headings that name their
    /// sections. Those of one section come first, those of all kinds of records last.
    ///
    /// ```
    /// use vibroimpact::campaign::KeyMeaning;
    /// let height = KeyMeaning::of("drop").find(|one| one.key == "height").unwrap();
    /// assert_eq!((height.unit, height.meaning), ("m", "height of the fall"));
    /// ```
    pub fn of(section: &str) -> impl Iterator<Item = KeyMeaning> {
        let (named, mut sections) = (format!("[[{section}]]"), 0);
        let mut all: Vec<(usize, KeyMeaning)> = Vec::new();
        for line in include_str!("../../docs/campaign.md").lines() {
            if line.starts_with("## ") {
                sections = if line.contains(&named) { line.matches("[[").count() } else { 0 };
            }
            all.extend(KeyMeaning::in_row(line).filter(|_| sections > 0).map(|key| (sections, key)));
        }
        all.sort_by_key(|(sections, _)| *sections);
        all.into_iter().map(|(_, key)| key)
    }

    /// The key of a row `` | `key` | unit | meaning | left out | ``.
    fn in_row(line: &'static str) -> Option<KeyMeaning> {
        let (key, rest) = line.strip_prefix("| `")?.split_once("` | ")?;
        let mut cells = rest.trim_end_matches(" |").split("| ").map(str::trim);
        let (unit, meaning, left_out) = (cells.next()?, cells.next()?, cells.next()?);
        Some(KeyMeaning { key, unit, meaning, left_out })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analysis;
    use crate::read::Folder;
    use std::path::Path;

    /// Other spellings of `fit`, `beam_from` and `noise`.
    const SPELT_OTHERWISE: [&str; 3] = ["fit_duration", "from", "noise_record"];

    /// The keys that a section takes are those that the error about an unknown key lists.
    #[test]
    fn each_key_of_each_section_has_a_meaning_and_no_other_has() {
        for section in analysis::sections() {
            let text = format!("[[{section}]]\nname = \"a\"\nno_such_key = 1\n");
            let error = analysis::parse(&Folder::default(), Path::new("campaign.toml"), text).unwrap_err();
            let listed = error.to_string();
            let (_, listed) = listed.split_once("keys known here: ").expect("a list of keys");
            let mut known: Vec<&str> =
                listed.lines().next().unwrap_or_default().split(", ").map(str::trim).collect();
            known.retain(|key| !SPELT_OTHERWISE.contains(key));
            let mut described: Vec<&str> = KeyMeaning::of(section).map(|one| one.key).collect();
            known.sort_unstable();
            described.sort_unstable();
            assert_eq!(described, known, "docs/campaign.md, [[{section}]]");
            let ranges: Vec<_> = analysis::key_ranges().collect();
            for one in KeyMeaning::of(section) {
                assert!(!one.meaning.is_empty() && !one.left_out.is_empty(), "{one:?}");
                let range = crate::campaign::KeyRange::of(one.key, ranges.iter().copied());
                let unit = range.map_or("", |range| range.unit());
                // The mass of a sweep is a number, 1 or 2.
                let is_number = (section, one.key) == ("sweep", "mass");
                assert!(is_number || unit.is_empty() || unit == one.unit, "{one:?}: numbers in {unit}");
            }
        }
    }
}

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
    /// Its name in plain words: the first clause of the meaning.
    pub label: &'static str,
    /// What holds without it.
    pub left_out: &'static str,
    /// Whether tables of all kinds have it: it says how a file is read.
    pub shared: bool,
}

impl KeyMeaning {
    /// The keys of the tables of a section. In `docs/campaign.md` they stand below headings that name their
    /// sections. Those of one section come first, those of all kinds of records last.
    ///
    /// ```
    /// use vibroimpact::campaign::KeyMeaning;
    /// let height = KeyMeaning::of("drop").find(|one| one.key == "height").unwrap();
    /// assert_eq!((height.unit, height.label), ("m", "height of the fall"));
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
        let most = all.iter().map(|(sections, _)| *sections).max();
        for (sections, key) in &mut all {
            key.shared = *sections > 2 && Some(*sections) == most;
        }
        all.sort_by_key(|(sections, _)| *sections);
        all.into_iter().map(|(_, key)| key)
    }

    /// The key of a row `` | `key` | unit | meaning | left out | ``.
    fn in_row(line: &'static str) -> Option<KeyMeaning> {
        let (key, rest) = line.strip_prefix("| `")?.split_once("` | ")?;
        let mut cells = rest.trim_end_matches(" |").split("| ").map(str::trim);
        let (unit, meaning, left_out) = (cells.next()?, cells.next()?, cells.next()?);
        // "`true`: hum stays" is the switch "hum stays".
        let clause = meaning
            .strip_prefix("`true`")
            .map_or(meaning, |rest| rest.trim_start_matches(':').trim_start().trim_start_matches("for "));
        let label = clause.split([',', ';', ':', '(']).next()?.trim_end();
        Some(KeyMeaning { key, unit, meaning, label, left_out, shared: false })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_key_has_a_short_label_of_its_own() {
        for section in ["sweep", "spectrum", "frf", "impacts", "drop", "decay", "pulse", "drill"] {
            let keys: Vec<KeyMeaning> = KeyMeaning::of(section).collect();
            for (i, one) in keys.iter().enumerate() {
                let same = keys[..i].iter().find(|other| other.label == one.label);
                assert_eq!(same.map(|other| other.key), None, "[[{section}]] {}: {}", one.key, one.label);
                let plain = !one.label.contains(['`', '[', ']']) && (4..=45).contains(&one.label.len());
                assert!(plain, "[[{section}]] {}: {:?}", one.key, one.label);
            }
        }
        let hum = KeyMeaning::of("drop").find(|one| one.key == "keep_hum").unwrap();
        assert_eq!(hum.label, "mains hum stays in the trace");
    }
}

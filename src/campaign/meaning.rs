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
    /// The rest of the meaning; empty where the label says all.
    pub rest: &'static str,
    /// What holds without it.
    pub left_out: &'static str,
    /// Whether tables of all kinds have it: it says how a file is read.
    pub shared: bool,
}

impl KeyMeaning {
    /// Keys of all kinds of records that a kind refuses, since it has keys of its own for them.
    pub(crate) const REFUSED: [(&'static str, &'static str); 2] =
        [("drill", "channel"), ("drill", "calibration")];

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
        let refused = KeyMeaning::REFUSED.map(|(kind, key)| (kind == section).then_some(key));
        all.into_iter().map(|(_, key)| key).filter(move |one| !refused.contains(&Some(one.key)))
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
        let rest = after_mark(&clause[label.len()..]);
        Some(KeyMeaning { key, unit, meaning, label, rest, left_out, shared: false })
    }

    /// A text about the key without the words of its label and its unit, for where they stand beside it: of
    /// "height of the fall in m; by a rule" and "in m; by a rule" it is "by a rule".
    pub fn beyond<'a>(&self, text: &'a str) -> &'a str {
        let rest = text.strip_prefix(self.label).unwrap_or(text).trim_start();
        let rest = rest.strip_prefix("in ").unwrap_or(rest);
        match rest.strip_prefix(self.unit).filter(|_| !self.unit.is_empty()) {
            Some(rest) if rest.is_empty() || rest.starts_with([',', ';']) => after_mark(rest),
            _ if text.starts_with(self.label) => after_mark(&text[self.label.len()..]),
            _ => text,
        }
    }
}

/// A text without the punctuation that it begins with.
fn after_mark(text: &str) -> &str {
    text.trim_start_matches([' ', ',', ';', ':'])
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
        assert_eq!((hum.label, hum.rest), ("mains hum stays in the trace", ""));
        let height = KeyMeaning::of("drop").find(|one| one.key == "height").unwrap();
        for (text, beyond) in [
            ("height of the fall in m; by a rule", "by a rule"),
            ("height of the fall in m", ""),
            ("in m; by a rule", "by a rule"),
            ("m; by a rule", "by a rule"),
            ("many falls", "many falls"),
            ("its height", "its height"),
        ] {
            assert_eq!(height.beyond(text), beyond);
        }
        let low_pass = KeyMeaning::of("pulse").find(|one| one.key == "low_pass").unwrap();
        assert!(low_pass.rest.starts_with("corner of its Butterworth filter"), "{low_pass:?}");
    }
}

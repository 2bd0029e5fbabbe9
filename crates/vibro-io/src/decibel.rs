//! Whether a file says that its values are levels in decibels.

use vibro_record::Meta;

/// What a file says of decibels, in its own words.
#[derive(Debug, PartialEq)]
pub(super) enum Decibel {
    /// Its values are decibels: by their unit, or by a header line that states unit, scale or level.
    Stated(String),
    /// The word stands elsewhere: a filter's slope, the name of a rig.
    Mentioned(String),
}

/// Keys of header lines that say what values are.
const KEYS: [&str; 18] = [
    "unit",
    "units",
    "y unit",
    "y units",
    "yunit",
    "amplitude unit",
    "engineering unit",
    "scale",
    "scaling",
    "y scale",
    "amplitude scale",
    "vertical scale",
    "level",
    "levels",
    "y axis",
    "vertical axis",
    "amplitude",
    "magnitude",
];

impl Decibel {
    /// What the meta data of values say; `None` where there is no word of decibels.
    pub fn of(meta: &Meta) -> Option<Decibel> {
        let unit = meta.unit.symbol();
        if !meta.unit.is_known() && is_decibel(unit) {
            return Some(Decibel::Stated(unit.to_owned()));
        }
        // The line right above the values names their column.
        let above = meta.notes.last().filter(|(key, _)| key.is_empty()).map(|(_, line)| line);
        let mut names = std::iter::once(&meta.name).chain(above);
        if let Some(name) = names.find(|name| bracketed(name).is_some_and(is_decibel)) {
            return Some(Decibel::Stated(name.clone()));
        }
        let line = |(key, value): &(String, String)| {
            if key.is_empty() { value.clone() } else { format!("{key}: {value}") }
        };
        let states = |(key, value): &&(String, String)| is_key(key) && says_decibels(value);
        if let Some(note) = meta.notes.iter().find(states) {
            return Some(Decibel::Stated(line(note)));
        }
        let mut lines = std::iter::once(meta.name.clone()).chain(meta.notes.iter().map(line));
        lines.find(|line| says_decibels(line)).map(Decibel::Mentioned)
    }
}

/// `dB`, `dBV`, `dB re 1 m/s`, `decibels`.
fn is_decibel(unit: &str) -> bool {
    let unit = unit.trim().to_lowercase();
    unit.starts_with("db") || unit.starts_with("decibel")
}

fn bracketed(name: &str) -> Option<&str> {
    let from = name.find(['[', '('])? + 1;
    let length = name[from..].find([']', ')'])?;
    Some(&name[from..from + length])
}

fn is_key(key: &str) -> bool {
    let plain: String =
        key.to_lowercase().chars().map(|c| if matches!(c, '_' | '-' | '.') { ' ' } else { c }).collect();
    KEYS.contains(&plain.trim())
}

/// Whether a line holds the word dB and no number before or behind it, as `gain: 20 dB` and `gain [dB]: 20` have. In a path
/// or a fraction it is no word.
fn says_decibels(line: &str) -> bool {
    let words: Vec<&str> = line
        .split(|c: char| c.is_whitespace() || "[](){}:=,;\"".contains(c))
        .filter(|w| !w.is_empty())
        .collect();
    let number =
        |at: Option<usize>| at.and_then(|at| words.get(at)).is_some_and(|w| w.parse::<f64>().is_ok());
    let level = |word: &str| matches!(word.to_lowercase().as_str(), "db" | "decibel" | "decibels");
    (0..words.len()).any(|i| level(words[i]) && !number(i.checked_sub(1)) && !number(Some(i + 1)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use vibro_record::units::Unit;

    fn of(unit: &str, name: &str, key: &str, value: &str) -> Option<Decibel> {
        let mut meta = Meta::new(name, Unit::parse_or_opaque(unit));
        meta.notes.push((key.to_owned(), value.to_owned()));
        Decibel::of(&meta)
    }

    #[test]
    fn units_and_statements_of_levels() {
        for (unit, name, key, value) in [
            ("dB", "", "", ""),
            ("dBV", "", "", ""),
            ("", "amplitude [dB re 1 m/s]", "", ""),
            ("m/s", "v (dB)", "", ""),
            ("", "", "", "Level (dB)"),
            ("", "", "Y axis", "dB"),
            ("", "", "scale", "log dB"),
            ("", "", "Y_unit", "dB re 1e-9 m/s"),
            ("", "", "LEVEL", "Decibels"),
        ] {
            let said = of(unit, name, key, value);
            assert!(matches!(said, Some(Decibel::Stated(_))), "{unit} {name} {key} {value}: {said:?}");
        }
    }

    #[test]
    fn a_word_elsewhere_is_only_mentioned() {
        for (name, key, value) in [
            ("", "Database", "DB rig"),
            ("", "", "Levels in dB"),
            ("v dB", "", ""),
            ("", "Filter", "dB, steep"),
        ] {
            let said = of("", name, key, value);
            assert!(matches!(said, Some(Decibel::Mentioned(_))), "{name} {key} {value}: {said:?}");
        }
    }

    #[test]
    fn settings_in_decibels_and_paths_are_no_levels() {
        for (key, value) in [
            ("gain", "20 dB"),
            ("gain [dB]", "20"),
            ("Level", "-20 dB"),
            ("Window", "flat top (-93 dB)"),
            ("File", "/data/db/run1.dat"),
            ("Filter slope", "dB/octave, 12"),
            ("", "adb"),
            ("", "range dB = 10"),
        ] {
            assert_eq!(of("m/s", "v", key, value), None, "{key}: {value}");
        }
    }
}

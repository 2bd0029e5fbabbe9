//! Finds the known name that was probably meant by an unknown one.

use std::cmp::Reverse;

/// The known name at the smallest edit distance from the wrong one (Damerau 1964, each letter changed once),
/// if that distance is at most 1 plus a sixth of the known name's length. Else the longest known name with
/// which the wrong one begins.
pub fn nearest<'a>(wrong: &str, known: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let wrong = wrong.to_lowercase();
    let known: Vec<(&str, String)> = known.into_iter().map(|name| (name, name.to_lowercase())).collect();
    let distance = |name: &str| strsim::osa_distance(&wrong, name);
    let slips = known.iter().filter(|(_, name)| distance(name) <= 1 + name.chars().count() / 6);
    let longer = known.iter().filter(|(_, name)| name.len() > 1 && wrong.starts_with(name));
    let near = slips.min_by_key(|(_, name)| (distance(name), Reverse(name.len())));
    near.or_else(|| longer.max_by_key(|(_, name)| name.len())).map(|(name, _)| *name)
}

/// The pattern of all names that differ from this one only in their numbers: `step*.csv` for `step01.csv`.
pub fn pattern(name: &str) -> String {
    let dot = name.rfind('.').unwrap_or(name.len());
    let mut pattern = String::new();
    for c in name[..dot].chars() {
        match c {
            '0'..='9' if pattern.ends_with('*') => {}
            '0'..='9' => pattern.push('*'),
            other => pattern.push(other),
        }
    }
    pattern + &name[dot..]
}

#[cfg(test)]
mod tests {
    use super::{nearest, pattern};

    #[test]
    fn numbers_in_a_name_are_any_numbers_in_a_pattern() {
        assert_eq!(pattern("run 2, step01.mp3"), "run *, step*.mp3");
        assert_eq!(pattern("12"), "*");
        assert_eq!(pattern("notes"), "notes");
    }

    #[test]
    fn a_slip_is_seen_and_another_word_is_not() {
        assert_eq!(nearest("calibraton", ["window", "calibration"]), Some("calibration"));
        assert_eq!(nearest("Sweep_1.CSV", ["sweep_01.csv", "drop_1.csv"]), Some("sweep_01.csv"));
        assert_eq!(nearest("bnech", ["bench"]), Some("bench"));
        assert_eq!(nearest("height_sdt", ["height", "height_std"]), Some("height_std"));
        assert_eq!(nearest("velocity2", ["velocity", "velocity 2"]), Some("velocity 2"));
        assert_eq!(nearest("downwards", ["up", "down"]), Some("down"));
        assert_eq!(nearest("nofile.csv", ["norate.csv"]), None);
        assert_eq!(nearest("xyz", ["calibration", "window"]), None);
    }
}

//! The known name that was meant by one that is not known.

/// The known name with which the wrong one begins; else that at the smallest edit distance (Damerau 1964, each letter changed once), where that is
/// small beside its length.
pub fn nearest<'a>(wrong: &str, known: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let wrong = wrong.to_lowercase();
    let distance = |name: &str| match name.to_lowercase() {
        short if short.len() > 1 && wrong.starts_with(&short) => 0,
        name => strsim::osa_distance(&wrong, &name),
    };
    let (distance, near) = known.into_iter().map(|name| (distance(name), name)).min()?;
    (distance <= 1 + near.chars().count() / 6).then_some(near)
}

#[cfg(test)]
mod tests {
    use super::nearest;

    #[test]
    fn a_slip_is_seen_and_another_word_is_not() {
        assert_eq!(nearest("calibraton", ["window", "calibration"]), Some("calibration"));
        assert_eq!(nearest("Sweep_1.CSV", ["sweep_01.csv", "drop_1.csv"]), Some("sweep_01.csv"));
        assert_eq!(nearest("bnech", ["bench"]), Some("bench"));
        assert_eq!(nearest("downwards", ["up", "down"]), Some("down"));
        assert_eq!(nearest("nofile.csv", ["norate.csv"]), None);
        assert_eq!(nearest("xyz", ["calibration", "window"]), None);
    }
}

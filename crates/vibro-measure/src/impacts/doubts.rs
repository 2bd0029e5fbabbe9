//! What a person must know of a train of impacts.

use super::Impacts;

/// Adds a sentence for each doubt.
pub fn doubts(found: &Impacts, warnings: &mut Vec<String>) {
    if let Some(length) = found.pattern {
        warnings.push(format!(
            "Intervals repeat after {length}: a pattern of {length} impacts, none of which is counted as missed or too many."
        ));
    }
    if found.n == 2 {
        warnings.push("Two impacts have one interval: whether it repeats is not known.".to_owned());
    }
    if found.missed > 0 {
        warnings.push(format!(
            "{} impact{} missed: intervals that are {} are counted as such in the mean. If none is: --none-missed.",
            found.missed,
            if found.missed == 1 { " is" } else { "s are" },
            if found.pattern.is_some() { "several of the pattern" } else { "a multiple of the median" }
        ));
    }
    if found.missed > found.n {
        warnings.push(
            "More impacts are missed than were found: either the record rests for long, or what was found is no impacts but their ringing. State the pause that parts impacts: --refractory S.".to_owned(),
        );
    }
    if found.doubled > 0 {
        warnings.push(format!(
            "{} impact{} another within half an interval, or between two of a pattern: left out of the mean interval.",
            found.doubled,
            if found.doubled == 1 { " follows" } else { "s follow" }
        ));
    }
    if let Some(spread) = found.spread.filter(|_| !found.regular && found.excitation.is_none()) {
        warnings.push(format!(
            "Intervals spread by {:.0} % of their median: impacts are irregular, and their mean is no period.",
            100.0 * spread / found.median_interval
        ));
    }
}

//! What a choice found that a person should know.

use super::motions::MOST_CYCLES;
use super::{Choice, Followed, Known, Question};
use vibro_record::Finding;

/// What is to be known of a choice beside the reasons of its rungs.
pub fn findings(choice: &Choice, question: &Question) -> Vec<Finding> {
    if choice.needs.contains(&"history") {
        return vec![several(&choice.motions)];
    }
    let mut found: Vec<Finding> = rare(&choice.motions).into_iter().collect();
    found.extend(choice.followed.map(searched));
    found.extend(match choice.chosen {
        Some(_) => known_enough(choice),
        None => Some(open(choice)),
    });
    found.extend(law(choice));
    found.extend(gap(choice, question));
    found
}

fn named<'a>(motions: impl Iterator<Item = &'a Known>) -> String {
    motions.map(|m| m.pattern.to_string()).collect::<Vec<String>>().join(", ")
}

/// Only the history decides between these motions.
fn several(motions: &[Known]) -> Finding {
    let found = Finding::doubt("several-motions").count("n", motions.len());
    let found = found.name("motions", named(motions.iter()));
    let unstable: Vec<&Known> = motions.iter().filter(|m| !m.stable).collect();
    if unstable.is_empty() { found } else { found.name("unstable", named(unstable.into_iter())) }
}

/// Motions beside the one that is answered for strike less than once a cycle.
fn rare(motions: &[Known]) -> Option<Finding> {
    let rare: Vec<&Known> = motions.iter().filter(|m| m.rare).collect();
    let found = Finding::caution("rare-motions").count("n", rare.len());
    (!rare.is_empty()).then(|| found.name("motions", named(rare.into_iter())))
}

/// How far other motions were looked for.
fn searched(Followed { states, of }: Followed) -> Finding {
    let found =
        if states < of { Finding::caution("search-cut") } else { Finding::note("other-motions-searched") };
    let found = found.count("states", states as usize).count("of", of as usize);
    found.count("cycles", MOST_CYCLES as usize)
}

/// The stiffness of the contact is not known and need not be.
fn known_enough(choice: &Choice) -> Option<Finding> {
    let (first, last) = (choice.sensitivity.first()?, choice.sensitivity.last()?);
    let found = Finding::note("stiffness-not-needed");
    Some(found.number("low", first.stiffness).number("high", last.stiffness))
}

/// Why no rung can be chosen.
fn open(choice: &Choice) -> Finding {
    let rows = &choice.sensitivity;
    let (Some(first), Some(last)) = (rows.first(), rows.last()) else {
        return if choice.needs.is_empty() {
            Finding::doubt("no-rung")
        } else {
            Finding::doubt("contact-unknown").name("needs", choice.needs.join(" and "))
        };
    };
    let worst = rows.iter().map(|r| r.change.abs()).fold(0.0, f64::max);
    let mut found = Finding::doubt("stiffness-needed")
        .name("needs", choice.needs.join(" and "))
        .number("low", first.stiffness)
        .number("high", last.stiffness)
        .number("change", worst);
    match rows.iter().rposition(|r| !r.enough) {
        Some(i) if i + 1 == rows.len() => found = found.number("still", last.change),
        Some(i) => found = found.number("enough_from", rows[i + 1].stiffness),
        None => {}
    }
    if choice.sensitivity_failed.is_empty() {
        return found;
    }
    found.numbers("failed", choice.sensitivity_failed.clone())
}

/// How far the law of the contact moves the chosen answer.
fn law(choice: &Choice) -> Option<Finding> {
    let law = choice.law?;
    let found = if law.enough { Finding::note("law-within") } else { Finding::doubt("law-matters") };
    Some(found.name("rung", choice.chosen?.name()).number("change", law.change))
}

/// What the uncertainty of the gap does to the chosen answer.
fn gap(choice: &Choice, question: &Question) -> Option<Finding> {
    let [smaller, larger] = choice.gap.as_slice() else { return None };
    let enough = choice.gap.iter().all(|c| c.is_some_and(|c| c.enough));
    let mut found = if enough { Finding::note("gap-within") } else { Finding::caution("gap-matters") };
    found = found.number("std", question.gap_std);
    for (name, change) in [("smaller", smaller), ("larger", larger)] {
        if let Some(change) = change {
            found = found.number(name, change.change);
        }
    }
    Some(found)
}

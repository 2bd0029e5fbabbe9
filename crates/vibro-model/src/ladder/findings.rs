//! Findings on a choice, beside the reasons of its rungs. A choice has no numbers with an uncertainty: its
//! doubts name none.

use super::motions::MOST_CYCLES;
use super::{Change, Choice, Followed, KnownMotion, Need, Question};
use vibro_record::Finding;

/// Findings on motions, search, stiffness, contact law and gap.
pub fn findings(choice: &Choice, question: &Question) -> Vec<Finding> {
    let names = |of: &dyn Fn(&KnownMotion) -> bool| {
        choice.motions.iter().filter(|m| of(m)).map(|m| m.pattern.to_string()).collect::<Vec<_>>().join(", ")
    };
    if choice.needs.contains(&Need::History) {
        let found = Finding::doubt("several-motions").count("n", choice.motions.len()).without_estimate();
        let (found, unstable) = (found.name("motions", names(&|_| true)), names(&|m| !m.stable));
        return vec![if unstable.is_empty() { found } else { found.name("unstable", unstable) }];
    }
    let mut found = Vec::new();
    // Coexisting motions with less than one impact a cycle.
    let rare = choice.motions.iter().filter(|m| m.rare).count();
    if rare > 0 {
        found.push(Finding::caution("rare-motions").count("n", rare).name("motions", names(&|m| m.rare)));
    }
    found.extend(choice.followed.map(searched));
    found.extend(stiffness(choice));
    if let (Some(law), Some(chosen)) = (choice.law.filter(|law| !law.enough), choice.chosen) {
        let matters = Finding::doubt("law-matters").name("rung", chosen.name()).without_estimate();
        found.push(matters.number("change", law.change));
    }
    if choice.gap.iter().any(|change| change.is_none_or(|change| !change.enough)) {
        let matters = Finding::caution("gap-matters").number("std", question.gap_std);
        let sides = ["smaller", "larger"].into_iter().zip(&choice.gap);
        let moved = |found: Finding, (name, change): (&'static str, &Option<Change>)| match change {
            Some(change) => found.number(name, change.change),
            None => found,
        };
        found.push(sides.fold(matters, moved));
    }
    found
}

/// Finding on the search for other motions: how many start states of all were simulated.
fn searched(Followed { states, of }: Followed) -> Finding {
    let found =
        if states < of { Finding::caution("search-cut") } else { Finding::note("other-motions-searched") };
    let found = found.count("states", states as usize).count("of", of as usize);
    found.count("cycles", MOST_CYCLES as usize)
}

/// Finding on an unknown contact stiffness: its effect, and why no rung can be chosen.
fn stiffness(choice: &Choice) -> Option<Finding> {
    let rows = &choice.sensitivity;
    let range = |found: Finding| match (rows.first(), rows.last()) {
        (Some(first), Some(last)) => found.number("low", first.stiffness).number("high", last.stiffness),
        _ => found,
    };
    if choice.chosen.is_some() {
        return (!rows.is_empty()).then(|| range(Finding::note("stiffness-not-needed")));
    }
    if choice.needs.is_empty() {
        return Some(Finding::doubt("no-rung").without_estimate());
    }
    let needs = choice.needs.iter().map(|need| need.name()).collect::<Vec<_>>().join(" and ");
    let found = range(Finding::doubt("stiffness-needed").name("needs", needs).without_estimate());
    let Some(worst) = rows.iter().map(|r| r.change.abs()).reduce(f64::max) else { return Some(found) };
    let found = found.number("change", worst);
    Some(match rows.iter().rposition(|r| !r.enough) {
        Some(i) if i + 1 == rows.len() => found.number("still", rows[i].change),
        Some(i) => found.number("enough_from", rows[i + 1].stiffness),
        None => found,
    })
}

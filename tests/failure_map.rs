//! At the borders of what they can, the library's own methods are right or refuse with a reason: none is wrong without a word,
//! stalls or crashes.

use vibroimpact::compare::precision::{FailureMap, Outcome, estimators, models};

fn check(map: &FailureMap) {
    let broken: Vec<String> = map
        .broken()
        .map(|c| format!("{}, {}, {}: {:?}: {}", c.border, c.scene, c.method, c.outcome, c.why))
        .collect();
    assert!(broken.is_empty(), "{}", broken.join("\n"));
    // A refusal has its reason.
    let reasons = [Outcome::Refused, Outcome::NotAsked];
    assert!(map.cells.iter().all(|c| !reasons.contains(&c.outcome) || c.why.len() > 10));
}

#[test]
fn no_model_is_wrong_or_stalls_at_its_borders() {
    let map = models::failures(true).unwrap();
    let right = map.cells.iter().filter(|c| c.ours && c.outcome == Outcome::Right).count();
    // The map is not empty, and the check can fail: other methods do.
    assert!(right > 60, "{right} cells");
    // Every method has a cell at every scene.
    let scenes: std::collections::HashSet<_> = map.cells.iter().map(|c| (&c.border, &c.scene)).collect();
    assert_eq!(map.cells.len(), scenes.len() * map.methods().len());
    assert!(map.cells.iter().any(|c| !c.ours && c.outcome == Outcome::Wrong));
    check(&map);
}

/// So many cells of each quantity each method must answer rightly at least: a map of refusals would be no use. Some below what it is, so that another
/// seed of a record at the very border does not decide.
const RIGHT: [(&str, &str, usize); 8] = [
    ("frequency", "three lines, Hann", 5),
    ("frequency", "least squares", 14),
    ("displacement", "lines, cut-off", 11),
    ("displacement", "in time, high-pass", 5),
    ("damping", "rational fit", 9),
    ("impact rate", "onset fit", 19),
    ("contact ξ", "whole pulse", 11),
    ("contact ξ", "two times", 6),
];

#[test]
fn estimators_are_right_or_refuse_at_their_borders() {
    let (map, rates) = estimators::failures_and_rates(true).unwrap();
    check(&map);
    let parts = map.parts();
    let mut short = Vec::new();
    for (quantity, method, least) in RIGHT {
        let part = parts.iter().find(|p| p.0 == quantity).unwrap_or_else(|| panic!("{quantity}"));
        let of = part.1.cells.iter().filter(|c| c.ours && c.method == method);
        let right = of.filter(|c| c.outcome == Outcome::Right).count();
        if right < least {
            short.push(format!("{quantity}, {method}: {right} right, {least} wanted"));
        }
    }
    assert!(short.is_empty(), "{}", short.join("\n"));
    // Uncertainties are those of the errors, over all borders of a method.
    let ours: Vec<_> = rates.iter().filter(|r| r.ours).collect();
    println!("{ours:?}");
    // Four cells of six records each at least.
    assert!(ours.len() == RIGHT.len() && ours.iter().all(|r| r.judged >= 24), "{ours:?}");
    assert!(ours.iter().all(|r| r.beyond <= r.limit()), "{ours:?}");
    // Nobody is left out of the list above, and the check can fail: other methods do.
    let ours = map.cells.iter().filter(|c| c.ours);
    assert!(ours.clone().all(|c| RIGHT.iter().any(|r| c.border.starts_with(r.0) && c.method == r.1)));
    assert!(map.cells.iter().filter(|c| !c.ours && c.outcome == Outcome::Wrong).count() > 60);
    // What is written by hand may crash on what it did not expect, but it is given records that a person would give it.
    assert!(map.cells.iter().all(|c| c.outcome != Outcome::Crashed));
}

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

#[test]
fn no_estimator_is_wrong_or_stalls_at_its_borders() {
    check(&estimators::failures(true).unwrap());
}

//! Curved springs: `vibro model backbone`, and what the other commands say of `[springs]`.

use super::{complaint, json, text};

/// Runs `vibro model …` with arguments separated by spaces.
fn model(typed: &str) -> serde_json::Value {
    json(&["model"].into_iter().chain(typed.split(' ')).collect::<Vec<_>>())
}

#[test]
fn the_response_of_a_curved_spring_has_its_keys_and_files() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out");
    let found = model(&format!(
        "backbone --force 5e-3 --set springs.cubic1=2e7 --from 4.5 --to 7 --points 60 --out {}",
        text(&out)
    ));
    let points = found["points"].as_array().unwrap();
    assert!(points.len() > 60 && found["limit"].is_null() && found["mass"] == 1);
    for point in points {
        let number = |key: &str| point[key].as_f64().unwrap();
        let (omega, lag, a) =
            (std::f64::consts::TAU * number("frequency"), number("lag"), number("amplitude"));
        // The dampers take what the force gives: cωA = F₀ sin φ, to the rounding of a phase near π.
        assert!((0.1 * omega * a - 5e-3 * lag.sin()).abs() < 1e-12, "{point}");
        let near = point["exact"]["amplitude"].as_f64().is_none_or(|exact| (exact / a - 1.0).abs() < 0.02);
        assert!(near, "{point}");
    }
    assert_eq!(found["jumps"].as_array().map(Vec::len), Some(2));
    let last = found["backbone"].as_array().unwrap().last().unwrap();
    // √(k + ¾k₃A²), with the largest amplitude F₀/(cω) but for the width of the grid.
    let [a, balance] = [0, 1].map(|i| last[i].as_f64().unwrap());
    let expected = ((135.0 + 1.5e7 * a * a) / 0.125_f64).sqrt() / std::f64::consts::TAU;
    assert!((balance / expected - 1.0).abs() < 1e-12, "{last}");
    for file in ["backbone.svg", "backbone.csv", "response.csv", "jumps.csv"] {
        assert!(out.join(file).is_file(), "{file}");
    }
}

#[test]
fn what_a_curved_spring_cannot_be_is_refused() {
    for (typed, code, words) in [
        ("--force 5e-3", 2, "spring 1 is straight"),
        ("--force 0 --set springs.cubic1=1e7", 2, "nothing drives the mass"),
        (
            "--force 5e-3 --set springs.cubic1=1e7 --mass 3",
            2,
            "--mass is 3; expected a whole number from 1 to 2",
        ),
        (
            "--force 5e-3 --set springs.cubic1=1e7 --mass 0",
            2,
            "--mass is 0; expected a whole number from 1 to 2",
        ),
        ("--force 5e-3 --set springs.cubic1=1e7 --tolerance 0", 2, "a tolerance of 0"),
        ("--force 5e-3 --set springs.cubic2=1e7 --mass 2 --set m2=inf", 2, "mass 2 is a wall"),
        ("--impulse 5e-3 --set springs.cubic1=1e7", 2, "impulse"),
        ("--force 5e-3 --set springs.cubic3=1e7", 2, "cubic3"),
        ("--force 50 --set springs.cubic1=-1e7", 1, "largest force"),
    ] {
        let typed = format!("model backbone --from 4 --to 5 --points 5 {typed}");
        let said = complaint(&typed.split(' ').collect::<Vec<_>>(), code);
        assert!(said.contains(words), "{typed}: {said}");
    }
}

/// A campaign has no model with curved springs; the command that is named instead runs as it stands.
#[test]
fn a_campaign_says_where_springs_belong() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("c.toml");
    std::fs::write(&path, "[rig]\nm1 = 0.125\n[springs]\ncubic1 = 1e7\ncubic2 = -2e6\n").unwrap();
    let said = complaint(&["run", text(&path)], 2);
    assert!(said.contains("line 3") && said.contains("[springs] in a campaign"), "{said}");
    let named = said.split('`').nth(1).unwrap().strip_prefix("vibro ").unwrap();
    let found = json(&named.split(' ').collect::<Vec<_>>());
    assert_eq!(found["scene"]["springs"], serde_json::json!({ "cubic1": 1e7, "cubic2": -2e6 }));
}

/// Both springs together are judged beside each alone, each with the mass whose answer changes most.
#[test]
fn two_curved_springs_are_judged_together() {
    let found = model(
        "choose --force 5e-3 --frequency 5.1 --history up --set contact.stiffness=1e7 \
         --set springs.cubic1=1e7 --set springs.cubic2=1e9",
    );
    // Mass 2 rests: both springs change what the first alone changes.
    let alone = &found["springs"][0]["change"];
    assert_eq!((&found["springs_together"], &alone["mass"]), (alone, &1.into()));
    let doubts = found["findings"].as_array().unwrap().iter().filter(|f| f["severity"] == "doubt");
    let codes: Vec<&str> = doubts.map(|f| f["code"].as_str().unwrap()).collect();
    assert!(codes.contains(&"springs-together-matter"), "{codes:?}");
    let one = model("choose --force 5e-3 --frequency 5.1 --history up --set springs.cubic1=1e7");
    assert!(one.get("springs_together").is_none());
}

#[test]
fn curved_springs_are_used_or_the_answer_says_that_they_are_not() {
    let has = |typed: &str, code: &str| {
        let found = model(&format!("{typed} --set springs.cubic1=1e6"));
        found["findings"].as_array().unwrap().iter().any(|f| f["code"] == code)
    };
    for typed in [
        "orbit --force 0.5 --frequency 11",
        "simulate --force 0.5 --frequency 11 --settle 10 --cycles 10",
        "response --force 0.5 --from 10 --to 11 --points 3",
        "continue --force 0.5 --frequency 11 --from 10.9 --to 11.1",
        "sweep --force 0.5 --from 10 --to 11 --steps 2 --settle 5",
        "map --force 0.5 --x frequency:10:12:2 --y gap:1e-3:2e-3:2",
    ] {
        assert!(has(typed, "springs-unused"), "{typed}");
    }
    let choose = "choose --force 0.5 --frequency 11 --set contact.stiffness=1e6";
    assert!(has(choose, "spring-curvature-matters") && !has(choose, "springs-unused"));
    assert!(!has("backbone --force 5e-3 --from 5 --to 6 --points 5", "springs-unused"));
}

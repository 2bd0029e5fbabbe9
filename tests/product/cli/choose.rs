//! `vibro model choose`: keys, answers without a choice, files, error messages.

use super::{complaint, json, text};
use serde_json::Value;

/// The thesis' rig at ν = 2.1, where ν = 2πf/√(k₁/m₁).
const SCENE_B: [&str; 8] =
    ["model", "choose", "--force", "0.5", "--frequency", "10.983764", "--observable", "impact-speed"];

fn scene_b(more: &[&str]) -> Value {
    json(&[&SCENE_B[..], more].concat())
}

#[test]
fn a_choice_has_its_keys() {
    let found = scene_b(&["--set", "contact.stiffness=1e6"]);
    assert_eq!(found["chosen"], "soft-corrected");
    let rungs = found["rungs"].as_array().unwrap();
    let names: Vec<&str> = rungs.iter().map(|r| r["model"].as_str().unwrap()).collect();
    assert_eq!(
        names,
        [
            "linear",
            "closed-form",
            "soft-corrected",
            "restitution",
            "kelvin-voigt",
            "hunt-crossley",
            "loose-mass"
        ]
    );
    for rung in rungs {
        assert!(rung["valid"].is_boolean() && !rung["why"].as_str().unwrap().is_empty(), "{rung}");
        assert!(rung["needs"].as_array().unwrap().iter().all(|n| n["known"].is_boolean()));
    }
    assert!(rungs[1]["cost_ns"].as_f64().unwrap() > 0.0);
    assert!((rungs[1]["error"].as_f64().unwrap() - 0.209).abs() < 0.004, "{}", rungs[1]);
    assert_eq!(found["audit"]["at"], "kelvin-voigt");
    assert_eq!((&found["law"]["at"], &found["law"]["enough"]), (&"hunt-crossley".into(), &false.into()));
    let warnings = found["warnings"].as_array().unwrap();
    assert_eq!(warnings.iter().filter(|w| w.as_str().unwrap().contains("force over deflection")).count(), 1);
    assert!(found["audit"]["change"].as_f64().unwrap().abs() < 0.003);
    assert_eq!(
        (&found["tolerance"], &found["observable"]),
        (&Value::from(0.02), &Value::from("impact-speed"))
    );
    assert!(
        found["reasons"].as_array().unwrap().len() >= 3 && found["sensitivity"] == Value::Array(Vec::new())
    );
}

#[test]
fn what_is_not_known_is_said_and_is_no_failure() {
    let found = scene_b(&[]);
    assert_eq!((&found["chosen"], &found["needs"][0]), (&Value::Null, &Value::from("contact.stiffness")));
    let rows = found["sensitivity"].as_array().unwrap();
    assert!(rows.len() >= 5 && rows.iter().all(|r| r["stiffness"].is_number() && r["change"].is_number()));
    assert!(found["warnings"].as_array().unwrap().last().unwrap().as_str().unwrap().contains("stiffness"));
    let scene =
        ["model", "choose", "--force", "0.1", "--frequency", "7.8455", "--set", "contact.stiffness=1e6"];
    let open = json(&scene);
    assert_eq!((&open["chosen"], &open["needs"][0]), (&Value::Null, &Value::from("history")));
    let fell = json(&[&scene[..], &["--history", "down"]].concat());
    assert_eq!((&fell["chosen"], &fell["history"]), (&Value::from("linear"), &Value::from("down")));
    let rose = json(&[&scene[..], &["--history", "up"]].concat());
    assert_eq!(rose["chosen"], "soft-corrected");
}

#[test]
fn an_axis_and_its_files() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out");
    let axis = ["model", "choose", "--force", "0.3", "--from", "10", "--to", "14", "--points", "9"];
    let more = ["--history", "down", "--set", "contact.stiffness=1e6", "--out", text(&out)];
    let found = json(&[&axis[..], &more[..]].concat());
    assert_eq!(found["points"].as_array().map(Vec::len), Some(9));
    let stretches = found["stretches"].as_array().unwrap();
    assert_eq!(stretches.last().unwrap()["chosen"], "linear");
    assert_eq!(stretches.iter().map(|s| s["points"].as_u64().unwrap()).sum::<u64>(), 9);
    assert!(found["rungs"][0]["why"].as_str().unwrap().contains("chosen at"));
    for name in ["ladder.svg", "ladder.png", "points.csv", "rungs.csv", "stretches.csv"] {
        assert!(out.join(name).is_file(), "{name}");
    }
}

#[test]
fn impossible_requests_are_named() {
    let asked = |more: &[&str], code| complaint(&[&["model", "choose"], more].concat(), code);
    let b = |more: &[&str], code| asked(&[&SCENE_B[2..], more].concat(), code);
    for tolerance in ["0", "-0.02", "nan", "1e-9", "inf"] {
        assert!(b(&["--tolerance", tolerance], 2).contains("a tolerance of"));
    }
    assert!(b(&["--noise", "-1"], 2).contains("the noise floor is -1 m/s"));
    assert!(b(&["--gap-std", "nan"], 2).contains("uncertainty of the gap"));
    assert!(asked(&["--frequency", "5"], 2).contains("nothing drives"));
    assert!(asked(&["--frequency", "-5", "--force", "1"], 2).contains("frequency is -5 Hz"));
    assert!(asked(&["--frequency", "1e-6", "--force", "1"], 1).contains("swings"));
    let axis = |from: &str, to: &str, points: &str| {
        asked(&["--force", "1", "--from", from, "--to", to, "--points", points], 2)
    };
    assert!(axis("5", "4", "10").contains("an axis from 5 to 4 Hz"));
    assert!(axis("4", "5", "1").contains("1 points") && axis("4", "5", "100000000").contains("2 to 2000"));
    assert!(asked(&["--force", "1", "--from", "4"], 2).contains("--to"));
}

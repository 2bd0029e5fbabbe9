//! `vibro model orbit` and `response`: keys, settings, files, error messages.

use super::{complaint, json, text};

#[test]
fn an_orbit_has_its_keys() {
    let found = json(&["model", "orbit", "--frequency", "11", "--force", "0.5", "--gap-std", "1e-5"]);
    let orbit = &found["orbits"][0];
    for key in ["impulse", "timing", "approach_velocity", "min_gap", "spectral_radius", "grazing_distance"] {
        assert!(orbit[key].is_number(), "{key}");
    }
    for key in ["exists", "admissible", "stable", "energy_rule", "robust", "near_grazing"] {
        assert!(orbit[key].is_boolean(), "{key}");
    }
    for key in ["peak_to_peak", "fundamental"] {
        assert_eq!(orbit[key].as_array().map(Vec::len), Some(2), "{key}");
    }
    let multipliers = orbit["multipliers"].as_array().unwrap();
    assert!(multipliers.len() == 4 && multipliers.iter().all(|z| z.as_array().map(Vec::len) == Some(2)));
    assert_eq!(orbit["stability"], "stable");
    assert!(found["no_impact"]["possible"].is_boolean() && found["no_impact"]["amplitude"].is_number());
}

#[test]
fn a_rig_comes_from_a_file_and_settings() {
    let folder = tempfile::tempdir().unwrap();
    let rig = folder.path().join("rig.toml");
    std::fs::write(&rig, "gap = 2e-3\n[excitation]\nkind = \"impulse\"\nimpulse = 0.009\n").unwrap();
    let found = json(&["model", "orbit", text(&rig), "--frequency", "4", "--set", "gap=1e-3"]);
    assert_eq!(found["scene"]["gap"], 1e-3);
    assert_eq!(found["orbits"][0]["timing_unit"], "s");
    assert!(found["warnings"][0].as_str().unwrap().contains("does not give m1"));
    std::fs::write(&rig, "gap = 2e-3\nmass = 1\n").unwrap();
    let said = complaint(&["model", "orbit", text(&rig), "--frequency", "4", "--force", "1"], 2);
    assert!(said.contains("line 2") && said.contains("mass"), "{said}");
}

#[test]
fn a_response_and_its_files() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out");
    let found = json(&[
        "model",
        "response",
        "--from",
        "4",
        "--to",
        "12",
        "--points",
        "60",
        "--force",
        "0.1",
        "--out",
        text(&out),
    ]);
    assert_eq!(found["points"].as_array().map(Vec::len), Some(60));
    assert!(found["changes"].as_array().unwrap().iter().any(|c| c["kind"] == "fold"));
    for name in ["response.svg", "response.png", "response.csv", "changes.csv"] {
        assert!(out.join(name).is_file(), "{name}");
    }
}

#[test]
fn what_cannot_be_is_said() {
    let orbit = |more: &[&str], code| complaint(&[&["model", "orbit"], more].concat(), code);
    assert!(orbit(&["--frequency", "5"], 2).contains("nothing drives"));
    assert!(orbit(&["--frequency", "0", "--force", "1"], 2).contains("frequency is 0"));
    assert!(orbit(&["--frequency", "nan", "--force", "1"], 2).contains("frequency is NaN"));
    assert!(orbit(&["--frequency", "5", "--force", "1", "--set", "m1=-1"], 2).contains("m1 is -1 kg"));
    assert!(
        orbit(&["--frequency", "5", "--force", "1", "--set", "restitution=1.1"], 2)
            .contains("restitution is 1.1")
    );
    assert!(orbit(&["--frequency", "5", "--force", "1", "--cycles", "1000000000"], 1).contains("swings"));
    assert!(orbit(&["--frequency", "5", "--force", "0"], 2).contains("of 0"));
    assert!(
        complaint(&["model", "response", "--from", "5", "--to", "4", "--force", "1"], 2).contains("from")
    );
}

/// The energies are equal at both orbits and nowhere else.
#[test]
fn energies_cross_at_the_orbits() {
    let dir = tempfile::tempdir().unwrap();
    let scene =
        ["--frequency", "10.5", "--force", "0.1", "--set=restitution=0.98", "--out", text(dir.path())];
    let found = json(&[&["model", "orbit"], &scene[..]].concat());
    let impulse = |i: usize| found["orbits"][i]["impulse"].as_f64().unwrap();
    let table = std::fs::read_to_string(dir.path().join("energy.csv")).unwrap();
    let rows = table.lines().skip(1).map(|row| row.split(',').map(|v| v.parse().unwrap()).collect());
    let rows: Vec<Vec<f64>> = rows.collect();
    let crossings = rows.windows(2).filter(|w| (w[0][1] > w[0][2]) != (w[1][1] > w[1][2]));
    let crossings: Vec<[f64; 2]> = crossings.map(|w| [w[0][0], w[1][0]]).collect();
    assert_eq!(crossings.len(), 2, "{crossings:?}");
    for (crossing, orbit) in crossings.iter().zip([1, 0]) {
        assert!(crossing[0] <= impulse(orbit) && impulse(orbit) <= crossing[1], "{crossing:?}");
    }
}

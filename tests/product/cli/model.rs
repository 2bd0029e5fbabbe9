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

#[test]
fn a_hammer_drill_shows_the_three_motions_of_the_thesis() {
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/examples/hammer_drill/drill.toml");
    let at =
        |speed: &str| json(&["model", "drill", file, "--speed", speed, "--turns", "30", "--settle", "30"]);
    let velocities = |found: &serde_json::Value| -> Vec<f64> {
        let turn = found["turn"].as_array().unwrap().iter();
        turn.map(|sample| sample["velocities"][0].as_f64().unwrap()).collect()
    };
    // Low speed: about 0.5 m/s towards the bit, no blow.
    let low = at("7");
    assert_eq!((&low["regime"], &low["caught"]), (&"no-blow".into(), &serde_json::Value::Null));
    let fastest = velocities(&low).into_iter().fold(0.0, f64::max);
    assert!((0.3..0.6).contains(&fastest), "{fastest}");
    // Medium: it strikes, faster than the piston's 2π·18·0.0113 = 1.3 m/s. Full: near 7.5 m/s.
    for (speed, range) in [("18", 1.5..4.0), ("45", 6.5..8.5)] {
        let found = at(speed);
        assert_eq!(found["regime"], "every-turn");
        let fastest = velocities(&found).into_iter().fold(0.0, f64::max);
        assert!(range.contains(&fastest), "{speed}: {fastest}");
        assert_eq!(found["blow_rate"].as_f64().unwrap().round(), 60.0 * speed.parse::<f64>().unwrap());
        let energy = found["book"]["piston"].as_f64().unwrap();
        assert!(found["book"]["residual"].as_f64().unwrap().abs() < 1e-6 * energy, "{}", found["book"]);
        assert!(found["rungs"].as_array().unwrap().iter().all(|rung| rung["steps"].is_number()));
        assert!(found["forces"]["pressure"][1].as_f64().unwrap() > 101_325.0);
    }
}

#[test]
fn a_hammer_drill_comes_from_a_file_and_settings() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("drill.toml");
    std::fs::write(&file, "[drill.striker]\nmass = 0.2\n").unwrap();
    let found = json(&["model", "drill", text(&file), "--set", "crank.frequency=30", "--rung", "vented"]);
    assert_eq!(found["machine"]["striker"]["mass"], 0.2);
    assert_eq!((&found["speed"], &found["rung"]), (&30.0.into(), &"vented".into()));
    assert!(found["warnings"][0].as_str().unwrap().contains("cushion.length"), "{}", found["warnings"]);
    for (written, said) in [
        ("[drill.striker]\nmass = -0.2", "striker.mass is -0.2 kg"),
        ("[drill.striker]\nmas = 0.2", "did you mean `mass`"),
        ("[[drill]]\nfile = \"a.wav\"", "this is a campaign"),
        ("m1 = 1", "no table [drill]"),
    ] {
        std::fs::write(&file, written).unwrap();
        let found = complaint(&["model", "drill", text(&file)], 2);
        assert!(found.contains(said), "{written}: {found}");
    }
    std::fs::write(&file, "[drill]\n").unwrap();
    let other = complaint(&["model", "orbit", text(&file), "--frequency", "4", "--force", "1"], 2);
    assert!(other.contains("vibro model drill"), "{other}");
    for (range, key) in [("speeds", "5:5:3"), ("speeds", "5:60"), ("over", "cushion.size=1:2:3")] {
        let option = format!("--{range}={key}");
        let words = ["model", "drill", "--speeds", "5:6:2", &option];
        let words = if range == "speeds" { vec!["model", "drill", &option] } else { words.to_vec() };
        complaint(&words, 2);
    }
}

#[test]
fn speeds_and_maps_of_a_hammer_drill_have_their_regimes() {
    let more = ["--rung", "friction", "--turns", "10", "--settle", "10", "--speeds", "5:45:2"];
    let found = json(&[&["model", "drill", "--from-rest"], &more[..]].concat());
    let regimes: Vec<_> = found["speeds"].as_array().unwrap().iter().map(|cell| &cell["regime"]).collect();
    assert_eq!(regimes, ["no-blow", "every-turn"]);
    let start = found["start"]["blows"].as_array().unwrap();
    let first = start.iter().position(serde_json::Value::is_number).unwrap();
    assert_eq!((start.len(), found["start"]["caught"].as_u64()), (20, Some(first as u64 + 1)));
    let map = &json(&[&["model", "drill", "--over", "striker.friction=0:40:3"], &more[..]].concat())["map"];
    assert_eq!((&map["unit"], map["cells"].as_array().unwrap().len()), (&"N".into(), 6));
    // The second key runs slower than the speed; 40 N hold the striker.
    assert_eq!((&map["cells"][2]["value"], &map["cells"][5]["regime"]), (&20.0.into(), &"no-blow".into()));
}

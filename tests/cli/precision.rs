//! `vibro precision` on what an earlier run measured: fronts, lines of other programs, charts.

use serde_json::json;

#[test]
fn an_earlier_run_is_drawn_with_the_lines_of_other_programs() {
    let method = |name: &str, setting: &str, error: Option<f64>, time_ns: f64| {
        json!({
            "method": name, "setting": setting, "ours": name == "exact", "error": error, "error_spread": null,
            "time_ns": time_ns, "time_spread": [time_ns, time_ns], "failed": error.is_none(),
            "why": error.is_none().then_some("it stalls"), "front": true
        })
    };
    let scene = json!({
        "name": "scene C", "family": "models", "says": "A scene.", "error_of": "error in s", "truth": "arithmetic",
        "bound": null,
        "methods": [
            method("exact", "", Some(1e-15), 1e4), method("steps", "100", Some(1e-3), 1e5),
            method("steps", "1000", Some(1e-4), 1e6), method("events", "1e-6", None, 1e7),
        ]
    });
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    std::fs::write(path("earlier.json"), json!({ "scenes": [scene], "failures": [] }).to_string()).unwrap();
    let added = json!([
        { "scene": "scene C", "method": "Peer 1.0", "setting": "", "error": 1e-16, "time_ns": 1e8, "why": null },
        { "scene": "scene C", "method": "Peer 1.0", "setting": "loose", "error": null, "time_ns": 1e3, "why": "it stalls" },
        { "scene": "another", "method": "Peer 1.0", "setting": "", "error": 1e-3, "time_ns": 1e3, "why": null },
    ]);
    std::fs::write(path("added.json"), added.to_string()).unwrap();
    let answer = super::json(&[
        "precision",
        "--from",
        &path("earlier.json"),
        "--add",
        &path("added.json"),
        "--out",
        &path("out"),
    ]);
    // On the front: the fastest that answers and the most accurate; a failure is on none, however fast.
    let front: Vec<(&str, &str)> = answer["scenes"][0]["methods"]
        .as_array()
        .unwrap()
        .iter()
        .filter(|m| m["front"] == true)
        .map(|m| (m["method"].as_str().unwrap(), m["setting"].as_str().unwrap()))
        .collect();
    assert_eq!(front, [("exact", ""), ("Peer 1.0", "")]);
    assert!(answer["warnings"].to_string().contains("1 lines of"), "{}", answer["warnings"]);
    let chart = std::fs::read_to_string(path("out/precision_scene_c.svg")).unwrap();
    // What failed is named: "events" has failed alone, the other program once out of twice.
    assert!(chart.contains("above: failed"));
    assert_eq!((chart.matches(">events<").count(), chart.matches(">Peer 1.0<").count()), (1, 2));
    let table = std::fs::read_to_string(path("out/precision.csv")).unwrap();
    assert_eq!(table.lines().filter(|l| l.contains("it stalls")).count(), 2, "{table}");
    // Numbers that cannot be are no measurement.
    for (key, value) in [("time_ns", -5.0), ("error", -1.0)] {
        let mut edited: serde_json::Value =
            serde_json::from_str(&std::fs::read_to_string(path("earlier.json")).unwrap()).unwrap();
        edited["scenes"][0]["methods"][1][key] = json!(value);
        std::fs::write(path("edited.json"), edited.to_string()).unwrap();
        let said = super::complaint(&["precision", "--from", &path("edited.json")], 2);
        assert!(said.contains("scene C, steps 100") && said.contains("edited.json"), "{said}");
    }
    for wrong in ["earlier.json", "out"] {
        super::complaint(&["precision", "--from", &path("earlier.json"), "--add", &path(wrong)], 2);
    }
}

/// The whole of it, small: scenes and borders of the estimators, their charts, tables and keys.
#[test]
fn estimators_are_measured_and_drawn() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out");
    let answer = super::json(&[
        "precision",
        "--quick",
        "--family",
        "estimators",
        "--failures",
        "--out",
        out.to_str().unwrap(),
    ]);
    let scenes = answer["scenes"].as_array().unwrap();
    assert_eq!(scenes.len(), 9);
    for scene in scenes {
        assert!(scene["bound"].as_f64().unwrap() > 0.0 && scene["family"] == "estimators");
        for method in scene["methods"].as_array().unwrap() {
            for key in ["method", "setting", "ours", "error", "time_ns", "failed", "why", "front"] {
                assert!(method.get(key).is_some(), "{key} of {method}");
            }
            let failed = method["failed"].as_bool().unwrap();
            assert_eq!(method["error"].is_null(), failed);
            assert!(method["time_ns"].as_f64().unwrap() > 0.0 && (!failed || method["why"].is_string()));
        }
        // On each chart something is best, and this library has an answer.
        let methods = scene["methods"].as_array().unwrap();
        assert!(methods.iter().any(|m| m["front"] == true));
        assert!(methods.iter().any(|m| m["ours"] == true && m["failed"] == false));
    }
    let cells = answer["failures"].as_array().unwrap();
    let outcomes = ["right", "refused", "wrong", "stalled", "crashed"];
    for cell in cells {
        assert!(outcomes.contains(&cell["outcome"].as_str().unwrap()) && cell["family"] == "estimators");
        assert!(["method", "border", "scene", "why"].iter().all(|key| cell[key].is_string()));
    }
    // One chart a scene and one map a quantity, each twice, and two tables; names that every system takes.
    let files = answer["files"].as_array().unwrap();
    assert_eq!(files.len(), 2 * (9 + 5) + 2);
    let names: Vec<String> = std::fs::read_dir(&out)
        .unwrap()
        .map(|file| file.unwrap().file_name().into_string().unwrap())
        .collect();
    assert_eq!(names.len(), files.len());
    assert!(names.iter().all(|n| n.is_ascii() && n.chars().all(|c| c.is_alphanumeric() || "._".contains(c))));
    for name in ["precision_sine_noise.svg", "failures_estimators_contact_xi.png", "failures.csv"] {
        assert!(names.iter().any(|n| n == name), "{name}: {names:?}");
    }
    let rows = std::fs::read_to_string(out.join("failures.csv")).unwrap().lines().count();
    assert_eq!(rows, cells.len() + 1);
}

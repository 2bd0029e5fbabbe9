//! `vibro precision` on the results of an earlier run: fronts, results of other programs, charts.

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
    // The front has the fastest method with an answer and the most accurate one. A failure is never on it.
    let front: Vec<(&str, &str)> = answer["scenes"][0]["methods"]
        .as_array()
        .unwrap()
        .iter()
        .filter(|m| m["front"] == true)
        .map(|m| (m["method"].as_str().unwrap(), m["setting"].as_str().unwrap()))
        .collect();
    assert_eq!(front, [("exact", ""), ("Peer 1.0", "")]);
    let warnings = answer["warnings"][0].as_str().unwrap();
    assert!(warnings.contains("1 line of the scene \"another\""), "{warnings}");
    let chart = std::fs::read_to_string(path("out/precision_scene_c.svg")).unwrap();
    // Failed methods are named: `events` failed in its only run, the other program in one of two.
    assert!(chart.contains("above: failed"));
    let named =
        [">events: failed<", ">Peer 1.0<", ">Peer 1.0: failed<"].map(|name| chart.matches(name).count());
    assert_eq!((named, chart.matches(">events<").count()), ([1, 1, 1], 0));
    let table = std::fs::read_to_string(path("out/precision.csv")).unwrap();
    assert_eq!(table.lines().filter(|l| l.contains("it stalls")).count(), 2, "{table}");
    // Impossible numbers are refused.
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
    // The text names the unit of the errors, and an impossible number of another program is named.
    let text = super::vibro(&["precision", "--from", &path("earlier.json")]);
    assert!(String::from_utf8(text.stdout).unwrap().contains("\nError: error in s\n"));
    let impossible = json!([{ "scene": "scene C", "method": "Peer 1.0", "error": -1.0, "time_ns": 1e3 }]);
    std::fs::write(path("added.json"), impossible.to_string()).unwrap();
    let said =
        super::complaint(&["precision", "--from", &path("earlier.json"), "--add", &path("added.json")], 2);
    assert!(said.contains("Peer 1.0") && said.contains("error is -1; expected a number above 0"), "{said}");
}

/// Results of an earlier run: two scenes without methods, and a failure map of one cell.
fn earlier(family: &str) -> serde_json::Value {
    let scene = |name: &str| json!({ "name": name, "family": family, "says": "", "error_of": "error in s", "truth": "", "bound": null, "methods": [] });
    let cell = json!({
        "family": family, "method": "exact", "ours": true, "border": "grazing", "scene": "1e-9 m",
        "outcome": "right", "why": "all times agree"
    });
    json!({ "scenes": [scene("scene C"), scene("scene B, 100 s")], "failures": [cell] })
}

#[test]
fn failures_of_an_earlier_run_are_drawn_again() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    let held = earlier("models");
    std::fs::write(path("earlier.json"), held.to_string()).unwrap();
    for more in [&[][..], &["--failures"], &["--family", "models"]] {
        let out = path("out");
        let from = path("earlier.json");
        let typed = ["precision", "--from", &from, "--out", &out].into_iter().chain(more.iter().copied());
        let answer = super::json(&typed.collect::<Vec<_>>());
        assert_eq!(answer["failures"], held["failures"]);
        assert_eq!(answer["scenes"].as_array().unwrap().len(), 2);
        let map = std::fs::read_to_string(path("out/failures_models.svg")).unwrap();
        assert!(map.contains(">10⁻⁹ m<"));
        let table = std::fs::read_to_string(path("out/failures.csv")).unwrap();
        assert!(table.contains("all times agree"), "{table}");
        std::fs::remove_dir_all(out).unwrap();
    }
    // Parts that the file does not contain are reported.
    let said = super::complaint(&["precision", "--from", &path("earlier.json"), "--family", "estimators"], 2);
    assert!(said.contains("no scenes of this kind"), "{said}");
    std::fs::write(path("scenes.json"), json!({ "scenes": held["scenes"] }).to_string()).unwrap();
    let said = super::complaint(&["precision", "--from", &path("scenes.json"), "--failures"], 2);
    assert!(said.contains("no failures of this kind") && said.contains("try: "), "{said}");
}

/// The example in docs/precision.md is valid and has every key that its table lists; the example in
/// `--help` is valid.
#[test]
fn the_lines_of_other_programs_are_as_described() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    std::fs::write(path("earlier.json"), earlier("models").to_string()).unwrap();
    let document = concat!(env!("CARGO_MANIFEST_DIR"), "/docs/precision.md");
    let document = std::fs::read_to_string(document).unwrap();
    let example = document.split("```json\n").nth(1).unwrap().split("```").next().unwrap();
    let help = String::from_utf8(super::vibro(&["precision", "--help"]).stdout).unwrap();
    let shown = help[help.find("[{").unwrap()..].split_inclusive("}]").next().unwrap();
    for (lines, count) in [(example, 2), (shown, 1)] {
        std::fs::write(path("added.json"), lines).unwrap();
        let answer =
            super::json(&["precision", "--from", &path("earlier.json"), "--add", &path("added.json")]);
        assert_eq!(answer["warnings"], json!([]));
        let methods =
            answer["scenes"].as_array().unwrap().iter().flat_map(|s| s["methods"].as_array().unwrap());
        assert_eq!(methods.count(), count);
    }
    let lines: Vec<serde_json::Value> = serde_json::from_str(example).unwrap();
    let keys = ["scene", "method", "setting", "error", "time_ns", "why"];
    for key in keys {
        assert!(document.contains(&format!("| `{key}` |")), "{key}");
        assert!(lines.iter().any(|line| line.get(key).is_some()), "{key}");
    }
    assert!(lines.iter().all(|line| line.as_object().unwrap().keys().all(|k| keys.contains(&k.as_str()))));
}

/// The whole command in its quick form: scenes and limits of the estimators, their charts, tables and keys.
#[test]
#[ignore = "the whole command: cargo test --release -- --ignored"]
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
    assert_eq!(scenes.len(), 11);
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
        // Each chart has a front, and this library has an answer.
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
    // One chart per scene and one map per quantity, each in two formats, and two tables. File names are
    // valid on every system.
    let files = answer["files"].as_array().unwrap();
    assert_eq!(files.len(), 2 * (11 + 5) + 2);
    let names: Vec<String> = std::fs::read_dir(&out)
        .unwrap()
        .map(|file| file.unwrap().file_name().into_string().unwrap())
        .filter(|name| !name.starts_with(".vibro."))
        .collect();
    assert_eq!(names.len(), files.len());
    assert!(names.iter().all(|n| n.is_ascii() && n.chars().all(|c| c.is_alphanumeric() || "._".contains(c))));
    for name in ["precision_sine_noise.svg", "failures_estimators_contact_xi.png", "failures.csv"] {
        assert!(names.iter().any(|n| n == name), "{name}: {names:?}");
    }
    let rows = std::fs::read_to_string(out.join("failures.csv")).unwrap().lines().count();
    assert_eq!(rows, cells.len() + 1);
}

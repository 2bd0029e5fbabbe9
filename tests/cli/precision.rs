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

//! `vibro impacts` and `vibro restitution`: keys, numbers, refusals.

use super::{complaint, json};
use serde_json::Value;

fn trace(case: &str) -> String {
    format!("{}/fixtures/reference/scripts/timeav_{case}/TRACE01.DAT", env!("CARGO_MANIFEST_DIR"))
}

fn example(name: &str) -> String {
    format!("{}/examples/drop_test/{name}", env!("CARGO_MANIFEST_DIR"))
}

fn has(value: &Value, wanted: &[&str]) {
    for key in wanted {
        assert!(value.get(key).is_some(), "no key {key} in {value}");
    }
}

#[test]
fn impacts_answers_with_the_keys_that_programs_read() {
    let found = json(&["impacts", &trace("missing"), "--base-band", "50", "--excitation", "7.49"]);
    has(
        &found,
        &[
            "n",
            "interval",
            "frequency",
            "median_interval",
            "spread",
            "missed",
            "doubled",
            "per_cycle",
            "regular",
            "times",
        ],
    );
    has(&found["interval"], &["value", "std", "unit", "n", "method"]);
    assert_eq!((found["n"].as_u64(), found["missed"].as_u64()), (Some(58), Some(2)));
    assert_eq!(
        (found["per_cycle"]["impacts"].as_u64(), found["per_cycle"]["cycles"].as_u64()),
        (Some(1), Some(1))
    );
    let irregular = json(&["impacts", &trace("irregular"), "--rate", "128"]);
    assert_eq!((irregular["regular"].as_bool(), irregular["per_cycle"].is_null()), (Some(false), true));
}

#[test]
fn impacts_legacy_is_that_of_timeav() {
    let found = json(&["impacts", &trace("noiselead"), "--base-band", "50", "--legacy"]);
    assert_eq!(found["n"], 117);
    assert!((found["frequency"]["value"].as_f64().unwrap() - 14.788_844_621_513_945).abs() < 1e-12);
    let one = json(&["impacts", &trace("bigfirst"), "--base-band", "50", "--legacy"]);
    assert!(one["n"] == 1 && one["interval"]["value"].is_null());
    assert!(complaint(&["impacts", &trace("header"), "--base-band", "50", "--legacy"], 1).contains("header"));
}

#[test]
fn impacts_refuses_what_it_cannot_answer() {
    assert!(complaint(&["impacts", &trace("nominal")], 2).contains("--base-band"));
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("flat.txt");
    std::fs::write(&path, "1\n".repeat(50)).unwrap();
    assert!(complaint(&["impacts", path.to_str().unwrap(), "--rate", "100"], 1).contains("equal"));
}

#[test]
fn impacts_draws_what_it_found() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().to_str().unwrap();
    json(&["impacts", &trace("nominal"), "--base-band", "50", "--out", out]);
    for name in ["impacts.svg", "impacts.png", "impacts.csv"] {
        assert!(folder.path().join(name).is_file(), "{name}");
    }
}

#[test]
fn restitution_of_numbers_and_of_records() {
    let found = json(&["restitution", "--height", "0.57", "--interval", "0.144"]);
    has(&found, &["restitution", "by", "agree"]);
    assert!((found["restitution"]["value"].as_f64().unwrap() - 0.2112).abs() < 5e-5);
    has(&found["by"][0], &["method", "restitution"]);
    let drops: Vec<String> = (1..=5).map(|i| example(&format!("DROP{i:02}.CSV"))).collect();
    let mut arguments = vec!["restitution", "--height", "0.57", "--height-std", "0.001"];
    arguments.extend(drops.iter().map(String::as_str));
    let found = json(&arguments);
    let (r, u) = (&found["restitution"]["value"], &found["restitution"]["std"]);
    assert!((r.as_f64().unwrap() - 0.2112).abs() < 4.0 * u.as_f64().unwrap(), "{found}");
    let train = json(&["restitution", &example("BOUNCE.CSV"), "--height", "0.57", "--height-std", "0.001"]);
    assert_eq!((train["by"].as_array().unwrap().len(), train["agree"].as_bool()), (2, Some(true)));
    let torn = json(&[
        "restitution",
        "--height",
        "0.57",
        "--height-std",
        "0.001",
        "--interval-std",
        "0.0005",
        "--intervals",
        "0.2,0.18,0.162,0.1458,0.13122",
    ]);
    assert!(torn["agree"] == false && torn["restitution"]["value"].is_null(), "{torn}");
    // (0.14·7.5 − 0.28·4)/0.14 = −0.5, and (4 + 0.5)/7.5 = 0.6.
    let struck = json(&["restitution", "--before", "7.5,0", "--after2", "4", "--masses", "0.14,0.28"]);
    assert!((struck["restitution"]["value"].as_f64().unwrap() - 0.6).abs() < 1e-12, "{struck}");
}

#[test]
fn restitution_refuses_what_cannot_be() {
    assert!(complaint(&["restitution", "--height", "0", "--interval", "0.144"], 1).contains("above 0"));
    assert!(complaint(&["restitution", "--height", "0.57", "--interval", "0.9"], 1).contains("at most"));
    assert!(complaint(&["restitution", "--before", "1,2", "--after", "1,2"], 1).contains("do not approach"));
    assert!(complaint(&["restitution"], 2).contains("--height"));
    assert!(complaint(&["restitution", "--interval", "0.1"], 2).contains("--height"));
}

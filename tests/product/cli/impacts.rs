//! `vibro impacts` and `vibro restitution`: keys, values, error messages.

use super::{complaint, json, vibro};
use serde_json::Value;
use std::fmt::Write as _;
use vibroimpact::math::Noise;

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
    // The methods disagree and none is preferred, so there is no answer; the JSON gives the result of each.
    let torn = vibro(&[
        "restitution",
        "--json",
        "--height",
        "0.57",
        "--height-std",
        "0.001",
        "--interval-std",
        "0.0005",
        "--intervals",
        "0.2,0.18,0.162,0.1458,0.13122",
    ]);
    assert_eq!(torn.status.code(), Some(1));
    let torn: Value = serde_json::from_slice(&torn.stdout).unwrap();
    assert!(torn["agree"] == false && torn["restitution"]["value"].is_null(), "{torn}");
    // Momentum: (0.14·7.5 − 0.28·4)/0.14 = −0.5 m/s after the impact, so R = (4 + 0.5)/7.5 = 0.6.
    let struck = json(&["restitution", "--before", "7.5,0", "--after2", "4", "--masses", "0.14,0.28"]);
    assert!((struck["restitution"]["value"].as_f64().unwrap() - 0.6).abs() < 1e-12, "{struck}");
}

#[test]
fn restitution_refuses_what_cannot_be() {
    assert!(complaint(&["restitution", "--height", "0", "--interval", "0.144"], 2).contains("above 0"));
    assert!(complaint(&["restitution", "--height", "0.57", "--interval", "0.9"], 1).contains("at most"));
    assert!(complaint(&["restitution", "--before", "1,2", "--after", "1,2"], 1).contains("do not approach"));
    assert!(complaint(&["restitution"], 2).contains("--height"));
    assert!(complaint(&["restitution", "--interval", "0.1"], 2).contains("--height"));
}

#[test]
fn impacts_are_matched_to_a_shape_that_is_known() {
    let folder = tempfile::tempdir().unwrap();
    // Gaussian pulses of 0.3 ms standard deviation, sampled at 10 kHz with peaks between samples. The known
    // shape is sampled at 50 kHz.
    let pulse = |t: f64| (-0.5 * (t / 3e-4).powi(2)).exp();
    let times: Vec<f64> = (0..12).map(|k| 0.05 + 0.100_037 * f64::from(k)).collect();
    let mut noise = Noise::new(5);
    let mut trace = String::from("time [s],contact [V]\n");
    for i in 0..12_500 {
        let noise = noise.between(-1e-3, 1e-3);
        let t = f64::from(i) * 1e-4;
        let value = 3.0 * times.iter().map(|at| pulse(t - at)).sum::<f64>() + 3.0 * noise;
        let _ = writeln!(trace, "{t:.4},{value:.6}");
    }
    let shape: String = (0..150).fold("time [s],pulse [V]\n".to_owned(), |text, i| {
        let t = f64::from(i) * 2e-5;
        text + &format!("{t:.5},{:.9}\n", 0.2 * pulse(t - 1.5e-3))
    });
    let [file, known] = ["contact.csv", "shape.csv"].map(|name| folder.path().join(name));
    std::fs::write(&file, trace).unwrap();
    std::fs::write(&known, shape).unwrap();
    let found = json(&["impacts", file.to_str().unwrap(), "--shape", known.to_str().unwrap()]);
    assert!(found["interval"]["method"].as_str().unwrap().contains("known shape"), "{found}");
    // The rising flank passes half its height √(2 ln 2) standard deviations before the peak.
    let early = 3e-4 * (2.0 * 2f64.ln()).sqrt();
    let ours: Vec<f64> = found["times"].as_array().unwrap().iter().map(|t| t.as_f64().unwrap()).collect();
    assert_eq!(ours.len(), times.len());
    for (a, b) in ours.iter().zip(&times) {
        // Noise: σ = 2e-3/√12 = 5.8e-4 of the height. Pulse of 3 samples standard deviation: Σ(slope)² =
        // √π/6. The time is then known to σ/√0.30 = 1.1e-3 samples = 1.1e-7 s; five times that is allowed.
        assert!((a - (b - early)).abs() < 6e-7, "{a} {}", b - early);
    }
    let constant = folder.path().join("constant.csv");
    std::fs::write(&constant, "time [s],a [V]\n0,1\n0.1,1\n0.2,1\n0.3,1\n0.4,1\n0.5,1\n").unwrap();
    let said = complaint(&["impacts", file.to_str().unwrap(), "--shape", constant.to_str().unwrap()], 1);
    assert!(said.contains("no shape of a pulse"), "{said}");
}

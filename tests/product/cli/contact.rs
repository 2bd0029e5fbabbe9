//! `vibro pulse`.

use super::{complaint, json, text, vibro};
use std::f64::consts::TAU;
use std::fmt::Write as _;
use std::fs;

#[test]
fn two_times() {
    let answer = json(&[
        "pulse",
        "--time-to-peak",
        "6.25e-6",
        "--duration",
        "18e-6",
        "--mass",
        "0.43",
        "--std",
        "1e-8",
    ]);
    assert!((answer["xi"]["value"].as_f64().unwrap() - 0.20668).abs() < 0.5e-5, "{answer}");
    assert!(answer["xi"]["std"].as_f64().unwrap() > 0.0 && answer["initial_velocity"].is_null());
    assert!(answer["stiffness"]["unit"] == "N/m" && answer["fits"].as_array().unwrap().is_empty());
    // The impulse response of the low-pass of 30 kHz alone lasts longer: its first zero is at 1/(√2·30 kHz)
    // = 23.6 µs.
    let behind =
        ["pulse", "--time-to-peak", "6.25e-6", "--duration", "18e-6", "--low-pass", "30000", "--order", "2"];
    let answer = json(&behind);
    assert!(
        answer["xi"]["value"].is_null() && answer["warnings"].to_string().contains("23.6 µs"),
        "{answer}"
    );
    let swapped = complaint(&["pulse", "--time-to-peak", "18e-6", "--duration", "6.25e-6"], 1);
    assert!(swapped.contains("swapped"), "{swapped}");
    complaint(&["pulse", "--time-to-peak", "18e-6"], 2);
    complaint(&["pulse"], 2);
}

#[test]
fn a_record_with_its_figure() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("bit.csv");
    // Deceleration of x = e^{-ht} sin(Ωt)/Ω with ξ = 0.2 and 10 kHz, from 3 m/s until it vanishes.
    let (xi, omega) = (0.2_f64, TAU * 10e3);
    let (h, turn) = (xi * omega, omega * f64::sqrt(1.0 - xi * xi));
    let end = (2.0 * h * turn).atan2(h * h - turn * turn) / turn;
    let mut rows = String::from("time [s],acceleration [m/s²]\n");
    for i in 0..200 {
        let t = f64::from(i) * 1e-6 - 80.4e-6;
        let (sin, cos) = (turn * t).sin_cos();
        let inside = (0.0..=end).contains(&t);
        let a = (-h * t).exp() * ((turn * turn - h * h) * sin + 2.0 * h * turn * cos) / turn;
        let noise = 200.0 * (f64::from(i * i) * 0.7).sin();
        let _ =
            writeln!(rows, "{:.6e},{:.6e}", f64::from(i) * 1e-6, if inside { 3.0 * a } else { 0.0 } + noise);
    }
    fs::write(&path, rows).unwrap();
    let out = folder.path().join("figures");
    let answer = json(&["pulse", text(&path), "--mass", "0.4", "--low-pass", "none", "--out", text(&out)]);
    assert!((answer["xi"]["value"].as_f64().unwrap() - 0.2).abs() < 0.01, "{answer}");
    for key in ["frequency", "restitution", "stiffness", "damping", "initial_velocity"] {
        assert!(answer[key]["value"].is_f64() && answer[key]["std"].is_f64(), "{key}: {answer}");
    }
    for fit in answer["fits"].as_array().unwrap() {
        assert!(fit["model"].is_string() && fit["residual"].is_f64() && fit["aicc"].is_f64(), "{fit}");
    }
    assert!(out.join("pulse.svg").is_file() && out.join("pulse_fits.csv").is_file());
    let campaign = folder.path().join("campaign.toml");
    fs::write(&campaign, "[[pulse]]\nfile = \"bit.csv\"\nmass = 0.4\nlow_pass = 1e6\norder = 2\n").unwrap();
    let whole = json(&["run", text(&campaign)]);
    assert!(whole["results"]["pulses"][0]["xi"]["value"].is_f64(), "{whole}");
}

#[test]
fn a_record_that_allows_no_answer_does_not_end_a_campaign() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    let rows = |unit: &str, value: &dyn Fn(u32) -> f64| {
        (0..400).fold(format!("time [s],a [{unit}],b [V]\n"), |mut rows, i| {
            let _ = writeln!(rows, "{:.6e},{},0", f64::from(i) * 1e-5, value(i));
            rows
        })
    };
    fs::write(at("flat.csv"), rows("m/s²", &|_| 0.0)).unwrap();
    // A half sine of 1 ms.
    let half = |i: u32| if i < 100 { 300.0 * (TAU * f64::from(i) / 200.0).sin() } else { 0.0 };
    fs::write(at("good.csv"), rows("m/s²", &|i| half(i.wrapping_sub(150)))).unwrap();
    let entries = "[[pulse]]\nname = \"P\"\nfile = \"flat.csv\"\nchannel = \"a\"\n\
        [[impacts]]\nname = \"I\"\nfile = \"flat.csv\"\nchannel = \"a\"\n\
        [[drop]]\nname = \"D\"\nfile = \"flat.csv\"\nchannel = \"a\"\n\
        [[drill]]\nname = \"M\"\nfile = \"flat.csv\"\nvelocity = \"a\"\nreference = \"b\"\nsensitivity = 1.0\n\
        beam_angle = 0\nfrom = \"axis\"\npulses_per_turn = 1\nedge = \"rising\"\n";
    let campaign = at("campaign.toml");
    let good = "[[pulse]]\nname = \"good\"\nfile = \"good.csv\"\nchannel = \"a\"\n";
    fs::write(&campaign, format!("{entries}{good}")).unwrap();
    let found = json(&["run", text(&campaign)]);
    let results = &found["results"];
    assert_eq!(results["pulses"].as_array().map(Vec::len), Some(1), "{found}");
    assert_eq!(results["pulses"][0]["name"], "good");
    for key in ["impacts", "drops", "drill"] {
        assert!(results[key].as_array().unwrap().is_empty(), "{key}");
    }
    let said = found["warnings"].to_string();
    for name in ["P", "I; flat.csv", "M"] {
        assert!(said.contains(&format!("{name}: Left out: ")), "{name}: {said}");
    }
    fs::write(&campaign, entries).unwrap();
    // The report is written; the exit code shows that it contains no result.
    let output = vibro(&["run", text(&campaign), "--json"]);
    assert_eq!(output.status.code(), Some(1));
    let none: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert!(none["warnings"].to_string().contains("No file allows an answer: nothing was computed."));
    // A file that cannot be read still ends the run.
    fs::write(at("flat.csv"), "no numbers here\n").unwrap();
    complaint(&["run", text(&campaign)], 2);
}

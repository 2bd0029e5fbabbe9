//! `vibro modal`.

use super::{complaint, json, text};
use std::f64::consts::TAU;
use std::fmt::Write as _;
use std::fs;

/// An accelerance of a mode at 80.3 Hz with ζ 0.01 and A = 2/kg, by its formula.
fn accelerance() -> String {
    let mut rows =
        String::from("frequency [Hz],accelerance real [(m/s²)/N],accelerance imaginary [(m/s²)/N]\n");
    for i in 0..400 {
        let f = f64::from(i) * 0.5;
        let (omega, own) = (TAU * f, TAU * 80.3);
        let (re, im) = (own * own - omega * omega, 0.02 * own * omega);
        let size = -2.0 * omega * omega / (re * re + im * im);
        let _ = writeln!(rows, "{f},{:.8e},{:.8e}", size * re, -size * im);
    }
    rows
}

#[test]
fn modes_of_a_file() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("plate.csv");
    fs::write(&path, accelerance()).unwrap();
    let out = folder.path().join("figures");
    let answer = json(&["modal", text(&path), "--complex", "--mass", "0.125", "--out", text(&out)]);
    let mode = &answer["modes"][0];
    // Printed to nine digits.
    assert!((mode["frequency"]["value"].as_f64().unwrap() - 80.3).abs() < 1e-5, "{answer}");
    assert!((mode["zeta"]["value"].as_f64().unwrap() - 0.01).abs() < 1e-6, "{answer}");
    assert!(mode["method"].is_string() && mode["stiffness"]["value"].is_f64());
    let methods: Vec<&str> =
        mode["by"].as_array().unwrap().iter().filter_map(|b| b["method"].as_str()).collect();
    assert_eq!(methods, ["rational fit", "circle fit", "half power", "peak"]);
    assert!(
        out.join("nyquist.svg").is_file() && out.join("frf.png").is_file() && out.join("modes.csv").is_file()
    );
    let none = complaint(&["modal", text(&path), "--complex", "--band", "120:150"], 1);
    assert!(none.contains("no peak between"), "{none}");
    complaint(&["modal", text(&path), "--complex", "--band", "120"], 2);
}

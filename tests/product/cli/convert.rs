//! `vibro convert` with filters, integration and differentiation in the time domain.

use super::{complaint, json, text};
use std::f64::consts::TAU;
use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};
use vibroimpact::read::Reader;
use vibroimpact::record::Trace;

const RATE: f64 = 2000.0;
const OMEGA: f64 = TAU * 20.0;

/// 4 s of a velocity at 20 Hz with a displacement amplitude of 1 mm, plus a tenth of it at 200 Hz and a
/// mean of half of it; a second channel `pulse`.
fn bench(folder: &Path) -> PathBuf {
    let mut rows = String::from("time [s],velocity [m/s],pulse [V]\n");
    for i in 0..8000 {
        let t = f64::from(i) / RATE;
        let v = 1e-3 * OMEGA * ((OMEGA * t).cos() + 0.1 * (10.0 * OMEGA * t).cos() + 0.5);
        let _ = writeln!(rows, "{t},{v},{}", i % 100);
    }
    let path = folder.join("bench.csv");
    fs::write(&path, rows).unwrap();
    path
}

/// Amplitude at a multiple of 20 Hz, by projection on the middle two seconds.
fn amplitude(trace: &Trace, multiple: f64) -> f64 {
    let (mut re, mut im) = (0.0, 0.0);
    for i in 2000..6000 {
        let (sin, cos) = (multiple * OMEGA * i as f64 / RATE).sin_cos();
        (re, im) = (re + trace.values[i] * cos, im + trace.values[i] * sin);
    }
    f64::hypot(re, im) / 2000.0
}

fn converted(input: &Path, options: &[&str]) -> (Trace, String) {
    let out = input.with_file_name("out.uff");
    let answer = json(&[&["convert", text(input), text(&out), "--channel", "velocity"], options].concat());
    assert_eq!(answer["records"], 1);
    let trace = Reader::new().from_path(&out).unwrap().trace(None, None).unwrap();
    (trace, answer["warnings"].to_string())
}

#[test]
fn velocity_to_displacement_and_acceleration() {
    let folder = tempfile::tempdir().unwrap();
    let input = bench(folder.path());
    let (x, said) = converted(&input, &["--integrate", "1", "--fmin", "5", "--excitation", "20"]);
    assert_eq!(x.meta.unit.symbol(), "m");
    // The stated band, 9.7 to 78 Hz, is accurate to 1 %.
    assert!((amplitude(&x, 1.0) / 1e-3 - 1.0).abs() < 0.01, "{}", amplitude(&x, 1.0));
    for sentence in ["integrated once", "order 4, corner 5 Hz", "within 1 % from 9.", "Drift left: "] {
        assert!(said.contains(sentence), "{sentence}: {said}");
    }
    // The stated gain at the excitation frequency is the actual one. The high-pass settles to 1e-4 within
    // 3/5 s.
    for (corner, band) in [("5", " Hz high-pass"), ("12", "outside the band")] {
        let (x, said) = converted(&input, &["--integrate", "1", "--fmin", corner, "--excitation", "20"]);
        let (before, after) = said.split_once("trapezoidal rule leave ").unwrap();
        let gain: f64 = after.split(' ').next().unwrap().parse().unwrap();
        assert!(before.contains(band), "{said}");
        assert!((amplitude(&x, 1.0) / 1e-3 / gain - 1.0).abs() < 1e-4, "{corner} Hz: {gain}");
        assert!(said.contains("Divide by it"), "{said}");
    }
    let (_, said) = converted(&input, &["--integrate", "1", "--fmin", "5"]);
    assert!(!said.contains("may be divided"), "{said}");
    let (a, said) = converted(&input, &["--integrate", "-1"]);
    assert_eq!(a.meta.unit.symbol(), "m/s²");
    for (multiple, part) in [(1.0, 1.0), (10.0, 1.0)] {
        // A tenth of the velocity at ten times the frequency has the same acceleration; 200 Hz is below the
        // stated limit of 235 Hz.
        let found = amplitude(&a, multiple) / (1e-3 * OMEGA * OMEGA);
        assert!((found / part - 1.0).abs() < 0.01, "{multiple}: {found}");
    }
    assert!(said.contains("differentiated once") && said.contains("up to 235"), "{said}");
    let (same, said) = converted(&input, &["--calibration", "2"]);
    assert!((amplitude(&same, 1.0) / (2e-3 * OMEGA) - 1.0).abs() < 1e-6 && !said.contains("corner"));
}

#[test]
fn filters_pass_twice() {
    let folder = tempfile::tempdir().unwrap();
    let input = bench(folder.path());
    let velocity = 1e-3 * OMEGA;
    let (low, said) = converted(&input, &["--low-pass", "20"]);
    // The filter passes forwards and backwards: half at the corner, 1/(1 + 10⁸) of the tenth at ten times
    // the corner.
    assert!((amplitude(&low, 1.0) / velocity - 0.5).abs() < 1e-3, "{}", amplitude(&low, 1.0));
    assert!(amplitude(&low, 10.0) < 1e-6 * velocity);
    assert!(said.contains("low-pass of order 4, corner 20 Hz, forwards and backwards"), "{said}");
    let (high, _) = converted(&input, &["--high-pass", "200"]);
    assert!((amplitude(&high, 10.0) / velocity - 0.05).abs() < 1e-4);
    assert!(amplitude(&high, 1.0) < 1e-6 * velocity);
}

#[test]
fn what_cannot_be_integrated_writes_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let input = bench(folder.path());
    let out = folder.path().join("out.csv");
    let why = |options: &[&str], code| {
        complaint(&[&["convert", text(&input), text(&out), "--channel", "velocity"], options].concat(), code)
    };
    assert!(why(&["--integrate", "1"], 2).contains("--fmin"));
    assert!(why(&["--fmin", "5"], 2).contains("--integrate"));
    assert!(why(&["--integrate", "-1", "--excitation", "20"], 2).contains("--excitation"));
    assert!(why(&["--integrate", "1", "--fmin=-5"], 2).contains("fmin is -5"));
    assert!(why(&["--integrate", "1", "--fmin", "500"], 1).contains("no band"));
    why(&["--low-pass", "1000"], 2);
    why(&["--integrate", "3", "--fmin", "5"], 2);
    let lines = folder.path().join("lines.csv");
    fs::write(&lines, "frequency [Hz],velocity [m/s]\n0,1\n1,2\n2,3\n3,4\n").unwrap();
    let spectrum = complaint(&["convert", text(&lines), text(&out), "--integrate", "1", "--fmin", "1"], 1);
    assert!(spectrum.contains("no time trace") && spectrum.contains("vibro spectrum"), "{spectrum}");
    assert!(!out.exists());
}

#[test]
fn exponential_smoothing_is_late_by_its_time_constant() {
    let folder = tempfile::tempdir().unwrap();
    let input = folder.path().join("ramp.csv");
    let rows = (0..2000).fold("time [s],velocity [m/s]\n".to_owned(), |text, i| {
        text + &format!("{t:.4},{t:.4}\n", t = f64::from(i) / RATE)
    });
    fs::write(&input, rows).unwrap();
    let (slow, said) = converted(&input, &["--smoothing", "0.01"]);
    let late = 0.75 - slow.values[1500];
    // A ramp is delayed by (1 − α)/α samples, which is the time constant to within half a sample.
    assert!((late - 0.01).abs() < 0.5 / RATE, "{late}");
    assert!(said.contains("exponential smoothing") && said.contains("15.915494 Hz"), "{said}");
    let both = ["convert", text(&input), "x.csv", "--smoothing", "0.01", "--low-pass", "5"];
    complaint(&both, 2);
}

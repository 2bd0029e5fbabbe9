//! `vibro model sweep` and `vibro model map`.

use super::{json, vibro};
use std::fs;

fn words(line: &str) -> Vec<&str> {
    line.split(' ').collect()
}

#[test]
fn a_sweep_has_its_keys_and_files() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().to_str().unwrap();
    let line =
        format!("model sweep --force 0.5 --from 9 --to 11 --steps 9 --settle 20 --measure 2 --out {out}");
    let answer = json(&words(&line));
    for side in ["up", "down"] {
        let points = answer[side].as_array().unwrap();
        assert_eq!(points.len(), 9);
        for key in ["frequency", "x1", "x2", "force"] {
            assert!(points[0][key].is_f64(), "{side} {key}");
        }
    }
    assert_eq!(answer["up"][0]["frequency"], 9.0);
    assert_eq!(answer["down"][0]["frequency"], 11.0);
    assert!(answer["resonances"].is_array() && answer["jumps"].is_array());
    for name in ["sweep.svg", "sweep.png", "sweep.csv"] {
        assert!(folder.path().join(name).exists(), "{name}");
    }
}

#[test]
fn a_sweep_of_the_force_keeps_its_frequency() {
    let answer = json(&words(
        "model sweep --over force --force 0.1 --frequency 10 --from 0.1 --to 0.5 --steps 3 --settle 5 --measure 1 --direction up",
    ));
    let forces: Vec<f64> =
        answer["up"].as_array().unwrap().iter().map(|p| p["force"].as_f64().unwrap()).collect();
    // Two rounding errors of numbers below 1.
    let off = forces.iter().zip([0.1, 0.3, 0.5]).map(|(f, truth)| (f - truth).abs());
    assert!(forces.len() == 3 && off.fold(0.0, f64::max) < 2.0 * f64::EPSILON, "{forces:?}");
    assert_eq!(answer["up"][2]["frequency"], 10.0);
    assert!(answer["down"].as_array().unwrap().is_empty());
}

/// A sweep that starts from the final state of another continues it. Only the clock differs: times round to
/// 1e-16 of 20 s, in which the masses move 1e-13 of their amplitude. Impacts amplify that by less than 100
/// in a step.
#[test]
fn a_sweep_from_the_end_of_another_continues_it() {
    let swept = |range: &str, start: &str| {
        json(&words(&format!(
            "model sweep --over force --force 0.1 --frequency 8 {range} --settle 24 --measure 8 --direction up{start}"
        )))
    };
    let whole = swept("--from 0.25 --to 1.25 --steps 5", "");
    let first = swept("--from 0.25 --to 0.5 --steps 2", "");
    let end = &first["ends"][0];
    let numbers = ["x1", "v1", "x2", "v2", "phase"].map(|key| end[key].as_f64().unwrap().to_string());
    let second = swept("--from 0.75 --to 1.25 --steps 3", &format!(" --start={}", numbers.join(",")));
    for (i, point) in second["up"].as_array().unwrap().iter().enumerate() {
        for key in ["force", "x1", "x2"] {
            let [found, expected] = [point, &whole["up"][i + 2]].map(|p| p[key].as_f64().unwrap());
            assert!((found / expected - 1.0).abs() < 1e-11, "{key} of point {i}: {found} {expected}");
        }
    }
}

/// Above the natural frequency of the masses moving together they clap, whatever the number of steps.
#[test]
fn names_do_not_depend_on_the_number_of_steps() {
    for steps in [60, 150] {
        let line =
            format!("model sweep --force 0.5 --from 8 --to 12 --steps {steps} --settle 300 --direction up");
        let answer = json(&words(&line));
        let kinds: Vec<_> = answer["resonances"].as_array().unwrap().iter().map(|r| &r["kind"]).collect();
        assert_eq!(kinds, ["antiresonance", "clapping", "clapping"], "{steps} steps");
    }
}

#[test]
fn a_start_has_five_numbers() {
    let output = vibro(&words("model sweep --force 0.1 --from 3 --to 4 --start 0,0,0,0"));
    assert!(String::from_utf8_lossy(&output.stderr).contains("five: x1,v1,x2,v2,phase"));
}

/// The sweep down begins at the state in which the sweep up ends, not after the cycles that are drawn there:
/// a sweep down that is started from that state has the same amplitudes, but for the rounding of its phase.
#[test]
fn down_continues_at_the_end_of_up() {
    let range = "model sweep --force 0.5 --from 9 --to 10 --steps 5 --settle 5 --measure 2";
    let both = json(&words(&format!("{range} --direction up-down")));
    let end = |key: &str| both["ends"][0][key].as_f64().unwrap();
    let [x1, v1, x2, v2, phase] = ["x1", "v1", "x2", "v2", "phase"].map(end);
    let down =
        json(&words(&format!("{range} --direction down --start={x1:?},{v1:?},{x2:?},{v2:?},{phase:?}")));
    for (a, b) in both["down"].as_array().unwrap().iter().zip(down["down"].as_array().unwrap()) {
        let [a, b] = [a, b].map(|point| point["x1"].as_f64().unwrap());
        assert!((a / b - 1.0).abs() < 1e-9, "{a} {b}");
    }
}

#[test]
fn a_largest_amplitude_in_irregular_motion_is_named() {
    let answer = json(&words("model sweep --force 0.5 --from 11.5 --to 12 --steps 20 --direction up"));
    let largest = |key: &str| {
        let points = answer["up"].as_array().unwrap().iter();
        points.map(|p| p[key].as_f64().unwrap()).fold(0.0, f64::max)
    };
    let all = answer["findings"].as_array().unwrap().iter();
    let named: Vec<_> = all.filter(|f| f["code"] == "sweep-maximum-irregular").collect();
    assert!(!named.is_empty());
    for found in named {
        let mass = found["numbers"]["mass"].as_f64().unwrap();
        assert_eq!(found["numbers"]["amplitude"], largest(&format!("x{mass}")));
    }
}

#[test]
fn a_map_has_its_keys_and_its_rows() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().to_str().unwrap();
    let line = format!(
        "model map --force 0.5 --x frequency:9:11:3 --y restitution:0.4:0.6:4 --cycles 60 --out {out}"
    );
    let first = json(&words(&line));
    assert_eq!(first["x"].as_array().unwrap().len(), 3);
    assert_eq!(first["regime"].as_array().unwrap().len(), 4);
    assert_eq!(first["spectral_radius"][3].as_array().unwrap().len(), 3);
    // The header line and one line per cell.
    let whole = fs::read_to_string(folder.path().join("map.csv")).unwrap();
    assert_eq!(whole.lines().count(), 1 + 3 * 4);
}

#[test]
fn bad_requests_are_complaints() {
    for (line, word) in [
        ("model sweep --force 0.1 --from 14 --to 3", "between 14 and 3"),
        ("model sweep --force 0.1 --from 0 --to 3", "frequency is 0"),
        ("model sweep --force NaN --from 1 --to 3", "NaN"),
        ("model sweep --from 1 --to 3", "nothing drives"),
        ("model sweep --force 0.1 --from 1 --to 3 --settle 1000000000", "more than"),
        ("model sweep --force 0.1 --from 1 --to 3 --rate 1e-9", "more than"),
        ("model sweep --force 0.1 --from 1 --to 3 --set m1=-1", "m1"),
        ("model map --force 0.1 --x frequency:3:9:4 --y mass:1:2:3", "mass:1:2:3"),
        ("model map --force 0.1 --x frequency:0:9:4 --y gap:0:1e-3:3", "frequency is 0"),
        ("model map --force 0.1 --x frequency:3:9:4 --y restitution:0:2:3", "restitution is 2"),
        ("model map --force 0.1 --x frequency:3:9:4 --y gap:-1:1e-3:3", "gap is -1"),
        ("model map --force 0.1 --x frequency:3:9:4000 --y gap:0:1e-3:4000 --cycles 1000000000", "more than"),
    ] {
        let output = vibro(&words(line));
        let text = String::from_utf8_lossy(&output.stderr);
        assert!(matches!(output.status.code(), Some(1 | 2)), "{line}: {text}");
        assert!(text.contains(word), "{line}: {text}");
    }
}

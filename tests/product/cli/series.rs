//! Files that belong together whatever their names: steps of a sweep, drops of one body.

use super::init::{burst, write};
use super::stepped::write_steps;
use super::{json, text};
use serde_json::Value;
use std::fs;
use std::path::Path;
use vibroimpact::math::Noise;

/// File names of steps as typed at a bench: decimals, blanks, marks of a repetition, extensions in
/// capitals.
const ODD: [(&str, f64); 13] = [
    ("sine_14hz.csv", 14.0),
    ("sine_17.5hz.csv", 17.5),
    ("sine_20hz.csv", 20.0),
    ("sine_22.5hz.csv", 22.5),
    ("sine_25hz_FINAL.csv", 25.0),
    ("sine_27hz.csv", 27.0),
    ("sine_29hz.CSV", 29.0),
    ("sine 31hz.csv", 31.0),
    ("sine_33hz.csv", 33.0),
    ("sine_33hz (repeat).csv", 33.0),
    ("sine_36hz.csv", 36.0),
    ("sine_40hz.csv", 40.0),
    ("last.csv", 45.0),
];

fn named(all: &[(&str, f64)]) -> Vec<(String, f64)> {
    all.iter().map(|(name, f)| ((*name).to_owned(), *f)).collect()
}

fn excitations(answer: &Value) -> Vec<f64> {
    answer["points"].as_array().unwrap().iter().map(|p| p["excitation"].as_f64().unwrap()).collect()
}

/// Checks the excitation frequencies in Hz and their order. A force of 6 s with noise of 0.1 % gives each
/// to 10 µHz.
fn are(found: &[f64], expected: &[f64]) {
    assert_eq!(found.len(), expected.len(), "{found:?}");
    assert!(found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-3), "{found:?}");
}

fn finding<'a>(answer: &'a Value, code: &str) -> Option<&'a Value> {
    answer["findings"].as_array().unwrap().iter().find(|found| found["code"] == code)
}

fn proposed(folder: &Path) -> String {
    json(&["init", text(folder)]);
    fs::read_to_string(folder.join("campaign.toml")).unwrap()
}

#[test]
fn steps_are_told_by_what_is_in_them() {
    let root = tempfile::tempdir().unwrap();
    write_steps(root.path(), &named(&ODD), 6.0);
    // A step that was stopped early has the same columns and sampling rate but is shorter.
    write_steps(root.path(), &named(&[("cut.csv", 26.0)]), 4.0);
    let answer = json(&["response", text(root.path())]);
    are(&excitations(&answer), &ODD.map(|(_, f)| f));
    let again = finding(&answer, "sweep-frequency-repeated").expect("the repetition is named");
    let files = again["numbers"]["files"].as_str().unwrap();
    assert!(files.contains("sine_33hz (repeat).csv") && again["numbers"]["n"] == 1.0, "{again}");
    let more = finding(&answer, "sweep-more-steps").expect("the short step is named");
    assert_eq!((&more["numbers"]["files"], &more["numbers"]["n"]), (&"cut.csv".into(), &1.0.into()));
    // Further steps that the pattern does not match are named.
    let some = json(&["response", text(&root.path().join("sine_*hz.csv"))]);
    are(&excitations(&some), &[14.0, 17.5, 20.0, 22.5, 27.0, 33.0, 36.0, 40.0]);
    assert_eq!(finding(&some, "sweep-more-steps").unwrap()["numbers"]["n"], 6.0);
    let campaign = proposed(root.path());
    assert_eq!(campaign.matches("[[sweep]]").count(), 1, "{campaign}");
    let run = json(&["run", text(root.path())]);
    are(&excitations(&run["results"]["responses"][0]), &ODD.map(|(_, f)| f));
}

/// A series over the same frequencies as another is a separate sweep; so is a series of the other
/// direction.
#[test]
fn sweeps_that_names_tell_apart_stay_apart() {
    let root = tempfile::tempdir().unwrap();
    let series = |name: &str| -> Vec<(String, f64)> {
        (1..=6).map(|k| (format!("{name}{k}.csv"), 15.0 + 4.0 * f64::from(k))).collect()
    };
    for name in ["low_", "high_"] {
        write_steps(root.path(), &series(name), 6.0);
    }
    let campaign = proposed(root.path());
    assert_eq!(campaign.matches("[[sweep]]").count(), 2, "{campaign}");
    assert!(campaign.contains("\"low_*.csv\"") && campaign.contains("\"high_*.csv\""), "{campaign}");
    // Frequencies between those of another series are further steps of one sweep, unless the names state
    // directions.
    let between = |name: &str| series(name).into_iter().map(|(n, f)| (n, f + 2.0)).collect::<Vec<_>>();
    for (names, sweeps) in [(["a_", "b_"], 1), (["up_", "down_"], 2)] {
        let root = tempfile::tempdir().unwrap();
        write_steps(root.path(), &series(names[0]), 6.0);
        write_steps(root.path(), &between(names[1]), 6.0);
        let campaign = proposed(root.path());
        assert_eq!(campaign.matches("[[sweep]]").count(), sweeps, "{campaign}");
    }
}

#[test]
fn steps_whose_names_give_no_order_are_sorted_by_frequency() {
    let root = tempfile::tempdir().unwrap();
    let mixed = [("p1.csv", 30.0), ("p2.csv", 20.0), ("p3.csv", 35.0), ("p4.csv", 25.0), ("p5.csv", 40.0)];
    write_steps(root.path(), &named(&mixed), 6.0);
    let pattern = root.path().join("p*.csv");
    let answer = json(&["response", text(&pattern)]);
    are(&excitations(&answer), &[20.0, 25.0, 30.0, 35.0, 40.0]);
    assert!(finding(&answer, "sweep-sorted").is_some() && finding(&answer, "sweep-out-of-order").is_none());
    // An upward sweep followed by a downward sweep is in order.
    let turned = [("p1.csv", 20.0), ("p2.csv", 30.0), ("p3.csv", 40.0), ("p4.csv", 35.0), ("p5.csv", 25.0)];
    write_steps(root.path(), &named(&turned), 6.0);
    are(&excitations(&json(&["response", text(&pattern)])), &turned.map(|(_, f)| f));
}

/// Drops of one body, one under a name of its own. A recording of the room beside them is no drop.
#[test]
fn drops_are_one_series_whatever_their_names() {
    let root = tempfile::tempdir().unwrap();
    let mut noise = Noise::new(7);
    for (name, rest) in [("drop1", 0.4788), ("drop2", 0.4791), ("drop3", 0.4789), ("again", 0.4790)] {
        write(&root.path().join(format!("{name}.csv")), "sound [V]", 20_000.0, 1.0, &mut |t| {
            burst(t - 0.2) + 0.6 * burst(t - 0.2 - rest) + 0.003 * noise.normal()
        });
    }
    let quiet = root.path().join("room.csv");
    write(&quiet, "sound [V]", 20_000.0, 1.0, &mut |_| 0.003 * noise.normal());
    let notes = "Monday.\nAll drops: height 0.57 m.\nMicrophone: sensitivity 10.3 mV/Pa\n";
    fs::write(root.path().join("notes.txt"), notes).unwrap();
    let campaign = proposed(root.path());
    // What notes state is shown beside the open key or above all tables, but is not used.
    let beside = |line: &str| {
        line.contains("height =") && line.contains("notes.txt, line 2: All drops: height 0.57 m.")
    };
    assert!(campaign.lines().any(beside) && !campaign.contains("height = 0.57"), "{campaign}");
    assert!(campaign.contains("# notes.txt, line 3: Microphone: sensitivity 10.3 mV/Pa\n"), "{campaign}");
    let drops = campaign.split("[[drop]]").skip(1);
    let names: Vec<&str> = drops
        .filter_map(|t| t.lines().find(|line| line.trim_start_matches('#').starts_with("name")))
        .collect();
    assert!(names.len() == 4 && names.iter().all(|line| line.contains("\"drop\"")), "{campaign}");
    assert!(campaign.contains("file = \"again.csv\"") && !campaign.contains("\"drop\"\nfile = \"room.csv\""));
    // When the open keys are filled in, the campaign gives one restitution of four drops.
    let filled = campaign.lines().map(|line| match line.trim_start_matches('#') {
        row if row.starts_with("height =") => "height = 0.57".to_owned(),
        row if row.starts_with("height_std =") => "height_std = 0.001".to_owned(),
        row if line.starts_with("#[[") || line.starts_with("#name") || line.starts_with("#file") => {
            row.to_owned()
        }
        _ => line.to_owned(),
    });
    let filled: Vec<String> = filled.collect();
    fs::write(root.path().join("campaign.toml"), filled.join("\n")).unwrap();
    let run = json(&["run", text(root.path())]);
    let drops = run["results"]["drops"].as_array().unwrap();
    assert_eq!(drops.len(), 1, "{drops:?}");
    assert_eq!(drops[0]["files"].as_array().unwrap().len(), 4, "{drops:?}");
}

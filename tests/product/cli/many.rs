//! A folder of many recordings: what `vibro init` proposes, and how long it takes.

use super::{json, text};
use std::f64::consts::TAU;
use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::{Duration, Instant};
use vibroimpact::math::Noise;

/// Writes a folder `rig` of files with force and velocity, 300 rows each, driven by noise. Their names do
/// not show that they are functions.
fn functions(root: &Path, files: usize) -> PathBuf {
    let (folder, mut noise) = (root.join("rig"), Noise::new(8));
    fs::create_dir(&folder).unwrap();
    for k in 0..files {
        let mut text = "time [s],force [N],velocity [m/s]\n".to_owned();
        let (mut last, mut before) = (0.0, 0.0);
        for i in 0..300 {
            let force = noise.normal();
            // A mode at 100 Hz that loses 5 % of its amplitude a sample.
            let velocity =
                2.0 * 0.95 * (TAU * 100.0 / 1024.0).cos() * last - 0.95 * 0.95 * before + 0.01 * force;
            (before, last) = (last, velocity);
            writeln!(text, "{:.10},{force:.6},{velocity:.7}", f64::from(i) / 1024.0).unwrap();
        }
        fs::write(folder.join(format!("rec_{k:05}.csv")), text).unwrap();
    }
    folder
}

#[test]
fn a_long_series_of_functions_is_one_table_in_bounded_work() {
    let root = tempfile::tempdir().unwrap();
    let folder = functions(root.path(), 250);
    let campaign = folder.join("campaign.toml");
    let mut proposed = Vec::new();
    for cores in ["1", "2"] {
        let begun = Instant::now();
        let mut init = Command::new(env!("CARGO_BIN_EXE_vibro"));
        let output = init.args(["init", text(&folder)]).env("RAYON_NUM_THREADS", cores).output().unwrap();
        assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
        // Eight of the files take about 4 s in a debug build; all of them would take minutes.
        assert!(begun.elapsed() < Duration::from_secs(20), "{:?}", begun.elapsed());
        proposed.push(fs::read_to_string(&campaign).unwrap());
        fs::remove_file(&campaign).unwrap();
    }
    assert_eq!(proposed[0], proposed[1]);
    assert_eq!(proposed[0].matches("[[").count(), 1, "{}", proposed[0]);
    assert!(
        proposed[0].contains("# 250 files, rec_00000.csv to rec_00249.csv: force and response\n[[frf]]\n")
    );
    assert!(proposed[0].contains("file = \"rec_*.csv\"\n"), "{}", proposed[0]);
    fs::write(&campaign, &proposed[0]).unwrap();
    assert_eq!(json(&["check", text(&folder)])["files"].as_array().unwrap().len(), 250);
}

/// Pulses up to the seventh file, sines in the rest: each file gets a table of its kind, in numerical
/// order.
#[test]
fn where_files_of_a_series_are_of_several_kinds_each_gets_its_own() {
    let root = tempfile::tempdir().unwrap();
    let mut noise = Noise::new(2);
    for k in 1..=20 {
        let mut text = "time [s],acceleration [m/s²]\n".to_owned();
        for i in 0..800 {
            let t = f64::from(i) / 200_000.0;
            let part = (t - 0.001) / 0.0009;
            let push = if (0.0..1.0).contains(&part) { (0.5 * TAU * part).sin() } else { 0.0 };
            let value = if k < 8 { 900.0 * push } else { 900.0 * (TAU * 5000.0 * t).sin() };
            writeln!(text, "{t:.6},{:.4}", value + 0.5 * noise.normal()).unwrap();
        }
        fs::write(root.path().join(format!("rec{k}.csv")), text).unwrap();
    }
    json(&["init", text(root.path())]);
    let campaign = fs::read_to_string(root.path().join("campaign.toml")).unwrap();
    let of = |section: &str| -> Vec<String> {
        let tables = campaign.split("[[").filter(|table| table.starts_with(section));
        let files = tables.filter_map(|table| table.lines().find(|line| line.starts_with("file = ")));
        files.map(str::to_owned).collect()
    };
    let files = |range: std::ops::RangeInclusive<usize>| -> Vec<String> {
        range.map(|k| format!("file = \"rec{k}.csv\"")).collect()
    };
    assert_eq!(of("pulse"), files(1..=7), "{campaign}");
    assert_eq!(of("spectrum"), files(8..=20), "{campaign}");
}

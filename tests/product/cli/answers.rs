//! Answers of the commands: the keys that other programs read, and their values.

use super::rig::{amplitude, frequencies, sweep};
use super::{json, text, vibro};
use serde_json::Value;
use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

fn keys(value: &Value, wanted: &[&str]) {
    for key in wanted {
        assert!(value.get(key).is_some(), "no key {key} in {value}");
    }
}

fn estimate(value: &Value) {
    keys(value, &["value", "std", "unit", "n", "method"]);
}

#[test]
fn info_says_what_is_in_a_file() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("trace.txt");
    fs::write(&path, "rate: 100 Hz\nunit: mm/s\n1\n-5\n2\n").unwrap();
    let value = json(&["info", text(&path)]);
    let record = &value["files"][0]["records"][0];
    keys(&value["files"][0], &["path", "format", "records"]);
    keys(
        record,
        &["name", "kind", "quantity", "unit", "n", "declared_n", "x0", "dx", "complex", "max_abs", "max_at"],
    );
    assert_eq!(record["kind"], "trace");
    assert_eq!(record["quantity"], "velocity");
    assert_eq!((record["n"].as_u64(), record["max_abs"].as_f64()), (Some(3), Some(5e-3)));
    assert_eq!((record["dx"].as_f64(), record["max_at"].as_f64()), (Some(0.01), Some(0.01)));
}

#[test]
fn info_says_what_was_passed_over_and_how_text_was_read() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("trace.txt");
    let written = "SPS390 TRACE\nOperator: X\n0,25\t1\n-0,5\t3\n0,1\t2\n";
    let utf16: Vec<u8> =
        [0xff, 0xfe].into_iter().chain(written.encode_utf16().flat_map(u16::to_le_bytes)).collect();
    fs::write(&path, utf16).unwrap();
    let value = json(&["info", text(&path)]);
    let notes = &value["files"][0]["records"][0]["notes"];
    assert_eq!(
        *notes,
        serde_json::json!(["SPS390 TRACE", "Operator: X", "encoding: UTF-16", "decimal mark: comma"])
    );
    // A note that holds for both channels appears once.
    let units = value["warnings"].as_array().unwrap().iter().filter(|w| w.to_string().contains("No unit"));
    assert_eq!(units.count(), 1, "{}", value["warnings"]);
    let output = vibro(&["info", text(&path)]);
    let table = String::from_utf8(output.stdout).unwrap();
    assert!(
        table.contains("notes: SPS390 TRACE | Operator: X | encoding: UTF-16 | decimal mark: comma"),
        "{table}"
    );
    assert!(table.contains("trace, unit not known") && !table.contains("[]"), "{table}");
    // A value of 0.30000000000000004 is shown with six digits.
    fs::write(&path, "unit: mm\nrate: 3 Hz\n0.30000000000000004\n0.1\n").unwrap();
    let table = String::from_utf8(vibro(&["info", text(&path)]).stdout).unwrap();
    assert!(table.contains("3 Hz, 0.666667 s, 0.0001 to 0.0003 m, largest at 0 s"), "{table}");
}

#[test]
fn excitation_response_and_waterfall_of_a_list() {
    let folder = tempfile::tempdir().unwrap();
    let list = sweep(folder.path(), &frequencies());
    let list = text(&list);
    let value = json(&["excitation", list]);
    for (point, f) in value["points"].as_array().unwrap().iter().zip(frequencies()) {
        keys(point, &["file", "frequency"]);
        // The background of 1e-12 is small beside a line of 0.1.
        assert!((point["frequency"].as_f64().unwrap() - f).abs() < 1e-9);
    }
    let value = json(&["response", list, "--unit", "m/s", "--integrate", "1", "--band", "3"]);
    keys(&value, &["points", "resonances", "jumps"]);
    for (point, f) in value["points"].as_array().unwrap().iter().zip(frequencies()) {
        keys(point, &["excitation", "frequency", "harmonics", "subharmonics", "largest_elsewhere"]);
        estimate(&point["amplitude"]);
        let found = point["amplitude"]["value"].as_f64().unwrap();
        assert!((found / amplitude(f) - 1.0).abs() < 1e-8, "{found} at {f}");
        assert_eq!(point["largest_elsewhere"], false);
    }
    let resonance = &value["resonances"][0];
    keys(resonance, &["frequency", "amplitude", "kind"]);
    assert!((resonance["frequency"].as_f64().unwrap() - 5.6).abs() < 0.05, "{resonance}");
    let value = json(&["waterfall", list, "--unit", "m/s"]);
    let rows = value["magnitude"].as_array().unwrap();
    assert_eq!(rows.len(), value["excitation"].as_array().unwrap().len());
    assert_eq!(rows[0].as_array().unwrap().len(), value["frequency"].as_array().unwrap().len());
    assert!(rows[0][0].is_null(), "the DC line has no displacement");
}

#[test]
fn hand_over_files_are_written_and_read() {
    let folder = tempfile::tempdir().unwrap();
    let list = sweep(folder.path(), &frequencies());
    let (force, response) = (folder.path().join("FORCE.TXT"), folder.path().join("RESP.TXT"));
    json(&["excitation", text(&list), "--legacy", "--write-lists", text(&force), text(&response)]);
    let value = json(&["response", text(&response), "--unit", "m/s"]);
    assert_eq!(value["points"].as_array().unwrap().len(), frequencies().len());
    assert!(fs::read_to_string(force).unwrap().contains("FUP0001.DATFUP0002.DAT"));
}

#[test]
fn legacy_reads_on_the_line() {
    let folder = tempfile::tempdir().unwrap();
    let list = sweep(folder.path(), &frequencies());
    let value = json(&["response", text(&list), "--legacy", "--unit", "m/s"]);
    // 4.03 Hz lies between lines, which are 0.1 Hz apart; the answer is the nearest line.
    assert_eq!(value["points"][0]["excitation"].as_f64(), Some(4.0));
    let value = json(&["waterfall", text(&list), "--legacy"]);
    assert!(value["magnitude"][0][0].is_number());
}

#[test]
fn pictures_and_tables_are_written_where_asked() {
    let folder = tempfile::tempdir().unwrap();
    let list = sweep(folder.path(), &frequencies());
    let out = folder.path().join("out");
    let value = json(&["response", text(&list), "--unit", "m/s", "--out", text(&out)]);
    for file in value["files"].as_array().unwrap() {
        assert!(out.join(file.as_str().unwrap()).is_file(), "{file}");
    }
    assert!(out.join("force.svg").is_file());
    json(&["waterfall", text(&list), "--unit", "m/s", "--out", text(&out)]);
    for name in ["response.svg", "response.png", "response.csv", "waterfall.svg", "map.png", "waterfall.csv"]
    {
        assert!(out.join(name).is_file(), "{name}");
    }
}

#[test]
fn convert_keeps_the_values() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("trace.txt");
    fs::write(&path, "rate: 100 Hz\nunit: m/s\n0.25\n-0.5\n0.125\n").unwrap();
    for (name, options) in [
        ("a.uff", &[][..]),
        ("b.uff", &["--binary"]),
        ("c.csv", &[]),
        ("d.wav", &[]),
        ("e.unv", &["--single"]),
    ] {
        let out = folder.path().join(name);
        let mut arguments = vec!["convert", text(&path), text(&out)];
        arguments.extend(options);
        let value = json(&arguments);
        assert!(value["written"].as_str().unwrap().ends_with(name));
        let back = json(&["info", text(&out)]);
        let record = &back["files"][0]["records"][0];
        // All three values are exact in single precision.
        assert_eq!(
            (record["n"].as_u64(), record["max_abs"].as_f64()),
            (Some(3), Some(0.5)),
            "{name}: {record}"
        );
        assert!((record["dx"].as_f64().unwrap() - 0.01).abs() < 1e-12, "{name}: {record}");
    }
    let out = folder.path().join("f.npy");
    let replaced = |value: &Value| value["warnings"].to_string().contains("f.npy existed and was replaced.");
    assert!(!replaced(&json(&["convert", text(&path), text(&out)])));
    assert!(replaced(&json(&["convert", text(&path), text(&out)])));
}

fn contents(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let entries = fs::read_dir(folder).unwrap().map(|e| e.unwrap().path());
    entries
        .filter(|p| {
            p.is_file() && !p.file_name().is_some_and(|name| name.as_encoded_bytes().starts_with(b".vibro."))
        })
        .map(|p| (p.file_name().unwrap().to_string_lossy().into_owned(), fs::read(&p).unwrap()))
        .collect()
}

#[test]
fn run_and_compare_do_the_example_campaign() {
    let example = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/two_mass_rig");
    let before = contents(&example);
    let folder = tempfile::tempdir().unwrap();
    let campaign = example.join("campaign.toml");
    let out = folder.path().join("out");
    let value = json(&["run", text(&campaign), "--out", text(&out)]);
    keys(&value, &["results", "files"]);
    let first = contents(&out);
    assert_eq!(
        first.len(),
        value["files"].as_array().unwrap().len(),
        "nothing beside the files that are named, but what is kept for the next run"
    );
    assert!(first.contains_key("report.html") && first.contains_key("results.json"));
    // A second run writes the same bytes, and the inputs are unchanged.
    json(&["run", text(&campaign), "--out", text(&out)]);
    assert!(first == contents(&out));
    assert!(before == contents(&example));

    // As in the thesis: grazing near 5.6 Hz in both directions, clapping near 10.6 Hz only on the way up.
    let found = |name: &str, kind: &str| -> Option<f64> {
        let responses = value["results"]["responses"].as_array().unwrap();
        let response = responses.iter().find(|r| r["name"] == name).unwrap();
        let resonances = response["resonances"].as_array().unwrap();
        resonances.iter().find(|r| r["kind"] == kind)?["frequency"].as_f64()
    };
    for name in ["mass 1, up", "mass 2, up", "mass 1, down", "mass 2, down"] {
        let grazing = found(name, "grazing").unwrap();
        assert!((grazing - 5.6).abs() < 0.15, "{name}: {grazing}");
        let clapping = found(name, "clapping");
        if name.ends_with("up") {
            assert!((clapping.unwrap() - 10.6).abs() < 0.1, "{name}: {clapping:?}");
        } else {
            assert_eq!(clapping, None, "{name}");
        }
    }
    // Above the crossing at the antiresonance of the excited mass, the passive mass has the larger
    // amplitude.
    let crossings = value["results"]["crossings"].as_array().unwrap();
    assert!(crossings.iter().any(|c| c["direction"] == "up" && c["larger_above"] == 2), "{crossings:?}");

    let value = json(&["compare", text(&campaign)]);
    keys(&value, &["pairs", "scores", "fit"]);
    for pair in value["pairs"].as_array().unwrap() {
        keys(pair, &["measured", "predicted", "residual"]);
        estimate(&pair["measured"]);
    }
    for score in value["scores"].as_array().unwrap() {
        let median = score["median_relative"].as_f64().unwrap();
        assert!(median < 0.002, "most points lie on the branch they follow: {score}");
    }
}

#[test]
fn what_the_rig_of_a_campaign_leaves_out_is_said_first() {
    let example = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/two_mass_rig");
    let whole = fs::read_to_string(example.join("campaign.toml")).unwrap();
    let left: Vec<&str> = whole.lines().filter(|l| !l.starts_with("k2 ")).collect();
    assert_eq!(left.len() + 1, whole.lines().count());
    let folder = tempfile::tempdir().unwrap();
    let (campaign, out) = (folder.path().join("campaign.toml"), folder.path().join("out"));
    let lists = format!("list = '{}{}", text(&example), std::path::MAIN_SEPARATOR);
    fs::write(&campaign, left.join("\n").replace("list = \"", &lists).replace(".TXT\"", ".TXT'")).unwrap();
    let compared = json(&["compare", text(&campaign), "--allow-outside"]);
    let run = json(&["run", text(&campaign), "--allow-outside", "--out", text(&out)]);
    for warnings in [&compared["warnings"], &run["results"]["warnings"]] {
        assert!(warnings[0].as_str().unwrap().contains("[rig] does not give k2"), "{warnings}");
    }
}

/// The example's truth in one direction, point by point: frequency in Hz, and `x1` or `x2` in m.
fn truth(direction: &str, mass: usize) -> Vec<(f64, f64)> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/two_mass_rig/TRUTH.csv");
    let text = fs::read_to_string(path).unwrap();
    text.lines()
        .skip(1)
        .map(|l| l.split(',').collect::<Vec<_>>())
        .filter(|c| c[0] == direction)
        .map(|c| (c[2].parse().unwrap(), c[2 + mass].parse().unwrap()))
        .collect()
}

#[test]
fn the_example_is_measured_as_it_was() {
    let campaign = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/two_mass_rig/campaign.toml");
    for direction in ["up", "down"] {
        for mass in [1, 2] {
            let value = json(&["response", &format!("{}#mass {mass}, {direction}", text(&campaign))]);
            let points = value["points"].as_array().unwrap();
            let truth = truth(direction, mass);
            assert_eq!(points.len(), truth.len());
            for (point, (frequency, amplitude)) in points.iter().zip(truth) {
                // A hundredth of the line spacing of 0.05 Hz.
                assert!((point["excitation"].as_f64().unwrap() - frequency).abs() < 5e-4);
                let (value, std) = (
                    point["amplitude"]["value"].as_f64().unwrap(),
                    point["amplitude"]["std"].as_f64().unwrap(),
                );
                // Four standard deviations of the noise, plus 0.2 % for side lines of irregular motion.
                // Where the mass rests, the magnitude of the noise alone lies within four of its standard
                // deviations above zero.
                let allowed = 4.0 * std + 0.002 * amplitude;
                assert!(
                    (value - amplitude).abs() < allowed,
                    "{direction} {mass}: {value} for {amplitude} ± {std}"
                );
            }
        }
    }
}

#[test]
fn a_closed_pipe_is_no_failure() {
    use std::process::{Command, Stdio};
    let campaign = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/two_mass_rig/campaign.toml");
    let mut child = Command::new(env!("CARGO_BIN_EXE_vibro"))
        .args(["compare", text(&campaign), "--json"])
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    drop(child.stdout.take());
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
}

#[test]
fn help_and_version_go_to_standard_output() {
    for arguments in [&["--help"][..], &["--version"], &["response", "--help"]] {
        let output = vibro(arguments);
        assert_eq!(output.status.code(), Some(0));
        assert!(!output.stdout.is_empty() && output.stderr.is_empty());
    }
}

#[test]
fn the_help_names_every_parameter_of_a_rig() {
    use vibroimpact::model::Parameter;
    let names_all = |command: &[&str], of: &dyn Fn(Parameter) -> bool| {
        let help = String::from_utf8(vibro(command).stdout).unwrap();
        let words: Vec<&str> = help.split(|c: char| !c.is_alphanumeric()).collect();
        for name in Parameter::all().filter(|p| of(*p)).map(Parameter::name) {
            assert!(words.contains(&name), "{command:?} says nothing of {name}");
        }
    };
    names_all(&["model", "orbit", "--help"], &|p| Parameter::is_of_rig(p.name()));
    names_all(&["model", "map", "--help"], &|_| true);
    names_all(&["compare", "--help"], &|p| p.can_be_fitted());
}

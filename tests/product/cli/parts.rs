//! Files of a zip archive and sheets of a workbook as records of a campaign.

use super::{complaint, json, text, vibro};
use rust_xlsxwriter::Workbook;
use serde_json::Value;
use std::f64::consts::TAU;
use std::fs;
use std::io::{Cursor, Write};
use std::path::Path;
use vibroimpact::math::Noise;
use zip::write::SimpleFileOptions;

const RATE: f64 = 1000.0;
const SECONDS: f64 = 4.0;

/// A sine of this frequency in Hz: time in s, acceleration in m/s².
fn tone(frequency: f64) -> Vec<[f64; 2]> {
    let mut noise = Noise::new(7);
    let at = |i| f64::from(i) / RATE;
    (0..(RATE * SECONDS) as u32)
        .map(|i| [at(i), (TAU * frequency * at(i)).sin() + 0.01 * noise.normal()])
        .collect()
}

const HEAD: [&str; 2] = ["time [s]", "acceleration [m/s²]"];

fn archive(path: &Path, files: &[(&str, f64)]) {
    let mut writer = zip::ZipWriter::new(Cursor::new(Vec::new()));
    for (name, frequency) in files {
        writer.start_file(*name, SimpleFileOptions::default()).unwrap();
        writeln!(writer, "{}", HEAD.join(",")).unwrap();
        for [t, value] in tone(*frequency) {
            writeln!(writer, "{t},{value}").unwrap();
        }
    }
    fs::write(path, writer.finish().unwrap().into_inner()).unwrap();
}

fn workbook(path: &Path, sheets: &[(&str, f64)]) {
    let mut book = Workbook::new();
    for (name, frequency) in sheets {
        let sheet = book.add_worksheet();
        sheet.set_name(*name).unwrap();
        sheet.write_row(0, 0, HEAD).unwrap();
        sheet.write_row_matrix(1, 0, tone(*frequency)).unwrap();
    }
    book.save(path).unwrap();
}

/// Writes an archive and a workbook of two records each. Returns path and frequency in Hz of each record.
fn folder(root: &Path) -> [(&'static str, f64); 4] {
    archive(&root.join("walk.zip"), &[("first.csv", 23.0), ("sub/second.csv", 41.0)]);
    workbook(&root.join("book.xlsx"), &[("Left hand", 57.0), ("Right hand", 89.0)]);
    [
        ("walk.zip/first.csv", 23.0),
        ("walk.zip/sub/second.csv", 41.0),
        ("book.xlsx/Left hand", 57.0),
        ("book.xlsx/Right hand", 89.0),
    ]
}

/// The strongest tone of each spectrum lies within 1/T, one line, of the true frequency.
fn holds_tones(spectra: &Value, expected: &[f64]) {
    let found: Vec<f64> = spectra
        .as_array()
        .unwrap()
        .iter()
        .map(|s| s["tones"][0]["frequency"]["value"].as_f64().unwrap())
        .collect();
    assert_eq!(found.len(), expected.len(), "{found:?}");
    for (found, expected) in found.iter().zip(expected) {
        assert!((found - expected).abs() < 1.0 / SECONDS, "{found} {expected}");
    }
}

#[test]
fn a_campaign_measures_parts_of_archives_and_workbooks() {
    let root = tempfile::tempdir().unwrap();
    let parts = folder(root.path());
    let table = |(part, _): &(&str, f64)| format!("[[spectrum]]\nfile = \"{part}\"\ntones = 1\n");
    let path = root.path().join("campaign.toml");
    fs::write(&path, parts.iter().map(table).collect::<String>()).unwrap();
    json(&["check", text(&path)]);
    let answer = json(&["run", text(&path)]);
    holds_tones(&answer["results"]["spectra"], &parts.map(|(_, frequency)| frequency));
    // The list of inputs names the archive and the workbook, whose checksums can be checked.
    let inputs = fs::read_to_string(root.path().join("results/inputs.sha256")).unwrap();
    for file in ["  walk.zip\n", "  book.xlsx\n"] {
        assert_eq!(inputs.matches(file).count(), 1, "{inputs}");
    }
    // Changed content is analysed again.
    archive(&root.path().join("walk.zip"), &[("first.csv", 31.0), ("sub/second.csv", 41.0)]);
    let again = json(&["run", text(&path)]);
    holds_tones(&again["results"]["spectra"], &[31.0, 41.0, 57.0, 89.0]);
}

/// A folder of results whose name ends like a file name is refused with a name that works, and is not
/// created.
#[test]
fn results_go_to_no_folder_named_like_a_file() {
    let root = tempfile::tempdir().unwrap();
    folder(root.path());
    let part = root.path().join("book.xlsx/Left hand");
    for name in ["new.xlsx", "new.csv", "new.PNG"] {
        let out = root.path().join(name);
        let said = complaint(&["spectrum", text(&part), "--out", text(&out)], 2);
        let plain = root.path().join("new");
        assert!(said.contains(&format!("--out {}", text(&plain))) && !out.exists(), "{said}");
    }
    let plain = root.path().join("new");
    assert!(vibro(&["spectrum", text(&part), "--out", text(&plain)]).status.success() && plain.is_dir());
    // An existing folder may have any name.
    fs::rename(&plain, root.path().join("old.v2.csv")).unwrap();
    let out = root.path().join("old.v2.csv");
    assert!(vibro(&["spectrum", text(&part), "--out", text(&out)]).status.success());
}

#[test]
fn a_part_that_is_not_there_is_said_with_those_that_are() {
    let root = tempfile::tempdir().unwrap();
    folder(root.path());
    let path = root.path().join("campaign.toml");
    for (name, expected) in [
        ("walk.zip/third.csv", "one of first.csv, sub/second.csv"),
        ("book.xlsx/Left", "one of Left hand, Right hand"),
        ("gone.zip/first.csv", "gone.zip/first.csv does not exist"),
    ] {
        fs::write(&path, format!("[[spectrum]]\nfile = \"{name}\"\n")).unwrap();
        for command in ["check", "run"] {
            let said = complaint(&[command, text(&path)], 2);
            assert!(said.contains(expected), "{command} {name}: {said}");
        }
    }
}

#[test]
fn init_writes_a_table_of_each_part_and_the_campaign_runs() {
    let root = tempfile::tempdir().unwrap();
    let parts = folder(root.path());
    // Records of the same name in two archives.
    archive(&root.path().join("later.zip"), &[("first.csv", 103.0), ("second.csv", 127.0)]);
    json(&["init", text(root.path())]);
    let path = root.path().join("campaign.toml");
    let written = fs::read_to_string(&path).unwrap();
    for part in parts.iter().map(|(part, _)| *part).chain(["later.zip/first.csv", "later.zip/second.csv"]) {
        assert_eq!(written.matches(&format!("file = \"{part}\"")).count(), 1, "{written}");
    }
    let mut names: Vec<&str> = written.lines().filter_map(|l| l.strip_prefix("name = ")).skip(1).collect();
    let n = names.len();
    names.sort_unstable();
    names.dedup();
    assert_eq!((n, names.len()), (6, 6), "{written}");
    json(&["check", text(&path)]);
    let answer = json(&["run", text(&path)]);
    assert_eq!(answer["results"]["spectra"].as_array().unwrap().len(), 6);
    // The campaign names all parts, so none is reported as not named.
    let said = String::from_utf8(vibro(&["run", text(&path)]).stderr).unwrap();
    assert!(!said.contains("walk.zip"), "{said}");
}

#[test]
fn an_archive_of_which_a_part_is_read_is_never_replaced() {
    let root = tempfile::tempdir().unwrap();
    folder(root.path());
    let (archive, to) = (root.path().join("walk.zip"), root.path().join("walk.csv"));
    fs::rename(&archive, &to).unwrap();
    let before = fs::read(&to).unwrap();
    let said = complaint(&["convert", text(&to.join("first.csv")), text(&to), "--replace"], 2);
    assert!(said.contains("same file"), "{said}");
    assert_eq!(fs::read(&to).unwrap(), before);
}

#[test]
fn a_reference_may_be_a_part() {
    let root = tempfile::tempdir().unwrap();
    folder(root.path());
    let (file, reference) =
        (root.path().join("walk.zip/sub/second.csv"), root.path().join("walk.zip/first.csv"));
    let reference = format!("{}#1", text(&reference));
    let said = vibro(&["modal", text(&file), "--reference", &reference]);
    // Both files were read: the error is about the reference, which is one sine.
    assert!(String::from_utf8_lossy(&said.stderr).contains("sine"), "{said:?}");
}

#[test]
fn info_says_of_what_it_is_a_part() {
    let root = tempfile::tempdir().unwrap();
    for (part, _) in folder(root.path()) {
        let said = vibro(&["info", text(&root.path().join(part))]).stdout;
        let said = String::from_utf8(said).unwrap();
        let file = part.split('/').next().unwrap();
        let format =
            if Path::new(file).extension().is_some_and(|e| e == "xlsx") { "workbook" } else { "csv" };
        assert!(said.contains(&format!("{part} ({format} in {file})")), "{said}");
    }
}

//! No number has an uncertainty beside a doubt about it: records that provoke each doubt, analysed by the
//! command line, and recordings of others.

mod concern;
mod provoked;

use crate::others_files;
use concern::{CONCERNS, Concern, uncertainties};
use provoked::{Case, cases, fits};
use rayon::prelude::*;
use serde_json::Value;
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::process::Command;
use vibroimpact::record::code::{READER_DOUBTS, UNIT_DOUBTS};

/// Doubts that no case here provokes, each with the reason.
const NOT_PROVOKED: [(&str, &str); 21] = [
    ("no-closing-line", "a damaged binary file: read/uff_damage.rs; all doubts of readers are one function"),
    ("step-changed", "as no-closing-line: vibro-io/src/tdms/tests.rs"),
    ("sheet-in-percent", "as no-closing-line: vibro-io/src/packed/tests.rs"),
    ("decibels-overruled", "as no-closing-line, of a sweep: read/sweep_units.rs"),
    (
        "pulse-low-pass-missing",
        "another contact explains a smooth onset: pulse/tests.rs has one that none does",
    ),
    ("pulse-onset-unlike", "as pulse-low-pass-missing, behind a stated low-pass"),
    ("drill-velocity-impossible", "needs parabolas that leave the record: drill/groups/tests.rs"),
    ("drill-ringing", "needs jumps alike in velocity and phase: drill/groups/tests.rs"),
    ("drill-left-out", "of a model alone nothing has an uncertainty; of a fit all keys lose theirs at once"),
    ("drill-key-in-combination", "needs records that a model drew: compare/drill/tests.rs"),
    ("drill-key-open", "as drill-key-in-combination"),
    ("too-few-residuals", FIT),
    ("motions-not-settled", FIT),
    ("least-squares-not-reached", FIT),
    ("least-squares-elsewhere", FIT),
    ("bound-contradicted", FIT),
    ("contact-too-long", FIT),
    ("parameter-needs-impacts", FIT),
    ("parameter-at-limit", FIT),
    ("parameter-in-combination", FIT),
    ("parameter-too-uncertain", FIT),
];
/// Reason why few doubts about fits are provoked.
const FIT: &str =
    "a fit takes seconds; all its doubts are applied at one place, which compare/fit/tests holds";

/// The JSON answer of `vibro`, whatever its exit code; null where there is none.
fn answer<S: AsRef<std::ffi::OsStr>>(arguments: &[S]) -> Value {
    let output = Command::new(env!("CARGO_BIN_EXE_vibro")).args(arguments).arg("--json").output().unwrap();
    assert!(!String::from_utf8_lossy(&output.stderr).contains("panicked"), "{output:?}");
    serde_json::from_slice(&output.stdout).unwrap_or(Value::Null)
}

/// The doubts of an answer and of the answers inside it, by their codes, and the uncertainties beside them.
#[derive(Default)]
struct Doubts {
    codes: BTreeSet<String>,
    left: Vec<String>,
}

impl Doubts {
    fn of(answer: &Value) -> Doubts {
        let mut all = Doubts::default();
        all.add(answer);
        all
    }

    fn add(&mut self, answer: &Value) {
        let inner = answer.as_object().into_iter().flatten().filter(|(key, _)| *key != "findings");
        let items = answer.as_array().into_iter().flatten();
        inner.map(|(_, value)| value).chain(items).for_each(|value| self.add(value));
        let findings = answer["findings"].as_array().into_iter().flatten();
        for found in findings.filter(|found| found["severity"] == "doubt") {
            let code = found["code"].as_str().unwrap();
            let (_, concern) = CONCERNS.iter().find(|(known, _)| *known == code).expect(code);
            for (path, number) in concern.numbers(answer, found) {
                let stated = uncertainties(number).into_iter();
                self.left.extend(stated.map(|std| format!("{code} leaves {path}{std}")));
            }
            self.codes.insert(code.to_owned());
        }
    }
}

fn provoke(cases: &[Case]) {
    let wrong = |case: &Case| {
        let found = answer(&case.arguments);
        let Doubts { codes, left } = Doubts::of(&found);
        let absent = case.codes.iter().filter(|code| !codes.contains(**code));
        let absent = absent.map(|code| format!("no {code} in {codes:?}, {}", found["warnings"]));
        absent.chain(left).map(|wrong| format!("{}: {wrong}\n", case.name)).collect::<Vec<String>>()
    };
    let wrong: Vec<String> = cases.par_iter().flat_map(wrong).collect();
    assert!(wrong.is_empty(), "{}", wrong.concat());
}

#[test]
fn no_number_has_an_uncertainty_beside_a_doubt_about_it() {
    let folder = tempfile::tempdir().unwrap();
    provoke(&cases(folder.path()));
}

#[test]
fn a_doubt_about_the_unit_leaves_what_does_not_depend_on_it() {
    let folder = tempfile::tempdir().unwrap();
    let cases = cases(folder.path());
    let of_units = cases.iter().filter(|case| case.codes.iter().any(|code| UNIT_DOUBTS.contains(code)));
    let found: Vec<Value> = of_units.map(|case| answer(&case.arguments)["modes"][0].take()).collect();
    assert_eq!(found.len(), 2);
    for mode in found {
        let known = ["frequency", "zeta", "phase", "amplitude"].map(|key| mode[key]["std"].is_number());
        assert_eq!(known, [true, true, true, false], "{mode}");
    }
}

#[test]
#[ignore = "fits of a whole rig: cargo test --release -- --ignored"]
fn no_parameter_has_an_uncertainty_beside_a_doubt_about_the_fit() {
    let folder = tempfile::tempdir().unwrap();
    provoke(&fits(folder.path()));
}

#[test]
fn every_doubt_has_its_numbers_and_a_case_or_a_reason() {
    let sentences = include_str!("../../docs/findings.md").lines();
    let code = |line: &str| Some(line.strip_prefix("| `")?.split_once("` | doubt |")?.0.to_owned());
    let doubts: BTreeSet<String> = sentences.filter_map(code).collect();
    let known: BTreeSet<String> = CONCERNS.iter().map(|(code, _)| (*code).to_owned()).collect();
    assert_eq!(doubts, known);
    // Those of the readers stand in one section of the document.
    let document = include_str!("../../docs/findings.md");
    let of_readers =
        document.split("\n## ").find(|text| text.starts_with("Reading and writing files")).unwrap();
    let of_readers: BTreeSet<String> = of_readers.lines().filter_map(code).collect();
    assert_eq!(of_readers, READER_DOUBTS.into_iter().map(str::to_owned).collect());
    let folder = tempfile::tempdir().unwrap();
    let all = cases(folder.path()).into_iter().chain(fits(folder.path()));
    let provoked: BTreeSet<&str> = all.flat_map(|case| case.codes.iter().copied()).collect();
    let known = |(code, concern): &&(&str, Concern)| {
        let reason = NOT_PROVOKED.iter().any(|(known, _)| known == code);
        matches!(concern, Concern::Nothing(_)) || provoked.contains(code) != reason
    };
    let wrong: Vec<&str> = CONCERNS.iter().filter(|row| !known(row)).map(|(code, _)| *code).collect();
    assert!(wrong.is_empty(), "without a case and a reason for none, or with both: {wrong:?}");
}

/// The recordings of others: files, and of a folder its first file, since the others are like it.
fn recordings(unpacked: &Path, data: &Path) -> Vec<PathBuf> {
    let sorted = |folder: &Path| {
        let mut files = crate::layers::files(folder);
        files.sort();
        files
    };
    let first = |entry: std::fs::DirEntry| {
        let path = entry.path();
        if path.is_dir() { sorted(&path).into_iter().next() } else { Some(path) }
    };
    let found = std::fs::read_dir(unpacked).unwrap().filter_map(|entry| first(entry.unwrap()));
    found.chain(sorted(data)).collect()
}

/// Every command that takes one file alone reads every recording of others.
#[test]
fn no_number_of_a_recording_of_others_has_an_uncertainty_beside_a_doubt_about_it() {
    let (Some(found), Some(data)) = (others_files::folder("../found"), others_files::folder(".")) else {
        return;
    };
    let folder = tempfile::tempdir().unwrap();
    let unpack = "for f in \"$1\"/*.gz; do case $f in *.tar.gz) tar xzf \"$f\" -C \"$2\";; \
                  *) gunzip -c \"$f\" > \"$2/$(basename \"$f\" .gz)\";; esac; done";
    let status = Command::new("sh").args(["-c", unpack, "sh"]).arg(found).arg(folder.path()).status();
    assert!(status.unwrap().success());
    let clipped = folder.path().join("sweep_clip_21/step*.csv");
    let all: Vec<PathBuf> = recordings(folder.path(), &data).into_iter().chain([clipped]).collect();
    let wrong = |file: &PathBuf| {
        let commands = ["decay", "modal", "impacts", "pulse", "restitution", "spectrum", "response"];
        let left = |command| Doubts::of(&answer(&[command, file.to_str().unwrap()])).left;
        let left = commands.into_iter().flat_map(left);
        left.map(|left| format!("{}: {left}\n", file.display())).collect::<Vec<String>>()
    };
    let wrong: Vec<String> = all.par_iter().flat_map(wrong).collect();
    assert!(wrong.is_empty(), "{}", wrong.concat());
}

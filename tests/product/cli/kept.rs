//! Which answers a second run computes, and which it keeps.

use super::{json, text, vibro};
use std::collections::BTreeMap;
use std::f64::consts::TAU;
use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};

/// Copies the recordings of two examples and writes a sweep. Returns a campaign with every kind of record
/// but drills.
pub fn records(folder: &Path) -> String {
    let examples = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples");
    let mut campaign = String::from("name = \"all\"\n");
    for example in ["bench", "drop_test"] {
        for entry in fs::read_dir(examples.join(example)).unwrap() {
            let path = entry.unwrap().path();
            if path.is_file() {
                fs::copy(&path, folder.join(path.file_name().unwrap())).unwrap();
            }
        }
        let text = fs::read_to_string(examples.join(example).join("campaign.toml")).unwrap();
        campaign.extend(
            text.lines()
                .filter(|line| *line != "name = \"Bench\"" && *line != "name = \"Drop test\"")
                .flat_map(|line| [line, "\n"]),
        );
    }
    for step in 0..6_i32 {
        let f = 20.0 + 3.0 * f64::from(step);
        let mut table = "time [s],F [N],v [m/s]\n".to_owned();
        for i in 0..1200 {
            let t = f64::from(i) / 600.0;
            let (sin, cos) = (TAU * f * t).sin_cos();
            writeln!(table, "{t:.6},{:.6},{:.6}", 3.0 * cos, sin / (1.0 + f64::from((step - 3).pow(2))))
                .unwrap();
        }
        fs::write(folder.join(format!("step{step}.csv")), table).unwrap();
    }
    campaign
        + "[[sweep]]\nname = \"s\"\ntraces = \"step*.csv\"\nforce = \"F\"\nresponse = \"v\"\n[[frf]]\nname = \"modes of s\"\nsweep = \"s\"\n"
}

pub fn contents(folder: &Path) -> BTreeMap<PathBuf, Vec<u8>> {
    let files = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    files
        .map(|path| (path.file_name().unwrap().into(), fs::read(&path).unwrap()))
        .filter(|(name, _): &(PathBuf, _)| !name.to_str().is_some_and(|name| name.starts_with(".vibro.")))
        .collect()
}

#[test]
fn a_second_run_computes_what_changed_and_gives_what_a_first_would() {
    let root = tempfile::tempdir().unwrap();
    let (out, anew) = (root.path().join("results"), root.path().join("anew"));
    let path = root.path().join("campaign.toml");
    let campaign = records(root.path());
    // Number of kept answers; the results must equal those of a run that keeps none.
    let kept = |campaign: &str| {
        fs::write(&path, campaign).unwrap();
        let output = vibro(&["run", text(&path)]);
        assert_eq!(output.status.code(), Some(0));
        json(&["run", text(&path), "--again", "--out", text(&anew)]);
        assert!(contents(&out) == contents(&anew));
        let said = String::from_utf8(output.stderr).unwrap();
        let line = said.lines().find(|line| line.contains("of the last run kept"));
        line.map_or(0, |line| line.split_whitespace().find_map(|word| word.parse::<usize>().ok()).unwrap())
    };
    assert_eq!(kept(&campaign), 0);
    let all = kept(&campaign);
    // Sweep, modes, spectrum, function, decay, three pulses, impacts, three series of drops.
    assert_eq!(all, 12);
    // A changed key costs the answer of its table; a table that only moves within the file costs none.
    let segment = campaign.replacen("segment = 1024", "segment = 2048", 1);
    assert_eq!(kept(&segment), all - 1);
    assert_eq!(kept(&format!("# remarks\n\n{segment}")), all);
    // A key of `[compute]` affects sweeps, tables that name a sweep, and series of drops.
    assert_eq!(kept(&format!("{segment}\n[compute]\nfmax = 30\n")), all - 5);
    assert_eq!(kept(&campaign), all - 6);
    // A changed recording.
    let pulse = fs::read_to_string(root.path().join("PULSE.CSV")).unwrap();
    fs::write(root.path().join("PULSE.CSV"), pulse.trim_end().rsplit_once('\n').unwrap().0).unwrap();
    assert_eq!(kept(&campaign), all - 1);
    // A changed step of the sweep affects its response and its modes.
    let step = fs::read_to_string(root.path().join("step2.csv")).unwrap();
    fs::write(root.path().join("step2.csv"), step.replace(",3.0", ",3.1")).unwrap();
    assert_eq!(kept(&campaign), all - 2);
    // A renamed step: file names are part of the history of the results.
    fs::rename(root.path().join("step5.csv"), root.path().join("step6.csv")).unwrap();
    assert_eq!(kept(&campaign), all - 2);
    // Damaged kept answers are not used, whether damaged in part or as a whole.
    let file = out.join(".vibro.kept");
    let bytes = fs::read(&file).unwrap();
    fs::write(&file, &bytes[..bytes.len() / 2]).unwrap();
    assert_eq!(kept(&campaign), 0);
    let mut bytes = fs::read(&file).unwrap();
    let middle = bytes.len() / 2;
    bytes[middle] ^= 1;
    fs::write(&file, bytes).unwrap();
    assert_eq!(kept(&campaign), 0);
    fs::write(&file, "no answers").unwrap();
    assert_eq!(kept(&campaign), 0);
    assert_eq!(kept(&campaign), all);
}

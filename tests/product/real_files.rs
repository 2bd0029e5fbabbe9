//! The pipeline of `vibro run` on measurement files made by other people's instruments.

use serde_json::{Value, json};
use std::fmt::Write as _;
use std::fs;
use std::path::PathBuf;
use vibroimpact::analysis::{AnswerCache, open_in, run};
use vibroimpact::read::Reader;
use vibroimpact::read::{Folder, Owner};
use vibroimpact::report::Output;

fn data() -> Option<PathBuf> {
    crate::others_files::folder("")
}

fn results(campaign: &str) -> (Value, tempfile::TempDir) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("campaign.toml");
    fs::write(&path, campaign).unwrap();
    let campaign = open_in(&Folder::default().allow_outside(true), &path).unwrap();
    let mut output = Output::new(folder.path().join("out"), Owner::Run).unwrap();
    let found = run(&campaign, &AnswerCache::default(), &mut output, &()).unwrap();
    for name in &output.commit().unwrap() {
        assert!(folder.path().join("out").join(name).is_file(), "{name}");
    }
    (Value::Object(found.answer.result), folder)
}

/// Modes found in FRF number `index`.
fn modes(results: &Value, index: usize) -> &Vec<Value> {
    results["frf"][index]["modes"].as_array().unwrap()
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or(f64::NAN)
}

fn near(results: &Value, index: usize, frequency: f64, tolerance: f64) -> bool {
    let away = |mode: &Value| (number(&mode["frequency"]["value"]) - frequency).abs();
    modes(results, index).iter().any(|mode| away(mode) <= tolerance)
}

#[test]
fn resonances_of_a_hammer_test() {
    let Some(data) = data() else { return };
    let file = data.join("uff/dataset58_FRF.unv");
    let (found, _folder) =
        results(&format!("name = \"hammer test\"\n[[frf]]\nfile = {:?}\n", file.display().to_string()));
    // Stated resonances lie on spectral lines, 0.5 Hz apart. Interpolated peaks lie within one line of them.
    for f in [62.0, 81.5, 96.5, 125.0, 140.5, 175.0] {
        assert!(near(&found, 0, f, 0.5), "{f}: {:?}", found["frf"][0]["findings"]);
    }
    // Beside the peak at 41 Hz lies a dip that no single mode explains. A finding reports the peak among
    // those without a mode, and no mode is fitted there.
    let warnings = found["warnings"].to_string();
    let mut findings = found["findings"].as_array().unwrap().iter();
    let lines = |f: &Value| f["numbers"]["lines"].as_array().is_some_and(|at| at.contains(&json!(41.0)));
    let unexplained = findings.any(|f| f["code"] == "modal-peaks-of-noise" && lines(f));
    assert!(unexplained && !near(&found, 0, 41.0, 3.0), "{warnings}");
    // Label and unit of that file contradict each other, and a warning reports it.
    assert!(warnings.contains("eceptance"), "{warnings}");
}

#[test]
fn resonances_of_measured_accelerances() {
    let Some(data) = data() else { return };
    let mut text = String::from("name = \"accelerance\"\n");
    for i in 1..=3 {
        let file = data.join(format!("analyser/accelerance_point_{i}.txt"));
        let file = file.display().to_string();
        let _ = writeln!(
            text,
            "[[frf]]\nname = \"point {i}\"\nfile = {file:?}\nbase_band = 1000.0\nunit = \"(m/s²)/N\""
        );
    }
    let (found, _folder) = results(&text);
    for f in [52.0, 142.0, 279.0, 460.0, 687.0, 959.0] {
        assert!((0..3).any(|i| near(&found, i, f, 1.0)), "{f}");
    }
}

/// Where a peak has enough lines, circle fit and half-power method agree with the fit: the frequency within
/// a line (0.5 Hz), the damping within 20 %.
#[test]
fn three_methods_agree_on_measured_modes() {
    let Some(data) = data() else { return };
    let file = data.join("uff/dataset58_FRF.unv").display().to_string();
    let (found, _folder) = results(&format!("[[frf]]\nfile = {file:?}\n"));
    let mut compared = 0;
    // Well separated resonances below 200 Hz; above, the modes overlap.
    let named = [62.0, 81.5, 96.5, 125.0, 140.5, 175.0];
    let modes = modes(&found, 0).iter();
    for mode in modes.filter(|m| named.iter().any(|f| (number(&m["frequency"]["value"]) - f).abs() < 1.0)) {
        let of = |method| {
            let by = mode["by"].as_array().unwrap().iter().find(|b| b["method"] == method);
            // A mode that shares its lines with another is compared all the same.
            let no_limit = |b: &&&Value| b["note"] == "" || b["note"] == "method-of-one-mode";
            by.filter(|b| b["frequency"]["value"].is_number()).filter(|b| no_limit(&b))
        };
        for method in ["circle fit", "half power"] {
            let Some(by) = of(method) else { continue };
            // ζ of the 81.5 Hz mode has no uncertainty, since two modes fit that peak better. It counts as
            // 0, so the mode is compared all the same. Modes with ζ uncertain by more than 10 % are skipped.
            let (f, zeta) = (number(&mode["frequency"]["value"]), number(&mode["zeta"]["value"]));
            let std = mode["zeta"]["std"].as_f64().unwrap_or(0.0);
            if std > 0.1 * zeta {
                continue;
            }
            let (by_f, by_zeta) = (number(&by["frequency"]["value"]), number(&by["zeta"]["value"]));
            println!("{method} {by_f:.3} {f:.3}, ζ {by_zeta:.5} {zeta:.5} ± {std:.5}");
            assert!((by_f - f).abs() < 0.5, "{mode}");
            assert!((by_zeta / zeta - 1.0).abs() < 0.2, "{mode}");
            compared += 1;
        }
    }
    assert!(compared >= 8, "{compared}");
}

/// Every file can be read, and the survey gives each record the same length and largest value as reading
/// does.
#[test]
fn every_file_is_listed_as_it_is_read() {
    let Some(data) = data() else { return };
    let mut files = 0;
    for folder in ["uff", "analyser"] {
        for entry in fs::read_dir(data.join(folder)).unwrap() {
            let path = entry.unwrap().path();
            if path.file_name().unwrap().to_string_lossy().starts_with("LICENSE") {
                continue;
            }
            let recording = Reader::new().from_path(&path).unwrap_or_else(|e| panic!("{e}"));
            let (format, headers, _) = Reader::new().survey(&path).unwrap();
            assert_eq!((format, headers.len()), (recording.format, recording.records.len()), "{path:?}");
            for (header, record) in headers.iter().zip(&recording.records) {
                assert_eq!(header.n, record.len(), "{path:?}");
                let max = record.extremes().largest().map(|m| m.1);
                let same = match (header.max_abs, max) {
                    // Scaling before or after taking the modulus differs by a few roundings.
                    (Some(a), Some(b)) => (a - b).abs() <= 4.0 * f64::EPSILON * b,
                    (a, b) => a == b,
                };
                assert!(same, "{path:?}: {:?} against {max:?}", header.max_abs);
            }
            files += 1;
        }
    }
    assert!(files >= 40, "{files}");
}

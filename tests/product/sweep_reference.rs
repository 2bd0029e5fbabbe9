//! Every case of the reference sweeps: `legacy` against the output of the scripts, the default against the
//! truth.

use std::fs;
use std::path::{Path, PathBuf};
use vibroimpact::measure::response::{ResponseOptions, response};
use vibroimpact::measure::{excitation, legacy};
use vibroimpact::read::{Folder, SweepList, SweepReader};
use vibroimpact::record::Sweep;

fn cases() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("fixtures/reference/scripts")
}

fn load(folder: &Path) -> (SweepList, Sweep) {
    let list = SweepList::from_path(folder.join("LIST.TXT"), &Folder::default()).expect("a list");
    let sweep = SweepReader::default().read(&list).expect("its spectra");
    (list, sweep)
}

fn table(path: &Path) -> Option<Vec<Vec<f64>>> {
    let text = fs::read_to_string(path).ok()?;
    let rows = text.lines().filter(|l| l.chars().next().is_some_and(|c| c.is_ascii_digit()));
    Some(rows.map(|l| l.split(',').map(|v| v.parse().expect("a number")).collect()).collect())
}

const ALL: [&str; 6] =
    ["sweep_nominal", "sweep_dcforce", "sweep_fd03125", "sweep_lastharm", "sweep_tie", "sweep_header"];

#[test]
fn the_default_is_right_on_every_point() {
    let folder = cases();
    for case in ALL {
        let (_, sweep) = load(&folder.join(case));
        let df = sweep.line_width().expect("even lines");
        let truth = table(&folder.join(case).join("TRUTH.csv")).expect("a truth");
        let found = response(&sweep, &ResponseOptions::default()).expect("a response");
        assert_eq!(found.points.len(), truth.len(), "{case}");
        for (i, (point, truth)) in found.points.iter().zip(&truth).enumerate() {
            let lines = (point.excitation - truth[0]) / df;
            assert!(lines.abs() < 0.01, "{case} {i}: off by {lines} lines");
            let relative = point.amplitude.value / truth[1] - 1.0;
            assert!(relative.abs() < 0.002, "{case} {i}: amplitude off by {relative}");
            if let Some(std) = point.amplitude.std {
                // The simulated noise is white: five standard uncertainties, plus the rounding of the
                // printed digits.
                let error = (point.amplitude.value - truth[1]).abs();
                assert!(error < 5.0 * std + 1e-6 * truth[1], "{case} {i}: {error} against {std}");
            }
        }
    }
}

#[test]
fn legacy_gives_what_the_scripts_gave() {
    let folder = cases();
    let mut compared = 0;
    for case in ALL {
        let folder = folder.join(case);
        let (list, sweep) = load(&folder);
        let printed = fs::read_to_string(folder.join("out_sineswpf.txt")).expect("the script's output");
        if !printed.starts_with("ERROR") {
            let x: Vec<f64> = printed.lines().filter_map(|l| l.trim().parse().ok()).collect();
            let found = legacy::excitation(&sweep).expect("frequencies");
            assert_eq!(found, x, "{case}: sineswpf");
            let text = |names: &[PathBuf]| {
                let names: Vec<_> = names.iter().filter_map(|n| n.file_name()).collect();
                legacy::hand_over(list.lines, list.base_band, &found, &names)
            };
            for (name, names) in [("FORCE.TXT", &list.force), ("RESP.TXT", &list.response)] {
                assert_eq!(text(names), fs::read_to_string(folder.join(name)).expect(name), "{case}: {name}");
            }
            compared += 1;
        }
        if let Some(z) = table(&folder.join("out_sinesw_Z.csv")) {
            let found = legacy::waterfall(&sweep);
            for (k, row) in z.iter().enumerate() {
                assert_eq!(row[0], sweep.axis.at(k));
                assert!(
                    row[1..].iter().enumerate().all(|(i, v)| *v == found[i][k]),
                    "{case}: sinesw line {k}"
                );
            }
            compared += 1;
        }
        if let Some(xy) = table(&folder.join("out_sinesw3_xy.csv")) {
            let found = legacy::response(&sweep).expect("a response");
            for (i, (row, found)) in xy.iter().zip(&found).enumerate() {
                assert_eq!((row[0], row[1]), *found, "{case}: sinesw3 point {i}");
            }
            assert_eq!(xy.len(), found.len());
            compared += 1;
        }
    }
    // In the cases nominal, dcforce, fd03125 and lastharm all three scripts printed results.
    assert_eq!(compared, 12);
}

#[test]
fn a_tie_stops_the_script_and_not_the_default() {
    let folder = cases();
    let (_, sweep) = load(&folder.join("sweep_tie"));
    let error = legacy::excitation(&sweep).unwrap_err().to_string();
    assert!(error.contains("equally large"), "{error}");
    let found = excitation::excitations(&sweep, 0.0).expect("frequencies");
    assert!((found[1].frequency - 5.525).abs() < 5e-4);
}

#[test]
fn a_hand_over_file_is_a_sweep_too() {
    let folder = cases();
    let path = folder.join("sweep_nominal/RESP.TXT");
    let list = SweepList::from_path(&path, &Folder::default()).expect("a hand-over file");
    let sweep = SweepReader::default().read(&list).expect("its spectra");
    let found = response(&sweep, &ResponseOptions::default()).expect("a response");
    let truth = table(&folder.join("sweep_nominal/TRUTH.csv")).expect("a truth");
    for (point, truth) in found.points.iter().zip(&truth) {
        assert!((point.amplitude.value / truth[1] - 1.0).abs() < 0.002);
    }
}

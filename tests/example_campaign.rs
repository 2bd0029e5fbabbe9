//! The example campaign's data are what its generator makes, byte for byte.

#[path = "../examples/two_mass_rig/analyser.rs"]
mod analyser;
#[path = "../examples/two_mass_rig/campaign.rs"]
mod campaign;
#[path = "../examples/two_mass_rig/noise.rs"]
mod noise;

use campaign::{Direction, list, measure, truth_header};
use std::path::Path;

fn committed(name: &str) -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/two_mass_rig").join(name);
    std::fs::read_to_string(&path).unwrap_or_else(|e| panic!("{}: {e}", path.display()))
}

/// The whole upward sweep is simulated; spectra are made where something happens: at its start, at both resonances, at the
/// antiresonance between them, and just after the jump.
#[test]
fn the_upward_sweep_comes_out_again() {
    let shown = [1, 11, 22, 35, 36];
    let truth = committed("TRUTH.csv");
    let (mut number, mut compared) = (0, 0);
    measure(Direction::Up, usize::MAX, |point| {
        number += 1;
        let row = point.truth();
        // An irregular motion doubles a difference in the last digit of a sine every few cycles: it need not come out
        // again on a machine with another mathematics library.
        if !row.contains("irregular") {
            assert!(truth.contains(&row), "TRUTH.csv lacks {row}");
        }
        if shown.contains(&number) {
            for (name, text) in point.files() {
                assert_eq!(name.len(), 11);
                assert!(text == committed(&name), "{name} differs from what the generator makes");
                compared += 1;
            }
        }
        Ok(())
    })
    .unwrap();
    assert_eq!((number, compared), (40, 15));
}

#[test]
fn lists_name_files_that_are_there() {
    assert!(committed("TRUTH.csv").starts_with(&truth_header()));
    for direction in [Direction::Up, Direction::Down] {
        for mass in [1, 2] {
            let (name, text) = list(direction, mass);
            assert!(text == committed(&name), "{name}");
            let mut lines = text.lines();
            assert_eq!((lines.next(), lines.next(), lines.next()), (Some("40"), Some("400"), Some("20")));
            let names: Vec<&str> = lines.collect();
            assert_eq!(names.len(), 80);
            for name in names {
                let spectrum = committed(name);
                assert_eq!(spectrum.lines().count(), 401, "{name}");
                assert!(spectrum.lines().all(|line| line.len() == 14), "{name}");
            }
        }
    }
}

//! Units in the files of a sweep, against units that the user states.

use super::sentences;
use vibroimpact::read::{Folder, SweepList, SweepReader};
use vibroimpact::record::{Sweep, Values};
use vibroimpact::units::Unit;

/// Reads a sweep of one point: five lines from 0 to 20 Hz.
fn read(force: &str, response: &str, how: &SweepReader) -> Result<Sweep, String> {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).unwrap();
    write("L.TXT", "1\n4\n20\nF.DAT\nR.DAT\n");
    write("F.DAT", &format!("{force}\n0.5\n1\n2\n1\n0.5\n"));
    write("R.DAT", &format!("{response}\n0.5\n1\n2\n1\n0.5\n"));
    let list = SweepList::from_path(folder.path().join("L.TXT"), &Folder::default()).unwrap();
    how.read(&list).map_err(|e| e.to_string())
}

fn close(a: f64, b: f64) -> bool {
    (a / b - 1.0).abs() < 4.0 * f64::EPSILON
}

fn response(sweep: &Sweep) -> f64 {
    match &sweep.points[0].response.values {
        Values::Real(values) => values[2],
        Values::Complex(values) => panic!("{values:?}"),
    }
}

#[test]
fn a_force_in_volts_takes_its_calibration() {
    for unit in ["V", "mV", "%", "N"] {
        let how = SweepReader { force_calibration: Some(22.4), ..SweepReader::default() };
        let sweep = read(&format!("Unit: {unit}"), "Unit: m/s", &how).unwrap();
        // The calibration is in newtons per stored number, whatever the unit of that number.
        assert!(close(sweep.points[0].force.magnitude(2), 2.0 * 22.4), "{unit}: {:?}", sweep.points[0].force);
    }
    let error = read("Unit: V", "Unit: m/s", &SweepReader::default()).unwrap_err();
    assert!(error.contains("F.DAT") && error.contains("force_calibration"), "{error}");
    let how = SweepReader { force_calibration: Some(22.4), ..SweepReader::default() };
    assert!(
        read("Unit: m/s", "Unit: m/s", &how).unwrap_err().contains("check that these are the force files")
    );
}

#[test]
fn a_response_in_volts_takes_unit_and_calibration() {
    let how = |unit: Option<&str>, calibration| SweepReader {
        unit: unit.and_then(Unit::parse),
        calibration,
        ..SweepReader::default()
    };
    for written in ["V", "mV"] {
        let sweep = read("Unit: N", &format!("Unit: {written}"), &how(Some("mm/s"), Some(125.0))).unwrap();
        assert!(close(response(&sweep), 2.0 * 0.125), "{written}: {}", response(&sweep));
        assert_eq!(sweep.points[0].response.meta.unit.symbol(), "m/s");
    }
    let error = read("Unit: N", "Unit: V", &how(Some("mm/s"), None)).unwrap_err();
    assert!(error.contains("R.DAT") && error.contains("state unit and calibration"), "{error}");
    // A calibration does not turn an acceleration into a velocity.
    let error = read("Unit: N", "Unit: m/s²", &how(Some("mm/s"), Some(125.0))).unwrap_err();
    assert!(error.contains("acceleration") && error.contains("expected velocity"), "{error}");
}

#[test]
fn only_what_states_the_values_makes_them_decibels() {
    let plain = SweepReader::default();
    let linear = SweepReader { unit: Unit::parse("mm/s"), ..SweepReader::default() };
    for header in ["Unit: dB", "scale: log dB", "amplitude [dB]"] {
        let error = read("Unit: N", header, &plain).unwrap_err();
        assert!(error.contains("says that its values are decibels"), "{header}: {error}");
        let sweep = read("Unit: N", header, &linear).unwrap();
        assert!(close(response(&sweep), 2e-3), "{header}");
        assert!(
            sentences(&sweep.findings)
                .iter()
                .any(|d| d.contains("decibels") && d.contains("mm/s was stated")),
            "{header}"
        );
        // A unit stated for responses does not apply to forces.
        assert!(read(header, "Unit: m/s", &linear).unwrap_err().contains("F.DAT"), "{header}");
    }
}

#[test]
fn a_stated_unit_wins_over_the_files_and_that_is_said() {
    let how = |unit: &str| SweepReader { unit: Unit::parse(unit), ..SweepReader::default() };
    let sweep = read("Unit: kN", "Unit: mm/s", &how("m/s")).unwrap();
    assert!(close(response(&sweep), 2.0), "{}", response(&sweep));
    assert!(
        sentences(&sweep.findings).iter().any(|d| d.contains("m/s was stated and is used")),
        "{:?}",
        sentences(&sweep.findings)
    );
    // No unit is stated for the force, so that of the file applies.
    assert!(close(sweep.points[0].force.magnitude(2), 2000.0));
    let sweep = read("Unit: N", "Unit: mm/s", &how("mm/s")).unwrap();
    assert!(close(response(&sweep), 2e-3));
    assert!(
        !sentences(&sweep.findings).iter().any(|d| d.contains("was stated")),
        "{:?}",
        sentences(&sweep.findings)
    );
}

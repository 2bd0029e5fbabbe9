use super::*;
use crate::reader::Reader;
use crate::recording::Recording;
use crate::tests::{has_finding, read_both_ways, texts};
use num_complex::Complex64;
use proptest::prelude::*;
use vibro_record::units::Unit;
use vibro_record::{AxisKind, Record};

/// Values of the fixtures.
fn v() -> impl Iterator<Item = f64> {
    (0..24).map(|i| 5.0 * f64::from(i) - 60.0)
}

/// Reads a fixture from its folder, which also holds the targets of its links.
fn fixture(name: &str) -> Recording {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../../fixtures/hdf5/");
    read_both_ways(&Source::file(format!("{folder}{name}")).unwrap()).unwrap()
}

fn names(recording: &Recording) -> Vec<&str> {
    recording.records.iter().map(|record| record.meta().name.as_str()).collect()
}

fn named<'a>(recording: &'a Recording, name: &str) -> &'a Record {
    let known = names(recording);
    recording
        .records
        .iter()
        .find(|record| record.meta().name == name)
        .unwrap_or_else(|| panic!("{name}: {known:?}"))
}

fn values<'a>(recording: &'a Recording, name: &str) -> &'a [f64] {
    match named(recording, name) {
        Record::Trace(trace) => &trace.values,
        other => panic!("{name} is a {}", other.kind()),
    }
}

#[test]
fn values_are_the_same_however_they_are_stored() {
    for (name, more) in [
        ("storage_earliest.h5", &[][..]),
        ("storage_latest.h5", &["compact", "early", "growing", "one", "scaled"]),
    ] {
        let recording = fixture(name);
        assert_eq!(recording.format, Format::Hdf5);
        for name in ["contiguous", "fixed", "tree[:,0]"].iter().chain(more) {
            assert!(values(&recording, name).iter().copied().eq(v()), "{name}");
        }
        assert!(values(&recording, "tree[:,1]").iter().copied().eq(v().map(|v| -v)));
        if !more.is_empty() {
            assert!(values(&recording, "lzf").iter().copied().eq(v().flat_map(|v| [v; 20])));
            assert_eq!(values(&recording, "unwritten"), [2.5; 24]);
        }
        assert_eq!(recording.findings, []);
    }
}

#[test]
fn every_number_is_read_in_both_orders_of_bytes() {
    let recording = fixture("numbers.h5");
    for order in ["<", ">"] {
        for kind in ["i1", "i2", "i4", "i8", "f4", "f8"] {
            assert!(values(&recording, &format!("{order}{kind}")).iter().copied().eq(v()), "{order}{kind}");
        }
        for kind in ["u1", "u2", "u4", "u8"] {
            let unsigned = v().map(|v| v + 60.0);
            assert!(
                values(&recording, &format!("{order}{kind}")).iter().copied().eq(unsigned),
                "{order}{kind}"
            );
        }
        let Record::Spectrum(complex) = named(&recording, &format!("{order}c16")) else { panic!("complex") };
        let Values::Complex(complex) = &complex.values else { panic!("complex") };
        assert!(complex.iter().copied().eq(v().map(|v| Complex64::new(v, -v))));
    }
    assert!(values(&recording, "table/x").iter().copied().eq(v()));
    assert_eq!(named(&recording, "table/x").axis().step(), Some(0.125));
    assert_eq!(recording.records.len(), 23);
    assert_eq!(
        texts(&recording.findings),
        [
            "variable-passed-over variable=table/mark class=field that is no number",
            "axis-unit-assumed unit=s column=vector \"table/t\"",
        ]
    );
}

#[test]
fn what_is_no_plain_number_is_left_out_by_name() {
    let recording = fixture("odd_numbers.h5");
    assert_eq!(names(&recording), ["v"]);
    for (code, name, class) in [
        ("variable-passed-over", "12 bits", "unusual layout"),
        ("variable-passed-over", "other exponent", "unusual layout"),
        ("variable-passed-over", "long double", "unusual layout"),
        ("variable-passed-over", "16 bits", "unusual layout"),
        ("variable-passed-over", "flags", "enumeration"),
        ("variable-passed-over", "ragged", "different lengths"),
        ("variable-passed-over", "times", "neither numbers nor text"),
        ("variable-many-dimensions", "cube", "3"),
        ("variable-empty", "rows", ""),
        ("variable-empty", "nothing", ""),
    ] {
        let found = has_finding(&recording.findings, code, &[&format!("variable={name}"), class]);
        assert!(found, "{name}: {:?}", texts(&recording.findings));
    }
    assert_eq!(recording.findings.len(), 10);
}

#[test]
fn links_lead_to_nothing_twice_and_to_no_other_file() {
    let recording = fixture("links.h5");
    assert_eq!(names(&recording), ["soft"]);
    for (code, facts) in [
        ("link-not-followed", "file=numbers.h5"),
        ("dataset-unreadable", "variable=raw outside"),
        ("variable-passed-over", "variable=v class=second link"),
        ("variable-passed-over", "variable=loop class=second link"),
        ("variable-passed-over", "variable=references"),
    ] {
        assert!(has_finding(&recording.findings, code, &[facts]), "{:?}", texts(&recording.findings));
    }
}

#[test]
fn attributes_state_unit_rate_and_start_of_their_dataset_or_group() {
    let recording = fixture("logger.h5");
    let of = |name| {
        let record = named(&recording, name);
        (record.meta().unit.symbol(), record.axis().start(), record.axis().step().unwrap(), record.len())
    };
    assert_eq!(of("bare"), ("", 0.0, 0.01, 24));
    assert_eq!(of("run 1/two"), ("", 3.0, 0.25, 2));
    // Two rows of 24 values are two channels; three rows of eight values with three times are eight
    // channels.
    assert_eq!(of("run 1/velocity[1,:]"), ("m/s", 0.0, 0.005, 24));
    assert_eq!(of("run 2/force[:,7]"), ("N", 0.0, 0.002, 3));
    assert_eq!(recording.records.len(), 12);
    let double: Vec<f64> = values(&recording, "run 1/velocity[1,:]").to_vec();
    assert!(double.iter().zip(v()).all(|(found, v)| (found - 2e-3 * v).abs() <= 1e-16));
    assert_eq!(values(&recording, "run 2/force[:,7]"), [-25e3, 15e3, 55e3]);
    let notes = &named(&recording, "run 1/two").meta().notes;
    for (key, value) in [("operator", "Jäger"), ("sample_rate", "200"), ("temperature", "21.5"), ("t0", "3")]
    {
        assert!(notes.contains(&(key.to_owned(), value.to_owned())), "{notes:?}");
    }
    let stated = Reader::new().rate(Some(50.0)).unit(Some(Unit::parse("g").unwrap()));
    let bytes = include_bytes!("../../../../fixtures/hdf5/logger.h5");
    let stated = stated.from_reader("x.h5", &bytes[..]).unwrap();
    assert_eq!(named(&stated, "bare").axis().step(), Some(0.02));
    let findings = stated.all_findings();
    assert!(has_finding(&findings, "rate-overrides-step", &["step=0.01"]), "{:?}", texts(&findings));
    assert!(
        has_finding(&findings, "unit-overrides-file", &["file=mm/s", "used=g"]),
        "{:?}",
        texts(&findings)
    );
}

#[test]
fn counts_of_an_oscilloscope_are_taken_through_their_scale() {
    let recording = fixture("scope.h5");
    let channel = "Waveforms/Channel 1/Channel 1";
    assert!(values(&recording, &format!("{channel}Data")).iter().copied().eq(v().map(|v| 0.5 * v + 10.0)));
    assert!(values(&recording, &format!("{channel} Volts")).iter().copied().eq(v()));
    let counts = named(&recording, &format!("{channel}Data"));
    assert_eq!(
        (counts.meta().unit.symbol(), counts.axis().start(), counts.axis().step()),
        ("V", -2e-6, Some(1e-6))
    );
    let Record::Spectrum(spectrum) = named(&recording, "Waveforms/Function 1/Function 1Data") else {
        panic!()
    };
    assert_eq!((spectrum.axis.start(), spectrum.axis.step()), (10.0, Some(2.0)));
    // A dimension in millimetres is not used as abscissa.
    assert!(values(&recording, "packed").iter().copied().eq(v().map(|v| 0.25 * v - 1.0)));
    assert_eq!(named(&recording, "packed").axis().kind, AxisKind::Index);
}

#[test]
fn the_unit_of_a_clock_stands_in_its_name_or_is_assumed_aloud() {
    let recording = fixture("clocks.h5");
    let even = |name: &str| {
        let axis = named(&recording, name).axis();
        (axis.kind.clone(), axis.start(), crate::assemble::short(axis.step().unwrap()))
    };
    for (name, step) in [
        ("time_ms/v", 2e-3),
        ("timestamp/v", 2e-3),
        ("time/v", 2.0),
        ("speed/v", 0.01),
        ("device/raw/v", 1e-3),
        ("speed/speed", 0.01),
        ("by sampling_rate", 1.0 / 51.2e3),
        ("by dt", 20e-6),
    ] {
        let (kind, _, found) = even(name);
        assert_eq!((kind, found), (AxisKind::Time, crate::assemble::short(step)), "{name}");
    }
    // Doubles of ns since 1970 are 256 ns apart: over 23 steps, the mean step is right to 256 ns / 23.
    assert!((named(&recording, "timestamp_ns/v").axis().step().unwrap() - 1e-6).abs() < 256e-9 / 23.0);
    // Times whose name states nanoseconds keep their instants; a clock without a unit counts from its first
    // value.
    assert_eq!((even("timestamp/v").1, even("timestamp_ns/v").1), (0.0, 1.7e9));
    // Not used: clock ticks as seconds, a rate in blocks, and the rate of the samples for their means.
    for name in ["ticks timestamp/v", "by fs", "device/support/level 10/v"] {
        assert_eq!(named(&recording, name).axis().kind, AxisKind::Index, "{name}");
    }
    let means = named(&recording, "device/support/level 10/v").meta();
    assert!(has_finding(&means.findings, "abscissa-unsaid", &["sampling rate", "rate=1000"]));
    for (code, facts) in [
        ("axis-epoch", ["unit=ms", "timestamp/timestamp"]),
        ("axis-unit-assumed", ["unit=s", "time/time"]),
        // Doubles at 1.7e18 are 256 apart, here ns.
        ("axis-rounded", ["timestamp_ns", "smallest"]),
    ] {
        assert!(has_finding(&recording.findings, code, &facts), "{code}: {:?}", texts(&recording.findings));
    }
}

#[test]
fn stored_numbers_are_no_measured_values() {
    let keeping = Reader::new().allow_missing(true);
    let bytes = include_bytes!("../../../../fixtures/hdf5/scales.h5");
    let recording = keeping.from_reader("scales.h5", &bytes[..]).unwrap();
    assert!(values(&recording, "reference").iter().copied().eq(v().map(|v| 0.5 * v + 10.0)));
    assert!(values(&recording, "float").iter().copied().eq(v().map(|v| 0.5 * v + 10.0)));
    let filled = values(&recording, "filled");
    assert!(filled[0].is_nan() && filled[1..].iter().copied().eq(v().skip(1).map(|v| 0.5 * v)));
    assert_eq!(recording.records.len(), 3);
    assert!(has_finding(&recording.findings, "scale-unknown", &["variable=unclear", "scale=scale"]));
    assert!(Reader::new().from_reader("scales.h5", &bytes[..]).unwrap_err().to_string().contains("NaN"));
}

#[test]
fn what_was_written_is_read_and_the_rest_is_not_made_up() {
    let recording = fixture("half_written.h5");
    for name in ["plain", "packed"] {
        assert!(values(&recording, name).iter().copied().eq(v()), "{name}");
    }
    assert!(has_finding(&recording.findings, "fewer-values", &["declared=100000000", "n=24"]));
}

#[test]
fn what_is_declared_and_not_there_is_left_out() {
    let recording = fixture("declared.h5");
    assert_eq!(names(&recording), ["v"]);
    for name in ["variable=filled", "variable=chunked", "variable=packed"] {
        let found = has_finding(
            &recording.findings,
            "dataset-unreadable",
            &[name, "8000000000000 bytes are declared"],
        );
        assert!(found, "{:?}", texts(&recording.findings));
    }
    let bytes = include_bytes!("../../../../fixtures/hdf5/virtual.h5");
    let refused = Reader::new().from_reader("x.h5", &bytes[..]).unwrap_err().to_string();
    assert!(refused.contains("unsupported layout") && refused.contains("write its arrays as"), "{refused}");
}

#[test]
fn variables_of_matlab_are_named_as_matlab_names_them() {
    let recording = fixture("matlab.mat");
    for name in ["bearing.gs", "bearing.load.y", "runs(1).x", "data{3}.x", "counts", "pair(:,1)"] {
        assert!(values(&recording, name).iter().copied().eq(v()), "{name}");
    }
    assert!(values(&recording, "runs(2).x").iter().copied().eq(v().map(|v| 2.0 * v)));
    assert!(values(&recording, "pair(:,2)").iter().copied().eq(v().map(|v| -v)));
    assert_eq!(values(&recording, "data{1}"), [0.0, 1.0, 2.0, 3.0]);
    let Record::Spectrum(frf) = named(&recording, "frf") else { panic!("complex") };
    let Values::Complex(frf) = &frf.values else { panic!("complex") };
    assert_eq!((frf.len(), frf[1]), (5, Complex64::new(-55.0, 1.0)));
    assert_eq!(recording.records.len(), 10);
    let counts = named(&recording, "counts");
    assert_eq!(counts.axis().step(), Some(1e-3));
    assert!(counts.meta().notes.contains(&("rig".to_owned(), "zwei Massen µ".to_owned())));
    assert!(has_finding(&recording.findings, "variable-empty", &["variable=none"]));
    assert!(has_finding(
        &recording.findings,
        "variable-passed-over",
        &["variable=flag", "class=logical array"]
    ));
    for (name, format) in [("x.h5", None), ("x", Some(Format::Hdf5)), ("x", Some(Format::Mat))] {
        let bytes = include_bytes!("../../../../fixtures/hdf5/matlab.mat");
        let other = Reader::new().format(format).from_reader(name, &bytes[..]).unwrap();
        assert_eq!(names(&other), names(&recording));
    }
}

#[test]
fn a_file_that_ends_early_never_panics() {
    let bytes = include_bytes!("../../../../fixtures/hdf5/logger.h5");
    for end in (1..bytes.len()).step_by(7) {
        assert!(Reader::new().from_reader("x.h5", &bytes[..end]).is_err(), "{end}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]
    #[test]
    fn damage_never_panics(which in 0..4, flips in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..6)) {
        let mut bytes = match which {
            0 => include_bytes!("../../../../fixtures/hdf5/logger.h5").to_vec(),
            1 => include_bytes!("../../../../fixtures/hdf5/storage_latest.h5").to_vec(),
            2 => include_bytes!("../../../../fixtures/hdf5/storage_earliest.h5").to_vec(),
            _ => include_bytes!("../../../../fixtures/hdf5/matlab.mat").to_vec(),
        };
        for (at, byte) in flips {
            let at = at.index(bytes.len());
            bytes[at] = byte;
        }
        let _ = Reader::new().format(Some(Format::Hdf5)).from_reader("x.h5", bytes.as_slice());
    }
}

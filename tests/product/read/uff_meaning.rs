//! The meaning of a data set 58's header: units, kind of record, abscissa.

use super::sentences;
use super::uff_set::{NONE, SEVEN, Set, doubts, form, read, reader, refused, try_read, values};
use vibroimpact::record::{AxisKind, Record, Scaling};
use vibroimpact::units::{Quantity, Unit};

fn axis(code: u8, label: &str, unit: &str) -> String {
    format!("{code:10}    0    0    0 {label:20} {unit:20}")
}

/// Unit symbol, first value (1 in the file, so the factor of the unit) and findings of a ratio.
fn unit(set: &Set) -> (String, f64, String) {
    let recording = read(&set.file());
    (recording.records[0].meta().unit.symbol().to_owned(), values(&recording)[0], doubts(&recording))
}

#[test]
fn numerator_and_denominator_share_the_unit() {
    let none = axis(0, "NONE", "NONE");
    let force = axis(13, "Force", "N");
    for (above, below, symbol, factor) in [
        (axis(12, "Acceleration", "m/s2"), &force, "(m/s²)/N", 1.0),
        (axis(12, "Acceleration", "g"), &force, "(m/s²)/N", 9.806_65),
        (axis(12, "Acceleration", "g"), &axis(13, "Force", "kN"), "(m/s²)/N", 9.806_65e-3),
        // The numerator states the unit of the whole ratio, with and without a denominator that repeats it.
        (axis(12, "Acceleration", "(m/s²)/N"), &force, "(m/s²)/N", 1.0),
        (axis(0, "NONE", "mm/s/N"), &force, "(m/s)/N", 1e-3),
        (axis(0, "NONE", "µm/N"), &none, "m/N", 1e-6),
        (axis(8, "NONE", "mm"), &axis(0, "NONE", "kN"), "m/N", 1e-6),
    ] {
        let (found, value, doubts) = unit(&Set::ratio(4, &above, below));
        assert_eq!(found, symbol, "{above} over {below}");
        assert!((value / factor - 1.0).abs() < 1e-14, "{above} over {below}: {value}");
        assert_eq!(doubts, "");
    }
}

#[test]
fn units_without_text() {
    let (symbol, value, text) = unit(&Set::ratio(4, &axis(12, "NONE", "NONE"), &axis(13, "NONE", "NONE")));
    assert_eq!((symbol.as_str(), value), ("(m/s²)/N", 1.0));
    assert!(text.contains("SI units of acceleration over excitation force are assumed"), "{text}");
    // Millimetre and newton: a stored displacement of 1 is 1 mm.
    let system = b"    -1\n   164\n        10mm (newton)                  2\n  1.00000000000000000D+03  1.00000000000000000D+00  1.00000000000000000D+00\n  2.73149999999999977D+02\n    -1\n";
    let set = Set::ratio(4, &axis(8, "NONE", "NONE"), &axis(13, "NONE", "NONE")).file();
    let recording = read(&[&system[..], &set].concat());
    assert_eq!(recording.records[0].meta().unit.symbol(), "m/N");
    assert_eq!(values(&recording)[0], 1e-3);
    // A unit in the text takes precedence over the unit system.
    let set = Set::ratio(4, &axis(8, "NONE", "m"), &axis(13, "NONE", "N")).file();
    let recording = read(&[&system[..], &set].concat());
    assert_eq!(values(&recording)[0], 1.0);
    // A rotation has a different unit.
    let mut set = Set::trace(1, "  1.00000E+00\n");
    set.axes[1] = axis(12, "NONE", "NONE");
    let rotation = String::from_utf8(set.file()).unwrap().replace("   7   3 NONE", "   7   6 NONE");
    let recording = read(rotation.as_bytes());
    assert_eq!(recording.records[0].meta().unit.dimension(), Unit::parse("rad/s²").unwrap().dimension());
    assert_eq!(recording.records[0].meta().name, "Mic 7+RZ");
    for (ordinate, said) in [(axis(11, "NONE", "NONE"), 1), (axis(11, "Velocity", "rad/s"), 0)] {
        set.axes[1] = ordinate;
        let rotation = String::from_utf8(set.file()).unwrap().replace("   7   3 NONE", "   7   6 NONE");
        let recording = read(rotation.as_bytes());
        let meta = recording.records[0].meta();
        assert_eq!((meta.quantity, meta.unit.symbol()), (Quantity::AngularVelocity, "rad/s"));
        assert_eq!(sentences(&meta.findings).len(), said, "{:?}", sentences(&meta.findings));
    }
}

#[test]
fn units_that_are_not_understood_or_contradict() {
    let none = axis(0, "NONE", "NONE");
    for (function, above, symbol, word) in [
        (4, axis(0, "NONE", "EU"), "EU", "\"EU\" is not known"),
        (4, none.clone(), "", "No unit found"),
        (4, axis(0, "Receptance", "(m/s)/N"), "(m/s)/N", "label is \"Receptance\""),
        (12, axis(12, "Velocity", "m/s²"), "m/s²", "label is \"Velocity\""),
        (9, axis(12, "NONE", "g"), "g", "is squared"),
    ] {
        let (found, value, text) = unit(&Set::ratio(function, &above, &none));
        assert_eq!((found.as_str(), value), (symbol, 1.0), "{above}");
        assert!(text.contains(word), "{text}");
    }
    let (symbol, value, text) = unit(&Set::ratio(9, &axis(12, "NONE", "g^2/Hz"), &none));
    assert!(
        symbol == "m^2·s^-3" && (value / 9.806_65f64.powi(2) - 1.0).abs() < 1e-14 && text.is_empty(),
        "{text}"
    );
    let (symbol, ..) = unit(&Set::ratio(9, &axis(12, "NONE", "NONE"), &none));
    assert_eq!(
        Unit::parse(&symbol.replace('·', "*")).unwrap().dimension(),
        Unit::parse("m^2/s^3").unwrap().dimension()
    );
    let (symbol, ..) = unit(&Set::ratio(6, &axis(12, "NONE", "NONE"), &axis(13, "NONE", "NONE")));
    assert_eq!(symbol, "1");
}

#[test]
fn function_types_and_abscissa_decide_the_record() {
    let pressure = axis(15, "NONE", "Pa");
    let squared = axis(0, "NONE", "Pa^2");
    for (function, above, scaling, word) in [
        (2, &squared, Scaling::Unknown, "squared RMS or squared peak"),
        (3, &squared, Scaling::Unknown, "squared RMS or squared peak"),
        (6, &axis(0, "NONE", "1"), Scaling::Coherence, ""),
        (9, &axis(0, "NONE", "Pa^2/Hz"), Scaling::Psd, ""),
        (10, &axis(0, "NONE", "Pa^2 s/Hz"), Scaling::Energy, ""),
        (12, &pressure, Scaling::Unknown, "peak or RMS"),
        (0, &pressure, Scaling::Unknown, "general function"),
        (1, &pressure, Scaling::Unknown, "time response"),
        (24, &pressure, Scaling::Unknown, "shock response spectrum"),
    ] {
        let recording = read(&Set::ratio(function, above, NONE).file());
        let Record::Spectrum(spectrum) = &recording.records[0] else {
            panic!("type {function} is no spectrum")
        };
        assert_eq!(spectrum.scaling, scaling, "type {function}");
        let text = doubts(&recording);
        assert!(text.contains(word) && text.is_empty() == word.is_empty(), "type {function}: {text}");
    }
    for (function, word) in
        [(0, ""), (1, ""), (4, "abscissa is time"), (7, "auto correlation"), (11, "probability")]
    {
        let recording = read(&Set { function, ..Set::trace(7, SEVEN) }.file());
        assert_eq!(recording.records[0].kind(), "trace", "type {function}");
        let text = doubts(&recording);
        assert!(text.contains(word) && text.is_empty() == word.is_empty(), "type {function}: {text}");
    }
    let message = refused(&Set { form: form(5, 2, 1), ..Set::trace(0, "1 0 0 1\n") }.file());
    assert!(message.contains("complex values over time") && message.contains("line 9"), "{message}");
}

#[test]
fn the_abscissa_is_time_frequency_or_something_else() {
    let kind = |function, abscissa: &str| {
        let mut set = Set { function, ..Set::trace(7, SEVEN) };
        abscissa.clone_into(&mut set.axes[0]);
        let recording = read(&set.file());
        let axis = recording.records[0].axis().clone();
        (axis.kind.clone(), axis.step().unwrap(), doubts(&recording))
    };
    assert_eq!(kind(1, &axis(17, "time", "ms")), (AxisKind::Time, 0.25e-3, String::new()));
    assert_eq!(kind(1, &axis(17, "NONE", "NONE")), (AxisKind::Time, 0.25, String::new()));
    let (found, step, text) = kind(1, &axis(17, "NONE", "Hz"));
    assert!(found == AxisKind::Frequency && step == 0.25 && text.contains("the unit is used"), "{text}");
    let (found, _, text) = kind(1, &axis(0, "NONE", "NONE"));
    assert!(found == AxisKind::Time && text.contains("is assumed"), "{text}");
    let (found, _, text) = kind(0, &axis(0, "NONE", "NONE"));
    assert!(found == AxisKind::Index && text.contains("is not said"), "{text}");
    let (found, _, text) = kind(1, &axis(17, "NONE", "fortnight"));
    assert!(found == AxisKind::Time && text.contains("fortnight"), "{text}");
    // 2π rad are one turn.
    for (code, unit) in [(18, "rad/s"), (0, "rad/s"), (1, "1/s*rad")] {
        let (found, step, text) = kind(12, &axis(code, "omega", unit));
        assert!(found == AxisKind::Frequency && text.contains("divided by 2π"), "{unit}: {text}");
        // One product and one quotient, each rounded by half a unit in the last place.
        assert!((step * 2.0 * std::f64::consts::PI / 0.25 - 1.0).abs() < 4.0 * f64::EPSILON, "{step}");
    }
    assert_eq!(kind(0, &axis(19, "speed", "rpm")).0, AxisKind::Other("speed [rpm]".into()));
    assert_eq!(kind(0, &axis(5, "NONE", "K")).0, AxisKind::Other("temperature [K]".into()));
}

#[test]
fn values_that_leave_the_range_of_numbers_are_refused() {
    let mut set = Set::trace(2, "  1.00000E+00  1.00000+308\n");
    set.axes[1] = axis(8, "NONE", "km");
    let error = refused(&set.file());
    assert!(error.contains("odd.uff: the value 1e308"), "{error}");
    set.axes[1] = axis(8, "NONE", "m");
    assert_eq!(values(&read(&set.file())), [1.0, 1e308]);
}

#[test]
fn what_a_person_states_wins() {
    let bytes = Set::trace(7, SEVEN).file();
    let recording = try_read(&reader().rate(Some(8.0)).unit(Unit::parse("kPa")), &bytes).unwrap();
    assert_eq!(recording.records[0].axis().step(), Some(0.125));
    assert_eq!(values(&recording)[1], 2000.0);
    let text = doubts(&recording);
    assert!(text.contains("0.25") && text.contains("8 Hz") && text.contains("kPa"), "{text}");
    let agreed = try_read(&reader().rate(Some(4.0)).unit(Unit::parse("Pa")), &bytes).unwrap();
    assert_eq!(doubts(&agreed), "");
    let spectrum = Set::ratio(9, &axis(0, "NONE", "Pa^2/Hz"), NONE).file();
    let recording = try_read(&reader().base_band(Some(20.0)), &spectrum).unwrap();
    assert!(doubts(&recording).contains("base band"));
}

#[test]
fn a_step_that_is_no_step() {
    let zero = String::from_utf8(Set::trace(7, SEVEN).file()).unwrap().replace("2.50000E-01", "0.00000E+00");
    let recording = read(zero.as_bytes());
    assert_eq!(recording.records[0].axis().kind, AxisKind::Index);
    assert!(doubts(&recording).contains("abscissa step of 0"));
    let recording = try_read(&reader().rate(Some(4.0)), zero.as_bytes()).unwrap();
    assert_eq!(recording.records[0].axis().step(), Some(0.25));
}

#[test]
fn instants_that_are_stored_and_even_give_a_rate() {
    let pairs: Vec<String> =
        (0..9).map(|i| format!("{:13.5e}{:13.5e}\n", f64::from(i) / 3.0, f64::from(i))).collect();
    let mut set = Set::trace(0, &pairs.concat());
    set.form = form(2, 9, 0);
    let recording = read(&set.file());
    let step = recording.records[0].axis().step().expect("an even axis");
    // 8/3 is printed as 2.66667, so the step is off by half a unit of the last digit over eight steps.
    assert!((step - 1.0 / 3.0).abs() <= 0.5e-5 / 8.0);
}

#[test]
fn a_lost_sample_leaves_no_rate() {
    let pairs: Vec<String> =
        (0..9).filter(|i| *i != 4).map(|i| format!("{:13.5e}{i:13}\n", f64::from(i) / 3.0)).collect();
    let set = Set { form: form(2, 8, 0), ..Set::trace(0, &pairs.concat()) };
    let recording = read(&set.file());
    assert_eq!(recording.records[0].axis().step(), None);
    assert!(doubts(&recording).contains("The abscissa is uneven"));
    let stated = try_read(&reader().rate(Some(3.0)), &set.file()).unwrap();
    assert_eq!(stated.records[0].axis().step(), Some(1.0 / 3.0));
    assert!(doubts(&stated).contains("its own instants"));
}

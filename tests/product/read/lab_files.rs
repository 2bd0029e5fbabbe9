//! Files of oscilloscopes, LabVIEW and the PEER database.
//!
//! Expected values are those of `../shared/data/README.md` in SI units. If a file is in g, the test
//! contains the factor.

#![expect(clippy::unreadable_literal, reason = "digits as the files print them")]

use crate::others_files::folder;
use std::path::Path;
use vibroimpact::read::{Reader, Recording};
use vibroimpact::record::{Record, Trace};

const G: f64 = 9.80665;

fn read(folder: &Path, name: &str) -> Recording {
    Reader::new().from_path(folder.join(name)).unwrap_or_else(|e| panic!("{name}: {e}"))
}

fn trace(record: &Record) -> &Trace {
    if let Record::Trace(trace) = record { trace } else { panic!("{record:?}") }
}

fn traces(recording: &Recording) -> Vec<&Trace> {
    recording.records.iter().map(trace).collect()
}

fn close(a: f64, b: f64, relative: f64) -> bool {
    (a - b).abs() <= relative * b.abs()
}

/// Name, number of values, start in s and step in s of each trace.
fn shape(recording: &Recording) -> Vec<(&str, usize, f64, Option<f64>)> {
    let of = |t: &Trace| (t.values.len(), t.axis.start(), t.axis.step());
    traces(recording)
        .into_iter()
        .map(|t| {
            let (n, start, step) = of(t);
            (t.meta.name.as_str(), n, start, step)
        })
        .collect()
}

#[test]
fn oscilloscopes() {
    let Some(folder) = folder("scope") else { return };
    // File, number of values, start in s, step in s, and channels with their largest magnitude in V.
    for (name, n, start, step, extremes) in [
        ("DS1074Z-A.csv", 1200, -2e-3, 20e-6, &[("CH1", 0.1), ("CH2", 1.1), ("CH3", -1.02)][..]),
        ("DS2072A-7.csv", 1400, -3.5e-3, 5e-6, &[("CH2", 0.32)]),
        ("DS1102E-B.csv", 600, -6e-6, 20e-9, &[("CH1", 4.48)]),
        ("DS1102D-A.csv", 1024, -4.688e-3, 10.0098e-6, &[("CH 1", 8.08), ("CH 2", 8.4)]),
    ] {
        let found = read(&folder, name);
        let traces = traces(&found);
        assert_eq!(traces.len(), extremes.len(), "{name}");
        for (trace, (channel, extreme)) in traces.iter().zip(extremes) {
            assert_eq!((trace.meta.name.as_str(), trace.values.len()), (*channel, n), "{name}");
            assert_eq!(trace.meta.unit.symbol(), "V");
            // One file prints its first time from single precision.
            assert!(
                close(trace.axis.start(), start, 1e-7) && close(trace.axis.step().unwrap(), step, 1e-5),
                "{name}"
            );
            let largest =
                trace.values.iter().fold(0.0f64, |max, v| if v.abs() > max.abs() { *v } else { max });
            let reached = trace.values.iter().any(|v| close(*v, *extreme, 1e-9));
            assert!(reached && (largest.abs() - extreme.abs()).abs() < 0.03, "{name} {channel}: {largest}");
        }
    }
}

#[test]
fn labview() {
    let Some(folder) = folder("lvm") else { return };
    let short = read(&folder, "short.lvm");
    let dt = Some(3.90625e-5);
    assert_eq!(shape(&short), [("Excitation (Trigger)", 10, 0.0, dt), ("Response (Trigger)", 10, 0.0, dt)]);
    let firsts: Vec<f64> = traces(&short).iter().map(|t| t.values[0]).collect();
    assert_eq!(firsts, [0.914018, 1.204792]);
    assert_eq!(traces(&short).iter().map(|t| t.meta.unit.symbol()).collect::<Vec<_>>(), ["N", "m/s²"]);

    let multi = read(&folder, "multi_time_column.lvm");
    let [voltage, acceleration] = traces(&multi)[..] else { panic!() };
    assert_eq!(
        (voltage.axis.step(), voltage.values[0], voltage.meta.unit.symbol()),
        (Some(1.953125e-5), -0.035229, "V")
    );
    assert!(close(acceleration.values[0], 0.532608 * G, 1e-12));
    let short_of = voltage.meta.findings.iter().find(|f| f.code == "fewer-values").expect("a finding");
    assert_eq!(
        (short_of.get("declared"), short_of.get("n")),
        (Some(51_200.0), Some(voltage.values.len() as f64))
    );

    let plain = read(&folder, "no_decimal_separator.lvm");
    let dt = Some(2.5e-4);
    assert_eq!(shape(&plain), [("ax", 4, 0.0, dt), ("ay", 4, 0.0, dt), ("az", 4, 0.0, dt)]);
    assert!(close(traces(&plain)[0].values[3], 0.059248 * G, 1e-12));

    let comments = read(&folder, "with_comments.lvm");
    assert_eq!(
        shape(&comments).iter().map(|(_, n, _, step)| (*n, *step)).collect::<Vec<_>>(),
        [(9, None); 3]
    );
    let notes = &traces(&comments)[0].meta.notes;
    assert!(notes.contains(&("Comment".into(), "row 1: LOST COMMUNICATION".into())));
    assert_eq!(traces(&comments)[0].axis.at(8), 9.723275);

    let empty = read(&folder, "with_empty_fields.lvm");
    assert_eq!(
        shape(&empty).iter().map(|(name, _, _, step)| (*name, *step)).collect::<Vec<_>>(),
        [("Dev0/Ai0", Some(1e-3)), ("Dev0/Ai2", Some(1e-3)), ("Dev0/Ai0 1", Some(1e-3))]
    );
    assert_eq!(empty.findings.iter().filter(|f| f.code == "variable-empty").count(), 4);
}

#[test]
fn one_series_five_to_a_line() {
    let Some(folder) = folder("at2") else { return };
    let name = "RSN4863_CHUETSU_65036NS.AT2";
    let found = read(&folder, name);
    let [trace] = traces(&found)[..] else { panic!() };
    assert_eq!((trace.values.len(), trace.axis.step()), (6000, Some(0.01)));
    let least = trace.values.iter().copied().fold(f64::INFINITY, f64::min);
    let most = trace.values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    assert!(close(least, -0.2856169 * G, 1e-12) && close(most, 0.27492 * G, 1e-12), "{least} {most}");
    // Without its header the file does not show what its columns are, so the reader asks.
    let text = std::fs::read_to_string(folder.join(name)).unwrap();
    let rows = text.lines().skip(4).collect::<Vec<_>>().join("\n");
    let plain = || Reader::new().rate(Some(100.0));
    let Err(said) = plain().from_reader("x.txt", rows.as_bytes()) else {
        panic!("five channels are guessed")
    };
    assert!(said.settings().eq(["wrapped", "columns"]), "{said}");
    let one = plain().wrapped(Some(true)).from_reader("x.txt", rows.as_bytes()).unwrap();
    assert_eq!(traces(&one)[0].values.len(), 6000);
    let five = plain().wrapped(Some(false)).from_reader("x.txt", rows.as_bytes()).unwrap();
    assert_eq!(five.records.len(), 5);
}

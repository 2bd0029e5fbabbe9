//! A sampling rate or base band that the user states although the file has a column of times or
//! frequencies.

use super::sentences;
use std::fmt::Write as _;
use vibroimpact::read::{Reader, Recording};

fn table(rows: usize, name: &str, value: impl Fn(f64) -> f64) -> String {
    let mut text = format!("{name},v [m/s]\n");
    for i in 0..rows {
        let _ = writeln!(text, "{:.9},1.5", value(i as f64));
    }
    text
}

fn read(reader: &Reader, text: &str) -> Result<Recording, String> {
    reader.from_reader("x.csv", text.as_bytes()).map_err(|e| e.to_string())
}

/// The value that the column gives, rounded to 0.001, and the stated value that it replaces.
fn refined(recording: &Recording) -> Option<(f64, f64)> {
    let found = recording.all_findings().into_iter().find(|f| f.code == "column-refines")?;
    Some(((found.get("holds")? * 1e3).round() / 1e3, found.get("stated")?))
}

#[test]
fn a_rounded_rate_leaves_a_long_column_as_it_is() {
    const RATE: f64 = 8192.0 / 3.0;
    let text = table(20_000, "t [s]", |i| i / RATE);
    let recording = read(&Reader::new().rate(Some(2730.67)), &text).unwrap();
    let step = recording.records[0].axis().step().unwrap();
    // Both ends are printed to half a nanosecond.
    assert!((step - 1.0 / RATE).abs() <= 1e-9 / 19_999.0, "{step}");
    assert_eq!(refined(&recording), Some((2730.667, 2730.67)));
    // The stated rate is too far off: the message prints both steps up to the first digit that differs.
    let error = read(&Reader::new().rate(Some(2731.0)), &text).unwrap_err();
    assert!(error.contains("steps of 0.000366211 s") && error.contains("steps of 0.000366166 s"), "{error}");
}

#[test]
fn lines_of_a_plain_transform_go_with_their_base_band() {
    let text = table(400, "f [Hz]", |i| 0.05 * i);
    let recording = read(&Reader::new().base_band(Some(20.0)), &text).unwrap();
    assert!((recording.records[0].axis().step().unwrap() - 0.05).abs() < 1e-11);
    assert!(
        !sentences(&recording.all_findings()).iter().any(|d| d.contains("stated")),
        "{:?}",
        sentences(&recording.all_findings())
    );
    let nearly = read(&Reader::new().base_band(Some(20.001)), &text).unwrap();
    assert_eq!(refined(&nearly), Some((20.0, 20.001)));
    assert!(read(&Reader::new().base_band(Some(20.1)), &text).is_err());
}

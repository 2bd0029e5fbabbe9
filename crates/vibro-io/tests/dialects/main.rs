//! Text exports of instruments and programs, generated from public descriptions of their layouts. Each is
//! read correctly, or refused with one setting or edit that makes it readable. The test compares the list
//! with `docs/formats.md`.
//!
//! All exports hold the same signals: closed forms that differ from each other, have both signs, and peak
//! at a known place.

mod loggers;
mod programs;
mod scopes;
mod seismic;
mod signal;
mod vibration;

use signal::{DX, N, value};
use vibro_io::{Reader, Recording};
use vibro_record::{AxisKind, Record};

/// A layout of one instrument or program.
struct Dialect {
    /// Instrument or program.
    of: &'static str,
    oddity: &'static str,
    /// Name of the file; its ending is part of the test.
    file: &'static str,
    text: fn() -> Vec<u8>,
    outcome: Outcome,
}

enum Outcome {
    Read(Right),
    Refused(Refusal),
}

/// The expected error, and the setting or edit after which the export is read correctly.
struct Refusal {
    /// Words of the error message.
    words: &'static [&'static str],
    /// The option as the user types it.
    option: &'static str,
    state: fn(Reader) -> Reader,
    /// Edit of the text, if no setting is enough.
    edit: fn(String) -> String,
    right: Right,
}

/// The expected reading.
struct Right {
    channels: &'static [Channel],
    x: X,
    /// Codes of the expected findings.
    findings: &'static [&'static str],
}

struct Channel {
    name: &'static str,
    /// SI symbol; empty if the file states no unit.
    unit: &'static str,
    /// Number of the signal, see [`value`].
    signal: usize,
    /// Factor from the signal to SI.
    factor: f64,
    /// Half a unit in the last printed digit, in units of the signal.
    digits: f64,
}

enum X {
    /// Time from a start in s, with the step of the signals.
    Even(f64),
    /// Time from 0, with this step in s.
    Steps(f64),
    /// Spectral lines, this far apart in Hz.
    Lines(f64),
    /// From 0 with the step of the signals, of an unknown kind.
    Unsaid,
    /// The abscissa is the index of the value.
    Numbered,
    /// Time in two segments, each from this start in s with the step of the signals.
    Segments(f64),
}

const fn ch(name: &'static str, unit: &'static str, signal: usize, factor: f64, digits: f64) -> Channel {
    Channel { name, unit, signal, factor, digits }
}

const fn read(channels: &'static [Channel], x: X, findings: &'static [&'static str]) -> Outcome {
    Outcome::Read(Right { channels, x, findings })
}

fn all() -> Vec<&'static Dialect> {
    [scopes::ALL, loggers::ALL, vibration::ALL, programs::ALL, seismic::ALL].into_iter().flatten().collect()
}

/// Differences between a reading and the expected one.
fn faults(found: &Recording, right: &Right) -> Vec<String> {
    let mut faults = Vec::new();
    let names: Vec<&str> = found.records.iter().map(|r| r.meta().name.as_str()).collect();
    if found.records.len() != right.channels.len() {
        return vec![format!(
            "{} records {names:?} in place of {}",
            found.records.len(),
            right.channels.len()
        )];
    }
    for (record, channel) in found.records.iter().zip(right.channels) {
        let (meta, axis) = (record.meta(), record.axis());
        if (meta.name.as_str(), meta.unit.symbol()) != (channel.name, channel.unit) {
            faults.push(format!(
                "{:?} in {:?}, not {:?} in {:?}",
                meta.name,
                meta.unit.symbol(),
                channel.name,
                channel.unit
            ));
        }
        let values: &[f64] = match record {
            Record::Trace(trace) => &trace.values,
            Record::Spectrum(spectrum) => match &spectrum.values {
                vibro_record::Values::Real(values) => values,
                vibro_record::Values::Complex(_) => &[],
            },
            Record::Frf(_) => &[],
        };
        if values.len() != N {
            faults.push(format!("{} values of {:?}", values.len(), meta.name));
            continue;
        }
        let right_value = |i: usize| value(channel.signal, i) * channel.factor;
        let off = |i: &usize| {
            // A missing value (NaN) is not compared.
            (values[*i] - right_value(*i)).abs() > channel.digits * channel.factor.abs() * (1.0 + 1e-9)
        };
        if let Some(i) = (0..N).find(off) {
            faults.push(format!("value {i} of {:?} is {}, not {}", meta.name, values[i], right_value(i)));
        }
        let (kind, start, step) = match &right.x {
            X::Even(start) | X::Segments(start) => (AxisKind::Time, *start, DX),
            X::Steps(step) => (AxisKind::Time, 0.0, *step),
            X::Lines(step) => (AxisKind::Frequency, 0.0, *step),
            X::Unsaid => (AxisKind::Other("first column".to_owned()), 0.0, DX),
            X::Numbered => (AxisKind::Index, 0.0, 1.0),
        };
        let segments = matches!(right.x, X::Segments(_));
        let instant = |i: usize| start + step * (if segments { i % (N / 2) } else { i }) as f64;
        // Instants are printed to at least a hundredth of a step.
        let off = |i: &usize| (axis.at(*i) - instant(*i)).abs() > 0.01 * step;
        if axis.kind != kind || axis.step().is_some() == segments {
            faults.push(format!(
                "axis {:?} in steps of {:?}, not {kind:?} of {step}",
                axis.kind,
                axis.step()
            ));
        } else if let Some(i) = (0..N).find(off) {
            faults.push(format!("instant {i} is {}, not {}", axis.at(i), instant(i)));
        }
    }
    let all = found.all_findings();
    let codes: Vec<&str> = all.iter().map(|f| f.code.as_ref()).collect();
    faults.extend(
        right.findings.iter().filter(|c| !codes.contains(c)).map(|c| format!("no finding {c} in {codes:?}")),
    );
    // No findings other than the expected ones: a needless caution teaches users to ignore cautions.
    let known = |code: &&&str| !right.findings.contains(code);
    let more: Vec<&&str> = codes.iter().filter(known).collect();
    if !more.is_empty() {
        faults.push(format!("findings {more:?} too many"));
    }
    faults
}

/// Faults in how a dialect is read.
fn wrong(dialect: &Dialect) -> Vec<String> {
    let text = (dialect.text)();
    let with = |reader: Reader| reader.from_reader(dialect.file, text.as_slice());
    match (&dialect.outcome, with(Reader::new())) {
        (Outcome::Read(right), Ok(found)) => faults(&found, right),
        (Outcome::Read(_), Err(why)) => vec![format!("refused: {why}")],
        (Outcome::Refused(_), Ok(found)) => {
            let names: Vec<&str> = found.records.iter().map(|r| r.meta().name.as_str()).collect();
            vec![format!("read as {names:?}")]
        }
        (Outcome::Refused(refusal), Err(why)) => {
            let why = why.to_string();
            let unsaid = refusal.words.iter().filter(|word| !why.contains(**word));
            let mut wrong: Vec<String> =
                unsaid.map(|word| format!("{why:?} does not say {word:?}")).collect();
            let edited = match String::from_utf8(text.clone()) {
                Ok(text) => (refusal.edit)(text).into_bytes(),
                Err(_) => text.clone(),
            };
            match (refusal.state)(Reader::new()).from_reader(dialect.file, edited.as_slice()) {
                Ok(found) => wrong.extend(faults(&found, &refusal.right)),
                Err(why) => wrong.push(format!("refused with {} too: {why}", refusal.option)),
            }
            wrong
        }
    }
}

#[test]
fn each_is_read_right_or_refused_with_what_reads_it() {
    let mut wrong_ones = Vec::new();
    for dialect in all() {
        for fault in wrong(dialect) {
            wrong_ones.push(format!("{} ({}): {fault}", dialect.of, dialect.oddity));
        }
    }
    assert!(wrong_ones.is_empty(), "{} faults:\n{}", wrong_ones.len(), wrong_ones.join("\n"));
}

#[test]
fn there_are_as_many_as_promised_and_no_two_alike() {
    let all = all();
    let distinct: std::collections::HashSet<Vec<u8>> = all.iter().map(|d| (d.text)()).collect();
    assert!(all.len() >= 45, "{}", all.len());
    assert_eq!(distinct.len(), all.len());
}

/// Changes that an editor or another system may make do not change the reading.
#[test]
fn line_ends_marks_and_blank_lines_behind_change_nothing() {
    let mut wrong_ones = Vec::new();
    for dialect in all() {
        let Outcome::Read(right) = &dialect.outcome else { continue };
        let Ok(text) = String::from_utf8((dialect.text)()) else { continue };
        if text.contains('\r') || text.starts_with('\u{feff}') {
            continue;
        }
        for (how, changed) in [
            ("CR LF", text.replace('\n', "\r\n")),
            ("CR", text.replace('\n', "\r")),
            ("byte order mark", format!("\u{feff}{text}")),
            ("blank lines behind", format!("{text}\n\n")),
            ("no last line end", text.trim_end_matches('\n').to_owned()),
            ("blanks behind", text.replace('\n', "  \n")),
        ] {
            let said = match Reader::new().from_reader(dialect.file, changed.as_bytes()) {
                Ok(found) => faults(&found, right),
                Err(why) => vec![why.to_string()],
            };
            wrong_ones.extend(said.into_iter().map(|fault| format!("{} with {how}: {fault}", dialect.of)));
        }
    }
    assert!(wrong_ones.is_empty(), "{} faults:\n{}", wrong_ones.len(), wrong_ones.join("\n"));
}

/// The table of text exports in `docs/formats.md`, row for row.
#[test]
fn the_table_of_the_documents_is_this_list() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/formats.md");
    let text = std::fs::read_to_string(path).unwrap_or_default();
    let exports = text.split_once("\n## Text exports").map_or("", |(_, exports)| exports);
    let stands: Vec<&str> = exports.lines().filter(|line| line.starts_with("| ")).skip(1).collect();
    let row = |dialect: &Dialect| {
        let said = match &dialect.outcome {
            Outcome::Read(right) if right.findings.is_empty() => "read".to_owned(),
            Outcome::Read(right) => {
                let codes: Vec<String> = right.findings.iter().map(|code| format!("`{code}`")).collect();
                format!("read, says {}", codes.join(", "))
            }
            Outcome::Refused(refusal) => format!("refused: {}", refusal.option),
        };
        format!("| {} | {} | {said} |", dialect.of, dialect.oddity)
    };
    let rows: Vec<String> = all().into_iter().map(row).collect();
    assert_eq!(stands, rows, "the table should be:\n{}", rows.join("\n"));
}

/// A truncated or garbled export gives a reading or an error, never a panic.
#[test]
fn none_makes_the_reader_panic_when_it_is_cut_off() {
    for dialect in all() {
        let text = (dialect.text)();
        for at in (1..text.len()).step_by(text.len() / 11 + 1) {
            let _ = Reader::new().from_reader(dialect.file, &text[..at]);
            let mut garbled = text.clone();
            garbled[at] = b':';
            let _ = Reader::new().allow_missing(true).from_reader(dialect.file, garbled.as_slice());
        }
    }
}

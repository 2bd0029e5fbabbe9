//! `vibro info`: what is in a file.

use super::{CommandArgs, complain, print, stdout};
use crate::analysis::{Answer, file_name};
use crate::campaign::Reading;
use crate::error::Result;
use crate::read::{Folder, Header};
use crate::record::{Finding, shown};
use crate::report::words::{Voice, graded, put};
use serde_json::json;
use std::fmt::Write as _;
use std::path::PathBuf;

#[derive(Debug, clap::Args)]
pub struct Info {
    /// Measurement files
    #[arg(index = 1, required = true)]
    files: Vec<PathBuf>,
    #[command(flatten)]
    reading: Reading,
}

/// Number of notes of a file that are printed.
const NOTES: usize = 8;
/// Number of characters that are printed of a note.
const NOTE_LENGTH: usize = 90;

impl CommandArgs for Info {
    /// Lists each file and reports those that cannot be read; returns the exit code of the first failure.
    fn run(&self, json: bool) -> Result<u8> {
        let (within, reader) = (Folder::default(), self.reading.reader()?);
        let (mut files, mut errors, mut about) = (Vec::new(), Vec::new(), Vec::new());
        let (mut text, mut code) = (String::new(), 0);
        for path in &self.files {
            let surveyed = print::busy(json, "reading", |_| reader.survey(path));
            let (format, records, mut findings) = match surveyed {
                Ok(found) => found,
                // One unreadable file does not stop the list.
                Err(error) => {
                    let failed = complain::error(&error, Voice::Command, false);
                    code = if code == 0 { failed } else { code };
                    errors.push(error.to_string());
                    continue;
                }
            };
            let of_records: Vec<_> =
                records.iter().map(|r| (r.name.as_str(), r.findings.as_slice())).collect();
            findings.extend(Finding::gathered(&of_records));
            let (from, shown_path) = (path.as_path(), shown(path));
            let path = path.display().to_string();
            let file = if self.files.len() > 1 { path.as_str() } else { "" };
            about.extend(findings.into_iter().map(|finding| (file.to_owned(), finding)));
            let held =
                within.part(from).map_or_else(String::new, |(file, _)| format!(" in {}", file_name(file)));
            let _ = writeln!(text, "{shown_path} ({}{held})", format.name());
            for record in &records {
                line(&mut text, record);
            }
            notes(&mut text, records.first().map_or(&[], |r| &r.notes));
            files.push(json!({ "path": path, "format": format.name(), "records": records }));
        }
        if json {
            let mut answer = Answer::of(&json!({ "files": files, "errors": errors }))?;
            put(&mut answer.result, &about, Voice::Command);
            stdout::object(answer.result)?;
        } else {
            complain::warn(&graded(&about, Voice::Command), "--json");
            stdout::text(&text)?;
        }
        Ok(code)
    }
}

fn line(text: &mut String, r: &Header) {
    let n = match r.declared_n {
        Some(declared) if declared != r.n => format!("{} of {declared}", r.n),
        _ => r.n.to_string(),
    };
    let axis = r.x_unit;
    let step = match r.dx {
        Some(dx) if axis == "s" => {
            format!("{}, {}", known(1.0 / dx, "Hz"), known(dx * r.n as f64, "s"))
        }
        Some(dx) => format!("step {}", known(dx, axis)),
        None => "uneven steps".to_owned(),
    };
    let max = match (r.max_abs.zip(r.max_at), r.min.zip(r.max)) {
        (Some((_, at)), Some((min, max))) => {
            format!("{} to {}, largest at {}", known(min, ""), known(max, &r.unit), known(at, axis))
        }
        (Some((max, at)), None) => format!("max {} at {}", known(max, &r.unit), known(at, axis)),
        _ => "max not known".to_owned(),
    };
    let complex = if r.complex { "complex " } else { "" };
    let name = if r.name.is_empty() { "(no name)" } else { &r.name };
    let what = match (r.quantity, r.unit.as_str()) {
        ("other", "") => ", unit not known".to_owned(),
        ("other", unit) => format!(" in {unit}"),
        (quantity, unit) => format!(" of {quantity} [{unit}]"),
    };
    let (kind, start) = (r.kind, known(r.x0, axis));
    let _ = writeln!(text, "  {name}: {complex}{kind}{what}, {n} values from {start}, {step}, {max}");
}

/// A number with six significant digits and its unit.
fn known(value: f64, unit: &str) -> String {
    let six = format!("{value:.5e}");
    let digits: f64 = six.parse().unwrap_or(value);
    let plain = digits == 0.0 || (1e-7..1e12).contains(&digits.abs());
    let text = if plain { digits.to_string() } else { format!("{digits:e}") };
    format!("{text} {unit}").trim_end().to_owned()
}

fn notes(text: &mut String, notes: &[String]) {
    let shown = notes.iter().take(NOTES).map(|note| {
        let long = note.chars().count() > NOTE_LENGTH;
        if long { note.chars().take(NOTE_LENGTH - 1).chain(['…']).collect() } else { note.clone() }
    });
    let mut shown: Vec<String> = shown.collect();
    if notes.len() > NOTES {
        shown.push(format!("and {} more (--json)", notes.len() - NOTES));
    }
    if !shown.is_empty() {
        let _ = writeln!(text, "  notes: {}", shown.join(" | "));
    }
}

//! `vibro info`: what is in a file.

use super::{args, complain, print};
use crate::error::Result;
use crate::read::Header;
use crate::record::Finding;
use crate::report::words::{Voice, told, with_record};
use serde::Serialize;
use std::fmt::Write as _;

#[derive(Serialize)]
struct Answer {
    files: Vec<File>,
    /// Complaints about files that could not be listed.
    errors: Vec<String>,
    findings: Vec<Finding>,
}

#[derive(Serialize)]
struct File {
    path: String,
    format: &'static str,
    records: Vec<Header>,
}

/// Lists what can be listed and complains of the rest; gives the exit code of the first failure.
pub fn run(typed: &args::Info, json: bool) -> Result<u8> {
    let reader = typed.reading.reader()?;
    let mut answer = Answer { files: Vec::new(), errors: Vec::new(), findings: Vec::new() };
    let mut about = Vec::new();
    let mut code = 0;
    for path in &typed.files {
        let (format, records, mut findings) = match reader.survey(path) {
            Ok(found) => found,
            // The other files are still worth listing; the first failure decides the exit code.
            Err(error) => {
                let failed = complain::error(&error, Voice::Command, false);
                code = if code == 0 { failed } else { code };
                answer.errors.push(error.to_string());
                continue;
            }
        };
        let of_records: Vec<_> = records.iter().map(|r| (r.name.as_str(), r.findings.as_slice())).collect();
        findings.extend(Finding::gathered(&of_records));
        let file = if typed.files.len() > 1 { path.display().to_string() } else { String::new() };
        about.extend(findings.into_iter().map(|finding| (file.clone(), finding)));
        answer.files.push(File { path: path.display().to_string(), format: format.name(), records });
    }
    if json {
        answer.findings = about.into_iter().map(with_record).collect();
        print::json(&answer)?;
    } else {
        complain::warn(&told(&about, Voice::Command, true));
        print::text(&table(&answer.files))?;
    }
    Ok(code)
}

fn table(files: &[File]) -> String {
    let mut text = String::new();
    for file in files {
        let _ = writeln!(text, "{} ({})", file.path, file.format);
        for r in &file.records {
            let n = match r.declared_n {
                Some(declared) if declared != r.n => format!("{} of {declared}", r.n),
                _ => r.n.to_string(),
            };
            let step = r.dx.map_or_else(|| "uneven".to_owned(), |dx| format!("step {}", short(dx)));
            let max = match (r.max_abs, r.max_at) {
                (Some(max), Some(at)) => format!("max {} at {}", short(max), short(at)),
                _ => "max not known".to_owned(),
            };
            let complex = if r.complex { "complex " } else { "" };
            let name = if r.name.is_empty() { "(no name)" } else { &r.name };
            let what = match (r.quantity, r.unit.as_str()) {
                ("other", "") => ", unit not known".to_owned(),
                ("other", unit) => format!(" in {unit}"),
                (quantity, unit) => format!(" of {quantity} [{unit}]"),
            };
            // What a universal file calls itself; the name is made of its points.
            let title = r.notes.iter().find_map(|n| n.strip_prefix("id line 1: ")).filter(|t| *t != name);
            let title = title.map_or_else(String::new, |t| format!(" ({t})"));
            let _ = writeln!(
                text,
                "  {name}{title}: {complex}{}{what}, {n} values from {}, {step}, {max}",
                r.kind,
                short(r.x0)
            );
        }
        let notes: Vec<&String> =
            file.records.first().map_or(&[][..], |r| &r.notes).iter().filter(|n| !shown_before(n)).collect();
        if !notes.is_empty() {
            let shown: Vec<String> = notes.iter().take(NOTES).map(|n| shortened(n)).collect();
            let more = notes.len().saturating_sub(NOTES);
            let more = if more > 0 { format!(" | and {more} more (--json)") } else { String::new() };
            let _ = writeln!(text, "  notes: {}{more}", shown.join(" | "));
        }
    }
    text
}

/// Whether a note of a universal file stands in the line of its record: title, point, function.
fn shown_before(note: &str) -> bool {
    ["id line 1: ", "record 6: ", "point: "].iter().any(|key| note.starts_with(key))
}

/// A note, or the beginning of a long one: a line of a universal file with its key stands whole.
fn shortened(note: &str) -> String {
    if note.chars().count() <= WIDE {
        return note.to_owned();
    }
    note.chars().take(WIDE - 1).chain(['…']).collect()
}

/// Characters of a note that a table shows.
const WIDE: usize = 100;

/// Notes of a file that a table shows.
const NOTES: usize = 4;

/// Twelve digits: what is behind them is rounding.
fn short(value: f64) -> f64 {
    format!("{value:.11e}").parse().unwrap_or(value)
}

//! `vibro info`: what is in a file.

use super::{args, complain, print, settings};
use crate::error::Result;
use crate::read::Header;
use serde::Serialize;
use std::fmt::Write as _;

#[derive(Serialize)]
struct Answer {
    files: Vec<File>,
    /// Complaints about files that could not be listed.
    errors: Vec<String>,
    warnings: Vec<String>,
}

#[derive(Serialize)]
struct File {
    path: String,
    format: &'static str,
    records: Vec<Header>,
}

/// Lists what can be listed and complains of the rest; gives the exit code of the first failure.
pub fn run(typed: &args::Info, json: bool) -> Result<u8> {
    let reader = settings::reader(&typed.reading)?;
    let mut answer = Answer { files: Vec::new(), errors: Vec::new(), warnings: Vec::new() };
    let mut code = 0;
    for path in &typed.files {
        let (format, records, doubts) = match reader.survey(path) {
            Ok(found) => found,
            // The other files are still worth listing; the first failure decides the exit code.
            Err(error) => {
                let failed = complain::error(&error, false);
                code = if code == 0 { failed } else { code };
                answer.errors.push(error.to_string());
                continue;
            }
        };
        let about =
            |d: &String| if typed.files.len() > 1 { format!("{}: {d}", path.display()) } else { d.clone() };
        answer.warnings.extend(doubts.iter().map(about));
        for record in &records {
            for doubt in &record.doubts {
                let named =
                    if records.len() > 1 { format!("{}: {doubt}", record.name) } else { doubt.clone() };
                answer.warnings.push(about(&named));
            }
        }
        answer.files.push(File { path: path.display().to_string(), format: format.name(), records });
    }
    if json {
        print::json(&answer)?;
    } else {
        complain::warn(&answer.warnings);
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
            let step = r.dx.map_or_else(|| "uneven".to_owned(), |dx| format!("step {dx}"));
            let max = match (r.max_abs, r.max_at) {
                (Some(max), Some(at)) => format!("max {max} at {at}"),
                _ => "max not known".to_owned(),
            };
            let complex = if r.complex { "complex " } else { "" };
            let name = if r.name.is_empty() { "(no name)" } else { &r.name };
            let _ = writeln!(
                text,
                "  {name}: {complex}{} of {} [{}], {n} values from {}, {step}, {max}",
                r.kind, r.quantity, r.unit, r.x0
            );
        }
    }
    text
}

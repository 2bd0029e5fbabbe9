//! `vibro run`: all that a campaign asks for.

use super::{args, complain, print, progress};
use crate::campaign::Campaign;
use crate::error::Result;
use crate::report::Output;
use crate::report::job::{self, JobOptions, Results};
use crate::report::tables;
use serde::Serialize;
use std::fmt::Write as _;

#[derive(Serialize)]
struct Answer {
    results: Results,
    files: Vec<String>,
    folder: String,
    warnings: Vec<String>,
}

/// Gives the exit code: 1 where nothing that was asked for could be answered.
pub fn run(typed: &args::Run, json: bool) -> Result<u8> {
    let campaign = Campaign::from_path(&typed.campaign)?;
    let folder = typed.out.clone().unwrap_or_else(|| campaign.out());
    let options = JobOptions { allow_outside: typed.allow_outside };
    let mut output = Output::new(&folder)?;
    let results = job::run(&campaign, options, &mut output, &progress::bar(json))?;
    let files = output.written().to_vec();
    let warnings = results.warnings.clone();
    let code = u8::from(results.is_empty() && !campaign.is_empty());
    if json {
        print::json(&Answer { results, files, folder: folder.display().to_string(), warnings })?;
        return Ok(code);
    }
    complain::warn(&warnings);
    let mut text = String::new();
    for table in tables::summary(&results) {
        let _ = writeln!(text, "{}", table.text());
    }
    let _ = writeln!(text, "{} files in {}; open report.html there", files.len(), folder.display());
    print::text(&text)?;
    Ok(code)
}

//! `vibro run`: all that a campaign asks for.

use super::{args, complain, print, progress};
use crate::analysis::{self, JobOptions, Outcome};
use crate::error::Result;
use crate::report::Output;
use crate::report::words::{Voice, told};
use std::fmt::Write as _;

/// Gives the exit code: 1 where nothing that was asked for could be answered.
pub fn run(typed: &args::Run, json: bool) -> Result<u8> {
    let campaign = analysis::open(&typed.campaign)?;
    let folder = typed.out.clone().unwrap_or_else(|| campaign.out());
    let options = JobOptions { allow_outside: typed.allow_outside };
    let mut output = Output::set(&folder)?;
    let Outcome { results, findings, tables, answered } =
        analysis::run(&campaign, options, &mut output, &progress::bar(json))?;
    output.commit()?;
    let files = output.written();
    let code = u8::from(!answered && !campaign.is_empty());
    if json {
        let warnings = results["warnings"].clone();
        let answer = serde_json::json!({
            "results": results, "files": files, "folder": folder.display().to_string(), "warnings": warnings
        });
        print::object(&answer)?;
        return Ok(code);
    }
    complain::warn(&told(&findings, Voice::Campaign, true));
    let mut text = String::new();
    for table in tables {
        let _ = writeln!(text, "{}", table.text());
    }
    let _ = writeln!(text, "{} files in {}; open report.html there", files.len(), folder.display());
    print::text(&text)?;
    Ok(code)
}

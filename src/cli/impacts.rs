//! `vibro impacts`: the job of timeav.

use super::{args, complain, print};
use crate::analysis::impacts::Keys;
use crate::error::{Error, Result};
use crate::measure::{Estimate, legacy};
use crate::record::Trace;
use serde::Serialize;
use std::fmt::Write as _;
use std::path::PathBuf;

#[derive(Debug, clap::Args)]
pub struct Impacts {
    /// File with a contact trace, or any signal that jumps at each impact
    file: PathBuf,
    /// Print what the thesis' script timeav printed, mistakes included
    #[arg(long)]
    legacy: bool,
    #[command(flatten)]
    keys: Keys,
    #[command(flatten)]
    record: args::Record,
}

/// What the script printed: a mean and the times. It knew nothing of the rest.
#[derive(Serialize)]
struct Legacy {
    n: usize,
    maxima: usize,
    interval: Estimate,
    frequency: Estimate,
    median_interval: Option<f64>,
    spread: Option<f64>,
    missed: Option<usize>,
    doubled: Option<usize>,
    per_cycle: Option<()>,
    regular: Option<bool>,
    times: Vec<f64>,
    warnings: Vec<String>,
}

pub fn run(typed: &Impacts, json: bool) -> Result<()> {
    if typed.legacy && typed.record.out.is_some() {
        return Err(Error::usage(
            "--legacy prints what the script printed, it draws nothing",
            "--legacy or --out",
        ));
    }
    if typed.legacy {
        let trace = typed.record.measured(&typed.file, json, |source| source.trace(&source.recording()?))?;
        return legacy(&trace, json);
    }
    let found = typed.record.measured(&typed.file, json, |source| typed.keys.measure(source));
    let answer = found.map_err(|e| e.of_record(&typed.file.display().to_string()))?;
    let note = "times: --json, or impacts.csv with --out";
    print::answer(answer, typed.record.out.as_deref(), &[], note, json)
}

fn legacy(trace: &Trace, json: bool) -> Result<()> {
    let found = legacy::contact_times(trace)?;
    let mut warnings = vec!["These are the answers of the script timeav, mistakes included.".to_owned()];
    let n = found.times.len();
    if n == 1 {
        warnings.push("timeav kept one peak, and its mean interval was 0/0.".to_owned());
    }
    if json {
        let method = "(last − first)/(peaks − 1), as timeav";
        return print::json(&Legacy {
            n,
            maxima: found.maxima,
            interval: Estimate::new(found.interval, None, "s", n, method),
            frequency: Estimate::new(found.frequency, None, "Hz", n, method),
            median_interval: None,
            spread: None,
            missed: None,
            doubled: None,
            per_cycle: None,
            regular: None,
            times: found.times,
            warnings,
        });
    }
    complain::warn(&warnings);
    let mut text = format!(
        "maxp={} maxpeak={n} diffav={} diffreq={}\npeakt=",
        found.maxima, found.interval, found.frequency
    );
    for t in found.times {
        let _ = write!(text, " {t:.6}");
    }
    print::text(&(text + "\n"))
}

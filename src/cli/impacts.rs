//! `vibro impacts`: the job of timeav.

use super::{args, complain, print, settings};
use crate::error::{Error, Result};
use crate::measure::impacts::{Impacts, ImpactsOptions, Scatter, Shape, impacts};
use crate::measure::{Estimate, legacy};
use crate::read::Reader;
use crate::record::Trace;
use crate::report::words::{self, Voice};
use crate::report::{Output, files, pictures, tables};
use serde::Serialize;
use std::fmt::Write as _;

#[derive(Serialize)]
struct Answer {
    #[serde(flatten)]
    impacts: Impacts,
    files: Vec<String>,
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

pub fn run(typed: &args::Impacts, json: bool) -> Result<()> {
    let recording = settings::time_reader(&typed.reading)?.from_path(&typed.file)?;
    let trace = recording.trace(typed.channel.channel.as_deref(), typed.channel.calibration)?;
    if typed.legacy {
        if typed.out.is_some() {
            return Err(Error::usage(
                "--legacy prints what the script printed, it draws nothing",
                "--legacy or --out",
            ));
        }
        return legacy(&trace, json);
    }
    let reference = match &typed.reference {
        Some(name) => Some(recording.trace(Some(name), None)?.values),
        None => None,
    };
    let shape = match &typed.shape {
        Some(file) => {
            settings::above_zero("--shape-rate", typed.shape_rate)?;
            let pulse = Reader::new().rate(typed.shape_rate).from_path(file)?.trace(None, None)?;
            Some(Shape::of(&pulse, &trace)?)
        }
        None => None,
    };
    let options = ImpactsOptions {
        excitation: typed.excitation.map(|f| f.value),
        excitation_std: typed.excitation_std.or(typed.excitation.map(|f| f.std)),
        complete: typed.none_missed,
        reference,
        shape,
        scatter: match typed.scatter {
            args::Scatter::Onsets => Scatter::Onsets,
            args::Scatter::Intervals => Scatter::Intervals,
            args::Scatter::Unknown => Scatter::Unknown,
        },
        ..settings::finding(&typed.finding, None)
    };
    let mut found = impacts(&trace, &options).map_err(|e| e.of_record(&typed.file.display().to_string()))?;
    let findings = [recording.findings.as_slice(), &trace.meta.findings].concat();
    found.warnings.extend(words::sentences(&findings, Voice::Command));
    let mut written = Vec::new();
    if let Some(folder) = &typed.out {
        let mut output = Output::new(folder)?;
        let figure = pictures::impacts(&trace.meta.name, &trace, &found);
        files::figures(&mut output, &[("impacts".to_owned(), figure)], &|| ())?;
        output.write("impacts.csv", tables::impact_times(&found).csv())?;
        written = output.written().to_vec();
    }
    if json {
        return print::json(&Answer { impacts: found, files: written });
    }
    complain::warn(&found.warnings);
    let mut text = tables::impacts(&[(String::new(), &found)]).text();
    let _ = writeln!(text, "\n{}\ntimes: --json, or impacts.csv with --out", found.interval.method);
    for file in written {
        let _ = writeln!(text, "wrote {file}");
    }
    print::text(&text)
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

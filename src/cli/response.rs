//! `vibro response`: the job of sinesw3.

use super::{args, complain, print, settings};
use crate::analysis::sweep::{figures, tables};
use crate::error::{Error, Result};
use crate::measure::response::{Response, response};
use crate::measure::{Estimate, legacy};
use crate::record::Sweep;
use crate::report::{Output, files};
use serde::Serialize;
use std::fmt::Write as _;

#[derive(Serialize)]
struct Answer {
    #[serde(flatten)]
    response: Response,
    files: Vec<String>,
}

#[derive(Serialize)]
struct Legacy {
    points: Vec<LegacyPoint>,
    resonances: [(); 0],
    jumps: [(); 0],
    warnings: Vec<String>,
}

/// What the script printed: a frequency and a largest line. It knew nothing of the rest.
#[derive(Serialize)]
struct LegacyPoint {
    excitation: f64,
    frequency: f64,
    amplitude: Estimate,
    harmonics: [(); 0],
    subharmonics: [(); 0],
    largest_elsewhere: Option<bool>,
}

pub fn run(typed: &args::Response, json: bool) -> Result<()> {
    let (list, how) = settings::listed(&typed.sweep)?;
    let sweep = how.read(&list)?;
    if typed.sweep.legacy && typed.out.is_some() {
        return Err(Error::usage(
            "--legacy prints what the script printed, it draws nothing",
            "--legacy or --out",
        ));
    }
    if typed.sweep.legacy {
        return legacy(&sweep, sweep.unit().quantity().symbol(), json);
    }
    let options = settings::taking(&typed.taking, typed.sweep.fmin, sweep.unit().quantity());
    let response = response(&sweep, &options)?;
    let mut written = Vec::new();
    if let Some(folder) = &typed.out {
        let mut output = Output::new(folder)?;
        let figure = figures::response(&response.name, std::slice::from_ref(&response));
        files::figures(&mut output, &[("response".to_owned(), figure)], &|| ())?;
        output.write("response.csv", tables::response(&response).csv())?;
        written = output.written().to_vec();
    }
    if json {
        return print::json(&Answer { response, files: written });
    }
    complain::found(&response.findings);
    let mut text = tables::curve(&response).text();
    let all = std::slice::from_ref(&response);
    for table in [tables::resonances(all), tables::jumps(all)] {
        if !table.rows.is_empty() {
            let _ = write!(text, "\n{}", table.text());
        }
    }
    text.push_str("\nharmonics and sub-harmonics: --json, or response.csv with --out\n");
    for file in written {
        let _ = writeln!(text, "wrote {file}");
    }
    print::text(&text)
}

fn legacy(sweep: &Sweep, unit: &'static str, json: bool) -> Result<()> {
    let warnings = vec!["These are the answers of the script sinesw3, mistakes included.".to_owned()];
    let points: Vec<LegacyPoint> = legacy::response(sweep)?
        .into_iter()
        .map(|(excitation, amplitude)| LegacyPoint {
            excitation,
            frequency: excitation,
            amplitude: Estimate::new(amplitude, None, unit, 1, "largest line, as sinesw3"),
            harmonics: [],
            subharmonics: [],
            largest_elsewhere: None,
        })
        .collect();
    if json {
        return print::json(&Legacy { points, resonances: [], jumps: [], warnings });
    }
    complain::warn(&warnings);
    let mut text = String::new();
    for p in points {
        let _ = writeln!(text, "{:>10.4} {:>14.6e}", p.excitation, p.amplitude.value);
    }
    print::text(&text)
}

//! `vibro restitution`: by every method that the data allow.

use super::{args, complain, print, settings};
use crate::error::{Error, Result};
use crate::measure::restitution::{Bounces, Drop, GRAVITY, Restitution, Train, Velocities, restitution};
use crate::report::words::{self, Voice};
use crate::report::{Output, files, pictures, tables};
use crate::units::notation::quantity;
use serde::Serialize;
use std::fmt::Write as _;

#[derive(Serialize)]
struct Answer {
    #[serde(flatten)]
    restitution: Restitution,
    warnings: Vec<String>,
    files: Vec<String>,
}

pub fn run(typed: &args::Restitution, json: bool) -> Result<()> {
    if typed.interval.is_some() && !typed.intervals.is_empty() {
        return Err(Error::usage(
            "--interval and --intervals",
            "one of them: the first of --intervals is the interval after the fall",
        ));
    }
    let masses = pair("--masses", &typed.masses)?;
    let mut bounces = Bounces::default();
    let mut figures = Vec::new();
    let mut warnings = Vec::new();
    for (i, file) in typed.files.iter().enumerate() {
        let (trace, doubts) = settings::trace(file, &typed.reading, &typed.channel)?;
        let found = bounces.add(&trace, &settings::finding(&typed.finding, Some(Bounces::THRESHOLD)))?;
        for doubt in doubts.into_iter().chain(words::warnings(&found.findings, Voice::Command)) {
            match warnings.iter_mut().find(|w: &&mut (String, usize)| w.0 == doubt) {
                Some(known) => known.1 += 1,
                None => warnings.push((doubt, 1)),
            }
        }
        let name = file.file_name().map_or_else(String::new, |n| n.to_string_lossy().into_owned());
        figures.push((format!("drop_{}", i + 1), pictures::drop(&name, &trace, &found.times)));
    }
    let drop = Drop {
        height: typed.height.unwrap_or(f64::NAN),
        height_std: typed.height_std,
        intervals: typed.interval.into_iter().chain(typed.intervals.first().copied()).collect(),
        interval_std: typed.interval_std,
        gravity: typed.gravity.unwrap_or(GRAVITY),
        gravity_std: typed.gravity_std,
        masses,
    };
    if typed.interval.is_some() && typed.height.is_none() {
        return Err(Error::usage("--interval without --height", "both, or flight times with --intervals"));
    }
    let mut measured = bounces.measured(drop, typed.height.is_some());
    if !typed.intervals.is_empty() {
        let onset_std = typed.interval_std.map(|s| s / 2f64.sqrt());
        measured.trains.push(Train { intervals: typed.intervals.clone(), onset_std });
    }
    measured.velocities = velocities(typed, masses)?;
    let found = restitution(&measured)?;
    let all = typed.files.len();
    let counted = |(doubt, n): (String, usize)| match n {
        _ if all == 1 => doubt,
        n if n == all => format!("All files: {doubt}"),
        n => format!("{n} of {all} files: {doubt}"),
    };
    let mut warnings: Vec<String> = warnings.into_iter().map(counted).collect();
    let mut written = Vec::new();
    if let Some(folder) = &typed.out {
        let mut output = Output::new(folder)?;
        files::figures(&mut output, &figures, &|| ())?;
        output.write("restitution.csv", tables::restitution(&[(String::new(), &found)]).csv())?;
        written = output.written().to_vec();
    }
    if json {
        return print::json(&Answer { restitution: found, warnings, files: written });
    }
    warnings.extend(words::sentences(&found.findings, Voice::Command));
    complain::warn(&warnings);
    let mut text = tables::restitution(&[(String::new(), &found)]).text();
    if found.by.len() > 1 {
        let said = match found.agree {
            Some(true) => "agree",
            Some(false) => "disagree",
            None => "cannot be compared: one has no uncertainty",
        };
        let _ = writeln!(text, "\nthe methods {said}");
    }
    if let Some(u) = found.bootstrap_std {
        let _ = writeln!(
            text,
            "standard uncertainty from the scatter of the drops by a bootstrap: {}",
            quantity(u, "1", 2)
        );
    }
    for file in written {
        let _ = writeln!(text, "wrote {file}");
    }
    print::text(&text)
}

fn velocities(typed: &args::Restitution, masses: Option<(f64, f64)>) -> Result<Option<Velocities>> {
    let Some(before) = pair("--before", &typed.before)? else {
        return if typed.after.is_empty() && typed.after2.is_none() {
            Ok(None)
        } else {
            Err(Error::usage("--after or --after2 without --before", "both"))
        };
    };
    let (after1, after2) = match (typed.after.as_slice(), typed.after2) {
        ([one], two) => (Some(*one), two),
        ([one, two], None) => (Some(*one), Some(*two)),
        ([], Some(two)) => (None, Some(two)),
        (other, _) => {
            return Err(Error::usage(
                format!("--after has {} velocities", other.len()),
                "V1,V2, or V1 with --masses, or --after2 V2 with --masses",
            ));
        }
    };
    Ok(Some(Velocities { before, after1, after2, masses, std: typed.velocity_std }))
}

fn pair(name: &str, values: &[f64]) -> Result<Option<(f64, f64)>> {
    match values {
        [] => Ok(None),
        [a, b] => Ok(Some((*a, *b))),
        other => {
            Err(Error::usage(format!("{name} has {} numbers", other.len()), "two, with a comma between them"))
        }
    }
}

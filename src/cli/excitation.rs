//! `vibro excitation`: the job of sineswpf.

use super::target::{apart, write_beside};
use super::{args, complain, print, settings};
use crate::error::{Error, Result};
use crate::measure::excitation::{Excitation, excitations};
use crate::measure::legacy;
use crate::report::words::{self, Voice};
use serde::Serialize;
use std::fmt::Write as _;
use std::path::Path;

#[derive(Serialize)]
struct Answer {
    points: Vec<Excitation>,
    warnings: Vec<String>,
    written: Vec<String>,
}

pub fn run(typed: &args::Excitation, json: bool) -> Result<()> {
    let (list, how) = settings::listed(&typed.sweep)?;
    let sweep = how.read(&list)?;
    let mut warnings = words::sentences(&sweep.findings, Voice::Command);
    let points = if typed.sweep.legacy {
        warnings = vec!["These are the answers of the script sineswpf, mistakes included.".to_owned()];
        legacy::excitation(&sweep)?
            .into_iter()
            .zip(&sweep.points)
            .map(|(frequency, p)| Excitation {
                file: p.name(),
                frequency,
                std: None,
                force: None,
                force_std: None,
            })
            .collect()
    } else {
        excitations(&sweep, typed.sweep.fmin.unwrap_or(0.0))?
    };
    let mut written = Vec::new();
    if let Some([force, response]) = typed.write_lists.as_deref() {
        if list.force.is_empty() {
            return Err(Error::usage(
                "--write-lists needs a list file with force names",
                "a list, no hand-over file",
            ));
        }
        apart(force, response)?;
        let (path, _) = typed.sweep.source.rsplit_once('#').unwrap_or((&typed.sweep.source, ""));
        for target in [force, response] {
            apart(Path::new(path), target)?;
        }
        let folder = Path::new(path).parent().unwrap_or(Path::new(""));
        let frequency: Vec<f64> = points.iter().map(|p| p.frequency).collect();
        for (path, names) in [(force, &list.force), (response, &list.response)] {
            let names: Vec<_> = names.iter().map(|n| n.strip_prefix(folder).unwrap_or(n)).collect();
            let text = legacy::hand_over(list.lines, list.base_band, &frequency, &names);
            written.push(write_beside(path, &text)?.display().to_string());
        }
    }
    if json {
        return print::json(&Answer { points, warnings, written });
    }
    let mut text = format!("{:<16} {:>12} {:>12} {:>12}\n", "file", "frequency/Hz", "std/Hz", "force/N");
    for p in &points {
        let cell = |v: Option<f64>| v.map_or_else(|| "-".to_owned(), |v| format!("{v:.3e}"));
        let _ =
            writeln!(text, "{:<16} {:>12.5} {:>12} {:>12}", p.file, p.frequency, cell(p.std), cell(p.force));
    }
    complain::warn(&warnings);
    print::text(&text)
}

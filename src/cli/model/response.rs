//! `vibro model response`: motions over frequency.

use super::{Judged, gap_std, judged};
use crate::analysis::model::{figures, tables};
use crate::campaign::above_zero;
use crate::cli::progress::Busy;
use crate::cli::{args, complain, print};
use crate::error::Result;
use crate::model::{Change, NoImpact, ResponsePoint, Scene, response};
use crate::report::{Output, files};
use serde::Serialize;
use std::fmt::Write as _;

#[derive(Serialize)]
struct Answer<'a> {
    scene: &'a Scene,
    points: Vec<Point<'a>>,
    changes: &'a [Change],
    warnings: &'a [String],
    files: Vec<String>,
}

#[derive(Serialize)]
struct Point<'a> {
    frequency: f64,
    orbits: Vec<Judged<'a>>,
    no_impact: Option<NoImpact>,
    backbone: Option<Backbone>,
    refused: Option<&'a str>,
}

/// Free motion without losses.
#[derive(Serialize)]
struct Backbone {
    impulse: f64,
    peak_to_peak: [f64; 2],
    fundamental: [f64; 2],
    admissible: bool,
}

fn point(point: &ResponsePoint, gap_std: Option<f64>) -> Point<'_> {
    Point {
        frequency: point.frequency,
        orbits: point.orbits.iter().map(|o| judged(o, gap_std)).collect(),
        no_impact: point.no_impact,
        backbone: point.backbone.as_ref().map(|o| Backbone {
            impulse: o.impulse,
            peak_to_peak: o.peak_to_peak,
            fundamental: o.fundamental.map(num_complex::Complex::norm),
            admissible: o.validity.admissible,
        }),
        refused: point.refused.as_deref(),
    }
}

pub fn run(typed: &args::ModelResponse, json: bool) -> Result<()> {
    above_zero("from", Some(typed.from))?;
    above_zero("to", Some(typed.to))?;
    let gap_std = gap_std(typed.gap_std)?;
    let (scene, mut warnings) = super::scene(&typed.scene, Some(typed.from))?;
    let excitation = super::excitation(&scene)?;
    let busy = Busy::with(json, "solving at each frequency");
    let found = response(&scene.rig, excitation, typed.from, typed.to, typed.points, typed.cycles)?;
    drop(busy);
    let refused: Vec<_> = found.points.iter().filter_map(|p| p.refused.as_ref()).collect();
    if let Some(why) = refused.first() {
        warnings.push(format!("{} frequencies have no answer, the first of them: {why}", refused.len()));
    }
    let mut written = Vec::new();
    if let Some(folder) = &typed.out {
        let mut output = Output::new(folder)?;
        let figure = figures::branches("Response with one impact a period", &found);
        files::figures(&mut output, &[("response".to_owned(), figure)], &|| ())?;
        output.write("response.csv", tables::branches(&found).csv())?;
        output.write("changes.csv", tables::changes(&found).csv())?;
        written = output.written().to_vec();
    }
    if json {
        return print::json(&Answer {
            scene: &scene,
            points: found.points.iter().map(|p| point(p, gap_std)).collect(),
            changes: &found.changes,
            warnings: &warnings,
            files: written,
        });
    }
    complain::warn(&warnings);
    let real = |p: &&ResponsePoint| {
        p.orbits.iter().any(|o| o.validity.admissible && o.validity.stable == Some(true))
    };
    let mut text = format!(
        "{} frequencies from {} to {} Hz; a stable motion with one impact a period at {} of them\n\n{}",
        found.points.len(),
        typed.from,
        typed.to,
        found.points.iter().filter(real).count(),
        tables::changes(&found).text()
    );
    if typed.out.is_none() {
        text.push_str("\ngive --out DIR for the picture and the table, or --json for the numbers\n");
    }
    for file in written {
        let _ = writeln!(text, "wrote {file}");
    }
    print::text(&text)
}

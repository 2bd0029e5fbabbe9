//! `vibro waterfall`: the job of sinesw.

use super::{args, complain, print, settings};
use crate::analysis::sweep::figures;
use crate::campaign::above_zero;
use crate::error::Result;
use crate::measure::legacy;
use crate::measure::waterfall::{Waterfall, waterfall};
use crate::record::Finding;
use crate::report::{Output, files};
use ndarray::Array2;
use serde::Serialize;
use std::fmt::Write as _;

#[derive(Serialize)]
struct Answer<'a> {
    frequency: &'a [f64],
    excitation: &'a [f64],
    /// One row a point, one value a line.
    magnitude: Vec<Vec<f64>>,
    unit: &'a str,
    fmin: f64,
    findings: &'a [Finding],
    files: Vec<String>,
}

pub fn run(typed: &args::Waterfall, json: bool) -> Result<()> {
    above_zero("fmax", typed.fmax)?;
    let (list, how) = settings::listed(&typed.sweep)?;
    let sweep = how.read(&list)?;
    let matrix = if typed.sweep.legacy {
        let excitation = legacy::rounded(&legacy::excitation(&sweep)?);
        let rows = legacy::waterfall(&sweep);
        let shape = (excitation.len(), sweep.axis.len());
        Waterfall {
            name: sweep.name.clone(),
            frequency: sweep.axis.values(),
            excitation,
            magnitude: Array2::from_shape_fn(shape, |(i, k)| rows[i][k]),
            quantity: sweep.unit().quantity(),
            unit: sweep.unit().symbol().to_owned(),
            fmin: 0.0,
            findings: vec![Finding::caution("legacy-matrix")],
        }
    } else {
        waterfall(&sweep, &settings::taking(&typed.taking, typed.sweep.fmin, sweep.unit().quantity()))?
    };
    let mut files = Vec::new();
    if let Some(folder) = &typed.out {
        let mut output = Output::new(folder)?;
        let figures = [
            ("waterfall".to_owned(), figures::waterfall(&matrix, typed.fmax)?),
            ("map".to_owned(), figures::map(&matrix, typed.fmax)?),
        ];
        files::figures(&mut output, &figures, &|| ())?;
        output.write("waterfall.csv", files::matrix_csv(&matrix))?;
        files = output.written().to_vec();
    }
    if json {
        return print::json(&Answer {
            frequency: &matrix.frequency,
            excitation: &matrix.excitation,
            magnitude: matrix.magnitude.rows().into_iter().map(|r| r.to_vec()).collect(),
            unit: &matrix.unit,
            fmin: matrix.fmin,
            findings: &matrix.findings,
            files,
        });
    }
    complain::found(&matrix.findings);
    let (points, lines) = matrix.magnitude.dim();
    let mut text = format!("{points} spectra of {lines} lines, {} in {}\n", matrix.quantity, matrix.unit);
    if typed.out.is_none() {
        text.push_str("give --out DIR for the picture and the matrix, or --json for the numbers\n");
    }
    for file in files {
        let _ = writeln!(text, "wrote {file}");
    }
    print::text(&text)
}

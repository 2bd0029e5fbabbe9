//! The abscissa of a text: what a person states, what a column holds, what the header states.

use super::header::Stated;
use crate::Options;
use crate::assemble::short;
use std::path::Path;
use vibro_record::{Axis, AxisKind, Error, Finding, Place, Result};

/// Relative difference that no statement means: six digits are the least that a person states.
const SURE: f64 = 1e-6;
/// Relative difference of a statement that was rounded to fewer digits than the column has.
const ROUNDED: f64 = 1e-4;

/// An abscissa that stands in the file as a column.
pub struct Printed {
    pub axis: Axis,
    /// Names the column, e.g. `column "t"`.
    pub label: String,
    /// Half a unit in the last digit that it was printed with, in s or Hz.
    pub resolution: f64,
    /// Whether it is time or frequency only because a person's statement says so.
    pub assumed: bool,
    /// What is to be said of it, if it is used.
    pub findings: Vec<Finding>,
}

/// The axis of `n` values: what a person states, then the printed one, then what the header states.
///
/// # Errors
/// If a person's statement contradicts a whole printed column.
pub fn choose(
    path: &Path,
    printed: Option<Printed>,
    n: usize,
    stated: &Stated,
    options: &Options,
    findings: &mut Vec<Finding>,
) -> Result<Axis> {
    let given = match (options.rate, options.base_band) {
        (Some(rate), _) => Axis::time(0.0, 1.0 / rate, n),
        (None, Some(band)) => {
            let half_open = printed.as_ref().is_some_and(|p| p.stops_before(band));
            Axis::frequency(0.0, band / if half_open { n as f64 } else { stated.lines_of(n) }, n)
        }
        (None, None) => {
            return Ok(match printed {
                Some(printed) => trusted(printed, stated, findings),
                None => headed(n, stated, findings),
            });
        }
    };
    let step = given.step().unwrap_or(f64::NAN);
    contradicted(stated, options, step, findings);
    let Some(printed) = printed else { return Ok(given) };
    let Printed { axis, label, .. } = &printed;
    let about = |found: Finding| found.name("column", label.as_str());
    if !matches!(axis.kind, AxisKind::Time | AxisKind::Frequency) {
        findings.push(about(Finding::caution("column-no-axis")));
        return Ok(given);
    }
    printed.runs_forward(path)?;
    if printed.goes_with(&given, options.base_band, SURE) {
        if axis.step().is_none() {
            findings.push(about(Finding::caution("column-uneven")).number("step", step));
        } else if given.kind == AxisKind::Frequency {
            return Ok(printed.axis);
        }
    } else if axis.step().is_some() && printed.goes_with(&given, options.base_band, ROUNDED) {
        findings.push(about(printed.nearly(options)));
        return Ok(printed.axis);
    } else if printed.assumed && axis.step() == Some(1.0) && matches!(axis.start(), 0.0 | 1.0) {
        findings.push(about(Finding::caution("column-counts")).number("step", step));
        return Ok(given);
    } else {
        return Err(printed.contradiction(path, &given, options));
    }
    Ok(if given.kind == AxisKind::Time { Axis::time(axis.start(), step, n) } else { given })
}

impl Printed {
    /// Whether what was stated can be meant by the digits of the column: a time may begin anywhere, lines that do not begin
    /// at 0 Hz must end at the base band.
    fn goes_with(&self, given: &Axis, base_band: Option<f64>, relative: f64) -> bool {
        let axis = &self.axis;
        let (Some(last), true) = (axis.len().checked_sub(1), axis.kind == given.kind) else { return false };
        let close = |a: f64, b: f64, resolution: f64| (a - b).abs() <= resolution + relative * b.abs();
        let (from, to) = (axis.start(), axis.at(last));
        // Both ends are rounded; a lost sample makes a whole step, an unsteady clock less than half of one.
        let tolerance = axis.step().map_or(0.5 * given.step().unwrap_or(0.0), |_| 2.0 * self.resolution);
        let span = close(to - from, given.at(last) - given.start(), tolerance);
        let ends = base_band.is_some_and(|band| close(to, band, self.resolution)) && axis.step().is_some();
        match given.kind {
            AxisKind::Frequency => ends || (span && self.begins_at_zero()),
            _ => span,
        }
    }

    /// Refuses a column that runs backwards: its values are in no order, whatever the rate.
    fn runs_forward(&self, path: &Path) -> Result<()> {
        let at = |i: usize| short(self.axis.at(i));
        let back = |i: &usize| self.axis.at(*i) < self.axis.at(i - 1) - 2.0 * self.resolution;
        let Some(i) = (1..self.axis.len()).find(back) else { return Ok(()) };
        let (value, before) = (at(i), at(i - 1));
        let found = format!("the {} runs backwards: value {} is {value}, behind {before}", self.label, i + 1);
        Err(Error::input(Place::file(path), found, "times or frequencies that rise")
            .hint("sort the rows, or cut the file where it begins anew"))
    }

    fn begins_at_zero(&self) -> bool {
        let last = self.axis.at(self.axis.len().saturating_sub(1));
        self.axis.start().abs() <= self.resolution + SURE * last.abs()
    }

    /// Whether lines from 0 Hz on end one step below the base band, as those of a plain transform do.
    fn stops_before(&self, base_band: f64) -> bool {
        let n = self.axis.len();
        let Some(step) = self.axis.step().filter(|_| n > 1 && self.axis.kind == AxisKind::Frequency) else {
            return false;
        };
        let next = self.axis.at(n - 1) + step;
        // Half a step tells this from lines that end at the base band.
        let tolerance = (self.resolution * 2.0 + ROUNDED * base_band).min(0.5 * step);
        self.begins_at_zero() && (next - base_band).abs() <= tolerance
    }

    /// A statement that is a rounded number of what the column holds.
    fn nearly(&self, options: &Options) -> Finding {
        let (step, last) = (self.axis.step().unwrap_or(f64::NAN), self.axis.len().saturating_sub(1));
        let (what, holds, said) = match (options.rate, options.base_band) {
            (Some(rate), _) => ("sampling rate", 1.0 / step, rate),
            (None, band) => {
                let band = band.unwrap_or(f64::NAN);
                let beyond = if self.stops_before(band) { step } else { 0.0 };
                ("base band", self.axis.at(last) + beyond, band)
            }
        };
        Finding::note("column-refines").name("what", what).number("holds", holds).number("stated", said)
    }

    fn contradiction(&self, path: &Path, given: &Axis, options: &Options) -> Error {
        let runs = |axis: &Axis| {
            let (what, unit) = if axis.kind == AxisKind::Time { ("time", "s") } else { ("frequency", "Hz") };
            let (from, to) = (short(axis.start()), short(axis.at(axis.len().saturating_sub(1))));
            let steps =
                axis.step().map_or("uneven steps".to_owned(), |s| format!("steps of {} {unit}", short(s)));
            format!("{what} from {from} to {to} {unit} in {steps}")
        };
        let (said, setting) = match (options.rate, options.base_band) {
            (Some(rate), _) => (format!("sampling rate of {rate} Hz"), "rate"),
            (None, band) => (format!("base band of {} Hz", band.unwrap_or(f64::NAN)), "base_band"),
        };
        Error::input(
            Place::file(path),
            format!("the {} holds a {}", self.label, runs(&self.axis)),
            format!("a {}, since a {said} was stated", runs(given)),
        )
        .hint(
            "correct the stated number, or leave it out to believe the column; if the column has another unit, name it in \
             its header, e.g. [ms] or [kHz]",
        )
        .setting(setting)
    }
}

/// Says where a person's statement and the header differ.
fn contradicted(stated: &Stated, options: &Options, step: f64, findings: &mut Vec<Finding>) {
    let differ = |what: &str, file: Option<f64>, used: Option<f64>| {
        let (file, used) = file.zip(used).filter(|(file, used)| file != used)?;
        let found = Finding::caution("statement-overrides-file").name("what", what);
        Some(found.number("file", file).number("used", used))
    };
    if options.rate.is_some() {
        findings.extend(differ("sampling rate", stated.rate, options.rate));
    } else {
        findings.extend(differ("base band", stated.base_band, options.base_band));
        findings.extend(differ("line distance", stated.line_width.map(short), Some(short(step))));
    }
}

/// A printed axis, compared with what the header states.
fn trusted(printed: Printed, stated: &Stated, findings: &mut Vec<Finding>) -> Axis {
    let Printed { axis, label, findings: said, .. } = printed;
    findings.extend(said);
    let header = match axis.kind {
        AxisKind::Time => stated.rate.map(|rate| 1.0 / rate),
        AxisKind::Frequency => stated.line_width,
        AxisKind::Index | AxisKind::Other(_) => None,
    };
    if let (Some(header), Some(step)) = (header, axis.step())
        && (step / header - 1.0).abs() > 1e-3
    {
        let found = Finding::caution("header-step-differs").name("column", label);
        findings.push(found.number("header", header).number("step", step));
    }
    axis
}

/// The axis that the header states.
fn headed(n: usize, stated: &Stated, findings: &mut Vec<Finding>) -> Axis {
    match (stated.spacing(n), stated.rate) {
        (Some(df), rate) if rate.is_none() || stated.all_lines(n) => Axis::frequency(0.0, df, n),
        (spacing, Some(rate)) => {
            if spacing.is_some() {
                findings.push(Finding::caution("rate-and-spectrum-in-header").number("rate", rate));
            }
            Axis::time(0.0, 1.0 / rate, n)
        }
        _ => {
            findings.push(Finding::caution("abscissa-unsaid"));
            Axis::index(n)
        }
    }
}

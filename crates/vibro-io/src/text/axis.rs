//! Chooses the abscissa of a text: from the options, from a printed column, or from the header.

use super::header::{PerhapsRate, Stated};
use crate::assemble::{NOMINAL, domain, short};
use crate::options::Options;
use vibro_record::code;
use vibro_record::{Axis, AxisKind, Clock, Error, Finding, Grid, Result, evened};

/// Largest relative difference at which a stated number and the column agree. A smaller
/// difference is rounding in print, not a correction by the user.
const SURE: f64 = 1e-6;
/// Largest relative difference at which a stated number is the column's value rounded to fewer digits.
const ROUNDED: f64 = 1e-4;

/// An abscissa that the file prints as a column.
pub struct PrintedAbscissa {
    pub axis: Axis,
    /// Text that names the column in messages, such as `column "t"`.
    pub label: String,
    /// Half a unit in the last digit of the printed values, in s or Hz.
    pub resolution: f64,
    /// Whether time or frequency is only assumed: neither the column's name nor the header states it.
    pub assumed: bool,
    /// Unix time in s of the column's zero; 0 if the column holds no Unix time.
    pub origin: f64,
    /// Relative standard uncertainty of the step, if the axis is even.
    pub clock: f64,
    /// Findings on the column, reported if it is used.
    pub findings: Vec<Finding>,
}

/// Sampling rate or base band stated in the options.
struct Statement {
    /// `sampling rate` of values over time, `base band` of a spectrum.
    what: &'static str,
    setting: &'static str,
    hertz: f64,
    /// The same quantity in Hz as the header states it.
    header: Option<f64>,
    /// The axis that follows from the stated number.
    axis: Axis,
}

impl Statement {
    fn of(
        options: &Options,
        header: &Stated,
        printed: Option<&PrintedAbscissa>,
        n: usize,
    ) -> Option<Statement> {
        let (what, setting, hertz, header, axis) = match (options.rate, options.base_band) {
            (Some(rate), _) => ("sampling rate", "rate", rate, header.rate, Axis::time(0.0, 1.0 / rate, n)),
            (None, Some(band)) => {
                let half_open = printed.is_some_and(|p| p.stops_before(band));
                let steps = if half_open { n as f64 } else { header.lines_of(n) };
                ("base band", "base_band", band, header.base_band, Axis::frequency(0.0, band / steps, n))
            }
            (None, None) => return None,
        };
        Some(Statement { what, setting, hertz, header, axis })
    }

    /// Adds findings where the stated number differs from the header.
    fn against(&self, header: &Stated, findings: &mut Vec<Finding>) {
        let mut differ = |what: &str, file: Option<f64>, used: f64| {
            let found = Finding::caution("statement-overrides-file").name("what", what);
            let file = file.filter(|file| *file != used);
            findings.extend(file.map(|file| found.number("file", file).number("used", used)));
        };
        differ(self.what, self.header, self.hertz);
        if self.axis.kind == AxisKind::Frequency {
            let step = self.axis.step().unwrap_or(f64::NAN);
            differ("line distance", header.line_width.map(short), short(step));
        }
    }
}

/// Chooses the axis of `n` values: from the options, else from the printed column, else from the header.
/// Also returns the relative standard uncertainty of the step; 0 if no column is used.
///
/// # Errors
/// If the options contradict the printed column, or if the column runs backwards.
pub fn choose(
    printed: Option<PrintedAbscissa>,
    n: usize,
    header: &Stated,
    options: &Options,
    findings: &mut Vec<Finding>,
) -> Result<(f64, Axis)> {
    // Uneven times are kept if a stretch is to be cut out or the trace resampled later.
    let evened = options.stretch.is_some() || options.resample.is_some();
    let own = evened && printed.as_ref().is_some_and(|p| p.axis.step().is_none());
    let Some(statement) = Statement::of(options, header, printed.as_ref(), n).filter(|_| !own) else {
        return Ok(match printed {
            Some(printed) => (printed.clock, trusted(printed, header, findings)),
            None => (0.0, headed(n, header, findings)),
        });
    };
    statement.against(header, findings);
    let given = &statement.axis;
    let Some(printed) = printed else { return Ok((0.0, statement.axis)) };
    let PrintedAbscissa { axis, label, .. } = &printed;
    let about = |code| Finding::caution(code).name("column", label.as_str());
    if !matches!(axis.kind, AxisKind::Time | AxisKind::Frequency) {
        findings.push(about("column-no-axis"));
        return Ok((0.0, statement.axis));
    }
    printed.runs_forward()?;
    let step = given.step().unwrap_or(f64::NAN);
    if printed.goes_with(&statement, SURE) {
        if axis.step().is_none() {
            findings.push(about("column-uneven").number("step", step));
        } else if given.kind == AxisKind::Frequency {
            return Ok((printed.clock, printed.axis));
        }
    } else if axis.step().is_some() && printed.goes_with(&statement, printed.rounded()) {
        findings.push(printed.refines(&statement));
        findings.extend(printed.findings.into_iter().filter(|found| found.code == Clock::JITTERS));
        return Ok((printed.clock, printed.axis));
    } else if printed.assumed && axis.step() == Some(1.0) && matches!(axis.start(), 0.0 | 1.0) {
        findings.push(about("column-counts").number("step", step));
        return Ok((0.0, statement.axis));
    } else {
        return Err(printed.contradicts(&statement));
    }
    let time = given.kind == AxisKind::Time;
    Ok((0.0, if time { Axis::time(axis.start(), step, n) } else { statement.axis }))
}

impl PrintedAbscissa {
    fn last(&self) -> f64 {
        self.axis.at(self.axis.len().saturating_sub(1))
    }

    /// Whether column and statement agree within the printed digits plus a `relative` difference. Times may
    /// begin anywhere. Spectral lines that do not begin at 0 Hz must end at the base band.
    fn goes_with(&self, statement: &Statement, relative: f64) -> bool {
        let (axis, given) = (&self.axis, &statement.axis);
        if axis.is_empty() || axis.kind != given.kind {
            return false;
        }
        let close = |a: f64, b: f64, resolution: f64| (a - b).abs() <= resolution + relative * b.abs();
        // Both ends are rounded. Uneven times may differ by half a step: an unsteady clock stays below that,
        // a lost sample adds a whole step.
        let uneven = || self.batch().unwrap_or(0.5 * given.step().unwrap_or(0.0));
        let tolerance = axis.step().map_or_else(uneven, |_| 2.0 * self.resolution);
        let span = close(self.last() - axis.start(), given.at(axis.len() - 1), tolerance);
        let ends = || close(self.last(), statement.hertz, self.resolution) && axis.step().is_some();
        if given.kind == AxisKind::Time { span } else { ends() || (span && self.begins_at_zero()) }
    }

    /// Time in s from one batch of samples to the next, if all samples of a batch have one time.
    fn batch(&self) -> Option<f64> {
        if let Grid::Uneven(instants) = &self.axis.grid { batch(instants) } else { None }
    }

    /// Largest relative difference at which a statement is a rounded form of this column; larger for a
    /// clock with jitter.
    fn rounded(&self) -> f64 {
        if self.findings.iter().any(|found| found.code == Clock::JITTERS) { NOMINAL } else { ROUNDED }
    }

    /// Refuses a column that runs backwards: no sampling rate can put its values in order.
    fn runs_forward(&self) -> Result<()> {
        let at = |i: usize| short(self.axis.at(i));
        let back = |i: &usize| self.axis.at(*i) < self.axis.at(i - 1) - 2.0 * self.resolution;
        let Some(i) = (1..self.axis.len()).find(back) else { return Ok(()) };
        let (value, before) = (at(i), at(i - 1));
        let found = format!("the {} runs backwards: value {} is {value}, behind {before}", self.label, i + 1);
        Err(Error::usage(found, "times or frequencies that rise")
            .hint("sort the rows, or cut the file where it begins anew"))
    }

    fn begins_at_zero(&self) -> bool {
        self.axis.start().abs() <= self.resolution + SURE * self.last().abs()
    }

    /// Whether lines from 0 Hz end one step below the base band, as those of a discrete Fourier transform
    /// do.
    fn stops_before(&self, base_band: f64) -> bool {
        let many = self.axis.len() > 1 && self.axis.kind == AxisKind::Frequency;
        self.axis.step().filter(|_| many).is_some_and(|step| {
            // A tolerance below half a step excludes lines that end at the base band itself.
            let tolerance = (self.resolution * 2.0 + ROUNDED * base_band).min(0.5 * step);
            self.begins_at_zero() && (self.last() + step - base_band).abs() <= tolerance
        })
    }

    /// Finding that the stated number is a rounded form of the column's value, which is used.
    fn refines(&self, Statement { what, hertz, axis, .. }: &Statement) -> Finding {
        let step = self.axis.step().unwrap_or(f64::NAN);
        let holds = match axis.kind {
            AxisKind::Time => 1.0 / step,
            _ => self.last() + if self.stops_before(*hertz) { step } else { 0.0 },
        };
        let found = Finding::note("column-refines").name("what", *what).number("holds", holds);
        found.number("stated", *hertz).name("column", self.label.as_str())
    }

    fn contradicts(&self, Statement { what, setting, hertz, axis, .. }: &Statement) -> Error {
        let runs = |axis: &Axis| {
            let (what, unit) = domain(&axis.kind);
            let (from, to) = (short(axis.start()), short(axis.at(axis.len().saturating_sub(1))));
            let steps =
                axis.step().map_or("uneven steps".to_owned(), |s| format!("steps of {} {unit}", short(s)));
            format!("{what} from {from} to {to} {unit} in {steps}")
        };
        let found = format!("the {} holds a {}", self.label, runs(&self.axis));
        let error = Error::usage(found, format!("a {}, since a {what} of {hertz} Hz was stated", runs(axis)));
        if let Grid::Uneven(instants) = &self.axis.grid
            && axis.kind == AxisKind::Time
        {
            if batch(instants).is_some() {
                return error.hint(
                    "where samples are missing, cut the file and read the parts alone; else correct the stated number",
                );
            }
            return evened(error, instants, self.resolution);
        }
        error
            .hint(
                "correct the stated number, or leave it out to believe the column; if the column has another unit, name it \
                 in its header, e.g. [ms] or [kHz]",
            )
            .setting(setting)
    }
}

/// Median step in s between different instants, if some instants are equal and none runs backwards.
fn batch(instants: &[f64]) -> Option<f64> {
    let steps: Vec<f64> = instants.windows(2).map(|w| w[1] - w[0]).collect();
    let batched = steps.contains(&0.0) && steps.iter().all(|step| *step >= 0.0);
    let apart: Vec<f64> = steps.into_iter().filter(|step| *step > 0.0).collect();
    (batched && !apart.is_empty()).then(|| vibro_record::median(&apart))
}

/// The printed axis, with a finding if the header states another step.
fn trusted(printed: PrintedAbscissa, header: &Stated, findings: &mut Vec<Finding>) -> Axis {
    let PrintedAbscissa { axis, label, findings: mut said, .. } = printed;
    let header = match axis.kind {
        AxisKind::Time => header.rate.map(|rate| 1.0 / rate),
        AxisKind::Frequency => header.line_width,
        AxisKind::Index | AxisKind::Other(_) => None,
    };
    if let (Some(header), Some(step)) = (header, axis.step()) {
        if (step / header - 1.0).abs() > 1e-3 {
            let found = Finding::caution("header-step-differs").name("column", label);
            findings.push(found.number("header", header).number("step", step));
        } else {
            said.retain(|found| found.code != code::AXIS_ROUNDED_OR_LOST);
        }
    }
    findings.extend(said);
    axis
}

/// The axis from the header, else an index.
fn headed(n: usize, header: &Stated, findings: &mut Vec<Finding>) -> Axis {
    match (header.spacing(n), header.rate) {
        (Some(df), rate) if rate.is_none() || header.all_lines(n) => Axis::frequency(0.0, df, n),
        (spacing, Some(rate)) => {
            if spacing.is_some() {
                findings.push(Finding::caution("rate-and-spectrum-in-header").number("rate", rate));
            }
            let assumed =
                header.assumed.as_deref().map(|key| Finding::doubt("head-step-assumed").name("key", key));
            findings.extend(assumed.map(|found| found.number("step", 1.0 / rate).without_estimate()));
            if header.assumed.is_none() {
                findings.push(Finding::note(code::RATE_FROM_HEAD).number("rate", rate));
                let line = header.decimation.as_deref();
                findings.extend(line.map(|line| {
                    let found = Finding::doubt("rate-decimated").number("rate", rate);
                    found.name("line", line).without_estimate()
                }));
            }
            let other = header.other_rate.map(|other| Finding::doubt("rates-differ").number("other", other));
            findings.extend(other.map(|found| found.number("rate", rate).without_estimate()));
            Axis::time(header.start.unwrap_or(0.0), 1.0 / rate, n)
        }
        _ => {
            let found = Finding::caution(code::ABSCISSA_UNSAID);
            let found = match &header.perhaps_rate {
                Some(PerhapsRate { said, decimal, grouped }) => {
                    found.name("said", said.as_str()).number("decimal", *decimal).number("grouped", *grouped)
                }
                None => found,
            };
            findings.push(found);
            Axis::index(n)
        }
    }
}

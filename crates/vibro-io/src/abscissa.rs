//! An abscissa that a file prints or stores value by value.

use super::ascii::stated::Stated;
use super::reader::Options;
use std::path::Path;
use vibro_record::{Axis, AxisKind, Error, Grid, Place, Result, Values};

/// Relative difference that no statement means: six digits are the least that a person states.
const SURE: f64 = 1e-6;
/// Relative difference of a statement that was rounded to fewer digits than the column has.
const ROUNDED: f64 = 1e-4;

/// An abscissa that stands in the file as a column.
pub(super) struct Printed {
    pub axis: Axis,
    /// Names the column at the start of a sentence.
    pub label: String,
    /// Half a unit in the last digit that it was printed with, in s or Hz.
    pub resolution: f64,
    /// Whether it is time or frequency only because a person's statement says so.
    pub assumed: bool,
    /// What is to be said of it, if it is used.
    pub doubts: Vec<String>,
}

/// The axis of `n` values: what a person states, then the printed one, then what the header states. Words behind the values
/// (a `footer`) make the number of lines doubtful.
///
/// # Errors
/// If a person's statement contradicts a whole printed column.
pub(super) fn choose(
    path: &Path,
    printed: Option<Printed>,
    (n, footer): (usize, bool),
    stated: &Stated,
    options: &Options,
    doubts: &mut Vec<String>,
) -> Result<Axis> {
    let half_open =
        printed.as_ref().is_some_and(|p| options.base_band.is_some_and(|band| p.stops_before(band)));
    let given = match (options.rate, options.base_band) {
        (Some(rate), _) => Some(Axis::time(0.0, 1.0 / rate, n)),
        (None, Some(band)) if half_open => Some(Axis::frequency(0.0, band / n as f64, n)),
        (None, Some(band)) => Some(Axis::frequency(0.0, band / stated.lines_of(n), n)),
        (None, None) => None,
    };
    let (printed, given) = match (printed, given) {
        (Some(printed), None) => return Ok(trusted(printed, stated, doubts)),
        (Some(printed), Some(given)) => (printed, given),
        (None, given) => {
            if let Some(given) = &given {
                contradicted(stated, options, given.step().unwrap_or(f64::NAN), doubts);
            }
            let axis = given.unwrap_or_else(|| headed(n, stated, doubts));
            let counted = stated.lines.is_none_or(|lines| lines != n as f64 && lines + 1.0 != n as f64);
            if footer && counted && axis.kind == AxisKind::Frequency {
                doubts.push(format!(
                    "Whether {n} values are all lines is not stated: if the words behind them stand for values, all frequencies are wrong (a header line such as `lines: 400` settles it)."
                ));
            }
            return Ok(axis);
        }
    };
    let step = given.step().unwrap_or(f64::NAN);
    contradicted(stated, options, step, doubts);
    let Printed { axis, label, .. } = &printed;
    if !matches!(axis.kind, AxisKind::Time | AxisKind::Frequency) {
        doubts.push(format!("{label} is no axis for what was stated, and is passed over."));
        return Ok(given);
    }
    printed.runs_forward(path)?;
    if printed.goes_with(&given, options.base_band, SURE) {
        if axis.step().is_none() {
            doubts.push(format!("{label} is uneven; a step of {} was stated and is used.", short(step)));
        } else if given.kind == AxisKind::Frequency {
            return Ok(printed.axis);
        }
    } else if axis.step().is_some() && printed.goes_with(&given, options.base_band, ROUNDED) {
        doubts.push(printed.nearly(options));
        return Ok(printed.axis);
    } else if printed.assumed && printed.counts() {
        doubts.push(format!("{label} counts the values; a step of {} was stated and is used.", short(step)));
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
        match (1..self.axis.len()).find(|i| self.axis.at(*i) < self.axis.at(i - 1) - 2.0 * self.resolution) {
            Some(i) => Err(Error::input(
                Place::file(path),
                format!("{} runs backwards: value {} is {}, behind {}", self.label, i + 1, at(i), at(i - 1)),
                "times or frequencies that rise",
            )
            .hint("sort the rows, or cut the file where it begins anew")),
            None => Ok(()),
        }
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

    /// What is said where the statement is a rounded number of what the column holds.
    fn nearly(&self, options: &Options) -> String {
        let (step, last) = (self.axis.step().unwrap_or(f64::NAN), self.axis.len().saturating_sub(1));
        let (what, holds, said) = match (options.rate, options.base_band) {
            (Some(rate), _) => ("a sampling rate", 1.0 / step, rate),
            (None, band) => {
                let band = band.unwrap_or(f64::NAN);
                let beyond = if self.stops_before(band) { step } else { 0.0 };
                ("a base band", self.axis.at(last) + beyond, band)
            }
        };
        let digits = apart(holds, said);
        let (holds, said) = (rounded(holds, digits), rounded(said, digits));
        format!("{} holds {what} of {holds} Hz; {said} Hz was stated: the column is used.", self.label)
    }

    /// Whether the column counts 0, 1, 2, … or 1, 2, 3, …
    fn counts(&self) -> bool {
        self.axis.step() == Some(1.0) && matches!(self.axis.start(), 0.0 | 1.0)
    }

    fn contradiction(&self, path: &Path, given: &Axis, options: &Options) -> Error {
        let step = |axis: &Axis| axis.step().unwrap_or(f64::NAN);
        let digits = apart(step(&self.axis), step(given));
        let runs = |axis: &Axis| {
            let (what, unit) = if axis.kind == AxisKind::Time { ("time", "s") } else { ("frequency", "Hz") };
            let short = |value: f64| rounded(value, digits);
            let (from, to) = (short(axis.start()), short(axis.at(axis.len().saturating_sub(1))));
            let steps =
                axis.step().map_or("uneven steps".to_owned(), |s| format!("steps of {} {unit}", short(s)));
            format!("{what} from {from} to {to} {unit} in {steps}")
        };
        let (said, option) = match (options.rate, options.base_band) {
            (Some(rate), _) => (format!("sampling rate of {rate} Hz"), "--rate"),
            (None, band) => (format!("base band of {} Hz", band.unwrap_or(f64::NAN)), "--base-band"),
        };
        Error::input(
            Place::file(path),
            format!("{} holds a {}", self.label, runs(&self.axis)),
            format!("a {}, since a {said} was stated", runs(given)),
        )
        .hint(format!(
            "correct what was stated (in the list, the campaign or {option}), or leave {option} out and the column is believed; if the column has another unit, write it into its header, e.g. [ms] or [kHz]"
        ))
    }
}

/// Says where a person's statement and the header differ.
fn contradicted(stated: &Stated, options: &Options, step: f64, doubts: &mut Vec<String>) {
    let mut differ = |what: &str, written: Option<f64>, said: Option<f64>| {
        if let (Some(written), Some(said)) = (written, said)
            && written != said
        {
            doubts.push(format!("The file says a {what} of {written} Hz; {said} Hz was given and is used."));
        }
    };
    if let Some(rate) = options.rate {
        differ("sampling rate", stated.rate, Some(rate));
        if stated.rate.is_none()
            && let Some(band) = stated.base_band.or(stated.line_width)
        {
            doubts.push(format!(
                "The file states a spectrum (of {band} Hz); a rate of {rate} Hz was given: the values are taken as a time trace."
            ));
        }
        if options.base_band.is_some() {
            doubts.push("A rate and a base band were given: the rate is used.".to_owned());
        }
    } else {
        differ("base band", stated.base_band, options.base_band);
        differ("line distance", stated.line_width.map(short), Some(short(step)));
        if let (Some(rate), Some(band), None, None) =
            (stated.rate, options.base_band, stated.base_band, stated.line_width)
        {
            doubts.push(format!(
                "The file says a sampling rate of {rate} Hz; a base band of {band} Hz was given: the values are taken as a spectrum."
            ));
        }
    }
}

/// A printed axis, compared with what the header states.
fn trusted(printed: Printed, stated: &Stated, doubts: &mut Vec<String>) -> Axis {
    let Printed { axis, label, doubts: said, .. } = printed;
    doubts.extend(said);
    let step = match axis.kind {
        AxisKind::Time => stated.rate.map(|rate| 1.0 / rate),
        AxisKind::Frequency => stated.line_width,
        AxisKind::Index | AxisKind::Other(_) => None,
    };
    if let (Some(stated), Some(step)) = (step, axis.step())
        && (step / stated - 1.0).abs() > 1e-3
    {
        doubts.push(format!(
            "The preamble states a step of {}; {label} has {} and is used.",
            short(stated),
            short(step)
        ));
    }
    axis
}

/// The axis that the header states.
fn headed(n: usize, stated: &Stated, doubts: &mut Vec<String>) -> Axis {
    match (stated.spacing(n), stated.rate) {
        (Some(df), rate) if rate.is_none() || stated.all_lines(n) => Axis::frequency(0.0, df, n),
        (spacing, Some(rate)) => {
            if spacing.is_some() {
                doubts.push(format!(
                    "The file states a sampling rate of {rate} Hz and a spectrum too: the values are taken as a time trace (give --base-band for a spectrum)."
                ));
            }
            Axis::time(0.0, 1.0 / rate, n)
        }
        _ => {
            doubts.push(
                "The file says nothing of its abscissa: values are numbered (give --rate for a time trace, --base-band for a spectrum).".to_owned(),
            );
            Axis::index(n)
        }
    }
}

/// Multiplies values by the factor of their unit.
///
/// # Errors
/// If one becomes too large for a number.
pub(super) fn to_si(path: &Path, values: &mut Values, factor: f64) -> Result<()> {
    if factor == 1.0 {
        return Ok(());
    }
    let over = match values {
        Values::Real(values) => {
            for v in values.iter_mut() {
                *v *= factor;
            }
            values.iter().position(|v| v.is_infinite())
        }
        Values::Complex(values) => {
            for v in values.iter_mut() {
                *v *= factor;
            }
            values.iter().position(|v| v.re.is_infinite() || v.im.is_infinite())
        }
    };
    match over {
        Some(at) => Err(Error::input(
            Place::file(path),
            format!("value {} is too large for a number once it is taken to SI by {factor}", at + 1),
            "values that a measurement can have",
        )
        .hint("check the unit, or state it with --unit")),
        None => Ok(()),
    }
}

/// Axis of `values` (SI) and a sentence where it is uneven or was printed with too few digits.
///
/// `resolution` is half a unit in the last digit, `what` names the values in the sentence, e.g. `The column "t"`.
pub(super) fn from_values(
    kind: AxisKind,
    values: Vec<f64>,
    resolution: f64,
    what: &str,
) -> (Axis, Option<String>) {
    let unit = match kind {
        AxisKind::Time => " s",
        AxisKind::Frequency => " Hz",
        AxisKind::Index | AxisKind::Other(_) => "",
    };
    let steps: Vec<f64> = values.windows(2).map(|w| w[1] - w[0]).collect();
    let (smallest, largest) =
        steps.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), d| (a.min(*d), b.max(*d)));
    let long = steps.iter().filter(|d| **d > f64::midpoint(smallest, largest)).count();
    let range = format!(
        "steps from {} to {}{unit}, {long} of {} near the largest",
        short(smallest),
        short(largest),
        steps.len()
    );
    // Steps of one and of two units in the last digit: rounding of 1.25 ms to whole ones, or a sample that was lost.
    let doubled = smallest > 0.0 && largest > 1.5 * smallest;
    let axis = if doubled && !is_rounding(&steps, f64::midpoint(smallest, largest)) {
        Axis { kind, grid: Grid::Uneven(values) }
    } else {
        Axis::from_values(kind, values, resolution)
    };
    let doubt = match axis.step() {
        _ if axis.len() < 2 => None,
        // Steps may differ by rounding in binary; a thousandth of a step is visible.
        Some(step) if largest - smallest > 2e-3 * step => Some(format!(
            "{what} has too few digits ({range}): the step is taken as (last - first)/(n - 1) = {}{unit}.",
            short(step)
        )),
        Some(_) => None,
        None if smallest > 0.0 => Some(format!("{what} is uneven: {range}.")),
        None => Some(format!("{what} is uneven and does not always rise: {range}.")),
    };
    (axis, doubt)
}

/// Whether the longer steps come as regularly as rounding an even grid makes them: the distances between them differ by one
/// at most. Fewer than three of them prove nothing.
fn is_rounding(steps: &[f64], middle: f64) -> bool {
    let long: Vec<usize> = steps.iter().enumerate().filter(|(_, d)| **d > middle).map(|(i, _)| i).collect();
    let gaps = long.windows(2).map(|w| w[1] - w[0]);
    let (least, most) = gaps.fold((usize::MAX, 0), |(a, b), gap| (a.min(gap), b.max(gap)));
    long.len() >= 3 && most - least <= 1
}

/// Six digits are enough for a sentence.
pub(super) fn short(value: f64) -> f64 {
    rounded(value, 6)
}

fn rounded(value: f64, digits: usize) -> f64 {
    format!("{value:.*e}", digits.saturating_sub(1)).parse().unwrap_or(value)
}

/// How many digits show that two numbers differ: six at least, and no more where twelve do not.
fn apart(a: f64, b: f64) -> usize {
    (6..=12).find(|digits| rounded(a, *digits) != rounded(b, *digits)).unwrap_or(6)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_what_a_person_must_know_is_said() {
        let of = |values: &[f64], resolution| {
            from_values(AxisKind::Time, values.to_vec(), resolution, "The column \"t\"")
        };
        let (axis, doubt) = of(&[0.0, 0.1, 0.2, 0.300_000_000_000_000_04], 0.0);
        assert_eq!((axis.step().is_some(), doubt), (true, None));
        // Steps of 1.25 ms, printed in whole milliseconds: every fourth is longer.
        let printed: Vec<f64> = (0..16).map(|i| (1.25 * f64::from(i)).round() / 1e3).collect();
        let (axis, doubt) = of(&printed, 0.5e-3);
        // Both ends are rounded by half a millisecond at most.
        assert!((axis.step().unwrap() - 0.00125).abs() <= 1e-3 / 15.0);
        let doubt = doubt.unwrap();
        assert!(doubt.contains("too few digits (steps from 0.001 to 0.002 s, 4 of 15 near"), "{doubt}");
        let (_, doubt) = of(&[0.0, 1.0, 3.0], 0.0);
        assert_eq!(
            doubt.as_deref(),
            Some("The column \"t\" is uneven: steps from 1 to 2 s, 1 of 2 near the largest.")
        );
        let (_, doubt) = of(&[0.0, 2.0, 1.0], 0.0);
        assert!(doubt.unwrap().contains("does not always rise: steps from -1 to 2 s,"));
        assert_eq!(of(&[1.0], 0.0).1, None);
        assert_eq!(of(&[], 0.0).1, None);
    }

    #[test]
    fn numbers_are_printed_until_they_differ() {
        for (a, b, digits) in
            [(1.0, 2.0, 6), (2_730.67, 2_730.666_667, 7), (1.0, 1.000_000_01, 9), (1.0, 1.0, 6)]
        {
            assert_eq!(apart(a, b), digits, "{a} {b}");
        }
        assert_ne!(rounded(2_730.67, 7), rounded(2_730.666_667, 7));
    }

    #[test]
    fn lost_samples_are_not_taken_for_rounding() {
        for lost in [vec![3], vec![5, 20], vec![5, 6, 30, 70]] {
            let times: Vec<f64> =
                (0..100).filter(|i| !lost.contains(i)).map(|i| f64::from(i) / 1e3).collect();
            let (axis, doubt) = from_values(AxisKind::Time, times.clone(), 0.5e-3, "The column \"t\"");
            assert_eq!(axis.values(), times, "{lost:?}");
            assert!(doubt.unwrap().contains("is uneven: steps from 0.001"), "{lost:?}");
        }
    }
}

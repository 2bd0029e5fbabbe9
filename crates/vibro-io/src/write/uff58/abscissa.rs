//! The abscissa in the few columns that the format has for it.

use super::field;
use crate::number;
use vibro_record::{Error, Grid, Record, Result};

/// How far a value of the abscissa should be off at most, in parts of the (smallest) step: more digits are taken for it.
const WANTED: f64 = 1e-3;
/// How far it may be off, or the record is refused.
const TOLERANCE: f64 = 0.1;
/// Width of start and step in record 7, and of an abscissa in text.
const WIDTH: usize = 13;

/// Start and step of an even abscissa as they stand in record 7; zeros for an uneven one.
///
/// # Errors
/// If the format has too few digits for the abscissa of this record.
pub fn form(record: &Record, binary: bool) -> Result<[String; 2]> {
    match &record.axis().grid {
        Grid::Even { start, step, n } => {
            let last = n.saturating_sub(1) as f64;
            // Start and step take half of the tolerance each; the error of the step adds up to the last value.
            let fitting = |value: f64, times: f64| {
                let within = |part: f64| {
                    let bound = 0.5 * part * step.abs();
                    spellings(value).into_iter().find(|text| (read(text) - value).abs() * times <= bound)
                };
                within(WANTED).or_else(|| within(TOLERANCE))
            };
            fitting(*start, 1.0).zip(fitting(*step, last)).map(|(start, step)| [start, step]).ok_or_else(
                || refused(record, &format!("begins at {start} with a step of {step}, {n} values long")),
            )
        }
        Grid::Uneven(values) => {
            let steps = values.windows(2).map(|w| (w[1] - w[0]).abs()).filter(|step| *step > 0.0);
            let bound = TOLERANCE * steps.fold(f64::INFINITY, f64::min);
            let off = |value: f64| {
                let kept = if binary { f64::from(value as f32) } else { read(&field(value, WIDTH, 5)) };
                (kept - value).abs()
            };
            match values.iter().find(|value| off(**value).is_nan() || off(**value) > bound) {
                Some(value) => Err(refused(
                    record,
                    &format!("holds {value}, with neighbours {} apart", bound / TOLERANCE),
                )),
                None => Ok([0.0, 0.0].map(|zero| field(zero, WIDTH, 6))),
            }
        }
    }
}

/// Ways to write a number in its columns, the usual one first: E13.5 with one more digit where there is no sign, then as
/// many digits as go behind a blank, then as many as there are columns.
fn spellings(value: f64) -> [String; 3] {
    let dense = |room: usize| {
        let fits = |digits: &usize| format!("{value:.digits$E}").len() <= room;
        let digits = (0..room).rev().find(fits).unwrap_or(0);
        format!("{:>WIDTH$}", format!("{value:.digits$E}"))
    };
    [field(value, WIDTH, if value < 0.0 { 5 } else { 6 }), dense(WIDTH - 1), dense(WIDTH)]
}

fn read(text: &str) -> f64 {
    number::parse(text.trim().as_bytes()).unwrap_or(f64::NAN)
}

fn refused(record: &Record, what: &str) -> Error {
    let why = format!(
        "the abscissa of {} {what}: data set 58 has too few digits for it",
        crate::write::label(record)
    );
    Error::refused(why)
        .hint("write .csv or .npy, which keep every digit, or binary values (58b), or fewer at once")
}

#[cfg(test)]
mod tests {
    use super::*;
    use vibro_record::units::Unit;
    use vibro_record::{Axis, AxisKind, Meta, Trace};

    fn of(grid: Grid, binary: bool) -> Result<[String; 2]> {
        let axis = Axis { kind: AxisKind::Time, grid };
        let values = vec![0.0; axis.len()];
        form(&Record::Trace(Trace { meta: Meta::new("x", Unit::none()), axis, values }), binary)
    }

    /// A record of one value stands for a long one: only its axis is looked at.
    fn form_of_axis(axis: Axis) -> Result<[String; 2]> {
        form(&Record::Trace(Trace { meta: Meta::new("x", Unit::none()), axis, values: vec![0.0] }), false)
    }

    #[test]
    fn digits_are_taken_where_there_is_room() {
        let even = |start, step, n| of(Grid::Even { start, step, n }, false).unwrap();
        assert_eq!(even(0.0, 1.0 / 44_100.0, 7), [" 0.000000E+00", " 2.267574E-05"]);
        assert_eq!(even(123_456.789, 1.0 / 1024.0, 7), [" 1.23456789E5", " 9.765625E-04"]);
        assert_eq!(even(0.0, 1.0 / 48_000.0, 20_000)[1], " 2.0833333E-5");
        assert_eq!(even(0.0, 1.0 / 48_000.0, 200_000)[1], "2.08333333E-5");
        assert_eq!(even(-1.5, 1.0, 1)[0], " -1.50000E+00");
    }

    #[test]
    fn an_abscissa_that_would_be_distorted_is_refused() {
        let words = |result: Result<[String; 2]>| result.unwrap_err().to_string();
        let late = words(of(Grid::Even { start: 123_456.789_123_4, step: 1e-4, n: 7 }, true));
        assert!(
            late.contains("the trace \"x\" begins at 123456.7891234") && late.contains("try: write .csv"),
            "{late}"
        );
        // Nine digits of 1/48000 are off by 3.3e-14, so by 0.16 of a step after a hundred million steps.
        let axis = |n| form_of_axis(Axis::time(0.0, 1.0 / 48_000.0, n));
        assert!(axis(1_000_000).is_ok());
        let long = words(axis(100_000_000));
        assert!(long.contains("100000000 values"), "{long}");
        for binary in [false, true] {
            let far = words(of(Grid::Uneven(vec![100_000.0, 100_000.001, 100_000.003]), binary));
            assert!(far.contains("holds 100000.001"), "{far}");
            assert!(of(Grid::Uneven(vec![0.0, 0.5, 2.0, 2.0]), binary).is_ok());
            assert!(of(Grid::Uneven(vec![100_000.001]), binary).is_ok());
            assert!(of(Grid::Uneven(vec![0.0, f64::NAN]), binary).is_err());
        }
    }
}

//! Helpers of the writers: a record value by value, and records that must share an axis.

use vibro_record::{Error, Record, Result};

/// Value `i` of a record, or its real and imaginary part; NaN if there is no such value.
pub fn parts(record: &Record, i: usize) -> impl Iterator<Item = f64> + use<> {
    let (real, complex) = record.numbers();
    let (re, im) = if record.is_complex() {
        complex.get(i).map_or((f64::NAN, Some(f64::NAN)), |v| (v.re, Some(v.im)))
    } else {
        (real.get(i).copied().unwrap_or(f64::NAN), None)
    };
    std::iter::once(re).chain(im)
}

/// The first of several records that must share one axis. `what` ends the error if they do not: `abscissae:
/// a table has one`.
pub fn together<'a>(records: &'a [Record], what: &str) -> Result<&'a Record> {
    let first = records.first().ok_or_else(|| Error::refused("there is no record to write"))?;
    let Some(other) = records.iter().find(|r| r.axis() != first.axis()) else { return Ok(first) };
    let why = format!("{} and {} have different {what}", label(first), label(other));
    Err(Error::refused(why).hint("write them one by one"))
}

/// Kind and name of a record, for errors.
pub fn label(record: &Record) -> String {
    format!("the {} {:?}", record.kind(), record.meta().name)
}

pub fn failed(error: std::io::Error) -> Error {
    Error::io("write", "the output", error)
}

//! Records that were made in memory.

use crate::held::{Contents, scale};
use crate::missing;
use crate::options::{Options, POSSIBLE};
use crate::source::Source;
use rayon::prelude::*;
use vibro_record::{AxisKind, Error, Frf, Place, Record, Result, Spectrum, Trace, Values};

/// Reads the records of a source that was made in memory.
///
/// # Errors
/// If a record has no values or an impossible rate, if values are missing and that is not allowed, or if
/// one overflows a double.
pub fn read(source: &Source, options: &Options, _survey: bool) -> Result<Contents> {
    let Some(made) = source.in_records() else { return Ok(Contents::default()) };
    if let Some(empty) = made.records.iter().find(|record| record.is_empty()) {
        let found = format!("the record {:?} has no values", empty.meta().name);
        return Err(Error::input(Place::default(), found, "two values at least"));
    }
    let rates = made.records.iter().filter_map(|record| Some((record, 1.0 / record.axis().step()?)));
    let mut of_time = rates.filter(|(record, _)| record.axis().kind == AxisKind::Time);
    if let Some((record, rate)) = of_time.find(|(_, rate)| !POSSIBLE.contains(rate)) {
        let found = format!("the record {:?} has a sampling rate of {rate:e} Hz", record.meta().name);
        return Err(Error::input(Place::default(), found, "a possible number of hertz"));
    }
    let mut records = made.records.clone();
    let mut values: Vec<Values> = records.iter_mut().map(taken).collect();
    let named = records.par_iter().zip(&mut values).map(|(record, values)| (&*record.meta().name, values));
    let kept = missing::checked(named, options.allow_missing)?;
    for (record, values) in records.iter_mut().zip(values) {
        put(record, values);
        if let Some(unit) = &options.unit {
            let factor = record.meta_mut().restate_unit(unit, true);
            scale(record, factor)?;
        }
    }
    Ok(Contents::of(records, made.findings.iter().cloned().chain(kept).collect()))
}

/// The values of a record, which has none then.
fn taken(record: &mut Record) -> Values {
    match record {
        Record::Trace(Trace { values, .. }) => Values::Real(std::mem::take(values)),
        Record::Frf(Frf { values, .. }) => Values::Complex(std::mem::take(values)),
        Record::Spectrum(Spectrum { values, .. }) => std::mem::replace(values, Values::Real(Vec::new())),
    }
}

/// Gives a record its values back.
fn put(record: &mut Record, taken: Values) {
    match (record, taken) {
        (Record::Trace(Trace { values, .. }), Values::Real(taken)) => *values = taken,
        (Record::Frf(Frf { values, .. }), Values::Complex(taken)) => *values = taken,
        (Record::Spectrum(Spectrum { values, .. }), taken) => *values = taken,
        _ => {}
    }
}

#[cfg(test)]
mod tests {
    use crate::{Folder, Format, Reader, Recording};
    use vibro_record::units::Unit;
    use vibro_record::{Axis, Meta, Record, Result, Trace};

    /// Reads a trace of these values that was made in memory.
    fn read(values: &[f64], reader: Reader) -> Result<Recording> {
        let meta = Meta::new("a", Unit::parse("m").unwrap());
        let trace = Trace { meta, axis: Axis::time(0.0, 0.1, values.len()), values: values.to_vec() };
        let records = vec![Record::Trace(trace)];
        let made = Recording { path: "a".into(), format: Format::Memory, records, findings: Vec::new() };
        reader.within(&Folder::default().with_recordings([made])).from_path("a")
    }

    #[test]
    fn missing_values_are_refused_as_those_of_a_file() {
        let values = [1.0, f64::NAN, f64::INFINITY];
        let refused = read(&values, Reader::new()).unwrap_err().to_string();
        assert!(refused.contains("2 values") && refused.contains("2 of \"a\""), "{refused}");
        let kept = read(&values, Reader::new().allow_missing(true)).unwrap();
        assert_eq!(kept.findings[0].get("n"), Some(2.0));
        assert!(kept.trace(None, None).unwrap().values[2].is_nan());
        assert!(read(&[], Reader::new()).unwrap_err().to_string().contains("no values"));
    }

    #[test]
    fn options_of_reading_hold_for_records_in_memory() {
        let values: Vec<f64> = (0..100).map(f64::from).collect();
        let reader = Reader::new().span(Some((2.0, 3.0))).unit(Unit::parse("mm"));
        let part = read(&values, reader).unwrap().trace(None, None).unwrap();
        assert_eq!((part.values.len(), part.axis.start()), (10, 2.0));
        // A stated unit takes the place of the record's: 20 mm.
        assert!((part.values[0] - 0.02).abs() < 1e-15, "{}", part.values[0]);
    }
}

//! A part of time traces, from one time to another.

use crate::assemble::{drift, epoch, from_values, short};
use crate::held::Contents;
use std::ops::Range;
use vibro_record::{Axis, AxisKind, Error, Grid, Meta, Record, Result};

/// Indices of the samples of `axis` that lie within a `span` in s: from its first value on and before its
/// second.
///
/// # Errors
/// If there are none.
pub fn within(axis: &Axis, span: (f64, f64)) -> Result<Range<usize>> {
    let part = axis.between(span.0, span.1);
    if !part.is_empty() {
        return Ok(part);
    }
    let found = format!("no sample from {} to {} s", short(span.0), short(span.1));
    let end = axis.at(axis.len().max(1) - 1) + axis.step().unwrap_or(0.0);
    Err(Error::usage(found, format!("a part of {} to {} s", short(axis.start()), short(end))).setting("span"))
}

/// Keeps in the history of a channel which part of it was read; of a part nothing is declared.
pub fn note(meta: &mut Meta, span: Option<(f64, f64)>, declared: Option<usize>) {
    meta.declared_n = declared.filter(|_| span.is_none());
    if let Some((from, to)) = span {
        meta.step("span", &[("from", &from), ("to", &to)]);
    }
}

/// The same contents with the time traces cut to a `span`, if there is one.
///
/// # Errors
/// If no record is over time, or none has samples there.
pub fn cut(mut contents: Contents, span: Option<(f64, f64)>) -> Result<Contents> {
    let Some(span) = span else { return Ok(contents) };
    let mut over_time = false;
    for (record, _) in &mut contents.records {
        let Record::Trace(trace) = record else { continue };
        if trace.axis.kind != AxisKind::Time || trace.axis.is_empty() {
            continue;
        }
        // Only a record that rises has one part between two times; stretches are numbered in the whole.
        let rises = |instants: &[f64]| instants.is_sorted_by(|a, b| a < b);
        if matches!(&trace.axis.grid, Grid::Uneven(instants) if !rises(instants)) {
            trace.sampling_rate()?;
        }
        // Since 1970 in the unit of the file, or since its first row in s.
        let counted = [span.0, span.1].into_iter().find_map(|t| if t.is_finite() { epoch(t) } else { None });
        let (from, factor) = counted.map_or((0.0, 1.0), |(_, factor)| (trace.meta.origin, factor));
        let part = within(&trace.axis, (span.0 * factor - from, span.1 * factor - from))?;
        if part.len() < trace.values.len() {
            let mut axis = trace.axis.part(part.clone());
            if let Grid::Uneven(instants) = axis.grid {
                let resolution = trace.meta.resolution.max(drift(&instants, false));
                let judged = from_values(AxisKind::Time, instants, resolution, "time", false);
                if judged.axis.step().is_none() {
                    trace.sampling_rate()?;
                }
                trace.meta.findings.extend(judged.found);
                (axis, trace.meta.clock) = (judged.axis, judged.clock);
            }
            trace.axis = axis;
            trace.values.truncate(part.end);
            trace.values.drain(..part.start);
        }
        note(&mut trace.meta, Some(span), None);
        over_time = true;
    }
    if over_time {
        return Ok(contents);
    }
    let found = "a part in s was stated, but no record is over time";
    Err(Error::usage(found, "a trace with its sampling rate").setting("span").setting("rate"))
}

#[cfg(test)]
mod tests {
    use crate::write::{Storage, Target};
    use crate::{Reader, Recording};
    use vibro_record::units::Unit;
    use vibro_record::{Axis, Meta, Record, Result, Trace};

    fn read(name: &str, bytes: &[u8], span: (f64, f64)) -> Result<Recording> {
        Reader::new().span(Some(span)).from_reader(name, bytes)
    }

    #[test]
    fn a_part_has_the_samples_and_times_of_the_whole() {
        // 100 samples of 8 Hz: all times are exact.
        let values: Vec<f64> = (0..100).map(|i| f64::from(i) / 128.0).collect();
        let meta = Meta::new("v", Unit::parse("m/s").unwrap());
        let trace = Trace { meta, axis: Axis::time(2.0, 0.125, 100), values };
        let row = |(i, v): (usize, &f64)| format!("{},{v}\n", trace.axis.at(i));
        let rows = trace.values.iter().enumerate().map(row).collect::<Vec<_>>().concat();
        let mut wave = Vec::new();
        Target::Wav.write(&[Record::Trace(trace.clone())], Storage::default(), &mut wave).unwrap();
        for (name, bytes) in [("x.csv", format!("time [s],v [m/s]\n{rows}").as_bytes()), ("x.wav", &wave)] {
            let Record::Trace(part) = read(name, bytes, (3.0, 4.0)).unwrap().records.remove(0) else {
                panic!()
            };
            assert_eq!(part.axis, Axis::time(3.0, 0.125, 8), "{name}");
            assert_eq!(part.values, trace.values[8..16], "{name}");
            let all = read(name, bytes, (0.0, 1e9)).unwrap().records.remove(0);
            assert_eq!(all.len(), 100, "{name}");
            let said = read(name, bytes, (20.0, 30.0)).unwrap_err().to_string();
            assert!(said.contains("no sample from 20 to 30 s; expected a part of 2 to 14.5 s"), "{said}");
            assert!(
                read(name, bytes, (4.0, 3.0)).unwrap_err().to_string().contains("a time, and a later one")
            );
        }
    }

    #[test]
    fn parts_have_open_ends_and_count_from_1970_where_the_file_does() {
        let rows = (0..100).map(|i| format!("{}.5,{i}\n", 1_700_000_000 + i)).collect::<Vec<_>>().concat();
        let text = format!("timestamp,a (V)\n{rows}");
        let begun = 1_700_000_000.5;
        let ends = (f64::NEG_INFINITY, f64::INFINITY);
        for (span, first, n) in [
            ((10.0, 20.0), 10.0, 10),
            ((begun + 10.0, begun + 20.0), 10.0, 10),
            ((begun + 90.0, ends.1), 90.0, 10),
            ((ends.0, begun + 5.0), 0.0, 5),
            ((95.0, ends.1), 95.0, 5),
        ] {
            let Record::Trace(part) = read("x.csv", text.as_bytes(), span).unwrap().records.remove(0) else {
                panic!()
            };
            assert_eq!((part.values[0], part.values.len()), (first, n), "{span:?}");
        }
    }

    #[test]
    fn what_is_not_over_time_has_no_part() {
        let said = read("x.csv", b"frequency [Hz],a [m]\n0,1\n1,2\n2,3\n", (0.0, 1.0)).unwrap_err();
        assert!(said.to_string().contains("no record is over time"), "{said}");
    }
}

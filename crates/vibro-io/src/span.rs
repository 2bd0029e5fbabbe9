//! Cuts time traces to a span of time.

use crate::assemble::{drift, epoch, from_values, short};
use crate::held::Contents;
use std::ops::Range;
use vibro_record::{Axis, AxisKind, Error, Finding, Grid, Meta, Record, Result};

/// Indices of the samples of `axis` in `span`, in s: from the first time (included) to the second
/// (excluded).
///
/// # Errors
/// If no sample lies in the span.
pub fn within(axis: &Axis, span: (f64, f64)) -> Result<Range<usize>> {
    let part = axis.between(span.0, span.1);
    if !part.is_empty() {
        return Ok(part);
    }
    let found = format!("no sample from {} to {} s", short(span.0), short(span.1));
    let (start, end) = (short(axis.start()), short(end(axis)));
    Err(Error::usage(found, format!("a part of {start} to {end} s")).setting("span"))
}

/// End of a record in s: one step behind its last sample.
fn end(axis: &Axis) -> f64 {
    axis.at(axis.len().max(1) - 1) + axis.step().unwrap_or(0.0)
}

/// A finding where a part ends later than the record, by more than a step.
pub fn beyond(axis: &Axis, to: f64) -> Option<Finding> {
    let end = end(axis);
    let is_beyond = to.is_finite() && to > end + axis.step().unwrap_or(0.0);
    is_beyond.then(|| Finding::caution("span-beyond-record").number("to", to).number("end", end))
}

/// Adds the span to a channel's history. Keeps the declared number of values only if the whole channel was
/// read.
pub fn note(meta: &mut Meta, span: Option<(f64, f64)>, declared: Option<usize>) {
    meta.declared_n = declared.filter(|_| span.is_none());
    if let Some((from, to)) = span {
        meta.step("span", &[("from", &from), ("to", &to)]);
    }
}

/// The contents with all time traces cut to `span`, in s; unchanged without a span.
///
/// # Errors
/// If no record is a time trace, or a trace has no sample in the span.
pub fn cut(mut contents: Contents, span: Option<(f64, f64)>) -> Result<Contents> {
    let Some(span) = span else { return Ok(contents) };
    let mut over_time = false;
    for (record, _) in &mut contents.records {
        let Record::Trace(trace) = record else { continue };
        if trace.axis.kind != AxisKind::Time || trace.axis.is_empty() {
            continue;
        }
        // Only in rising times is a span one contiguous part. Otherwise the error of `sampling_rate` lists
        // the stretches, numbered within the whole trace.
        let rises = |instants: &[f64]| instants.is_sorted_by(|a, b| a < b);
        if matches!(&trace.axis.grid, Grid::Uneven(instants) if !rises(instants)) {
            trace.sampling_rate()?;
        }
        // A span of dates counts from 1970, in the unit that `epoch` detects. Any other span is in s on the
        // trace's axis.
        let counted = [span.0, span.1].into_iter().find_map(|t| if t.is_finite() { epoch(t) } else { None });
        let (from, factor) = counted.map_or((0.0, 1.0), |(_, factor)| (trace.meta.origin, factor));
        let to = span.1 * factor - from;
        let part = within(&trace.axis, (span.0 * factor - from, to))?;
        trace.meta.findings.extend(beyond(&trace.axis, to));
        if part.len() < trace.values.len() {
            let mut axis = trace.axis.part(part.clone());
            if let Grid::Uneven(instants) = axis.grid {
                let resolution = trace.meta.resolution.max(drift(&instants, false));
                let judged = from_values(AxisKind::Time, instants, resolution, "time", false);
                if judged.axis.step().is_none() {
                    trace.sampling_rate()?;
                }
                trace.meta.findings.extend(judged.found);
                (axis, trace.meta.clock) = (judged.axis, judged.step_relative_std);
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
mod tests;

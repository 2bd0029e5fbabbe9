//! From a file to averages or to whole traces.

use super::super::{args, progress};
use crate::error::{Error, Result};
use crate::read::Traces;
use crate::record::{Axis, Trace, Window};
use crate::signal::segment::Segments;
use crate::signal::welch::{Averages, Welch};

/// Samples of a segment where none is stated.
pub const SEGMENT: usize = 8192;
/// This part of a hammer record stands before the blow.
pub const BEFORE: usize = 50;

/// Averages over segments, with products where there is a reference.
pub fn averages(
    typed: &args::Spectrum,
    traces: &mut Traces,
    window: Window,
    detrend: bool,
    json: bool,
) -> Result<Averages> {
    let bar = progress::bar(json);
    bar.set_length(traces.frames() as u64);
    bar.set_message("samples");
    let length = typed.segment.unwrap_or(SEGMENT.min(traces.frames()));
    let welch = Welch { segments: Segments::new(length, typed.overlap.unwrap_or(0.5))?, window, detrend };
    let averages = welch.average(traces, typed.reference.is_some(), |frames| bar.set_position(frames as u64));
    // Before a complaint, too.
    bar.finish_and_clear();
    averages
}

/// All samples of all channels.
pub fn whole<const N: usize>(traces: &mut Traces) -> Result<[Trace; N]> {
    let (mut block, mut columns) = (Vec::new(), vec![Vec::new(); N]);
    while traces.next_block(&mut block)? > 0 {
        for (column, part) in columns.iter_mut().zip(&block) {
            column.extend_from_slice(part);
        }
    }
    let (start, step) = (traces.start(), 1.0 / traces.rate());
    let all: Vec<Trace> = columns
        .into_iter()
        .zip(traces.channels())
        .map(|(values, meta)| Trace {
            meta: meta.clone(),
            axis: Axis::time(start, step, values.len()),
            values,
        })
        .collect();
    all.try_into().map_err(|all: Vec<Trace>| Error::usage(format!("{} channels", all.len()), N.to_string()))
}

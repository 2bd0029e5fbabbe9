//! Spectra and frequency response functions of time records, from channels to lines with their uncertainty.

mod options;
mod result;

pub use options::{Method, SpectralOptions};
pub use result::{Lines, Response, SpectralResult};

use super::tones;
use num_complex::Complex64;
use std::f64::consts::TAU;
use vibro_record::units::Unit;
use vibro_record::{Axis, Error, Meta, Record, Result, Scaling, Spectrum, Trace, Traces, Values};
use vibro_signal::impact::{Blows, from_blows};
use vibro_signal::integrate::in_frequency;
use vibro_signal::segment::Segments;
use vibro_signal::spectrum;
use vibro_signal::transfer::{Estimator, transfer};
use vibro_signal::welch::{Averages, Welch};

/// Samples of a segment where none is stated.
const SEGMENT: usize = 8192;
/// One part in so many of a hammer record stands before the blow.
pub(crate) const BEFORE: usize = 50;

/// The spectrum of the only channel, or with an estimator the frequency response function from the first channel to the second.
/// `progress` gets the number of samples read.
///
/// ```
/// use vibro_measure::spectral::{SpectralOptions, spectral};
/// use vibro_record::Traces;
/// use vibro_record::{Axis, Meta, Trace};
/// use vibro_record::units::Unit;
/// let values = (0..4096).map(|i| 3.0 * (std::f64::consts::TAU * i as f64 / 16.0).cos()).collect();
/// let meta = Meta::new("laser", Unit::parse("m/s").unwrap());
/// let trace = Trace { meta, axis: Axis::time(0.0, 1.0 / 1024.0, 4096), values };
/// let options = SpectralOptions { segment: Some(1024), ..SpectralOptions::default() };
/// let found = spectral(&mut Traces::from_memory(vec![trace])?, &options, |_| ())?;
/// assert!((found.value[64] - 3.0).abs() < 1e-9); // 64 Hz
/// # Ok::<(), vibro_record::Error>(())
/// ```
///
/// # Errors
/// If options contradict each other ([`SpectralOptions::check`]), there are too few channels, or the record allows no answer.
pub fn spectral(
    traces: &mut Traces,
    options: &SpectralOptions,
    progress: impl FnMut(usize) + Send,
) -> Result<SpectralResult> {
    options.check()?;
    let mut found = match options.estimator {
        None => lines(traces, options, progress),
        Some(estimator) => response(traces, options, estimator, progress),
    }?;
    if let Some(reference) = options.decibel {
        found.over(reference);
    }
    Ok(found)
}

fn lines(
    traces: &mut Traces,
    options: &SpectralOptions,
    progress: impl FnMut(usize) + Send,
) -> Result<SpectralResult> {
    let (scaling, window) = (options.scaling.unwrap_or(Scaling::Peak), options.window());
    let detrend = options.detrended();
    let mut tones = None;
    let (spectrum, averages, mut scatter) = if options.method() == Method::Welch {
        let averages = averages(traces, options, progress)?;
        let meta = traces.channels().first().cloned().unwrap_or_else(|| Meta::new("", Unit::opaque("")));
        let scatter = spectrum::scatter(&averages, scaling);
        (spectrum::averaged(&averages, 0, &meta, window, scaling)?, averages.count, scatter)
    } else {
        let [trace] = whole(traces, progress)?;
        let spectrum = spectrum::plain(&trace, window, scaling, detrend)?;
        if let Some(count) = options.tones {
            tones = Some(tones::tones(&trace, count)?);
        }
        let unknown = vec![f64::NAN; spectrum.axis.len()];
        (spectrum, 1, unknown)
    };
    let fmin = options.lowest(spectrum.axis.step().unwrap_or(0.0));
    let spectrum = in_frequency(&spectrum, options.integrate, fmin)?;
    scatter.drain(..scatter.len() - spectrum.axis.len());
    let mut found = SpectralResult::lines(
        spectrum,
        averages,
        &scatter,
        if detrend { "mean" } else { "none" },
        traces.findings(),
    );
    if let Some(tones) = tones {
        found.findings.extend(tones.findings);
        found.tones = tones.tones;
    }
    found.left_out(options.integrate, fmin);
    Ok(found)
}

fn response(
    traces: &mut Traces,
    options: &SpectralOptions,
    estimator: Estimator,
    progress: impl FnMut(usize) + Send,
) -> Result<SpectralResult> {
    let window = options.window();
    let (found, step, window, detrend, blows) = if options.hammer {
        let length = options.segment.unwrap_or(SEGMENT);
        let how = Blows {
            length,
            before: length / BEFORE,
            force_window: options.force_window,
            left_at_end: options.left_at_end,
        };
        let [force, response] = whole(traces, progress)?;
        let found = from_blows(&force, &response, &how, estimator)?;
        let window = (found.window, found.enbw);
        (found.transfer, traces.rate() / length as f64, window, "level before the blow", found.blows)
    } else {
        let averages = averages(traces, options, progress)?;
        let found = transfer(&averages, 1, traces.channels(), estimator)?;
        let detrend = if options.detrended() { "mean" } else { "none" };
        (found, averages.step(), (window.name(), window.enbw()), detrend, Vec::new())
    };
    let fmin = options.lowest(step);
    let mut found = found.integrated(options.integrate, fmin)?;
    if let Some(delay) = options.delay {
        // What comes late by τ has the factor e^(−iωτ).
        for (k, value) in found.frf.values.iter_mut().enumerate() {
            *value *= Complex64::cis(TAU * found.frf.axis.at(k) * delay);
        }
        found.frf.meta.step("delay", &[("seconds", &delay)]);
    }
    let mut result = SpectralResult::response(found, estimator, window, detrend, blows, traces.findings());
    result.left_out(options.integrate, fmin);
    Ok(result)
}

/// Averages over segments, with products where there is a second channel.
fn averages(
    traces: &mut Traces,
    options: &SpectralOptions,
    progress: impl FnMut(usize) + Send,
) -> Result<Averages> {
    let length = options.segment.unwrap_or(SEGMENT.min(traces.frames()));
    let segments = Segments::new(length, options.overlap.unwrap_or(0.5))?;
    let welch = Welch { segments, window: options.window(), detrend: options.detrended() };
    welch.average(traces, options.estimator.is_some(), progress)
}

/// All samples of all channels.
fn whole<const N: usize>(traces: &mut Traces, mut progress: impl FnMut(usize)) -> Result<[Trace; N]> {
    let (mut block, mut columns) = (Vec::new(), vec![Vec::new(); N]);
    while traces.next_block(&mut block)? > 0 {
        for (column, part) in columns.iter_mut().zip(&block) {
            column.extend_from_slice(part);
        }
        progress(columns.first().map_or(0, Vec::len));
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

/// The coherence of a function as a record.
fn coherence(axis: &Axis, values: &[f64]) -> Record {
    Record::Spectrum(Spectrum {
        meta: Meta::new("coherence", Unit::parse_or_opaque("1")),
        axis: axis.clone(),
        values: Values::Real(values.to_vec()),
        scaling: Scaling::Coherence,
        window: None,
        enbw: None,
    })
}

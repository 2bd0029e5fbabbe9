//! How impacts are found, and whether a trace allows it.

use vibro_record::units::notation::shortest;
use vibro_record::{Error, Grid, Result, Trace};

/// How impacts are found.
#[derive(Debug, Clone, PartialEq)]
pub struct ImpactsOptions {
    /// Lowest impact as a part of the median one. Default 1/8.
    pub threshold: f64,
    /// Pause in s that separates two impacts. Default: from the pauses of the trace.
    pub refractory: Option<f64>,
    /// Whether mains hum is removed. Default true.
    pub hum: bool,
    /// One recorded pulse of the shape that all have. Default: the average of the pulses.
    pub shape: Option<Trace>,
    /// Whether no impact is missed and none is too many, however uneven the intervals. Default false.
    pub complete: bool,
    /// Frequency of the excitation in Hz, for impacts per cycle.
    pub excitation: Option<f64>,
    /// Samples of a channel that rises once a cycle of the excitation, recorded with the trace.
    pub reference: Option<Vec<f64>>,
}

impl Default for ImpactsOptions {
    fn default() -> ImpactsOptions {
        ImpactsOptions {
            threshold: 0.125,
            refractory: None,
            hum: true,
            shape: None,
            complete: false,
            excitation: None,
            reference: None,
        }
    }
}

/// Checks options and trace, and gives the sampling rate in Hz.
pub(super) fn check(trace: &Trace, options: &ImpactsOptions) -> Result<f64> {
    let rate = rate_of(trace)?;
    if !(0.0..1.0).contains(&options.threshold) {
        let found = format!("a threshold of {}", options.threshold);
        return Err(Error::usage(found, "a part of the median height, from 0 to 1"));
    }
    for (name, value) in [("a refractory time", options.refractory), ("an excitation", options.excitation)] {
        if let Some(v) = value.filter(|v| !(v.is_finite() && *v > 0.0)) {
            return Err(Error::usage(format!("{name} of {v}"), "a finite number above 0"));
        }
    }
    no_gaps(trace, &trace.values, "the trace")?;
    if trace.values.iter().all(|v| Some(v) == trace.values.first()) {
        return Err(Error::refused("all values of the trace are equal: it has no impacts"));
    }
    if let Some(reference) = &options.reference {
        let (n, expected) = (reference.len(), trace.values.len());
        if n != expected {
            let why = format!("the reference channel has {n} samples, the trace {expected}");
            return Err(Error::refused(why));
        }
        no_gaps(trace, reference, "the reference channel")?;
    }
    Ok(rate)
}

/// Sampling rate of a trace in Hz.
///
/// # Errors
/// Where it has none.
pub(crate) fn rate_of(trace: &Trace) -> Result<f64> {
    trace.rate().filter(|r| r.is_finite() && *r > 0.0).ok_or_else(|| match trace.axis.grid {
        Grid::Uneven(_) => Error::refused("the trace is sampled unevenly: it has no sampling rate")
            .hint("cut the file where samples are lost, or write them"),
        Grid::Even { .. } => Error::usage("the sampling rate of the trace is not known", "")
            .hint("state the sampling rate in Hz, or the base band of an analyser: it samples at 2.56 times that")
            .setting("rate")
            .setting("base_band"),
    })
}

/// Refuses missing values: an impact, or the begin of a cycle, may stand in any of them.
fn no_gaps(trace: &Trace, values: &[f64], name: &str) -> Result<()> {
    let missing: Vec<usize> = (0..values.len()).filter(|i| !values[*i].is_finite()).collect();
    let (Some(first), Some(last)) = (missing.first(), missing.last()) else { return Ok(()) };
    let [first, last] = [first, last].map(|i| shortest(trace.axis.at(*i)));
    let n = missing.len();
    let why = format!("{n} values of {name} are missing or infinite, from {first} s to {last} s");
    Err(Error::refused(why).hint("cut the file before or behind them"))
}

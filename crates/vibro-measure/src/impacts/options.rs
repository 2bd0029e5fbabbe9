//! How impacts are found.

use super::unfit;
use super::{Scatter, Shape};
use vibro_record::{Error, Result, Trace};

/// How impacts are found.
#[derive(Debug, Clone, PartialEq)]
pub struct ImpactsOptions {
    /// Bursts lower than this part of the median burst are no impacts. Default 1/8.
    pub threshold: f64,
    /// Pause in s that parts two impacts. Default: found from the pauses of the trace.
    pub refractory: Option<f64>,
    /// Whether mains hum is looked for and taken away. Default true.
    pub hum: bool,
    /// Whether it is known that no impact is missed and none is too many, however uneven the intervals. Default false.
    pub complete: bool,
    /// Frequency of the excitation in Hz, for impacts per cycle.
    pub excitation: Option<f64>,
    /// Its standard uncertainty in Hz. Default: that of the digits it is written with.
    pub excitation_std: Option<f64>,
    /// Samples of a channel that rises once a cycle of the excitation, taken together with the trace.
    pub reference: Option<Vec<f64>>,
    /// Shape of the pulses over time in samples, where it is known; its origin is the time of the impact.
    pub shape: Option<Shape>,
    /// Whether onsets or intervals are known to scatter. Default: unknown.
    pub scatter: Scatter,
}

impl Default for ImpactsOptions {
    fn default() -> ImpactsOptions {
        ImpactsOptions {
            threshold: 0.125,
            refractory: None,
            hum: true,
            complete: false,
            excitation: None,
            excitation_std: None,
            reference: None,
            shape: None,
            scatter: Scatter::Unknown,
        }
    }
}

/// Whether the options can be, and the trace can be looked at.
///
/// # Errors
/// Where they or it cannot.
pub fn check(trace: &Trace, options: &ImpactsOptions) -> Result<()> {
    if !(0.0..1.0).contains(&options.threshold) {
        return Err(Error::usage(
            format!("a threshold of {}", options.threshold),
            "0 to 1, of the median height",
        ));
    }
    for (what, value) in [
        ("a refractory time", options.refractory),
        ("an excitation", options.excitation),
        ("an uncertainty of the excitation", options.excitation_std),
    ] {
        if let Some(v) = value.filter(|v| !(v.is_finite() && *v > 0.0)) {
            return Err(Error::usage(format!("{what} of {v}"), "a finite number above 0"));
        }
    }
    unfit::lost(trace, &trace.values, "the trace", "an impact may stand in any of them")?;
    if trace.values.iter().all(|v| Some(v) == trace.values.first()) {
        return Err(Error::refused("all values of the trace are equal: there are no impacts in it"));
    }
    if options.reference.as_ref().is_some_and(|r| r.len() != trace.values.len()) {
        return Err(Error::refused("the reference channel has another number of samples than the trace"));
    }
    let reference = options.reference.as_deref().unwrap_or_default();
    unfit::lost(trace, reference, "the reference channel", "a cycle may begin in any of them")
}

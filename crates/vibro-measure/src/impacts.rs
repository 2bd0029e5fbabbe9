//! Impacts in a trace: a contact circuit, or any signal that jumps at each of them.
//!
//! One pipeline: [`detect`] removes drift and mains hum and times each burst above the noise once, ringing included, below a sample;
//! [`impacts`] numbers the impacts, missed and doubled ones allowed for, fits their mean interval, and compares them with the
//! excitation. What was assumed and what is doubtful is in [`Impacts::findings`].

mod background;
mod count;
mod detect;
mod drift;
mod excitation;
mod hum;
mod interval;
mod locking;
mod multiples;
mod onset;
mod options;
mod pattern;
mod recorder;
mod reference;
mod result;
mod ringing;
mod shape;
mod spline;

pub use detect::{Detected, detect};
pub use hum::Hum;
pub use interval::{Interval, Scatter, interval};
pub use locking::{PerCycle, Phase, typed};
pub use options::ImpactsOptions;
pub use result::Impacts;
pub use shape::Shape;

pub(crate) use options::rate_of;

use super::Estimate;
use background::median;
use count::{Counted, count};
use onset::Timing;
use vibro_record::{Error, Finding, Result, Severity, Trace};

/// Intervals that spread by less than this part of their median are regular.
const REGULAR: f64 = 0.05;

/// Finds the impacts of `trace`, their mean interval, and what they repeat.
///
/// # Errors
/// Where the trace has no sampling rate, missing or equal values, or fewer than two impacts; where the reference channel has fewer than two
/// edges; on impossible options.
pub fn impacts(trace: &Trace, options: &ImpactsOptions) -> Result<Impacts> {
    let Detected { times, heights, onset_std, hum, mut findings, timing, resolution } =
        detect(trace, options)?;
    let steps: Vec<f64> = times.windows(2).map(|w| w[1] - w[0]).collect();
    let counted = count(&times, &steps, options.complete);
    let kept: Vec<f64> = counted.kept.iter().map(|i| times[*i]).collect();
    let length = counted.length;
    let even = if length > 1 {
        pattern::evened(&kept, &counted.index, &counted.place, length)
    } else {
        kept.clone()
    };
    let fitted = interval(&even, &counted.index, options.scatter)
        .ok_or_else(|| Error::refused("one impact alone counts: an interval needs two"))?;
    if fitted.wanders {
        findings.push(Finding::caution("intervals-drift"));
    }
    findings.extend(counted.unsure.clone());
    // What onsets anywhere within a sample leave open, as a part of the interval.
    let span = counted.index.last().copied().unwrap_or(0) as f64;
    let sampled = resolution.map_or(0.0, |step| reference::quantised(span * fitted.mean / step));
    // The shifts of the places of a pattern are fitted with the interval.
    let free = |parameters: usize| even.len().saturating_sub(parameters) as f64;
    let widened = if length > 1 { (free(2) / free(1 + length)).sqrt() } else { 1.0 };
    let doubted = findings.iter().any(|f| f.severity == Severity::Doubt);
    let std = (widened * fitted.std).hypot(sampled * fitted.mean);
    let std = Some(std).filter(|s| s.is_finite() && !doubted);
    let median_interval = median(&steps);
    let of = |value, std, unit| Estimate::new(value, std, unit, kept.len(), described(kept.len(), timing));
    let mut answer = Impacts {
        n: times.len(),
        interval: of(fitted.mean, std, "s"),
        frequency: of(1.0 / fitted.mean, std.map(|s| s / fitted.mean.powi(2)), "Hz"),
        median_interval,
        spread: deviation(&single(&kept, &counted)),
        serial_correlation: Some(fitted.correlation).filter(|r| r.is_finite()),
        pattern: (length > 1).then_some(length),
        missed: counted.missed,
        doubled: counted.doubled,
        excitation: None,
        per_cycle: None,
        beat: None,
        regular: deviation(&single(&even, &counted)).is_some_and(|s| s < REGULAR * median_interval),
        phases: Vec::new(),
        onset_std,
        heights,
        phase: Vec::new(),
        hum,
        times,
        findings,
    };
    let rate = rate_of(trace)?;
    excitation::compare(&mut answer, &counted, (trace.axis.start(), rate, sampled), options)?;
    let of_train = of_train(&answer, counted.unsure.is_none());
    answer.findings.extend(of_train);
    Ok(answer)
}

/// Intervals between neighbours without a missed impact between them.
fn single(times: &[f64], counted: &Counted) -> Vec<f64> {
    let pairs = times.windows(2).zip(counted.index.windows(2));
    pairs.filter(|(_, k)| k[1] - k[0] == 1).map(|(t, _)| t[1] - t[0]).collect()
}

/// Standard deviation; `None` of fewer than two values.
fn deviation(values: &[f64]) -> Option<f64> {
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    (values.len() >= 2).then(|| (values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / (n - 1.0)).sqrt())
}

/// Findings on the spread of the intervals and, where it is `sure`, on their count.
fn of_train(found: &Impacts, sure: bool) -> Vec<Finding> {
    let mut all = Vec::new();
    if let Some(length) = found.pattern {
        all.push(Finding::note("interval-pattern").count("n", length));
    }
    if found.n == 2 {
        all.push(Finding::note("one-interval"));
    }
    if sure && found.missed > 0 {
        all.push(Finding::caution("impacts-missed").count("n", found.missed));
    }
    if sure && found.doubled > 0 {
        all.push(Finding::caution("impacts-doubled").count("n", found.doubled));
    }
    if let Some(spread) = found.spread.filter(|_| !found.regular && found.excitation.is_none()) {
        all.push(Finding::caution("impacts-irregular").number("spread", spread / found.median_interval));
    }
    all
}

/// How the interval of `n` impacts was found.
fn described(n: usize, timing: Timing) -> String {
    let fit = if n < 3 { "difference of two onsets" } else { "generalised least squares of the intervals" };
    let onsets = match timing {
        Timing::Flank => "onsets at half height of the rising flanks",
        Timing::Average => "onsets by matching each pulse to the average pulse",
        Timing::Known => "onsets by matching each pulse to its known shape",
    };
    format!("{fit}; {onsets}")
}

#[cfg(test)]
mod tests;

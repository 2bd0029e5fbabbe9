//! Impacts in a trace: a contact circuit, or any signal that jumps at each of them.
//!
//! A burst over the background is one impact, ringing included; its time is that at which the first rising flank passes half its
//! height, below a sample. What is counted, what is left out and what was assumed is in [`Impacts::warnings`].

mod burst;
mod count;
mod cycle;
mod cycles;
mod doubts;
mod drift;
mod excited;
mod found;
mod held;
mod hum;
mod interval;
mod multiples;
mod onset;
mod options;
mod pattern;
mod result;
mod ringing;
mod shape;
mod unfit;

pub use cycle::{PerCycle, Phase, typed};
pub use hum::Hum;
pub use interval::{Interval, Scatter, interval};
pub use onset::Timing;
pub use options::ImpactsOptions;
pub use result::Impacts;
pub use shape::{Matched, Shape};

use super::Estimate;
use burst::median;
use count::count;
use doubts::doubts;
use found::{Found, find};
use options::check;
use std::fmt::Write as _;
use vibro_record::units::notation::quantity;
use vibro_record::{Error, Result, Trace};

/// Intervals that spread by less than this part of their median are regular.
pub const REGULAR: f64 = 0.05;

/// Finds the impacts of `trace` and what they repeat.
///
/// # Errors
/// Where the trace has no sampling rate, missing or equal values, or fewer than two impacts; where the reference channel has fewer than two
/// edges; on options that cannot be.
pub fn impacts(trace: &Trace, options: &ImpactsOptions) -> Result<Impacts> {
    let (mut found, of_train) = with_train(trace, options)?;
    found.warnings.extend(of_train);
    Ok(found)
}

/// As [`impacts`], with what there is to say of them as a steady train beside the warnings.
pub(super) fn with_train(trace: &Trace, options: &ImpactsOptions) -> Result<(Impacts, Vec<String>)> {
    let rate = rate_of(trace)?;
    check(trace, options)?;
    let found = find(trace, rate, options);
    if found.onsets.len() < 2 {
        return Err(found.too_few(trace.meta.unit.symbol()));
    }
    let Found { onsets, timing, sharp, held, hum, lost, mut warnings, .. } = found;
    let start = trace.axis.start();
    let times: Vec<f64> = onsets.iter().map(|o| start + o.time / rate).collect();
    let steps: Vec<f64> = times.windows(2).map(|w| w[1] - w[0]).collect();
    let counted = count(&times, &steps, options.complete);
    let kept: Vec<f64> = counted.kept.iter().map(|i| times[*i]).collect();
    let even = if counted.length > 1 {
        pattern::evened(&kept, &counted.index, &counted.place, counted.length)
    } else {
        kept.clone()
    };
    let found = interval(&even, &counted.index, options.scatter)
        .ok_or_else(|| Error::refused("one impact alone counts: an interval needs two"))?;
    // The shifts of the places are fitted, too.
    let free = |n: usize| even.len().saturating_sub(n) as f64;
    let mut of_train = Vec::new();
    if found.wanders {
        of_train.push(
            "Intervals change slowly along the record: the uncertainty of their mean may be too small; measure longer.".to_owned(),
        );
    }
    let widened = if counted.length > 1 { (free(2) / free(1 + counted.length)).sqrt() } else { 1.0 };
    // What the samples hide of first and last, as a part of the interval.
    let span = counted.index.last().zip(counted.index.first()).map_or(0, |(l, f)| l - f) as f64;
    let hidden = if sharp { cycle::quantised(span * found.mean * rate / held as f64) } else { 0.0 };
    let std = Some((widened * found.std).hypot(hidden * found.mean))
        .filter(|s| s.is_finite() && !lost && counted.unsure.is_none());
    if sharp {
        warnings.push(format!(
            "The pulses rise within one sample: onsets are known to {} only.",
            quantity(held as f64 / (12f64.sqrt() * rate), "s", 2)
        ));
    }
    let single = |times: &[f64]| -> Vec<f64> {
        let next = |k: &[usize]| k[1] - k[0] == 1;
        let both = times.windows(2).zip(counted.index.windows(2));
        both.filter(|(_, k)| next(k)).map(|(t, _)| t[1] - t[0]).collect()
    };
    let median_interval = median(&steps);
    let spread = deviation(&single(&kept));
    let regular = deviation(&single(&even)).is_some_and(|s| s < REGULAR * median_interval);
    let mut method = described(&found, kept.len(), timing);
    if sharp {
        method.push_str("; first and last onset anywhere within a sample");
    }
    if counted.length > 1 {
        let _ = write!(method, "; a pattern of {} impacts fitted with it", counted.length);
    }
    let mut answer = Impacts {
        n: times.len(),
        interval: Estimate::new(found.mean, std, "s", kept.len(), method.as_str()),
        frequency: Estimate::new(
            1.0 / found.mean,
            std.map(|s| s / found.mean.powi(2)),
            "Hz",
            kept.len(),
            method,
        ),
        median_interval,
        spread,
        serial_correlation: Some(found.correlation).filter(|r| r.is_finite()),
        pattern: (counted.length > 1).then_some(counted.length),
        missed: counted.missed,
        doubled: counted.doubled,
        excitation: None,
        per_cycle: None,
        beat: None,
        regular,
        phases: Vec::new(),
        onset_std: Some(median(&onsets.iter().map(|o| o.std).collect::<Vec<f64>>()) / rate)
            .filter(|s| s.is_finite()),
        heights: onsets.iter().map(|o| o.height).collect(),
        phase: Vec::new(),
        hum,
        times,
        warnings: Vec::new(),
    };
    excited::compare(&mut answer, &counted, (start, rate, hidden), options, &mut of_train)?;
    doubts(&answer, &mut of_train);
    of_train.extend(counted.unsure);
    answer.warnings = warnings;
    Ok((answer, of_train))
}

/// Sampling rate of a trace.
///
/// # Errors
/// Where it has none.
pub(super) fn rate_of(trace: &Trace) -> Result<f64> {
    trace.rate().filter(|r| r.is_finite() && *r > 0.0).ok_or_else(|| {
        unfit::uneven(trace).unwrap_or_else(|| {
            Error::usage("the file does not say at which even rate the trace was sampled", "a sampling rate")
                .hint("--rate HZ, or --base-band HZ for an analyser that samples at 2.56 times its base band")
        })
    })
}

fn deviation(values: &[f64]) -> Option<f64> {
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    (values.len() >= 2).then(|| (values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / (n - 1.0)).sqrt())
}

fn described(found: &Interval, n: usize, timing: Timing) -> String {
    let onsets = match timing {
        Timing::Flank => "onsets at half height of the rising flanks",
        Timing::Average => "onsets by matching each pulse to the average pulse",
        Timing::Known => "onsets by matching each pulse to its known shape",
    };
    if n < 3 {
        return format!("difference of two onsets; {onsets}");
    }
    let line = match (found.onset > 0.0, found.jitter > 0.0) {
        (_, false) => {
            "generalised least squares, nearest the straight line through index and time (onset noise alone)"
        }
        (false, true) => "generalised least squares, nearest (t_last − t_first)/(n − 1) (jitter alone)",
        (true, true) => "generalised least squares of the intervals (onset noise and jitter)",
    };
    let correlation = if found.correlation.is_finite() {
        format!(", serial correlation of intervals {:.2}", found.correlation)
    } else {
        String::new()
    };
    format!(
        "{line}: onset noise {}, cycle-to-cycle jitter {}{correlation}; {onsets}",
        quantity(found.onset, "s", 3),
        quantity(found.jitter, "s", 3)
    )
}

#[cfg(test)]
pub(super) mod tests;

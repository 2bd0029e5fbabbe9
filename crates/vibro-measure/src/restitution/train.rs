//! Restitution from a train of bounces: flight times shrink by R from bounce to bounce, `ln Δt_n = ln Δt₁ + (n − 1) ln R`.

use super::bounces::{Flight, fit};
use super::{Way, above_zero, not_negative, repeated, together};
use crate::Estimate;
use crate::impacts::{Detected, ImpactsOptions, detect};
use vibro_record::{Error, Finding, Result, Trace};

/// Flight times of one train of bounces.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Train {
    /// Times between successive impacts, in s.
    pub intervals: Vec<f64>,
    /// Standard uncertainty of one impact's time, in s, where it is known.
    pub onset_std: Option<f64>,
}

impl Train {
    /// Lowest bounce as a part of the median one.
    pub const THRESHOLD: f64 = 0.02;

    /// The bounces of a falling body, with its impacts; what precedes the first large one is handling, not an impact.
    ///
    /// # Errors
    /// As [`detect`]; also where fewer than two impacts are left.
    pub fn of(trace: &Trace, options: &ImpactsOptions) -> Result<(Train, Detected)> {
        let mut found = detect(trace, options)?;
        let largest = found.heights.iter().copied().fold(0.0, f64::max);
        // A body strikes first as hard as it ever does; half of that leaves room for coarse samples.
        let first = found.heights.iter().position(|h| *h >= 0.5 * largest).unwrap_or(0);
        if first > 0 {
            found.findings.push(Finding::note("handling-ignored").count("n", first));
            found.times.drain(..first);
            found.heights.drain(..first);
        }
        if found.times.len() < 2 {
            let few = Error::refused("one impact found: restitution from a drop needs two");
            let few = few.hint("a lower threshold, or a shorter pause between impacts");
            return Err(few.setting("threshold").setting("refractory"));
        }
        let intervals = found.times.windows(2).map(|w| w[1] - w[0]).collect();
        Ok((Train { intervals, onset_std: found.onset_std }, found))
    }
}

/// R of trains of bounces, the mean of their ln R; `None` where no train has two flights.
pub(super) fn answer(trains: &[Train], findings: &mut Vec<Finding>) -> Result<Option<Way>> {
    let (mut logs, mut stds, mut n) = (Vec::new(), Vec::new(), 0);
    for (train, t) in trains.iter().enumerate().map(|(i, t)| (i + 1, t)) {
        not_negative("an uncertainty of the time of an impact", t.onset_std)?;
        for interval in &t.intervals {
            above_zero("a flight time", *interval)?;
        }
        // A train of one flight has no ratio.
        if t.intervals.len() < 2 {
            continue;
        }
        let mut flights: Vec<Flight> =
            t.intervals.iter().enumerate().map(|(place, d)| Flight { place, log: d.ln() }).collect();
        while let Some((worst, expected)) = worst(&flights) {
            let bad = flights.remove(worst);
            findings.push(
                Finding::caution("flight-outlier")
                    .count("flight", bad.place + 1)
                    .count("train", train)
                    .number("interval", bad.log.exp())
                    .number("expected", expected),
            );
        }
        let noise = t.onset_std.unwrap_or(0.0);
        let (log, std) = fit(&flights, t.onset_std)
            .ok_or_else(|| Error::refused("flight times from which no ratio follows"))?;
        if let Some(flight) = grown(&flights, noise).or(flights.last().filter(|_| log >= 0.0)) {
            let flight = flight.place + 1;
            let why =
                format!("flight times grow, at flight {flight} of train {train}: R would not be below 1");
            return Err(
                Error::refused(why).hint("the intervals in the order of the bounces, all of one train")
            );
        }
        n += flights.len();
        logs.push(log);
        stds.push(std);
    }
    if logs.is_empty() {
        return Ok(None);
    }
    // From four trains on their scatter shows all that is uncertain in each.
    let (log, std) = repeated(&logs, together(stds.into_iter()).filter(|_| logs.len() < 4));
    let value = log.exp();
    if std.is_none() {
        findings.push(Finding::caution("too-few-flights").count("n", n).count("trains", logs.len()));
    }
    findings.push(Finding::note("flight-times-assume"));
    let method = format!("log-linear fit of {n} flight times");
    let restitution = Estimate::new(value, std.map(|s| value * s), "1", n, method);
    Ok(Some(Way { method: "flight times", restitution }))
}

/// Growth beyond this many standard deviations of the onset noise is none of it.
const BEYOND: f64 = 4.0;

/// A flight that is longer than the one before it, which the noise of the onsets does not explain.
fn grown(flights: &[Flight], onset_std: f64) -> Option<&Flight> {
    let grows = |pair: &&[Flight]| {
        let (before, after) = (pair[0].log.exp(), pair[1].log.exp());
        // Two neighbours have the variance 6σ²: they share an onset.
        after - before > (BEYOND * onset_std * 6f64.sqrt()).max(1e-3 * before)
    };
    flights.windows(2).find(grows).map(|pair| &pair[1])
}

/// Quantile 0.9995 of Student's t from 2 degrees of freedom on: what lies beyond is an outlier.
const OUTSIDE: [f64; 9] = [31.6, 12.92, 8.61, 6.87, 5.96, 5.41, 5.04, 4.78, 4.59];

/// How far the flight `one` is from what the `others` expect, in parts of the quantile, and that logarithm: by the straight line through the
/// logarithms, where the variance of a logarithm goes as Δt to −`power`.
fn off(one: &Flight, others: &[Flight], power: f64) -> Option<(f64, f64)> {
    let free = others.len().checked_sub(4)?;
    let weight = |log: f64| (power * log).exp();
    let sum =
        |f: &dyn Fn(&Flight) -> f64| others.iter().map(|other| weight(other.log) * f(other)).sum::<f64>();
    let total = sum(&|_| 1.0);
    let (place, log) = (sum(&|f| f.place as f64) / total, sum(&|f| f.log) / total);
    let x = |f: &Flight| f.place as f64 - place;
    let sxx = sum(&|f| x(f) * x(f));
    let slope = sum(&|f| x(f) * (f.log - log)) / sxx;
    let residual = |f: &Flight| f.log - log - slope * x(f);
    let expected = one.log - residual(one);
    let leverage = weight(expected).recip() + total.recip() + x(one) * x(one) / sxx;
    let variance = sum(&|f| residual(f).powi(2)) / (free + 2) as f64 * leverage;
    // Numbers that were typed have three digits at least: half a unit of the last is 1e-3 of a flight.
    let score = residual(one).abs() / variance.max(1e-6).sqrt();
    Some((score / OUTSIDE[free.min(OUTSIDE.len() - 1)], expected))
}

/// The flight that fits the others worst, where it is an outlier, and the time that they expect of it: one whether R scatters, which makes the
/// variances of logarithms alike, or the onsets do, which makes them go as 1/Δt².
fn worst(flights: &[Flight]) -> Option<(usize, f64)> {
    let scored = |i: usize| {
        let mut others = flights.to_vec();
        let one = others.remove(i);
        let (alike, timed) = (off(&one, &others, 0.0)?, off(&one, &others, 2.0)?);
        let (score, expected) = if timed.0 < alike.0 { timed } else { alike };
        Some((i, score, expected.exp()))
    };
    let worst = (0..flights.len()).filter_map(scored).max_by(|a, b| a.1.total_cmp(&b.1))?;
    (worst.1 > 1.0).then_some((worst.0, worst.2))
}

//! Restitution from a train of bounces: flight times shrink by R from bounce to bounce, `ln Δt_n = ln Δt₁ + (n − 1) ln R`.
//!
//! R scatters from bounce to bounce, which makes the logarithms a random walk, and from train to train; noise of the onsets, which neighbouring
//! flights share, weighs the more the shorter the flight. Which of these is at work follows from the flights themselves: [`super::ratios`].

use super::ratios::{TRAINS, fit};
use super::{Method, Shares, Way, above_zero, not_negative};
use crate::Estimate;
use serde::Serialize;
use vibro_record::{Error, Finding, Result};

/// Flight times of one train of bounces.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Train {
    /// Times between successive impacts, in s.
    pub intervals: Vec<f64>,
    /// Standard uncertainty of one impact's time, in s, where it is known.
    pub onset_std: Option<f64>,
}

/// A flight time that does not fit the train.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[non_exhaustive]
pub struct Outlier {
    /// Train, counted from 1.
    pub train: usize,
    /// Flight, counted from 1.
    pub flight: usize,
    /// Its time in s.
    pub interval: f64,
    /// What the others say it should be, in s.
    pub expected: f64,
}

/// Most flights: the time of the fit grows with their cube.
const MOST: usize = 300;

/// One flight: train, place in the train, logarithm.
#[derive(Clone, Copy)]
pub(super) struct Flight {
    pub(super) train: usize,
    pub(super) place: usize,
    pub(super) log: f64,
}

/// R of trains of bounces; `None` where no train has two flights.
pub(super) fn answer(
    trains: &[Train],
    outliers: &mut Vec<Outlier>,
    findings: &mut Vec<Finding>,
) -> Result<Option<Way>> {
    let mut flights = Vec::new();
    for (train, t) in trains.iter().enumerate() {
        not_negative("an uncertainty of the time of an impact", t.onset_std)?;
        for interval in &t.intervals {
            above_zero("a flight time", *interval)?;
        }
        // A train of one flight has no ratio.
        if t.intervals.len() > 1 {
            flights.extend(t.intervals.iter().enumerate().map(|(place, d)| Flight {
                train,
                place,
                log: d.ln(),
            }));
        }
    }
    if flights.is_empty() {
        return Ok(None);
    }
    if flights.len() > MOST {
        return Err(Error::refused(format!(
            "{} flight times: restitution takes {MOST} at most",
            flights.len()
        ))
        .hint("the mean interval of impacts, for a long record"));
    }
    while let Some((worst, expected)) = worst(&flights) {
        let bad = flights.remove(worst);
        outliers.push(Outlier {
            train: bad.train + 1,
            flight: bad.place + 1,
            interval: bad.log.exp(),
            expected,
        });
    }
    outliers.sort_by_key(|o| (o.train, o.flight));
    for o in outliers.iter() {
        findings.push(
            Finding::caution("flight-outlier")
                .count("flight", o.flight)
                .count("train", o.train)
                .number("interval", o.interval)
                .number("expected", o.expected),
        );
    }
    let Some(fit) = fit(&flights, trains) else {
        return Err(Error::refused("flight times from which no ratio follows"));
    };
    let value = fit.log_r.exp();
    if let Some((train, flight)) = growing(&flights, trains, value) {
        return Err(Error::refused(format!(
            "flight times grow, at flight {flight} of train {train}: R would not be below 1"
        ))
        .hint("the intervals in the order of the bounces, all of one train"));
    }
    let std = Some(value * fit.std).filter(|s| s.is_finite());
    let n = flights.len();
    if std.is_none() {
        let without = if fit.trains_differ {
            Finding::caution("trains-differ").count("n", fit.trains).count("needed", TRAINS)
        } else {
            Finding::caution("too-few-flights").count("n", n)
        };
        let onsets = value * fit.onsets_alone;
        findings.push(if onsets.is_finite() { without.number("onsets", onsets) } else { without });
    }
    findings.push(Finding::note("flight-times-assume"));
    Ok(Some(Way {
        method: Method::FlightTimes,
        restitution: Estimate::new(value, std, "1", n, format!("log-linear fit of {n} flight times")),
        shares: Shares::Flights,
    }))
}

/// Growth beyond this many standard deviations of the onset noise is none of it.
const BEYOND: f64 = 4.0;

/// Train and flight, counted from 1, of a flight that is longer than one before it: R is not above 1.
fn growing(flights: &[Flight], trains: &[Train], value: f64) -> Option<(usize, usize)> {
    let grows = |pair: &&[Flight]| {
        let (before, after) = (pair[0].log.exp(), pair[1].log.exp());
        // Two neighbours have the variance 6σ²: they share an onset.
        let noise = trains[pair[0].train].onset_std.unwrap_or(0.0) * 6f64.sqrt();
        pair[0].train == pair[1].train && after - before > (BEYOND * noise).max(1e-3 * before)
    };
    let one = flights.windows(2).find(grows).map(|pair| pair[1]);
    one.or(flights.last().copied().filter(|_| value >= 1.0)).map(|f| (f.train + 1, f.place + 1))
}

/// Quantile 0.9995 of Student's t from 2 degrees of freedom on: what lies beyond is an outlier.
const OUTSIDE: [f64; 9] = [31.6, 12.92, 8.61, 6.87, 5.96, 5.41, 5.04, 4.78, 4.59];

/// How far the flight `one` is from what the `others` expect, in parts of the quantile, and that logarithm: by the straight line through the
/// logarithms, one slope and an offset each train, where the variance of a logarithm goes as Δt to `power`.
fn off(one: &Flight, others: &[Flight], power: f64) -> Option<(f64, f64)> {
    if others.iter().filter(|f| f.train == one.train).count() < 2 {
        return None;
    }
    let weight = |log: f64| (-power * log).exp();
    // Sum of the weights, and weighted means of place and logarithm, of each train.
    let mut means = vec![[0.0; 3]; others.iter().map(|f| f.train + 1).max()?];
    for f in others {
        let w = weight(f.log);
        let m = &mut means[f.train];
        *m = [m[0] + w, m[1] + w * f.place as f64, m[2] + w * f.log];
    }
    for m in &mut means {
        *m = [m[0], m[1] / m[0], m[2] / m[0]];
    }
    let centred = |f: &Flight| (f.place as f64 - means[f.train][1], f.log - means[f.train][2]);
    let (mut sxx, mut sxy) = (0.0, 0.0);
    for f in others {
        let (w, (x, y)) = (weight(f.log), centred(f));
        (sxx, sxy) = (sxx + w * x * x, sxy + w * x * y);
    }
    let slope = sxy / sxx;
    let residual = |f: &Flight| centred(f).1 - slope * centred(f).0;
    let free = others.len().checked_sub(3 + means.iter().filter(|m| m[0] > 0.0).count())?;
    let squares: f64 = others.iter().map(|f| weight(f.log) * residual(f).powi(2)).sum();
    let (x, expected) = (centred(one).0, one.log - residual(one));
    let leverage = weight(expected).recip() + means[one.train][0].recip() + x * x / sxx;
    let variance = squares / (free + 2) as f64 * leverage;
    // Numbers that were typed have three digits at least: half a unit of the last is 1e-3 of a flight.
    let score = residual(one).abs() / variance.max(1e-6).sqrt();
    Some((score / OUTSIDE[free.min(OUTSIDE.len() - 1)], expected))
}

/// The flight that fits the others worst, where it is an outlier, and what they expect of it: one whether R scatters, which makes the variances of
/// logarithms alike, or the onsets do, which makes them go as 1/Δt².
fn worst(flights: &[Flight]) -> Option<(usize, f64)> {
    let mut found: Option<(usize, f64, f64)> = None;
    for i in 0..flights.len() {
        let mut others = flights.to_vec();
        let one = others.remove(i);
        let (Some(alike), Some(timed)) = (off(&one, &others, 0.0), off(&one, &others, -2.0)) else {
            continue;
        };
        let (score, expected) = if timed.0 < alike.0 { timed } else { alike };
        if found.is_none_or(|f| score > f.1) {
            found = Some((i, score, expected.exp()));
        }
    }
    found.filter(|f| f.1 > 1.0).map(|f| (f.0, f.2))
}

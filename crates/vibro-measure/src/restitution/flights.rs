//! R from the flights of trains of bounces: outliers are left out, flights that grow are refused.

use super::fit::{Flight, FlightNoise, TrainFit, fit, misfit};
use super::{MethodAnswer, Train, above_zero, not_negative, repeated, together};
use crate::Estimate;
use crate::chance::{chi_squared_at, student_at};
use crate::mean::average;
use vibro_record::lanes::Extremes;
use vibro_record::{Error, Finding, Result};

/// A flight longer than the first by this factor is no bounce of the same fall.
const LONGER: f64 = 1.2;
/// Most such flights of a train: more are not the taps of a hand before and after a drop.
const HANDLED: usize = 2;

/// Number of flights longer than the first, where they are more than [`HANDLED`]: voices or ringing count as
/// impacts.
pub(super) fn longer(train: &Train) -> Option<usize> {
    let (first, rest) = train.intervals.split_first()?;
    let long = |flight: &&f64| **flight > LONGER * first;
    // Sounds after the last bounce make long intervals, too, and do not count.
    let behind = rest.iter().rev().take_while(long).count();
    let n = rest[..rest.len() - behind].iter().filter(long).count();
    (n > HANDLED).then_some(n)
}

/// From this number of trains on, their scatter alone gives the uncertainty.
pub(super) const MANY: usize = 4;

/// Confidence level of the test whether trains differ: trains that do are not fitted together.
const DIFFER: f64 = 0.95;
/// Confidence level beyond which a finding says that trains differ.
const SURELY: f64 = 0.999;

/// R of trains of bounces, `None` where no train has two flights, and the noise of their flights where it is
/// determined. Up to three trains that do not differ share R and noise and, where all begin with the same
/// `fall`, the first flight. Otherwise R is from the mean of their ln R.
pub(super) fn answer(
    trains: &[Train],
    fall: bool,
    findings: &mut Vec<Finding>,
) -> Result<(Option<MethodAnswer>, Option<FlightNoise>)> {
    let (mut all, mut fits) = (Vec::new(), Vec::new());
    for (train, t) in trains.iter().enumerate().map(|(i, t)| (i + 1, t)) {
        let flights = usable(train, t, findings)?;
        fits.extend(fitted(train, &flights, t.onset_std)?);
        all.push((flights, t.onset_std));
    }
    if fits.is_empty() {
        return Ok((None, None));
    }
    let own = FlightNoise::mean(&fits.iter().filter_map(|fit| fit.noise).collect::<Vec<_>>());
    // Whether the trains lie farther from this ln R than those of one body do with the probability `chance`.
    let apart = |log: f64, noise: Option<FlightNoise>, chance: f64| {
        let noise = noise.filter(|_| fits.len() > 1);
        noise.is_some_and(|noise| misfit(&all, log, noise) > chi_squared_at(chance, fits.len() - 1))
    };
    let alike = |joint: &TrainFit| !apart(joint.log_r, own.or(joint.noise), DIFFER);
    let joint = (all.len() < MANY).then(|| fit(&all, fall)).flatten().filter(alike);
    let logs: Vec<f64> = fits.iter().map(|fit| fit.log_r).collect();
    let (log, std, noise) = if let Some(fit) = joint {
        (fit.log_r, fit.std, fit.noise)
    } else {
        let stated = together(fits.iter().map(|fit| fit.std)).filter(|_| logs.len() < MANY);
        let (log, std) = repeated(&logs, stated);
        (log, std, own)
    };
    let n = all.iter().map(|(flights, _)| flights.len()).filter(|n| *n > 1).sum();
    let value = log.exp();
    let few = Finding::caution("too-few-flights").count("n", n).count("trains", fits.len());
    findings.extend(std.is_none().then_some(few));
    if apart(log, own, SURELY)
        && let Some((low, high)) = Extremes::of(&logs).range()
    {
        let differ = Finding::caution("trains-differ").count("trains", fits.len());
        findings.push(differ.number("low", low.exp()).number("high", high.exp()));
    }
    let method = format!("log-linear fit of {n} flight times");
    let restitution = Estimate::new(value, std.map(|s| value * s), "1", n, method);
    Ok((Some(MethodAnswer { method: "flight times", restitution }), noise))
}

/// The flights of a train without outliers.
fn usable(train: usize, t: &Train, findings: &mut Vec<Finding>) -> Result<Vec<Flight>> {
    not_negative("an uncertainty of the time of an impact", t.onset_std)?;
    t.intervals.iter().try_for_each(|interval| above_zero("a flight time", *interval))?;
    if let Some(n) = longer(t) {
        let why = format!(
            "{n} flights of series {train} of bounces are longer than the first: other sounds count as impacts"
        );
        let hint = "cut the record to the bounces, or raise the threshold; else intervals in the order of the bounces";
        return Err(Error::refused(why).hint(hint).setting("threshold").setting("refractory"));
    }
    let logs = t.intervals.iter().enumerate().map(|(place, d)| Flight { place, log: d.ln() });
    let mut flights: Vec<Flight> = logs.collect();
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
    if let Some([first, last]) = changing(&flights) {
        let found = Finding::caution("restitution-changes").count("train", train);
        findings.push(found.number("first", first).number("last", last));
    }
    Ok(flights)
}

/// Fits one train by itself; `None` for one flight, which has no ratio.
fn fitted(train: usize, flights: &[Flight], onset_std: Option<f64>) -> Result<Option<TrainFit>> {
    if flights.len() < 2 {
        return Ok(None);
    }
    let fit = fit(&[(flights.to_vec(), onset_std)], false)
        .ok_or_else(|| Error::refused("flight times from which no ratio follows"))?;
    let grown = grown(flights, onset_std.unwrap_or(0.0));
    if let Some(flight) = grown.or(flights.last().filter(|_| fit.log_r >= 0.0)) {
        let flight = flight.place + 1;
        let why = format!("the flight times grow, at flight {flight} of train {train}: R would be above 1");
        let hint = "a longer pause where ringing or echoes count as impacts; else intervals in the order of the bounces";
        return Err(Error::refused(why).hint(hint).setting("refractory"));
    }
    Ok(Some(fit))
}

/// Growth of a flight beyond this many standard deviations of the onset noise is real.
const BEYOND: f64 = 4.0;

/// The first flight that is longer than the one before it by more than the noise of the onsets explains.
fn grown(flights: &[Flight], onset_std: f64) -> Option<&Flight> {
    let grows = |pair: &&[Flight]| {
        let (before, after) = (pair[0].log.exp(), pair[1].log.exp());
        // Two neighbours have the variance 6σ²: they share an onset.
        after - before > (BEYOND * onset_std * 6f64.sqrt()).max(1e-3 * before)
    };
    flights.windows(2).find(grows).map(|pair| &pair[1])
}

/// One-sided probability of the quantile of Student's distribution beyond which a flight is an outlier, or a
/// change of R is real: by chance one of 1000 passes, on either side together.
const OUTSIDE: f64 = 0.9995;

/// R of the first and the last bounce by the straight line through ln R of each, where it rises or falls
/// beyond chance; needs four values of R. Noise of the onsets makes neighbouring R differ, so the slope
/// seems less certain than it is.
fn changing(flights: &[Flight]) -> Option<[f64; 2]> {
    let ratio = |pair: &[Flight]| {
        let places = (pair[1].place - pair[0].place) as f64;
        (0.5 * (pair[0].place + pair[1].place) as f64, (pair[1].log - pair[0].log) / places)
    };
    let points: Vec<(f64, f64)> = flights.windows(2).map(ratio).collect();
    let free = points.len().checked_sub(2).filter(|free| *free > 1)?;
    let quantile = student_at(OUTSIDE, free);
    let mean = |of: fn(&(f64, f64)) -> f64| average(&points.iter().map(of).collect::<Vec<f64>>());
    let (x, y) = (mean(|p| p.0), mean(|p| p.1));
    let sum = |of: &dyn Fn(f64, f64) -> f64| points.iter().map(|p| of(p.0 - x, p.1 - y)).sum::<f64>();
    let sxx = sum(&|x, _| x * x);
    let slope = sum(&|x, y| x * y) / sxx;
    let std = (sum(&|x, y| (y - slope * x).powi(2)) / free as f64 / sxx).sqrt();
    let line = |at: f64| (y + slope * (at - x)).exp();
    let ends = [points.first()?.0, points.last()?.0].map(line);
    // A change of R below 1 % may be the rounding of typed values.
    (slope.abs() > quantile * std && (ends[1] / ends[0]).ln().abs() > 1e-2).then_some(ends)
}

/// Residual of the flight `one` from the straight line through the logarithms of the `others`, over the
/// quantile of Student's distribution, and the logarithm expected. The variance of a logarithm goes as Δt to
/// −`power`.
fn off(one: &Flight, others: &[Flight], power: f64) -> Option<(f64, f64)> {
    let free = others.len().checked_sub(2).filter(|free| *free > 1)?;
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
    let variance = sum(&|f| residual(f).powi(2)) / free as f64 * leverage;
    // Numbers that were typed have three digits at least: half a unit of the last is 1e-3 of a flight.
    let score = residual(one).abs() / variance.max(1e-6).sqrt();
    Some((score / student_at(OUTSIDE, free), expected))
}

/// The worst outlier among flights, and the time in s that the others expect of it. It must be an outlier
/// both if R scatters, which makes the variances of logarithms equal, and if the onsets do, which makes them
/// go as 1/Δt².
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

//! Restitution from a train of bounces: flight times shrink by R from bounce to bounce, `ln Δt_n = ln Δt₁ + (n − 1) ln R`.
//!
//! R scatters from bounce to bounce, which makes the logarithms a random walk, and from train to train; noise of the onsets, which neighbouring
//! flights share, weighs the more the shorter the flight. What of these is at work the flights themselves must say: [`super::ratios`].

use super::ratios::{Fitted, TRAINS, fit};
use super::{Shares, Way, above_zero, not_negative};
use crate::Estimate;
use serde::Serialize;
use vibro_record::units::notation::quantity;
use vibro_record::{Error, Result};

/// Flight times of one train of bounces.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Train {
    /// Times between successive impacts, in s.
    pub intervals: Vec<f64>,
    /// Standard uncertainty of one impact's time, in s, where it is known.
    pub onset_std: Option<f64>,
    /// How long the record goes on after the last impact, in s.
    pub after: Option<f64>,
}

/// A flight time that does not fit the train.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
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

/// More flights than this are no train of bounces.
const MOST: usize = 300;

/// One flight: train, place in the train, logarithm.
#[derive(Clone, Copy)]
pub(super) struct Flight {
    pub(super) train: usize,
    pub(super) place: usize,
    pub(super) log: f64,
}

pub(super) fn answer(
    trains: &[Train],
    outliers: &mut Vec<Outlier>,
    warnings: &mut Vec<String>,
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
            "{} flight times: a train of bounces has fewer than {MOST}",
            flights.len()
        ))
        .hint("`vibro impacts` takes the intervals of long records"));
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
        warnings.push(format!(
            "Flight {} of train {}, {}, does not fit the others, which expect {}: it was left out.",
            o.flight,
            o.train,
            quantity(o.interval, "s", 4),
            quantity(o.expected, "s", 4)
        ));
    }
    let Some(fit) = fit(&flights, trains) else {
        return Err(Error::refused("flight times from which no ratio follows"));
    };
    let value = fit.log_r.exp();
    if value >= 1.0 {
        return Err(Error::refused(format!(
            "flight times grow, by {value:.4} from bounce to bounce: R would not be below 1"
        ))
        .hint("are the intervals in the order of the bounces, and all of one train?"));
    }
    if let Some(sentence) = grows(&flights, trains) {
        return Err(Error::refused(sentence)
            .hint("are the intervals in the order of the bounces, and all of one train?"));
    }
    let std = Some(value * fit.std).filter(|s| s.is_finite());
    if std.is_none() && fit.between.is_some() {
        warnings.push(format!(
            "R differs from train to train by more than within them; {} trains are too few for a standard uncertainty of their mean: {TRAINS} have one.",
            fit.trains
        ));
    }
    let method = described(&fit, flights.len(), value);
    bend(&flights, warnings);
    ends(trains, value, warnings);
    warnings.push("Flight times need neither height nor g; they assume that each impact is short beside its flight and that R is the same at every speed. Drag of the air makes R too low.".to_owned());
    Ok(Some(Way {
        method: "flight times",
        restitution: Estimate::new(value, std, "1", flights.len(), method),
        shares: Shares::Flights,
    }))
}

/// What the answer rests on.
fn described(fit: &Fitted, flights: usize, value: f64) -> String {
    let between =
        fit.between.map_or_else(String::new, |t| format!(", from train to train by {}", quantity(t, "1", 2)));
    if fit.std.is_finite() {
        return format!(
            "log-linear fit of {flights} flight times: ln R scatters by {} from bounce to bounce{between}, onsets by {}",
            quantity(fit.scatter, "1", 2),
            quantity(fit.onset, "s", 2)
        );
    }
    let what = match (flights, fit.between) {
        (_, Some(_)) => {
            format!("log-linear fit of {flights} flight times of {} trains that differ{between}", fit.trains)
        }
        (2, None) => "ratio of two flight times, which shows no scatter of R".to_owned(),
        (_, None) => {
            format!(
                "log-linear fit of {flights} flight times, too few for a standard uncertainty from their scatter"
            )
        }
    };
    if fit.onsets_alone.is_finite() {
        return format!(
            "{what} (the stated onsets alone would give {})",
            quantity(value * fit.onsets_alone, "1", 2)
        );
    }
    what
}

/// Growth that the noise of the onsets does not explain is beyond this many of its standard deviations.
const BEYOND: f64 = 4.0;

/// Says where a flight is longer than one before it in its train.
fn grows(flights: &[Flight], trains: &[Train]) -> Option<String> {
    for pair in flights.windows(2).filter(|w| w[0].train == w[1].train) {
        let (before, after) = (pair[0].log.exp(), pair[1].log.exp());
        // Two neighbours have the variance 6σ²: they share an onset.
        let noise = trains.get(pair[0].train).and_then(|t| t.onset_std).unwrap_or(0.0) * 6f64.sqrt();
        if after - before > (BEYOND * noise).max(1e-3 * before) {
            return Some(format!(
                "flight times grow: flight {} of train {} takes {}, the one before {}: R would not be below 1",
                pair[1].place + 1,
                pair[1].train + 1,
                quantity(after, "s", 4),
                quantity(before, "s", 4)
            ));
        }
    }
    None
}

/// The straight line through the logarithms of trains: one slope, an offset each.
struct Line {
    slope: f64,
    /// Sum of the weights, and weighted means of place and logarithm, of each train.
    means: Vec<(f64, f64, f64)>,
    /// Weighted sum of squares of the places about their means.
    sxx: f64,
    /// Degrees of freedom of the residuals.
    free: usize,
}

impl Line {
    /// Least squares with the weights `weight` of the flights.
    fn new(flights: &[Flight], weight: impl Fn(&Flight) -> f64) -> Line {
        let trains = flights.iter().map(|f| f.train + 1).max().unwrap_or(0);
        let mut means = vec![(0.0, 0.0, 0.0); trains];
        for f in flights {
            let (m, w) = (&mut means[f.train], weight(f));
            *m = (m.0 + w, m.1 + w * f.place as f64, m.2 + w * f.log);
        }
        for m in &mut means {
            *m = (m.0, m.1 / m.0, m.2 / m.0);
        }
        let (mut sxx, mut sxy) = (0.0, 0.0);
        for f in flights {
            let (m, w) = (means[f.train], weight(f));
            let x = f.place as f64 - m.1;
            (sxx, sxy) = (sxx + w * x * x, sxy + w * x * (f.log - m.2));
        }
        let used = means.iter().filter(|m| m.0 > 0.0).count();
        Line { slope: sxy / sxx, means, sxx, free: flights.len().saturating_sub(used + 1) }
    }

    fn at(&self, f: &Flight) -> f64 {
        let (_, place, log) = self.means[f.train];
        log + self.slope * (f.place as f64 - place)
    }

    fn residuals(&self, flights: &[Flight]) -> Vec<f64> {
        flights.iter().map(|f| f.log - self.at(f)).collect()
    }
}

/// Quantile 0.9995 of Student's t from 2 degrees of freedom on: what lies beyond is an outlier.
const OUTSIDE: [f64; 9] = [31.6, 12.92, 8.61, 6.87, 5.96, 5.41, 5.04, 4.78, 4.59];

/// How far the flight `one` is from what the `others` expect, in parts of the quantile, and that logarithm; the variance of the logarithm goes as Δt to
/// `power`.
fn off(one: &Flight, others: &[Flight], power: f64) -> Option<(f64, f64)> {
    let weight = |log: f64| (-power * log).exp();
    let line = Line::new(others, |f| weight(f.log));
    if others.iter().filter(|f| f.train == one.train).count() < 2 || line.free < 2 {
        return None;
    }
    let expected = line.at(one);
    let (sum, place, _) = line.means[one.train];
    let x = one.place as f64 - place;
    let squares: f64 = others.iter().zip(line.residuals(others)).map(|(f, r)| weight(f.log) * r * r).sum();
    let variance = squares / line.free as f64 * (weight(expected).recip() + sum.recip() + x * x / line.sxx);
    // Numbers that were typed have three digits at least: half a unit of the last is 1e-3 of a flight.
    let score = (one.log - expected).abs() / variance.max(1e-6).sqrt();
    Some((score / OUTSIDE[(line.free - 2).min(OUTSIDE.len() - 1)], expected))
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

/// Says where residuals bend: R changes with the speed, or impacts are not short beside the last flights.
fn bend(flights: &[Flight], warnings: &mut Vec<String>) {
    let line = Line::new(flights, |_| 1.0);
    let (residuals, free) = (line.residuals(flights), line.free);
    if free < 3 {
        return;
    }
    let middle = 0.5 * flights.iter().map(|f| f.place).max().unwrap_or(0) as f64;
    let square = |f: &Flight| Flight { log: (f.place as f64 - middle).powi(2), ..*f };
    let squares: Vec<Flight> = flights.iter().map(square).collect();
    let curve = Line::new(&squares, |_| 1.0).residuals(&squares);
    let product = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let size = product(&curve, &curve);
    let c = product(&curve, &residuals) / size;
    let rest = (product(&residuals, &residuals) - c * c * size).max(0.0) / (free - 1) as f64;
    let t = c.abs() / (rest / size).sqrt();
    // As for outliers; and no bend where it changes no flight by half a per cent.
    if t > OUTSIDE[(free - 2).min(OUTSIDE.len() - 1)] && c.abs() * middle * middle > 5e-3 {
        warnings.push(format!(
            "Flight times do not shrink evenly: R {} from bounce to bounce. It changes with the speed of impact, or the last impacts are not short beside their flights; the uncertainty does not cover that.",
            if c > 0.0 { "grows" } else { "falls" }
        ));
    }
}

/// Says where a record ends before the bounce that should follow.
fn ends(trains: &[Train], value: f64, warnings: &mut Vec<String>) {
    for (i, train) in trains.iter().enumerate() {
        let (Some(after), Some(last)) = (train.after, train.intervals.last()) else { continue };
        let (next, still) = (last * value, last * value / (1.0 - value));
        let missing = after < next;
        let [after, next, still] = [after, next, still].map(|t| quantity(t, "s", 3));
        warnings.push(if missing {
            format!(
                "Train {}: the record ends {after} after the last impact, before the next is due at {next}: the last bounces are not in it. The body would come to rest {still} after that impact.",
                i + 1
            )
        } else {
            format!(
                "Train {}: the bounce due {next} after the last impact is not in the record, which goes on for {after}: the last bounces are lost in noise or in the ringing of the one before.",
                i + 1
            )
        });
    }
}

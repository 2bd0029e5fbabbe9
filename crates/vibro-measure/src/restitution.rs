//! Coefficient of restitution: speed of separation over speed of approach.
//!
//! Each method that the data allow gives its own answer. Where answers differ by more than their uncertainties, that is the result:
//! nothing is averaged.

mod drop;
mod ratios;
mod train;
mod velocities;

pub use drop::{Bounces, Drop, GRAVITY};
pub use train::{Outlier, Train};
pub use velocities::Velocities;

use super::Estimate;
use serde::{Serialize, Serializer};
use std::fmt;
use vibro_record::{Error, Finding, Result};

/// How restitution was found.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Method {
    /// The first flight after a fall from a known height.
    Drop,
    /// Ratios of successive flight times.
    FlightTimes,
    /// Velocities of both masses before and after.
    BothVelocities,
    /// The velocity of mass 1 after, that of mass 2 from the momentum balance.
    Velocity1,
    /// The velocity of mass 2 after, that of mass 1 from the momentum balance.
    Velocity2,
}

impl Method {
    /// Its name in answers.
    pub fn name(self) -> &'static str {
        match self {
            Method::Drop => "drop",
            Method::FlightTimes => "flight times",
            Method::BothVelocities => "velocities of both masses",
            Method::Velocity1 => "velocity of mass 1 and momentum",
            Method::Velocity2 => "velocity of mass 2 and momentum",
        }
    }
}

impl fmt::Display for Method {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl Serialize for Method {
    fn serialize<S: Serializer>(&self, serializer: S) -> std::result::Result<S::Ok, S::Error> {
        serializer.serialize_str(self.name())
    }
}

/// One method's answer.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[non_exhaustive]
pub struct Way {
    /// The method.
    pub method: Method,
    /// Its answer.
    pub restitution: Estimate,
    #[serde(skip)]
    shares: Shares,
}

/// What an answer has in common with others.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Shares {
    /// Flight times.
    Flights,
    /// Velocities v₁, v₂, v₁⁺, v₂⁺: its derivatives by them, times their standard uncertainty.
    Velocities([f64; 4]),
}

/// The coefficient of restitution by every method that the data allow.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[non_exhaustive]
pub struct Restitution {
    /// The answer with the smallest uncertainty; null where methods disagree.
    pub restitution: Estimate,
    /// All answers.
    pub by: Vec<Way>,
    /// Whether the answers agree within the uncertainties of their differences; null where one that has none leaves that open. A single
    /// answer agrees.
    pub agree: Option<bool>,
    /// Standard deviation of `restitution` by drops over 2000 drawings of as many drops with replacement (Efron 1979), from a fixed seed:
    /// the scatter of the drops alone. Null for fewer than five drops.
    pub bootstrap_std: Option<f64>,
    /// Intervals between impacts in s, one list a drop or train.
    pub intervals: Vec<Vec<f64>>,
    /// Flight times that do not fit the train.
    pub outliers: Vec<Outlier>,
    /// What was assumed, and what is doubtful.
    pub findings: Vec<Finding>,
}

/// What is known of the impacts. Everything is optional; what is there decides which methods answer.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Measured {
    /// Drops from a height, with the interval between first and second impact.
    pub drop: Option<Drop>,
    /// Trains of bounces.
    pub trains: Vec<Train>,
    /// Velocities before and after.
    pub velocities: Option<Velocities>,
}

/// Restitution by every method that `measured` allows.
///
/// ```
/// use vibro_measure::restitution::{Drop, Measured, restitution};
/// let drop = Drop { height: 0.57, intervals: vec![0.144], ..Drop::default() };
/// let found = restitution(&Measured { drop: Some(drop), ..Measured::default() })?;
/// assert!((found.restitution.value - 0.2112).abs() < 5e-5);
/// # Ok::<(), vibro_record::Error>(())
/// ```
///
/// # Errors
/// Where nothing is given from which it follows, and where what is given is impossible: a height of 0, an interval longer than the
/// fall allows, masses that do not approach.
pub fn restitution(measured: &Measured) -> Result<Restitution> {
    let (mut by, mut findings, mut outliers) = (Vec::new(), Vec::new(), Vec::new());
    let mut intervals: Vec<Vec<f64>> = measured.trains.iter().map(|t| t.intervals.clone()).collect();
    if let Some(drop) = &measured.drop {
        by.push(drop.answer(&mut findings)?);
        if intervals.is_empty() {
            intervals = drop.intervals.iter().map(|d| vec![*d]).collect();
        }
    }
    match train::answer(&measured.trains, &mut outliers, &mut findings) {
        Ok(way) => by.extend(way),
        // What follows a drop may be no train of bounces; the drop answers nevertheless.
        Err(error) if measured.drop.is_some() && error.exit_code() == 1 => {
            findings.push(Finding::caution("flight-times-ignored"));
        }
        Err(error) => return Err(error),
    }
    if let Some(velocities) = &measured.velocities {
        match velocities.answers(&mut findings) {
            Ok(ways) => by.extend(ways),
            Err(error) if !by.is_empty() && error.exit_code() == 1 => {
                findings.push(Finding::caution("velocities-ignored"));
            }
            Err(error) => return Err(error),
        }
    }
    if by.is_empty() && !measured.trains.is_empty() {
        return Err(Error::refused("one flight time has no ratio, from which restitution follows")
            .hint("state two flight times or more, or the height of the fall with the interval")
            .setting("intervals")
            .setting("height")
            .setting("interval"));
    }
    let uncertainty = |way: &Way| way.restitution.std.unwrap_or(f64::INFINITY);
    let Some(surest) = by.iter().min_by(|a, b| uncertainty(a).total_cmp(&uncertainty(b))) else {
        return Err(Error::usage(
            "nothing from which restitution follows",
            "a height with an interval, flight times, or velocities before and after",
        )
        .hint("state one of them")
        .setting("height")
        .setting("interval")
        .setting("intervals")
        .setting("before"));
    };
    let agree = agreement(&by, &mut findings);
    let restitution = if agree == Some(false) {
        Estimate::new(f64::NAN, None, "1", by.len(), "methods disagree: see `by`")
    } else {
        surest.restitution.clone()
    };
    let bootstrap_std = measured.drop.as_ref().and_then(Drop::bootstrap);
    Ok(Restitution { restitution, by, agree, bootstrap_std, intervals, outliers, findings })
}

/// Two-sided 95 % limits of a normal deviate for the largest of 1 to 10 comparisons (Bonferroni); five methods have ten pairs.
const LIMITS: [f64; 10] = [1.960, 2.241, 2.394, 2.498, 2.576, 2.638, 2.690, 2.734, 2.773, 2.807];

/// Standard uncertainty of the difference of two answers, `None` where one has none.
///
/// Methods by velocity share all their numbers: their difference has the covariance of these. A drop and a train may share the first
/// flight, with a correlation that depends on what scatters: the largest possible one is assumed.
fn of_difference(a: &Way, b: &Way) -> Option<f64> {
    let (u, v) = (a.restitution.std?, b.restitution.std?);
    Some(match (a.shares, b.shares) {
        (Shares::Velocities(x), Shares::Velocities(y)) => {
            x.iter().zip(y).map(|(x, y)| (x - y).powi(2)).sum::<f64>().sqrt()
        }
        (Shares::Flights, Shares::Flights) => u + v,
        _ => u.hypot(v),
    })
}

/// Whether every pair of answers agrees at 95 % together; `None` where one has no uncertainty and the others agree.
fn agreement(by: &[Way], findings: &mut Vec<Finding>) -> Option<bool> {
    let pairs: Vec<(&Way, &Way)> =
        by.iter().enumerate().flat_map(|(i, a)| by[i + 1..].iter().map(move |b| (a, b))).collect();
    let tested: Vec<(&Way, &Way, f64)> =
        pairs.iter().filter_map(|(a, b)| Some((*a, *b, of_difference(a, b)?))).collect();
    let open = tested.len() < pairs.len();
    if open {
        findings.push(Finding::note("method-not-compared"));
    }
    let limit = tested.len().checked_sub(1).and_then(|i| LIMITS.get(i)).copied().unwrap_or(f64::INFINITY);
    let mut agree = true;
    for (a, b, u) in &tested {
        let difference = (a.restitution.value - b.restitution.value).abs();
        // Equal numbers may differ by roundings.
        if difference > limit * u + 1e-12 {
            agree = false;
            findings.push(
                Finding::doubt("methods-disagree")
                    .name("first", a.method.name())
                    .number("first_value", a.restitution.value)
                    .name("second", b.method.name())
                    .number("second_value", b.restitution.value)
                    .number("ratio", difference / u),
            );
        }
    }
    if agree && open { None } else { Some(agree) }
}

/// Checks a number that must be finite and above 0.
fn above_zero(name: &str, value: f64) -> Result<()> {
    if value.is_finite() && value > 0.0 {
        return Ok(());
    }
    Err(Error::refused(format!("{name} of {value}: it must be above 0")))
}

/// Checks an uncertainty.
fn not_negative(name: &str, value: Option<f64>) -> Result<()> {
    match value {
        Some(v) if !(v.is_finite() && v >= 0.0) => Err(Error::usage(format!("{name} of {v}"), "0 or more")),
        _ => Ok(()),
    }
}

#[cfg(test)]
mod tests;

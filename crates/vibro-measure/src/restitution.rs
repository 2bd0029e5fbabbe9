//! Coefficient of restitution: speed of separation over speed of approach.
//!
//! Each method that the data allow answers for itself. Where answers differ by more than their uncertainties, that is the result:
//! nothing is averaged.

mod drop;
mod ratios;
mod train;
mod velocities;

pub use drop::{Bounces, Drop, GRAVITY};
pub use train::{Outlier, Train};
pub use velocities::Velocities;

use super::Estimate;
use serde::Serialize;
use vibro_record::units::notation::quantity;
use vibro_record::{Error, Result};

/// One method's answer.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Way {
    /// Name of the method.
    pub method: &'static str,
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
    /// Velocities v₁, v₂, v₁⁺, v₂⁺: its derivatives by them, times their standard uncertainties.
    Velocities([f64; 4]),
}

/// The coefficient of restitution by every method that the data allow.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Restitution {
    /// The answer of the surest method; null where methods disagree.
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
    /// What a person must know.
    pub warnings: Vec<String>,
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
/// Where nothing is given from which it follows, and where what is given cannot be: a height of 0, an interval longer than the fall allows, masses
/// that do not approach.
pub fn restitution(measured: &Measured) -> Result<Restitution> {
    let (mut by, mut warnings, mut outliers) = (Vec::new(), Vec::new(), Vec::new());
    let mut intervals: Vec<Vec<f64>> = measured.trains.iter().map(|t| t.intervals.clone()).collect();
    if let Some(drop) = &measured.drop {
        by.push(drop.answer(&mut warnings)?);
        if intervals.is_empty() {
            intervals = drop.intervals.iter().map(|d| vec![*d]).collect();
        }
    }
    match train::answer(&measured.trains, &mut outliers, &mut warnings) {
        Ok(way) => by.extend(way),
        // What follows a drop may be no train of bounces; the drop answers nevertheless.
        Err(error) if measured.drop.is_some() && error.exit_code() == 1 => {
            warnings.push(format!("Flight times are left out: {error}"));
        }
        Err(error) => return Err(error),
    }
    if let Some(velocities) = &measured.velocities {
        match velocities.answers(&mut warnings) {
            Ok(ways) => by.extend(ways),
            Err(error) if !by.is_empty() && error.exit_code() == 1 => {
                warnings.push(format!("Velocities are left out: {error}"));
            }
            Err(error) => return Err(error),
        }
    }
    if let (true, [only]) = (by.is_empty(), measured.trains.as_slice())
        && only.intervals.len() == 1
    {
        return Err(Error::refused(
            "one flight time says nothing of restitution: the ratio of two that follow each other does",
        )
        .hint("--intervals A,B with two or more, or --height M with --interval S"));
    }
    let Some(surest) = by.iter().min_by(|a, b| uncertainty(a).total_cmp(&uncertainty(b))) else {
        return Err(Error::usage(
            "nothing from which restitution follows",
            "a height with an interval, flight times, or velocities",
        )
        .hint("--height M --interval S, or --intervals A,B,C, or --before V1,V2 --after V1,V2"));
    };
    let agree = agreement(&by, &mut warnings);
    let restitution = if agree == Some(false) {
        Estimate::new(f64::NAN, None, "1", by.len(), "methods disagree: see `by`")
    } else {
        surest.restitution.clone()
    };
    let bootstrap_std = measured.drop.as_ref().and_then(Drop::bootstrap);
    Ok(Restitution { restitution, by, agree, bootstrap_std, intervals, outliers, warnings })
}

fn uncertainty(way: &Way) -> f64 {
    way.restitution.std.unwrap_or(f64::INFINITY)
}

/// Two-sided 95 % limits of a normal deviate for the largest of 1 to 10 comparisons (Bonferroni); five methods have ten pairs.
const LIMITS: [f64; 10] = [1.960, 2.241, 2.394, 2.498, 2.576, 2.638, 2.690, 2.734, 2.773, 2.807];

/// Standard uncertainty of the difference of two answers, `None` where one has none.
///
/// Methods by velocity share all their numbers: their difference has the covariance of these. A drop and a train may share the first
/// flight, with a correlation that depends on what scatters: the largest possible one is taken.
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
fn agreement(by: &[Way], warnings: &mut Vec<String>) -> Option<bool> {
    let pairs: Vec<(&Way, &Way)> =
        by.iter().enumerate().flat_map(|(i, a)| by.iter().skip(i + 1).map(move |b| (a, b))).collect();
    let tested: Vec<(&Way, &Way, f64)> =
        pairs.iter().filter_map(|(a, b)| Some((*a, *b, of_difference(a, b)?))).collect();
    if tested.len() < pairs.len() {
        warnings.push("A method without an uncertainty was not compared with the others.".to_owned());
    }
    // Methods are five at most.
    let limit = tested.len().checked_sub(1).and_then(|i| LIMITS.get(i)).copied().unwrap_or(f64::INFINITY);
    let mut agree = true;
    for (a, b, u) in &tested {
        let difference = a.restitution.value - b.restitution.value;
        // Equal numbers may differ by roundings.
        if difference.abs() > limit * u + 1e-12 {
            agree = false;
            warnings.push(format!(
                "The methods disagree by more than their uncertainties: {} {:.4}, {} {:.4}; the difference of {:.4} has a standard uncertainty of {}.",
                a.method,
                a.restitution.value,
                b.method,
                b.restitution.value,
                difference.abs(),
                quantity(*u, "1", 2)
            ));
        }
    }
    if agree && tested.len() < pairs.len() { None } else { Some(agree) }
}

/// Checks a number that must be finite and above 0.
fn above_zero(what: &str, value: f64) -> Result<()> {
    if value.is_finite() && value > 0.0 {
        return Ok(());
    }
    Err(Error::refused(format!("{what} of {value} allows no answer: it must be above 0")))
}

/// Checks an uncertainty.
fn not_negative(what: &str, value: Option<f64>) -> Result<()> {
    match value {
        Some(v) if !(v.is_finite() && v >= 0.0) => Err(Error::usage(format!("{what} of {v}"), "0 or more")),
        _ => Ok(()),
    }
}

#[cfg(test)]
mod tests;

//! Coefficient of restitution: speed of separation over speed of approach.
//!
//! Each method that the data allow answers for itself. Where answers differ by more than their uncertainties, that is the result:
//! nothing is averaged.

mod drop;
mod train;
mod velocities;

pub use drop::{Bounces, Drop, GRAVITY};
pub use train::{Outlier, Train};
pub use velocities::Velocities;

use super::Estimate;
use crate::error::{Error, Result};
use serde::Serialize;

/// One method's answer.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Way {
    /// Name of the method.
    pub method: &'static str,
    /// Its answer.
    pub restitution: Estimate,
}

/// The coefficient of restitution by every method that the data allow.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Restitution {
    /// The answer of the surest method; null where methods disagree.
    pub restitution: Estimate,
    /// All answers.
    pub by: Vec<Way>,
    /// Whether the answers agree within their uncertainties.
    pub agree: bool,
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
/// use vibroimpact::measure::restitution::{Drop, Measured, restitution};
/// let drop = Drop { height: 0.57, intervals: vec![0.144], ..Drop::default() };
/// let found = restitution(&Measured { drop: Some(drop), ..Measured::default() })?;
/// assert!((found.restitution.value - 0.2112).abs() < 5e-5);
/// # Ok::<(), vibroimpact::Error>(())
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
    if let Some(way) = train::answer(&measured.trains, &mut outliers, &mut warnings)? {
        by.push(way);
    }
    if let Some(velocities) = &measured.velocities {
        by.extend(velocities.answers(&mut warnings)?);
    }
    let Some(surest) = by.iter().min_by(|a, b| uncertainty(a).total_cmp(&uncertainty(b))) else {
        return Err(Error::usage(
            "nothing from which restitution follows",
            "a height with an interval, flight times, or velocities",
        )
        .hint("--height M --interval S, or --intervals A,B,C, or --before V1,V2 --after V1,V2"));
    };
    let agree = agreement(&by, &mut warnings);
    let restitution = if agree {
        surest.restitution.clone()
    } else {
        Estimate::new(f64::NAN, None, "", by.len(), "methods disagree: see `by`")
    };
    Ok(Restitution { restitution, by, agree, intervals, outliers, warnings })
}

fn uncertainty(way: &Way) -> f64 {
    way.restitution.std.unwrap_or(f64::INFINITY)
}

/// Quantiles of χ² at 95 % for 1 to 5 degrees of freedom.
const CHI_SQUARE: [f64; 5] = [3.841, 5.991, 7.815, 9.488, 11.070];

/// Whether Σ((Rᵢ − R̄)/uᵢ)² about the weighted mean stays below the 95 % point of χ².
fn agreement(by: &[Way], warnings: &mut Vec<String>) -> bool {
    let known: Vec<(f64, f64)> = by
        .iter()
        .filter_map(|w| Some((w.restitution.value, w.restitution.std.filter(|s| *s > 0.0)?)))
        .collect();
    if by.len() > 1 && known.len() < by.len() {
        warnings.push("A method without an uncertainty was not compared with the others.".to_owned());
    }
    let Some(limit) = known.len().checked_sub(2).map(|i| CHI_SQUARE[i.min(4)]) else { return true };
    let weight: f64 = known.iter().map(|(_, u)| u.powi(-2)).sum();
    let mean = known.iter().map(|(r, u)| r * u.powi(-2)).sum::<f64>() / weight;
    let chi: f64 = known.iter().map(|(r, u)| ((r - mean) / u).powi(2)).sum();
    if chi > limit {
        let all: Vec<String> =
            by.iter().map(|w| format!("{} {:.4}", w.method, w.restitution.value)).collect();
        warnings.push(format!(
            "The methods disagree by more than their uncertainties (χ² {chi:.1}, 95 % limit {limit:.1}): {}.",
            all.join(", ")
        ));
    }
    chi <= limit
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

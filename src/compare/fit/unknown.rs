//! What is to be found.

use super::coordinate::Coordinate;
use super::setting::Setting;
use crate::campaign::{FitEntry, Parameter};
use crate::error::{Error, Result};

/// A parameter to be found.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Unknown {
    pub parameter: Parameter,
    pub coordinate: Coordinate,
    /// Value and standard uncertainty from another measurement.
    pub prior: Option<[f64; 2]>,
}

impl Unknown {
    /// All that an entry asks for, from these values on.
    ///
    /// # Errors
    /// If nothing is asked for, a parameter twice, a starting value lies outside its bounds, or a prior or bounds cannot be.
    pub fn all(entry: &FitEntry, from: &Setting) -> Result<Vec<Unknown>> {
        entry.usable()?;
        if entry.parameters.is_empty() {
            return Err(Error::usage("a fit of no parameter", "one parameter or more"));
        }
        let one = |parameter: &Parameter| {
            let (low, high) = entry.range(*parameter);
            let value = from.get(*parameter);
            if !(value >= low && value <= high) {
                return Err(Error::usage(
                    format!("{} starts at {value}, outside its bounds {low} to {high}", parameter.name()),
                    "bounds that hold the rig's own value, from which the fit starts",
                )
                .hint(format!(
                    "give `bounds.{} = [lowest, highest]` in [fit]{}",
                    parameter.name(),
                    if *parameter == Parameter::Gap {
                        ", below 0 for masses that are pressed together"
                    } else {
                        ""
                    }
                )));
            }
            if high.is_infinite() && value == low {
                return Err(Error::usage(
                    format!(
                        "{} starts at {value}, where nothing says how large a change of it is",
                        parameter.name()
                    ),
                    format!("a value above {low} in the rig, roughly right"),
                ));
            }
            let prior = entry.prior.get(parameter).copied();
            Ok(Unknown { parameter: *parameter, coordinate: Coordinate { low, high }, prior })
        };
        entry.parameters.iter().map(one).collect()
    }
}

/// A parameter without an upper bound goes no farther than this factor from where it started, more than a mistaken unit: beyond, nothing pulls it back, and motions
/// of a rig without dampers, or without a gap, take for ever to simulate.
const LEASH: f64 = 1e4;
/// A parameter between two bounds comes no nearer to either than this part of the way between.
const NEAREST: f64 = 1e-6;

/// `base` with these unknowns at these coordinates.
pub fn at(base: &Setting, unknowns: &[Unknown], u: &[f64]) -> Setting {
    unknowns.iter().zip(u).fold(*base, |setting, (unknown, u)| {
        let [low, high] = limits(base, unknown);
        setting.with(unknown.parameter, unknown.coordinate.value(*u).clamp(low, high))
    })
}

/// Where a parameter may go.
pub fn limits(base: &Setting, unknown: &Unknown) -> [f64; 2] {
    let Coordinate { low, high } = unknown.coordinate;
    let start = base.get(unknown.parameter) - low;
    if high.is_finite() {
        [low + NEAREST * (high - low), high - NEAREST * (high - low)]
    } else if start > 0.0 {
        [low + start / LEASH, low + start * LEASH]
    } else {
        [low, f64::INFINITY]
    }
}

/// Which coordinates are the lower of the two that give the same value; they are turned into the upper.
pub fn fold(unknowns: &[Unknown], u: &mut [f64]) -> Vec<bool> {
    let one = |(unknown, u): (&Unknown, &mut f64)| {
        let lower = unknown.coordinate.high.is_infinite() && *u < 0.0;
        if lower {
            *u = -*u;
        }
        lower
    };
    unknowns.iter().zip(u).map(one).collect()
}

/// Coordinates of the unknowns' values in `setting`.
pub fn coordinates(setting: &Setting, unknowns: &[Unknown]) -> Vec<f64> {
    unknowns.iter().map(|unknown| unknown.coordinate.of(setting.get(unknown.parameter))).collect()
}

//! What is to be found from the responses.

use super::Parameter;
use super::compute::Fault;
use crate::error::{Error, Result};
use serde::Deserialize;
use std::collections::BTreeMap;

/// The table `[fit]`.
#[derive(Debug, Clone, PartialEq, Default, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct FitEntry {
    /// Parameters to be found. None: nothing is fitted.
    pub parameters: Vec<Parameter>,
    /// What is known of a parameter from another measurement: `[value, standard uncertainty]`.
    pub prior: BTreeMap<Parameter, [f64; 2]>,
    /// Lowest and highest value that a parameter may take.
    pub bounds: BTreeMap<Parameter, [f64; 2]>,
    /// Starting points. Default 8.
    pub starts: Option<usize>,
    /// Relative standard uncertainty of the calibration of each mass' amplitudes: one factor for all of them, and as much again as a slope
    /// from the lowest to the highest frequency; and of the factor of the force, where that is not fitted. Default 0.01, which is said.
    pub calibration: Option<f64>,
    /// Relative standard uncertainty of each amplitude for itself, beside the noise in its spectrum: how far a measurement that is repeated
    /// strays. Default 0.
    pub scatter: Option<f64>,
}

/// Starting points, at most.
const MOST_STARTS: usize = 1000;

impl FitEntry {
    /// That nothing in it is impossible.
    ///
    /// # Errors
    /// With the key that is, and why.
    pub fn usable(&self) -> Result<()> {
        let expected = "each parameter once, masses with a prior, and values as docs/campaign.md has them";
        self.check().map_err(|(key, why)| Error::usage(format!("fit of {key}: {why}"), expected))
    }

    /// The key that holds an impossible value, and why.
    pub(super) fn check(&self) -> std::result::Result<(), Fault> {
        for (i, parameter) in self.parameters.iter().enumerate() {
            let name = parameter.name();
            if self.parameters[..i].contains(parameter) {
                return Err(("parameters", format!("{name} is named twice")));
            }
            if parameter.is_mass() && !self.prior.contains_key(parameter) {
                let why = "while motion tells only the ratios of force, stiffness and damping to the masses: weigh it and give";
                let why = format!(
                    "{name} is fitted without a prior, {why} `prior.{name} = [kg, standard uncertainty]` in [fit]"
                );
                return Err(("parameters", why));
            }
        }
        if self.starts.is_some_and(|n| n == 0 || n > MOST_STARTS) {
            return Err(("starts", format!("starts is not from 1 to {MOST_STARTS}")));
        }
        for (key, value) in [("calibration", self.calibration), ("scatter", self.scatter)] {
            if value.is_some_and(|v| !(0.0..0.5).contains(&v)) {
                return Err((key, format!("{key} is not from 0 to 0.5: it is relative, 0.01 for 1 %")));
            }
        }
        for (parameter, [value, std]) in &self.prior {
            let (name, (low, high)) = (parameter.name(), self.range(*parameter));
            let prior = format!("the prior of {name} is {value}");
            if !(value.is_finite() && std.is_finite() && *std > 0.0) {
                let why = "which is not above 0: leave it out of the fit to keep it fixed";
                return Err((name, format!("{prior} with a standard uncertainty of {std}, {why}")));
            }
            if !(*value > low && *value < high) {
                return Err((name, format!("{prior}, outside its bounds {low} to {high}")));
            }
        }
        for (parameter, [low, high]) in &self.bounds {
            let (name, (least, most)) = (parameter.name(), parameter.range());
            // A gap may be negative: the masses are then pressed together.
            let least = if *parameter == Parameter::Gap { f64::NEG_INFINITY } else { least };
            if !(low < high && *low >= least && *high <= most) {
                let why = match parameter {
                    Parameter::Restitution if low < high => "it is from 0 to 1",
                    _ if low < high => "it is not below 0",
                    _ => "no value lies between",
                };
                return Err((name, format!("the bounds of {name} are {low} to {high}: {why}")));
            }
        }
        Ok(())
    }

    /// Where a parameter may lie.
    pub fn range(&self, parameter: Parameter) -> (f64, f64) {
        self.bounds.get(&parameter).map_or(parameter.range(), |[low, high]| (*low, *high))
    }
}

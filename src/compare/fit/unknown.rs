//! The parameters that a fit looks for.

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

/// A parameter without an upper bound goes no farther than this factor from where it started, ten times a mistaken milli: beyond, nothing
/// pulls it back, and a rig without dampers or gap takes for ever to simulate.
const FARTHEST: f64 = 1e4;

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
            let (value, name) = (from.get(*parameter), parameter.name());
            if !(value >= low && value <= high) {
                let pressed =
                    if *parameter == Parameter::Gap { ", below 0 for masses pressed together" } else { "" };
                return Err(Error::usage(
                    format!("{name} starts at {value}, outside its bounds {low} to {high}"),
                    "bounds around the rig's own value, from which the fit starts",
                )
                .hint(format!("state `bounds.{name} = [lowest, highest]` of the fit{pressed}")));
            }
            if high.is_infinite() && value == low {
                return Err(Error::usage(
                    format!("{name} starts at {value}, which gives no scale for its changes"),
                    format!("a value above {low} in the rig, roughly right"),
                ));
            }
            let prior = entry.prior.get(parameter).copied();
            Ok(Unknown { parameter: *parameter, coordinate: Coordinate { low, high }, prior })
        };
        entry.parameters.iter().map(one).collect()
    }

    /// Lowest and highest value that it takes.
    pub fn limits(&self, base: &Setting) -> [f64; 2] {
        let Coordinate { low, high } = self.coordinate;
        let start = base.get(self.parameter) - low;
        if high.is_infinite() && start > 0.0 {
            [low + start / FARTHEST, low + start * FARTHEST]
        } else {
            self.coordinate.limits()
        }
    }
}

//! Fitted parameters, their coordinates without bounds, and the rig with their values.

use super::MotionKind;
use crate::campaign::FitEntry;
use crate::error::{Error, Result};
use crate::model::{Parameter, Rig, Sine, Steady, shown};

/// A fitted parameter.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Unknown {
    pub parameter: Parameter,
    pub coordinate: Coordinate,
    /// Value and standard uncertainty from another measurement.
    pub prior: Option<[f64; 2]>,
}

/// A parameter without an upper bound stays within this factor of its starting value: ten times the error of
/// a mistaken milli. Further away the points no longer constrain it, and a rig without dampers or gap takes
/// very long to simulate.
const FARTHEST: f64 = 1e4;

impl Unknown {
    /// All parameters of an entry, with these starting values.
    ///
    /// # Errors
    /// If no parameter is listed or one is listed twice, a starting value lies outside its bounds, or a
    /// prior or bounds are impossible.
    pub fn all(entry: &FitEntry, from: &Setting) -> Result<Vec<Unknown>> {
        entry.usable()?;
        if entry.parameters.is_empty() {
            return Err(Error::usage("a fit of no parameter", "one parameter or more"));
        }
        let one = |parameter: &Parameter| {
            let (low, high) = entry.range(*parameter);
            let (value, name) = (from.get(*parameter), parameter.name());
            let starts = |found: &str, expected: &str| {
                Error::usage(format!("{name} starts at {value}, {found}"), expected)
            };
            if !(value >= low && value <= high) {
                let gap = *parameter == Parameter::Gap;
                let pressed = if gap { ", below 0 for masses pressed together" } else { "" };
                let expected = "bounds around the rig's own value, from which the fit starts";
                let error = starts(&format!("outside its bounds {low} to {high}"), expected);
                return Err(
                    error.hint(format!("state `bounds.{name} = [lowest, highest]` of the fit{pressed}"))
                );
            }
            if high.is_infinite() && value == low {
                let expected = format!("a value above {low} in the rig, roughly right");
                return Err(starts("which gives no scale for its changes", &expected));
            }
            let prior = entry.prior.get(parameter).copied();
            Ok(Unknown { parameter: *parameter, coordinate: Coordinate { low, high }, prior })
        };
        entry.parameters.iter().map(one).collect()
    }

    /// Lowest and highest value in a fit, in the unit of the parameter.
    pub fn limits(&self, base: &Setting) -> [f64; 2] {
        let Coordinate { low, high } = self.coordinate;
        if high.is_finite() {
            let inside = NEAREST * (high - low);
            return [low + inside, high - inside];
        }
        let start = base.get(self.parameter) - low;
        [low + start / FARTHEST, low + start * FARTHEST]
    }
}

/// Coordinate u, from −∞ to ∞, of a parameter θ from `low` to `high`: √(θ − low) without an upper bound,
/// else the logit of its relative position between both bounds.
///
/// A damper may be 0. With a logarithm instead of the root a fit could not leave θ = low, where all slopes
/// vanish.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Coordinate {
    pub low: f64,
    /// Infinite where there is none.
    pub high: f64,
}

/// Smallest distance of a parameter from each of two bounds, over their distance: a loss 1 − R of 1e-6 is
/// below what any sweep shows.
const NEAREST: f64 = 1e-6;

impl Coordinate {
    /// u of θ; θ at a bound or beyond it counts as just inside.
    pub fn of(self, value: f64) -> f64 {
        if self.high.is_infinite() {
            return (value - self.low).max(0.0).sqrt();
        }
        let part = ((value - self.low) / (self.high - self.low)).clamp(NEAREST, 1.0 - NEAREST);
        (part / (1.0 - part)).ln()
    }

    /// θ of u.
    pub fn value(self, u: f64) -> f64 {
        if self.high.is_infinite() {
            return self.low + u * u;
        }
        self.low + (self.high - self.low) / (1.0 + (-u).exp())
    }

    /// Smallest and largest θ between u − `away` and u + `away`.
    pub fn interval(self, u: f64, away: f64) -> [f64; 2] {
        let [a, b] = [u - away, u + away].map(|u| self.value(u));
        let low = if self.high.is_infinite() && u.abs() < away { self.low } else { a.min(b) };
        [low, a.max(b)]
    }

    /// dθ/du.
    pub fn slope(self, u: f64) -> f64 {
        let value = self.value(u);
        if self.high.is_infinite() {
            return 2.0 * u;
        }
        (value - self.low) * (self.high - value) / (self.high - self.low)
    }
}

/// A rig and the reference force on it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Setting {
    pub rig: Rig,
    /// Force amplitude in N.
    pub force: f64,
}

impl Setting {
    fn place(&mut self, parameter: Parameter) -> &mut f64 {
        // The force is the only parameter outside the rig.
        parameter.place(&mut self.rig).unwrap_or(&mut self.force)
    }

    pub fn get(mut self, parameter: Parameter) -> f64 {
        *self.place(parameter)
    }

    pub fn with(mut self, parameter: Parameter, value: f64) -> Setting {
        *self.place(parameter) = value;
        self
    }

    /// Amplitudes of both masses in m that a spectrum shows of this motion, at a force in N and a frequency
    /// in Hz; NaN where the motion does not exist.
    pub fn shows(&self, kind: MotionKind, force: f64, frequency: f64) -> [f64; 2] {
        let sine = Sine { force, frequency };
        match kind {
            MotionKind::Impacting => shown(&self.rig, &sine).map_or([f64::NAN; 2], |s| s.amplitude),
            MotionKind::Free => Steady::new(&self.rig, &sine).map_or([f64::NAN; 2], |s| [s.amplitude(), 0.0]),
            MotionKind::Pattern | MotionKind::Irregular => [f64::NAN; 2],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn there_and_back() {
        let cases = [
            (0.0, 1.0, 0.98),
            (0.0, f64::INFINITY, 1e-3),
            (-1e-3, f64::INFINITY, 5e-4),
            (90.0, 180.0, 128.0),
        ];
        for (low, high, value) in cases {
            let c = Coordinate { low, high };
            let u = c.of(value);
            assert!((c.value(u) / value - 1.0).abs() < 1e-12);
            // A central difference errs by h²/6 times the third derivative, and by ε/h.
            let slope = (c.value(u + 1e-5) - c.value(u - 1e-5)) / 2e-5;
            assert!((c.slope(u) / slope - 1.0).abs() < 1e-6, "{c:?}");
            for u in [-1e9, 1e9] {
                assert!(c.value(u) >= low && c.value(u) <= high);
            }
            assert!(c.of(low).is_finite() && c.of(value.min(high)).is_finite());
        }
    }

    #[test]
    fn each_parameter_has_its_place() {
        let setting = Setting { rig: Rig::thesis(), force: 0.1 };
        let fitted = || Parameter::all().filter(|p| p.can_be_fitted());
        for parameter in fitted() {
            let changed = setting.with(parameter, 0.25);
            for other in fitted() {
                let expected = if other == parameter { 0.25 } else { setting.get(other) };
                assert_eq!(changed.get(other), expected, "{parameter:?} {other:?}");
            }
        }
        for unknown in ["mass", "frequency"] {
            let said = FitEntry::parameter(unknown).unwrap_err().to_string();
            assert!(said.contains(unknown) && said.contains("restitution"), "{said}");
        }
    }
}

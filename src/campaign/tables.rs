//! Tables of a campaign that apply to all sweeps: excitation, model, results to compute and fit.

use crate::error::Error;
use crate::model::Parameter;
use crate::model::ladder::Model;
use serde::Deserialize;
use std::collections::BTreeMap;

/// A key with an impossible value, and the reason.
type Fault = (&'static str, String);

/// The first of these checks that fails, as an error.
fn first_fault(checks: impl IntoIterator<Item = (&'static str, bool, String)>) -> Result<(), Fault> {
    let fault = checks.into_iter().find(|(_, usable, _)| !usable);
    fault.map_or(Ok(()), |(key, _, why)| Err((key, why)))
}

/// Excitation of mass 1 in all sweeps.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Drive {
    /// Kind of excitation: `sine`.
    #[serde(default)]
    pub kind: DriveKind,
    /// Force amplitude in N; if left out, the measured force is used.
    pub force: Option<f64>,
}

/// Kinds of excitation of a sweep.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum DriveKind {
    /// Harmonic force.
    #[default]
    Sine,
}

/// The table `[compute]`: results to compute, and settings.
#[derive(Debug, Clone, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Compute {
    /// Overlay measured responses on the model, where a rig is given. Default true.
    pub overlay: bool,
    /// Draw waterfalls. Default true.
    pub waterfall: bool,
    /// Spectral lines on each side of the excitation frequency that are searched for the peak. Default 3.
    #[serde(alias = "band")]
    pub peak_lines: usize,
    /// Lowest frequency used, in Hz. Default: two line spacings or a quarter of the lowest excitation
    /// frequency, whichever is larger.
    pub fmin: Option<f64>,
    /// Highest frequency in waterfalls and maps, in Hz. Default: where the last line that can be seen beside
    /// the largest lies.
    pub fmax: Option<f64>,
}

impl Compute {
    /// Checks the values; the error is the key with the reason.
    pub(super) fn check(&self) -> Result<(), Fault> {
        let above_zero = [("fmin", self.fmin), ("fmax", self.fmax)].map(|(key, value)| {
            let v = value.unwrap_or(1.0);
            (key, v.is_finite() && v > 0.0, format!("{key} = {v} is not a finite number above 0"))
        });
        let band = format!("peak_lines = {} is not between 1 and 1000 lines", self.peak_lines);
        first_fault(above_zero.into_iter().chain([(
            "peak_lines",
            (1..=1000).contains(&self.peak_lines),
            band,
        )]))
    }
}

impl Default for Compute {
    fn default() -> Compute {
        Compute { overlay: true, waterfall: true, peak_lines: 3, fmin: None, fmax: None }
    }
}

/// The table `[model]`.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct ModelEntry {
    /// Model of the predictions. If left out, the ladder of models chooses it.
    pub name: Option<Follows>,
    /// Relative change of an amplitude that is negligible when a model is chosen. Default 0.02.
    pub tolerance: f64,
    /// Excitation cycles simulated at each point of a sweep before the motion is evaluated, so that
    /// transients decay. Default 300.
    pub settle: u32,
    /// Excitation cycles over which the motion is evaluated: a pattern longer than a ninth of them is not
    /// recognised. Default 64.
    pub measure: u32,
}

/// Contact models that can simulate a sweep.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Follows {
    /// Rigid impacts: a restitution, no duration.
    Restitution,
    /// A contact of a linear spring and a damper.
    KelvinVoigt,
    /// A contact whose force is not linear in the indentation.
    HuntCrossley,
}

impl Follows {
    /// The rung of the ladder.
    pub fn model(self) -> Model {
        match self {
            Follows::Restitution => Model::Restitution,
            Follows::KelvinVoigt => Model::KelvinVoigt,
            Follows::HuntCrossley => Model::HuntCrossley,
        }
    }
}

/// Upper limit of `settle` and of `measure`, in cycles a point: it bounds the time that a sweep may take.
const MOST: u32 = 1_000_000;

impl Default for ModelEntry {
    /// On the rig of the thesis a disturbance decays below e⁻⁸ within 300 cycles.
    fn default() -> ModelEntry {
        ModelEntry { name: None, tolerance: 0.02, settle: 300, measure: 64 }
    }
}

impl ModelEntry {
    /// Checks the values.
    pub(super) fn check(&self) -> Result<(), Fault> {
        let tolerance = self.tolerance;
        let expected = format!("tolerance = {tolerance}: expected a part from 0.0001 to 1");
        let few = |key, n| (key, n <= MOST, format!("{key} = {n} cycles at each point, more than {MOST}"));
        first_fault([
            ("tolerance", (1e-4..=1.0).contains(&tolerance), expected),
            ("measure", self.measure > 0, "measure = 0 cycles: nothing would be read".to_owned()),
            few("settle", self.settle),
            few("measure", self.measure),
        ])
    }
}

/// The table `[fit]`.
#[derive(Debug, Clone, PartialEq, Default, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct FitEntry {
    /// Parameters to fit; if empty, nothing is fitted.
    pub parameters: Vec<Parameter>,
    /// Prior of a parameter from another measurement: `[value, standard uncertainty]`.
    pub prior: BTreeMap<Parameter, [f64; 2]>,
    /// Lowest and highest value that a parameter may take.
    pub bounds: BTreeMap<Parameter, [f64; 2]>,
    /// Number of starting points. Default 8.
    pub starts: Option<usize>,
    /// Relative standard uncertainty of the calibration. It applies to one factor for all amplitudes of a
    /// mass, to a slope from the lowest to the highest frequency, and to the force where that is not
    /// fitted. Default 0.01, with a caution.
    pub calibration: Option<f64>,
    /// Repeatability of the measurement: relative standard uncertainty of each single amplitude, in
    /// addition to the noise in its spectrum. Default 0.
    pub scatter: Option<f64>,
}

/// Largest number of starting points: each is a search of its own, so the computing time grows with it.
const MOST_STARTS: usize = 1000;

impl FitEntry {
    fn known() -> String {
        Parameter::all().filter(|p| p.can_be_fitted()).map(Parameter::name).collect::<Vec<_>>().join(", ")
    }

    /// The parameter of this name that a fit can find.
    ///
    /// # Errors
    /// If no parameter that can be fitted has this name.
    pub fn parameter(name: &str) -> Result<Parameter, Error> {
        Parameter::named(name).filter(|p| p.can_be_fitted()).ok_or_else(|| {
            let error = Error::usage(format!("no parameter of a fit is named {name:?}"), FitEntry::known());
            if name.contains("contact") {
                error.hint("state it as `stiffness` in [contact]: a model corrected for it is then judged")
            } else {
                error
            }
        })
    }

    /// Checks that all values are possible.
    ///
    /// # Errors
    /// The key with an impossible value, and the reason.
    pub fn usable(&self) -> Result<(), Error> {
        let expected = "each parameter once, masses with a prior, and values as docs/campaign.md has them";
        self.check().map_err(|(key, why)| Error::usage(format!("fit of {key}: {why}"), expected))
    }

    /// Checks the values; the error is the key with the reason.
    pub(super) fn check(&self) -> Result<(), Fault> {
        let mut checks = Vec::new();
        for (i, parameter) in self.parameters.iter().enumerate() {
            let name = parameter.name();
            let once = !self.parameters[..i].contains(parameter);
            checks.push(("parameters", once, format!("{name} is named twice")));
            let why = format!("a fit does not look for {name}, but for {}", FitEntry::known());
            checks.push(("parameters", parameter.can_be_fitted(), why));
            let weighed = !parameter.is_mass() || self.prior.contains_key(parameter);
            let why = "while motion tells only the ratios of force, stiffness and damping to the masses: weigh it and give";
            let why = format!(
                "{name} is fitted without a prior, {why} `prior.{name} = [kg, standard uncertainty]` in [fit]"
            );
            checks.push(("parameters", weighed, why));
        }
        let some = self.starts.is_none_or(|n| (1..=MOST_STARTS).contains(&n));
        checks.push(("starts", some, format!("starts is not from 1 to {MOST_STARTS}")));
        for (key, value) in [("calibration", self.calibration), ("scatter", self.scatter)] {
            let relative = value.is_none_or(|v| (0.0..0.5).contains(&v));
            checks.push((key, relative, format!("{key} is not from 0 to 0.5: it is relative, 0.01 for 1 %")));
        }
        for (parameter, [value, std]) in &self.prior {
            let (name, (low, high)) = (parameter.name(), self.range(*parameter));
            let prior = format!("the prior of {name} is {value}");
            let why = "which is not above 0: leave it out of the fit to keep it fixed";
            let why = format!("{prior} with a standard uncertainty of {std}, {why}");
            checks.push((name, value.is_finite() && std.is_finite() && *std > 0.0, why));
            let inside = *value > low && *value < high;
            checks.push((name, inside, format!("{prior}, outside its bounds {low} to {high}")));
        }
        for (parameter, [low, high]) in &self.bounds {
            let (name, (least, most)) = (parameter.name(), parameter.limits());
            let why = match () {
                () if low >= high => "no value lies between",
                () if most.is_finite() => "it is from 0 to 1",
                () => "it is not below 0",
            };
            let possible = low < high && *low >= least && *high <= most;
            checks.push((name, possible, format!("the bounds of {name} are {low} to {high}: {why}")));
        }
        first_fault(checks)
    }

    /// Lowest and highest value that a fit may give a parameter, in its unit.
    pub fn range(&self, parameter: Parameter) -> (f64, f64) {
        let (least, most) = parameter.limits();
        // A gap below 0 (masses pressed together) is searched only within stated bounds.
        self.bounds.get(&parameter).map_or((least.max(0.0), most), |[low, high]| (*low, *high))
    }
}

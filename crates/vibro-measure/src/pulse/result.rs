//! What a contact pulse says.

use super::KelvinVoigt;
use crate::Estimate;
use serde::Serialize;
use std::collections::BTreeMap;
use vibro_record::Finding;

/// A model of a contact.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum ContactModel {
    /// Spring and damper side by side.
    KelvinVoigt,
    /// Two curved bodies without losses.
    Hertz,
    /// Two curved bodies with losses that grow with the indentation.
    HuntCrossley,
}

impl ContactModel {
    /// Its name, as in JSON.
    pub fn name(self) -> &'static str {
        ["kelvin-voigt", "hertz", "hunt-crossley"][self as usize]
    }
}

/// Damping and frequency of a contact, what follows from them, and the models that were fitted.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PulseResult {
    /// Damping ratio of a contact of spring and damper; it and all that follows null where the record is no such contact.
    pub xi: Estimate,
    /// Its undamped natural frequency in Hz.
    pub frequency: Estimate,
    /// Velocity after over velocity before, when it is left at zero force.
    pub restitution: Estimate,
    /// Stiffness in N/m; `None` without a mass.
    pub stiffness: Option<Estimate>,
    /// Damping in N s/m; `None` without a mass.
    pub damping: Option<Estimate>,
    /// Velocity of approach in m/s; `None` where the record is no acceleration.
    pub initial_velocity: Option<Estimate>,
    /// Duration of the contact in s.
    pub duration: Estimate,
    /// Every model fitted to the whole pulse; the first is the one of spring and damper.
    pub fits: Vec<PulseFit>,
    /// What was assumed, and what the record leaves open.
    pub findings: Vec<Finding>,
    /// Curves for a figure.
    #[serde(skip)]
    pub picture: Option<PulsePicture>,
}

impl PulseResult {
    /// The same without values: the record is no such contact.
    pub(super) fn refused(mut self) -> PulseResult {
        let contact = [&mut self.xi, &mut self.frequency, &mut self.restitution, &mut self.duration];
        let more = [&mut self.stiffness, &mut self.damping, &mut self.initial_velocity];
        for estimate in contact.into_iter().chain(more.into_iter().flatten()) {
            (estimate.value, estimate.std) = (f64::NAN, None);
            estimate.method.push_str(", refused: see the findings");
        }
        self
    }
}

/// A model fitted to a pulse.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PulseFit {
    /// The model.
    pub model: ContactModel,
    /// Root mean square of what is left, in the unit of the record.
    pub residual: f64,
    /// Akaike's criterion, corrected; the smaller the better, and only differences count.
    pub aicc: f64,
    /// Probability that white noise shows as much serial correlation as the residuals (Ljung & Box 1978).
    pub whiteness: Option<f64>,
    /// Samples fitted.
    pub n: usize,
    /// Parameters by name.
    pub parameters: BTreeMap<&'static str, Estimate>,
}

/// A pulse and its fits, to be drawn.
#[derive(Debug, Clone, PartialEq)]
pub struct PulsePicture {
    /// Quantity and unit of the record.
    pub quantity: (&'static str, String),
    /// Time in s and value of every sample around the pulse, and whether it was fitted.
    pub samples: Vec<(f64, f64, bool)>,
    /// Curves of the models.
    pub curves: Vec<PulseCurve>,
}

/// One model over the pulse.
#[derive(Debug, Clone, PartialEq)]
pub struct PulseCurve {
    /// The model.
    pub model: ContactModel,
    /// Time in s and value, closely spaced.
    pub points: Vec<(f64, f64)>,
    /// Time in s and residual of every sample that was fitted.
    pub residuals: Vec<(f64, f64)>,
}

/// A value of a function of parameters and its standard uncertainty by their covariance, linearised by central differences.
pub(super) fn propagated(
    parameters: &[f64],
    scale: &[f64],
    covariance: impl Fn(usize, usize) -> f64,
    function: impl Fn(&[f64]) -> Option<f64>,
) -> Option<(f64, f64)> {
    let value = function(parameters)?;
    let mut slopes = Vec::with_capacity(parameters.len());
    for i in 0..parameters.len() {
        let step = f64::EPSILON.cbrt() * parameters[i].abs().max(scale[i].abs());
        let moved = |by: f64| {
            let mut p = parameters.to_vec();
            p[i] += by;
            function(&p)
        };
        slopes.push((moved(step)? - moved(-step)?) / (2.0 * step));
    }
    let mut variance = 0.0;
    for (i, a) in slopes.iter().enumerate() {
        for (j, b) in slopes.iter().enumerate() {
            variance += a * b * covariance(i, j);
        }
    }
    Some((value, variance.sqrt()))
}

/// All that follows from the parameters of a contact of spring and damper, without fits and findings.
pub(super) fn contact_estimates(
    (parameters, scale): (&[f64], &[f64]),
    covariance: impl Fn(usize, usize) -> f64,
    contact: impl Fn(&[f64]) -> Option<KelvinVoigt>,
    mass: Option<f64>,
    n: usize,
    method: &str,
) -> Option<PulseResult> {
    let estimate = |unit: &'static str, of: &dyn Fn(KelvinVoigt) -> f64| {
        let (value, std) = propagated(parameters, scale, &covariance, |p| contact(p).map(of))?;
        Some(Estimate::new(value, Some(std), unit, n, method))
    };
    let omega = |c: KelvinVoigt| std::f64::consts::TAU * c.frequency();
    Some(PulseResult {
        xi: estimate("1", &|c| c.xi())?,
        frequency: estimate("Hz", &|c| c.frequency())?,
        restitution: estimate("1", &|c| c.restitution())?,
        stiffness: mass.and_then(|m| estimate("N/m", &|c| m * omega(c).powi(2))),
        damping: mass.and_then(|m| estimate("N s/m", &|c| 2.0 * c.xi() * m * omega(c))),
        initial_velocity: None,
        duration: estimate("s", &|c| c.duration())?,
        fits: Vec::new(),
        findings: Vec::new(),
        picture: None,
    })
}

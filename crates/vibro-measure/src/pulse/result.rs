//! Results of a contact pulse: damping ratio and frequency, the models fitted, and their uncertainties.

use super::{KelvinVoigt, Rebound};
use crate::Estimate;
use crate::mean::mixture;
use serde::Serialize;
use std::collections::BTreeMap;
use std::f64::consts::TAU;
use std::sync::LazyLock;
use vibro_record::{Finding, Uncertain};

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
    /// A power law with any exponents of spring and loss.
    PowerLaw,
    /// A spring that yields, and is stiffer on unloading.
    Yielding,
}

impl ContactModel {
    /// The models fitted beside that of spring and damper.
    pub(super) const RIVALS: [ContactModel; 4] =
        [ContactModel::Hertz, ContactModel::HuntCrossley, ContactModel::Yielding, ContactModel::PowerLaw];

    /// Its name, as in JSON.
    pub fn name(self) -> &'static str {
        ["kelvin-voigt", "hertz", "hunt-crossley", "power-law", "yielding"][self as usize]
    }

    /// Its name in sentences and tables.
    pub fn words(self) -> &'static str {
        ["spring and damper", "Hertz", "Hunt–Crossley", "power law", "yielding spring"][self as usize]
    }

    /// Number of parameters of its shape.
    pub(super) fn parameters(self) -> usize {
        [2, 1, 2, 4, 2][self as usize]
    }

    /// The contact for the shape parameters after the duration: none (Hertz), the loss α, α and both
    /// exponents, or the restitution (yielding). `None` for spring and damper, and for impossible values.
    pub(super) fn rebound(self, shape: &[f64]) -> Option<Rebound> {
        // Hertz has no shape parameters: integrated once, since every step of a fit needs it.
        static HERTZ: LazyLock<Option<Rebound>> = LazyLock::new(|| Rebound::power_law(0.0, 1.5, 1.5));
        match (self, shape) {
            (ContactModel::Hertz, []) => HERTZ.clone(),
            (ContactModel::HuntCrossley, &[alpha]) => Rebound::power_law(alpha, 1.5, 1.5),
            (ContactModel::PowerLaw, &[alpha, n, s]) => Rebound::power_law(alpha, n, s),
            (ContactModel::Yielding, &[restitution]) => Rebound::yielding(restitution),
            _ => None,
        }
    }

    /// Distances of the exponents of a power law from their prior means, where one standard deviation of the
    /// prior counts as one of the `noise`. Empty for the other models, whose exponents are fixed.
    pub(super) fn unlikely(self, parameters: &[f64], noise: f64) -> Vec<f64> {
        let exponents = if self == ContactModel::PowerLaw { &parameters[5..] } else { &[] };
        exponents.iter().zip(LIKELY).map(|(p, (mean, std))| noise * (p - mean) / std).collect()
    }
}

/// Prior mean and standard deviation of the exponents of spring and loss: from flat to pointed bodies for
/// the spring (Johnson 1985, 5.3), from losses that hardly depend on the indentation to losses that grow
/// with its square. Without losses only the prior determines the second.
pub(super) const LIKELY: [(f64, f64); 2] = [(1.5, 0.5), (1.0, 0.75)];

/// Damping ratio and frequency of a contact, the quantities derived from them, and the fitted models.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PulseResult {
    /// Damping ratio of a contact of spring and damper. It, frequency, stiffness and damping are null where
    /// the record is no such contact.
    pub xi: Estimate,
    /// Its undamped natural frequency in Hz.
    pub frequency: Estimate,
    /// Coefficient of restitution: velocity after over velocity before, with separation at zero force. Like
    /// the velocity of approach and the duration, it is a mean over the likely models where the record
    /// prefers another than spring and damper.
    pub restitution: Estimate,
    /// Stiffness in N/m; `None` without a mass.
    pub stiffness: Option<Estimate>,
    /// Damping in N s/m; `None` without a mass.
    pub damping: Option<Estimate>,
    /// Velocity of approach in m/s; `None` unless the record is an acceleration, or a force on a known mass.
    pub initial_velocity: Option<Estimate>,
    /// Duration of the contact in s.
    pub duration: Estimate,
    /// Largest force of the contact in N, without the effect of low-pass and sensor; `None` unless the record
    /// is a force, or an acceleration of a known mass. Like `impulse`, of the leading models.
    pub peak: Option<Estimate>,
    /// Largest force that the record shows, in N: noise adds to it, and a low-pass takes from it.
    pub peak_read: Option<Estimate>,
    /// Impulse of the contact, ∫F dt, in N s. A low-pass and a sensor keep it.
    pub impulse: Option<Estimate>,
    /// Impulse of the pulse in the record in N s, by its samples alone: it holds for any law of contact and
    /// any instrument.
    pub impulse_read: Option<Estimate>,
    /// The models fitted to the whole pulse; the first is the one of spring and damper.
    pub fits: Vec<PulseFit>,
    /// The models without a fit.
    pub unfitted: Vec<Unfitted>,
    /// Assumptions, and doubts that the record leaves.
    pub findings: Vec<Finding>,
    /// Curves for a figure.
    #[serde(skip)]
    pub picture: Option<PulsePicture>,
    /// Time above half the height in s, whatever the model.
    #[serde(skip)]
    pub width: f64,
}

impl Uncertain for PulseFit {
    fn doubt(&mut self) {
        self.parameters.doubt();
    }

    fn doubt_scale(&mut self) {
        for name in ["baseline", "initial_velocity", "peak", "impulse"] {
            self.parameters.get_mut(name).doubt();
        }
    }
}

impl Uncertain for PulseResult {
    fn doubt(&mut self) {
        self.estimates().for_each(Uncertain::doubt);
        self.fits.doubt();
    }

    fn doubt_scale(&mut self) {
        let read = [&mut self.peak_read, &mut self.impulse_read];
        let scaled = [&mut self.initial_velocity, &mut self.peak, &mut self.impulse];
        scaled.into_iter().chain(read).for_each(Uncertain::doubt);
        self.fits.doubt_scale();
    }
}

impl PulseResult {
    fn estimates(&mut self) -> impl Iterator<Item = &mut Estimate> {
        let contact = [&mut self.xi, &mut self.frequency, &mut self.restitution, &mut self.duration];
        let more = [&mut self.stiffness, &mut self.damping, &mut self.initial_velocity];
        let force = [&mut self.peak, &mut self.peak_read, &mut self.impulse, &mut self.impulse_read];
        contact.into_iter().chain(more.into_iter().chain(force).flatten())
    }

    /// Makes all values null, since the record is no contact of spring and damper.
    pub(super) fn refuse(&mut self) {
        for estimate in self.estimates() {
            (estimate.value, estimate.std) = (f64::NAN, None);
            estimate.method.push_str(", refused: see the findings");
        }
    }

    /// Adds the relative standard uncertainty `clock` of the sampling rate: once to frequency, duration,
    /// damping, velocity and impulse, twice to stiffness, which grows with the square of the rate. Ratios do
    /// not depend on it.
    pub(super) fn by_clock(mut self, clock: f64) -> PulseResult {
        let once = [
            Some(&mut self.frequency),
            Some(&mut self.duration),
            self.damping.as_mut(),
            self.initial_velocity.as_mut(),
            self.impulse.as_mut(),
            self.impulse_read.as_mut(),
        ];
        let all = once.into_iter().map(|of| (of, 1.0)).chain([(self.stiffness.as_mut(), 2.0)]);
        for (estimate, power) in all.filter_map(|(of, power)| Some((of?, power))) {
            *estimate = estimate.clone().with_relative(power * clock);
        }
        self
    }

    /// Adds the spread between the supported models to the uncertainties of restitution, duration and
    /// velocity of approach. Where the record prefers an `other` model than spring and damper, they are means
    /// over these models, a finding says so, and there are no values of spring and damper.
    /// `also` are further minima of the models.
    pub(super) fn led_by_best(&mut self, also: &[PulseFit], other: bool) -> Option<Finding> {
        let best = self.fits.iter().min_by(|a, b| a.aicc.total_cmp(&b.aicc))?;
        let lower = self.fits[0].aicc - best.aicc;
        let lead = if other { best } else { &self.fits[0] };
        // Model averaging (Burnham & Anderson 2002, eq. 4.9) of squares, about the value of spring and damper
        // where that leads, else about the mean. A model whose onset does not match the record has no values
        // (NaN) and is left out. So is, of a mean, the contact of Hertz, which is that of Hunt and Crossley
        // without losses: no pulse shows that there are none.
        let likely = |fit: &&PulseFit| {
            (-0.5 * fit.behind).exp() > NEGLIGIBLE && !(other && fit.model == ContactModel::Hertz)
        };
        let supported: Vec<&PulseFit> = self.fits.iter().chain(also).filter(likely).collect();
        let stated = |name: &str, own: Option<&Estimate>| {
            let led = lead.parameters.get(name)?;
            let of = |fit: &&PulseFit| {
                let fitted = fit.parameters.get(name).filter(|p| !p.value.is_nan())?;
                Some((-0.5 * fit.behind, fitted.value, fitted.std.unwrap_or(f64::NAN).powi(2)))
            };
            let (mean, variance) = mixture(&supported.iter().filter_map(of).collect::<Vec<_>>());
            let value = if other && !led.value.is_nan() { mean } else { led.value };
            let std = variance.sqrt().hypot(mean - value).max(led.std.unwrap_or(f64::NAN));
            let own = own.filter(|_| !other).map(|own| own.method.clone());
            let averaged =
                || format!("{}, mean over the likely models, best {}", led.method, lead.model.words());
            let method = own.unwrap_or_else(averaged);
            Some(Estimate::new(value, Some(std), led.unit, led.n, method))
        };
        let restitution = stated("restitution", Some(&self.restitution));
        let duration = stated("duration", Some(&self.duration));
        let velocity = stated("initial_velocity", self.initial_velocity.as_ref());
        let [peak, impulse] = ["peak", "impulse"].map(|name| stated(name, Some(&self.duration)));
        let law = lead.model.words();
        let found = other.then(|| {
            self.refuse();
            self.fits[0].doubt();
            Finding::note("pulse-other-model").name("model", law).number("ahead", lower)
        });
        self.restitution = restitution.unwrap_or_else(|| self.restitution.clone());
        self.duration = duration.unwrap_or_else(|| self.duration.clone());
        self.initial_velocity = velocity.or(self.initial_velocity.take());
        (self.peak, self.impulse) = (peak, impulse);
        found
    }
}

/// Models with less than this Akaike weight, relative to the best, are left out of the average.
const NEGLIGIBLE: f64 = 1e-6;

/// A model fitted to a pulse.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PulseFit {
    /// The model.
    pub model: ContactModel,
    /// Root mean square of the residuals, in the unit of the record.
    pub residual: f64,
    /// Corrected Akaike criterion (AICc): smaller is better, and only differences between models matter.
    pub aicc: f64,
    /// Probability that white noise shows as much serial correlation as the residuals (Ljung & Box 1978).
    pub whiteness: Option<f64>,
    /// Samples fitted.
    pub n: usize,
    /// Twice the logarithm of the evidence for the likeliest model over that for this one.
    #[serde(skip)]
    pub behind: f64,
    /// Parameters by name.
    pub parameters: BTreeMap<&'static str, Estimate>,
}

/// A model without a fit.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Unfitted {
    /// The model.
    pub model: ContactModel,
    /// Why it has no fit.
    pub reason: String,
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
    /// Time in s and residual of every usable sample around the pulse, fitted or not.
    pub residuals: Vec<(f64, f64)>,
}

/// Value of a function of the parameters and its standard uncertainty from their covariance, linearised by
/// central differences; `scale` sets the smallest step of each parameter.
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

/// The estimates of a contact of spring and damper from its parameters; fits and findings stay empty.
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
    let omega = |c: KelvinVoigt| TAU * c.frequency();
    Some(PulseResult {
        xi: estimate("1", &|c| c.xi())?,
        frequency: estimate("Hz", &|c| c.frequency())?,
        restitution: estimate("1", &|c| c.restitution())?,
        stiffness: mass.and_then(|m| estimate("N/m", &|c| m * omega(c).powi(2))),
        damping: mass.and_then(|m| estimate("N s/m", &|c| 2.0 * c.xi() * m * omega(c))),
        initial_velocity: None,
        duration: estimate("s", &|c| c.duration())?,
        peak: None,
        peak_read: None,
        impulse: None,
        impulse_read: None,
        fits: Vec::new(),
        unfitted: Vec::new(),
        findings: Vec::new(),
        picture: None,
        width: f64::NAN,
    })
}

/// Half-width of the interval of ξ where it has no uncertainty: the low-pass of an unknown instrument moves
/// ξ by about this much.
pub(super) const UNKNOWN: f64 = 0.1;

/// Caution that ξ is consistent with zero: below twice its standard uncertainty or, without one, below
/// [`UNKNOWN`].
pub(super) fn undamped(xi: &Estimate) -> Option<Finding> {
    let found = Finding::caution("pulse-no-damping").number("xi", xi.value);
    let (reach, found) = match xi.std {
        Some(std) => (2.0 * std, found.number("std", std)),
        None => (UNKNOWN, found.number("allowed", UNKNOWN)),
    };
    (xi.value < reach).then_some(found)
}

//! Contact pulses: damping ratio and contact frequency from two instants, or from fits to the whole pulse.
//!
//! The model of spring and damper (Kelvin–Voigt) gives the answer; those of Hertz and of Hunt and Crossley are fitted beside it,
//! to see whether the record prefers them. The instrument's low-pass is applied to the models in closed form.

mod findings;
mod fit;
mod hunt_crossley;
mod kelvin_voigt;
mod locate;
mod low_pass;
mod normalised;
mod result;
mod two_times;

pub use kelvin_voigt::KelvinVoigt;
pub use low_pass::LowPass;
pub use result::{ContactModel, PulseCurve, PulseFit, PulsePicture, PulseResult};
pub use two_times::two_times;

use super::Estimate;
use super::residuals::Whiteness;
use findings::findings;
use hunt_crossley::HuntCrossley;
use locate::locate;
use normalised::{Normalised, Window};
use result::contact_estimates;
use vibro_record::units::notation::shortest;
use vibro_record::{Error, Finding, Result, Trace};

/// What is known of a pulse beside its record.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct PulseOptions {
    /// What the instrument did to the pulse. Default: unknown, and no uncertainty.
    pub instrument: Instrument,
    /// Mass in kg that is decelerated, taken as exact. Default: unknown, and no stiffness and damping.
    pub mass: Option<f64>,
}

/// What an instrument does to the shape of a pulse.
#[derive(Debug, Clone, Default, PartialEq)]
pub enum Instrument {
    /// Not known. An ignored low-pass moves ξ by 0.1 and more, and fits may look right all the same: there are no uncertainties.
    #[default]
    Unknown,
    /// Nothing.
    Flat,
    /// A Butterworth low-pass.
    LowPass(LowPass),
}

impl Instrument {
    /// What a person states: nothing, no low-pass (`Some(None)`), or one of a corner in Hz with its order.
    ///
    /// # Errors
    /// If corner and order do not come together; as [`LowPass::new`].
    pub fn stated(low_pass: Option<Option<f64>>, order: Option<usize>) -> Result<Instrument> {
        match (low_pass, order) {
            (None, None) => Ok(Instrument::Unknown),
            (Some(None), None) => Ok(Instrument::Flat),
            (Some(Some(corner)), Some(order)) => Ok(Instrument::LowPass(LowPass::new(corner, order)?)),
            (Some(Some(corner)), None) => Err(Error::usage(
                format!("a low-pass of {corner} Hz without its order"),
                "the order of the low-pass, 1 to 10",
            )
            .setting("order")),
            (_, Some(order)) => Err(Error::usage(
                format!("a low-pass of order {order} without its corner"),
                "the corner of the low-pass in Hz",
            )
            .setting("low_pass")),
        }
    }

    /// Whether its effect is known at this sampling rate: not where its rise falls between two samples.
    fn is_known_at(&self, rate: f64) -> bool {
        match self {
            Instrument::Unknown => false,
            Instrument::Flat => true,
            Instrument::LowPass(filter) => filter.corner() < 0.5 * rate,
        }
    }

    /// The low-pass, if there is one.
    pub fn low_pass(&self) -> Option<&LowPass> {
        if let Instrument::LowPass(filter) = self { Some(filter) } else { None }
    }
}

/// Fewest samples above half the height, two thirds of a half sine: five inside the pulse, whose shape has four parameters.
const FEWEST: f64 = 10.0 / 3.0;

/// Fits the largest pulse of a record of acceleration (or of force).
///
/// Residuals are taken for noise of one variance. Where they are correlated, which is tested, uncertainties are enlarged by the
/// correlation. Where the pulse begins otherwise than the model can, as behind an unstated low-pass, ξ and all that follows are
/// null. Where the instrument is unknown, or its corner lies at half the sampling rate or above, no uncertainty is stated: in the one
/// case another ξ may pass for this one, in the other more than one onset fits.
///
/// # Errors
/// If the record is not evenly sampled in time, holds no whole pulse, or too few samples of it, or does not determine the
/// parameters; if the mass is not above 0.
pub fn pulse(trace: &Trace, options: &PulseOptions) -> Result<PulseResult> {
    let Some(rate) = trace.rate().filter(|r| r.is_finite() && *r > 0.0) else {
        return Err(Error::refused("a pulse needs evenly spaced samples over time")
            .hint("state the sampling rate in Hz")
            .setting("rate"));
    };
    if let Some(mass) = options.mass.filter(|m| !(m.is_finite() && *m > 0.0)) {
        return Err(Error::usage(format!("a mass of {mass} kg"), "a finite mass above 0"));
    }
    let located = locate(&trace.values)?;
    let seen = located.flanks.1 - located.flanks.0;
    if seen < FEWEST {
        return Err(Error::refused(format!(
            "the pulse has {seen:.1} samples above half its height, and at least {FEWEST:.1} are needed"
        ))
        .hint("sample faster"));
    }
    let mut found = Vec::new();
    let filter = options.instrument.low_pass();
    if let Some(filter) = filter.filter(|f| f.corner() >= 0.5 * rate) {
        found.push(
            Finding::doubt("pulse-corner-above-half-rate")
                .number("corner", filter.corner())
                .number("rate", rate),
        );
    }
    let unlike = |error: Error| unlike(&error, filter, 1.5 * seen / rate);
    let scale = Normalised::new(trace, rate, &located, filter)?;
    let Window { samples, used, level } = scale.window(&mut found, unlike)?;
    let main = samples.fit(ContactModel::KelvinVoigt).map_err(unlike)?;
    let whiteness = Whiteness::of(&[&main.fit.residuals]);
    let n = samples.times.len();
    let method = match filter {
        Some(filter) => format!(
            "least squares, spring and damper through a Butterworth low-pass of order {} at {} Hz",
            filter.order(),
            shortest(filter.corner())
        ),
        None => "least squares, spring and damper".to_owned(),
    };
    let unit = [1.0, 1.0 / scale.length];
    let shape = [main.fit.parameters[3], main.fit.parameters[4] * unit[1]];
    let widening = samples.widening(&main, &whiteness);
    let known = level && options.instrument.is_known_at(rate);
    let widened = widening.filter(|_| known).unwrap_or(f64::NAN);
    let covariance =
        |i: usize, j: usize| widened.powi(2) * unit[i] * unit[j] * samples.covariance(&main, 3 + i, 3 + j);
    let contact = |p: &[f64]| KelvinVoigt::new(p[0], p[1]);
    let mut result = contact_estimates((&shape, &unit), covariance, contact, options.mass, n, &method)
        .ok_or_else(|| {
            Error::refused("the fitted contact lies at the border of what is possible (ξ near 1)")
        })?;
    match scale.to_velocity(options.mass) {
        Ok(factor) => {
            let std = factor * samples.std(&main, 2) * widened;
            let value = factor * main.fit.parameters[2].abs();
            result.initial_velocity = Some(Estimate::new(value, Some(std), "m/s", n, method));
        }
        Err(why) => found.push(why),
    }
    let mut fits = vec![(main, whiteness)];
    for rival in [ContactModel::Hertz, ContactModel::HuntCrossley] {
        match samples.fit(rival) {
            Ok(fitted) => {
                let whiteness = Whiteness::of(&[&fitted.fit.residuals]);
                fits.push((fitted, whiteness));
            }
            Err(_) => found.push(Finding::caution("pulse-model-not-fitted").name("model", rival.name())),
        }
    }
    // Beyond rounding a contact gives back no more than it took.
    let gains = result.xi.value + 2.0 * result.xi.std.unwrap_or(0.1) < 0.0;
    if gains {
        found.push(
            Finding::doubt("pulse-gains-energy")
                .number("xi", result.xi.value)
                .number("restitution", result.restitution.value),
        );
    }
    if gains || widening.is_none() {
        result = result.refused();
    }
    result.fits = fits.iter().map(|(f, w)| scale.report(&samples, f, w, options.mass, known)).collect();
    found.extend(findings(&fits[0].0, widening, &fits[0].1, &result.fits, &result, options));
    result.findings = found;
    result.picture = Some(scale.picture(&samples, &used, fits.iter().map(|f| &f.0)));
    Ok(result)
}

/// That no contact of spring and damper fits a pulse of about this duration in s.
fn unlike(error: &Error, filter: Option<&LowPass>, duration: f64) -> Error {
    match filter {
        Some(filter) => Error::refused(format!(
            "no contact behind a low-pass of order {} at {} Hz fits the pulse, which lasts about {:.3} ms ({error})",
            filter.order(),
            shortest(filter.corner()),
            1e3 * duration
        ))
        .hint("check corner and order: a low-pass lengthens a pulse to 1/corner at least")
        .setting("low_pass")
        .setting("order"),
        None => Error::refused(format!("no contact of spring and damper fits the pulse ({error})"))
            .hint("choose a record with one clean pulse and its baseline"),
    }
}

#[cfg(test)]
mod tests;

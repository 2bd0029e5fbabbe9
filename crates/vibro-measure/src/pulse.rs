//! Contact pulses: damping ratio and contact frequency from two instants, or from fits to the whole pulse.
//!
//! The model of spring and damper (Kelvin–Voigt) gives the answer; those of Hertz and of Hunt and Crossley are fitted beside it,
//! to see whether the record prefers them. What the instrument's low-pass does to a pulse is done to the models, in closed form.

mod doubts;
mod fit;
mod hunt_crossley;
mod kelvin_voigt;
mod locate;
mod low_pass;
mod result;
mod two_times;
mod view;

pub use hunt_crossley::HuntCrossley;
pub use kelvin_voigt::KelvinVoigt;
pub use low_pass::LowPass;
pub use result::{PulseCurve, PulseFit, PulsePicture, PulseResult};
pub use two_times::two_times;

use super::Estimate;
use super::residuals::Whiteness;
use doubts::doubts;
use fit::{Model, Trust};
use locate::locate;
use result::contact_estimates;
use vibro_record::units::notation::shortest;
use vibro_record::{Error, Result, Trace};
use view::View;

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
    /// Not known. A low-pass that is not taken into account moves ξ by 0.1 and more, and fits may look right all the same: there
    /// are no uncertainties.
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
                "its order, 1 to 10",
            )),
            (_, Some(order)) => Err(Error::usage(
                format!("a low-pass of order {order} without its corner"),
                "its corner in Hz, too",
            )),
        }
    }

    /// Whether what it does can be told at this sampling rate: not where it is not known, nor where the rise of its low-pass falls between
    /// two samples.
    fn told(&self, rate: f64) -> bool {
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
/// correlation and that is said; where the pulse begins otherwise than the model can, as behind an unstated low-pass, ξ and all
/// that follows are null. Where it is not known whether the instrument has a low-pass no uncertainty is stated: such a pulse may
/// pass for one without a low-pass and another ξ. A low-pass is applied whatever its corner, but from half the sampling rate on no uncertainty
/// is stated: its rise falls between two samples, and more than one onset fits.
///
/// # Errors
/// If the record is not evenly sampled in time, holds no whole pulse, or too few samples of it, or does not determine the
/// parameters; if the mass is not above 0.
pub fn pulse(trace: &Trace, options: &PulseOptions) -> Result<PulseResult> {
    let Some(rate) = trace.rate().filter(|r| r.is_finite() && *r > 0.0) else {
        return Err(Error::refused("a pulse needs evenly spaced samples over time")
            .hint("state the sampling rate with --rate"));
    };
    if let Some(mass) = options.mass.filter(|m| !(m.is_finite() && *m > 0.0)) {
        return Err(Error::usage(format!("a mass of {mass} kg"), "a finite mass above 0"));
    }
    let found = locate(&trace.values)?;
    let seen = found.flanks.1 - found.flanks.0;
    if seen < FEWEST {
        return Err(Error::refused(format!(
            "the pulse has {seen:.1} samples above half its height, and at least {FEWEST:.1} are needed"
        ))
        .hint("sample faster"));
    }
    let mut warnings = Vec::new();
    if let Some(filter) = options.instrument.low_pass().filter(|f| f.corner() >= 0.5 * rate) {
        warnings.push(format!(
            "The low-pass at {} Hz is not below half the sampling rate of {} Hz: its rise falls between two samples, more than one onset fits, and there is no uncertainty. Where it does not matter, --low-pass none states that.",
            shortest(filter.corner()),
            shortest(rate)
        ));
    }
    let unlike = |error: Error| {
        match options.instrument.low_pass() {
        Some(filter) => Error::refused(format!(
            "no contact behind a low-pass of order {} at {} Hz looks like the pulse, which lasts about {:.3} ms ({error})",
            filter.order(),
            shortest(filter.corner()),
            1.5e3 * seen / rate
        ))
        .hint("check corner and order: a low-pass lengthens a pulse to about 1/corner at least; try without, or with a higher corner"),
        None => Error::refused(format!("no contact of spring and damper looks like the pulse ({error})"))
            .hint("choose a record with one clean pulse and its baseline"),
    }
    };
    let view = View::new(trace, rate, &found, options.instrument.low_pass())?;
    let (samples, used, rests) = view.window(&mut warnings, unlike)?;
    let main = samples.fit(Model::KelvinVoigt).map_err(unlike)?;
    let whiteness = Whiteness::of(&[&main.fit.residuals]);
    let n = samples.times.len();
    let method = match options.instrument.low_pass() {
        Some(filter) => format!(
            "least squares, spring and damper through a Butterworth low-pass of order {} at {} Hz",
            filter.order(),
            shortest(filter.corner())
        ),
        None => "least squares, spring and damper".to_owned(),
    };
    let unit = [1.0, 1.0 / view.length];
    let shape = [main.fit.parameters[3], main.fit.parameters[4] * unit[1]];
    let trust = samples.trust(&main, &whiteness);
    let told = rests && options.instrument.told(rate);
    let widened = if told { trust.factor() } else { f64::NAN };
    let covariance =
        |i: usize, j: usize| widened.powi(2) * unit[i] * unit[j] * samples.covariance(&main, 3 + i, 3 + j);
    let contact = |p: &[f64]| KelvinVoigt::new(p[0], p[1]);
    let mut result = contact_estimates((&shape, &unit), covariance, contact, options.mass, n, &method)
        .ok_or_else(|| {
            Error::refused("the fitted contact lies at the border of what is possible (ξ near 1)")
        })?;
    match view.to_velocity(options.mass) {
        Ok(factor) => {
            let std = factor * samples.std(&main, 2) * widened;
            let value = factor * main.fit.parameters[2].abs();
            result.initial_velocity = Some(Estimate::new(value, Some(std), "m/s", n, method));
        }
        Err(why) => warnings.push(why),
    }
    let mut fits = vec![(main, whiteness)];
    for rival in [Model::Hertz, Model::HuntCrossley] {
        match samples.fit(rival) {
            Ok(fitted) => {
                let whiteness = Whiteness::of(&[&fitted.fit.residuals]);
                fits.push((fitted, whiteness));
            }
            Err(error) => warnings.push(format!("The model {} could not be fitted: {error}.", rival.name())),
        }
    }
    // Beyond rounding a contact gives back no more than it took.
    if result.xi.value + 2.0 * result.xi.std.unwrap_or(0.1) < 0.0 {
        warnings.push(format!(
            "The fit gives ξ = {:.3}, restitution {:.3}: more comes back than arrived. The top may be cut, the baseline uneven, or this is no contact; nothing is stated.",
            result.xi.value, result.restitution.value
        ));
        result = result.refused();
    }
    if trust == Trust::Refused {
        result = result.refused();
    }
    result.fits = fits.iter().map(|(f, w)| view.report(&samples, f, w, options.mass, told)).collect();
    warnings.extend(doubts(&fits[0].0, trust, &fits[0].1, &result.fits, &result, options));
    result.warnings = warnings;
    result.picture = Some(view.picture(&samples, &used, fits.iter().map(|f| &f.0)));
    Ok(result)
}

#[cfg(test)]
mod tests;

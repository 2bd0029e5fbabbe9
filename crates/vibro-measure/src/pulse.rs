//! Contact pulses: damping ratio and contact frequency from two instants, or from fits to the whole pulse.
//!
//! The model of spring and damper (Kelvin–Voigt) gives the answer unless the record prefers another. Fitted
//! beside it are those of Hertz, of Hunt and Crossley, of a power law with free exponents, and of a yielding
//! spring. Where spring and damper does not lead, restitution, duration and velocity are means over the
//! likely models. The instrument's low-pass is applied to the models in closed form.

mod contact;
mod edge;
mod evidence;
mod expected;
mod fit;
mod impulse;
mod instants;
mod linear;
mod located;
mod losses;
mod low_pass;
mod normalised;
mod rebound;
mod result;
mod ringing;
mod sensor;

pub use contact::KelvinVoigt;
pub use expected::{GuessedPulse, expected, rehearse};
pub use instants::two_times;
pub use low_pass::LowPass;
pub use result::{ContactModel, PulseCurve, PulseFit, PulsePicture, PulseResult, Unfitted};

use super::Estimate;
use super::residuals::NO_SUPPORT;

use fit::{FittedPulse, Samples};
use located::{Located, locate};
use normalised::Normalised;
use rebound::Rebound;
use result::{UNKNOWN, contact_estimates, undamped};
use vibro_record::units::Quantity;
use vibro_record::units::notation::{quantity, shortest};
use vibro_record::{Doubt, Error, Finding, Result, Trace, Uncertain};

/// Options: what is known of a pulse beside its record.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct PulseOptions {
    /// Effect of the instrument on the pulse. Default: unknown, so that no uncertainty is stated.
    pub instrument: Instrument,
    /// Mass in kg that is decelerated, taken as exact. Default: unknown, so that there is no stiffness and
    /// damping, and of an acceleration no force and impulse.
    pub mass: Option<f64>,
}

/// Effect of an instrument on the shape of a pulse.
#[derive(Debug, Clone, Default, PartialEq)]
pub enum Instrument {
    /// Not known: no uncertainties are stated. An ignored low-pass moves ξ by 0.1 and more, and fits may
    /// look right all the same.
    #[default]
    Unknown,
    /// The pulse passes unchanged.
    Flat,
    /// A Butterworth low-pass.
    LowPass(LowPass),
}

impl Instrument {
    /// From what the user states: nothing (unknown), no low-pass (`Some(None)`), or one of a corner in Hz
    /// with its order.
    ///
    /// # Errors
    /// If corner and order do not come together; as [`LowPass::new`].
    pub fn stated(low_pass: Option<Option<f64>>, order: Option<usize>) -> Result<Instrument> {
        match (low_pass, order) {
            (None, None) => Ok(Instrument::Unknown),
            (Some(None), None) => Ok(Instrument::Flat),
            (Some(Some(corner)), Some(order)) => LowPass::new(corner, order).map(Instrument::LowPass),
            (Some(Some(corner)), None) => {
                let found = format!("a low-pass of {corner} Hz without its order");
                Err(Error::usage(found, "the order of the low-pass, 1 to 10").setting("order"))
            }
            (_, Some(order)) => {
                let found = format!("a low-pass of order {order} without its corner");
                Err(Error::usage(found, "the corner of the low-pass in Hz").setting("low_pass"))
            }
        }
    }

    /// Reasons why a pulse recorded by this instrument at `rate` in Hz does not determine the contact.
    fn doubts(&self, rate: f64) -> Vec<Doubt> {
        match self {
            Instrument::Unknown => vec![Finding::doubt("pulse-instrument-unknown")],
            // The rise of this low-pass falls between two samples.
            Instrument::LowPass(filter) if filter.corner >= 0.5 * rate => {
                let above = Finding::doubt("pulse-corner-above-half-rate");
                vec![above.number("corner", filter.corner).number("rate", rate)]
            }
            _ => Vec::new(),
        }
    }

    /// The low-pass, if there is one.
    pub fn low_pass(&self) -> Option<&LowPass> {
        if let Instrument::LowPass(filter) = self { Some(filter) } else { None }
    }
}

/// Duration of a contact times the corner of the low-pass below which the shape is mostly the filter's.
const NEAR_CORNER: f64 = 2.0;

/// Fewest samples above half the height. A half sine is above it for two thirds of its length: five samples
/// in the pulse, one more than its shape has parameters.
const FEWEST: f64 = 10.0 / 3.0;

/// Speed in m/s below which a blow is asked about, if its body has 1 kg or more: the mass may be meant in g.
const SLOWEST: f64 = 0.01;

/// Least time above half the height of a pulse, times the corner of the low-pass that it has passed: that of
/// the impulse response of order 1, `e^(−2πft)`, is ln 2/(2π) = 0.110; higher orders have a longer one.
const LEAST_HALF_WIDTH: f64 = 0.1;

/// Refuses a low-pass of this `corner` (Hz) behind which no pulse is as short as one above half its height
/// for this `time` (s).
fn is_possible(corner: f64, time: f64) -> Result<()> {
    if time * corner >= LEAST_HALF_WIDTH {
        return Ok(());
    }
    let (is, at_least) = (quantity(time, "s", 2), quantity(LEAST_HALF_WIDTH / corner, "s", 2));
    let why = |typed: &str| {
        Error::refused(format!(
            "a low-pass of {} Hz{typed} Behind it every pulse is above half its height for {at_least} or longer, and this one is for {is}",
            shortest(corner)
        ))
    };
    let meant = 1e3 * corner;
    Err(if time * meant >= LEAST_HALF_WIDTH {
        let meant = shortest(meant);
        why(&format!(": did you mean {meant} Hz ({} kHz)?", shortest(corner)))
            .hint("the corner in Hz")
            .set("low_pass", meant)
    } else {
        why(" is impossible.").hint("the corner of the filter that the pulse has passed").setting("low_pass")
    })
}

/// The caution about a mass that struck too slowly for a blow; a force alone tells nothing of it.
fn slow_blow(trace: &Trace, options: &PulseOptions, result: &PulseResult) -> Option<Finding> {
    let mass = options.mass.filter(|mass| *mass >= 1.0)?;
    let speed = result.initial_velocity.as_ref()?.value;
    let is_slow = trace.meta.unit.quantity() == Quantity::Force && speed < SLOWEST;
    let large = Finding::caution("pulse-mass-large").number("mass", mass).number("speed", speed);
    is_slow.then(|| large.number("meant", 1e-3 * mass))
}

/// Fits the largest pulse of a record of acceleration (or of force).
///
/// Residuals are taken as noise of one variance; where a test finds them correlated, uncertainties are
/// enlarged. Where the onset does not match the model, as after an unstated low-pass, ξ and all values
/// derived from it are null. No uncertainty is stated where the instrument is unknown, since another ξ may
/// fit as well, or where its corner is at half the sampling rate or above, since more than one onset fits.
///
/// # Errors
/// If the record is not evenly sampled in time, holds no whole pulse, or too few samples of it, or does not
/// determine the parameters; if the mass is not above 0.
pub fn pulse(trace: &Trace, options: &PulseOptions) -> Result<PulseResult> {
    let rate = trace.sampling_rate()?;
    check(trace, options)?;
    let located = locate(&trace.values)?;
    let seen = samples_of(&located, located.another(&trace.values).is_some())?;
    let filter = options.instrument.low_pass();
    filter.map_or(Ok(()), |filter| is_possible(filter.corner, seen / rate))?;
    let (mut doubts, mut found) = (options.instrument.doubts(rate), Vec::new());
    let unlike = |error: Error| {
        let lasts = 1.5e3 * seen / rate;
        Error::refused(format!("no contact of spring and damper fits the pulse, which lasts about {lasts:.3} ms ({error})"))
            .hint("choose a record with one clean pulse and its baseline; a low-pass lengthens a pulse to 1/corner at least")
            .setting("low_pass")
    };
    let scale = Normalised::new(trace, rate, &located, filter)?;
    let (mut samples, mut level) = scale.window(&mut found, unlike)?;
    let main = samples.fit(ContactModel::KelvinVoigt).map_err(unlike)?;
    let (mut fits, mut unfitted) = rivals(&samples, main);
    if let Some(rings) = sensor::ringing(&scale, &fits) {
        (samples, fits, unfitted, level) = (rings.samples, rings.fits, rings.unfitted, None);
    }
    let rests = samples.rings.is_none() || level.is_some();
    found.extend((!rests).then(|| Finding::caution("pulse-no-rest-after")));
    let has_level = level.is_none();
    doubts.extend(level);
    // No model of a pulse in doubt has an uncertainty, also where it only decides on another finding.
    let known = doubts.is_empty();
    let (widening, whiteness) = (fits[0].widening, fits[0].whiteness);
    let widened = widening.filter(|_| known).unwrap_or(f64::NAN);
    let mut result = spring_and_damper(&fits[0], (&scale, samples.times.len()), widened, options)?;
    found.splice(..0, doubts.into_iter().map(|doubt| doubt.of(&mut result)));
    // A contact cannot return more energy than it took: ξ may be below 0 only by its uncertainty.
    let gains = result.xi.value + 2.0 * result.xi.std.unwrap_or(UNKNOWN) < 0.0;
    let onset = if filter.is_none() { "pulse-low-pass-missing" } else { "pulse-onset-unlike" };
    // Reasons against spring and damper; they do not count for a contact that follows another law.
    let impossible = [gains.then(|| gained(&result)), widening.is_none().then(|| Finding::doubt(onset))];
    if gains || widening.is_none() {
        result.refuse();
    }
    let xi = result.xi.value;
    let spread = result.xi.std.map_or(UNKNOWN, |s| 2.0 * s);
    let duration = result.duration.value;
    let no_peak = (xi + spread >= 0.5).then(|| Finding::caution("pulse-no-inner-peak").number("xi", xi));
    if let Some(filter) = filter.filter(|filter| duration * filter.corner < NEAR_CORNER) {
        let near = Finding::caution("pulse-near-corner").number("duration", duration);
        found.push(near.number("corner", filter.corner));
    }
    result.unfitted = unfitted;
    over_losses(&samples, &mut fits, &mut result.unfitted);
    let best = leader(&fits);
    let unexplained = samples.unexplained(best);
    let of_best = best.whiteness;
    let dispersion = samples.dispersion(&best.fit);
    found.extend(samples.mode.map(|_| scale.rings(best)));
    let against = |fit: &FittedPulse| fits[0].behind(fit, dispersion) - fit.improbable();
    let other = fits.iter().any(|fit| against(fit) > NO_SUPPORT);
    // Against spring and damper free exponents pay for the laws that they rule out; among other laws, which
    // may all be wrong, they do not.
    let price = |fit: &FittedPulse| if other { 0.0 } else { fit.improbable() };
    let report = |fit: &FittedPulse| PulseFit {
        behind: fit.behind(best, dispersion) + price(fit),
        ..scale.report(fit, options.mass, known && !unexplained)
    };
    result.fits = fits.iter().map(report).collect();
    let also: Vec<_> = fits.iter().flat_map(|fit| &fit.also).map(report).collect();
    let lead = if other { leader(&fits) } else { &fits[0] };
    let led = result.led_by_best(&also, other);
    let noise = samples.noise().0;
    result.peak_read = scale.peak_read(lead, noise, options.mass);
    if !known || unexplained || result.restitution.value.is_nan() {
        result.peak_read.doubt();
    }
    if led.is_none() || result.restitution.value.is_nan() {
        found.extend(impossible.into_iter().flatten().map(|doubt| doubt.of(&mut result)));
    }
    // What is known of ξ does not count for another law.
    found.extend(no_peak.filter(|_| led.is_none()));
    let whiteness = if led.is_some() { of_best } else { whiteness };
    let answered = !result.restitution.value.is_nan();
    let coloured = answered && whiteness.rejected();
    found.extend(led.filter(|_| answered && !unexplained));
    let restitution = &result.restitution;
    let more = restitution.std.is_some_and(|std| restitution.value - 2.0 * std > 1.0);
    found.extend(more.then(|| gained(&result).of(&mut result)));
    if unexplained {
        let doubt = Finding::doubt("pulse-unexplained").of(&mut result);
        found.push(if known { doubt } else { doubt.name("unknown", "low-pass of the instrument") });
    }
    found.extend(slow_blow(trace, options, &result));
    // Where a doubt has taken the uncertainties, none is enlarged.
    let code = "pulse-residuals-coloured";
    let pattern = match result.restitution.std {
        Some(_) => whiteness.coloured(code),
        None => Finding::caution(code),
    };
    found.extend(coloured.then_some(pattern));
    found.extend(undamped(&result.xi));
    // It rests on no model of contact or instrument, but on the level around the pulse.
    let force = scale.force_of_unit(options.mass).filter(|_| has_level);
    result.impulse_read = force.and_then(|force| impulse::read(&trace.values, rate, &located, force));
    result = result.by_clock(trace.meta.clock);
    result.findings = found;
    result.picture = Some(scale.picture(&samples, &fits));
    result.width = seen / rate;
    Ok(result)
}

/// Replaces a power law by that with all likely losses. It needs them only where spring and damper does not
/// lead. A law that is only likely with a loss below 0 is no contact.
fn over_losses(samples: &Samples<'_>, fits: &mut Vec<FittedPulse>, unfitted: &mut Vec<Unfitted>) {
    let best = leader(fits);
    let behind = fits[0].behind(best, samples.dispersion(&best.fit)) > NO_SUPPORT;
    let law = fits.iter().position(|fit| behind && fit.model == ContactModel::PowerLaw);
    let Some(law) = law else { return };
    match samples.over_losses(&fits[law]) {
        Some(averaged) => fits[law] = averaged,
        None if fits[law].loss() < 0.0 => {
            let reason = "the samples prefer a loss below 0".to_owned();
            unfitted.push(Unfitted { model: fits.remove(law).model, reason });
        }
        None => {}
    }
}

/// The fit of the lowest `AICc`.
fn leader(fits: &[FittedPulse]) -> &FittedPulse {
    fits.iter().fold(&fits[0], |best, fit| if fit.aicc() < best.aicc() { fit } else { best })
}

/// Number of samples of a pulse above half its height; with `several`, the record has more like it.
///
/// # Errors
/// If there are too few for a fit.
fn samples_of(located: &Located, several: bool) -> Result<f64> {
    let seen = located.flanks.1 - located.flanks.0;
    if seen < FEWEST {
        let why = format!(
            "the pulse has {seen:.1} samples above half its height, and at least {FEWEST:.1} are needed"
        );
        // A spike among others is an impact of a machine: a faster record would show several pulses.
        return Err(Error::refused(why).hint(if several {
            "`vibro impacts` times several impacts in a row; for the shape of one of them sample faster"
        } else {
            "sample faster"
        }));
    }
    Ok(seen)
}

/// Estimates of a spring and damper fitted to `n` samples. `widened` is the factor on their uncertainties,
/// NaN where these are not known.
fn spring_and_damper(
    main: &FittedPulse,
    (scale, n): (&Normalised, usize),
    widened: f64,
    options: &PulseOptions,
) -> Result<PulseResult> {
    let filter = options.instrument.low_pass();
    let through = |f: &LowPass| {
        format!(" through a Butterworth low-pass of order {} at {} Hz", f.order, shortest(f.corner))
    };
    let method = format!("least squares, spring and damper{}", filter.map_or_else(String::new, through));
    let unit = [1.0, 1.0 / scale.length];
    let shape = [main.fit.parameters[3], main.fit.parameters[4] * unit[1]];
    let covariance =
        |i: usize, j: usize| widened.powi(2) * unit[i] * unit[j] * main.fit.covariance(3 + i, 3 + j);
    let contact = |p: &[f64]| KelvinVoigt::new(p[0], p[1]);
    let border = || Error::refused("the fitted contact lies at the border of what is possible (ξ near 1)");
    let mut result = contact_estimates((&shape, &unit), covariance, contact, options.mass, n, &method)
        .ok_or_else(border)?;
    result.initial_velocity = scale.to_velocity(options.mass).map(|factor| {
        let std = factor * main.fit.std(2) * widened;
        Estimate::new(factor * main.fit.parameters[2].abs(), Some(std), "m/s", n, method)
    });
    Ok(result)
}

/// Refuses records of displacement or velocity, and a mass that is not above 0.
fn check(trace: &Trace, options: &PulseOptions) -> Result<()> {
    let quantity = trace.meta.quantity;
    if matches!(quantity, Quantity::Displacement | Quantity::Velocity) {
        return Err(Error::refused(format!("the record is one of {quantity}")).hint(
            "choose a record of acceleration or force; differentiate a velocity once, a displacement twice",
        ));
    }
    if let Some(mass) = options.mass.filter(|m| !(m.is_finite() && *m > 0.0)) {
        return Err(Error::usage(format!("a mass of {mass} kg"), "a finite mass above 0"));
    }
    Ok(())
}

/// Fits all models to the samples, spring and damper first. The power law is skipped where the shape of the
/// pulse shows, and spring and damper leaves white residuals and is clearly ahead of the other models. The
/// second value has the models without a fit.
fn rivals(samples: &Samples<'_>, main: FittedPulse) -> (Vec<FittedPulse>, Vec<Unfitted>) {
    let (mut fits, mut unfitted) = (vec![main], Vec::new());
    for rival in ContactModel::RIVALS {
        let behind = fits[1..].iter().all(|fit| fit.aicc() - fits[0].aicc() > NO_SUPPORT);
        let lasts = fits[0].end() - fits[0].fit.parameters[0];
        // Behind a slow low-pass a law between those of the other models looks like spring and damper.
        let shown = samples.filter.is_none_or(|filter| filter.corner * lasts > NEAR_CORNER);
        if rival == ContactModel::PowerLaw && behind && shown && !fits[0].whiteness.rejected() {
            let reason = "not needed, spring and damper is clearly ahead".to_owned();
            unfitted.push(Unfitted { model: rival, reason });
            continue;
        }
        match samples.fit(rival) {
            Ok(fit) => fits.push(fit),
            Err(error) => unfitted.push(Unfitted { model: rival, reason: error.to_string() }),
        }
    }
    (fits, unfitted)
}

fn gained(result: &PulseResult) -> Doubt {
    let gained = Finding::doubt("pulse-gains-energy").number("restitution", result.restitution.value);
    if result.xi.value.is_nan() { gained } else { gained.number("xi", result.xi.value) }
}

#[cfg(test)]
mod tests;

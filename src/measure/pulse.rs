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
use crate::error::{Error, Result};
use crate::record::Trace;
use doubts::doubts;
use fit::{Model, Trust};
use locate::locate;
use result::contact_estimates;
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
            "The low-pass at {} Hz is not below half the sampling rate of {rate} Hz: its rise falls between two samples, more than one onset fits, and there is no uncertainty. Where it does not matter, --low-pass none states that.",
            filter.corner()
        ));
    }
    let unlike = |error: Error| {
        match options.instrument.low_pass() {
        Some(filter) => Error::refused(format!(
            "no contact behind a low-pass of order {} at {} Hz looks like the pulse, which lasts about {:.3} ms ({error})",
            filter.order(),
            filter.corner(),
            1.5e3 * seen / rate
        ))
        .hint("check corner and order: a low-pass lengthens a pulse to about 1/corner at least; try without, or with a higher corner"),
        None => Error::refused(format!("no contact of spring and damper looks like the pulse ({error})"))
            .hint("choose a record with one clean pulse and its baseline"),
    }
    };
    let view = View::new(trace, rate, &found, options.instrument.low_pass())?;
    let (samples, used) = view.window(&mut warnings, unlike)?;
    let main = samples.fit(Model::KelvinVoigt).map_err(unlike)?;
    let whiteness = Whiteness::of(&[&main.fit.residuals]);
    let n = samples.times.len();
    let method = match options.instrument.low_pass() {
        Some(filter) => format!(
            "least squares, spring and damper through a Butterworth low-pass of order {} at {} Hz",
            filter.order(),
            filter.corner()
        ),
        None => "least squares, spring and damper".to_owned(),
    };
    let unit = [1.0, 1.0 / view.length];
    let shape = [main.fit.parameters[3], main.fit.parameters[4] * unit[1]];
    let trust = samples.trust(&main, &whiteness);
    let told = options.instrument.told(rate);
    let widened = if told { trust.factor() } else { f64::NAN };
    let covariance =
        |i: usize, j: usize| widened.powi(2) * unit[i] * unit[j] * main.fit.covariance(3 + i, 3 + j);
    let contact = |p: &[f64]| KelvinVoigt::new(p[0], p[1]);
    let mut result = contact_estimates((&shape, &unit), covariance, contact, options.mass, n, &method)
        .ok_or_else(|| {
            Error::refused("the fitted contact lies at the border of what is possible (ξ near 1)")
        })?;
    match view.to_velocity(options.mass) {
        Ok(factor) => {
            let std = factor * main.fit.std(2) * widened;
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
mod tests {
    use super::*;
    use crate::record::{Axis, Meta};
    use crate::units::Unit;

    const DT: f64 = 1e-6;

    /// A record of 200 samples, a contact of ξ 0.2, 10 kHz and 3 m/s at 80.4 µs on it, and a ripple of 0.1 % for noise.
    fn record() -> Vec<f64> {
        let contact = KelvinVoigt::new(0.2, 10e3).unwrap();
        (0..200)
            .map(|i| {
                let t = f64::from(i) * DT - 80.4e-6;
                let pulse = if t >= 0.0 && t <= contact.duration() { contact.unbounded(t) } else { 0.0 };
                3.0 * pulse + 200.0 * (f64::from(i * i) * 0.7).sin()
            })
            .collect()
    }

    fn trace(values: Vec<f64>, unit: &str) -> Trace {
        let axis = Axis::time(0.5, DT, values.len());
        Trace { meta: Meta::new("bit", Unit::parse(unit).unwrap()), axis, values }
    }

    fn found(values: Vec<f64>) -> PulseResult {
        let result =
            pulse(&trace(values, "m/s²"), &PulseOptions { mass: Some(0.4), instrument: Instrument::Flat })
                .unwrap();
        // Five of the uncertainties that are stated, and those within a hundredth of the value.
        for (estimate, truth) in [(&result.xi, 0.2), (&result.frequency, 10e3)] {
            let std = estimate.std.unwrap();
            assert!((estimate.value - truth).abs() < 5.0 * std && std < 0.02 * truth, "{result:?}");
        }
        result
    }

    fn says(result: &PulseResult, words: &str) -> bool {
        result.warnings.iter().any(|w| w.contains(words))
    }

    #[test]
    fn all_that_follows_from_a_pulse() {
        let result = found(record());
        let velocity = result.initial_velocity.as_ref().unwrap();
        assert!((velocity.value - 3.0).abs() < 5.0 * velocity.std.unwrap(), "{result:?}");
        let onset = &result.fits[0].parameters["onset"];
        assert!((onset.value - 0.5 - 80.4e-6).abs() < 5.0 * onset.std.unwrap(), "{onset:?}");
        let k = result.stiffness.as_ref().unwrap().value;
        assert!((k / (0.4 * (std::f64::consts::TAU * result.frequency.value).powi(2)) - 1.0).abs() < 1e-12);
        let models: Vec<&str> = result.fits.iter().map(|f| f.model).collect();
        assert_eq!(models, ["kelvin-voigt", "hertz", "hunt-crossley"]);
        assert!(result.fits[1..].iter().all(|f| f.aicc > result.fits[0].aicc + 10.0), "{:?}", result.fits);
    }

    #[test]
    fn an_unknown_instrument_leaves_no_uncertainty() {
        let result =
            pulse(&trace(record(), "m/s²"), &PulseOptions { mass: Some(0.4), ..PulseOptions::default() });
        let result = result.unwrap();
        assert!(says(&result, "not known whether") && result.xi.value.is_finite(), "{:?}", result.warnings);
        let all = [&result.xi, &result.frequency, &result.restitution, &result.duration];
        assert!(all.iter().all(|e| e.std.is_none()) && result.stiffness.unwrap().std.is_none());
        assert!(result.initial_velocity.unwrap().std.is_none());
        assert!(result.fits.iter().flat_map(|f| f.parameters.values()).all(|e| e.std.is_none()));
    }

    #[test]
    fn without_an_uncertainty_the_borders_of_xi_are_said_from_afar() {
        let of = |xi: f64| {
            let contact = KelvinVoigt::new(xi, 10e3).unwrap();
            let values = (0..200).map(|i| {
                let t = f64::from(i) * DT - 80.4e-6;
                let pulse = if t >= 0.0 && t <= contact.duration() { contact.unbounded(t) } else { 0.0 };
                pulse + 50.0 * (f64::from(i * i) * 0.7).sin()
            });
            let record = trace(values.collect(), "m/s²");
            let known = PulseOptions { instrument: Instrument::Flat, mass: None };
            [pulse(&record, &PulseOptions::default()).unwrap(), pulse(&record, &known).unwrap()]
        };
        // 0.44 and 0.05 are each within 0.1 of a border, and not within the uncertainty of about 0.005 of a known instrument.
        let [unknown, known] = of(0.44);
        assert!(says(&unknown, "1/2 or more") && !says(&known, "1/2 or more"), "{:?}", unknown.warnings);
        let [unknown, known] = of(0.05);
        assert!(
            says(&unknown, "no damping is seen") && !says(&known, "no damping"),
            "{:?}",
            unknown.warnings
        );
    }

    #[test]
    fn polarity_and_baseline_do_not_matter() {
        found(record().iter().map(|v| 5e4 - v).collect());
    }

    #[test]
    fn a_clipped_top_is_left_out() {
        let result = found(record().iter().map(|v| v.min(1.2e5)).collect());
        assert!(says(&result, "clipped"), "{:?}", result.warnings);
    }

    #[test]
    fn ringing_after_the_pulse_is_not_fitted() {
        let end = 80.4e-6 + KelvinVoigt::new(0.2, 10e3).unwrap().duration();
        let ringing = record().into_iter().enumerate().map(|(i, v)| {
            let t = i as f64 * DT - end;
            v + if t > 0.0 { 4e4 * (-t / 30e-6).exp() * (t * 2e5).sin() } else { 0.0 }
        });
        let result = found(ringing.collect());
        assert!(says(&result, "does not rest"), "{:?}", result.warnings);
    }

    #[test]
    fn the_contact_of_hunt_and_crossley_is_preferred_where_it_is_one() {
        let contact = HuntCrossley::new(0.3).unwrap();
        let times: Vec<f64> = (0..200).map(|i| f64::from(i) * DT - 80.4e-6).collect();
        let shape = contact.decelerations(45e-6, None, &times);
        let values = shape
            .iter()
            .zip(record())
            .enumerate()
            .map(|(i, (v, _))| 3.0 * v + 200.0 * ((i * i) as f64 * 0.7).sin());
        let options = PulseOptions { instrument: Instrument::Flat, mass: None };
        let result = pulse(&trace(values.collect(), "m/s²"), &options).unwrap();
        assert!(says(&result, "prefers the model hunt-crossley"), "{:?}", result.warnings);
        let alpha = &result.fits[2].parameters["alpha"];
        assert!((alpha.value - 0.3).abs() < 5.0 * alpha.std.unwrap(), "{alpha:?}");
    }

    /// A contact through a low-pass of 30 kHz, fitted without.
    #[test]
    fn without_the_low_pass_that_is_there_nothing_is_stated() {
        let contact = KelvinVoigt::new(0.15, 6e3).unwrap();
        let filter = LowPass::new(30e3, 2).unwrap();
        let values: Vec<f64> = (0..400)
            .map(|i| {
                let noise = 100.0 * (f64::from(i * i) * 0.7).sin();
                contact.filtered(&filter, f64::from(i) * DT - 150.4e-6) + noise
            })
            .collect();
        let fitted = |corner: Option<f64>| {
            let instrument =
                corner.map_or(Instrument::Flat, |hz| Instrument::LowPass(LowPass::new(hz, 2).unwrap()));
            pulse(&trace(values.clone(), "m/s²"), &PulseOptions { instrument, mass: None })
        };
        let with = fitted(Some(30e3)).unwrap().xi;
        assert!((with.value - 0.15).abs() < 5.0 * with.std.unwrap(), "{with:?}");
        let nothing = |found: &PulseResult| {
            let own = &found.fits[0].parameters["xi"];
            [&found.xi, &found.frequency, &found.restitution, &found.duration, own]
                .iter()
                .all(|e| e.value.is_nan() && e.std.is_none())
        };
        let without = fitted(None).unwrap();
        assert!(nothing(&without), "{without:?}");
        assert!(says(&without, "low-pass of the instrument is needed"), "{:?}", without.warnings);
        // One that is far too high is as good as none, above half the sampling rate as below.
        let beyond = fitted(Some(600e3)).unwrap();
        assert!(nothing(&beyond), "{:?} {:?}", beyond.xi, beyond.warnings);
        let high = fitted(Some(450e3)).unwrap();
        assert!(nothing(&high), "{:?} {:?}", high.xi, without.xi);
        assert!(fitted(Some(1e3)).unwrap_err().to_string().contains("low-pass"));
    }

    #[test]
    fn a_force_needs_the_mass_and_a_voltage_has_no_velocity() {
        let options = PulseOptions { mass: Some(0.5), ..PulseOptions::default() };
        let force = pulse(&trace(record(), "N"), &options).unwrap();
        // F = ma: half the mass, twice the acceleration.
        assert!((force.initial_velocity.unwrap().value / 6.0 - 1.0).abs() < 0.02);
        let bare = pulse(&trace(record(), "N"), &PulseOptions::default()).unwrap();
        assert!(bare.initial_velocity.is_none() && says(&bare, "needs the mass"));
        let volts = pulse(&trace(record(), "V"), &PulseOptions::default()).unwrap();
        assert!(volts.initial_velocity.is_none() && says(&volts, "no acceleration"));
    }

    #[test]
    fn what_is_no_pulse_is_refused() {
        let refusal = |values| pulse(&trace(values, "m/s²"), &PulseOptions::default()).unwrap_err();
        assert!(refusal(vec![1.0; 80]).to_string().contains("all samples are 1"));
        let mut spike = vec![0.0; 80];
        spike[40] = 1.0;
        assert!(refusal(spike).to_string().contains("sample faster"));
        let uneven = Trace { axis: Axis::index(200), ..trace(record(), "m/s²") };
        assert!(pulse(&uneven, &PulseOptions::default()).unwrap_err().to_string().contains("--rate"));
        let options = PulseOptions { mass: Some(0.0), ..PulseOptions::default() };
        assert_eq!(pulse(&trace(record(), "m/s²"), &options).unwrap_err().exit_code(), 2);
    }
}

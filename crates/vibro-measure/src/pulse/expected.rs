//! Expected uncertainty of a planned contact pulse.

use super::fit::{FittedPulse, Samples};
use super::located::{Located, locate};
use super::normalised::Normalised;
use super::{ContactModel, Instrument, KelvinVoigt, PulseOptions, pulse, samples_of, spring_and_damper};
use crate::expected::{DrawnNoise, Expected, Heard, Recorder};
use crate::mean::together;
use nalgebra::DMatrix;
use vibro_math::Noise;
use vibro_record::units::Unit;
use vibro_record::{Axis, Error, Finding, Meta, Result, Trace};

/// A contact of spring and damper as it is guessed before the test.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GuessedPulse {
    /// Damping ratio.
    pub xi: f64,
    /// Undamped natural frequency of the contact in Hz.
    pub frequency: f64,
    /// Velocity of approach in m/s.
    pub speed: f64,
    /// Mass in kg; of a force it is needed.
    pub mass: Option<f64>,
    /// Whether the record is one of force, not of acceleration.
    pub force: bool,
}

/// Baseline of a planned record on either side of its pulse, in durations of what the pulse looks like.
const BESIDE: f64 = 4.0;

impl GuessedPulse {
    fn contact(&self) -> Result<KelvinVoigt> {
        let possible = (0.0..1.0).contains(&self.xi);
        KelvinVoigt::new(self.xi, self.frequency).filter(|_| possible).ok_or_else(|| {
            Error::usage(format!("a damping ratio of {}", self.xi), "0 to below 1").setting("xi")
        })
    }

    /// The record of the pulse without noise, with its onset at the part `phase` of a sampling interval.
    ///
    /// # Errors
    /// If the contact is impossible, or a force has no mass.
    pub fn record(&self, recorder: &Recorder, phase: f64) -> Result<Trace> {
        let contact = self.contact()?;
        let (unit, factor) = match (self.force, self.mass) {
            (false, _) => ("m/s²", self.speed),
            (true, Some(mass)) => ("N", self.speed * mass),
            (true, None) => {
                return Err(Error::usage("a force without a mass", "the mass in kg").setting("mass"));
            }
        };
        let filter = recorder.low_pass.as_ref();
        let seen = contact.duration() + filter.map_or(0.0, |filter| 3.0 * filter.delay());
        Recorder::check_work(3.0 * BESIDE * seen * recorder.rate)?;
        let before = (BESIDE * seen * recorder.rate).ceil();
        let n = 2 * before as usize + (seen * recorder.rate) as usize + 2;
        let onset = before + phase;
        let value = |i: usize| {
            let t = (i as f64 - onset) / recorder.rate;
            factor
                * match filter {
                    _ if t < 0.0 => 0.0,
                    Some(filter) => contact.filtered(filter, t),
                    None if t <= contact.duration() => contact.unbounded(t),
                    None => 0.0,
                }
        };
        let unit = Unit::parse(unit).ok_or_else(|| Error::refused("the unit of a pulse"))?;
        let meta = Meta::new("planned", unit);
        Ok(Trace { meta, axis: Axis::time(0.0, 1.0 / recorder.rate, n), values: (0..n).map(value).collect() })
    }
}

/// Records over which the variances are averaged without a low-pass. There the force jumps at the onset, and
/// how well that is known depends on its place between two samples, and on the noise of these.
const RECORDS: u32 = 16;

/// What the samples of a pulse will tell, by the fit of spring and damper of [`super::pulse`].
///
/// # Errors
/// If the contact is impossible, or the record allows no fit.
pub fn expected(guess: &GuessedPulse, recorder: &Recorder) -> Result<Expected> {
    let mut found = at(guess, recorder, 0.5, None)?;
    let drawn = if recorder.low_pass.is_some() { 0 } else { RECORDS };
    let one = |k: u32| {
        let phase = (f64::from(k) + 0.5) / f64::from(RECORDS);
        at(guess, recorder, phase, Some(Noise::new(k.into())))
    };
    // A record in sixteen that allows no fit is no plan.
    let all = (0..drawn).map(one).collect::<Result<Vec<Expected>>>()?;
    for (name, answer) in &mut found.answers {
        let of = |one: &Expected| one.answers.iter().find(|(other, _)| other == name)?.1.std;
        answer.std = together(all.iter().map(of)).or(answer.std);
    }
    found.findings.extend(hidden(guess.contact()?.duration(), recorder));
    Ok(found)
}

/// What a pulse will tell whose onset lies at the part `phase` of a sampling interval: without noise, or with
/// one that is drawn.
fn at(guess: &GuessedPulse, recorder: &Recorder, phase: f64, drawn: Option<Noise>) -> Result<Expected> {
    let mut trace = guess.record(recorder, phase)?;
    if let Some(mut noise) = drawn {
        let std = recorder.covariance(0).sqrt();
        trace.values.iter_mut().for_each(|value| *value += std * noise.normal());
    }
    recorder.holds(trace.values.iter().fold(0.0, |most: f64, v| most.max(v.abs())))?;
    // The record has no step of a converter; its rounding is in the covariance.
    let located = Located { quantum: 0.0, clipped: Vec::new(), ..locate(&trace.values)? };
    samples_of(&located, false)?;
    let instrument = recorder.low_pass.clone().map_or(Instrument::Flat, Instrument::LowPass);
    let options = PulseOptions { instrument, mass: guess.mass };
    let scale = Normalised::new(&trace, recorder.rate, &located, options.instrument.low_pass())?;
    let (samples, _) = scale.window(&mut Vec::new(), |error| error)?;
    let height = located.height.abs();
    let covariance = |apart: usize| recorder.covariance(apart) / (height * height);
    let samples = Samples { planned: Some(covariance(0)), ..samples };
    let fitted = samples.fit(ContactModel::KelvinVoigt)?;
    let (n, places) = (samples.places.len(), &samples.places);
    let fit = if recorder.is_white() {
        // Between two samples the onset has a covariance of its own.
        let covariance = &fitted.fit.cofactor * covariance(0);
        fitted.fit.clone().of_covariance(covariance)
    } else {
        let all: Vec<f64> = (0..trace.values.len()).map(covariance).collect();
        let c = |i: usize, k: usize| all[places[i].abs_diff(places[k])];
        let times_c = |gain: &DMatrix<f64>| {
            let product = |i: usize, j: usize| (0..n).map(|k| c(i, k) * gain[(k, j)]).sum();
            DMatrix::from_fn(n, gain.ncols(), product)
        };
        fitted.fit.clone().under_noise(times_c)
    };
    let fitted = FittedPulse { fit, widening: Some(1.0), ..fitted };
    let result = spring_and_damper(&fitted, (&scale, n), 1.0, &options)?;
    let mut found = Expected::default();
    let optional = [("stiffness", &result.stiffness), ("damping", &result.damping)];
    found.put("xi", &result.xi);
    found.put("frequency", &result.frequency);
    found.put("restitution", &result.restitution);
    found.put("duration", &result.duration);
    let velocity = result.initial_velocity.as_ref().map(|velocity| ("initial_velocity", velocity));
    let optional = optional.into_iter().filter_map(|(name, estimate)| Some((name, estimate.as_ref()?)));
    optional.chain(velocity).for_each(|(name, estimate)| found.put(name, estimate));
    let report = scale.report(&fitted, guess.mass, true);
    for name in ["peak", "impulse"] {
        if let Some(estimate) = report.parameters.get(name) {
            found.put(name, estimate);
        }
    }
    let names = ["onset", "baseline", "initial_velocity", "xi", "frequency"];
    found.tie(&fitted.fit, &names.into_iter().map(str::to_owned).enumerate().collect::<Vec<_>>());
    Ok(found)
}

/// Draws records of the pulse with onsets at any part of a sampling interval, and measures them by
/// [`super::pulse`].
///
/// # Errors
/// As that.
pub fn rehearse(guess: &GuessedPulse, recorder: &Recorder) -> impl Fn(&mut Noise) -> Result<Heard> + use<> {
    let (guess, recorder) = (*guess, recorder.clone());
    let instrument = recorder.low_pass.clone().map_or(Instrument::Flat, Instrument::LowPass);
    let options = PulseOptions { instrument, mass: guess.mass };
    move |noise| {
        let truth = guess.record(&recorder, noise.uniform())?;
        let drawn = DrawnNoise::of(&recorder, truth.values.len());
        let found = pulse(&drawn.record(truth.values, truth.meta.unit, noise), &options)?;
        let fitted = [
            ("xi", &found.xi),
            ("frequency", &found.frequency),
            ("restitution", &found.restitution),
            ("duration", &found.duration),
        ];
        let optional = [
            ("stiffness", &found.stiffness),
            ("damping", &found.damping),
            ("initial_velocity", &found.initial_velocity),
            ("peak", &found.peak),
            ("impulse", &found.impulse),
        ];
        let optional = optional.into_iter().filter_map(|(name, estimate)| Some((name, estimate.as_ref()?)));
        let all = fitted.into_iter().chain(optional);
        Ok((all.map(|(name, estimate)| (name.to_owned(), estimate.clone())).collect(), found.findings))
    }
}

/// Caution where the low-pass makes most of the pulse's shape, or all of it.
fn hidden(duration: f64, recorder: &Recorder) -> Option<Finding> {
    let filter = recorder.low_pass.as_ref()?;
    let end = filter.alone().map(|[_, end]| end).filter(|end| *end > duration);
    let found = |code| Finding::caution(code).number("duration", duration).number("corner", filter.corner);
    if let Some(end) = end {
        return Some(found("plan-filter-alone").number("end", end));
    }
    (duration * filter.corner < super::NEAR_CORNER).then(|| found("pulse-near-corner"))
}

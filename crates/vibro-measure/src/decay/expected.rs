//! Expected uncertainty of the modes of a planned free decay.

use super::damped::{Damped, SineGroup};
use super::mode;
use super::sines::{ENOUGH, range};
use super::{DecayMode, DecayOptions, decay};
use crate::expected::{DrawnNoise, Expected, Heard, Recorder};
use num_complex::Complex64;
use std::f64::consts::TAU;
use vibro_math::Noise;
use vibro_record::units::Unit;
use vibro_record::{Error, Result, sort_by_number};

/// A mode as it is guessed before the test.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GuessedMode {
    /// Undamped natural frequency in Hz.
    pub frequency: f64,
    /// Damping ratio.
    pub zeta: f64,
    /// Amplitude at the release, in the unit of the record.
    pub amplitude: f64,
}

/// What the lines of a decay of these modes will tell of them, by the fit of [`super::decay`].
///
/// # Errors
/// If the record holds too few lines, or too few samples a period.
pub fn expected(modes: &[GuessedMode], recorder: &Recorder, unit: &'static str) -> Result<Expected> {
    let mut modes = modes.to_vec();
    sort_by_number(&mut modes, |mode| mode.frequency);
    let rate = |mode: &GuessedMode| TAU * mode.frequency * mode.zeta;
    let motion = |mode: &GuessedMode| mode.amplitude / rate(mode);
    let strongest = modes.iter().max_by(|a, b| motion(a).total_cmp(&motion(b)));
    let strongest = strongest.ok_or_else(|| Error::usage("a decay without a mode", "one mode or more"))?;
    if let Some(high) = modes.iter().find(|mode| mode.frequency > 0.5 * recorder.rate) {
        let found = format!("a mode at {} Hz, sampled at {} Hz", high.frequency, recorder.rate);
        return Err(
            Error::usage(found, "a sampling rate above twice the frequency, both in Hz").setting("rate")
        );
    }
    recorder.holds(modes.iter().map(|mode| mode.amplitude).sum())?;
    // Samples behind the sixth time constant of the strongest mode are not used.
    let enough = (ENOUGH / rate(strongest) * recorder.rate) as usize;
    let n = recorder.samples().min(enough);
    let duration = n as f64 / recorder.rate;
    let sine = |mode: &GuessedMode| {
        let gain = recorder.low_pass.as_ref().map_or(1.0, |filter| filter.gain(mode.frequency));
        Damped {
            periods: mode.frequency * (1.0 - mode.zeta * mode.zeta).sqrt() * duration,
            decay: rate(mode) * duration,
            amplitude: Complex64::new(gain * mode.amplitude, 0.0),
        }
    };
    let sines: Vec<Damped> = modes.iter().map(sine).collect();
    let mut found = Expected::default();
    for near in sines.chunk_by(SineGroup::near) {
        let lines = range(near, n / 2 + 1);
        Recorder::check_work(lines.end as f64)?;
        let spectrum: Vec<Complex64> =
            (0..lines.end).map(|k| near.iter().map(|sine| sine.line(k, n)).sum()).collect();
        let starts: Vec<(f64, f64)> = near.iter().map(|sine| (sine.periods, sine.decay)).collect();
        // A component of a line 2/N Σ xⱼe^(−2πijk/N) has the variance of the density over the duration.
        let variance = |k: usize| recorder.spectrum(k as f64 / duration) / duration;
        let group = SineGroup::fit(&spectrum, lines.clone(), n, &starts, &[])?.under_noise(variance);
        let mut names = Vec::new();
        for m in 0..near.len() {
            let one = mode(&group, m, n, recorder.rate, unit);
            let of =
                if modes.len() > 1 { format!(" {}", found.answers.len() / 3 + 1) } else { String::new() };
            found.put(format!("frequency{of}"), &one.frequency);
            found.put(format!("zeta{of}"), &one.zeta);
            found.put(format!("amplitude{of}"), &one.amplitude);
            names.extend(SineGroup::shapes(m, &of));
        }
        found.tie(&group.fit, &names);
    }
    Ok(found)
}

/// Largest relative distance of a found mode from the planned one.
const NEAR: f64 = 0.05;

/// Draws records of these modes, released behind a tenth of silence, and measures them by [`super::decay`].
///
/// # Errors
/// As that.
pub fn rehearse(
    modes: &[GuessedMode],
    recorder: &Recorder,
    unit: Unit,
) -> impl Fn(&mut Noise) -> Result<Heard> + use<> {
    let mut modes = modes.to_vec();
    sort_by_number(&mut modes, |mode| mode.frequency);
    let before = recorder.samples() / 10;
    let rate = recorder.rate;
    let gains: Vec<f64> = modes
        .iter()
        .map(|mode| recorder.low_pass.as_ref().map_or(1.0, |filter| filter.gain(mode.frequency)))
        .collect();
    let value = |i: usize| {
        let t = (i as f64 - before as f64) / rate;
        let motion = |(mode, gain): (&GuessedMode, &f64)| {
            let omega = TAU * mode.frequency;
            let decayed = gain * mode.amplitude * (-mode.zeta * omega * t).exp();
            decayed * (omega * (1.0 - mode.zeta * mode.zeta).sqrt() * t).cos()
        };
        if i < before { 0.0 } else { modes.iter().zip(&gains).map(motion).sum() }
    };
    let truth: Vec<f64> = (0..before + recorder.samples()).map(value).collect();
    let release = before as f64 / rate;
    let drawn = DrawnNoise::of(recorder, truth.len());
    move |noise| {
        let found = decay(&drawn.record(truth.clone(), unit.clone(), noise), &DecayOptions::default())?;
        let mut left: Vec<&DecayMode> = found.modes.iter().collect();
        let mut answers = Vec::new();
        for (k, mode) in modes.iter().enumerate() {
            let off = |found: &DecayMode| (found.frequency.value - mode.frequency).abs();
            // A found mode answers for the planned one that is nearest to it.
            let nearest = |found: &DecayMode| {
                modes.iter().all(|other| off(found) <= (found.frequency.value - other.frequency).abs())
            };
            let place = (0..left.len())
                .filter(|i| off(left[*i]) < NEAR * mode.frequency && nearest(left[*i]))
                .min_by(|a, b| off(left[*a]).total_cmp(&off(left[*b])));
            let Some(own) = place.map(|place| left.remove(place)) else { continue };
            // The part that is fitted may begin a few samples beside the release.
            let late = TAU * own.frequency.value * own.zeta.value * (found.start - release);
            let mut amplitude = own.amplitude.clone();
            amplitude.value *= late.exp();
            let of = if modes.len() > 1 { format!(" {}", k + 1) } else { String::new() };
            answers.push((format!("frequency{of}"), own.frequency.clone()));
            answers.push((format!("zeta{of}"), own.zeta.clone()));
            answers.push((format!("amplitude{of}"), amplitude));
        }
        Ok((answers, found.findings))
    }
}

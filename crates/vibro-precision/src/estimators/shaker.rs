//! Damping ratio from the force of a shaker and the response, over time.

use super::trial::{Case, Ensemble, EstimationMethod, Numbers, Record, trace};
use super::{EstimatorScene, bounds, damping, rivals, scene};
use std::f64::consts::TAU;
use vibro_math::Noise;
use vibro_measure::modal::Measured;
use vibro_measure::spectral::{SpectralOptions, spectral};
use vibro_record::{Error, Result, Trace, Traces};
use vibro_signal::transfer::Estimator;

/// Sampling rate in Hz.
const RATE: f64 = 512.0;
/// Samples of a record: 64 s.
const N: usize = 32_768;
/// Samples of a segment: lines of 0.25 Hz, eight in the bandwidth of the mode.
const SEGMENT: usize = 2048;
/// Natural frequency in Hz and damping ratio of the mode.
const FREQUENCY: f64 = 100.0;
const ZETA: f64 = 0.01;

/// Force and displacement.
struct Shaken([Trace; 2]);

impl Record for Shaken {
    fn numbers(&self) -> Numbers {
        let Shaken([force, response]) = self;
        let both = force.values.iter().zip(&response.values);
        Numbers { values: both.flat_map(|(f, x)| [*f, *x]).collect(), ..force.numbers() }
    }
}

/// Methods for the damping ratio.
const METHODS: [EstimationMethod<Shaken>; 2] = [
    EstimationMethod::Rival("H1, half power", |s| {
        function(s).map_or(f64::NAN, |m| rivals::half_power(&m.frequency, &m.values, true))
    }),
    EstimationMethod::Own("H1, rational fit", |s| damping::rational(&function(s)?)),
];

/// The response function, as from `vibro modal --reference force --segment 2048`.
fn function(Shaken(traces): &Shaken) -> Result<Measured> {
    let estimator = Some(Estimator::H1);
    let options = SpectralOptions { segment: Some(SEGMENT), estimator, ..SpectralOptions::default() };
    let records = spectral(&mut Traces::from_memory(traces.to_vec())?, &options, |_| ())?.records();
    let (_, measured) = Measured::all(&records, None)?.pop().ok_or_else(|| Error::refused("no function"))?;
    Ok(measured)
}

/// Displacements of a mode of mass 1 from rest, natural frequency in Hz and ζ, under a force constant within
/// each step: the motion within a step in closed form.
fn motion(frequency: f64, zeta: f64, force: &[f64]) -> Vec<f64> {
    let (omega, step) = (TAU * frequency, 1.0 / RATE);
    let (decay, damped_omega) = (zeta * omega, omega * (1.0 - zeta * zeta).sqrt());
    let (sin, cos) = (damped_omega * step).sin_cos();
    let (left, ratio) = ((-decay * step).exp(), decay / damped_omega);
    let (mut x, mut v) = (0.0, 0.0);
    let mut next = |f: &f64| {
        let (now, rest) = (x, f / (omega * omega));
        let y = x - rest;
        x = rest + left * (y * (cos + ratio * sin) + v / damped_omega * sin);
        v = left * (v * (cos - ratio * sin) - y * omega * omega / damped_omega * sin);
        now
    };
    force.iter().map(&mut next).collect()
}

/// A random force, and its response without noise, of an RMS of about 1.
fn draw(noise: &mut Noise) -> [Vec<f64>; 2] {
    let force: Vec<f64> = (0..N).map(|_| noise.normal()).collect();
    // Variance of the displacement under white noise of the density 1/RATE (two-sided, per Hz).
    let rms = (1.0 / (4.0 * ZETA * (TAU * FREQUENCY).powi(3) * RATE)).sqrt();
    let response = motion(FREQUENCY, ZETA, &force).iter().map(|x| x / rms).collect();
    [force, response]
}

/// Draws records in noise of `part` of the response's RMS.
fn shaken(part: f64) -> impl Fn(&mut Noise) -> Case<Shaken> {
    move |noise| {
        let [force, mut response] = draw(noise);
        for x in &mut response {
            *x += part * noise.normal();
        }
        let data =
            Shaken([trace("force", "N", 1.0 / RATE, force), trace("laser", "m", 1.0 / RATE, response)]);
        Case { data, truth: ZETA, unit: ZETA, tolerance: 0.1 * ZETA }
    }
}

/// Cramér–Rao bound of the relative error of ζ: the force is known, frequency, ζ and modal mass are not.
fn bound(part: f64) -> f64 {
    let [force, response] = draw(&mut Noise::new(70_000));
    let clean = motion(FREQUENCY, ZETA, &force);
    let scale = response[N - 1] / clean[N - 1];
    let model = |p: &[f64]| motion(p[0], p[1], &force).iter().map(|x| p[2] * scale * x).collect();
    bounds(&[FREQUENCY, ZETA, 1.0], &[1e-3, 1e-5, 1e-3], part, model)[1] / ZETA
}

/// The scene of a shaker.
pub fn scenes() -> Vec<EstimatorScene> {
    let settings = [0.01, 0.1, 1.0]
        .map(|part| Ensemble::new(format!("noise of {} %", 100.0 * part), 70_000, shaken(part)));
    let texts = [
        "shaker",
        "The damping ratio of a mode of ζ 1 % at 100 Hz from 64 s of a random force and the displacement, in noise of 1 to 100 % of its RMS; the bound is that of 1 %.",
        "damping ratio: relative error (rms)",
        "the mode whose motion was computed in closed form",
    ];
    vec![scene(texts, bound(0.01), &METHODS, settings)]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A constant force: x = (1 − e^(−ζωt)(cos Ωt + ζω/Ω sin Ωt))/ω² with Ω = ω√(1 − ζ²).
    #[test]
    fn a_step_of_the_force_moves_the_mode_as_the_closed_form() {
        let (omega, zeta) = (TAU * 80.0, 0.05);
        let (decay, own) = (zeta * omega, omega * f64::sqrt(1.0 - zeta * zeta));
        for (i, x) in motion(80.0, zeta, &[1.0; 200]).into_iter().enumerate() {
            let t = i as f64 / RATE;
            let free = (-decay * t).exp() * ((own * t).cos() + decay / own * (own * t).sin());
            assert!((x * omega * omega - (1.0 - free)).abs() < 1e-11, "{i}");
        }
    }
}

//! Damping ratio from a free decay.

use super::trial::{Case, Ensemble, EstimationMethod, EstimatorAnswer, trace};
use super::{EstimatorScene, bounds, rivals, scene};
use std::f64::consts::TAU;
use vibro_math::Noise;
use vibro_measure::decay::{DecayMode, DecayOptions, decay};
use vibro_record::{Error, Result, Trace};

/// Sampling rate in Hz.
const RATE: f64 = 2048.0;
/// Samples of a record: one second, in which the decay falls to 1/500.
const N: u32 = 2048;
/// Damping ratio of the mode.
const ZETA: f64 = 0.01;
/// Cycles between the two peaks of the logarithmic decrement: a decay to 1/e.
const CYCLES: usize = 16;

/// Methods for the damping ratio.
const METHODS: [EstimationMethod<Trace>; 2] = [
    EstimationMethod::Rival("log decrement", |t| {
        let peaks: Vec<f64> = cycles(&t.values).map(|c| c.iter().copied().fold(f64::MIN, f64::max)).collect();
        let Some(last) = peaks.get(CYCLES) else { return f64::NAN };
        let decrement = (peaks[0] / last).ln() / CYCLES as f64;
        decrement / decrement.hypot(TAU)
    }),
    EstimationMethod::Own("fit of the decay", fitted),
];

/// Samples between one upward crossing of zero and the next.
fn cycles(values: &[f64]) -> impl Iterator<Item = &[f64]> {
    let starts: Vec<usize> = rivals::passages(values, 0.0).iter().map(|t| t.ceil() as usize).collect();
    (1..starts.len()).map(move |i| &values[starts[i - 1]..starts[i]])
}

/// ζ of the strongest mode, as from `vibro decay`.
fn fitted(trace: &Trace) -> Result<EstimatorAnswer> {
    let found = decay(trace, &DecayOptions { band: None, modes: None })?;
    let stronger = |a: &&DecayMode, b: &&DecayMode| a.amplitude.value.total_cmp(&b.amplitude.value);
    let mode = found.modes.iter().max_by(stronger).ok_or_else(|| Error::refused("no mode"))?;
    Ok(EstimatorAnswer::found(&mode.zeta, &found.findings))
}

/// A decay from amplitude, natural frequency in Hz, ζ and phase in rad.
fn record(p: &[f64]) -> impl Iterator<Item = f64> {
    let (amplitude, omega, zeta, phase) = (p[0], TAU * p[1], p[2], p[3]);
    let damped_omega = omega * (1.0 - zeta * zeta).sqrt();
    (0..N).map(move |i| {
        let t = f64::from(i) / RATE;
        amplitude * (-zeta * omega * t).exp() * (damped_omega * t + phase).cos()
    })
}

/// Draws decays of a mode at 90 to 110 Hz in noise of `part` of their first amplitude; errors in units of
/// their Cramér–Rao bound.
fn decays(part: f64) -> impl Fn(&mut Noise) -> Case<Trace> {
    move |noise| {
        let p = [1.0, noise.between(90.0, 110.0), ZETA, noise.between(0.0, TAU)];
        let values = record(&p).map(|v| v + part * noise.normal()).collect();
        let unit = bounds(&p, &[1e-4, 1e-4, 1e-6, 1e-4], part, |p| record(p).collect())[2];
        Case { data: trace("laser", "m/s", 1.0 / RATE, values), truth: ZETA, unit, tolerance: 0.1 * ZETA }
    }
}

/// The scene of decays.
pub fn scenes() -> Vec<EstimatorScene> {
    let settings = [0.1, 0.03, 0.01, 0.001]
        .map(|part| Ensemble::new(format!("noise of {} %", 100.0 * part), 60_000, decays(part)));
    let texts = [
        "decay",
        "The damping ratio of a mode of ζ 1 % at 90 to 110 Hz from one second of its free decay, in noise of 0.1 to 10 % of its first amplitude.",
        "damping ratio: error (rms) over its Cramér–Rao bound",
        "the mode that was written into the record",
    ];
    vec![scene(texts, 1.0, &METHODS, settings)]
}

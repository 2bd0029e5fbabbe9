//! Displacement from a velocity.

use super::trial::{Case, Ensemble, EstimationMethod, EstimatorAnswer, Numbers, Record, questions, trace};
use super::{EstimatorScene, one_point, rivals, scene};
use crate::BorderQuestion;
use std::f64::consts::TAU;
use vibro_math::Noise;
use vibro_measure::response::{ResponseOptions, response};
use vibro_measure::tones::sine;
use vibro_record::{Error, Result, Scaling, Trace, Window};
use vibro_signal::integrate::{InTime, in_time};
use vibro_signal::spectrum;

/// Sampling rate in Hz.
const RATE: f64 = 2048.0;
/// Samples of a record: two seconds.
const N: usize = 4096;
/// Amplitude of the displacement in m.
const AMPLITUDE: f64 = 1e-3;

/// A velocity, and the frequency in Hz of the vibration whose displacement is to be estimated.
struct Vibration {
    velocity: Trace,
    frequency: f64,
}

impl Record for Vibration {
    fn numbers(&self) -> Numbers {
        Numbers { known: Some(self.frequency), ..self.velocity.numbers() }
    }
}

/// Methods for the amplitude of a displacement from its velocity.
const METHODS: [EstimationMethod<Vibration>; 6] = [
    EstimationMethod::Rival("division, largest line", |v| divided(v).into_iter().skip(1).fold(0.0, f64::max)),
    EstimationMethod::Rival("division, line at f", |v| {
        divided(v)[(v.frequency / rivals::spacing(&v.velocity)).round() as usize]
    }),
    EstimationMethod::Rival("sum, half the swing", |v| rivals::half_swing(&rivals::sums(&v.velocity))),
    EstimationMethod::Rival("sum, detrended", |v| {
        let mean = rivals::mean(&v.velocity.values);
        let values = v.velocity.values.iter().map(|x| x - mean).collect();
        let moved = rivals::detrended(&rivals::sums(&Trace { values, ..v.velocity.clone() }));
        (2.0 * rivals::mean(&moved.iter().map(|x| x * x).collect::<Vec<_>>())).sqrt()
    }),
    EstimationMethod::Own("lines, cut-off", with_cut_off),
    EstimationMethod::Own("in time, high-pass", filtered),
];

/// Spectral lines, each divided by its angular frequency, as an analyser integrates.
fn divided(v: &Vibration) -> Vec<f64> {
    let step = rivals::spacing(&v.velocity);
    let lines = rivals::lines(&v.velocity, Window::Hann);
    lines.iter().enumerate().map(|(k, a)| a / (TAU * k as f64 * step)).collect()
}

/// As `vibro response` for one point with a known excitation frequency.
fn with_cut_off(v: &Vibration) -> Result<EstimatorAnswer> {
    let lines = spectrum::plain(&v.velocity, Window::Hann, Scaling::Peak, false)?;
    let sweep = one_point(lines, None, Some(v.frequency));
    let found = response(&sweep, &ResponseOptions::default())?;
    let point = found.points.first().ok_or_else(|| Error::refused("no point"))?;
    if let Some(limit) = point.upper_limit {
        return Err(Error::refused(format!("the amplitude does not stand out; it is below {limit:.3e} m")));
    }
    Ok(EstimatorAnswer::found(&point.amplitude, &found.findings))
}

/// As `vibro convert --integrate 1 --fmin f/2 --excitation f`, then the sine fitted between the edges,
/// divided by the gain of filter and trapezoidal rule.
fn filtered(v: &Vibration) -> Result<EstimatorAnswer> {
    let f = v.frequency;
    let options = InTime { times: 1, corner: 0.5 * f, order: 4, period: Some(1.0 / f) };
    let found = in_time(&v.velocity, &options)?;
    let [low, high] = found.band;
    if !(low..=high).contains(&f) {
        return Err(Error::refused(format!("amplitudes are right from {low:.1} to {high:.1} Hz only")));
    }
    let edge = (found.edge * RATE) as usize;
    let inner =
        found.trace.values.get(edge..found.trace.values.len().saturating_sub(edge)).unwrap_or_default();
    if inner.is_empty() {
        return Err(Error::refused("the edges of the filter fill the record"));
    }
    let sine = sine(&trace("laser", "m", 1.0 / RATE, inner.to_vec()), Some(f))?;
    let gain = options.gain(f, RATE)?;
    let EstimatorAnswer { value, std, doubt } =
        EstimatorAnswer::found(&sine.tones[0].amplitude, &sine.findings);
    Ok(EstimatorAnswer { value: value / gain, std: std.map(|s| s / gain), doubt })
}

/// A vibration between two frequencies in Hz, in noise `decibel` below it. A constant level and a drift over
/// the whole record are added to the velocity, in units of its amplitude.
#[derive(Clone, Copy)]
struct SyntheticVibration {
    /// Number of samples.
    n: usize,
    /// Lowest and highest frequency in Hz.
    band: (f64, f64),
    level: f64,
    drift: f64,
    /// Power of the vibration over that of the noise, in dB.
    decibel: f64,
}

/// A vibration without level and drift, 40 dB above the noise.
const CLEAN: SyntheticVibration =
    SyntheticVibration { n: N, band: (15.0, 25.0), level: 0.0, drift: 0.0, decibel: 40.0 };

impl SyntheticVibration {
    /// Random records of this vibration.
    fn kind(self, name: impl Into<String>, seed: u64) -> Ensemble<Vibration> {
        Ensemble::new(name, seed, move |noise: &mut Noise| {
            let SyntheticVibration { n, band, level, drift, decibel } = self;
            let (frequency, phase) = (noise.between(band.0, band.1), noise.between(0.0, TAU));
            let size = AMPLITUDE * TAU * frequency;
            let sigma = size * (0.5 / 10f64.powf(decibel / 10.0)).sqrt();
            let value = |i: usize| {
                let sine = (TAU * frequency * i as f64 / RATE + phase).cos();
                size * (sine + level + drift * i as f64 / n as f64) + sigma * noise.normal()
            };
            let velocity = trace("laser", "m/s", 1.0 / RATE, (0..n).map(value).collect());
            let data = Vibration { velocity, frequency };
            Case { data, truth: AMPLITUDE, unit: AMPLITUDE, tolerance: 0.05 * AMPLITUDE }
        })
    }
}

/// The scene of integration.
pub fn scenes() -> Vec<EstimatorScene> {
    let settings = [
        ("noise alone", CLEAN),
        ("level of a tenth", SyntheticVibration { level: 0.1, ..CLEAN }),
        ("level of 10", SyntheticVibration { level: 10.0, ..CLEAN }),
        ("drift of 1", SyntheticVibration { drift: 1.0, ..CLEAN }),
        ("both", SyntheticVibration { level: 10.0, drift: 1.0, ..CLEAN }),
    ]
    .map(|(name, made)| made.kind(name, 40_000));
    let texts = [
        "integration",
        "The amplitude of a displacement of 1 mm at 15 to 25 Hz from two seconds of its velocity, 40 dB above the noise, on a level and a drift of so many times its amplitude.",
        "displacement: relative error (rms)",
        "the displacement whose velocity was written into the record",
    ];
    // Cramér–Rao bound: Kay 1993, eq. 3.41, √(1/(ηN)).
    let bound = 1.0 / (N as f64 * 10f64.powf(CLEAN.decibel / 10.0)).sqrt();
    vec![scene(texts, bound, &METHODS, settings)]
}

/// Questions to methods of integration at their borders.
pub(crate) fn borders(quick: bool) -> Vec<BorderQuestion> {
    let kind = |(name, made): (&str, SyntheticVibration)| made.kind(name, 41_000);
    let level = [
        ("level of 1000 amplitudes", SyntheticVibration { level: 1e3, ..CLEAN }),
        ("drift of 10 amplitudes", SyntheticVibration { drift: 10.0, ..CLEAN }),
        ("drift of 1000 amplitudes", SyntheticVibration { drift: 1e3, ..CLEAN }),
        ("level and drift of 100 amplitudes", SyntheticVibration { level: 100.0, drift: 100.0, ..CLEAN }),
    ];
    let noise = [20.0, 0.0, -20.0, -40.0]
        .map(|decibel| SyntheticVibration { decibel, ..CLEAN }.kind(format!("{decibel} dB"), 41_000));
    let band = [
        ("half a period", SyntheticVibration { band: (0.2, 0.3), ..CLEAN }),
        ("1.5 periods", SyntheticVibration { band: (0.7, 0.8), ..CLEAN }),
        ("3 periods", SyntheticVibration { band: (1.4, 1.6), ..CLEAN }),
        ("8 periods", SyntheticVibration { band: (3.8, 4.2), ..CLEAN }),
        ("a tenth of the rate", SyntheticVibration { band: (200.0, 210.0), ..CLEAN }),
        ("0.45 of the rate", SyntheticVibration { band: (920.0, 925.0), ..CLEAN }),
        ("64 samples", SyntheticVibration { n: 64, band: (100.0, 120.0), ..CLEAN }),
    ];
    let mut all = questions("displacement: level and drift", &METHODS, level.map(kind), quick);
    all.extend(questions("displacement: noise", &METHODS, noise, quick));
    all.extend(questions("displacement: ends of the band", &METHODS, band.map(kind), quick));
    all
}

//! Damping ratio of a contact from the pulse of its force.

use super::trial::{
    Case, Change, Ensemble, EstimationMethod, EstimatorAnswer, Numbers, Record, each, questions, trace,
};
use super::{EstimatorScene, bounds, rivals, scene};
use crate::BorderQuestion;
use std::f64::consts::{PI, TAU};
use vibro_math::Noise;
use vibro_measure::pulse::{Instrument, KelvinVoigt, PulseOptions, pulse, two_times};
use vibro_record::{Axis, Trace};

/// Contact frequency in Hz, as in the runs of the thesis.
const FREQUENCY: f64 = 25e3;

/// A pulse, the instrument's properties, and two times of the pulse as read elsewhere, the time to the peak
/// and the duration, with their standard uncertainty, in s.
struct Pulse {
    trace: Trace,
    instrument: Instrument,
    times: [f64; 3],
}

impl Record for Pulse {
    fn numbers(&self) -> Numbers {
        self.trace.numbers()
    }
}

/// ξ from two instants read off the record.
const BY_HAND: EstimationMethod<Pulse> =
    EstimationMethod::Rival("two instants", |p| closed_form(rivals::instants(&p.trace.values)));

/// ξ from the shape of the whole pulse, as from `vibro pulse`.
const WHOLE: EstimationMethod<Pulse> = EstimationMethod::Own("whole pulse", |p| {
    let found = pulse(&p.trace, &PulseOptions { instrument: p.instrument.clone(), mass: None })?;
    Ok(EstimatorAnswer::found(&found.xi, &found.findings))
});

/// ξ from two times with an uncertainty, as from `vibro pulse --peak --end`.
const TWO_TIMES: EstimationMethod<Pulse> = EstimationMethod::Own("two times", |p| {
    let [peak, end, std] = p.times;
    let found = two_times(peak, end, Some(std), &PulseOptions::default())?;
    Ok(EstimatorAnswer::found(&found.xi, &found.findings))
});

/// ξ from the same two times in closed form, as in a spreadsheet, which does not check the range of ρ.
const FORMULA: EstimationMethod<Pulse> =
    EstimationMethod::Rival("formula of ρ", |p| closed_form(p.times[0] / p.times[1]));

/// Methods for a record of the pulse.
const METHODS: [EstimationMethod<Pulse>; 2] = [BY_HAND, WHOLE];
/// These and the methods for two times read elsewhere.
const ALL_METHODS: [EstimationMethod<Pulse>; 4] = [FORMULA, BY_HAND, TWO_TIMES, WHOLE];

/// ξ from ρ = time to peak / duration, for any ρ.
fn closed_form(rho: f64) -> f64 {
    (PI * (1.0 - 2.0 * rho) / (2.0 * (3.0 - 2.0 * rho))).sin()
}

/// Deceleration of a contact of spring and damper, normalised: −ẍ of x = e^{−ht} sin(Ωt)/Ω.
fn contact(xi: f64, t: f64) -> f64 {
    let omega = TAU * FREQUENCY;
    let (h, damped_omega) = (xi * omega, omega * (1.0 - xi * xi).sqrt());
    let (sin, cos) = (damped_omega * t).sin_cos();
    (-h * t).exp() * ((damped_omega * damped_omega - h * h) * sin + 2.0 * h * damped_omega * cos)
        / damped_omega
}

/// Duration of this contact in s, until the force is zero.
fn duration(xi: f64) -> f64 {
    // Damped over undamped frequency.
    let relative_omega = (1.0 - xi * xi).sqrt();
    (2.0 * xi * relative_omega).atan2(xi * xi - relative_omega * relative_omega)
        / (TAU * FREQUENCY * relative_omega)
}

/// A record of `n` samples, `dt` in s apart, of a pulse that begins at `onset` in s; `first` is the first
/// sample within the pulse.
fn clean(xi: f64, onset: f64, (n, dt, first): (usize, f64, usize)) -> Vec<f64> {
    let at = |i: usize| {
        let t = i as f64 * dt - onset;
        if i >= first && t <= duration(xi) { contact(xi, t) } else { 0.0 }
    };
    (0..n).map(at).collect()
}

/// Pulses of this ξ with `samples` samples, in noise of `part` of their height.
fn pulses(xi: f64, samples: f64, part: f64) -> impl Fn(&mut Noise) -> Case<Pulse> {
    move |noise| {
        let length = duration(xi);
        let dt = length / samples;
        let onset = 2.3 * length + dt * noise.uniform();
        let n = (5.8 * samples) as usize;
        let shape = clean(xi, onset, (n, dt, (onset / dt).ceil() as usize));
        let height = shape.iter().copied().fold(0.0, f64::max);
        let values = shape.iter().map(|v| 3.0 * (v + part * height * noise.normal())).collect();
        let std = 0.005 * length;
        let peak = KelvinVoigt::new(xi, FREQUENCY).and_then(|k| k.time_to_peak()).unwrap_or(0.0);
        let times = [peak + std * noise.normal(), length + std * noise.normal(), std];
        let trace = trace("bit", "m/s²", dt, values);
        let data = Pulse { trace, instrument: Instrument::Flat, times };
        Case { data, truth: xi, unit: 1.0, tolerance: 0.02 }
    }
}

/// Cramér–Rao bound of ξ with unknown onset, level, height and frequency, for an onset half-way between two
/// samples.
fn bound(xi: f64, samples: f64, part: f64) -> f64 {
    let length = duration(xi);
    let (dt, n) = (length / samples, (5.8 * samples) as usize);
    let first = (2.3 * samples).ceil() as usize;
    let onset = (first as f64 - 0.5) * dt;
    let frequency = KelvinVoigt::new(xi, FREQUENCY).map_or(f64::NAN, |k| k.frequency());
    // A lower frequency stretches the pulse in time and lowers its deceleration.
    let model = |p: &[f64]| {
        let stretch = p[4] / frequency;
        let grid = (n, dt * stretch, first);
        clean(p[3], p[0] * stretch, grid).iter().map(|v| p[1] + p[2] * stretch * v).collect()
    };
    let height = clean(xi, onset, (n, dt, first)).into_iter().fold(0.0, f64::max);
    bounds(
        &[onset, 0.0, 1.0, xi, frequency],
        &[1e-6 * dt, 1e-6, 1e-6, 1e-6, 1e-6 * frequency],
        part * height,
        model,
    )[3]
}

/// The scene of pulses.
pub fn scenes() -> Vec<EstimatorScene> {
    let settings = [8.0, 16.0, 32.0, 64.0, 128.0]
        .map(|n| Ensemble::new(format!("{n} samples in the pulse"), 50_000, pulses(0.2, n, 0.01)));
    let texts = [
        "pulse",
        "The damping ratio ξ of a contact from its pulse of deceleration, 8 to 128 samples long, in noise of 1 % of its height; the bound is that of 128 samples.",
        "damping ratio ξ of the contact: error (rms)",
        "the contact of spring and damper, ξ = 0.2, in closed form",
    ];
    vec![scene(texts, bound(0.2, 128.0, 0.01), &METHODS, settings)]
}

/// Height of a pulse above zero.
fn height(p: &Pulse) -> f64 {
    2.0 * rivals::half(&p.trace.values)
}

/// Questions to methods for pulses at their borders.
pub(crate) fn borders(quick: bool) -> Vec<BorderQuestion> {
    let damped = |xi: f64| {
        let rho = KelvinVoigt::new(xi, FREQUENCY).and_then(|k| Some(k.time_to_peak()? / k.duration()));
        let rho = rho.map_or("no peak".to_owned(), |r| format!("ρ = {r:.3}"));
        Ensemble::new(format!("ξ = {xi}, {rho}"), 52_000, pulses(xi, 40.0, 0.01))
    };
    let light = [0.0, 0.003, 0.02].map(damped);
    let heavy = [0.4, 0.45, 0.49, 0.6].map(damped);
    let noise = [0.1, 0.3, 1.0, 3.0].map(|part| {
        Ensemble::new(format!("noise of {} % of the height", 100.0 * part), 53_000, pulses(0.2, 40.0, part))
    });
    let few = [2.0, 4.0, 6.0, 8.0]
        .map(|n| Ensemble::new(format!("{n} samples in the pulse"), 54_000, pulses(0.2, n, 0.01)));
    let changes: [Change<Pulse>; 10] = [
        ("clipped at 80 % of the height", |p| {
            let high = height(p);
            each(&mut p.trace, |_, v| v.min(0.8 * high));
        }),
        ("ringing of 30 % afterwards", |p| {
            let high = height(p);
            // The pulse ends 3.3 durations of 40 samples after the start of the record.
            for (i, v) in p.trace.values.iter_mut().skip(133).enumerate() {
                *v += 0.3 * high * (-(i as f64) / 20.0).exp() * (i as f64 / 2.0).sin();
            }
        }),
        ("level of 1000 heights", |p| {
            let high = height(p);
            each(&mut p.trace, |_, v| v + 1e3 * high);
        }),
        ("level drifts by the height", |p| {
            let high = height(p);
            each(&mut p.trace, |part, v| v + high * part);
        }),
        ("points downwards", |p| each(&mut p.trace, |_, v| -v)),
        ("cut off at the top", |p| {
            p.trace.values.truncate(108);
            p.trace.axis = Axis::time(0.0, p.trace.axis.step().unwrap_or(1.0), 108);
        }),
        ("low-pass not stated", |p| p.instrument = Instrument::Unknown),
        ("a second, lower pulse", |p| {
            let copy: Vec<f64> = p.trace.values.clone();
            p.trace.values.iter_mut().skip(60).zip(copy).for_each(|(v, c)| *v += 0.5 * c);
        }),
        ("one sample missing", |p| p.trace.values[100] = f64::NAN),
        ("all equal", |p| p.trace.values.fill(1.0)),
    ];
    let faults =
        changes.map(|(name, change)| Ensemble::new(name, 51_000, pulses(0.2, 40.0, 0.01)).changed(change));
    let mut all = questions("contact ξ: ρ → 1/2", &ALL_METHODS, light, quick);
    all.extend(questions("contact ξ: ρ → 0", &ALL_METHODS, heavy, quick));
    all.extend(questions("contact ξ: noise", &METHODS, noise, quick));
    all.extend(questions("contact ξ: few samples", &METHODS, few, quick));
    all.extend(questions("contact ξ: faults", &METHODS, faults, quick));
    all
}

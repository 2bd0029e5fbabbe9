//! Displacement from a velocity.

use super::rivals;
use super::trial::{Answer, Case, Kind, Method, Task, cells, measured};
use crate::{Family, Scene};
use std::f64::consts::TAU;
use vibro_math::Noise;
use vibro_measure::Estimate;
use vibro_measure::response::{ResponseOptions, response};
use vibro_measure::tones::sine;
use vibro_record::units::Unit;
use vibro_record::{Axis, Error, Finding, Meta, Result, Scaling, Sweep, SweepPoint, Trace, Window};
use vibro_signal::integrate::{InTime, in_time};
use vibro_signal::spectrum;

const RATE: f64 = 2048.0;
const N: usize = 4096;
/// Amplitude of the displacement in m.
const AMPLITUDE: f64 = 1e-3;
/// Signal over noise in decibels.
const DECIBEL: f64 = 40.0;

/// A velocity and the frequency in Hz of the vibration whose displacement is asked for.
struct Vibration {
    velocity: Trace,
    frequency: f64,
}

const METHODS: [Method<Vibration>; 6] = [
    Method {
        name: "division, largest line",
        ours: false,
        estimate: |v| Ok(Answer::bare(divided(v, 1..usize::MAX))),
    },
    Method {
        name: "division, line at f",
        ours: false,
        estimate: |v| {
            let at = (v.frequency / rivals::spacing(&v.velocity)).round() as usize;
            Ok(Answer::bare(divided(v, at..at + 1)))
        },
    },
    Method {
        name: "sum, half the swing",
        ours: false,
        estimate: |v| Ok(Answer::bare(rivals::half_swing(&rivals::sums(&v.velocity)))),
    },
    Method {
        name: "sum, detrended",
        ours: false,
        estimate: |v| {
            let centred = Trace { values: rivals::centred(&v.velocity.values), ..v.velocity.clone() };
            let moved = rivals::detrended(&rivals::sums(&centred));
            let squares = moved.iter().map(|x| x * x).sum::<f64>() / moved.len() as f64;
            Ok(Answer::bare((2.0 * squares).sqrt()))
        },
    },
    Method { name: "lines, cut-off", ours: true, estimate: with_cut_off },
    Method { name: "in time, high-pass", ours: true, estimate: filtered },
];

/// The largest of these lines, divided by its angular frequency as an analyser does.
fn divided(v: &Vibration, lines: std::ops::Range<usize>) -> f64 {
    let (all, step) = (rivals::lines(&v.velocity, Window::Hann), rivals::spacing(&v.velocity));
    let within = all.iter().enumerate().filter(|(k, _)| lines.contains(k));
    within.map(|(k, a)| a / (TAU * k as f64 * step)).fold(0.0, f64::max)
}

/// `vibro response` of one point whose excitation frequency is known.
fn with_cut_off(v: &Vibration) -> Result<Answer> {
    let lines = spectrum::plain(&v.velocity, Window::Hann, Scaling::Peak, false)?;
    let sweep = Sweep {
        name: String::new(),
        direction: None,
        mass: None,
        axis: lines.axis.clone(),
        analyser_integrated: 0,
        points: vec![SweepPoint {
            force_path: None,
            response_path: "velocity".into(),
            force: Vec::new(),
            given: Some(v.frequency),
            response: lines,
        }],
        findings: Vec::new(),
    };
    let found = response(&sweep, &ResponseOptions { integrate: 1, ..ResponseOptions::default() })?;
    let point = found.points.first().ok_or_else(|| Error::refused("no point"))?;
    if let Some(limit) = point.upper_limit {
        return Err(Error::refused(format!("the amplitude does not stand out; it is below {limit:.3e} m")));
    }
    // One point has no direction.
    let findings: Vec<Finding> =
        found.findings.into_iter().filter(|f| f.code != "sweep-too-few-points").collect();
    Ok(Answer::found(&point.amplitude, &findings))
}

/// `vibro convert --integrate 1 --fmin f/2 --excitation f`, then the sine of what lies between the edges, over the gain of filter and trapezoid.
fn filtered(v: &Vibration) -> Result<Answer> {
    let f = v.frequency;
    let how = InTime { times: 1, corner: 0.5 * f, order: 4, period: Some(1.0 / f) };
    let found = in_time(&v.velocity, &how)?;
    let [low, high] = found.band;
    if !(low..=high).contains(&f) {
        return Err(Error::refused(format!("amplitudes are right from {low:.1} to {high:.1} Hz only")));
    }
    let edge = (found.edge * RATE) as usize;
    let inner = found.trace.values.get(edge..found.trace.values.len().saturating_sub(edge));
    let inner = inner
        .filter(|i| !i.is_empty())
        .ok_or_else(|| Error::refused("the edges of the filter fill the record"))?;
    let axis = Axis::time(0.0, 1.0 / RATE, inner.len());
    let sine = sine(&Trace { values: inner.to_vec(), axis, meta: found.trace.meta.clone() }, Some(f))?;
    let gain = how.gain(f, RATE)?;
    let amplitude = &sine.tones[0].amplitude;
    let stated =
        Estimate { value: amplitude.value / gain, std: amplitude.std.map(|s| s / gain), ..amplitude.clone() };
    Ok(Answer::found(&stated, &sine.findings))
}

/// What lies on the velocity beside its noise, in amplitudes of the velocity: a level, and a slope over the whole record.
#[derive(Clone, Copy)]
struct Faults {
    level: f64,
    drift: f64,
    decibel: f64,
}

const CLEAN: Faults = Faults { level: 0.0, drift: 0.0, decibel: DECIBEL };

/// A vibration between these frequencies in Hz.
fn vibration(n: usize, (low, high): (f64, f64), faults: Faults) -> impl Fn(&mut Noise) -> Case<Vibration> {
    move |noise| {
        let (frequency, phase) = (noise.between(low, high), noise.between(0.0, TAU));
        let size = AMPLITUDE * TAU * frequency;
        let sigma = size * (0.5 / 10f64.powf(faults.decibel / 10.0)).sqrt();
        let values = (0..n)
            .map(|i| {
                let sine = (TAU * frequency * i as f64 / RATE + phase).cos();
                size * (sine + faults.level + faults.drift * i as f64 / n as f64) + sigma * noise.normal()
            })
            .collect();
        let meta = Meta::new("laser", Unit::parse_or_opaque("m/s"));
        let velocity = Trace { meta, axis: Axis::time(0.0, 1.0 / RATE, n), values };
        Case {
            data: Vibration { velocity, frequency },
            truth: AMPLITUDE,
            unit: AMPLITUDE,
            tolerance: 0.05 * AMPLITUDE,
        }
    }
}

/// The scene of integration.
pub fn scenes(quick: bool) -> Vec<Scene> {
    let settings = [
        ("noise alone", CLEAN),
        ("level of a tenth", Faults { level: 0.1, ..CLEAN }),
        ("level of 10", Faults { level: 10.0, ..CLEAN }),
        ("drift of 1", Faults { drift: 1.0, ..CLEAN }),
        ("both", Faults { level: 10.0, drift: 1.0, ..CLEAN }),
    ]
    .map(|(name, faults)| Kind::new(name, 40_000, vibration(N, (15.0, 25.0), faults)));
    vec![Scene {
        name: "integration".to_owned(),
        family: Family::Estimators,
        says: "The amplitude of a displacement of 1 mm at 15 to 25 Hz from two seconds of its velocity, 40 dB above the noise, on a level and a drift of so many times its amplitude.".to_owned(),
        error_of: "displacement: relative error (rms)".to_owned(),
        truth: "the displacement whose velocity was written into the record".to_owned(),
        // Kay 1993, eq. 3.41: √(1/(ηN)).
        bound: Some(1.0 / (N as f64 * 10f64.powf(DECIBEL / 10.0)).sqrt()),
        methods: measured(&METHODS, &settings, quick),
    }]
}

/// What methods of integration do at their borders.
pub(crate) fn cells_of_integration(quick: bool) -> Vec<Task> {
    let kind = |name: &str, n, band, faults| Kind::new(name, 41_000, vibration(n, band, faults));
    let usual = (15.0, 25.0);
    let level = [
        kind("level of 1000 amplitudes", N, usual, Faults { level: 1e3, ..CLEAN }),
        kind("drift of 10 amplitudes", N, usual, Faults { drift: 10.0, ..CLEAN }),
        kind("drift of 1000 amplitudes", N, usual, Faults { drift: 1e3, ..CLEAN }),
        kind("level and drift of 100 amplitudes", N, usual, Faults { level: 100.0, drift: 100.0, ..CLEAN }),
    ];
    let noise = [20.0, 0.0, -20.0, -40.0]
        .map(|decibel| kind(&format!("{decibel} dB"), N, usual, Faults { decibel, ..CLEAN }));
    let band = [
        kind("half a period", N, (0.2, 0.3), CLEAN),
        kind("1.5 periods", N, (0.7, 0.8), CLEAN),
        kind("3 periods", N, (1.4, 1.6), CLEAN),
        kind("8 periods", N, (3.8, 4.2), CLEAN),
        kind("a tenth of the rate", N, (200.0, 210.0), CLEAN),
        kind("0.45 of the rate", N, (920.0, 925.0), CLEAN),
        kind("64 samples", 64, (100.0, 120.0), CLEAN),
    ];
    let mut all = cells("displacement: level and drift", &METHODS, level, quick);
    all.extend(cells("displacement: noise", &METHODS, noise, quick));
    all.extend(cells("displacement: ends of the band", &METHODS, band, quick));
    all
}

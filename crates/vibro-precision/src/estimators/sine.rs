//! Frequency and amplitude of sines in noise.

use super::bound::bounds;
use super::rivals;
use super::trial::{Answer, Case, Kind, Method, Task, cells, measured};
use crate::{Family, Scene};
use std::f64::consts::TAU;
use vibro_math::Noise;
use vibro_measure::excitation::{Excitation, excitations};
use vibro_measure::tones::{sine, tones};
use vibro_record::units::Unit;
use vibro_record::{Axis, Error, Meta, Result, Scaling, Sweep, SweepPoint, Trace, Window};
use vibro_signal::spectrum;

/// Samples a second.
const RATE: f64 = 1024.0;
/// Samples of a record where its length is not what is varied.
const N: usize = 1024;

/// A record of sines (frequency in lines, amplitude, phase) on a level, in noise of standard deviation `sigma`.
fn record(n: usize, sines: &[(f64, f64, f64)], level: f64, sigma: f64, noise: &mut Noise) -> Trace {
    let step = TAU / n as f64;
    let sum = |i: usize| -> f64 { sines.iter().map(|(k, a, p)| a * (step * k * i as f64 + p).cos()).sum() };
    let values = (0..n).map(|i| level + sum(i) + sigma * noise.normal()).collect();
    trace(values)
}

fn trace(values: Vec<f64>) -> Trace {
    let meta = Meta::new("laser", Unit::parse_or_opaque("m/s"));
    Trace { meta, axis: Axis::time(0.0, 1.0 / RATE, values.len()), values }
}

/// Standard deviation of the noise for this ratio of powers in decibels and an amplitude of 1.
fn sigma(decibel: f64) -> f64 {
    (0.5 / 10f64.powf(decibel / 10.0)).sqrt()
}

/// Bound of the frequency in lines: Kay 1993, eq. 3.41, for a real sine of amplitude 1.
fn bound(n: usize, sigma: f64) -> f64 {
    let (eta, n) = (0.5 / (sigma * sigma), n as f64);
    n / TAU * (12.0 / (eta * n * (n * n - 1.0))).sqrt()
}

/// Three lines under a Hann window, as in `vibro excitation`.
fn three_lines(trace: &Trace) -> Result<Excitation> {
    let response = spectrum::plain(trace, Window::Hann, Scaling::Peak, false)?;
    let point = SweepPoint {
        force_path: Some("record".into()),
        response_path: "record".into(),
        force: response.values.magnitudes(),
        given: None,
        response,
    };
    let sweep = Sweep {
        name: String::new(),
        direction: None,
        mass: None,
        axis: point.response.axis.clone(),
        analyser_integrated: 0,
        points: vec![point],
        findings: Vec::new(),
    };
    excitations(&sweep, 0.0)?.pop().ok_or_else(|| Error::refused("no point"))
}

/// The three lines say no word: where they have no uncertainty, they are held to what is allowed to all.
fn silent(value: f64, std: Option<f64>) -> Answer {
    Answer { std, ..Answer::bare(value) }
}

const FREQUENCY: [Method<Trace>; 5] = [
    Method { name: "zero crossings", ours: false, estimate: |t| Ok(Answer::bare(rivals::crossings(t))) },
    Method {
        name: "largest line",
        ours: false,
        estimate: |t| {
            let lines = rivals::lines(t, Window::Rectangular);
            Ok(Answer::bare(rivals::largest(&lines) as f64 * rivals::spacing(t)))
        },
    },
    Method {
        name: "parabola",
        ours: false,
        estimate: |t| {
            let lines = rivals::lines(t, Window::Hann);
            Ok(Answer::bare(rivals::parabola(&lines, rivals::largest(&lines)).0 * rivals::spacing(t)))
        },
    },
    Method {
        name: "three lines, Hann",
        ours: true,
        estimate: |t| three_lines(t).map(|e| silent(e.frequency, e.std)),
    },
    Method {
        name: "least squares",
        ours: true,
        estimate: |t| sine(t, None).map(|s| Answer::found(&s.tones[0].frequency, &s.findings)),
    },
];

const AMPLITUDE: [Method<Trace>; 6] = [
    Method {
        name: "half the swing",
        ours: false,
        estimate: |t| Ok(Answer::bare(rivals::half_swing(&t.values))),
    },
    Method {
        name: "line, no window",
        ours: false,
        estimate: |t| Ok(Answer::bare(highest(t, Window::Rectangular))),
    },
    Method { name: "line, Hann", ours: false, estimate: |t| Ok(Answer::bare(highest(t, Window::Hann))) },
    Method {
        name: "line, flat top",
        ours: false,
        estimate: |t| Ok(Answer::bare(highest(t, Window::FlatTop))),
    },
    Method {
        name: "three lines, Hann",
        ours: true,
        estimate: |t| three_lines(t).map(|e| silent(e.force.unwrap_or(f64::NAN), e.force_std)),
    },
    Method {
        name: "least squares",
        ours: true,
        estimate: |t| sine(t, None).map(|s| Answer::found(&s.tones[0].amplitude, &s.findings)),
    },
];

fn highest(trace: &Trace, window: Window) -> f64 {
    rivals::lines(trace, window).into_iter().fold(0.0, f64::max)
}

/// The weaker of two sines.
const WEAKER: [Method<Trace>; 3] = [
    Method {
        name: "second line",
        ours: false,
        estimate: |t| {
            let lines = rivals::lines(t, Window::Rectangular);
            let at = rivals::second(&lines).ok_or_else(|| Error::refused("there is no second peak"))?;
            Ok(Answer::bare(at as f64 * rivals::spacing(t)))
        },
    },
    Method {
        name: "parabola, Hann",
        ours: false,
        estimate: |t| {
            let lines = rivals::lines(t, Window::Hann);
            let at = rivals::second(&lines).ok_or_else(|| Error::refused("there is no second peak"))?;
            Ok(Answer::bare(rivals::parabola(&lines, at).0 * rivals::spacing(t)))
        },
    },
    Method { name: "least squares", ours: true, estimate: weaker },
];

fn weaker(trace: &Trace) -> Result<Answer> {
    let found = tones(trace, 2)?;
    match found.tones.get(1) {
        Some(tone) => Ok(Answer::found(&tone.frequency, &found.findings)),
        None => Err(Error::refused("no second tone stands out of the noise")),
    }
}

/// A sine anywhere between lines, not nearer to the ends than ten.
fn anywhere(n: usize, decibel: f64, unit: impl Fn(f64) -> f64) -> impl Fn(&mut Noise) -> Case<Trace> {
    move |noise| {
        let (place, phase) = (noise.between(10.0, n as f64 / 2.0 - 10.0), noise.between(0.0, TAU));
        let line = RATE / n as f64;
        Case {
            data: record(n, &[(place, 1.0, phase)], 0.0, sigma(decibel), noise),
            truth: place * line,
            unit: unit(line),
            tolerance: 0.5 * line,
        }
    }
}

/// Two sines `apart` lines from each other, the second of half the amplitude, whose frequency is asked for.
fn pair(apart: f64, decibel: f64) -> impl Fn(&mut Noise) -> Case<Trace> {
    move |noise| {
        let (n, line) = (512, RATE / 512.0);
        let first = noise.between(20.0, 200.0);
        let both = [(first, 1.0, noise.between(0.0, TAU)), (first + apart, 0.5, noise.between(0.0, TAU))];
        let p = [both[0].0, both[0].1, both[0].2, both[1].0, both[1].1, both[1].2];
        let model = |p: &[f64]| {
            let step = TAU / f64::from(n);
            let one = |s: &[f64], i: i32| s[1] * (step * s[0] * f64::from(i) + s[2]).cos();
            (0..n).map(|i| one(&p[..3], i) + one(&p[3..], i)).collect()
        };
        let unit = bounds(&p, &[1e-5; 6], sigma(decibel), model)[3];
        Case {
            data: record(512, &both, 0.0, sigma(decibel), noise),
            truth: both[1].0 * line,
            unit: unit * line,
            tolerance: 0.5 * line,
        }
    }
}

/// The scenes of sines.
pub fn scenes(quick: bool) -> Vec<Scene> {
    let scene = |name: &str, says: &str, error_of: &str, bound, methods| Scene {
        name: name.to_owned(),
        family: Family::Estimators,
        says: says.to_owned(),
        error_of: error_of.to_owned(),
        truth: "the sine that was written into the record".to_owned(),
        bound: Some(bound),
        methods,
    };
    let noise = [0.0, 20.0, 40.0, 60.0, 80.0].map(|db| {
        Kind::new(format!("{db} dB"), 1_000, anywhere(N, db, move |line| line * bound(N, sigma(db))))
    });
    let lengths = [64, 256, 1024, 4096, 16_384];
    let longest = bound(16_384, sigma(40.0)) * RATE / 16_384.0;
    let length = lengths.map(|n| Kind::new(format!("{n} samples"), 2_000, anywhere(n, 40.0, |_| 1.0)));
    let offsets = [0.0, 0.25, 0.5].map(|part| {
        Kind::new(format!("{part} lines off"), 3_000, move |noise: &mut Noise| {
            let place = noise.between(20.0, 490.0).round() + part;
            let sine = (place, 1.0, noise.between(0.0, TAU));
            Case { data: record(N, &[sine], 0.0, sigma(60.0), noise), truth: 1.0, unit: 1.0, tolerance: 0.05 }
        })
    });
    let pairs = [0.7, 1.0, 1.5, 2.0, 4.0, 16.0]
        .map(|apart| Kind::new(format!("{apart} lines apart"), 4_000, pair(apart, 40.0)));
    vec![
        scene(
            "sine-noise",
            "The frequency of one sine between two lines of a record of 1024 samples, from a signal as strong as the noise (0 dB) to one of 80 dB.",
            "frequency: error (rms) over its Cramér–Rao bound",
            1.0,
            measured(&FREQUENCY, &noise, quick),
        ),
        scene(
            "sine-length",
            "The frequency of one sine, 40 dB above the noise, at 1024 samples a second, from 64 to 16 384 samples; the bound is that of the longest record.",
            "frequency: error (rms), Hz",
            longest,
            measured(&FREQUENCY, &length, quick),
        ),
        scene(
            "sine-amplitude",
            "The amplitude of one sine on a line, a quarter of a line off and half-way between two, 60 dB above the noise.",
            "amplitude: relative error (rms)",
            sigma(60.0) * (2.0 / N as f64).sqrt(),
            measured(&AMPLITUDE, &offsets, quick),
        ),
        scene(
            "two-sines",
            "The frequency of the weaker of two sines, of half the other's amplitude and 34 dB above the noise, from 0.7 to 16 lines beside it.",
            "frequency: error (rms) over its Cramér–Rao bound",
            1.0,
            measured(&WEAKER, &pairs, quick),
        ),
    ]
}

/// A sine of amplitude 1 at this place in lines, on a level, in noise.
fn at(name: &str, n: usize, place: f64, level: f64, decibel: f64) -> Kind<Trace> {
    Kind::new(name, 10_000, move |noise: &mut Noise| {
        let phase = noise.between(0.0, TAU);
        let line = RATE / n as f64;
        Case {
            data: record(n, &[(place, 1.0, phase)], level, sigma(decibel), noise),
            truth: place * line,
            unit: line,
            tolerance: 0.5 * line,
        }
    })
}

/// A record changed after it was made.
fn changed(name: &str, change: impl Fn(&mut Vec<f64>, &mut Noise) + Send + Sync + 'static) -> Kind<Trace> {
    let make = anywhere(N, 40.0, |line| line);
    Kind::new(name, 11_000, move |noise: &mut Noise| {
        let mut case = make(noise);
        change(&mut case.data.values, noise);
        case
    })
}

/// What methods for sines do at their borders.
pub(crate) fn cells_of_sines(quick: bool) -> Vec<Task> {
    let noise = [0.0, -10.0, -20.0, -30.0]
        .map(|db| Kind::new(format!("{db} dB"), 12_000, anywhere(N, db, |line| line)));
    let short = [0.5, 0.9, 1.2, 1.6, 2.5].map(|p| at(&format!("{p} periods"), 256, p, 0.0, 40.0));
    let ends = [
        at("1.7 lines from half the rate", N, 510.3, 0.0, 40.0),
        at("0.4 lines from half the rate", N, 511.6, 0.0, 40.0),
        at("half the rate", N, 512.0, 0.0, 40.0),
    ];
    let faults = [
        at("level 1000 times the amplitude", N, 40.3, 1e3, 40.0),
        changed("drift of 20 amplitudes", |v, _| {
            let n = v.len() as f64;
            v.iter_mut().enumerate().for_each(|(i, v)| *v += 20.0 * i as f64 / n);
        }),
        changed("clipped at half the amplitude", |v, _| v.iter_mut().for_each(|v| *v = v.clamp(-0.5, 0.5))),
        changed("one sample missing", |v, _| v[300] = f64::NAN),
        changed("one spike of 100 amplitudes", |v, _| v[300] = 100.0),
        changed("8 samples", |v, _| v.truncate(8)),
        changed("all zero", |v, _| v.fill(0.0)),
    ];
    let beside = [0.3, 0.7, 1.0, 2.0, 4.0]
        .map(|apart| Kind::new(format!("{apart} lines apart"), 13_000, pair(apart, 40.0)));
    // Of two sines the single-sine methods are asked for the stronger.
    let stronger = [0.5, 1.0, 2.0, 4.0].map(|apart| {
        Kind::new(format!("{apart} lines apart"), 14_000, move |noise: &mut Noise| {
            let case = pair(apart, 40.0)(noise);
            Case { truth: case.truth - apart * rivals::spacing(&case.data), ..case }
        })
    });
    let mut all = cells("frequency: noise", &FREQUENCY, noise, quick);
    all.extend(cells("frequency: short record", &FREQUENCY, short, quick));
    all.extend(cells("frequency: end of the band", &FREQUENCY, ends, quick));
    all.extend(cells("frequency: faults", &FREQUENCY, faults, quick));
    all.extend(cells("frequency: stronger of two", &FREQUENCY, stronger, quick));
    all.extend(cells("frequency: weaker of two", &WEAKER, beside, quick));
    all
}

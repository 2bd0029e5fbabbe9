//! Frequency and amplitude of sines in noise.

use super::trial::{Case, Change, Ensemble, EstimationMethod, EstimatorAnswer, each, questions, trace};
use super::{EstimatorScene, bounds, one_point, rivals, scene};
use crate::BorderQuestion;
use std::f64::consts::TAU;
use vibro_math::Noise;
use vibro_measure::excitation::{Excitation, excitations};
use vibro_measure::tones::{sine, tones};
use vibro_record::{Error, Result, Scaling, Trace, Window};
use vibro_signal::spectrum;

/// Sampling rate in Hz.
const RATE: f64 = 1024.0;
/// Samples of a record, except where the length is varied.
const N: usize = 1024;

/// A record of sines (frequency in lines, amplitude, phase in rad) and a constant level, in noise whose power
/// is `decibel` below that of a sine of amplitude 1.
fn record(n: usize, sines: &[(f64, f64, f64)], level: f64, decibel: f64, noise: &mut Noise) -> Trace {
    let (step, sigma) = (TAU / n as f64, sigma(decibel));
    let sum = |i: usize| -> f64 { sines.iter().map(|(k, a, p)| a * (step * k * i as f64 + p).cos()).sum() };
    trace("laser", "m/s", 1.0 / RATE, (0..n).map(|i| level + sum(i) + sigma * noise.normal()).collect())
}

/// Standard deviation of the noise for this power ratio in decibels and a sine of amplitude 1.
fn sigma(decibel: f64) -> f64 {
    (0.5 / 10f64.powf(decibel / 10.0)).sqrt()
}

/// Cramér–Rao bound of the frequency in lines: Kay 1993, eq. 3.41, for a real sine of amplitude 1.
fn bound(n: usize, decibel: f64) -> f64 {
    let (eta, n) = (10f64.powf(decibel / 10.0), n as f64);
    n / TAU * (12.0 / (eta * n * (n * n - 1.0))).sqrt()
}

/// Interpolation from three lines under a Hann window, as in `vibro excitation`. It states no doubt: an
/// answer without an uncertainty must meet the limit for all methods.
fn three_lines(trace: &Trace, read: fn(&Excitation) -> (f64, Option<f64>)) -> Result<EstimatorAnswer> {
    let response = spectrum::plain(trace, Window::Hann, Scaling::Peak, false)?;
    let force = response.values.magnitudes();
    let found = excitations(&one_point(response, Some(force), None), 0.0)?;
    let (value, std) = found.first().map(read).ok_or_else(|| Error::refused("no point"))?;
    Ok(EstimatorAnswer { value, std, doubt: None })
}

/// Frequency in Hz of a `place` in lines, which may lie between two lines.
fn hertz(trace: &Trace, window: Window, place: fn(&[f64]) -> f64) -> f64 {
    place(&rivals::lines(trace, window)) * rivals::spacing(trace)
}

/// Methods for the frequency of a sine.
const FREQUENCY: [EstimationMethod<Trace>; 5] = [
    EstimationMethod::Rival("zero crossings", |t| {
        RATE * rivals::mean_rate(&rivals::passages(&t.values, rivals::mean(&t.values)))
    }),
    EstimationMethod::Rival("largest line", |t| hertz(t, Window::Rectangular, |l| rivals::largest(l) as f64)),
    EstimationMethod::Rival("parabola", |t| {
        hertz(t, Window::Hann, |l| rivals::parabola(l, rivals::largest(l)))
    }),
    EstimationMethod::Own("three lines, Hann", |t| three_lines(t, |e| (e.frequency, e.std))),
    EstimationMethod::Own("least squares", |t| {
        sine(t, None).map(|s| EstimatorAnswer::found(&s.tones[0].frequency, &s.findings))
    }),
];

/// Methods for the amplitude of a sine.
const AMPLITUDE: [EstimationMethod<Trace>; 6] = [
    EstimationMethod::Rival("half the swing", |t| rivals::half_swing(&t.values)),
    EstimationMethod::Rival("line, no window", |t| highest_line(t, Window::Rectangular)),
    EstimationMethod::Rival("line, Hann", |t| highest_line(t, Window::Hann)),
    EstimationMethod::Rival("line, flat top", |t| highest_line(t, Window::FlatTop)),
    EstimationMethod::Own("three lines, Hann", |t| {
        three_lines(t, |e| (e.force.unwrap_or(f64::NAN), e.force_std))
    }),
    EstimationMethod::Own("least squares", |t| {
        sine(t, None).map(|s| EstimatorAnswer::found(&s.tones[0].amplitude, &s.findings))
    }),
];

/// Amplitude of the largest line.
fn highest_line(trace: &Trace, window: Window) -> f64 {
    rivals::lines(trace, window).into_iter().fold(0.0, f64::max)
}

/// Methods for the frequency of the weaker of two sines.
const WEAKER: [EstimationMethod<Trace>; 3] = [
    EstimationMethod::Rival("second line", |t| {
        hertz(t, Window::Rectangular, |l| rivals::second(l).map_or(f64::NAN, |k| k as f64))
    }),
    EstimationMethod::Rival("parabola, Hann", |t| {
        hertz(t, Window::Hann, |l| rivals::second(l).map_or(f64::NAN, |k| rivals::parabola(l, k)))
    }),
    EstimationMethod::Own("least squares", |t| {
        let found = tones(t, 2)?;
        let tone =
            found.tones.get(1).ok_or_else(|| Error::refused("no second tone stands out of the noise"))?;
        Ok(EstimatorAnswer::found(&tone.frequency, &found.findings))
    }),
];

/// A record in which the frequency of a sine is to be estimated, from its place in lines.
fn at_line(data: Trace, place: f64, unit: f64) -> Case<Trace> {
    let line = rivals::spacing(&data);
    Case { data, truth: place * line, unit: unit * line, tolerance: 0.5 * line }
}

/// Draws records of a sine anywhere between lines, at least ten lines from the ends of the band; errors in
/// units of `unit` lines.
fn anywhere(n: usize, decibel: f64, unit: f64) -> impl Fn(&mut Noise) -> Case<Trace> {
    move |noise| {
        let (place, phase) = (noise.between(10.0, n as f64 / 2.0 - 10.0), noise.between(0.0, TAU));
        at_line(record(n, &[(place, 1.0, phase)], 0.0, decibel, noise), place, unit)
    }
}

/// Draws records of two sines `apart` lines from each other, the first 40 dB above the noise; the frequency
/// of the second, of half its amplitude, is to be estimated.
fn pair(apart: f64) -> impl Fn(&mut Noise) -> Case<Trace> {
    move |noise| {
        let first = noise.between(20.0, 200.0);
        let both = [(first, 1.0, noise.between(0.0, TAU)), (first + apart, 0.5, noise.between(0.0, TAU))];
        let p = [both[0].0, both[0].1, both[0].2, both[1].0, both[1].1, both[1].2];
        let model = |p: &[f64]| {
            let one = |s: &[f64], i: i32| s[1] * (TAU / 512.0 * s[0] * f64::from(i) + s[2]).cos();
            (0..512).map(|i| one(&p[..3], i) + one(&p[3..], i)).collect()
        };
        let unit = bounds(&p, &[1e-5; 6], sigma(40.0), model)[3];
        at_line(record(512, &both, 0.0, 40.0, noise), both[1].0, unit)
    }
}

/// Every scene of sines, measured.
pub fn scenes() -> Vec<EstimatorScene> {
    let noise = [0.0, 20.0, 40.0, 60.0, 80.0]
        .map(|db| Ensemble::new(format!("{db} dB"), 1_000, anywhere(N, db, bound(N, db))));
    let length = [64, 256, 1024, 4096, 16_384]
        .map(|n| Ensemble::new(format!("{n} samples"), 2_000, anywhere(n, 40.0, n as f64 / RATE)));
    let offsets = [0.0, 0.25, 0.5].map(|part| {
        Ensemble::new(format!("{part} lines off"), 3_000, move |noise: &mut Noise| {
            let place = noise.between(20.0, 490.0).round() + part;
            let sine = (place, 1.0, noise.between(0.0, TAU));
            Case { data: record(N, &[sine], 0.0, 60.0, noise), truth: 1.0, unit: 1.0, tolerance: 0.05 }
        })
    });
    let pairs = [0.7, 1.0, 1.5, 2.0, 4.0, 16.0]
        .map(|apart| Ensemble::new(format!("{apart} lines apart"), 4_000, pair(apart)));
    let in_noise = [
        "sine-noise",
        "The frequency of one sine between two lines of a record of 1024 samples, from a signal as strong as the noise (0 dB) to one of 80 dB.",
        "frequency: error (rms) over its Cramér–Rao bound",
    ];
    let of_length = [
        "sine-length",
        "The frequency of one sine, 40 dB above the noise, at 1024 samples a second, from 64 to 16 384 samples; the bound is that of the longest record.",
        "frequency: error (rms), Hz",
    ];
    let of_amplitude = [
        "sine-amplitude",
        "The amplitude of one sine on a line, a quarter of a line off and half-way between two, 60 dB above the noise.",
        "amplitude: relative error (rms)",
    ];
    let of_two = [
        "two-sines",
        "The frequency of the weaker of two sines, of half the other's amplitude and 34 dB above the noise, from 0.7 to 16 lines beside it.",
        "frequency: error (rms) over its Cramér–Rao bound",
    ];
    let (longest, amplitude) = (bound(16_384, 40.0) * RATE / 16_384.0, sigma(60.0) * (2.0 / N as f64).sqrt());
    // The truth of all scenes is the sine written into the record.
    let truth = "the sine that was written into the record";
    let of = |[name, says, error_of]: [&'static str; 3]| [name, says, error_of, truth];
    vec![
        scene(of(in_noise), 1.0, &FREQUENCY, noise),
        scene(of(of_length), longest, &FREQUENCY, length),
        scene(of(of_amplitude), amplitude, &AMPLITUDE, offsets),
        scene(of(of_two), 1.0, &WEAKER, pairs),
    ]
}

/// Records of a sine of amplitude 1 at this place in lines, on a constant level, 40 dB above the noise.
fn fixed_sine(name: impl Into<String>, n: usize, place: f64, level: f64) -> Ensemble<Trace> {
    Ensemble::new(name, 10_000, move |noise: &mut Noise| {
        let phase = noise.between(0.0, TAU);
        at_line(record(n, &[(place, 1.0, phase)], level, 40.0, noise), place, 1.0)
    })
}

/// Questions to methods for sines at their borders.
pub(crate) fn borders(quick: bool) -> Vec<BorderQuestion> {
    let noise =
        [0.0, -10.0, -20.0, -30.0].map(|db| Ensemble::new(format!("{db} dB"), 12_000, anywhere(N, db, 1.0)));
    let short = [0.5, 0.9, 1.2, 1.6, 2.5].map(|p| fixed_sine(format!("{p} periods"), 256, p, 0.0));
    let ends = [
        fixed_sine("1.7 lines from half the rate", N, 510.3, 0.0),
        fixed_sine("0.4 lines from half the rate", N, 511.6, 0.0),
        fixed_sine("half the rate", N, 512.0, 0.0),
    ];
    let changes: [Change<Trace>; 6] = [
        ("drift of 20 amplitudes", |t| each(t, |part, v| v + 20.0 * part)),
        ("clipped at half the amplitude", |t| each(t, |_, v| v.clamp(-0.5, 0.5))),
        ("one sample missing", |t| t.values[300] = f64::NAN),
        ("one spike of 100 amplitudes", |t| t.values[300] = 100.0),
        ("8 samples", |t| t.values.truncate(8)),
        ("all zero", |t| t.values.fill(0.0)),
    ];
    let changed =
        changes.map(|(name, change)| Ensemble::new(name, 11_000, anywhere(N, 40.0, 1.0)).changed(change));
    let faults = std::iter::once(fixed_sine("level 1000 times the amplitude", N, 40.3, 1e3)).chain(changed);
    let beside = [0.3, 0.7, 1.0, 2.0, 4.0]
        .map(|apart| Ensemble::new(format!("{apart} lines apart"), 13_000, pair(apart)));
    // Methods for a single sine must find the stronger of two.
    let stronger = [0.5, 1.0, 2.0, 4.0].map(|apart| {
        Ensemble::new(format!("{apart} lines apart"), 14_000, move |noise: &mut Noise| {
            let case = pair(apart)(noise);
            Case { truth: case.truth - apart * rivals::spacing(&case.data), ..case }
        })
    });
    let mut all = questions("frequency: noise", &FREQUENCY, noise, quick);
    all.extend(questions("frequency: short record", &FREQUENCY, short, quick));
    all.extend(questions("frequency: end of the band", &FREQUENCY, ends, quick));
    all.extend(questions("frequency: faults", &FREQUENCY, faults, quick));
    all.extend(questions("frequency: stronger of two", &FREQUENCY, stronger, quick));
    all.extend(questions("frequency: weaker of two", &WEAKER, beside, quick));
    all
}

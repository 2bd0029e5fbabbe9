//! Random accelerations of a handle, to check how often the stated uncertainties of the weighted values
//! cover the truth.

use super::disturbance::Mix;
use super::record::{Answer, Kind, Record};
use num_complex::Complex64;
use std::f64::consts::TAU;
use vibroimpact::measure::exposure::exposure;

/// The kinds of records drawn here.
pub const KINDS: &[Kind] = &[Kind {
    name: "exposure of a hand",
    ranges: "three axes, 8 to 60 s at 5.1 to 20 kHz; 1 to 5 sines of 8 to 1000 Hz, 0.1 to 10 m/s² each; white noise of 0.1 to 3 times the largest of them; \
        the truth is of the mean power",
    every: 10,
    draw,
}];

/// Magnitude of the weighting `W_h` at `f` Hz (ISO 5349-1:2001, table A.1), as a product of its sections.
fn weight(f: f64) -> f64 {
    let section = |corner: f64, quality: f64| {
        let x = f / corner;
        (Complex64::new(1.0 - x * x, x / quality), x)
    };
    let [(high, x), (low, _), (turn, y)] =
        [section(6.310, 1.0 / 2f64.sqrt()), section(1258.9, 1.0 / 2f64.sqrt()), section(15.915, 0.64)];
    x * x / high.norm() / low.norm() * Complex64::new(1.0, y).norm() / turn.norm()
}

/// Draws a handle and compares the weighted RMS of its axes and their sum with the truth.
fn draw(mix: &mut Mix) -> Record {
    let rate = mix.log(5.1e3, 20e3);
    mix.note("rate", rate);
    let n = (mix.log(8.0, 60.0) * rate) as usize;
    mix.note("duration", n as f64 / rate);
    let noise_to_sine = mix.log(0.1, 3.0);
    mix.note("noise to sine", noise_to_sine);
    let mut axes: Vec<Vec<f64>> = Vec::new();
    let mut squares: Vec<f64> = Vec::new();
    for _ in 0..3 {
        let count = mix.random.between(1.0, 6.0) as usize;
        let sines: Vec<(f64, f64, f64)> = (0..count)
            .map(|_| (mix.log(8.0, 1000.0), mix.log(0.1, 10.0), mix.random.between(0.0, TAU)))
            .collect();
        let noise = noise_to_sine * sines.iter().map(|s| s.1).fold(0.0, f64::max);
        let mut values: Vec<f64> = (0..n)
            .map(|i| {
                let t = i as f64 / rate;
                sines.iter().map(|(f, a, phase)| a * (TAU * f * t + phase).cos()).sum()
            })
            .collect();
        mix.add_white(&mut values, noise);
        // White noise has the density σ²/(rate/2) up to half the rate.
        let lines = 20_000;
        let mean = (0..lines)
            .map(|k| weight((f64::from(k) + 0.5) / f64::from(lines) * rate / 2.0).powi(2))
            .sum::<f64>()
            / f64::from(lines);
        let sum: f64 = sines.iter().map(|(f, a, _)| (a * weight(*f)).powi(2) / 2.0).sum();
        squares.push(sum + noise * noise * mean);
        axes.push(values);
    }
    let handles: Vec<&[f64]> = axes.iter().map(Vec::as_slice).collect();
    let found = exposure(rate, &handles, None).ok();
    let mut record = Record::default();
    for (k, square) in squares.iter().enumerate() {
        record.answers.push(Answer::new("axis", square.sqrt(), found.as_ref().map(|f| &f.axes[k])));
    }
    let total = squares.iter().sum::<f64>().sqrt();
    record.answers.push(Answer::new("a_hv", total, found.as_ref().map(|f| &f.a_hv)));
    record
}

//! The instruments: force gauge, accelerometers with integrating charge amplifiers, and a dynamic signal
//! analyser.
//!
//! The converter runs at 32 times the rate of the final record and averages over each of its intervals, as
//! integrating converters do. A digital filter then passes only the base band, so that jumps of velocity do
//! not alias. Here the filter is a windowed Fourier transform of the fast record, of which lines 0 to 400 are
//! used.

use super::noise::PairedNoise;
use std::f64::consts::{PI, TAU};
use std::fmt::Write as _;

/// Spectral lines above the line at 0 Hz.
pub const LINES: usize = 400;
/// Base band in Hz.
pub const BASE_BAND: f64 = 20.0;
/// Duration of a block in s: the reciprocal of the line spacing.
pub const BLOCK: f64 = LINES as f64 / BASE_BAND;
/// Number of the converter's samples in a block: 32 for each of the 1024 samples of the final record.
pub const SAMPLES: usize = 1024 * 32;
/// Interval of the converter's samples in s.
pub const INTERVAL: f64 = BLOCK / SAMPLES as f64;

/// Frequency in Hz of the mains hum in a record: the analogue filter passes part of the 50 Hz, which
/// aliases at the final sampling rate of 51.2 Hz.
const HUM: f64 = 51.2 - 50.0;

/// Noise, hum and converter of an input.
struct Input {
    /// Density of the white noise, in the unit of the signal per √Hz.
    noise: f64,
    /// Amplitude of the aliased hum, in the unit of the signal.
    hum: f64,
    /// Full scale of the 12-bit converter, in the unit of the signal.
    full_scale: f64,
}

/// Input of the force gauge, in N.
const FORCE: Input = Input { noise: 5e-5, hum: 3e-4, full_scale: 0.5 };
/// Offset of the force gauge in N; the force has an amplitude of 0.1 N.
const FORCE_OFFSET: f64 = 0.012;
/// Input of an integrated accelerometer, in m/s.
const VELOCITY: Input = Input { noise: 4e-5, hum: 2e-4, full_scale: 1.0 };
/// White noise of an accelerometer in m/s² per √Hz.
const ACCELERATION_NOISE: f64 = 8e-4;
/// Offset of an accelerometer in m/s².
const ACCELERATION_OFFSET: f64 = 4e-3;
/// Lower limiting frequency in Hz of the integrating charge amplifier. Above it the accelerometer's noise is
/// divided by 2πf; the offset is divided by 2π times this frequency. Both make the velocity spectrum rise
/// towards 0 Hz.
const LOWER_LIMIT: f64 = 0.01;

/// Force spectrum, in N.
pub fn force(signal: &[f64], noise: &mut PairedNoise) -> Vec<f64> {
    let offset: Vec<f64> = signal.iter().map(|v| v + FORCE_OFFSET).collect();
    spectrum(&FORCE.convert(&offset, noise))
}

/// Velocity spectrum, in m/s, from the true velocity averaged over each interval.
pub fn velocity(signal: &[f64], noise: &mut PairedNoise) -> Vec<f64> {
    let corner = TAU * LOWER_LIMIT;
    // Output of the settled integrator for offset and noise: its mean is offset/corner, its variance
    // density²/(4·corner).
    let mut drift =
        ACCELERATION_OFFSET / corner + noise.normal() * ACCELERATION_NOISE / (2.0 * corner.sqrt());
    let std = ACCELERATION_NOISE * (0.5 / INTERVAL).sqrt();
    let drifting: Vec<f64> = signal
        .iter()
        .map(|v| {
            let acceleration = ACCELERATION_OFFSET + std * noise.normal();
            drift += INTERVAL * (acceleration - corner * drift);
            v + drift
        })
        .collect();
    spectrum(&VELOCITY.convert(&drifting, noise))
}

impl Input {
    /// Adds hum and noise and rounds to the converter's steps.
    fn convert(&self, signal: &[f64], noise: &mut PairedNoise) -> Vec<f64> {
        let step = 2.0 * self.full_scale / 4096.0;
        let phase = TAU * noise.uniform();
        let std = self.noise * (0.5 / INTERVAL).sqrt();
        let converted = |(i, v): (usize, &f64)| {
            let hum = self.hum * (TAU * HUM * i as f64 * INTERVAL + phase).cos();
            let value = v + hum + std * noise.normal();
            (value.clamp(-self.full_scale, self.full_scale - step) / step).round() * step
        };
        signal.iter().enumerate().map(converted).collect()
    }
}

/// Value of the periodic Hann window at sample `i` of a block.
pub fn hann(i: usize) -> f64 {
    (PI * i as f64 / SAMPLES as f64).sin().powi(2)
}

/// Spectral lines 0 to 400 of a Hann-windowed block as peak amplitudes.
///
/// Each line is a plain sum, the same to the last bit on any processor. A fast Fourier transform would depend
/// on the vector instructions of the processor.
fn spectrum(signal: &[f64]) -> Vec<f64> {
    let table: Vec<(f64, f64)> = (0..SAMPLES).map(|i| (TAU * i as f64 / SAMPLES as f64).sin_cos()).collect();
    let windowed: Vec<f64> = signal.iter().enumerate().map(|(i, v)| v * hann(i)).collect();
    let sum: f64 = (0..SAMPLES).map(hann).sum();
    let line = |k: usize| {
        let (mut re, mut im) = (0.0, 0.0);
        for (i, v) in windowed.iter().enumerate() {
            let (sin, cos) = table[i * k % SAMPLES];
            re += v * cos;
            im -= v * sin;
        }
        // Amplitude of a cosine at a line above 0 Hz; at 0 Hz the mean.
        f64::hypot(re, im) / sum * if k == 0 { 1.0 } else { 2.0 }
    };
    (0..=LINES).map(line).collect()
}

/// The values as text, one a line: `  4.001992e-02`.
pub fn print(spectrum: &[f64]) -> String {
    let mut text = String::with_capacity(15 * spectrum.len());
    for value in spectrum {
        let plain = format!("{value:.6e}");
        let (mantissa, exponent) = plain.split_once('e').unwrap_or((&plain, "0"));
        let (sign, digits) = exponent.strip_prefix('-').map_or(('+', exponent), |digits| ('-', digits));
        let _ = writeln!(text, "  {mantissa}e{sign}{digits:0>2}");
    }
    text
}

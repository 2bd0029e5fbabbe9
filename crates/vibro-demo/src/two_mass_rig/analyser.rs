//! The instruments: force gauge, accelerometers with integrating charge amplifiers, and a dynamic signal
//! analyser.
//!
//! The converter runs at 32 times the rate of the finished record and averages over each of its intervals, as
//! integrating converters do. The digital filter after it keeps the base band. Here that filter is one
//! windowed transform of the fast record, of which lines 0 to 400 are kept, so that jumps of velocity do not
//! alias.

use super::noise::PairedNoise;
use std::f64::consts::{PI, TAU};
use std::fmt::Write as _;

/// Spectral lines above the line at 0 Hz.
pub const LINES: usize = 400;
/// Base band in Hz.
pub const BASE_BAND: f64 = 20.0;
/// Duration of a block in s: the reciprocal of the line spacing.
pub const BLOCK: f64 = LINES as f64 / BASE_BAND;
/// Converter's samples in a block: 1024 of the finished record, 32 for each.
pub const SAMPLES: usize = 1024 * 32;
/// Interval of the converter's samples in s.
pub const INTERVAL: f64 = BLOCK / SAMPLES as f64;

/// Mains hum at 50 Hz leaks through the analogue filter and aliases to 1.2 Hz at the finished record's 51.2
/// Hz.
const HUM: f64 = 51.2 - 50.0;

/// Noise and hum that an input adds to its signal, and its converter.
struct Input {
    /// Density of its white noise, in the unit of the signal per √Hz.
    noise: f64,
    /// Amplitude of the aliased hum, in the unit of the signal.
    hum: f64,
    /// Full scale of the 12-bit converter, in the unit of the signal.
    full_scale: f64,
}

/// Force gauge, in N.
const FORCE: Input = Input { noise: 5e-5, hum: 3e-4, full_scale: 0.5 };
/// Offset of the force gauge in N, below the sine's amplitude of 0.1 N.
const FORCE_OFFSET: f64 = 0.012;
/// Integrated accelerometer, in m/s.
const VELOCITY: Input = Input { noise: 4e-5, hum: 2e-4, full_scale: 1.0 };
/// White noise of an accelerometer in m/s² per √Hz.
const ACCELERATION_NOISE: f64 = 8e-4;
/// Offset of an accelerometer in m/s².
const ACCELERATION_OFFSET: f64 = 4e-3;
/// Lower limiting frequency in Hz of the integrating charge amplifier. Above it the accelerometer's noise
/// appears divided by 2πf; at it the offset stops growing. Both make the spectrum rise towards 0 Hz, as
/// integration does.
const LOWER_LIMIT: f64 = 0.01;

/// Force spectrum, in N.
pub fn force(signal: &[f64], noise: &mut PairedNoise) -> Vec<f64> {
    let offset: Vec<f64> = signal.iter().map(|v| v + FORCE_OFFSET).collect();
    spectrum(&FORCE.convert(&offset, noise))
}

/// Velocity spectrum, in m/s, from the true velocity averaged over each interval.
pub fn velocity(signal: &[f64], noise: &mut PairedNoise) -> Vec<f64> {
    let corner = TAU * LOWER_LIMIT;
    // The integrator has settled: a mean of offset/corner, and a variance of density²/(4·corner).
    let mut drift =
        ACCELERATION_OFFSET / corner + noise.normal() * ACCELERATION_NOISE / (2.0 * corner.sqrt());
    let spread = ACCELERATION_NOISE * (0.5 / INTERVAL).sqrt();
    let drifting: Vec<f64> = signal
        .iter()
        .map(|v| {
            let acceleration = ACCELERATION_OFFSET + spread * noise.normal();
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
        let spread = self.noise * (0.5 / INTERVAL).sqrt();
        let one = |(i, v): (usize, &f64)| {
            let hum = self.hum * (TAU * HUM * i as f64 * INTERVAL + phase).cos();
            let value = v + hum + spread * noise.normal();
            (value.clamp(-self.full_scale, self.full_scale - step) / step).round() * step
        };
        signal.iter().enumerate().map(one).collect()
    }
}

/// Hann window, periodic, sample `i` of a block.
pub fn hann(i: usize) -> f64 {
    (PI * i as f64 / SAMPLES as f64).sin().powi(2)
}

/// Spectral lines 0 to 400 of a Hann-windowed block as peak amplitudes.
///
/// A plain sum for each line: the result is the same to the last bit on any processor, while a fast transform
/// depends on the vector instructions that it finds.
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
        // Amplitude of a cosine; the line at 0 Hz is the mean itself.
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

//! Tests: modes from single blows of a hammer, whose force lasts as long as a rubber tip's.

use super::{Measured, ModalOptions, Mode, modal};
use crate::spectral::{SpectralOptions, spectral};
use num_complex::Complex64;
use std::f64::consts::{PI, TAU};
use vibro_math::Noise;
use vibro_record::units::Unit;
use vibro_record::{Axis, Meta, Record, Trace, Traces};
use vibro_signal::transfer::Estimator;

/// Modes: frequency in Hz, damping ratio, modal constant in 1/kg.
const MODES: [(f64, f64, f64); 2] = [(31.2, 0.02, 0.25), (87.6, 0.011, 0.4)];
const RATE: f64 = 2048.0;
const N: usize = 4096;
/// Steps of the simulation in a sample: half of a step before and half after each turn of a mode is exact to
/// (ωΔt)²/12, 2e-5 at the upper mode.
const FINE: usize = 16;

/// A blow of 6 ms at 50 to 52 ms, and the acceleration, with the noise of their sensors.
fn record(seed: u64) -> [Trace; 2] {
    let mut noise = Noise::new(seed);
    let (peak, at) = (60.0 + 60.0 * noise.uniform(), 0.05 + 0.002 * noise.uniform());
    let dt = 1.0 / (RATE * FINE as f64);
    let push = |t: f64| if (0.0..0.006).contains(&t) { peak * (PI * t / 0.006).sin().powi(2) } else { 0.0 };
    let pole = |(f, zeta, _): (f64, f64, f64)| TAU * f * Complex64::new(-zeta, (1.0 - zeta * zeta).sqrt());
    let (mut motion, mut force, mut response) = ([Complex64::ZERO; 2], Vec::new(), Vec::new());
    for i in 0..N * FINE {
        let now = push(i as f64 * dt - at);
        let mut acceleration = 0.0;
        for (z, mode) in motion.iter_mut().zip(MODES) {
            let s = pole(mode);
            *z += 0.5 * dt * now;
            acceleration += mode.2 * ((s * s * *z).im / s.im + now);
            *z = (*z + 0.5 * dt * now) * (s * dt).exp();
        }
        if i % FINE == 0 {
            force.push(now + 0.05 * noise.normal());
            response.push(acceleration + 0.02 * noise.normal());
        }
    }
    let trace = |unit: &str, values: Vec<f64>| Trace {
        meta: Meta::new(unit, Unit::parse_or_opaque(unit)),
        axis: Axis::time(0.0, 1.0 / RATE, N),
        values,
    };
    [trace("N", force), trace("m/s²", response)]
}

/// The samples of the record of the blow, and the modes nearest to [`MODES`].
fn found(seed: u64, segment: Option<usize>) -> (usize, [Mode; 2]) {
    let mut traces = Traces::from_memory(record(seed).into()).unwrap();
    let estimator = Some(Estimator::H1);
    let options = SpectralOptions { segment, estimator, hammer: true, ..SpectralOptions::default() };
    let function = spectral(&mut traces, &options, |_| ()).unwrap();
    let Record::Frf(frf) = &function.records()[0] else { panic!() };
    let options = ModalOptions { band: Some((20.0, 110.0)), ..ModalOptions::default() };
    let modes = modal(&Measured::complex(frf), &options).unwrap().modes;
    let near = |f: f64| {
        let off = |mode: &&Mode| (mode.frequency.value - f).abs();
        modes.iter().min_by(|a, b| off(a).total_cmp(&off(b))).unwrap().clone()
    };
    ((RATE / function.frequency[0]).round() as usize, MODES.map(|mode| near(mode.0)))
}

/// Largest deviation in standard uncertainties, over single blows whose records hold all of the response, or
/// end while it rings. Whatever the phase of the samples, all of a record is used while the response rings:
/// after half of it, 2 % of the lower mode are left.
#[test]
fn a_single_blow_is_used_to_the_end_of_its_record_which_biases_no_mode() {
    for segment in [None, Some(2048), Some(1024)] {
        for seed in 0..6 {
            let (samples, modes) = found(seed, segment);
            // The blow passes its trigger before its middle, which is 55 ms or 113 samples from the beginning
            // at most; a record has an even number of samples.
            assert!(segment.is_some() || samples >= N - 114, "{seed}: {samples} samples");
            for (mode, (f, zeta, constant)) in modes.iter().zip(MODES) {
                let phase = mode.phase.as_ref().unwrap();
                let pairs = [
                    (&mode.frequency, f),
                    (&mode.zeta, zeta),
                    (&mode.modal_constant, constant),
                    (phase, 0.0),
                ];
                for (found, truth) in pairs {
                    let off = (found.value - truth) / found.std.unwrap();
                    assert!(off.abs() < 5.0, "{segment:?}, seed {seed}, {f} Hz: {off} of {found:?}");
                }
            }
        }
    }
}

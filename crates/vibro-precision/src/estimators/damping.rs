//! Damping ratio from a frequency response function.

use super::trial::{Case, Ensemble, EstimationMethod, EstimatorAnswer, Numbers, Record, questions};
use super::{EstimatorScene, bounds, rivals, scene};
use crate::BorderQuestion;
use num_complex::Complex64;
use std::f64::consts::TAU;
use vibro_math::Noise;
use vibro_measure::modal::{Measured, ModalOptions, Mode, Pole, modal};
use vibro_record::units::Quantity;
use vibro_record::{Error, Result};

/// Natural frequency in Hz and damping ratio of the mode: a half-power bandwidth of 0.36 Hz.
const NATURAL_FREQUENCY: f64 = 100.0;
const ZETA: f64 = 0.0018;

/// Methods for the damping ratio.
const METHODS: [EstimationMethod<Measured>; 4] = [
    EstimationMethod::Rival("half power, lines", |m| rivals::half_power(&m.frequency, &m.values, false)),
    EstimationMethod::Rival("half power, between", |m| rivals::half_power(&m.frequency, &m.values, true)),
    EstimationMethod::Rival("circle", |m| rivals::circle(&m.frequency, &m.values)),
    EstimationMethod::Own("rational fit", rational),
];

impl Record for Measured {
    fn numbers(&self) -> Numbers {
        let (start, step) = (self.frequency[0], self.frequency[1] - self.frequency[0]);
        let values = self.values.iter().flat_map(|v| [v.re, v.im]).collect();
        Numbers { start, step, values, known: None }
    }
}

/// ζ of the strongest mode, as from `vibro modal`.
pub(super) fn rational(measured: &Measured) -> Result<EstimatorAnswer> {
    let found = modal(measured, &ModalOptions::default())?;
    let height = |m: &&Mode| m.modal_constant.value.abs() / m.zeta.value;
    let strongest = found.modes.iter().max_by(|a, b| height(a).total_cmp(&height(b)));
    let mode = strongest.ok_or_else(|| Error::refused("no mode"))?;
    Ok(EstimatorAnswer::found(&mode.zeta, &found.findings))
}

/// A receptance on lines `step` Hz apart from `from` to `to` in Hz, in noise of `part` times its highest
/// line. The truth is ζ of the first mode.
fn case(modes: &[Pole], (from, to, step): (f64, f64, f64), part: f64, noise: &mut Noise) -> Case<Measured> {
    let count = ((to - from) / step) as usize;
    let frequency: Vec<f64> = (0..count).map(|i| from + i as f64 * step).collect();
    let sum = |f: &f64| modes.iter().map(|m| m.at(*f, 0)).sum::<Complex64>();
    let mut values: Vec<Complex64> = frequency.iter().map(sum).collect();
    let sigma = part * values.iter().map(|v| v.norm()).fold(0.0, f64::max);
    for v in &mut values {
        *v += Complex64::new(sigma * noise.normal(), sigma * noise.normal());
    }
    let data = Measured::new(frequency, values, Quantity::Receptance);
    let zeta = modes[0].zeta;
    Case { data, truth: zeta, unit: zeta, tolerance: 0.1 * zeta }
}

/// A mode with a modal constant of 1.
fn mode(frequency: f64, zeta: f64) -> Pole {
    Pole { frequency, zeta, constant: Complex64::new(1.0, 0.0) }
}

/// Draws records of the mode with this number of lines in its bandwidth, its frequency anywhere between two
/// lines. The band is the larger of ±12 Hz and ±12 lines about the mode, above 0 Hz; noise of `part` times
/// the highest line.
fn mode_on_lines(in_bandwidth: f64, part: f64) -> impl Fn(&mut Noise) -> Case<Measured> {
    move |noise| {
        let step = 2.0 * ZETA * NATURAL_FREQUENCY / in_bandwidth;
        let half_span = (12.0 * step).max(12.0);
        let from = (NATURAL_FREQUENCY - half_span).max(0.0) + step * noise.uniform();
        case(&[mode(NATURAL_FREQUENCY, ZETA)], (from, NATURAL_FREQUENCY + half_span, step), part, noise)
    }
}

/// Cramér–Rao bound of the relative error of ζ, from the lines within six bandwidths, since further away
/// other modes would matter. A complex modal constant and two complex residual terms are unknown, too.
fn bound(in_bandwidth: f64, part: f64) -> f64 {
    let width = 2.0 * ZETA * NATURAL_FREQUENCY;
    let stiffness = (TAU * NATURAL_FREQUENCY).powi(2);
    let half_span = (6.0 * in_bandwidth).max(16.0) as i32;
    let model = |p: &[f64]| {
        let pole = Pole { frequency: p[0], zeta: p[1], constant: Complex64::new(p[2], p[3]) };
        let at = |k: i32| {
            let f = NATURAL_FREQUENCY + (f64::from(k) + 0.25) * width / in_bandwidth;
            let rest =
                Complex64::new(p[4], p[5]) + Complex64::new(p[6], p[7]) * (NATURAL_FREQUENCY / f).powi(2);
            let v = pole.at(f, 0) * stiffness + rest;
            [v.re, v.im]
        };
        (-half_span..=half_span).flat_map(at).collect()
    };
    let p = [NATURAL_FREQUENCY, ZETA, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0];
    let steps = [1e-4 * width, 1e-4 * ZETA, 1e-4, 1e-4, 1e-3, 1e-3, 1e-3, 1e-3];
    bounds(&p, &steps, part / (2.0 * ZETA), model)[1] / ZETA
}

/// The scene of damping.
pub fn scenes() -> Vec<EstimatorScene> {
    let settings = [1.16, 2.0, 4.0, 8.0, 16.0]
        .map(|n| Ensemble::new(format!("{n} lines in the bandwidth"), 20_000, mode_on_lines(n, 0.01)));
    let texts = [
        "damping",
        "The damping ratio of a mode at 100 Hz whose bandwidth of 0.36 Hz holds 1.16 lines (0.31 Hz apart) to 16 lines, in noise of 1 % of the peak; the bound is that of 16 lines.",
        "damping ratio: relative error (rms)",
        "the pole that the receptance was made of",
    ];
    vec![scene(texts, bound(16.0, 0.01), &METHODS, settings)]
}

/// Questions to methods for damping at their borders.
pub(crate) fn borders(quick: bool) -> Vec<BorderQuestion> {
    // Modes on lines 0.5 Hz apart up to 300 Hz, changed after they were made; ζ of the first is to be
    // estimated.
    let changed = |name: &str, modes: Vec<Pole>, change: fn(&mut Measured)| {
        Ensemble::new(name, 21_000, move |noise: &mut Noise| case(&modes, (1.0, 300.0, 0.5), 0.01, noise))
            .changed(change)
    };
    let plain = |name: &str, modes: &[Pole]| changed(name, modes.to_vec(), |_| ());
    let one = |name, change| changed(name, vec![mode(100.0, 0.01)], change);
    let narrow = [0.01, 0.1, 0.3, 0.5, 1.0]
        .map(|n| Ensemble::new(format!("bandwidth of {n} lines"), 22_000, mode_on_lines(n, 0.01)));
    let noise = [0.1, 0.3, 1.0].map(|part| {
        Ensemble::new(format!("noise of {} % of the peak", 100.0 * part), 23_000, mode_on_lines(4.0, part))
    });
    let heavy = [0.1, 0.3, 0.5, 0.7, 0.9, 1.5].map(|z| plain(&format!("ζ = {z}"), &[mode(100.0, z)]));
    let zero = Pole { constant: Complex64::new(1.5, 0.0), ..mode(107.0, 0.02) };
    let faults = [
        plain("equal mode half a bandwidth beside", &[mode(100.0, 0.01), mode(101.0, 0.01)]),
        plain("equal mode two bandwidths beside", &[mode(100.0, 0.01), mode(104.0, 0.01)]),
        plain("antiresonance a bandwidth above", &[mode(100.0, 0.01), zero]),
        plain("peak 2 lines from the first", &[mode(2.2, 0.1)]),
        one("phase reversed", |m| m.values.iter_mut().for_each(|v| *v = v.conj())),
        one("magnitudes alone", |m| {
            m.magnitude_only = true;
            m.values.iter_mut().for_each(|v| *v = Complex64::new(v.norm(), 0.0));
        }),
        one("one line missing", |m| m.values[190] = Complex64::new(f64::NAN, f64::NAN)),
        one("all lines zero", |m| m.values.fill(Complex64::new(0.0, 0.0))),
    ];
    let mut all = questions("damping: narrow peak", &METHODS, narrow, quick);
    all.extend(questions("damping: noise", &METHODS, noise, quick));
    all.extend(questions("damping: heavy", &METHODS, heavy, quick));
    all.extend(questions("damping: faults", &METHODS, faults, quick));
    all
}

//! Response of a mode in a function that was averaged over windowed segments, or over the blows of a hammer.
//!
//! The mean of conj(F)X over segments of a stationary excitation, windowed by w, is the cross-spectrum
//! smoothed by |W|² (Bendat & Piersol 2010, 8.5). Where the excitation is flat over a few lines, so is the
//! frequency response function. In time this multiplies the impulse response by the window's autocorrelation
//! r(τ)/r(0), 0 ≤ τ ≤ T, and ∫ r(τ) exp(−sτ) dτ takes the place of 1/s.
//!
//! For w = Σ cₖ exp(2πikt/T) that integral is T Σ [cⱼ² L(z − 2πij) + bⱼ E(z − 2πij)]/Σ cₖ² with z = sT, E(z)
//! = (1 − exp(−z))/z, L(z) = (1 − E(z))/z and bⱼ = cⱼ/(πi) Σ cₘ/(m − j) over m ≠ j: the products of two terms
//! of w, each integrated from 0 to T − τ.
//!
//! The record of a blow ends while the response F(p) exp(pt) rings, F(p) the transform of the force. With s =
//! iω − p and T the time from the centre of the force to the first sample after the record, the sum over the
//! samples after it, Δt apart, lacks from 1/s: exp(−sT) Δt/(1 − exp(−sΔt)) exp((p² + ω²)v/2). The last factor
//! is F(p)/F(iω) about the centre: v is the variance of the force over time, its second cumulant.

use super::{BlowRecords, Measured};
use num_complex::Complex64;
use std::f64::consts::{PI, TAU};
use vibro_record::Window;

/// What takes the place of 1/s, for times over the inverse unit of s.
#[derive(Debug, Clone)]
pub(super) enum Leakage {
    /// The integral above for one window and segment length.
    Segments {
        length: f64,
        /// 2πj, cⱼ² and bⱼ over Σ cₖ².
        terms: Vec<(f64, f64, Complex64)>,
    },
    Blows(BlowRecords),
}

/// Fall of the power of a force over frequency, ω²v, up to which its second cumulant describes it: 10 dB.
const FALL: f64 = 2.3;

impl Measured {
    /// Leakage of the records over which the function was averaged, for angular frequencies over `unit` in
    /// rad/s.
    pub(super) fn leakage(&self, unit: f64) -> Option<Leakage> {
        let segments = self.window.map(|window| Leakage::of(window, unit / self.spacing()));
        segments.or(self.blows.map(|blows| Leakage::of_blows(&blows, unit)))
    }
}

impl Leakage {
    /// For segments of `length`, in the inverse unit of s.
    pub fn of(window: Window, length: f64) -> Leakage {
        let a = window.coefficients();
        let most = a.len() as i32 - 1;
        let c = |k: i32| match k.unsigned_abs() as usize {
            0 => a[0],
            k => a[k] * if k % 2 == 0 { 0.5 } else { -0.5 },
        };
        let power: f64 = (-most..=most).map(|k| c(k) * c(k)).sum();
        let term = |j: i32| {
            let beside: f64 = (-most..=most).filter(|m| *m != j).map(|m| c(m) / f64::from(m - j)).sum();
            let b = Complex64::new(0.0, -c(j) * beside / PI);
            (TAU * f64::from(j), c(j) * c(j) / power, b / power)
        };
        Leakage::Segments { length, terms: (-most..=most).map(term).collect() }
    }

    /// For the records of blows, for angular frequencies over `unit` in rad/s.
    pub fn of_blows(blows: &BlowRecords, unit: f64) -> Leakage {
        Leakage::Blows(BlowRecords {
            after: unit * blows.after,
            before: unit * blows.before,
            variance: unit * unit * blows.variance,
            sample: unit * blows.sample,
            ..*blows
        })
    }

    /// What takes the place of 1/(iω − p) at the line `at` = iω, for a pole p.
    pub fn inverse(&self, at: Complex64, pole: Complex64) -> Complex64 {
        let s = at - pole;
        let (length, terms) = match self {
            Leakage::Segments { length, terms } => (*length, terms),
            Leakage::Blows(BlowRecords { after, variance, sample, .. }) => {
                let fall = (variance * at.im * at.im).min(FALL);
                let left = (0.5 * (variance * pole * pole + fall) - s * after).exp();
                // Of an undamped mode on a line: the limit, to 1e-6.
                let whole =
                    if (s * after).norm_sqr() < 1e-12 { after + variance * at } else { (1.0 - left) / s };
                // Δt/(1 − exp(−sΔt)) = 1/s + Δt/2 + sΔt²/12 …
                return whole - left * sample * (0.5 + s * sample / 12.0);
            }
        };
        let decayed = (-s * length).exp();
        let sum = terms.iter().map(|(shift, square, b)| {
            let z = s * length - Complex64::new(0.0, *shift);
            // z = 0 is an undamped mode on a line; near it both are at their limits 1 and ½, to 1e-6.
            let small = z.norm_sqr() < 1e-12;
            let e = if small { Complex64::new(1.0, 0.0) } else { (1.0 - decayed) / z };
            let l = if small { Complex64::new(0.5, 0.0) } else { (1.0 - e) / z };
            square * l + b * e
        });
        length * sum.sum::<Complex64>()
    }

    /// As [`Leakage::mode`], of what the blow before left, whose size and phase is that of the mode times
    /// `phase`: it begins with the record, and ends as the mode does. 0 for segments.
    pub fn blow_before(&self, x: f64, (own, zeta): (f64, f64), power: i32, phase: Complex64) -> Complex64 {
        let Leakage::Blows(BlowRecords { after, before, variance, .. }) = self else {
            return Complex64::ZERO;
        };
        let pole = own * Complex64::new(-zeta, (1.0 - zeta * zeta).max(0.0).sqrt());
        let part = |pole: Complex64| {
            let s = Complex64::new(0.0, x) - pole;
            let force = (0.5 * (variance * pole * pole + (variance * x * x).min(FALL))).exp();
            pole.powi(power) * force * ((s * *before).exp() - (-s * *after).exp()) / s
        };
        (phase * part(pole) - phase.conj() * part(pole.conj())) / Complex64::new(0.0, 2.0 * pole.im)
    }

    /// Response at the angular frequency `x` of a mode with natural angular frequency `own`, damping ratio
    /// `zeta` and modal constant 1, times (ix)^`power`.
    pub fn mode(&self, x: f64, (own, zeta): (f64, f64), power: i32) -> Complex64 {
        let pole = own * Complex64::new(-zeta, (1.0 - zeta * zeta).max(0.0).sqrt());
        let part = |pole: Complex64| pole.powi(power) * self.inverse(Complex64::new(0.0, x), pole);
        let smooth = if power == 2 { 1.0 } else { 0.0 };
        smooth + (part(pole) - part(pole.conj())) / Complex64::new(0.0, 2.0 * pole.im)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Reference: r(τ) and its transform, both by Simpson's rule.
    fn by_sums(window: Window, length: f64, s: Complex64) -> Complex64 {
        let n = 2000;
        let at = |t: f64| -> f64 {
            let terms = window.coefficients().iter().enumerate();
            terms.map(|(k, a)| if k % 2 == 0 { 1.0 } else { -1.0 } * a * (TAU * k as f64 * t).cos()).sum()
        };
        // Composite Simpson over [0, end] of a function of a fraction.
        let simpson = |end: f64, f: &dyn Fn(f64) -> Complex64| -> Complex64 {
            let weight = |i: usize| {
                if i == 0 || i == n {
                    1.0
                } else if i % 2 == 1 {
                    4.0
                } else {
                    2.0
                }
            };
            (0..=n).map(|i| f(end * i as f64 / n as f64) * weight(i)).sum::<Complex64>() * end
                / (3.0 * n as f64)
        };
        let r = |tau: f64| simpson(1.0 - tau, &|t| (at(t) * at(t + tau)).into());
        let zero = r(0.0);
        length * simpson(1.0, &|tau| r(tau) / zero * (-s * length * tau).exp())
    }

    #[test]
    fn the_closed_form_is_the_integral() {
        for window in Window::ALL {
            for s in [Complex64::new(0.8, 0.3), Complex64::new(0.1, -2.0), Complex64::new(3.0, 9.0)] {
                let (found, expected) =
                    (Leakage::of(window, 2.0).inverse(s, Complex64::ZERO), by_sums(window, 2.0, s));
                // Simpson's rule on 2000 steps of functions with up to 8 periods: (8·2π/2000)⁴/180 is 2e-9.
                assert!(
                    (found - expected).norm() < 1e-7 * expected.norm(),
                    "{window:?} {s}: {found} {expected}"
                );
            }
        }
    }

    /// Samples Δt apart of a mode after two impulses √v before and after its time 0, summed one by one from
    /// the end of a record on: 1/s lacks these.
    #[test]
    fn the_end_of_a_record_is_a_sum_over_samples_of_what_an_extended_force_leaves() {
        let (pole, sample, n, half) = (Complex64::new(-0.02, 1.0), 0.2, 50, 0.1f64);
        let blows =
            BlowRecords { after: f64::from(n) * sample, variance: half * half, sample, ..Default::default() };
        for omega in [0.9, 0.98, 1.0, 1.1] {
            let at = Complex64::new(0.0, omega);
            let force = |s: Complex64| 0.5 * ((s * half).exp() + (-s * half).exp());
            // After 1500 time units the mode has decayed to exp(−30).
            let behind = (n..7500).map(|k| sample * ((pole - at) * (sample * f64::from(k))).exp());
            let left = behind.sum::<Complex64>() * force(pole) / force(at);
            let expected = 1.0 / (at - pole) - left;
            let found = Leakage::of_blows(&blows, 1.0).inverse(at, pole);
            // The fourth cumulant of the force changes the part left by 2(0.1)⁴/12 = 2e-5, the next term of
            // the sum over samples by (0.02)⁴/720.
            assert!((found - expected).norm() < 3e-5 * left.norm(), "{omega}: {found} {expected}");
            let plain = Leakage::of_blows(&BlowRecords { variance: 0.0, sample: 0.0, ..blows }, 1.0);
            assert!((plain.inverse(at, pole) - expected).norm() > 1e-3 * left.norm(), "neither matters");
        }
    }

    /// What a mode leaves that two impulses √v apart from a former time drove, integrated over the record.
    #[test]
    fn what_the_blow_before_left_begins_with_the_record() {
        let (own, zeta, after, before, half) = (1.0, 0.02, 10.0, 1.5, 0.1f64);
        let pole = own * Complex64::new(-zeta, f64::sqrt(1.0 - zeta * zeta));
        let blows = BlowRecords { after, before, variance: half * half, ..Default::default() };
        let phase = Complex64::cis(0.7);
        for x in [0.8, 1.0, 1.1] {
            let at = Complex64::new(0.0, x);
            let force = |s: Complex64| 0.5 * ((s * half).exp() + (-s * half).exp());
            let (n, step) = (4000, (after + before) / 4000.0);
            let response = |t: f64| (phase * force(pole) * (pole * t).exp()).im / pole.im;
            let time = |k: i32| (f64::from(k) + 0.5) * step - before;
            let sum: Complex64 = (0..n).map(|k| response(time(k)) * (-at * time(k)).exp() * step).sum();
            let expected = sum / force(at);
            let found = Leakage::of_blows(&blows, 1.0).blow_before(x, (own, zeta), 0, phase);
            // The fourth cumulant of the force is 2e-5 of each pole, the midpoint rule errs by step²/24.
            assert!((found - expected).norm() < 1e-4 * expected.norm(), "{x}: {found} {expected}");
        }
    }

    /// Long segments leave a mode as it is: r falls from 1 by κτ² with κ = 2π²/3T² for a Hann window.
    #[test]
    fn long_segments_leave_a_mode_alone() {
        for power in 0..3 {
            let (x, own, zeta) = (1.02, 1.0, 0.01);
            let length = 2e4;
            let found = Leakage::of(Window::Hann, length).mode(x, (own, zeta), power);
            let plain =
                Complex64::new(0.0, x).powi(power) / Complex64::new(own * own - x * x, 2.0 * zeta * own * x);
            // 2κ/a² of the mode with a = |i(x − 1) + ζ| or more.
            let bound = 4.0 * PI * PI / 3.0 / (length * 0.01).powi(2);
            assert!((found / plain - 1.0).norm() < bound, "{power}: {found} {plain}");
        }
    }
}

#[cfg(test)]
mod averaged {
    use super::super::{Measured, ModalOptions, modal};
    use crate::spectral::{SpectralOptions, spectral};
    use num_complex::Complex64;
    use std::f64::consts::TAU;
    use vibro_math::Noise;
    use vibro_record::units::Unit;
    use vibro_record::{Axis, Meta, Record, Trace, Traces};
    use vibro_signal::transfer::Estimator;

    /// A mode driven by white noise f: ẍ + 2ζωẋ + ω²x = f, sampled; its impulse response is sin(ω′t)
    /// exp(−ζωt)/ω′.
    fn records(seed: u64, (own, zeta): (f64, f64), rate: f64, n: usize) -> [Trace; 2] {
        let mut noise = Noise::new(seed);
        let pole = TAU * own * Complex64::new(-zeta, (1.0 - zeta * zeta).sqrt());
        let (step, mut state) = ((pole / rate).exp(), Complex64::new(0.0, 0.0));
        let (mut force, mut response) = (Vec::new(), Vec::new());
        for _ in 0..n {
            let f = noise.normal();
            state = state * step + f / rate;
            force.push(f);
            response.push(state.im / pole.im + 1e-9 * noise.normal());
        }
        let trace = |name: &str, unit, values: Vec<f64>| Trace {
            meta: Meta::new(name, Unit::parse_or_opaque(unit)),
            axis: Axis::time(0.0, 1.0 / rate, values.len()),
            values,
        };
        [trace("force", "N", force), trace("x", "m", response)]
    }

    /// Five lines in the bandwidth: a fit without leakage would make the mode 5 % too wide.
    #[test]
    fn modes_of_averaged_spectra_are_covered() {
        let (own, zeta, rate, segment) = (60.0, 0.02, 512.0, 1024);
        let mut far = [0.0; 3];
        let runs = 12;
        for seed in 0..runs {
            let [force, response] = records(seed, (own, zeta), rate, 120 * segment);
            let mut traces = Traces::from_memory(vec![force, response]).unwrap();
            let options = SpectralOptions {
                segment: Some(segment),
                estimator: Some(Estimator::H1),
                ..SpectralOptions::default()
            };
            let found = spectral(&mut traces, &options, |_| {}).unwrap();
            let records = found.records();
            let Record::Frf(frf) = &records[0] else { panic!() };
            let measured = Measured::complex(frf).with_coherence_of(&records).unwrap();
            let found = modal(&measured, &ModalOptions::default()).unwrap();
            let mode = &found.modes[0];
            // Without a stated window the lines determine it.
            let unsaid = modal(&Measured { window: None, ..measured }, &ModalOptions::default()).unwrap();
            assert_eq!(unsaid.modes[0].zeta, mode.zeta);
            far[0] += ((mode.zeta.value - zeta) / mode.zeta.std.unwrap()).powi(2);
            far[1] += ((mode.frequency.value - own) / mode.frequency.std.unwrap()).powi(2);
            far[2] += ((mode.modal_constant.value - 1.0) / mode.modal_constant.std.unwrap()).powi(2);
        }
        // χ² with 12 degrees of freedom exceeds 32.9 in one of a thousand cases.
        assert!(far.iter().all(|sum| *sum < 32.9), "{far:?}");
    }
}

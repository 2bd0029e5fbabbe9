//! Fitted modes with their uncertainties, beside what the classical methods give.

use super::bands::Group;
use super::classical::{circle, half_power};
use super::rational::Rational;
use super::selection::support_for_two;
use super::{ByMethod, Measured, ModalOptions, Mode, Pole};
use crate::Estimate;
use num_complex::Complex64;
use std::f64::consts::TAU;
use vibro_record::Finding;

/// A modal constant within this of 0 or 180°, in degrees, has a sign.
const IN_STEP: f64 = 45.0;

/// Bandwidths in lines below which the half-power method is tens of per cent off.
const LINES_OF_HALF_POWER: f64 = 8.0;

/// Modes of all groups, and what was found on the way.
pub(super) struct Report<'a> {
    pub measured: &'a Measured,
    pub options: &'a ModalOptions,
    pub modes: Vec<Mode>,
    pub findings: Vec<Finding>,
}

impl Report<'_> {
    /// Adds the modes of a fitted group, beside those of `others`.
    pub fn add(&mut self, group: &Group, fit: &Rational, others: &[Pole]) {
        let sound = fit.sound(self.measured, &group.peaks);
        for (m, sound) in sound.into_iter().enumerate() {
            let (pole, std) = (&fit.modes[m], fit.std[m]);
            let own = pole.without_decay(self.options.decay.unwrap_or(0.0), self.measured.power());
            if let Some(own) = own.filter(|_| sound && fit.explains()) {
                self.mode((group, fit), m, own, others);
                continue;
            }
            self.findings.push(
                Finding::caution("modal-peak-unsupported")
                    .number("frequency", self.measured.frequency[group.peaks[m].at])
                    .number("zeta", pole.zeta)
                    .number("std", std[1])
                    .number("unexplained", fit.unexplained),
            );
        }
    }

    /// Adds mode `m` of a fit, `own` without the decay of a window.
    fn mode(&mut self, (group, fit): (&Group, &Rational), m: usize, own: Pole, others: &[Pole]) {
        let measured = self.measured;
        let (pole, mut std) = (&fit.modes[m], fit.std[m]);
        let at = measured.frequency[group.peaks[m].at];
        let finding = |found: Finding| found.number("frequency", at);
        let mut found = Vec::new();
        if fit.whiteness.rejected() {
            let coloured = finding(Finding::caution("modal-residuals-coloured"));
            found.push(coloured.number("factor", fit.whiteness.inflation));
        }
        let span = measured.frequency[group.lines.end - 1] - measured.frequency[group.lines.start];
        let spacing = span / (group.lines.len() - 1) as f64;
        // Averaging segments multiplies the impulse response by the window's autocorrelation, 1 − 2π²t²/3T² for a Hann window; the
        // pole that fits 1/s − 2κ/s³ best has a decay larger by 2κ/a of a.
        let bandwidth = 2.0 * pole.zeta * pole.frequency / spacing;
        let leakage = 4.0 / 3.0 / bandwidth.powi(2);
        let blows = self.options.from_blows;
        let leaks = !blows && measured.coherence.is_some() && leakage * pole.zeta > std[1];
        if leaks {
            let leaks = finding(Finding::caution("modal-leakage")).number("bandwidth", bandwidth);
            found.push(leaks.number("part", leakage));
        }
        if blows {
            // A record that ends T after the blow lacks e^(sT − iωT) of a mode's part: a factor on A.
            let left = (-TAU * pole.frequency * pole.zeta / spacing).exp();
            if left * pole.constant.norm() > std[2] {
                found.push(finding(Finding::caution("modal-blow-cut-off")).number("part", left));
            }
            (std[2], std[3]) = (std[2].hypot(left * pole.constant.norm()), std[3].hypot(left));
        }
        let phase = own.constant.arg().to_degrees();
        if !measured.magnitude_only && (IN_STEP..180.0 - IN_STEP).contains(&phase.abs()) {
            found.push(finding(Finding::caution("modal-constant-no-sign")).number("phase", phase));
        }
        // ζωᵣ is known as before, and the constant has the factor that its uncertainty has.
        std[1] *= pole.frequency / own.frequency;
        std[2] *= own.constant.norm() / pole.constant.norm();
        // A peak that leakage widens has no longer the form of one mode.
        let two = if leaks { None } else { support_for_two(measured, (group, fit), m, others) };
        found.extend(two.map(|ahead| finding(Finding::doubt("modal-two-modes")).number("ahead", ahead)));
        self.findings.extend(found);
        // What the phases of residual terms and other modes do to magnitudes is in no residual.
        let std = (two.is_none() && !measured.magnitude_only).then_some(std);
        let mode = Estimates { measured, group, fit, m, own, std }.mode(self.options);
        self.modes.push(mode);
    }
}

/// |A|, negative where its phase is nearer to 180° than to ±90°.
fn signed(constant: Complex64) -> f64 {
    let opposite = constant.arg().to_degrees().abs() > 180.0 - IN_STEP;
    if opposite { -constant.norm() } else { constant.norm() }
}

/// One mode of a fit: its pole without the decay of a window, and standard uncertainties of frequency, ζ, modal constant and phase.
struct Estimates<'a> {
    measured: &'a Measured,
    group: &'a Group,
    fit: &'a Rational,
    m: usize,
    own: Pole,
    std: Option<[f64; 4]>,
}

impl Estimates<'_> {
    fn mode(&self, options: &ModalOptions) -> Mode {
        let Estimates { measured, group, fit, own, .. } = self;
        let f = &measured.frequency[group.lines.clone()];
        let n = f.len();
        let together = match group.peaks.len() {
            1 => String::new(),
            many => format!(", {many} modes together"),
        };
        let method = format!("rational fit{together}, {}", fit.noise);
        let phases = !measured.magnitude_only;
        let std = |i: usize| self.std.map(|s| s[i]);
        let estimate = |value, std: Option<f64>, unit| Estimate::new(value, std, unit, n, method.clone());
        let frequency = estimate(own.frequency, std(0), "Hz");
        let zeta = estimate(own.zeta, std(1), "1");
        let constant = if phases { signed(own.constant) } else { own.constant.norm() };
        let modal_constant = estimate(constant, std(2), "1/kg");
        let phase =
            phases.then(|| estimate(own.constant.arg().to_degrees(), std(3).map(f64::to_degrees), "°"));
        let stiffness = options.mass.map(|mass| {
            let k = mass * (TAU * own.frequency).powi(2);
            let std = frequency.std.map(|u| 2.0 * k * u / own.frequency);
            Estimate::new(k, std, "N/m", n, "k = m(2πf)²")
        });
        let decay = options.decay.unwrap_or(0.0);
        let mut by = vec![ByMethod {
            method: "rational fit",
            frequency: frequency.clone(),
            zeta: Some(zeta.clone()),
            modal_constant: Some(modal_constant.clone()),
            note: None,
        }];
        by.extend(phases.then(|| by_circle(&self.circle(decay))));
        by.extend(self.by_magnitudes(decay));
        let fitted = f.iter().zip(&fit.fitted).map(|(f, v)| (*f, v.re, v.im)).collect();
        let lines = (f[0], f[n - 1], n);
        Mode { frequency, zeta, modal_constant, phase, method, stiffness, lines, by, fitted }
    }

    /// The circle of the response as measured, and its mode without the decay of a window.
    fn circle(&self, decay: f64) -> Result<(Pole, usize), Finding> {
        let power = self.measured.power();
        let seen = self.own.without_decay(-decay, power).unwrap_or(self.own);
        let (pole, n) = circle(self.measured, &seen, &self.group.lines)?;
        let pole = pole.without_decay(decay, power).ok_or_else(|| Finding::caution("circle-not-round"))?;
        Ok((pole, n))
    }

    /// The methods that read the magnitudes.
    fn by_magnitudes(&self, decay: f64) -> Vec<ByMethod> {
        let (f, at) = (&self.measured.frequency, self.group.peaks[self.m].at);
        let line = (f[at + 1] - f[at - 1]) / 2.0;
        let found = |(method, how), frequency, zeta: Option<f64>, note| ByMethod {
            method,
            frequency: Estimate::new(frequency, None, "Hz", 1, how),
            zeta: zeta.map(|zeta| Estimate::new(zeta, None, "1", 4, how)),
            modal_constant: None,
            note,
        };
        let half = half_power(self.measured, at, &self.group.lines).map(|(frequency, zeta)| {
            let lines = 2.0 * zeta * frequency / line;
            let coarse = (lines < LINES_OF_HALF_POWER)
                .then(|| Finding::caution("half-power-few-lines").number("bandwidth", lines));
            found(("half power", "half power"), frequency, Some(zeta - decay / (TAU * frequency)), coarse)
        });
        let within = Finding::note("peak-within-a-line").number("half", line / 2.0);
        half.into_iter().chain([found(("peak", "largest line"), f[at], None, Some(within))]).collect()
    }
}

fn by_circle(found: &Result<(Pole, usize), Finding>) -> ByMethod {
    let pole = found.as_ref().ok().map(|circle| circle.0);
    let n = found.as_ref().map_or(0, |circle| circle.1);
    let plain = |value, unit| Estimate::new(value, None, unit, n, "circle fit");
    ByMethod {
        method: "circle fit",
        frequency: plain(pole.map_or(f64::NAN, |p| p.frequency), "Hz"),
        zeta: pole.map(|p| plain(p.zeta, "1")),
        modal_constant: pole.map(|p| plain(signed(p.constant), "1/kg")),
        note: found.as_ref().err().cloned(),
    }
}

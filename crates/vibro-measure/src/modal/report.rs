//! Results of fitted modes with their uncertainties, beside those of the classical methods.

use super::classical::{CIRCLE, circle, half_power};
use super::rational::{MATTERS, Rational};
use super::selection::PeakGroup;
use super::{ByMethod, Measured, ModalOptions, Mode, Pole};
use crate::Estimate;
use num_complex::Complex64;
use std::f64::consts::TAU;
use vibro_record::Finding;
use vibro_record::code;

/// A modal constant has a sign if its phase is within this angle in degrees of 0° or 180°.
const IN_STEP: f64 = 45.0;
/// Bandwidth in lines below which the half-power method is wrong by tens of per cent.
const LINES_OF_HALF_POWER: f64 = 8.0;

/// Largest residual of a fit, root mean square over the highest line; beyond it the model does not describe
/// the lines.
const EXPLAINED: f64 = 0.1;

/// One mode of a group that was fitted.
pub(super) struct Candidate<'a> {
    pub measured: &'a Measured,
    pub options: &'a ModalOptions,
    pub group: &'a PeakGroup,
    pub fit: &'a Rational,
    /// Index of the mode in the fit.
    pub m: usize,
    /// Whether the function was averaged over segments, and neither the file nor the lines determine their
    /// window.
    pub unsaid: bool,
}

impl Candidate<'_> {
    fn decay(&self) -> f64 {
        self.options.decay.unwrap_or(0.0)
    }

    /// The mode, with its findings; `None` where its peak supports none.
    pub fn mode(&self, sound: bool, findings: &mut Vec<Finding>) -> Option<Mode> {
        let Candidate { measured, group, fit, m, .. } = *self;
        let (pole, mut std) = (&fit.modes[m], fit.std[m]);
        let at = measured.frequency[group.peaks[m].at];
        let mut find =
            |holds: bool, found: Finding| findings.extend(holds.then(|| found.number("frequency", at)));
        let own = pole.without_decay(self.decay(), measured.power());
        let Some(own) = own.filter(|_| sound && fit.unexplained < EXPLAINED) else {
            let found = Finding::caution("modal-peak-unsupported").number("zeta", pole.zeta);
            find(true, found.number("std", std[1]).number("unexplained", fit.unexplained));
            return None;
        };
        find(fit.whiteness.rejected(), fit.whiteness.coloured("modal-residuals-coloured"));
        let span = measured.frequency[group.lines.end - 1] - measured.frequency[group.lines.start];
        let spacing = span / (group.lines.len() - 1) as f64;
        // Averaging segments multiplies the impulse response by the window's autocorrelation, 1 − 2π²t²/3T²
        // = 1 − κt² for a Hann window. The pole that fits 1/s − 2κ/s³ best decays faster, with a + 2κ/a in
        // place of a.
        let bandwidth = 2.0 * pole.zeta * pole.frequency / spacing;
        let leakage = 4.0 / 3.0 / bandwidth.powi(2);
        let leaks = leakage * pole.zeta > std[1];
        let of = |found: Finding| found.number("bandwidth", bandwidth).number("part", leakage);
        if self.unsaid && leaks {
            std[1] = std[1].hypot(leakage * pole.zeta);
            std[2] = std[2].hypot(leakage * pole.constant.norm());
            find(true, of(Finding::caution("modal-leakage")));
        }
        find(measured.window.is_some() && leaks, of(Finding::note("modal-leakage-fitted")));
        if let Some(blows) = measured.blows {
            let left = (-TAU * own.frequency * own.zeta * blows.apart.unwrap_or(blows.after)).exp();
            let cut_off = Finding::caution(code::MODAL_BLOW_CUT_OFF).number("part", left);
            find(left * pole.constant.norm() > std[2], cut_off);
            // Noise within a short force window is alike on neighbouring lines: it scales the whole mode.
            (std[2], std[3]) =
                (std[2].hypot(blows.scatter * pole.constant.norm()), std[3].hypot(blows.scatter));
        }
        let phase = own.constant.arg().to_degrees();
        let no_sign = !measured.magnitude_only && (IN_STEP..180.0 - IN_STEP).contains(&phase.abs());
        find(no_sign, Finding::caution("modal-constant-no-sign").number("phase", phase));
        // An error φ of the phase takes |A|φ²/2 from the part along a real modal constant: the mean square is
        // ¾|A|²u⁴ (second order, JCGM 100:2008, 5.1.2). An unknown phase leaves the sign open, too.
        std[2] = std[2].hypot(0.75f64.sqrt() * pole.constant.norm() * std[3].powi(2));
        // Removing the window's decay keeps the uncertainty of ζωᵣ, and changes that of the constant by the
        // same factor as the constant.
        std[1] *= pole.frequency / own.frequency;
        std[2] *= own.constant.norm() / pole.constant.norm();
        let around = |other: f64| (other - pole.frequency).abs() < MATTERS * pole.zeta * pole.frequency;
        let ahead = group.ahead.filter(|(_, other)| around(*other)).map(|(ahead, _)| ahead);
        let two = ahead.map(|ahead| Finding::doubt("modal-two-modes").number("ahead", ahead));
        let more = group.pattern.map(|ahead| Finding::doubt("modal-more-modes").number("ahead", ahead));
        let mut mode = self.estimates(&own, std);
        if self.has_neighbour() || two.is_some() || more.is_some() {
            let one_mode = |by: &&mut ByMethod| matches!(by.method, "circle fit" | "half power");
            let shared = |by: &mut ByMethod| {
                by.note.get_or_insert(Finding::caution("method-of-one-mode"));
            };
            mode.by.iter_mut().filter(one_mode).for_each(shared);
        }
        let doubts = two.into_iter().chain(more);
        findings.extend(doubts.map(|doubt| doubt.number("frequency", at).of(&mut mode)));
        Some(mode)
    }

    /// Whether another mode of the fit lies on the lines of this one's circle, or this one on those of its.
    fn has_neighbour(&self) -> bool {
        let half = |mode: &Pole| mode.zeta * mode.frequency;
        let own = &self.fit.modes[self.m];
        let near =
            |other: &Pole| (other.frequency - own.frequency).abs() < CIRCLE * half(other).max(half(own));
        self.fit.modes.iter().enumerate().any(|(m, other)| m != self.m && near(other))
    }

    /// The estimates of a mode by all methods. `own` is its pole without the decay of a window; `std` are
    /// the standard uncertainties of frequency in Hz, ζ, modal constant, and phase in rad.
    fn estimates(&self, own: &Pole, std: [f64; 4]) -> Mode {
        let Candidate { measured, options, group, fit, m, .. } = *self;
        let f = &measured.frequency[group.lines.clone()];
        let n = f.len();
        let together = match group.peaks.len() {
            1 => String::new(),
            many => format!(", {many} modes together"),
        };
        let hidden = if fit.covers_hidden { ", one hidden mode allowed for" } else { "" };
        let method = format!("rational fit{together}, {}{hidden}", fit.noise);
        let phases = !measured.magnitude_only;
        let estimate = |value, std, unit| Estimate::new(value, Some(std), unit, n, method.clone());
        let frequency = estimate(own.frequency, std[0], "Hz").with_relative(options.clock);
        let zeta = estimate(own.zeta, std[1], "1");
        let constant = if phases { signed(own.constant) } else { own.constant.norm() };
        let modal_constant = estimate(constant, std[2], measured.unit_of_constants());
        let angle = own.constant.arg().to_degrees();
        let phase = phases.then(|| estimate(angle, std[3].to_degrees(), "°"));
        let stiffness = options.mass.map(|mass| {
            let k = mass * (TAU * own.frequency).powi(2);
            let std = frequency.std.map(|u| 2.0 * k * u / own.frequency);
            Estimate::new(k, std, "N/m", n, "k = m(2πf)²")
        });
        let rational = ByMethod {
            method: "rational fit",
            frequency: frequency.clone(),
            zeta: Some(zeta.clone()),
            modal_constant: Some(modal_constant.clone()),
            note: None,
        };
        let by_circle = phases.then(|| self.by_circle(own));
        let at = group.peaks[m].at;
        let by = [Some(rational), by_circle, self.by_half_power(at), Some(self.by_largest_line(at))];
        let fitted = f.iter().zip(&fit.fitted).map(|(f, v)| (*f, v.re, v.im)).collect();
        let (by, lines) = (by.into_iter().flatten().collect(), (f[0], f[n - 1], n));
        Mode { frequency, zeta, modal_constant, phase, method, stiffness, lines, by, fitted }
    }

    /// Circle fit of the response as measured, and its mode without the decay of a window.
    fn by_circle(&self, own: &Pole) -> ByMethod {
        let (power, decay) = (self.measured.power(), self.decay());
        let seen = own.without_decay(-decay, power).unwrap_or(*own);
        let found = circle(self.measured, &seen, &self.group.lines).and_then(|(pole, n)| {
            let pole = pole.without_decay(decay, power);
            pole.map(|pole| (pole, n)).ok_or_else(|| Finding::caution("circle-not-round"))
        });
        let (pole, n, note) = match found {
            Ok((pole, n)) => (Some(pole), n, None),
            Err(note) => (None, 0, Some(note)),
        };
        let plain = |value, unit| Estimate::new(value, None, unit, n, "circle fit");
        ByMethod {
            method: "circle fit",
            frequency: plain(pole.map_or(f64::NAN, |p| p.frequency), "Hz"),
            zeta: pole.map(|p| plain(p.zeta, "1")),
            modal_constant: pole.map(|p| plain(signed(p.constant), self.measured.unit_of_constants())),
            note,
        }
    }

    /// Distance in Hz of the lines around line `at`.
    fn line(&self, at: usize) -> f64 {
        (self.measured.frequency[at + 1] - self.measured.frequency[at - 1]) / 2.0
    }

    fn by_half_power(&self, at: usize) -> Option<ByMethod> {
        let (frequency, zeta) = half_power(self.measured, at, &self.group.lines)?;
        let lines = 2.0 * zeta * frequency / self.line(at);
        let coarse = Finding::caution("half-power-few-lines").number("bandwidth", lines);
        let own = zeta - self.decay() / (TAU * frequency);
        Some(ByMethod {
            method: "half power",
            frequency: Estimate::new(frequency, None, "Hz", 1, "half power"),
            zeta: Some(Estimate::new(own, None, "1", 4, "half power")),
            modal_constant: None,
            note: (lines < LINES_OF_HALF_POWER).then_some(coarse),
        })
    }

    fn by_largest_line(&self, at: usize) -> ByMethod {
        ByMethod {
            method: "peak",
            frequency: Estimate::new(self.measured.frequency[at], None, "Hz", 1, "largest line"),
            zeta: None,
            modal_constant: None,
            note: Some(Finding::note("peak-within-a-line").number("half", self.line(at) / 2.0)),
        }
    }
}

/// |A|, negative where its phase is nearer to 180° than to ±90°.
fn signed(constant: Complex64) -> f64 {
    let opposite = constant.arg().to_degrees().abs() > 180.0 - IN_STEP;
    if opposite { -constant.norm() } else { constant.norm() }
}

//! What is known of each mode.

use super::bands::Group;
use super::graphic::{Circle, POINTS, circle, half_power};
use super::hidden::hidden;
use super::rational::Rational;
use super::response::hertz;
use super::{Measured, Pole};
use crate::Estimate;
use num_complex::Complex64;
use serde::Serialize;
use std::f64::consts::TAU;
use vibro_record::units::notation::{estimate, significant};

/// How modes are looked for.
#[derive(Debug, Clone, PartialEq)]
pub struct ModalOptions {
    /// Band in Hz whose peaks are fitted together. Default: a band around each peak.
    pub band: Option<(f64, f64)>,
    /// Mass in kg for the stiffness k = m(2πf)², taken as exact. Default: none.
    pub mass: Option<f64>,
    /// Lines of a coherence below this are left out. Default 0.5.
    pub least_coherence: f64,
    /// Decay in 1/s that an exponential window added to the response, which is taken off ζ. Default: none.
    pub decay: Option<f64>,
    /// Whether the function was averaged over the blows of a hammer, each a record as long as one over the distance of the lines.
    /// Default: false.
    pub from_blows: bool,
}

impl Default for ModalOptions {
    fn default() -> ModalOptions {
        ModalOptions { band: None, mass: None, least_coherence: 0.5, decay: None, from_blows: false }
    }
}

/// The modes of a frequency response function.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ModalResult {
    /// Modes by frequency.
    pub modes: Vec<Mode>,
    /// What a person must know.
    pub warnings: Vec<String>,
}

/// One mode.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Mode {
    /// Undamped natural frequency in Hz.
    pub frequency: Estimate,
    /// Damping ratio.
    pub zeta: Estimate,
    /// Modal constant A of the receptance A/(ωᵣ² − ω² + 2iζωᵣω), 1/kg: its magnitude, negative where its phase is within 45° of
    /// 180°. In a mode shape the signs are the directions.
    pub modal_constant: Estimate,
    /// Phase of the modal constant in degrees: 0 or 180° for a mode of which all parts move in step. `None` without phases.
    pub phase: Option<Estimate>,
    /// How these were found.
    pub method: String,
    /// k = m(2πf)² in N/m; `None` without a mass.
    pub stiffness: Option<Estimate>,
    /// First and last line in Hz, and the number of lines, that were fitted.
    pub lines: (f64, f64, usize),
    /// What every method gives.
    pub by: Vec<ByMethod>,
    /// Curves for a figure.
    #[serde(skip)]
    pub picture: ModePicture,
}

/// What one method gives.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ByMethod {
    /// `rational fit`, `circle fit`, `half power` or `peak`.
    pub method: &'static str,
    /// Natural frequency in Hz.
    pub frequency: Estimate,
    /// Damping ratio.
    pub zeta: Option<Estimate>,
    /// Modal constant, with the sign of [`Mode::modal_constant`].
    pub modal_constant: Option<Estimate>,
    /// What limits it; empty for nothing.
    pub note: String,
}

/// A mode, to be drawn.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ModePicture {
    /// Frequency and fitted response of the lines that were used, real and imaginary.
    pub fitted: Vec<(f64, f64, f64)>,
    /// The circle, where one was fitted.
    pub circle: Option<Circle>,
}

/// So far from 0 or 180°, in degrees, a modal constant has a sign.
const IN_STEP: f64 = 45.0;

/// The share of a blow's record that lies before the blow.
const BEFORE: f64 = 1.0 / crate::spectral::BEFORE as f64;

/// |A|, negative where its phase is nearer to 180° than to ±90°.
fn signed(constant: Complex64) -> f64 {
    let opposite = constant.arg().to_degrees().abs() > 180.0 - IN_STEP;
    if opposite { -constant.norm() } else { constant.norm() }
}

fn stiffness(frequency: &Estimate, mass: Option<f64>) -> Option<Estimate> {
    let k = mass? * (TAU * frequency.value).powi(2);
    let std = frequency.std.map(|u| 2.0 * k * u / frequency.value);
    Some(Estimate::new(k, std, "N/m", frequency.n, "k = m(2πf)²"))
}

/// Adds the modes of a fitted group, beside those of `others`; returns how many of them have a phase that runs the wrong way.
pub(super) fn report(
    measured: &Measured,
    group: &Group,
    fit: &Rational,
    others: &[Pole],
    options: &ModalOptions,
    modes: &mut Vec<Mode>,
    warnings: &mut Vec<String>,
) -> usize {
    let mut reversed = 0;
    let sound = fit.sound(measured, &group.peaks);
    for (m, (((pole, std), peak), sound)) in
        fit.modes.iter().zip(&fit.std).zip(&group.peaks).zip(sound).enumerate()
    {
        let at = hertz(measured.frequency[peak.at]);
        if !(sound && fit.explains()) {
            if pole.zeta < 0.0 && std[1] < -pole.zeta / 2.0 {
                reversed += 1;
            }
            warnings.push(format!(
                "The peak at {at} Hz is not supported as a mode: the fit gives ζ = {} at {:.3} Hz and leaves {:.0} % of the highest line.",
                estimate(pole.zeta, Some(std[1])),
                pole.frequency,
                100.0 * fit.unexplained
            ));
            continue;
        }
        if fit.whiteness.rejected() {
            warnings.push(format!(
                "Around {} Hz the residuals are not white: neighbouring modes, leakage or a damping that is not viscous; the uncertainties are enlarged by a factor of {}.",
                hertz(pole.frequency),
                significant(fit.whiteness.inflation, 3)
            ));
        }
        // Averaging segments multiplies the impulse response by the window's autocorrelation, 1 − 2π²t²/3T² for a Hann
        // window; the pole that fits 1/s − 2κ/s³ best has a decay larger by 2κ/a of a.
        let bandwidths = 2.0 * pole.zeta * pole.frequency * (group.lines.len() - 1) as f64;
        let span = measured.frequency[group.lines.end - 1] - measured.frequency[group.lines.start];
        let leakage = 4.0 / 3.0 * (span / bandwidths).powi(2);
        let leaks = !options.from_blows && measured.coherence.is_some() && leakage * pole.zeta > std[1];
        if leaks {
            warnings.push(format!(
                "At {at} Hz the bandwidth is {:.1} lines: if segments of a lasting excitation were averaged (Hann window), leakage makes ζ too large, by about {} % where the fit rests on the top of the peak and less where it rests on the flanks, which is not in its uncertainty. Longer segments show.",
                bandwidths / span,
                significant(100.0 * leakage, 1)
            ));
        }
        let Some(own) = pole.without_decay(options.decay.unwrap_or(0.0), measured.power()) else {
            warnings.push(if pole.zeta >= 1.0 {
                format!(
                    "The peak at {at} Hz is no mode that oscillates: the fit gives ζ = {}.",
                    estimate(pole.zeta, Some(std[1]))
                )
            } else {
                format!(
                    "The peak at {at} Hz decays by less than the exponential window added: it is no mode, or the window another than stated."
                )
            });
            continue;
        };
        let mut std = *std;
        if options.from_blows {
            // A record that ends T after the blow lacks e^(sT − iωT) of a mode's part. On lines 1/(T + t) apart, t before the blow,
            // that is a factor on A, which turns by t·ω from line to line as a delay of t would: seen over the width of the
            // peak, t·ζωᵣ, it changes ζ and ωᵣ, too.
            let decay = TAU * pole.frequency * pole.zeta;
            let record = (group.lines.len() - 1) as f64 / span;
            let left = (-decay * (1.0 - BEFORE) * record).exp();
            let turned = left * decay * BEFORE * record;
            if left * pole.constant.norm() > std[2] {
                warnings.push(format!(
                    "At {at} Hz {} % of the mode's response is left when the record of a blow ends: its modal constant may be off by as much, which is in the uncertainty. Longer records (--segment) or an exponential window (--left-at-end) help.",
                    significant(100.0 * left, 2)
                ));
            }
            std[0] = std[0].hypot(turned * pole.zeta * pole.frequency);
            std[1] = std[1].hypot(turned * pole.zeta);
            std[2] = std[2].hypot(left * pole.constant.norm());
            std[3] = std[3].hypot(left);
        }
        let phase = own.constant.arg().to_degrees();
        if !measured.magnitude_only && (IN_STEP..180.0 - IN_STEP).contains(&phase.abs()) {
            warnings.push(format!(
                "The modal constant at {at} Hz has a phase of {phase:.0}° and no sign: the parts do not move in step, or the response came late."
            ));
        }
        // ζωᵣ is known as before, and the constant has the factor that its uncertainty has.
        std[1] *= pole.frequency / own.frequency;
        std[2] *= own.constant.norm() / pole.constant.norm();
        // A peak that leakage widens has no longer the form of one mode.
        let hidden = if leaks { None } else { hidden(measured, group, fit, m, others) };
        // What the phases of residual terms and other modes do to magnitudes is in no residual, nor what a mode does that shows as no peak.
        let std = (hidden.is_none() && !measured.magnitude_only).then_some(&std);
        modes.push(mode(measured, group, peak.at, fit, (&own, std), options));
        warnings.extend(hidden);
    }
    reversed
}

fn mode(
    measured: &Measured,
    group: &Group,
    at: usize,
    fit: &Rational,
    (pole, std): (&Pole, Option<&[f64; 4]>),
    options: &ModalOptions,
) -> Mode {
    let lines = group.lines.clone();
    let n = lines.len();
    let f = &measured.frequency[lines.clone()];
    let together = match group.peaks.len() {
        1 => String::new(),
        many => format!(", {many} modes together"),
    };
    let method = format!("rational fit{together}, {}", fit.noise);
    let phases = !measured.magnitude_only;
    let estimate = |value, std: Option<f64>, unit| Estimate::new(value, std, unit, n, method.clone());
    let std = |i: usize| std.map(|s| s[i]);
    let frequency = estimate(pole.frequency, std(0), "Hz");
    let zeta = estimate(pole.zeta, std(1), "1");
    let modal_constant =
        estimate(if phases { signed(pole.constant) } else { pole.constant.norm() }, std(2), "1/kg");
    let phase = phases.then(|| estimate(pole.constant.arg().to_degrees(), std(3).map(f64::to_degrees), "°"));
    let mut by = vec![ByMethod {
        method: "rational fit",
        frequency: frequency.clone(),
        zeta: Some(zeta.clone()),
        modal_constant: Some(modal_constant.clone()),
        note: String::new(),
    }];
    let mut drawn = None;
    if phases {
        let blank = |note: String| ByMethod {
            method: "circle fit",
            frequency: Estimate::new(f64::NAN, None, "Hz", 0, "circle fit"),
            zeta: None,
            modal_constant: None,
            note,
        };
        let decay = options.decay.unwrap_or(0.0);
        // The circle is that of the response as measured, with the decay of the window.
        let seen = pole.without_decay(-decay, measured.power()).unwrap_or(*pole);
        let found = circle(measured, &seen, &lines).and_then(|circle| {
            let own = circle.pole.without_decay(decay, measured.power()).ok_or(circle.points.len())?;
            Ok(Circle { pole: own, ..circle })
        });
        by.push(match found {
            Ok(circle) => {
                let n = circle.points.len();
                let plain = |value, unit| Estimate::new(value, None, unit, n, "circle fit");
                let found = ByMethod {
                    method: "circle fit",
                    frequency: plain(circle.pole.frequency, "Hz"),
                    zeta: Some(plain(circle.pole.zeta, "1")),
                    modal_constant: Some(plain(signed(circle.pole.constant), "1/kg")),
                    note: String::new(),
                };
                drawn = Some(circle);
                found
            }
            Err(n) if n < POINTS => {
                blank(format!("a circle needs {POINTS} lines around the mode, and there are {n}"))
            }
            Err(_) => blank("the lines lie on no circle".to_owned()),
        });
    }
    by.extend(graphic(measured, group, at, options.decay.unwrap_or(0.0)));
    let fitted = f.iter().zip(&fit.fitted).map(|(f, v)| (*f, v.re, v.im)).collect();
    Mode {
        stiffness: stiffness(&frequency, options.mass),
        frequency,
        zeta,
        modal_constant,
        phase,
        method,
        lines: (f[0], f[n - 1], n),
        by,
        picture: ModePicture { fitted, circle: drawn },
    }
}

/// The methods that read the magnitudes.
fn graphic(measured: &Measured, group: &Group, at: usize, decay: f64) -> Vec<ByMethod> {
    let f = &measured.frequency;
    let line = (f[at + 1] - f[at - 1]) / 2.0;
    let near = |f: f64, method| Estimate::new(f, None, "Hz", 1, method);
    let mut by = Vec::new();
    if let Some((frequency, zeta)) = half_power(measured, at, &group.lines) {
        let lines = 2.0 * zeta * frequency / line;
        let note = if lines < 8.0 {
            format!(
                "bound to the lines: the bandwidth is {lines:.1} lines, and ζ is too large by up to tens of per cent"
            )
        } else {
            String::new()
        };
        by.push(ByMethod {
            method: "half power",
            frequency: near(frequency, "half power"),
            zeta: Some(Estimate::new(zeta - decay / (TAU * frequency), None, "1", 4, "half power")),
            modal_constant: None,
            note,
        });
    }
    by.push(ByMethod {
        method: "peak",
        frequency: near(f[at], "largest line"),
        zeta: None,
        modal_constant: None,
        note: format!("bound to the lines: within {:.6} Hz", line / 2.0),
    });
    by
}

//! Modes of frequency response functions: natural frequency, damping ratio and modal constant.
//!
//! The result is a rational fit in the complex plane, local to each peak: modes of viscous damping and two
//! residual terms for the modes below and above, in the kind of the function itself (a receptance times iω
//! for a mobility, −ω² for an accelerance). The largest line, the half-power bandwidth and the circle fit are
//! given for comparison.

mod blow_records;
#[cfg(test)]
mod blows;
mod classical;
mod leakage;
#[cfg(test)]
mod neighbours;
mod noise;
mod peak;
mod rational;
mod report;
mod response;
mod result;
mod selection;
mod stabilisation;

pub use blow_records::BlowRecords;
pub use response::Measured;
pub use result::{ByMethod, ModalOptions, ModalResult, Mode, Pole};
pub use stabilisation::{OrderedPole, stabilisation};

use num_complex::Complex64;
use peak::Peak;
use rational::{Rational, rational};
use report::Candidate;
use selection::{PeakGroup, averaging, chosen, complete, groups, together};
use vibro_record::{Error, Finding, Result, sort_by_number};

/// Peaks and the modes that were fitted to them.
type Fitted = (PeakGroup, Rational);

/// Finds the modes of a frequency response function.
///
/// Each peak a factor of two above its valleys is a candidate. Peaks too near each other to be separated are
/// fitted together, and modes of other groups are subtracted before the last fit of a group. With a band, its
/// modes are then fitted together to all its lines, where that explains the lines. Where only the conjugate
/// of the function has modes, its phase follows exp(−iωt), and the conjugate is fitted.
///
/// # Errors
/// If the band is impossible, holds no peak or fewer lines than the parameters of a mode, or no line can be
/// used.
pub fn modal(measured: &Measured, options: &ModalOptions) -> Result<ModalResult> {
    let refused = match damped(measured, options) {
        Err(refused) if !measured.magnitude_only => refused,
        found => return found,
    };
    let values = measured.values.iter().map(Complex64::conj).collect();
    let Ok(mut found) = damped(&Measured { values, ..measured.clone() }, options) else {
        return Err(refused);
    };
    found.modes.iter_mut().flat_map(|mode| &mut mode.fitted).for_each(|(_, _, im)| *im = -*im);
    found.findings.insert(0, Finding::caution("modal-phase-reversed"));
    Ok(found)
}

/// The modes of a function whose phase falls through a resonance.
fn damped(measured: &Measured, options: &ModalOptions) -> Result<ModalResult> {
    let least = options.least_coherence.unwrap_or(0.5);
    if !(0.0..1.0).contains(&least) {
        return Err(Error::usage(format!("a least coherence of {least}"), "a number from 0 to below 1"));
    }
    let decayed = |decay| Finding::note("modal-window-decay").number("decay", decay);
    let mut findings: Vec<Finding> = options.decay.map(decayed).into_iter().collect();
    let mut lines = measured.clone().usable(least, &mut findings)?;
    findings.extend((!lines.kind.is_function()).then(|| Finding::caution("modal-unit-unknown")));
    // Without phases, errors by residual terms and other modes do not show in the residuals.
    let without_phases = lines.magnitude_only.then(|| Finding::doubt("modal-magnitudes-only"));
    let place = findings.len();
    let (mut fits, mut unsupported, mut failed) = (Vec::new(), Vec::new(), None);
    let groups = groups(&lines, options.band)?;
    // A coherence shows that the function was averaged, but not how.
    let unsaid = lines.window.is_none() && lines.coherence.is_some() && lines.blows.is_none();
    let unsaid = unsaid && !averaging(&mut lines, &groups);
    for mut group in groups {
        match chosen(&lines, &mut group, &mut unsupported) {
            Ok(fit) => fits.push((group, fit)),
            Err(error) => {
                unsupported.extend(group.peaks);
                failed.get_or_insert(error);
            }
        }
    }
    if let Some(error) = failed.filter(|_| fits.is_empty()) {
        return Err(error);
    }
    if let Some(band) = options.band {
        together(&lines, lines.within(band), &mut fits, &mut unsupported);
    }
    refine(&lines, &mut fits);
    let mut modes = Vec::new();
    for at in 0..fits.len() {
        let others = poles_beside(&lines, &fits, at);
        let (group, fit) = &mut fits[at];
        let sound = complete(&lines, group, fit, &others);
        let starts = fit.starts();
        if let Some(again) = fit.again(&lines, group.lines.clone(), &others, &starts) {
            fit.cover_hidden(&again);
            fit.cover_noise(&again);
            if let Some(blows) = &lines.blows {
                fit.cover_blow_before(&again, blows, options.decay.unwrap_or(0.0));
            }
        }
        for (m, sound) in sound.into_iter().enumerate() {
            let candidate = Candidate { measured: &lines, options, group, fit, m, unsaid };
            modes.extend(candidate.mode(sound, &mut findings));
        }
    }
    if modes.is_empty() {
        return Err(without_modes(options));
    }
    findings.splice(place..place, without_phases.map(|doubt| doubt.of(&mut modes)));
    gather_noise(&lines, &unsupported, &mut findings);
    sort_by_number(&mut modes, |a| a.frequency.value);
    Ok(ModalResult { modes, findings })
}

/// Error for a function without modes.
fn without_modes(options: &ModalOptions) -> Error {
    let refused = Error::refused("no peak of the function is supported as a mode");
    match options.band {
        None => refused.hint("choose a band around one peak").setting("band"),
        Some(_) => refused.hint("take longer records, for five lines or more in the peak"),
    }
}

/// Gathers `unsupported` peaks in one finding, and findings on peaks without a mode where these are more
/// than [`ALONE`].
fn gather_noise(lines: &Measured, unsupported: &[Peak], findings: &mut Vec<Finding>) {
    let odd = |found: &Finding| found.get("frequency").filter(|_| found.code == "modal-peak-unsupported");
    let mut at: Vec<f64> = findings.iter().filter_map(odd).collect();
    if at.len() > ALONE {
        findings.retain(|found| odd(found).is_none());
    } else {
        at.clear();
    }
    at.extend(unsupported.iter().map(|p| lines.frequency[p.at]));
    if at.is_empty() {
        return;
    }
    // The highest are named.
    let height = |f: &f64| lines.values[lines.frequency.partition_point(|line| line < f)].norm();
    sort_by_number(&mut at, |a| -height(a));
    let finding = Finding::caution("modal-peaks-of-noise").count("n", at.len());
    at.truncate(NAMED);
    at.sort_by(f64::total_cmp);
    findings.push(finding.numbers("lines", at));
}

/// Most peaks without a mode that have a finding each.
const ALONE: usize = 2;

/// Most peaks without a mode that one finding names.
const NAMED: usize = 8;

/// The modes of all groups but group `at`. A mode that no peak of its own group supports may belong to group
/// `at`, and is left out.
fn poles_beside(lines: &Measured, fits: &[Fitted], at: usize) -> Vec<Pole> {
    let sound = |(group, fit): &Fitted| {
        let modes = fit.modes.clone().into_iter().zip(fit.sound(lines, &group.peaks));
        modes.filter(|(_, sound)| *sound).map(|(mode, _)| mode).collect::<Vec<_>>()
    };
    fits[..at].iter().chain(&fits[at + 1..]).flat_map(sound).collect()
}

/// Fits each group again with the modes of the others subtracted, twice.
fn refine(lines: &Measured, fits: &mut [Fitted]) {
    // Without phases nothing can be subtracted.
    let turns = if lines.magnitude_only { 0 } else { 2 * fits.len() };
    for at in (0..fits.len()).cycle().take(turns) {
        let others = poles_beside(lines, fits, at);
        let (group, fit) = &mut fits[at];
        let starts: Vec<(f64, f64)> = fit.modes.iter().map(|m| (m.frequency, m.zeta)).collect();
        if !others.is_empty()
            && starts.iter().all(|s| s.0 > 0.0 && s.1 > 0.0)
            && let Ok(better) = rational(lines, group.lines.clone(), (&starts, 0), &others)
        {
            *fit = better;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use vibro_record::Fact;
    use vibro_record::units::Quantity;

    /// Two modes as an accelerance, lines of 0.5 Hz.
    fn two() -> Measured {
        let poles = [(80.3, 0.01), (210.7, 0.004)];
        let poles =
            poles.map(|(frequency, zeta)| Pole { frequency, zeta, constant: Complex64::new(2.0, 0.0) });
        let frequency: Vec<f64> = (0..600).map(|i| f64::from(i) * 0.5).collect();
        let values = frequency.iter().map(|f| poles.iter().map(|p| p.at(*f, 2)).sum()).collect();
        Measured::new(frequency, values, Quantity::Accelerance)
    }

    fn says(result: &ModalResult, code: &str) -> bool {
        result.findings.iter().any(|f| f.code == code)
    }

    fn found(measured: &Measured, options: &ModalOptions) -> ModalResult {
        modal(measured, options).unwrap()
    }

    #[test]
    fn modes_without_noise_are_exact() {
        let result = found(&two(), &ModalOptions { mass: Some(0.125), ..ModalOptions::default() });
        assert_eq!(result.modes.len(), 2, "{result:?}");
        for (mode, (f, zeta)) in result.modes.iter().zip([(80.3, 0.01), (210.7, 0.004)]) {
            // The other mode is subtracted up to the error of its own fit: one part in 1e5 of a bandwidth.
            assert!((mode.frequency.value - f).abs() < 1e-5 * f * zeta, "{mode:?}");
            assert!((mode.zeta.value / zeta - 1.0).abs() < 1e-5, "{mode:?}");
            assert!((mode.modal_constant.value / 2.0 - 1.0).abs() < 1e-4, "{mode:?}");
            let k = mode.stiffness.as_ref().unwrap();
            let expected = 0.125 * (std::f64::consts::TAU * mode.frequency.value).powi(2);
            assert!((k.value / expected - 1.0).abs() < 1e-12);
            let (of_k, of_f) = (k.std.unwrap() / k.value, mode.frequency.std.unwrap() / mode.frequency.value);
            assert!((of_k / (2.0 * of_f) - 1.0).abs() < 1e-9);
        }
        // A mode of bandwidth 1.6 Hz has seven lines on 270° of its circle. That circle is exact except for
        // the contribution of the other mode.
        let circle = result.modes[0].by.iter().find(|b| b.method == "circle fit").unwrap();
        assert!((circle.frequency.value - 80.3).abs() < 0.02, "{circle:?}");
        assert!((circle.zeta.as_ref().unwrap().value / 0.01 - 1.0).abs() < 0.02, "{circle:?}");
    }

    /// A phase that rises through resonances is that of exp(−iωt).
    #[test]
    fn the_conjugate_of_a_function_has_its_modes() {
        let conjugate = |of: &Measured| Measured {
            values: of.values.iter().map(Complex64::conj).collect(),
            ..of.clone()
        };
        let (plain, reversed) =
            (found(&two(), &ModalOptions::default()), found(&conjugate(&two()), &ModalOptions::default()));
        assert!(says(&reversed, "modal-phase-reversed") && !says(&plain, "modal-phase-reversed"));
        assert_eq!(plain.modes.len(), reversed.modes.len());
        for (plain, reversed) in plain.modes.iter().zip(&reversed.modes) {
            assert_eq!(
                (&plain.frequency, &plain.modal_constant),
                (&reversed.frequency, &reversed.modal_constant)
            );
            let [a, b] = [plain, reversed].map(|mode| mode.fitted[0]);
            assert_eq!(a, (b.0, b.1, -b.2), "the fit is of the lines as they are");
        }
    }

    /// A mode shape: where two parts move against each other, one of their modal constants is negative.
    #[test]
    fn a_modal_constant_has_a_sign_and_a_phase() {
        let mut measured = two();
        let poles = [(80.3, 0.01, -0.35), (210.7, 0.004, 2.0)].map(|(frequency, zeta, a)| Pole {
            frequency,
            zeta,
            constant: Complex64::new(a, 0.0),
        });
        let sum = |f: &f64| poles.iter().map(|p| p.at(*f, 2)).sum();
        measured.values = measured.frequency.iter().map(sum).collect();
        let result = found(&measured, &ModalOptions::default());
        for (mode, (a, degrees)) in result.modes.iter().zip([(-0.35, 180.0), (2.0, 0.0)]) {
            assert!((mode.modal_constant.value / a - 1.0).abs() < 1e-3, "{mode:?}");
            let phase = mode.phase.as_ref().unwrap();
            assert!((phase.value.abs() - degrees).abs() < 0.1 && phase.unit == "°", "{mode:?}");
            assert!(phase.std.is_some() && mode.modal_constant.std.is_some());
            let circle = mode.by.iter().find(|b| b.method == "circle fit").unwrap();
            assert!(circle.modal_constant.as_ref().is_none_or(|c| c.value * a > 0.0), "{circle:?}");
        }
        assert_eq!(result.modes.len(), 2);
        // A phase of 90° has no sign.
        measured.values.iter_mut().for_each(|v| *v *= Complex64::i());
        let result = found(&measured, &ModalOptions::default());
        assert!(says(&result, "modal-constant-no-sign"), "{result:?}");
        assert!(result.modes.iter().all(|m| m.modal_constant.value > 0.0));
    }

    /// Two like modes with a bandwidth of 2 Hz, 1 Hz apart, show one peak and are found as two modes.
    #[test]
    fn a_peak_of_two_modes_is_two_modes() {
        let mut noise = vibro_math::Noise::new(3);
        let mut with = |modes: &[f64]| {
            let pole = |f: &f64| Pole { frequency: *f, zeta: 0.01, constant: Complex64::new(2.0, 0.0) };
            let poles: Vec<Pole> = modes.iter().map(pole).collect();
            let frequency: Vec<f64> = (1..600).map(|i| f64::from(i) * 0.5).collect();
            let mut values: Vec<Complex64> =
                frequency.iter().map(|f| poles.iter().map(|p| p.at(*f, 0)).sum()).collect();
            let sigma = 0.01 * values.iter().map(|v| v.norm()).fold(0.0, f64::max);
            for v in &mut values {
                *v += sigma * Complex64::new(noise.normal(), noise.normal());
            }
            let measured = Measured { frequency, values, kind: Quantity::Receptance, ..two() };
            found(&measured, &ModalOptions { mass: Some(1.0), ..ModalOptions::default() })
        };
        let result = with(&[100.0, 101.0]);
        assert_eq!(result.modes.len(), 2, "{:?}", result.findings);
        for (mode, f) in result.modes.iter().zip([100.0, 101.0]) {
            for (estimate, truth) in [(&mode.frequency, f), (&mode.zeta, 0.01)] {
                assert!((estimate.value - truth).abs() < 4.0 * estimate.std.unwrap(), "{estimate:?}");
            }
        }
        let result = with(&[100.0]);
        assert!(result.modes[0].zeta.std.is_some() && result.modes[0].stiffness.is_some(), "{result:?}");
    }

    /// An exponential window shifts all poles: the function is taken at iω + σ, as the modes are here.
    #[test]
    fn the_decay_of_an_exponential_window_is_taken_off() {
        let (own, zeta, decay, measured) = (500.0, 0.01, 3.0, two());
        let values = measured.frequency.iter().map(|f| {
            let s = Complex64::new(decay, std::f64::consts::TAU * f);
            2.0 / (own * own + s * s + 2.0 * zeta * own * s)
        });
        let measured = Measured { values: values.collect(), kind: Quantity::Receptance, ..measured.clone() };
        let result = found(&measured, &ModalOptions { decay: Some(decay), ..ModalOptions::default() });
        let mode = &result.modes[0];
        // Without noise the receptance is a mode exactly; the fit ends within 1e-5 of a bandwidth.
        assert!((mode.zeta.value / zeta - 1.0).abs() < 1e-4, "{mode:?}");
        assert!((mode.frequency.value * std::f64::consts::TAU / own - 1.0).abs() < 1e-6, "{mode:?}");
        assert!((mode.modal_constant.value / 2.0 - 1.0).abs() < 1e-4, "{mode:?}");
        let circle = mode.by.iter().find(|b| b.method == "circle fit").unwrap();
        assert!((circle.zeta.as_ref().unwrap().value / zeta - 1.0).abs() < 0.02, "{circle:?}");
        assert!(says(&result, "modal-window-decay"), "{:?}", result.findings);
        let without = found(&measured, &ModalOptions::default());
        // Uncorrected, ζ + σ/ωᵣ is found, up to the square of that.
        assert!((without.modes[0].zeta.value / (zeta + decay / own) - 1.0).abs() < 1e-3);
        // As an accelerance, whose constant the correction changes by 2e-4, and its uncertainty by as much.
        let s = |f: &f64| Complex64::new(decay, std::f64::consts::TAU * f);
        let values = measured.values.iter().zip(&measured.frequency).map(|(v, f)| v * s(f) * s(f));
        let measured = Measured { values: values.collect(), kind: Quantity::Accelerance, ..measured.clone() };
        let of = |decay| {
            let result = found(&measured, &ModalOptions { decay, ..ModalOptions::default() });
            let constant = &result.modes[0].modal_constant;
            (constant.value, constant.std.unwrap() / constant.value)
        };
        let (with, without) = (of(Some(3.0)), of(None));
        assert!(
            (with.0 / 2.0 - 1.0).abs() < 1e-4 && (with.1 / without.1 - 1.0).abs() < 1e-9,
            "{with:?} {without:?}"
        );
    }

    /// A receptance of a blow whose record ends T = 0.98 s after it, with 12 % of the response left: its
    /// impulse response is cut there, which gives each pole s the factor 1 − e^((s − iω)T).
    #[test]
    fn the_end_of_a_record_of_a_blow_is_a_part_of_the_mode() {
        let (own, zeta, length) = (500.0, 0.0043, 0.98);
        let pole = own * Complex64::new(-zeta, f64::sqrt(1.0 - zeta * zeta));
        let measured = two();
        let values = measured.frequency.iter().map(|f| {
            let part = |s: Complex64| {
                let apart = Complex64::new(0.0, std::f64::consts::TAU * f) - s;
                (1.0 - (-apart * length).exp()) / apart
            };
            2.0 * (part(pole) - part(pole.conj())) / Complex64::new(0.0, 2.0 * pole.im)
        });
        let kind = Quantity::Receptance;
        let blows = Some(BlowRecords { after: length, ..BlowRecords::default() });
        let measured = Measured { blows, values: values.collect(), kind, ..measured.clone() };
        let result = found(&measured, &ModalOptions::default());
        let mode = &result.modes[0];
        assert!((mode.zeta.value / zeta - 1.0).abs() < 1e-4, "{mode:?}");
        assert!((mode.modal_constant.value / 2.0 - 1.0).abs() < 1e-4, "{mode:?}");
        // What the blow before left, half of e^(−ζωT), is not known from the lines.
        let left = 0.5 * (-own * zeta * length).exp();
        // The fit is exact but for rounding.
        assert!(mode.modal_constant.std.unwrap() >= 2.0 * left * (1.0 - 1e-12), "{mode:?}");
        assert!(says(&result, "modal-blow-cut-off"), "{:?}", result.findings);
    }

    #[test]
    fn magnitudes_alone_give_frequency_and_damping() {
        let mut measured = two();
        measured.values.iter_mut().for_each(|v| *v = Complex64::new(v.norm(), 0.0));
        measured.magnitude_only = true;
        let result = found(&measured, &ModalOptions { band: Some((76.0, 85.0)), ..ModalOptions::default() });
        // The contribution of the other mode is not constant over the band: its curvature is (4.5/130)² of
        // it.
        assert!((result.modes[0].frequency.value - 80.3).abs() < 0.02, "{result:?}");
        assert!((result.modes[0].zeta.value / 0.01 - 1.0).abs() < 0.03, "{result:?}");
        assert!(says(&result, "modal-magnitudes-only"));
        let mode = &result.modes[0];
        assert!([&mode.frequency, &mode.zeta, &mode.modal_constant].iter().all(|e| e.std.is_none()));
        assert!(mode.phase.is_none());
        assert!(result.modes[0].by.iter().all(|b| b.method != "circle fit"));
    }

    #[test]
    fn lines_of_impossible_coherence_are_left_out_and_named() {
        let mut measured = two();
        let mut coherence = vec![0.99; measured.frequency.len()];
        (coherence[158], coherence[162], coherence[420]) = (1.2, 0.2, f64::NAN);
        measured.values[158] *= 50.0;
        measured.coherence = Some(coherence);
        let result = found(&measured, &ModalOptions::default());
        for (code, line) in [
            ("frf-lines-impossible-coherence", 79.0),
            ("frf-lines-low-coherence", 81.0),
            ("frf-lines-missing", 210.0),
        ] {
            let found = result.findings.iter().find(|f| f.code == code).unwrap();
            assert_eq!(found.fact("lines"), Some(&Fact::Numbers(vec![line])), "{code}");
        }
        assert!((result.modes[0].frequency.value - 80.3).abs() < 1e-3, "{result:?}");
    }

    #[test]
    fn what_cannot_be_fitted_is_refused() {
        let refusal = |measured: &Measured, band| {
            format!("{:#}", modal(measured, &ModalOptions { band, ..ModalOptions::default() }).unwrap_err())
        };
        let measured = two();
        assert!(refusal(&measured, Some((100.0, 130.0))).contains("no peak between"));
        assert!(refusal(&measured, Some((79.5, 81.0))).contains("4 lines"));
        assert!(refusal(&measured, Some((90.0, 80.0))).contains("LO below HI"));
        let with = |value| Measured { values: vec![value; 600], ..two() };
        assert!(refusal(&with(Complex64::new(1.0, 0.0)), None).contains("no peak"));
        assert!(refusal(&with(Complex64::new(f64::NAN, 0.0)), None).contains("0 of 600 lines"));
    }
}

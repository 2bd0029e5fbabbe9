//! A force that grows or falls within its steps.
//!
//! A linear response to e^{(iω + ε)t} is H(iω + ε): near a resonance of decay rate h (1/s) it differs from
//! H(iω) by the fraction ε/h.

use super::{Phasor, StepReading, common};
use crate::residuals::widened;
use num_complex::Complex64;
use std::f64::consts::TAU;
use vibro_record::sort_by_number;

/// Fewest blocks that show a growth.
const FEWEST: usize = 4;
/// Least distance of two frequencies, over the frequency, at which they show a slope.
const APART: f64 = 1e-5;

/// Relative growth of the sizes of the phasors of blocks, in the inverse unit of their `length`, by a
/// straight line through their logarithms, and its standard uncertainty; 0 where they are too few.
pub(super) fn growth(phasors: &[Complex64], length: f64) -> (f64, f64) {
    let n = phasors.len();
    if n < FEWEST {
        return (0.0, 0.0);
    }
    let logarithms: Vec<f64> = phasors.iter().map(|phasor| phasor.norm().ln()).collect();
    let centre = 0.5 * (n as f64 - 1.0);
    let mean = logarithms.iter().sum::<f64>() / n as f64;
    let at = |k: usize| (k as f64 - centre) * length;
    let squares: f64 = (0..n).map(|k| at(k) * at(k)).sum();
    let slope = logarithms.iter().enumerate().map(|(k, v)| at(k) * (v - mean)).sum::<f64>() / squares;
    let left: f64 = logarithms.iter().enumerate().map(|(k, v)| (v - mean - slope * at(k)).powi(2)).sum();
    let std = widened(n - 2) * (left / (n - 2) as f64 / squares).sqrt();
    if slope.is_finite() && std.is_finite() { (slope, std) } else { (0.0, 0.0) }
}

/// Growth of each step in view of the growth of all: with a normal distribution about 0, whose variance is
/// that of the growths beyond their uncertainties, the mean and standard deviation of its growth given its
/// own measured one. Where no step shows a growth, no step has one.
fn likely(steps: &[StepReading]) -> Vec<(f64, f64)> {
    let seen: Vec<(f64, f64)> =
        steps.iter().map(|step| (step.growth.0.powi(2), step.growth.1.powi(2))).collect();
    let variance = common(&seen);
    let of = |step: &StepReading| {
        let part = variance / (variance + step.growth.1.powi(2)).max(f64::MIN_POSITIVE);
        (step.growth.0 * part, step.growth.1 * part.sqrt())
    };
    steps.iter().map(of).collect()
}

/// Corrects H(iω + ε) of each step to H(iω), by the slope of H over frequency. Near a resonance 1/H is
/// smooth, a parabola in iω; near an antiresonance H is. The one that is straighter over the step and its
/// neighbours gives the slope, and its curvature the uncertainty of the slope.
pub(super) fn without_growth(steps: &mut [StepReading]) {
    let mut all: Vec<(f64, Complex64)> =
        steps.iter().map(|step| (TAU * step.frequency.value, step.ratio.value)).collect();
    sort_by_number(&mut all, |a| a.0);
    let likely = likely(steps);
    for (step, growth) in steps.iter_mut().zip(likely).filter(|(_, growth)| growth.0 != 0.0) {
        let own = (TAU * step.frequency.value, step.ratio.value);
        let below = all.iter().rev().find(|(w, _)| *w < own.0 * (1.0 - APART));
        let above = all.iter().find(|(w, _)| *w > own.0 * (1.0 + APART));
        let Some((factor, unsure)) = back(growth, own, below.copied(), above.copied()) else { continue };
        for phasor in [&mut step.response, &mut step.ratio] {
            let Phasor { value, .. } = *phasor;
            phasor.value = value * factor;
            phasor.allow(value.norm() * unsure);
        }
    }
}

/// Angular frequency ω in rad/s, and the response there.
type At = (f64, Complex64);

/// Factor from H(iω + `growth`) to H(iω), and its standard uncertainty, from those of the growth and of the
/// slope. At an end of the sweep, one neighbour gives the slope, and all of the correction is uncertain.
/// `None` without a neighbour.
fn back(
    (growth, std): (f64, f64),
    own: At,
    below: Option<At>,
    above: Option<At>,
) -> Option<(Complex64, f64)> {
    let logarithmic = |of: &dyn Fn(Complex64) -> Complex64| {
        let toward = |other: At| (of(other.1) - of(own.1)) / (other.0 - own.0) / of(own.1);
        match (below, above) {
            (Some(a), Some(b)) => {
                let (left, right) = (toward(a), toward(b));
                let slope = (left * (b.0 - own.0) + right * (own.0 - a.0)) / (b.0 - a.0);
                Some((slope, 0.5 * (left - right).norm()))
            }
            (Some(one), None) | (None, Some(one)) => Some((toward(one), toward(one).norm())),
            (None, None) => None,
        }
    };
    // d/ds = −i d/dω.
    let turn = Complex64::new(0.0, -growth);
    let (direct, bend) = logarithmic(&|h| h)?;
    let (inverse, inverse_bend) = logarithmic(&|h| h.inv())?;
    let factor = if inverse_bend < bend { (1.0 - turn * inverse).inv() } else { 1.0 - turn * direct };
    let (slope, bend) = if inverse_bend < bend { (inverse, inverse_bend) } else { (direct, bend) };
    let unsure = (growth * bend).hypot(std * slope.norm());
    (factor.is_finite() && unsure.is_finite()).then_some((factor, unsure))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Receptance of two modes at s, in closed form.
    fn receptance(s: Complex64) -> Complex64 {
        let mode = |f: f64, zeta: f64, part: f64| {
            let w = TAU * f;
            part / (s * s + 2.0 * zeta * w * s + w * w)
        };
        mode(34.4, 0.008, 1.0) + mode(76.6, 0.042, 1.0)
    }

    #[test]
    fn the_response_to_a_growing_force_is_taken_back() {
        let growth = 0.01;
        let at = |f: f64| (TAU * f, receptance(Complex64::new(growth, TAU * f)));
        for f in [20.0, 30.0, 34.2, 34.4, 34.6, 50.0, 57.5, 76.0, 90.0] {
            let truth = receptance(Complex64::new(0.0, TAU * f));
            let (factor, unsure) = back((growth, 0.0), at(f), Some(at(f - 0.4)), Some(at(f + 0.4))).unwrap();
            let (before, after) = ((at(f).1 / truth - 1.0).norm(), (at(f).1 * factor / truth - 1.0).norm());
            // The remaining error is within the uncertainty, and below 2 % of the uncorrected error or 10⁻⁶
            // (ε²/hω).
            assert!(
                after < 2.0 * unsure + 1e-6 && after < 0.02 * before + 1e-6,
                "{f}: {before} {after} {unsure}"
            );
        }
        let (_, unsure) = back((growth, 0.0), at(30.0), None, Some(at(30.4))).unwrap();
        assert!(unsure > 0.5 * (at(30.0).1 / receptance(Complex64::new(0.0, TAU * 30.0)) - 1.0).norm());
        assert_eq!(back((growth, 0.0), at(30.0), None, None), None);
    }

    #[test]
    fn the_growth_of_blocks_is_that_of_their_logarithms() {
        let of = |rate: f64, noise: f64| {
            let size = |k: i32| (rate * 0.1 * f64::from(k)).exp() + noise * (f64::from(k * k) * 0.7).sin();
            growth(&(0..40).map(|k| size(k).into()).collect::<Vec<Complex64>>(), 0.1)
        };
        assert!((of(-5e-3, 0.0).0 + 5e-3).abs() < 1e-12);
        // The slope over 4 s of noise of 10⁻⁴, whose root mean square is 0.7·10⁻⁴, is 0.7·10⁻⁴ √(12/40)/4 =
        // 10⁻⁵.
        let (still, std) = of(0.0, 1e-4);
        assert!((of(5e-3, 1e-4).0 - 5e-3).abs() < 4e-5 && still.abs() < 4e-5, "{still}");
        assert!(std > 0.7e-5 && std < 1.4e-5, "{std}");
    }
}

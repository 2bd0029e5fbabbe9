//! When the force of a blow acts: its centre, and its variance over time.

use super::{Blow, Blows, TRIGGER};
use std::f64::consts::TAU;
use vibro_record::Trace;

/// Delay in samples from the trigger of a blow to the centre of its force, with the ringing of filters within
/// four contact times.
///
/// With the transform F(s) of the force, a mode of pole s that rings at the end T of the record lacks e^((s −
/// iω)T) F(s)/F(iω) of its transform. Near the mode F(s)/F(iω) is e^((iω − s)c), where c is that centre: the
/// record ends T − c after an impulse.
pub(super) fn delay(force: &Trace, blow: &Blow, how: &Blows) -> f64 {
    let part = &force.values[blow.start..blow.start + how.length];
    let quiet = how.before / 2;
    let level = part[..quiet].iter().sum::<f64>() / quiet.max(1) as f64;
    let share = |v: &f64| (v - level) / blow.peak;
    let contact = part[how.before..].iter().take_while(|v| share(v) > TRIGGER).count();
    let from = how.before.saturating_sub(4 * contact).max(quiet);
    let around = &part[from..(how.before + 5 * contact).min(how.length)];
    let [moment, sum] = around.iter().enumerate().fold([0.0, 0.0], |[moment, sum], (i, v)| {
        [moment + ((from + i) as f64 - how.before as f64) * share(v), sum + share(v)]
    });
    if sum > 0.0 { moment / sum } else { 0.0 }
}

/// Fraction of the power of the force at the lowest line, down to which lines show its variance over time.
/// Above it the second cumulant alone describes a blow, and an anti-alias filter does not count.
const FLAT: f64 = 0.8;

/// Variance in s² of the force of a blow over time, from the mean powers of its lines `step` Hz apart: the
/// second cumulant v of ln |F(ω)|² = a − vω².
pub(super) fn variance(power: &[f64], step: f64) -> f64 {
    let lines = power.iter().skip(1).take_while(|p| **p > FLAT * power[1]).count().max(3);
    let points = power.iter().enumerate().skip(1).take(lines);
    let points: Vec<(f64, f64)> = points.map(|(k, p)| ((TAU * step * k as f64).powi(2), p.ln())).collect();
    let n = points.len() as f64;
    let [x, y] = points.iter().fold([0.0; 2], |[x, y], p| [x + p.0 / n, y + p.1 / n]);
    let [xx, xy] =
        points.iter().fold([0.0; 2], |[xx, xy], p| [xx + (p.0 - x) * (p.0 - x), xy + (p.0 - x) * (p.1 - y)]);
    (-xy / xx).max(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    /// Powers of lines 10 Hz apart, for the transform of a force over the angular frequency.
    fn powers(transform: impl Fn(f64) -> f64) -> Vec<f64> {
        (0..400).map(|k| transform(TAU * 10.0 * f64::from(k)).powi(2)).collect()
    }

    /// |F|² of a bell curve of variance v is exp(−vω²).
    #[test]
    fn the_variance_of_a_bell_curve_is_exact() {
        let truth = 4e-4f64.powi(2);
        let found = variance(&powers(|omega| 3.0 * (-0.5 * truth * omega * omega).exp()), 10.0);
        assert!((found / truth - 1.0).abs() < 1e-9, "{found} {truth}");
        // A force that is alike on all lines is an impulse, and noise makes no variance negative.
        assert_eq!([variance(&[1.0; 9], 10.0), variance(&[1.0, 1.0, 1.1, 1.2, 1.3], 10.0)], [0.0; 2]);
    }

    /// A half sine of duration d has the transform cos(ωd/2)/(1 − (ωd/π)²), and the variance d²(¼ − 2/π²).
    #[test]
    fn the_variance_of_a_half_sine_is_that_of_its_curve() {
        let duration = 1e-3;
        let found = variance(
            &powers(|omega| (0.5 * omega * duration).cos() / (1.0 - (omega * duration / PI).powi(2))),
            10.0,
        );
        let truth = duration * duration * (0.25 - 2.0 / (PI * PI));
        // The fourth cumulant, −0.81 v², changes ln |F|² by 0.81 vω²/12 of vω² itself: by 1.5 % where the
        // power has fallen to 0.8.
        assert!((found / truth - 1.0).abs() < 0.02, "{found} {truth}");
    }
}

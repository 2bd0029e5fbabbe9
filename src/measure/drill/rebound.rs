//! Restitution from the speeds of impacts, where they allow one.

use super::summary::mean_of;
use super::{DrillOptions, Impact, Running};
use crate::measure::Estimate;

/// The approach of most impacts must be this many times its uncertainty,
const CLEAR: f64 = 6.0;
/// and its mean this many times its scatter from impact to impact: a quotient by what may be 0 has no mean.
const STEADY: f64 = 3.0;
/// Standard uncertainties beyond which a restitution above 1 is no chance.
const BEYOND: f64 = 2.0;

/// R = (v₂⁺ − v₁⁺)/v₁⁻ with v₂⁺ = m₁(v₁⁻ − v₁⁺)/m₂ from the balance of momentum, the struck mass at rest before (W. J. Stronge,
/// Impact Mechanics, 2000, section 2.4); without a struck mass v₂⁺ = 0. In its place a sentence where the approach
/// cannot be told from 0, or more comes back than arrived.
pub(super) fn restitution(impacts: &[Impact], options: &DrillOptions) -> Result<Option<Estimate>, String> {
    let mut approach = Running::default();
    for impact in impacts {
        approach.push(impact.before);
    }
    let unclear = impacts.iter().filter(|i| i.before.abs() < CLEAR * i.before_std).count();
    if !impacts.is_empty() && (2 * unclear > impacts.len() || approach.mean().abs() < STEADY * approach.std())
    {
        return Err(format!(
            "No restitution: the speed before the impacts, {:.3} m/s with a scatter of {:.3} m/s, cannot be told from 0; what is measured here does not strike but is struck.",
            approach.mean(),
            approach.std()
        ));
    }
    let ratio = options.mass.zip(options.struck_mass).map(|(m, struck)| m / struck);
    let method = if ratio.is_some() {
        "balance of momentum, the struck mass at rest before"
    } else {
        "−after/before, which assumes that the struck mass does not move"
    };
    let ratio = ratio.unwrap_or(0.0);
    let found = mean_of(impacts, "1", method, |i| (ratio * (i.before - i.after) - i.after) / i.before);
    match found {
        Some(e) if e.value - BEYOND * e.std.unwrap_or(0.0) > 1.0 => Err(format!(
            "No restitution: {:.3} would be above 1, more than its uncertainty explains: check masses, direction of the beam, and what is struck.",
            e.value
        )),
        found => Ok(found),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measure::drill::{Beam, Edge, From};

    fn options(masses: Option<(f64, f64)>) -> DrillOptions {
        let plain = DrillOptions::new(1.0, Beam::new(0.0, From::Axis).unwrap(), 1, Edge::Rising);
        DrillOptions { mass: masses.map(|m| m.0), struck_mass: masses.map(|m| m.1), ..plain }
    }

    /// Twenty impacts whose speeds scatter by a hundredth.
    fn impacts(before: f64, after: f64, std: f64) -> Vec<Impact> {
        let speed = |v: f64, k: usize| v + 0.01 * ((k * 7 % 20) as f64 / 19.0 - 0.5);
        (0..20)
            .map(|k| Impact {
                cycle: k,
                time: k as f64,
                phase: 0.5,
                phase_std: 1e-3,
                before: speed(before, k),
                before_std: std,
                after: speed(after, k * k),
                after_std: std,
                clipped: false,
            })
            .collect()
    }

    #[test]
    fn what_strikes_has_a_restitution_and_what_is_struck_has_none() {
        // 0.1 kg at 5 m/s on 0.3 kg: they part at 0.4 · 5 m/s; momentum leaves −0.25 and 1.75 m/s.
        let found = restitution(&impacts(5.0, -0.25, 0.02), &options(Some((0.1, 0.3)))).unwrap().unwrap();
        // Scatter of 0.003 a speed over 20 impacts; four times that.
        assert!((found.value - 0.4).abs() < 4.0 * 0.003 / 20f64.sqrt(), "{found:?}");
        let why = |i: &[Impact], o| restitution(i, &o).unwrap_err();
        assert!(why(&impacts(0.01, 2.7, 0.02), options(None)).contains("cannot be told from 0"));
        assert!(why(&impacts(5.0, -5.5, 0.02), options(None)).contains("1.100 would be above 1"));
        assert!(restitution(&[], &options(None)).unwrap().is_none());
    }
}

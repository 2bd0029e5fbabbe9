//! Restitution from the speeds of impacts, where they allow one.

use super::{DrillOptions, Impact, Running};
use crate::measure::Estimate;
use crate::measure::mean::Mean;
use crate::units::notation::quantity;

/// The approach of most impacts must be this many times its uncertainty,
const CLEAR: f64 = 6.0;
/// and its mean this many times its scatter from impact to impact: a quotient by what may be 0 has no mean.
const STEADY: f64 = 3.0;
/// Standard uncertainties beyond which a restitution above 1 is no chance.
const BEYOND: f64 = 2.0;
/// Relative uncertainty of the mean approach speed up to which a ratio has a standard uncertainty: 1.96² times its square is
/// Fieller's g, 0.04, and what propagation neglects is of that order (E. Fieller, J. R. Stat. Soc. B 16 (1954) 175).
const KNOWN: f64 = 0.1;

/// R = Σ(v₂⁺ − v₁⁺)/Σv₁⁻ with v₂⁺ = m₁(v₁⁻ − v₁⁺)/m₂ from the balance of momentum, the struck mass at rest before (W. J. Stronge,
/// Impact Mechanics, 2000, section 2.4); without a struck mass, or away from it (not `front`), v₂⁺ = 0. The mean of the quotients
/// would weigh slow impacts most. The uncertainty is that of the mean of (v₂⁺ − v₁⁺ − R v₁⁻)/mean(v₁⁻), which is the propagated one
/// (delta method). In its place a sentence where the approach cannot be told from 0, or more comes back than arrived.
pub(super) fn restitution(
    impacts: &[Impact],
    front: bool,
    options: &DrillOptions,
) -> Result<Option<Estimate>, String> {
    let mut approach = Running::default();
    for impact in impacts {
        approach.push(impact.before);
    }
    let unclear = impacts.iter().filter(|i| i.before.abs() < CLEAR * i.before_std).count();
    if !impacts.is_empty() && (2 * unclear > impacts.len() || approach.mean().abs() < STEADY * approach.std())
    {
        return Err(format!(
            "No restitution: the speed before the impacts, {} with a scatter of {}, cannot be told from 0; what is measured here does not strike but is struck.",
            quantity(approach.mean(), "m/s", 2),
            quantity(approach.std(), "m/s", 2)
        ));
    }
    let known = options.mass.zip(options.struck_mass).map(|(m, struck)| m / struck);
    let mut method = match known {
        Some(_) if front => "balance of momentum, the struck mass at rest before",
        Some(_) => "−after/before: away from the struck mass, what is struck is taken not to move",
        None => "−after/before, which assumes that the struck mass does not move",
    }
    .to_owned();
    method.push_str("; ratio of the sums over impacts");
    let ratio = known.filter(|_| front).unwrap_or(0.0);
    let separation: Vec<f64> = impacts.iter().map(|i| ratio * (i.before - i.after) - i.after).collect();
    let approach = Mean::of(&impacts.iter().map(|i| i.before).collect::<Vec<f64>>());
    let value = Mean::of(&separation).value / approach.value;
    let off = impacts.iter().zip(&separation).map(|(i, s)| (s - value * i.before) / approach.value);
    let std = Mean::of(&off.collect::<Vec<f64>>()).std;
    let clear = approach.std.is_some_and(|s| s < KNOWN * approach.value.abs());
    if !clear && approach.std.is_some() {
        method.push_str("; no uncertainty: the mean speed of approach is not known within a tenth");
    }
    let found =
        value.is_finite().then(|| Estimate::new(value, std.filter(|_| clear), "1", impacts.len(), method));
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
                group: 0,
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
        let found =
            restitution(&impacts(5.0, -0.25, 0.02), true, &options(Some((0.1, 0.3)))).unwrap().unwrap();
        // Scatter of 0.003 a speed over 20 impacts; four times that.
        assert!((found.value - 0.4).abs() < 4.0 * 0.003 / 20f64.sqrt(), "{found:?}");
        let why = |i: &[Impact], o| restitution(i, true, &o).unwrap_err();
        assert!(why(&impacts(0.01, 2.7, 0.02), options(None)).contains("cannot be told from 0"));
        assert!(why(&impacts(5.0, -5.5, 0.02), options(None)).contains("1.100 would be above 1"));
        assert!(restitution(&[], true, &options(None)).unwrap().is_none());
    }
}

//! Restitution from the speeds of impacts, where they allow one.

use super::{DrillOptions, Impact, Running};
use crate::Estimate;
use crate::mean::Mean;
use vibro_record::Finding;

/// A velocity of approach is known from 0 by this many times its uncertainty.
const CLEAR: f64 = 6.0;
/// The mean velocity of approach must be this many times its own uncertainty.
const MEAN_CLEAR: f64 = 3.0;
/// Standard uncertainties beyond which a restitution outside 0 to 1 is no chance.
const BEYOND: f64 = 2.0;
/// Relative uncertainty of the mean approach speed up to which a ratio has a standard uncertainty: 1.96² times its square is
/// Fieller's g, 0.04, and what propagation neglects is of that order (E. Fieller, J. R. Stat. Soc. B 16 (1954) 175).
const KNOWN: f64 = 0.1;

/// R = Σ(v₂⁺ − v₁⁺)/Σv₁⁻ with v₂⁺ = m₁(v₁⁻ − v₁⁺)/m₂ from the balance of momentum, the struck mass at rest before (W. J. Stronge,
/// Impact Mechanics, 2000, section 2.4); without a struck mass, or away from it (not `front`), v₂⁺ = 0. The mean of the quotients
/// would weigh slow impacts most. The uncertainty is that of the mean of (v₂⁺ − v₁⁺ − R v₁⁻)/mean(v₁⁻), which is the propagated one
/// (delta method).
///
/// There is none where the approach is consistent with 0, as that of a bit, which is struck; nor where it would be negative or above
/// 1 by more than its uncertainty explains. Without an uncertainty nothing is explained, and a value above 1 stays.
pub(super) fn restitution(
    impacts: &[Impact],
    front: bool,
    options: &DrillOptions,
) -> (Option<Estimate>, Option<Finding>) {
    let mut approach = Running::default();
    for impact in impacts {
        approach.push(impact.before);
    }
    let unclear = impacts.iter().filter(|i| i.before.abs() < CLEAR * i.before_std).count();
    if 2 * unclear > impacts.len() {
        let found = Finding::caution("drill-not-striking");
        return (None, Some(found.number("speed", approach.mean()).number("scatter", approach.std())));
    }
    let mean = Mean::of(&impacts.iter().map(|i| i.before).collect::<Vec<f64>>());
    // Below four values the mean states no uncertainty; that of independent ones is a lower limit.
    let std = mean.std.unwrap_or(0.0).max(approach.std() / (impacts.len() as f64).sqrt());
    if mean.value.abs() < MEAN_CLEAR * std {
        let found = Finding::caution("drill-approach-unclear");
        return (None, Some(found.number("speed", mean.value).number("std", std)));
    }
    let masses = options.mass.zip(options.struck_mass);
    let method = match masses {
        Some(_) if front => {
            "balance of momentum, the struck mass at rest before; ratio of the sums over impacts"
        }
        Some(_) => {
            "−after/before, away from the struck mass: what is struck does not move; ratio of the sums over impacts"
        }
        None => "−after/before, the struck mass does not move; ratio of the sums over impacts",
    };
    let ratio = masses.filter(|_| front).map_or(0.0, |(m, struck)| m / struck);
    let separation: Vec<f64> = impacts.iter().map(|i| ratio * (i.before - i.after) - i.after).collect();
    let value = Mean::of(&separation).value / mean.value;
    if !value.is_finite() {
        return (None, None);
    }
    let off = impacts.iter().zip(&separation).map(|(i, s)| (s - value * i.before) / mean.value);
    let std = Mean::of(&off.collect::<Vec<f64>>()).std;
    let loose = mean.std.is_some_and(|s| s >= KNOWN * mean.value.abs());
    let estimate = |std| Some(Estimate::new(value, std, "1", impacts.len(), method));
    match std.filter(|_| !loose) {
        Some(std) if value - BEYOND * std > 1.0 || value + BEYOND * std < 0.0 => (
            None,
            Some(Finding::doubt("drill-restitution-impossible").number("value", value).number("std", std)),
        ),
        None if loose => (estimate(None), Some(Finding::doubt("drill-approach-loose"))),
        std => (estimate(std), None),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::drill::{Beam, Edge, From};

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
        let found = restitution(&impacts(5.0, -0.25, 0.02), true, &options(Some((0.1, 0.3)))).0.unwrap();
        // Scatter of 0.003 a speed over 20 impacts; four times that.
        assert!((found.value - 0.4).abs() < 4.0 * 0.003 / 20f64.sqrt(), "{found:?}");
        let why = |i: &[Impact], o| {
            let (found, why) = restitution(i, true, &o);
            assert_eq!(found, None);
            why.unwrap()
        };
        assert_eq!(why(&impacts(0.01, 2.7, 0.02), options(None)).code, "drill-not-striking");
        for after in [-5.5, 2.5] {
            let why = why(&impacts(5.0, after, 0.02), options(None));
            assert_eq!(why.code, "drill-restitution-impossible");
            assert!((why.get("value").unwrap() + after / 5.0).abs() < 1e-3, "{why:?}");
        }
    }

    #[test]
    fn what_has_no_uncertainty_explains_nothing() {
        // Three impacts have no uncertainty: that 1.1 is above 1 is not beyond it.
        let (found, why) = restitution(&impacts(5.0, -5.5, 0.02)[..3], true, &options(None));
        let found = found.unwrap();
        assert!((found.value - 1.1).abs() < 0.01 && found.std.is_none() && why.is_none(), "{found:?}");
    }

    #[test]
    fn a_striker_whose_speed_varies_by_half_still_strikes() {
        // Speeds from 1.1 to 9 m/s in no order, each sent back with 0.3 of it, mean 5 m/s: the sum of twenty is known to 11 %, the
        // quotient is the same in all.
        let mut all = impacts(5.0, -1.5, 0.02);
        for (k, impact) in all.iter_mut().enumerate() {
            impact.before = 1.1 + 7.9 * ((k * 7) % 20) as f64 / 19.0;
            impact.after = -0.3 * impact.before;
        }
        let (found, why) = restitution(&all, true, &options(None));
        assert!((found.as_ref().unwrap().value - 0.3).abs() < 1e-12, "{found:?} {why:?}");
        assert!(why.is_none_or(|w| w.code == "drill-approach-loose"));
        // About 0 the sum says nothing, however well each speed is known.
        for impact in &mut all {
            impact.before -= 5.0;
        }
        let (found, why) = restitution(&all, true, &options(None));
        assert!(found.is_none());
        assert_eq!(why.unwrap().code, "drill-approach-unclear");
    }
}

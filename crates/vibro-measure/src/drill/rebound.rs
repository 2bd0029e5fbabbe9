//! Restitution from the speeds of impacts, where they allow one.

use super::{DrillOptions, Impact, Running};
use crate::Estimate;
use crate::mean::Mean;
use vibro_record::units::notation::quantity;

/// The approach of most impacts must be this many times its uncertainty,
const CLEAR: f64 = 6.0;
/// and its mean this many times its own.
const TOLD: f64 = 3.0;
/// Standard uncertainties beyond which a restitution above 1 is no chance.
const BEYOND: f64 = 2.0;
/// Relative uncertainty of the mean approach speed up to which a ratio has a standard uncertainty: 1.96² times its square is
/// Fieller's g, 0.04, and what propagation neglects is of that order (E. Fieller, J. R. Stat. Soc. B 16 (1954) 175).
const KNOWN: f64 = 0.1;

/// What there is to say of a restitution.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Doubt {
    /// None: the velocity before most impacts, with this mean and scatter in m/s, is not told from 0.
    Struck(f64, f64),
    /// None: the mean velocity before the impacts, with this uncertainty in m/s, is not told from 0.
    Mean(f64, f64),
    /// None: it would have this value, too far above 1 for its standard uncertainty.
    AboveOne(f64, f64),
    /// A value without an uncertainty: the mean speed of approach is not known within a tenth.
    Loose,
}

impl Doubt {
    /// The sentence; `of` names the group, with a blank before it.
    pub fn sentence(self, of: &str) -> String {
        let speed = |v: f64| quantity(v, "m/s", 2);
        match self {
            Doubt::Struck(mean, scatter) => format!(
                "No restitution{of}: the speed before the impacts, {} with a scatter of {}, cannot be told from 0 in most of them; what is measured here does not strike but is struck.",
                speed(mean),
                speed(scatter)
            ),
            Doubt::Mean(mean, std) => format!(
                "No restitution{of}: the mean speed before the impacts, {} with a standard uncertainty of {}, cannot be told from 0.",
                speed(mean),
                speed(std)
            ),
            Doubt::AboveOne(value, std) => format!(
                "No restitution{of}: {value:.3} would be above 1, more than its standard uncertainty of {std:.3} explains: check masses, direction of the beam, and what is struck."
            ),
            Doubt::Loose => format!(
                "The mean speed of approach of the impacts{of} is not known within a tenth: the restitution has no uncertainty."
            ),
        }
    }
}

/// R = Σ(v₂⁺ − v₁⁺)/Σv₁⁻ with v₂⁺ = m₁(v₁⁻ − v₁⁺)/m₂ from the balance of momentum, the struck mass at rest before (W. J. Stronge,
/// Impact Mechanics, 2000, section 2.4); without a struck mass, or away from it (not `front`), v₂⁺ = 0. The mean of the quotients
/// would weigh slow impacts most. The uncertainty is that of the mean of (v₂⁺ − v₁⁺ − R v₁⁻)/mean(v₁⁻), which is the propagated one
/// (delta method). There is none where the approach cannot be told from 0, or more comes back than arrived by more than the
/// uncertainty explains; without an uncertainty nothing is explained, and the value stays.
pub(super) fn restitution(
    impacts: &[Impact],
    front: bool,
    options: &DrillOptions,
) -> (Option<Estimate>, Option<Doubt>) {
    if impacts.is_empty() {
        return (None, None);
    }
    let mut speeds = Running::default();
    for impact in impacts {
        speeds.push(impact.before);
    }
    let unclear = impacts.iter().filter(|i| i.before.abs() < CLEAR * i.before_std).count();
    if 2 * unclear > impacts.len() {
        return (None, Some(Doubt::Struck(speeds.mean(), speeds.std())));
    }
    let approach = Mean::of(&impacts.iter().map(|i| i.before).collect::<Vec<f64>>());
    // Below four values the mean states no uncertainty; that of independent ones is a lower limit.
    let told = approach.std.unwrap_or(0.0).max(speeds.std() / (impacts.len() as f64).sqrt());
    if approach.value.abs() < TOLD * told {
        return (None, Some(Doubt::Mean(approach.value, told)));
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
    let value = Mean::of(&separation).value / approach.value;
    if !value.is_finite() {
        return (None, None);
    }
    let off = impacts.iter().zip(&separation).map(|(i, s)| (s - value * i.before) / approach.value);
    let std = Mean::of(&off.collect::<Vec<f64>>()).std;
    let loose = approach.std.is_some_and(|s| s >= KNOWN * approach.value.abs());
    if loose {
        method.push_str("; no uncertainty: the mean speed of approach is not known within a tenth");
    }
    match std.filter(|_| !loose) {
        Some(std) if value - BEYOND * std > 1.0 => (None, Some(Doubt::AboveOne(value, std))),
        std => (Some(Estimate::new(value, std, "1", impacts.len(), method)), loose.then_some(Doubt::Loose)),
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
            why.unwrap().sentence(" of group 3")
        };
        assert!(why(&impacts(0.01, 2.7, 0.02), options(None)).contains("cannot be told from 0"));
        assert!(why(&impacts(5.0, -5.5, 0.02), options(None)).contains("1.100 would be above 1"));
        assert!(why(&impacts(5.0, -5.5, 0.02), options(None)).starts_with("No restitution of group 3:"));
        assert_eq!(restitution(&[], true, &options(None)), (None, None));
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
        assert!(matches!(why, None | Some(Doubt::Loose)), "{why:?}");
        // About 0 the sum says nothing, however well each speed is known.
        for impact in &mut all {
            impact.before -= 5.0;
        }
        let (found, why) = restitution(&all, true, &options(None));
        assert!(found.is_none() && matches!(why, Some(Doubt::Mean(..))), "{why:?}");
        assert!(!why.unwrap().sentence("").contains("is struck"));
    }
}

//! Restitution from velocities before and after: R = (v₂⁺ − v₁⁺)/(v₁⁻ − v₂⁻), with the momentum balance where masses are known.

use super::{Shares, Way, above_zero, not_negative};
use crate::Estimate;
use vibro_record::units::notation::quantity;
use vibro_record::{Error, Result};

/// Velocities of both masses along one axis, in m/s.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Velocities {
    /// Before the impact: mass 1 and 2.
    pub before: (f64, f64),
    /// Of mass 1 after the impact.
    pub after1: Option<f64>,
    /// Of mass 2 after the impact.
    pub after2: Option<f64>,
    /// Masses in kg.
    pub masses: Option<(f64, f64)>,
    /// Standard uncertainty of each velocity.
    pub std: Option<f64>,
}

impl Velocities {
    pub(super) fn answers(&self, warnings: &mut Vec<String>) -> Result<Vec<Way>> {
        let (v1, v2) = self.before;
        not_negative("an uncertainty of the velocities", self.std)?;
        let all = [Some(v1), Some(v2), self.after1, self.after2];
        if let Some(bad) = all.into_iter().flatten().find(|v| !v.is_finite()) {
            return Err(Error::usage(format!("a velocity of {bad} m/s"), "finite numbers"));
        }
        let approach = v1 - v2;
        if approach <= 0.0 {
            return Err(Error::refused(format!(
                "before the impact mass 1 has {v1} m/s and mass 2 {v2} m/s: they do not approach"
            ))
            .hint("mass 1 is the one behind: velocities count positive from mass 1 to mass 2"));
        }
        let ratio = match self.masses {
            Some((m1, m2)) => {
                above_zero("a mass", m1)?;
                above_zero("a mass", m2)?;
                Some(m1 / m2)
            }
            None => None,
        };
        // R = s/(v₁ − v₂) with s linear in v₁, v₂, v₁⁺, v₂⁺, whose coefficients are given.
        let mut given: Vec<(&'static str, [f64; 4], &str)> = Vec::new();
        if let (Some(w1), Some(w2)) = (self.after1, self.after2) {
            given.push(("velocities of both masses", [0.0, 0.0, -1.0, 1.0], "(v₂⁺ − v₁⁺)/(v₁⁻ − v₂⁻)"));
            if let Some((m1, m2)) = self.masses {
                let lost = m1 * (v1 - w1) + m2 * (v2 - w2);
                let u = self.std.map_or(f64::NAN, |u| u * (2.0 * (m1 * m1 + m2 * m2)).sqrt());
                if lost.abs() > 2.0 * u {
                    warnings.push(format!("Momentum changes by {}, more than twice its uncertainty of {}: velocities, masses or a third body.", quantity(lost, "N s", 3), quantity(u, "N s", 2)));
                }
            }
        }
        if let (Some(_), Some(q)) = (self.after1, ratio) {
            // v₂⁺ = v₂ + q(v₁ − v₁⁺).
            given.push((
                "velocity of mass 1 and momentum",
                [q, 1.0, -1.0 - q, 0.0],
                "v₂⁺ from the momentum balance",
            ));
        }
        if let (Some(_), Some(q)) = (self.after2, ratio) {
            // v₁⁺ = v₁ + (v₂ − v₂⁺)/q.
            given.push((
                "velocity of mass 2 and momentum",
                [-1.0, -1.0 / q, 0.0, 1.0 + 1.0 / q],
                "v₁⁺ from the momentum balance",
            ));
        }
        let n = if self.after1.is_some() && self.after2.is_some() { 4 } else { 3 };
        let known = [v1, v2, self.after1.unwrap_or(0.0), self.after2.unwrap_or(0.0)];
        let (mut ways, mut refused) = (Vec::new(), None);
        for (method, by, how) in given {
            let r = by.iter().zip(known).map(|(b, v)| b * v).sum::<f64>() / approach;
            let slopes = [by[0] - r, by[1] + r, by[2], by[3]].map(|d| d / approach);
            let std = self.std.map(|u| u * slopes.iter().map(|d| d * d).sum::<f64>().sqrt());
            let outside = (-r).max(r - 1.0);
            // Roundings of equal numbers are no velocity.
            if outside > std.map_or(0.0, |u| 2.0 * u).max(1e-12) {
                let why = format!("velocities give R = {r:.4} ({how}): outside 0 to 1");
                warnings.push(format!("The {method} is left out: {why}."));
                refused = refused.or(Some(why));
                continue;
            }
            if outside > 1e-12 {
                warnings.push(format!(
                    "The {method} gives R = {r:.4}, outside 0 to 1 by less than twice its uncertainty."
                ));
            }
            let shares = Shares::Velocities(slopes.map(|d| d * self.std.unwrap_or(f64::NAN)));
            ways.push(Way { method, restitution: Estimate::new(r, std, "1", n, how), shares });
        }
        match (ways.is_empty(), refused) {
            (false, _) => Ok(ways),
            (true, Some(why)) => Err(Error::refused(why).hint(
                "are all velocities counted in one direction, and the masses in the order of the velocities?",
            )),
            (true, None) => Err(Error::usage(
                "velocities of one mass without masses",
                "both velocities after the impact, or --masses M1,M2",
            )),
        }
    }
}

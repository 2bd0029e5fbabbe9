//! Restitution from velocities before and after: R = (v₂⁺ − v₁⁺)/(v₁⁻ − v₂⁻), with the momentum balance where
//! masses are known.

use super::{MethodAnswer, above_zero, not_negative};
use crate::Estimate;
use vibro_record::{Error, Result};

/// Velocities of both masses along one axis, in m/s.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Velocities {
    /// Before the impact: mass 1 and 2.
    pub before: (f64, f64),
    /// Velocity of mass 1 after the impact.
    pub after1: Option<f64>,
    /// Velocity of mass 2 after the impact.
    pub after2: Option<f64>,
    /// Masses in kg.
    pub masses: Option<(f64, f64)>,
    /// Standard uncertainty of each velocity in m/s.
    pub std: Option<f64>,
}

impl Velocities {
    /// Answers by each method that the velocities allow. Momentum that is not conserved makes them disagree.
    pub(super) fn answers(&self) -> Result<Vec<MethodAnswer>> {
        let (v1, v2) = self.before;
        not_negative("an uncertainty of the velocities", self.std)?;
        let all = [Some(v1), Some(v2), self.after1, self.after2];
        if let Some(bad) = all.into_iter().flatten().find(|v| !v.is_finite()) {
            return Err(Error::usage(format!("a velocity of {bad} m/s"), "finite numbers"));
        }
        let approach = v1 - v2;
        if approach <= 0.0 {
            let why =
                format!("before the impact mass 1 has {v1} m/s and mass 2 {v2} m/s: they do not approach");
            let hint = "mass 1 behind mass 2, velocities positive from mass 1 to mass 2";
            return Err(Error::refused(why).hint(hint));
        }
        if let Some((m1, m2)) = self.masses {
            above_zero("a mass", m1)?;
            above_zero("a mass", m2)?;
        }
        let q = self.masses.map(|(m1, m2)| m1 / m2);
        // R = s/(v₁ − v₂) with s linear in v₁, v₂, v₁⁺, v₂⁺, whose coefficients are given. By momentum v₂⁺ =
        // v₂ + q(v₁ − v₁⁺) or v₁⁺ = v₁ + (v₂ − v₂⁺)/q.
        let both = self.after1.and(self.after2).map(|_| [0.0, 0.0, -1.0, 1.0]);
        let by1 = self.after1.and(q).map(|q| [q, 1.0, -1.0 - q, 0.0]);
        let by2 = self.after2.and(q).map(|q| [-1.0, -1.0 / q, 0.0, 1.0 + 1.0 / q]);
        let given = [
            ("velocities of both masses", both, "(v₂⁺ − v₁⁺)/(v₁⁻ − v₂⁻)"),
            ("velocity of mass 1 and momentum", by1, "v₂⁺ from the momentum balance"),
            ("velocity of mass 2 and momentum", by2, "v₁⁺ from the momentum balance"),
        ];
        let known = all.map(|v| v.unwrap_or(0.0));
        let mut ways = Vec::new();
        for (method, by, how) in given {
            let Some(by) = by else { continue };
            let r = by.iter().zip(known).map(|(b, v)| b * v).sum::<f64>() / approach;
            let slopes = [by[0] - r, by[1] + r, by[2], by[3]].map(|d| d / approach);
            let std = self.std.map(|u| u * slopes.iter().map(|d| d * d).sum::<f64>().sqrt());
            // R beyond 0 to 1 by more than twice its uncertainty is refused, but not for the rounding of
            // equal numbers.
            if (-r).max(r - 1.0) > std.map_or(0.0, |u| 2.0 * u).max(1e-12) {
                let why = format!("R = {r:.4} by the {method}: outside 0 to 1");
                let hint =
                    "all velocities positive in one direction, and the masses in the order of the velocities";
                return Err(Error::refused(why).hint(hint));
            }
            let restitution = Estimate::new(r, std, "1", all.iter().flatten().count(), how);
            ways.push(MethodAnswer { method, restitution });
        }
        if ways.is_empty() {
            let expected = "both velocities after the impact, or masses";
            let error = Error::usage("velocities of one mass without masses", expected);
            return Err(error.hint("state what is missing").setting("after").setting("masses"));
        }
        Ok(ways)
    }
}

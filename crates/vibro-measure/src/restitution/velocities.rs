//! Restitution from velocities before and after: R = (v₂⁺ − v₁⁺)/(v₁⁻ − v₂⁻), with the momentum balance where masses are known.

use super::{Method, Shares, Way, above_zero, not_negative};
use crate::Estimate;
use vibro_record::{Error, Finding, Result};

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
    /// Answers by each method that the velocities allow. Momentum that is not conserved makes them disagree.
    pub(super) fn answers(&self, findings: &mut Vec<Finding>) -> Result<Vec<Way>> {
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
            .hint("mass 1 behind mass 2, velocities positive from mass 1 to mass 2"));
        }
        if let Some((m1, m2)) = self.masses {
            above_zero("a mass", m1)?;
            above_zero("a mass", m2)?;
        }
        let ratio = self.masses.map(|(m1, m2)| m1 / m2);
        // R = s/(v₁ − v₂) with s linear in v₁, v₂, v₁⁺, v₂⁺, whose coefficients are given.
        let mut given: Vec<(Method, [f64; 4], &str)> = Vec::new();
        if self.after1.is_some() && self.after2.is_some() {
            given.push((Method::BothVelocities, [0.0, 0.0, -1.0, 1.0], "(v₂⁺ − v₁⁺)/(v₁⁻ − v₂⁻)"));
        }
        if let (Some(_), Some(q)) = (self.after1, ratio) {
            // v₂⁺ = v₂ + q(v₁ − v₁⁺).
            given.push((Method::Velocity1, [q, 1.0, -1.0 - q, 0.0], "v₂⁺ from the momentum balance"));
        }
        if let (Some(_), Some(q)) = (self.after2, ratio) {
            // v₁⁺ = v₁ + (v₂ − v₂⁺)/q.
            let by = [-1.0, -1.0 / q, 0.0, 1.0 + 1.0 / q];
            given.push((Method::Velocity2, by, "v₁⁺ from the momentum balance"));
        }
        if given.is_empty() {
            return Err(Error::usage(
                "velocities of one mass without masses",
                "both velocities after the impact, or masses",
            )
            .hint("state what is missing")
            .setting("after")
            .setting("masses"));
        }
        let n = all.iter().flatten().count();
        let known = all.map(|v| v.unwrap_or(0.0));
        let (mut ways, mut outside) = (Vec::new(), f64::NAN);
        for (method, by, how) in given {
            let r = by.iter().zip(known).map(|(b, v)| b * v).sum::<f64>() / approach;
            let slopes = [by[0] - r, by[1] + r, by[2], by[3]].map(|d| d / approach);
            let std = self.std.map(|u| u * slopes.iter().map(|d| d * d).sum::<f64>().sqrt());
            // Beyond twice its uncertainty it is no restitution; roundings of equal numbers are no velocity.
            if (-r).max(r - 1.0) > std.map_or(0.0, |u| 2.0 * u).max(1e-12) {
                findings.push(
                    Finding::caution("restitution-out-of-range")
                        .name("method", method.name())
                        .number("value", r),
                );
                outside = r;
                continue;
            }
            let shares = Shares::Velocities(slopes.map(|d| d * self.std.unwrap_or(f64::NAN)));
            ways.push(Way { method, restitution: Estimate::new(r, std, "1", n, how), shares });
        }
        if ways.is_empty() {
            return Err(Error::refused(format!("velocities give R = {outside:.4}: outside 0 to 1")).hint(
                "all velocities positive in one direction, and the masses in the order of the velocities",
            ));
        }
        Ok(ways)
    }
}

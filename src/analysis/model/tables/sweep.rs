//! Tables of sweeps of a model, and of the branches beside them.

use crate::compare::Named;
use crate::measure::jump::Jump;
use crate::measure::resonance::Resonance;
use crate::model::PeriodicOrbit;
use crate::model::Loss;
use crate::model::continuation::Branch;
use crate::model::sweep::{Observable, Swept};
use crate::report::layout::{headed, pair};
use crate::report::{Cell, Table};
use num_complex::Complex64;
use serde::Serialize;

/// Point by point, up and then down.
pub fn sweep(swept: &Swept) -> Table {
    let head = [
        ("direction", ""),
        ("frequency", "Hz"),
        ("force", "N"),
        ("x1", "m"),
        ("x2", "m"),
        ("x1 scatter", "m"),
        ("x2 scatter", "m"),
    ];
    let sides = [("up", &swept.up), ("down", &swept.down)];
    sides.into_iter().flat_map(|(name, points)| points.iter().map(move |p| (name, p))).fold(
        headed("Sweep", &head),
        |table, (name, p)| {
            let numbers = [p.frequency, p.force, p.x1, p.x2, p.x1_scatter, p.x2_scatter];
            table.row(std::iter::once(Cell::from(name)).chain(numbers.map(Cell::from)))
        },
    )
}

/// Resonances and jumps of both masses.
pub(crate) fn sweep_named(resonances: &[Named<Resonance>], jumps: &[Named<Jump>]) -> Table {
    let head = [("mass", ""), ("direction", ""), ("kind", ""), ("frequency", "Hz"), ("amplitude", "m")];
    let mut table = headed("Resonances and jumps", &head);
    for r in resonances {
        table.push([
            usize::from(r.mass).into(),
            r.direction.name().into(),
            r.found.kind.name().into(),
            pair(r.found.frequency, r.found.frequency_std),
            r.found.amplitude.into(),
        ]);
    }
    for j in jumps {
        table.push([
            usize::from(j.mass).into(),
            j.direction.name().into(),
            format!("jump, {}", j.found.change.name()).into(),
            pair(j.found.frequency, Some(j.found.frequency_std)),
            j.found.amplitude_after.into(),
        ]);
    }
    table
}

/// A branch as it is printed.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Followed {
    /// Impacts in a period.
    pub impacts: u32,
    /// Cycles in a period.
    pub cycles: u32,
    /// Points in the order of the branch.
    pub points: Vec<FollowedPoint>,
    /// Borders of stability and folds.
    pub marks: Vec<FollowedMark>,
}

/// A point of a branch.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct FollowedPoint {
    /// Frequency in Hz.
    pub frequency: f64,
    /// Force in N.
    pub force: f64,
    /// x₁ in m.
    pub x1: f64,
    /// x₂ in m.
    pub x2: f64,
    /// As the verdict of the same name.
    pub admissible: bool,
    /// As the verdict of the same name.
    pub stable: Option<bool>,
    /// Largest modulus of the multipliers.
    pub spectral_radius: Option<f64>,
}

/// A mark of a branch.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct FollowedMark {
    /// What happens.
    pub kind: Loss,
    /// Frequency in Hz.
    pub frequency: f64,
    /// Force in N.
    pub force: f64,
}

/// A branch with the observable of a sweep.
pub fn followed(branch: &Branch, observable: Observable) -> Followed {
    let points = branch.points.iter().map(|o| {
        let [x1, x2] = match observable {
            Observable::Peak => o.peak_to_peak.map(|x| x / 2.0),
            _ => o.fundamental.map(Complex64::norm),
        };
        FollowedPoint {
            frequency: o.sine.frequency,
            force: o.sine.force,
            x1,
            x2,
            admissible: o.validity.admissible,
            stable: o.validity.stable,
            spectral_radius: o.spectral_radius(),
        }
    });
    let mark = |m: &crate::model::continuation::Mark| FollowedMark {
        kind: m.kind,
        frequency: m.orbit.sine.frequency,
        force: m.orbit.sine.force,
    };
    Followed {
        impacts: branch.points.first().map_or(0, PeriodicOrbit::impacts),
        cycles: branch.points.first().map_or(0, |o| o.cycles),
        points: points.collect(),
        marks: branch.marks.iter().map(mark).collect(),
    }
}

/// Branches, point by point.
pub(crate) fn branch_points(branches: &[Branch], observable: Observable) -> Table {
    let head = [
        ("branch", ""),
        ("frequency", "Hz"),
        ("force", "N"),
        ("x1", "m"),
        ("x2", "m"),
        ("admissible", ""),
        ("stable", ""),
        ("spectral radius", ""),
    ];
    let word = |yes: bool| if yes { "yes" } else { "no" };
    let mut table = headed("Branches", &head);
    for (k, branch) in branches.iter().enumerate() {
        for p in followed(branch, observable).points {
            table.push([
                (k + 1).into(),
                p.frequency.into(),
                p.force.into(),
                p.x1.into(),
                p.x2.into(),
                word(p.admissible).into(),
                p.stable.map_or("neutral", word).into(),
                p.spectral_radius.into(),
            ]);
        }
    }
    table
}

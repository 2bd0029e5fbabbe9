//! A body of a machine, as its run shows it.

use crate::Estimate;
use crate::drill::{Corner, Drill, DrillOptions, Group, TurnsFrom};
use serde::{Deserialize, Serialize};

/// A body of a machine, as its run shows it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Body {
    /// Name of the record.
    pub record: String,
    /// Name of the body.
    pub name: String,
    /// Mass in kg.
    pub mass: Option<f64>,
    /// Turns a second: mean, and standard deviation from turn to turn.
    pub speed: [f64; 2],
    /// Whether phases count from the crank's pulse.
    pub crank: bool,
    /// Samples a second of its record.
    pub rate: f64,
    /// Highest frequency in Hz that its instrument passes, where it is known.
    pub instrument: Option<f64>,
    /// Smoothing of the average.
    pub smoothing: Option<Corner>,
    /// Turns in the average.
    pub turns: usize,
    /// Groups of impacts.
    pub hits: Vec<Hits>,
    /// Phases of the average turn, in turns.
    pub phase: Vec<f64>,
    /// Mean velocity in m/s at these phases.
    pub mean: Vec<f64>,
    /// Its standard deviation from turn to turn.
    pub std: Vec<f64>,
    /// Displacement in m at these phases, with a mean of 0.
    pub displacement: Vec<f64>,
}

/// Impacts of one group.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Hits {
    /// Number of impacts in the means.
    pub n: usize,
    /// Impacts a turn.
    pub share: f64,
    /// Mean phase in turns, and its standard deviation from impact to impact.
    pub phase: [f64; 2],
    /// Mean velocities in m/s before and after.
    pub velocities: [f64; 2],
    /// Covariance of these means: from their scatter together, and what else is uncertain of each.
    pub covariance: Option<[[f64; 2]; 2]>,
    /// Mean kinetic energy in J before, with its standard uncertainty.
    pub energy: Option<(f64, Option<f64>)>,
    /// Mean energy in J that an impact takes out of the body, with its standard uncertainty.
    pub given: Option<(f64, Option<f64>)>,
}

impl Body {
    /// The body of a run that was measured with these options.
    pub fn of(record: &str, name: &str, options: &DrillOptions, found: &Drill) -> Body {
        let hits =
            found.groups.iter().enumerate().filter_map(|(number, group)| Hits::of(found, number, group));
        Body {
            record: record.to_owned(),
            name: name.to_owned(),
            mass: options.mass,
            speed: [found.speed.value, found.speed_variation],
            crank: found.turns_from == TurnsFrom::Reference,
            rate: 1.0 / found.excerpt_time.1,
            instrument: options.instrument,
            smoothing: found.smoothing,
            turns: found.averaged,
            hits: hits.collect(),
            phase: found.average.phase.clone(),
            mean: found.average.mean.clone(),
            std: found.average.std.clone(),
            displacement: found.displacement.value.clone(),
        }
    }

    /// Whether the speeds of two runs differ by no more than they scatter from turn to turn.
    pub fn runs_with(&self, other: &Body) -> bool {
        (self.speed[0] - other.speed[0]).abs() <= self.speed[1].hypot(other.speed[1])
    }
}

impl Hits {
    /// Means of a group; `None` where it has no velocities.
    fn of(found: &Drill, number: usize, group: &Group) -> Option<Hits> {
        let velocities = [group.before.value, group.after.value];
        let all: Vec<_> = found.impacts.iter().filter(|i| i.group == number).collect();
        let sound: Vec<_> = all.iter().filter(|i| !i.clipped || group.clipped == all.len()).collect();
        if sound.is_empty() || velocities.iter().any(|v| !v.is_finite()) {
            return None;
        }
        let n = sound.len() as f64;
        let mean = |of: &dyn Fn(usize) -> f64| (0..sound.len()).map(of).sum::<f64>() / n;
        let sides = |i: usize| [sound[i].before, sound[i].after];
        let centre = [mean(&|i| sides(i)[0]), mean(&|i| sides(i)[1])];
        let scattered = |a: usize, b: usize| {
            mean(&|i| (sides(i)[a] - centre[a]) * (sides(i)[b] - centre[b])) / (n - 1.0).max(1.0)
        };
        let std = group.before.std.zip(group.after.std).filter(|_| sound.len() > 1);
        let covariance = std.map(|(before, after)| {
            let whole = |k: usize, std: f64| scattered(k, k).max(std * std);
            let both = scattered(0, 1);
            [[whole(0, before), both], [both, whole(1, after)]]
        });
        let phase = group.phase.value;
        let apart = |i: usize| turn_between(sound[i].phase, phase).powi(2);
        let estimate = |of: &Option<Estimate>| of.as_ref().map(|e| (e.value, e.std));
        Some(Hits {
            n: sound.len(),
            share: group.share,
            phase: [phase, mean(&apart).sqrt()],
            velocities,
            covariance,
            energy: estimate(&group.energy),
            given: estimate(&group.energy_given),
        })
    }

    /// Change of the velocity in m/s.
    pub(super) fn jump(&self) -> f64 {
        self.velocities[1] - self.velocities[0]
    }

    /// Variance of a sum of the mean velocities, each times its part.
    pub(super) fn variance(&self, parts: [f64; 2]) -> Option<f64> {
        let c = self.covariance?;
        Some(
            parts[0] * parts[0] * c[0][0]
                + 2.0 * parts[0] * parts[1] * c[0][1]
                + parts[1] * parts[1] * c[1][1],
        )
    }
}

/// Difference of two phases in turns, −0.5 to 0.5.
pub(super) fn turn_between(a: f64, b: f64) -> f64 {
    (a - b + 0.5).rem_euclid(1.0) - 0.5
}

//! Impacts that belong together: of one direction, at like phases of the turn.

use super::{DrillOptions, Impact, rebound};
use crate::measure::Estimate;
use crate::measure::mean::Mean;
use serde::Serialize;
use std::f64::consts::TAU;

/// Neighbours in phase that are farther apart than this part of a turn belong to two groups.
const GAP: f64 = 0.1;

/// Impacts of one direction at like phases, and their means.
///
/// A striker that hits the bit in front and is caught behind has two groups; means over both would be those of no impact.
/// Groups are made by the sign of the jump of the velocity and then by gaps of more than 0.1 turn between neighbours on the
/// circle of phases. The first group is the strongest: that with the largest sum of squared jumps over the record, so that a
/// strong stray impact does not stand for all.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Group {
    /// Impacts.
    pub n: usize,
    /// Those of them that went over the range of the instrument: they are in no mean, unless there are no others.
    pub clipped: usize,
    /// Impacts for one turn measured: 1 where there is one in each.
    pub share: f64,
    /// Mean phase in turns after the edge, on the circle; no uncertainty where impacts come all round the turn.
    pub phase: Estimate,
    /// Standard deviation of the phase from impact to impact, in turns.
    pub phase_variation: Option<f64>,
    /// Mean velocity before, in m/s.
    pub before: Estimate,
    /// Mean velocity after, in m/s.
    pub after: Estimate,
    /// Mean kinetic energy before, in J, where the mass is known.
    pub energy: Option<Estimate>,
    /// Mean energy that an impact takes out of the mass, in J.
    pub energy_given: Option<Estimate>,
    /// Sum of the speeds of separation over sum of the speeds of approach.
    pub restitution: Option<Estimate>,
    /// Why there is no restitution.
    #[serde(skip)]
    pub(crate) unknown: Option<String>,
}

/// Impacts in the order of time, by number, of phases without a gap.
struct Arc {
    /// Phase at which they begin; `None` where they go all round the turn.
    start: Option<f64>,
    members: Vec<usize>,
    rises: bool,
}

/// Groups of impacts found in `turns` turns, the strongest first; each impact is told its group.
pub(super) fn groups(impacts: &mut [Impact], turns: usize, options: &DrillOptions) -> Vec<Group> {
    let rises = |i: &Impact| i.after > i.before;
    let mut all: Vec<(f64, Arc)> = Vec::new();
    for direction in [false, true] {
        let members = (0..impacts.len()).filter(|k| rises(&impacts[*k]) == direction).collect();
        for (start, members) in arcs(impacts, members) {
            let squares = members.iter().map(|k| (impacts[*k].after - impacts[*k].before).powi(2)).sum();
            all.push((squares, Arc { start, members, rises: direction }));
        }
    }
    all.sort_by(|a, b| b.0.total_cmp(&a.0));
    let front = all.first().map(|(_, arc)| arc.rises);
    for (number, (_, arc)) in all.iter().enumerate() {
        arc.members.iter().for_each(|k| impacts[*k].group = number);
    }
    all.iter()
        .map(|(_, arc)| {
            let own: Vec<Impact> = arc.members.iter().map(|k| impacts[*k]).collect();
            Group::new(&own, arc.start, turns, front == Some(arc.rises), options)
        })
        .collect()
}

/// Members on arcs of the circle without a gap, in the order of time, and where each arc begins.
fn arcs(impacts: &[Impact], mut members: Vec<usize>) -> Vec<(Option<f64>, Vec<usize>)> {
    members.sort_by(|a, b| impacts[*a].phase.total_cmp(&impacts[*b].phase));
    let phase = |k: usize| members.get(k).map_or(f64::NAN, |i| impacts[*i].phase);
    let n = members.len();
    let gap = |k: usize| if k == 0 { phase(0) - (phase(n - 1) - 1.0) } else { phase(k) - phase(k - 1) };
    let starts: Vec<usize> = (0..n).filter(|k| gap(*k) > GAP).collect();
    let Some(first) = starts.first() else {
        members.sort_unstable();
        return if n == 0 { Vec::new() } else { vec![(None, members)] };
    };
    let ends = starts.iter().skip(1).copied().chain([first + n]);
    let arc = |(start, end): (&usize, usize)| {
        let mut own: Vec<usize> = (*start..end).map(|k| members[k % n]).collect();
        own.sort_unstable();
        (Some(phase(*start)), own)
    };
    starts.iter().zip(ends).map(arc).collect()
}

impl Group {
    /// Means over `own` impacts; `front` tells that they go the way of the strongest group, towards the struck mass.
    fn new(own: &[Impact], start: Option<f64>, turns: usize, front: bool, options: &DrillOptions) -> Group {
        let (all, own) = (own, within_range(own));
        let clipped = all.iter().filter(|i| i.clipped).count();
        let leaning = one_sided(clipped, all.len());
        let estimate = |unit, method: &str, of: &dyn Fn(&Impact) -> f64| {
            let mean = Mean::of(&own.iter().map(of).collect::<Vec<f64>>());
            Estimate::new(mean.value, mean.std.filter(|_| !leaning), unit, mean.n, method)
        };
        let (phase, phase_variation) = phase(&own, start);
        let energy = |m: f64| {
            estimate("J", "½ m v² before, mean over impacts", &move |i| 0.5 * m * i.before * i.before)
        };
        let given = |m: f64| {
            let taken = move |i: &Impact| 0.5 * m * (i.before * i.before - i.after * i.after);
            estimate("J", "½ m (v² before − v² after), mean over impacts", &taken)
        };
        let (mut restitution, unknown) = match rebound::restitution(&own, front, options) {
            Ok(found) => (found, None),
            Err(why) => (None, Some(why)),
        };
        if let Some(found) = restitution.as_mut().filter(|_| leaning) {
            found.std = None;
        }
        Group {
            n: all.len(),
            clipped,
            share: all.len() as f64 / turns as f64,
            phase,
            phase_variation,
            before: estimate("m/s", "parabola up to the contact, mean over impacts", &|i| i.before),
            after: estimate("m/s", "parabola from the contact on, mean over impacts", &|i| i.after),
            energy: options.mass.map(energy),
            energy_given: options.mass.map(given),
            restitution,
            unknown,
        }
    }

    /// Whether so many impacts were left out that the means lean to the slower ones, and have no uncertainty for it.
    pub(super) fn leans(&self) -> bool {
        one_sided(self.clipped, self.n)
    }
}

/// Impacts of the means: those that the instrument could follow, unless it could follow none.
fn within_range(impacts: &[Impact]) -> Vec<Impact> {
    let kept: Vec<Impact> = impacts.iter().filter(|i| !i.clipped).copied().collect();
    if kept.is_empty() { impacts.to_vec() } else { kept }
}

/// Whether leaving out `clipped` of `all` impacts may move a mean by more than its uncertainty. The impacts left out are likely
/// the fastest; without a share p of its fastest, the mean of a normal distribution lies about 2pσ lower, and its standard
/// uncertainty is σ/√n.
fn one_sided(clipped: usize, all: usize) -> bool {
    clipped > 0 && 2.0 * clipped as f64 > (all as f64).sqrt()
}

/// Phases run round the circle: their mean is taken along the arc on which they lie, or, where they lie all round, in the
/// direction of the mean of their unit vectors, without an uncertainty.
fn phase(own: &[Impact], start: Option<f64>) -> (Estimate, Option<f64>) {
    let (sin, cos) = own.iter().map(|i| (TAU * i.phase).sin_cos()).fold((0.0, 0.0), add);
    let from = start.unwrap_or_else(|| f64::atan2(sin, cos) / TAU - 0.5);
    let along: Vec<f64> = own.iter().map(|i| (i.phase - from).rem_euclid(1.0)).collect();
    let mean = Mean::of(&along);
    let squares: f64 = along.iter().map(|x| (x - mean.value).powi(2)).sum();
    let variation = (mean.n > 1).then(|| (squares / (mean.n - 1) as f64).sqrt());
    let method = if start.is_some() {
        "turns after the edge, mean over impacts on the circle"
    } else {
        "turns after the edge, mean direction of impacts at all phases: no uncertainty"
    };
    let std = start.and(mean.std);
    (Estimate::new((from + mean.value).rem_euclid(1.0), std, "1", mean.n, method), variation)
}

fn add(a: (f64, f64), b: (f64, f64)) -> (f64, f64) {
    (a.0 + b.0, a.1 + b.1)
}

/// Sentences on groups.
pub(super) fn doubts(groups: &[Group]) -> Vec<String> {
    /// Groups that are described.
    const DESCRIBED: usize = 4;
    let mut said = Vec::new();
    if let [first, others @ ..] = groups
        && !others.is_empty()
    {
        let describe = |g: &Group| {
            format!(
                "at phase {:.3} from {:.2} to {:.2} m/s ({:.2} a turn)",
                g.phase.value, g.before.value, g.after.value, g.share
            )
        };
        let more = match others.len().saturating_sub(DESCRIBED) {
            0 => String::new(),
            more => format!(", and {more} more"),
        };
        let few: Vec<String> = others.iter().take(DESCRIBED).map(describe).collect();
        said.push(format!(
            "The impacts are of {} groups. Means are those of the strongest, {}; the others come {}{more}.",
            groups.len(),
            describe(first),
            few.join(", ")
        ));
    }
    for (number, group) in groups.iter().enumerate() {
        let of = if groups.len() > 1 { format!(" of group {number}") } else { String::new() };
        if group.phase.method.ends_with("no uncertainty") {
            said.push(format!("Impacts{of} come at all phases of the turn: their mean phase means little."));
        }
        said.extend(
            group
                .unknown
                .as_ref()
                .map(|why| why.replacen("No restitution", &format!("No restitution{of}"), 1)),
        );
        if group.restitution.as_ref().is_some_and(|r| r.method.ends_with("within a tenth")) {
            said.push(format!(
                "The mean speed of approach of the impacts{of} is not known within a tenth: the restitution has no uncertainty."
            ));
        }
    }
    said
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measure::drill::{Beam, Edge, From};

    fn options(masses: Option<(f64, f64)>) -> DrillOptions {
        let mut options = DrillOptions::new(1.0, Beam::new(0.0, From::Axis).unwrap(), 1, Edge::Rising);
        (options.mass, options.struck_mass) = (masses.map(|m| m.0), masses.map(|m| m.1));
        options
    }

    /// Impacts of turns in a row from (phase, before, after).
    fn impacts(of: &[(f64, f64, f64)]) -> Vec<Impact> {
        let one = |(cycle, (phase, before, after)): (usize, &(f64, f64, f64))| Impact {
            cycle,
            group: 99,
            time: cycle as f64 + phase,
            phase: *phase,
            phase_std: 0.0,
            before: *before,
            before_std: 0.0,
            after: *after,
            after_std: 0.0,
            clipped: false,
        };
        of.iter().enumerate().map(one).collect()
    }

    #[test]
    fn front_and_rear_and_a_stray() {
        let mut all = impacts(&[
            (0.98, 7.0, -1.0),
            (0.45, -4.0, 1.0),
            (0.02, 8.0, -2.0),
            (0.47, -4.2, 1.2),
            (0.99, 7.5, -1.5),
            (0.30, 30.0, 0.0),
            (0.03, 7.5, -1.5),
            (0.44, -4.1, 1.1),
        ]);
        let groups = groups(&mut all, 4, &options(Some((0.1, 0.2))));
        // Squares of jumps: the stray 900, in front 64 + 100 + 81 + 81 = 326, behind 25 + 29 + 27.
        assert_eq!(groups.iter().map(|g| g.n).collect::<Vec<_>>(), [1, 4, 3]);
        assert_eq!(all.iter().map(|i| i.group).collect::<Vec<_>>(), [1, 2, 1, 2, 1, 0, 1, 2]);
        let front = &groups[1];
        // (−0.02 + 0.02 − 0.01 + 0.03)/4, across the edge of the turn.
        assert!((front.phase.value - 0.005).abs() < 1e-12 && front.share == 1.0, "{front:?}");
        assert!((front.before.value - 7.5).abs() < 1e-12 && (front.after.value + 1.5).abs() < 1e-12);
        // Separation ½(v − v′) − v′ = 4.5 + 1.5 in the mean, approach 7.5.
        assert!((front.restitution.as_ref().unwrap().value - 6.0 / 7.5).abs() < 1e-12);
        // Behind, 3.3/12.3: the struck mass is not there.
        let rear = groups[2].restitution.as_ref().unwrap();
        assert!((rear.value - 3.3 / 12.3).abs() < 1e-12 && rear.std.is_none(), "{rear:?}");
        assert!(groups[2].before.std.is_none() && front.before.std.is_some());
        let said = doubts(&groups);
        assert!(said.len() == 1 && said[0].contains("3 groups"), "{said:?}");
    }

    #[test]
    fn a_strong_stray_does_not_stand_for_all() {
        let mut of = vec![(0.3, 7.0, -2.0); 20];
        of.push((0.7, 30.0, 0.0));
        let groups = groups(&mut impacts(&of), 20, &options(None));
        assert_eq!((groups.len(), groups[0].n, groups[1].n), (2, 20, 1));
    }

    #[test]
    fn impacts_at_all_phases_have_no_mean_phase() {
        let of: Vec<_> = (0..40).map(|k| ((0.37 * f64::from(k)).fract(), 5.0, -1.0)).collect();
        let groups = groups(&mut impacts(&of), 40, &options(None));
        assert_eq!((groups.len(), groups[0].n, groups[0].phase.std), (1, 40, None));
        assert!(groups[0].before.std.is_some());
        assert!(doubts(&groups)[0].contains("all phases"));
        assert!(super::groups(&mut [], 3, &options(None)).is_empty());
    }

    #[test]
    fn a_ratio_of_sums_and_its_propagated_uncertainty() {
        // R = 0.2 in every impact whatever the speed: nothing scatters. Then a speed of approach that is not known.
        let of: Vec<_> =
            (0..12).map(|k| (0.5, 10.0 + 0.2 * f64::from(k), -0.2 * (10.0 + 0.2 * f64::from(k)))).collect();
        let found = groups(&mut impacts(&of), 12, &options(None));
        let r = found[0].restitution.as_ref().unwrap();
        assert!((r.value - 0.2).abs() < 1e-12 && r.std.unwrap() < 1e-12, "{r:?}");
        let of: Vec<_> =
            (0..12).map(|k| (0.5, if k % 5 < 2 { 1.0 } else { -0.8 }, -3.0 - f64::from(k % 3))).collect();
        let found = groups(&mut impacts(&of), 12, &options(None));
        assert_eq!(found[0].restitution, None);
        assert!(doubts(&found)[0].contains("cannot be told from 0"), "{:?}", doubts(&found));
    }
}

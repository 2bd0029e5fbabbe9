//! Impacts that belong together: of one direction, at like phases of the turn.

use super::misfit::{Misfit, Misfits};
use super::rebound::{Doubt, restitution};
use super::{DrillOptions, Impact};
use crate::Estimate;
use crate::mean::Mean;
use serde::Serialize;
use std::f64::consts::TAU;

/// Neighbours in phase that are farther apart than this part of a turn, and than chance makes of so many, belong to two groups.
const GAP: f64 = 0.1;
/// Chance that impacts at phases of pure chance are taken for groups, and that they are taken for impacts at like phases.
const CHANCE: f64 = 0.01;
/// Bias of a mean, in standard uncertainties, that leaves ± 1.96 of them a coverage of 94 %.
const BIAS: f64 = 0.3;

/// Impacts of one direction at like phases, and their means.
///
/// A striker that hits the bit in front and is caught behind has two groups; means over both would be those of no impact.
/// Groups are made by the sign of the jump of the velocity and then by gaps between neighbours on the circle of phases: two or more
/// gaps, each of more than 0.1 turn and wider than two of n impacts at phases of pure chance are once in a hundred. Of n
/// such phases two given gaps are wider than x with the probability (1 − 2x)^(n − 1) (L. Holst, J. Appl. Probab. 17 (1980) 623), any two of
/// n(n − 1)/2 pairs at most as many times that: 0.41 turn for 5 impacts, 0.3 for 10, 0.2 for 20, 0.1 for 55. The first group is the strongest: that with the largest sum of squared jumps over the record, so that a
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
    /// What there is to say of the restitution.
    #[serde(skip)]
    pub(crate) doubt: Option<Doubt>,
    /// What the fits before and after leave alike, where it may move the mean by more than its scatter tells.
    #[serde(skip)]
    pub(super) misfit: [Option<Misfit>; 2],
    /// Whether the impacts come all round the turn, for all that is known.
    #[serde(skip)]
    pub(crate) all_round: bool,
    /// Whether velocities or phase wander so slowly that uncertainties may be too small.
    #[serde(skip)]
    pub(crate) wanders: bool,
}

/// Impacts in the order of time, by number, of phases without a gap.
struct Arc {
    /// Phase at which they begin; `None` where they may go all round the turn.
    start: Option<f64>,
    members: Vec<usize>,
    rises: bool,
}

/// Groups of impacts found in `turns` turns, the strongest first; each impact is told its group.
pub(super) fn groups(
    impacts: &mut [Impact],
    misfits: &Misfits,
    turns: usize,
    options: &DrillOptions,
) -> Vec<Group> {
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
            let taken: Vec<usize> = arc
                .members
                .iter()
                .copied()
                .filter(|k| own.iter().all(|i| i.clipped) || !impacts[*k].clipped)
                .collect();
            Group::new(&own, misfits.alike(&taken), arc.start, turns, front == Some(arc.rises), options)
        })
        .collect()
}

/// Largest of the second widest gaps that `n` phases of pure chance leave on the circle, but for one case in a hundred.
fn by_chance(n: usize) -> f64 {
    let n = n as f64;
    0.5 * (1.0 - (CHANCE / (0.5 * n * (n - 1.0))).powf(1.0 / (n - 1.0)))
}

/// Whether phases prefer a direction more than chance explains: probability of the length R of the sum of n unit vectors, if all
/// directions are alike, exp(√(1 + 4n + 4(n² − R²)) − 1 − 2n) (J. Zar, Biostatistical Analysis, 1999, equation 27.4). It
/// is below 1 % only from four impacts on; fewer have no uncertainty anyhow.
fn directed(impacts: &[Impact], members: &[usize]) -> bool {
    let n = members.len() as f64;
    let (sin, cos) = members.iter().map(|k| (TAU * impacts[*k].phase).sin_cos()).fold((0.0, 0.0), add);
    let exponent = (1.0 + 4.0 * n + 4.0 * (n * n - sin * sin - cos * cos)).max(0.0).sqrt() - 1.0 - 2.0 * n;
    n < 4.0 || exponent < CHANCE.ln()
}

/// Members on arcs of the circle without a gap, in the order of time, and where each arc begins.
fn arcs(impacts: &[Impact], mut members: Vec<usize>) -> Vec<(Option<f64>, Vec<usize>)> {
    members.sort_by(|a, b| impacts[*a].phase.total_cmp(&impacts[*b].phase));
    let phase = |k: usize| members.get(k).map_or(f64::NAN, |i| impacts[*i].phase);
    let n = members.len();
    let gap = |k: usize| if k == 0 { phase(0) - (phase(n - 1) - 1.0) } else { phase(k) - phase(k - 1) };
    if n == 0 {
        return Vec::new();
    }
    let wide = GAP.max(by_chance(n));
    let mut starts: Vec<usize> = (0..n).filter(|k| gap(*k) > wide).collect();
    if starts.len() < 2 {
        // One group. Its arc begins behind the widest gap, if it is one.
        let widest = (0..n).max_by(|a, b| gap(*a).total_cmp(&gap(*b))).filter(|k| gap(*k) > GAP);
        starts = widest.filter(|_| directed(impacts, &members)).into_iter().collect();
    }
    let Some(first) = starts.first() else {
        members.sort_unstable();
        return vec![(None, members)];
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
    fn new(
        own: &[Impact],
        misfit: [Option<Misfit>; 2],
        start: Option<f64>,
        turns: usize,
        front: bool,
        options: &DrillOptions,
    ) -> Group {
        let (all, own) = (own, within_range(own));
        let clipped = all.iter().filter(|i| i.clipped).count();
        let leaning = one_sided(clipped, all.len());
        let mean = |of: &dyn Fn(&Impact) -> f64| Mean::of(&own.iter().map(of).collect::<Vec<f64>>());
        // A mean that is moved by less than its scatter leaves open keeps its uncertainty.
        let moved = |misfit: Option<Misfit>, of: &dyn Fn(&Impact) -> f64| {
            misfit.filter(|m| mean(of).std.is_some_and(|std| m.bias > BIAS * std))
        };
        let misfit = [moved(misfit[0], &|i| i.before), moved(misfit[1], &|i| i.after)];
        let [open_before, open_after] = misfit.map(|m| leaning || m.is_some());
        let estimate = |unit, method: &str, open: bool, of: &dyn Fn(&Impact) -> f64| {
            let mean = mean(of);
            Estimate::new(mean.value, mean.std.filter(|_| !open), unit, mean.n, method)
        };
        let (phase, phase_variation) = phase(&own, start);
        let slow = |of: &dyn Fn(&Impact) -> f64| mean(of).wanders;
        let from = phase.value - 0.5;
        let wanders =
            slow(&|i| i.before) || slow(&|i| i.after) || slow(&|i| (i.phase - from).rem_euclid(1.0));
        let energy = |m: f64| {
            estimate("J", "½ m v² before, mean over impacts", open_before, &move |i| {
                0.5 * m * i.before * i.before
            })
        };
        let given = |m: f64| {
            let taken = move |i: &Impact| 0.5 * m * (i.before * i.before - i.after * i.after);
            estimate("J", "½ m (v² before − v² after), mean over impacts", open_before || open_after, &taken)
        };
        let (mut restitution, doubt) = restitution(&own, front, options);
        if let Some(found) = restitution.as_mut().filter(|_| open_before || open_after) {
            found.std = None;
        }
        Group {
            n: all.len(),
            clipped,
            share: all.len() as f64 / turns as f64,
            phase,
            phase_variation,
            before: estimate("m/s", "parabola up to the contact, mean over impacts", open_before, &|i| {
                i.before
            }),
            after: estimate("m/s", "parabola from the contact on, mean over impacts", open_after, &|i| {
                i.after
            }),
            energy: options.mass.map(energy),
            energy_given: options.mass.map(given),
            restitution,
            doubt,
            misfit,
            all_round: start.is_none(),
            wanders,
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

/// Whether leaving out `clipped` of `all` impacts may move a mean by more than 0.3 of its standard uncertainty. The impacts left out are
/// likely the fastest: the mean of a normal distribution without its share p beyond z lies φ(z) σ/(1 − p) lower, which for small p
/// is p z σ and less than p √(2 ln(1/p)) σ; its standard uncertainty is σ/√n.
fn one_sided(clipped: usize, all: usize) -> bool {
    let (out, n) = (clipped as f64, all as f64);
    clipped > 0 && (2 * clipped >= all || out * (2.0 * (n / out).ln()).sqrt() > BIAS * n.sqrt())
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
        if group.all_round {
            said.push(format!(
                "Impacts{of} come at all phases of the turn, or are too few to prefer one: their mean phase means little."
            ));
        }
        said.extend(group.doubt.map(|doubt| doubt.sentence(&of)));
        said.extend(Misfit::sentence(group.misfit, &of));
    }
    said
}

#[cfg(test)]
mod tests;

//! Impacts that belong together: of one direction, at like phases of the turn.

use super::lack_of_fit::{LackOfFit, Residuals};
use super::restitution::restitution;
use super::{DrillOptions, Impact};
use crate::Estimate;
use crate::mean::Mean;
use serde::Serialize;
use std::f64::consts::TAU;
use vibro_record::Finding;

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
/// n(n − 1)/2 pairs at most as many times that: 0.41 turn for 5 impacts, 0.3 for 10, 0.2 for 20, 0.1 for 55. The first group is the
/// strongest: that with the largest sum of squared jumps over the record, so that a strong stray impact does not stand for all.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[non_exhaustive]
pub struct Group {
    /// Impacts.
    pub n: usize,
    /// Those of them that are over-range: they are in no mean, unless there are no others.
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
    /// What was found of this group alone.
    #[serde(skip)]
    pub(super) findings: Vec<Finding>,
    /// Whether velocities or phase change so slowly that uncertainties may be too small.
    #[serde(skip)]
    pub(super) wanders: bool,
}

/// Impacts in the order of time, by number, of phases without a gap.
struct Arc {
    /// Phase at which they begin; `None` where they may go all round the turn.
    start: Option<f64>,
    members: Vec<usize>,
    rises: bool,
    /// Sum of the squares of their jumps.
    strength: f64,
}

/// Groups of impacts found in `turns` turns, the strongest first; each impact gets its group.
pub(super) fn groups(
    impacts: &mut [Impact],
    residuals: &Residuals,
    turns: usize,
    options: &DrillOptions,
) -> Vec<Group> {
    let mut all: Vec<Arc> = Vec::new();
    for rises in [false, true] {
        let members =
            (0..impacts.len()).filter(|k| (impacts[*k].after > impacts[*k].before) == rises).collect();
        for (start, members) in arcs(impacts, members) {
            let strength = members.iter().map(|k| (impacts[*k].after - impacts[*k].before).powi(2)).sum();
            all.push(Arc { start, members, rises, strength });
        }
    }
    all.sort_by(|a, b| b.strength.total_cmp(&a.strength));
    for (number, arc) in all.iter().enumerate() {
        arc.members.iter().for_each(|k| impacts[*k].group = number);
    }
    let front = all.first().map(|arc| arc.rises);
    let group = |(number, arc): (usize, &Arc)| {
        // The means are of impacts that the instrument could follow, unless it could follow none.
        let within = |k: &usize| !impacts[*k].clipped;
        let any = arc.members.iter().any(within);
        let used: Vec<usize> = arc.members.iter().copied().filter(|k| !any || within(k)).collect();
        let own: Vec<Impact> = used.iter().map(|k| impacts[*k]).collect();
        let lack = residuals.lack_of_fit(&used);
        let mut group = Group::new(&own, arc, turns, lack, front == Some(arc.rises), options);
        if all.len() > 1 {
            group.findings = group.findings.into_iter().map(|found| found.count("group", number)).collect();
        }
        group
    };
    all.iter().enumerate().map(group).collect()
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
    let (sin, cos) = resultant(members.iter().map(|k| &impacts[*k]));
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
    /// Means over `own` impacts, those of `arc` within the range; `front`: they go the way of the strongest group, towards the
    /// struck mass.
    fn new(
        own: &[Impact],
        arc: &Arc,
        turns: usize,
        lack: [Option<LackOfFit>; 2],
        front: bool,
        options: &DrillOptions,
    ) -> Group {
        let n = arc.members.len();
        let clipped = if own.iter().all(|i| i.clipped) { n } else { n - own.len() };
        let range_biased = range_bias(clipped, n);
        let mean = |of: &dyn Fn(&Impact) -> f64| Mean::of(&own.iter().map(of).collect::<Vec<f64>>());
        let (before, after) = (mean(&|i| i.before), mean(&|i| i.after));
        // A mean that is moved by less than its scatter leaves open keeps its uncertainty.
        let moves = |lack: Option<LackOfFit>, mean: &Mean| {
            lack.filter(|l| mean.std.is_some_and(|std| l.bias > BIAS * std))
        };
        let lack = [moves(lack[0], &before), moves(lack[1], &after)];
        let [open_before, open_after] = lack.map(|l| range_biased || l.is_some());
        let open = open_before || open_after;
        let estimate = |mean: Mean, open: bool, unit, method| {
            Estimate::new(mean.value, mean.std.filter(|_| !open), unit, mean.n, method)
        };
        let (phase, phase_variation, phase_wanders) = phase(own, arc.start);
        let (mut restitution, doubt) = restitution(own, front, options);
        if let Some(found) = restitution.as_mut().filter(|_| open) {
            found.std = None;
        }
        let mut findings: Vec<Finding> = doubt.into_iter().collect();
        if clipped > 0 {
            let found = match (clipped == n, range_biased) {
                (true, _) => Finding::doubt("drill-all-impacts-over-range"),
                (_, true) => Finding::doubt("drill-impacts-over-range-biased"),
                _ => Finding::caution("drill-impacts-over-range"),
            };
            findings.push(found.count("n", clipped).count("all", n));
        }
        if arc.start.is_none() {
            findings.push(Finding::doubt("drill-phase-undirected"));
        }
        let sides = ["before", "after"].into_iter().zip(lack);
        findings.extend(sides.filter_map(|(side, lack)| {
            Some(Finding::doubt("drill-lack-of-fit").name("side", side).number("residual", lack?.residual))
        }));
        Group {
            n,
            clipped,
            share: n as f64 / turns as f64,
            phase,
            phase_variation,
            before: estimate(before, open_before, "m/s", "parabola up to the contact, mean over impacts"),
            after: estimate(after, open_after, "m/s", "parabola from the contact on, mean over impacts"),
            energy: options.mass.map(|m| {
                let all = mean(&|i| 0.5 * m * i.before * i.before);
                estimate(all, open_before, "J", "½ m v² before, mean over impacts")
            }),
            energy_given: options.mass.map(|m| {
                let all = mean(&|i| 0.5 * m * (i.before * i.before - i.after * i.after));
                estimate(all, open, "J", "½ m (v² before − v² after), mean over impacts")
            }),
            restitution,
            findings,
            wanders: before.wanders || after.wanders || phase_wanders,
        }
    }
}

/// Whether leaving out `clipped` of `all` impacts may move a mean by more than 0.3 of its standard uncertainty. The impacts left out are
/// likely the fastest: the mean of a normal distribution without its share p beyond z lies φ(z) σ/(1 − p) lower, which for small p
/// is p z σ and less than p √(2 ln(1/p)) σ; its standard uncertainty is σ/√n.
fn range_bias(clipped: usize, all: usize) -> bool {
    let (out, n) = (clipped as f64, all as f64);
    clipped > 0 && (2 * clipped >= all || out * (2.0 * (n / out).ln()).sqrt() > BIAS * n.sqrt())
}

/// Mean phase on the circle, its standard deviation, and whether it changes slowly: along the arc on which the impacts lie, or, where
/// they lie all round, in the direction of the mean of their unit vectors, without an uncertainty.
fn phase(own: &[Impact], start: Option<f64>) -> (Estimate, Option<f64>, bool) {
    let (sin, cos) = resultant(own.iter());
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
    let estimate = Estimate::new((from + mean.value).rem_euclid(1.0), std, "1", mean.n, method);
    (estimate, variation, mean.wanders)
}

/// Sum of the unit vectors of phases: sine and cosine.
fn resultant<'a>(impacts: impl Iterator<Item = &'a Impact>) -> (f64, f64) {
    impacts.map(|i| (TAU * i.phase).sin_cos()).fold((0.0, 0.0), |a, b| (a.0 + b.0, a.1 + b.1))
}

#[cfg(test)]
mod tests;

//! Groups of impacts of one direction: their means and their restitution.

use super::parabola::LackOfFit;
use super::{DrillOptions, TurnsFrom};
use crate::Estimate;
use crate::mean::Mean;
use serde::Serialize;
use std::f64::consts::TAU;
use vibro_record::{Finding, Uncertain, code, sort_by_number, uncertain};

/// Largest bias of a mean, in standard uncertainties, that is ignored: ±1.96 of them then still cover 94 %.
const BIAS: f64 = 0.3;
/// Least square of the sum of n unit vectors over n for phases with a direction: one in twenty sets of random
/// directions exceeds it (J. Zar, Biostatistical Analysis, 1999, section 27.1: Rayleigh's test).
const DIRECTED: f64 = 3.0;
/// Least velocity of approach over its uncertainty for a restitution; a slower approach is consistent with 0.
const CLEAR: f64 = 6.0;
/// Largest phase in turns, from rounding, of impacts that begin their turns.
const ROUNDING: f64 = 1e-6;
/// Largest plausible offset of an instrument, relative to the speed at an impact.
const LARGEST: f64 = 0.1;
/// Findings about the velocities at impacts.
const OF_VELOCITIES: [&str; 3] = ["drill-lack-of-fit", "drill-not-striking", "drill-restitution-impossible"];
/// Largest velocity that a parabola, continued to the middle of a contact, may give, over the largest of the
/// record.
const EXTRAPOLATED: f64 = 1.3;
/// Largest interval, relative to the mean one, at which an impact follows another closely. Of impacts at
/// random phases, one a turn, 3 % do.
const CLOSE: f64 = 0.25;
/// Largest share of impacts that may follow another closely by chance; a larger share means ringing.
const ACCIDENTS: f64 = 0.1;
/// Least gap between the phases of two groups of impacts, over the widest within a group.
const PARTED: f64 = 3.0;
/// Number of standard uncertainties by which the mean velocities of two blows a turn must differ to be
/// unlike.
const UNLIKE: f64 = 4.0;
/// Speed after an impact over that before it, beyond which the mass is struck: one that strikes a mass at
/// rest is no faster after than before.
const DRIVEN: f64 = 2.0;
/// Standard uncertainties beyond which a restitution outside 0 to 1 is impossible, not chance.
const BEYOND: f64 = 2.0;

/// One impact.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Impact {
    /// Turn, counted from 0 among the whole turns.
    pub cycle: usize,
    /// Number of its group in the result; 0 is the strongest.
    pub group: usize,
    /// Time from the first sample, in s.
    pub time: f64,
    /// Standard uncertainty of the time, in s.
    pub time_std: Option<f64>,
    /// Fraction of the turn after its beginning, 0 to 1.
    pub phase: f64,
    /// Standard uncertainty of the phase, in turns.
    pub phase_std: Option<f64>,
    /// Velocity at first contact, in m/s.
    pub first_contact: f64,
    /// Standard uncertainty of this velocity, in m/s.
    pub first_contact_std: Option<f64>,
    /// Velocity of approach, continued to the middle of the contact, in m/s.
    pub before: f64,
    /// Standard uncertainty of this velocity, in m/s.
    pub before_std: Option<f64>,
    /// Velocity of separation, continued back to the middle of the contact, in m/s.
    pub after: f64,
    /// Standard uncertainty of this velocity, in m/s.
    pub after_std: Option<f64>,
    /// Whether samples of the fits or of the contact are over-range. The speeds are then biased low, and the
    /// impact is left out of the means.
    pub clipped: bool,
}

uncertain!(Impact: time_std, phase_std; scaled: first_contact_std, before_std, after_std);

impl Impact {
    /// Time and phase.
    fn instant(&mut self) -> [&mut Option<f64>; 2] {
        [&mut self.time_std, &mut self.phase_std]
    }

    fn velocities(&mut self) -> [&mut Option<f64>; 3] {
        [&mut self.first_contact_std, &mut self.before_std, &mut self.after_std]
    }
}

/// Whether each impact of a group keeps its own uncertainties: a doubt about the group may be one about each.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Kept(bool);

impl Uncertain for Kept {
    fn doubt(&mut self) {
        self.0 = false;
    }
}

/// Mean velocity over turns in m/s, subtracted from the velocities at impacts. A mass that returns each turn
/// has none: it is an offset of the instrument, or the machine moves as a whole.
#[derive(Debug, Clone, Copy)]
pub(super) struct Offset {
    pub value: f64,
    pub std: Option<f64>,
}

impl Offset {
    /// From the mean drift over a turn in m and the time of a turn in s. `beyond` is the largest error of the
    /// mean from over-range, in m/s.
    pub fn of(drift: &Mean, period: f64, beyond: f64) -> Offset {
        if !drift.value.is_finite() {
            return Offset { value: 0.0, std: None };
        }
        Offset { value: drift.value / period, std: drift.std.map(|std| (std / period).hypot(beyond)) }
    }
}

/// Impacts of one direction, by the sign of the jump of the velocity, and their means.
///
/// A striker that hits the bit in front and a stop at the rear has two groups. Two unlike blows a turn are
/// two groups as well: a mean over both would describe neither. The first group is the strongest of the
/// direction with the largest sum of squared jumps over the record.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[non_exhaustive]
pub struct Group {
    /// Number of impacts.
    pub n: usize,
    /// Impacts of the group that are over-range: they are left out of the means, unless all are.
    pub clipped: usize,
    /// Impacts per measured turn: 1 where each turn has one.
    pub share: f64,
    /// Mean phase in turns after the edge, on the circle; no uncertainty if the impacts are spread over the
    /// whole turn.
    pub phase: Estimate,
    /// Mean velocity at first contact, in m/s.
    pub first_contact: Estimate,
    /// Mean velocity of approach, continued to the middle of the contact, in m/s: the balances of momentum
    /// and energy need both velocities at one instant.
    pub before: Estimate,
    /// Mean velocity of separation, continued back to the middle of the contact, in m/s.
    pub after: Estimate,
    /// Mean kinetic energy before, in J, where the mass is known.
    pub energy: Option<Estimate>,
    /// Mean energy that an impact takes out of the mass, in J.
    pub energy_given: Option<Estimate>,
    /// Sum of the speeds of separation over sum of the speeds of approach.
    pub restitution: Option<Estimate>,
    /// Findings of this group alone.
    #[serde(skip)]
    pub(super) findings: Vec<Finding>,
    /// Whether velocities or phase change so slowly that uncertainties may be too small.
    #[serde(skip)]
    pub(super) wanders: bool,
    /// Whether its impacts keep the uncertainties of their times and phases, and of their velocities.
    #[serde(skip)]
    kept: [Kept; 2],
}

impl Uncertain for Group {
    fn doubt(&mut self) {
        self.phase.doubt();
        self.velocities().doubt();
        self.kept.doubt();
    }

    fn doubt_scale(&mut self) {
        let Group { first_contact, before, after, energy, energy_given, .. } = self;
        let scaled: &mut [&mut dyn Uncertain] = &mut [first_contact, before, after, energy, energy_given];
        scaled.doubt();
    }
}

/// Groups of impacts found in `turns` turns, the strongest first; sets the group of each impact. The
/// `offset` is already subtracted from the velocities. `residuals` are those of the fits before and after
/// each impact, which end `gap` samples from the middle of the contact.
pub(super) fn groups(
    impacts: &mut [Impact],
    residuals: &[[Vec<f64>; 2]],
    gap: usize,
    turns: usize,
    options: &DrillOptions,
    offset: &Offset,
) -> Vec<Group> {
    let strength =
        |own: &[usize]| own.iter().map(|i| (impacts[*i].after - impacts[*i].before).powi(2)).sum::<f64>();
    let mut sides = [true, false].map(|up| {
        (0..impacts.len()).filter(|i| (impacts[*i].after > impacts[*i].before) == up).collect::<Vec<_>>()
    });
    sort_by_number(&mut sides, |a| -strength(a));
    let mut members: Vec<(bool, Vec<usize>)> = Vec::new();
    for (front, side) in [true, false].into_iter().zip(sides).filter(|(_, side)| !side.is_empty()) {
        let mut parts = by_phase(impacts, side, turns);
        sort_by_number(&mut parts, |a| -strength(a));
        members.extend(parts.into_iter().map(|part| (front, part)));
    }
    for (number, (_, own)) in members.iter().enumerate() {
        for i in own {
            impacts[*i].group = number;
        }
    }
    let group = |(number, (front, own)): (usize, &(bool, Vec<usize>))| {
        let own: Vec<_> = own.iter().map(|i| (&impacts[*i], &residuals[*i])).collect();
        let mut group = Group::new(&own, *front, gap, options).allowing(offset, options.mass);
        group.share = group.n as f64 / turns as f64;
        if members.len() > 1 {
            group.findings = group.findings.into_iter().map(|found| found.count("group", number)).collect();
        }
        group
    };
    members.iter().enumerate().map(group).collect()
}

/// Splits the impacts `own` of one direction by phase if a turn has several blows whose mean velocities
/// differ; otherwise returns them as one part. Each part is in the order of time. The phases are split at
/// their widest gaps on the circle.
fn by_phase(impacts: &[Impact], own: Vec<usize>, turns: usize) -> Vec<Vec<usize>> {
    let a_turn = (own.len() as f64 / turns.max(1) as f64).round() as usize;
    if a_turn < 2 {
        return vec![own];
    }
    let mut round = own.clone();
    sort_by_number(&mut round, |a| impacts[*a].phase);
    let phase = |k: usize| impacts[round[k % round.len()]].phase + (k / round.len()) as f64;
    let mut gaps: Vec<(f64, usize)> = (0..round.len()).map(|k| (phase(k + 1) - phase(k), k + 1)).collect();
    sort_by_number(&mut gaps, |a| -a.0);
    let inner = gaps.get(a_turn).map_or(0.0, |gap| gap.0);
    if gaps[a_turn - 1].0 < PARTED * inner {
        return vec![own];
    }
    let mut borders: Vec<usize> = gaps[..a_turn].iter().map(|gap| gap.1).collect();
    borders.sort_unstable();
    let part = |k: usize| {
        let end = borders.get(k + 1).copied().unwrap_or(borders[0] + round.len());
        let mut part: Vec<usize> = (borders[k]..end).map(|i| round[i % round.len()]).collect();
        part.sort_unstable();
        part
    };
    let parts: Vec<Vec<usize>> = (0..a_turn).map(part).collect();
    let mean = |part: &Vec<usize>| Mean::of(&part.iter().map(|i| impacts[*i].before).collect::<Vec<_>>());
    let means: Vec<Mean> = parts.iter().map(mean).collect();
    let unlike = |a: &Mean, b: &Mean| {
        a.std.zip(b.std).is_some_and(|(s, t)| (a.value - b.value).abs() > UNLIKE * s.hypot(t))
    };
    let differ = means.iter().any(|a| means.iter().any(|b| unlike(a, b)));
    if differ { parts } else { vec![own] }
}

impl Group {
    /// Adds the uncertainty of the offset, which all impacts share. If the offset is larger than that of an
    /// instrument ([`LARGEST`]), no uncertainty is stated. The energies are those of a mass in kg.
    fn allowing(mut self, offset: &Offset, mass: Option<f64>) -> Group {
        let (before, after) = (self.before.value, self.after.value);
        if offset.value.abs() > LARGEST * before.abs().max(after.abs()) {
            let doubt = Finding::doubt(code::DRILL_MEAN_VELOCITY).number("mean", offset.value);
            self.kept[1].doubt();
            let found = doubt.of(&mut self.velocities());
            self.findings.push(found);
            return self;
        }
        let Some(unknown) = offset.std else { return self };
        let add = |estimate: &mut Estimate, by: f64| {
            estimate.std = estimate.std.map(|std| std.hypot(by));
        };
        // Derivative m v of the energy ½ m v².
        let mass = mass.unwrap_or(0.0);
        self.energy.iter_mut().for_each(|e| add(e, mass * before * unknown));
        self.energy_given.iter_mut().for_each(|e| add(e, mass * (before - after) * unknown));
        self.restitution.iter_mut().for_each(|r| add(r, (1.0 + r.value) * unknown / before.abs()));
        add(&mut self.first_contact, unknown);
        add(&mut self.before, unknown);
        add(&mut self.after, unknown);
        self
    }

    /// The velocities, and what is computed from them.
    fn velocities(&mut self) -> [&mut dyn Uncertain; 6] {
        [
            &mut self.first_contact,
            &mut self.before,
            &mut self.after,
            &mut self.energy,
            &mut self.energy_given,
            &mut self.restitution,
        ]
    }

    /// Drops the velocities of the group if those of the fits exceed the largest of the record, `reach` in
    /// m/s, by far: the motion near these contacts is not a parabola.
    pub(super) fn within(mut self, reach: f64) -> Group {
        let largest = self.before.value.abs().max(self.after.value.abs());
        if largest.is_nan() || largest <= EXTRAPOLATED * reach {
            return self;
        }
        let energies = [self.energy.as_mut(), self.energy_given.as_mut()].into_iter().flatten();
        let velocities = [&mut self.first_contact, &mut self.before, &mut self.after];
        for estimate in velocities.into_iter().chain(energies) {
            estimate.value = f64::NAN;
        }
        self.restitution = None;
        // Findings about the dropped velocities go with them.
        self.findings.retain(|found| !OF_VELOCITIES.contains(&found.code.as_ref()));
        let doubt = Finding::doubt("drill-velocity-impossible").number("velocity", largest);
        let found = doubt.number("reach", reach).of(&mut self);
        self.findings.push(found);
        self
    }

    /// Means over impacts and the residuals of their fits. With `front` the impacts go towards the struck
    /// mass.
    fn new(members: &[(&Impact, &[Vec<f64>; 2])], front: bool, gap: usize, options: &DrillOptions) -> Group {
        // Over-range impacts are left out of the means, unless all are over-range.
        let clipped = members.iter().filter(|(i, _)| i.clipped).count();
        let used = |i: &Impact| clipped == members.len() || !i.clipped;
        let (own, residuals): (Vec<&Impact>, Vec<&[Vec<f64>; 2]>) =
            members.iter().copied().filter(|(i, _)| used(i)).unzip();
        let mean = |of: &dyn Fn(&Impact) -> f64| Mean::of(&own.iter().map(|i| of(i)).collect::<Vec<f64>>());
        let (before, after, first) = (mean(&|i| i.before), mean(&|i| i.after), mean(&|i| i.first_contact));
        // The uncertainty of the contact's length is the same for all impacts and does not average out.
        let std = |of: Option<f64>| of.unwrap_or(f64::NAN);
        let shared =
            |i: &Impact| (std(i.first_contact_std).powi(2) - std(i.before_std).powi(2)).max(0.0).sqrt();
        let first = Mean { std: first.std.map(|std| std.hypot(mean(&shared).value)), ..first };
        let sides = [&before, &after];
        let lacks = [0, 1].map(|side| lack_of_fit(&residuals, side, sides[side], gap));
        let bias = lacks.map(|lack| lack.map_or(0.0, |lack| lack.bias));
        // Bias of a quantity whose derivatives by the velocities before and after are `parts`.
        let moved = |parts: [f64; 2]| (parts[0] * bias[0]).hypot(parts[1] * bias[1]);
        let estimate = |mean: Mean, parts, unit, method| {
            let std = mean.std.map(|std| std.hypot(moved(parts)));
            Estimate::new(mean.value, std, unit, mean.n, method)
        };
        let energy = |squares: &dyn Fn(&Impact) -> f64, parts: [f64; 2], method| {
            options.mass.map(|m| estimate(mean(&|i| 0.5 * m * squares(i)), parts.map(|v| m * v), "J", method))
        };
        let (phase, directed) = mean_phase(&own);
        let wanders = before.wanders || after.wanders || phase.wanders;
        let phase = if options.turns_from == TurnsFrom::Impacts && own.iter().all(|i| i.phase < ROUNDING) {
            Estimate::new(0.0, None, "1", own.len(), "turns begin at these impacts")
        } else {
            let method = "part of the turn, mean over impacts on the circle";
            Estimate::new(phase.value, phase.std, "1", phase.n, method)
        };
        let (restitution, without) = match restitution(&own, front, options, &moved) {
            Ok(restitution) => (Some(restitution), None),
            Err(found) => (None, Some(found)),
        };
        let mut group = Group {
            n: members.len(),
            clipped,
            share: f64::NAN,
            phase,
            first_contact: estimate(
                first,
                [1.0, 0.0],
                "m/s",
                "parabola up to first contact, mean over impacts",
            ),
            before: estimate(
                before,
                [1.0, 0.0],
                "m/s",
                "parabola continued to the middle of the contact, mean over impacts",
            ),
            after: estimate(
                after,
                [0.0, 1.0],
                "m/s",
                "parabola continued back to the middle of the contact, mean over impacts",
            ),
            energy: energy(&|i| i.before * i.before, [before.value, 0.0], "½ m v² before, mean over impacts"),
            energy_given: energy(
                &|i| i.before * i.before - i.after * i.after,
                [before.value, after.value],
                "½ m (v² before − v² after), mean over impacts",
            ),
            restitution,
            findings: Vec::new(),
            wanders,
            kept: [Kept(true); 2],
        };
        group.findings = group.doubts(&lacks, followed(&own), own.len(), directed);
        group.findings.extend(without);
        group
    }

    /// Doubts about the means, by the impacts over-range, the `lacks` of fit before and after, the number of
    /// impacts that ring among those `used`, and a phase without a direction.
    fn doubts(
        &mut self,
        lacks: &[Option<LackOfFit>; 2],
        rings: usize,
        used: usize,
        directed: bool,
    ) -> Vec<Finding> {
        let mut found = Vec::new();
        if self.clipped > 0 {
            let doubt = Finding::doubt("drill-impacts-over-range").count("n", self.clipped);
            found.push(doubt.count("all", self.n).of(&mut self.velocities()));
        }
        for (lack, side) in lacks.iter().zip(["before", "after"]) {
            // The uncertainty of the velocity includes the bias. How far the phase is off is not known.
            found.extend(lack.map(|LackOfFit { residual, bias }| {
                let doubt = Finding::doubt("drill-lack-of-fit").name("side", side);
                let of_each: &mut [&mut dyn Uncertain] = &mut [&mut self.phase, &mut self.kept[0]];
                doubt.number("residual", residual).number("bias", bias).of(of_each)
            }));
        }
        if rings > 0 {
            found.push(Finding::doubt("drill-ringing").count("n", rings).count("all", used).of(self));
        }
        found.extend((!directed).then(|| Finding::doubt("drill-phase-undirected").of(&mut self.phase)));
        found
    }
}

/// Takes the uncertainties of impacts away that doubts about their groups concern, and those of velocities
/// that are over-range.
pub(super) fn doubt_impacts(impacts: &mut [Impact], groups: &[Group]) {
    for impact in impacts {
        let [instants, velocities] = groups.get(impact.group).map_or([Kept(true); 2], |group| group.kept);
        if !instants.0 {
            impact.instant().doubt();
        }
        if impact.clipped || !velocities.0 {
            impact.velocities().doubt();
        }
    }
}

/// Lack of fit of the parabolas on one side of impacts; `None` where its bias is well below the standard
/// uncertainty of their mean.
fn lack_of_fit(residuals: &[&[Vec<f64>; 2]], side: usize, mean: &Mean, gap: usize) -> Option<LackOfFit> {
    let fits: Vec<&[f64]> = residuals.iter().map(|r| r[side].as_slice()).collect();
    let lack = LackOfFit::of(&fits, gap);
    lack.filter(|l| mean.std.is_some_and(|std| l.bias > BIAS * std))
}

/// Mean phase of impacts on the circle, and whether they cluster around it.
fn mean_phase(own: &[&Impact]) -> (Mean, bool) {
    // Count phases from the point opposite to the mean direction, so that the mean does not wrap.
    let vectors = own.iter().map(|i| (TAU * i.phase).sin_cos());
    let (sin, cos) = vectors.fold((0.0, 0.0), |a, b| (a.0 + b.0, a.1 + b.1));
    let from = f64::atan2(sin, cos) / TAU - 0.5;
    let along = Mean::of(&own.iter().map(|i| (i.phase - from).rem_euclid(1.0)).collect::<Vec<f64>>());
    let undirected = along.n > 3 && sin * sin + cos * cos < DIRECTED * along.n as f64;
    (Mean { value: (from + along.value).rem_euclid(1.0), ..along }, !undirected)
}

/// Number of impacts that follow another one closely; 0 if chance explains them. A velocity that rings shows
/// several jumps for each impact.
fn followed(impacts: &[&Impact]) -> usize {
    let ([first, .., last], gaps) = (impacts, impacts.windows(2).map(|w| w[1].time - w[0].time)) else {
        return 0;
    };
    // Number of turns with an impact; a turn without one, for example in a pause, does not count in the mean
    // distance.
    let turns = 1 + impacts.windows(2).filter(|w| w[1].cycle > w[0].cycle).count();
    let period = (last.time - first.time) / last.cycle.saturating_sub(first.cycle).max(1) as f64;
    let distance = period * turns as f64 / impacts.len() as f64;
    let close = gaps.filter(|gap| *gap < CLOSE * distance).count();
    if close > 1 && close as f64 > ACCIDENTS * impacts.len() as f64 { close } else { 0 }
}

/// R = Σ(v₂⁺ − v₁⁺)/Σv₁⁻ with v₂⁺ = m₁(v₁⁻ − v₁⁺)/m₂ from the balance of momentum, the struck mass at rest
/// before (W. J. Stronge, Impact Mechanics, 2000, section 2.4). Without a struck mass, or away from it (not
/// `front`), v₂⁺ = 0. A mean of the quotients would weigh slow impacts most. The uncertainty is that of the
/// mean of (v₂⁺ − v₁⁺ − R v₁⁻)/mean(v₁⁻), which is the propagated one (delta method). `moved` gives the bias
/// of a quantity from its derivatives by the velocities before and after.
///
/// No restitution is given if most approaches are consistent with 0 or far slower than the separations, as
/// those of a bit, which is struck. Nor is it given if it is negative or above 1 by more than its uncertainty
/// explains. Without an uncertainty, a value above 1 stays.
fn restitution(
    impacts: &[&Impact],
    front: bool,
    options: &DrillOptions,
    moved: &dyn Fn([f64; 2]) -> f64,
) -> Result<Estimate, Finding> {
    let n = impacts.len() as f64;
    let approach = impacts.iter().map(|i| i.before).sum::<f64>() / n;
    let unclear =
        impacts.iter().filter(|i| i.before_std.is_some_and(|std| i.before.abs() < CLEAR * std)).count();
    let driven = impacts.iter().filter(|i| i.after.abs() > DRIVEN * i.before.abs()).count();
    if 2 * unclear.max(driven) > impacts.len() {
        return Err(Finding::caution("drill-not-striking").number("speed", approach));
    }
    let masses = options.mass.zip(options.struck_mass).filter(|_| front);
    let ratio = masses.map_or(0.0, |(mass, struck)| mass / struck);
    let method = match masses {
        Some(_) => "balance of momentum, the struck mass at rest before; ratio of the sums over impacts",
        None => "−after/before, what is struck does not move; ratio of the sums over impacts",
    };
    let separation = |i: &Impact| ratio * (i.before - i.after) - i.after;
    let value = impacts.iter().map(|i| separation(i)).sum::<f64>() / n / approach;
    let off: Vec<f64> = impacts.iter().map(|i| (separation(i) - value * i.before) / approach).collect();
    let biased = moved([(ratio - value) / approach, (1.0 + ratio) / approach]);
    let std = Mean::of(&off).std.map(|std| std.hypot(biased));
    let mut estimate = Estimate::new(value, std, "1", impacts.len(), method);
    match estimate.std {
        Some(std) if value - BEYOND * std > 1.0 || value + BEYOND * std < 0.0 => {
            let doubt = Finding::doubt("drill-restitution-impossible").number("value", value);
            Err(doubt.number("std", std).of(&mut estimate))
        }
        _ => Ok(estimate),
    }
}

#[cfg(test)]
mod tests;

//! The compliance of the contact, taken out of the points.

use super::super::prediction::Kind;
use super::super::simulated::Pace;
use super::data::{Data, Seen, Step};
use super::held::Held;
use super::motion::assigned;
use super::problem::Problem;
use super::setting::Setting;
use super::settle::{Settled, settle};
use super::unknown::{Unknown, coordinates};
use crate::error::Result;
use crate::model::{Compliance, Excitation, Sine, orbits, shown, softened};
use crate::units::notation::quantity;
use std::f64::consts::PI;

/// Rounds after which the corrections have to stand still.
const ROUNDS: usize = 8;
/// Part of a standard deviation by which they then still change at most.
const STILL: f64 = 0.1;

/// Points as they would be without compliance.
#[derive(Debug, Clone)]
pub struct Stiff {
    pub data: Data,
    /// Amplitudes of which that cannot be told; they are no longer seen.
    pub lost: usize,
    /// Coordinates that belong to them.
    pub u: Vec<f64>,
}

/// The points of an answer with the compliance of a contact of `stiffness` (N/m) taken out of them.
///
/// Each amplitude of impacts is divided by what the contact makes of it in the rig found, and the rig found again from the points so
/// corrected, in turn until both stay. With the part of the period in contact s, a change of the rig by δ changes the correction by some
/// sδ: each round leaves about s of the change that was left.
///
/// # Errors
/// If too few points are left.
pub fn stiff(rigid: &Settled<'_>, stiffness: f64, pace: Pace) -> Result<Stiff> {
    // The answer without compliance may be one of which none can be taken out: then from the rig as it was stated.
    let found = led(rigid, &rigid.setting(), stiffness, pace);
    if found.as_ref().is_ok_and(|s| s.lost == 0) {
        return found;
    }
    match (found, led(rigid, &rigid.problem.base, stiffness, pace)) {
        (Ok(a), Ok(b)) => Ok(if b.lost < a.lost { b } else { a }),
        (Err(_), other) => other,
        (found, Err(_)) => found,
    }
}

/// The same from this setting on.
fn led(rigid: &Settled<'_>, from: &Setting, stiffness: f64, pace: Pace) -> Result<Stiff> {
    let problem = &rigid.problem;
    let mut now = without(problem, problem.data, from, stiffness, pace)?;
    for _ in 0..ROUNDS {
        let settled = settle(&now.data, &problem.base, &problem.unknowns, &now.u, pace)?;
        let next = without(problem, &now.data, &settled.setting(), stiffness, pace)?;
        let still = change(&now.data, &next.data) <= STILL;
        now = next;
        if still {
            break;
        }
    }
    Ok(now)
}

/// The points of the problem without what the contact makes of them in this setting. Which motion each shows, `told` tells: points far from
/// their motion may be so for want of the correction.
fn without(
    problem: &Problem<'_>,
    told: &Data,
    setting: &Setting,
    stiffness: f64,
    pace: Pace,
) -> Result<Stiff> {
    let kinds = assigned(told, setting, pace)?.kinds;
    let (data, lost) = corrected(problem.data, setting, &kinds, stiffness);
    Ok(Stiff { data, lost, u: coordinates(setting, &problem.unknowns) })
}

/// Largest change of an amplitude in standard deviations.
fn change(before: &Data, after: &Data) -> f64 {
    let steps = before.steps.iter().zip(&after.steps);
    let pairs = steps.flat_map(|(a, b)| a.seen.iter().zip(&b.seen));
    let one = |pair: (&Option<Seen>, &Option<Seen>)| match pair {
        (Some(a), Some(b)) => (b.amplitude - a.amplitude).abs() / b.std,
        (None, None) => 0.0,
        _ => f64::INFINITY,
    };
    pairs.map(one).fold(0.0, f64::max)
}

/// The points without the compliance, and of how many amplitudes that cannot be told.
fn corrected(data: &Data, setting: &Setting, kinds: &[Option<Kind>], stiffness: f64) -> (Data, usize) {
    let (mut stiff, mut lost) = (data.clone(), 0);
    for (step, kind) in stiff.steps.iter_mut().zip(kinds) {
        if *kind != Some(Kind::Impacting) {
            continue;
        }
        let Some((made, left)) = made(setting, stiffness, setting.force_at(data, step), step.frequency)
        else {
            lost += Step::clear(step).count();
            step.seen = [None, None];
            continue;
        };
        for (seen, made) in step.seen.iter_mut().zip(made) {
            if let Some(seen) = seen {
                seen.amplitude /= made;
                seen.std = (seen.std / made).hypot(left * seen.amplitude);
                seen.limit = seen.limit.map(|l| l / made);
                (seen.soft, seen.left) = (made, left);
            }
        }
    }
    (stiff, lost)
}

/// What the compliance makes of the amplitudes of both masses, as factors, and the part (ωt)² of each that a correction of first order in the
/// time t in contact leaves; `None` where the correction does not hold.
fn made(setting: &Setting, stiffness: f64, force: f64, frequency: f64) -> Option<([f64; 2], f64)> {
    let (rig, sine) = (&setting.rig, Sine { force, frequency });
    let compliance = Compliance::new(rig, stiffness, None).ok()?;
    let found = orbits(rig, force, frequency).ok()?;
    let softened = softened(rig, &Excitation::Sine(sine), &found, &compliance).ok()?;
    let soft = softened.first()?.as_ref()?;
    let rigid = shown(rig, &sine).ok()?.amplitude;
    let made = [0, 1].map(|mass| soft.fundamental[mass] / rigid[mass]);
    let left = (2.0 * PI * soft.share).powi(2);
    made.iter().all(|m| m.is_finite() && *m > 0.0).then_some((made, left))
}

/// Part of the period in contact for which is said what an unknown compliance does.
const SHARE: f64 = 1e-3;

/// What a contact of a thousandth of the period would make of the parameters, where its stiffness is not known: those that it changes by more
/// than their standard uncertainty.
pub fn untold(settled: &Settled<'_>, held: &Held, pace: Pace) -> Option<String> {
    let (problem, setting) = (&settled.problem, settled.setting());
    let used: Vec<f64> = problem.used().map(|(step, _)| problem.data.steps[step].frequency).collect();
    let frequency = used.iter().sum::<f64>() / used.len() as f64;
    // t_c = π√(M/k₃) of a spring.
    let stiffness = setting.rig.reduced_mass() * (PI * frequency / SHARE).powi(2);
    let contact = format!("a contact of a thousandth of the period, {} stiff", quantity(stiffness, "N/m", 2));
    let say = |what: String| {
        format!("Impacts are taken to last no time. {what} Give `stiffness` in [contact] where it is known.")
    };
    let Ok(Some(soft)) = once(settled, stiffness, pace) else {
        return Some(say(format!("What {contact}, would make of the parameters could not be told.")));
    };
    let changed = |i: usize| (soft[i] - settled.minimum.parameters[i]).abs() > held.covariance[(i, i)].sqrt();
    let one = |i: usize| {
        let Unknown { parameter, coordinate, .. } = problem.unknowns[i];
        format!("{} {}", parameter.name(), quantity(coordinate.value(soft[i]), parameter.unit(), 4))
    };
    let moved: Vec<String> =
        (0..soft.len()).filter(|i| held.loose[*i].is_none() && changed(*i)).map(one).collect();
    (!moved.is_empty()).then(|| say(format!("With {contact}, it would be: {}.", moved.join(", "))))
}

/// The parameters found from the points without this compliance: what is left after one round is some thousandth of the change. `None` where
/// that is no least sum of squares, or not where parameters may lie.
fn once(rigid: &Settled<'_>, stiffness: f64, pace: Pace) -> Result<Option<Vec<f64>>> {
    let problem = &rigid.problem;
    let stiff = without(problem, problem.data, &rigid.setting(), stiffness, pace)?;
    let found = settle(&stiff.data, &problem.base, &problem.unknowns, &stiff.u, pace)?;
    let inside = found.held()?.edges.iter().all(Option::is_none);
    Ok((found.agreed && found.minimum.converged && inside).then_some(found.minimum.parameters))
}

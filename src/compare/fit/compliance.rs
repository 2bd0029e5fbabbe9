//! The compliance of the contact, taken out of the points.

use super::{Converged, Data, MotionKind, Problem, Setting, StepAmplitude, SweepStep, assigned};
use crate::error::Result;
use crate::model::{Compliance, Excitation, Sine, orbits, shown, softened};
use std::f64::consts::PI;

/// Rounds of correction and fit: with 2.5 % of the period in contact, the most that can be corrected, three
/// leave 2e-5 of the change.
const ROUNDS: usize = 8;
/// Part of a standard deviation by which the corrections then still change at most.
const STILL: f64 = 0.1;

/// Points as they would be with a rigid contact.
#[derive(Debug, Clone)]
pub struct CorrectedPoints {
    pub data: Data,
    /// Amplitudes for which the contact lasts too long; they are no longer seen.
    pub lost: usize,
    /// Coordinates that belong to them.
    pub u: Vec<f64>,
}

/// The points of an answer without the compliance of a contact of `stiffness` (N/m).
///
/// Each amplitude of impacts is divided by what the contact makes of it in the rig found, and the rig found
/// again from the points so corrected, in turn until both stay. With the part s of the period in contact, a
/// change of the rig by δ changes the correction by some sδ: each round leaves about s of the change that was
/// left.
///
/// # Errors
/// If too few points are left.
pub fn corrected(answer: &Converged<'_>, stiffness: f64) -> Result<CorrectedPoints> {
    let from = |setting: &Setting| corrected_from(answer, setting, stiffness);
    // A rigid answer may be a rig whose contacts last too long to be corrected: then from the rig as it was
    // stated.
    let stated = || from(&answer.least.problem.base);
    match from(&answer.setting()) {
        Ok(found) if found.lost == 0 => Ok(found),
        Ok(found) => Ok(stated().ok().filter(|other| other.lost < found.lost).unwrap_or(found)),
        Err(refusal) => stated().map_err(|_| refusal),
    }
}

fn corrected_from(answer: &Converged<'_>, from: &Setting, stiffness: f64) -> Result<CorrectedPoints> {
    let problem = &answer.least.problem;
    let mut now = without(problem, problem.data, from, stiffness)?;
    for _ in 0..ROUNDS {
        let setting = problem.with(&now.data).converge(&now.u)?.setting();
        let before = now.data;
        now = without(problem, &before, &setting, stiffness)?;
        if change(&before, &now.data) <= STILL {
            break;
        }
    }
    Ok(now)
}

/// The points of the problem without what the contact makes of them in this setting. The motions are those of
/// `latest` points: uncorrected ones may be outliers for want of the correction.
fn without(
    problem: &Problem<'_>,
    latest: &Data,
    setting: &Setting,
    stiffness: f64,
) -> Result<CorrectedPoints> {
    let kinds = assigned(latest, setting, latest.pace)?.kinds;
    let (mut data, mut lost) = (problem.data.clone(), 0);
    for (step, kind) in data.steps.iter_mut().zip(kinds) {
        if kind != Some(MotionKind::Impacting) {
            continue;
        }
        let force = problem.data.force_at(setting, step);
        let Some((factors, left)) = factors(setting, stiffness, force, step.frequency) else {
            lost += SweepStep::clear(step).count();
            step.readings = [None, None];
            continue;
        };
        let readings = step.readings.iter_mut().zip(factors);
        for (reading, factor) in readings.filter_map(|(reading, factor)| Some((reading.as_mut()?, factor))) {
            reading.amplitude /= factor;
            reading.std = (reading.std / factor).hypot(left * reading.amplitude);
            reading.upper_limit = reading.upper_limit.map(|l| l / factor);
            reading.compliance = factor;
        }
    }
    Ok(CorrectedPoints { data, lost, u: problem.coordinates(setting) })
}

/// Largest change of an amplitude in standard deviations.
fn change(before: &Data, after: &Data) -> f64 {
    let readings = |data: &Data| -> Vec<_> { data.steps.iter().flat_map(|s| s.readings.clone()).collect() };
    let one = |(a, b): (&Option<StepAmplitude>, &Option<StepAmplitude>)| match (a, b) {
        (Some(a), Some(b)) => (b.amplitude - a.amplitude).abs() / b.std,
        (None, None) => 0.0,
        _ => f64::INFINITY,
    };
    readings(before).iter().zip(&readings(after)).map(one).fold(0.0, f64::max)
}

/// What the compliance makes of the amplitudes of both masses, as factors, and the part (ωt)² of each that a
/// correction of first order in the time t in contact leaves; `None` where the correction does not hold.
fn factors(setting: &Setting, stiffness: f64, force: f64, frequency: f64) -> Option<([f64; 2], f64)> {
    let (rig, sine) = (&setting.rig, Sine { force, frequency });
    let compliance = Compliance::new(rig, stiffness, None).ok()?;
    let found = orbits(rig, force, frequency).ok()?;
    let softened = softened(rig, &Excitation::Sine(sine), &found, &compliance).ok()?;
    let soft = softened.first()?.as_ref()?;
    let rigid = shown(rig, &sine).ok()?.amplitude;
    let factors = [0, 1].map(|mass| soft.fundamental[mass] / rigid[mass]);
    let left = (2.0 * PI * soft.share).powi(2);
    factors.iter().all(|m| m.is_finite() && *m > 0.0).then_some((factors, left))
}

//! Corrects measured amplitudes for the compliance of the contact.

use super::{Converged, Data, MotionKind, Problem, Setting, StepAmplitude, SweepStep, assigned};
use crate::error::Result;
use crate::model::{Compliance, Excitation, Sine, orbits, shown, softened};
use std::f64::consts::PI;

/// Most rounds of correction and fit. With 2.5 % of the period in contact, the limit of the correction, three
/// rounds reduce the error to 2e-5 of the change.
const ROUNDS: usize = 8;
/// The rounds end when no amplitude changes by more than this many standard deviations.
const SETTLED: f64 = 0.1;

/// Points as they would be with a rigid contact.
#[derive(Debug, Clone)]
pub struct CorrectedPoints {
    pub data: Data,
    /// Number of amplitudes whose contact lasts too long to be corrected; they are left out.
    pub lost: usize,
    /// Coordinates of the rig with which the points were corrected.
    pub u: Vec<f64>,
}

/// The points of a fit, corrected for the compliance of a contact of `stiffness` (N/m).
///
/// Two steps alternate until nothing changes: each amplitude of impacts is divided by the factor of the
/// contact in the fitted rig, and the rig is fitted to the corrected points. With a share s of the period in
/// contact, a change δ of the rig changes the correction by about sδ: each round reduces the error by s.
///
/// # Errors
/// If too few points are left.
pub fn corrected(answer: &Converged<'_>, stiffness: f64) -> Result<CorrectedPoints> {
    let from = |setting: &Setting| corrected_from(answer, setting, stiffness);
    // The fit to uncorrected points may be a rig whose contacts last too long to be corrected. Then the
    // rounds start from the stated rig.
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
        if change(&before, &now.data) <= SETTLED {
            break;
        }
    }
    Ok(now)
}

/// The points of the problem, corrected with the rig and force of this setting. Motions are assigned by the
/// `latest` points, because uncorrected points may look like outliers.
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
        let Some((factors, error)) = factors(setting, stiffness, force, step.frequency) else {
            lost += SweepStep::clear(step).count();
            step.readings = [None, None];
            continue;
        };
        let readings = step.readings.iter_mut().zip(factors);
        for (reading, factor) in readings.filter_map(|(reading, factor)| Some((reading.as_mut()?, factor))) {
            reading.amplitude /= factor;
            reading.std = (reading.std / factor).hypot(error * reading.amplitude);
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

/// Factors by which the compliance changes the amplitudes of both masses, and their relative error (ωt)²: the
/// correction is of first order in the time t in contact. `None` where the correction is not valid.
fn factors(setting: &Setting, stiffness: f64, force: f64, frequency: f64) -> Option<([f64; 2], f64)> {
    let (rig, sine) = (&setting.rig, Sine { force, frequency });
    let compliance = Compliance::new(rig, stiffness, None).ok()?;
    let found = orbits(rig, force, frequency).ok()?;
    let softened = softened(rig, &Excitation::Sine(sine), &found, &compliance).ok()?;
    let soft = softened.first()?.as_ref()?;
    let rigid = shown(rig, &sine).ok()?.amplitude;
    let factors = [0, 1].map(|mass| soft.fundamental[mass] / rigid[mass]);
    let error = (2.0 * PI * soft.share).powi(2);
    factors.iter().all(|m| m.is_finite() && *m > 0.0).then_some((factors, error))
}

//! Parameters of the rig from measured responses.
//!
//! Amplitudes of both masses and directions are compared with what a spectrum would show of the closed-form motions (one impact a cycle,
//! or none). Which motion a step shows, a simulated sweep with the parameters found so far decides; parameters and motions are found in
//! turn until both stay. Steps of any other pattern are left out and counted.

mod calibration;
mod coordinate;
mod data;
mod edge;
mod held;
mod motion;
mod prior;
mod problem;
mod profile;
mod rung;
mod search;
mod setting;
mod settle;
mod shared;
mod stiff;
mod told;
mod unknown;

pub use profile::Profile;
pub use rung::{Block, Rung};

use super::prediction::Kind;
use super::simulated::Pace;
use crate::campaign::{FitEntry, Parameter};
use crate::error::{Error, Result};
use crate::measure::Estimate;
use crate::measure::response::Response;
use crate::model::Rig;
use crate::record::Direction;
use data::Data;
use held::{Held, NORMAL};
use rayon::prelude::*;
use search::{Led, around, search};
use serde::Serialize;
use setting::Setting;
use settle::{Settled, settle};
use stiff::stiff;
use unknown::{Unknown, coordinates};

/// A parameter as it was found.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Fitted {
    /// Parameter.
    pub parameter: Parameter,
    /// Value with its standard uncertainty, `None` where the points do not hold it or the answer contradicts them.
    pub estimate: Estimate,
    /// Where it started.
    pub start: f64,
    /// Within these it lies with 95 % confidence, all other parameters free; `None` where the points do not hold it.
    pub interval: Option<[f64; 2]>,
    /// Whether the points hold it.
    pub identifiable: bool,
    /// Why not.
    pub reason: Option<String>,
    /// What was known of it: value and standard uncertainty.
    pub prior: Option<[f64; 2]>,
    /// Whether that says more of it than the points.
    pub rests_on_prior: bool,
}

/// A point of the fit.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct FitPoint {
    /// Sweep.
    pub sweep: String,
    /// 1 excited, 2 passive.
    pub mass: u8,
    /// Direction of the sweep.
    pub direction: Direction,
    /// Excitation frequency in Hz.
    pub frequency: f64,
    /// Motion it was taken for.
    pub motion: Kind,
    /// Measured amplitude in m.
    pub measured: f64,
    /// Amplitude in m by the parameters found.
    pub fitted: f64,
    /// Residual in stated standard deviations; in those that the residuals tell, where none are stated.
    pub residual: f64,
}

/// Amplitudes that took no part.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize)]
pub struct LeftOut {
    /// They do not stand out of the noise.
    pub faint: usize,
    /// The simulated sweep comes to another pattern than one impact a cycle or none.
    pub other_motion: usize,
    /// The simulated sweep comes to one of these, but they lie five standard deviations from it, and five times the median scatter.
    pub far: usize,
    /// Their motion changed with the parameters from round to round.
    pub wavering: usize,
    /// The contact lasts too long there for the correction of its compliance.
    pub soft: usize,
}

/// What the responses say of the rig.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Fit {
    /// Parameters in the order they were asked for.
    pub parameters: Vec<Fitted>,
    /// Correlations of the same, row by row.
    pub correlations: Vec<Vec<f64>>,
    /// The rig found.
    pub rig: Rig,
    /// Force amplitude in N found or held; the median where each point has its own.
    pub force: f64,
    /// Amplitudes in the fit.
    pub n: usize,
    /// Amplitudes left out.
    pub left_out: LeftOut,
    /// Sum of squared residuals over amplitudes less parameters, by the stated uncertainties: about 1 where model and uncertainties are right;
    /// NaN (null) with no more amplitudes than parameters.
    pub reduced_chi_squared: f64,
    /// Factor on the standard deviations of the data, by which the residuals are larger than stated.
    pub widened: f64,
    /// Probability that white noise shows as much correlation along frequency as the residuals.
    pub whiteness: Option<f64>,
    /// Starting points.
    pub starts: usize,
    /// Of these, how many led to this answer.
    pub agreeing: usize,
    /// Profile of the parameter known worst.
    pub profile: Option<Profile>,
    /// Models of rising order, by what they predict of points that they were not fitted to.
    pub rungs: Vec<Rung>,
    /// Points of the fit.
    pub points: Vec<FitPoint>,
    /// Why no parameter has an uncertainty, where none has: the answer as a whole may be wrong.
    pub doubt: Option<String>,
    /// What a person must know.
    pub warnings: Vec<String>,
}

/// Starting points where none are asked for.
const STARTS: usize = 8;
/// Turns of looking around the best answer.
const TURNS: usize = 6;
/// So many turns in which no answer came nearer by [`BETTER`] are the last.
const IDLE: usize = 2;
/// Part of what all points can miss below which there is nothing better to be found.
const EXPLAINED: f64 = 0.1;
/// One point more within one κ.
const BETTER: f64 = 1.0;
/// Times that the least is looked for from where a profile falls below it.
const AGAIN: usize = 3;

/// Finds the parameters that `entry` asks for from displacement responses, beginning with `rig` and the stated `force` (N; `None`: each
/// point its measured one). With the stiffness of the `contact` (N/m) its compliance is taken out of the points.
///
/// # Errors
/// If nothing can be fitted, the entry is impossible, or there are fewer usable points than parameters.
pub fn fit(
    rig: &Rig,
    force: Option<f64>,
    contact: Option<f64>,
    pace: Pace,
    responses: &[Response],
    entry: &FitEntry,
) -> Result<Fit> {
    rig.check()?;
    let mut data = Data::new(force, responses)?;
    data.calibration = entry.calibration.unwrap_or(0.0);
    data.scattered(entry.scatter.unwrap_or(0.0));
    let base = Setting { rig: *rig, force: data.force };
    found(&data, &base, contact, responses, entry, pace)
}

/// As [`fit`], from points that have been taken.
fn found(
    data: &Data,
    base: &Setting,
    contact: Option<f64>,
    responses: &[Response],
    entry: &FitEntry,
    pace: Pace,
) -> Result<Fit> {
    let unknowns = Unknown::all(entry, base)?;
    let starts = entry.starts.unwrap_or(STARTS);
    let (rigid, ends) = identify(data, base, &unknowns, starts, pace)?;
    let stiff = contact.map(|stiffness| stiff(&rigid, stiffness, pace)).transpose()?;
    let settled = match &stiff {
        None => rigid.clone(),
        Some(stiff) => settle(&stiff.data, base, &unknowns, &stiff.u, pace)?,
    };
    let (mut settled, mut held, profile) = profiled(settled, pace)?;
    settled.contradictions.extend(profile.as_ref().and_then(Profile::missed));
    settled.contradictions.extend(prior::contradictions(&settled, starts, pace));
    settled.contradictions.extend(settled.pulled(&held));
    settled.lost = stiff.as_ref().map_or(0, |s| s.lost);
    if entry.calibration.is_none() {
        held.lose_scale(&settled.problem);
    }
    let mut fit = gathered(&settled, &held, base, profile);
    (fit.starts, fit.agreeing) = (starts, agreeing(&ends, &rigid.minimum.parameters, &rigid.held()?));
    fit.rungs = match stiff {
        None => rung::rungs(&settled, None, responses, pace),
        Some(_) => rung::rungs(&rigid, Some(&settled), responses, pace),
    };
    fit.warnings = told::warnings(&fit, &settled, data);
    if fit.doubt.is_some() {
        fit.warnings.extend(told::scarce(data, motion::assigned(data, base, pace)?.amplitudes(data)));
    } else if contact.is_none() {
        fit.warnings.extend(stiff::untold(&settled, &held, pace));
    }
    fit.warnings.extend(told::unused(entry));
    Ok(fit)
}

/// An answer with how well it is held and the profile of the parameter known worst. Where that falls below the answer, the least was not
/// found: it is looked for from there.
fn profiled(mut best: Settled<'_>, pace: Pace) -> Result<(Settled<'_>, Held, Option<Profile>)> {
    let of = |settled: &Settled<'_>| -> Result<(Held, Option<Profile>)> {
        let held = settled.held()?;
        let profile = profile::profile(settled, &held, held.worst());
        Ok((held, profile))
    };
    let (mut held, mut profile) = of(&best)?;
    for _ in 0..AGAIN {
        let Some(u) = profile.as_ref().and_then(Profile::lower) else { break };
        let next = settle(best.problem.data, &best.problem.base, &best.problem.unknowns, u, pace)?;
        if next.missed > best.missed + BETTER {
            break;
        }
        (held, profile) = of(&next)?;
        best = next;
    }
    Ok((best, held, profile))
}

/// The best answer of several starts, and where each start led that led anywhere.
fn identify<'a>(
    data: &'a Data,
    base: &Setting,
    unknowns: &[Unknown],
    starts: usize,
    pace: Pace,
) -> Result<(Settled<'a>, Vec<Vec<f64>>)> {
    let clear = data.steps.iter().flat_map(data::Step::clear).count();
    let priors = unknowns.iter().filter(|u| u.prior.is_some()).count();
    if clear + priors < unknowns.len() || clear == 0 {
        return Err(Error::refused(format!(
            "{clear} amplitude(s) do not determine {} parameters",
            unknowns.len()
        ))
        .hint("fit fewer parameters, or give priors"));
    }
    let all = |places: &[Vec<f64>]| -> Vec<Result<Settled<'a>>> {
        places.par_iter().map(|u| settle(data, base, unknowns, u, pace)).collect()
    };
    let led = search(data, base, unknowns, starts.max(1));
    let mut found = all(&led.iter().map(|l| l.u.clone()).collect::<Vec<_>>());
    let end = |(settled, led): (&Result<Settled<'a>>, &Led)| {
        Some(vec![settled.as_ref().ok()?.minimum.parameters.clone(); led.starts])
    };
    let ends = found.iter().zip(&led).filter_map(end).flatten().collect();
    // Where the rig is known well, no search is nearer than the rig itself.
    found.extend(all(&[coordinates(base, unknowns)]));
    let (mut best, mut idle) = (nearest(found)?, 0);
    let most = search::MOST * clear as f64;
    for turn in 0..TURNS {
        if idle == IDLE || best.missed < EXPLAINED * most {
            break;
        }
        let around = around(base, unknowns, &best.minimum.parameters, turn);
        match nearest(all(&around)) {
            Ok(next) if next.missed < best.missed - BETTER => (best, idle) = (next, 0),
            _ => idle += 1,
        }
    }
    Ok((best, ends))
}

/// The answer nearest to the points; the first refusal where there is none.
fn nearest(found: Vec<Result<Settled<'_>>>) -> Result<Settled<'_>> {
    let mut best: Option<Settled<'_>> = None;
    let mut refusal = None;
    for one in found {
        match one {
            Ok(one) if best.as_ref().is_none_or(|b| one.missed < b.missed) => best = Some(one),
            Ok(_) => {}
            Err(error) => refusal = refusal.or(Some(error)),
        }
    }
    best.ok_or_else(|| refusal.unwrap_or_else(|| Error::refused("no starting point led to an answer")))
}

/// How many starts led within one standard uncertainty of the answer in every parameter.
fn agreeing(ends: &[Vec<f64>], best: &[f64], held: &Held) -> usize {
    let near = |i: usize, u: f64| (u - best[i]).abs() <= held.covariance[(i, i)].sqrt();
    ends.iter().filter(|end| end.iter().enumerate().all(|(i, u)| near(i, *u))).count()
}

fn gathered(settled: &Settled<'_>, held: &Held, base: &Setting, profile: Option<Profile>) -> Fit {
    let (problem, u) = (&settled.problem, &settled.minimum.parameters);
    let setting = settled.setting();
    // What the profile says of its parameter is nearer to the truth than the slopes at the least.
    let profiled = |i: usize| {
        let profile = profile.as_ref().filter(|p| p.parameter == problem.unknowns[i].parameter)?;
        Some([profile.interval[0]?, profile.interval[1]?])
    };
    let parameters = (0..u.len()).map(|i| fitted(settled, held, base, i, profiled(i))).collect();
    let row = |i: usize| (0..u.len()).map(|j| held.correlation(i, j)).collect();
    let used: Vec<(usize, usize)> = problem.used().collect();
    let stated = if problem.data.guessed { 1.0 } else { problem.scale.sqrt() };
    let points = used.iter().zip(&settled.minimum.residuals).filter_map(|((i, mass), residual)| {
        let step = &problem.data.steps[*i];
        let (kind, seen) = (problem.kinds[*i]?, step.seen[*mass].as_ref()?);
        let (sweep, direction) = &problem.data.sweeps[seen.sweep];
        Some(FitPoint {
            sweep: sweep.clone(),
            mass: *mass as u8 + 1,
            direction: *direction,
            frequency: step.frequency,
            motion: kind,
            measured: seen.amplitude * seen.soft,
            fitted: setting.shows(kind, setting.force_at(problem.data, step), step.frequency)[*mass]
                * seen.soft,
            residual: *residual * stated,
        })
    });
    let clear = problem.data.steps.iter().flat_map(data::Step::clear).count();
    Fit {
        parameters,
        correlations: (0..u.len()).map(row).collect(),
        rig: setting.rig,
        force: setting.force,
        n: used.len(),
        left_out: LeftOut {
            faint: problem.data.faint,
            other_motion: (clear - used.len()).saturating_sub(settled.wavering + settled.far),
            far: settled.far,
            wavering: settled.wavering,
            soft: settled.lost,
        },
        reduced_chi_squared: settled.reduced,
        widened: problem.scale.sqrt(),
        whiteness: settled.whiteness.p_value,
        starts: 0,
        agreeing: 0,
        profile,
        rungs: Vec::new(),
        points: points.collect(),
        doubt: settled.doubt(),
        warnings: Vec::new(),
    }
}

fn fitted(
    settled: &Settled<'_>,
    held: &Held,
    base: &Setting,
    i: usize,
    interval: Option<[f64; 2]>,
) -> Fitted {
    let u = settled.minimum.parameters[i];
    let Unknown { parameter, coordinate, prior } = settled.problem.unknowns[i];
    let std = held.covariance[(i, i)].sqrt();
    let reason = settled.doubt().or_else(|| held.loose[i].clone());
    let slope = coordinate.slope(u).abs();
    let exact = |p: &Parameter| settled.problem.unknowns.iter().all(|u| u.parameter != *p);
    let mut exact: Vec<&str> =
        [Parameter::M1, Parameter::M2].iter().filter(|p| exact(p)).map(|p| p.name()).collect();
    let corrected = |step: &data::Step| step.seen.iter().flatten().any(|seen| seen.soft != 1.0);
    if settled.problem.data.steps.iter().any(corrected) {
        exact.push("the stiffness of the contact");
    }
    let method = "least squares of both masses and directions by the closed form";
    let method = match exact.as_slice() {
        [] => method.to_owned(),
        some => format!("{method}, {} taken as exact", some.join(", ")),
    };
    // A prior adds 1/s² to the reciprocal of the variance that all else leaves, exactly where the model is linear.
    let rests = prior.is_some_and(|[_, s]| (std * slope).powi(2) > 0.5 * s * s);
    Fitted {
        parameter,
        estimate: Estimate::new(
            settled.setting().get(parameter),
            reason.is_none().then_some(std * slope),
            parameter.unit(),
            settled.problem.rows().0,
            method,
        ),
        start: base.get(parameter),
        interval: reason.is_none().then(|| interval.unwrap_or_else(|| coordinate.interval(u, NORMAL * std))),
        identifiable: reason.is_none(),
        reason,
        prior,
        rests_on_prior: rests,
    }
}

#[cfg(test)]
mod tests;

//! Parameters of the rig from measured responses.
//!
//! Amplitudes of both masses and directions are compared with what a spectrum would show of the closed-form motions (one impact a cycle,
//! or none). Which motion a step shows, a simulated sweep with the parameters found so far decides; parameters and motions are found in
//! turn until both stay. Steps of any other pattern are left out and counted.

mod answer;
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

pub use answer::{Fit, FitPoint, Fitted, LeftOut};
pub use profile::Profile;
pub use rung::{Block, Rung};

use super::simulated::Pace;
use crate::campaign::FitEntry;
use crate::error::{Error, Result};
use crate::measure::response::Response;
use crate::model::Rig;
use answer::gathered;
use data::Data;
use held::Held;
use rayon::prelude::*;
use search::{Led, around, search};
use setting::Setting;
use settle::{Settled, settle};
use stiff::stiff;
use unknown::{Unknown, coordinates};

/// Starting points where none are asked for.
const STARTS: usize = 8;
/// Relative standard uncertainty of calibrations where none is stated: that of a good sensor. Amplitudes alone cannot tell it, and all that
/// grows with them (gap, force, masses) is as uncertain.
const ASSUMED: f64 = 0.01;
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
    data.calibration = entry.calibration.unwrap_or(ASSUMED);
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
    let (mut settled, held, profile) = profiled(settled, pace)?;
    settled.contradictions.extend(profile.as_ref().and_then(Profile::missed));
    settled.contradictions.extend(prior::contradictions(&settled, starts, pace));
    settled.contradictions.extend(settled.pulled(&held));
    settled.lost = stiff.as_ref().map_or(0, |s| s.lost);
    let mut fit = gathered(&settled, &held, base, profile);
    (fit.starts, fit.agreeing) = (starts, agreeing(&ends, &rigid.minimum.parameters, &rigid.held()?));
    fit.rungs = match stiff {
        None => rung::rungs(&settled, None, responses, pace),
        Some(_) => rung::rungs(&rigid, Some(&settled), responses, pace),
    };
    fit.warnings = told::warnings(&fit, &settled);
    if fit.doubt.is_some() {
        fit.warnings.extend(told::scarce(data, motion::assigned(data, base, pace)?.amplitudes(data)));
    } else if contact.is_none() {
        fit.warnings.extend(stiff::untold(&settled, &held, pace));
    }
    if entry.calibration.is_none() {
        // Nothing is more important but that there is no uncertainty.
        fit.warnings.insert(usize::from(fit.doubt.is_some()), told::assumed(data.calibration, entry));
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

#[cfg(test)]
mod tests;

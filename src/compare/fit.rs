//! Fits parameters of the rig to measured responses.
//!
//! Amplitudes of both masses and directions are compared with those of the closed-form motions (one impact
//! a cycle, or none) in a spectrum. A simulated sweep with the parameters found so far decides which motion
//! a step shows. Motions and parameters are updated in turn until both stay the same. Steps of any other
//! pattern are left out and counted.
//!
//! [`data`] → [`problem`] (weighted residuals) → [`search`] (starting points) → [`converge`] (motions and
//! parameters in turn) → [`answer`].

mod answer;
mod compliance;
mod converge;
mod data;
pub mod design;
mod hold_out;
mod problem;
mod search;
mod uncertainty;
mod unknown;

pub use answer::{Fit, FitPoint, FittedParameter, LeftOut};
pub use hold_out::{Block, Rung};
pub(super) use uncertainty::covariance;
pub use uncertainty::{Profile, Unidentified};

use super::forcing::range;
use super::pair::reached;
use super::predicting::Swept;
use super::prediction::{Motion, MotionKind, motions};
use super::simulated::{Pace, Simulated, simulated_briefly};
use crate::campaign::FitEntry;
use crate::error::{Error, Result};
use crate::measure::response::Response;
use crate::model::Rig;
use answer::AssessedFit;
use compliance::corrected;
use converge::{Converged, LeastSquares, assigned};
use data::{Data, GUESS, StepAmplitude, SweepStep};
use hold_out::rungs;
use problem::{Problem, shown};
use rayon::prelude::*;
use search::{FINE_KAPPA, LocalMinimum, distances};
use uncertainty::{NORMAL, Uncertainty, profile};
use unknown::{Setting, Unknown};

/// Default number of starting points.
const STARTS: usize = 8;
/// Largest number of turns of the search around the best answer, and of turns in a row without a better
/// one.
const TURNS: usize = 6;
const IDLE: usize = 2;
/// Smallest reduction of the unexplained distance by which an answer is better: that of one more point
/// explained to within one κ.
const BETTER: f64 = 1.0;
/// Relative standard uncertainty of calibrations where none is stated: that of a good sensor. Amplitudes do
/// not reveal a calibration error, which scales gap, force and masses.
const ASSUMED: f64 = 0.01;

/// Fits the parameters of `entry` to displacement responses, starting from `rig` and the stated `force` (N;
/// `None`: the measured force of each point). With the stiffness of the `contact` (N/m) the amplitudes are
/// corrected for its compliance.
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
    let mut data = Data::new(force, responses, pace)?;
    data.calibration = entry.calibration.unwrap_or(ASSUMED);
    data.scattered(entry.scatter.unwrap_or(0.0));
    let base = Setting { rig: *rig, force: data.force };
    found(&data, &base, contact, responses, entry)
}

/// As [`fit`], for given points.
fn found(
    data: &Data,
    base: &Setting,
    contact: Option<f64>,
    responses: &[Response],
    entry: &FitEntry,
) -> Result<Fit> {
    let problem = Problem::new(data, base, Unknown::all(entry, base)?);
    let starts = entry.starts.unwrap_or(STARTS);
    let (rigid, ends) = identify(&problem, starts)?;
    let corrected = contact.map(|stiffness| corrected(&rigid, stiffness)).transpose()?;
    let soft = corrected.as_ref().map(|soft| problem.with(&soft.data).converge(&soft.u)).transpose()?;
    let rungs = rungs(&rigid, soft.as_ref(), responses);
    let agreeing = agreeing(&ends, &rigid)?;
    let answer = AssessedFit::new(soft.unwrap_or(rigid), corrected.as_ref().map(|soft| soft.lost))?;
    let mut fit = Fit { starts, agreeing, rungs, ..answer.fit(base) };
    let doubts = answer.unidentified(&mut fit);
    fit.findings.extend(doubts);
    fit.findings.extend(answer.cautions(&fit, entry));
    Ok(fit)
}

/// The best answer of several starts, and where each start ended.
fn identify<'a>(problem: &Problem<'a>, starts: usize) -> Result<(Converged<'a>, Vec<LocalMinimum>)> {
    problem.enough(problem.data.clear())?;
    // The stated rig is a start as well: where it is known well, no search comes nearer. It counts as an
    // end that no start reached.
    let stated = LocalMinimum { u: problem.coordinates(&problem.base), starts: 0 };
    let reached: Vec<LocalMinimum> = problem.search(starts).into_iter().chain([stated]).collect();
    let found: Vec<Result<Converged<'a>>> = reached.par_iter().map(|end| problem.converge(&end.u)).collect();
    let ends = found.iter().zip(&reached).filter_map(|(found, end)| {
        Some(LocalMinimum { u: found.as_ref().ok()?.least.minimum.parameters.clone(), ..*end })
    });
    let ends = ends.collect();
    let (mut best, mut idle) = (nearest(found)?, 0);
    for turn in 0..TURNS {
        let places = problem.around(&best.least.minimum.parameters, turn);
        match nearest(places.par_iter().map(|u| problem.converge(u)).collect()) {
            Ok(next) if next.unexplained < best.unexplained - BETTER => (best, idle) = (next, 0),
            _ if idle + 1 == IDLE => break,
            _ => idle += 1,
        }
    }
    Ok((best, ends))
}

/// The answer with the smallest unexplained distance; the first refusal where there is none.
fn nearest(found: Vec<Result<Converged<'_>>>) -> Result<Converged<'_>> {
    let mut refusals = Vec::new();
    let answers = found.into_iter().filter_map(|one| one.map_err(|refusal| refusals.push(refusal)).ok());
    let best = answers.reduce(|best, one| if one.unexplained < best.unexplained { one } else { best });
    let refused = || Error::refused("no start led to an answer");
    best.ok_or_else(|| refusals.into_iter().next().unwrap_or_else(refused))
}

/// Number of starts that ended within one standard uncertainty of the answer in every parameter.
fn agreeing(ends: &[LocalMinimum], answer: &Converged<'_>) -> Result<usize> {
    let (best, uncertainty) = (&answer.least.minimum.parameters, Uncertainty::new(&answer.least)?);
    let near = |(i, u): (usize, &f64)| (u - best[i]).abs() <= uncertainty.std(i);
    Ok(ends.iter().filter(|end| end.u.iter().enumerate().all(near)).map(|end| end.starts).sum())
}

#[cfg(test)]
mod tests;

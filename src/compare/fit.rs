//! Parameters of the rig from measured responses.
//!
//! Amplitudes of both masses and directions are compared with what a spectrum would show of the closed-form motions (one impact a cycle,
//! or none). Which motion a step shows, a simulated sweep with the parameters found so far decides; parameters and motions are found in
//! turn until both stay. Steps of any other pattern are left out and counted.

mod coordinate;
mod data;
mod held;
mod motion;
mod problem;
mod profile;
mod rung;
mod search;
mod setting;
mod settle;
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
use held::Held;
use rayon::prelude::*;
use search::{Found, search, unexplained};
use serde::Serialize;
use setting::Setting;
use settle::{Settled, settle};
use unknown::Unknown;

/// A parameter as it was found.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Fitted {
    /// Parameter.
    pub parameter: Parameter,
    /// Value with its standard uncertainty, `None` where the points do not hold it.
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
    /// Residual in standard deviations.
    pub residual: f64,
}

/// Amplitudes that took no part.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize)]
pub struct LeftOut {
    /// They do not stand out of the noise.
    pub faint: usize,
    /// The simulated sweep comes to another pattern than one impact a cycle or none, or they lie far from these: ten
    /// standard deviations, and ten times the median.
    pub other_motion: usize,
    /// Their motion changed with the parameters from round to round.
    pub wavering: usize,
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
    /// Sum of squared residuals over amplitudes less parameters, by the stated uncertainties: about 1 where model and uncertainties are right.
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
    /// What a person must know.
    pub warnings: Vec<String>,
}

/// Starting points where none are asked for.
const STARTS: usize = 8;
/// Answers of the search that are looked at more closely.
const CLOSER: usize = 3;

/// Finds the parameters that `entry` asks for from displacement responses, beginning with `rig` and the stated `force` (N; `None`: each
/// point its measured one).
///
/// # Errors
/// If nothing can be fitted, the entry is impossible, or there are fewer usable points than parameters.
pub fn fit(
    rig: &Rig,
    force: Option<f64>,
    pace: Pace,
    responses: &[Response],
    entry: &FitEntry,
) -> Result<Fit> {
    rig.check()?;
    let data = Data::new(force, responses)?;
    let base = Setting { rig: *rig, force: data.force, contact: None };
    let unknowns = Unknown::all(entry, &base)?;
    let starts = entry.starts.unwrap_or(STARTS);
    let (settled, found) = identify(&data, &base, &unknowns, starts, pace)?;
    let held = Held::new(&settled.problem, &settled.minimum.parameters, &settled.minimum.jacobian)?;
    let profile = profile::profile(&settled, &held, held.worst());
    let mut fit = gathered(&settled, &held, &base, profile);
    (fit.starts, fit.agreeing) = (starts, agreeing(&found));
    fit.rungs = rung::rungs(&settled, responses, entry.contact_stiffness);
    fit.warnings = told::warnings(&fit, &settled, &data);
    Ok(fit)
}

/// The best answer of several starts.
fn identify<'a>(
    data: &'a Data,
    base: &Setting,
    unknowns: &[Unknown],
    starts: usize,
    pace: Pace,
) -> Result<(Settled<'a>, Vec<Found>)> {
    let clear = data.steps.iter().flat_map(data::Step::clear).count();
    let priors = unknowns.iter().filter(|u| u.prior.is_some()).count();
    if clear + priors < unknowns.len() || clear == 0 {
        return Err(Error::refused(format!(
            "{clear} amplitude(s) do not determine {} parameters",
            unknowns.len()
        ))
        .hint("fit fewer parameters, or give priors"));
    }
    let found = search(data, base, unknowns, starts.max(1));
    let mut distinct: Vec<&Found> = Vec::new();
    for one in &found {
        if distinct.iter().all(|d| !same(d, one)) && one.cost <= 2.0 * found[0].cost + 1.0 {
            distinct.push(one);
        }
    }
    let settled: Vec<Result<Settled<'a>>> =
        distinct.par_iter().take(CLOSER).map(|f| settle(data, base, unknowns, &f.u, pace)).collect();
    let mut best: Option<(f64, Settled<'a>)> = None;
    let mut refusal = None;
    for one in settled {
        match one {
            Ok(settled) => {
                let cost = unexplained(data, &settled.setting(), &settled.problem.kinds);
                if best.as_ref().is_none_or(|b| cost < b.0) {
                    best = Some((cost, settled));
                }
            }
            Err(error) => refusal = refusal.or(Some(error)),
        }
    }
    match best {
        Some((_, settled)) => Ok((settled, found)),
        None => Err(refusal.unwrap_or_else(|| Error::refused("no starting point led to an answer"))),
    }
}

/// Whether two starts led to the same.
fn same(a: &Found, b: &Found) -> bool {
    (a.cost - b.cost).abs() <= 0.01 * a.cost.max(b.cost) + 1e-6
}

fn agreeing(found: &[Found]) -> usize {
    found.first().map_or(0, |best| found.iter().filter(|f| same(best, f)).count())
}

/// Normal deviate that is exceeded on both sides together in 5 % of cases.
const NORMAL: f64 = 1.959_964;

fn gathered(settled: &Settled<'_>, held: &Held, base: &Setting, profile: Option<Profile>) -> Fit {
    let (problem, u) = (&settled.problem, &settled.minimum.parameters);
    let setting = settled.setting();
    let parameters = (0..u.len()).map(|i| fitted(settled, held, base, i)).collect();
    let row = |i: usize| (0..u.len()).map(|j| held.correlation(i, j)).collect();
    let used: Vec<(usize, usize)> = problem.used().collect();
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
            measured: seen.amplitude,
            fitted: setting.shows(kind, setting.force_at(problem.data, step), step.frequency)[*mass],
            residual: *residual,
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
            other_motion: (clear - used.len()).saturating_sub(settled.wavering),
            wavering: settled.wavering,
        },
        reduced_chi_squared: settled.reduced,
        widened: problem.scale.sqrt(),
        whiteness: settled.whiteness.p_value,
        starts: 0,
        agreeing: 0,
        profile,
        rungs: Vec::new(),
        points: points.collect(),
        warnings: Vec::new(),
    }
}

fn fitted(settled: &Settled<'_>, held: &Held, base: &Setting, i: usize) -> Fitted {
    let u = settled.minimum.parameters[i];
    let Unknown { parameter, coordinate, prior } = settled.problem.unknowns[i];
    let std = held.covariance[(i, i)].sqrt();
    let reason = held.loose[i].clone();
    let slope = coordinate.slope(u);
    let method = "least squares of both masses and directions by the closed form";
    let value = coordinate.value(u);
    // A prior adds 1/s² to the reciprocal of the variance that all else leaves, exactly where the model is linear.
    let rests = prior.is_some_and(|[_, s]| (std * slope).powi(2) > 0.5 * s * s);
    Fitted {
        parameter,
        estimate: Estimate::new(
            value,
            reason.is_none().then_some(std * slope),
            parameter.unit(),
            settled.problem.rows().0,
            method,
        ),
        start: base.get(parameter),
        interval: reason.is_none().then(|| [-NORMAL, NORMAL].map(|z| coordinate.value(u + z * std))),
        identifiable: reason.is_none(),
        reason,
        prior,
        rests_on_prior: rests,
    }
}

#[cfg(test)]
mod tests;

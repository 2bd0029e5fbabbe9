//! What a fit says of the rig.

use super::super::prediction::Kind;
use super::data::Step;
use super::held::{Held, NORMAL};
use super::profile::Profile;
use super::rung::Rung;
use super::setting::Setting;
use super::settle::Settled;
use super::unknown::Unknown;
use crate::campaign::Parameter;
use crate::measure::Estimate;
use crate::model::Rig;
use crate::record::Direction;
use serde::Serialize;

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

/// The answer of a settled search.
pub fn gathered(settled: &Settled<'_>, held: &Held, base: &Setting, profile: Option<Profile>) -> Fit {
    let (problem, u) = (&settled.problem, &settled.minimum.parameters);
    let setting = settled.setting();
    // What the profile says of its parameter is nearer to the truth than the slopes at the least.
    let profiled = |i: usize| {
        let profile = profile.as_ref().filter(|p| p.parameter == problem.unknowns[i].parameter)?;
        Some([profile.interval[0]?, profile.interval[1]?])
    };
    let method = method(settled);
    let parameters = (0..u.len()).map(|i| fitted(settled, held, base, i, profiled(i), &method)).collect();
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
    let clear = problem.data.steps.iter().flat_map(Step::clear).count();
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

/// How the parameters were found, and what is taken as exact.
fn method(settled: &Settled<'_>) -> String {
    let problem = &settled.problem;
    let exact = |p: &Parameter| problem.unknowns.iter().all(|u| u.parameter != *p);
    let masses = [Parameter::M1, Parameter::M2].into_iter().filter(exact);
    let mut exact: Vec<&str> = masses.map(Parameter::name).collect();
    if problem.data.corrected() {
        exact.push("the stiffness of the contact");
    }
    let method = "least squares of both masses and directions by the closed form";
    if exact.is_empty() {
        method.to_owned()
    } else {
        format!("{method}, {} taken as exact", exact.join(", "))
    }
}

/// Parameter number `i`, with the interval that its profile shows.
pub fn fitted(
    settled: &Settled<'_>,
    held: &Held,
    base: &Setting,
    i: usize,
    interval: Option<[f64; 2]>,
    method: &str,
) -> Fitted {
    let u = settled.minimum.parameters[i];
    let Unknown { parameter, coordinate, prior } = settled.problem.unknowns[i];
    let std = held.covariance[(i, i)].sqrt();
    let reason = settled.doubt().or_else(|| held.loose[i].clone());
    let slope = coordinate.slope(u).abs();
    // A prior adds 1/s² to the reciprocal of the variance that all else leaves, exactly where the model is linear.
    let rests = prior.is_some_and(|[_, s]| (std * slope).powi(2) > 0.5 * s * s);
    Fitted {
        parameter,
        estimate: Estimate::new(
            settled.setting().get(parameter),
            reason.is_none().then_some(std * slope),
            parameter.unit(),
            settled.problem.rows().0,
            method.to_owned(),
        ),
        start: base.get(parameter),
        interval: reason.is_none().then(|| interval.unwrap_or_else(|| coordinate.interval(u, NORMAL * std))),
        identifiable: reason.is_none(),
        reason,
        prior,
        rests_on_prior: rests,
    }
}

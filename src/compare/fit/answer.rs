//! What a fit says of the rig, and what a person must know of it.

use super::{
    Converged, GUESS, MotionKind, NORMAL, Profile, Rung, Setting, SweepStep, Uncertainty, Unidentified,
    Unknown, profile,
};
use crate::campaign::FitEntry;
use crate::error::Result;
use crate::measure::Estimate;
use crate::measure::residuals::student;
use crate::model::{Parameter, Rig};
use crate::record::{Direction, Finding};
use serde::Serialize;
use std::borrow::Cow;

/// A parameter as it was found.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct FittedParameter {
    /// Parameter.
    pub parameter: Parameter,
    /// Value with its standard uncertainty, `None` where it is not identifiable.
    pub estimate: Estimate,
    /// Where it started.
    pub start: f64,
    /// 95 % confidence interval, all other parameters free; `None` where it is not identifiable.
    pub interval: Option<[f64; 2]>,
    /// Whether the points determine it.
    pub identifiable: bool,
    /// Why not.
    pub reason: Option<Unidentified>,
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
    pub motion: MotionKind,
    /// Measured amplitude in m.
    pub measured: f64,
    /// Amplitude in m by the parameters found.
    pub fitted: f64,
    /// Residual in stated standard deviations; in those of the residuals themselves, where none are stated.
    pub residual: f64,
}

/// Amplitudes that took no part.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize)]
pub struct LeftOut {
    /// Below the noise floor.
    pub faint: usize,
    /// The simulated sweep shows another pattern than one impact a cycle or none.
    pub other_motion: usize,
    /// Outliers: five standard deviations, and five times the median scatter, from the motion of the
    /// simulated sweep.
    pub far: usize,
    /// Their motion changed with the parameters from round to round.
    pub wavering: usize,
    /// The contact lasts too long there for the correction of its compliance.
    pub soft: usize,
}

impl LeftOut {
    /// All that lie above the noise floor.
    pub fn clear(&self) -> usize {
        self.other_motion + self.far + self.wavering + self.soft
    }
}

/// What the responses say of the rig.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Fit {
    /// Parameters in the order they were asked for.
    pub parameters: Vec<FittedParameter>,
    /// Correlations of the same, row by row.
    pub correlations: Vec<Vec<f64>>,
    /// The rig found. The overlay and its scores are of the rig as it was stated.
    pub rig: Rig,
    /// Force amplitude in N, found or fixed; the median where each point has its own.
    pub force: f64,
    /// Amplitudes in the fit.
    pub n: usize,
    /// Amplitudes left out.
    pub left_out: LeftOut,
    /// Sum of squared residuals over degrees of freedom, by the stated uncertainties: about 1 where model
    /// and uncertainties are right; NaN (null) without degrees of freedom.
    pub reduced_chi_squared: f64,
    /// Factor on the standard deviations of the data, by which the residuals are larger than stated.
    pub widened: f64,
    /// Probability that white noise shows as much correlation along frequency as the residuals.
    pub whiteness: Option<f64>,
    /// Starting points.
    pub starts: usize,
    /// Of these, how many led to this answer.
    pub agreeing: usize,
    /// Profile of the parameter with the largest relative uncertainty.
    pub profile: Option<Profile>,
    /// Models of rising order, by what they predict of points that they were not fitted to.
    pub rungs: Vec<Rung>,
    /// Points of the fit.
    pub points: Vec<FitPoint>,
    /// Code of the first finding that takes the uncertainty of all parameters away, where there is one.
    pub doubt: Option<Cow<'static, str>>,
    /// What a person must know; doubts of the whole answer come first.
    pub findings: Vec<Finding>,
}

/// A converged search with what its sum of squares says.
pub struct AssessedFit<'a> {
    pub found: Converged<'a>,
    pub uncertainty: Uncertainty,
    pub profile: Option<Profile>,
    /// Amplitudes for which the contact lasts too long; `None` with rigid impacts.
    pub lost: Option<usize>,
}

impl<'a> AssessedFit<'a> {
    /// Of a search in which `lost` amplitudes were no longer seen.
    ///
    /// # Errors
    /// As [`Uncertainty::new`].
    pub fn new(found: Converged<'a>, lost: Option<usize>) -> Result<AssessedFit<'a>> {
        let uncertainty = Uncertainty::new(&found.least)?;
        let profile = profile(&found.least, &uncertainty, uncertainty.worst());
        Ok(AssessedFit { found, uncertainty, profile, lost })
    }
}

/// How the parameters are found; all that is not fitted is taken as exact.
const METHOD: &str = "least squares of both masses and directions by the closed form";

impl AssessedFit<'_> {
    /// The result, but for starts, rungs and cautions.
    pub fn fit(&self, base: &Setting) -> Fit {
        let (least, setting) = (&self.found.least, self.found.setting());
        let (problem, n) = (&least.problem, least.minimum.parameters.len());
        let (data, used) = (problem.data, problem.used().collect::<Vec<_>>());
        let row = |i: usize| (0..n).map(|j| self.uncertainty.correlation(i, j)).collect();
        let stated = if data.guessed { 1.0 } else { problem.scale.sqrt() };
        let points =
            used.iter().zip(&least.minimum.residuals).filter_map(|((i, mass, reading), residual)| {
                let (step, kind) = (&data.steps[*i], problem.kinds[*i]?);
                let (sweep, direction) = data.sweeps[reading.sweep].clone();
                Some(FitPoint {
                    sweep,
                    mass: *mass as u8 + 1,
                    direction,
                    frequency: step.frequency,
                    motion: kind,
                    measured: reading.amplitude * reading.compliance,
                    fitted: data.shows(&setting, kind, step)[*mass] * reading.compliance,
                    residual: *residual * stated,
                })
            });
        let (far, wavering, findings) = (self.found.far, self.found.wavering, self.doubts());
        let doubt = findings.first().map(|doubt| doubt.code.clone());
        Fit {
            parameters: (0..n).map(|i| self.fitted(base, i, doubt.is_some())).collect(),
            correlations: (0..n).map(row).collect(),
            rig: setting.rig,
            force: setting.force,
            n: used.len(),
            left_out: LeftOut {
                faint: data.steps.iter().flat_map(SweepStep::faint).count(),
                other_motion: (data.clear() - used.len()).saturating_sub(wavering + far),
                far,
                wavering,
                soft: self.lost.unwrap_or(0),
            },
            reduced_chi_squared: least.reduced,
            widened: problem.scale.sqrt(),
            whiteness: least.whiteness.p_value,
            starts: 0,
            agreeing: 0,
            profile: self.profile.clone(),
            rungs: Vec::new(),
            points: points.collect(),
            doubt,
            findings,
        }
    }

    /// The parameter number `i`.
    pub fn fitted(&self, base: &Setting, i: usize, in_doubt: bool) -> FittedParameter {
        let (problem, u) = (&self.found.least.problem, self.found.least.minimum.parameters[i]);
        let Unknown { parameter, coordinate, prior } = problem.unknowns[i];
        let reason = if in_doubt { Some(Unidentified::InDoubt) } else { self.uncertainty.unidentified[i] };
        let (value, std, identifiable) = (self.found.setting().get(parameter), self.std(i), reason.is_none());
        // The profile of its parameter is nearer to the truth than the slopes at the least.
        let profile = self.profile.as_ref().filter(|p| p.parameter == parameter);
        let profiled = profile.and_then(|p| Some([p.interval[0]?, p.interval[1]?]));
        let sloped = || coordinate.interval(u, NORMAL * self.uncertainty.std(i));
        let (unit, n) = (parameter.unit(), problem.rows().0);
        FittedParameter {
            parameter,
            estimate: Estimate::new(value, identifiable.then_some(std), unit, n, METHOD),
            start: base.get(parameter),
            interval: identifiable.then(|| profiled.unwrap_or_else(sloped)),
            identifiable,
            reason,
            prior,
            // A prior adds 1/s² to the reciprocal of the variance that all else leaves, exactly where the
            // model is linear.
            rests_on_prior: prior.is_some_and(|[_, s]| std.powi(2) > 0.5 * s * s),
        }
    }

    /// Standard uncertainty of a parameter in its unit.
    pub fn std(&self, i: usize) -> f64 {
        let least = &self.found.least;
        let slope = least.problem.unknowns[i].coordinate.slope(least.minimum.parameters[i]);
        self.uncertainty.std(i) * slope.abs()
    }
}

/// A prior and the points contradict each other by so many standard uncertainties of both: chance does so in
/// one of 1.7 million cases.
const APART: f64 = 5.0;
/// Smallest part of a prior's variance that the points can have taken away and be told from rounding.
const TAKEN: f64 = 0.01;
/// Standard deviations by which the points must pull a parameter over a bound to contradict it: chance does
/// so in one of 700 cases.
const PULLED: f64 = 3.0;
/// One standard uncertainty raises the sum of squares by 1: a profile that falls by as much has found another
/// answer.
const FALL: f64 = 1.0;
/// Part of the amplitudes that may be outliers, or lost to a long contact, before the answer is in doubt.
const LOST: f64 = 0.1;
/// χ²/ν beyond which residuals say more of the model than of noise: what it lacks moves parameters by more
/// than is left of it in the residuals, which the parameters take up as far as they can.
const POOR: f64 = 1.25;
/// A force that differs by more than this part is another one: a load cell is calibrated to 1 or 2 %.
const OTHER: f64 = 0.05;

impl AssessedFit<'_> {
    /// Why the answer as a whole may be wrong, and its uncertainties mean nothing.
    pub fn doubts(&self) -> Vec<Finding> {
        let (least, found, problem) = (&self.found.least, &self.found, &self.found.least.problem);
        let (n, freedom, guessed) = (problem.rows().0, problem.freedom(), problem.data.guessed);
        let many = |doubt: Finding, key, part: usize| {
            let many = part as f64 > LOST * (n + part) as f64;
            many.then(|| doubt.count(key, part).count("n", n + part))
        };
        let poor = least.reduced > POOR && (least.beyond_chance() || least.whiteness.rejected());
        let scaled = guessed || least.reduced > 1.0;
        let of_all = [
            many(Finding::doubt("contact-too-long"), "lost", self.lost.unwrap_or(0)),
            many(Finding::doubt("many-outliers"), "outliers", found.far),
            (!guessed && poor).then(|| Finding::doubt("lack-of-fit").number("ratio", least.reduced.sqrt())),
            (scaled && student(freedom).is_none())
                .then(|| Finding::doubt("too-few-residuals").count("freedom", freedom)),
            (!found.agreed).then(|| Finding::doubt("motions-not-settled")),
            (!least.minimum.converged).then(|| Finding::doubt("least-squares-not-reached")),
        ];
        self.contradictions().into_iter().chain(of_all.into_iter().flatten()).collect()
    }

    /// Priors and bounds that the points contradict, and a least sum of squares that lies elsewhere.
    fn contradictions(&self) -> Vec<Finding> {
        let (problem, setting) = (&self.found.least.problem, self.found.setting());
        let mut found = Vec::new();
        for (i, unknown) in problem.unknowns.iter().enumerate() {
            let (name, unit) = (unknown.parameter.name(), unknown.parameter.unit());
            let pulled = |doubt: Finding, deviations| doubt.about(name).number("deviations", deviations);
            if let Some([known, std]) = unknown.prior {
                // The answer lies (s² − p²)/s² of the way from the prior, of uncertainty s, to what the
                // points alone say, p being its own: over √(s² − p²), that is the distance of
                // both over their uncertainties.
                let taken = (std * std - self.std(i).powi(2)).max(TAKEN * std * std).sqrt();
                let deviations = (setting.get(unknown.parameter) - known).abs() / taken;
                if deviations > APART {
                    let prior = pulled(Finding::doubt("prior-contradicted"), deviations);
                    found.push(prior.number("prior", known).number("std", std).name("unit", unit));
                }
            }
            if let Some(limit) = self.uncertainty.limits[i].filter(|limit| limit.pull > PULLED) {
                let bound = pulled(Finding::doubt("bound-contradicted"), limit.pull);
                found.push(bound.number("bound", limit.value).name("unit", unit));
            }
        }
        if let Some(profile) = self.profile.as_ref().filter(|p| p.fall() > FALL) {
            let name = profile.parameter.name();
            found.push(Finding::doubt("least-squares-elsewhere").about(name).number("fall", profile.fall()));
        }
        found
    }

    /// All findings but the doubts of the whole answer.
    pub fn cautions(&self, fit: &Fit, entry: &FitEntry) -> Vec<Finding> {
        let (least, data) = (&self.found.least, self.found.least.problem.data);
        let (whiteness, ratio, sound) =
            (&least.whiteness, fit.reduced_chi_squared.sqrt(), fit.doubt.is_none());
        let mut found = Vec::new();
        if entry.calibration.is_none() {
            found.push(Finding::caution("calibration-assumed").number("part", data.calibration));
        }
        for (i, parameter) in fit.parameters.iter().enumerate() {
            let name = parameter.parameter.name();
            found.extend(parameter.reason.and_then(|reason| self.unidentified(fit, i, reason)));
            if parameter.rests_on_prior {
                found.push(Finding::caution("rests-on-prior").about(name));
            }
            let ratio = parameter.estimate.value / parameter.start;
            let free = parameter.parameter == Parameter::Force && parameter.prior.is_none();
            if free && sound && (ratio - 1.0).abs() > OTHER {
                found.push(Finding::caution("force-differs-from-stated").number("ratio", ratio));
            }
        }
        let chosen = fit.rungs.iter().find(|r| r.chosen).zip(fit.rungs.last().filter(|own| !own.chosen));
        let left = fit.left_out;
        let stated = !data.guessed;
        let of_all = [
            chosen.map(|(rung, own)| {
                let other = Finding::caution("simpler-model-predicts-as-well").name("model", rung.model);
                other.name("fitted", own.model)
            }),
            data.guessed
                .then(|| Finding::caution("amplitude-std-from-residuals").number("part", GUESS * ratio)),
            (stated && data.without_std > 0)
                .then(|| Finding::caution("amplitude-std-assumed").count("n", data.without_std)),
            (stated && ratio.is_nan()).then(|| Finding::caution("no-degrees-of-freedom")),
            (stated && sound && least.beyond_chance())
                .then(|| Finding::caution("residuals-larger-than-stated").number("ratio", ratio)),
            (sound && whiteness.rejected())
                .then(|| Finding::caution("residuals-correlated").number("inflation", whiteness.inflation)),
            (sound && self.lost.is_none()).then(|| Finding::caution("rigid-impacts-assumed")),
            (left.clear() > 0).then(|| {
                let out = Finding::caution("amplitudes-left-out").count("n", left.clear());
                let out = out.count("all", fit.n + left.clear()).count("other", left.other_motion);
                out.count("far", left.far + left.wavering).count("soft", left.soft)
            }),
            (fit.agreeing * 2 < fit.starts).then(|| {
                let few = Finding::caution("few-starts-agree").count("agreeing", fit.agreeing);
                few.count("starts", fit.starts)
            }),
        ];
        found.extend(of_all.into_iter().flatten());
        let unused = entry.prior.keys().chain(entry.bounds.keys()).filter(|p| !entry.parameters.contains(p));
        found.extend(unused.map(|p| Finding::caution("prior-or-bounds-unused").about(p.name())));
        found
    }

    /// Why the parameter number `i` is not identifiable; `None` where the whole answer is in doubt.
    fn unidentified(&self, fit: &Fit, i: usize, reason: Unidentified) -> Option<Finding> {
        let parameter = fit.parameters[i].parameter;
        let finding = match reason {
            Unidentified::InDoubt => return None,
            Unidentified::NeedsImpacts => Finding::doubt("parameter-needs-impacts"),
            Unidentified::AtLimit => {
                let limit = self.uncertainty.limits[i]?.value;
                Finding::doubt("parameter-at-limit").number("limit", limit).name("unit", parameter.unit())
            }
            Unidentified::Combination => {
                let tied = (0..fit.parameters.len()).filter(|j| *j != i && self.uncertainty.is_tied(i, *j));
                let others: Vec<&str> = tied.map(|j| fit.parameters[j].parameter.name()).collect();
                Finding::doubt("parameter-in-combination").name("others", others.join(", "))
            }
            Unidentified::TooUncertain => Finding::doubt("parameter-too-uncertain"),
        };
        Some(finding.about(parameter.name()))
    }
}

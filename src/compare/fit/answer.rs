//! Result of a fit: parameters with their uncertainties, and findings on them.

use super::{
    Converged, GUESS, MotionKind, NORMAL, Profile, Rung, Setting, SweepStep, Uncertainty, Unidentified,
    Unknown, profile,
};
use crate::campaign::FitEntry;
use crate::error::Result;
use crate::measure::Estimate;
use crate::measure::residuals::student;
use crate::model::{Parameter, Rig};
use crate::record::{Direction, Doubt, Finding, Uncertain};
use serde::Serialize;
use std::borrow::Cow;

/// A fitted parameter.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct FittedParameter {
    /// Parameter.
    pub parameter: Parameter,
    /// Value with its standard uncertainty, `None` where it is not identifiable.
    pub estimate: Estimate,
    /// Stated value, in the unit of the estimate.
    pub start: f64,
    /// 95 % confidence interval, all other parameters free; `None` where it is not identifiable.
    pub interval: Option<[f64; 2]>,
    /// Whether the points determine it.
    pub identifiable: bool,
    /// Reason where it is not identifiable.
    pub reason: Option<Unidentified>,
    /// Prior value and its standard uncertainty, if stated.
    pub prior: Option<[f64; 2]>,
    /// Whether the prior determines the parameter more than the points do: the variance of the estimate is
    /// above half of the prior's.
    pub rests_on_prior: bool,
}

impl Uncertain for FittedParameter {
    fn doubt(&mut self) {
        self.estimate.doubt();
        (self.interval, self.identifiable) = (None, false);
    }
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
    /// Motion assigned to the point.
    pub motion: MotionKind,
    /// Measured amplitude in m.
    pub measured: f64,
    /// Amplitude in m predicted with the fitted parameters.
    pub fitted: f64,
    /// Residual in stated standard deviations; without these, in standard deviations estimated from the
    /// residuals.
    pub residual: f64,
}

/// Numbers of amplitudes left out of the fit.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize)]
pub struct LeftOut {
    /// Below the noise floor.
    pub faint: usize,
    /// The simulated sweep shows another pattern than one impact a cycle or none.
    pub other_motion: usize,
    /// Outliers: farther from their motion than five standard deviations and five times the median scatter.
    pub far: usize,
    /// The motion assigned to them changed from round to round.
    pub wavering: usize,
    /// Impacts last too long at these points for the correction of the contact's compliance.
    pub soft: usize,
}

impl LeftOut {
    /// Number of left out amplitudes above the noise floor.
    pub fn clear(&self) -> usize {
        self.other_motion + self.far + self.wavering + self.soft
    }
}

/// Result of a fit of the rig to measured responses.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Fit {
    /// Parameters in the order of the campaign's `parameters`.
    pub parameters: Vec<FittedParameter>,
    /// Correlation matrix of these parameters, row by row.
    pub correlations: Vec<Vec<f64>>,
    /// Rig with the fitted parameters. The overlay and its scores use the rig as stated.
    pub rig: Rig,
    /// Force amplitude in N, found or fixed; the median where each point has its own.
    pub force: f64,
    /// Amplitudes in the fit.
    pub n: usize,
    /// Amplitudes left out.
    pub left_out: LeftOut,
    /// χ²/ν, sum of squared residuals over degrees of freedom, by the stated uncertainties: about 1 where
    /// model and uncertainties are right; NaN (null) without degrees of freedom.
    pub reduced_chi_squared: f64,
    /// Factor on the standard deviations of the data, from χ²/ν and the correlation of the residuals.
    pub widened: f64,
    /// Probability that white noise shows as much correlation along frequency as the residuals.
    pub whiteness: Option<f64>,
    /// Starting points.
    pub starts: usize,
    /// Number of starting points whose search ended at this answer.
    pub agreeing: usize,
    /// Profile of the parameter with the largest relative uncertainty.
    pub profile: Option<Profile>,
    /// Models of rising order, compared by their predictions of held-out points.
    pub rungs: Vec<Rung>,
    /// Points of the fit.
    pub points: Vec<FitPoint>,
    /// Code of the first doubt about the whole answer, if any: all uncertainties are then withdrawn.
    pub doubt: Option<Cow<'static, str>>,
    /// Findings; doubts about the whole answer come first.
    pub findings: Vec<Finding>,
}

/// A converged search with its uncertainties and the profile of the least certain parameter.
pub struct AssessedFit<'a> {
    pub found: Converged<'a>,
    pub uncertainty: Uncertainty,
    pub profile: Option<Profile>,
    /// Number of amplitudes excluded because the contact lasts too long; `None` with rigid impacts.
    pub lost: Option<usize>,
}

impl<'a> AssessedFit<'a> {
    /// Assesses a search that excluded `lost` amplitudes because of a long contact.
    ///
    /// # Errors
    /// As [`Uncertainty::new`].
    pub fn new(found: Converged<'a>, lost: Option<usize>) -> Result<AssessedFit<'a>> {
        let uncertainty = Uncertainty::new(&found.least)?;
        let profile = profile(&found.least, &uncertainty, uncertainty.worst());
        Ok(AssessedFit { found, uncertainty, profile, lost })
    }
}

/// Method named in each estimate. Parameters that are not fitted are taken as exact.
const METHOD: &str = "least squares of both masses and directions by the closed form";

impl AssessedFit<'_> {
    /// Result without starts, rungs and cautions.
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
        let (far, wavering, doubts) = (self.found.far, self.found.wavering, self.doubts());
        let in_doubt = !doubts.is_empty();
        let mut parameters: Vec<FittedParameter> = (0..n).map(|i| self.fitted(base, i, in_doubt)).collect();
        let mut profile = self.profile.clone();
        let all: &mut [&mut dyn Uncertain] = &mut [&mut parameters, &mut profile];
        let findings: Vec<Finding> = doubts.into_iter().map(|doubt| doubt.of(all)).collect();
        Fit {
            parameters,
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
            profile,
            rungs: Vec::new(),
            points: points.collect(),
            doubt: findings.first().map(|doubt| doubt.code.clone()),
            findings,
        }
    }

    /// Result for parameter number `i`.
    pub fn fitted(&self, base: &Setting, i: usize, in_doubt: bool) -> FittedParameter {
        let (problem, u) = (&self.found.least.problem, self.found.least.minimum.parameters[i]);
        let Unknown { parameter, coordinate, prior } = problem.unknowns[i];
        let reason = if in_doubt { Some(Unidentified::InDoubt) } else { self.uncertainty.unidentified[i] };
        let (value, std, identifiable) = (self.found.setting().get(parameter), self.std(i), reason.is_none());
        // The interval of a profile is more accurate than that of the Jacobian at the minimum.
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
            // A prior with the uncertainty s adds 1/s² to the reciprocal variance (exactly in a linear
            // model). This is more than half of it if the variance is above s²/2.
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

/// A prior and the points contradict each other if they differ by more than this many combined standard
/// uncertainties: chance does so in one of 1.7 million cases.
const CONTRADICTION: f64 = 5.0;
/// The variance of this difference is taken as at least this share of the prior's variance: below, it is
/// rounding.
const LEAST_VARIANCE_SHARE: f64 = 0.01;
/// The points contradict a bound if they would move the parameter beyond it by more than this many standard
/// deviations: chance does so in one of 700 cases.
const BOUND_PULL: f64 = 3.0;
/// A profile shows another, lower minimum if the sum of squares falls by more than this along it: one
/// standard uncertainty raises the sum by 1.
const PROFILE_FALL: f64 = 1.0;
/// The answer is in doubt if more than this share of the amplitudes are outliers, or are left out because of
/// a long contact.
const MOST_LEFT_OUT: f64 = 0.1;
/// χ²/ν beyond which a lack of fit is a doubt. The fitted parameters absorb most of a model's error, so they
/// err by more than the residuals show.
const LACK_OF_FIT: f64 = 1.25;
/// Relative difference of the fitted from the stated force beyond which it is a caution: load cells err by 1
/// or 2 %.
const FORCE_DIFFERENCE: f64 = 0.05;

impl AssessedFit<'_> {
    /// Doubts about the whole answer: its uncertainties are then invalid.
    pub fn doubts(&self) -> Vec<Doubt> {
        let (least, found, problem) = (&self.found.least, &self.found, &self.found.least.problem);
        let (n, freedom, guessed) = (problem.rows().0, problem.freedom(), problem.data.guessed);
        let many = |doubt: Doubt, key, part: usize| {
            let many = part as f64 > MOST_LEFT_OUT * (n + part) as f64;
            many.then(|| doubt.count(key, part).count("n", n + part))
        };
        let poor = least.reduced > LACK_OF_FIT && (least.beyond_chance() || least.whiteness.rejected());
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

    /// Priors and bounds that the points contradict, and a profile that falls below the minimum found.
    fn contradictions(&self) -> Vec<Doubt> {
        let (problem, setting) = (&self.found.least.problem, self.found.setting());
        let mut found = Vec::new();
        for (i, unknown) in problem.unknowns.iter().enumerate() {
            let (name, unit) = (unknown.parameter.name(), unknown.parameter.unit());
            let pulled = |doubt: Doubt, deviations| doubt.about(name).number("deviations", deviations);
            if let Some([known, std]) = unknown.prior {
                // With the uncertainties s of the prior and p of the answer, the answer is (s² − p²)/s² of
                // the way from the prior to the value by the points alone. So |answer − prior|/√(s² − p²) is
                // the difference of prior and points divided by their combined uncertainty.
                let shift_std =
                    (std * std - self.std(i).powi(2)).max(LEAST_VARIANCE_SHARE * std * std).sqrt();
                let deviations = (setting.get(unknown.parameter) - known).abs() / shift_std;
                if deviations > CONTRADICTION {
                    let prior = pulled(Finding::doubt("prior-contradicted"), deviations);
                    found.push(prior.number("prior", known).number("std", std).name("unit", unit));
                }
            }
            if let Some(limit) = self.uncertainty.limits[i].filter(|limit| limit.pull > BOUND_PULL) {
                let bound = pulled(Finding::doubt("bound-contradicted"), limit.pull);
                found.push(bound.number("bound", limit.value).name("unit", unit));
            }
        }
        if let Some(profile) = self.profile.as_ref().filter(|p| p.fall() > PROFILE_FALL) {
            let name = profile.parameter.name();
            found.push(Finding::doubt("least-squares-elsewhere").about(name).number("fall", profile.fall()));
        }
        found
    }

    /// Doubts about parameters, which are not identifiable.
    pub fn unidentified(&self, fit: &mut Fit) -> Vec<Finding> {
        let Fit { parameters, profile, .. } = fit;
        let doubts: Vec<Option<Doubt>> = (0..parameters.len()).map(|i| self.doubt(parameters, i)).collect();
        let found = doubts.into_iter().zip(parameters).filter_map(|(doubt, parameter)| {
            let mut profile = profile.as_mut().filter(|profile| profile.parameter == parameter.parameter);
            let numbers: &mut [&mut dyn Uncertain] = &mut [parameter, &mut profile];
            Some(doubt?.of(numbers))
        });
        found.collect()
    }

    /// All findings except the doubts.
    pub fn cautions(&self, fit: &Fit, entry: &FitEntry) -> Vec<Finding> {
        let (least, data) = (&self.found.least, self.found.least.problem.data);
        let (whiteness, ratio, sound) =
            (&least.whiteness, fit.reduced_chi_squared.sqrt(), fit.doubt.is_none());
        let mut found = Vec::new();
        if entry.calibration.is_none() {
            found.push(Finding::caution("calibration-assumed").number("part", data.calibration));
        }
        for parameter in &fit.parameters {
            let name = parameter.parameter.name();
            if parameter.rests_on_prior {
                found.push(Finding::caution("rests-on-prior").about(name));
            }
            let ratio = parameter.estimate.value / parameter.start;
            let free = parameter.parameter == Parameter::Force && parameter.prior.is_none();
            if free && sound && (ratio - 1.0).abs() > FORCE_DIFFERENCE {
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

    /// Doubt about parameter number `i`; `None` where it is identifiable, or the whole answer is in doubt.
    fn doubt(&self, parameters: &[FittedParameter], i: usize) -> Option<Doubt> {
        let parameter = parameters[i].parameter;
        let doubt = match parameters[i].reason? {
            Unidentified::InDoubt => return None,
            Unidentified::NeedsImpacts => Finding::doubt("parameter-needs-impacts"),
            Unidentified::AtLimit => {
                let limit = self.uncertainty.limits[i]?.value;
                Finding::doubt("parameter-at-limit").number("limit", limit).name("unit", parameter.unit())
            }
            Unidentified::Combination => {
                let tied = (0..parameters.len()).filter(|j| *j != i && self.uncertainty.is_tied(i, *j));
                let others: Vec<&str> = tied.map(|j| parameters[j].parameter.name()).collect();
                Finding::doubt("parameter-in-combination").name("others", others.join(", "))
            }
            Unidentified::TooUncertain => Finding::doubt("parameter-too-uncertain"),
        };
        Some(doubt.about(parameter.name()))
    }
}

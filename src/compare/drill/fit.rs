//! Keys of a drill and the angle of its pulse from the joined turn, by least squares.
//!
//! Residuals are measured less shown velocities at the phases of each average, over the standard error of
//! that mean. The velocity scale of each record has an error of its own, with a prior.

use super::turn::{MeasuredPhase, ModelTurn, TurnModel};
use crate::campaign::DrillModelEntry;
use crate::compare::fit::{Unidentified, covariance};
use crate::error::{Error, Result};
use crate::math::{Minimum, minimise};
use crate::measure::Estimate;
use crate::measure::expected::TIED;
use crate::measure::residuals::{Whiteness, student};
use crate::model::drill::{Machine, MachineDraft};
use crate::record::{Doubt, Finding, Uncertain, uncertain};
use nalgebra::DMatrix;
use serde::Serialize;
use std::cell::RefCell;

/// A fitted key of the drill.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct FittedKey {
    /// Key, as in the drill's file; or `pulse_angle`.
    pub key: String,
    /// Value with its standard uncertainty, `None` where it is not identifiable.
    pub estimate: Estimate,
    /// Value of the file; `None` for the angle of the pulse.
    pub start: Option<f64>,
    /// Reason where the turn does not determine it.
    pub reason: Option<Unidentified>,
}

impl Uncertain for FittedKey {
    fn doubt(&mut self) {
        self.estimate.doubt();
    }
}

/// Fit of a drill to its joined turn.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct DrillFit {
    /// Fitted keys in the order of the campaign, then the angle of the pulse where it is not stated.
    pub keys: Vec<FittedKey>,
    /// Correlations of these keys, row by row.
    pub correlations: Vec<Vec<f64>>,
    /// Velocities in the fit.
    pub n: usize,
    /// χ²/ν by the standard errors of the means over turns: about 1 where the model is right.
    pub reduced_chi_squared: f64,
    /// Factor on these standard errors, from χ²/ν and the correlation of neighbouring residuals.
    pub widened: f64,
}

uncertain!(DrillFit: keys);

/// Relative change of the sum of squares and of the unknowns at which a search ends.
const GAIN: f64 = 1e-6;
/// Name of the angle of the pulse among the keys.
const PULSE: &str = "pulse_angle";
/// Relative standard uncertainty of a velocity scale that is not stated: that of a beam set to 1° at 30° to
/// the motion.
const CALIBRATION: f64 = 0.01;
/// Correlation with an open unknown beyond which an unknown depends on it.
const SHARED: f64 = 0.5;
/// Largest relative standard uncertainty of a key that the turn determines: beyond, half or twice the value
/// fits.
const LOOSE: f64 = 0.5;
/// χ²/ν beyond which the model lacks something: what is fitted then takes up a part of its error.
const LACK_OF_FIT: f64 = 1.25;
/// Steps of the derivatives, in the units of [`minimise`]: 6e-5 of a key, far above the error of the
/// integration.
const KEY_SCALE: f64 = 10.0;
/// Those of the pulse in turns and of the velocity scales: a significant change.
const SMALL: f64 = 0.01;

/// Coordinate of a key: the logarithm of its ratio to the start; of a restitution that of R/(1 − R).
#[derive(Debug, Clone, Copy)]
struct Unknown<'a> {
    key: &'a str,
    start: f64,
    is_part: bool,
}

impl Unknown<'_> {
    fn value(&self, u: f64) -> f64 {
        if self.is_part {
            let odds = self.start / (1.0 - self.start) * u.exp();
            odds / (1.0 + odds)
        } else {
            self.start * u.exp()
        }
    }

    /// dθ/du.
    fn slope(&self, u: f64) -> f64 {
        let value = self.value(u);
        if self.is_part { value * (1.0 - value) } else { value }
    }
}

/// The sum of squares.
struct Problem<'a> {
    turns: &'a TurnModel<'a>,
    draft: &'a MachineDraft,
    keys: Vec<Unknown<'a>>,
    /// Stated angle of the pulse in turns.
    pulse: Option<f64>,
    /// Relative standard uncertainty of each velocity scale; 0: they are exact.
    calibration: f64,
    /// Measured phases of each body, with the standard error of the mean instead of the scatter.
    phases: Vec<Vec<MeasuredPhase>>,
    /// The last motions, by the coordinates of their keys: pulse and scales change without a run.
    last: RefCell<Vec<(Vec<f64>, Option<ModelTurn>)>>,
}

impl<'a> Problem<'a> {
    fn new(turns: &'a TurnModel<'a>, draft: &'a MachineDraft, entry: &'a DrillModelEntry) -> Result<Self> {
        let machine = draft.machine()?;
        let keys = entry.fit.iter().map(|key| {
            let start = machine.value(key).unwrap_or(f64::NAN);
            let is_part = key.ends_with(".restitution");
            if start > 0.0 && (start < 1.0 || !is_part) {
                return Ok(Unknown { key, start, is_part });
            }
            let range = if is_part { "a start between 0 and 1" } else { "a start above 0" };
            Err(Error::usage(format!("a fit of {key} from {start}"), range).setting("fit"))
        });
        let phases = turns.bodies.iter().map(|(body, _)| {
            let root = (body.turns.max(1) as f64).sqrt();
            let of_mean = |phase: MeasuredPhase| MeasuredPhase { scatter: phase.scatter / root, ..phase };
            turns.phases(body).into_iter().map(of_mean).collect()
        });
        Ok(Problem {
            turns,
            draft,
            keys: keys.collect::<Result<_>>()?,
            pulse: entry.pulse_angle.map(|angle| angle / 360.0),
            calibration: if entry.fit.is_empty() { 0.0 } else { entry.calibration.unwrap_or(CALIBRATION) },
            phases: phases.collect(),
            last: RefCell::default(),
        })
    }

    /// Unknowns: angle of the pulse if it is not stated, velocity scales, keys.
    fn scales(&self) -> usize {
        if self.calibration > 0.0 { self.turns.bodies.len() } else { 0 }
    }

    fn first_key(&self) -> usize {
        usize::from(self.pulse.is_none()) + self.scales()
    }

    /// Velocities of the fit.
    fn n(&self) -> usize {
        self.phases.iter().map(Vec::len).sum()
    }

    fn machine(&self, keys: &[f64]) -> Result<Machine> {
        let mut draft = self.draft.clone();
        for (unknown, u) in self.keys.iter().zip(keys) {
            draft.put(unknown.key, unknown.value(*u))?;
        }
        draft.machine()
    }

    /// What `of` makes of the motion with these coordinates of the keys, `None` where it cannot be followed.
    fn with_turn<T>(&self, keys: &[f64], of: impl Fn(Option<&ModelTurn>) -> T) -> T {
        let known = self.last.borrow().iter().position(|(known, _)| known == keys);
        let place = known.unwrap_or_else(|| {
            let turn = self.machine(keys).and_then(|machine| self.turns.run(&machine)).ok();
            let mut last = self.last.borrow_mut();
            last.truncate(1);
            last.insert(0, (keys.to_vec(), turn));
            0
        });
        of(self.last.borrow()[place].1.as_ref())
    }

    /// Residuals at `u`, those of the data in units of `errors`; NaN where the machine cannot be followed.
    fn at(&self, u: &[f64], errors: &dyn Fn(f64) -> f64, residuals: &mut [f64]) {
        let ahead = self.pulse.unwrap_or(u[0]);
        let (scales, keys) = u[usize::from(self.pulse.is_none())..].split_at(self.scales());
        let shown = self.with_turn(keys, |turn| self.turns.shown(turn?, ahead).ok());
        let Some(shown) = shown else { return residuals.fill(f64::NAN) };
        let (data, priors) = residuals.split_at_mut(self.n());
        let mut data = data.iter_mut();
        for (i, (shown, phases)) in shown.iter().zip(&self.phases).enumerate() {
            let scale = 1.0 + scales.get(i).unwrap_or(&0.0);
            for phase in phases {
                if let Some(r) = data.next() {
                    *r = (phase.velocity - scale * shown[phase.index]) / errors(phase.scatter);
                }
            }
        }
        priors.iter_mut().zip(scales).for_each(|(r, scale)| *r = scale / self.calibration);
    }

    /// Least squares from `start`, with `errors` of a velocity from its standard error.
    fn least(&self, start: &[f64], errors: &dyn Fn(f64) -> f64) -> Result<Minimum> {
        let mut scale = vec![SMALL; self.first_key()];
        scale.resize(start.len(), KEY_SCALE);
        minimise(|u, r| self.at(u, errors, r), self.n() + self.scales(), start, &scale, Some(GAIN))
    }

    /// Residuals of the data in m/s.
    fn off(&self, u: &[f64]) -> Vec<f64> {
        let mut residuals = vec![0.0; self.n() + self.scales()];
        self.at(u, &|_| 1.0, &mut residuals);
        residuals.truncate(self.n());
        residuals
    }

    /// Whole phase of the averages at which the pulse fits best with the stated keys, in turns.
    fn pulse_start(&self) -> Result<f64> {
        let turn = self.turns.run(&self.machine(&vec![0.0; self.keys.len()])?)?;
        let shown = self.turns.shown(&turn, 0.0)?;
        let steps = shown.iter().map(Vec::len).max().unwrap_or(1);
        let sum = |step: usize| -> f64 {
            let all = shown.iter().zip(&self.phases).flat_map(|(shown, phases)| {
                let later = step * shown.len() / steps;
                phases.iter().map(move |p| (p.velocity - shown[(p.index + later) % shown.len()]).powi(2))
            });
            all.sum()
        };
        let best = (0..steps).min_by(|a, b| sum(*a).total_cmp(&sum(*b))).unwrap_or(0);
        Ok(best as f64 / steps as f64)
    }
}

/// Fit of the stated keys, and the machine with them; adds its findings. The angle of the pulse is the last
/// key where it is not stated. `None` where nothing is to be found.
///
/// # Errors
/// If a key cannot be fitted, or the machine cannot be followed.
pub fn fitted(
    turns: &TurnModel<'_>,
    draft: &MachineDraft,
    entry: &DrillModelEntry,
    findings: &mut Vec<Finding>,
) -> Result<(Option<DrillFit>, Machine)> {
    let problem = Problem::new(turns, draft, entry)?;
    let free = problem.first_key() + problem.keys.len();
    if free == 0 {
        return Ok((None, draft.machine()?));
    }
    let mut start = vec![0.0; free];
    if problem.pulse.is_none() {
        start[0] = problem.pulse_start()?;
    }
    // All phases alike first: where the turns hardly scatter, a bad start would weigh the most.
    let mean = |values: &[f64]| values.iter().map(|v| v * v).sum::<f64>() / values.len().max(1) as f64;
    let errors: Vec<f64> = problem.phases.iter().flatten().map(|phase| phase.scatter).collect();
    let typical = mean(&errors).sqrt();
    let alike = problem.least(&start, &|_| typical)?;
    let first = problem.least(&alike.parameters, &|error| error)?;
    let freedom = problem.n().saturating_sub(free);
    let mut data = &first.residuals[..problem.n()];
    let reduced = mean(data) * problem.n() as f64 / freedom as f64;
    let mut sequences = Vec::new();
    for phases in &problem.phases {
        let (own, others) = data.split_at(phases.len());
        sequences.push(own);
        data = others;
    }
    let whiteness = Whiteness::of(&sequences);
    let widened = reduced.max(1.0).sqrt() * whiteness.inflation * student(freedom).unwrap_or(1.0);
    // What a model lacks is as large where the turns hardly scatter: it is an error of all phases.
    let lacks = reduced > LACK_OF_FIT;
    let left = if lacks { mean(&problem.off(&alike.parameters)).sqrt() } else { 0.0 };
    let minimum = if lacks {
        problem.least(&alike.parameters, &|error| error.hypot(left))?
    } else if problem.scales() > 0 {
        problem.least(&first.parameters, &|error| error * widened)?
    } else {
        Minimum { jacobian: &first.jacobian / widened, ..first }
    };
    let covariance = covariance(minimum.jacobian.clone())?;
    let machine = problem.machine(&minimum.parameters[problem.first_key()..])?;
    let answer = Answer { problem: &problem, minimum, covariance };
    let mut fit = DrillFit { reduced_chi_squared: reduced, widened, ..answer.fit(&machine) };
    if let Some(angle) = fit.keys.last().filter(|_| problem.pulse.is_none()) {
        findings.push(Finding::caution("drill-pulse-angle-found").number("angle", angle.estimate.value));
    }
    if problem.scales() > 0 && entry.calibration.is_none() {
        findings.push(Finding::caution("drill-fit-calibration").number("part", CALIBRATION));
    }
    let lack = Finding::doubt("drill-fit-lack").number("ratio", reduced.sqrt());
    let unfinished = Finding::doubt("least-squares-not-reached");
    let doubts = [(lacks, lack), (!answer.minimum.converged, unfinished)];
    let doubts: Vec<Doubt> = doubts.into_iter().filter(|(here, _)| *here).map(|(_, doubt)| doubt).collect();
    if doubts.is_empty() && whiteness.rejected() {
        findings.push(whiteness.coloured("drill-fit-correlated"));
    }
    for doubt in doubts {
        fit.keys.iter_mut().for_each(|key| key.reason = Some(Unidentified::InDoubt));
        findings.push(doubt.of(&mut fit.keys));
    }
    findings.extend(Answer::unidentified(&mut fit));
    Ok((Some(fit), machine))
}

/// A minimum with its covariance.
struct Answer<'a> {
    problem: &'a Problem<'a>,
    minimum: Minimum,
    covariance: DMatrix<f64>,
}

impl Answer<'_> {
    /// Numbers of the unknowns that are told apart: the keys, then the pulse if it is found.
    fn unknowns(&self) -> Vec<usize> {
        let pulse = self.problem.pulse.is_none().then_some(0);
        (self.problem.first_key()..self.minimum.parameters.len()).chain(pulse).collect()
    }

    fn std(&self, i: usize) -> f64 {
        self.covariance[(i, i)].sqrt()
    }

    fn correlation(&self, i: usize, j: usize) -> f64 {
        self.covariance[(i, j)] / (self.std(i) * self.std(j))
    }

    /// Keys with their uncertainties and correlations.
    fn fit(&self, machine: &Machine) -> DrillFit {
        let (problem, u) = (self.problem, &self.minimum.parameters);
        let method = "least squares of the mean turn";
        let estimate = |value, std, unit| Estimate::new(value, Some(std), unit, problem.n(), method);
        let key = |i: usize| {
            let Some(k) = i.checked_sub(problem.first_key()) else {
                let angle = estimate(360.0 * u[i].rem_euclid(1.0), 360.0 * self.std(i), "°");
                return FittedKey { key: PULSE.to_owned(), estimate: angle, start: None, reason: None };
            };
            let Unknown { key, start, .. } = problem.keys[k];
            let std = problem.keys[k].slope(u[i]) * self.std(i);
            let value = machine.value(key).unwrap_or(f64::NAN);
            let estimate = estimate(value, std, machine.unit(key));
            FittedKey { key: key.to_owned(), estimate, start: Some(start), reason: None }
        };
        let all = self.unknowns();
        let row = |i: &usize| all.iter().map(|j| self.correlation(*i, *j)).collect();
        DrillFit {
            keys: all.iter().map(|i| key(*i)).collect(),
            correlations: all.iter().map(row).collect(),
            n: problem.n(),
            reduced_chi_squared: f64::NAN,
            widened: f64::NAN,
        }
    }

    /// Doubts about keys that the turn does not determine, or only in combination. Where an unknown is open
    /// it may lie far from where the covariance was taken: what depends on it has no uncertainty either.
    fn unidentified(fit: &mut DrillFit) -> Vec<Finding> {
        let related = |i: usize, j: usize, least: f64| i != j && fit.correlations[i][j].abs() > least;
        let all = 0..fit.keys.len();
        let loose = |key: &FittedKey| {
            key.start.is_some() && key.estimate.std.is_some_and(|std| std > LOOSE * key.estimate.value.abs())
        };
        let is_open = |i: usize| loose(&fit.keys[i]) || all.clone().any(|j| related(i, j, TIED));
        let open: Vec<bool> = all.clone().map(is_open).collect();
        let others = |i: usize| -> Vec<&str> {
            let tied = all.clone().filter(|j| related(i, *j, TIED) || open[*j] && related(i, *j, SHARED));
            tied.map(|j| fit.keys[j].key.as_str()).collect()
        };
        let found: Vec<Option<(Doubt, Unidentified)>> = all
            .clone()
            .map(|i| {
                let others = others(i);
                if others.is_empty() {
                    return open[i].then(|| (Finding::doubt("drill-key-open"), Unidentified::TooUncertain));
                }
                let tied = Finding::doubt("drill-key-in-combination").name("others", others.join(", "));
                Some((tied, Unidentified::Combination))
            })
            .collect();
        let doubts = fit.keys.iter_mut().zip(found).filter_map(|(key, found)| {
            let (doubt, reason) = found.filter(|_| key.reason.is_none())?;
            key.reason = Some(reason);
            Some(doubt.about(&*key.key).of(key))
        });
        doubts.collect()
    }
}

//! Which points of a sweep tell most of a rig before they are measured (V. V. Fedorov, Theory of Optimal
//! Experiments, 1972).
//!
//! A point adds `JᵀC⁻¹J` to the information of the fit of [`problem`](super::problem): J the derivative of
//! its amplitudes by the parameters, C the covariance of their errors. Errors of the calibrations, which all
//! points share, are further unknowns with a prior. The next point is the one with which the largest relative
//! variance of a parameter is least, or the variance of a prediction (c-optimal). The determinant of the
//! covariance (D-optimal) leaves one parameter uncertain for longer: on five drawn rigs it needed about as
//! many points as an even grid.

use super::problem::Problem;
use super::{ASSUMED, Data, MotionKind, Pace, Setting, StepAmplitude, SweepStep, Unknown};
use crate::campaign::FitEntry;
use crate::compare::simulated::simulated_briefly;
use crate::error::{Error, Result};
use crate::model::{Parameter, Rig};
use crate::record::Direction;
use nalgebra::{DMatrix, DVector};

/// Rig and what a fit is to find of it.
#[derive(Debug, Clone)]
pub struct DesignTask<'a> {
    pub rig: Rig,
    /// Reference of the forces in N.
    pub force: f64,
    /// Parameters, priors, calibration and scatter.
    pub fit: &'a FitEntry,
    pub pace: Pace,
}

/// Points, and the motion that a sweep through them reaches at each.
#[derive(Debug, Clone)]
pub struct ReachedPoints {
    data: Data,
    base: Setting,
    unknowns: Vec<Unknown>,
    kinds: Vec<Option<MotionKind>>,
    scatter: f64,
}

/// An amplitude counts if it exceeds its standard uncertainty by this factor; below, a sweep gives an upper
/// limit.
const CLEAR: f64 = 5.0;
/// Largest relative difference of a simulated amplitude from the closed form of the same motion.
const SAME: f64 = 0.05;
/// Standard uncertainty of ln θ before any point is measured: a person knows a rig to within a factor of 1.5.
/// It only ranks points while they are too few for all parameters.
const GUESSED: f64 = 0.4;
/// Neighbours on either side that must show the same motion as a point that is suggested.
const MARGIN: usize = 2;
/// Relative step of the derivatives by the coordinates of the parameters.
const STEP: f64 = 1e-5;

impl ReachedPoints {
    /// The motions at these sequences of points (frequency in Hz, force in N), each passed in its order by a
    /// sweep that starts at rest. A point whose motion has no closed form tells nothing.
    ///
    /// # Errors
    /// If the rig, a point or the parameters are impossible.
    pub fn of(task: &DesignTask<'_>, sequences: &[Vec<(f64, f64)>]) -> Result<ReachedPoints> {
        task.rig.check()?;
        let base = Setting { rig: task.rig, force: task.force };
        let unknowns = Unknown::all(task.fit, &base)?;
        let (mut steps, mut kinds, mut places) = (Vec::new(), Vec::new(), Vec::new());
        for points in sequences {
            let simulated = simulated_briefly(&task.rig, points, task.pace);
            let first = steps.len();
            for ((frequency, force), simulated) in points.iter().zip(simulated) {
                let kind = simulated.ok().and_then(|simulated| {
                    let kind = MotionKind::of(simulated.regime);
                    let shows = base.shows(kind, *force, *frequency);
                    let near = (simulated.amplitude[0] / shows[0] - 1.0).abs() < SAME;
                    (near && shows[0] > 0.0).then_some((kind, shows))
                });
                let reading = |mass: usize| {
                    let amplitude = kind.map_or(0.0, |(_, shows)| shows[mass]);
                    let (upper_limit, compliance) = (None, 1.0);
                    Some(StepAmplitude { sweep: mass, amplitude, std: f64::NAN, upper_limit, compliance })
                };
                let (frequency, force) = (*frequency, *force);
                let readings = [reading(0), reading(1)];
                steps.push(SweepStep { frequency, frequency_std: 0.0, force, force_std: 0.0, readings });
                kinds.push(kind.map(|(kind, _)| kind));
            }
            places.push((first..steps.len()).collect());
        }
        let data = Data {
            sweeps: ["mass 1", "mass 2"].map(|name| (name.to_owned(), Direction::Up)).to_vec(),
            steps,
            sequences: places,
            force: task.force,
            calibration: task.fit.calibration.unwrap_or(ASSUMED),
            without_std: 0,
            guessed: false,
            pace: task.pace,
        };
        Ok(ReachedPoints { data, base, unknowns, kinds, scatter: task.fit.scatter.unwrap_or(0.0) })
    }

    /// The motion at each point; `None` where it has no closed form.
    pub fn kinds(&self) -> &[Option<MotionKind>] {
        &self.kinds
    }

    /// Points that can be suggested: their neighbours in the sweep show the same motion. Beside a change of
    /// motion the sweep of a slightly different rig would jump.
    pub fn candidates(&self) -> Vec<usize> {
        let of = |sequence: &Vec<usize>| {
            let kinds: Vec<_> = sequence.iter().map(|place| self.kinds[*place]).collect();
            let safe = |i: usize| {
                let near = &kinds[i.saturating_sub(MARGIN)..(i + MARGIN + 1).min(kinds.len())];
                kinds[i].is_some() && near.iter().all(|kind| *kind == kinds[i])
            };
            (0..kinds.len()).filter(|i| safe(*i)).map(|i| sequence[i]).collect::<Vec<usize>>()
        };
        self.data.sequences.iter().flat_map(of).collect()
    }

    /// The information of each point, where `std` gives the standard uncertainty in m of an amplitude at a
    /// frequency in Hz.
    pub fn information(&self, std: &dyn Fn(f64) -> f64) -> PointInformation {
        let mut data = self.data.clone();
        for step in &mut data.steps {
            let noise = std(step.frequency);
            for reading in step.readings.iter_mut().flatten() {
                reading.std = noise.hypot(self.scatter * reading.amplitude);
                reading.upper_limit =
                    (reading.amplitude < CLEAR * reading.std).then_some(CLEAR * reading.std);
            }
        }
        let mut problem = Problem::new(&data, &self.base, self.unknowns.clone()).of(self.kinds.clone());
        let u = problem.coordinates(&self.base);
        problem.weigh(&u);
        let shows = |u: &[f64]| {
            let setting = problem.setting(u);
            problem.whitened(|step, kind| data.shows(&setting, kind, step))
        };
        let slope = |(i, unknown): (usize, &Unknown)| {
            let step = STEP * u[i].abs().max(STEP);
            let moved = |by: f64| {
                let mut moved = u.clone();
                moved[i] += by;
                shows(&moved)
            };
            // By ln θ: the coordinate u has its own slope.
            let rate = self.base.get(unknown.parameter).abs() / unknown.coordinate.slope(u[i]);
            let pairs = moved(step).into_iter().zip(moved(-step)).map(|(a, b)| rate * (a - b) / (2.0 * step));
            pairs.collect::<Vec<f64>>()
        };
        let mut columns: Vec<Vec<f64>> = self.unknowns.iter().enumerate().map(slope).collect();
        columns.extend(problem.calibration_columns(&self.base));
        let mut points = vec![Vec::new(); data.steps.len()];
        for (row, (step, ..)) in problem.used().enumerate() {
            let row = DVector::from_iterator(columns.len(), columns.iter().map(|column| column[row]));
            if row.iter().all(|v| v.is_finite()) {
                points[step].push(row);
            }
        }
        let prior = |unknown: &Unknown| {
            let value = self.base.get(unknown.parameter);
            unknown.prior.map_or(0.0, |[_, std]| (value / std).powi(2))
        };
        let priors = self.unknowns.iter().map(prior).collect();
        let parameters = self.unknowns.iter().map(|unknown| unknown.parameter).collect();
        PointInformation { points, priors, columns: columns.len(), parameters }
    }
}

/// What each point tells of the parameters, whose changes are relative ones.
#[derive(Debug, Clone)]
pub struct PointInformation {
    /// Derivatives of the amplitudes of each point, over their standard uncertainties, by the parameters and
    /// by the errors of the calibrations in theirs.
    points: Vec<Vec<DVector<f64>>>,
    /// Reciprocal variance of each parameter by its prior.
    priors: Vec<f64>,
    columns: usize,
    pub parameters: Vec<Parameter>,
}

/// The aim of a design.
#[derive(Debug, Clone)]
pub enum Aim {
    /// All parameters: the sum of the squares of their relative variances, a smooth measure of the largest.
    Parameters,
    /// One prediction, with its relative derivatives by the parameters.
    Prediction(DVector<f64>),
}

impl PointInformation {
    /// Covariance of the relative errors of the parameters with these points; with `guessed` they are known
    /// to a factor of 1.5 before. `None` where the points do not determine them.
    pub fn covariance(&self, chosen: &[usize], guessed: bool) -> Option<DMatrix<f64>> {
        let n = self.parameters.len();
        let before = |i: usize| match self.priors.get(i) {
            Some(prior) if guessed => prior + GUESSED.powi(-2),
            Some(prior) => *prior,
            None => 1.0,
        };
        let mut information = DMatrix::from_diagonal(&DVector::from_fn(self.columns, |i, _| before(i)));
        for row in chosen.iter().flat_map(|point| &self.points[*point]) {
            information.ger(1.0, row, row, 1.0);
        }
        // Scaled to a unit diagonal, so that its condition does not depend on the noise.
        let scale = information.diagonal().map(|v| 1.0 / v.sqrt());
        if scale.iter().any(|v| !v.is_finite()) {
            return None;
        }
        let scaled = information.component_mul(&(&scale * scale.transpose()));
        let inverse = scaled.cholesky()?.inverse().component_mul(&(&scale * scale.transpose()));
        Some(inverse.view((0, 0), (n, n)).into_owned())
    }

    /// Half the logarithm of what a design is to make small.
    fn cost(&self, chosen: &[usize], aim: &Aim) -> f64 {
        let Some(covariance) = self.covariance(chosen, true) else { return f64::INFINITY };
        match aim {
            Aim::Parameters => 0.25 * covariance.diagonal().map(|variance| variance * variance).sum().ln(),
            Aim::Prediction(slopes) => 0.5 * (slopes.transpose() * covariance * slopes)[(0, 0)].ln(),
        }
    }

    /// Part by which each of the `candidates` lowers the uncertainty that is aimed at, beside the points
    /// `chosen`.
    pub fn gains(&self, chosen: &[usize], candidates: &[usize], aim: &Aim) -> Vec<f64> {
        let before = self.cost(chosen, aim);
        let after = |candidate: &usize| self.cost(&[chosen, &[*candidate]].concat(), aim);
        candidates.iter().map(|candidate| 1.0 - (after(candidate) - before).exp()).collect()
    }

    /// The next `n` points among the `candidates`, one by one, beside those `chosen`.
    pub fn next(&self, chosen: &[usize], candidates: &[usize], n: usize, aim: &Aim) -> Vec<usize> {
        let mut all = chosen.to_vec();
        for _ in 0..n {
            let gains = self.gains(&all, candidates, aim);
            let best = candidates.iter().zip(gains).max_by(|a, b| a.1.total_cmp(&b.1));
            all.extend(best.map(|(candidate, _)| *candidate));
        }
        all.split_off(chosen.len())
    }

    /// Largest relative standard uncertainty of a parameter, or that of the prediction; `None` where the
    /// points do not determine it.
    pub fn uncertainty(&self, chosen: &[usize], aim: &Aim) -> Option<f64> {
        let covariance = self.covariance(chosen, false)?;
        let variance = match aim {
            Aim::Parameters => covariance.diagonal().max(),
            Aim::Prediction(slopes) => (slopes.transpose() * covariance * slopes)[(0, 0)],
        };
        Some(variance.sqrt())
    }
}

/// Relative derivatives of a prediction by the parameters; `of` gives the prediction of a rig and its force.
///
/// # Errors
/// If the motion of the prediction does not exist.
pub fn slopes(task: &DesignTask<'_>, of: &dyn Fn(&Rig, f64) -> Option<f64>) -> Result<DVector<f64>> {
    let base = Setting { rig: task.rig, force: task.force };
    let value = |parameter: Parameter, by: f64| {
        let moved = base.with(parameter, base.get(parameter) * (1.0 + by));
        of(&moved.rig, moved.force).map(f64::ln)
    };
    let slope =
        |parameter: &Parameter| Some((value(*parameter, STEP)? - value(*parameter, -STEP)?) / (2.0 * STEP));
    let all: Option<Vec<f64>> = task.fit.parameters.iter().map(slope).collect();
    let slopes = all.filter(|all| all.iter().all(|slope| slope.is_finite()));
    slopes.map(DVector::from_vec).ok_or_else(|| Error::refused("the predicted motion does not exist there"))
}

#[cfg(test)]
mod tests;

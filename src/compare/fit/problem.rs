//! Weighted residuals of the steps with a known motion.

use super::{Data, MotionKind, Setting, StepAmplitude, SweepStep, Unknown, range};
use crate::error::{Error, Result};
use crate::math::{Minimum, minimise};
use crate::model::Parameter;
use nalgebra::{DMatrix, SVD};

/// A sum of squares to be minimised: weighted residuals of the data, and of priors.
///
/// Frequency and force of a step have errors common to both masses; a calibration has errors common to all
/// points of a mass. Each amplitude has its own uncertainty as well. The residuals are whitened with the
/// covariance of these errors ([`SharedErrors`]): first step by step, then all together.
#[derive(Debug, Clone)]
pub struct Problem<'a> {
    pub data: &'a Data,
    pub base: Setting,
    pub unknowns: Vec<Unknown>,
    /// Motion of each step; steps with `None` are left out.
    pub kinds: Vec<Option<MotionKind>>,
    /// Errors of frequency and force, by step.
    step_errors: Vec<SharedErrors>,
    /// Errors of the calibrations.
    calibrations: SharedErrors,
    /// Factor on the stated variances of the data.
    pub scale: f64,
}

impl<'a> Problem<'a> {
    /// Problem of points whose motions are not known yet.
    pub fn new(data: &'a Data, base: &Setting, unknowns: Vec<Unknown>) -> Problem<'a> {
        Problem {
            data,
            base: *base,
            unknowns,
            kinds: vec![None; data.steps.len()],
            step_errors: Vec::new(),
            calibrations: SharedErrors::default(),
            scale: 1.0,
        }
    }

    /// The same problem with these motions. Its weights are not set yet: see [`Problem::weigh`].
    pub fn of(&self, kinds: Vec<Option<MotionKind>>) -> Problem<'a> {
        Problem { kinds, ..self.with(self.data) }
    }

    /// The same unknowns with other points, whose motions are not known yet.
    pub fn with<'b>(&self, data: &'b Data) -> Problem<'b> {
        Problem::new(data, &self.base, self.unknowns.clone())
    }
}

impl Problem<'_> {
    /// The setting at these coordinates of the unknowns.
    pub fn setting(&self, u: &[f64]) -> Setting {
        self.unknowns.iter().zip(u).fold(self.base, |setting, (unknown, u)| {
            let [low, high] = unknown.limits(&self.base);
            setting.with(unknown.parameter, unknown.coordinate.value(*u).clamp(low, high))
        })
    }

    /// Coordinates of the unknowns' values in `setting`.
    pub fn coordinates(&self, setting: &Setting) -> Vec<f64> {
        self.unknowns.iter().map(|k| k.coordinate.of(setting.get(k.parameter))).collect()
    }

    /// The same minimum with coordinates of at least 0 for unknowns without an upper bound: u and −u give
    /// the same value.
    pub fn folded(&self, mut minimum: Minimum) -> Minimum {
        for (i, (unknown, u)) in self.unknowns.iter().zip(&mut minimum.parameters).enumerate() {
            if unknown.coordinate.high.is_infinite() && *u < 0.0 {
                *u = -*u;
                minimum.jacobian.column_mut(i).neg_mut();
            }
        }
        minimum
    }

    /// Checks that `n` amplitudes and the priors can determine the unknowns.
    ///
    /// # Errors
    /// If they cannot.
    pub fn enough(&self, n: usize) -> Result<()> {
        let all = self.unknowns.len();
        if n + self.rows().1 >= all && n > 0 {
            return Ok(());
        }
        let why = format!("{n} amplitudes with one impact a cycle or none do not determine {all} parameters");
        Err(Error::refused(why).hint(
            "check units and which mass is which; start nearer to the rig, fit fewer parameters, or state priors",
        ))
    }

    /// Amplitudes in the fit, with the indices of step and mass.
    pub fn used(&self) -> impl Iterator<Item = (usize, usize, &StepAmplitude)> {
        let steps = self.data.steps.iter().zip(&self.kinds).enumerate();
        steps.flat_map(|(i, (step, kind))| shown(step, *kind).map(move |(mass, reading)| (i, mass, reading)))
    }

    /// Numbers of residuals of data and of priors; priors come last.
    pub fn rows(&self) -> (usize, usize) {
        (self.used().count(), self.unknowns.iter().filter(|u| u.prior.is_some()).count())
    }

    /// Degrees of freedom: amplitudes and priors less parameters.
    pub fn freedom(&self) -> usize {
        let (data, priors) = self.rows();
        (data + priors).saturating_sub(self.unknowns.len())
    }

    /// Sets the covariance of the residuals by errors of frequencies, forces and calibrations, at the
    /// setting at `u`.
    pub fn weigh(&mut self, u: &[f64]) {
        let setting = self.setting(u);
        let errors = |(step, kind): (&SweepStep, &Option<MotionKind>)| {
            let Some(kind) = *kind else { return SharedErrors::default() };
            let force = self.data.force_at(&setting, step);
            let column = |std: f64, slopes: [f64; 2]| {
                let mut column = vec![0.0; 2];
                for (mass, reading) in shown(step, Some(kind)) {
                    column[mass] = slopes[mass] * std / reading.std;
                }
                column
            };
            let by_frequency = slopes(|by| setting.shows(kind, force, step.frequency * by));
            let by_force = slopes(|by| setting.shows(kind, force * by, step.frequency));
            SharedErrors::new(&[
                column(step.frequency_std / step.frequency, by_frequency),
                column(step.force_std / step.force, by_force),
            ])
        };
        self.step_errors = self.data.steps.iter().zip(&self.kinds).map(errors).collect();
        self.calibrations = SharedErrors::new(&self.calibration_columns(&setting));
    }

    /// Change of each whitened residual by one standard uncertainty of the calibrations: of each mass'
    /// factor, of its slope over frequency (−1 to 1), and of the force where it is not fitted. The
    /// amplitudes do not reveal an error of the force: force, gap and amplitudes scale alike.
    pub fn calibration_columns(&self, setting: &Setting) -> Vec<Vec<f64>> {
        let (std, mut columns) = (self.data.calibration, Vec::new());
        if std == 0.0 {
            return columns;
        }
        let (low, high) = range(self.data.steps.iter().map(|s| s.frequency));
        let along = |f: f64| if high > low { (2.0 * f - low - high) / (high - low) } else { 0.0 };
        for (mass, sloped) in [(0, false), (1, false), (0, true), (1, true)] {
            columns.push(self.whitened(|step, kind| {
                let mut error = [0.0; 2];
                let part = std * if sloped { along(step.frequency) } else { 1.0 };
                error[mass] = self.data.shows(setting, kind, step)[mass] * part;
                error
            }));
        }
        if self.unknowns.iter().all(|u| u.parameter != Parameter::Force) {
            columns.push(self.whitened(|step, kind| {
                let force = self.data.force_at(setting, step);
                slopes(|by| setting.shows(kind, force * by, step.frequency)).map(|s| s * std)
            }));
        }
        columns
    }

    /// Values of `of` for each step and its motion, in m for both masses, over their standard deviations
    /// and whitened step by step.
    pub fn whitened(&self, of: impl Fn(&SweepStep, MotionKind) -> [f64; 2]) -> Vec<f64> {
        let mut all = Vec::new();
        for ((step, kind), errors) in self.data.steps.iter().zip(&self.kinds).zip(&self.step_errors) {
            let Some(kind) = *kind else { continue };
            let (of, mut row) = (of(step, kind), [0.0; 2]);
            for (mass, reading) in shown(step, Some(kind)) {
                row[mass] = of[mass] / reading.std;
            }
            errors.whiten(&mut row, 1.0);
            all.extend(shown(step, Some(kind)).map(|(mass, _)| row[mass]));
        }
        all
    }

    /// Whitened residuals, measured less `shows` for each step and its motion, in standard deviations.
    pub fn off(&self, shows: impl Fn(&SweepStep, MotionKind) -> [f64; 2]) -> Vec<f64> {
        let widened = self.scale.sqrt();
        let mut all = self.whitened(|step, kind| {
            let shows = shows(step, kind);
            [0, 1].map(|mass: usize| step.readings[mass].as_ref().map_or(0.0, |r| r.amplitude) - shows[mass])
        });
        for r in &mut all {
            *r /= widened;
        }
        self.calibrations.whiten(&mut all, widened);
        all
    }

    /// Residuals at `u` in standard deviations, data and priors.
    pub fn at(&self, u: &[f64]) -> Vec<f64> {
        let setting = self.setting(u);
        let mut all = self.off(|step, kind| self.data.shows(&setting, kind, step));
        for unknown in &self.unknowns {
            all.extend(unknown.prior.map(|[value, std]| (setting.get(unknown.parameter) - value) / std));
        }
        all
    }

    /// Minimises the sum of squares from `start`.
    ///
    /// # Errors
    /// As [`minimise`].
    pub fn solve(&self, start: &[f64]) -> Result<Minimum> {
        let (data, priors) = self.rows();
        let residuals = |u: &[f64], r: &mut [f64]| r.copy_from_slice(&self.at(u));
        Ok(self.folded(minimise(residuals, data + priors, start, &vec![0.1; start.len()], None)?))
    }
}

/// Amplitudes above the noise floor that depend on the parameters in this motion; a mass at rest has none.
pub fn shown(step: &SweepStep, kind: Option<MotionKind>) -> impl Iterator<Item = (usize, &StepAmplitude)> {
    step.clear().filter(move |(mass, _)| match kind {
        Some(MotionKind::Impacting) => true,
        Some(_) => *mass == 0,
        None => false,
    })
}

/// Derivative of both amplitudes by the factor that `shows` applies to frequency or force, at 1; 0 at the
/// end of a branch, where no difference exists.
///
/// The central difference with h = 1e-6 errs by h²/6 times the third derivative, and by rounding of ε/h =
/// 2e-10 of the value.
fn slopes(shows: impl Fn(f64) -> [f64; 2]) -> [f64; 2] {
    const H: f64 = 1e-6;
    let [above, below] = [1.0 + H, 1.0 - H].map(shows);
    [0, 1].map(|mass| (above[mass] - below[mass]) / (2.0 * H)).map(|s| if s.is_finite() { s } else { 0.0 })
}

/// Errors that move several residuals at once: those of frequency and force of a step, or of the
/// calibrations.
///
/// W is the change of the residuals, in standard deviations, by one standard uncertainty of each error: the
/// covariance is `I + WWᵀ`. With `W = VSQᵀ` the residuals are multiplied by its inverse square root, `I − V
/// (I − (I + S²)^(−1/2)) Vᵀ`. This is generalised least squares (A. C. Aitken 1935), as if each error were
/// fitted as an unknown with a prior.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct SharedErrors {
    /// Columns of V, each of length 1, and S.
    directions: Vec<(Vec<f64>, f64)>,
}

impl SharedErrors {
    /// From the columns of W; no errors where all entries are 0 or one is not finite.
    pub fn new(columns: &[Vec<f64>]) -> SharedErrors {
        let rows = columns.first().map_or(0, Vec::len);
        let w = DMatrix::from_fn(rows, columns.len(), |i, j| columns[j][i]);
        let usable = rows > 0 && w.iter().all(|v| v.is_finite()) && w.amax() > 0.0;
        // With an iteration limit, since the algorithm has no bound of its own.
        let Some(svd) = usable.then(|| SVD::try_new(w, true, false, f64::EPSILON, 10_000)).flatten() else {
            return SharedErrors::default();
        };
        let v = svd.u.iter().flat_map(|u| u.column_iter().map(|c| c.iter().copied().collect::<Vec<f64>>()));
        SharedErrors { directions: v.zip(svd.singular_values.iter().copied()).collect() }
    }

    /// Whitens residuals in units of standard deviations that are `widened` times as large as stated.
    pub(crate) fn whiten(&self, residuals: &mut [f64], widened: f64) {
        for (v, s) in &self.directions {
            // V's columns are orthogonal: each removes its own part.
            let along: f64 = v.iter().zip(residuals.iter()).map(|(v, r)| v * r).sum();
            let off = along * (1.0 - 1.0 / (s / widened).hypot(1.0));
            residuals.iter_mut().zip(v).for_each(|(r, v)| *r -= off * v);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Compares with the definition, rᵀ(I + WWᵀ)⁻¹r by a plain inverse, for columns that are neither
    /// orthogonal nor small.
    #[test]
    fn squares_sum_to_the_definition() {
        let columns: [Vec<f64>; 3] =
            [vec![1.0, 2.0, -0.5, 3.0, 0.1], vec![0.5, 2.0, 0.0, 2.5, -1.0], vec![0.0, 0.0, 30.0, 1.0, 0.0]];
        let r = [0.3, -1.0, 2.0, 0.7, -0.2];
        for widened in [1.0, 2.5] {
            let w = DMatrix::from_fn(5, 3, |i, j| columns[j][i] / widened);
            let covariance = DMatrix::identity(5, 5) + &w * w.transpose();
            let column = nalgebra::DVector::from_row_slice(&r);
            let expected = column.dot(&(covariance.try_inverse().unwrap() * &column));
            let mut white = r;
            SharedErrors::new(&columns).whiten(&mut white, widened);
            let sum: f64 = white.iter().map(|r| r * r).sum();
            // Rounding times the largest eigenvalue of the covariance, about 900, with a margin of 5.
            assert!((sum / expected - 1.0).abs() < 1e-12, "{sum} {expected}");
        }
    }

    #[test]
    fn without_errors_nothing_changes() {
        for columns in [&[][..], &[vec![0.0; 4]], &[vec![f64::NAN; 4]]] {
            let mut r = [1.0, 2.0, 3.0, 4.0];
            SharedErrors::new(columns).whiten(&mut r, 1.0);
            assert_eq!(r, [1.0, 2.0, 3.0, 4.0]);
        }
    }

    /// Compares with the definition for two residuals, C^(−1/2) C C^(−1/2) = I, for small and large errors,
    /// parallel and not.
    #[test]
    fn the_covariance_of_white_residuals_is_one() {
        for errors in [
            [[0.0, 0.0], [0.0, 0.0]],
            [[3.0, 0.0], [0.1, 0.0]],
            [[0.3, -0.2], [1.0, 2.0]],
            [[1e3, 2e3], [5e2, 1e3]],
            [[1e4, 1.0], [-1.0, 1e4]],
        ] {
            let shared = SharedErrors::new(&errors.map(|w| w.to_vec()));
            let c = |i: usize, j: usize| {
                f64::from(u8::from(i == j)) + errors.iter().map(|w| w[i] * w[j]).sum::<f64>()
            };
            let columns = [[1.0, 0.0], [0.0, 1.0]].map(|mut column| {
                shared.whiten(&mut column, 1.0);
                column
            });
            for (i, a) in columns.iter().enumerate() {
                for (j, b) in columns.iter().enumerate() {
                    let pairs = (0..2).flat_map(|k| (0..2).map(move |l| (k, l)));
                    let sum: f64 = pairs.map(|(k, l)| a[k] * c(k, l) * b[l]).sum();
                    // Terms of the size of C cancel down to 1, with three roundings in each whitened entry,
                    // two in a product and three in the sum.
                    let tolerance = 11.0 * f64::EPSILON * (c(0, 0) + c(1, 1));
                    assert!(
                        (sum - f64::from(u8::from(i == j))).abs() < tolerance,
                        "{errors:?}: {i} {j} {sum}"
                    );
                }
            }
        }
    }
}

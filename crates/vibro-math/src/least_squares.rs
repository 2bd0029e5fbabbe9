//! Nonlinear least squares by the MINPACK algorithm of the crate `levenberg-marquardt`. This module adds a
//! Jacobian by central differences, the covariance of the parameters, and an error for parameters that the
//! data do not determine.

use levenberg_marquardt::{LeastSquaresProblem, LevenbergMarquardt};
use nalgebra::storage::Owned;
use nalgebra::{DMatrix, DVector, Dyn};
use vibro_record::{Error, Result};

/// Parameters that minimise a sum of squared residuals, and how well they are determined.
#[derive(Debug, Clone, PartialEq)]
pub struct Fit {
    /// Parameters at the minimum, in the order of the first guess.
    pub parameters: Vec<f64>,
    /// Residuals at the minimum.
    pub residuals: Vec<f64>,
    /// J: ∂rᵢ/∂pⱼ at the minimum.
    pub jacobian: DMatrix<f64>,
    /// (JᵀJ)⁻¹: covariance of the parameters for residuals of unit variance.
    pub cofactor: DMatrix<f64>,
    /// Whether a minimum was reached; else the parameters are the best ones found.
    pub converged: bool,
}

impl Fit {
    /// Sum of squared residuals.
    pub fn sum_of_squares(&self) -> f64 {
        self.residuals.iter().map(|r| r * r).sum()
    }

    /// Number of residuals minus number of parameters.
    pub fn degrees_of_freedom(&self) -> usize {
        self.residuals.len().saturating_sub(self.parameters.len())
    }

    /// Variance of a residual, s² = Σr²/(n − p); NaN if there are no more residuals than parameters.
    pub fn variance(&self) -> f64 {
        match self.degrees_of_freedom() {
            0 => f64::NAN,
            free => self.sum_of_squares() / free as f64,
        }
    }

    /// Covariance of parameters `i` and `j`, s²(JᵀJ)⁻¹ᵢⱼ, for uncorrelated residuals of one unknown variance.
    ///
    /// # Panics
    /// If `i` or `j` is no parameter.
    pub fn covariance(&self, i: usize, j: usize) -> f64 {
        self.variance() * self.cofactor[(i, j)]
    }

    /// The fit of a record without noise, with the covariance that noise would give its parameters: `KJᵀCJK`,
    /// K the cofactor and C the covariance of the noise. `times_c` multiplies a matrix by C from the left.
    /// For white noise it is the Cramér–Rao bound; for coloured noise it is that of least squares, which
    /// weighs all residuals alike.
    #[must_use]
    pub fn under_noise(self, times_c: impl Fn(&DMatrix<f64>) -> DMatrix<f64>) -> Fit {
        let gain = &self.jacobian * &self.cofactor;
        self.of_covariance(gain.tr_mul(&times_c(&gain)))
    }

    /// The same fit with this covariance of its parameters.
    #[must_use]
    pub fn of_covariance(mut self, covariance: DMatrix<f64>) -> Fit {
        self.cofactor = covariance;
        // The scale of the covariance is in the cofactor: residuals of unit variance keep it there.
        let size = (self.degrees_of_freedom() as f64 / self.residuals.len() as f64).sqrt();
        self.residuals.fill(size);
        self
    }

    /// Correlation of parameters `i` and `j`.
    ///
    /// # Panics
    /// If `i` or `j` is no parameter.
    pub fn correlation(&self, i: usize, j: usize) -> f64 {
        self.cofactor[(i, j)] / (self.cofactor[(i, i)] * self.cofactor[(j, j)]).sqrt()
    }

    /// Standard uncertainty of parameter `i`; as [`Fit::covariance`].
    ///
    /// # Panics
    /// If `i` is no parameter.
    pub fn std(&self, i: usize) -> f64 {
        self.covariance(i, i).sqrt()
    }
}

/// Minimises Σrᵢ(p)². `residuals(p, r)` fills `r`, of length `n`. `start` is the first guess. `scale` is the
/// size of a small but significant change of each parameter; its sign and exact size do not matter.
///
/// ```
/// use vibro_math::least_squares;
/// let times = [0.0, 1.0, 2.0, 3.0, 4.0];
/// let values = [2.0, 1.213, 0.736, 0.446, 0.271]; // 2 exp(−t/2), rounded
/// let fit = least_squares(
///     |p, r| times.iter().zip(&values).zip(r).for_each(|((t, v), r)| *r = v - p[0] * (-p[1] * t).exp()),
///     times.len(), &[1.0, 1.0], &[0.1, 0.1],
/// )?;
/// assert!((fit.parameters[1] - 0.5).abs() < 2.0 * fit.std(1));
/// # Ok::<(), vibro_record::Error>(())
/// ```
///
/// # Errors
/// - If there is no parameter, or not one scale for each parameter, or a scale is 0 or not finite.
/// - If there are fewer residuals than parameters.
/// - If the model gives a value that is not finite at the first guess or at the minimum.
/// - If the residuals at the minimum do not depend on some combination of the parameters; the error names
///   these by their numbers.
pub fn least_squares(
    residuals: impl Fn(&[f64], &mut [f64]),
    n: usize,
    start: &[f64],
    scale: &[f64],
) -> Result<Fit> {
    minimise(residuals, n, start, scale, None)?.fit()
}

/// Parameters that minimise a sum of squared residuals, without their uncertainty.
#[derive(Debug, Clone, PartialEq)]
pub struct Minimum {
    /// Parameters at the minimum, in the order of the first guess.
    pub parameters: Vec<f64>,
    /// Residuals at the minimum.
    pub residuals: Vec<f64>,
    /// ∂rᵢ/∂pⱼ at the minimum.
    pub jacobian: DMatrix<f64>,
    /// Whether a minimum was reached; else the parameters are the best ones found.
    pub converged: bool,
}

impl Minimum {
    /// The minimum with the cofactor of its parameters.
    ///
    /// # Errors
    /// If the residuals do not depend on some combination of the parameters.
    pub fn fit(self) -> Result<Fit> {
        let Minimum { parameters, residuals, jacobian, converged } = self;
        Ok(Fit { cofactor: cofactor(jacobian.clone())?, parameters, residuals, jacobian, converged })
    }
}

/// As [`least_squares`], for callers that examine the Jacobian themselves: a combination of parameters on
/// which no residual depends is no error; it stays near the first guess. A `gain`, such as 0.001, is for
/// searches that continue from the result: the fit stops when a step changes the sum of squares or the
/// parameters by less than this fraction, at the latest after about twenty evaluations per parameter.
///
/// # Errors
/// As [`least_squares`], except for parameters that the data do not determine.
pub fn minimise(
    residuals: impl Fn(&[f64], &mut [f64]),
    n: usize,
    start: &[f64],
    scale: &[f64],
    gain: Option<f64>,
) -> Result<Minimum> {
    let whole = LevenbergMarquardt::new().with_patience(200);
    let algorithm = gain.map_or(whole, |gain| whole.with_patience(20).with_ftol(gain).with_xtol(gain));
    let scaled = scale.iter().all(|s| s.is_finite() && *s != 0.0);
    if start.is_empty() || scale.len() != start.len() || !scaled {
        return Err(Error::usage(
            format!("a fit of {} parameters with the scales {scale:?}", start.len()),
            "one scale other than 0 a parameter",
        ));
    }
    if n < start.len() {
        return Err(Error::refused(format!("{n} values do not determine {} parameters", start.len())));
    }
    let mut problem = Problem { residuals, n, scale, parameters: DVector::from_column_slice(start) };
    if problem.at(&problem.parameters).is_none() {
        return Err(Error::refused("the model gives no finite value at the first guess of a fit"));
    }
    let report;
    (problem, report) = algorithm.minimize(problem);
    let parameters = problem.parameters.clone();
    let (Some(residuals), Some(jacobian)) = (problem.at(&parameters), problem.jacobian()) else {
        return Err(Error::refused("a fit ran to where the model gives no finite value"));
    };
    Ok(Minimum {
        parameters: parameters.as_slice().to_vec(),
        residuals: residuals.as_slice().to_vec(),
        jacobian,
        converged: report.termination.was_successful(),
    })
}

/// (JᵀJ)⁻¹ by the singular values of J. The columns of J are scaled to length 1 first: else the units of the
/// parameters would decide which singular values are small.
fn cofactor(mut jacobian: DMatrix<f64>) -> Result<DMatrix<f64>> {
    let lengths: Vec<f64> = jacobian.column_iter().map(|c| c.norm()).collect();
    if lengths.iter().any(|l| !l.is_finite()) {
        return Err(Error::refused("the model of a fit changes beyond all numbers at its minimum"));
    }
    if let Some(i) = lengths.iter().position(|l| *l == 0.0) {
        return Err(undetermined(&[i]));
    }
    for (mut column, length) in jacobian.column_iter_mut().zip(&lengths) {
        column /= *length;
    }
    let rows = jacobian.nrows() as f64;
    // JᵀJ is not formed, since that would square the condition number. The algorithm has no bound on its
    // iterations, hence the limit.
    let svd = nalgebra::SVD::try_new(jacobian, false, true, f64::EPSILON, 10_000)
        .ok_or_else(|| Error::refused("the singular values of a fit were not found"))?;
    let v_t = svd.v_t.ok_or_else(|| Error::refused("the singular vectors of a fit were not found"))?;
    let largest = svd.singular_values.max();
    // Central differences have a relative error of about ε^(2/3); a singular value below it is noise.
    let least = largest * f64::EPSILON.powf(2.0 / 3.0) * rows.sqrt().max(1.0);
    if let Some((k, _)) = svd.singular_values.iter().enumerate().find(|(_, s)| **s <= least || !s.is_finite())
    {
        let part: Vec<usize> =
            v_t.row(k).iter().enumerate().filter(|(_, v)| v.abs() > 0.3).map(|(i, _)| i).collect();
        return Err(undetermined(&part));
    }
    let n = lengths.len();
    Ok(DMatrix::from_fn(n, n, |i, j| {
        let sum: f64 =
            svd.singular_values.iter().enumerate().map(|(k, s)| v_t[(k, i)] * v_t[(k, j)] / (s * s)).sum();
        sum / (lengths[i] * lengths[j])
    }))
}

/// Error for parameters, by their indices, that the data do not determine.
fn undetermined(parameters: &[usize]) -> Error {
    let names: Vec<String> = parameters.iter().map(|i| (i + 1).to_string()).collect();
    let which = if names.len() == 1 { "parameter" } else { "the combination of parameters" };
    Error::refused(format!("the data do not determine {which} {} of the fit", names.join(", ")))
}

/// A fit in the form that the crate `levenberg-marquardt` expects.
struct Problem<'a, F> {
    residuals: F,
    n: usize,
    scale: &'a [f64],
    parameters: DVector<f64>,
}

impl<F: Fn(&[f64], &mut [f64])> Problem<'_, F> {
    /// Residuals for these parameters; `None` if one is not finite.
    fn at(&self, parameters: &DVector<f64>) -> Option<DVector<f64>> {
        let mut values = DVector::zeros(self.n);
        (self.residuals)(parameters.as_slice(), values.as_mut_slice());
        values.iter().all(|v| v.is_finite()).then_some(values)
    }
}

impl<F: Fn(&[f64], &mut [f64])> LeastSquaresProblem<f64, Dyn, Dyn> for Problem<'_, F> {
    type ResidualStorage = Owned<f64, Dyn>;
    type JacobianStorage = Owned<f64, Dyn, Dyn>;
    type ParameterStorage = Owned<f64, Dyn>;

    fn set_params(&mut self, parameters: &DVector<f64>) {
        self.parameters.copy_from(parameters);
    }

    fn params(&self) -> DVector<f64> {
        self.parameters.clone()
    }

    fn residuals(&self) -> Option<DVector<f64>> {
        // `None` would end the algorithm; a large residual makes it shorten its step.
        let far = || DVector::from_element(self.n, f64::MAX.sqrt().sqrt());
        Some(self.at(&self.parameters).unwrap_or_else(far))
    }

    fn jacobian(&self) -> Option<DMatrix<f64>> {
        let mut jacobian = DMatrix::zeros(self.n, self.parameters.len());
        for (i, mut column) in jacobian.column_iter_mut().enumerate() {
            let here = self.parameters[i];
            // ε^(1/3) balances rounding ε/h against truncation h² of a central difference (Dennis & Schnabel
            // 1983, 5.6).
            let step = f64::EPSILON.cbrt() * here.abs().max(self.scale[i].abs());
            let mut moved = self.parameters.clone();
            moved[i] = here + step;
            let above = self.at(&moved)?;
            let up = moved[i];
            moved[i] = here - step;
            let below = self.at(&moved)?;
            column.copy_from(&((above - below) / (up - moved[i])));
        }
        Some(jacobian)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A straight line has a closed form: slope Sxy/Sxx, its variance s²/Sxx.
    #[test]
    fn a_line_has_its_closed_form() {
        let x: Vec<f64> = (0..12).map(f64::from).collect();
        let y = [3.1, 4.9, 7.2, 8.8, 11.1, 13.0, 14.7, 17.3, 19.0, 21.2, 22.8, 25.1];
        let fit = least_squares(
            |p, r| r.iter_mut().zip(x.iter().zip(&y)).for_each(|(r, (x, y))| *r = y - p[0] - p[1] * x),
            12,
            &[0.0, 0.0],
            &[1.0, 1.0],
        )
        .unwrap();
        let (mx, my) = (x.iter().sum::<f64>() / 12.0, y.iter().sum::<f64>() / 12.0);
        let sxx: f64 = x.iter().map(|x| (x - mx).powi(2)).sum();
        let slope = x.iter().zip(&y).map(|(x, y)| (x - mx) * (y - my)).sum::<f64>() / sxx;
        // MINPACK stops at relative changes of about ε^½ in the cost, which for a linear problem is one step
        // to rounding.
        assert!((fit.parameters[1] - slope).abs() < 1e-9, "{fit:?}");
        assert!((fit.std(1) / (fit.variance() / sxx).sqrt() - 1.0).abs() < 1e-6, "{fit:?}");
        // Intercept and slope: −x̄/√(Σx²/n).
        let expected = -mx / (x.iter().map(|x| x * x).sum::<f64>() / 12.0).sqrt();
        assert!((fit.covariance(0, 1) / (fit.std(0) * fit.std(1)) - expected).abs() < 1e-6);
    }

    /// White noise of variance 4 gives twice the standard uncertainties of unit residuals; noise that all
    /// residuals share moves the intercept of a line alone.
    #[test]
    fn noise_gives_its_covariance() {
        let line = |p: &[f64], r: &mut [f64]| {
            r.iter_mut().enumerate().for_each(|(i, r)| *r = p[0] + p[1] * (i as f64 - 2.0));
        };
        let fit = least_squares(line, 5, &[0.0, 0.0], &[1.0, 1.0]).unwrap();
        let white = fit.clone().under_noise(|gain| gain * 4.0);
        // Intercept 2/√5, slope 2/√Σx², with x from −2 to 2; the Jacobian of a line is exact to ε^(2/3).
        assert!(
            (white.std(0) - 2.0 / 5f64.sqrt()).abs() < 1e-9
                && (white.std(1) - 2.0 / 10f64.sqrt()).abs() < 1e-9
        );
        assert!(white.correlation(0, 1).abs() < 1e-9);
        let shared = fit.under_noise(|gain| DMatrix::from_element(5, 5, 9.0) * gain);
        assert!((shared.std(0) - 3.0).abs() < 1e-9 && shared.std(1) < 1e-6);
    }

    #[test]
    fn rosenbrock_is_found_from_afar() {
        let fit = least_squares(
            |p, r| {
                r[0] = 10.0 * (p[1] - p[0] * p[0]);
                r[1] = 1.0 - p[0];
            },
            2,
            &[-1.2, 1.0],
            &[1.0, 1.0],
        )
        .unwrap();
        assert!(fit.converged && fit.parameters.iter().all(|p| (p - 1.0).abs() < 1e-6), "{fit:?}");
        assert!(fit.variance().is_nan());
    }

    #[test]
    fn what_the_data_do_not_determine_is_named() {
        // Only the product of the first two parameters acts.
        let error = least_squares(
            |p, r| {
                for (i, r) in r.iter_mut().enumerate() {
                    *r = (p[0] * p[1] - 3.0) * i as f64 + p[2] - 1.0;
                }
            },
            9,
            &[1.0, 2.0, 0.0],
            &[1.0, 1.0, 1.0],
        )
        .unwrap_err()
        .to_string();
        assert!(error.contains("1, 2"), "{error}");
        assert!(least_squares(|_, r| r.fill(1.0), 1, &[1.0, 1.0], &[1.0, 1.0]).is_err());
        assert!(least_squares(|_, r| r.fill(1.0), 3, &[1.0], &[]).is_err());
        assert!(least_squares(|_, r| r.fill(1.0), 3, &[1.0], &[0.0]).is_err());
        assert!(least_squares(|_, r| r.fill(1.0), 3, &[], &[]).is_err());
        assert!(least_squares(|_, r| r.fill(f64::NAN), 3, &[1.0], &[1.0]).is_err());
        let flat = least_squares(|p, r| r.fill(p[0]), 3, &[1.0, 1.0], &[1.0, 1.0]).unwrap_err().to_string();
        assert!(flat.contains("parameter 2"), "{flat}");
    }
}

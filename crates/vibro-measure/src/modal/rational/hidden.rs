//! A further mode that the noise may hide beside the modes of a fit.
//!
//! Lines that do not show a mode do not exclude it: where modes overlap, a weak one between them changes the
//! parameters of the others and leaves almost no residual. So the uncertainty is a mean over both cases,
//! equally likely before the lines are seen: no further mode, or one of [`Hidden`].
//!
//! A further mode of height a adds Ca to the lines, whitened as the residuals r with the Jacobian J. Near the
//! minimum the other parameters follow it by `(JᵀJ)⁻¹JᵀC` a, which leaves `D = CᵀC − CᵀJ(JᵀJ)⁻¹JᵀC` of its
//! power. With a normal prior of variance τ² for each of the two components of a, G = D/s² + 1/τ² and b =
//! Cᵀr/s², a has the mean G⁻¹b and the covariance G⁻¹. The evidence over that of no further mode is
//! exp(½bᵀG⁻¹b)/√|τ²G| (Laplace's method: `MacKay`, Information Theory, Inference, and Learning Algorithms,
//! 2003, chapter 28).

use super::{LineNoise, Rational, Scaled};
use crate::mean::mixture;
use crate::modal::{Measured, Pole};
use nalgebra::{DMatrix, DVector, Matrix2};
use num_complex::Complex64;
use std::f64::consts::{FRAC_1_SQRT_2, SQRT_2};
use std::ops::Range;
use vibro_math::Fit;

/// Half bandwidths within which a mode matters to another: two bandwidths.
pub const MATTERS: f64 = 4.0;

/// Distances from the nearest mode of the fit in its bandwidths, in steps of √2. Two modes of one bandwidth
/// count as one up to a quarter of it; where a fit takes them for one mode, that lies between them.
const DISTANCES: [f64; 7] = [0.2, 0.2 * SQRT_2, 0.4, 0.4 * SQRT_2, 0.8, 0.8 * SQRT_2, 1.6];

/// Damping ratios over that of the nearest mode: modes of one structure are damped alike.
const DAMPINGS: [f64; 3] = [FRAC_1_SQRT_2, 1.0, SQRT_2];

/// Heights over that of the highest mode, root mean square: any order of magnitude is as likely. What is
/// lower is left to the residual terms.
const HEIGHTS: [f64; 3] = [0.1, 0.3, 1.0];

/// One further mode: what it does to quantities of the fit.
struct Hidden {
    /// Logarithm of its evidence over that of no further mode.
    log_evidence: f64,
    /// Change of each quantity, and the variance that it adds.
    changes: Vec<(f64, f64)>,
}

impl Hidden {
    /// A mode with the whitened lines `columns`, a column for each component of its height, and `tau` as the
    /// prior standard deviation of each component. `slopes` are derivatives of the quantities with respect to
    /// the parameters of the fit, whose residuals have this `variance`.
    fn beside(
        (fit, variance): (&Fit, f64),
        slopes: &DMatrix<f64>,
        columns: &DMatrix<f64>,
        taus: impl Iterator<Item = f64>,
    ) -> Vec<Hidden> {
        let shared = fit.jacobian.tr_mul(columns);
        let follow = &fit.cofactor * &shared;
        let left = (columns.tr_mul(columns) - shared.tr_mul(&follow)) / variance;
        let left = Matrix2::from_fn(|i, j| left[(i, j)]);
        let b = columns.tr_mul(&DVector::from_column_slice(&fit.residuals)) / variance;
        let b = b.fixed_rows::<2>(0).into_owned();
        let through = slopes * follow;
        let of = |tau: f64| {
            let g = left + Matrix2::identity() / (tau * tau);
            let inverse = g.try_inverse()?;
            let height = inverse * b;
            let log_evidence = 0.5 * b.dot(&height) - 0.5 * (tau.powi(4) * g.determinant()).ln();
            let change =
                |row: nalgebra::RowVector2<f64>| ((row * height)[0], (row * inverse * row.transpose())[0]);
            let changes =
                through.fixed_columns::<2>(0).row_iter().map(|row| change(row.into_owned())).collect();
            log_evidence.is_finite().then_some(Hidden { log_evidence, changes })
        };
        taus.filter_map(of).collect()
    }
}

impl Rational {
    /// Widens the uncertainties to cover a further mode that the noise may hide, where modes lie within two
    /// bandwidths of each other; `others` are subtracted from the lines `part` first. A mode on its own shows
    /// no sign that modes are close.
    pub fn cover_hidden(&mut self, measured: &Measured, part: Range<usize>, others: &[Pole]) {
        let half = |mode: &Pole| mode.zeta * mode.frequency;
        let near = |w: &[Pole]| w[1].frequency - w[0].frequency < MATTERS * half(&w[0]).max(half(&w[1]));
        let close = self.modes.windows(2).any(near) && self.modes.iter().all(|mode| mode.zeta > 0.0);
        if measured.magnitude_only || !close {
            return;
        }
        let starts = self.starts();
        let scaled = Scaled::of(measured, part, &starts, others);
        let Some(fit) = scaled.again(&self.weights) else { return };
        let hidden = self.hidden(&scaled, &fit);
        if hidden.is_empty() {
            return;
        }
        let each = (1.0 / hidden.len() as f64).ln();
        for (q, std) in self.std.iter_mut().flatten().enumerate() {
            let own = std.powi(2);
            let with = |h: &Hidden| (h.log_evidence + each, h.changes[q].0, own + h.changes[q].1);
            let all: Vec<(f64, f64, f64)> = hidden.iter().map(with).chain([(0.0, 0.0, own)]).collect();
            let (mean, variance) = mixture(&all);
            *std = variance.sqrt().hypot(mean);
        }
        self.covers_hidden = true;
    }

    /// Frequency in Hz and damping ratio of each mode.
    pub(super) fn starts(&self) -> Vec<(f64, f64)> {
        self.modes.iter().map(|mode| (mode.frequency, mode.zeta)).collect()
    }

    /// The further modes that the fit may lack, each as likely.
    fn hidden(&self, scaled: &Scaled<'_>, fit: &Fit) -> Vec<Hidden> {
        let p = &fit.parameters;
        let n = scaled.x.len();
        let variance = fit.variance() * self.whiteness.inflation.powi(2);
        let slopes = scaled.slopes(p);
        let shapes: Vec<(f64, f64)> = (0..scaled.starts.len()).map(|m| scaled.shape(p, m)).collect();
        let peak = |(own, zeta): (f64, f64)| 1.0 / (2.0 * zeta * own.powi(2 - scaled.power));
        let height = |(m, shape): (usize, &(f64, f64))| p[4 * m + 2].hypot(p[4 * m + 3]) * peak(*shape);
        let highest = shapes.iter().enumerate().map(height).fold(0.0, f64::max);
        let mut all = Vec::new();
        for (own, zeta) in &shapes {
            for distance in DISTANCES.iter().flat_map(|d| [-d, *d]) {
                let at = own * (1.0 + 2.0 * zeta * distance);
                let apart = |(other, its): &(f64, f64)| (at - other).abs() / (its * other);
                let nearest = shapes.iter().map(apart).fold(f64::INFINITY, f64::min);
                let within = scaled.x[0] < at && at < scaled.x[n - 1];
                if !within || nearest < 2.0 * distance.abs() * (1.0 - 1e-9) {
                    continue;
                }
                for zeta in DAMPINGS.map(|ratio| ratio * zeta) {
                    let lines: Vec<Complex64> =
                        (0..n).map(|i| scaled.shaped(i, (at, zeta)) / peak((at, zeta))).collect();
                    let component = |turn: Complex64| {
                        self.weights.column(&lines.iter().map(|v| v * turn).collect::<Vec<_>>())
                    };
                    let columns = [component(Complex64::ONE), component(Complex64::i())].concat();
                    let columns = DMatrix::from_vec(2 * n, 2, columns);
                    // The mean square of a height is that of its two components.
                    let taus = HEIGHTS.iter().map(|height| height * highest * FRAC_1_SQRT_2);
                    all.extend(Hidden::beside((fit, variance), &slopes, &columns, taus));
                }
            }
        }
        all
    }
}

impl Scaled<'_> {
    /// The fit from its own minimum as first guess.
    pub(super) fn again(&self, noise: &LineNoise) -> Option<Fit> {
        let mut p = vec![0.0; 4 * self.starts.len() + 4];
        (0..self.starts.len()).for_each(|m| p[4 * m + 1] = 1.0);
        self.linear(&mut p, &noise.each)?;
        self.fit(&p, noise).ok()
    }
}

impl LineNoise {
    /// Whitened real and imaginary parts of lines.
    pub(super) fn column(&self, lines: &[Complex64]) -> Vec<f64> {
        let mut column: Vec<f64> = lines.iter().map(|v| v.re).chain(lines.iter().map(|v| v.im)).collect();
        self.whiten(&mut column);
        column
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use vibro_math::Noise;

    /// Oracle: parameters and height as one set of normal equations, with the prior as two more lines.
    #[test]
    fn a_hidden_mode_is_the_joint_fit_with_its_prior() {
        let mut noise = Noise::new(5);
        let (jacobian, columns) =
            (DMatrix::from_fn(12, 3, |_, _| noise.normal()), DMatrix::from_fn(12, 2, |_, _| noise.normal()));
        let cofactor = jacobian.tr_mul(&jacobian).try_inverse().unwrap();
        let raw = DVector::from_fn(12, |_, _| noise.normal());
        // At a minimum the Jacobian takes nothing from the residuals.
        let residuals = &raw - &jacobian * (&cofactor * jacobian.tr_mul(&raw));
        let (variance, tau) = (0.3, 0.7);
        let fit = Fit {
            parameters: vec![0.0; 3],
            residuals: residuals.as_slice().to_vec(),
            jacobian: jacobian.clone(),
            cofactor: cofactor.clone(),
            converged: true,
        };
        let slopes = DMatrix::from_fn(4, 3, |_, _| noise.normal());
        let found = &Hidden::beside((&fit, variance), &slopes, &columns, [tau].into_iter())[0];

        let all = DMatrix::from_fn(12, 5, |i, j| if j < 3 { -jacobian[(i, j)] } else { columns[(i, j - 3)] });
        let mut normal = all.tr_mul(&all) / variance;
        (3..5).for_each(|k| normal[(k, k)] += 1.0 / (tau * tau));
        let joint = normal.clone().try_inverse().unwrap();
        let best = &joint * all.tr_mul(&residuals) / variance;
        let height = best[3] * best[3] + best[4] * best[4];
        let least = (&residuals - &all * &best).norm_squared() / variance + height / (tau * tau);
        // Volumes of the two posterior distributions, without factors that they share.
        let volumes = (jacobian.tr_mul(&jacobian) / variance).determinant() / normal.determinant();
        let evidence = 0.5 * (residuals.norm_squared() / variance - least + volumes.ln()) - 2.0 * tau.ln();
        let close = |a: f64, b: f64| (a - b).abs() < 1e-10 * (1.0 + b.abs());
        assert!(close(found.log_evidence, evidence), "{} {evidence}", found.log_evidence);
        for (q, (change, more)) in found.changes.iter().enumerate() {
            let slope = slopes.row(q);
            let own = (slope * &cofactor * slope.transpose())[0] * variance;
            let together = (slope * joint.view((0, 0), (3, 3)) * slope.transpose())[0];
            assert!(close(*change, (slope * best.rows(0, 3))[0]) && close(*more, together - own), "{q}");
        }
    }
}

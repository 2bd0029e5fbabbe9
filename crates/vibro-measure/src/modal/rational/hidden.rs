//! A further mode that the noise may hide beside the modes of a fit.
//!
//! Lines that do not show a mode do not exclude it: where modes overlap, a weak one between them changes the
//! parameters of the others and leaves almost no residual. So the uncertainty is a mean over both cases: no
//! further mode, or one from a prior, weighted by their likelihoods.
//!
//! The prior: modes are as dense as the others of the fit beside one of them (a Poisson process whose rate is
//! known by their number, Jeffreys' prior), of similar damping, and of any order of magnitude in height.
//! Structures of proportional damping have real modal constants, any other constants of any phase; both are
//! as likely. Where fewer modes stand for more, their constants have phases.
//!
//! The others follow a further mode by a fit of their own to the lines without it, nearly in proportion to
//! its height only while that is small. So its posterior is no normal one, and follows by importance sampling
//! (`MacKay`, Information Theory, Inference, and Learning Algorithms, 2003, chapter 29). Heights a are drawn
//! from a mixture that leaves no part of the posterior without draws (Hesterberg 1995): the priors, and the
//! posteriors of the linear problem, twice as wide. With C as the lines of a height of 1, whitened as the
//! residuals r with the Jacobian J, the other parameters leave `D = CᵀC − CᵀJ(JᵀJ)⁻¹JᵀC` of its power. A
//! prior covariance P of both components of a then gives a mean of G⁻¹Cᵀr/s² and a covariance of G⁻¹ with G =
//! D/s² + P⁻¹.

use super::Rational;
use super::again::Again;
use crate::mean::mixture;
use nalgebra::{DMatrix, DVector, Matrix2, Vector2};
use num_complex::Complex64;
use std::f64::consts::{PI, TAU};
use vibro_math::Noise;

/// Half bandwidths within which a mode matters to another: two bandwidths.
pub const MATTERS: f64 = 4.0;

/// Bandwidths beyond the outer modes within which a further one is drawn. One farther away shows, or is left
/// to the residual terms.
const REACH: f64 = 1.6;

/// Least distance of two modes over the sum of their half bandwidths; nearer ones count as one.
const APART: f64 = 0.2;

/// Largest ratio of the damping of a further mode to that of the nearest, and its inverse the least: modes
/// of one structure are damped alike.
const DAMPED_ALIKE: f64 = 2.0;

/// Heights over that of the highest mode, root mean square: any order of magnitude is as likely. What is
/// lower is left to the residual terms.
const HEIGHTS: [f64; 3] = [0.1, 0.3, 1.0];

/// Standard deviation in rad of the phase of a real modal constant: damping is proportional, but for that.
const REAL: f64 = 0.05;

/// Draws of a further mode.
const DRAWS: u32 = 300;

/// One draw: what a further mode does to quantities of the fit.
struct Draw {
    /// Logarithm of its posterior density over the density that it was drawn from and the evidence of no
    /// further mode.
    log_weight: f64,
    /// Change of each quantity, and its variance.
    changes: Vec<(f64, f64)>,
}

/// A normal distribution of both components of a height.
#[derive(Clone, Copy)]
struct Normal {
    mean: Vector2<f64>,
    /// Inverse of the covariance, and its determinant.
    inverse: Matrix2<f64>,
    determinant: f64,
    /// Cholesky factor of the covariance.
    root: Matrix2<f64>,
}

impl Normal {
    fn of(mean: Vector2<f64>, covariance: Matrix2<f64>) -> Option<Normal> {
        let root = covariance.cholesky()?;
        let (inverse, root) = (root.inverse(), root.l());
        Some(Normal { mean, inverse, determinant: inverse.determinant(), root })
    }

    fn density(&self, at: Vector2<f64>) -> f64 {
        let off = at - self.mean;
        (-0.5 * off.dot(&(self.inverse * off))).exp() * self.determinant.sqrt() / TAU
    }

    /// Mean density of several distributions.
    fn mean_density(all: &[Normal], at: Vector2<f64>) -> f64 {
        all.iter().map(|normal| normal.density(at)).sum::<f64>() / all.len() as f64
    }
}

/// Priors of a height for a structure with real modal constants, and for any other; `highest` is the height of
/// the highest mode.
fn priors(highest: f64) -> [Vec<Normal>; 2] {
    [[1.0, REAL * REAL], [0.5, 0.5]].map(|parts| {
        let covariance =
            |height: &f64| Matrix2::from_diagonal(&Vector2::from(parts)) * (height * highest).powi(2);
        HEIGHTS.iter().filter_map(|height| Normal::of(Vector2::zeros(), covariance(height))).collect()
    })
}

/// Density of the phases of the modal constants of a structure with real ones, and of any other. `quantities`
/// are four of each mode, the last its phase.
fn of_phases(quantities: &[f64], covariance: &DMatrix<f64>) -> [f64; 2] {
    let modes = quantities.len() / 4;
    let off = DVector::from_fn(modes, |m, _| {
        let phase = quantities[4 * m + 3];
        phase - (phase / PI).round() * PI
    });
    let own = DMatrix::from_diagonal_element(modes, modes, REAL * REAL);
    let spread = DMatrix::from_fn(modes, modes, |i, j| covariance[(4 * i + 3, 4 * j + 3)]) + own;
    let whole_turn = TAU.powi(modes as i32);
    let real = spread.cholesky().map_or(0.0, |root| {
        let normal = (-0.5 * off.dot(&root.solve(&off))).exp() / (whole_turn.sqrt() * root.l().determinant());
        // Each constant has one of two signs.
        normal * 0.5f64.powi(modes as i32)
    });
    [real, 1.0 / whole_turn]
}

impl Rational {
    /// Widens the uncertainties to cover a further mode that the noise may hide.
    pub fn cover_hidden(&mut self, again: &Again<'_>) {
        let draws = self.draws(again);
        let odds = self.modes.len() as f64 - 0.5;
        let each = odds.ln() - f64::from(DRAWS).ln();
        for (q, std) in self.std.iter_mut().flatten().enumerate() {
            let with = |draw: &Draw| (draw.log_weight + each, draw.changes[q].0, draw.changes[q].1);
            let all: Vec<(f64, f64, f64)> = draws.iter().map(with).chain([(0.0, 0.0, std.powi(2))]).collect();
            let (mean, variance) = mixture(&all);
            *std = std.max(variance.sqrt().hypot(mean));
        }
        self.covers_hidden = !draws.is_empty();
    }

    /// Further modes that the fit may lack, drawn evenly in frequency.
    fn draws(&self, again: &Again<'_>) -> Vec<Draw> {
        let Again { scaled, fit, noise, .. } = again;
        let (p, n) = (&fit.parameters, scaled.x.len());
        let widened = self.whiteness.inflation.powi(2);
        let (variance, free) = (fit.variance() * widened, fit.degrees_of_freedom() as f64 / widened);
        let shapes = |p: &[f64]| (0..scaled.starts.len()).map(|m| scaled.shape(p, m)).collect::<Vec<_>>();
        let modes = shapes(p);
        let peak = |(own, zeta): (f64, f64)| 1.0 / (2.0 * zeta * own.powi(2 - scaled.power));
        let height = |(m, shape): (usize, &(f64, f64))| p[4 * m + 2].hypot(p[4 * m + 3]) * peak(*shape);
        let highest = modes.iter().enumerate().map(height).fold(0.0, f64::max);
        let edge = |sign: f64| modes.iter().map(move |(own, zeta)| own * (1.0 + sign * 2.0 * zeta * REACH));
        let low = edge(-1.0).fold(f64::INFINITY, f64::min).max(scaled.x[0]);
        let high = edge(1.0).fold(0.0, f64::max).min(scaled.x[n - 1]);
        let before = scaled.quantities(p);
        let of_fit: f64 = of_phases(&before, &scaled.covariance(p, &fit.cofactor, variance)).iter().sum();
        let classes = priors(highest);
        let mut random = Noise::new(1);
        let mut draw = |k: u32| {
            let own = low + (high - low) * (f64::from(k) + 0.5) / f64::from(DRAWS);
            let apart = |(mode, zeta): (f64, f64)| (own - mode).abs() / (zeta * mode);
            let nearest = modes.iter().min_by(|a, b| apart(**a).total_cmp(&apart(**b)))?;
            let zeta = nearest.1 * DAMPED_ALIKE.powf(random.between(-1.0, 1.0));
            let lines: Vec<Complex64> =
                (0..n).map(|i| scaled.shaped(i, (own, zeta)) / peak((own, zeta))).collect();
            let turned: Vec<Complex64> = lines.iter().map(|v| v * Complex64::i()).collect();
            let columns = DMatrix::from_vec(2 * n, 2, [noise.column(&lines), noise.column(&turned)].concat());
            let shared = fit.jacobian.tr_mul(&columns);
            let left = columns.tr_mul(&columns) - shared.tr_mul(&(&fit.cofactor * &shared));
            let left = left.fixed_view::<2, 2>(0, 0) / variance;
            let b = columns.tr_mul(&DVector::from_column_slice(&fit.residuals)) / variance;
            let posterior = |prior: &Normal| {
                let covariance = (left + prior.inverse).try_inverse()?;
                Normal::of(covariance * b.fixed_rows::<2>(0), covariance * 4.0)
            };
            let mut all = classes.concat();
            all.extend(classes.iter().flatten().filter_map(posterior));
            let from = &all[k as usize % all.len()];
            let a = from.mean + from.root * Vector2::new(random.normal(), random.normal());
            let found = scaled.beside(noise, fit, &(&columns * a))?;
            let p = &found.parameters;
            let one = |s: &(f64, f64)| (own - s.0).abs() < APART * (own * zeta + s.0 * s.1);
            if shapes(p).iter().any(one) {
                return None;
            }
            let (after, covariance) = (scaled.quantities(p), scaled.covariance(p, &found.cofactor, variance));
            let prior: f64 = classes
                .iter()
                .zip(of_phases(&after, &covariance))
                .map(|(class, of_phases)| Normal::mean_density(class, a) * of_phases)
                .sum();
            let prior = prior / (Normal::mean_density(&all, a) * of_fit);
            // The variance of the noise is unknown, with the likelihood (Σr²)^(−ν/2). The parameters have the
            // volume √|(JᵀJ)⁻¹|.
            let volume = found.cofactor.determinant() / fit.cofactor.determinant();
            let better = free * (fit.sum_of_squares() / found.sum_of_squares).ln();
            let log_weight = 0.5 * (better + volume.ln()) + prior.ln();
            let change = |(q, (after, before)): (usize, (&f64, &f64))| {
                let turn = q % 4 == 3;
                let by = after - before;
                (if turn { by.sin().atan2(by.cos()) } else { by }, covariance[(q, q)])
            };
            let changes = after.iter().zip(&before).enumerate().map(change).collect();
            log_weight.is_finite().then_some(Draw { log_weight, changes })
        };
        (0..DRAWS).filter_map(&mut draw).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Both are densities: over the phase of one mode, and over the height.
    #[test]
    fn the_priors_are_densities() {
        let (mut sum, mut any) = (0.0, 0.0);
        let covariance = DMatrix::from_diagonal_element(4, 4, 0.04);
        let n = 1000;
        for k in 0..n {
            let phase = PI * (2.0 * (f64::from(k) + 0.5) / f64::from(n) - 1.0);
            let [of_real, of_any] = of_phases(&[0.0, 0.0, 0.0, phase], &covariance);
            (sum, any) = (sum + of_real * TAU / f64::from(n), any + of_any * TAU / f64::from(n));
        }
        // A normal distribution of 0.206 rad ends at ±π/2 but for 2e-14.
        assert!((sum - 1.0).abs() < 1e-9 && (any - 1.0).abs() < 1e-9, "{sum} {any}");
        let mut random = Noise::new(3);
        let [real, other] = priors(2.0);
        let draws = 20_000;
        let ratio = |k: usize| {
            let from = &other[k % other.len()];
            let a = from.mean + from.root * Vector2::new(random.normal(), random.normal());
            Normal::mean_density(&real, a) / Normal::mean_density(&other, a)
        };
        let mean = (0..draws).map(ratio).sum::<f64>() / draws as f64;
        // The ratio is up to √2/0.05/2 = 14 in a fifteenth of the draws: its mean scatters by 3.5/√20000.
        assert!((mean - 1.0).abs() < 0.1, "{mean}");
    }
}

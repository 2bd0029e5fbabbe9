//! A further mode that the noise may hide beside the modes of a fit.
//!
//! Lines that do not show a mode do not exclude it: where modes overlap, a weak one between them changes the
//! parameters of the others and leaves almost no residual. So the uncertainty is a mean over both cases: no
//! further mode, or one from a prior, weighted by their likelihoods.
//!
//! The prior: modes are as dense as the others beside one of them in the band of the fit (a Poisson process
//! whose rate is known by their number, Jeffreys' prior), of similar damping, and of any order of magnitude
//! in height. Structures of proportional damping have real modal constants, any other constants of any phase;
//! both are as likely. Where fewer modes stand for more, their constants have phases.
//!
//! The others follow a further mode by a fit of their own to the lines without it, nearly in proportion to
//! its height only while that is small. So its posterior is no normal one, and follows by importance sampling
//! (`MacKay`, Information Theory, Inference, and Learning Algorithms, 2003, chapter 29). Heights a are drawn
//! from a mixture that leaves no part of the posterior without draws (Hesterberg 1995): the priors, and the
//! posteriors of the linear problem, twice as wide. Draws beside the heaviest (population Monte Carlo) were
//! worse: an uncertainty depends on the ends of the posterior, which these draws leave out. With C as the
//! lines of a height of 1, whitened as the residuals r with the Jacobian J, the other parameters leave `D =
//! CᵀC − CᵀJ(JᵀJ)⁻¹JᵀC` of its power. A prior covariance P of both components of a then gives a mean of
//! G⁻¹Cᵀr/s² and a covariance of G⁻¹ with G = D/s² + P⁻¹.

use super::Rational;
use super::again::Again;
use crate::chance::normal_above;
use crate::mean::mixture;
use nalgebra::{DMatrix, DVector, Matrix2, Vector2};
use num_complex::Complex64;
use std::f64::consts::{PI, TAU};
use vibro_math::{Noise, bisected};

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

/// Draws of a further mode: a few, which tell whether one is likely enough to matter, and all.
const DRAWS: [usize; 2] = [240, 1680];

/// Least odds of a further mode, given the lines, for more draws.
const NEEDED: f64 = 1e-3;

/// One draw: what a further mode does to quantities of the fit.
struct Draw {
    /// Logarithm of the posterior density over the evidence of no further mode, and over the density of the
    /// draw.
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

/// Priors of a height for a structure with real modal constants, and for any other; `highest` is the height
/// of the highest mode.
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

/// Share of a posterior that may lie beyond four standard uncertainties. A further mode that is unlikely
/// but moves a quantity far hardly changes its standard deviation: that would leave this chance beyond any
/// number of them.
const BEYOND: f64 = 0.003;

/// The least standard uncertainty from `least` on of which four hold all but [`BEYOND`] of a mixture of
/// normal distributions (logarithm of the weight, mean, variance) about 0.
fn holding(mixture: &[(f64, f64, f64)], least: f64) -> f64 {
    let highest = mixture.iter().map(|part| part.0).fold(f64::NEG_INFINITY, f64::max);
    let total: f64 = mixture.iter().map(|part| (part.0 - highest).exp()).sum();
    let beyond = |std: f64| {
        let each = mixture.iter().map(|(log_weight, mean, variance)| {
            let sides = [-1.0, 1.0].map(|sign| normal_above((4.0 * std + sign * mean) / variance.sqrt()));
            (log_weight - highest).exp() * sides.iter().sum::<f64>()
        });
        each.sum::<f64>() > BEYOND * total
    };
    let most = mixture.iter().map(|(_, mean, variance)| mean.abs() + variance.sqrt()).fold(least, f64::max);
    // To one part of 4096 of the distance.
    if beyond(least) { bisected(most, least, 12, |std| !beyond(std)).0 } else { least }
}

impl Rational {
    /// Widens the uncertainties of modes that were fitted together to cover a further one that the noise may
    /// hide. A mode on its own has none: beside it, what the noise may hide counted too much in single modes.
    pub fn cover_hidden(&mut self, again: &Again<'_>) {
        if self.modes.len() < 2 {
            return;
        }
        let Some(hidden) = Hidden::of(again, self.whiteness.inflation) else { return };
        let odds = hidden.odds();
        let draws = hidden.draws(odds);
        let each = (odds / draws.len() as f64).ln();
        for (q, std) in self.std.iter_mut().flatten().enumerate() {
            let with = |draw: &Draw| (draw.log_weight + each, draw.changes[q].0, draw.changes[q].1);
            let found = draws.iter().flatten().map(with);
            let all: Vec<(f64, f64, f64)> = found.chain([(0.0, 0.0, std.powi(2))]).collect();
            let (mean, variance) = mixture(&all);
            *std = holding(&all, std.max(variance.sqrt().hypot(mean)));
        }
        // All were drawn where a further mode matters.
        self.covers_hidden = draws.len() > DRAWS[0];
    }
}

/// Further modes of a fit.
struct Hidden<'a> {
    again: &'a Again<'a>,
    variance: f64,
    /// Degrees of freedom of the noise.
    free: f64,
    /// Frequency and damping ratio of each mode.
    modes: Vec<(f64, f64)>,
    highest: f64,
    /// Frequencies between which a further mode is drawn.
    between: (f64, f64),
    quantities: Vec<f64>,
    /// Density of the phases of the fit.
    of_phases: f64,
    classes: [Vec<Normal>; 2],
}

impl<'a> Hidden<'a> {
    /// `None` where the modes leave no room for one.
    fn of(again: &'a Again<'a>, inflation: f64) -> Option<Hidden<'a>> {
        let Again { scaled, fit, .. } = again;
        let p = &fit.parameters;
        let (variance, free) =
            (fit.variance() * inflation.powi(2), fit.degrees_of_freedom() as f64 / inflation.powi(2));
        let modes: Vec<(f64, f64)> = (0..scaled.starts.len()).map(|m| scaled.shape(p, m)).collect();
        let height = |(m, shape): (usize, &(f64, f64))| p[4 * m + 2].hypot(p[4 * m + 3]) * again.peak(*shape);
        let highest = modes.iter().enumerate().map(height).fold(0.0, f64::max);
        let edge = |sign: f64| modes.iter().map(move |(own, zeta)| own * (1.0 + sign * 2.0 * zeta * REACH));
        let low = edge(-1.0).fold(f64::INFINITY, f64::min).max(scaled.x[0]);
        let high = edge(1.0).fold(0.0, f64::max).min(scaled.x[scaled.x.len() - 1]);
        if !(low < high && highest > 0.0 && highest.is_finite() && modes.iter().all(|mode| mode.1 > 0.0)) {
            return None;
        }
        let quantities = scaled.quantities(p);
        let of_phases = of_phases(&quantities, &scaled.covariance(p, &fit.cofactor, variance)).iter().sum();
        let classes = priors(highest);
        let between = (low, high);
        Some(Hidden { again, variance, free, modes, highest, between, quantities, of_phases, classes })
    }

    /// Odds of a further mode before the lines are seen.
    fn odds(&self) -> f64 {
        let x = &self.again.scaled.x;
        (self.modes.len() as f64 - 0.5) * (self.between.1 - self.between.0) / (x[x.len() - 1] - x[0])
    }

    /// Draws of a further mode, evenly over frequency; the mean of their weights is its evidence. `None` for
    /// one of weight 0.
    fn draws(&self, odds: f64) -> Vec<Option<Draw>> {
        let (low, high) = self.between;
        let mut random = Noise::new(1);
        let mut draws: Vec<Option<Draw>> = Vec::new();
        for count in DRAWS {
            for k in 0..count {
                let own = low + (high - low) * (k as f64 + 0.5) / count as f64;
                let damping = self.nearest(own).ln() + DAMPED_ALIKE.ln() * random.between(-1.0, 1.0);
                let step = Vector2::from_fn(|_, _| random.normal());
                draws.push(self.at((own, damping.exp()), k, step));
            }
            let weights = draws.iter().flatten().map(|draw| draw.log_weight.exp());
            if odds * weights.sum::<f64>() < NEEDED * draws.len() as f64 {
                break;
            }
        }
        draws
    }

    /// Damping ratio of the mode nearest to a frequency.
    fn nearest(&self, own: f64) -> f64 {
        let apart = |(mode, zeta): (f64, f64)| (own - mode).abs() / (zeta * mode);
        let nearest = self.modes.iter().min_by(|a, b| apart(**a).total_cmp(&apart(**b)));
        nearest.map_or(f64::NAN, |(_, zeta)| *zeta)
    }

    /// The draw of a further mode with this frequency and damping ratio, and a height from the distribution
    /// `k`, at `step` standard deviations. `None` where the prior holds none, or the modes do not follow.
    fn at(&self, (own, zeta): (f64, f64), k: usize, step: Vector2<f64>) -> Option<Draw> {
        let Again { scaled, fit, noise, .. } = self.again;
        let n = scaled.x.len();
        let peak = self.again.peak((own, zeta));
        let lines: Vec<Complex64> = (0..n).map(|i| scaled.shaped(i, (own, zeta)) / peak).collect();
        let turned: Vec<Complex64> = lines.iter().map(|v| v * Complex64::i()).collect();
        let columns = DMatrix::from_vec(2 * n, 2, [noise.column(&lines), noise.column(&turned)].concat());
        let shared = fit.jacobian.tr_mul(&columns);
        let left = columns.tr_mul(&columns) - shared.tr_mul(&(&fit.cofactor * &shared));
        let left = left.fixed_view::<2, 2>(0, 0) / self.variance;
        let b = columns.tr_mul(&DVector::from_column_slice(&fit.residuals)) / self.variance;
        let posterior = |prior: &Normal| {
            let covariance = (left + prior.inverse).try_inverse()?;
            Normal::of(covariance * b.fixed_rows::<2>(0), covariance * 4.0)
        };
        let mut all = self.classes.concat();
        all.extend(self.classes.iter().flatten().filter_map(posterior));
        let from = &all[k % all.len()];
        let a = from.mean + from.root * step;
        let found = scaled.beside(noise, fit, &(&columns * a), a.norm() / self.highest)?;
        let p = &found.parameters;
        let one = |s: (f64, f64)| (own - s.0).abs() < APART * (own * zeta + s.0 * s.1);
        if (0..self.modes.len()).any(|m| one(scaled.shape(p, m))) {
            return None;
        }
        let (after, covariance) =
            (scaled.quantities(p), scaled.covariance(p, &found.cofactor, self.variance));
        let of_phases = of_phases(&after, &covariance);
        let prior = self.classes.iter().zip(of_phases);
        let prior: f64 = prior.map(|(class, of_phases)| Normal::mean_density(class, a) * of_phases).sum();
        // The variance of the noise is unknown, with the likelihood (Σr²)^(−ν/2). The parameters have the
        // volume √|(JᵀJ)⁻¹|.
        let volume = found.cofactor.determinant() / fit.cofactor.determinant();
        let better = self.free * (fit.sum_of_squares() / found.sum_of_squares).ln();
        let drawn = Normal::mean_density(&all, a);
        let log_weight = 0.5 * (better + volume.ln()) + (prior / self.of_phases / drawn).ln();
        // The mode of a peak is the nearest to it, whether it follows or is the further one.
        let further = [own * scaled.unit, zeta, a.norm() / peak * scaled.to_constant(), a[1].atan2(a[0])];
        let change = |(q, before): (usize, &f64)| {
            let m = q - q % 4;
            let off = |frequency: f64| (frequency - self.quantities[m]).abs();
            let after = if off(further[0]) < off(after[m]) { further[q % 4] } else { after[q] };
            let by = after - before;
            // The last of four is an angle.
            (if q % 4 == 3 { by.sin().atan2(by.cos()) } else { by }, covariance[(q, q)])
        };
        let changes = self.quantities.iter().enumerate().map(change).collect();
        log_weight.is_finite().then_some(Draw { log_weight, changes })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A second value with a chance of 1 % at 100 standard deviations: four standard uncertainties reach to
    /// where 0.3 % lie beyond, three tenths of the second distribution, 0.524 above its mean. One of 0.2 %
    /// changes nothing.
    #[test]
    fn four_standard_uncertainties_hold_an_unlikely_value() {
        let with = |chance: f64| holding(&[((1.0 - chance).ln(), 0.0, 1.0), (chance.ln(), 100.0, 1.0)], 2.0);
        assert!((with(0.01) - (100.0 + 0.524) / 4.0).abs() < 0.03, "{}", with(0.01));
        assert!((with(0.002) - 2.0).abs() < 1e-9, "{}", with(0.002));
    }

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

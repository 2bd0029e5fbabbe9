//! How the modes of a fit follow a further one.

use super::{LineNoise, Scaled};
use nalgebra::{DMatrix, DVector};
use num_complex::Complex64;
use vibro_math::Fit;

/// The modes of a fit beside a further one.
pub(super) struct Beside {
    pub parameters: Vec<f64>,
    pub sum_of_squares: f64,
    /// Covariance of the parameters for residuals of unit variance.
    pub cofactor: DMatrix<f64>,
}

/// Parts in which a further mode as high as the highest grows from nothing, each followed by a step of Gauss
/// and Newton; a lower one grows in fewer.
const PARTS: f64 = 4.0;

/// Least damping ratio over its first guess on the way; below it the modes no longer follow.
const LEAST_DAMPED: f64 = 0.05;

impl Scaled<'_> {
    /// The fit again to the lines without those of a further mode, `taken`, whitened, of this height over the
    /// highest mode. `None` where the modes do not follow it.
    pub(super) fn beside(
        &self,
        noise: &LineNoise,
        fit: &Fit,
        taken: &DVector<f64>,
        height: f64,
    ) -> Option<Beside> {
        let parts = (PARTS * height).ceil().clamp(1.0, PARTS) as u32;
        let mut p = fit.parameters.clone();
        let mut left = vec![0.0; self.rows()];
        let mut found = None;
        // The last step has the whole mode once more.
        for part in (1..=parts).chain([parts]) {
            self.white(&p, noise, &mut left);
            let left = DVector::from_column_slice(&left) - taken * (f64::from(part) / f64::from(parts));
            let jacobian = self.jacobian(&p, noise);
            let root = jacobian.tr_mul(&jacobian).cholesky()?;
            let step = root.solve(&jacobian.tr_mul(&left));
            p.iter_mut().zip(step.iter()).for_each(|(p, step)| *p -= step);
            if !(0..self.starts.len()).all(|m| p[4 * m + 1] > LEAST_DAMPED) {
                return None;
            }
            found = (part == parts).then(|| (left - jacobian * step, root));
        }
        let (left, root) = found?;
        Some(Beside { parameters: p, sum_of_squares: left.norm_squared(), cofactor: root.inverse() })
    }

    /// Derivatives of the whitened residuals with respect to all parameters.
    pub(super) fn jacobian(&self, p: &[f64], noise: &LineNoise) -> DMatrix<f64> {
        let n = self.x.len();
        let mut columns = Vec::with_capacity(2 * n * p.len());
        let mut model = |lines: Vec<Complex64>| columns.extend(noise.column(&lines).iter().map(|v| -v));
        let times_i = |lines: &[Complex64]| lines.iter().map(|v| v * Complex64::i()).collect();
        for (m, (f, zeta)) in self.starts.iter().enumerate() {
            let ((own, damping), a) = (self.shape(p, m), Complex64::new(p[4 * m + 2], p[4 * m + 3]));
            // A central difference over a part h of the half bandwidth errs by h².
            let (step, unit) = (1e-4 * damping, f * zeta / self.unit);
            let change = |up: (f64, f64), down: (f64, f64), over: f64| {
                (0..n).map(|i| a * (self.shaped(i, up) - self.shaped(i, down)) / over).collect()
            };
            let (up, down) = (own * (1.0 + step), own * (1.0 - step));
            model(change((up, damping), (down, damping), (up - down) / unit));
            let (up, down) = (damping + step, damping - step);
            model(change((own, up), (own, down), (up - down) / zeta));
            let lines: Vec<Complex64> = (0..n).map(|i| self.shaped(i, (own, damping))).collect();
            let turned = times_i(&lines);
            model(lines);
            model(turned);
        }
        let below = self.factor.iter().zip(&self.x).map(|(f, x)| f / (x * x)).collect();
        for lines in [self.factor.clone(), below] {
            let turned = times_i(&lines);
            model(lines);
            model(turned);
        }
        DMatrix::from_vec(2 * n, p.len(), columns)
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
    use crate::modal::{Measured, Pole};
    use vibro_record::units::Quantity;

    /// Two modes of one bandwidth on lines a sixth of it apart; the fit of the first alone follows the second
    /// to the parameters that made the lines.
    #[test]
    fn what_is_left_without_a_further_mode_is_the_other() {
        let pole = |frequency: f64, constant: Complex64| Pole { frequency, zeta: 0.02, constant };
        let poles = [pole(100.0, 1.0.into()), pole(102.0, Complex64::new(0.3, 0.1))];
        let frequency: Vec<f64> = (0..121).map(|k| 80.0 + f64::from(k) / 3.0).collect();
        let values = frequency.iter().map(|f| poles.iter().map(|p| p.at(*f, 1)).sum()).collect();
        let measured = Measured::new(frequency.clone(), values, Quantity::Mobility);
        let starts = [(100.5, 0.02)];
        let scaled = Scaled::of(&measured, 0..121, &starts, &[]);
        let noise = LineNoise::independent(vec![1.0; 121]);
        let one = scaled.refit(&noise).unwrap();
        let second: Vec<Complex64> = frequency.iter().map(|f| poles[1].at(*f, 1) / scaled.height).collect();
        let taken = DVector::from_vec(noise.column(&second));
        let found = scaled.beside(&noise, &one, &taken, 1.0).unwrap();
        let [f, zeta, constant, phase] = scaled.quantities(&found.parameters).try_into().unwrap();
        // Five steps, of which each squares the error of the one before.
        assert!((f - 100.0).abs() < 1e-3 && (zeta - 0.02).abs() < 1e-5, "{f} {zeta}");
        assert!((constant - 1.0).abs() < 1e-3 && phase.abs() < 1e-3, "{constant} {phase}");
        assert!(one.sum_of_squares() > 1e3 * found.sum_of_squares);
        // The fit has the same derivatives by differences.
        let jacobian = scaled.jacobian(&one.parameters, &noise);
        let off = (&jacobian - &one.jacobian).norm();
        assert!(off < 1e-5 * jacobian.norm(), "{off}");
    }
}

//! A fit once more at its minimum, to widen its uncertainties.

use super::rivals::rivals;
use super::{LineNoise, Rational, Scaled};
use crate::modal::{Measured, Pole};
use nalgebra::DMatrix;
use num_complex::Complex64;
use std::ops::Range;
use vibro_math::Fit;

/// A fit at its minimum.
pub struct Again<'a> {
    pub(super) scaled: Scaled<'a>,
    pub(super) fit: Fit,
    pub(super) noise: LineNoise,
    /// All that the noise may be.
    pub(super) rivals: Vec<LineNoise>,
}

impl Rational {
    /// Frequency in Hz and damping ratio of each mode.
    pub fn starts(&self) -> Vec<(f64, f64)> {
        self.modes.iter().map(|mode| (mode.frequency, mode.zeta)).collect()
    }

    /// The fit from its own minimum as first guess, which is near `starts`; `others` are subtracted from the
    /// lines `part` first. `None` without phases, or where a mode grows.
    pub fn again<'a>(
        &self,
        measured: &Measured,
        part: Range<usize>,
        others: &[Pole],
        starts: &'a [(f64, f64)],
    ) -> Option<Again<'a>> {
        if measured.magnitude_only || starts.iter().any(|(_, zeta)| *zeta <= 0.0) {
            return None;
        }
        let scaled = Scaled::of(measured, part.clone(), starts, others);
        let fit = scaled.refit(&self.weights)?;
        let rivals = rivals(measured, part, &scaled, &fit.parameters);
        let rivals = rivals.into_iter().map(|(noise, _)| noise).collect();
        Some(Again { scaled, fit, noise: self.weights.clone(), rivals })
    }
}

impl Again<'_> {
    /// Height of the peak of a mode with a constant of 1.
    pub(super) fn peak(&self, (own, zeta): (f64, f64)) -> f64 {
        1.0 / (2.0 * zeta * own.powi(2 - self.scaled.power))
    }
}

impl Scaled<'_> {
    /// The fit from the first guesses of frequency and damping.
    pub(super) fn refit(&self, noise: &LineNoise) -> Option<Fit> {
        let mut p = vec![0.0; 4 * self.starts.len() + 4];
        (0..self.starts.len()).for_each(|m| p[4 * m + 1] = 1.0);
        self.linear(&mut p, &noise.each)?;
        self.fit(&p, noise).ok()
    }

    /// Frequency in Hz, damping ratio, magnitude and phase of the modal constant, of each mode in turn.
    pub(super) fn quantities(&self, p: &[f64]) -> Vec<f64> {
        let of = |m: usize| {
            let ((own, zeta), a) = (self.shape(p, m), Complex64::new(p[4 * m + 2], p[4 * m + 3]));
            [own * self.unit, zeta, a.norm() * self.to_constant(), a.arg()]
        };
        (0..self.starts.len()).flat_map(of).collect()
    }

    /// Covariance of the quantities for that of the parameters, `cofactor` times `variance`.
    pub(super) fn covariance(&self, p: &[f64], cofactor: &DMatrix<f64>, variance: f64) -> DMatrix<f64> {
        let slopes = self.slopes(p);
        &slopes * cofactor * slopes.transpose() * variance
    }
}

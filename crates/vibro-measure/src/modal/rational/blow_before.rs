//! What the blow before a record left in it.

use super::Rational;
use super::again::Again;
use crate::modal::BlowRecords;
use nalgebra::DVector;
use num_complex::Complex64;
use std::f64::consts::TAU;

impl Rational {
    /// Widens the uncertainties to cover what the blow before left: e^(sT) of its own response after the time
    /// T, which has the poles of the modes and any phase, but begins with the record. Its mean over blows of
    /// independent phases is smaller by √n; a coherence needs two. The `decay` in 1/s that an exponential
    /// window adds is not its own.
    pub fn cover_blow_before(&mut self, again: &Again<'_>, blows: &BlowRecords, decay: f64) {
        let Again { scaled, fit, .. } = again;
        let Some(leakage) = &scaled.leakage else { return };
        let p = &fit.parameters;
        let gain = scaled.slopes(p) * &fit.cofactor * fit.jacobian.transpose();
        for (m, mode) in self.modes.iter().enumerate() {
            let decay = TAU * mode.frequency * mode.zeta - decay;
            let left = (-decay * blows.apart.unwrap_or(blows.after)).exp();
            let each = left / (2.0 * blows.count.unwrap_or(2.0)).sqrt();
            for phase in [Complex64::ONE, Complex64::i()].map(|phase| each * phase) {
                let constant = phase * p[4 * m + 2].hypot(p[4 * m + 3]);
                let line = |x: &f64| leakage.blow_before(*x, scaled.shape(p, m), scaled.power, constant);
                let lines: Vec<Complex64> = scaled.x.iter().map(line).collect();
                let changes = &gain * DVector::from_vec(self.weights.column(&lines));
                self.std.iter_mut().flatten().zip(changes.iter()).for_each(|(std, by)| *std = std.hypot(*by));
            }
        }
    }
}

//! How strongly samples prefer one model of a contact to another.

use super::ContactModel;
use super::fit::FittedPulse;
use super::losses::EXPONENT;
use super::result::LIKELY;
use crate::mean::mixture;
use crate::residuals::{aicc, quasi};
use vibro_math::Fit;

impl FittedPulse {
    /// Corrected Akaike criterion (`AICc`).
    pub fn aicc(&self) -> f64 {
        aicc(self.fit.sum_of_squares(), self.fit.residuals.len(), self.determined())
    }

    /// Akaike's criterion over that of `other`, for noise of this `dispersion`.
    pub fn behind(&self, other: &FittedPulse, dispersion: f64) -> f64 {
        let ratio = self.fit.sum_of_squares() / other.fit.sum_of_squares();
        quasi(self.aicc() - other.aicc(), self.fit.residuals.len(), ratio, dispersion)
    }

    /// Effective number of parameters: an exponent counts by the part of its prior variance that the samples
    /// remove (Spiegelhalter et al., J. R. Statist. Soc. B 64 (2002) 583).
    fn determined(&self) -> f64 {
        let unknown: f64 = if self.losses.is_empty() { 0.0 } else { self.unknown().sum() };
        self.fit.parameters.len() as f64 - unknown
    }

    /// Part of the prior variance of each exponent that the samples leave.
    fn unknown(&self) -> impl Iterator<Item = f64> {
        let exponents = if self.model == ContactModel::PowerLaw { &LIKELY[..] } else { &[] };
        exponents.iter().enumerate().map(|(i, (_, std))| {
            let own = |fit: &Fit| (fit.parameters[EXPONENT + i], fit.covariance(EXPONENT + i, EXPONENT + i));
            let of = |(weight, given): &(f64, FittedPulse)| {
                let (value, variance) = own(&given.fit);
                (*weight, value, variance)
            };
            let averaged = || mixture(&self.losses.iter().map(of).collect::<Vec<_>>()).1;
            let variance = if self.losses.is_empty() { own(&self.fit).1 } else { averaged() };
            (variance / (std * std)).min(1.0)
        })
    }

    /// Twice the logarithm of the evidence for a law of fixed exponents over that for this one, beyond the
    /// difference of Akaike's criterion: of the prior of each exponent the samples leave a part, and the
    /// narrower it is, the fewer of the laws fit (Kass & Raftery, J. Am. Statist. Assoc. 90 (1995) 773).
    pub(super) fn improbable(&self) -> f64 {
        let exponents = self.unknown().count() as f64;
        let counted = exponents - (self.fit.parameters.len() as f64 - self.determined());
        self.unknown().map(|part| -part.ln()).sum::<f64>() - 2.0 * counted
    }
}

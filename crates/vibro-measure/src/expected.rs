//! What a record will tell before it is made: the expected uncertainty of each answer.
//!
//! The model that an estimator fits is fitted, by that estimator's own code, to the record that the guess
//! would give without noise. The Jacobian J of that fit and the covariance C of the noise give the covariance
//! of its parameters, `(JᵀJ)⁻¹JᵀCJ(JᵀJ)⁻¹`, with onset, offset and gain among them. For white noise this is
//! the Cramér–Rao bound (Kay 1993, 3.4).

mod drawn;
mod rehearsal;

pub(crate) use drawn::DrawnNoise;
pub use rehearsal::{Heard, Refusal, Rehearsal, Rehearsed, Shown};

use crate::Estimate;
use crate::converter::rounding;
use crate::pulse::LowPass;
use vibro_math::Fit;
use vibro_record::{Error, Finding, Result};

/// Correlation beyond which two parameters are known only in combination: to know one would divide the
/// uncertainty of the other by 1/√(1 − r²) = 5.
pub const TIED: f64 = 0.98;

/// Multiples of the sampling rate from which filtered noise is folded back. A low-pass of order 1 with its
/// corner at the sampling rate leaves 1 % of the power beyond.
const FOLDS: u32 = 64;

/// Most values of a planned fit.
const MOST: f64 = 2e4;

/// The instrument of a planned record, in the unit of that record.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Recorder {
    /// Sampling rate in Hz.
    pub rate: f64,
    /// Length of a record in s.
    pub duration: f64,
    /// Step of the converter; 0 where it does not count.
    pub step: f64,
    /// Largest value of the converter; `None` where it does not count.
    pub range: Option<f64>,
    /// Standard deviation of white noise of a sample, added behind the low-pass.
    pub noise: f64,
    /// One-sided spectral density of the sensor's noise before the low-pass, per √Hz.
    pub density: f64,
    /// Low-pass between sensor and converter.
    pub low_pass: Option<LowPass>,
}

impl Recorder {
    /// Variance of white noise of a sample: noise, and rounding to a step q with the variance q²/12 (Widrow &
    /// Kollár 2008).
    fn white(&self) -> f64 {
        let sensor = if self.low_pass.is_none() { 0.5 * self.rate * self.density.powi(2) } else { 0.0 };
        self.noise.powi(2) + rounding(self.step).powi(2) + sensor
    }

    /// Whether the noise of neighbouring samples is independent.
    pub fn is_white(&self) -> bool {
        self.low_pass.is_none() || self.density == 0.0
    }

    /// Covariance of two samples that are `apart` samples apart.
    pub fn covariance(&self, apart: usize) -> f64 {
        let filtered = self
            .low_pass
            .as_ref()
            .map_or(0.0, |filter| self.density.powi(2) * filter.autocovariance(apart as f64 / self.rate));
        filtered + self.covariance_of_white(apart)
    }

    /// The part of the covariance that white noise has.
    fn covariance_of_white(&self, apart: usize) -> f64 {
        if apart == 0 { self.white() } else { 0.0 }
    }

    /// One-sided spectral density of the noise at `frequency` in Hz, squared unit per Hz.
    pub fn spectrum(&self, frequency: f64) -> f64 {
        // What lies beyond half the sampling rate is folded back.
        let folded = |filter: &LowPass| {
            let above =
                (1..=FOLDS).flat_map(|k| [-1.0, 1.0].map(|side| f64::from(k) * self.rate + side * frequency));
            std::iter::once(frequency).chain(above).map(|f| filter.gain(f).powi(2)).sum::<f64>()
        };
        let filtered = self.low_pass.as_ref().map_or(0.0, folded);
        2.0 * self.white() / self.rate + self.density.powi(2) * filtered
    }

    /// Refuses a record whose largest value is beyond the range of the converter.
    pub(crate) fn holds(&self, largest: f64) -> Result<()> {
        let Some(range) = self.range.filter(|range| largest > *range) else { return Ok(()) };
        let why = format!("the record reaches {largest:.3}, the converter {range}: it would be clipped");
        Err(Error::refused(why).hint("a larger range").setting("range"))
    }

    /// Number of samples of a record.
    pub fn samples(&self) -> usize {
        (self.rate * self.duration) as usize
    }

    /// Refuses a fit of more than [`MOST`] samples or lines, whose covariance would take too long.
    pub(crate) fn check_work(samples: f64) -> Result<()> {
        if samples <= MOST {
            return Ok(());
        }
        let why = format!("a fit of {samples:.0} values: a plan takes {MOST:.0} at most");
        let hint = "plan with a lower sampling rate, or a shorter record; rates are in Hz, times in s";
        Err(Error::refused(why).hint(hint).setting("rate"))
    }
}

/// Two parameters that a record tells apart badly.
#[derive(Debug, Clone, PartialEq)]
pub struct Tie {
    /// Names of the two.
    pub of: [String; 2],
    /// Their correlation.
    pub correlation: f64,
}

/// What a planned record will tell.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Expected {
    /// Answers by name, with the standard uncertainty of one record.
    pub answers: Vec<(String, Estimate)>,
    /// Pairs of parameters whose correlation exceeds [`TIED`].
    pub ties: Vec<Tie>,
    /// What will make the answers less certain than that.
    pub findings: Vec<Finding>,
}

impl Expected {
    /// Adds an answer.
    pub fn put(&mut self, name: impl Into<String>, estimate: &Estimate) {
        self.answers.push((name.into(), estimate.clone()));
    }

    /// Adds the pairs of these parameters of a fit that it tells apart badly.
    pub fn tie(&mut self, fit: &Fit, names: &[(usize, String)]) {
        for (k, (i, first)) in names.iter().enumerate() {
            for (j, second) in &names[k + 1..] {
                let correlation = fit.correlation(*i, *j);
                if correlation.abs() > TIED {
                    self.ties.push(Tie { of: [first.clone(), second.clone()], correlation });
                }
            }
        }
    }
}

#[cfg(test)]
mod tests;

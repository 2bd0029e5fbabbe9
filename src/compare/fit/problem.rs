//! Weighted residuals of the steps whose motion is known.

use super::super::prediction::Kind;
use super::calibration::Calibration;
use super::data::{Data, Step};
use super::setting::Setting;
use super::shared::Shared;
use super::unknown::{Unknown, at, fold};
use crate::campaign::Parameter;
use crate::error::Result;
use crate::math::{Minimum, minimise};

/// Relative step of a difference.
const NEAR: f64 = 1e-6;

/// A sum of squares to be minimised: data with weights, and priors.
///
/// Frequency and force of a step err by `σ_f` and `σ_F` for both masses alike, so their amplitudes have the covariance
/// `diag(σ²) + σ_f²aaᵀ + σ_F²bbᵀ`, a and b the slopes of the predicted amplitudes over frequency and force. The residuals, over σ, are
/// multiplied by the inverse square root of what that leaves ([`Shared`]).
#[derive(Debug, Clone)]
pub struct Problem<'a> {
    pub data: &'a Data,
    pub base: Setting,
    pub unknowns: Vec<Unknown>,
    /// Motion of each step; `None` leaves it out.
    pub kinds: Vec<Option<Kind>>,
    /// Errors that both masses of a step share.
    pub shared: Vec<Shared>,
    /// Variances of the data are so much larger than stated.
    pub scale: f64,
    /// Errors shared by all points of a mass.
    pub calibration: Calibration,
}

impl<'a> Problem<'a> {
    /// Of these motions; weights are still to be taken.
    pub fn new(data: &'a Data, base: &Setting, unknowns: &[Unknown], kinds: &[Option<Kind>]) -> Problem<'a> {
        Problem {
            data,
            base: *base,
            unknowns: unknowns.to_vec(),
            kinds: kinds.to_vec(),
            shared: Vec::new(),
            scale: 1.0,
            calibration: Calibration::default(),
        }
    }
}

impl Problem<'_> {
    /// Amplitudes that take part: index of the step and of the mass.
    pub fn used(&self) -> impl Iterator<Item = (usize, usize)> + '_ {
        self.data.steps.iter().zip(&self.kinds).enumerate().filter(|(_, (_, kind))| kind.is_some()).flat_map(
            |(i, (step, kind))| {
                step.clear()
                    .map(|(mass, _)| mass)
                    .filter(|mass| counts(*kind, *mass))
                    .map(move |mass| (i, mass))
            },
        )
    }

    /// Number of residuals: data, then one for each prior.
    pub fn rows(&self) -> (usize, usize) {
        (self.used().count(), self.unknowns.iter().filter(|u| u.prior.is_some()).count())
    }

    /// The setting at these coordinates.
    pub fn setting(&self, u: &[f64]) -> Setting {
        at(&self.base, &self.unknowns, u)
    }

    /// Takes the shares of frequencies, forces and calibrations from the setting at `u`.
    pub fn weigh(&mut self, u: &[f64]) {
        let setting = self.setting(u);
        let shared = |(step, kind): (&Step, &Option<Kind>)| {
            let Some(kind) = *kind else { return Shared::default() };
            let force = setting.force_at(self.data, step);
            // By so many standard uncertainties the amplitudes change with a relative change of frequency or force, which errs by `std`.
            let error = |std: f64, shows: &dyn Fn(f64) -> [f64; 2]| {
                let mut w = [0.0; 2];
                if std > 0.0 {
                    let slopes = slopes(shows);
                    for (mass, seen) in step.clear().filter(|(mass, _)| counts(Some(kind), *mass)) {
                        w[mass] = slopes[mass] * std / seen.std;
                    }
                }
                w
            };
            Shared::new([
                error(step.frequency_std / step.frequency, &|by| {
                    setting.shows(kind, force, step.frequency * by)
                }),
                error(step.force_std / step.force, &|by| setting.shows(kind, force * by, step.frequency)),
            ])
        };
        self.shared = self.data.steps.iter().zip(&self.kinds).map(shared).collect();
        self.calibration = Calibration::new(&self.shares(&setting));
    }

    /// By how much each residual changes by one standard uncertainty of the calibrations: of each mass' factor, of its slope, 1 at the ends of
    /// the frequencies, and of the force where it is not looked for. That moves gap and amplitudes alike, and no amplitude tells it.
    fn shares(&self, setting: &Setting) -> Vec<Vec<f64>> {
        if self.data.calibration == 0.0 {
            return Vec::new();
        }
        let frequencies = self.data.steps.iter().map(|s| s.frequency);
        let (low, high) =
            frequencies.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), f| (l.min(f), h.max(f)));
        let share = |mass: usize, sloped: bool| {
            self.scaled(|step, kind| {
                let along = match sloped {
                    false => 1.0,
                    true if high > low => (2.0 * step.frequency - low - high) / (high - low),
                    true => 0.0,
                };
                let shows = setting.shows(kind, setting.force_at(self.data, step), step.frequency);
                let mut error = [0.0; 2];
                error[mass] = shows[mass] * self.data.calibration * along;
                error
            })
        };
        let mut shares =
            [(0, false), (1, false), (0, true), (1, true)].map(|(mass, sloped)| share(mass, sloped)).to_vec();
        if self.unknowns.iter().all(|u| u.parameter != Parameter::Force) {
            shares.push(self.scaled(|step, kind| {
                let force = setting.force_at(self.data, step);
                slopes(|by| setting.shows(kind, force * by, step.frequency))
                    .map(|s| s * self.data.calibration)
            }));
        }
        shares
    }

    /// What `of` makes of each step and its motion, in m for both masses, over their standard deviations.
    fn scaled(&self, of: impl Fn(&Step, Kind) -> [f64; 2]) -> Vec<f64> {
        let mut all = Vec::new();
        for ((step, kind), shared) in self.data.steps.iter().zip(&self.kinds).zip(&self.shared) {
            let Some(kind) = *kind else { continue };
            let of = of(step, kind);
            let mut s = [None; 2];
            for (mass, seen) in step.clear().filter(|(mass, _)| counts(Some(kind), *mass)) {
                s[mass] = Some(of[mass] / seen.std);
            }
            // What does not count has no share, and leaves the other as it is.
            let allowed = shared.allow(s.map(|s| s.unwrap_or(0.0)));
            all.extend(s.iter().zip(allowed).filter_map(|(s, allowed)| s.and(Some(allowed))));
        }
        all
    }

    /// Measured less what `shown` makes of each step and its motion, in units of their standard deviation.
    pub fn off(&self, shown: impl Fn(&Step, Kind) -> [f64; 2]) -> Vec<f64> {
        let widened = self.scale.sqrt();
        let mut all = self.scaled(|step, kind| {
            let shown = shown(step, kind);
            [0, 1].map(|mass: usize| step.seen[mass].as_ref().map_or(0.0, |s| s.amplitude) - shown[mass])
        });
        for r in &mut all {
            *r /= widened;
        }
        self.calibration.allow(&mut all, widened);
        all
    }

    /// Residuals at `u` in units of their standard deviation.
    pub fn residuals(&self, u: &[f64], r: &mut [f64]) {
        let setting = self.setting(u);
        let mut all =
            self.off(|step, kind| setting.shows(kind, setting.force_at(self.data, step), step.frequency));
        for unknown in &self.unknowns {
            if let Some([value, std]) = unknown.prior {
                all.push((setting.get(unknown.parameter) - value) / std);
            }
        }
        r.iter_mut().zip(all).for_each(|(r, value)| *r = value);
    }

    /// Residuals at `u`, data and priors.
    pub fn at(&self, u: &[f64]) -> Vec<f64> {
        let (data, priors) = self.rows();
        let mut r = vec![0.0; data + priors];
        self.residuals(u, &mut r);
        r
    }

    /// The minimum from `start` on.
    ///
    /// # Errors
    /// As [`minimise`].
    pub fn solve(&self, start: &[f64]) -> Result<Minimum> {
        let (data, priors) = self.rows();
        let mut minimum =
            minimise(|u, r| self.residuals(u, r), data + priors, start, &vec![0.1; start.len()])?;
        for (i, lower) in fold(&self.unknowns, &mut minimum.parameters).into_iter().enumerate() {
            if lower {
                minimum.jacobian.column_mut(i).neg_mut();
            }
        }
        Ok(minimum)
    }
}

/// Change of both amplitudes by a relative change of what `shows` multiplies by its argument; 0 at the end of a motion, where there is none.
///
/// A central difference over a millionth errs by 1e-12 of the third derivative and 1e-10 of the value.
fn slopes(shows: impl Fn(f64) -> [f64; 2]) -> [f64; 2] {
    let [above, below] = [1.0 + NEAR, 1.0 - NEAR].map(shows);
    [0, 1].map(|mass| (above[mass] - below[mass]) / (2.0 * NEAR)).map(|s| if s.is_finite() { s } else { 0.0 })
}

/// Whether the amplitude of a mass counts in a motion of this kind: a mass at rest shows no parameter.
pub fn counts(kind: Option<Kind>, mass: usize) -> bool {
    mass == 0 || kind == Some(Kind::Impacting)
}

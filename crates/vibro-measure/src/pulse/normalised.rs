//! A record in units of its pulse, and the way back.

use super::fit::{Fitted, Samples, Seen};
use super::locate::Located;
use super::result::{PulseCurve, PulseFit, PulsePicture, propagated};
use super::{ContactModel, HuntCrossley, LowPass};
use crate::Estimate;
use crate::mean::average;
use crate::residuals::aicc;
use std::collections::BTreeMap;
use std::ops::Range;
use vibro_record::units::Quantity;
use vibro_record::{Error, Finding, Result, Trace};

/// A record with time over the length of its pulse, from half the height of the rising flank, and values over its height.
pub(super) struct Normalised<'a> {
    trace: &'a Trace,
    found: &'a Located,
    /// Sampling interval in s.
    step: f64,
    /// Unit of time in s: about the duration of the pulse.
    pub length: f64,
    /// Unit of the values.
    height: f64,
    seen: Seen,
}

/// A mean of this part of the root mean square is another level; what rings is on both sides of its own.
const LEVEL: f64 = 0.5;

/// Lengths of the pulse that are fitted before and after it, for the baseline.
const BESIDE: f64 = 2.0;

/// Fewest samples up to the falling flank: five parameters and four degrees of freedom.
const FEWEST: usize = 9;

impl<'a> Normalised<'a> {
    pub fn new(
        trace: &'a Trace,
        rate: f64,
        found: &'a Located,
        filter: Option<&LowPass>,
    ) -> Result<Normalised<'a>> {
        let step = 1.0 / rate;
        // A half sine is above half its height for two thirds of its length.
        let length = 1.5 * (found.flanks.1 - found.flanks.0) * step;
        let filter = filter.map(|f| LowPass::new(f.corner * length, f.order)).transpose()?;
        let hertz = HuntCrossley::new(0.0).ok_or_else(|| Error::refused("no shape of a Hertzian contact"))?;
        let seen = Seen { step: step / length, filter, hertz };
        Ok(Normalised { trace, found, step, length, height: found.height.abs(), seen })
    }

    fn time(&self, index: usize) -> f64 {
        (index as f64 - self.found.flanks.0) * self.step / self.length
    }

    fn index(&self, time: f64) -> usize {
        let place = self.found.flanks.0 + time * self.length / self.step;
        (place.max(0.0).ceil() as usize).min(self.trace.values.len())
    }

    /// Time in s of the record.
    fn seconds(&self, time: f64) -> f64 {
        self.trace.axis.start() + self.found.flanks.0 * self.step + time * self.length
    }

    /// The usable samples of a part of the record.
    fn samples(&self, range: Range<usize>) -> Samples<'_> {
        let usable = |i: &usize| self.trace.values[*i].is_finite() && !self.found.clipped.contains(i);
        let places: Vec<usize> = range.filter(usable).collect();
        let times = places.iter().map(|i| self.time(*i)).collect();
        let values = places.iter().map(|i| self.trace.values[*i] / self.height).collect();
        Samples { seen: &self.seen, places, times, values }
    }

    /// The samples to be fitted: the pulse with a baseline on both sides, or only before it where the record does not rest after it;
    /// and whether the record comes back to the level before the pulse.
    ///
    /// # Errors
    /// If there are too few samples, or no contact of spring and damper fits the pulse, as `unlike` says.
    pub fn window(
        &self,
        findings: &mut Vec<Finding>,
        unlike: impl Fn(Error) -> Error,
    ) -> Result<(Samples<'_>, bool)> {
        let delay = self.seen.delay();
        let from = self.index(-BESIDE - delay);
        let first = self.samples(from..self.found.low);
        let n = first.times.len();
        if n < FEWEST {
            let why =
                format!("the pulse has {n} usable samples, and {FEWEST} are needed for five parameters");
            let hint = "sample faster, and record some of the baseline before the pulse";
            return Err(Error::refused(why).hint(hint));
        }
        self.faults(from..self.found.low, findings);
        let fitted = first.fit(ContactModel::KelvinVoigt).map_err(unlike)?;
        let settled = self.index(fitted.end() + 3.0 * delay);
        let far = self.index(fitted.end() + 3.0 * delay + BESIDE);
        let after = self.samples(settled..far);
        // Mean and root of the mean square of what is left after the pulse.
        let model = fitted.at(&after, &after.times).unwrap_or_default();
        let left: Vec<f64> = model.iter().zip(&after.values).map(|(m, v)| v - m).collect();
        let mean = average(&left);
        let rms = average(&left.iter().map(|d| d * d).collect::<Vec<f64>>()).sqrt();
        let inside = (fitted.fit.sum_of_squares() / n as f64).sqrt().max(1e-6);
        let restless = left.len() >= 4 && rms > 4.0 * inside;
        let level = !restless || mean.abs() <= LEVEL * rms;
        if restless {
            let caution = Finding::caution("pulse-no-rest-after");
            findings.push(if level { caution } else { Finding::doubt("pulse-level-changes") });
        }
        let end = if restless { self.index(fitted.end()).max(self.found.low) } else { far };
        Ok((self.samples(from..end), level))
    }

    /// What is wrong with the record around the pulse.
    fn faults(&self, range: Range<usize>, findings: &mut Vec<Finding>) {
        let Normalised { trace, found, .. } = self;
        if let Some(first) = found.clipped.first() {
            let clipped = Finding::caution("pulse-clipped").count("n", found.clipped.len());
            let level = clipped.number("level", trace.values[*first]);
            findings.push(level.name("unit", trace.meta.unit.symbol()));
        }
        let missing = range.filter(|i| trace.values[*i].is_nan()).count();
        if missing > 0 {
            findings.push(Finding::caution("pulse-samples-missing").count("n", missing));
        }
        let other = (0..trace.values.len())
            .filter(|i| !(-0.5..=2.0).contains(&self.time(*i)))
            .find(|i| (trace.values[*i] - found.baseline) / found.height > 0.5);
        findings.extend(other.map(|i| Finding::caution("pulse-not-alone").number("time", trace.axis.at(i))));
    }

    /// Factor from the fitted velocity to m/s, where the record is an acceleration, or a force on a known mass.
    pub(crate) fn to_velocity(&self, mass: Option<f64>) -> Option<f64> {
        let unit = self.height * self.length;
        match self.trace.meta.quantity {
            Quantity::Acceleration => Some(unit),
            Quantity::Force => mass.map(|mass| unit / mass),
            _ => None,
        }
    }

    /// A fit in SI units; without uncertainties unless the instrument is `known`.
    pub fn report(&self, fitted: &Fitted, mass: Option<f64>, known: bool) -> PulseFit {
        let Fitted { model, fit, whiteness, widening, .. } = fitted;
        let n = fit.residuals.len();
        let widened = widening.filter(|_| known).unwrap_or(f64::NAN);
        let estimate = |value: f64, std: f64, unit| {
            let value = widening.map_or(f64::NAN, |_| value);
            Estimate::new(value, Some(std), unit, n, "least squares")
        };
        let mut parameters = BTreeMap::new();
        let mut put = |name, i: usize, factor: f64, shift: f64, unit| {
            let std = factor.abs() * fit.std(i) * widened;
            parameters.insert(name, estimate(shift + factor * fit.parameters[i], std, unit));
        };
        put("onset", 0, self.length, self.seconds(0.0), "s");
        let unit = self.trace.meta.quantity.symbol();
        put("baseline", 1, self.height, 0.0, unit);
        if let Some(factor) = self.to_velocity(mass) {
            put("initial_velocity", 2, factor * self.found.height.signum(), 0.0, "m/s");
        }
        match model {
            ContactModel::KelvinVoigt => {
                put("xi", 3, 1.0, 0.0, "1");
                put("frequency", 4, 1.0 / self.length, 0.0, "Hz");
            }
            ContactModel::Hertz => put("duration", 3, self.length, 0.0, "s"),
            ContactModel::HuntCrossley => {
                put("duration", 3, self.length, 0.0, "s");
                put("alpha", 4, 1.0, 0.0, "1");
                let restitution = |p: &[f64]| HuntCrossley::new(p[0]).map(|c| c.restitution());
                let variance = |_, _| (fit.std(4) * widened).powi(2);
                if let Some((r, std)) = propagated(&fit.parameters[4..], &[1e3], variance, restitution) {
                    parameters.insert("restitution", estimate(r, std, "1"));
                }
            }
        }
        PulseFit {
            model: *model,
            residual: self.height * (fit.sum_of_squares() / n as f64).sqrt(),
            aicc: aicc(fit.sum_of_squares(), n, fit.parameters.len()),
            whiteness: whiteness.p_value,
            n,
            parameters,
        }
    }

    /// What a figure needs.
    pub fn picture(&self, samples: &Samples<'_>, fits: &[Fitted]) -> PulsePicture {
        let from = self.index(-1.5);
        let end = fits.iter().map(Fitted::end).fold(1.0, f64::max);
        let to = self.index(end + 1.5);
        let fitted = |i: usize| samples.places.binary_search(&i).is_ok();
        let shown = |i: usize| (self.trace.axis.at(i), self.trace.values[i], fitted(i));
        let (a, b) = (self.time(from), self.time(to));
        let times: Vec<f64> = (0..=600).map(|i| a + (b - a) * f64::from(i) / 600.0).collect();
        let si = |times: &[f64], values: &[f64]| {
            times.iter().zip(values).map(|(t, v)| (self.seconds(*t), v * self.height)).collect()
        };
        let curve = |fit: &Fitted| {
            let points = si(&times, &fit.at(samples, &times)?);
            Some(PulseCurve { model: fit.model, points, residuals: si(&samples.times, &fit.fit.residuals) })
        };
        PulsePicture {
            quantity: (self.trace.meta.quantity.name(), self.trace.meta.unit.symbol().to_owned()),
            samples: (from..to).map(shown).collect(),
            curves: fits.iter().filter_map(curve).collect(),
        }
    }
}

//! Scales a record to its pulse, and converts fits back to SI units.

use super::fit::{FittedPulse, Samples};
use super::located::Located;
use super::result::{PulseCurve, PulseFit, PulsePicture, propagated};
use super::ringing::Ringing;
use super::{ContactModel, KelvinVoigt, LowPass, Rebound};
use crate::Estimate;
use crate::converter::rounding;
use crate::mean::{average, mixture};
use crate::residuals::widened;
use std::cell::RefCell;
use std::collections::BTreeMap;
use std::ops::Range;
use vibro_math::Fit;
use vibro_record::code;
use vibro_record::units::Quantity;
use vibro_record::{Doubt, Error, Finding, Result, Trace};

/// A record scaled to its pulse: time over the length of the pulse, from half height of the rising flank,
/// and values over the height of the pulse.
pub(super) struct Normalised<'a> {
    trace: &'a Trace,
    found: &'a Located,
    /// Sampling interval in s.
    step: f64,
    /// Unit of time in s: about the duration of the pulse.
    pub length: f64,
    /// Height of the pulse, in the unit of the record: unit of the values.
    height: f64,
    /// The low-pass with its corner in cycles per length of the pulse.
    filter: Option<LowPass>,
}

/// Mean over root mean square of the residuals after the pulse above which the record has changed its level:
/// ringing has a mean near zero.
const LEVEL: f64 = 0.5;

/// Record beside the contact whose level counts for it, on either side, in lengths of the pulse: slower drift
/// goes into the baseline.
const NEAR: f64 = 8.0;

/// Stretches of a contact whose levels show drift: more of them lie beside it, and their levels scatter by
/// drift as much as that of a whole contact or more.
const STRETCHES: f64 = 4.0;

/// Baseline fitted before and after the pulse, in lengths of the pulse.
const BESIDE: f64 = 2.0;

/// Ringing fitted after the pulse, in lengths of the pulse.
const RINGS: f64 = 2.0 * BESIDE;

/// Duration of the tail of the low-pass, in its delays: a first-order tail has fallen to e⁻³ then.
pub(super) const TAIL: f64 = 3.0;

/// The record does not rest after the pulse where its residuals there exceed those of the fit by this factor
/// (root mean squares).
const RESTLESS: f64 = 4.0;

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
        Ok(Normalised { trace, found, step, length, height: found.height.abs(), filter })
    }

    fn time(&self, index: usize) -> f64 {
        (index as f64 - self.found.flanks.0) * self.step / self.length
    }

    fn index(&self, time: f64) -> usize {
        let place = self.found.flanks.0 + time * self.length / self.step;
        (place.max(0.0).ceil() as usize).min(self.trace.values.len())
    }

    /// Converts a scaled time to the time of the record, in s.
    fn seconds(&self, time: f64) -> f64 {
        self.trace.axis.start() + self.found.flanks.0 * self.step + time * self.length
    }

    /// The usable samples of a part of the record: finite and not clipped.
    fn samples(&self, range: Range<usize>) -> Samples<'_> {
        let usable = |i: &usize| self.trace.values[*i].is_finite() && !self.found.clipped.contains(i);
        let places: Vec<usize> = range.filter(usable).collect();
        let times = places.iter().map(|i| self.time(*i)).collect();
        let values = places.iter().map(|i| self.trace.values[*i] / self.height).collect();
        let (step, filter) = (self.step / self.length, self.filter.as_ref());
        let quantum = self.found.quantum / self.height;
        let (mode, rings, planned, last) = (None, None, None, RefCell::default());
        Samples { step, filter, places, times, values, mode, quantum, rings, planned, last }
    }

    /// The samples to be fitted: the pulse with a baseline on both sides, or only before it where the record
    /// does not rest after it; and a doubt where it does not come back to the level before the pulse.
    ///
    /// # Errors
    /// If there are too few samples, or no contact of spring and damper fits the pulse, for which `unlike`
    /// makes the error.
    pub fn window(
        &self,
        findings: &mut Vec<Finding>,
        unlike: impl Fn(Error) -> Error,
    ) -> Result<(Samples<'_>, Option<Doubt>)> {
        let delay = self.filter.as_ref().map_or(0.0, LowPass::delay);
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
        let settled = self.index(fitted.end() + TAIL * delay);
        let far = self.index(fitted.end() + TAIL * delay + BESIDE);
        let after = self.samples(settled..far);
        // Mean and root mean square of the residuals after the pulse.
        let model = fitted.at(&after, &after.times).unwrap_or_default();
        let left: Vec<f64> = model.iter().zip(&after.values).map(|(m, v)| v - m).collect();
        let mean = average(&left);
        let rms = average(&left.iter().map(|d| d * d).collect::<Vec<f64>>()).sqrt();
        let inside = (fitted.fit.sum_of_squares() / n as f64).sqrt().max(rounding(first.quantum)).max(1e-6);
        let restless = left.len() >= 4 && rms > RESTLESS * inside;
        let level = !restless || mean.abs() <= LEVEL * rms;
        let changes = (!level).then(|| Finding::doubt("pulse-level-changes"));
        let end = if restless { self.index(fitted.end()).max(self.found.low) } else { far };
        let rings = restless.then(|| Ringing::of(&left, mean, rms));
        Ok((Samples { rings, ..self.samples(from..end) }, changes))
    }

    /// The samples of a pulse that ends at a scaled time, with the ringing that may follow it.
    pub fn ringing(&self, end: f64) -> Samples<'_> {
        let delay = self.filter.as_ref().map_or(0.0, LowPass::delay);
        self.samples(self.index(-BESIDE - delay)..self.index(end + TAIL * delay + RINGS))
    }

    /// Adds findings on clipped samples, on missing ones, and on another pulse in the record.
    fn faults(&self, range: Range<usize>, findings: &mut Vec<Finding>) {
        let Normalised { trace, found, .. } = self;
        if let Some(first) = found.clipped.first() {
            let clipped = Finding::caution("pulse-clipped").count("n", found.clipped.len());
            let level = clipped.number("level", trace.values[*first]);
            findings.push(level.name("unit", trace.meta.unit.symbol()));
        }
        let missing = range.filter(|i| trace.values[*i].is_nan()).count();
        findings.extend((missing > 0).then(|| Finding::caution("pulse-samples-missing").count("n", missing)));
        let other = found.another(&trace.values);
        findings
            .extend(other.map(|i| Finding::caution(code::PULSE_NOT_ALONE).number("time", trace.axis.at(i))));
    }

    /// Factor from the fitted velocity to m/s, where the record is an acceleration, or a force on a known
    /// mass.
    pub(crate) fn to_velocity(&self, mass: Option<f64>) -> Option<f64> {
        let unit = self.height * self.length;
        match self.trace.meta.quantity {
            Quantity::Acceleration => Some(unit),
            Quantity::Force => mass.map(|mass| unit / mass),
            _ => None,
        }
    }

    /// Factor from a scaled value to N, where the record is a force, or an acceleration of a known mass.
    pub(crate) fn to_force(&self, mass: Option<f64>) -> Option<f64> {
        Some(self.height * self.force_of_unit(mass)?)
    }

    /// Force in N for one unit of the record.
    pub(crate) fn force_of_unit(&self, mass: Option<f64>) -> Option<f64> {
        match self.trace.meta.quantity {
            Quantity::Force => Some(1.0),
            Quantity::Acceleration => mass,
            _ => None,
        }
    }

    /// Standard uncertainty of the level under the contact, over the height of the pulse, that drift, hum and
    /// 1/f noise leave beyond white noise: the residuals of stretches beside it scatter by it about zero. The
    /// white part is that of the differences of neighbours.
    fn level_std(&self, fitted: &FittedPulse) -> f64 {
        let (onset, end) = (fitted.fit.parameters[0], fitted.end());
        let delay = self.filter.as_ref().map_or(0.0, LowPass::delay);
        let n = ((end - onset) * self.length / self.step / STRETCHES).ceil().max(2.0);
        // What the fit leaves, without another pulse, which is no drift.
        let left = |range: Range<usize>| {
            let samples = self.samples(range);
            let model = fitted.at(&samples, &samples.times).unwrap_or_default();
            let left = samples.values.iter().zip(model).map(|(value, model)| value - model);
            left.collect::<Vec<f64>>()
        };
        let quiet = |stretch: &&[f64]| stretch.iter().all(|v| v.abs() < 0.5);
        let before = left(self.index(onset - NEAR)..self.index(onset - 2.0 * self.step / self.length));
        // Behind the contact a sensor with a mode rings.
        let rings = fitted.fit.parameters.len() > 3 + fitted.model.parameters();
        let settled = self.index(end + TAIL * delay);
        let after = left(settled..if rings { settled } else { self.index(end + TAIL * delay + NEAR) });
        let (mut count, mut squares, mut steps) = (0.0, 0.0, 0.0);
        let stretches = before.rchunks_exact(n as usize).chain(after.chunks_exact(n as usize));
        for stretch in stretches.filter(quiet) {
            let neighbours = stretch.windows(2).map(|w| (w[1] - w[0]).powi(2)).sum::<f64>();
            (count, squares, steps) = (count + 1.0, squares + average(stretch).powi(2), steps + neighbours);
        }
        let white = steps / (2.0 * count * (n - 1.0).max(1.0)) / n;
        let beyond = (squares / count - white).max(0.0).sqrt();
        if count > 0.0 { beyond * widened(count as usize) } else { 0.0 }
    }

    /// The fit with the covariance that a level under the contact other than the baseline gives it, as by
    /// drift: each parameter changes by `C_ib/C_bb` for a change of the baseline b.
    fn drifting(&self, fitted: &FittedPulse) -> Fit {
        let mut fit = fitted.fit.clone();
        let level = self.level_std(fitted) / fitted.widening.unwrap_or(1.0);
        if level == 0.0 || fit.variance() <= 0.0 {
            return fit;
        }
        let slopes = fit.cofactor.column(1) / fit.cofactor[(1, 1)];
        fit.cofactor += &slopes * slopes.transpose() * (level * level / fit.variance());
        fit
    }

    /// Standard uncertainty of the duration of a power law, in lengths of the pulse, for ends that the
    /// samples do not show. Its exponents are free because no law is known: the law of the fit may not go on
    /// where the force is below the noise. There the ends of the contact lie anywhere. A part at an end is
    /// not shown as long as the pulse without it has a sum of squares larger by one variance or less.
    fn unseen(&self, fitted: &FittedPulse) -> Option<f64> {
        let (model, fit) = (fitted.model, &fitted.fit);
        let contact = model.rebound(&fit.parameters[4..3 + model.parameters()])?;
        let one = fit.variance() * fitted.whiteness.inflation.powi(2) * self.step / self.length;
        // Behind a low-pass a short part is seen as its impulse.
        let passes = self.filter.as_ref().map_or(f64::INFINITY, |filter| 2.0 * filter.autocovariance(0.0));
        let hidden =
            |squares: f64, sum: f64| fit.parameters[2].powi(2) * squares.min(sum * sum * passes) < one;
        let [begin, end] = contact.ends(fit.parameters[3], hidden);
        Some(begin.hypot(end) / f64::sqrt(3.0))
    }

    /// The largest sample above the baseline of a fit, in N; without an uncertainty where the top is clipped.
    pub fn peak_read(&self, fitted: &FittedPulse, noise: f64, mass: Option<f64>) -> Option<Estimate> {
        let factor = self.to_force(mass)?;
        let level = fitted.fit.parameters[1] * self.height;
        let peak = (self.found.height + self.found.baseline - level).abs() / self.height;
        let widened = fitted.widening.filter(|_| self.found.clipped.is_empty()).unwrap_or(f64::NAN);
        let std = factor * (fitted.fit.std(1) * widened).hypot(noise);
        Some(Estimate::new(factor * peak, Some(std), "N", 1, "largest sample above the baseline of the fit"))
    }

    /// A fit in SI units; without uncertainties unless the instrument is `known`.
    pub fn report(&self, fitted: &FittedPulse, mass: Option<f64>, known: bool) -> PulseFit {
        let n = fitted.fit.residuals.len();
        let of = |fit: &FittedPulse| self.parameters(fit, mass, known);
        let mut parameters = of(fitted);
        let losses: Vec<_> = fitted.losses.iter().map(|(weight, fit)| (weight, of(fit))).collect();
        for (name, estimate) in parameters.iter_mut().filter(|_| !losses.is_empty()) {
            let with = |(weight, all): &(&f64, BTreeMap<_, Estimate>)| {
                let given: &Estimate = all.get(name)?;
                Some((**weight, given.value, given.std.unwrap_or(f64::NAN).powi(2)))
            };
            let (mean, variance) = mixture(&losses.iter().filter_map(with).collect::<Vec<_>>());
            *estimate = Estimate::new(mean, Some(variance.sqrt()), estimate.unit, n, estimate.method.clone());
        }
        PulseFit {
            model: fitted.model,
            residual: self.height * (fitted.fit.sum_of_squares() / n as f64).sqrt(),
            aicc: fitted.aicc(),
            whiteness: fitted.whiteness.p_value,
            n,
            behind: 0.0,
            parameters,
        }
    }

    /// The mode of the sensor in a fit.
    pub fn rings(&self, fitted: &FittedPulse) -> Finding {
        let mode = &fitted.fit.parameters[3 + fitted.model.parameters()..];
        let number = |i: usize| mode.get(i).copied().unwrap_or(f64::NAN);
        let found = Finding::note("pulse-sensor-rings").number("share", number(0));
        found.number("frequency", number(1) / self.length).number("zeta", number(2))
    }

    /// The parameters of a fit, in SI units.
    fn parameters(
        &self,
        fitted: &FittedPulse,
        mass: Option<f64>,
        known: bool,
    ) -> BTreeMap<&'static str, Estimate> {
        let n = fitted.fit.residuals.len();
        let widening = fitted.widening.filter(|_| known).unwrap_or(f64::NAN);
        let (model, fit) = (&fitted.model, &self.drifting(fitted));
        let estimate = |value: f64, std: f64, unit| {
            let value = fitted.widening.map_or(f64::NAN, |_| value);
            Estimate::new(value, Some(std), unit, n, "least squares")
        };
        let mut parameters = BTreeMap::new();
        let mut put = |name, i: usize, factor: f64, shift: f64, unit| {
            let std = factor.abs() * fit.std(i) * widening;
            parameters.insert(name, estimate(shift + factor * fit.parameters[i], std, unit));
        };
        put("onset", 0, self.length, self.seconds(0.0), "s");
        let unit = self.trace.meta.quantity.symbol();
        put("baseline", 1, self.height, 0.0, unit);
        if let Some(factor) = self.to_velocity(mass) {
            put("initial_velocity", 2, factor * self.found.height.signum(), 0.0, "m/s");
        }
        let names: &[(&'static str, f64, &'static str)] = match model {
            ContactModel::KelvinVoigt => &[("xi", 1.0, "1"), ("frequency", 1.0 / self.length, "Hz")],
            ContactModel::Hertz => &[("duration", self.length, "s")],
            ContactModel::HuntCrossley => &[("duration", self.length, "s"), ("alpha", 1.0, "1")],
            ContactModel::Yielding => &[("duration", self.length, "s"), ("restitution", 1.0, "1")],
            ContactModel::PowerLaw => &[
                ("duration", self.length, "s"),
                ("alpha", 1.0, "1"),
                ("exponent", 1.0, "1"),
                ("loss_exponent", 1.0, "1"),
            ],
        };
        let sensor = [
            ("sensor_share", 1.0, "1"),
            ("sensor_frequency", 1.0 / self.length, "Hz"),
            ("sensor_damping", 1.0, "1"),
        ];
        for (i, (name, factor, unit)) in (3..fit.parameters.len()).zip(names.iter().chain(&sensor)) {
            put(name, i, *factor, 0.0, unit);
        }
        let shape = &fit.parameters[3..3 + model.parameters()];
        let variance = |i: usize, j: usize| fit.covariance(3 + i, 3 + j) * widening.powi(2);
        let kelvin_voigt = |p: &[f64]| KelvinVoigt::new(p[0], p[1]);
        // All but spring and damper are integrated, with more rounding: differences need larger steps.
        let scale = vec![if *model == ContactModel::KelvinVoigt { 1.0 } else { 1e2 }; shape.len()];
        if let Some(force) = self.to_force(mass).map(|factor| factor * self.found.height.signum()) {
            let of = |p: &[f64], value: &dyn Fn(&KelvinVoigt) -> f64, other: &dyn Fn(&Rebound) -> f64| {
                Some(
                    p[0] * match model {
                        ContactModel::KelvinVoigt => value(&kelvin_voigt(&p[1..])?),
                        _ => other(&model.rebound(&p[2..])?),
                    },
                )
            };
            // From the velocity on.
            let of_all = |i: usize, j: usize| fit.covariance(2 + i, 2 + j) * widening.powi(2);
            let p = &fit.parameters[2..3 + model.parameters()];
            let steps = [&[scale[0]], &scale[..]].concat();
            let mut put = |name, factor: f64, unit, of: &dyn Fn(&[f64]) -> Option<f64>| {
                if let Some((value, std)) = propagated(p, &steps, of_all, of) {
                    parameters.insert(name, estimate(factor * value, factor.abs() * std, unit));
                }
            };
            put("peak", force, "N", &|p| of(p, &|c| c.peak(), &|c| c.peak(p[1])));
            let gained = |restitution: f64| 1.0 + restitution;
            let impulse = |p: &[f64]| of(p, &|c| gained(c.restitution()), &|c| gained(c.restitution));
            put("impulse", force * self.length, "N s", &impulse);
        }
        if *model == ContactModel::PowerLaw
            && let Some(duration) = parameters.get_mut("duration")
        {
            let unseen = self.unseen(fitted);
            duration.std = duration.std.zip(unseen).map(|(std, unseen)| std.max(self.length * unseen));
        }
        let mut follow = |name, factor: f64, unit, of: &dyn Fn(&[f64]) -> Option<f64>| {
            if let Some((value, std)) = propagated(shape, &scale, variance, of) {
                parameters.insert(name, estimate(factor * value, factor * std, unit));
            }
        };
        if *model == ContactModel::KelvinVoigt {
            follow("restitution", 1.0, "1", &|p| kelvin_voigt(p).map(|c| c.restitution()));
            follow("duration", self.length, "s", &|p| kelvin_voigt(p).map(|c| c.duration()));
        } else if *model != ContactModel::Yielding {
            follow("restitution", 1.0, "1", &|p| model.rebound(&p[1..]).map(|c| c.restitution));
        }
        parameters
    }

    /// The samples, curves and residuals for a figure.
    pub fn picture(&self, samples: &Samples<'_>, fits: &[FittedPulse]) -> PulsePicture {
        let from = self.index(-1.5);
        let end = fits.iter().map(FittedPulse::end).fold(1.0, f64::max);
        let to = self.index(end + 1.5);
        let fitted = |i: usize| samples.places.binary_search(&i).is_ok();
        let shown = |i: usize| (self.trace.axis.at(i), self.trace.values[i], fitted(i));
        let (a, b) = (self.time(from), self.time(to));
        let times: Vec<f64> = (0..=600).map(|i| a + (b - a) * f64::from(i) / 600.0).collect();
        let si = |times: &[f64], values: &[f64]| {
            times.iter().zip(values).map(|(t, v)| (self.seconds(*t), v * self.height)).collect()
        };
        let all = self.samples(from..to);
        let curve = |fit: &FittedPulse| {
            let points = si(&times, &fit.at(samples, &times)?);
            let model = fit.at(samples, &all.times)?;
            let left: Vec<f64> = all.values.iter().zip(model).map(|(v, m)| v - m).collect();
            Some(PulseCurve { model: fit.model, points, residuals: si(&all.times, &left) })
        };
        PulsePicture {
            quantity: (self.trace.meta.quantity.name(), self.trace.meta.unit.symbol().to_owned()),
            samples: (from..to).map(shown).collect(),
            curves: fits.iter().filter_map(curve).collect(),
        }
    }
}

//! Finds the pulse of a record, scales the record to the pulse, and converts fits back to SI units.

use super::fit::{FittedPulse, Samples};
use super::result::{PulseCurve, PulseFit, PulsePicture, propagated};
use super::ringing::Ringing;
use super::{ContactModel, KelvinVoigt, LowPass};
use crate::Estimate;
use crate::converter::{rounding, step};
use crate::mean::{average, mixture};
use crate::swings;
use std::cell::RefCell;
use std::collections::BTreeMap;
use std::ops::Range;
use vibro_record::code;
use vibro_record::units::Quantity;
use vibro_record::{Doubt, Error, Finding, Result, Trace, median};

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

/// Baseline fitted before and after the pulse, in lengths of the pulse.
const BESIDE: f64 = 2.0;

/// Ringing fitted after the pulse, in lengths of the pulse.
const RINGS: f64 = 2.0 * BESIDE;

/// Duration of the tail of the low-pass, in its delays: a first-order tail has fallen to e⁻³ then.
const TAIL: f64 = 3.0;

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
        let (mode, rings, last) = (None, None, RefCell::default());
        Samples { step, filter, places, times, values, mode, quantum, rings, last }
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
        let other = (0..trace.values.len())
            .filter(|i| !(-0.5..=2.0).contains(&self.time(*i)))
            .find(|i| (trace.values[*i] - found.baseline) / found.height > 0.5);
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
        let FittedPulse { model, fit, widening, .. } = fitted;
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
        let variance = |i: usize, j: usize| fit.covariance(3 + i, 3 + j) * widened.powi(2);
        let kelvin_voigt = |p: &[f64]| KelvinVoigt::new(p[0], p[1]);
        // All but spring and damper are integrated, and smooth only to 1e-5: differences need larger steps.
        let scale = vec![if *model == ContactModel::KelvinVoigt { 1.0 } else { 1e3 }; shape.len()];
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

/// The largest pulse of a record.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Located {
    /// Value without a pulse.
    pub baseline: f64,
    /// Largest excursion from it, with its sign.
    pub height: f64,
    /// Positions of the flanks at half the height, in samples.
    pub flanks: (f64, f64),
    /// Index of the sample where the falling flank has come down to a fifth of the height.
    pub low: usize,
    /// Indices of the samples of a flat top.
    pub clipped: Vec<usize>,
    /// Step of the converter.
    pub quantum: f64,
}

/// Number of samples by which a flat top must exceed three times the length of a round one.
const FLAT: f64 = 3.0;

/// Samples within this many standard deviations of the noise of the largest count as equal to it.
const BAND: f64 = 8.0;

/// Least height of a pulse above the baseline, in standard deviations of the noise: white noise of 10⁶
/// samples reaches 5.
const LEAST: f64 = 6.0;

/// Finds the largest pulse.
///
/// # Errors
/// If no pulse stands out of the noise, or its onset or end is not in the record.
pub(super) fn locate(values: &[f64]) -> Result<Located> {
    let mut sorted: Vec<f64> = values.iter().copied().filter(|v| v.is_finite()).collect();
    sorted.sort_by(f64::total_cmp);
    let (Some(least), Some(most)) = (sorted.first(), sorted.last()) else {
        return Err(Error::refused("the record holds no value"));
    };
    if least == most {
        return Err(Error::refused(format!("all samples are {least}: there is no pulse"))
            .hint("choose the channel that holds the pulse")
            .setting("channel"));
    }
    let baseline = mode(&sorted);
    // 1.4826: from the median of absolute values to the standard deviation of a normal distribution. √2:
    // from the standard deviation of a difference to that of a value.
    let differences = values.windows(2).map(|w| (w[1] - w[0]).abs());
    let noise = 1.4826 * median(differences).max(0.0) / f64::sqrt(2.0);
    let quantum = step(&sorted);
    let far = |v: &f64| if v.is_finite() { (v - baseline).abs() } else { -1.0 };
    let peak = (0..values.len()).max_by(|a, b| far(&values[*a]).total_cmp(&far(&values[*b]))).unwrap_or(0);
    let height = values[peak] - baseline;
    if height.abs() < LEAST * noise {
        let why = format!(
            "no pulse stands out: the largest excursion is {:.1} times the noise, {LEAST} times are needed",
            height.abs() / noise
        );
        let hint = "choose a record with one clean pulse and its baseline";
        return Err(Error::refused(why).hint(hint));
    }
    let part = |i: usize| (values[i] - baseline) / height;
    let before = (0..peak).rev().find(|i| part(*i) < 0.5);
    let after = (peak + 1..values.len()).find(|i| part(*i) < 0.5);
    let missing = |which: &str, end: &str| {
        Error::refused(format!("the record {which} inside the pulse: its {end} is missing"))
            .hint("record with a pre-trigger, and long enough")
    };
    let Some(before) = before else { return Err(missing("begins", "onset")) };
    let Some(after) = after else { return Err(missing("stops", "end")) };
    let cross = |a: usize, b: usize| a as f64 + (0.5 - part(a)) / (part(b) - part(a)) * (b as f64 - a as f64);
    let low = (after..values.len()).find(|i| part(*i) < 0.2).unwrap_or(after);
    let flanks = (cross(before, before + 1), cross(after - 1, after));
    let depth = BAND * noise.max(rounding(quantum));
    let near = |i: &usize| height.abs() * (1.0 - part(*i)) <= depth;
    let from = (before..=peak).rev().take_while(near).last().unwrap_or(peak);
    let to = (peak..after).take_while(near).last().unwrap_or(peak);
    let run = (to + 1 - from) as f64;
    let is_flat = flat(run, flanks.1 - flanks.0, depth / height.abs());
    let clipped = if is_flat { (from..=to).collect() } else { Vec::new() };
    let located = Located { baseline, height, flanks, low, clipped, quantum };
    match swings::back_and_forth(values, baseline, height, flanks) {
        Some(rings) => Err(rings),
        None => Ok(located),
    }
}

/// Whether `run` samples within `depth` (a part of the height) of the largest are a flat top of a pulse
/// `width` samples wide at half its height.
///
/// The top of a half sine, 1.5 widths long, is within a part x of its height for (3/π) acos(1 − x) widths.
/// No contact stays there for three times that and for more than an eighth of the width.
fn flat(run: f64, width: f64, depth: f64) -> bool {
    let round = 3.0 / std::f64::consts::PI * (1.0 - depth).max(-1.0).acos() * width;
    run > 3.0 * round + FLAT && run > width / 8.0
}

/// Middle of the shortest interval that holds a quarter of the sorted values: the baseline, also of a record
/// that is mostly pulse.
fn mode(sorted: &[f64]) -> f64 {
    let quarter = (sorted.len() / 4).clamp(1, sorted.len().max(2) - 1);
    sorted
        .windows(quarter + 1)
        .min_by(|a, b| (a[quarter] - a[0]).total_cmp(&(b[quarter] - b[0])))
        .map_or(f64::NAN, |w| w[w.len() / 2])
}

#[cfg(test)]
mod located {
    use super::*;

    /// A half sine of height `h` over 40 samples, on a baseline of 2, after 60 samples of baseline and
    /// before 30.
    fn record(h: f64) -> Vec<f64> {
        let half = |i: i32| {
            if (0..=40).contains(&i) { (f64::from(i) * std::f64::consts::PI / 40.0).sin() } else { 0.0 }
        };
        (-60..70).map(|i| 2.0 + h * half(i) + 1e-4 * f64::from(i % 3)).collect()
    }

    #[test]
    fn a_pulse_of_either_sign_over_a_baseline() {
        for h in [5.0, -5.0] {
            let found = locate(&record(h)).unwrap();
            assert!(
                (found.baseline - 2.0).abs() < 1e-3 && (found.height / h - 1.0).abs() < 1e-3,
                "{found:?}"
            );
            // A half sine is above half its height from 1/6 to 5/6 of its length.
            let (rise, fall) = found.flanks;
            assert!(
                (rise - 60.0 - 40.0 / 6.0).abs() < 0.1 && (fall - 60.0 - 200.0 / 6.0).abs() < 0.1,
                "{found:?}"
            );
            assert!(found.clipped.is_empty());
        }
    }

    #[test]
    fn a_flat_top_is_seen() {
        let clipped: Vec<f64> = record(5.0).iter().map(|v| v.min(6.0)).collect();
        let found = locate(&clipped).unwrap();
        // sin > 0.8 from 0.295 to 0.705 of 40 samples.
        assert!((16..=18).contains(&found.clipped.len()), "{found:?}");
    }

    #[test]
    fn a_flat_top_with_noise_is_seen_and_a_round_one_is_not() {
        // A deterministic noise of 0.05 % of the height; the pulse 200 samples long.
        let noise = |i: i32| 2.5e-3 * (f64::from(i * i) * 0.7).sin() * f64::sqrt(2.0);
        let half = |i: i32| {
            if (0..=200).contains(&i) { (f64::from(i) * std::f64::consts::PI / 200.0).sin() } else { 0.0 }
        };
        let record =
            |limit: f64| (-200..400).map(|i| (5.0 * half(i)).min(limit) + noise(i)).collect::<Vec<f64>>();
        assert!(locate(&record(9.0)).unwrap().clipped.is_empty());
        // With this noise 11 samples of a round top count as equal to its peak; a flat top three times as
        // long, by a cut of 4 %, is detected.
        for part in [0.8, 0.9] {
            let n = locate(&record(5.0 * part)).unwrap().clipped.len() as f64;
            // 200/π · 2 acos(part) samples at the limit, and those within eight deviations of noise and their
            // own noise beside them.
            let flat = 400.0 / std::f64::consts::PI * f64::acos(part);
            assert!(n > 0.9 * flat && n < flat + 20.0, "{part}: {n} {flat}");
        }
    }

    #[test]
    fn records_without_a_whole_pulse_are_refused() {
        assert!(locate(&[3.0; 50]).unwrap_err().to_string().contains("all samples are 3"));
        assert!(locate(&[f64::NAN; 5]).is_err() && locate(&[]).is_err());
        assert!(locate(&record(5.0)[80..]).unwrap_err().to_string().contains("onset"));
        assert!(locate(&record(5.0)[..80]).unwrap_err().to_string().contains("end is missing"));
        let noise: Vec<f64> = (0..200).map(|i| f64::from(i * 7919 % 201)).collect();
        assert!(locate(&noise).unwrap_err().to_string().contains("stands out"));
    }
}

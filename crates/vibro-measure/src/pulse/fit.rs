//! Models of a contact fitted to the samples of a pulse.

use super::linear::Linear;
use super::ringing::Ringing;
use super::{ContactModel, KelvinVoigt, LowPass, Rebound};
use crate::converter::{concealed, hidden, rounding};
use crate::mean::{average, scatter};
use crate::residuals::{Whiteness, student};
use std::cell::RefCell;
use vibro_math::{Fit, least_squares};
use vibro_record::{Error, Result, sort_by_number};

/// Samples scaled to the pulse: time from its rising flank over its length, value over its height.
pub(super) struct Samples<'a> {
    /// Sampling interval, in lengths of the pulse.
    pub step: f64,
    /// Low-pass of the instrument, with its corner in cycles per length of the pulse.
    pub filter: Option<&'a LowPass>,
    /// Indices of the samples in the record.
    pub places: Vec<usize>,
    pub times: Vec<f64>,
    pub values: Vec<f64>,
    /// First guess of a mode of the sensor: share of the signal, frequency in cycles per length of the pulse,
    /// and damping ratio. `None` for a sensor without a mode.
    pub mode: Option<[f64; 3]>,
    /// Step of the converter, over the height; 0 where values are not rounded.
    pub quantum: f64,
    /// Ringing after the pulse, which may occur within it, too.
    pub rings: Option<Ringing>,
    /// Variance of the noise over the squared height, of a planned record without noise.
    pub planned: Option<f64>,
    /// The contact integrated last, with its model and shape: most steps of a fit keep it.
    pub last: RefCell<Option<(ContactModel, Vec<f64>, Rebound)>>,
}

/// The best fit of a model. Its parameters are onset, baseline, velocity of approach, and those of the
/// shape: ξ and f (Kelvin–Voigt); duration (Hertz); duration and α (Hunt–Crossley) or restitution
/// (yielding); duration, α and both exponents (power law). Behind them are those of the sensor's mode where
/// it has one.
#[derive(Clone)]
pub(super) struct FittedPulse {
    pub model: ContactModel,
    pub fit: Fit,
    pub whiteness: Whiteness,
    /// Factor on the uncertainties by the fit's covariance. `None` if the record does not begin as the model
    /// does, so that the parameters are meaningless: coloured residuals are larger around the onset than
    /// elsewhere, or the onset lies outside the two samples between which the contact begins.
    pub widening: Option<f64>,
    /// Index of the first sample inside the contact, where the model begins with a jump.
    pub first: Option<usize>,
    /// Fits at further minima of the sum of squares over the exponent of the loss.
    pub also: Vec<FittedPulse>,
    /// Of a power law: its fits with given losses, each with the logarithm of its weight.
    pub losses: Vec<(f64, FittedPulse)>,
}

/// A fit, whether its onset is outside of where it may be, and its sum of squares with the onset inside.
pub(super) type Judged = ((bool, f64), FittedPulse);

/// Fits whose exponents of the loss differ by less than this belong to one minimum.
const APART: f64 = 0.05;

/// Least standard deviation of the noise, over the height of the pulse: about the digits of a converter.
const DIGITS: f64 = 3e-4;

/// A variance counts as larger than another if it exceeds it by this many standard deviations of chance.
const SURE: f64 = 4.0;

/// A contact counts as patterned at the usual level over this: its test comes beside those of other faults.
const TESTS: usize = 10;

/// Step of the coarse grid of onsets, in durations of the contact.
const LEAD: f64 = 0.08;

/// Half-width of the finer grid of onsets around a first guess, in durations of the contact: one and a half
/// steps of the coarse grid.
const REACH: f64 = 1.5 * LEAD;

/// Most samples that the search for a first guess uses; of more, every n-th is taken.
const COARSE: usize = 48;

/// Corner over sampling rate above which a low-pass counts as fast: its rise takes fewer than about four
/// samples.
const FAST: f64 = 0.1;

/// Half-width of the interval around the onset, over the pulse's length, in which a wrong low-pass shows.
const AROUND: f64 = 0.1;

impl Samples<'_> {
    /// Delay of the low-pass, in lengths of the pulse.
    fn delay(&self) -> f64 {
        self.filter.map_or(0.0, LowPass::delay)
    }

    /// The model at these rising times; `first` is the index of the first time inside the contact where that
    /// is fixed.
    pub fn model(
        &self,
        model: ContactModel,
        p: &[f64],
        times: &[f64],
        first: Option<usize>,
    ) -> Option<Vec<f64>> {
        Some(scaled(&self.shape(model, p, times, first)?, p))
    }

    /// The model without baseline and at unit velocity.
    fn shape(&self, model: ContactModel, p: &[f64], times: &[f64], first: Option<usize>) -> Option<Vec<f64>> {
        let since = times.iter().map(|t| t - p[0]);
        let (shape, mode) = p[3..].split_at(model.parameters());
        let rings = match *mode {
            [share, frequency, zeta] => Some(Linear::sensor([share, frequency, zeta], self.filter)?),
            _ => None,
        };
        let instrument = rings.as_ref().or(self.filter.map(|filter| &filter.linear));
        Some(match model {
            ContactModel::KelvinVoigt => {
                let contact = KelvinVoigt::new(p[3], p[4])?;
                let end = contact.duration();
                let inside = |(i, t): (usize, f64)| {
                    let begun = first.map_or(t >= 0.0, |first| i >= first);
                    if begun && t <= end { contact.unbounded(t) } else { 0.0 }
                };
                let Some(instrument) = instrument else {
                    return Some(since.enumerate().map(inside).collect());
                };
                let mut shown = contact.through(instrument, &since.clone().collect::<Vec<_>>());
                if instrument.direct != 0.0 {
                    let bare = since.enumerate().map(inside);
                    shown.iter_mut().zip(bare).for_each(|(shown, bare)| *shown += instrument.direct * bare);
                }
                shown
            }
            _ if p[3] > 0.0 => {
                let mut last = self.last.borrow_mut();
                if !last.as_ref().is_some_and(|(of, known, _)| *of == model && *known == shape[1..]) {
                    *last = Some((model, shape[1..].to_vec(), model.rebound(&shape[1..])?));
                }
                last.as_ref()?.2.decelerations(shape[0], instrument, &since.collect::<Vec<_>>())
            }
            _ => return None,
        })
    }

    /// The best fit of a model, from a coarse search over onset and shape. The prior of each free exponent
    /// counts as one sample.
    pub fn fit(&self, model: ContactModel) -> Result<FittedPulse> {
        let (starts, noise) = (self.starts(model)?, self.noise().0);
        let corner = self.filter.map(|f| f.corner);
        let mut from: Vec<(Vec<f64>, Option<usize>)> = Vec::new();
        if model != ContactModel::KelvinVoigt || corner.is_some() {
            from.extend(
                starts
                    .iter()
                    .take(if model == ContactModel::PowerLaw { 4 } else { 3 })
                    .map(|p| (p.clone(), None)),
            );
        }
        // The force jumps at the onset, so the sum of squares jumps where the onset passes a sample. So the
        // onset is fitted between each two samples near the guess, with the contact continued smoothly
        // beyond them, and the best fit is taken. The rise of a fast low-pass lies, like a jump, between a
        // few samples: each of them then has a minimum of its own.
        if model == ContactModel::KelvinVoigt && corner.is_none_or(|c| c * self.step > FAST) {
            let near = self.nearer(&starts[0]);
            let at = |onset: f64| [&[onset], &near[1..]].concat();
            let last = self.times.len() - 1;
            let middle = self.times.partition_point(|t| *t < near[0]).clamp(1, last);
            from.extend((-3..=3).filter_map(|by: i32| {
                if corner.is_some() {
                    return Some((at(near[0] + f64::from(by) * self.step), None));
                }
                let first = middle.checked_add_signed(by as isize).filter(|k| (1..=last).contains(k))?;
                Some((at(f64::midpoint(self.times[first - 1], self.times[first])), Some(first)))
            }));
        }
        // Noise may move the onset beyond the two samples: the sum of squares is then increased, to first
        // order, to that with the onset fixed at the nearer sample. An onset beyond them by more than noise
        // explains and by more than half a sample, or by more than half of the pulse, follows a rise that
        // the model does not have.
        let held = |fit: &FittedPulse| {
            let (onset, std) = (fit.fit.parameters[0], fit.fit.std(0));
            let beyond =
                fit.first.map_or(0.0, |k| (self.times[k - 1] - onset).max(onset - self.times[k]).max(0.0));
            let outside = beyond > (self.step / 2.0).max(3.0 * std).min(0.5);
            let free = fit.fit.degrees_of_freedom() as f64;
            (outside, fit.fit.sum_of_squares() * (1.0 + (beyond / std).powi(2) / free))
        };
        let fits = from.into_iter().filter_map(|(start, first)| self.from(model, noise, &start, first));
        let mut fits: Vec<Judged> = fits.map(|fit| (held(&fit), fit)).collect();
        fits.sort_by(|(a, _), (b, _)| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)));
        self.between_samples(&mut fits);
        let mut fits = fits.into_iter().map(|((outside, _), fit)| self.judged(fit, outside));
        let Some(mut best) = fits.next() else {
            return Err(Error::refused("the fit does not converge"));
        };
        if model == ContactModel::PowerLaw {
            for fit in fits {
                let known = std::iter::once(&best).chain(&best.also);
                if known.clone().all(|k| (fit.loss_exponent() - k.loss_exponent()).abs() > APART) {
                    best.also.push(fit);
                }
            }
        }
        Ok(best)
    }

    /// Tests the residuals of a fit for whiteness, and sets the factor of its uncertainties, unless its
    /// onset is `outside` of where it may be or does not match the record.
    pub(super) fn judged(&self, mut fitted: FittedPulse, outside: bool) -> FittedPulse {
        fitted.whiteness = Whiteness::of(&[&fitted.fit.residuals]);
        if !(outside || fitted.whiteness.rejected() && self.more_left_at_onset(&fitted.fit)) {
            // At least nine samples leave four degrees of freedom.
            let student = student(fitted.fit.degrees_of_freedom()).unwrap_or(f64::NAN);
            let inside = (fitted.end() - fitted.fit.parameters[0]) / self.step;
            let rings = self.rings.map_or(1.0, |rings| rings.widening(inside, fitted.fit.variance()));
            let widening = Some(fitted.whiteness.inflation * student * rings.sqrt());
            for (_, given) in &mut fitted.losses {
                self.round(&mut given.fit);
                given.widening = widening;
            }
            self.round(&mut fitted.fit);
            fitted.widening = widening;
        }
        fitted
    }

    /// Adds rounding to the covariance of a fit if the noise of the baseline is below a step of the
    /// converter. Such a flat baseline does not show the rounding noise within the pulse, and has itself a
    /// rounding error that all samples share.
    fn round(&self, fit: &mut Fit) {
        let (hidden, variance) = (self.noise().1, fit.variance());
        if hidden == 0.0 || variance <= 0.0 {
            return;
        }
        // Parameters change by C_ib/C_bb for a change of the baseline b.
        let slopes = fit.cofactor.column(1) / fit.cofactor[(1, 1)];
        let baseline = &slopes * slopes.transpose() * (hidden * hidden / variance);
        fit.cofactor *= self.rounded(fit);
        fit.cofactor += baseline;
    }

    /// Variance of the noise within the contact over that of the residuals. It is 1 unless rounding conceals
    /// the noise of the baseline.
    fn rounded(&self, fit: &Fit) -> f64 {
        let ((noise, hidden), variance) = (self.noise(), fit.variance());
        if hidden == 0.0 || variance <= 0.0 { 1.0 } else { (noise * noise / variance).max(1.0) }
    }

    /// Factor by which differences of sums of squares, over the variance of the residuals, exceed those for
    /// white noise: for correlated residuals, and for rounding that a flat baseline does not show.
    pub fn dispersion(&self, fit: &Fit) -> f64 {
        Whiteness::of(&[&fit.residuals]).inflation.powi(2) * self.rounded(fit)
    }

    /// Standard deviation of the noise well before the pulse, over the pulse's height, at least [`DIGITS`];
    /// and the error that rounding adds to the mean baseline.
    pub(super) fn noise(&self) -> (f64, f64) {
        let begins = -0.5 - self.delay();
        let before = &self.values[..self.times.partition_point(|t| *t < begins)];
        let scatter = if before.len() < 8 { 0.0 } else { scatter(before) };
        let hidden = hidden(scatter, self.quantum);
        (scatter.hypot(hidden).max(DIGITS), hidden)
    }

    /// Whether the residuals within the contact exceed those before it by more than chance, or have a pattern
    /// that those outside of it have not: then the contact follows another law, or something else moved.
    pub fn unexplained(&self, fitted: &FittedPulse) -> bool {
        let fit = &fitted.fit;
        let onset = fit.parameters[0];
        // A sensor's mode has to explain what follows the contact, too.
        let end = self.mode.map_or(fitted.end() + self.delay(), |_| f64::INFINITY);
        let of = |part: &dyn Fn(f64) -> bool| {
            let squares =
                self.times.iter().zip(&fit.residuals).filter(|(t, _)| part(**t)).map(|(_, r)| r * r);
            (squares.clone().sum::<f64>(), squares.count() as f64)
        };
        let (inside, before) = (of(&|t| t >= onset && t <= end), of(&|t| t < onset - AROUND));
        // The parameters absorb noise within the contact: they take its degrees of freedom.
        let free = inside.1 - fit.parameters.len() as f64;
        // Coloured noise scatters more. Its colour shows before the contact; within, a misfit has its own.
        // Fewer than a test needs leave the colour of all residuals.
        let quiet = Whiteness::of(&[&fit.residuals[..before.1 as usize]]);
        let colour = quiet.p_value.map_or(fitted.whiteness.inflation, |_| quiet.inflation);
        let chance = SURE * colour * (2.0 / free.max(1.0) + 2.0 / before.1).sqrt();
        let shown = before.0 / before.1;
        let noise = shown + self.noise().1.powi(2) + concealed(shown.sqrt(), before.1, self.quantum).powi(2);
        let more = free >= 1.0 && before.1 >= 8.0 && inside.0 / free > (1.0 + chance) * noise;
        more || self.patterned(fitted)
    }

    /// Whether neighbouring residuals within the contact are alike, so that their density at low frequency is
    /// more than twice that of white noise, and those outside are white.
    fn patterned(&self, fitted: &FittedPulse) -> bool {
        let residuals = &fitted.fit.residuals;
        let place = |time: f64| self.times.partition_point(|t| *t < time);
        let onset = place(fitted.fit.parameters[0]);
        let end = place(fitted.end() + self.delay()).max(onset);
        let outside = Whiteness::of(&[&residuals[..onset], &residuals[end..]]);
        let white = outside.p_value.is_some() && !outside.rejected();
        let inside = Whiteness::of(&[&residuals[onset..end]]);
        white && inside.alike_among(TESTS) && inside.inflation.powi(2) > 2.0
    }

    /// Whether the residuals around the onset have more than twice the variance of the others, and more than
    /// chance gives: the variance of n samples of noise scatters by √(2/n).
    fn more_left_at_onset(&self, fit: &Fit) -> bool {
        let onset = fit.parameters[0];
        let around = onset - AROUND..=onset + AROUND + self.delay();
        let (mut near, mut far) = ((0.0, 0.0), (0.0, 0.0));
        for (t, r) in self.times.iter().zip(&fit.residuals) {
            let part = if around.contains(t) { &mut near } else { &mut far };
            *part = (part.0 + r * r, part.1 + 1.0);
        }
        let limit = (1.0 + SURE * (2.0_f64 / near.1).sqrt()).max(2.0);
        near.0 / near.1 > limit * (far.0 / far.1).max(rounding(self.quantum).powi(2))
    }

    /// The fit from one first guess; `None` where it does not converge.
    pub(super) fn from(
        &self,
        model: ContactModel,
        noise: f64,
        start: &[f64],
        first: Option<usize>,
    ) -> Option<FittedPulse> {
        let n = self.times.len();
        let rows = n + model.unlikely(start, noise).len();
        let residuals = self.residuals(model, noise, first);
        let scale: Vec<f64> = start.iter().map(|p| p.abs().max(0.1)).collect();
        let mut fit = least_squares(residuals, rows, start, &scale).ok()?;
        fit.residuals.truncate(n);
        let whiteness = Whiteness { p_value: None, inflation: 1.0 };
        fit.converged.then_some(FittedPulse {
            model,
            fit,
            whiteness,
            widening: None,
            first,
            also: Vec::new(),
            losses: Vec::new(),
        })
    }

    /// Residuals of the samples from a model, and behind them the distances of its exponents from their
    /// prior means.
    pub(super) fn residuals(
        &self,
        model: ContactModel,
        noise: f64,
        first: Option<usize>,
    ) -> impl Fn(&[f64], &mut [f64]) {
        let n = self.times.len();
        // Baseline and velocity only scale a shape: that of the last other parameters is kept for them.
        let last: RefCell<(Vec<f64>, Option<Vec<f64>>)> = RefCell::default();
        move |p, out| {
            let mut last = last.borrow_mut();
            let of = [&p[..1], &p[3..]].concat();
            if last.0 != of {
                *last = (of, self.shape(model, p, &self.times, first));
            }
            let Some(shape) = &last.1 else { return out.fill(f64::NAN) };
            out.iter_mut().zip(&self.values).zip(scaled(shape, p)).for_each(|((r, v), m)| *r = v - m);
            out[n..].iter_mut().zip(model.unlikely(p, noise)).for_each(|(r, unlikely)| *r = unlikely);
        }
    }

    /// A better guess of a contact of spring and damper, from a finer grid around a first one, on all
    /// samples.
    fn nearer(&self, guess: &[f64]) -> Vec<f64> {
        let Some(duration) = KelvinVoigt::new(guess[3], guess[4]).map(|c| c.duration()) else {
            return guess.to_vec();
        };
        let (reach, steps) = (REACH * duration, (REACH * duration / self.step).ceil().clamp(1.0, 10.0));
        let mut least = (f64::INFINITY, guess.to_vec());
        for onset in -(steps as i32)..=steps as i32 {
            for longer in -2..=2 {
                for shape in -2..=2 {
                    let xi = (guess[3] + 0.05 * f64::from(shape)).clamp(0.0, 0.9);
                    let duration = duration * (1.0 + 0.05 * f64::from(longer));
                    let Some(contact) = KelvinVoigt::lasting(duration, xi) else { continue };
                    let onset = guess[0] + reach * f64::from(onset) / steps;
                    let mut p = vec![onset, 0.0, 1.0, xi, contact.frequency()];
                    p.extend(self.mode.into_iter().flatten());
                    let levelled = self.levelled(ContactModel::KelvinVoigt, p, (&self.times, &self.values));
                    if let Some(better) = levelled.filter(|l| l.0 < least.0) {
                        least = better;
                    }
                }
            }
        }
        least.1
    }

    /// First guesses, the best first, one for each shape: durations and onsets on a grid, baseline and
    /// velocity by linear least squares.
    fn starts(&self, model: ContactModel) -> Result<Vec<Vec<f64>>> {
        let stride = self.times.len().div_ceil(if self.mode.is_some() { 2 * COARSE } else { COARSE }).max(1);
        let thin = |all: &[f64]| all.iter().copied().step_by(stride).collect::<Vec<f64>>();
        let (times, values) = (thin(&self.times), thin(&self.values));
        let delay = self.delay();
        // With free exponents there is a minimum on either side of the loss exponent at which the loss makes
        // the end of the pulse neither steeper nor flatter.
        let shapes: &[[f64; 2]] = match model {
            ContactModel::KelvinVoigt => &[[0.03, 0.0], [0.15, 0.0], [0.3, 0.0], [0.5, 0.0], [0.75, 0.0]],
            ContactModel::Hertz => &[[0.0; 2]],
            ContactModel::HuntCrossley => &[[0.1, 1.5], [0.6, 1.5], [2.0, 1.5]],
            ContactModel::PowerLaw => &[[0.1, 0.4], [0.4, 0.4], [0.1, 1.5], [0.6, 1.5], [2.0, 1.5]],
            ContactModel::Yielding => &[[0.4, 0.0], [0.7, 0.0], [0.95, 0.0]],
        };
        let guess = |[shape, loss]: [f64; 2], duration: f64, lead: i32| {
            let mut p = vec![-delay - LEAD * f64::from(lead) * duration, 0.0, 1.0];
            match model {
                ContactModel::KelvinVoigt => {
                    p.extend([shape, KelvinVoigt::lasting(duration, shape)?.frequency()]);
                }
                ContactModel::Hertz => p.push(duration),
                ContactModel::HuntCrossley | ContactModel::Yielding => p.extend([duration, shape]),
                ContactModel::PowerLaw => p.extend([duration, shape, 1.5, loss]),
            }
            p.extend(self.mode.into_iter().flatten());
            self.levelled(model, p, (&times, &values))
        };
        let nearest = |shape: &[f64; 2]| {
            let durations = [0.35, 0.6, 0.8, 1.0, 1.25, 1.6];
            let all = durations.into_iter().flat_map(|duration| (0..8).map(move |lead| (duration, lead)));
            let all = all.filter_map(|(duration, lead)| guess(*shape, duration, lead));
            all.min_by(|a, b| a.0.total_cmp(&b.0))
        };
        let mut found: Vec<(f64, Vec<f64>)> = shapes.iter().filter_map(nearest).collect();
        sort_by_number(&mut found, |a| a.0);
        if found.is_empty() {
            return Err(Error::refused("no first guess of a fit resembles the pulse"));
        }
        Ok(found.into_iter().map(|f| f.1).collect())
    }

    /// The sum of squares, and the parameters with the baseline and velocity that are best for these
    /// samples.
    fn levelled(
        &self,
        model: ContactModel,
        mut p: Vec<f64>,
        (times, y): (&[f64], &[f64]),
    ) -> Option<(f64, Vec<f64>)> {
        let x = self.model(model, &p, times, None)?;
        let (mx, my) = (average(&x), average(y));
        let sxx: f64 = x.iter().map(|x| (x - mx).powi(2)).sum();
        let sxy: f64 = x.iter().zip(y).map(|(x, y)| (x - mx) * (y - my)).sum();
        let slope = sxy / sxx;
        (p[1], p[2]) = (my - slope * mx, slope);
        let sum: f64 = x.iter().zip(y).map(|(x, y)| (y - p[1] - slope * x).powi(2)).sum();
        sum.is_finite().then_some((sum, p))
    }
}

/// A shape with the baseline and velocity of these parameters.
fn scaled(shape: &[f64], p: &[f64]) -> Vec<f64> {
    shape.iter().map(|s| p[1] + p[2] * s).collect()
}

impl FittedPulse {
    /// Loss of a power law.
    pub fn loss(&self) -> f64 {
        self.fit.parameters[4]
    }

    fn loss_exponent(&self) -> f64 {
        self.fit.parameters.get(6).copied().unwrap_or(f64::NAN)
    }

    /// The fitted model at any rising times.
    pub fn at(&self, samples: &Samples<'_>, times: &[f64]) -> Option<Vec<f64>> {
        let first = self.first.and_then(|f| samples.times.get(f)).map(|first| {
            let onset = self.fit.parameters[0].min(*first);
            times.partition_point(|t| *t < onset)
        });
        samples.model(self.model, &self.fit.parameters, times, first)
    }

    /// Time at which the contact ends, in lengths of the pulse.
    pub fn end(&self) -> f64 {
        let p = &self.fit.parameters;
        p[0] + match self.model {
            ContactModel::KelvinVoigt => KelvinVoigt::new(p[3], p[4]).map_or(f64::NAN, |c| c.duration()),
            _ => p[3],
        }
    }
}

//! Models of a contact fitted to the samples of a pulse.

use super::{ContactModel, HuntCrossley, KelvinVoigt, LowPass};
use crate::residuals::{Whiteness, student};
use std::f64::consts::PI;
use vibro_math::{Fit, least_squares};
use vibro_record::{Error, Result};

/// Samples in units of about the pulse: time from its rising flank over its length, value over its height.
pub(super) struct Samples {
    pub times: Vec<f64>,
    pub values: Vec<f64>,
    /// Distance of two samples.
    pub step: f64,
    /// The instrument's low-pass in the same unit of time.
    pub filter: Option<LowPass>,
    /// Standard deviation of what a converter rounds, and of the baseline by it.
    rounding: (f64, f64),
    hertz: HuntCrossley,
}

/// A model at its best, its parameters onset, baseline, velocity of approach, and those of its shape: ξ and f, duration, or
/// duration and α.
pub(super) struct Fitted {
    pub model: ContactModel,
    pub fit: Fit,
    /// First sample inside the contact, where the model begins with a jump.
    first: Option<usize>,
}

/// Samples that the search for a first guess uses.
const COARSE: usize = 48;

/// Corner of a low-pass over the sampling rate from which on its rise takes fewer than about four samples.
const FAST: f64 = 0.1;

/// Lengths of the pulse before its rising flank up to which a record rests.
const BEFORE: f64 = -0.4;

/// Place of the baseline among the parameters.
const BASELINE: usize = 1;

/// Part of the pulse's length around the onset in which a wrong low-pass shows.
const AROUND: f64 = 0.1;

impl Samples {
    /// Samples of a converter of this step, which may be 0.
    pub fn new(
        times: Vec<f64>,
        values: Vec<f64>,
        step: f64,
        filter: Option<LowPass>,
        code: f64,
    ) -> Result<Samples> {
        let hertz = HuntCrossley::new(0.0).ok_or_else(|| Error::refused("no shape of a Hertzian contact"))?;
        let rounded = code / 12f64.sqrt();
        let rest: Vec<f64> =
            times.iter().zip(&values).filter(|(t, _)| **t < BEFORE).map(|(_, v)| *v).collect();
        let mean = rest.iter().sum::<f64>() / rest.len().max(1) as f64;
        let squares = rest.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / rest.len().max(1) as f64;
        // Noise spreads a level over codes, whose mean is then the level but for exp(−2π²σ²/q²) of what is rounded
        // (P. Carbone and D. Petri, IEEE Trans. Instrum. Meas. 43 (1994) 389).
        let noise = (squares - rounded * rounded).max(0.0) / (code * code);
        let level = if code > 0.0 { rounded * (-2.0 * PI * PI * noise).exp() } else { 0.0 };
        Ok(Samples { times, values, step, filter, rounding: (rounded, level), hertz })
    }

    /// Covariance of two parameters of a fit. Noise is not less than what the converter rounds: a baseline that is one code has none,
    /// and may be off by as much, which moves the others as far as they depend on it.
    pub fn covariance(&self, fitted: &Fitted, i: usize, j: usize) -> f64 {
        let (fit, (rounded, level)) = (&fitted.fit, self.rounding);
        let noise = if rounded > 0.0 { (rounded * rounded / fit.variance()).max(1.0) } else { 1.0 };
        let along = |i: usize| fit.covariance(i, BASELINE) / fit.covariance(BASELINE, BASELINE);
        let moved = if level > 0.0 { level * level * along(i) * along(j) } else { 0.0 };
        noise * fit.covariance(i, j) + moved
    }

    /// Standard deviation of a parameter, as [`Samples::covariance`].
    pub fn std(&self, fitted: &Fitted, i: usize) -> f64 {
        self.covariance(fitted, i, i).sqrt()
    }

    /// The model at these rising times; `first` is the first time inside the contact where that is settled.
    pub fn model(
        &self,
        model: ContactModel,
        p: &[f64],
        times: &[f64],
        first: Option<usize>,
    ) -> Option<Vec<f64>> {
        let filter = self.filter.as_ref();
        let since = times.iter().map(|t| t - p[0]);
        let shape: Vec<f64> = match model {
            ContactModel::KelvinVoigt => {
                let contact = KelvinVoigt::new(p[3], p[4])?;
                let end = contact.duration();
                match filter {
                    Some(filter) => since.map(|t| contact.filtered(filter, t)).collect(),
                    None => since
                        .enumerate()
                        .map(|(i, t)| {
                            let begun = first.map_or(t >= 0.0, |first| i >= first);
                            if begun && t <= end { contact.unbounded(t) } else { 0.0 }
                        })
                        .collect(),
                }
            }
            ContactModel::Hertz if p[3] > 0.0 => {
                self.hertz.decelerations(p[3], filter, &since.collect::<Vec<_>>())
            }
            ContactModel::HuntCrossley if p[3] > 0.0 => {
                HuntCrossley::new(p[4])?.decelerations(p[3], filter, &since.collect::<Vec<_>>())
            }
            _ => return None,
        };
        Some(shape.into_iter().map(|s| p[1] + p[2] * s).collect())
    }

    /// The best fit of a model, from a coarse search over onset and shape.
    pub fn fit(&self, model: ContactModel) -> Result<Fitted> {
        let starts = self.starts(model)?;
        if model != ContactModel::KelvinVoigt || self.filter.is_some() {
            let guesses = starts.iter().take(3).cloned().chain(self.stepped(model, &starts));
            return best(guesses.map(|p| self.from(model, &p, None)));
        }
        // The jump of the force at the onset makes the sum of squares jump where the onset passes a sample. So the onset is
        // fitted between each two samples near the guess, the contact going on smoothly beyond them, and the best is taken.
        let cell = |onset: f64| self.times.partition_point(|t| *t < onset).clamp(1, self.times.len() - 1);
        let start = self.nearer(&starts[0]);
        let within = |first: usize| {
            let mut start = start.clone();
            start[0] = f64::midpoint(self.times[first - 1], self.times[first]);
            self.from(model, &start, Some(first))
        };
        let middle = cell(start[0]);
        let (mut inside, mut outside) = (Vec::new(), Vec::new());
        for first in middle.saturating_sub(3).max(1)..=(middle + 3).min(self.times.len() - 1) {
            let fitted = within(first);
            // Noise may take the onset a little beyond the two samples.
            let slack = self.step / 2.0;
            let border = self.times[first - 1] - slack..=self.times[first] + slack;
            if fitted.as_ref().is_ok_and(|f| border.contains(&f.fit.parameters[0])) {
                inside.push(fitted);
            } else {
                outside.push(fitted);
            }
        }
        // A jump that is lost in the noise does not tell where it is: then any of them will do.
        best(inside.into_iter()).or_else(|_| best(outside.into_iter()))
    }

    /// More guesses for a contact through a low-pass so fast that its rise, like a jump, falls between a few samples: each of
    /// them then holds a minimum of its own.
    fn stepped(&self, model: ContactModel, starts: &[Vec<f64>]) -> Vec<Vec<f64>> {
        let fast = self.filter.as_ref().is_some_and(|f| f.corner() * self.step > FAST);
        if model != ContactModel::KelvinVoigt || !fast {
            return Vec::new();
        }
        let near = self.nearer(&starts[0]);
        let moved = |by: i32| {
            let mut p = near.clone();
            p[0] += f64::from(by) * self.step;
            p
        };
        (-3..=3).map(moved).collect()
    }

    /// Factor for the uncertainties by the fit's covariance. `None` where more is left around the onset than elsewhere, and is not
    /// white noise: the pulse begins otherwise than the model can, and the parameters may be anything.
    pub(crate) fn widening(&self, fitted: &Fitted, whiteness: &Whiteness) -> Option<f64> {
        let onset = fitted.fit.parameters[0];
        let delay = self.filter.as_ref().map_or(0.0, LowPass::delay);
        let around = onset - AROUND..=onset + AROUND + delay;
        if whiteness.rejected() && self.more_left(fitted, |t| around.contains(&t)) {
            return None;
        }
        // At least nine samples leave four degrees of freedom.
        Some(whiteness.inflation * student(fitted.fit.degrees_of_freedom()).unwrap_or(f64::NAN))
    }

    /// Whether the residuals at some times have more than twice the variance of the others, and more than chance gives: the
    /// variance of n samples of noise scatters by √(2/n).
    fn more_left(&self, fitted: &Fitted, there: impl Fn(f64) -> bool) -> bool {
        let (mut near, mut far) = ((0.0, 0.0), (0.0, 0.0));
        for (t, r) in self.times.iter().zip(&fitted.fit.residuals) {
            let part = if there(*t) { &mut near } else { &mut far };
            *part = (part.0 + r * r, part.1 + 1.0);
        }
        let limit = (1.0 + 4.0 * (2.0_f64 / near.1).sqrt()).max(2.0);
        near.0 / near.1 > limit * (far.0 / far.1).max(self.rounding.0.powi(2))
    }

    fn from(&self, model: ContactModel, start: &[f64], first: Option<usize>) -> Result<Fitted> {
        let scale: Vec<f64> = start.iter().map(|p| p.abs().max(0.1)).collect();
        let residuals = |p: &[f64], out: &mut [f64]| match self.model(model, p, &self.times, first) {
            Some(values) => {
                out.iter_mut().zip(&self.values).zip(values).for_each(|((r, v), m)| *r = v - m);
            }
            None => out.fill(f64::NAN),
        };
        let fit = least_squares(residuals, self.times.len(), start, &scale)?;
        if !fit.converged {
            return Err(Error::refused(format!("the fit of the model {} does not converge", model.name())));
        }
        Ok(Fitted { model, fit, first })
    }

    /// A contact of spring and damper nearer to the pulse, from a finer grid around a guess, on all samples.
    fn nearer(&self, guess: &[f64]) -> Vec<f64> {
        let Some(duration) = KelvinVoigt::new(guess[3], guess[4]).map(|c| c.duration()) else {
            return guess.to_vec();
        };
        let (reach, steps) = (0.12 * duration, (0.12 * duration / self.step).ceil().clamp(1.0, 10.0));
        let mut least = (f64::INFINITY, guess.to_vec());
        for onset in -(steps as i32)..=steps as i32 {
            for longer in -2..=2 {
                for shape in -2..=2 {
                    let xi = (guess[3] + 0.05 * f64::from(shape)).clamp(0.0, 0.9);
                    let duration = duration * (1.0 + 0.05 * f64::from(longer));
                    let Some(contact) = KelvinVoigt::lasting(duration, xi) else { continue };
                    let onset = guess[0] + reach * f64::from(onset) / steps;
                    let mut p = vec![onset, 0.0, 1.0, xi, contact.frequency()];
                    let curve = self.model(ContactModel::KelvinVoigt, &p, &self.times, None);
                    let Some((base, velocity, sum)) = curve.and_then(|c| line(&c, &self.values)) else {
                        continue;
                    };
                    if sum < least.0 {
                        (p[1], p[2]) = (base, velocity);
                        least = (sum, p);
                    }
                }
            }
        }
        least.1
    }

    /// First guesses, the best first, one for each shape: durations and onsets on a grid, baseline and velocity by linear least
    /// squares.
    fn starts(&self, model: ContactModel) -> Result<Vec<Vec<f64>>> {
        let stride = self.times.len().div_ceil(COARSE).max(1);
        let thin = |all: &[f64]| all.iter().copied().step_by(stride).collect::<Vec<f64>>();
        let (times, values) = (thin(&self.times), thin(&self.values));
        let delay = self.filter.as_ref().map_or(0.0, LowPass::delay);
        let shapes: &[f64] = match model {
            ContactModel::KelvinVoigt => &[0.03, 0.15, 0.3, 0.5, 0.75],
            ContactModel::Hertz => &[0.0],
            ContactModel::HuntCrossley => &[0.1, 0.6, 2.0],
        };
        let mut found: Vec<(f64, Vec<f64>)> = Vec::new();
        for shape in shapes {
            let mut nearest: Option<(f64, Vec<f64>)> = None;
            for duration in [0.35, 0.6, 0.8, 1.0, 1.25, 1.6] {
                for lead in 0..8 {
                    let onset = -delay - 0.08 * f64::from(lead) * duration;
                    let mut p = vec![onset, 0.0, 1.0];
                    match model {
                        ContactModel::KelvinVoigt => match KelvinVoigt::lasting(duration, *shape) {
                            Some(contact) => p.extend([*shape, contact.frequency()]),
                            None => continue,
                        },
                        ContactModel::Hertz => p.push(duration),
                        ContactModel::HuntCrossley => p.extend([duration, *shape]),
                    }
                    let Some(curve) = self.model(model, &p, &times, None) else { continue };
                    let Some((base, velocity, sum)) = line(&curve, &values) else { continue };
                    (p[1], p[2]) = (base, velocity);
                    if nearest.as_ref().is_none_or(|n| sum < n.0) {
                        nearest = Some((sum, p));
                    }
                }
            }
            found.extend(nearest);
        }
        found.sort_by(|a, b| a.0.total_cmp(&b.0));
        if found.is_empty() {
            return Err(Error::refused("no first guess of a fit resembles the pulse"));
        }
        Ok(found.into_iter().map(|f| f.1).collect())
    }
}

impl Fitted {
    /// The fitted model at any rising times.
    pub fn at(&self, samples: &Samples, times: &[f64]) -> Option<Vec<f64>> {
        let first = self.first.and_then(|f| samples.times.get(f)).map(|first| {
            let onset = self.fit.parameters[0].min(*first);
            times.partition_point(|t| *t < onset)
        });
        samples.model(self.model, &self.fit.parameters, times, first)
    }

    /// When the contact ends.
    pub fn end(&self) -> f64 {
        let p = &self.fit.parameters;
        p[0] + match self.model {
            ContactModel::KelvinVoigt => KelvinVoigt::new(p[3], p[4]).map_or(f64::NAN, |c| c.duration()),
            _ => p[3],
        }
    }
}

/// The fit with the smallest sum of squares; where there is none, why the first failed.
fn best(fits: impl Iterator<Item = Result<Fitted>>) -> Result<Fitted> {
    let mut failed = None;
    let mut least: Option<Fitted> = None;
    for fit in fits {
        match fit {
            Ok(fit) if least.as_ref().is_none_or(|l| fit.fit.sum_of_squares() < l.fit.sum_of_squares()) => {
                least = Some(fit);
            }
            Ok(_) => {}
            Err(error) => failed = failed.or(Some(error)),
        }
    }
    least.ok_or_else(|| failed.unwrap_or_else(|| Error::refused("no fit resembles the pulse")))
}

/// Intercept, slope and sum of squares of y over x by least squares.
fn line(x: &[f64], y: &[f64]) -> Option<(f64, f64, f64)> {
    let n = x.len() as f64;
    let (mx, my) = (x.iter().sum::<f64>() / n, y.iter().sum::<f64>() / n);
    let sxx: f64 = x.iter().map(|x| (x - mx).powi(2)).sum();
    let sxy: f64 = x.iter().zip(y).map(|(x, y)| (x - mx) * (y - my)).sum();
    let slope = sxy / sxx;
    let base = my - slope * mx;
    let sum: f64 = x.iter().zip(y).map(|(x, y)| (y - base - slope * x).powi(2)).sum();
    sum.is_finite().then_some((base, slope, sum))
}

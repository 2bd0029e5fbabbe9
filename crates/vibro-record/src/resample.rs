//! Interpolates unevenly sampled traces on an even grid.

use crate::clock::{Stretch, stretches};
use crate::{Axis, AxisKind, Error, Finding, Grid, Result, Trace, median};

/// Lowest rate of interpolation, divided by the mean sampling rate. Below it parts of the signal would alias.
const LOWEST_RATE: f64 = 0.95;
/// Highest rate of interpolation, divided by the mean sampling rate. More values would only suggest a
/// resolution that the samples do not have.
const HIGHEST_RATE: f64 = 10.0;
/// Longest interval between samples that is interpolated, divided by the median interval. The stated error is
/// that of intervals of twice the median, found by leaving out one sample: far beyond, it is unknown.
const LONGEST_INTERVAL: f64 = 2.5;
/// Largest RMS error of samples predicted from their neighbours, divided by the standard deviation of the
/// samples. White noise gives 1.4, a sine 0.67 with four samples per period and 0.32 with five.
const LARGEST_ERROR: f64 = 0.5;

impl Trace {
    /// Interpolates at `rate` in Hz from the first instant on, by cubics through four samples. A finding
    /// states the error: the RMS difference between each sample and its prediction from four neighbours.
    ///
    /// # Errors
    /// - If instants do not rise, a gap is too long to interpolate, or values are missing.
    /// - If the rate is below 0.95 times or above ten times the mean sampling rate.
    /// - If the samples are too far apart for their signal.
    pub fn resample(&mut self, rate: f64) -> Result<()> {
        let (t, v) = (self.axis.values(), &self.values);
        let n = t.len();
        if self.axis.kind != AxisKind::Time || n < 5 || v.iter().any(|v| !v.is_finite()) {
            return Err(Error::refused(
                "only five samples over time and more, without missing values, can be resampled",
            ));
        }
        let steps: Vec<f64> = t.windows(2).map(|w| w[1] - w[0]).collect();
        let typical = Some(median(&steps)).filter(|_| steps.iter().all(|step| *step > 0.0));
        let typical =
            typical.ok_or_else(|| Error::refused("instants that do not rise cannot be resampled"))?;
        if let Some(i) = steps.iter().position(|step| *step > LONGEST_INTERVAL * typical) {
            let found =
                format!("a gap of {:.4} s behind {:.6} s is too long to be interpolated", steps[i], t[i]);
            return Err(evened(Error::refused(found), &t, self.meta.resolution));
        }
        let mean = (n - 1) as f64 / (t[n - 1] - t[0]);
        if !(LOWEST_RATE * mean..=HIGHEST_RATE * mean).contains(&rate) {
            let found = format!("a rate of {rate} Hz to resample {mean:.5} samples a second");
            let expected = format!("{:.5} to {:.5} Hz", LOWEST_RATE * mean, HIGHEST_RATE * mean);
            return Err(Error::usage(found, expected).set("resample", proposed(mean)));
        }
        let at = |four: [usize; 4], x: f64| cubic(four.map(|i| (t[i], v[i])), x);
        let own = (2..n - 2).map(|i| at([i - 2, i - 1, i + 1, i + 2], t[i]) - v[i]);
        let error = (own.map(|e| e * e).sum::<f64>() / (n - 4) as f64).sqrt();
        let level = v.iter().sum::<f64>() / n as f64;
        let spread = (v.iter().map(|v| (v - level).powi(2)).sum::<f64>() / n as f64).sqrt();
        if error > LARGEST_ERROR * spread {
            let share = 100.0 * error / spread;
            return Err(Error::refused(format!(
                "the samples are too far apart to interpolate: each differs by {share:.3} % from what its neighbours predict"
            ))
            .hint("record at a higher rate, or with even steps"));
        }
        let many = ((t[n - 1] - t[0]) * rate * (1.0 + f64::EPSILON)).floor() as usize + 1;
        let mut behind = 1;
        let values = (0..many).map(|i| {
            let x = t[0] + i as f64 / rate;
            while behind < n - 1 && t[behind] < x {
                behind += 1;
            }
            let first = behind.saturating_sub(2).min(n - 4);
            at([first, first + 1, first + 2, first + 3], x)
        });
        let values = values.collect();
        let found = Finding::caution("resampled").number("rate", rate).number("error", error);
        let found = found
            .name("unit", self.meta.unit.symbol())
            .number("share", if error == 0.0 { 0.0 } else { error / spread });
        self.axis = Axis::time(t[0], 1.0 / rate, many);
        self.meta.clock = 0.0;
        // The error of a cubic grows with the fourth power of the interval. The effective interval is the
        // fourth root of the mean of that power over time.
        let fourth = steps.iter().map(|step| step.powi(5)).sum::<f64>() / steps.iter().sum::<f64>();
        self.meta.interpolated = fourth.powf(0.25);
        self.values = values;
        self.meta.found(found);
        self.meta.step("resample", &[("rate", &rate), ("method", &"cubics through four samples")]);
        Ok(())
    }

    /// Keeps only the samples of one stretch between lost samples, by its number from 1, on the even grid of
    /// that stretch.
    ///
    /// # Errors
    /// If there is no such stretch.
    pub fn keep_stretch(&mut self, number: usize) -> Result<()> {
        let all = match &self.axis.grid {
            Grid::Uneven(t) if self.axis.kind == AxisKind::Time => stretches(t, self.meta.resolution),
            // An even record is a single stretch.
            _ if number == 1 => return Ok(()),
            _ => Vec::new(),
        };
        let Some(Stretch { samples, clock }) = number.checked_sub(1).and_then(|i| all.get(i)) else {
            let found = match all.len() {
                0 => format!("stretch {number} of samples without a gap, or without an even stretch"),
                n => format!("stretch {number} of {n}"),
            };
            let error = Error::usage(found, "the number of an even stretch, from 1");
            return Err(if all.is_empty() {
                error.hint("leave it out").setting("stretch")
            } else {
                error.set("stretch", "1")
            });
        };
        let (rate, std) = clock.rate();
        let found = Finding::caution("stretch-used").count("stretch", number).count("of", all.len());
        let found = found.count("n", samples.len()).number("start", clock.start).number("rate", rate);
        self.meta.found(found.number("std", std));
        self.meta.clock = clock.relative();
        self.meta.step("stretch", &[("first", &samples.start), ("n", &samples.len())]);
        self.axis = Axis::time(clock.start, clock.step, samples.len());
        self.values = self.values[samples.clone()].to_vec();
        Ok(())
    }
}

/// Adds a hint to an error about uneven `instants` in s: use one of their even stretches, or interpolate.
/// `resolution` in s is half a unit in the last digit of the instants.
pub fn evened(error: Error, instants: &[f64], resolution: f64) -> Error {
    let all = stretches(instants, resolution);
    if let Some((number, longest)) = Stretch::longest(&all) {
        let (n, duration) = (all.len(), longest.duration());
        let hint = if n == 1 {
            format!("use the part without a gap, {duration:.4} s")
        } else {
            format!("use one of {n} stretches without a gap; number {number} is the longest, {duration:.4} s")
        };
        return error.hint(hint).set("stretch", number.to_string());
    }
    if instants.windows(2).any(|w| w[1] < w[0]) {
        return error.hint("sort the rows, or cut the file where it begins anew");
    }
    if instants.windows(2).any(|w| w[1] == w[0]) {
        return error.hint("several samples have one time: state the samples per second").setting("rate");
    }
    let steps: Vec<f64> = instants.windows(2).map(|w| w[1] - w[0]).collect();
    if steps.iter().any(|step| *step > LONGEST_INTERVAL * median(&steps)) {
        return error
            .hint("its gaps are too long to interpolate: record or export every sample, with even steps");
    }
    let mean = instants.len().saturating_sub(1) as f64 / (instants[instants.len() - 1] - instants[0]);
    error.hint("interpolate on an even grid").set("resample", proposed(mean))
}

/// A mean rate in Hz, rounded up to three digits, as text.
fn proposed(mean: f64) -> String {
    let unit = 10f64.powf(mean.log10().floor() - 2.0);
    let text = format!("{:.3e}", (mean / unit * (1.0 - 1e-9)).ceil() * unit);
    text.parse::<f64>().map_or(text, |rate| rate.to_string())
}

/// Value at `x` of the cubic through four points.
fn cubic(points: [(f64, f64); 4], x: f64) -> f64 {
    let weight = |i: usize| {
        let others = (0..4).filter(|j| *j != i).map(|j| (x - points[j].0) / (points[i].0 - points[j].0));
        others.product::<f64>()
    };
    (0..4).map(|i| weight(i) * points[i].1).sum()
}

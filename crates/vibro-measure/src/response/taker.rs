//! Single points of a response curve.

use super::steady::SteadyLine;
use super::{Harmonic, Receptance, ResponseOptions, ResponsePoint};
use crate::Estimate;
use crate::excitation::{Excitation, bent};
use crate::line::{SubLine, amplitude_at, interpolate, nearest};
use crate::noise::{self, upper_limit};
use num_complex::Complex64;
use std::f64::consts::TAU;
use vibro_record::units::Quantity;
use vibro_record::{Sweep, SweepPoint, Values, Window};

/// Least height of a response peak, over the noise of one component of a line. A fainter one is read at the
/// excitation frequency, where noise cannot choose the line, and gets an upper limit.
const PEAK_ABOVE: f64 = 5.0;
/// Largest distance of a response peak from the excitation, in lines.
const NEAR: f64 = 1.0;

/// Reads the points of a response curve from spectra.
pub(super) struct Taker<'a> {
    pub sweep: &'a Sweep,
    pub options: &'a ResponseOptions,
    /// Number of integrations.
    pub times: i8,
    pub df: f64,
    pub fmin: f64,
    pub unit: &'static str,
    /// Lines that the excitation passes on its way.
    pub steady: Vec<SteadyLine>,
}

impl Taker<'_> {
    pub fn frequency(&self, position: f64) -> f64 {
        self.sweep.axis.start() + position * self.df
    }

    pub fn position(&self, frequency: f64) -> f64 {
        (frequency - self.sweep.axis.start()) / self.df
    }

    /// Amplitude and upper limit of the wanted quantity, from those of the measured signal at `frequency` in
    /// Hz.
    fn estimate(
        &self,
        frequency: f64,
        (value, std, limit): (f64, Option<f64>, Option<f64>),
        method: impl Into<String>,
    ) -> (Estimate, Option<f64>) {
        // (2πf)ⁿ from the measured signal to the wanted quantity.
        let times = i32::from(self.sweep.analyser_integrated) + i32::from(self.times);
        let divisor = (TAU * frequency).powi(times);
        let std = std.map(|s| s / divisor);
        (Estimate::new(value / divisor, std, self.unit, 3, method), limit.map(|l| l / divisor))
    }

    /// Magnitudes of the signal that was measured: the analyser's division by (2πf)ⁿ is undone.
    pub fn measured(&self, point: &SweepPoint) -> Vec<f64> {
        let undo = i32::from(self.sweep.analyser_integrated);
        let undone = |(k, m): (usize, f64)| m * (TAU * self.frequency(k as f64)).powi(undo);
        point.response.values.magnitudes().into_iter().enumerate().map(undone).collect()
    }

    /// Standard deviation of one component that steady lines add at `position`.
    pub fn beside(&self, position: f64, window: Option<Window>) -> f64 {
        self.steady.iter().fold(0.0, |sum, line| sum.hypot(line.at(position, window)))
    }

    /// Standard deviation of one component of the lines at `position`: of the noise around line `k`, and of
    /// steady lines.
    fn floor(&self, measured: &[f64], position: f64, k: usize, window: Option<Window>) -> Option<f64> {
        let noise = noise::sloping(measured, k, noise::REACH, window)?;
        Some(noise.hypot(self.beside(position, window)))
    }

    /// Reads one step from the magnitudes of its measured signal.
    pub fn point(&self, point: &SweepPoint, excitation: &Excitation, measured: &[f64]) -> ResponsePoint {
        let at = self.position(excitation.frequency);
        let centre = at.round().max(0.0) as usize;
        let window = point.response.window;
        let low = centre.saturating_sub(self.options.band).max(1);
        let high = centre.saturating_add(self.options.band).min(measured.len().saturating_sub(2));
        let top = (low..=high)
            .filter(|&k| measured[k] >= measured[k - 1] && measured[k] >= measured[k + 1])
            .max_by(|a, b| measured[*a].total_cmp(&measured[*b]));
        let floor = self.floor(measured, at, top.unwrap_or(centre), window);
        // A hump of noise is not the response. Neither is another line near the excitation, which hides the
        // response.
        let clear = |p: &SubLine| floor.is_none_or(|f| p.amplitude >= PEAK_ABOVE * f);
        let peak = top.and_then(|k| {
            let line = interpolate(measured, k, window, floor).filter(clear)?;
            Some(bent(line, measured, k, window.zip(floor)))
        });
        let hidden = peak.is_some_and(|p| (p.position - at).abs() > NEAR);
        let (frequency, frequency_std, amplitude, method) = if excitation.frequency < self.fmin {
            (excitation.frequency, None, (f64::NAN, None, None), "below the cut-off".to_owned())
        } else if let Some(peak) = peak.filter(|_| !hidden) {
            let method = match window {
                Some(w) => format!("peak of three lines, {} window", w.name()),
                None => "parabola through log magnitudes, window unknown".to_owned(),
            };
            let std = peak.position_std.map(|s| s * self.df);
            (self.frequency(peak.position), std, (peak.amplitude, peak.amplitude_std, None), method)
        } else {
            let method = "line nearest to the excitation, no peak of its own, noise not taken out".to_owned();
            let floor = floor.filter(|_| !hidden);
            (excitation.frequency, excitation.std, faint(measured, at, window, floor), method)
        };
        let (amplitude, upper_limit) = self.estimate(frequency, amplitude, method);
        let (phase, receptance) = self.transfer(point, excitation.frequency).unzip();
        let harmonic =
            |order: String, ratio: f64| self.harmonic(measured, order, excitation.frequency * ratio, window);
        let largest = self.largest(&point.response.values.magnitudes());
        ResponsePoint {
            excitation: excitation.frequency,
            excitation_std: excitation.std,
            force: excitation.force,
            force_std: excitation.force_std,
            frequency,
            frequency_std,
            amplitude,
            upper_limit,
            harmonics: (2..=5).map(|n| harmonic(n.to_string(), f64::from(n))).collect(),
            phase,
            receptance: receptance.filter(|_| self.unit == Quantity::Displacement.symbol()),
            subharmonics: (2..=4).map(|n| harmonic(format!("1/{n}"), 1.0 / f64::from(n))).collect(),
            largest_elsewhere: largest.abs_diff(centre) > self.options.band,
            largest_at: self.frequency(largest as f64),
        }
    }

    /// Phase of the response against the force, and their ratio, by the line nearest to the excitation of
    /// complex spectra. Both lines have the same window, which cancels in the ratio.
    fn transfer(&self, point: &SweepPoint, excitation: f64) -> Option<(Estimate, Receptance)> {
        let (Values::Complex(response), Values::Complex(force)) = (&point.response.values, &point.force)
        else {
            return None;
        };
        let k = self.position(excitation).round().max(0.0) as usize;
        let (x, f) = (*response.get(k)?, *force.get(k)?);
        let window = point.response.window;
        let noise = |values: &Values| noise::sloping(&values.magnitudes(), k, noise::REACH, window);
        // The analyser's division at the frequency of the line is replaced by one at the frequency of the
        // sine.
        let undone =
            Complex64::new(0.0, TAU * self.frequency(k as f64)).powi(self.sweep.analyser_integrated.into());
        // Steady lines are those of the measured signal, before that division.
        let steady = self.beside(self.position(excitation), window) / undone.norm();
        let (of_x, of_f) = (noise(&point.response.values)?.hypot(steady), noise(&point.force)?);
        let relative = (of_x / x.norm()).hypot(of_f / f.norm());
        let times = i32::from(self.sweep.analyser_integrated) + i32::from(self.times);
        let ratio = x / f * undone / Complex64::new(0.0, TAU * excitation).powi(times);
        let std = Some(relative * ratio.norm()).filter(|std| std.is_finite());
        let phase =
            Estimate::new(ratio.arg(), std.map(|_| relative), "rad", 1, "line nearest to the excitation");
        Some((phase, Receptance { re: ratio.re, im: ratio.im, std }))
    }

    fn harmonic(&self, measured: &[f64], order: String, frequency: f64, window: Option<Window>) -> Harmonic {
        let at = self.position(frequency);
        let inside = frequency >= self.fmin && at >= 1.0 && at.round() < measured.len() as f64 - 1.0;
        let floor = self.floor(measured, at, at.round().max(0.0) as usize, window);
        let found = inside.then(|| amplitude_at(measured, at, window, floor)).flatten();
        let (found, method) = match (found, floor) {
            (Some((value, _)), Some(floor)) if value < PEAK_ABOVE * floor => {
                (faint(measured, at, window, Some(floor)), "nearest line, noise not taken out")
            }
            (Some((value, std)), _) => ((value, std, None), "three lines at a known frequency"),
            (None, _) => ((f64::NAN, None, None), "outside the lines or below the cut-off"),
        };
        let (amplitude, upper_limit) = self.estimate(frequency, found, method);
        Harmonic { order, frequency, amplitude, upper_limit }
    }

    /// Index of the largest line of the wanted quantity at or above the cut-off.
    fn largest(&self, stored: &[f64]) -> usize {
        let first = self.position(self.fmin).ceil().max(1.0) as usize;
        let wanted = |k: usize| stored[k] / (TAU * self.frequency(k as f64)).powi(i32::from(self.times));
        (first..stored.len()).max_by(|a, b| wanted(*a).total_cmp(&wanted(*b))).unwrap_or(first)
    }
}

/// Amplitude near the noise, its uncertainty and its upper limit, from one line, since the distribution of
/// its magnitude is known.
fn faint(
    measured: &[f64],
    position: f64,
    window: Option<Window>,
    floor: Option<f64>,
) -> (f64, Option<f64>, Option<f64>) {
    let (line, gain) = nearest(measured, position, window).unwrap_or((f64::NAN, 1.0));
    let std = window.and(floor);
    let limit = std.and_then(|f| upper_limit(line, f));
    (line / gain, std.map(|s| s / gain), limit.map(|l| l / gain))
}

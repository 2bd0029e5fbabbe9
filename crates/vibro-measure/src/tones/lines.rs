//! Spectral lines of a record, among which the first guesses of its sines are found.

use super::super::line::interpolate;
use super::super::residuals::student;
use super::super::stands_out::{self, floor};
use super::{FAR, MOST_BESIDE};
use std::f64::consts::PI;
use vibro_record::units::notation::quantity;
use vibro_record::{Error, Result, Scaling, Trace, Window, sort_by_number};
use vibro_signal::spectrum;

/// Largest error of a stated frequency, in spectral lines.
const NEAR: f64 = 2.0;

/// Fewest and most lines on either side that give the noise at a sine; between these, half of its line
/// number. Over that range 1/f² noise still changes threefold after the correction for 1/f.
const AROUND: [usize; 2] = [15, 40];

/// Amplitude spectrum of a record with a Hann window, the mean removed.
pub(super) struct HannLines {
    magnitudes: Vec<f64>,
    powers: Vec<f64>,
    /// Distance of two lines in Hz.
    pub spacing: f64,
}

impl HannLines {
    pub fn of(trace: &Trace) -> Result<HannLines> {
        let lines = spectrum::plain(trace, Window::Hann, Scaling::Peak, true)?;
        let magnitudes = lines.values.magnitudes();
        let powers = magnitudes.iter().map(|m| m * m).collect();
        Ok(HannLines { magnitudes, powers, spacing: lines.axis.step().unwrap_or(0.0) })
    }

    /// Amplitude of the line nearest to `frequency` in Hz.
    pub fn height(&self, frequency: f64) -> f64 {
        self.magnitudes.get((frequency / self.spacing).round() as usize).copied().unwrap_or(0.0)
    }

    /// Ratio, as amplitudes, of the noise around `frequency` (Hz) to white noise of standard deviation
    /// `sigma`. At least 1 unless the sine is `alone`: other sines act from beyond the lines compared here.
    pub fn colour(&self, frequency: f64, sigma: f64, alone: bool) -> f64 {
        let centre = (frequency / self.spacing).round() as usize;
        let reach = (centre / 2).clamp(AROUND[0], AROUND[1]);
        let Some(floor) = floor(&self.powers, centre, reach, 1.0, Some(Window::Hann)) else { return 1.0 };
        // Squared peak amplitude of a line of white noise: 4σ²·ENBW/N for N samples, which give N/2 lines.
        let white = 2.0 * sigma * sigma * Window::Hann.enbw() / (self.magnitudes.len() - 1) as f64;
        let factor = student(2 * floor.lines).unwrap_or(1.0) * (floor.power / white).sqrt();
        if alone { factor } else { factor.max(1.0) }
    }

    /// Noise around line `k`.
    fn noise(&self, k: usize) -> Option<stands_out::Floor> {
        floor(&self.powers, k, stands_out::REACH, 1.0, Some(Window::Hann))
    }

    /// Whether line `k`, one of `n` that were looked at, stands out of the noise.
    fn is_visible(&self, k: usize, n: usize) -> bool {
        self.noise(k).is_none_or(|noise| noise.is_below(self.powers[k], 1.0, n))
    }

    /// Place of the sine of line `k`, in lines.
    fn position(&self, k: usize) -> f64 {
        interpolate(&self.magnitudes, k, Some(Window::Hann), None).map_or(k as f64, |line| line.position)
    }

    /// Frequency in Hz of the sine that acts most on the sines at `frequencies`, if any acts on one by more
    /// than `least`. A sine of height h at d lines from another shifts its amplitude by up to h/(πd), the
    /// side lobe of a record that is cut off (sinc); frequency and phase are shifted alike. A nearer one may
    /// be the skirt of a sine that wanders: see [`Tone::widened`].
    pub fn acting(&self, frequencies: &[f64], least: f64) -> Option<f64> {
        let shift = |k: &usize| {
            let away = |f: &f64| (*k as f64 - f / self.spacing).abs();
            let nearest = frequencies.iter().map(away).fold(f64::INFINITY, f64::min);
            if nearest < FAR { 0.0 } else { self.magnitudes[*k] / (PI * nearest) }
        };
        let n = self.magnitudes.len().saturating_sub(1);
        let is_peak = |k: &usize| self.magnitudes[*k] >= self.magnitudes[k - 1].max(self.magnitudes[k + 1]);
        let mut peaks: Vec<usize> = (2..n).filter(|k| shift(k) > least && is_peak(k)).collect();
        sort_by_number(&mut peaks, |k| -shift(k));
        let strongest = peaks.into_iter().take(MOST_BESIDE).find(|k| self.is_visible(*k, n))?;
        Some(self.spacing * self.position(strongest))
    }

    /// Frequency in Hz of the strongest line above the noise, or of the strongest within two lines of `near`
    /// Hz, interpolated between lines.
    pub fn strongest(&self, near: Option<f64>) -> Result<f64> {
        let HannLines { magnitudes, spacing, .. } = self;
        let within = |k: &usize| near.is_none_or(|f| (*k as f64 - f / spacing).abs() <= NEAR);
        let mut lines: Vec<usize> = (1..magnitudes.len().saturating_sub(1)).filter(within).collect();
        sort_by_number(&mut lines, |a| -magnitudes[*a]);
        let first = *lines.first().ok_or_else(|| Error::refused("no line of the spectrum lies there"))?;
        let noise = |k: usize| self.noise(k);
        let Some(largest) = lines.iter().copied().find(|k| self.is_visible(*k, lines.len())) else {
            let why = format!(
                "no sine stands out of the noise: the largest line, {:.6} Hz, has {}, the noise of a line is {}",
                first as f64 * spacing,
                quantity(magnitudes[first], "1", 3),
                quantity(noise(first).map_or(0.0, |n| n.power.sqrt()), "1", 3)
            );
            return Err(Error::refused(why).hint("take a longer record, or state the frequency"));
        };
        let position = self.position(largest);
        if position < 1.5 {
            let why = format!("the record holds {position:.2} periods: a mean and a sine cannot be parted");
            return Err(Error::refused(why).hint("take a longer record"));
        }
        Ok(spacing * position)
    }
}

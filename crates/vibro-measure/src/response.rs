//! Response at the excitation, step by step (the job of the thesis' sinesw3).

mod findings;

use super::excitation::{Excitation, excitations};
use super::jump::{Jump, jumps};
use super::limit::upper_limit;
use super::line::{amplitude_at, interpolate, nearest};
use super::resonance::{Resonance, resonances};
use super::{Estimate, noise};
use findings::{direction, hidden_by_lines, repeated, wrong_window};
use serde::Serialize;
use std::f64::consts::PI;
use vibro_record::units::Quantity;
use vibro_record::{Direction, Error, Finding, Result, Step, Sweep, SweepPoint, Window};
use vibro_signal::window::line_shape;

/// How a response is to be taken.
#[derive(Debug, Clone, PartialEq)]
pub struct ResponseOptions {
    /// Lines on both sides of the excitation in which its peak is looked for. Default 3.
    pub band: usize,
    /// Integrations in frequency from the stored quantity: 1 takes velocity to displacement. Default 0.
    pub integrate: i8,
    /// Lowest frequency in Hz that is read. Default: the larger of two lines and a quarter of the lowest
    /// excitation frequency.
    pub fmin: Option<f64>,
}

impl Default for ResponseOptions {
    fn default() -> Self {
        ResponseOptions { band: 3, integrate: 0, fmin: None }
    }
}

/// Integrations that take a quantity to displacement; 0 for what has none.
pub fn to_displacement(stored: Quantity) -> i8 {
    match stored {
        Quantity::Velocity => 1,
        Quantity::Acceleration => 2,
        _ => 0,
    }
}

/// A line at a whole multiple or a fraction of the excitation frequency.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Harmonic {
    /// `2`, `3`, … or `1/2`, `1/3`, …
    pub order: String,
    /// Frequency in Hz.
    pub frequency: f64,
    /// Amplitude; no value where the frequency lies outside the lines or below the cut-off. In the noise the nearest line as it is.
    pub amplitude: Estimate,
    /// 95 % upper limit of the true amplitude, where it does not stand out of the noise or leakage (Read 2002).
    pub upper_limit: Option<f64>,
}

/// One step of the response curve.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ResponsePoint {
    /// Excitation frequency in Hz.
    pub excitation: f64,
    /// Its standard uncertainty in Hz.
    pub excitation_std: Option<f64>,
    /// Force amplitude in N, where there is a force spectrum.
    pub force: Option<f64>,
    /// Its standard uncertainty in N.
    pub force_std: Option<f64>,
    /// Frequency of the response peak in Hz.
    pub frequency: f64,
    /// Its standard uncertainty in Hz.
    pub frequency_std: Option<f64>,
    /// Peak amplitude at the excitation. Where the response does not stand out of the noise, the line nearest to the excitation
    /// as it is: noise lifts it, so a faint amplitude is more likely too large than too small.
    pub amplitude: Estimate,
    /// 95 % upper limit of the true amplitude, where it does not stand out of the noise or leakage (Read 2002).
    pub upper_limit: Option<f64>,
    /// Orders 2 to 5.
    pub harmonics: Vec<Harmonic>,
    /// Orders 1/2, 1/3, 1/4.
    pub subharmonics: Vec<Harmonic>,
    /// Whether the largest line of the spectrum is not at the excitation.
    pub largest_elsewhere: bool,
    /// Frequency of the largest line in Hz.
    pub largest_at: f64,
}

/// A response curve.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Response {
    /// Name of the sweep.
    pub name: String,
    /// Direction of the sweep, stated or found from the excitation frequencies.
    pub direction: Option<Direction>,
    /// Mass, where stated.
    pub mass: Option<u8>,
    /// Quantity of the amplitudes.
    pub quantity: &'static str,
    /// Unit of the amplitudes.
    pub unit: &'static str,
    /// Cut-off in Hz: lines below were left out.
    pub fmin: f64,
    /// Steps, in the order in which they were taken.
    pub points: Vec<ResponsePoint>,
    /// Maxima and minima of the curve.
    pub resonances: Vec<Resonance>,
    /// Sudden changes.
    pub jumps: Vec<Jump>,
    /// What limits the curve.
    pub findings: Vec<Finding>,
    /// Every step from file to curve.
    pub history: Vec<Step>,
}

/// The cut-off below which a spectrum that was divided by frequency is noise: the larger of two lines and a quarter of
/// the lowest excitation frequency.
pub(crate) fn default_cutoff(line_width: f64, excitations: &[Excitation]) -> f64 {
    let lowest = excitations.iter().map(|e| e.frequency).fold(f64::INFINITY, f64::min);
    (2.0 * line_width).max(if lowest.is_finite() { lowest / 4.0 } else { 0.0 })
}

/// Takes the response curve of a sweep.
///
/// Lines are interpolated in the spectrum of the measured signal: where the analyser divided by (2πf)ⁿ that is undone line by
/// line, and the amplitude is divided by (2πf)ⁿ at the frequency found. So the slope of 1/fⁿ across a line's own
/// shape does not bend the result.
///
/// # Errors
/// If an excitation frequency cannot be found, or the lines are not evenly spaced.
pub fn response(sweep: &Sweep, options: &ResponseOptions) -> Result<Response> {
    let df =
        sweep.line_width().ok_or_else(|| Error::refused("the lines of the sweep are not evenly spaced"))?;
    let excitations = excitations(sweep, options.fmin.unwrap_or(0.0))?;
    let fmin = options.fmin.unwrap_or_else(|| default_cutoff(df, &excitations));
    let mut findings = sweep.findings.clone();
    let quantity = sweep.unit().times_seconds(options.integrate).quantity();
    if quantity == Quantity::Other {
        return Err(Error::refused(format!(
            "values in {}, integrated {} times, are no displacement, velocity or acceleration",
            sweep.unit(),
            options.integrate
        ))
        .hint("integrate once from velocity to displacement, twice from acceleration")
        .setting("integrate"));
    }
    let unit = quantity.symbol();
    let wrong = wrong_window(sweep, &excitations, df);
    findings.extend(repeated(sweep));
    let taker = Taker { sweep, options, df, fmin, unit };
    let (mut points, hiders): (Vec<ResponsePoint>, Vec<Option<f64>>) =
        sweep.points.iter().zip(&excitations).map(|(p, e)| taker.point(p, e)).unzip();

    let frequency: Vec<f64> = excitations.iter().map(|e| e.frequency).collect();
    let direction = direction(&frequency, sweep.direction, &mut findings);
    let amplitude: Vec<f64> = points.iter().map(|p| p.amplitude.value).collect();
    let std: Vec<f64> = points.iter().map(|p| p.amplitude.std.unwrap_or(f64::NAN)).collect();
    let faint = points.iter().zip(&hiders).filter(|(p, h)| p.upper_limit.is_some() && h.is_none()).count();
    if faint > 0 {
        findings.push(Finding::caution("sweep-below-noise").count("n", faint));
    }
    findings.extend(hidden_by_lines(&frequency, &hiders));
    let below = amplitude.iter().filter(|a| a.is_nan()).count();
    if below > 0 {
        findings.push(Finding::caution("sweep-below-cutoff").count("n", below).number("fmin", fmin));
    }
    let (mut jumps, mut resonances) = match direction {
        Some(direction) if points.len() >= 3 => {
            let jumps = jumps(&frequency, &amplitude, &std, direction);
            let mut order: Vec<usize> = (0..points.len()).collect();
            order.sort_by(|a, b| frequency[*a].total_cmp(&frequency[*b]));
            let sorted = |v: &[f64]| -> Vec<f64> { order.iter().map(|i| v[*i]).collect() };
            let [rising, height, std] = [&frequency, &amplitude, &std].map(|v| sorted(v));
            let resonances = resonances(&rising, &height, &std, &jumps, sweep.mass);
            (jumps, resonances)
        }
        _ => {
            findings.push(Finding::caution("sweep-too-few-points").count("n", points.len()));
            (Vec::new(), Vec::new())
        }
    };
    if let Some(wrong) = wrong {
        findings.insert(0, wrong);
        for point in &mut points {
            (point.frequency_std, point.amplitude.std) = (None, None);
        }
        for jump in &mut jumps {
            (jump.amplitude_before_std, jump.amplitude_after_std) = (None, None);
        }
        for resonance in &mut resonances {
            (resonance.frequency_std, resonance.amplitude_std) = (None, None);
        }
    }
    let mut history = sweep.history().to_vec();
    history.push(Step::new(
        "response",
        &[
            ("band", &options.band),
            ("integrate", &options.integrate),
            ("analyser_integrated", &sweep.analyser_integrated),
            ("fmin", &fmin),
        ],
    ));
    Ok(Response {
        name: sweep.name.clone(),
        direction,
        mass: sweep.mass,
        quantity: quantity.name(),
        unit,
        fmin,
        points,
        resonances,
        jumps,
        findings,
        history,
    })
}

/// A response peak must stand this factor above the noise of a line; a fainter one is read at the excitation frequency, where
/// noise cannot choose the line, and gets an upper limit.
const PEAK_ABOVE: f64 = 5.0;
/// A response peak lies within this many lines of the excitation.
const NEAR: f64 = 1.0;

/// Takes single points.
struct Taker<'a> {
    sweep: &'a Sweep,
    options: &'a ResponseOptions,
    df: f64,
    fmin: f64,
    unit: &'static str,
}

impl Taker<'_> {
    fn frequency(&self, position: f64) -> f64 {
        self.sweep.axis.start() + position * self.df
    }

    fn position(&self, frequency: f64) -> f64 {
        (frequency - self.sweep.axis.start()) / self.df
    }

    /// (2πf)ⁿ from the measured signal to the wanted quantity.
    fn divisor(&self, frequency: f64) -> f64 {
        (2.0 * PI * frequency)
            .powi(i32::from(self.sweep.analyser_integrated) + i32::from(self.options.integrate))
    }

    /// The point, and the frequency of another line where that hides its response.
    fn point(&self, point: &SweepPoint, excitation: &Excitation) -> (ResponsePoint, Option<f64>) {
        let stored = point.response.values.magnitudes();
        let undo = i32::from(self.sweep.analyser_integrated);
        let measured: Vec<f64> = stored
            .iter()
            .enumerate()
            .map(|(k, m)| m * (2.0 * PI * self.frequency(k as f64)).powi(undo))
            .collect();
        let at = self.position(excitation.frequency);
        let centre = at.round().max(0.0) as usize;
        let window = point.response.window;
        let low = centre.saturating_sub(self.options.band).max(1);
        let high = centre.saturating_add(self.options.band).min(measured.len().saturating_sub(2));
        let top = (low..=high)
            .filter(|&k| measured[k] >= measured[k - 1] && measured[k] >= measured[k + 1])
            .max_by(|a, b| measured[*a].total_cmp(&measured[*b]));
        let floor = noise::around(&measured, top.unwrap_or(centre), window);
        let other = window.zip(floor).and_then(|(w, f)| intruder(&measured, at, w, f));
        let leakage = other.map_or(0.0, |o| o.1);
        let peak = top
            .and_then(|k| interpolate(&measured, k, window, floor))
            // A hump of noise or leakage, or another line beside the excitation, is not the response.
            .filter(|p| {
                floor.is_none_or(|f| p.amplitude >= PEAK_ABOVE * f.hypot(leakage))
                    && (p.position - at).abs() <= NEAR
            });
        let (mut limit, mut hider) = (None, None);
        let (frequency, frequency_std, amplitude, method) = if excitation.frequency < self.fmin {
            (excitation.frequency, None, (f64::NAN, None), "below the cut-off".to_owned())
        } else if let Some(peak) = peak {
            let method = match window {
                Some(w) => format!("peak of three lines, {} window", w.name()),
                None => "parabola through log magnitudes, window unknown".to_owned(),
            };
            let frequency = self.frequency(peak.position);
            // Leakage tilts the three lines and lifts them by its part of their height, about.
            let std = peak.position_std.map(|s| s.hypot(leakage / peak.amplitude) * self.df);
            let amplitude_std = peak.amplitude_std.map(|s| s.hypot(leakage));
            (frequency, std, (peak.amplitude, amplitude_std), method)
        } else {
            let (line, std, upper_limit) = faint(&measured, at, window, floor, leakage);
            limit = upper_limit;
            hider = other.filter(|_| limit.is_some()).map(|o| self.frequency(o.0));
            let method = "line nearest to the excitation, no peak of its own, noise not taken out".to_owned();
            (excitation.frequency, excitation.std, (line, std), method)
        };
        let divisor = self.divisor(frequency);
        let amplitude =
            Estimate::new(amplitude.0 / divisor, amplitude.1.map(|s| s / divisor), self.unit, 3, method);
        let harmonic = |numerator: u32, denominator: u32| {
            let order = if denominator == 1 { numerator.to_string() } else { format!("1/{denominator}") };
            let f = excitation.frequency * f64::from(numerator) / f64::from(denominator);
            self.harmonic(&measured, order, f, window)
        };
        let largest = self.largest(&stored);
        let point = ResponsePoint {
            excitation: excitation.frequency,
            excitation_std: excitation.std,
            force: excitation.force,
            force_std: excitation.force_std,
            frequency,
            frequency_std,
            amplitude,
            upper_limit: limit.map(|l| l / divisor),
            harmonics: (2..=5).map(|n| harmonic(n, 1)).collect(),
            subharmonics: (2..=4).map(|n| harmonic(1, n)).collect(),
            largest_elsewhere: largest.abs_diff(centre) > self.options.band,
            largest_at: self.frequency(largest as f64),
        };
        (point, hider)
    }

    fn harmonic(&self, measured: &[f64], order: String, frequency: f64, window: Option<Window>) -> Harmonic {
        let at = self.position(frequency);
        let inside = frequency >= self.fmin && at >= 1.0 && at.round() < measured.len() as f64 - 1.0;
        let floor = noise::around(measured, at.round().max(0.0) as usize, window);
        let found = inside.then(|| amplitude_at(measured, at, window, floor)).flatten();
        let ((value, std, limit), method) = match (found, floor) {
            (Some((value, _)), Some(floor)) if value < PEAK_ABOVE * floor => {
                (faint(measured, at, window, Some(floor), 0.0), "nearest line, noise not taken out")
            }
            (Some((value, std)), _) => ((value, std, None), "three lines at a known frequency"),
            (None, _) => ((f64::NAN, None, None), "outside the lines or below the cut-off"),
        };
        let divisor = self.divisor(frequency);
        let amplitude = Estimate::new(value / divisor, std.map(|s| s / divisor), self.unit, 3, method);
        Harmonic { order, frequency, amplitude, upper_limit: limit.map(|l| l / divisor) }
    }

    /// Index of the largest line of the wanted quantity, cut-off and above.
    fn largest(&self, stored: &[f64]) -> usize {
        let first = self.position(self.fmin).ceil().max(1.0) as usize;
        let wanted = |k: usize| {
            stored[k] / (2.0 * PI * self.frequency(k as f64)).powi(i32::from(self.options.integrate))
        };
        (first..stored.len()).max_by(|a, b| wanted(*a).total_cmp(&wanted(*b))).unwrap_or(first)
    }
}

/// Lines on either side in which another line is looked for that may hide a response.
const REACH: usize = 40;

/// The line further than [`NEAR`] from `position` that reaches highest there: its own position, and its height at the line nearest
/// to `position`. `None` where that is within the noise.
fn intruder(measured: &[f64], position: f64, window: Window, floor: f64) -> Option<(f64, f64)> {
    let centre = position.round().max(0.0) as usize;
    let high = centre.saturating_add(REACH).min(measured.len().saturating_sub(2));
    (centre.saturating_sub(REACH).max(1)..=high)
        .filter(|&k| measured[k] >= measured[k - 1] && measured[k] >= measured[k + 1])
        // Half a line off, a line is 2/π of the amplitude or more.
        .filter(|&k| measured[k] >= 0.5 * PEAK_ABOVE * floor)
        .filter_map(|k| interpolate(measured, k, Some(window), None))
        .filter(|p| p.amplitude >= PEAK_ABOVE * floor && (p.position - position).abs() > NEAR)
        .map(|p| (p.position, p.amplitude * line_shape(window, centre as f64 - p.position).abs()))
        .filter(|p| p.1 > floor)
        .max_by(|a, b| a.1.total_cmp(&b.1))
}

/// The normal distribution leaves 5 % above this many standard deviations.
const ONE_IN_TWENTY: f64 = 1.645;

/// Amplitude in the noise, its uncertainty and its upper limit, from one line, because the distribution of its magnitude is known.
///
/// `leakage` of another line adds to the response or takes away from it, as their phases, which are not known, will have it: at the
/// worst all of the line is missing what the other took. So it adds to the limit as a whole; a line far above both has none.
fn faint(
    measured: &[f64],
    position: f64,
    window: Option<Window>,
    floor: Option<f64>,
    leakage: f64,
) -> (f64, Option<f64>, Option<f64>) {
    let (line, gain) = nearest(measured, position, window).unwrap_or((f64::NAN, 1.0));
    let floor = window.and(floor);
    let std = floor.map(|f| f.hypot(leakage));
    let limit = floor.and_then(|f| {
        let in_noise = upper_limit(line, f);
        if leakage == 0.0 || line >= PEAK_ABOVE * f.hypot(leakage) {
            return in_noise;
        }
        Some(in_noise.unwrap_or(line + ONE_IN_TWENTY * f) + leakage).filter(|l| l.is_finite())
    });
    (line / gain, std.map(|s| s / gain), limit.map(|l| l / gain))
}

#[cfg(test)]
mod tests;

//! Response at the excitation, step by step (the job of the thesis' sinesw3).

use super::excitation::{Excitation, bent, excitations};
use super::jump::Jump;
use super::line::{SubLine, amplitude_at, interpolate, nearest};
use super::noise::upper_limit;
use super::resonance::{NamedCurve, Resonance};
use super::{Estimate, noise};
use crate::line::deviation;
use crate::mean::upper_median;
use num_complex::Complex64;
use serde::Serialize;
use std::cmp::Ordering;
use std::f64::consts::TAU;
use vibro_record::units::Quantity;
use vibro_record::{Direction, Error, Finding, Result, Step, Sweep, SweepPoint, Values, Window};

/// How a response is to be taken.
#[derive(Debug, Clone, PartialEq)]
pub struct ResponseOptions {
    /// Lines on both sides of the excitation in which its peak is looked for. Default 3.
    pub band: usize,
    /// Integrations in frequency from the stored quantity: 1 takes velocity to displacement. Default: what takes it to displacement.
    pub integrate: Option<i8>,
    /// Lowest frequency in Hz that is read. Default: the larger of two lines and a quarter of the lowest
    /// excitation frequency.
    pub fmin: Option<f64>,
}

impl Default for ResponseOptions {
    fn default() -> Self {
        ResponseOptions { band: 3, integrate: None, fmin: None }
    }
}

impl ResponseOptions {
    /// Integrations from what a sweep holds.
    pub(crate) fn times(&self, sweep: &Sweep) -> i8 {
        self.integrate.unwrap_or(match sweep.unit().quantity() {
            Quantity::Velocity => 1,
            Quantity::Acceleration => 2,
            _ => 0,
        })
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
    /// 95 % upper limit of the true amplitude, where it does not stand out of the noise (Read 2002).
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
    /// 95 % upper limit of the true amplitude, where it does not stand out of the noise (Read 2002).
    pub upper_limit: Option<f64>,
    /// Orders 2 to 5.
    pub harmonics: Vec<Harmonic>,
    /// Orders 1/2, 1/3, 1/4.
    pub subharmonics: Vec<Harmonic>,
    /// Phase of the response against the force in rad, where it is known.
    pub phase: Option<Estimate>,
    /// Displacement over force, where its phase is known.
    pub receptance: Option<Receptance>,
    /// Whether the largest line of the spectrum is not at the excitation.
    pub largest_elsewhere: bool,
    /// Frequency of the largest line in Hz.
    pub largest_at: f64,
}

/// Displacement over force at one frequency, in m/N.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Receptance {
    /// Real part.
    pub re: f64,
    /// Imaginary part.
    pub im: f64,
    /// Standard uncertainty of each of them.
    pub std: Option<f64>,
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
    let excitations = excitations(sweep, options.fmin.unwrap_or(0.0))?;
    let df = sweep.line_width().unwrap_or(f64::NAN);
    let wrong = wrong_window(sweep, &excitations, df);
    let mut found = read(sweep, options, &excitations)?;
    found.findings.splice(0..0, wrong.iter().cloned());
    let mut found = found.curve(sweep.direction);
    if wrong.is_some() {
        for point in &mut found.points {
            (point.frequency_std, point.amplitude.std) = (None, None);
        }
        for jump in &mut found.jumps {
            (jump.amplitude_before_std, jump.amplitude_after_std) = (None, None);
        }
        for resonance in &mut found.resonances {
            (resonance.frequency_std, resonance.amplitude_std) = (None, None);
        }
    }
    Ok(found)
}

/// The points of a sweep at known excitations, no curve yet.
///
/// # Errors
/// If what is stored cannot be taken to a displacement, velocity or acceleration.
pub(crate) fn read(sweep: &Sweep, options: &ResponseOptions, excitations: &[Excitation]) -> Result<Response> {
    let df = sweep.line_width().unwrap_or(f64::NAN);
    let fmin = options.fmin.unwrap_or_else(|| default_cutoff(df, excitations));
    let times = options.times(sweep);
    let quantity = sweep.unit().times_seconds(times).quantity();
    if quantity == Quantity::Other {
        let why = format!(
            "values in {}, integrated {} times, are no displacement, velocity or acceleration",
            sweep.unit(),
            times
        );
        let hint = "integrate once from velocity to displacement, twice from acceleration";
        return Err(Error::refused(why).hint(hint).setting("integrate"));
    }
    let unit = quantity.symbol();
    let taker = Taker { sweep, options, times, df, fmin, unit };
    let points = sweep.points.iter().zip(excitations).map(|(p, e)| taker.point(p, e)).collect();
    let taken: [(_, &dyn std::fmt::Display); 4] = [
        ("band", &options.band),
        ("integrate", &times),
        ("analyser_integrated", &sweep.analyser_integrated),
        ("fmin", &fmin),
    ];
    Ok(Response {
        name: sweep.name.clone(),
        direction: None,
        mass: sweep.mass,
        quantity: quantity.name(),
        unit,
        fmin,
        points,
        resonances: Vec::new(),
        jumps: Vec::new(),
        findings: sweep.findings.iter().cloned().chain(repeated(sweep)).collect(),
        history: sweep.history().iter().cloned().chain([Step::new("response", &taken)]).collect(),
    })
}

impl Response {
    /// Finds what the points show as a curve; the direction is the one stated, else that of the frequencies.
    pub(crate) fn curve(mut self, stated: Option<Direction>) -> Response {
        let Response { points, findings, fmin, .. } = &mut self;
        let frequency: Vec<f64> = points.iter().map(|p| p.excitation).collect();
        let direction = direction(&frequency, stated, findings);
        let faint = points.iter().filter(|p| p.upper_limit.is_some()).count();
        let below = points.iter().filter(|p| p.amplitude.value.is_nan()).count();
        let below_cutoff = Finding::caution("sweep-below-cutoff").count("n", below).number("fmin", *fmin);
        findings.extend((faint > 0).then(|| Finding::caution("sweep-below-noise").count("n", faint)));
        findings.extend((below > 0).then_some(below_cutoff));
        if let Some(direction) = direction.filter(|_| points.len() >= 3) {
            let at =
                |p: &ResponsePoint| (p.excitation, p.amplitude.value, p.amplitude.std.unwrap_or(f64::NAN));
            let receptance = |p: &ResponsePoint| p.receptance.as_ref().map(|r| Complex64::new(r.re, r.im));
            let receptances: Option<Vec<Complex64>> = points.iter().map(receptance).collect();
            let receptances = receptances.unwrap_or_default();
            let curve = NamedCurve::new(points.iter().map(at).collect(), &receptances, direction, self.mass);
            (self.jumps, self.resonances) = (curve.jumps, curve.resonances);
        } else {
            findings.push(Finding::caution("sweep-too-few-points").count("n", points.len()));
        }
        self.direction = direction;
        self
    }
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
    /// Integrations.
    times: i8,
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

    /// An amplitude of the wanted quantity from one of the measured signal at `frequency`, and the same of its upper limit.
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

    fn point(&self, point: &SweepPoint, excitation: &Excitation) -> ResponsePoint {
        let stored = point.response.values.magnitudes();
        let undo = i32::from(self.sweep.analyser_integrated);
        let measured: Vec<f64> =
            stored.iter().enumerate().map(|(k, m)| m * (TAU * self.frequency(k as f64)).powi(undo)).collect();
        let at = self.position(excitation.frequency);
        let centre = at.round().max(0.0) as usize;
        let window = point.response.window;
        let low = centre.saturating_sub(self.options.band).max(1);
        let high = centre.saturating_add(self.options.band).min(measured.len().saturating_sub(2));
        let top = (low..=high)
            .filter(|&k| measured[k] >= measured[k - 1] && measured[k] >= measured[k + 1])
            .max_by(|a, b| measured[*a].total_cmp(&measured[*b]));
        let floor = noise::around(&measured, top.unwrap_or(centre), noise::REACH, window);
        // A hump of noise is not the response, nor is another line beside the excitation, which hides it.
        let clear = |p: &SubLine| floor.is_none_or(|f| p.amplitude >= PEAK_ABOVE * f);
        let peak = top.and_then(|k| {
            let line = interpolate(&measured, k, window, floor).filter(clear)?;
            Some(bent(line, &measured, k, window.zip(floor)))
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
            (excitation.frequency, excitation.std, faint(&measured, at, window, floor), method)
        };
        let (amplitude, upper_limit) = self.estimate(frequency, amplitude, method);
        let (phase, receptance) = self.transfer(point, excitation.frequency).unzip();
        let harmonic =
            |order: String, ratio: f64| self.harmonic(&measured, order, excitation.frequency * ratio, window);
        let largest = self.largest(&stored);
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

    /// Phase of the response against the force, and their ratio, by the line nearest to the excitation of complex spectra. Both lines have the same
    /// window, which the ratio is free of.
    fn transfer(&self, point: &SweepPoint, excitation: f64) -> Option<(Estimate, Receptance)> {
        let (Values::Complex(response), Values::Complex(force)) = (&point.response.values, &point.force)
        else {
            return None;
        };
        let k = self.position(excitation).round().max(0.0) as usize;
        let (x, f) = (*response.get(k)?, *force.get(k)?);
        let window = point.response.window;
        let noise = |values: &Values| noise::around(&values.magnitudes(), k, noise::REACH, window);
        let (of_x, of_f) = (noise(&point.response.values)?, noise(&point.force)?);
        let relative = (of_x / x.norm()).hypot(of_f / f.norm());
        // What the analyser divided by at the line is taken to the frequency of the sine.
        let undone =
            Complex64::new(0.0, TAU * self.frequency(k as f64)).powi(self.sweep.analyser_integrated.into());
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
        let floor = noise::around(measured, at.round().max(0.0) as usize, noise::REACH, window);
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

    /// Index of the largest line of the wanted quantity, cut-off and above.
    fn largest(&self, stored: &[f64]) -> usize {
        let first = self.position(self.fmin).ceil().max(1.0) as usize;
        let wanted = |k: usize| stored[k] / (TAU * self.frequency(k as f64)).powi(i32::from(self.times));
        (first..stored.len()).max_by(|a, b| wanted(*a).total_cmp(&wanted(*b))).unwrap_or(first)
    }
}

/// Amplitude in the noise, its uncertainty and its upper limit, from one line, because the distribution of its magnitude is known.
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

/// Force lines further than this part of the largest from their window's shape are not under that window: a clean sine under Hann,
/// read as under any other window, is off by more.
const WRONG_SHAPE: f64 = 0.02;

/// Where the force lines, which hold one strong sine, have not the shape that the window gives them.
pub(crate) fn wrong_window(sweep: &Sweep, excitations: &[Excitation], df: f64) -> Option<Finding> {
    let window = sweep.points.first()?.response.window?;
    let typical = |window: Window| {
        upper_median(sweep.points.iter().zip(excitations).filter_map(|(p, e)| {
            let k = ((e.frequency - sweep.axis.start()) / df).round().max(0.0) as usize;
            let force = p.force.magnitudes();
            Some(deviation(&force, k, 1, window)? / force[k])
        }))
    };
    let off = typical(window).filter(|off| *off > WRONG_SHAPE)?;
    let finding = Finding::doubt("sweep-window-unlike").name("window", window.name()).number("off", off);
    let others = Window::ALL.into_iter().filter_map(|w| Some((typical(w)?, w)));
    let better = others.min_by(|a, b| a.0.total_cmp(&b.0)).filter(|b| b.0 < off / 3.0);
    Some(match better {
        Some((off, window)) => finding.name("better", window.name()).number("left", off),
        None => finding,
    })
}

/// Steps that share a file or hold the same values: a name was typed twice.
pub(crate) fn repeated(sweep: &Sweep) -> Option<Finding> {
    let points = &sweep.points;
    let same = |a: &SweepPoint, b: &SweepPoint| {
        a.response_path == b.response_path
            || a.force_path.is_some() && a.force_path == b.force_path
            || a.response.values == b.response.values && a.force == b.force && a.given == b.given
    };
    let earlier = |k: usize| Some((points[..k].iter().position(|p| same(p, &points[k]))? + 1, k + 1));
    let repeats: Vec<(usize, usize)> = (0..points.len()).filter_map(earlier).collect();
    let (first, second) = *repeats.first()?;
    let finding = Finding::caution("sweep-steps-repeated").count("n", repeats.len());
    Some(finding.count("first", first).count("second", second))
}

/// Direction of a sweep from its frequencies, with findings where they are not in order.
pub(crate) fn direction(
    frequency: &[f64],
    stated: Option<Direction>,
    findings: &mut Vec<Finding>,
) -> Option<Direction> {
    let count = |falls: bool| frequency.windows(2).filter(|w| w[0] != w[1] && (w[1] < w[0]) == falls).count();
    let (rising, falling) = (count(false), count(true));
    let found = match rising.cmp(&falling) {
        Ordering::Greater => Some(Direction::Up),
        Ordering::Less => Some(Direction::Down),
        Ordering::Equal => None,
    };
    let against = rising.min(falling);
    if against > 0 {
        let steps = frequency.len() - 1;
        findings.push(Finding::caution("sweep-out-of-order").count("n", against).count("steps", steps));
    }
    if let Some((stated, found)) = stated.zip(found).filter(|(stated, found)| stated != found) {
        let contradicted = Finding::caution("sweep-direction-contradicted");
        findings.push(contradicted.name("stated", stated.name()).name("found", found.name()));
    }
    stated.or(found)
}

#[cfg(test)]
mod tests;

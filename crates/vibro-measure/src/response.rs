//! Response at the excitation, step by step, as the thesis' script sinesw3 computes it.

mod result;
mod steady;
mod taker;

use super::answered::answered;
use super::excitation::{Excitation, each, excitations};
use super::resonance::{NamedCurve, Resonance};
use crate::line::deviation;
use num_complex::Complex64;
pub use result::{Harmonic, Receptance, Response, ResponsePoint};
use std::cmp::Ordering;
use steady::SteadyLine;
use taker::Taker;
use vibro_record::units::Quantity;
use vibro_record::{Direction, Doubt, Error, Finding, Result, Step, Sweep, SweepPoint, Window, median};

/// Options of a response curve.
#[derive(Debug, Clone, PartialEq)]
pub struct ResponseOptions {
    /// Lines on either side of the excitation that are searched for its peak. Default: 3.
    pub band: usize,
    /// Integrations in frequency from the stored quantity: 1 takes velocity to displacement. Default: as
    /// many as lead to displacement.
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
    /// Number of integrations of the stored quantity: as stated, else to displacement.
    pub(crate) fn times(&self, sweep: &Sweep) -> i8 {
        self.integrate.unwrap_or(match sweep.unit().quantity() {
            Quantity::Velocity => 1,
            Quantity::Acceleration => 2,
            _ => 0,
        })
    }
}

/// The sweep without the steps whose excitation is not found, each of which is named in a finding.
///
/// # Errors
/// If no step has an excitation, or the lines are not evenly spaced.
pub fn answerable(mut sweep: Sweep, options: &ResponseOptions) -> Result<Sweep> {
    let found = each(&sweep, options.fmin.unwrap_or(0.0))?;
    let steps = sweep.points.into_iter().zip(found).map(|(point, found)| {
        let path = point.force_path.clone().unwrap_or_else(|| point.response_path.clone());
        (path, found.map(|_| point))
    });
    let (points, left_out) = answered(steps)?;
    sweep.points = points;
    sweep.findings.extend(left_out);
    Ok(sweep)
}

/// Takes the response curve of a sweep.
///
/// Lines are interpolated in the spectrum of the measured signal: a division by (2πf)ⁿ in the analyser is
/// undone line by line. The amplitude is then divided by (2πf)ⁿ at the frequency found, so that the slope of
/// 1/fⁿ over the lines of a peak does not bias the result.
///
/// # Errors
/// If an excitation frequency cannot be found, or the lines are not evenly spaced.
pub fn response(sweep: &Sweep, options: &ResponseOptions) -> Result<Response> {
    let excitations = excitations(sweep, options.fmin.unwrap_or(0.0))?;
    let df = sweep.line_width().unwrap_or(f64::NAN);
    let wrong = wrong_window(sweep, &excitations, df);
    let (found, _) = read(sweep, options, &excitations)?;
    let mut found = found.curve(sweep.direction);
    let wrong = wrong.map(|doubt| doubt.of(&mut found));
    found.findings.splice(0..0, wrong);
    Ok(found)
}

/// The points of a sweep at known excitations, without jumps and resonances yet; and for each the standard
/// deviation of one component that steady lines add there, in the unit of the measured signal.
///
/// # Errors
/// If the stored quantity cannot be integrated to a displacement, velocity or acceleration.
pub(crate) fn read(
    sweep: &Sweep,
    options: &ResponseOptions,
    excitations: &[Excitation],
) -> Result<(Response, Vec<f64>)> {
    let df = sweep.line_width().unwrap_or(f64::NAN);
    // A spectrum that was divided by frequency is noise below two lines, and below a quarter of the lowest
    // excitation.
    let lowest = excitations.iter().map(|e| e.frequency).fold(f64::INFINITY, f64::min);
    let quarter = if lowest.is_finite() { lowest / 4.0 } else { 0.0 };
    let fmin = options.fmin.unwrap_or((2.0 * df).max(quarter));
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
    let mut taker = Taker { sweep, options, times, df, fmin, unit, steady: Vec::new() };
    let measured: Vec<Vec<f64>> = sweep.points.iter().map(|p| taker.measured(p)).collect();
    let positions: Vec<f64> = excitations.iter().map(|e| taker.position(e.frequency)).collect();
    let window = sweep.points.first().and_then(|p| p.response.window);
    taker.steady = SteadyLine::of(&measured, &positions, window);
    let steps = sweep.points.iter().zip(excitations).zip(&measured);
    let points = steps.map(|((p, e), measured)| taker.point(p, e, measured)).collect();
    let beside = positions.iter().map(|at| taker.beside(*at, window)).collect();
    let passed = taker.steady.iter().map(|line| {
        let n = positions.iter().filter(|at| line.at(**at, window) > 0.0).count();
        Finding::caution("sweep-passes-line")
            .count("n", n)
            .number("frequency", taker.frequency(line.position))
    });
    let taken: [(_, &dyn std::fmt::Display); 4] = [
        ("band", &options.band),
        ("integrate", &times),
        ("analyser_integrated", &sweep.analyser_integrated),
        ("fmin", &fmin),
    ];
    let response = Response {
        name: sweep.name.clone(),
        direction: None,
        mass: sweep.mass,
        quantity: quantity.name(),
        unit,
        fmin,
        points,
        resonances: Vec::new(),
        jumps: Vec::new(),
        findings: sweep.findings.iter().cloned().chain(repeated(sweep)).chain(passed).collect(),
        history: sweep.history().iter().cloned().chain([Step::new("response", &taken)]).collect(),
    };
    Ok((response, beside))
}

impl Response {
    /// Finds jumps and resonances of the points as a curve. The direction is as stated, else it follows from
    /// the order of the frequencies.
    pub(crate) fn curve(mut self, stated: Option<Direction>) -> Response {
        let Response { points, findings, fmin, mass, .. } = &mut self;
        let frequency: Vec<f64> = points.iter().map(|p| p.excitation).collect();
        let direction = direction(&frequency, stated, findings);
        let faint = points.iter().filter(|p| p.upper_limit.is_some()).count();
        let below = points.iter().filter(|p| p.amplitude.value.is_nan()).count();
        let below_cutoff = Finding::caution("sweep-below-cutoff").count("n", below).number("fmin", *fmin);
        findings.extend((faint > 0).then(|| Finding::caution("sweep-below-noise").count("n", faint)));
        findings.extend((below > 0).then_some(below_cutoff));
        if let Some(direction) = direction.filter(|_| points.len() >= 3) {
            let at = |p: &ResponsePoint| (p.excitation, p.amplitude.value, p.off_curve().unwrap_or(f64::NAN));
            let receptance = |p: &ResponsePoint| p.receptance.as_ref().map(|r| Complex64::new(r.re, r.im));
            let receptances: Option<Vec<Complex64>> = points.iter().map(receptance).collect();
            let receptances = receptances.unwrap_or_default();
            let mut curve = NamedCurve::new(points.iter().map(at).collect(), &receptances, direction, *mass);
            for Resonance { frequency, amplitude, amplitude_std, .. } in &mut curve.resonances {
                let away = |p: &&ResponsePoint| (p.excitation - *frequency).abs();
                let nearest = points.iter().min_by(|a, b| away(a).total_cmp(&away(b)));
                let common = nearest.map_or(0.0, ResponsePoint::with_curve) * *amplitude;
                *amplitude_std = amplitude_std.map(|std| std.hypot(common));
            }
            // Two steps at one frequency prevent an interpolation there, however fine the other steps are.
            let alone = |f: f64| points.iter().filter(|p| p.excitation == f).count() == 1;
            let coarse = curve.resonances.iter().filter(|r| r.is_largest_point()).map(|r| r.frequency);
            let coarse = coarse.filter(|f| alone(*f));
            let coarse: Vec<f64> = coarse.collect();
            let found = Finding::caution("sweep-steps-coarse").count("n", coarse.len());
            findings.extend((!coarse.is_empty()).then(|| found.numbers("frequencies", coarse)));
            findings.extend(moved_by_force(points, direction, &curve));
            (self.jumps, self.resonances) = (curve.jumps, curve.resonances);
        } else {
            findings.push(Finding::caution("sweep-too-few-points").count("n", points.len()));
        }
        self.direction = direction;
        self
    }
}

/// Caution on the peak that a changing force moves most: the response per newton peaks elsewhere by more
/// than twice the combined standard uncertainty.
fn moved_by_force(points: &[ResponsePoint], direction: Direction, curve: &NamedCurve) -> Option<Finding> {
    let per_newton = |p: &ResponsePoint| {
        let force = p.force.filter(|f| *f > 0.0)?;
        let relative = (p.amplitude.std? / p.amplitude.value).hypot(p.force_std.unwrap_or(0.0) / force);
        let ratio = p.amplitude.value / force;
        Some((p.excitation, ratio, ratio * relative))
    };
    let ratios: Vec<_> = points.iter().map(per_newton).collect::<Option<_>>()?;
    let ratios = NamedCurve::new(ratios, &[], direction, curve.mass);
    let smooth = |r: &&Resonance| r.kind.is_maximum() && !r.at_jump;
    let moved = curve.resonances.iter().filter(smooth).filter_map(|peak| {
        let away = |r: &Resonance| (r.frequency - peak.frequency).abs();
        let near = ratios.resonances.iter().filter(smooth).min_by(|a, b| away(a).total_cmp(&away(b)))?;
        Some((peak, near, away(near) / peak.frequency_std?.hypot(near.frequency_std?)))
    });
    let (peak, near, _) = moved.filter(|m| m.2 > 2.0).max_by(|a, b| a.2.total_cmp(&b.2))?;
    let force = || points.iter().filter_map(|p| p.force);
    let finding = Finding::caution("sweep-force-moves-peak")
        .number("frequency", peak.frequency)
        .number("per_newton", near.frequency)
        .number("std", near.frequency_std?);
    let (least, largest) = (force().fold(f64::INFINITY, f64::min), force().fold(0.0, f64::max));
    Some(finding.number("least", least).number("largest", largest))
}

/// The window is doubtful if force lines deviate from its shape by more than this fraction of the largest
/// line (median over steps). A clean sine under Hann deviates more from the shape of any other window.
const WRONG_SHAPE: f64 = 0.02;

/// Doubt where the force lines, which hold one strong sine, do not have the shape of the stated window.
/// Names a window that fits better.
pub(crate) fn wrong_window(sweep: &Sweep, excitations: &[Excitation], df: f64) -> Option<Doubt> {
    let window = sweep.points.first()?.response.window?;
    let typical = |window: Window| {
        median(sweep.points.iter().zip(excitations).filter_map(|(p, e)| {
            let k = ((e.frequency - sweep.axis.start()) / df).round().max(0.0) as usize;
            let force = p.force.magnitudes();
            Some(deviation(&force, k, 1, window)? / force[k])
        }))
    };
    let off = Some(typical(window)).filter(|off| *off > WRONG_SHAPE)?;
    let finding = Finding::doubt("sweep-window-unlike").name("window", window.name()).number("off", off);
    let others = Window::ALL.into_iter().map(|w| (typical(w), w));
    let better = others.min_by(|a, b| a.0.total_cmp(&b.0)).filter(|b| b.0 < off / 3.0);
    Some(match better {
        Some((off, window)) => finding.name("better", window.name()).number("left", off),
        None => finding,
    })
}

/// Caution if steps share a file or hold the same values: probably a name was typed twice.
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

//! Resonances, antiresonances and jumps of a response curve.

use super::peaks::{local_maxima, vertex};
use crate::record::Direction;
use serde::Serialize;

/// A maximum or minimum of a response curve.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Resonance {
    /// Frequency in Hz.
    pub frequency: f64,
    /// Its standard uncertainty in Hz.
    pub frequency_std: Option<f64>,
    /// Amplitude there.
    pub amplitude: f64,
    /// Its standard uncertainty.
    pub amplitude_std: Option<f64>,
    /// `resonance`, `antiresonance`; `grazing` or `clapping` where both masses were measured.
    pub kind: String,
    /// Whether the curve ends in a jump there, so that the true maximum may lie between the points.
    pub at_jump: bool,
}

/// A sudden change of amplitude from one step of a sweep to the next.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Jump {
    /// Last excitation frequency before, in Hz.
    pub from: f64,
    /// First excitation frequency behind, in Hz.
    pub to: f64,
    /// Frequency of the jump in Hz: the middle of the two.
    pub frequency: f64,
    /// Its standard uncertainty in Hz: anywhere between the two with equal chance, their distance over √12.
    pub frequency_std: f64,
    /// Amplitude before.
    pub amplitude_before: f64,
    /// Its standard uncertainty.
    pub amplitude_before_std: Option<f64>,
    /// Amplitude behind.
    pub amplitude_after: f64,
    /// Its standard uncertainty.
    pub amplitude_after_std: Option<f64>,
    /// `rise` or `drop`.
    pub change: &'static str,
    /// Direction of the sweep.
    pub direction: Direction,
}

/// A maximum must stand this factor above its valleys.
const PROMINENCE: f64 = 1.2;
/// A jump changes the amplitude by at least this factor …
const JUMP: f64 = 1.5;
/// … and in logarithm by this much more than the steps beside it.
const JUMP_AGAINST_NEIGHBOURS: f64 = 2.5;

/// Resonances and antiresonances of a curve with rising `frequency`, given amplitudes, their uncertainties, and
/// jumps.
pub fn resonances(frequency: &[f64], amplitude: &[f64], std: &[f64], jumps: &[Jump]) -> Vec<Resonance> {
    let inverse: Vec<f64> = amplitude.iter().map(|a| 1.0 / a).collect();
    let mut found: Vec<Resonance> = Vec::new();
    for (values, kind) in [(amplitude, "resonance"), (inverse.as_slice(), "antiresonance")] {
        for maximum in local_maxima(values, PROMINENCE) {
            let i = maximum.at;
            if !maximum.valleys.iter().all(|k| differ(amplitude, std, i, *k)) {
                continue;
            }
            let f = [frequency[i - 1], frequency[i], frequency[i + 1]];
            let beside = |j: &Jump| {
                let (low, high) = (j.from.min(j.to), j.from.max(j.to));
                high >= f[0] && low <= f[2] && (low == f[1] || high == f[1])
            };
            let jump = jumps.iter().find(|j| beside(j));
            if kind == "antiresonance" && jump.is_some() {
                continue; // the foot of a jump
            }
            let interpolated = if jump.is_none() && f[0] < f[1] && f[1] < f[2] {
                let a = [values[i - 1], values[i], values[i + 1]];
                // Relative uncertainties are the same for a value and its inverse.
                let s = [i - 1, i, i + 1].map(|k| values[k] * std[k] / amplitude[k]);
                vertex(f, a, s)
            } else {
                None
            };
            found.push(match interpolated {
                Some(v) => {
                    let height = if kind == "resonance" { v.height } else { 1.0 / v.height };
                    let relative = v.height_std / v.height;
                    Resonance {
                        frequency: v.frequency,
                        frequency_std: Some(v.frequency_std),
                        amplitude: height,
                        amplitude_std: Some(height * relative).filter(|s| s.is_finite()),
                        kind: kind.into(),
                        at_jump: false,
                    }
                }
                None => Resonance {
                    frequency: f[1],
                    // Anywhere between this point and its neighbours with equal chance.
                    frequency_std: Some((f[1] - f[0]).max(f[2] - f[1]) / f64::sqrt(3.0)),
                    amplitude: amplitude[i],
                    amplitude_std: jump.and_then(|j| at_a_jump(frequency, amplitude, std, i, j)),
                    kind: kind.into(),
                    at_jump: jump.is_some(),
                },
            });
        }
    }
    found.sort_by(|a, b| a.frequency.total_cmp(&b.frequency));
    found
}

/// Uncertainty of the height of a branch that ends in a jump beside point `i`: the slope towards it, carried on over the
/// distance to the point behind the jump.
fn at_a_jump(frequency: &[f64], amplitude: &[f64], std: &[f64], i: usize, jump: &Jump) -> Option<f64> {
    let behind =
        if (jump.from - frequency[i]).abs() < (jump.to - frequency[i]).abs() { jump.to } else { jump.from };
    let before = if behind > frequency[i] { i.checked_sub(1)? } else { i + 1 };
    let slope = (amplitude[i] - amplitude.get(before)?) / (frequency[i] - frequency.get(before)?);
    let reach = slope * (behind - frequency[i]) / f64::sqrt(3.0);
    Some(reach.hypot(std[i])).filter(|s| s.is_finite())
}

fn known(std: f64) -> Option<f64> {
    Some(std).filter(|s| s.is_finite())
}

/// Differences below this many standard deviations are noise.
const SIGMA: f64 = 4.0;

/// Whether two amplitudes differ by more than noise. Unknown uncertainties count as none.
fn differ(amplitude: &[f64], std: &[f64], i: usize, k: usize) -> bool {
    let noise = [std[i], std[k]].map(|s| if s.is_finite() { s } else { 0.0 });
    (amplitude[i] - amplitude[k]).abs() > SIGMA * noise[0].hypot(noise[1])
}

/// Jumps between neighbouring steps, in the order in which the sweep was run.
pub fn jumps(frequency: &[f64], amplitude: &[f64], std: &[f64], direction: Direction) -> Vec<Jump> {
    let n = amplitude.len();
    let step = |i: usize| (amplitude[i + 1] / amplitude[i]).ln();
    let width = |i: usize| (frequency[i + 1] - frequency[i]).abs();
    (0..n.saturating_sub(1))
        .filter(|&i| {
            // What the curve does on its own over this distance: the steepest of two steps on each side. Without a step on both sides,
            // and where a sharp peak stands beside the step, a jump cannot be told from a flank.
            let sides = [i.saturating_sub(2)..i, i + 1..(i + 3).min(n - 1)];
            let usual = sides.map(|side| {
                side.filter(|k| width(*k) > 1e-5 * frequency[*k])
                    .map(|k| (step(k) * width(i) / width(k)).abs())
                    .fold(f64::NAN, f64::max)
            });
            let s = step(i).abs();
            s.is_finite()
                && s > JUMP.ln()
                && usual.iter().all(|u| s > JUMP_AGAINST_NEIGHBOURS * u)
                && differ(amplitude, std, i, i + 1)
        })
        .map(|i| Jump {
            from: frequency[i],
            to: frequency[i + 1],
            frequency: f64::midpoint(frequency[i], frequency[i + 1]),
            frequency_std: width(i) / f64::sqrt(12.0),
            amplitude_before: amplitude[i],
            amplitude_before_std: known(std[i]),
            amplitude_after: amplitude[i + 1],
            amplitude_after_std: known(std[i + 1]),
            change: if step(i) > 0.0 { "rise" } else { "drop" },
            direction,
        })
        .collect()
}

/// A response curve whose resonances are to be named: excited (1) or passive (2) mass.
#[derive(Debug)]
pub struct NamedCurve<'a> {
    /// 1 excited, 2 passive.
    pub mass: u8,
    /// Direction of the sweep.
    pub direction: Direction,
    /// Excitation frequency in Hz, amplitude and its standard uncertainty, rising in frequency.
    pub curve: Vec<(f64, f64, f64)>,
    /// Its jumps.
    pub jumps: Vec<Jump>,
    /// Its resonances.
    pub resonances: &'a mut Vec<Resonance>,
}

/// The other mass must move at least this fraction of the one that resonates, or they do not resonate together.
const TOGETHER: f64 = 0.1;

/// Names the resonances in which both masses move: the largest maximum below the antiresonance of mass 1 is the grazing
/// resonance (in phase), the largest above it the clapping one (out of phase).
///
/// Where one mass jumps, the motion of both has changed: resonances are found again with the jumps of both.
/// A maximum at which the other mass of the same sweep rests keeps its kind, as do all where the other mass was not
/// measured. A sweep without an antiresonance of mass 1 uses that of the other direction.
pub fn name_modes(curves: &mut [NamedCurve<'_>]) {
    for i in 0..curves.len() {
        let other = curves.iter().find(|c| c.mass != curves[i].mass && c.direction == curves[i].direction);
        let Some(foreign) = other.map(|o| o.jumps.clone()).filter(|j| !j.is_empty()) else { continue };
        let own = &curves[i];
        let all: Vec<Jump> = own.jumps.iter().cloned().chain(foreign).collect();
        let column = |of: fn(&(f64, f64, f64)) -> f64| own.curve.iter().map(of).collect::<Vec<f64>>();
        *curves[i].resonances = resonances(&column(|p| p.0), &column(|p| p.1), &column(|p| p.2), &all);
    }
    let up = antiresonance(curves, Direction::Up);
    let down = antiresonance(curves, Direction::Down);
    for i in 0..curves.len() {
        let (mass, direction) = (curves[i].mass, curves[i].direction);
        let between = if direction == Direction::Up { up.or(down) } else { down.or(up) };
        let partner = curves.iter().find(|c| c.mass != mass && c.direction == direction);
        let partner = partner.map(|p| p.curve.clone());
        let (Some(between), Some(partner)) = (between, partner) else { continue };
        for (name, below) in [("grazing", true), ("clapping", false)] {
            let largest = curves[i]
                .resonances
                .iter_mut()
                .filter(|r| r.kind == "resonance" && (r.frequency < between) == below)
                .filter(|r| at(&partner, r.frequency).is_some_and(|other| other >= TOGETHER * r.amplitude))
                .max_by(|a, b| a.amplitude.total_cmp(&b.amplitude));
            if let Some(largest) = largest {
                name.clone_into(&mut largest.kind);
            }
        }
        // A maximum at a jump of one mass alone is the jump's edge.
        curves[i].resonances.retain(|r| !(r.at_jump && r.kind == "resonance"));
    }
}

/// Frequency of the deepest minimum of mass 1.
fn antiresonance(curves: &[NamedCurve<'_>], direction: Direction) -> Option<f64> {
    deepest(curves.iter().find(|c| c.mass == 1 && c.direction == direction)?.resonances)
}

/// Frequency of the deepest antiresonance of a curve.
pub fn deepest(resonances: &[Resonance]) -> Option<f64> {
    let minima = resonances.iter().filter(|r| r.kind == "antiresonance");
    minima.min_by(|a, b| a.amplitude.total_cmp(&b.amplitude)).map(|r| r.frequency)
}

/// The points between which `f` lies in a rising curve, and their weights in its logarithm there; `None` outside.
fn between(curve: &[(f64, f64, f64)], f: f64) -> Option<[(usize, f64); 2]> {
    let i = curve.partition_point(|p| p.0 < f);
    let b = curve.get(i)?;
    if b.0 == f {
        return Some([(i, 1.0), (i, 0.0)]);
    }
    let a = curve.get(i.checked_sub(1)?)?;
    let t = (f - a.0) / (b.0 - a.0);
    Some([(i - 1, 1.0 - t), (i, t)])
}

/// A curve between its points, linear in the logarithm; `None` outside.
fn at(curve: &[(f64, f64, f64)], f: f64) -> Option<f64> {
    Some(between(curve, f)?.iter().map(|(i, weight)| weight * curve[*i].1.ln()).sum::<f64>().exp())
}

/// Where two curves cross.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Crossing {
    /// Frequency in Hz.
    pub frequency: f64,
    /// Its standard uncertainty in Hz; `None` where that of an amplitude is not known.
    pub frequency_std: Option<f64>,
    /// Whether the second curve is the larger one above.
    pub second_above: bool,
}

/// Where two curves over frequency cross. Each is given as (frequency, amplitude, its standard uncertainty) in any order; the
/// second is interpolated at the frequencies of the first (linear in the logarithm).
///
/// The uncertainty is that of the amplitudes, carried through the interpolation. Where one of the curves jumps between the two
/// points, the crossing is that jump: it lies anywhere between the points with equal chance.
pub fn crossings(
    mut first: Vec<(f64, f64, f64)>,
    mut second: Vec<(f64, f64, f64)>,
    jumps: &[Jump],
) -> Vec<Crossing> {
    first.sort_by(|a, b| a.0.total_cmp(&b.0));
    second.sort_by(|a, b| a.0.total_cmp(&b.0));
    // Frequency, logarithm of the ratio, relative uncertainty of the first, points of the second.
    let ratios: Vec<_> = first
        .iter()
        .filter_map(|(f, a, s)| Some((*f, (at(&second, *f)? / a).ln(), s / a, between(&second, *f)?)))
        .filter(|r| r.1.is_finite())
        .collect();
    ratios
        .windows(2)
        .filter(|w| (w[0].1 > 0.0) != (w[1].1 > 0.0))
        .map(|w| {
            let (low, high) = (&w[0], &w[1]);
            let (width, turn) = (high.0 - low.0, low.1 - high.1);
            let second_above = high.1 > 0.0;
            if jumps.iter().any(|j| j.from.min(j.to) < high.0 && j.from.max(j.to) > low.0) {
                let frequency_std = Some(width / f64::sqrt(12.0));
                return Crossing { frequency: f64::midpoint(low.0, high.0), frequency_std, second_above };
            }
            // Slopes of the crossing over the two logarithms.
            let slopes = [-width * high.1 / (turn * turn), width * low.1 / (turn * turn)];
            let mut variance = (slopes[0] * low.2).powi(2) + (slopes[1] * high.2).powi(2);
            // One point of the second curve may stand behind both.
            let parts: Vec<(usize, f64)> = [(slopes[0], low.3), (slopes[1], high.3)]
                .iter()
                .flat_map(|(slope, points)| points.map(|(i, weight)| (i, slope * weight)))
                .filter(|part| part.1 != 0.0)
                .collect();
            for (i, a) in &parts {
                let shared: f64 = parts.iter().filter(|p| p.0 == *i).map(|p| p.1).sum();
                variance += a * shared * (second[*i].2 / second[*i].1).powi(2);
            }
            Crossing {
                frequency: low.0 + width * low.1 / turn,
                frequency_std: known(variance.sqrt()),
                second_above,
            }
        })
        .collect()
}

#[cfg(test)]
mod tests;

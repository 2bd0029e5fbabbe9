//! Resonances and antiresonances of a response curve.

use super::jump::{Jump, SIGMA, differ, echo, known};
use super::peaks::{Maximum, Vertex, local_maxima};
use super::top::top;
use serde::Serialize;
use std::ops::RangeInclusive;
use vibro_record::Direction;

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
    /// `resonance`, `antiresonance`, `minimum`; `grazing` or `clapping` where both masses were measured.
    pub kind: String,
    /// Whether the curve ends in a jump there, so that the true maximum may lie between the points.
    pub at_jump: bool,
}

/// A maximum must stand this factor above its valleys.
const PROMINENCE: f64 = 1.2;

/// Resonances and minima of a curve with rising `frequency`, given amplitudes, their uncertainties, jumps, and the mass where it
/// is known.
///
/// The excited mass (1) has an antiresonance between two resonances. The response of another point may pass between them without
/// a zero: its minimum is called an antiresonance only where it is deep (less than half of the curve half-way to its neighbours).
pub fn resonances(
    frequency: &[f64],
    amplitude: &[f64],
    std: &[f64],
    jumps: &[Jump],
    mass: Option<u8>,
) -> Vec<Resonance> {
    let curve = Curve { frequency, amplitude, std, jumps };
    let rising = |m: &Maximum| m.valleys.iter().all(|k| differ(amplitude, std, m.at, *k));
    let maxima = local_maxima(amplitude, PROMINENCE).into_iter().filter(rising);
    let mut found: Vec<Resonance> = maxima.map(|m| curve.maximum(m.at)).collect();
    let inverse: Vec<f64> = amplitude.iter().map(|a| 1.0 / a).collect();
    let minima = local_maxima(&inverse, PROMINENCE).into_iter().filter(rising);
    found.extend(minima.filter_map(|m| {
        let antiresonance = mass == Some(1) || curve.is_deep(&m);
        curve.minimum(m.at, &inverse, if antiresonance { "antiresonance" } else { "minimum" })
    }));
    found.sort_by(|a, b| a.frequency.total_cmp(&b.frequency));
    found
}

/// A minimum without a zero is less deep than this factor below the curve half-way (in f²) to the resonances beside it: where the
/// tails A/(u − p) and B/(q − u) of two modes add, the sum there is (2r + 2/(2 + r))/(1 + r) < 2 times its minimum, with
/// r² = A/B or its inverse. Where they cancel, it falls to what damping leaves.
const DEEP: f64 = 2.0;

/// A response curve of rising frequency.
struct Curve<'a> {
    frequency: &'a [f64],
    amplitude: &'a [f64],
    std: &'a [f64],
    jumps: &'a [Jump],
}

impl Curve<'_> {
    fn jump_between(&self, i: usize, k: usize) -> bool {
        let (low, high) = (self.frequency[i.min(k)], self.frequency[i.max(k)]);
        self.jumps.iter().any(|j| j.from.min(j.to) < high && j.from.max(j.to) > low)
    }

    /// Whether a jump ends or begins at point `i`.
    fn jump_at(&self, i: usize) -> Option<&Jump> {
        let f = &self.frequency[i - 1..=i + 1];
        self.jumps.iter().find(|j| {
            let (low, high) = (j.from.min(j.to), j.from.max(j.to));
            high >= f[0] && low <= f[2] && (low == f[1] || high == f[1])
        })
    }

    /// Points on both sides of `i` over which `values` fall without a jump, two at most.
    fn flanks(&self, values: &[f64], i: usize) -> RangeInclusive<usize> {
        let falls = |from: usize, to: usize| {
            values[to] < values[from] && values[to] > 0.0 && !self.jump_between(from, to)
        };
        let low = if i >= 2 && falls(i - 1, i - 2) { i - 2 } else { i - 1 };
        let high = if i + 2 < values.len() && falls(i + 1, i + 2) { i + 2 } else { i + 1 };
        low..=high
    }

    /// Frequency, height and their uncertainties between the points around the highest, `i`; `None` where it cannot be told.
    fn interpolated(&self, values: &[f64], i: usize) -> Option<Vertex> {
        let range = self.flanks(values, i);
        let stretch = self.frequency.get(range.clone())?;
        if !stretch.windows(2).all(|f| f[0] < f[1]) {
            return None;
        }
        // Relative uncertainties are the same for a value and its inverse.
        let std: Vec<f64> =
            values.iter().zip(self.std).zip(self.amplitude).map(|((v, s), a)| v * s / a).collect();
        top(self.frequency, values, &std, i, range)
    }

    fn maximum(&self, i: usize) -> Resonance {
        let jump = self.jump_at(i);
        let found = jump.map_or_else(|| self.interpolated(self.amplitude, i), |_| None);
        let kind = "resonance".to_owned();
        match found {
            Some(v) => Resonance {
                frequency: v.frequency,
                frequency_std: known(v.frequency_std),
                amplitude: v.height,
                amplitude_std: known(v.height_std),
                kind,
                at_jump: false,
            },
            None => Resonance {
                frequency: self.frequency[i],
                frequency_std: Some(anywhere(self.frequency, i, [i - 1, i + 1])),
                amplitude: self.amplitude[i],
                amplitude_std: jump.and_then(|j| at_a_jump(self.frequency, self.amplitude, self.std, i, j)),
                kind,
                at_jump: jump.is_some(),
            },
        }
    }

    /// `None` at the foot of a jump.
    fn minimum(&self, i: usize, inverse: &[f64], kind: &str) -> Option<Resonance> {
        let single = |sides: [usize; 2]| Resonance {
            frequency: self.frequency[i],
            frequency_std: Some(anywhere(self.frequency, i, sides)),
            amplitude: self.amplitude[i],
            amplitude_std: known(self.std[i]),
            kind: kind.to_owned(),
            at_jump: false,
        };
        if self.amplitude[i] < SIGMA * self.std[i] {
            // In the noise its place is not known: between the points that stand out on both sides.
            let out = |k: &usize| differ(self.amplitude, self.std, i, *k);
            let sides = [(0..i).rev().find(out)?, (i + 1..self.amplitude.len()).find(out)?];
            return (!self.jump_between(sides[0], sides[1])).then(|| single(sides));
        }
        if self.jump_at(i).is_some() {
            return None;
        }
        Some(self.interpolated(inverse, i).map_or_else(
            || Resonance { amplitude_std: None, ..single([i - 1, i + 1]) },
            |v| Resonance {
                frequency: v.frequency,
                frequency_std: known(v.frequency_std),
                amplitude: 1.0 / v.height,
                amplitude_std: known(v.height_std / (v.height * v.height)),
                ..single([i - 1, i + 1])
            },
        ))
    }

    /// Whether the curve stands [`DEEP`] above a minimum at the last point before half-way to its neighbours, on both sides.
    fn is_deep(&self, minimum: &Maximum) -> bool {
        let square = |k: usize| self.frequency[k].powi(2);
        minimum.valleys.iter().all(|&end| {
            let half_way = f64::midpoint(square(minimum.at), square(end));
            let before = |k: &usize| (square(*k) - half_way) * (square(end) - half_way) <= 0.0;
            let (low, high) = (minimum.at.min(end), minimum.at.max(end));
            let highest = (low..=high).filter(before).map(|k| self.amplitude[k]).fold(0.0, f64::max);
            highest > DEEP * self.amplitude[minimum.at]
        })
    }
}

/// Uncertainty of a place that lies anywhere from point `i` to those on its two sides with equal chance.
fn anywhere(frequency: &[f64], i: usize, sides: [usize; 2]) -> f64 {
    sides.map(|k| (frequency[k] - frequency[i]).abs()).into_iter().fold(0.0, f64::max) / f64::sqrt(3.0)
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
    pub jumps: &'a mut Vec<Jump>,
    /// Its resonances.
    pub resonances: &'a mut Vec<Resonance>,
}

/// The other mass must move at least this fraction of the one that resonates, or they do not resonate together.
const TOGETHER: f64 = 0.1;

/// Names the resonances in which both masses move: the largest maximum below the antiresonance of mass 1 is the grazing
/// resonance (in phase), the largest above it the clapping one (out of phase).
///
/// Where one mass jumps, the motion of both has changed: a change of the other there that its slopes do not predict is entered in
/// its jumps, and resonances are found again with the jumps of both.
/// A maximum at which the other mass of the same sweep rests keeps its kind, as do all where the other mass was not
/// measured. A sweep without an antiresonance of mass 1 uses that of the other direction.
pub fn name_modes(curves: &mut [NamedCurve<'_>]) {
    for i in 0..curves.len() {
        let other = curves.iter().find(|c| c.mass != curves[i].mass && c.direction == curves[i].direction);
        let Some(foreign) = other.map(|o| o.jumps.clone()).filter(|j| !j.is_empty()) else { continue };
        let own = &mut curves[i];
        for jump in &foreign {
            let known = own.jumps.iter().any(|j| (j.frequency - jump.frequency).abs() < j.frequency_std);
            if !known && let Some(found) = echo(&own.curve, jump) {
                own.jumps.push(found);
            }
        }
        let all = [own.jumps.as_slice(), &foreign].concat();
        let column = |of: fn(&(f64, f64, f64)) -> f64| own.curve.iter().map(of).collect::<Vec<f64>>();
        *own.resonances =
            resonances(&column(|p| p.0), &column(|p| p.1), &column(|p| p.2), &all, Some(own.mass));
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

/// Frequency of the antiresonance of mass 1 between its modes: the one that lies deepest below the largest maxima on both of its sides, or the
/// deepest where none has both.
fn antiresonance(curves: &[NamedCurve<'_>], direction: Direction) -> Option<f64> {
    let found: &[Resonance] = curves.iter().find(|c| c.mass == 1 && c.direction == direction)?.resonances;
    let largest = |side: &dyn Fn(f64) -> bool| {
        let tops =
            found.iter().filter(|r| r.kind != "antiresonance" && r.kind != "minimum" && side(r.frequency));
        tops.map(|r| r.amplitude).fold(0.0, f64::max)
    };
    let depth =
        |m: &Resonance| largest(&|f| f < m.frequency).min(largest(&|f| f > m.frequency)) / m.amplitude;
    let between = found.iter().filter(|r| r.kind == "antiresonance").map(|m| (depth(m), m.frequency));
    let between = between.filter(|m| m.0 > 0.0).max_by(|a, b| a.0.total_cmp(&b.0));
    between.map(|m| m.1).or_else(|| deepest(found))
}

/// Frequency of the deepest antiresonance of a curve.
pub fn deepest(resonances: &[Resonance]) -> Option<f64> {
    let minima = resonances.iter().filter(|r| r.kind == "antiresonance");
    minima.min_by(|a, b| a.amplitude.total_cmp(&b.amplitude)).map(|r| r.frequency)
}

/// Two points of a curve, and their weights in its logarithm between them.
type Between = [(usize, f64); 2];

/// The points between which `f` lies in a rising curve; `None` outside.
fn between(curve: &[(f64, f64, f64)], f: f64) -> Option<Between> {
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

/// Where two curves over frequency cross. Each is given as (frequency, amplitude, its standard uncertainty) in any order;
/// between its points it is a straight line in the logarithm, but not across a jump of its own.
///
/// The uncertainty is that of the amplitudes, carried through the interpolation. Where the curves change places at a jump, the
/// crossing is that jump: it lies anywhere between the points beside it with equal chance.
pub fn crossings(
    mut first: Vec<(f64, f64, f64)>,
    mut second: Vec<(f64, f64, f64)>,
    jumps: &[Jump],
) -> Vec<Crossing> {
    first.sort_by(|a, b| a.0.total_cmp(&b.0));
    second.sort_by(|a, b| a.0.total_cmp(&b.0));
    let curves = [&first, &second];
    let mut frequencies: Vec<f64> = curves.iter().flat_map(|c| c.iter().map(|p| p.0)).collect();
    frequencies.sort_by(f64::total_cmp);
    frequencies.dedup();
    let range = |j: &Jump| (j.from.min(j.to), j.from.max(j.to));
    // The points of both curves behind a frequency. Within a jump of its own a curve has no value.
    let places = |f: f64| -> Option<[Between; 2]> {
        let places = [between(&first, f)?, between(&second, f)?];
        let within = |(curve, [a, b]): (&&Vec<(f64, f64, f64)>, &Between)| {
            jumps.iter().any(|j| range(j) == (curve[a.0].0, curve[b.0].0))
        };
        (!curves.iter().zip(&places).any(within)).then_some(places)
    };
    // Frequency, logarithm of second over first, and where both come from.
    let ratios: Vec<_> = frequencies
        .into_iter()
        .filter_map(|f| Some((f, (at(&second, f)? / at(&first, f)?).ln(), places(f)?)))
        .filter(|r| r.1.is_finite())
        .collect();
    ratios
        .windows(2)
        .filter(|w| (w[0].1 > 0.0) != (w[1].1 > 0.0))
        .map(|w| {
            let (low, high) = (&w[0], &w[1]);
            let (width, turn) = (high.0 - low.0, low.1 - high.1);
            let second_above = high.1 > 0.0;
            // A jump belongs to the stretch that holds more than half of its step: both masses seldom have quite the same frequencies.
            let held =
                jumps.iter().map(range).filter(|j| j.1.min(high.0) - j.0.max(low.0) > 0.5 * (j.1 - j.0));
            if let Some(jump) = held.reduce(|a, b| (a.0.min(b.0), a.1.max(b.1))) {
                let frequency_std = Some((jump.1 - jump.0) / f64::sqrt(12.0));
                return Crossing { frequency: f64::midpoint(jump.0, jump.1), frequency_std, second_above };
            }
            // Slopes of the crossing over the two logarithms.
            let slopes = [-width * high.1 / (turn * turn), width * low.1 / (turn * turn)];
            let mut variance = 0.0;
            for (which, curve) in curves.iter().enumerate() {
                // One point may stand behind both.
                let parts: Vec<(usize, f64)> = [(slopes[0], low.2[which]), (slopes[1], high.2[which])]
                    .iter()
                    .flat_map(|(slope, points)| points.map(|(i, weight)| (i, slope * weight)))
                    .filter(|part| part.1 != 0.0)
                    .collect();
                for (i, a) in &parts {
                    let shared: f64 = parts.iter().filter(|p| p.0 == *i).map(|p| p.1).sum();
                    variance += a * shared * (curve[*i].2 / curve[*i].1).powi(2);
                }
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

//! Resonances and antiresonances of a response curve.

use super::apex::apex;
use super::crossing::at;
use super::jump::{Jump, SIGMA, differ, echo, known};
use super::peaks::{Maximum, Vertex, local_maxima};
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
    /// Maximum or minimum, by its name where both masses were measured.
    pub kind: ResonanceKind,
    /// Whether the curve ends in a jump there, so that the true maximum may lie between the points.
    pub at_jump: bool,
}

/// What a maximum or minimum of a response curve is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum ResonanceKind {
    /// A maximum.
    Resonance,
    /// The resonance in phase, in which the masses graze.
    Grazing,
    /// The resonance out of phase, in which the masses clap.
    Clapping,
    /// A deep minimum between two resonances.
    Antiresonance,
    /// Any other minimum.
    Minimum,
}

impl ResonanceKind {
    /// Its name, as in JSON.
    pub fn name(self) -> &'static str {
        match self {
            ResonanceKind::Resonance => "resonance",
            ResonanceKind::Grazing => "grazing",
            ResonanceKind::Clapping => "clapping",
            ResonanceKind::Antiresonance => "antiresonance",
            ResonanceKind::Minimum => "minimum",
        }
    }

    /// Whether it is a maximum.
    pub fn is_maximum(self) -> bool {
        !matches!(self, ResonanceKind::Antiresonance | ResonanceKind::Minimum)
    }
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
        let kind = if antiresonance { ResonanceKind::Antiresonance } else { ResonanceKind::Minimum };
        curve.minimum(m.at, &inverse, kind)
    }));
    found.sort_by(|a, b| a.frequency.total_cmp(&b.frequency));
    found
}

/// A minimum without a zero is less deep than this factor below the curve half-way (in f²) to the resonances beside it: where the
/// tails A/(u − p) and B/(q − u) of two modes add, the sum there is (2r + 2/(2 + r))/(1 + r) < 2 times its minimum, with
/// r² = A/B or its inverse. Where they cancel, it falls to what damping leaves.
const DEEP: f64 = 2.0;

impl Resonance {
    fn moved(self, top: Vertex) -> Resonance {
        Resonance {
            frequency: top.frequency,
            frequency_std: known(top.frequency_std),
            amplitude: top.height,
            amplitude_std: known(top.height_std),
            ..self
        }
    }
}

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

    /// The top between the points around the highest, `i`; `None` where they do not determine it.
    fn interpolated(&self, values: &[f64], i: usize) -> Option<Vertex> {
        let range = self.flanks(values, i);
        let stretch = self.frequency.get(range.clone())?;
        if !stretch.windows(2).all(|f| f[0] < f[1]) {
            return None;
        }
        // Relative uncertainties are the same for a value and its inverse.
        let std: Vec<f64> =
            values.iter().zip(self.std).zip(self.amplitude).map(|((v, s), a)| v * s / a).collect();
        apex(self.frequency, values, &std, i, range)
    }

    fn maximum(&self, i: usize) -> Resonance {
        let (jump, kind) = (self.jump_at(i), ResonanceKind::Resonance);
        if let Some(jump) = jump {
            let std = at_a_jump(self.frequency, self.amplitude, self.std, i, jump);
            return Resonance { at_jump: true, ..self.point(i, [i - 1, i + 1], kind, std) };
        }
        let here = self.point(i, [i - 1, i + 1], kind, None);
        self.interpolated(self.amplitude, i).map_or(here.clone(), |top| here.moved(top))
    }

    /// The maximum or minimum at point `i`, which lies anywhere between those on its two `sides`.
    fn point(
        &self,
        i: usize,
        sides: [usize; 2],
        kind: ResonanceKind,
        amplitude_std: Option<f64>,
    ) -> Resonance {
        let [a, b] = sides.map(|k| (self.frequency[k] - self.frequency[i]).abs());
        let (frequency, amplitude) = (self.frequency[i], self.amplitude[i]);
        let frequency_std = Some(a.max(b) / f64::sqrt(3.0));
        Resonance { frequency, frequency_std, amplitude, amplitude_std, kind, at_jump: false }
    }

    /// `None` at the foot of a jump.
    fn minimum(&self, i: usize, inverse: &[f64], kind: ResonanceKind) -> Option<Resonance> {
        if self.amplitude[i] < SIGMA * self.std[i] {
            // In the noise its place is not known: between the points that stand out on both sides.
            let out = |k: &usize| differ(self.amplitude, self.std, i, *k);
            let sides = [(0..i).rev().find(out)?, (i + 1..self.amplitude.len()).find(out)?];
            let here = self.point(i, sides, kind, known(self.std[i]));
            return (!self.jump_between(sides[0], sides[1])).then_some(here);
        }
        if self.jump_at(i).is_some() {
            return None;
        }
        let here = self.point(i, [i - 1, i + 1], kind, None);
        let Some(top) = self.interpolated(inverse, i) else { return Some(here) };
        let (height, height_std) = (1.0 / top.height, top.height_std / (top.height * top.height));
        Some(here.moved(Vertex { height, height_std, ..top }))
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
/// its jumps, and resonances are found again with the jumps of both. A maximum at which the other mass of the same sweep rests keeps
/// its kind, as do all where the other mass was not measured. A sweep without an antiresonance of mass 1 uses that of the other
/// direction.
pub fn name_modes(curves: &mut [NamedCurve<'_>]) {
    let partner = |curves: &[NamedCurve<'_>], i: usize| {
        let own = &curves[i];
        curves.iter().position(|c| c.mass != own.mass && c.direction == own.direction)
    };
    for i in 0..curves.len() {
        let foreign = partner(curves, i).map_or_else(Vec::new, |other| curves[other].jumps.clone());
        if foreign.is_empty() {
            continue;
        }
        let own = &mut curves[i];
        for jump in &foreign {
            let known = own.jumps.iter().any(|j| (j.frequency - jump.frequency).abs() < j.frequency_std);
            own.jumps.extend(echo(&own.curve, jump).filter(|_| !known));
        }
        let all = [own.jumps.as_slice(), &foreign].concat();
        let column = |of: fn(&(f64, f64, f64)) -> f64| own.curve.iter().map(of).collect::<Vec<f64>>();
        *own.resonances =
            resonances(&column(|p| p.0), &column(|p| p.1), &column(|p| p.2), &all, Some(own.mass));
    }
    let between =
        |direction| deepest(curves.iter().find(|c| c.mass == 1 && c.direction == direction)?.resonances);
    let (up, down) = (between(Direction::Up), between(Direction::Down));
    for i in 0..curves.len() {
        let between = if curves[i].direction == Direction::Up { up.or(down) } else { down.or(up) };
        let (Some(between), Some(partner)) = (between, partner(curves, i)) else { continue };
        let partner = curves[partner].curve.clone();
        for (kind, below) in [(ResonanceKind::Grazing, true), (ResonanceKind::Clapping, false)] {
            let largest = curves[i]
                .resonances
                .iter_mut()
                .filter(|r| r.kind == ResonanceKind::Resonance && (r.frequency < between) == below)
                .filter(|r| at(&partner, r.frequency).is_some_and(|other| other >= TOGETHER * r.amplitude))
                .max_by(|a, b| a.amplitude.total_cmp(&b.amplitude));
            if let Some(largest) = largest {
                largest.kind = kind;
            }
        }
        // A maximum at a jump of one mass alone is the jump's edge.
        curves[i].resonances.retain(|r| !(r.at_jump && r.kind == ResonanceKind::Resonance));
    }
}

/// Frequency of the deepest antiresonance of a curve.
pub fn deepest(resonances: &[Resonance]) -> Option<f64> {
    let minima = resonances.iter().filter(|r| r.kind == ResonanceKind::Antiresonance);
    minima.min_by(|a, b| a.amplitude.total_cmp(&b.amplitude)).map(|r| r.frequency)
}

#[cfg(test)]
mod tests;

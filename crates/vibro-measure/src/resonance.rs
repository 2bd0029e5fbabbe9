//! Resonances and antiresonances of a response curve.

use super::crossing::at;
use super::jump::{Jump, Point, SIGMA, differ, echo, jumps, known};
use super::peaks::{Maximum, Vertex, apex, local_maxima};
use num_complex::Complex64;
use serde::Serialize;

use vibro_record::{Direction, sort_by_number, uncertain};

/// A maximum or minimum of a response curve.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Resonance {
    /// Frequency in Hz.
    pub frequency: f64,
    /// Its standard uncertainty in Hz.
    pub frequency_std: Option<f64>,
    /// Amplitude there, in the unit of the curve.
    pub amplitude: f64,
    /// Its standard uncertainty; `None` where the points do not determine it.
    pub amplitude_std: Option<f64>,
    /// Maximum or minimum; a maximum has the name of its mode where both masses were measured.
    pub kind: ResonanceKind,
    /// Whether the curve ends in a jump there, so that the true maximum may lie between the points.
    pub at_jump: bool,
}

uncertain!(Resonance: frequency_std; scaled: amplitude_std);

/// Kind of a maximum or minimum of a response curve.
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
        ["resonance", "grazing", "clapping", "antiresonance", "minimum"][self as usize]
    }

    /// Whether it is a maximum.
    pub fn is_maximum(self) -> bool {
        !matches!(self, ResonanceKind::Antiresonance | ResonanceKind::Minimum)
    }
}

/// Least ratio of a maximum to the higher of its valleys: a smaller one lists ripples, a larger one misses
/// weak resonances.
const PROMINENCE: f64 = 1.2;

/// Resonances and minima of a curve of rising frequency, given its jumps, and the mass where it is known.
///
/// The excited mass (1) has an antiresonance between two resonances. The response of another point may pass
/// between them without a zero: its minimum is called an antiresonance only where it is deep (less than half
/// of the curve half-way to its neighbours).
pub(crate) fn resonances(points: &[Point], jumps: &[Jump], mass: Option<u8>) -> Vec<Resonance> {
    let inverted = |p: &Point| (p.0, 1.0 / p.1, p.2 / (p.1 * p.1));
    let inverse: Vec<Point> = points.iter().map(inverted).collect();
    let curve = Curve { points, inverse: &inverse, jumps };
    let tops = |of: &[Point]| {
        let heights: Vec<f64> = of.iter().map(|p| p.1).collect();
        let rises = |m: &Maximum| m.valleys.iter().all(|k| differ(&points[m.at], &points[*k]));
        local_maxima(&heights, PROMINENCE).into_iter().filter(rises)
    };
    let mut found: Vec<Resonance> = tops(points).map(|m| curve.maximum(m.at)).collect();
    found.extend(tops(&inverse).filter_map(|m| {
        let antiresonance = mass == Some(1) || curve.is_deep(&m);
        let kind = if antiresonance { ResonanceKind::Antiresonance } else { ResonanceKind::Minimum };
        curve.minimum(m.at, kind)
    }));
    sort_by_number(&mut found, |a| a.frequency);
    found
}

/// An antiresonance lies more than this factor below the curve half-way (in f²) to the resonances beside it.
/// Where the tails A/(u − p) and B/(q − u) of two modes add, the sum there is less than 2 times its minimum:
/// (2r + 2/(2 + r))/(1 + r) with r² = A/B or its inverse. Where they cancel, only damping limits the
/// minimum.
const DEEP: f64 = 2.0;

impl Resonance {
    /// Whether this is a maximum that its neighbouring points do not determine: the true one may lie between
    /// them, and be higher.
    pub(crate) fn is_largest_point(&self) -> bool {
        self.kind.is_maximum()
            && !self.at_jump
            && self.amplitude_std.is_none()
            && self.frequency_std.is_some()
    }

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

/// Fewest divided differences from which a scatter is estimated.
const FEW: usize = 4;

/// Most points on either side of the highest used for the scatter: farther ones may belong to another
/// motion.
const REACH: usize = 4;

/// Squared divided difference of 1/a² over f² through all `points`, over its variance by their
/// uncertainties; 1 without uncertainties. Frequencies and heights are taken relative to `top`.
fn squared_difference(points: &[Point], top: Point) -> f64 {
    let x = |p: &Point| (p.0 / top.0).powi(2);
    let (mut difference, mut variance) = (0.0, 0.0);
    for p in points {
        let others = points.iter().filter(|q| q.0 != p.0);
        let weight: f64 = others.map(|q| x(p) - x(q)).product::<f64>().recip();
        let inverse = (top.1 / p.1).powi(2);
        difference += weight * inverse;
        variance += (weight * 2.0 * inverse * p.2 / p.1).powi(2);
    }
    if variance > 0.0 { difference * difference / variance } else { 1.0 }
}

/// A response curve of rising frequency.
struct Curve<'a> {
    points: &'a [Point],
    /// The same points with inverse amplitudes, whose maxima are the minima of the curve.
    inverse: &'a [Point],
    jumps: &'a [Jump],
}

impl Curve<'_> {
    fn jump_between(&self, i: usize, k: usize) -> bool {
        let (low, high) = (self.points[i.min(k)].0, self.points[i.max(k)].0);
        self.jumps.iter().map(Jump::span).any(|j| j.0 < high && j.1 > low)
    }

    /// The jump that ends or begins at point `i`.
    fn jump_at(&self, i: usize) -> Option<&Jump> {
        let [low, f, high] = [i - 1, i, i + 1].map(|k| self.points[k].0);
        self.jumps.iter().find(|j| {
            let j = j.span();
            j.1 >= low && j.0 <= high && (j.0 == f || j.1 == f)
        })
    }

    /// Vertex of this curve or its inverse near its highest point `i`, from up to two points on each side
    /// over which the curve falls without a jump; `None` where they do not determine it.
    fn interpolated(&self, of: &[Point], i: usize) -> Option<Vertex> {
        let falls =
            |from: usize, to: usize| of[to].1 < of[from].1 && of[to].1 > 0.0 && !self.jump_between(from, to);
        let low = if i >= 2 && falls(i - 1, i - 2) { i - 2 } else { i - 1 };
        let high = if i + 2 < of.len() && falls(i + 1, i + 2) { i + 2 } else { i + 1 };
        let near = of.get(low..=high)?;
        let widened = self.scatter(of, i);
        let near: Vec<Point> = near.iter().map(|p| (p.0, p.1, p.2 * widened)).collect();
        let rises = near.windows(2).all(|p| p[0].0 < p[1].0);
        if rises { apex(&near, i - low) } else { None }
    }

    /// Factor by which the points around the highest, `i`, scatter more than their uncertainties state; at
    /// least 1. A force that varies from step to step moves points that are each correct.
    ///
    /// 1/a² of one mode is a parabola in f², and contact and other modes add a smooth part. So divided
    /// differences of orders 3 to 5, over near points above half of the highest, are noise or fall with the
    /// order. The smallest of their root mean squares, in units of the stated uncertainties, is taken.
    fn scatter(&self, of: &[Point], i: usize) -> f64 {
        let joined = |from: usize, to: usize| 2.0 * of[to].1 > of[i].1 && !self.jump_between(from, to);
        let low = (1..=i).rev().take(REACH).take_while(|k| joined(*k, k - 1)).last().map_or(i, |k| k - 1);
        let high =
            (i..of.len() - 1).take(REACH).take_while(|k| joined(*k, k + 1)).last().map_or(i, |k| k + 1);
        let of_order = |order: usize| {
            let windows = of[low..=high].windows(order + 1);
            let count = windows.len();
            let sum: f64 = windows.map(|points| squared_difference(points, of[i])).sum();
            (count >= FEW).then(|| (sum / count as f64).sqrt())
        };
        (3..=5).filter_map(of_order).reduce(f64::min).unwrap_or(1.0).max(1.0)
    }

    fn maximum(&self, i: usize) -> Resonance {
        let here = self.point(i, [i - 1, i + 1], ResonanceKind::Resonance);
        match self.jump_at(i) {
            Some(jump) => Resonance { at_jump: true, amplitude_std: self.std_at_jump(i, jump), ..here },
            None => self.interpolated(self.points, i).map_or(here.clone(), |top| here.moved(top)),
        }
    }

    /// The maximum or minimum at point `i`. Its true frequency lies with equal chance anywhere between the
    /// points on its two `sides`.
    fn point(&self, i: usize, sides: [usize; 2], kind: ResonanceKind) -> Resonance {
        let (frequency, amplitude, _) = self.points[i];
        let [a, b] = sides.map(|k| (self.points[k].0 - frequency).abs());
        let frequency_std = Some(a.max(b) / f64::sqrt(3.0));
        Resonance { frequency, frequency_std, amplitude, amplitude_std: None, kind, at_jump: false }
    }

    /// The minimum at point `i`; `None` at the foot of a jump.
    fn minimum(&self, i: usize, kind: ResonanceKind) -> Option<Resonance> {
        let (_, amplitude, std) = self.points[i];
        if amplitude < SIGMA * std {
            // A minimum below the noise may lie anywhere between the nearest points on both sides that
            // differ from it.
            let out = |k: &usize| differ(&self.points[i], &self.points[*k]);
            let sides = [(0..i).rev().find(out)?, (i + 1..self.points.len()).find(out)?];
            let here = Resonance { amplitude_std: known(std), ..self.point(i, sides, kind) };
            return (!self.jump_between(sides[0], sides[1])).then_some(here);
        }
        if self.jump_at(i).is_some() {
            return None;
        }
        let here = self.point(i, [i - 1, i + 1], kind);
        let Some(top) = self.interpolated(self.inverse, i) else { return Some(here) };
        let (height, height_std) = (1.0 / top.height, top.height_std / (top.height * top.height));
        Some(here.moved(Vertex { height, height_std, ..top }))
    }

    /// Whether the curve rises above [`DEEP`] times a minimum no farther than half-way (in f²) to the maxima
    /// beside it, on both sides.
    fn is_deep(&self, minimum: &Maximum) -> bool {
        let square = |k: usize| self.points[k].0.powi(2);
        minimum.valleys.iter().all(|&end| {
            let half_way = f64::midpoint(square(minimum.at), square(end));
            let before = |k: &usize| (square(*k) - half_way) * (square(end) - half_way) <= 0.0;
            let (low, high) = (minimum.at.min(end), minimum.at.max(end));
            let highest = (low..=high).filter(before).map(|k| self.points[k].1).fold(0.0, f64::max);
            highest > DEEP * self.points[minimum.at].1
        })
    }

    /// Standard uncertainty of the amplitude of a branch that ends in a jump beside point `i`: the slope
    /// before the jump, extrapolated to the point on its other side (uniform distribution), combined with
    /// the uncertainty of the point itself.
    fn std_at_jump(&self, i: usize, jump: &Jump) -> Option<f64> {
        let (f, amplitude, std) = self.points[i];
        let behind = if (jump.from - f).abs() < (jump.to - f).abs() { jump.to } else { jump.from };
        let before = self.points.get(if behind > f { i.checked_sub(1)? } else { i + 1 })?;
        let slope = (amplitude - before.1) / (f - before.0);
        known((slope * (behind - f) / f64::sqrt(3.0)).hypot(std))
    }
}

/// A response curve with its jumps and resonances.
#[derive(Debug, Clone, PartialEq)]
pub struct NamedCurve {
    /// Mass: 1 excited, 2 passive; `None` where that is not known.
    pub mass: Option<u8>,
    /// Direction of the sweep.
    pub direction: Direction,
    /// Its points by rising frequency.
    pub curve: Vec<Point>,
    /// Its jumps.
    pub jumps: Vec<Jump>,
    /// Its resonances.
    pub resonances: Vec<Resonance>,
}

impl NamedCurve {
    /// Finds jumps and resonances of a curve whose points come in the order of measurement. `receptances`
    /// belong to the points in that order; empty where they are not known.
    pub fn new(
        mut curve: Vec<Point>,
        receptances: &[Complex64],
        direction: Direction,
        mass: Option<u8>,
    ) -> NamedCurve {
        let jumps = jumps(&curve, receptances, direction);
        sort_by_number(&mut curve, |a| a.0);
        let resonances = resonances(&curve, &jumps, mass);
        NamedCurve { mass, direction, curve, jumps, resonances }
    }
}

/// Least amplitude of the other mass over that of the resonating one for a resonance of both; below it the
/// other mass counts as at rest.
const TOGETHER: f64 = 0.1;

/// Names the resonances in which both masses move: the largest maximum below the antiresonance of mass 1 is
/// the grazing resonance (in phase), the largest above it the clapping one (out of phase).
///
/// A sweep without an antiresonance of mass 1 uses that of the other direction. Where the phase between the
/// masses is known, [`name_modes_by_phase`] is better.
pub fn name_modes(curves: &mut [NamedCurve]) {
    share_jumps(curves);
    let excited = |c: &&NamedCurve, direction| c.mass == Some(1) && c.direction == direction;
    let between = |direction| deepest(&curves.iter().find(|c| excited(c, direction))?.resonances);
    let (up, down) = (between(Direction::Up), between(Direction::Down));
    name_modes_by_phase(curves, |direction, frequency| {
        let between = if direction == Direction::Up { up.or(down) } else { down.or(up) };
        Some(frequency < between?)
    });
}

/// The curve of the other mass in the same direction.
fn partner(curves: &[NamedCurve], i: usize) -> Option<&NamedCurve> {
    curves.iter().find(|c| c.mass != curves[i].mass && c.direction == curves[i].direction)
}

/// Gives each curve the jumps of the other mass, since a jump of one mass changes the motion of both. A step
/// there that the curve's slopes do not predict is added to its jumps. Then resonances are searched again
/// with the jumps of both masses.
pub fn share_jumps(curves: &mut [NamedCurve]) {
    for i in 0..curves.len() {
        let foreign = partner(curves, i).map_or_else(Vec::new, |other| other.jumps.clone());
        if foreign.is_empty() {
            continue;
        }
        let own = &mut curves[i];
        for jump in &foreign {
            let known = own.jumps.iter().any(|j| (j.frequency - jump.frequency).abs() < j.frequency_std);
            own.jumps.extend(echo(&own.curve, jump).filter(|_| !known));
        }
        let all = [own.jumps.as_slice(), &foreign].concat();
        own.resonances = resonances(&own.curve, &all, own.mass);
    }
}

/// Names the largest maximum in phase the grazing resonance, the largest out of phase the clapping one.
/// `in_phase` tells whether the masses move in phase at a frequency (Hz) of a direction, where it is known.
///
/// A maximum at which the other mass of the same sweep rests keeps its kind, as do all where the other mass
/// was not measured.
pub fn name_modes_by_phase(curves: &mut [NamedCurve], in_phase: impl Fn(Direction, f64) -> Option<bool>) {
    for i in 0..curves.len() {
        let direction = curves[i].direction;
        let Some(partner) = partner(curves, i).map(|other| other.curve.clone()) else { continue };
        let own = &mut curves[i].resonances;
        if own.iter().all(|r| in_phase(direction, r.frequency).is_none()) {
            continue;
        }
        for (kind, phase) in [(ResonanceKind::Grazing, true), (ResonanceKind::Clapping, false)] {
            let largest = own
                .iter_mut()
                .filter(|r| r.kind == ResonanceKind::Resonance)
                .filter(|r| in_phase(direction, r.frequency) == Some(phase))
                .filter(|r| at(&partner, r.frequency).is_some_and(|other| other >= TOGETHER * r.amplitude))
                .max_by(|a, b| a.amplitude.total_cmp(&b.amplitude));
            if let Some(largest) = largest {
                largest.kind = kind;
            }
        }
        // A maximum at a jump that did not get the name of a mode is only the edge of the jump.
        own.retain(|r| !(r.at_jump && r.kind == ResonanceKind::Resonance));
    }
}

/// Frequency of the deepest antiresonance of a curve.
pub fn deepest(resonances: &[Resonance]) -> Option<f64> {
    let minima = resonances.iter().filter(|r| r.kind == ResonanceKind::Antiresonance);
    minima.min_by(|a, b| a.amplitude.total_cmp(&b.amplitude)).map(|r| r.frequency)
}

#[cfg(test)]
mod tests;

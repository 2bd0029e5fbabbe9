//! One-impact orbits under impulses or rectangular pulses: all impact times that meet the impact conditions.

use super::conditions::{Conditions, Root};
use super::driven::{Piece, PulseResponse};
use super::{Course, Orbit};
use crate::excitation::Excitation;
use crate::flow::Flight;
use crate::waves::Waves;
use std::f64::consts::TAU;
use vibro_math::root::bracketed;

/// One-impact orbits, ordered by the time τ of the impact after the beginning of the pulse. `response` is the
/// steady motion y of mass 1 alone under `excitation`.
///
/// Eliminating the impulse J from the conditions y(τ) = Δ + JC and ẏ(τ) = JP gives G(τ) = P(y − Δ) − Cẏ = 0.
/// In each piece of the response Py − Cẏ is a free motion of mass 1 about a constant, so the stationary
/// points of G are known in closed form. Between two of them G has at most one root.
pub fn orbits(conditions: &Conditions, response: &PulseResponse, excitation: &Excitation) -> Vec<Orbit> {
    let mut orbits = Vec::new();
    let Conditions { c, p, rig, .. } = *conditions;
    if c == 0.0 && p == 0.0 {
        return orbits;
    }
    let omega = TAU / response.cycle;
    each_root(conditions, response, |timing, slope| {
        let [y, v, a] = response.at(timing);
        let norm = (c * omega).powi(2) + p * p;
        let impulse = (c * (y - rig.gap) * omega * omega + p * v) / norm;
        let root = Root {
            impulse,
            timing,
            force_phase: omega * timing,
            // dJ/dΔ from ẏ dτ = dΔ + C dJ and ÿ dτ = P dJ.
            sensitivity: a.abs() / slope.abs(),
            size: rig.gap.abs() + y.abs(),
            // With τ from y = Δ + JC, d(JP − ẏ)/dJ = (Pẏ − Cÿ)/ẏ: its sign is that of the slope of G.
            upper: slope > 0.0,
        };
        let course = course(conditions, response, impulse, timing);
        orbits.push(conditions.orbit(&root, course, Some(excitation.clone())));
    });
    orbits
}

/// Motion over one period, from impact to impact: the steady response minus the effect of the impacts. The
/// impact follows the beginning of the pulse by `delay` (s).
fn course(conditions: &Conditions, response: &PulseResponse, impulse: f64, delay: f64) -> Course {
    let (period, gap) = (conditions.period(), conditions.rig.gap);
    let oscillators = conditions.rig.oscillators();
    let mut stretches = Vec::new();
    let (mut t, (mut piece, mut inside)) = (0.0, response.piece(delay));
    // A remainder of a few roundings of the period is not made a stretch of its own.
    while t < period * (1.0 - 4.0 * f64::EPSILON) {
        let remaining = piece.duration - inside;
        let (x, v) = oscillators[0].free(piece.free.0, piece.free.1, inside);
        let [(c1, d1), (c2, d2)] = conditions.greens.map(|green| green.at(t));
        let free = [(x - impulse * c1, v - impulse * d1), (impulse * c2, impulse * d2)];
        let flight = Flight::of(oscillators, Waves::default(), piece.rest, gap, free);
        stretches.push((remaining.min(period - t), flight));
        t += remaining;
        inside = 0.0;
        let [on, off] = response.pieces();
        piece = if piece.start == 0.0 && response.width > 0.0 || on.duration == 0.0 { off } else { on };
    }
    Course { period, stretches }
}

/// Calls `visit` with each root τ of G in s and the slope of G there.
fn each_root(conditions: &Conditions, response: &PulseResponse, mut visit: impl FnMut(f64, f64)) {
    let Conditions { c, p, rig, .. } = *conditions;
    let oscillator = &response.oscillator;
    for piece in response.pieces() {
        let Piece { start, duration, rest, free: (x, v) } = piece;
        let a = oscillator.acceleration(x, v);
        // z = Py − Cẏ as a free motion.
        let (z, dz) = (p * x - c * v, p * v - c * a);
        let level = p * (rig.gap - rest);
        // |z| stays below its bound: where that is below the level, the piece has no root.
        if duration <= 0.0 || oscillator.bound(z, dz) < level.abs() {
            continue;
        }
        let g = |t: f64| {
            let (z, dz) = oscillator.free(z, dz, t);
            (z - level, dz)
        };
        let mut left = (0.0, g(0.0).0);
        let extrema = oscillator.passages(dz, oscillator.acceleration(z, dz), duration);
        for t in extrema.chain(std::iter::once(duration)) {
            let here = g(t).0;
            // A root on the border belongs to the piece that begins there.
            let root = if left.1 == 0.0 {
                Some(left.0)
            } else {
                (left.1 * here < 0.0).then(|| bracketed(left.0, t, g))
            };
            if let Some(root) = root.filter(|root| start + root > 0.0) {
                visit(start + root, g(root).1);
            }
            left = (t, here);
        }
    }
}

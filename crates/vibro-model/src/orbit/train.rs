//! Orbits under impulses or pulses: every root of the timing.

use super::Orbit;
use super::conditions::{Conditions, Root};
use super::course::Course;
use super::drive::Drive;
use super::response::{Piece, Response};
use std::f64::consts::TAU;
use vibro_math::bracket::bracketed;
use vibro_math::swing::passages;

/// Orbits under the excitation whose steady motion is `response`, in the order of their timing τ in 0 < τ < T.
///
/// Both conditions together, y(τ) = Δ + JC and ẏ(τ) = JP, ask for G(τ) = P(y − Δ) − Cẏ = 0. In each piece Py − Cẏ is a free motion of
/// mass 1 itself, so its stationary points are known in closed form, and between two of them lies one root at most.
pub fn orbits(conditions: &Conditions<'_>, response: &Response, drive: Drive) -> Vec<Orbit> {
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
            // ẏ dτ = dΔ + C dJ and ÿ dτ = P dJ.
            sensitivity: a.abs() / slope.abs(),
            size: rig.gap.abs() + y.abs(),
            // With τ from y = Δ + JC, d(JP − ẏ)/dJ = (Pẏ − Cÿ)/ẏ.
            upper: slope > 0.0,
        };
        let course = Course::Broken {
            response: *response,
            greens: conditions.greens,
            impulse,
            delay: timing,
            gap: rig.gap,
        };
        orbits.push(conditions.orbit(&root, &course, drive));
    });
    orbits
}

/// Visits every root τ of G with G's slope there.
fn each_root(conditions: &Conditions<'_>, response: &Response, mut visit: impl FnMut(f64, f64)) {
    let Conditions { c, p, rig, .. } = *conditions;
    let oscillator = &response.oscillator;
    for piece in response.pieces() {
        let Piece { start, duration, rest, free: (x, v) } = piece;
        let a = oscillator.acceleration(x, v);
        // z = Py − Cẏ as a free motion.
        let (z, dz) = (p * x - c * v, p * v - c * a);
        let level = p * (rig.gap - rest);
        // |z| never exceeds its bound again.
        if duration <= 0.0 || oscillator.bound(z, dz) < level.abs() {
            continue;
        }
        let g = |t: f64| {
            let (z, dz) = oscillator.free(z, dz, t);
            (z - level, dz)
        };
        let mut left = (0.0, g(0.0).0);
        let turns = passages(oscillator, dz, oscillator.acceleration(z, dz), duration);
        for t in turns.chain(std::iter::once(duration)) {
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

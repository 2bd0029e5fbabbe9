//! One mass on a spring with a cubic term under a sine force: m ẍ + c ẋ + k x + k₃ x³ = F₀ cos ωt
//! (Duffing 1918, *Erzwungene Schwingungen bei veränderlicher Eigenfrequenz*).
//!
//! Harmonic balance keeps the first harmonic of x³: x = A cos(ωt − φ) sees the stiffness k + ¾k₃A², and
//! ((k + ¾k₃A² − mω²)² + c²ω²) A² = F₀² is a cubic in A² (Nayfeh & Mook 1979, *Nonlinear Oscillations*,
//! 4.1.1). Two exact calculations state its error: the free period without damper, and periodic motions
//! by shooting.
//!
//! The spring hardens with k₃ > 0. With k₃ < 0 it softens, and its force falls beyond x = √(k/3|k₃|): a
//! cubic holds for no real spring there, so larger motions are left out.

use super::body::Body;
use super::excitation::Sine;
use super::parallel;
use super::response::axis;
use super::scales;
use super::scene::Scene;
use num_complex::Complex64;
use serde::Serialize;
use std::f64::consts::TAU;
use vibro_math::root::bracketed;
use vibro_math::runge_kutta::{Dop853, Integrator, Tolerance};
use vibro_math::{bisected, border};
use vibro_record::units::notation::significant;
use vibro_record::{Error, Result};

/// Most frequencies of a response.
const MOST_POINTS: usize = 10_000;
/// Amplitudes of a backbone.
const BACKBONE: usize = 20;
/// Relative error of a step of the integration. The step of Newton's iteration falls to some 1e-10.
const STEP_ERROR: f64 = 1e-12;
/// Newton's step over the amplitude at which a periodic motion is found.
const FOUND: f64 = 1e-9;
/// Most of Newton's steps.
const ITERATIONS: usize = 20;
/// Displacement over the amplitude by harmonic balance beyond which a motion is given up.
const FAR: f64 = 4.0;
/// Frequencies between which folds are sought.
const FOLDS: usize = 4000;
/// Most swings, or decays by e, in a cycle for which an exact motion is sought: a thousand
/// points then take some ten seconds.
const MOST_SWINGS: f64 = 100.0;

/// One mass on a spring with a cubic term.
///
/// ```
/// use vibro_model::{Duffing, Scene};
/// let scene = Scene::from_toml("[springs]\ncubic1 = 1e7")?;
/// let [balance, exact] = Duffing::new(&scene, 1)?.free(2e-3);
/// assert!(exact > 5.23 && balance > exact && balance < 1.01 * exact);
/// # Ok::<(), vibro_record::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Duffing {
    body: Body,
    /// k₃ in N/m³.
    cubic: f64,
}

/// A periodic motion by harmonic balance, and the exact one.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct CurvePoint {
    /// Frequency in Hz.
    pub frequency: f64,
    /// Amplitude in m by harmonic balance.
    pub amplitude: f64,
    /// Phase in rad by which it lags behind the force.
    pub lag: f64,
    /// Whether its amplitude rises with the force: else it is unstable (slope criterion).
    pub stable: bool,
    /// The exact motion; `None` where Newton's iteration from this one finds none.
    pub exact: Option<ExactMotion>,
}

/// An exact periodic motion.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct ExactMotion {
    /// Half its peak-to-peak displacement in m.
    pub amplitude: f64,
    /// Modulus of its largest Floquet multiplier: above 1 it is unstable.
    pub spectral_radius: f64,
}

/// A jump of the amplitude where two motions meet and vanish, by harmonic balance.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct CurveJump {
    /// Frequency in Hz.
    pub frequency: f64,
    /// Whether it occurs with rising frequency.
    pub rising: bool,
    /// Amplitudes in m before and after.
    pub amplitude: [f64; 2],
}

/// Response over frequency.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct CurvedResponse {
    /// Motions, by frequency and amplitude.
    pub points: Vec<CurvePoint>,
    /// Jumps, by frequency.
    pub jumps: Vec<CurveJump>,
    /// Number of motions beyond the largest force of a softening spring, which are left out.
    pub beyond: usize,
    /// Free motion without damper up to the largest amplitude: amplitude in m, frequency in Hz by
    /// harmonic balance, and the exact one.
    pub backbone: Vec<[f64; 3]>,
}

impl ExactMotion {
    /// Whether it is stable; without damper all multipliers lie on the unit circle, to an error of the
    /// integration below 1e-6.
    pub fn is_stable(&self) -> bool {
        self.spectral_radius <= 1.0 + 1e-6
    }
}

impl CurvePoint {
    /// Relative error of the amplitude by harmonic balance.
    pub fn error(&self) -> Option<f64> {
        self.exact.map(|exact| self.amplitude / exact.amplitude - 1.0)
    }
}

impl Duffing {
    /// Mass 1 or 2 of a scene, alone on its spring.
    ///
    /// # Errors
    /// If the scene states no cubic coefficient for it, or the mass is a wall.
    pub fn new(scene: &Scene, mass: usize) -> Result<Duffing> {
        let cubic = scene.springs.unwrap_or_default().cubic()[mass - 1];
        scales::check_values(&scene.rig, [cubic])?;
        let body = scene.rig.bodies()[mass - 1];
        if body.mass == f64::INFINITY {
            return Err(Error::usage("mass 2 is a wall: it does not move", "a finite m2, or mass 1"));
        }
        if cubic == 0.0 {
            let expected = format!("springs.cubic{mass} in N/m³, not 0");
            return Err(Error::usage(format!("spring {mass} is straight"), expected)
                .hint(format!(
                    "state springs.cubic{mass}, such as springs.cubic{mass}=1e7: 10 mN more at 1 mm"
                ))
                .setting("set"));
        }
        Ok(Duffing { body, cubic })
    }

    /// Deflection in m at which the force of a softening spring is largest; infinite for a hardening
    /// one.
    pub fn limit(&self) -> f64 {
        limit(self.body.stiffness, self.cubic)
    }

    /// Natural frequency in Hz at a small amplitude.
    pub fn natural_frequency(&self) -> f64 {
        self.free(0.0)[1]
    }

    /// Frequency in Hz of the free motion without damper: by harmonic balance, and the exact one. The
    /// amplitude (m) must not exceed [`Duffing::limit`].
    ///
    /// T = 4K/√((k + k₃A²)/m) with the complete elliptic integral K of the parameter k₃A²/2(k + k₃A²).
    /// By K = π/2agm(1, k′), ω is the arithmetic-geometric mean of √((k + k₃A²)/m) and √((k + ½k₃A²)/m).
    /// Harmonic balance takes the root of their mean square: it is too high, by up to 2.23 % with k₃ >
    /// 0, and up to 0.233 % with k₃ < 0.
    pub fn free(&self, amplitude: f64) -> [f64; 2] {
        let added = self.cubic * amplitude * amplitude;
        let hz = |part: f64| ((self.body.stiffness + part * added) / self.body.mass).sqrt() / TAU;
        [hz(0.75), agm(hz(1.0), hz(0.5))]
    }

    /// All motions by harmonic balance, amplitudes rising, each with its complex amplitude in m and
    /// whether it is stable.
    ///
    /// F₀² over A² has at most two turning points: each stretch between them holds one motion at most,
    /// and that of the falling stretch is unstable.
    fn balanced(&self, sine: &Sine) -> Vec<(Complex64, bool)> {
        let omega = sine.omega();
        let offset = self.body.stiffness - self.body.mass * omega * omega;
        let (loss, bend) = ((self.body.damping * omega).powi(2), 0.75 * self.cubic);
        let work = |u: f64| {
            let e = offset + bend * u;
            (u * (e * e + loss) - sine.force * sine.force, e * e + loss + 2.0 * bend * u * e)
        };
        let mut ends = vec![0.0];
        if offset * bend < 0.0 && offset * offset > 3.0 * loss {
            let root = (offset * offset - 3.0 * loss).sqrt();
            ends.extend([-1.0, 1.0].map(|sign| (2.0 * offset.abs() + sign * root) / (3.0 * bend.abs())));
        }
        // Beyond 2|k − mω²|/¾|k₃| the left side exceeds (¾k₃)²A⁶/4.
        let high = (4.0 * (sine.force / bend).powi(2)).cbrt();
        ends.push(2.0 * offset.abs() / bend.abs() + 2.0 * high);
        let motion = |(i, pair): (usize, &[f64])| {
            let crosses = (work(pair[0]).0 <= 0.0) != (work(pair[1]).0 <= 0.0);
            let u = crosses.then(|| bracketed(pair[0], pair[1], work))?;
            let body = Body { stiffness: self.body.stiffness + bend * u, ..self.body };
            Some((body.receptance(omega) * sine.force, i != 1))
        };
        ends.windows(2).enumerate().filter_map(motion).collect()
    }

    /// The exact periodic motion near a complex amplitude, by Newton's method on the state after a
    /// cycle.
    fn shoot(&self, sine: &Sine, near: Complex64) -> Option<ExactMotion> {
        let stiffest = self.body.stiffness + 3.0 * self.cubic.max(0.0) * near.norm_sqr();
        let fastest = (stiffest / self.body.mass).sqrt().max(TAU * self.body.damping / self.body.mass);
        if fastest > MOST_SWINGS * sine.omega() {
            return None;
        }
        let mut start = [near.re, -sine.omega() * near.im];
        for _ in 0..ITERATIONS {
            let (end, amplitude) = self.cycle(sine, start, near.norm())?;
            let [x, v, a, b, c, d] = end;
            // Newton's step (I − Φ)⁻¹(y(T) − y(0)) with the monodromy Φ = [[a, c], [b, d]].
            let (determinant, left) = ((1.0 - a) * (1.0 - d) - b * c, [x - start[0], v - start[1]]);
            let step = [
                ((1.0 - d) * left[0] + c * left[1]) / determinant,
                (b * left[0] + (1.0 - a) * left[1]) / determinant,
            ];
            if step[0].hypot(step[1] / sine.omega()) <= FOUND * near.norm() {
                let half = Complex64::from(f64::midpoint(a, d));
                let root = (half * half - (a * d - b * c)).sqrt();
                let spectral_radius = (half + root).norm().max((half - root).norm());
                return Some(ExactMotion { amplitude, spectral_radius });
            }
            start = [start[0] + step[0], start[1] + step[1]];
        }
        None
    }

    /// State and monodromy (by columns) after a cycle from `start`, and half the peak-to-peak
    /// displacement. `None` beyond [`FAR`] times the displacement `size` in m.
    fn cycle(&self, sine: &Sine, start: [f64; 2], size: f64) -> Option<([f64; 6], f64)> {
        let (omega, Body { mass, damping, stiffness }) = (sine.omega(), self.body);
        let rate = |t: f64, y: &[f64; 6]| {
            let tangent = stiffness + 3.0 * self.cubic * y[0] * y[0];
            let force = sine.force * (omega * t).cos() - (stiffness + self.cubic * y[0] * y[0]) * y[0];
            let fall = |x: f64, v: f64| -(tangent * x + damping * v) / mass;
            [y[1], (force - damping * y[1]) / mass, y[3], fall(y[2], y[3]), y[5], fall(y[4], y[5])]
        };
        let floor = [size, size * omega, 1.0, omega, 1.0 / omega, 1.0];
        let tolerance = Tolerance { relative: STEP_ERROR, floor };
        let (period, begin) = (1.0 / sine.frequency, [start[0], start[1], 1.0, 0.0, 0.0, 1.0]);
        let mut flight = Integrator::<Dop853, 6>::new(rate, 0.0, begin, period / 100.0, tolerance);
        let (mut low, mut high) = (start[0], start[0]);
        while flight.time() < period {
            let before = flight.y()[1];
            let step = flight.step(rate, period).ok()?;
            // Steps are much shorter than the time between two turning points.
            let turns = before * step.end[1] < 0.0;
            let turn = turns.then(|| border(0.0, step.duration, |t| step.at(t)[1] * before > 0.0));
            let x = step.at(turn.unwrap_or(step.duration))[0];
            (low, high) = (low.min(x), high.max(x));
            if high.max(-low) > FAR * size {
                return None;
            }
        }
        Some((*flight.y(), (high - low) / 2.0))
    }

    /// Response to a force of this amplitude (N) at `points` frequencies from `from` to `to` (Hz), and
    /// at the jumps between them.
    ///
    /// # Errors
    /// If the force or the axis is impossible, or all motions are beyond the largest force of the spring.
    pub fn response(&self, force: f64, from: f64, to: f64, points: usize) -> Result<CurvedResponse> {
        let at = axis(from, to, points, MOST_POINTS)?;
        Sine { force, frequency: from }.check()?;
        scales::check_sizes([force, from, to].into_iter())?;
        if force == 0.0 {
            return Err(Error::usage("nothing drives the mass", "a force above 0").setting("force"));
        }
        let balanced = |frequency: f64| self.balanced(&Sine { force, frequency });
        let mut frequencies: Vec<f64> = (0..points).map(at).collect();
        // Folds lie closer together than the points of a figure, and the balance costs nothing.
        let fine: Vec<f64> = (0..FOLDS).map(axis(from, to, FOLDS, MOST_POINTS)?).collect();
        let limit = self.limit();
        let mut jumps: Vec<CurveJump> = fine.windows(2).filter_map(|pair| jump(pair, &balanced)).collect();
        jumps.retain(|jump| jump.amplitude.iter().all(|amplitude| *amplitude <= limit));
        frequencies.extend(jumps.iter().map(|jump| jump.frequency));
        frequencies.sort_by(f64::total_cmp);
        let found = parallel::each(frequencies.len(), |i| {
            let sine = Sine { force, frequency: frequencies[i] };
            let all = self.balanced(&sine);
            let within = all.iter().filter(|(x, _)| x.norm() <= limit).map(|(x, stable)| {
                let nearest = |found: &ExactMotion| {
                    let own = (found.amplitude - x.norm()).abs();
                    found.amplitude <= limit
                        && all.iter().all(|o| own <= (found.amplitude - o.0.norm()).abs())
                };
                let (amplitude, lag, exact) = (x.norm(), -x.arg(), self.shoot(&sine, *x).filter(nearest));
                CurvePoint { frequency: sine.frequency, amplitude, lag, stable: *stable, exact }
            });
            (within.collect::<Vec<_>>(), all.len())
        });
        let all: usize = found.iter().map(|(_, all)| all).sum();
        let points: Vec<CurvePoint> = found.into_iter().flat_map(|(within, _)| within).collect();
        let Some(largest) = points.iter().map(|p| p.amplitude).reduce(f64::max) else {
            return Err(Error::refused(format!(
                "all motions go beyond {} m, where the softening spring has its largest force",
                significant(limit, 3)
            ))
            .hint("give a smaller force"));
        };
        let backbone = (0..=BACKBONE).map(|i| {
            let amplitude = largest * i as f64 / BACKBONE as f64;
            let [balance, exact] = self.free(amplitude);
            [amplitude, balance, exact]
        });
        Ok(CurvedResponse { beyond: all - points.len(), points, jumps, backbone: backbone.collect() })
    }
}

/// Deflection in m at which the force kx + k₃x³ of a softening spring is largest, else infinite.
pub(super) fn limit(stiffness: f64, cubic: f64) -> f64 {
    if cubic < 0.0 { (stiffness / (-3.0 * cubic)).sqrt() } else { f64::INFINITY }
}

/// Arithmetic-geometric mean of two positive numbers.
fn agm(mut a: f64, mut b: f64) -> f64 {
    // Digits double with each step.
    while (a - b).abs() > 1e-8 * a {
        (a, b) = (f64::midpoint(a, b), (a * b).sqrt());
    }
    f64::midpoint(a, b)
}

/// The jump between two frequencies, if there are three motions at one of them.
fn jump(pair: &[f64], balanced: &dyn Fn(f64) -> Vec<(Complex64, bool)>) -> Option<CurveJump> {
    let several = |frequency: f64| balanced(frequency).len() == 3;
    let (inside, outside) = match (several(pair[0]), several(pair[1])) {
        (true, false) => (pair[0], pair[1]),
        (false, true) => (pair[1], pair[0]),
        _ => return None,
    };
    let (frequency, _) = bisected(inside, outside, 60, several);
    let [low, middle, high]: [f64; 3] =
        balanced(frequency).iter().map(|(x, _)| x.norm()).collect::<Vec<_>>().try_into().ok()?;
    let amplitude = if high - middle < middle - low { [high, low] } else { [low, high] };
    Some(CurveJump { frequency, rising: inside < outside, amplitude })
}

#[cfg(test)]
mod tests;

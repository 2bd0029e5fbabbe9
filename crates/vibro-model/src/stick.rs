//! Both masses in lasting contact: their motion, the force between them, and the chatter that leads to it.

use super::body::Body;
use super::flow::Free;
use super::flow::{Flight, State};
use super::rig::Rig;
use super::waves::Waves;
use vibro_math::root::{Bounded, first_fall};

/// Motion of both masses in contact, in closed form; time counts from its start.
///
/// The masses move as one oscillator of m₁ + m₂, c₁ + c₂ and K = k₁ + k₂ under a constant force P (N) and
/// sine forces of complex amplitudes F (N): x₁ = (P + k₂Δ)/K + Σ Re(Ye^{iωt}) + free motion, and x₂ = x₁ −
/// Δ, with the complex amplitudes Y (m) of the forced motion and the gap Δ (m). The contact force on mass 2
/// is N = m₂ẍ₂ + c₂ẋ₂ + k₂x₂; the masses part where it vanishes.
///
/// Against a wall (m₂ infinite) mass 1 stays at x₁ = Δ, and the contact force is N = P + Σ Re(Fe^{iωt}) −
/// k₁Δ.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pair {
    /// Forced motion Y in m; against a wall the sine forces F in N.
    waves: Waves,
    /// Gap Δ in m.
    gap: f64,
    course: PairMotion,
}

/// Motion of a pair of masses in contact.
#[derive(Debug, Clone, Copy, PartialEq)]
enum PairMotion {
    Moving {
        /// Equilibrium of x₁ in m.
        rest: f64,
        free: Free,
        /// Mass 2.
        passive: Body,
    },
    /// Mass 1 at rest against a wall.
    Still {
        /// Constant force P in N and stiffness k₁ in N/m.
        force: f64,
        stiffness: f64,
    },
}

impl Pair {
    /// Motion from displacement `x1` (m) of mass 1 and the common velocity `v` (m/s), under a constant force
    /// (N) and with forced motion `waves` of the pair (m; against a wall, the sine forces in N).
    pub(super) fn new(rig: &Rig, waves: Waves, force: f64, x1: f64, v: f64) -> Pair {
        let [first, passive] = rig.bodies();
        let Some(both) = rig.joined() else {
            return Pair {
                waves,
                gap: rig.gap,
                course: PairMotion::Still { force, stiffness: first.stiffness },
            };
        };
        let [x, slope, ..] = waves.at(0.0);
        let rest = (force + passive.stiffness * rig.gap) / both.stiffness;
        let free = Free { oscillator: both.oscillator(), x: x1 - rest - x, v: v - slope };
        let course = PairMotion::Moving { rest, free, passive };
        Pair { waves, gap: rig.gap, course }
    }

    /// State at the time `t` ≥ 0 (s).
    pub fn state(&self, t: f64) -> State {
        match &self.course {
            PairMotion::Still { .. } => State { x1: self.gap, ..State::REST },
            PairMotion::Moving { rest, free, .. } => {
                let [x, v, ..] = self.series(*rest, free, t).0;
                State { x1: x, v1: v, x2: x - self.gap, v2: v }
            }
        }
    }

    /// Contact force N in N at `t` (s), its rate, and a bound on its second derivative for all later times.
    pub fn force(&self, t: f64) -> Bounded {
        match &self.course {
            PairMotion::Still { force, stiffness } => {
                let [sines, slope, ..] = self.waves.at(t);
                let curvature = self.waves.limits.curvature;
                Bounded { value: sines + force - stiffness * self.gap, slope, curvature }
            }
            PairMotion::Moving { rest, free, passive } => {
                let ([x, v, a, jerk, ..], [acceleration_bound, jerk_bound, snap_bound]) =
                    self.series(*rest, free, t);
                Bounded {
                    value: passive.mass * a + passive.damping * v + passive.stiffness * (x - self.gap),
                    slope: passive.mass * jerk + passive.damping * a + passive.stiffness * v,
                    curvature: passive.mass * snap_bound
                        + passive.damping * jerk_bound
                        + passive.stiffness * acceleration_bound,
                }
            }
        }
    }

    /// Rounding error of the contact force in N, taken as 8ε times the sum of its largest terms.
    pub(super) fn noise(&self) -> f64 {
        let size = match &self.course {
            PairMotion::Still { force, stiffness } => {
                self.waves.amplitude + force.abs() + stiffness * self.gap.abs()
            }
            PairMotion::Moving { rest, free, passive } => {
                let ([x, ..], [acceleration_bound, ..]) = self.series(*rest, free, 0.0);
                passive.mass * acceleration_bound
                    + passive.stiffness * (x.abs() + rest.abs() + self.gap.abs())
            }
        };
        8.0 * f64::EPSILON * size
    }

    /// Time in s in `0..=duration` at which the contact force vanishes and the masses part; 0 where the force
    /// would have to pull from the start.
    pub fn release(&self, duration: f64) -> Option<f64> {
        if self.force(0.0).value < -self.noise() {
            return Some(0.0);
        }
        first_fall(0.0, duration, 0.0, |t| self.force(t))
    }

    /// x₁ in m with its first five derivatives at `t` (s), and bounds on the second to the fourth for all
    /// later times.
    fn series(&self, rest: f64, free: &Free, t: f64) -> ([f64; 6], [f64; 3]) {
        let mut terms = free.series(t);
        let limits = self.waves.limits;
        let bound = |n: usize| free.oscillator.bound(terms[n], terms[n + 1]);
        let bounds = [limits.curvature + bound(2), limits.jerk + bound(3), limits.snap + bound(4)];
        for (sum, term) in terms.iter_mut().zip(self.waves.at(t)) {
            *sum += term;
        }
        terms[0] += rest;
        (terms, bounds)
    }

    /// Whether the motion is finite: false where the pair is driven at its undamped resonance.
    pub(super) fn is_finite(&self) -> bool {
        let free = match &self.course {
            PairMotion::Still { .. } => true,
            PairMotion::Moving { free, .. } => free.x.is_finite() && free.v.is_finite(),
        };
        self.waves.amplitude.is_finite() && free
    }
}

/// Relative motion at the start of a flight from contact. With the separation speed w the gap after the time
/// t is wt − at²/2 + jt³/6: a closes the gap, and j > 0 opens it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Press {
    /// Relative acceleration a of mass 1 towards mass 2 in m/s².
    pub acceleration: f64,
    /// Third derivative j of the gap in m/s³.
    jerk: f64,
    /// Rounding error of the gap in m.
    noise: f64,
}

impl Press {
    /// The relative motion at the start of `flight`.
    pub fn of(flight: &Flight) -> Press {
        let [[_, _, a1, j1, ..], [_, _, a2, j2, ..]] = flight.series(0.0);
        Press { acceleration: a1 - a2, jerk: j2 - j1, noise: flight.noise() }
    }

    /// Whether the masses count as resting: a rebound at `w` (m/s) would open the gap, at most w²/2a, by no
    /// more than four rounding errors.
    pub(crate) fn is_rest(&self, w: f64) -> bool {
        w * w <= 8.0 * self.acceleration * self.noise
    }

    /// Time T in s from a separation at speed `w` (m/s) to the end of the chatter that follows, a convergent
    /// series of ever shorter flights; `None` where the formula below is not accurate enough.
    ///
    /// Symbols: restitution R; a (m/s²) and j (m/s³) as in this type; reduced mass M (kg);
    /// decay rates b₁, b₂ (1/s) of masses m₁, m₂ (kg); κ = 2M(b₁/m₁ + b₂/m₂) (1/s). To the order of w², in
    /// each bounce:
    /// - the flight lasts 2w/a + 4jw²/3a³;
    /// - the masses meet again at the speed w − 2jw²/3a²;
    /// - a changes by −2jw/a during the flight, and by κ(1 + R) times the approach speed at the impact.
    ///
    /// The sum over all flights is T = 2w/(a(1 − R)) + [4j/3a³ − 2Rκ/a²] w²/(1 − R)² + O(w³). The second
    /// term must be below a ten thousandth of the first, and the first below a ten thousandth of the rig's
    /// time scale; then the truncation is below 1e-8 T.
    pub(crate) fn accumulation(&self, rig: &Rig, w: f64) -> Option<f64> {
        let (a, r) = (self.acceleration, rig.restitution);
        let loss = 1.0 - r;
        let ([first, second], [m1, m2]) = (rig.oscillators(), rig.masses());
        let kappa = 2.0 * rig.reduced_mass() * (first.decay() / m1 + second.decay() / m2);
        let leading = 2.0 * w / (a * loss);
        let correction = (4.0 / 3.0 * self.jerk / a - 2.0 * r * kappa) / (a * a) * (w / loss) * (w / loss);
        let scale = first.omega2().sqrt() + second.omega2().sqrt() + first.decay() + second.decay();
        let is_accurate = correction.abs() <= 1e-4 * leading && leading * scale <= 1e-4;
        if w == 0.0 { Some(0.0) } else { is_accurate.then_some(leading + correction) }
    }
}

//! The force between the masses over some cycles: peak, root mean square, and impulse a cycle.

use super::flow::State;
use super::law::Law;
use super::motion::{Event, Motion, Piece};
use serde::Serialize;

/// The force between the masses over some cycles.
///
/// A rigid impact has an impulse, but its force and its mean square are infinite.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Reaction {
    /// Largest force in N; `None` for rigid impacts.
    pub peak: Option<f64>,
    /// Root mean square in N over the whole time; `None` for rigid impacts.
    pub rms: Option<f64>,
    /// Impulse in N s per cycle of the excitation, including the force between masses that rest against each
    /// other; `None` where they rest against a wall.
    pub impulse: Option<f64>,
}

/// Nodes and weights of the three-point Gauss rule on 0..1.
const GAUSS: [(f64, f64); 3] =
    [(0.112_701_665_379_258_31, 5.0 / 18.0), (0.5, 8.0 / 18.0), (0.887_298_334_620_741_7, 5.0 / 18.0)];
/// Number of parts into which a piece in contact is divided for the Gauss rule. The piece lasts at most a
/// radian of its fastest motion. The error of a part is h⁷/2016000 of the sixth derivative, and 2⁶ times that
/// for the square of the force: 5e-8 of the force or its square.
const PARTS: u32 = 4;
/// Steps of the golden section search for the peak: they shorten the interval to 1e-6 of its length, within
/// which the force at a peak changes by 1e-13 of it.
const GOLDEN_STEPS: u32 = 30;

/// Sums the force between the masses piece by piece.
#[derive(Debug, Clone)]
pub struct Tally {
    law: Option<Law>,
    gap: f64,
    /// Mass (kg), damping (N s/m) and stiffness (N/m) of mass 2.
    second: [f64; 3],
    duration: f64,
    impulse: f64,
    square: f64,
    peak: f64,
    /// Time (s) and force (N) in contacts after the time `shown`.
    pub(crate) trace: Vec<(f64, f64)>,
    shown: f64,
}

impl Tally {
    /// A tally of `motion` from its present time; the force is recorded from the time `shown` (s) on.
    pub fn new(motion: &dyn Motion, shown: f64) -> Tally {
        let rig = motion.rig();
        Tally {
            law: motion.law(),
            gap: rig.gap,
            second: [rig.m2, rig.c2, rig.k2],
            duration: 0.0,
            impulse: 0.0,
            square: 0.0,
            peak: 0.0,
            trace: Vec::new(),
            shown,
        }
    }

    /// Adds a piece of the motion.
    pub fn take(&mut self, piece: &Piece<'_>) {
        let Piece { start, duration, path, event } = *piece;
        self.duration += duration;
        let middle = path.state(duration / 2.0);
        let (Some(law), gap) = (self.law, self.gap) else {
            if let Event::Impact(impact) = event {
                self.impulse += impact.impulse;
            }
            if duration > 0.0 && self.rests(&middle) {
                self.impulse += self.pressed(piece);
            }
            return;
        };
        if middle.x1 - middle.x2 <= gap {
            return;
        }
        let force = |t: f64| {
            let State { x1, v1, x2, v2 } = path.state(t);
            law.force(x1 - x2 - gap, v1 - v2)
        };
        let mut best = (0.0, 0.0);
        let h = duration / f64::from(PARTS);
        for part in 0..PARTS {
            for (node, weight) in GAUSS {
                let t = h * (f64::from(part) + node);
                let push = force(t);
                self.impulse += weight * h * push;
                self.square += weight * h * push * push;
                if push > best.1 {
                    best = (t, push);
                }
                if start + t >= self.shown {
                    self.trace.push((start + t, push));
                }
            }
        }
        let (mut low, mut high) = ((best.0 - h / 2.0).max(0.0), (best.0 + h / 2.0).min(duration));
        for _ in 0..GOLDEN_STEPS {
            let third = 0.381_966_011_250_105_1 * (high - low);
            if force(low + third) < force(high - third) { low += third } else { high -= third }
        }
        self.peak = self.peak.max(best.1).max(force(f64::midpoint(low, high)));
    }

    /// Whether the masses move together, within the rounding of displacements and velocities.
    fn rests(&self, state: &State) -> bool {
        let State { x1, v1, x2, v2 } = *state;
        (self.gap + x2 - x1).abs() <= 1e-9 * (x1.abs() + x2.abs() + self.gap.abs())
            && (v1 - v2).abs() <= 1e-9 * (v1.abs() + v2.abs())
    }

    /// Impulse in N s on mass 2 while the masses move together: ∫(m₂v̇₂ + c₂v₂ + k₂x₂) dt.
    fn pressed(&self, piece: &Piece<'_>) -> f64 {
        let [m2, c2, k2] = self.second;
        let (from, to) = (piece.path.state(0.0), piece.path.state(piece.duration));
        // A piece may last a cycle: with 64 parts the error is 1e-13.
        let h = piece.duration / 64.0;
        let way: f64 = (0..64)
            .flat_map(|i| {
                GAUSS.map(|(node, weight)| weight * h * piece.path.state(h * (f64::from(i) + node)).x2)
            })
            .sum();
        m2 * (to.v2 - from.v2) + c2 * (to.x2 - from.x2) + k2 * way
    }

    /// Peak, root mean square and impulse per cycle over all pieces added, which together last `cycles`
    /// cycles.
    pub fn read(&self, cycles: u32) -> Reaction {
        let known = |value: f64| self.law.map(|_| value);
        let impulse = Some(self.impulse / f64::from(cycles)).filter(|j| j.is_finite());
        Reaction { peak: known(self.peak), rms: known((self.square / self.duration).sqrt()), impulse }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::contact::Compliant;
    use crate::excitation::{Excitation, Sine};
    use crate::law::samples;
    use crate::rig::Rig;
    use crate::simulate::Simulation;

    fn seen(motion: &mut dyn Motion, settle: f64, cycles: u32) -> (Reaction, f64) {
        motion.advance(settle / motion.frequency(), &mut |_| {}).unwrap();
        let mut tally = Tally::new(motion, f64::INFINITY);
        let [m2, c2, k2] = tally.second;
        let (from, mut way) = (motion.state(), 0.0);
        let end = motion.time() + f64::from(cycles) / motion.frequency();
        motion
            .advance(end, &mut |piece| {
                tally.take(&piece);
                // Trapezoidal rule with 400 panels.
                let h = piece.duration / 400.0;
                let x2 = |i: i32| piece.path.state(h * f64::from(i)).x2;
                way += (0..400).map(|i| h * f64::midpoint(x2(i), x2(i + 1))).sum::<f64>();
            })
            .unwrap();
        let to = motion.state();
        let taken = m2 * (to.v2 - from.v2) + c2 * (to.x2 - from.x2) + k2 * way;
        (tally.read(cycles), taken / f64::from(cycles))
    }

    #[test]
    fn the_impulse_is_what_mass_2_takes_up() {
        let rig = Rig::thesis();
        let sine = |force, frequency| Excitation::Sine(Sine { force, frequency });
        let pressed = Rig { gap: -5e-4, ..rig };
        let giving = samples().map(|law| {
            Box::new(Compliant::new(&rig, &sine(0.5, 11.0), law, State::REST, 0.0).unwrap())
                as Box<dyn Motion>
        });
        let start = Simulation::at_rest(&pressed);
        let at_once: [Box<dyn Motion>; 2] = [
            Box::new(Simulation::from_state(&rig, &sine(0.5, 11.0), State::REST, 0.0).unwrap()),
            // Chatter and lasting contact every cycle.
            Box::new(Simulation::from_state(&pressed, &sine(0.35, 2.354), start, 0.0).unwrap()),
        ];
        for mut motion in giving.chain(at_once) {
            let (found, taken) = seen(&mut *motion, 20.0, 7);
            // Trapezoidal rule with panels of 1/400 of a flight of at most half a cycle: error (π/400)²/12 =
            // 5e-6.
            let error = (found.impulse.unwrap() / taken - 1.0).abs();
            assert!(error < 1e-5, "{error} {found:?} {taken}");
            assert_eq!(found.peak.is_some(), motion.law().is_some());
            assert_eq!(found.rms.is_some(), motion.law().is_some());
        }
    }

    #[test]
    fn a_hard_contact_has_the_force_of_a_free_rebound() {
        // Undamped spring: the force is half a sine of the height v√(kM) and the length π√(M/k), so its mean
        // square is half its height squared over that time. The contact force is some 100 N; beside it act
        // 0.5 N and the springs' 1 N, over a thousandth of a second.
        let rig = Rig { restitution: 1.0, ..Rig::thesis() };
        let k = 1e8;
        let law = Law::spring(k, 0.0);
        let sine = Excitation::Sine(Sine { force: 0.5, frequency: 11.0 });
        let mut motion = Compliant::new(&rig, &sine, law, State::REST, 0.0).unwrap();
        let mut tally = Tally::new(&motion, 0.0);
        let (mut speeds, end) = (Vec::new(), 20.0 / 11.0);
        motion
            .advance(end, &mut |piece| {
                tally.take(&piece);
                if let Event::Impact(impact) = piece.event {
                    speeds.push(impact.approach_velocity);
                }
            })
            .unwrap();
        let m = rig.reduced_mass();
        let height = (k * m).sqrt();
        let most = speeds.iter().copied().fold(0.0, f64::max);
        let found = tally.read(20);
        assert!((found.peak.unwrap() / (most * height) - 1.0).abs() < 1e-2, "{found:?}");
        let squares: f64 = speeds.iter().map(|v| (v * height).powi(2) / 2.0).sum();
        let rms = (squares * std::f64::consts::PI * (m / k).sqrt() / end).sqrt();
        assert!((found.rms.unwrap() / rms - 1.0).abs() < 1e-2, "{found:?} {rms}");
        assert!(tally.trace.iter().all(|(_, force)| *force >= 0.0) && !tally.trace.is_empty());
    }

    #[test]
    fn against_a_wall_that_is_rested_on_the_impulse_is_not_known() {
        let wall = Rig { m2: f64::INFINITY, gap: -5e-4, ..Rig::thesis() };
        let start = Simulation::at_rest(&wall);
        let sine = Excitation::Sine(Sine { force: 0.01, frequency: 2.0 });
        let mut motion = Simulation::from_state(&wall, &sine, start, 0.0).unwrap();
        let mut tally = Tally::new(&motion, 0.0);
        Motion::advance(&mut motion, 1.0, &mut |piece| tally.take(&piece)).unwrap();
        assert_eq!(tally.read(2), Reaction { peak: None, rms: None, impulse: None });
    }
}

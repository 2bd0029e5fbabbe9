//! Exact flight between impacts, and the first contact at its end.

mod hop;

use super::waves::Waves;
use serde::Serialize;
use vibro_math::Oscillator;
use vibro_math::root::{Bent, Limits, first_landing};

/// Displacements in m and velocities in m/s of both masses, each from its own rest.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
pub struct State {
    /// Displacement of the excited mass in m.
    pub x1: f64,
    /// Velocity of the excited mass in m/s.
    pub v1: f64,
    /// Displacement of the passive mass in m.
    pub x2: f64,
    /// Velocity of the passive mass in m/s.
    pub v2: f64,
}

impl State {
    /// Both masses at rest in their own rest positions.
    pub const REST: State = State { x1: 0.0, v1: 0.0, x2: 0.0, v2: 0.0 };

    /// The state of x₁, v₁, x₂, v₂.
    #[inline]
    pub(super) fn of([x1, v1, x2, v2]: [f64; 4]) -> State {
        State { x1, v1, x2, v2 }
    }

    /// x₁, v₁, x₂, v₂.
    #[inline]
    pub(super) fn array(&self) -> [f64; 4] {
        [self.x1, self.v1, self.x2, self.v2]
    }

    /// Approach speed vᵣ = v₁ − v₂ in m/s.
    pub fn approach(&self) -> f64 {
        self.v1 - self.v2
    }
}

/// Free part of one mass' motion: displacement in m and velocity in m/s at the flight's start.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Free {
    pub oscillator: Oscillator,
    pub x: f64,
    pub v: f64,
}

impl Free {
    /// Displacement and its first five derivatives at `t`.
    #[inline]
    pub(super) fn series(&self, t: f64) -> [f64; 6] {
        let (x, v) = if t == 0.0 { (self.x, self.v) } else { self.oscillator.free(self.x, self.v, t) };
        let a = self.oscillator.acceleration(x, v);
        let jerk = self.oscillator.acceleration(v, a);
        let snap = self.oscillator.acceleration(a, jerk);
        [x, v, a, jerk, snap, self.oscillator.acceleration(jerk, snap)]
    }
}

/// Change of a displacement in a step `h` (s), and the velocity after it, by Taylor's series.
#[inline]
fn ahead_of(terms: &[f64; 6], h: f64) -> (f64, f64) {
    let [_, v, a, jerk, snap, fifth] = *terms;
    let x = h * (v + h / 2.0 * (a + h / 3.0 * (jerk + h / 4.0 * (snap + h / 5.0 * fifth))));
    (x, v + h * (a + h / 2.0 * (jerk + h / 3.0 * (snap + h / 4.0 * fifth))))
}

/// First contact of a flight.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Landing {
    /// Time in s from the flight's start.
    pub time: f64,
    /// State just before the impact.
    pub state: State,
}

/// Motion of both masses without contact, in closed form; time counts from the flight's start.
///
/// x₁ = P/k₁ + Σ Re(Xe^{iωt}) + free motion, x₂ = free motion, under a constant force P and sine forces. No
/// step size: any time is evaluated at once.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Flight {
    /// Forced displacement of mass 1.
    pub(super) waves: Waves,
    /// Where mass 1 would rest under the constant force, in m.
    pub(super) rest: f64,
    /// Gap in m with both masses in their rest positions.
    pub(super) gap: f64,
    pub(super) free: [Free; 2],
    /// Time in s up to which parting masses are known to be apart; 0 for other flights.
    pub(super) open: f64,
}

impl Flight {
    /// Flight from `state` with forced motion `waves` about `rest` (m) of mass 1.
    #[inline]
    pub(super) fn with(
        oscillators: [Oscillator; 2],
        waves: Waves,
        rest: f64,
        gap: f64,
        state: &State,
    ) -> Flight {
        let [x, v, ..] = waves.at(0.0);
        Flight::of(oscillators, waves, rest, gap, [(state.x1 - x - rest, state.v1 - v), (state.x2, state.v2)])
    }

    /// Flight with these free parts, displacement and velocity, on top of the forced motion about `rest` (m)
    /// of mass 1.
    pub(super) fn of(
        oscillators: [Oscillator; 2],
        waves: Waves,
        rest: f64,
        gap: f64,
        free: [(f64, f64); 2],
    ) -> Flight {
        let part = |i: usize| Free { oscillator: oscillators[i], x: free[i].0, v: free[i].1 };
        Flight { waves, rest, gap, free: [part(0), part(1)], open: 0.0 }
    }

    /// The same flight for masses that part from rest against each other. No contact is searched for while
    /// the gap is known to open: the rounding error of so small a gap could pass for a contact.
    ///
    /// With g = ġ = 0 at the start and a bound M₄ on the fourth derivative, g ≥ g̈t²/2 + g⃛t³/6 − M₄t⁴/24:
    /// above 0 up to its root. After a release g̈ is 0 as well: the gap opens like t³ and stays below its
    /// rounding error for a long time.
    pub(super) fn parting(mut self) -> Flight {
        let [[_, _, a1, j1, ..], [_, _, a2, j2, ..]] = self.series(0.0);
        let bound = |i: usize| {
            self.free[i].oscillator.bound(self.free[i].series(0.0)[4], self.free[i].series(0.0)[5])
        };
        let fourth = bound(1) + self.waves.limits.snap + bound(0);
        let (bend, jerk) = ((a2 - a1).max(0.0), j2 - j1);
        let root = (jerk / 6.0 + (jerk * jerk / 36.0 + fourth * bend / 12.0).sqrt()) / (fourth / 12.0);
        // Half the root, where the lower bound of the gap is still above an eighth of its leading term.
        if root.is_finite() {
            self.open = root / 2.0;
        }
        self
    }

    /// Both displacements with their first five derivatives.
    #[inline]
    pub(super) fn series(&self, t: f64) -> [[f64; 6]; 2] {
        let mut first = self.free[0].series(t);
        for (sum, term) in first.iter_mut().zip(self.waves.at(t)) {
            *sum += term;
        }
        first[0] += self.rest;
        [first, self.free[1].series(t)]
    }

    /// State at `t` ≥ 0.
    #[inline]
    pub fn state(&self, t: f64) -> State {
        let [[x1, v1, ..], [x2, v2, ..]] = self.series(t);
        State { x1, v1, x2, v2 }
    }

    /// Gap in m at `t`; negative where the flight, continued past a contact, lets the masses overlap.
    pub fn gap(&self, t: f64) -> f64 {
        let [[x1, ..], [x2, ..]] = self.series(t);
        self.gap + x2 - x1
    }

    /// Rate of change of the state at `t`.
    pub fn rate(&self, t: f64) -> [f64; 4] {
        let [[_, v1, a1, ..], [_, v2, a2, ..]] = self.series(t);
        [v1, a1, v2, a2]
    }

    /// Rounding error of a computed gap in m: a few ε of the largest term.
    pub fn noise(&self) -> f64 {
        2.0 * f64::EPSILON * (self.gap.abs() + self.rest.abs() + self.reach())
    }

    /// First contact in `0..=duration`, with the state there: the gap falls to zero. No contact can be missed
    /// (see [`vibro_math::root`]).
    #[inline]
    pub(super) fn land(&self, duration: f64) -> Option<Landing> {
        if self.open > duration {
            return None;
        }
        let mut last = [[0.0; 6]; 2];
        // Rounding error of the gap in m: a quarter ε of the terms that are summed.
        let rounding = 0.25
            * f64::EPSILON
            * (self.gap.abs() + self.waves.amplitude + self.free[0].x.abs() + self.free[1].x.abs());
        if self.open == 0.0
            && let Some(landing) = self.hop(duration, rounding)
        {
            return Some(landing);
        }
        let (at, mut ahead) = first_landing(
            self.open,
            duration,
            rounding,
            |t| {
                last = self.series(t);
                let [first, second] = &last;
                Bent {
                    value: self.gap + second[0] - first[0],
                    slope: second[1] - first[1],
                    bend: second[2] - first[2],
                    jerk: second[3] - first[3],
                }
            },
            |t| {
                let (limits, free) = self.limits(t);
                // Without limits the search ends: the motion cannot reach contact any more. At the start this
                // is not checked, since most flights end in contact.
                let reach = self.waves.amplitude + free;
                (t == self.open || self.gap - self.rest <= reach).then_some(limits)
            },
        )?;
        // Two Newton steps on the series: the root of the parabola is in error by the cube of the step.
        let start = self.gap + (last[1][0] - last[0][0]);
        for _ in 0..2 {
            if ahead > 0.0 {
                let [(x1, v1), (x2, v2)] = last.map(|terms| ahead_of(&terms, ahead));
                ahead += (start + (x2 - x1)) / (v1 - v2);
            }
        }
        let [(x1, v1), (x2, v2)] = last.map(|terms| ahead_of(&terms, ahead));
        let state = State { x1: last[0][0] + x1, v1, x2: last[1][0] + x2, v2 };
        Some(Landing { time: at + ahead, state })
    }

    /// Bounds on the derivatives of the gap from `t` on, and on the sum of the free displacements in m.
    fn limits(&self, t: f64) -> (Limits, f64) {
        let (mut limits, mut reach) = (self.waves.limits, 0.0);
        for part in &self.free {
            let [x, v, a, jerk, ..] = part.series(t);
            let (curvature, gain) = (part.oscillator.bound(a, jerk), part.oscillator.gain());
            let snap = curvature * gain * gain;
            limits.curvature += curvature;
            limits.jerk += curvature * gain;
            limits.snap += snap;
            limits.sixth += snap * gain * gain;
            reach += part.oscillator.bound(x, v);
        }
        (limits, reach)
    }

    /// A bound on |x₁ − x₂| for the whole flight, in m, about the rest positions.
    fn reach(&self) -> f64 {
        let free: f64 = self.free.iter().map(|part| part.oscillator.bound(part.x, part.v)).sum();
        self.waves.amplitude + free
    }
}

#[cfg(test)]
pub(crate) mod tests;

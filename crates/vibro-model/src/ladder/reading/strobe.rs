//! The state of a motion once a cycle: whether it repeats, and how far it still goes.

use crate::{Motion, State};
use std::f64::consts::TAU;

/// Longest pattern looked for, in cycles.
const LONGEST: usize = 32;
/// Differences below this part of the state are roundings and what integrators leave.
const ROUNDING: f64 = 1e-11;

/// States at the ends of cycles: x₁, v₁/ω, x₂, v₂/ω in m.
pub struct Strobe {
    states: Vec<[f64; 4]>,
    omega: f64,
    gap: f64,
    block: usize,
}

impl Strobe {
    /// Of `motion`, looked at in blocks of this many cycles.
    pub fn new(motion: &impl Motion, block: usize) -> Strobe {
        Strobe { states: Vec::new(), omega: TAU * motion.frequency(), gap: motion.rig().gap, block }
    }

    /// Takes the state at the end of a cycle.
    pub fn take(&mut self, state: &State) {
        self.states.push([state.x1, state.v1 / self.omega, state.x2, state.v2 / self.omega]);
    }

    /// The cycles of the last block but `before`.
    fn last(&self, before: usize) -> std::ops::Range<usize> {
        let end = self.states.len() - before * self.block;
        end - self.block..end
    }

    /// Whether the masses were in contact at the end of each cycle of the last block.
    pub fn pressed(&self) -> bool {
        let sizes = self.sizes();
        let noise = ROUNDING * (sizes[0] + sizes[1] + self.gap.abs());
        self.states[self.last(0)].iter().all(|s| s[0] - s[2] >= self.gap - noise)
    }

    /// How far the masses together still go, in m, where that is the part `fine` of what each moves at most; `None` where it is more, or
    /// cannot be told.
    ///
    /// What falls by the ratio ρ from one repetition to the next has dρ/(1 − ρ) of its last step d before it. Steps are the largest of a
    /// block, and ρ is taken from those of the block before: so that neither beats nor a turning point look like the end.
    pub fn left(&self, fine: f64) -> Option<f64> {
        (1..=LONGEST).find_map(|q| self.left_over(q, fine))
    }

    /// The same for what repeats in `q` cycles.
    fn left_over(&self, q: usize, fine: f64) -> Option<f64> {
        if self.states.len() < 2 * self.block + q {
            return None;
        }
        let sizes = self.sizes();
        let largest = sizes[0].max(sizes[1]);
        let allowed = sizes.map(|size| fine * size.max(super::NOTHING * largest));
        // Most patterns are turned down by the last cycle alone.
        let end = self.states.len();
        if (0..2).any(|mass| self.step(end - 1..end, q, mass) > allowed[mass]) {
            return None;
        }
        let mut all = 0.0;
        for (mass, allowed) in allowed.into_iter().enumerate() {
            let [last, before] = [0, 1].map(|n| self.step(self.last(n), q, mass));
            let left = if last <= ROUNDING * largest {
                last
            } else {
                let fallen = (last / before).powf(q as f64 / self.block as f64);
                if fallen >= 1.0 {
                    return None;
                }
                last * (fallen / (1.0 - fallen)).max(1.0)
            };
            if left > allowed {
                return None;
            }
            all += left;
        }
        Some(all)
    }

    /// The largest way of a mass in `q` cycles.
    fn step(&self, range: std::ops::Range<usize>, q: usize, mass: usize) -> f64 {
        let way = |i: usize| {
            let (a, b) = (&self.states[i], &self.states[i - q]);
            (a[2 * mass] - b[2 * mass]).hypot(a[2 * mass + 1] - b[2 * mass + 1])
        };
        range.map(way).fold(0.0, f64::max)
    }

    /// The largest state of each mass over the last block.
    fn sizes(&self) -> [f64; 2] {
        [0, 1].map(|mass| {
            let size = |s: &[f64; 4]| s[2 * mass].hypot(s[2 * mass + 1]);
            self.states[self.last(0)].iter().map(size).fold(0.0, f64::max)
        })
    }
}

//! What ends a stage of the motion when it falls to zero.

use super::mode::{DEEPEST, LENGTH, Mode, Row, dot};

/// A quantity linear in the coordinates, and its rate.
#[derive(Debug, Clone, Copy)]
pub struct Guard {
    weights: Row,
    rate: Row,
    /// A rate of this size is rounding.
    noise: f64,
}

impl Guard {
    /// The quantity of these `weights` in a mode.
    pub fn new(mode: &Mode, weights: Row) -> Guard {
        let rate = mode.rate(&weights);
        // Rounding of displacements of 1 mm and of speeds of 0.1 m/s.
        let size = [LENGTH, 0.1, LENGTH, 0.1, 1.0, 1.0, 1.0];
        let noise = 1e-14 * rate.iter().zip(size).map(|(r, s)| r.abs() * s).sum::<f64>();
        Guard { weights, rate, noise }
    }

    /// Its value.
    pub fn value(&self, at: &Row) -> f64 {
        dot(&self.weights, at)
    }

    /// Time in s after `time` and state at which it has fallen to zero within the step of this `level`, if it has: a change of
    /// sign, or a dip between two positive ends.
    pub fn fall(
        &self,
        mode: &Mode,
        phase: f64,
        level: usize,
        time: f64,
        ends: [&Row; 2],
    ) -> Option<(f64, [f64; 4])> {
        let falls = |at: &Row| dot(&self.rate, at) < -self.noise;
        let below = |at: &Row| self.value(at) <= 0.0;
        let [first, last] = ends;
        let dips = falls(first) && !falls(last) && !below(first) && !below(last);
        if !dips {
            if !(below(last) && falls(last)) {
                return None;
            }
            return Some(if falls(first) {
                walk(mode, phase, level, time, first, |at| below(at) || !falls(at))
            } else {
                walk(mode, phase, level, time, first, |at| below(at) && falls(at))
            });
        }
        let (after, lowest) = walk(mode, phase, level, time, first, |at| !falls(at));
        below(&mode.coordinates(phase, time + after, &lowest))
            .then(|| walk(mode, phase, level, time, first, |at| below(at) || !falls(at)))
    }
}

/// The last time and state before `over`, which is false at the start and stays true once it is so: by halving.
fn walk(
    mode: &Mode,
    phase: f64,
    level: usize,
    time: f64,
    first: &Row,
    over: impl Fn(&Row) -> bool,
) -> (f64, [f64; 4]) {
    let (mut after, mut at) = (0.0, *first);
    for level in level + 1..=DEEPEST {
        let y = mode.step(level, &at);
        let next = mode.coordinates(phase, time + after + mode.duration(level), &y);
        if !over(&next) {
            after += mode.duration(level);
            at = next;
        }
    }
    (after, [at[0], at[1], at[2], at[3]])
}

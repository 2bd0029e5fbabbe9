//! One linear mode of the rig, carried over steps by matrix exponentials, and what ends it.

use super::super::task::Task;
use nalgebra::SMatrix;
use std::f64::consts::TAU;

/// Coordinates: x₁, v₁, x₂, v₂, cos and sin of the exciting force's phase, 1.
pub const SIZE: usize = 7;
/// Coordinates, or weights of them.
pub type Row = [f64; SIZE];
/// Longest steps in a cycle.
pub const STEPS: usize = 512;
/// Halvings to the shortest step: 2⁻⁴⁶ of 1/5000 s is below the rounding of a time of 0.1 s.
const DEEPEST: usize = 46;
/// Length in m by which displacements are scaled, so that all coordinates are of order 1.
pub const LENGTH: f64 = 1e-3;

/// Masses that push each other by a force that is linear in the coordinates.
pub struct Mode {
    matrix: [Row; SIZE],
    /// Rows of x₁, v₁, x₂, v₂ for the longest step and each halving of it.
    ladder: Vec<[Row; 4]>,
    longest: f64,
    /// Frequency in Hz.
    frequency: f64,
}

/// A quantity linear in the coordinates that ends a stage when it falls to zero, with its rate.
pub struct Guard {
    weights: Row,
    rate: Row,
    /// A rate of this size is rounding.
    noise: f64,
}

/// A time in s at which the exciting force is F₀ cos ωt, and the coordinates there.
pub type Instant = (f64, Row);

impl Mode {
    /// The mode in which the masses push each other by `contact`·coordinates (N), in steps of a 512th of a cycle and of `longest` (s) at most.
    pub fn new(task: &Task, contact: &Row, longest: f64) -> Mode {
        let (rig, omega) = (&task.rig, TAU * task.frequency);
        let mut matrix = [[0.0; SIZE]; SIZE];
        matrix[0][1] = 1.0;
        matrix[1][..2].copy_from_slice(&[-rig.k1 / rig.m1, -rig.c1 / rig.m1]);
        matrix[1][4] = task.force / rig.m1;
        matrix[2][3] = 1.0;
        matrix[3][2..4].copy_from_slice(&[-rig.k2 / rig.m2, -rig.c2 / rig.m2]);
        for (i, force) in contact.iter().enumerate() {
            matrix[1][i] -= force / rig.m1;
            matrix[3][i] += force / rig.m2;
        }
        matrix[4][5] = -omega;
        matrix[5][4] = omega;
        // The exponential is exact to rounding of its largest entries: in units of 1 mm and 1 mm·ω they are alike.
        let speed = LENGTH * omega;
        let unit = [LENGTH, speed, LENGTH, speed, 1.0, 1.0, 1.0];
        let scaled = SMatrix::<f64, SIZE, SIZE>::from_fn(|i, j| matrix[i][j] * unit[j] / unit[i]);
        let longest = longest.min(task.cycle() / STEPS as f64);
        let ladder = (0..=DEEPEST).map(|level| {
            let step = (scaled * (longest * 0.5_f64.powi(level as i32))).exp();
            std::array::from_fn(|i| std::array::from_fn(|j| step[(i, j)] * unit[i] / unit[j]))
        });
        Mode { matrix, ladder: ladder.collect(), longest, frequency: task.frequency }
    }

    /// A time with all coordinates of a state.
    pub fn instant(&self, t: f64, y: &[f64]) -> Instant {
        let (sin, cos) = (TAU * self.frequency * t).sin_cos();
        (t, [y[0], y[1], y[2], y[3], cos, sin, 1.0])
    }

    fn duration(&self, level: usize) -> f64 {
        self.longest * 0.5_f64.powi(level as i32)
    }

    /// A step of this `level`: 0 is the longest, each further one half of it.
    pub fn step(&self, level: usize, (t, at): &Instant) -> Instant {
        self.instant(t + self.duration(level), &self.ladder[level].map(|row| dot(&row, at)))
    }

    /// Weights of the rate of what has these `weights`.
    pub fn rate(&self, weights: &Row) -> Row {
        std::array::from_fn(|j| (0..SIZE).map(|i| weights[i] * self.matrix[i][j]).sum())
    }

    /// The instant `duration` (s) later, by as many of the steps and halvings as fit.
    pub fn after(&self, mut at: Instant, duration: f64) -> Instant {
        let (mut left, mut level) = (duration, 0);
        while level <= DEEPEST {
            if self.duration(level) > left {
                level += 1;
            } else {
                at = self.step(level, &at);
                left -= self.duration(level);
            }
        }
        at
    }

    /// The first of the guards that falls to zero before `until`, and the instant; steps begin short, and are doubled one after another.
    pub fn next(&self, guards: &[&Guard], mut at: Instant, until: f64) -> Option<(usize, Instant)> {
        let mut level = DEEPEST;
        while at.0 < until {
            let then = self.step(level, &at);
            let fallen =
                guards.iter().enumerate().filter_map(|(i, g)| Some((i, g.fall(self, level, &at, &then)?)));
            if let Some(first) = fallen.min_by(|a, b| a.1.0.total_cmp(&b.1.0)) {
                return Some(first);
            }
            (at, level) = (then, level.saturating_sub(1));
        }
        None
    }
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

    /// The instant at which it has fallen to zero within a step from `first` to `last`, if it has: a change of sign, or a dip between two
    /// positive ends. By halving: the last instant before what is false at the start and true from there on.
    fn fall(&self, mode: &Mode, level: usize, first: &Instant, last: &Instant) -> Option<Instant> {
        let falls = |at: &Instant| dot(&self.rate, &at.1) < -self.noise;
        let below = |at: &Instant| self.value(&at.1) <= 0.0;
        let (falling, fallen) = (falls(first), below(last) && falls(last));
        if !fallen && (!falling || falls(last) || below(first) || below(last)) {
            return None;
        }
        let over = |at: &Instant| if falling { below(at) || !falls(at) } else { below(at) && falls(at) };
        let mut at = *first;
        for level in level + 1..=DEEPEST {
            let next = mode.step(level, &at);
            if !over(&next) {
                at = next;
            }
        }
        (fallen || below(&mode.step(DEEPEST, &at))).then_some(at)
    }
}

/// Sum of products.
fn dot(weights: &Row, coordinates: &Row) -> f64 {
    weights.iter().zip(coordinates).map(|(w, c)| w * c).sum()
}

//! One linear mode of the rig, carried over steps by matrix exponentials.

use std::f64::consts::TAU;

use nalgebra::SMatrix;

use super::super::task::Task;

/// Coordinates: x₁, v₁, x₂, v₂, cos and sin of the exciting force's phase, 1.
pub const SIZE: usize = 7;
/// Weights of the coordinates.
pub type Row = [f64; SIZE];
/// Longest steps in a cycle.
const STEPS: f64 = 512.0;
/// Halvings to the shortest step: 2⁻⁴⁶ of 1/5000 s is below the rounding of a time of 0.1 s.
pub(crate) const DEEPEST: usize = 46;
/// Length in m by which displacements are scaled, so that all coordinates are of order 1.
pub const LENGTH: f64 = 1e-3;

/// Masses that push each other by a force that is linear in the coordinates.
#[derive(Debug, Clone)]
pub struct Mode {
    matrix: [Row; SIZE],
    /// Rows of x₁, v₁, x₂, v₂ for the longest step and each halving of it.
    ladder: Vec<[Row; 4]>,
    longest: f64,
    /// Frequency in Hz.
    frequency: f64,
}

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
        let longest = longest.min(task.cycle() / STEPS);
        let ladder = (0..=DEEPEST).map(|level| {
            let step = (scaled * (longest * 0.5_f64.powi(level as i32))).exp();
            std::array::from_fn(|i| std::array::from_fn(|j| step[(i, j)] * unit[i] / unit[j]))
        });
        Mode { matrix, ladder: ladder.collect(), longest, frequency: task.frequency }
    }

    /// Duration in s of a step of this `level`.
    pub fn duration(&self, level: usize) -> f64 {
        self.longest * 0.5_f64.powi(level as i32)
    }

    /// Steps of level 0 in a cycle where nothing shortens them.
    #[cfg(test)]
    pub fn steps() -> usize {
        STEPS as usize
    }

    /// All coordinates of a state at `time`, the force being F₀ cos(phase) at time 0.
    pub fn coordinates(&self, phase: f64, time: f64, y: &[f64; 4]) -> Row {
        let (sin, cos) = (TAU * self.frequency * time + phase).sin_cos();
        [y[0], y[1], y[2], y[3], cos, sin, 1.0]
    }

    /// State after a step of this `level`.
    pub fn step(&self, level: usize, from: &Row) -> [f64; 4] {
        self.ladder[level].map(|row| dot(&row, from))
    }

    /// Weights of the rate of what has these `weights`.
    pub fn rate(&self, weights: &Row) -> Row {
        std::array::from_fn(|j| (0..SIZE).map(|i| weights[i] * self.matrix[i][j]).sum())
    }

    /// State `duration` (s) later, by as many of its steps and halvings as fit.
    pub fn after(&self, phase: f64, time: f64, y: [f64; 4], duration: f64) -> [f64; 4] {
        let (mut done, mut y, mut level) = (0.0, y, 0);
        while level <= DEEPEST {
            if done + self.duration(level) > duration {
                level += 1;
                continue;
            }
            y = self.step(level, &self.coordinates(phase, time + done, &y));
            done += self.duration(level);
        }
        y
    }
}

/// Sum of products.
pub fn dot(weights: &Row, coordinates: &Row) -> f64 {
    weights.iter().zip(coordinates).map(|(w, c)| w * c).sum()
}

//! Motions that repeat, by their definition: after a period the masses meet again as they met.

use std::f64::consts::TAU;

use nalgebra::{Matrix4, Vector4};

use super::super::rivals::Spring;
use super::super::task::Task;
use super::course::{Course, Met, Start};
use super::mode::LENGTH;

/// Rounds of Newton's method.
const ROUNDS: usize = 30;
/// Change of the unknowns for a derivative, in units of 1 mm, 1 mm·ω and 1 rad: half the digits.
const SMALL: f64 = 1e-7;
/// A motion closes where it misses by no more than this in these units: rounding of a few hundred steps, enlarged by what near grazing
/// does so.
const CLOSED: f64 = 1e-9;

/// What is left of the start, relative, where Newton's method takes over.
const NEARLY: f64 = 1e-3;

/// A motion with one impact a period, as the masses meet.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Repeats {
    /// State at the first touch.
    pub before: [f64; 4],
    /// Phase in rad of the exciting force there.
    pub phase: f64,
}

impl Repeats {
    /// Approach speed in m/s.
    pub fn speed(&self) -> f64 {
        self.before[1] - self.before[3]
    }
}

/// The motion with one impact in `period` (s) of a task, with impacts at once or a contact, that Newton's method reaches from `guess`.
pub fn repeats(task: &Task, contact: Option<&Spring>, period: f64, guess: &Repeats) -> Option<Repeats> {
    let course = Course::new(task, contact);
    let speed = LENGTH * TAU * task.frequency;
    let state = |u: &Vector4<f64>| -> ([f64; 4], f64) {
        let x1 = u[0] * LENGTH;
        ([x1, u[1] * speed, x1 - task.rig.gap, u[2] * speed], u[3])
    };
    let missed = |u: &Vector4<f64>| -> Option<Vector4<f64>> {
        let (y, phase) = state(u);
        let mut found = None;
        let far = 1.5 * period;
        course
            .run(phase, Start::Meeting(y), far, &mut |met| {
                if let Met::Impact(time, before) = met {
                    found = Some((*time, *before));
                }
                found.is_none()
            })
            .ok()?;
        let (time, then) = found?;
        Some(Vector4::new(
            (then[0] - y[0]) / LENGTH,
            (then[1] - y[1]) / speed,
            (then[3] - y[3]) / speed,
            TAU * task.frequency * (time - period),
        ))
    };
    let y = guess.before;
    let mut u = Vector4::new(y[0] / LENGTH, y[1] / speed, y[3] / speed, guess.phase);
    let mut off = missed(&u)?;
    for _ in 0..ROUNDS {
        let mut slope = Matrix4::zeros();
        for i in 0..4 {
            let (mut up, mut down) = (u, u);
            up[i] += SMALL;
            down[i] -= SMALL;
            slope.set_column(i, &((missed(&up)? - missed(&down)?) / (2.0 * SMALL)));
        }
        let step = slope.lu().solve(&off)?;
        // Half the way, and half of that, where the whole leads further off.
        let nearer = (0..8).find_map(|halvings| {
            let tried = u - step * 0.5_f64.powi(halvings);
            let missed = missed(&tried)?;
            (missed.norm() < off.norm()).then_some((tried, missed))
        });
        // Until rounding is all that is left.
        let Some(nearer) = nearer else { break };
        (u, off) = nearer;
    }
    let (before, phase) = state(&u);
    (off.amax() < CLOSED).then_some(Repeats { before, phase: phase.rem_euclid(TAU) })
}

/// The motion with one impact a cycle on which a task settles within so many `cycles`, if it does.
///
/// # Errors
/// As [`Course::run`].
pub fn settled(task: &Task, contact: Option<&Spring>, cycles: f64) -> Result<Option<Repeats>, String> {
    let mut last: Vec<(f64, [f64; 4])> = Vec::new();
    let until = cycles * task.cycle();
    Course::new(task, contact).run(task.phase, Start::Free(task.first()), until, &mut |met| {
        if let Met::Impact(time, before) = met
            && *time > until - 10.0 * task.cycle()
        {
            last.push((*time, *before));
        }
        true
    })?;
    let speed = |y: &[f64; 4]| y[1] - y[3];
    let regular = last.len() > 8
        && last.windows(2).all(|w| {
            ((w[1].0 - w[0].0) * task.frequency - 1.0).abs() < NEARLY
                && (speed(&w[1].1) / speed(&w[0].1) - 1.0).abs() < NEARLY
        });
    let Some((time, before)) = last.last().filter(|_| regular) else { return Ok(None) };
    let phase = TAU * task.frequency * time + task.phase;
    Ok(repeats(task, contact, task.cycle(), &Repeats { before: *before, phase }))
}

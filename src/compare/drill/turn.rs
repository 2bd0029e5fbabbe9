//! The model's turn of the measured bodies.

use crate::error::Result;
use crate::measure::chain::{Body, Jump};
use crate::model::drill::{Course, Impact, Machine, Run, Rung, run};

/// Turns of the model that are averaged: a pattern of up to this many turns is whole.
pub const JUDGED: usize = 4;
/// Least scatter of a phase, as a part of that of the whole turn: of few turns it may be too small by chance.
const LEAST_SCATTER: f64 = 0.1;

/// The model as the measurement sees it.
#[derive(Debug, Clone)]
pub struct TurnModel<'a> {
    pub rung: Rung,
    pub course: Course,
    /// Measured bodies, each with its number in the model.
    pub bodies: Vec<(&'a Body, usize)>,
    /// Sign of a velocity in the direction of a blow.
    pub direction: f64,
}

/// Motion of a machine over its mean turn from top dead centre. Its impacts are as the measurement shows
/// them, without duration.
#[derive(Debug, Clone)]
pub struct ModelTurn {
    pub run: Run,
    /// Mean positions in m at even angles from the beginning to the end of a turn, of each measured body.
    positions: Vec<Vec<f64>>,
    /// Jumps of the velocity of each measured body in the first of its turns.
    jumps: Vec<Vec<Jump>>,
}

impl TurnModel<'_> {
    /// Runs a machine.
    ///
    /// # Errors
    /// As [`run`].
    pub fn run(&self, machine: &Machine) -> Result<ModelTurn> {
        let samples = self.bodies.iter().map(|(body, _)| body.instants()).max().unwrap_or(0);
        let mut run = run(machine, self.rung, &Course { samples, ..self.course })?;
        let turns = run.turns.len() as f64;
        let mean = |body: usize| {
            let mut mean = vec![0.0; samples + 1];
            for turn in &run.turns {
                // A turn of a pattern of several does not end where it began.
                let positions = turn.samples.iter().map(|s| s.positions[body]).chain([turn.end[body]]);
                mean.iter_mut().zip(positions).for_each(|(m, x)| *m += x / turns);
            }
            mean
        };
        let positions = self.bodies.iter().map(|(_, body)| mean(*body)).collect();
        let (period, first) = (machine.crank.period(), self.course.turns.saturating_sub(self.course.judged));
        for (k, turn) in run.turns.iter_mut().enumerate() {
            let began = (first + k) as f64 * period;
            turn.impacts = turn.impacts.iter().map(|impact| turn.at_once(impact, began, period)).collect();
            turn.samples.clear();
        }
        let jump = |impact: &Impact, body: usize| {
            let side = impact.interface.bodies().iter().position(|side| *side == Some(body))?;
            let phase = ((impact.time + 0.5 * impact.duration) / period).fract();
            Some(Jump { phase, height: impact.after[side] - impact.before[side] })
        };
        let impacts = || run.turns.first().map_or(&[][..], |turn| &turn.impacts).iter();
        let jumps = |(_, body): &(&Body, usize)| impacts().filter_map(|i| jump(i, *body)).collect();
        Ok(ModelTurn { positions, jumps: self.bodies.iter().map(jumps).collect(), run })
    }

    /// Velocities in m/s in the direction of a blow at the phases of each average, with the pulse `ahead`
    /// turns after top dead centre.
    ///
    /// # Errors
    /// As [`Body::shown`].
    pub fn shown(&self, turn: &ModelTurn, ahead: f64) -> Result<Vec<Vec<f64>>> {
        let motions = turn.positions.iter().zip(&turn.jumps);
        self.bodies.iter().zip(motions).map(|((body, _), (x, jumps))| body.shown(x, jumps, ahead)).collect()
    }

    /// Measured phases of a body's average: a phase that faults hide in every turn has no mean.
    pub fn phases(&self, body: &Body) -> Vec<MeasuredPhase> {
        let all = || {
            body.mean.iter().zip(&body.std).enumerate().filter(|(_, (v, s))| v.is_finite() && s.is_finite())
        };
        let n = all().count().max(1) as f64;
        let least = LEAST_SCATTER * (all().map(|(_, (_, s))| s * s).sum::<f64>() / n).sqrt();
        // Turns that are equal have no scatter to count in.
        let scatter = |s: f64| if least > 0.0 { s.max(least) } else { 1.0 };
        let phase = |(index, (v, s)): (usize, (&f64, &f64))| MeasuredPhase {
            index,
            velocity: self.direction * v,
            scatter: scatter(*s),
        };
        all().map(phase).collect()
    }

    /// Root mean square of measured less a velocity (m/s), and with each phase in units of its scatter.
    pub fn off(&self, body: &Body, velocity: &[f64]) -> [f64; 2] {
        let phases = self.phases(body);
        let mean = |of: &dyn Fn(&MeasuredPhase) -> f64| {
            let sum: f64 = phases.iter().map(|p| ((p.velocity - velocity[p.index]) / of(p)).powi(2)).sum();
            (sum / phases.len() as f64).sqrt()
        };
        [mean(&|_| 1.0), mean(&|phase| phase.scatter)]
    }
}

/// Velocity at a phase of the average.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MeasuredPhase {
    /// Number of the phase.
    pub index: usize,
    /// Mean in m/s, positive in the direction of a blow.
    pub velocity: f64,
    /// Standard deviation from turn to turn in m/s.
    pub scatter: f64,
}

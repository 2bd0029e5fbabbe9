//! The time-synchronous average: all turns over the phase of the turn.

use super::faults::State;
use super::running::Running;
use super::{Phases, crossing};

/// The velocity of one turn at the phases of the average.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cycle<'a> {
    /// Turn, counted from 0 among the whole turns.
    pub number: usize,
    /// Time of its first edge from the first sample, in s.
    pub time: f64,
    /// Turns a second.
    pub speed: f64,
    /// Velocity in m/s at equal steps of the phase from 0 on, smoothed as the average is; NaN where it was not measured.
    pub velocity: &'a [f64],
}

/// What is done with each turn.
pub(super) type Each<'e> = dyn FnMut(&Cycle<'_>) -> vibro_record::Result<()> + 'e;

/// Mean and scatter of a signal at equal phases of the turn.
#[derive(Debug, Clone)]
pub(super) struct Average {
    points: Vec<Running>,
    /// Lowest and highest value at each phase.
    range: Vec<(f64, f64)>,
    row: Vec<f64>,
}

impl Average {
    /// An average at `points` phases, the first at the edge that begins the turn.
    pub fn new(points: usize) -> Average {
        Average {
            points: vec![Running::default(); points],
            range: vec![(f64::INFINITY, f64::NEG_INFINITY); points],
            row: Vec::new(),
        }
    }

    /// Takes the turn from `start` to `end`, in samples of `values`. Phases beside a sample that was not measured are left
    /// out. Gives the velocity at each phase, NaN where it is left out.
    pub fn push(&mut self, values: &[f64], states: &[State], start: f64, end: f64) -> &[f64] {
        self.row.clear();
        let step = (end - start) / self.points.len().max(1) as f64;
        for (k, (point, range)) in self.points.iter_mut().zip(&mut self.range).enumerate() {
            let at = start + k as f64 * step;
            let i = at as usize;
            let good = states.get(i..i + 2).is_some_and(|s| s.iter().all(|s| s.measured()));
            let value = crossing::value(values, at).filter(|v| good && v.is_finite());
            self.row.push(value.unwrap_or(f64::NAN));
            if let Some(v) = value {
                point.push(v);
                *range = (range.0.min(v), range.1.max(v));
            }
        }
        &self.row
    }

    /// What was averaged.
    pub fn phases(self) -> Phases {
        let n = self.points.len() as f64;
        Phases {
            phase: (0..self.points.len()).map(|k| k as f64 / n).collect(),
            mean: self.points.iter().map(Running::mean).collect(),
            std: self.points.iter().map(Running::std).collect(),
            range: self.range,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    #[test]
    fn turns_of_changing_length_fall_on_each_other() {
        let mut average = Average::new(90);
        let edges = [3.3, 1003.9, 1903.1, 3010.0];
        let amplitude = [1.0, 1.1, 1.2];
        let turn = |t: f64| edges.iter().rposition(|e| *e <= t).unwrap_or(0).min(2);
        let values: Vec<f64> = (0..3100)
            .map(|i| {
                let k = turn(f64::from(i));
                let phase = (f64::from(i) - edges[k]) / (edges[k + 1] - edges[k]);
                amplitude[k] * (TAU * phase).sin()
            })
            .collect();
        let mut states = vec![State::Good; values.len()];
        states[1100..1110].fill(State::Bridged);
        for w in edges.windows(2) {
            average.push(&values, &states, w[0], w[1]);
        }
        let counts: Vec<usize> = average.points.iter().map(Running::n).collect();
        let found = average.phases();
        for (k, (phase, (mean, std))) in found.phase.iter().zip(found.mean.iter().zip(&found.std)).enumerate()
        {
            let sine = (TAU * phase).sin();
            let gap =
                (1002.0..1112.0).contains(&(edges[1] + phase * (edges[2] - edges[1]))) && counts[k] == 2;
            let (truth, scatter) =
                if gap { (1.1 * sine, 0.02f64.sqrt() * sine) } else { (1.1 * sine, 0.1 * sine) };
            // A cubic between samples 2π/900 of a period apart: 1e-9, and kinks of the slope where turns meet, 0.4·2π/900/8.
            let near = if k == 0 { 4e-4 } else { 1e-8 };
            assert!((mean - truth).abs() < near, "{phase}: {mean} {truth}");
            assert!((std - scatter.abs()).abs() < near, "{phase}: {std} {scatter}");
        }
        assert!(counts.contains(&2));
    }
}

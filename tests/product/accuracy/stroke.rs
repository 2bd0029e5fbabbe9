//! A striker that goes back and forth once per turn of the crank; its motion is known exactly.
//!
//! Between two impacts its velocity is a straight line from the velocity after the first to the one before
//! the second, minus half a sine. The half sine makes the displacement over this time zero, so that all
//! impacts are at the same place. During a contact the velocity changes from one flight to the next as half a
//! sine. Duration of a turn, phase of the impact and velocities vary from turn to turn.

use crate::drill::noise::ShiftedNoise;
use std::f64::consts::PI;

/// Nominal values, and their standard deviations from turn to turn.
#[derive(Debug, Clone)]
pub struct Machine {
    /// Turns per second.
    pub speed: f64,
    /// Relative standard deviation of the duration of a turn.
    pub speed_scatter: f64,
    /// Phase of the impact in turns after top dead centre.
    pub phase: f64,
    /// Standard deviation of this phase in turns.
    pub phase_scatter: f64,
    /// Velocity before the impact in m/s.
    pub before: f64,
    /// Relative standard deviation of this velocity.
    pub before_scatter: f64,
    /// Velocity after the impact divided by the velocity before it; negative for a rebound.
    pub rebound: f64,
    /// Standard deviation of this quotient.
    pub rebound_scatter: f64,
    /// Duration of the contact in s.
    pub contact: f64,
}

/// One impact of the striker.
#[derive(Debug, Clone, Copy)]
pub struct Struck {
    /// Time of the middle of the contact in s.
    pub time: f64,
    /// Phase in turns after top dead centre.
    pub phase: f64,
    /// Velocity in m/s before the impact, extrapolated to the middle of the contact.
    pub before: f64,
    /// Velocity in m/s after the impact.
    pub after: f64,
}

/// A run of the machine.
#[derive(Debug, Clone)]
pub struct Run {
    /// Times of the top dead centres in s.
    pub edges: Vec<f64>,
    /// Impacts.
    pub impacts: Vec<Struck>,
    /// Duration of a contact in s.
    contact: f64,
}

impl Machine {
    /// A run of `duration` seconds and one or two turns more. The recording begins during the first turn, so
    /// the first top dead centre is before it.
    pub fn run(&self, duration: f64, noise: &mut ShiftedNoise) -> Run {
        let mut edges = vec![-noise.uniform() / self.speed];
        let mut impacts = Vec::new();
        while edges[edges.len() - 1] < duration + 1.0 / self.speed {
            let start = edges[edges.len() - 1];
            let period = (1.0 + self.speed_scatter * noise.normal()) / self.speed;
            let phase = self.phase + self.phase_scatter * noise.normal();
            let before = self.before * (1.0 + self.before_scatter * noise.normal());
            let after = before * (self.rebound + self.rebound_scatter * noise.normal());
            impacts.push(Struck { time: start + phase * period, phase, before, after });
            edges.push(start + period);
        }
        Run { edges, impacts, contact: self.contact }
    }
}

impl Run {
    /// `count` samples of the velocity of the striker in m/s at the sampling `rate` in Hz.
    pub fn velocity(&self, rate: f64, count: usize) -> Vec<f64> {
        let mut k = 0;
        (0..count)
            .map(|i| {
                let t = i as f64 / rate;
                while self.impacts.get(k + 1).is_some_and(|next| t > next.time - 0.5 * self.contact) {
                    k += 1;
                }
                // Contact k is the last that has begun; before the first contact the striker rests.
                let s = (t - self.impacts[k].time) / self.contact;
                if s < -0.5 {
                    return 0.0;
                }
                let blend = 0.5 + 0.5 * (PI * s.min(0.5)).sin();
                let before = if blend < 1.0 { self.flight(k.wrapping_sub(1), t) } else { 0.0 };
                (1.0 - blend) * before + blend * self.flight(k, t)
            })
            .collect()
    }

    /// Velocity in m/s at the time `t` (s) of the flight between impact `k` and the next; 0 without one of
    /// them.
    fn flight(&self, k: usize, t: f64) -> f64 {
        let (Some(from), Some(to)) = (self.impacts.get(k), self.impacts.get(k.wrapping_add(1))) else {
            return 0.0;
        };
        let s = (t - from.time) / (to.time - from.time);
        let half_sine = 0.25 * PI * (from.after + to.before);
        from.after * (1.0 - s) + to.before * s - half_sine * (PI * s).sin()
    }

    /// `count` samples at the sampling `rate` in Hz of a signal with one pulse from 0 to 1 per turn. The
    /// pulse rises within a few samples at the top dead centre and lasts a tenth of a turn.
    pub fn pulse(&self, rate: f64, count: usize) -> Vec<f64> {
        let rise = |samples: f64| 0.5 + 0.5 * (samples / 3.0).tanh();
        let mut k = 0;
        (0..count)
            .map(|i| {
                let t = i as f64 / rate;
                while self.edges.get(k + 2).is_some_and(|e| t > 0.5 * (self.edges[k + 1] + e)) {
                    k += 1;
                }
                let near = [k, k + 1, k + 2]
                    .into_iter()
                    .filter_map(|j| Some((self.edges.get(j)?, self.edges.get(j + 1)?)));
                near.map(|(a, b)| rise((t - a) * rate) - rise((t - a - 0.1 * (b - a)) * rate)).sum()
            })
            .collect()
    }
}

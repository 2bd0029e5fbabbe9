//! What the average turn of a record shows of a known motion.

use super::body::{Body, turn_between};
use crate::drill::{Corner, PART, value};
use std::f64::consts::PI;
use vibro_record::Result;

/// Instants of a known motion to a sample of the record. Turns of a record begin anywhere between two
/// samples, so that its average has them all.
const INSTANTS: usize = 4;
/// Most instants at which a motion is to be known: a fiftieth of a degree between two of them.
const MOST: usize = 20_000;
/// Standard deviations at which the scatter of the impacts' phase ends.
const FAR: f64 = 5.0;
/// Smallest jump of a known motion whose scatter counts, over its largest: a smaller one changes the mean by
/// less than that, wherever it comes.
const LEAST: f64 = 0.05;

/// Jump of the velocity of a known motion.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Jump {
    /// Phase in turns from the beginning of the turn.
    pub phase: f64,
    /// Change of the velocity in m/s.
    pub height: f64,
}

impl Body {
    /// Even instants of a turn at which [`Body::shown`] is to know the motion.
    pub fn instants(&self) -> usize {
        (INSTANTS * self.samples()).min(MOST)
    }

    /// Samples of a turn of the record.
    fn samples(&self) -> usize {
        ((self.rate / self.speed[0]).round() as usize).max(2)
    }

    /// Mean velocity (m/s) at the phases of the average if the body moved through these positions (m), at
    /// even instants from the beginning of a turn, `ahead` turns before the pulse of the crank, to its end.
    /// The end need not be where the turn began: a mean over turns may drift.
    ///
    /// The velocity is sampled, smoothed and averaged like the record. A low-pass without delay stands for
    /// the band of the instrument, where it is known and below half the sampling rate. Impacts whose phase
    /// scatters from turn to turn blur the average, each by its own scatter; `jumps` are those of the motion.
    ///
    /// # Errors
    /// If the turn is too short for the smoothing.
    pub fn shown(&self, positions: &[f64], jumps: &[Jump], ahead: f64) -> Result<Vec<f64>> {
        let (n, all) = (self.samples(), INSTANTS * self.samples());
        let last = positions.len().saturating_sub(2);
        let position = |i: usize| {
            let at = i as f64 / all as f64 * (last + 1) as f64;
            let k = (at as usize).min(last);
            positions[k] + (at - k as f64) * (positions[k + 1] - positions[k])
        };
        // Means between two instants: an impact between them is exact to their distance.
        let velocity = |i: usize| (position(i % all + 1) - position(i % all)) * all as f64 * self.speed[0];
        let mut mean = vec![0.0; self.phase.len()];
        for first in 0..INSTANTS {
            // Three turns, so that the smoothing of the middle one sees its neighbours.
            let turns: Vec<f64> = (0..3 * n).map(|k| velocity(first + INSTANTS * k)).collect();
            let rate = n as f64 * self.speed[0];
            let band = self.instrument.filter(|highest| *highest < 0.5 * rate).map(Corner::ZeroPhaseLowPass);
            let smooth = |turns: Vec<f64>, corner: Corner| corner.smooth(&turns, rate);
            let turns = [band, self.smoothing].into_iter().flatten().try_fold(turns, smooth)?;
            let offset = (first as f64 + 0.5) / INSTANTS as f64;
            for (mean, phase) in mean.iter_mut().zip(&self.phase) {
                let at = (phase + ahead).rem_euclid(1.0) + 1.0;
                *mean += value(&turns, at * n as f64 - offset).unwrap_or(f64::NAN) / INSTANTS as f64;
            }
        }
        Ok(blurred(&mean, &self.scatters(jumps, ahead)))
    }

    /// Scatter from turn to turn of each phase, in turns: that of the nearest impact. Where the impact is too
    /// small to be found, it follows from the scatter s of the velocity around it: a jump J whose phase
    /// scatters normally by σ has ∫s²dφ = J²σ/√π.
    fn scatters(&self, jumps: &[Jump], ahead: f64) -> Vec<f64> {
        let largest = jumps.iter().fold(0.0f64, |largest, jump| largest.max(jump.height.abs()));
        let small = jumps.iter().filter(|jump| (LEAST..PART).contains(&(jump.height.abs() / largest)));
        let found = self.hits.iter().map(|hits| (hits.phase[0], Ok(hits.phase[1])));
        let all: Vec<_> = found.chain(small.map(|jump| (jump.phase - ahead, Err(jump.height)))).collect();
        let apart = |phase: f64, k: usize| turn_between(phase, all[k].0).abs();
        let nearest =
            |phase: &f64| (0..all.len()).min_by(|i, j| apart(*phase, *i).total_cmp(&apart(*phase, *j)));
        let nearest: Vec<Option<usize>> = self.phase.iter().map(nearest).collect();
        let scatter = |k: usize| {
            let height = match all[k].1 {
                Ok(std) => return std,
                Err(height) => height,
            };
            let own = self.phase.iter().zip(&self.std).zip(&nearest).filter(|(_, near)| **near == Some(k));
            let own = own.map(|((phase, std), _)| (turn_between(*phase, all[k].0), std * std));
            let own: Vec<(f64, f64)> = own.filter(|(_, square)| square.is_finite()).collect();
            let by_phase = |a: &&(f64, f64), b: &&(f64, f64)| a.0.total_cmp(&b.0);
            // Away from the impact, at the ends, the velocity itself scatters.
            let ends = own.iter().min_by(by_phase).zip(own.iter().max_by(by_phase));
            let own_scatter = ends.map_or(0.0, |(first, last)| 0.5 * (first.1 + last.1));
            let sum: f64 = own.iter().map(|(_, square)| square - own_scatter).sum();
            PI.sqrt() * sum.max(0.0) / self.phase.len() as f64 / (height * height)
        };
        let scatters: Vec<f64> = (0..all.len()).map(scatter).collect();
        nearest.into_iter().map(|k| k.map_or(0.0, |k| scatters[k])).collect()
    }
}

/// Mean of turns whose instants scatter normally by `scatters` at each phase, in turns.
fn blurred(turn: &[f64], scatters: &[f64]) -> Vec<f64> {
    let n = turn.len();
    let blurred = |(i, scatter): (usize, &f64)| {
        let std = scatter * n as f64;
        let reach = ((FAR * std) as usize).min(n / 2);
        let weighted = (0..=2 * reach).map(|k| {
            let z = (k as f64 - reach as f64) / std.max(f64::MIN_POSITIVE);
            let weight = (-0.5 * z * z).exp();
            [weight, weight * turn[(i + n + k - reach) % n]]
        });
        let [weight, sum] = weighted.fold([0.0; 2], |[a, b], [weight, value]| [a + weight, b + value]);
        sum / weight
    };
    scatters.iter().enumerate().map(blurred).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::chain::Hits;
    use std::f64::consts::TAU;
    use vibro_math::Noise;

    /// A body at 45 turns a second without impacts, with 720 phases.
    fn body() -> Body {
        let n = 720;
        Body {
            record: String::new(),
            name: String::new(),
            mass: None,
            speed: [45.0, 0.0],
            crank: true,
            rate: 1e5,
            instrument: None,
            smoothing: None,
            turns: 30,
            hits: Vec::new(),
            phase: (0..n).map(|i| f64::from(i) / f64::from(n)).collect(),
            mean: Vec::new(),
            std: Vec::new(),
            displacement: Vec::new(),
        }
    }

    #[test]
    fn a_smooth_motion_is_shown_as_it_is() {
        let body = body();
        // The instants of another record: they need not be those of this one.
        let all = body.instants() + 7;
        // A mean of turns drifts by what the last of them is ahead of the first.
        let drift = 2.0;
        let position = |i: usize| {
            let part = i as f64 / all as f64;
            (TAU * part).sin() + drift * part
        };
        let positions: Vec<f64> = (0..=all).map(position).collect();
        // An instrument that passes half of 135 Hz passes 1/(1 + (45/135)⁴) of 45 Hz.
        for (instrument, gain) in [(None, 1.0), (Some(135.0), 81.0 / 82.0), (Some(1e6), 1.0)] {
            let body = Body { instrument, ..body.clone() };
            let shown = body.shown(&positions, &[], 0.3).unwrap();
            for (phase, v) in body.phase.iter().zip(&shown) {
                let expected = 45.0 * (gain * TAU * (TAU * (phase + 0.3)).cos() + drift);
                // The slope of straight lines between 9000 positions errs by half the angle between two.
                assert!(
                    (v - expected).abs() < TAU * 45.0 * 0.5 * TAU / all as f64,
                    "{phase}: {v} {expected}"
                );
            }
        }
    }

    #[test]
    fn each_impact_is_blurred_by_its_own_scatter() {
        // Phases and heights of jumps, and the scatter of their phases. The last is too small to be found:
        // its scatter shows in that of the velocity alone.
        let jumps = [(0.1, -3.4, 0.008), (0.3, 4.0, 0.006), (0.7, -0.6, 0.02)];
        let velocity = |phase: f64| -> f64 {
            jumps.iter().map(|(at, height, _)| if *at <= phase { *height } else { 0.0 }).sum()
        };
        let hit = |(phase, _, std): (f64, f64, f64)| Hits {
            n: 100,
            share: 1.0,
            phase: [phase, std],
            velocities: [0.0; 2],
            covariance: None,
            energy: None,
            given: None,
        };
        let mut body = Body { hits: vec![hit(jumps[0]), hit(jumps[1])], ..body() };
        // Mean and standard deviation of drawn turns.
        let (mut noise, turns) = (Noise::new(1), 2000);
        let mut sums = vec![[0.0; 2]; body.phase.len()];
        for _ in 0..turns {
            let at = jumps.map(|(at, height, std)| (at + std * noise.normal(), height));
            for (sum, phase) in sums.iter_mut().zip(&body.phase) {
                let v: f64 = at.iter().filter(|(at, _)| at <= phase).map(|(_, height)| height).sum();
                *sum = [sum[0] + v, sum[1] + v * v];
            }
        }
        let mean = |sum: &[f64; 2]| sum[0] / f64::from(turns);
        body.std = sums.iter().map(|s| (s[1] / f64::from(turns) - mean(s).powi(2)).max(0.0).sqrt()).collect();
        let all = body.instants();
        let positions: Vec<f64> = (0..=all)
            .scan(0.0, |x, i| {
                let before = *x;
                *x += velocity(i as f64 / all as f64) / (45.0 * all as f64);
                Some(before)
            })
            .collect();
        let jumps = jumps.map(|(phase, height, _)| Jump { phase, height });
        let shown = body.shown(&positions, &jumps, 0.0).unwrap();
        for ((v, sum), std) in shown.iter().zip(&sums).zip(&body.std) {
            // Five standard errors of the mean, and half of a phase of the steepest jump: 1/1440 of a turn at
            // 4 m/s over √(2π) 0.006 turns.
            let error = 5.0 * std / f64::from(turns).sqrt() + 4.0 / (1440.0 * TAU.sqrt() * 0.006);
            assert!((v - mean(sum)).abs() < error, "{v} {} {error}", mean(sum));
        }
    }
}

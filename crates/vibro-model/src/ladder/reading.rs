//! What a motion shows, followed until it has settled.

use super::question::{Answer, Question};
use crate::motion::{Event, Motion};
use crate::observable::Observable;
use crate::regime::{Regime, Strike, Watch};
use crate::rig::Rig;
use crate::sweep::{self, Gauge};
use std::f64::consts::TAU;
use vibro_record::Result;

/// Cycles read at once, or a multiple of them: whole patterns of 1 to 6, 10, 12, 15, 20 and 30 cycles. Of
/// others several blocks are.
const BLOCK: u32 = 60;
/// The multiple at most.
const MULTIPLE: f64 = 50.0;
/// A block lasts this part of the longest time in which free motion falls by e, so that the way to the end is
/// seen in it.
const DECAY: f64 = 0.3;
/// Blocks at most, and at least where a cycle holds many swings of a mass.
const BLOCKS: (usize, usize) = (6, 64);
/// Cycles that a motion is followed for at most.
pub const MOST_CYCLES: f64 = BLOCK as f64 * MULTIPLE * BLOCKS.1 as f64;
/// Blocks at most of motions whose contacts are integrated: no more than can be had in a second or so.
pub const BRIEF: usize = 12;
/// Swings of the faster mass that are followed at most, where that leaves enough blocks: as many as with five
/// in a cycle.
const SWINGS: f64 = 5.0 * 60.0 * 64.0;
/// The motion has settled where what is left of its way is this part of the tolerance, and of no more than
/// this tolerance.
const SETTLED: f64 = 0.02;
/// Of both masses, less than this part of what the larger one does is nothing.
const NOTHING: f64 = 1e-3;
/// Longest pattern of states looked for, in cycles.
const LONGEST: usize = 32;
/// Differences below this part of the state are roundings and what integrators leave.
const ROUNDING: f64 = 1e-11;
/// Standard deviations below its expectation from which von Neumann's ratio tells a drift: of a hundred
/// steady motions less than one.
const DRIFT: f64 = 2.5;

/// What a motion shows.
#[derive(Debug, Clone, PartialEq)]
pub struct Reading {
    pub answer: Answer,
    /// Its pattern over the last block.
    pub regime: Regime,
    /// The last impact of the pattern.
    pub strike: Option<Strike>,
    pub end: Settling,
    /// Cycles followed.
    pub cycles: u32,
    /// Mean over the cycles with impacts of the fastest one's approach speed in m/s, in the last block; 0
    /// without impacts.
    pub speed: f64,
}

/// What a motion that was followed came to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Settling {
    /// It repeats.
    Settled,
    /// The masses stay in contact, and the motion repeats.
    Pressed,
    /// It does not repeat, and its means over long stretches are no different from each other.
    Steady,
    /// Neither: it was not followed for long enough.
    Under,
}

/// How motions are read.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MotionReader {
    pub observable: Observable,
    pub tolerance: f64,
    /// Cycles of a block.
    pub block: u32,
    /// Blocks at most.
    pub blocks: usize,
    /// How far the motion without impacts stays clear of the other mass, in m, where that is known: below 0
    /// there is none. No motion without impacts is taken as settled that may yet come nearer.
    pub clearance: Option<f64>,
}

/// What a block of cycles shows.
struct Block {
    value: [f64; 2],
    /// What it counts beside other blocks.
    weight: f64,
    /// Mean approach speed in m/s.
    speed: f64,
}

impl MotionReader {
    /// For motions of `rig` at `frequency` (Hz).
    pub fn new(rig: &Rig, frequency: f64, question: &Question) -> MotionReader {
        let decays = rig.oscillators().map(|o| o.decay()).into_iter().filter(|b| *b > 0.0);
        let slowest = decays.fold(f64::INFINITY, f64::min);
        let wanted = (DECAY / slowest * frequency / f64::from(BLOCK)).ceil().clamp(1.0, MULTIPLE);
        let block = BLOCK * wanted as u32;
        let swings =
            rig.natural_frequencies().into_iter().filter(|f| f.is_finite()).fold(0.0, f64::max) / frequency;
        let blocks = (SWINGS / (swings * f64::from(block))).clamp(BLOCKS.0 as f64, BLOCKS.1 as f64) as usize;
        let Question { observable, tolerance, .. } = *question;
        MotionReader { observable, tolerance, block, blocks, clearance: None }
    }

    /// The part of the tolerance to which motions settle.
    pub fn fine(&self) -> f64 {
        SETTLED * self.tolerance.min(SETTLED)
    }

    /// Follows `motion` until its state, once a cycle, has nearly come to where it goes, and what is shown of
    /// it holds still; where it does not settle, the second half of all is averaged.
    pub fn read(&self, motion: &mut dyn Motion) -> Result<Reading> {
        let mut blocks: Vec<Block> = Vec::with_capacity(self.blocks);
        let mut watch = Watch::new(motion);
        let mut states = Vec::new();
        loop {
            blocks.push(self.block(motion, &mut watch, &mut states)?);
            let pattern = watch.pattern();
            let n = self.blocks_of(pattern.regime);
            let whole: Vec<[f64; 2]> = blocks.windows(n).map(mean_of).collect();
            let strobe = Strobe { states: &states, block: self.block as usize };
            // Masses that chatter to rest may be in contact at the end of each cycle, too.
            let pressed = pattern.regime == Regime::NoImpact && strobe.pressed(motion.rig().gap);
            let left = (1..=LONGEST).find_map(|q| strobe.left(q, self.fine()));
            // What repeats is followed until three means hold whole patterns.
            let most = if left.is_some() { self.blocks.max(n + 2) } else { self.blocks };
            // Without impacts the motion is that of mass 1 alone, of which it is known how far it goes.
            let free = pattern.regime == Regime::NoImpact && !pressed;
            let apart = |left: f64| !free || self.clearance.is_none_or(|clear| left < clear);
            let settled = left.is_some_and(apart) && still(&whole, self.fine());
            if settled || blocks.len() >= most {
                let half: Vec<[f64; 2]> = blocks[blocks.len() / 2..].iter().map(|b| b.value).collect();
                let end = match pattern.regime {
                    _ if settled && pressed => Settling::Pressed,
                    _ if settled => Settling::Settled,
                    Regime::Irregular | Regime::Chatter { cycles: None } if !drifts(&half) => {
                        Settling::Steady
                    }
                    _ => Settling::Under,
                };
                let exact = whole.last().filter(|_| settled).map(|value| Answer::exact(*value));
                return Ok(Reading {
                    answer: exact.unwrap_or_else(|| mean(&half, end == Settling::Steady)),
                    regime: pattern.regime,
                    strike: pattern.strikes.last().copied(),
                    end,
                    cycles: self.block * blocks.len() as u32,
                    speed: blocks[blocks.len() - 1].speed,
                });
            }
        }
    }

    /// Blocks that hold whole patterns.
    fn blocks_of(&self, regime: Regime) -> usize {
        match regime {
            Regime::Periodic { cycles, .. } | Regime::Chatter { cycles: Some(cycles) } => {
                (1..=cycles).find(|n| (n * self.block).is_multiple_of(cycles)).unwrap_or(1) as usize
            }
            _ => 1,
        }
    }

    /// One block, and the states at the ends of its cycles: x₁, v₁/ω, x₂, v₂/ω in m.
    fn block(&self, motion: &mut dyn Motion, watch: &mut Watch, states: &mut Vec<[f64; 4]>) -> Result<Block> {
        let (observable, frequency) = (self.observable, motion.frequency());
        let omega = TAU * frequency;
        let read = match observable {
            Observable::HalfPeakToPeak => sweep::Observable::Peak,
            _ => sweep::Observable::Fundamental,
        };
        let mut gauge = Gauge::new(read, motion.rig());
        let (mut with, mut speeds, mut impulses) = (0.0, 0.0, 0.0);
        *watch = Watch::new(motion);
        for _ in 0..self.block {
            let (start, phase) = (motion.time(), motion.phase());
            let mut strongest: Option<(f64, f64)> = None;
            motion.advance(start + 1.0 / frequency, &mut |piece| {
                watch.take(&piece);
                if !observable.is_of_impacts() {
                    gauge.take(piece.path, piece.duration, phase + omega * (piece.start - start), omega);
                }
                if let Event::Impact(impact) = piece.event
                    && strongest.is_none_or(|s| impact.approach_velocity > s.0)
                {
                    strongest = Some((impact.approach_velocity, impact.impulse));
                }
            })?;
            gauge.close_cycle();
            let s = motion.state();
            states.push([s.x1, s.v1 / omega, s.x2, s.v2 / omega]);
            if let Some((speed, impulse)) = strongest {
                with += 1.0;
                speeds += speed;
                impulses += impulse;
            }
        }
        let per = |sum: f64| if with > 0.0 { sum / with } else { 0.0 };
        let value = match observable {
            Observable::ImpactSpeed => [per(speeds); 2],
            Observable::Impulse => [per(impulses); 2],
            _ => gauge.read().map(|r| r.0),
        };
        let weight = if observable.is_of_impacts() { with } else { 1.0 };
        Ok(Block { value, weight, speed: per(speeds) })
    }
}

/// The state of a motion once a cycle, looked at in blocks.
struct Strobe<'a> {
    states: &'a [[f64; 4]],
    block: usize,
}

impl Strobe<'_> {
    /// The largest state of each mass over the last block.
    fn sizes(&self) -> [f64; 2] {
        let last = &self.states[self.states.len() - self.block..];
        [0, 2].map(|i| last.iter().map(|s| s[i].hypot(s[i + 1])).fold(0.0, f64::max))
    }

    /// Whether the masses, `gap` (m) apart at rest, were in contact at the end of each cycle of the last
    /// block.
    fn pressed(&self, gap: f64) -> bool {
        let sizes = self.sizes();
        let noise = ROUNDING * (sizes[0] + sizes[1] + gap.abs());
        self.states[self.states.len() - self.block..].iter().all(|s| s[0] - s[2] >= gap - noise)
    }

    /// How far the masses together still go, in m, where the motion repeats in `q` cycles and that is the
    /// part `fine` of what each moves at most; `None` where it is more, or cannot be told.
    ///
    /// What falls by the ratio ρ from one repetition to the next has dρ/(1 − ρ) of its last step d before it.
    /// Steps are the largest of a block, and ρ is taken from those of the block before: so that neither
    /// beats nor a turning point look like the end.
    fn left(&self, q: usize, fine: f64) -> Option<f64> {
        let end = self.states.len();
        if end < 2 * self.block + q {
            return None;
        }
        let sizes = self.sizes();
        let largest = sizes[0].max(sizes[1]);
        // The largest way of a mass in q cycles.
        let step = |range: std::ops::Range<usize>, mass: usize| {
            let i = 2 * mass;
            let way = |(a, b): (&[f64; 4], &[f64; 4])| (a[i] - b[i]).hypot(a[i + 1] - b[i + 1]);
            let before = &self.states[range.start - q..range.end - q];
            self.states[range].iter().zip(before).map(way).fold(0.0, f64::max)
        };
        let allowed = |mass: usize| fine * sizes[mass].max(NOTHING * largest);
        // Most patterns are turned down by the last cycle alone.
        if (0..2).any(|mass| step(end - 1..end, mass) > allowed(mass)) {
            return None;
        }
        let mut all = 0.0;
        for mass in 0..2 {
            let [last, before] = [end, end - self.block].map(|end| step(end - self.block..end, mass));
            let fallen = (last / before).powf(q as f64 / self.block as f64);
            let left = match last <= ROUNDING * largest {
                true => last,
                false if fallen >= 1.0 => return None,
                false => last * (fallen / (1.0 - fallen)).max(1.0),
            };
            if left > allowed(mass) {
                return None;
            }
            all += left;
        }
        Some(all)
    }
}

/// Mean over successive blocks.
fn mean_of(blocks: &[Block]) -> [f64; 2] {
    let all: f64 = blocks.iter().map(|b| b.weight).sum();
    [0, 1].map(|i| {
        let sum: f64 = blocks.iter().map(|b| b.value[i] * b.weight).sum();
        if all > 0.0 { sum / all } else { 0.0 }
    })
}

/// Whether the last of these values is the end of the way: what falls by the ratio ρ a block has ρ/(1 − ρ) of
/// its last step before it.
fn still(values: &[[f64; 2]], fine: f64) -> bool {
    let [.., a, b, c] = values else { return false };
    let largest = c[0].abs().max(c[1].abs());
    (0..2).all(|i| {
        let (before, last) = ((b[i] - a[i]).abs(), (c[i] - b[i]).abs());
        let ratio = if before > 0.0 { (last / before).min(0.999) } else { 0.0 };
        // Two steps that happen to be small are not yet the end: the larger of both counts.
        let left = before.max(last) * (ratio / (1.0 - ratio)).max(1.0);
        left <= fine * c[i].abs().max(NOTHING * largest)
    })
}

/// Mean of several blocks with its standard error: s²(1 + ρ)/(1 − ρ)/n, ρ being their correlation with the
/// next one.
fn mean(values: &[[f64; 2]], steady: bool) -> Answer {
    let n = values.len() as f64;
    let mut answer = Answer { steady, ..Answer::exact([0.0; 2]) };
    for i in 0..2 {
        let (mean, square, eta) = scatter(values, i);
        // η = 2(1 − ρ). Blocks that take turns are not trusted to make the mean better than independent ones
        // would.
        let rho = (1.0 - eta / 2.0).clamp(0.0, 0.99);
        answer.value[i] = mean;
        answer.spread[i] = (square / (n - 1.0) / n * (1.0 + rho) / (1.0 - rho)).sqrt();
    }
    answer
}

/// Whether successive values are nearer to each other than independent ones are: Σ(xᵢ₊₁ − xᵢ)²/Σ(xᵢ − x̄)²
/// has the mean 2 and the variance 4(n − 2)/(n² − 1) for independent ones (J. von Neumann, 1941).
fn drifts(values: &[[f64; 2]]) -> bool {
    let n = values.len() as f64;
    let least = 2.0 - DRIFT * (4.0 * (n - 2.0) / (n * n - 1.0)).sqrt();
    (0..2).any(|i| {
        let (_, square, eta) = scatter(values, i);
        square > 0.0 && eta < least
    })
}

/// Mean, sum of squares about it, and von Neumann's ratio.
fn scatter(values: &[[f64; 2]], i: usize) -> (f64, f64, f64) {
    let mean = values.iter().map(|v| v[i]).sum::<f64>() / values.len() as f64;
    let square: f64 = values.iter().map(|v| (v[i] - mean).powi(2)).sum();
    let steps: f64 = values.windows(2).map(|w| (w[1][i] - w[0][i]).powi(2)).sum();
    (mean, square, if square > 0.0 { steps / square } else { 2.0 })
}

#[cfg(test)]
mod tests;

//! Reads the observable of a motion, which is followed until it has settled.

use super::question::{Answer, Question};
use crate::motion::{Event, Motion};
use crate::observable::Observable;
use crate::regime::{Regime, Strike, Watch};
use crate::rig::Rig;
use crate::sweep::{self, Gauge};
use std::f64::consts::TAU;
use vibro_record::Result;

/// Cycles of a block: it holds whole patterns of 1 to 6, 10, 12, 15, 20 and 30 cycles. Other patterns need
/// several blocks.
const BLOCK: u32 = 60;
/// Most multiples of [`BLOCK`] in a block, for slowly decaying motions.
const MULTIPLE: f64 = 50.0;
/// Shortest block, as a fraction of the longest time constant of the free decay (to 1/e): shorter blocks
/// would not show the remaining decay.
const DECAY: f64 = 0.3;
/// Fewest and most blocks followed; the fewest where a cycle holds many swings of a mass.
const BLOCKS: (usize, usize) = (6, 64);
/// Most cycles for which a motion is followed: 192 000.
pub const MOST_CYCLES: f64 = BLOCK as f64 * MULTIPLE * BLOCKS.1 as f64;
/// Most blocks of motions whose contacts are integrated: about a second of computing.
pub const BRIEF: usize = 12;
/// Most swings of the faster mass that are followed, unless the fewest blocks hold more: 64 blocks of 60
/// cycles with five swings a cycle.
const SWINGS: f64 = 5.0 * 60.0 * 64.0;
/// A motion has settled where its remaining change is below this fraction of the tolerance. For this test a
/// tolerance above 2 % counts as 2 %.
const SETTLED: f64 = 0.02;
/// A mass that moves less than this fraction of the larger motion is judged relative to this fraction of it.
const NOTHING: f64 = 1e-3;
/// Longest pattern that the states are tested for, in cycles.
const LONGEST: usize = 32;
/// Relative difference of states that may come from rounding and from integration errors.
const ROUNDING: f64 = 1e-11;
/// A von Neumann ratio this many standard deviations below its expectation means a drift: fewer than one in
/// a hundred steady motions reach it.
const DRIFT: f64 = 2.5;

/// The observable of a motion, its pattern, and how it ended.
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
    /// Approach speed in m/s of the fastest impact of a cycle, as the mean over the last block's cycles with
    /// impacts; 0 without impacts.
    pub speed: f64,
}

/// State of a motion at the end of its simulation.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Settling {
    /// It repeats periodically.
    Settled,
    /// The masses stay in contact, and the motion repeats periodically.
    Pressed,
    /// It does not repeat, and its block means show no drift.
    Steady,
    /// Not settled, or with a drift: more cycles are needed.
    Under,
}

/// Settings by which motions are followed and read.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MotionReader {
    pub observable: Observable,
    pub tolerance: f64,
    /// Cycles of a block.
    pub block: u32,
    /// Most blocks.
    pub blocks: usize,
    /// Smallest distance in m to mass 2 of the motion without impacts, where it is known; below 0 the masses
    /// would meet. A motion without impacts has settled only if its remaining change is smaller.
    pub clearance: Option<f64>,
}

/// Means over a block of cycles.
struct Block {
    value: [f64; 2],
    /// Weight of the block in means over blocks: the cycles with impacts for impact quantities, else 1.
    weight: f64,
    /// Mean approach speed in m/s.
    speed: f64,
}

impl MotionReader {
    /// Settings for motions of `rig` at `frequency` (Hz).
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

    /// Relative remaining change below which motions count as settled.
    pub fn fine(&self) -> f64 {
        SETTLED * self.tolerance.min(SETTLED)
    }

    /// Follows `motion` until its state once a cycle and its observable have settled. If it does not settle,
    /// the answer is the mean over the second half of the blocks.
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
            // Patterns that repeat are followed until there are three means over whole patterns.
            let most = if left.is_some() { self.blocks.max(n + 2) } else { self.blocks };
            // Without impacts mass 1 moves alone, and its clearance in the steady state is known.
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

    /// Number of blocks that together hold whole patterns.
    fn blocks_of(&self, regime: Regime) -> usize {
        match regime {
            Regime::Periodic { cycles, .. } | Regime::Chatter { cycles: Some(cycles) } => {
                (1..=cycles).find(|n| (n * self.block).is_multiple_of(cycles)).unwrap_or(1) as usize
            }
            _ => 1,
        }
    }

    /// Reads one block, and appends the states at the ends of its cycles: x₁, v₁/ω, x₂, v₂/ω in m.
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

/// The state of a motion once a cycle (stroboscopic), read in blocks.
struct Strobe<'a> {
    states: &'a [[f64; 4]],
    block: usize,
}

impl Strobe<'_> {
    /// Largest size in m of each mass's state, √(x² + (v/ω)²), over the last block.
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

    /// Remaining change in m of both masses together, if the motion repeats in `q` cycles and the change of
    /// each is below the part `fine` of its largest state; `None` if it is more, or the states are too few.
    ///
    /// If the step between repetitions falls by the ratio ρ each time, the remaining change is dρ/(1 − ρ)
    /// with the last step d. Steps are the largest of a block, and ρ is their ratio to those of the block
    /// before, so that neither beats nor a turning point look settled.
    fn left(&self, q: usize, fine: f64) -> Option<f64> {
        let end = self.states.len();
        if end < 2 * self.block + q {
            return None;
        }
        let sizes = self.sizes();
        let largest = sizes[0].max(sizes[1]);
        // Largest step of a mass between repetitions.
        let step = |range: std::ops::Range<usize>, mass: usize| {
            let i = 2 * mass;
            let way = |(a, b): (&[f64; 4], &[f64; 4])| (a[i] - b[i]).hypot(a[i + 1] - b[i + 1]);
            let before = &self.states[range.start - q..range.end - q];
            self.states[range].iter().zip(before).map(way).fold(0.0, f64::max)
        };
        let allowed = |mass: usize| fine * sizes[mass].max(NOTHING * largest);
        // A quick test: the last cycle alone rules out most patterns.
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

/// Mean over successive blocks, with their weights.
fn mean_of(blocks: &[Block]) -> [f64; 2] {
    let all: f64 = blocks.iter().map(|b| b.weight).sum();
    [0, 1].map(|i| {
        let sum: f64 = blocks.iter().map(|b| b.value[i] * b.weight).sum();
        if all > 0.0 { sum / all } else { 0.0 }
    })
}

/// Whether the last three values have settled: if steps fall by the ratio ρ from block to block, the
/// remaining change is ρ/(1 − ρ) times the last step.
fn still(values: &[[f64; 2]], fine: f64) -> bool {
    let [.., a, b, c] = values else { return false };
    let largest = c[0].abs().max(c[1].abs());
    (0..2).all(|i| {
        let (before, last) = ((b[i] - a[i]).abs(), (c[i] - b[i]).abs());
        let ratio = if before > 0.0 { (last / before).min(0.999) } else { 0.0 };
        // One of two steps may be small by chance: the larger one counts.
        let left = before.max(last) * (ratio / (1.0 - ratio)).max(1.0);
        left <= fine * c[i].abs().max(NOTHING * largest)
    })
}

/// Mean of several blocks with its standard error, √(s²(1 + ρ)/((1 − ρ)n)), with the correlation ρ of
/// neighbouring blocks.
fn mean(values: &[[f64; 2]], steady: bool) -> Answer {
    let n = values.len() as f64;
    let mut answer = Answer { steady, ..Answer::exact([0.0; 2]) };
    for i in 0..2 {
        let (mean, square, eta) = scatter(values, i);
        // η = 2(1 − ρ). Alternating blocks (ρ < 0) count as independent: they must not make the error look
        // smaller.
        let rho = (1.0 - eta / 2.0).clamp(0.0, 0.99);
        answer.value[i] = mean;
        answer.spread[i] = (square / (n - 1.0) / n * (1.0 + rho) / (1.0 - rho)).sqrt();
    }
    answer
}

/// Whether the values drift: neighbours differ less than independent values would. Their von Neumann ratio
/// η = Σ(xᵢ₊₁ − xᵢ)²/Σ(xᵢ − x̄)² has the mean 2 and the variance 4(n − 2)/(n² − 1) (J. von Neumann, 1941).
fn drifts(values: &[[f64; 2]]) -> bool {
    let n = values.len() as f64;
    let least = 2.0 - DRIFT * (4.0 * (n - 2.0) / (n * n - 1.0)).sqrt();
    (0..2).any(|i| {
        let (_, square, eta) = scatter(values, i);
        square > 0.0 && eta < least
    })
}

/// Mean, sum of squared deviations, and von Neumann's ratio (2, as if independent, where all are equal).
fn scatter(values: &[[f64; 2]], i: usize) -> (f64, f64, f64) {
    let mean = values.iter().map(|v| v[i]).sum::<f64>() / values.len() as f64;
    let square: f64 = values.iter().map(|v| (v[i] - mean).powi(2)).sum();
    let steps: f64 = values.windows(2).map(|w| (w[1][i] - w[0][i]).powi(2)).sum();
    (mean, square, if square > 0.0 { steps / square } else { 2.0 })
}

#[cfg(test)]
mod tests;

//! What a motion shows, followed until it has settled.

use super::Question;
use super::change::Answer;
use crate::error::Result;
use crate::model::regime::{Regime, Watch};
use crate::model::sweep::{self, Gauge};
use crate::model::{Event, Motion, Observable, Rig};
use std::f64::consts::TAU;

/// Cycles read at once, or a multiple of them: whole patterns of 1 to 6, 10, 12, 15, 20 and 30 cycles.
const BLOCK: u32 = 60;
/// The multiple at most.
const MULTIPLE: f64 = 50.0;
/// A block lasts this part of the longest time in which free motion falls by e, so that the way to the end is seen in it.
const DECAY: f64 = 0.3;
/// Blocks at most, and at least where a cycle holds many swings of a mass.
const BLOCKS: (usize, usize) = (6, 64);
/// Blocks at most of motions whose contacts are integrated.
const BRIEF: usize = 12;
/// Swings of the faster mass that are followed at most, where that leaves enough blocks: as many as with five in a cycle.
const SWINGS: f64 = 5.0 * 60.0 * 64.0;
/// The answer has settled where what is left of its way is this part of the tolerance.
const SETTLED: f64 = 0.02;
/// No coarser than this.
const COARSE: f64 = 0.02;
/// Of both answers, less than this part of the larger one is nothing.
const NOTHING: f64 = 1e-3;

/// What a motion shows.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Reading {
    pub answer: Answer,
    /// Its pattern over the last block.
    pub regime: Regime,
    /// Whether the answer had settled.
    pub settled: bool,
    /// Cycles followed.
    pub cycles: u32,
    /// Mean over the cycles with impacts of the fastest one's approach speed in m/s, in the last block; 0 without impacts.
    pub speed: f64,
}

/// How motions are read.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Reader {
    observable: Observable,
    tolerance: f64,
    /// Cycles of a block.
    block: u32,
    /// Blocks at most.
    blocks: usize,
}

impl Reader {
    /// For motions of `rig` at `frequency` (Hz).
    pub fn new(rig: &Rig, frequency: f64, question: &Question) -> Reader {
        let decays = rig.oscillators().map(|o| o.decay()).into_iter().filter(|b| *b > 0.0);
        let slowest = decays.fold(f64::INFINITY, f64::min);
        let wanted = (DECAY / slowest * frequency / f64::from(BLOCK)).ceil().clamp(1.0, MULTIPLE);
        // Under a slow force a motion settles within a few cycles, each of which holds many swings.
        let swings =
            rig.natural_frequencies().into_iter().filter(|f| f.is_finite()).fold(0.0, f64::max) / frequency;
        let block = match swings {
            s if s <= 5.0 => BLOCK * wanted as u32,
            s if s <= 25.0 => BLOCK / 5,
            _ => BLOCK / 10,
        };
        let blocks = (SWINGS / (swings * f64::from(block))).clamp(BLOCKS.0 as f64, BLOCKS.1 as f64) as usize;
        Reader { observable: question.observable, tolerance: question.tolerance, block, blocks }
    }

    /// The same, for motions whose contacts are integrated: no more blocks than can be had in a second or so.
    pub fn brief(self) -> Reader {
        Reader { blocks: self.blocks.min(BRIEF), ..self }
    }

    /// Follows `motion` until what is shown of it moves by no more than a small part of the tolerance; where it does not settle, the
    /// second half of all is averaged.
    pub fn read<M: Motion>(&self, motion: &mut M) -> Result<Reading> {
        let mut values: Vec<[f64; 2]> = Vec::with_capacity(self.blocks);
        let mut watch = Watch::new(motion);
        loop {
            let (value, speed) = self.block(motion, &mut watch)?;
            values.push(value);
            let settled = still(&values, SETTLED * self.tolerance.min(COARSE));
            if settled || values.len() == self.blocks {
                let answer = if settled { Answer::exact(value) } else { mean(&values[values.len() / 2..]) };
                let (regime, cycles) = (watch.pattern().regime, self.block * values.len() as u32);
                return Ok(Reading { answer, regime, settled, cycles, speed });
            }
        }
    }

    /// One block, and the mean approach speed in it.
    fn block<M: Motion>(&self, motion: &mut M, watch: &mut Watch) -> Result<([f64; 2], f64)> {
        let observable = self.observable;
        let frequency = motion.frequency();
        let omega = TAU * frequency;
        let read = match observable {
            Observable::HalfPeakToPeak => sweep::Observable::Peak,
            _ => sweep::Observable::Fundamental,
        };
        let mut gauge = Gauge::new(read, motion.rig());
        let (mut with, mut speeds, mut impulses) = (0.0, 0.0, 0.0);
        watch.restart(motion);
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
        Ok((value, per(speeds)))
    }
}

/// Whether the last of these values is the end of the way: what falls by the ratio ρ a block has ρ/(1 − ρ) of its last step before it.
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

/// Mean of several blocks with its standard error.
fn mean(values: &[[f64; 2]]) -> Answer {
    let n = values.len() as f64;
    let mut answer = Answer::exact([0.0; 2]);
    for i in 0..2 {
        let mean = values.iter().map(|v| v[i]).sum::<f64>() / n;
        let square: f64 = values.iter().map(|v| (v[i] - mean).powi(2)).sum();
        answer.value[i] = mean;
        answer.spread[i] = (square / (n - 1.0) / n).sqrt();
    }
    answer
}

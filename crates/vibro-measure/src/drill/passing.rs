//! One pass over the velocity: repaired, cut into turns, and each turn handed to what measures it.

use super::cycle::{Cycle, Each};
use super::faults::{FaultCount, Faults, State};
use super::survey::median;
use super::turns::Turn;
use super::{Average, DrillOptions, Jumps, Motion, Survey, floor};
use vibro_record::Result;
use vibro_signal::filter::Filter;
use vibro_signal::welch::Stream;

/// Longest turn in samples; a turn that takes longer is passed over.
const LONGEST: f64 = 4e6;
/// Time constants of a filter after which it has settled.
const SETTLED: f64 = 8.0;

/// What the turns are handed to.
pub(super) struct Pass<'a> {
    rate: f64,
    turns: &'a [Turn],
    next: usize,
    faults: Faults,
    /// Of average and displacement, and whether it runs forward and backward.
    filter: Option<(Filter, bool)>,
    /// Its corner in Hz.
    pub corner: Option<f64>,
    /// Repaired velocity from sample `base` on.
    values: Vec<f64>,
    states: Vec<State>,
    base: usize,
    pub jumps: Jumps,
    pub average: Average,
    pub motion: Motion,
    pub spectrum: Option<Stream>,
    /// Turns in the average.
    pub averaged: usize,
    /// Turns with a part of the velocity lost, or too long.
    pub left_out: usize,
    pub count: FaultCount,
}

impl<'a> Pass<'a> {
    pub fn new(
        options: &DrillOptions,
        rate: f64,
        turns: &'a [Turn],
        survey: &Survey,
        spectrum: bool,
    ) -> Result<Pass<'a>> {
        let durations = turns.iter().map(|t| (t.end - t.start) / rate);
        let typical = median(durations);
        options.check_turn(typical)?;
        let corner = options.smoothing.corner(options.points, typical, rate);
        let filter = corner.map(|c| options.smoothing.filter(c, rate)).transpose()?;
        Ok(Pass {
            rate,
            turns,
            next: 0,
            faults: Faults::new(survey, (options.longest_dropout * rate) as usize),
            filter,
            corner,
            values: Vec::new(),
            states: Vec::new(),
            base: 0,
            jumps: Jumps::new(options.contact * rate, options.fit * rate),
            average: Average::new(options.points),
            motion: Motion::default(),
            spectrum: spectrum.then(floor::averages),
            averaged: 0,
            left_out: 0,
            count: FaultCount::default(),
        })
    }

    /// Takes the next samples of the velocity channel, multiplied by `factor` to m/s.
    pub fn push(&mut self, block: &[f64], each: &mut Each<'_>) -> Result<()> {
        let known = self.values.len();
        self.faults.push(block, &mut self.values, &mut self.states);
        if let Some(spectrum) = &mut self.spectrum {
            spectrum.push(&self.values[known..]);
        }
        self.measure(false, each)
    }

    pub fn finish(mut self, each: &mut Each<'_>) -> Result<Pass<'a>> {
        let known = self.values.len();
        self.count = self.faults.clone().finish(&mut self.values, &mut self.states);
        if let Some(spectrum) = &mut self.spectrum {
            spectrum.push(&self.values[known..]);
        }
        self.measure(true, each)?;
        Ok(self)
    }

    /// Samples that must be known before and after a turn.
    fn margin(&self) -> usize {
        let settle = self.corner.map_or(0.0, |corner| SETTLED * self.rate / corner);
        self.jumps.margin().max(settle.min(LONGEST) as usize) + 4
    }

    fn measure(&mut self, last: bool, each: &mut Each<'_>) -> Result<()> {
        let margin = self.margin();
        while let Some(&turn) = self.turns.get(self.next) {
            let known = self.base + self.values.len();
            if turn.end + margin as f64 > known as f64 && !last {
                break;
            }
            self.turn(turn, margin, each)?;
            self.next += 1;
        }
        // What the next turn does not need goes; without turns ahead nothing is needed.
        let needed = self.turns.get(self.next).map_or(f64::INFINITY, |t| t.start - margin as f64);
        let end = self.base + self.values.len();
        let drop = (needed.max(0.0).min(end as f64) as usize).saturating_sub(self.base);
        // Moving the rest is dear: only when half of it goes.
        if 2 * drop > self.values.len() {
            self.values.drain(..drop);
            self.states.drain(..drop);
            self.base += drop;
        }
        Ok(())
    }

    fn turn(&mut self, turn: Turn, margin: usize, each: &mut Each<'_>) -> Result<()> {
        let from = (turn.start as usize).saturating_sub(margin + self.base);
        let to = ((turn.end.ceil() as usize + margin).saturating_sub(self.base)).min(self.values.len());
        let base = (self.base + from) as f64;
        let (start, end) = (turn.start - base, turn.end - base);
        let (Some(values), Some(states)) = (self.values.get(from..to), self.states.get(from..to)) else {
            self.left_out += 1;
            return Ok(());
        };
        let inside = states.get(start as usize..(end.ceil() as usize + 1).min(states.len()));
        let whole = inside.is_some_and(|s| s.len() as f64 >= end - start && !s.contains(&State::Lost));
        if !whole || end - start > LONGEST {
            self.left_out += 1;
            return Ok(());
        }
        self.jumps.push(self.next, turn, values, states, base);
        self.motion.push(values, states, start, end, self.rate);
        // Nothing is missing here: faults are bridged, and only whole turns come so far.
        let smooth = match &self.filter {
            Some((filter, true)) => Some(filter.zero_phase(values)?),
            Some((filter, false)) => {
                let mut out = values.to_vec();
                filter.settled_at(values.first().copied().unwrap_or(0.0)).apply(&mut out);
                Some(out)
            }
            None => None,
        };
        let values = smooth.as_deref().unwrap_or(values);
        self.motion.displace(values, start, end, self.rate);
        self.averaged += 1;
        each(&Cycle {
            number: self.next,
            time: turn.start / self.rate,
            speed: self.rate / (end - start),
            velocity: self.average.push(values, states, start, end),
        })
    }
}

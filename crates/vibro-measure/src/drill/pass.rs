//! One pass over the velocity: repaired, cut into turns, and each turn handed to what measures it.

use super::average::{Average, Cycle, Each};
use super::faults::{FaultCount, Faults, State};
use super::jumps::Jumps;
use super::motion::Motion;
use super::options::LONGEST_TURN;
use super::survey::{Survey, median};
use super::turns::Turn;
use super::{DrillOptions, floor};
use vibro_record::Result;
use vibro_signal::filter::Filter;
use vibro_signal::welch::Stream;

/// Time constants of a filter after which it has settled to e⁻⁸.
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
    /// Samples that must be known before and after a turn.
    margin: usize,
    /// Repaired velocity from sample `base` on.
    values: Vec<f64>,
    states: Vec<State>,
    base: usize,
    pub jumps: Jumps,
    pub average: Average,
    pub motion: Motion,
    /// Averaged spectrum of the motion, where it is to be compared with a noise floor.
    pub spectrum: Option<Stream>,
    /// Turns in the average.
    pub averaged: usize,
    /// Turns with a part of the velocity lost, or cut off by an end of the record.
    pub left_out: usize,
    pub count: FaultCount,
}

impl<'a> Pass<'a> {
    /// A pass over a velocity that looks like `survey`.
    ///
    /// # Errors
    /// If a time of the options does not fit into a turn, or a corner into the sampling rate.
    pub fn new(
        options: &DrillOptions,
        rate: f64,
        turns: &'a [Turn],
        survey: &Survey,
        spectrum: bool,
    ) -> Result<Pass<'a>> {
        let typical = median(turns.iter().map(|t| (t.end - t.start) / rate));
        options.check_turn(typical, rate)?;
        let corner = options.smoothing.corner(options.points, typical, rate);
        let jumps = Jumps::new(options.contact * rate, options.fit * rate);
        let settle = corner.map_or(0.0, |corner| SETTLED * rate / corner);
        Ok(Pass {
            rate,
            turns,
            next: 0,
            faults: Faults::new(survey, (options.longest_dropout * rate) as usize),
            filter: corner.map(|c| options.smoothing.filter(c, rate)).transpose()?,
            corner,
            margin: jumps.margin().max(settle.min(LONGEST_TURN) as usize) + 4,
            values: Vec::new(),
            states: Vec::new(),
            base: 0,
            jumps,
            average: Average::new(options.points),
            motion: Motion::default(),
            spectrum: spectrum.then(floor::averages),
            averaged: 0,
            left_out: 0,
            count: FaultCount::default(),
        })
    }

    /// Takes the next samples of the velocity in m/s.
    pub fn push(&mut self, block: &[f64], each: &mut Each<'_>) -> Result<()> {
        let known = self.values.len();
        self.faults.push(block, &mut self.values, &mut self.states);
        self.measure(known, false, each)
    }

    /// Measures what is left.
    pub fn finish(mut self, each: &mut Each<'_>) -> Result<Pass<'a>> {
        let known = self.values.len();
        self.count = self.faults.finish(&mut self.values, &mut self.states);
        self.measure(known, true, each)?;
        Ok(self)
    }

    /// Measures the turns that are known whole; values from `new` on were not seen before.
    fn measure(&mut self, new: usize, last: bool, each: &mut Each<'_>) -> Result<()> {
        if let Some(spectrum) = &mut self.spectrum {
            spectrum.push(&self.values[new..]);
        }
        let end = self.base + self.values.len();
        while let Some(&turn) = self.turns.get(self.next) {
            if turn.end + self.margin as f64 > end as f64 && !last {
                break;
            }
            self.turn(turn, each)?;
            self.next += 1;
        }
        // What the next turn does not need goes; without turns ahead nothing is needed.
        let needed = self.turns.get(self.next).map_or(f64::INFINITY, |t| t.start - self.margin as f64);
        let drop = (needed.max(0.0).min(end as f64) as usize).saturating_sub(self.base);
        // Moving the rest is dear: only when half of it goes.
        if 2 * drop > self.values.len() {
            self.values.drain(..drop);
            self.states.drain(..drop);
            self.base += drop;
        }
        Ok(())
    }

    fn turn(&mut self, turn: Turn, each: &mut Each<'_>) -> Result<()> {
        let from = (turn.start as usize).saturating_sub(self.margin + self.base);
        let to = (turn.end.ceil() as usize + self.margin).saturating_sub(self.base).min(self.values.len());
        let base = (self.base + from) as f64;
        let (start, end) = (turn.start - base, turn.end - base);
        let (values, states) = (&self.values[from.min(to)..to], &self.states[from.min(to)..to]);
        let inside = states.get(start as usize..(end.ceil() as usize + 1).min(states.len()));
        if !inside.is_some_and(|s| s.len() as f64 >= end - start && !s.contains(&State::Lost)) {
            self.left_out += 1;
            return Ok(());
        }
        self.jumps.push(self.next, turn, values, states, base);
        self.motion.push(values, states, start, end, self.rate);
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

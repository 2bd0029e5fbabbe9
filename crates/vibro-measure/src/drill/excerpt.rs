//! A few turns of the middle of a record, to be drawn.

use super::turns::Turn;
use std::ops::Range;

/// Turns that are drawn.
const DRAWN: usize = 3;
/// Most samples that are kept for it.
const MOST: usize = 1 << 16;

/// Consecutive samples of a channel that comes in blocks.
pub(super) struct Excerpt {
    range: Range<usize>,
    seen: usize,
    pub values: Vec<f64>,
}

impl Excerpt {
    /// Samples of some turns in the middle, in a channel that is earlier than the turns by `delay` samples.
    pub fn new(turns: &[Turn], delay: f64) -> Excerpt {
        let first = turns.len().saturating_sub(DRAWN) / 2;
        let shown = turns.get(first..(first + DRAWN).min(turns.len())).unwrap_or(&[]);
        let from = shown.first().map_or(0, |t| t.start as usize);
        let to = shown.last().map_or(0, |t| t.end as usize + 1).min(from + MOST);
        let earlier = |i: usize| i.saturating_add_signed((-delay.round()) as isize);
        Excerpt { range: earlier(from)..earlier(to), seen: 0, values: Vec::new() }
    }

    /// Takes the next samples of the channel.
    pub fn push(&mut self, block: &[f64]) {
        let place = |i: usize| i.saturating_sub(self.seen).min(block.len());
        self.values.extend(&block[place(self.range.start)..place(self.range.end)]);
        self.seen += block.len();
    }

    /// First sample.
    pub fn start(&self) -> usize {
        self.range.start
    }
}

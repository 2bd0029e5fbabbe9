//! Cells of a study as they are computed.

use super::{Progress, Study};
use crate::error::Result;
use rayon::prelude::*;
use std::collections::VecDeque;
use std::time::{Duration, Instant};

/// Computes cells of a study in batches; gives their numbers and bytes in order.
///
/// A batch grows until it takes about half a second: what a killed program loses, and the time between two
/// reports of progress.
pub struct Computed<'a, N> {
    study: &'a dyn Study,
    numbers: N,
    progress: &'a dyn Progress,
    batch: usize,
    ready: VecDeque<(u64, Result<Vec<u8>>)>,
    done: usize,
    all: usize,
}

/// Time that a batch takes.
const BATCH: Duration = Duration::from_millis(500);

impl<'a, N: Iterator<Item = u64>> Computed<'a, N> {
    /// The cells with these numbers, `all` of them.
    pub fn new(study: &'a dyn Study, numbers: N, all: u64, progress: &'a dyn Progress) -> Computed<'a, N> {
        progress.start(study.what(), all as usize);
        let batch = if study.parallel() { rayon::current_num_threads() } else { 1 };
        Computed { study, numbers, progress, batch, ready: VecDeque::new(), done: 0, all: all as usize }
    }

    /// Whether the next cell is still to be computed.
    pub fn at_end_of_batch(&self) -> bool {
        self.ready.is_empty()
    }

    fn compute(&mut self) {
        let numbers: Vec<u64> = self.numbers.by_ref().take(self.batch).collect();
        let began = Instant::now();
        let study = self.study;
        let cell = |number: u64| (number, study.cell(number));
        if study.parallel() {
            // Short cells are handed out several at a time.
            let least = (numbers.len() / 256).clamp(1, 64);
            let computed: Vec<_> =
                numbers.par_iter().with_min_len(least).map(|number| cell(*number)).collect();
            self.ready.extend(computed);
            let took = began.elapsed();
            if took < BATCH / 2 {
                self.batch *= 2;
            } else if took > 2 * BATCH {
                self.batch = (self.batch / 2).max(rayon::current_num_threads());
            }
        } else {
            self.ready.extend(numbers.iter().map(|number| cell(*number)));
        }
        self.done += numbers.len();
        self.progress.at(self.done, self.all);
    }
}

impl<N: Iterator<Item = u64>> Iterator for Computed<'_, N> {
    type Item = (u64, Result<Vec<u8>>);

    fn next(&mut self) -> Option<(u64, Result<Vec<u8>>)> {
        if self.ready.is_empty() {
            self.compute();
        }
        self.ready.pop_front()
    }
}

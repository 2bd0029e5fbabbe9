//! One axis of a handle, block by block.

use super::{SETTLED, SPAN, Weighting};
use vibro_record::Result;

/// Takes one axis of the acceleration of a handle, block by block.
///
/// The half second in which the weighting settles is left out: after the first value and behind every missing one. So are missing
/// samples themselves, over which the value before is held.
#[derive(Debug, Clone)]
pub struct Handle {
    weighting: Weighting,
    /// Samples in which the weighting settles.
    settle: usize,
    /// Samples that are still to be passed over.
    settling: usize,
    /// Samples of a second.
    span: usize,
    /// Samples since the beginning of the record, missing ones included.
    clock: usize,
    seconds: Vec<Second>,
    pub(super) peak: f64,
    raw: Raw,
    pub(super) missing: usize,
    scratch: Vec<f64>,
}

/// What counts in one second of the record.
#[derive(Debug, Clone, Copy, Default)]
struct Second {
    squares: f64,
    n: usize,
}

/// The acceleration as it was measured.
#[derive(Debug, Clone, Default)]
struct Raw {
    last: Option<f64>,
    low: f64,
    high: f64,
    sum: f64,
    n: usize,
}

impl Raw {
    fn push(&mut self, v: f64) {
        (self.low, self.high) = if self.n == 0 { (v, v) } else { (self.low.min(v), self.high.max(v)) };
        self.sum += v;
        self.n += 1;
        self.last = Some(v);
    }

    fn peak(&self) -> f64 {
        let mean = self.sum / self.n.max(1) as f64;
        (self.high - mean).max(mean - self.low)
    }
}

impl Handle {
    /// An axis at `rate` samples a second.
    ///
    /// # Errors
    /// If the rate is below four times the upper corner of the weighting.
    pub fn new(rate: f64) -> Result<Handle> {
        let settle = (SETTLED * rate).ceil() as usize;
        Ok(Handle {
            weighting: Weighting::new(rate)?,
            settle,
            settling: settle,
            span: ((SPAN * rate) as usize).max(1),
            clock: 0,
            seconds: Vec::new(),
            peak: 0.0,
            raw: Raw::default(),
            missing: 0,
            scratch: Vec::new(),
        })
    }

    /// Takes the next accelerations in m/s²; what is not finite is missing.
    pub fn push(&mut self, block: &[f64]) {
        // The weighting begins at the first value that is there.
        let before =
            if self.raw.last.is_some() { 0 } else { block.iter().take_while(|v| !v.is_finite()).count() };
        self.missing += before;
        self.clock += before;
        let mut values = std::mem::take(&mut self.scratch);
        values.clear();
        for &v in &block[before..] {
            if v.is_finite() {
                self.raw.push(v);
            }
            values.push(self.raw.last.unwrap_or(0.0));
        }
        self.weighting.apply(&mut values);
        for (&measured, &weighted) in block[before..].iter().zip(&values) {
            if measured.is_finite() {
                self.take(weighted);
            } else {
                self.missing += 1;
                self.settling = self.settle;
            }
            self.clock += 1;
        }
        self.scratch = values;
    }

    fn take(&mut self, weighted: f64) {
        if self.settling > 0 {
            self.settling -= 1;
            return;
        }
        self.peak = self.peak.max(weighted.abs());
        // Seconds of all axes are the same: they count from where an axis without gaps has settled.
        let number = (self.clock - self.settle) / self.span;
        if self.seconds.len() <= number {
            self.seconds.resize(number + 1, Second::default());
        }
        let second = &mut self.seconds[number];
        second.squares += weighted * weighted;
        second.n += 1;
    }

    /// Samples of the record, missing ones included.
    pub(super) fn samples(&self) -> usize {
        self.clock
    }

    /// Weighted samples that count.
    pub(super) fn counted(&self) -> usize {
        self.seconds.iter().map(|s| s.n).sum()
    }

    /// Time in s of the samples that count.
    pub(super) fn duration(&self) -> f64 {
        self.counted() as f64 / self.span as f64
    }

    /// Mean square of the weighted samples that count.
    pub(super) fn mean_square(&self) -> f64 {
        self.seconds.iter().map(|s| s.squares).sum::<f64>() / self.counted().max(1) as f64
    }

    /// Mean square of each second, in the order of time; `None` where a part of it does not count.
    pub(super) fn seconds(&self) -> impl Iterator<Item = Option<f64>> {
        self.seconds.iter().map(|s| (s.n == self.span).then(|| s.squares / s.n as f64))
    }

    /// Largest unweighted deviation from the mean.
    pub(super) fn unweighted_peak(&self) -> f64 {
        self.raw.peak()
    }
}

//! Averaged spectra of long records: P. D. Welch, IEEE Trans. Audio Electroacoust. 15 (1967) 70.
//!
//! Segments are read, transformed on all cores and averaged as they come, so that memory does not grow with
//! the record. Sums are formed in a fixed order: the same record gives the same digits on any number of
//! cores.

use super::fft::{Transform, Workspace};
use super::rails::Rails;
use super::segment::{Batches, Segments};
use super::sound::constant;
use super::window;
use num_complex::Complex64;
use rayon::prelude::*;
use vibro_record::lanes;
use vibro_record::{Error, Result, Traces, Window};

/// Segments that one core sums up at a time: more save memory and additions, fewer share the work more
/// evenly.
const GROUP: usize = 8;

/// How a record is cut and weighted.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Welch {
    /// Length and distance of the segments.
    pub segments: Segments,
    /// Window of each segment.
    pub window: Window,
    /// Whether the mean of each segment is subtracted before the window, as with scipy's
    /// `detrend="constant"`.
    pub detrend: bool,
}

/// Mean squares and products of the spectral lines of all windowed segments, without any further scaling.
#[derive(Debug, Clone, PartialEq)]
pub struct Averages {
    /// Number of segments.
    pub count: usize,
    /// Number of independent segments with the same scatter; fewer than `count` where segments overlap.
    pub effective: f64,
    /// Samples of a segment.
    pub length: usize,
    /// Sampling rate in Hz.
    pub rate: f64,
    /// Whether the mean of each segment was subtracted: the line at 0 Hz then does not show it.
    pub detrended: bool,
    /// Sum of the window's samples.
    pub sum: f64,
    /// Sum of the squares of the window's samples.
    pub squares: f64,
    /// Mean of |X|² for each channel.
    pub auto: Vec<Vec<f64>>,
    /// Mean of |X|⁴ of the first channel.
    pub fourth: Vec<f64>,
    /// Mean of conj(X₀) X for each channel after the first, where products were requested.
    pub cross: Vec<Vec<Complex64>>,
    /// The range of each channel; empty where it was not determined.
    pub ranges: Vec<Rails>,
}

impl Averages {
    /// Distance of spectral lines in Hz.
    pub fn step(&self) -> f64 {
        self.rate / self.length as f64
    }

    /// Standard deviation of the power of line `k` of the first channel from segment to segment, as a part of
    /// its mean: 1 for noise, nothing for a steady sine, √2ab/(a² + b²) for two sines of amplitudes a and b
    /// that beat in it.
    pub fn variation(&self, k: usize) -> Option<f64> {
        let (power, square) = (self.auto.first()?.get(k)?, self.fourth.get(k)?);
        (*power > 0.0).then(|| (square / (power * power) - 1.0).max(0.0).sqrt())
    }

    /// Crest factor of a channel: half its range from peak to peak, over its root mean square without the
    /// mean, by Parseval's theorem.
    pub fn crest(&self, channel: usize) -> Option<f64> {
        let (range, lines) = self.ranges.get(channel).zip(self.auto.get(channel))?;
        let [high, low] = range.range();
        let squares = 2.0 * lines.iter().skip(1).sum::<f64>() / (self.length as f64 * self.squares);
        Some(0.5 * (high - low) / squares.sqrt())
    }
}

impl Welch {
    /// Averages over all segments of all channels of `traces`; with `products`, also the products with the
    /// first channel. `progress` gets the number of samples of each channel read so far.
    ///
    /// # Errors
    /// If the record is shorter than a segment, a sample is missing or a channel is constant, or the file
    /// cannot be read.
    pub fn average(
        &self,
        traces: &mut Traces,
        products: bool,
        mut progress: impl FnMut(usize) + Send,
    ) -> Result<Averages> {
        let Segments { length, hop } = self.segments;
        let (frames, rate) = (traces.frames(), traces.rate());
        if frames < length {
            let why = format!("the record has {frames} samples: not one segment of {length} fits into it");
            return Err(Error::refused(why)
                .hint(format!("take segments of at most {frames} samples"))
                .setting("segment"));
        }
        let names: Vec<String> = traces.channels().iter().map(|m| m.name.clone()).collect();
        let transform = Transform::new(length);
        let weights = window::samples(self.window, length);
        let mut total = Sums::new(names.len(), products, transform.lines());
        // Sums of the segments of a batch in their order, `GROUP` segments to a task.
        let summed = |batch: &[Vec<f64>], count: usize| -> Vec<Sums> {
            let group = |work: &mut Vec<Workspace>, group: usize| {
                let mut sums = Sums::new(batch.len(), products, transform.lines());
                for i in group * GROUP..count.min((group + 1) * GROUP) {
                    for (work, column) in work.iter_mut().zip(batch) {
                        let segment = column.get(i * hop..i * hop + length).unwrap_or_default();
                        let sum = if self.detrend { lanes::sum(segment) } else { 0.0 };
                        work.load(segment, sum / length as f64, &weights);
                        transform.run(work);
                    }
                    sums.add(work);
                }
                sums
            };
            let spaces = || batch.iter().map(|_| transform.workspace()).collect();
            (0..count.div_ceil(GROUP)).into_par_iter().map_init(spaces, group).collect()
        };
        let mut batches = Batches::new(traces, self.segments);
        let (mut batch, mut next) = (Vec::new(), Vec::new());
        let mut count = batches.fill(&mut batch)?;
        while count > 0 {
            batches.carry(&batch, count, &mut next);
            // The next batch is read while this one is transformed.
            let (read, sums) = rayon::join(|| batches.fill(&mut next), || summed(&batch, count));
            total.add_all(&sums);
            progress(batches.frames);
            std::mem::swap(&mut batch, &mut next);
            count = read?;
        }
        for (name, range) in names.iter().zip(&batches.ranges) {
            let [high, low] = range.range();
            if low == high {
                return Err(constant(name, low));
            }
        }
        let ranges = batches.ranges;
        Ok(Averages { ranges, ..total.mean(&weights, self.segments, rate, self.detrend) })
    }
}

/// Sums over segments.
#[derive(Clone)]
pub(super) struct Sums {
    count: usize,
    auto: Vec<Vec<f64>>,
    fourth: Vec<f64>,
    cross: Vec<Vec<Complex64>>,
}

impl Sums {
    pub(super) fn new(channels: usize, products: bool, lines: usize) -> Sums {
        let pairs = if products { channels.saturating_sub(1) } else { 0 };
        Sums {
            count: 0,
            auto: vec![vec![0.0; lines]; channels],
            fourth: vec![0.0; lines],
            cross: vec![vec![Complex64::ZERO; lines]; pairs],
        }
    }

    /// Adds the lines of one segment of all channels.
    pub(super) fn add(&mut self, lines: &[Workspace]) {
        self.count += 1;
        for (sum, work) in self.auto.iter_mut().zip(lines) {
            sum.iter_mut().zip(&work.output).for_each(|(s, x)| *s += x.norm_sqr());
        }
        let Some((first, rest)) = lines.split_first() else { return };
        self.fourth.iter_mut().zip(&first.output).for_each(|(s, x)| *s += x.norm_sqr().powi(2));
        for (sum, work) in self.cross.iter_mut().zip(rest) {
            let pairs = first.output.iter().zip(&work.output);
            sum.iter_mut().zip(pairs).for_each(|(s, (a, b))| *s += a.conj() * b);
        }
    }

    fn add_all(&mut self, parts: &[Sums]) {
        for part in parts {
            self.count += part.count;
            for (sum, more) in self.auto.iter_mut().zip(&part.auto) {
                sum.iter_mut().zip(more).for_each(|(s, m)| *s += m);
            }
            self.fourth.iter_mut().zip(&part.fourth).for_each(|(s, m)| *s += m);
            for (sum, more) in self.cross.iter_mut().zip(&part.cross) {
                sum.iter_mut().zip(more).for_each(|(s, m)| *s += m);
            }
        }
    }

    /// The means over the segments, to which `weights` were applied.
    pub(super) fn mean(
        mut self,
        weights: &[f64],
        segments: Segments,
        rate: f64,
        detrended: bool,
    ) -> Averages {
        let factor = 1.0 / self.count.max(1) as f64;
        self.auto.iter_mut().flatten().chain(&mut self.fourth).for_each(|v| *v *= factor);
        self.cross.iter_mut().flatten().for_each(|v| *v *= factor);
        Averages {
            count: self.count,
            effective: effective(weights, segments.hop, self.count),
            length: segments.length,
            rate,
            detrended,
            sum: weights.iter().sum(),
            squares: weights.iter().map(|w| w * w).sum(),
            auto: self.auto,
            fourth: self.fourth,
            cross: self.cross,
            ranges: Vec::new(),
        }
    }
}

/// Number of independent segments that scatter as little as `count` overlapping ones: count/(1 + 2 Σⱼ (1 −
/// j/K) ρⱼ), with K = count and ρⱼ the squared correlation of the windows of segments that are j apart (Welch
/// 1967, section "Application to Gaussian noise").
fn effective(weights: &[f64], hop: usize, count: usize) -> f64 {
    let squares: f64 = weights.iter().map(|w| w * w).sum();
    let mut inflation = 1.0;
    for j in 1..count {
        let Some(shifted) = weights.get(j * hop..).filter(|s| !s.is_empty()) else { break };
        let product: f64 = weights.iter().zip(shifted).map(|(a, b)| a * b).sum();
        inflation += 2.0 * (1.0 - j as f64 / count as f64) * (product / squares).powi(2);
    }
    count as f64 / inflation
}

#[cfg(test)]
mod tests;

//! Cuts records into overlapping segments, one batch of segments at a time.

use super::rails::Rails;
use super::sound::no_gaps;
use vibro_record::{Error, Result, Traces};

/// Samples of each channel in one batch: enough segments for several cores, and few enough for a processor's
/// cache.
const BATCH: usize = 128 * 1024;

/// Length and distance of segments in samples.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Segments {
    /// Samples of a segment.
    pub length: usize,
    /// Samples from the start of a segment to the start of the next.
    pub hop: usize,
}

impl Segments {
    /// Segments of `length` samples, each of which shares the fraction `overlap` (0 to below 1) with the
    /// next.
    ///
    /// # Errors
    /// If the length is below 8 samples, or the overlap leaves no step from one segment to the next.
    pub fn new(length: usize, overlap: f64) -> Result<Segments> {
        if length < 8 {
            return Err(Error::usage(format!("segments of {length} samples"), "at least 8 samples")
                .setting("segment"));
        }
        if !(0.0..1.0).contains(&overlap) {
            let error =
                Error::usage(format!("an overlap of {overlap}"), "a part of the segment from 0 to below 1");
            let hint = "0.5 for Hann, 0.75 for a flat top, 0 without a window";
            return Err(error.setting("overlap").hint(hint));
        }
        let shared = (overlap * length as f64).floor() as usize;
        Ok(Segments { length, hop: (length - shared.min(length)).max(1) })
    }

    /// Number of whole segments in `n` samples.
    pub fn count(self, n: usize) -> usize {
        if n < self.length { 0 } else { (n - self.length) / self.hop + 1 }
    }
}

/// Reads the channels of a file in batches of whole segments.
pub(crate) struct Batches<'a> {
    traces: &'a mut Traces,
    segments: Segments,
    /// Samples of each channel read so far.
    pub frames: usize,
    /// The range of each channel so far.
    pub ranges: Vec<Rails>,
}

impl<'a> Batches<'a> {
    /// All channels from the present place of `traces` on.
    pub fn new(traces: &'a mut Traces, segments: Segments) -> Batches<'a> {
        let ranges = vec![Rails::default(); traces.channels().len()];
        Batches { traces, segments, frames: 0, ranges }
    }

    /// Fills `batch`, one `Vec` for each channel, which starts with the samples from [`Batches::carry`],
    /// until it is full (and by up to a block of the file more) or the file ends. Returns the number of
    /// whole segments in it.
    ///
    /// # Errors
    /// If the file cannot be read, or a sample is missing.
    pub fn fill(&mut self, batch: &mut Vec<Vec<f64>>) -> Result<usize> {
        batch.resize_with(self.ranges.len(), Vec::new);
        let wanted = BATCH.max(self.segments.length + self.segments.hop);
        while batch.first().map_or(0, Vec::len) < wanted {
            let new = self.traces.append(batch)?;
            if new == 0 {
                break;
            }
            // Missing samples are refused: a transform would spread them over all lines.
            for ((column, range), meta) in batch.iter().zip(&mut self.ranges).zip(self.traces.channels()) {
                let values = &column[column.len() - new..];
                no_gaps(values, &meta.name, self.frames)?;
                range.extend(values);
            }
            self.frames += new;
        }
        Ok(self.segments.count(batch.first().map_or(0, Vec::len)))
    }

    /// Copies the samples of `batch` that segments after the `count` first still need into `next`.
    pub fn carry(&self, batch: &[Vec<f64>], count: usize, next: &mut Vec<Vec<f64>>) {
        next.resize_with(batch.len(), Vec::new);
        for (column, values) in next.iter_mut().zip(batch) {
            column.clear();
            column.extend_from_slice(values.get(count * self.segments.hop..).unwrap_or_default());
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use vibro_record::units::Unit;
    use vibro_record::{Axis, Meta, Trace};

    #[test]
    fn every_segment_comes_once_and_in_order() {
        let n = 3 * BATCH + 1000;
        let values: Vec<f64> = (0..n).map(|i| i as f64).collect();
        for (length, overlap) in [(1000, 0.0), (1024, 0.5), (4097, 0.75), (BATCH + 7, 0.5), (8, 0.9)] {
            let segments = Segments::new(length, overlap).unwrap();
            let meta = Meta::new("a", Unit::opaque("V"));
            let trace = Trace { meta, axis: Axis::time(0.0, 1.0, n), values: values.clone() };
            let mut traces = Traces::from_memory(vec![trace]).unwrap();
            let mut batches = Batches::new(&mut traces, segments);
            let (mut batch, mut next, mut seen) = (Vec::new(), Vec::new(), 0);
            loop {
                let count = batches.fill(&mut batch).unwrap();
                if count == 0 {
                    break;
                }
                for i in 0..count {
                    let segment = &batch[0][i * segments.hop..][..length];
                    assert_eq!(segment[0], (seen * segments.hop) as f64);
                    assert_eq!(segment[length - 1] - segment[0], (length - 1) as f64);
                    seen += 1;
                }
                batches.carry(&batch, count, &mut next);
                std::mem::swap(&mut batch, &mut next);
            }
            assert_eq!(seen, segments.count(n), "{length} {overlap}");
            assert_eq!((batches.frames, batches.ranges[0].range()[0]), (n, (n - 1) as f64));
        }
    }

    #[test]
    fn impossible_segments_are_refused() {
        assert!(Segments::new(7, 0.5).is_err());
        for overlap in [1.0, -0.1, f64::NAN] {
            assert!(Segments::new(64, overlap).unwrap_err().to_string().contains("overlap"));
        }
        // Half of an odd length, as scipy rounds it.
        assert_eq!(Segments::new(9, 0.5).unwrap().hop, 5);
        assert_eq!(Segments::new(64, 0.999).unwrap().hop, 1);
        assert_eq!(Segments { length: 8, hop: 4 }.count(7), 0);
    }
}

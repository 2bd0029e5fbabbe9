//! A wave file block by block in the units of its channels.

use super::{WavStream, beyond_full_scale, describe, dress, gaps, open};
use crate::reader::Options;
use crate::{Source, Summary};
use std::path::PathBuf;
use vibro_math::lanes;
use vibro_record::{Finding, Meta, Result, Stream, Trace, units};

/// Some channels of a wave file, with what a person stated and what the file says applied.
pub(crate) struct Calibrated {
    stream: WavStream,
    path: PathBuf,
    /// Every channel of the file without its values.
    all: Vec<Trace>,
    factors: Vec<f64>,
    /// Indices of the channels that are handed out.
    kept: Vec<usize>,
    largest: Vec<f64>,
    allow_missing: bool,
    scaled: bool,
    at: usize,
}

impl Calibrated {
    pub fn open(source: &Source, options: &Options) -> Result<Calibrated> {
        let stream = open(source, options)?;
        let summary = Summary { n: stream.frames() as usize, max: None };
        let (mut all, mut factors) = (Vec::new(), Vec::new());
        for channel in 0..stream.channels() {
            let mut trace = describe(source, &stream, options, channel, &summary);
            let factor =
                dress(&mut trace, &stream, options, channel).map_err(|e| e.in_file(source.path()))?;
            all.push(trace);
            factors.push(factor);
        }
        let n = all.len();
        Ok(Calibrated {
            scaled: stream.scales().is_some() || options.unit.is_some(),
            stream,
            path: source.path().to_owned(),
            all,
            factors,
            kept: (0..n).collect(),
            largest: vec![0.0; n],
            allow_missing: options.allow_missing,
            at: 0,
        })
    }

    pub fn channels(&self) -> &[Trace] {
        &self.all
    }

    pub fn findings(&self) -> &[Finding] {
        self.stream.findings()
    }

    pub fn frames(&self) -> usize {
        self.stream.frames() as usize
    }

    /// Hands out these of the channels handed out so far, in this order; returns them without values.
    pub fn chosen(&mut self, channels: &[usize]) -> Vec<Trace> {
        self.keep(channels);
        self.kept.iter().filter_map(|i| self.all.get(*i).cloned()).collect()
    }
}

impl Stream for Calibrated {
    fn append(&mut self, block: &mut Vec<Vec<f64>>) -> Result<usize> {
        let frames = self.stream.append(&self.kept, block)?;
        for ((channel, column), largest) in self.kept.iter().zip(&mut *block).zip(&mut self.largest) {
            let from = column.len() - frames;
            let values = &mut column[from..];
            let seen = lanes::survey(values);
            *largest = largest.max(seen.high).max(-seen.low);
            if !seen.finite {
                let places: Vec<usize> = (0..values.len()).filter(|i| !values[*i].is_finite()).collect();
                if !self.allow_missing {
                    let listed = places.iter().map(|i| (self.at + i, *channel));
                    return Err(gaps(&self.path, places.len(), listed));
                }
                for i in places {
                    values[i] = f64::NAN;
                }
            }
            let factor = self.factors.get(*channel).copied().unwrap_or(1.0);
            if factor != 1.0 {
                units::scale(values.iter_mut(), factor).map_err(|e| e.in_file(&self.path))?;
            }
        }
        self.at += frames;
        Ok(frames)
    }

    fn keep(&mut self, channels: &[usize]) {
        self.kept = channels.iter().filter_map(|i| self.kept.get(*i).copied()).collect();
        self.largest = vec![0.0; self.kept.len()];
    }

    fn finish(&self, metas: &mut [Meta]) {
        for (meta, largest) in metas.iter_mut().zip(&self.largest) {
            if *largest > 1.0 && !self.scaled {
                meta.found(beyond_full_scale(*largest));
            }
        }
    }
}

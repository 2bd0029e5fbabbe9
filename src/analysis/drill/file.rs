//! Reads the channels of a hammer drill from its file.

use crate::analysis::progress::Progress;
use std::path::Path;
use vibro_io::Reader;
use vibro_record::units::Quantity;
use vibro_record::{Error, Finding, Meta, Result, Trace};

/// Channels of one file, by name or number from 1.
pub(super) struct Channels {
    /// Sampling rate in Hz.
    pub rate: f64,
    /// Samples of each channel, in the order of the names.
    pub values: Vec<Vec<f64>>,
    metas: Vec<Meta>,
    /// Findings on the file. Missing sensitivities are no finding, since they are stated.
    pub findings: Vec<Finding>,
}

impl Channels {
    /// Reads channels; missing values are accepted as drop-outs. `progress` receives the number of samples
    /// read, and of all, after every block.
    ///
    /// # Errors
    /// If the file cannot be read, a channel does not exist or is named twice, or has another rate.
    pub fn read(reader: Reader, path: &Path, names: &[&str], progress: &dyn Progress) -> Result<Channels> {
        let mut traces = reader.allow_missing(true).stream_channels(path, names)?;
        if traces.channels().len() != names.len() {
            return Err(Error::refused(format!("one channel is named twice: {}", names.join(", ")))
                .hint("vibro info lists the channels with their numbers"));
        }
        let (mut values, mut done) = (Vec::new(), 0);
        loop {
            let n = traces.append(&mut values)?;
            if n == 0 {
                break;
            }
            done += n;
            progress.at(done, traces.frames());
        }
        let mut findings = traces.findings();
        findings.retain(|found| found.code != Trace::UNCALIBRATED);
        Ok(Channels { rate: traces.rate(), metas: traces.channels().to_vec(), values, findings })
    }

    /// Whether the file states this quantity for a channel.
    pub fn is(&self, channel: usize, quantity: Quantity) -> bool {
        self.metas.get(channel).is_some_and(|meta| meta.quantity == quantity)
    }

    /// Relative standard uncertainty of the sampling rate.
    pub fn clock(&self) -> f64 {
        self.metas.iter().fold(0.0, |most, meta| meta.clock.max(most))
    }

    /// Multiplies the channels from index `from` on.
    pub fn scale(&mut self, from: usize, factor: f64) {
        self.values.iter_mut().skip(from).flatten().for_each(|v| *v *= factor);
    }
}

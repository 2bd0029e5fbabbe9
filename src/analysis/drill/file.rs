//! Channels of a file.

use crate::analysis::progress::Progress;
use std::path::Path;
use vibro_io::Reader;
use vibro_record::units::Quantity;
use vibro_record::{Error, Finding, Meta, Result, Trace};

/// Channels of one file, by name or number from 1.
pub(super) struct Channels {
    pub rate: f64,
    pub values: Vec<Vec<f64>>,
    metas: Vec<Meta>,
    /// What the file says of itself. Sensitivities are stated: that it knows none is no finding.
    pub findings: Vec<Finding>,
}

impl Channels {
    /// Reads channels; missing values are taken, they are drop-outs. `progress` hears after every block how
    /// many samples were read, of how many.
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

    /// Whether the file says that a channel is this quantity.
    pub fn is(&self, channel: usize, quantity: Quantity) -> bool {
        self.metas.get(channel).is_some_and(|meta| meta.quantity == quantity)
    }

    /// Relative standard uncertainty of the sampling rate.
    pub fn clock(&self) -> f64 {
        self.metas.iter().fold(0.0, |most, meta| meta.clock.max(most))
    }

    /// Multiplies the channels from this one on.
    pub fn scale(&mut self, from: usize, factor: f64) {
        self.values.iter_mut().skip(from).flatten().for_each(|v| *v *= factor);
    }
}

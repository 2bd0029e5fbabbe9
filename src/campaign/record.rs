//! Entries that name a file of records: what the file does not say, and what an analysis needs to know.

use crate::read::Reader;
use crate::units::Unit;
use serde::Deserialize;
use std::path::PathBuf;
use toml::Spanned;

/// What all entries of files have in common.
#[derive(Debug, Clone)]
pub struct RecordEntry {
    /// Name; the file's name where it is left out.
    pub name: Option<String>,
    /// File.
    pub file: Spanned<PathBuf>,
    /// Channel by name; all where it is left out.
    pub channel: Option<String>,
    /// Unit of the stored values.
    pub unit: Option<String>,
    /// Factor on the stored values: volts or m/s at full scale for a wave file.
    pub calibration: Option<f64>,
    /// Sampling rate in Hz, where the file does not say.
    pub rate: Option<f64>,
    /// Base band in Hz, where the file does not say.
    pub base_band: Option<f64>,
}

/// An entry of a campaign: the common keys and its own.
macro_rules! record_entry {
    ($(#[$doc:meta])* $entry:ident { $($(#[$own:meta])* $field:ident: $kind:ty,)* }) => {
        $(#[$doc])*
        #[derive(Debug, Clone, Deserialize)]
        #[serde(deny_unknown_fields)]
        pub struct $entry {
            name: Option<String>,
            file: Spanned<PathBuf>,
            channel: Option<String>,
            unit: Option<String>,
            calibration: Option<f64>,
            rate: Option<f64>,
            base_band: Option<f64>,
            $($(#[$own])* #[serde(default)] pub $field: $kind,)*
        }

        impl $entry {
            /// The common keys.
            pub fn record(&self) -> RecordEntry {
                RecordEntry {
                    name: self.name.clone(),
                    file: self.file.clone(),
                    channel: self.channel.clone(),
                    unit: self.unit.clone(),
                    calibration: self.calibration,
                    rate: self.rate,
                    base_band: self.base_band,
                }
            }
        }
    };
}

record_entry! {
    /// Frequency response functions.
    FrfEntry {
        /// Band in Hz whose peaks are fitted together. Default: a band around each peak.
        band: Option<(f64, f64)>,
        /// Mass in kg for the stiffness.
        mass: Option<f64>,
    }
}

record_entry! {
    /// A trace of impacts.
    ImpactsEntry {}
}

record_entry! {
    /// A drop test.
    DropEntry {}
}

record_entry! {
    /// A contact pulse.
    PulseEntry {
        /// Mass in kg that is decelerated.
        mass: Option<f64>,
        /// Corner of the instrument's Butterworth low-pass in Hz. Default: none, with a warning.
        low_pass: Option<f64>,
        /// Its order.
        order: Option<usize>,
    }
}

record_entry! {
    /// A hammer-drill trace.
    DrillEntry {}
}

impl RecordEntry {
    /// What cannot be, as a sentence.
    pub(super) fn check(&self) -> Result<(), String> {
        for (key, value) in
            [("calibration", self.calibration), ("rate", self.rate), ("base_band", self.base_band)]
        {
            if let Some(v) = value.filter(|v| !(v.is_finite() && *v > 0.0)) {
                return Err(format!("{key} = {v} of this file is not a finite number above 0"));
            }
        }
        match self.unit.as_deref().filter(|u| Unit::parse(u).is_none()) {
            Some(unit) => Err(format!("the unit {unit:?} of this file is not known")),
            None => Ok(()),
        }
    }

    /// A reader that knows what the entry says.
    pub fn reader(&self) -> Reader {
        Reader::new()
            .rate(self.rate)
            .base_band(self.base_band)
            .unit(self.unit.as_deref().map(Unit::parse_or_opaque))
    }
}

//! Entries that name a file of records: what the file does not say, and what an analysis needs to know.

use super::LowPass;
use crate::measure::drill::{Edge, From};
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
        /// File with the coherence of the same lines. Default: a coherence in the file.
        coherence: Option<PathBuf>,
    }
}

record_entry! {
    /// A trace of impacts.
    ImpactsEntry {
        /// Frequency of the excitation in Hz.
        excitation: Option<f64>,
        /// Channel of the same file that rises once a cycle of the excitation.
        reference: Option<String>,
        /// Lowest impact, as part of the median one. Default 1/8.
        threshold: Option<f64>,
        /// Pause in s that parts two impacts. Default: found from the trace.
        refractory: Option<f64>,
    }
}

record_entry! {
    /// A drop test.
    DropEntry {
        /// Height of the fall in m; without it, a train of bounces.
        height: Option<f64>,
        /// Its standard uncertainty in m.
        height_std: Option<f64>,
        /// Acceleration of free fall in m/s². Default 9.80665.
        gravity: Option<f64>,
        /// Its standard uncertainty in m/s².
        gravity_std: Option<f64>,
        /// Lowest impact, as part of the median one. Default 0.02.
        threshold: Option<f64>,
        /// Pause in s that parts two impacts. Default: found from the trace.
        refractory: Option<f64>,
    }
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
    DrillEntry {
        /// Velocity channel.
        velocity: Option<String>,
        /// Channel with the pulses of the crank.
        reference: Option<String>,
        /// Velocity along the beam in m/s for one unit of the channel.
        sensitivity: Option<f64>,
        /// Angle of the beam in degrees.
        beam_angle: Option<f64>,
        /// From where that angle is counted: `normal` or `axis`.
        from: Option<From>,
        /// Pulses in a turn.
        pulses_per_turn: Option<usize>,
        /// `rising` or `falling`.
        edge: Option<Edge>,
        /// Level of the edge.
        level: Option<f64>,
        /// Mass that is measured, kg.
        mass: Option<f64>,
        /// Mass that it strikes, kg.
        struck_mass: Option<f64>,
        /// Longest contact, s.
        contact: Option<f64>,
        /// Duration of the fits, s.
        fit: Option<f64>,
        /// Corner of the zero-phase low-pass, Hz, or `none`.
        low_pass: Option<LowPass>,
        /// Time constant of exponential smoothing, s.
        smoothing: Option<f64>,
        /// Highest frequency that the instrument passes, Hz.
        instrument: Option<f64>,
        /// Record without motion.
        noise: Option<PathBuf>,
        /// Acceleration channels of a handle.
        handle: Vec<String>,
        /// Acceleration in m/s² for one unit of these.
        handle_sensitivity: Option<f64>,
        /// Hours a day of the exposure.
        exposure: Option<f64>,
    }
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

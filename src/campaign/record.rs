//! Entries that name a file of records: what the file does not say, and what an analysis needs to know.

use super::LowPass;
use crate::measure::drill::{Edge, From};
use crate::measure::impacts::Scatter;
use crate::measure::spectral::Method;
use crate::read::{Format, Reader};
use crate::record::Scaling;
use crate::signal::transfer::Estimator;
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
    /// Format by name, instead of finding it out.
    pub format: Option<String>,
    /// Whether missing values are kept as such.
    pub allow_missing: bool,
    /// Decimal mark, where the file leaves it open.
    pub decimal: Option<Decimal>,
    /// Whether two columns of values are real and imaginary part.
    pub complex: bool,
}

/// Decimal mark of a text file.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Decimal {
    /// 1,5
    Comma,
    /// 1.5
    Point,
}

/// What is taken out of a segment before the window.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Detrend {
    /// Nothing.
    None,
    /// Its mean.
    Mean,
}

/// A file that must be named, or may be.
trait Filed {
    type Record;
    fn record(&self, of: impl FnOnce(Spanned<PathBuf>) -> RecordEntry) -> Self::Record;
    fn named(&self) -> bool;
}

impl Filed for Spanned<PathBuf> {
    type Record = RecordEntry;
    fn record(&self, of: impl FnOnce(Spanned<PathBuf>) -> RecordEntry) -> RecordEntry {
        of(self.clone())
    }
    fn named(&self) -> bool {
        true
    }
}

impl Filed for Option<Spanned<PathBuf>> {
    type Record = Option<RecordEntry>;
    fn record(&self, of: impl FnOnce(Spanned<PathBuf>) -> RecordEntry) -> Option<RecordEntry> {
        self.clone().map(of)
    }
    fn named(&self) -> bool {
        self.is_some()
    }
}

/// What all entries can be asked.
pub(super) trait Common {
    /// A key that says how a file is read, where there is no file.
    fn without_file(&self) -> Option<&'static str>;
}

/// An entry of a campaign: the common keys and its own.
macro_rules! record_entry {
    ($(#[$doc:meta])* $entry:ident($file:ty) -> $record:ty { $($(#[$own:meta])* $field:ident: $kind:ty,)* }) => {
        $(#[$doc])*
        #[derive(Debug, Clone, Deserialize)]
        #[serde(deny_unknown_fields)]
        pub struct $entry {
            /// Name in the report. Default: that of the file.
            pub name: Option<String>,
            file: $file,
            #[serde(default, deserialize_with = "super::channel::one")]
            channel: Option<String>,
            unit: Option<String>,
            calibration: Option<f64>,
            rate: Option<f64>,
            base_band: Option<f64>,
            format: Option<String>,
            #[serde(default)]
            allow_missing: bool,
            decimal: Option<Decimal>,
            #[serde(default)]
            complex: bool,
            $($(#[$own])* #[serde(default)] pub $field: $kind,)*
        }

        impl Common for $entry {
            fn without_file(&self) -> Option<&'static str> {
                let given = [
                    ("channel", self.channel.is_some()),
                    ("unit", self.unit.is_some()),
                    ("calibration", self.calibration.is_some()),
                    ("rate", self.rate.is_some()),
                    ("base_band", self.base_band.is_some()),
                    ("format", self.format.is_some()),
                    ("allow_missing", self.allow_missing),
                    ("decimal", self.decimal.is_some()),
                    ("complex", self.complex),
                ];
                given.into_iter().find(|(_, given)| *given && !self.file.named()).map(|(key, _)| key)
            }
        }

        impl $entry {
            /// The common keys, with the file.
            pub fn record(&self) -> $record {
                self.file.record(|file| RecordEntry {
                    name: self.name.clone(),
                    file,
                    channel: self.channel.clone(),
                    unit: self.unit.clone(),
                    calibration: self.calibration,
                    rate: self.rate,
                    base_band: self.base_band,
                    format: self.format.clone(),
                    allow_missing: self.allow_missing,
                    decimal: self.decimal,
                    complex: self.complex,
                })
            }
        }
    };
}

record_entry! {
    /// Frequency response functions.
    FrfEntry(Spanned<PathBuf>) -> RecordEntry {
        /// Band in Hz whose peaks are fitted together. Default: a band around each peak.
        band: Option<(f64, f64)>,
        /// Mass in kg for the stiffness.
        mass: Option<f64>,
        /// File with the coherence of the same lines. Default: a coherence in the file.
        coherence: Option<PathBuf>,
        /// Lines of a lower coherence are left out. Default 0.5.
        least_coherence: Option<f64>,
        /// Channel of the excitation: the function is computed from it to the channel.
        #[serde(deserialize_with = "super::channel::one")]
        reference: Option<String>,
        /// Which noise the function does not mind. Default `h1`.
        estimator: Option<Estimator>,
        /// Samples of a segment.
        segment: Option<usize>,
        /// Part of a segment that it shares with the next.
        overlap: Option<f64>,
        /// What is taken out of a segment.
        detrend: Option<Detrend>,
        /// Window by name.
        window: Option<String>,
        /// Integrations in frequency.
        integrate: Option<i8>,
        /// Lowest frequency in Hz.
        fmin: Option<f64>,
        /// The excitation is a hammer.
        hammer: bool,
        /// Width of the force window in s.
        force_window: Option<f64>,
        /// What an exponential window leaves at the end of a record.
        left_at_end: Option<f64>,
        /// Time in s by which the channel was recorded late.
        delay: Option<f64>,
    }
}

record_entry! {
    /// A spectrum, or a frequency response function that is drawn without its modes.
    SpectrumEntry(Spanned<PathBuf>) -> RecordEntry {
        /// `welch` or `fft`.
        method: Option<Method>,
        /// Samples of a segment.
        segment: Option<usize>,
        /// Part of a segment that it shares with the next.
        overlap: Option<f64>,
        /// What is taken out of a segment.
        detrend: Option<Detrend>,
        /// Window by name.
        window: Option<String>,
        /// `peak`, `rms`, `power` or `psd`.
        scaling: Option<Scaling>,
        /// Integrations in frequency.
        integrate: Option<i8>,
        /// Lowest frequency in Hz.
        fmin: Option<f64>,
        /// Reference of levels in decibels.
        decibel: Option<f64>,
        /// Sines fitted to the whole record.
        tones: Option<usize>,
        /// Channel of the excitation.
        #[serde(deserialize_with = "super::channel::one")]
        reference: Option<String>,
        /// Which noise the function does not mind. Default `h1`.
        estimator: Option<Estimator>,
        /// The excitation is a hammer.
        hammer: bool,
        /// Width of the force window in s.
        force_window: Option<f64>,
        /// What an exponential window leaves at the end of a record.
        left_at_end: Option<f64>,
        /// Time in s by which the channel was recorded late.
        delay: Option<f64>,
    }
}

record_entry! {
    /// A trace of impacts.
    ImpactsEntry(Spanned<PathBuf>) -> RecordEntry {
        /// Frequency of the excitation in Hz.
        excitation: Option<f64>,
        /// Its standard uncertainty in Hz. Default: that of its digits.
        excitation_std: Option<f64>,
        /// Channel of the same file that rises once a cycle of the excitation.
        #[serde(deserialize_with = "super::channel::one")]
        reference: Option<String>,
        /// Lowest impact, as part of the median one. Default 1/8.
        threshold: Option<f64>,
        /// Pause in s that parts two impacts. Default: found from the trace.
        refractory: Option<f64>,
        /// Mains hum is left in the trace.
        keep_hum: bool,
        /// Record of one pulse of the shape that all have.
        shape: Option<PathBuf>,
        /// Its sampling rate in Hz, where its file does not say.
        shape_rate: Option<f64>,
        /// What is known to scatter: onsets, intervals, or (default) unknown.
        scatter: Scatter,
        /// No impact is missing: long intervals are intervals.
        none_missed: bool,
    }
}

record_entry! {
    /// A drop test: a file, or numbers without one.
    DropEntry(Option<Spanned<PathBuf>>) -> Option<RecordEntry> {
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
        /// Mains hum is left in the trace.
        keep_hum: bool,
        /// Time from first to second impact in s, instead of a file.
        interval: Option<f64>,
        /// Its standard uncertainty in s.
        interval_std: Option<f64>,
        /// Times between successive impacts of one train in s, instead of a file.
        intervals: Vec<f64>,
        /// Masses in kg: the striking and the struck one.
        masses: Option<(f64, f64)>,
        /// Velocities of both masses before the impact, m/s.
        before: Option<(f64, f64)>,
        /// Velocities after it: of both masses, or of mass 1 alone where masses are given.
        after: Vec<f64>,
        /// Velocity of mass 2 after it, where that of mass 1 is not known and masses are given.
        after2: Option<f64>,
        /// Standard uncertainty of each velocity, m/s.
        velocity_std: Option<f64>,
    }
}

record_entry! {
    /// A contact pulse: a file, or two times without one.
    PulseEntry(Option<Spanned<PathBuf>>) -> Option<RecordEntry> {
        /// Mass in kg that is decelerated.
        mass: Option<f64>,
        /// Corner of the instrument's Butterworth low-pass in Hz, or `none`. Default: not known, and no uncertainty.
        low_pass: Option<LowPass>,
        /// Its order.
        order: Option<usize>,
        /// Time from the onset to the largest force in s, instead of a file.
        time_to_peak: Option<f64>,
        /// Time from the onset to the end of the contact in s.
        duration: Option<f64>,
        /// Standard uncertainty of each of the two times in s.
        std: Option<f64>,
    }
}

record_entry! {
    /// A hammer-drill trace.
    DrillEntry(Spanned<PathBuf>) -> RecordEntry {
        /// Velocity channel.
        #[serde(deserialize_with = "super::channel::one")]
        velocity: Option<String>,
        /// Channel with the pulses of the crank.
        #[serde(deserialize_with = "super::channel::one")]
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
        /// Longest drop-out that is bridged, s.
        longest_dropout: Option<f64>,
        /// Time in s by which the velocity was recorded later than the reference.
        delay: Option<f64>,
        /// Phases of the average.
        points: Option<usize>,
        /// Margin in dB by which motion must stand above the noise.
        margin: Option<f64>,
        /// Corner of the zero-phase low-pass, Hz, or `none`.
        low_pass: Option<LowPass>,
        /// Time constant of exponential smoothing, s.
        smoothing: Option<f64>,
        /// Highest frequency that the instrument passes, Hz.
        instrument: Option<f64>,
        /// Record without motion.
        noise: Option<PathBuf>,
        /// Acceleration channels of a handle.
        #[serde(deserialize_with = "super::channel::several")]
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
        if let Some(name) = self.format.as_deref().filter(|n| Format::from_name(n).is_none()) {
            return Err(format!("the format {name:?} is not one of {}", Format::names().join(", ")));
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
            .format(self.format.as_deref().and_then(Format::from_name))
            .allow_missing(self.allow_missing)
            .decimal_comma(self.decimal.map(|d| d == Decimal::Comma))
            .complex(self.complex)
    }
}

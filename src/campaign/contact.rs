//! What entries of impacts and of pulses must have, or may not have together.

use super::fault::{Fault, fault};
use super::{ImpactsEntry, LowPass, PulseEntry};
use crate::error::Result;
use crate::measure::pulse::Instrument;

impl ImpactsEntry {
    pub(super) fn check_keys(&self) -> std::result::Result<(), Fault> {
        if self.reference.is_some() && self.excitation.is_some() {
            return Err(fault("excitation", "both reference and excitation", "one of them"));
        }
        if self.excitation_std.is_some() && self.excitation.is_none() {
            return Err(fault("excitation_std", "excitation_std without excitation", "both, or none"));
        }
        if self.shape_rate.is_some() && self.shape.is_none() {
            return Err(fault("shape_rate", "shape_rate without shape", "both, or none"));
        }
        match self.shape_rate.filter(|r| !(r.is_finite() && *r > 0.0)) {
            Some(rate) => Err(fault("shape_rate", format!("shape_rate = {rate}"), "a finite number above 0")),
            None => Ok(()),
        }
    }
}

impl PulseEntry {
    /// What the instrument did to the pulse.
    ///
    /// # Errors
    /// As [`Instrument::stated`].
    pub fn instrument(&self) -> Result<Instrument> {
        Instrument::stated(self.low_pass.map(LowPass::corner), self.order)
    }

    pub(super) fn check_keys(&self) -> std::result::Result<(), Fault> {
        let times = self.time_to_peak.is_some();
        if times != self.duration.is_some() {
            let key = if times { "time_to_peak" } else { "duration" };
            return Err(fault(key, "only one of time_to_peak and duration", "both, or none"));
        }
        if self.std.is_some() && !times {
            return Err(fault("std", "std without time_to_peak and duration", "both times"));
        }
        match (self.record().is_some(), times) {
            (true, true) => return Err(fault("time_to_peak", "a file and two times", "one of them")),
            (false, false) => {
                let expected = "file, or time_to_peak and duration";
                return Err(fault("", "neither a file nor two times", expected));
            }
            _ => {}
        }
        if times && (self.low_pass.is_some() || self.order.is_some()) {
            let key = if self.low_pass.is_some() { "low_pass" } else { "order" };
            return Err(fault(key, format!("{key} beside two times"), "a file, or leave it out"));
        }
        let key = if self.low_pass.is_some() { "low_pass" } else { "order" };
        let expected = "low_pass = HZ and its order, 1 to 10, or low_pass = \"none\"";
        self.instrument().map(drop).map_err(|why| fault(key, why.to_string(), expected))
    }
}

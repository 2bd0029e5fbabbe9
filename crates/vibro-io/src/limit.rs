//! Limit of the memory that a reader may use. It is checked before memory is reserved for a size that a
//! file declares.

use std::sync::atomic::{AtomicU64, Ordering};
use vibro_record::units::notation::significant;
use vibro_record::{Error, Result};

/// Bytes in a GB.
const GB: f64 = 1e9;
/// Memory in bytes that is assumed where the machine's own is unknown.
const UNKNOWN: f64 = 4.0 * GB;
/// Largest fraction of the machine's memory that a hint suggests as a limit. The system and other programs
/// need the rest.
const MOST_OF_MACHINE: f64 = 0.8;

/// Bits of the limit in bytes stated for all readers of the program; 0 where none is stated.
static STATED: AtomicU64 = AtomicU64::new(0);

/// Largest memory in bytes for the values of a file and the results computed from them.
///
/// ```
/// use vibro_io::Limit;
/// assert_eq!(Limit::parse("1.5GB"), Some(Limit(1.5e9)));
/// assert_eq!(Limit::parse("200 MB"), Some(Limit(2e8)));
/// assert_eq!(Limit::parse("much"), None);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Limit(pub f64);

impl Default for Limit {
    /// The limit from [`Limit::state`], else a quarter of the machine's memory.
    fn default() -> Limit {
        let stated = f64::from_bits(STATED.load(Ordering::Relaxed));
        Limit(if stated > 0.0 { stated } else { machine() / 4.0 })
    }
}

impl Limit {
    /// Makes this limit the default of all readers.
    pub fn state(self) {
        STATED.store(self.0.to_bits(), Ordering::Relaxed);
    }

    /// Parses a size above 0, such as `2GB` or `500MB`.
    pub fn parse(text: &str) -> Option<Limit> {
        let text = text.trim().to_uppercase();
        let units = [("TB", 1e12), ("GB", GB), ("MB", 1e6), ("KB", 1e3), ("B", 1.0)];
        let (number, unit) = units.iter().find_map(|(unit, size)| Some((text.strip_suffix(unit)?, size)))?;
        let bytes = number.trim().parse::<f64>().ok()? * unit;
        (bytes.is_finite() && bytes > 0.0).then_some(Limit(bytes))
    }

    /// Checks that `bytes` are within the limit.
    ///
    /// # Errors
    /// If they exceed it: the error states the memory needed and, if the machine has that much, the limit
    /// to set.
    pub(crate) fn hold(self, bytes: f64) -> Result<()> {
        self.hold_or(bytes, |error| error.hint("of several channels, name one").setting("channel"))
    }

    /// As [`Limit::hold`]; `advice` adds the hint for a machine that has too little memory.
    pub(crate) fn hold_or(self, bytes: f64, advice: impl FnOnce(Error) -> Error) -> Result<()> {
        if bytes <= self.0 {
            return Ok(());
        }
        let size = |bytes: f64| {
            let (unit, size) =
                [("GB", GB), ("MB", 1e6)].into_iter().find(|u| bytes >= u.1).unwrap_or(("kB", 1e3));
            format!("{} {unit}", significant(bytes / size, 2))
        };
        let found = format!("it needs {} of memory, the limit is {}", size(bytes), size(self.0));
        let error = Error::usage(found, "");
        // A margin of 10 % for the program itself and for rounding.
        let enough = (1.1 * bytes / GB).max(0.1);
        Err(if enough * GB <= MOST_OF_MACHINE * machine() {
            error.set("max_memory", format!("{}GB", (enough * 10.0).ceil() / 10.0))
        } else {
            advice(error)
        })
    }
}

/// Memory of the machine in bytes; [`UNKNOWN`] on systems without Linux's `/proc/meminfo`.
fn machine() -> f64 {
    let meminfo = std::fs::read_to_string("/proc/meminfo").ok();
    let total =
        meminfo.as_deref().and_then(|text| text.lines().find_map(|line| line.strip_prefix("MemTotal:")));
    let kib = total.and_then(|total| total.trim().strip_suffix("kB")?.trim().parse::<f64>().ok());
    kib.map_or(UNKNOWN, |kib| 1024.0 * kib)
}

#[cfg(test)]
mod tests;

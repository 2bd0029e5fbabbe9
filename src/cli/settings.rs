//! From what was typed of a sweep to what is meant.

use super::args::{Sweep, Taking};
use crate::analysis::{self, sweep};
use crate::campaign::above_zero;
use crate::error::Result;
use crate::measure::response::{ResponseOptions, to_displacement};
use crate::read::{SweepList, SweepReader};
use crate::units::Quantity;
use std::path::Path;

/// The list of a sweep, how to read it, and how to take its response to displacement.
///
/// # Errors
/// On options that contradict each other, an unknown name, or a list that cannot be read.
pub fn listed(typed: &Sweep) -> Result<(SweepList, SweepReader)> {
    let (path, name) = match typed.source.rsplit_once('#') {
        Some((path, name)) if path.to_lowercase().ends_with(".toml") => (path, Some(name)),
        _ => (typed.source.as_str(), None),
    };
    let (list, mut how) = if path.to_lowercase().ends_with(".toml") {
        sweep::named(&analysis::open(path)?, name, typed.allow_outside)?
    } else {
        (SweepList::from_path(path, typed.allow_outside)?, SweepReader::default())
    };
    if how.name.is_empty() {
        how.name = Path::new(path).file_stem().map_or_else(String::new, |s| s.to_string_lossy().into_owned());
    }
    above_zero("fmin", typed.fmin)?;
    typed.stored.apply(&mut how)?;
    Ok((list, how))
}

/// How responses are taken; the stored quantity decides how often to integrate where that was not typed.
pub fn taking(typed: &Taking, fmin: Option<f64>, stored: Quantity) -> ResponseOptions {
    ResponseOptions {
        band: usize::from(typed.band),
        integrate: typed.integrate.unwrap_or_else(|| to_displacement(stored)),
        fmin,
    }
}

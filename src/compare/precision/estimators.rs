//! Estimators of what is measured, on scenes with a known truth.

use super::{FailureMap, Family, Scene};
use crate::Result;

/// Every scene of the estimators, each method measured; `quick` takes fewer settings and repeats.
///
/// # Errors
/// If a scene cannot be built.
pub fn scenes(_quick: bool, _progress: &mut dyn FnMut(&str)) -> Result<Vec<Scene>> {
    Ok(Vec::new())
}

/// What the estimators do at their borders.
///
/// # Errors
/// If a scene cannot be built.
pub fn failures(_quick: bool) -> Result<FailureMap> {
    Ok(FailureMap { family: Family::Estimators, cells: Vec::new() })
}

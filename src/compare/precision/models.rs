//! Models of the motion, on scenes with a known truth.

use super::{FailureMap, Family, Scene};
use crate::Result;

/// Every scene of the models, each method measured; `quick` takes fewer settings and repeats.
///
/// # Errors
/// If a scene cannot be built.
pub fn scenes(_quick: bool, _progress: &mut dyn FnMut(&str)) -> Result<Vec<Scene>> {
    Ok(Vec::new())
}

/// What the models do at their borders.
///
/// # Errors
/// If a scene cannot be built.
pub fn failures(_quick: bool) -> Result<FailureMap> {
    Ok(FailureMap { family: Family::Models, cells: Vec::new() })
}

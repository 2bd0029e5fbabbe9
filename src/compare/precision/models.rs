//! Models of the motion, on scenes with a known truth.

mod entry;
mod ours;
mod rivals;
mod scene_b;
mod task;

use super::{FailureMap, Family, Scene};
use crate::Result;

/// Every scene of the models, each method measured; `quick` takes fewer settings and repeats.
///
/// # Errors
/// If a scene cannot be built.
pub fn scenes(quick: bool, progress: &mut dyn FnMut(&str)) -> Result<Vec<Scene>> {
    let mut found = Vec::new();
    for seconds in [2.0, 100.0] {
        progress(&format!("scene B over {seconds} s"));
        found.push(scene_b::scene(seconds, quick));
    }
    Ok(found)
}

/// What the models do at their borders.
///
/// # Errors
/// If a scene cannot be built.
pub fn failures(_quick: bool) -> Result<FailureMap> {
    Ok(FailureMap { family: Family::Models, cells: Vec::new() })
}

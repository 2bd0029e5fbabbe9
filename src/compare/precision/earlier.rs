//! What an earlier run measured, on another machine perhaps.

use std::path::Path;

use serde::Deserialize;

use super::Scene;
use super::measured::front;
use crate::{Error, Result};

#[derive(Deserialize)]
struct Earlier {
    scenes: Vec<Scene>,
}

/// The scenes of what `vibro precision --json` printed, with their fronts marked anew.
///
/// # Errors
/// If the file cannot be read, is something else, has a time, an error or a bound that is not above 0, or a method
/// that failed with an error, or did not without one.
pub fn scenes(path: &Path) -> Result<Vec<Scene>> {
    let text = std::fs::read_to_string(path).map_err(|e| Error::io("read", path, e))?;
    let wrong = |found: String| {
        Error::usage(format!("{}: {found}", path.display()), "what `vibro precision --json` printed")
            .hint("write it with `vibro precision --json > FILE`; the CSV of --out holds less")
    };
    let Earlier { mut scenes } = serde_json::from_str(&text).map_err(|e| wrong(e.to_string()))?;
    for scene in &mut scenes {
        let impossible = |v: f64| !(v.is_finite() && v > 0.0);
        if let Some(bound) = scene.bound.filter(|b| impossible(*b)) {
            return Err(wrong(format!("scene {} has bound {bound}", scene.name)));
        }
        // An error of 0 is one below what the truth resolves.
        let bad = |m: &&super::Measured| {
            impossible(m.time_ns) || m.error.is_some_and(|e| e != 0.0 && impossible(e))
        };
        if let Some(m) = scene.methods.iter().find(bad) {
            return Err(wrong(format!(
                "scene {}, {} {}: time {} ns, error {:?}",
                scene.name, m.method, m.setting, m.time_ns, m.error
            )));
        }
        if let Some(m) = scene.methods.iter().find(|m| m.failed == m.error.is_some()) {
            return Err(wrong(format!(
                "scene {}, {} {}: failed is {}, and the error {:?}",
                scene.name, m.method, m.setting, m.failed, m.error
            )));
        }
        front(scene.family, &mut scene.methods);
    }
    Ok(scenes)
}

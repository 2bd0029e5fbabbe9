//! Lines of other programs, measured by them on the same scenes.

use std::path::Path;

use serde::Deserialize;

use super::measured::front;
use super::{Measured, Scene};
use crate::{Error, Result};

/// What another program has measured: one method with one setting on one scene.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
struct Added {
    scene: String,
    /// Program, version and method.
    method: String,
    #[serde(default)]
    setting: String,
    error: Option<f64>,
    time_ns: f64,
    why: Option<String>,
}

/// Adds the lines of a JSON file, a list of objects with `scene`, `method`, `setting`, `error`, `time_ns` and `why`, to the
/// scenes that they name, and marks the fronts anew. Lines of scenes that were not measured are left out; gives their count.
///
/// # Errors
/// If the file cannot be read, is not such a list, or has a time or an error that is not above 0.
pub fn add(scenes: &mut [Scene], path: &Path) -> Result<usize> {
    let text = std::fs::read_to_string(path).map_err(|e| Error::io("read", path, e))?;
    let wrong = |found: String| {
        Error::usage(
            format!("{}: {found}", path.display()),
            "a list of lines as benches/peers/peers.py writes them",
        )
    };
    let lines: Vec<Added> = serde_json::from_str(&text).map_err(|e| wrong(e.to_string()))?;
    let mut left = 0;
    for line in lines {
        if [Some(line.time_ns), line.error].iter().flatten().any(|v| !(v.is_finite() && *v > 0.0)) {
            return Err(wrong(format!(
                "{} has time {} ns, error {:?}",
                line.method, line.time_ns, line.error
            )));
        }
        let Some(scene) = scenes.iter_mut().find(|s| s.name == line.scene) else {
            left += 1;
            continue;
        };
        let failed = line.error.is_none();
        scene.methods.push(Measured {
            method: line.method,
            setting: line.setting,
            ours: false,
            error: line.error,
            error_spread: None,
            time_ns: line.time_ns,
            time_spread: None,
            failed,
            why: line.why.or_else(|| failed.then(|| "no answer".to_owned())),
            front: false,
        });
        front(scene.family, &mut scene.methods);
    }
    Ok(left)
}

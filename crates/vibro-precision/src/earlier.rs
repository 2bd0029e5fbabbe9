//! What an earlier run measured, on another machine perhaps.

use std::path::Path;

use serde::Deserialize;

use super::measured::front;
use super::{Cell, FailureMap, Family, Scene};
use vibro_record::{Error, Result};

/// What `vibro precision --json` printed.
#[derive(Debug, Clone, PartialEq)]
pub struct Earlier {
    /// Its scenes.
    pub scenes: Vec<Scene>,
    /// A map of each family of which it holds cells.
    pub maps: Vec<FailureMap>,
}

#[derive(Deserialize)]
struct Printed {
    scenes: Vec<Scene>,
    #[serde(default)]
    failures: Vec<Failure>,
}

#[derive(Deserialize)]
struct Failure {
    family: Family,
    #[serde(flatten)]
    cell: Cell,
}

impl Earlier {
    /// Reads it; fronts are marked anew.
    ///
    /// # Errors
    /// If the file cannot be read, is something else, has a time, an error or a bound that is not above 0, or a method
    /// that failed with an error, or did not without one.
    pub fn from_path(path: &Path) -> Result<Earlier> {
        let text = std::fs::read_to_string(path).map_err(|e| Error::io("read", path, e))?;
        let wrong = |found: String| {
            Error::usage(format!("{}: {found}", path.display()), "what `vibro precision --json` printed")
                .hint("write it with `vibro precision --json > FILE`; the CSV of --out holds less")
        };
        let Printed { mut scenes, failures } =
            serde_json::from_str(&text).map_err(|e| wrong(e.to_string()))?;
        for scene in &mut scenes {
            check(scene).map_err(wrong)?;
            front(scene.family, &mut scene.methods);
        }
        Ok(Earlier { scenes, maps: maps(failures) })
    }

    /// Leaves out what belongs to another family.
    pub fn retain(&mut self, wanted: impl Fn(Family) -> bool) {
        self.scenes.retain(|scene| wanted(scene.family));
        self.maps.retain(|map| wanted(map.family));
    }
}

/// What cannot have been measured.
fn check(scene: &Scene) -> std::result::Result<(), String> {
    let impossible = |v: f64| !(v.is_finite() && v > 0.0);
    if let Some(bound) = scene.bound.filter(|b| impossible(*b)) {
        return Err(format!("scene {} has bound {bound}", scene.name));
    }
    for m in &scene.methods {
        let of = format!("scene {}, {} {}", scene.name, m.method, m.setting);
        let error = m.error.map_or("none".to_owned(), |e| e.to_string());
        // An error of 0 is one below what the truth resolves.
        if impossible(m.time_ns) || m.error.is_some_and(|e| e != 0.0 && impossible(e)) {
            return Err(format!("{of}: time {} ns, error {error}", m.time_ns));
        }
        if m.failed == m.error.is_some() {
            return Err(format!("{of}: failed is {}, and the error {error}", m.failed));
        }
    }
    Ok(())
}

/// The cells of each family, in their order.
fn maps(failures: Vec<Failure>) -> Vec<FailureMap> {
    let mut maps: Vec<FailureMap> = Vec::new();
    for Failure { family, cell } in failures {
        match maps.iter_mut().find(|map| map.family == family) {
            Some(map) => map.cells.push(cell),
            None => maps.push(FailureMap { family, cells: vec![cell] }),
        }
    }
    maps
}

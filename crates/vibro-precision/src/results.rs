//! The results of one run of the benchmarks, and those measured by other programs.

use super::{BenchmarkScene, BorderCell, FailureMap, Family, MeasuredMethod};
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use std::path::Path;
use vibro_record::{Error, Result};

/// The results that `vibro precision --json` prints and reads.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Results {
    /// The scenes.
    pub scenes: Vec<BenchmarkScene>,
    /// Outcomes at the borders; empty where these were not run.
    #[serde(default, skip_serializing_if = "FailureMap::is_empty")]
    pub failures: FailureMap,
}

/// A scene that is still to be measured.
///
/// # Errors
/// If it cannot be built.
pub type Measurement = Box<dyn FnOnce() -> Result<BenchmarkScene>>;

/// A result of another program: one method with one setting on one scene.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct AddedMeasurement {
    scene: String,
    /// Program, version and method.
    method: String,
    #[serde(default)]
    setting: String,
    error: Option<f64>,
    time_ns: f64,
    why: Option<String>,
}

impl Results {
    /// The scenes of a family, still to be measured; `quick` takes fewer settings, repeats, records and
    /// cycles.
    pub fn scenes_of(family: Family, quick: bool) -> Vec<Measurement> {
        match family {
            Family::Models => crate::models::scenes(quick),
            Family::Estimators => crate::estimators::scenes(quick),
        }
    }

    /// The outcomes at the borders of a family.
    ///
    /// # Errors
    /// If a border cannot be built.
    pub fn failures_of(family: Family, quick: bool) -> Result<FailureMap> {
        match family {
            Family::Models => crate::models::failures(quick),
            Family::Estimators => Ok(crate::estimators::failures(quick)),
        }
    }

    /// Adds a scene.
    pub fn push(&mut self, mut scene: BenchmarkScene) {
        scene.mark_front();
        self.scenes.push(scene);
    }

    /// Reads the results of an earlier run, perhaps of another machine, and marks the fronts again.
    ///
    /// # Errors
    /// If the file cannot be read or holds something else, or a time or an error in it is no positive number.
    pub fn from_path(path: &Path) -> Result<Results> {
        let mut results: Results = read(path, "what `vibro precision --json` printed")?;
        for scene in &mut results.scenes {
            for method in &scene.methods {
                check(path, &scene.name, method)?;
            }
            scene.mark_front();
        }
        Ok(results)
    }

    /// Adds results from a JSON file, a list of objects with `scene`, `method`, `setting`, `error`, `time_ns`
    /// and `why`, to the scenes that they name, and marks the fronts again. Returns the scenes named that
    /// were not measured; their results are left out.
    ///
    /// # Errors
    /// If the file cannot be read or is no such list, if a time or an error in it is no positive number, or
    /// if it gives a method the name of one of this library's, with which it would be confused.
    pub fn add(&mut self, path: &Path) -> Result<Vec<String>> {
        let lines: Vec<AddedMeasurement> =
            read(path, "a list of lines, each with scene, method, error and time_ns")?;
        let ours = |m: &MeasuredMethod| m.ours.then(|| m.method.clone());
        let our_methods: Vec<String> =
            self.scenes.iter().flat_map(|s| s.methods.iter().filter_map(ours)).collect();
        let mut unknown_scenes = Vec::new();
        for AddedMeasurement { scene, method, setting, error, time_ns, why } in lines {
            let answer = error.ok_or_else(|| why.unwrap_or_else(|| "no answer".to_owned()));
            let line = MeasuredMethod {
                other_program: true,
                ..MeasuredMethod::new((&method, false), setting, time_ns, answer)
            };
            check(path, &scene, &line)?;
            if our_methods.contains(&method) {
                let found = format!("{}: {scene}, {method}: a method of this library", path.display());
                return Err(Error::usage(found, "the name of the other program"));
            }
            match self.scenes.iter_mut().find(|s| s.name == scene) {
                Some(scene) => scene.methods.push(line),
                None => unknown_scenes.push(scene),
            }
        }
        self.scenes.iter_mut().for_each(BenchmarkScene::mark_front);
        Ok(unknown_scenes)
    }

    /// Keeps the wanted families only.
    pub fn retain(&mut self, wanted: impl Fn(Family) -> bool) {
        self.scenes.retain(|scene| wanted(scene.family));
        self.failures.cells.retain(|cell: &BorderCell| wanted(cell.family));
    }
}

/// The content of a JSON file.
fn read<T: DeserializeOwned>(path: &Path, expected: &str) -> Result<T> {
    let text = std::fs::read_to_string(path).map_err(|e| Error::io("read", path, e))?;
    serde_json::from_str(&text).map_err(|e| Error::usage(format!("{}: {e}", path.display()), expected))
}

/// Refuses a time or an error that cannot have been measured.
fn check(path: &Path, scene: &str, m: &MeasuredMethod) -> Result<()> {
    // An error of 0 means below the resolution of the truth.
    let numbers = [("time_ns", Some(m.time_ns)), ("error", m.error.filter(|e| *e != 0.0))];
    for (key, value) in numbers {
        if let Some(value) = value.filter(|v| !(v.is_finite() && *v > 0.0)) {
            let found = format!("{}: {scene}, {} {}: {key} is {value}", path.display(), m.method, m.setting);
            return Err(Error::usage(found, "a number above 0"));
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_peer_does_not_take_the_name_of_one_of_our_methods() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("peer.json");
        let method = |name: &str, ours| MeasuredMethod::new((name, ours), String::new(), 1e3, Ok(1e-9));
        let methods = vec![method("exact flights", true), method("Euler loop", false)];
        let scene = BenchmarkScene { methods, ..BenchmarkScene::new(Family::Models, ["one", "", "", ""]) };
        let mut results = Results { scenes: vec![scene], ..Results::default() };
        let mut added = |name: &str| {
            let line = format!(r#"[{{"scene": "one", "method": "{name}", "error": 1e-12, "time_ns": 1.0}}]"#);
            std::fs::write(&path, line).unwrap();
            results.add(&path)
        };
        assert!(added("a peer").unwrap().is_empty());
        assert!(added("Euler loop").unwrap().is_empty());
        assert!(added("exact flights").unwrap_err().to_string().contains("of this library"));
    }
}

//! Lines of other programs, measured by them on the same scenes.

use std::collections::{BTreeMap, HashSet};
use std::path::Path;

use serde::Deserialize;

use super::measured::front;
use super::{Measured, Scene};
use vibro_record::{Error, Result};

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
/// scenes that they name, and marks the fronts anew. Lines of scenes that were not measured are left out; gives a sentence on each such scene, and on an empty list.
///
/// # Errors
/// If the file cannot be read, is not such a list, has a time or an error that is not above 0, or gives a method no name, or that of one of
/// this library's, whose line it would become.
pub fn add(scenes: &mut [Scene], path: &Path) -> Result<Vec<String>> {
    let text = std::fs::read_to_string(path).map_err(|e| Error::io("read", path, e))?;
    let wrong = |found: String, expected: &str| {
        Error::usage(format!("{}: {found}", path.display()), expected)
            .hint("`vibro precision --help` and docs/precision.md show a file of lines")
    };
    let lines: Vec<Added> = serde_json::from_str(&text)
        .map_err(|e| wrong(e.to_string(), "a list of lines, each with scene, method, error and time_ns"))?;
    if lines.is_empty() {
        return Ok(vec![format!("{}: the list holds no lines.", path.display())]);
    }
    let own: HashSet<String> =
        scenes.iter().flat_map(|s| &s.methods).filter(|m| m.ours).map(|m| m.method.clone()).collect();
    let mut left: BTreeMap<String, usize> = BTreeMap::new();
    for (number, line) in (1..).zip(lines) {
        let of = format!("line {number} of the list ({}, {:?})", line.scene, line.method);
        for (key, value) in [("time_ns", Some(line.time_ns)), ("error", line.error)] {
            if let Some(value) = value.filter(|v| !(v.is_finite() && *v > 0.0)) {
                let failed = if key == "error" { "; null where the method failed" } else { "" };
                return Err(wrong(format!("{of}: {key} is {value}"), &format!("a number above 0{failed}")));
            }
        }
        if line.method.trim().is_empty() {
            return Err(wrong(format!("{of}: no method is named"), "the name of the other program"));
        }
        let Some(scene) = scenes.iter_mut().find(|s| s.name == line.scene) else {
            *left.entry(line.scene).or_default() += 1;
            continue;
        };
        if own.contains(&line.method) {
            return Err(wrong(
                format!("{of}: {:?} is the name of a method of this library", line.method),
                "the name of the other program",
            ));
        }
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
    let known = scenes.iter().map(|s| format!("{:?}", s.name)).collect::<Vec<_>>().join(", ");
    let sentence = |(scene, count): (String, usize)| {
        let lines = if count == 1 { "1 line is".to_owned() } else { format!("{count} lines are") };
        format!(
            "{}: {lines} left out, of the scene {scene:?}, which was not measured; these were: {known}.",
            path.display()
        )
    };
    Ok(left.into_iter().map(sentence).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Family;

    #[test]
    fn a_peer_does_not_take_the_name_of_one_of_our_methods() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("peer.json");
        let method = |method: &str, ours| Measured {
            method: method.to_owned(),
            setting: String::new(),
            ours,
            error: Some(1e-9),
            error_spread: None,
            time_ns: 1e3,
            time_spread: None,
            failed: false,
            why: None,
            front: true,
        };
        let mut scenes = [Scene {
            name: "one".into(),
            family: Family::Models,
            says: String::new(),
            error_of: String::new(),
            truth: String::new(),
            bound: None,
            methods: vec![method("exact flights", true), method("Euler loop", false)],
        }];
        let mut added = |name: &str| {
            let line = format!(r#"[{{"scene": "one", "method": "{name}", "error": 1e-12, "time_ns": 1.0}}]"#);
            std::fs::write(&path, line).unwrap();
            add(&mut scenes, &path)
        };
        assert!(added("a peer").unwrap().is_empty());
        assert!(added("Euler loop").unwrap().is_empty());
        assert!(added("exact flights").unwrap_err().to_string().contains("of this library"));
        assert!(added(" ").unwrap_err().to_string().contains("no method is named"));
        std::fs::write(&path, "[]").unwrap();
        assert!(add(&mut scenes, &path).unwrap()[0].contains("no lines"));
    }
}

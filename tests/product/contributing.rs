//! Every file and every name of the code that CONTRIBUTING.md mentions exists.

use super::layers::files;
use std::fs;
use std::path::{Path, PathBuf};

/// Whether a text between backticks is a path rather than a command or a piece of code.
fn is_path(name: &str) -> bool {
    let ends = [".rs", ".md", ".toml", ".sh", ".gz"].iter().any(|end| name.ends_with(end));
    (ends || name.contains('/')) && !name.contains([' ', '"']) && !name.starts_with(['.', '/'])
}

#[test]
fn what_is_named_is_there() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let text = fs::read_to_string(root.join("CONTRIBUTING.md")).unwrap();
    // Paths relative to the root, with a leading slash.
    let shown = |path: PathBuf| format!("/{}", path.strip_prefix(root).unwrap().display());
    let paths: Vec<String> = files(root).into_iter().map(shown).collect();
    let source = |path: &&String| {
        [".rs", ".toml", ".js", ".ci/run"].iter().any(|end| path.ends_with(end))
            && !path.ends_with("/contributing.rs")
    };
    let code: Vec<String> =
        paths.iter().filter(source).map(|path| fs::read_to_string(root.join(&path[1..])).unwrap()).collect();
    let named: Vec<&str> = text.split('`').skip(1).step_by(2).filter(|name| !name.contains("NAME")).collect();
    let (mut missing, mut seen) = (Vec::new(), [0, 0]);
    for name in named {
        if is_path(name) {
            seen[0] += 1;
            // A file, or a folder.
            let (file, folder) = (format!("/{name}"), format!("/{}/", name.trim_end_matches('/')));
            if !paths.iter().any(|path| path.ends_with(&file) || path.contains(&folder)) {
                missing.push(name);
            }
        } else if name.chars().all(|c| c.is_alphanumeric() || "_:-".contains(c)) && !name.contains("---") {
            seen[1] += 1;
            let words = name.split(':').filter(|word| !word.is_empty());
            if !words.clone().all(|word| code.iter().any(|text| text.contains(word))) {
                missing.push(name);
            }
        }
    }
    assert!(missing.is_empty(), "not in the project: {missing:?}");
    assert!(seen[0] > 25 && seen[1] > 30, "{seen:?}");
}

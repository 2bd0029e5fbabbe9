//! Measurement files of other people, which are not part of the project.

use std::io::Write as _;
use std::path::{Path, PathBuf};

/// The folder of this name under `../shared/data`. If it is absent, prints a line for `.ci/run`, which
/// counts skipped tests. The line bypasses the capture of the test harness, which would swallow
/// `eprintln!`.
pub fn folder(name: &str) -> Option<PathBuf> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/data").join(name);
    if path.is_dir() {
        return Some(path);
    }
    let test = std::thread::current().name().unwrap_or("a test").to_owned();
    writeln!(std::io::stderr(), "skipped: {test}: ../shared/data/{name} is absent").expect("standard error");
    None
}

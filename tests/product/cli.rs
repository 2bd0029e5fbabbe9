//! The command line as a user or a program meets it: exit codes, JSON keys, error messages.

mod answers;
mod blows;
mod campaign;
mod choose;
mod complaints;
mod contact;
mod convert;
mod documents;
mod faulty;
mod impacts;
mod init;
mod kept;
mod many;
mod model;
mod modes;
#[cfg(feature = "sheets")]
mod parts;
mod periodic;
mod precision;
mod ranges;
pub mod rig;
mod safe;
mod series;
mod shards;
mod simulate;
mod spectrum;
mod springs;
mod stepped;
mod sweeps;

use serde_json::Value;
use std::path::Path;
use std::process::{Command, Output};

/// Runs `vibro` with these arguments.
fn vibro<S: AsRef<std::ffi::OsStr>>(arguments: &[S]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_vibro")).args(arguments).output().expect("vibro starts")
}

/// Runs `vibro … --json`, expects exit code 0 and returns the JSON object.
fn json<S: AsRef<std::ffi::OsStr>>(arguments: &[S]) -> Value {
    let mut command = Command::new(env!("CARGO_BIN_EXE_vibro"));
    let output = command.args(arguments).arg("--json").output().expect("vibro starts");
    let stderr = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(0), "{stderr}");
    let value: Value = serde_json::from_slice(&output.stdout).expect("one JSON object and nothing else");
    assert!(value["warnings"].is_array(), "every result carries warnings");
    value
}

/// Runs `vibro`, expects this exit code and an empty standard output, and returns the error message.
fn complaint<S: AsRef<std::ffi::OsStr>>(arguments: &[S], code: i32) -> String {
    let output = vibro(arguments);
    let stderr = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(code), "{stderr}");
    assert!(output.stdout.is_empty(), "{}", String::from_utf8_lossy(&output.stdout));
    assert!(!stderr.contains("panicked"), "{stderr}");
    stderr
}

fn text(path: &Path) -> &str {
    path.to_str().expect("a path in UTF-8")
}

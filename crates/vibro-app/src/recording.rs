//! A file as the page lists it.

use crate::words;
use serde::Serialize;
use std::path::Path;
use vibroimpact::read::{Folder, Header, Reader};

/// A file: what it is, and its records as far as its head shows them.
#[derive(Debug, Clone, Serialize)]
pub struct SeenRecording {
    /// Its name in the folder.
    pub path: String,
    /// Its length.
    pub bytes: u64,
    /// Its format in words; empty if it cannot be read.
    pub format: &'static str,
    /// Its records.
    pub records: Vec<Header>,
    /// Why it cannot be read.
    pub problem: Option<String>,
}

impl SeenRecording {
    /// A file of a folder.
    pub fn of(folder: &Folder, path: &Path) -> SeenRecording {
        let bytes = folder.stamp(path).map_or(0, |(bytes, _)| bytes);
        let name = path.strip_prefix(folder.root()).unwrap_or(path).display().to_string();
        match Reader::new().within(folder).survey(path) {
            Ok((format, records, _)) => {
                SeenRecording { path: name, bytes, format: format.name(), records, problem: None }
            }
            Err(error) => {
                let (format, records, problem) = ("", Vec::new(), Some(words::error(&error)));
                SeenRecording { path: name, bytes, format, records, problem }
            }
        }
    }
}

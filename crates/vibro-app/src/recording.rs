//! A file as the page lists it.

use crate::words;
use serde::Serialize;
use std::path::Path;
use vibroimpact::read::{Folder, Header, Reader, is_missing};

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
    /// Why it cannot be read, or not without missing values: then it has records.
    pub problem: Option<String>,
}

impl SeenRecording {
    /// A file of a folder.
    pub fn of(folder: &Folder, path: &Path) -> SeenRecording {
        let bytes = folder.stamp(path).map_or(0, |(bytes, _)| bytes);
        let name = path.strip_prefix(folder.root()).unwrap_or(path).display().to_string();
        let survey = |missing| Reader::new().within(folder).allow_missing(missing).survey(path);
        let as_it_is = survey(false);
        let problem = as_it_is.as_ref().err().map(words::error);
        // What lacks some values has records all the same.
        let found = as_it_is.or_else(|error| if is_missing(&error) { survey(true) } else { Err(error) });
        let (format, records) =
            found.map_or_else(|_| ("", Vec::new()), |(format, all, _)| (format.name(), all));
        SeenRecording { path: name, bytes, format, records, problem }
    }
}

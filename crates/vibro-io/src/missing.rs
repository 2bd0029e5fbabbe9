//! The complaint about values that are missing.

use std::path::Path;
use vibro_record::{Error, Finding, Place, Result};

/// How many places a complaint lists.
pub(super) const LISTED: usize = 8;

/// Refuses missing values; `found` says which.
pub(super) fn refusal(place: Place, found: impl Into<String>) -> Error {
    Error::input(place, found, "a finite number in every place")
        .hint("allow missing values to keep them as such")
        .setting("allow_missing")
}

/// What is said where `count` of them are kept; nothing where there are none.
pub(super) fn kept(count: usize) -> Option<Finding> {
    (count > 0).then(|| Finding::caution("missing-kept").count("n", count))
}

/// Values that are missing: how many, and where the first of them stand.
#[derive(Debug, Default)]
pub(super) struct Missing {
    /// Number of values.
    pub count: usize,
    places: Vec<(u64, String)>,
}

impl Missing {
    /// Counts one value of a line; `what` names the column where it has a name.
    pub fn take(&mut self, line: u64, what: &str) {
        self.count += 1;
        let place = (line, what.to_owned());
        if self.places.len() <= LISTED && self.places.last() != Some(&place) {
            self.places.push(place);
        }
    }

    /// Refuses all of them at once.
    ///
    /// # Errors
    /// If there are any and they are not `allowed`.
    pub fn check(&self, path: &Path, allowed: bool) -> Result<()> {
        let Some((first, _)) = self.places.first().filter(|_| !allowed) else { return Ok(()) };
        let name = |(line, what): &(u64, String)| {
            if what.is_empty() { line.to_string() } else { format!("{line} ({what:?})") }
        };
        let listed: Vec<String> = self.places.iter().take(LISTED).map(name).collect();
        let more = if self.places.len() > LISTED { ", …" } else { "" };
        let (n, listed) = (self.count, listed.join(", "));
        let found = format!("{n} missing value(s) (NaN, Inf or blank) in line(s) {listed}{more}");
        Err(refusal(Place::line(path, *first), found))
    }
}

//! Tables of frequency response functions between the channels of a file.

use super::Table;
use super::folder::FileSeries;
use super::found::FoundTables;
use super::trial::Trial;
use crate::read::repeated;
use std::slice::from_ref;

/// A frequency response needs at least this many segments without overlap.
const LEAST_SEGMENTS: usize = 4;
/// Samples of a segment that always suffice. Where a record gives fewer, the length of its segments is
/// stated.
const LONG_SEGMENT: usize = 8192;

impl Trial<'_> {
    /// The frequency response between two channels: under a lasting excitation, else of hammer blows.
    pub(super) fn frequency_response(
        &self,
        series: &FileSeries,
        name: &str,
        [force, response]: [usize; 2],
    ) -> FoundTables {
        let steady = function(series, name, [force, response], "force and response");
        let steady = match series.headers[response].n / LEAST_SEGMENTS {
            few if few < LONG_SEGMENT => steady.guessed(
                "segment",
                1 << few.max(1).ilog2(),
                "seven averages of half-overlapping segments",
            ),
            _ => steady,
        };
        let blows = hammer_test(series, name, [force, response]);
        match self.first_plausible(&[steady.clone(), blows]) {
            Some(table) => FoundTables::table(table),
            None => self.with_answer(steady),
        }
    }

    /// The tables of a hammer test whose blows are records of their own, each under one name in the file.
    /// `None` if any record of the file would be left out.
    pub(super) fn repeated_blows(&self, series: &FileSeries, name: &str) -> Option<FoundTables> {
        let names: Vec<&str> = series.headers.iter().map(|header| header.name.as_str()).collect();
        let is_first =
            |k: &usize| !names[*k].rsplit_once(" #").is_some_and(|(first, _)| names.contains(&first));
        let (force, responses) = series.force_among((0..names.len()).filter(is_first).collect())?;
        let blows = names.len() / (responses.len() + 1);
        let whole = blows > 1 && blows * (responses.len() + 1) == names.len();
        let is_whole = |k: &usize| whole && repeated(&names, [names[force], names[*k]]).len() == blows;
        if !responses.iter().all(is_whole) {
            return None;
        }
        let tables = responses.iter().map(|response| hammer_test(series, name, [force, *response]));
        let tables: Vec<Table> = tables.collect();
        let plausible = tables.iter().all(|table| self.plausible_answer(from_ref(table)).is_some());
        plausible.then(|| FoundTables { tables, ..FoundTables::default() })
    }
}

/// The table of the function from a force to a response.
fn function(series: &FileSeries, name: &str, [force, response]: [usize; 2], about: &'static str) -> Table {
    let (file, title) = (&series.files[0], format!("{name} {}", series.headers[response].name));
    let table = Table::new("frf", about, file).found("name", title).found("file", file);
    let table = table.found("channel", series.channel(response));
    table.guessed("reference", series.channel(force), "the channel in N")
}

/// The table of a hammer test.
fn hammer_test(series: &FileSeries, name: &str, pair: [usize; 2]) -> Table {
    function(series, name, pair, "a hammer test").guessed("hammer", true, "the force is zero between blows")
}

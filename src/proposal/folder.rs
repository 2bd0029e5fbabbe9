//! The recordings of a folder: lists of sweeps, and files in series.

use super::{KeyStatus, Table};
use crate::analysis::{self, Progress, Recordings};
use crate::campaign::{Campaign, Reading};
use crate::error::{Error, Result};
use crate::read::{Folder, Header, MAGNITUDE, SweepList, is_missing, longest_stretch};
use crate::record::{Fact, Record, Trace, shown};
use crate::report::words::Voice;
use rayon::prelude::*;
use std::collections::HashMap;
use std::path::{Path, PathBuf};

/// Contents of a folder.
#[derive(Debug, Default)]
pub(super) struct Inventory {
    /// Names and paths of list files.
    pub lists: Vec<(String, String)>,
    /// Series of files, in order.
    pub series: Vec<FileSeries>,
    /// Files left out, with the reason: no recordings, or without a sampling rate.
    pub left: Vec<(String, String)>,
}

/// A single file, or a series of files with the same channels whose names differ in one number or whose
/// contents belong together.
#[derive(Debug, Clone)]
pub struct FileSeries {
    /// The common part of their names.
    pub name: String,
    /// Paths within the folder, sorted by the value of their number.
    pub files: Vec<String>,
    /// Channels of the first file.
    pub headers: Vec<Header>,
    /// Pattern that matches all of them and no other file.
    pub pattern: Option<String>,
    /// Whether contents, not names, made it a series.
    pub alike: bool,
    /// Reading options stated for the files.
    pub reading: Reading,
    /// Why only a part of the file is read, if the reading options were chosen so.
    pub part: Option<&'static str>,
}

/// A file, how it is read, and its channels.
struct Member {
    path: PathBuf,
    reading: Reading,
    part: Option<&'static str>,
    headers: Vec<Header>,
}

/// The channels of a file, as far as its head shows them.
struct Surveyed {
    /// How they were read: the stated options, as far as this file needs them.
    reading: Reading,
    /// Why they say that only a part is read.
    part: Option<&'static str>,
    headers: Result<Vec<Header>>,
}

/// Most digits of a time in s that a table proposes.
const MOST_DIGITS: usize = 12;

/// The options by which the longest part without a missing value of a file's time traces is read.
///
/// # Errors
/// If the file cannot be read with its missing values either.
fn longest_present(path: &Path, reading: &Reading, folder: &Folder) -> Result<Reading> {
    let kept = Reading { allow_missing: true, ..reading.clone() };
    let recording = kept.reader()?.within(folder).from_path(path)?;
    let trace = |record| if let Record::Trace(trace) = record { Some(trace) } else { None };
    let traces: Vec<Trace> = recording.records.into_iter().filter_map(trace).collect();
    let Some((axis, step)) = traces.first().and_then(|trace| Some((&trace.axis, trace.axis.step()?))) else {
        return Ok(kept);
    };
    let present = |i: usize| traces.iter().all(|trace| trace.values.get(i).is_some_and(|v| v.is_finite()));
    let (mut longest, mut from) = (0..0, 0);
    for i in (0..=axis.len()).filter(|i| !present(*i)) {
        if i - from > longest.len() {
            longest = from..i;
        }
        from = i + 1;
    }
    // Halfway between two samples, so that rounding does not decide which are read.
    let digits = (2.0 - f64::log10(step)).clamp(0.0, MOST_DIGITS as f64) as usize;
    let before = |i: usize| format!("{:.digits$}", axis.at(i) - 0.5 * step).parse().ok();
    let span = before(longest.start).zip(before(longest.end));
    Ok(Reading { span: span.filter(|_| !longest.is_empty()), ..kept })
}

impl Surveyed {
    /// Surveys a file with the sampling times that it states itself, else with the stated rate; where
    /// samples are lost or values are missing, the longest part without a gap.
    fn of(path: &Path, reading: &Reading, folder: &Folder) -> Surveyed {
        let survey = |reading: &Reading| reading.reader()?.within(folder).survey(path);
        let untimed_reading = reading.untimed();
        let as_stored = survey(&untimed_reading);
        let timed = as_stored.as_ref().is_ok_and(|(_, headers, _)| !untimed(headers));
        let stated = reading.rate.or(reading.base_band).or(reading.resample).is_some();
        let found = if timed || !stated { as_stored } else { survey(reading) };
        let lost = found.as_ref().ok().filter(|(_, headers, _)| untimed(headers));
        let stretch = lost.and_then(|(.., findings)| longest_stretch(findings));
        let chosen = if stretch.is_some() {
            let of_stretch = Reading { stretch, ..untimed_reading.clone() };
            Some((of_stretch, "the longest part without lost samples"))
        } else if found.as_ref().is_err_and(is_missing) {
            let present = longest_present(path, &untimed_reading, folder).ok();
            present.map(|present| (present, "values are missing: the longest part without"))
        } else {
            None
        };
        let part = chosen.as_ref().map(|(_, why)| *why);
        let (reading, found) = match chosen {
            Some((chosen, _)) => {
                let found = survey(&chosen);
                (chosen, found)
            }
            None if timed => (untimed_reading, found),
            None => (reading.clone(), found),
        };
        let headers = found.and_then(|(_, headers, _)| {
            let uneven = untimed(&headers) && headers.iter().any(|header| header.dx.is_none());
            let why =
                || reading.reader()?.within(folder).from_path(path)?.trace(Some("1"), None)?.sampling_rate();
            if uneven { why().map(|_| headers) } else { Ok(headers) }
        });
        Surveyed { reading, part, headers }
    }
}

/// Key by which files are grouped into a series.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
struct FileKind {
    /// Their name, with `*` for the number in which they differ.
    name: String,
    /// Units and kinds of their channels.
    channels: String,
    /// The options with which they are read, in words.
    reading: String,
}

impl FileKind {
    /// A pattern with `*` that matches these files and no other of `every`; `None` if there is none.
    fn pattern(&self, files: &[String], every: &[String], numbers: &Numbers) -> Option<String> {
        let [before, after] = split_at_number(&files[0], numbers);
        let matches = |name: &&String| {
            name.len() > before.len() + after.len() && name.starts_with(&before) && name.ends_with(&after)
        };
        let plain = !self.name.replacen('*', "", 1).contains(['*', '?', '[']);
        (plain && every.iter().filter(matches).count() == files.len()).then(|| self.name.clone())
    }
}

/// Channels of the first of several files. A channel whose name differs between the files loses it and goes
/// by its number.
pub(super) fn named_alike(files: &[&[Header]]) -> Vec<Header> {
    let mut headers = files[0].to_vec();
    for (k, header) in headers.iter_mut().enumerate() {
        if files.iter().any(|all| all[k].name != header.name) {
            header.name.clear();
        }
    }
    headers
}

/// Whether no channel of a file has a time axis.
fn untimed(headers: &[Header]) -> bool {
    headers.iter().all(|h| h.kind == "trace" && h.rate.is_none())
}

impl Inventory {
    /// Surveys the files of a folder that `known` does not name. A stated sampling rate applies to files
    /// without one.
    ///
    /// # Errors
    /// If a folder cannot be listed.
    pub fn of(
        folder: &Folder,
        reading: &Reading,
        known: Option<&Campaign>,
        progress: &dyn Progress,
    ) -> Result<Inventory> {
        let reader = reading.reader()?.within(folder);
        let Recordings { files: all, others, skipped } = analysis::recordings(folder)?;
        let root = folder.root();
        let new = known.map(|campaign| analysis::unnamed(campaign, &all)).transpose()?;
        let mut paths = new.unwrap_or_else(|| all.clone());
        let within = |path: &Path| {
            let inside = path.strip_prefix(root).unwrap_or(path);
            inside.components().map(|part| part.as_os_str().to_string_lossy()).collect::<Vec<_>>().join("/")
        };
        let left = skipped.into_iter().map(|(path, why)| (shown(within(&path)), why)).collect();
        let mut found = Inventory { left, ..Inventory::default() };
        progress.start("reading files", paths.len());
        found.take_lists(&mut paths, folder, &within);
        // An archive or workbook without a main part: each part is a recording.
        let parts = |path: PathBuf| match reader.parts(&path) {
            Ok(parts) if !parts.is_empty() => parts,
            _ => vec![path],
        };
        paths = paths.into_par_iter().flat_map_iter(parts).collect();
        analysis::in_order(&mut paths);
        let names: Vec<String> = paths.iter().map(|path| within(path)).collect();
        let numbers = numbers(&names);
        let every: Vec<String> = all.iter().map(|path| within(path)).collect();
        let survey = |path: &PathBuf| {
            let found = Surveyed::of(path, reading, folder);
            progress.step();
            found
        };
        let surveyed: Vec<Surveyed> = paths.par_iter().map(survey).collect();
        for (kind, members) in found.kinds(paths.into_iter().zip(surveyed), &numbers, &within) {
            let files: Vec<String> = members.iter().map(|one| within(&one.path)).collect();
            let pattern = kind.pattern(&files, &every, &numbers);
            let (reading, part) = (members[0].reading.clone(), members[0].part);
            let headers = named_alike(&members.iter().map(|one| &*one.headers).collect::<Vec<_>>());
            let name = name(&files);
            found.series.push(FileSeries { name, files, headers, pattern, alike: false, reading, part });
        }
        found.name_apart();
        if let ([first, more @ ..], None) = (others.as_slice(), known) {
            let names = match more.len() {
                0 => within(first),
                n => format!("{} and {n} more", within(first)),
            };
            found.left.push((names, "not a recording, by the ending".to_owned()));
        }
        Ok(found)
    }

    /// Removes list files, and the files that they name, from the paths.
    fn take_lists(&mut self, paths: &mut Vec<PathBuf>, folder: &Folder, within: &impl Fn(&Path) -> String) {
        let list = |path: &PathBuf| Some((path.clone(), SweepList::from_path(path, folder).ok()?));
        let lists: Vec<(PathBuf, SweepList)> = paths.par_iter().filter_map(list).collect();
        for (path, list) in &lists {
            paths.retain(|other| {
                other != path && !list.force.contains(other) && !list.response.contains(other)
            });
            self.lists.push((stem(path), within(path)));
        }
    }

    /// The files grouped by kind, in the order of the first of each; files without a time axis are left out.
    fn kinds(
        &mut self,
        surveyed: impl Iterator<Item = (PathBuf, Surveyed)>,
        numbers: &Numbers,
        within: &impl Fn(&Path) -> String,
    ) -> Vec<(FileKind, Vec<Member>)> {
        let mut kinds: Vec<(FileKind, Vec<Member>)> = Vec::new();
        let mut places: HashMap<FileKind, usize> = HashMap::new();
        for (path, Surveyed { reading, part, headers }) in surveyed {
            let why = match headers {
                Ok(headers) if headers.is_empty() => "no records".to_owned(),
                Ok(headers) if untimed(&headers) => {
                    "the file has no sampling rate: choose its kind, and state `rate` (vibro init: --rate HZ for all)"
                        .to_owned()
                }
                Ok(headers) => {
                    let name = split_at_number(&within(&path), numbers).join("*");
                    let reading_key = format!("{:?}", reading.stated());
                    let kind = FileKind { name, channels: signature(&headers), reading: reading_key };
                    let place = *places.entry(kind.clone()).or_insert(kinds.len());
                    if place == kinds.len() {
                        kinds.push((kind, Vec::new()));
                    }
                    kinds[place].1.push(Member { path, reading, part, headers });
                    continue;
                }
                // Only of a file with uneven times is the setting known that helps.
                Err(error) if error.settings().any(|key| key == "resample") => {
                    let in_voice = |voice: Voice| error.settings_with(|key, value| voice.set(key, value)).join(" ");
                    let (key, option) = (in_voice(Voice::Campaign), in_voice(Voice::Command));
                    format!("its samples are unevenly spaced: {key} interpolates them (vibro init: {option})")
                }
                Err(error) => short(&error),
            };
            self.left.push((within(&path), why));
        }
        kinds
    }

    /// Names single files by their path where several series have the same name, as in several folders or
    /// archives.
    fn name_apart(&mut self) {
        let names: Vec<String> = self.series.iter().map(|series| series.name.clone()).collect();
        for series in &mut self.series {
            if let ([file], true) =
                (&series.files[..], names.iter().filter(|n| **n == series.name).count() > 1)
            {
                series.name.clone_from(file);
            }
        }
    }
}

impl FileSeries {
    /// The table of a stepped sweep, if the files hold a force and responses.
    pub(super) fn sweep(&self) -> Option<Table> {
        let (force, responses) = self.force_and_responses()?;
        let table = Table::new("sweep", "a stepped sweep, one file a step", &self.in_words());
        let table = table.found("name", &self.name);
        let table = match self.direction() {
            Some(way) => table.guessed("direction", way, "the name says it"),
            None => table,
        };
        let table = match &self.pattern {
            Some(pattern) => table.found("traces", pattern),
            None if self.alike => {
                table.guessed("traces", &self.files, "alike but for their names; by frequency")
            }
            None => table.found("traces", &self.files),
        };
        let table = table.with("force", self.channel(force), KeyStatus::Guessed("the channel in N"));
        let responses: Vec<_> = responses.into_iter().map(|k| self.channel(k)).collect();
        Some(match responses.as_slice() {
            [one] => table.guessed("response", one, "the other channel"),
            all => table.guessed("response", all, "the other channels; each is a sweep of its own"),
        })
    }

    /// The force channel and the others, if there is exactly one force.
    pub(super) fn force_and_responses(&self) -> Option<(usize, Vec<usize>)> {
        self.force_among((0..self.headers.len()).collect())
    }

    /// The force channel and the others among some channels, if there is exactly one force.
    pub(super) fn force_among(&self, mut traces: Vec<usize>) -> Option<(usize, Vec<usize>)> {
        traces.retain(|k| self.headers[*k].kind == "trace");
        let is_force = |k: &usize| self.headers[*k].quantity == "force";
        let motion =
            |k: &usize| matches!(self.headers[*k].quantity, "displacement" | "velocity" | "acceleration");
        let mut forces = traces.iter().copied().filter(is_force);
        let force = forces.next().filter(|_| forces.next().is_none())?;
        let responses: Vec<usize> =
            traces.into_iter().filter(|k| motion(k) && self.components(*k).is_none()).collect();
        (!responses.is_empty()).then_some((force, responses))
    }

    /// The components of a channel that is the magnitude of a vector: the magnitude has no sign, so its
    /// tones appear at twice their frequency.
    pub(super) fn components(&self, k: usize) -> Option<&str> {
        let found = self.headers[k].findings.iter().find(|found| found.code == MAGNITUDE)?;
        match found.fact("components")? {
            Fact::Name(names) => Some(names),
            _ => None,
        }
    }

    /// A channel by its name; by its number where the name is ambiguous.
    pub(super) fn channel(&self, k: usize) -> serde_json::Value {
        let name = &self.headers[k].name;
        let same = self.headers.iter().filter(|h| h.name == *name).count();
        if name.is_empty() || same > 1 { (k + 1).into() } else { name.as_str().into() }
    }

    /// Its files in words.
    pub(super) fn in_words(&self) -> String {
        match self.files.as_slice() {
            [one] => one.clone(),
            [first, .., last] => {
                let alike = if self.alike { " of the same columns and rate" } else { "" };
                format!("{} files{alike}, {first} to {last}", self.files.len())
            }
            [] => String::new(),
        }
    }
}

/// A file name without folder and ending.
pub(super) fn stem(path: &Path) -> String {
    path.file_stem().map_or_else(String::new, |s| s.to_string_lossy().into_owned())
}

/// The name of a series or of a single file.
pub(super) fn name(files: &[String]) -> String {
    match files {
        [one] => stem(Path::new(one)),
        [first, ..] => common(&split_at_number(first, &numbers(files))[0]),
        [] => String::new(),
    }
}

/// The text before and after each number of a file name; folder and ending are not searched.
fn around_numbers(name: &str) -> Vec<[String; 2]> {
    let from = name.rfind('/').map_or(0, |at| at + 1);
    let to = name[from..].rfind('.').map_or(name.len(), |at| from + at);
    let digits = |at: usize| name[at..to].bytes().take_while(u8::is_ascii_digit).count();
    let begins =
        (from..to).filter(|at| is_digit_at(name, *at) && (*at == from || !is_digit_at(name, at - 1)));
    begins.map(|at| [name[..at].to_owned(), name[at + digits(at)..].to_owned()]).collect()
}

/// Whether the byte at this place is a digit.
fn is_digit_at(name: &str, at: usize) -> bool {
    name.as_bytes()[at].is_ascii_digit()
}

/// Number of names that have a number between the same two texts.
type Numbers = HashMap<[String; 2], usize>;

/// Counts, for each text before and after a number, the names with it.
fn numbers(names: &[String]) -> Numbers {
    let mut numbers = Numbers::new();
    names.iter().flat_map(|name| around_numbers(name)).for_each(|run| *numbers.entry(run).or_default() += 1);
    numbers
}

/// The text before and after the number that varies among similar names; else around the last number. A
/// name without a number is the text before, with nothing after.
fn split_at_number(name: &str, numbers: &Numbers) -> [String; 2] {
    let mut pairs = around_numbers(name);
    let varies = |run: &[String; 2]| numbers.get(run).is_some_and(|n| *n > 1);
    match pairs.iter().rposition(varies).or(pairs.len().checked_sub(1)) {
        Some(at) => pairs.swap_remove(at),
        None => [name.to_owned(), String::new()],
    }
}

/// Whether two names differ in exactly one number.
pub(super) fn alike(one: &str, other: &str) -> bool {
    let both = numbers(&[one.to_owned(), other.to_owned()]);
    one != other && split_at_number(one, &both) == split_at_number(other, &both)
}

/// The name of a series: the text before its number, without trailing separators.
fn common(before: &str) -> String {
    let name = before.trim_end_matches(|c: char| !c.is_alphanumeric());
    let name = name.rsplit('/').next().unwrap_or(name);
    if name.is_empty() { "series".to_owned() } else { name.to_owned() }
}

/// Units and kinds of the channels, as a key of files of one kind.
fn signature(headers: &[Header]) -> String {
    let one = |h: &Header| [h.unit.as_str(), h.kind].join("|");
    headers.iter().map(one).collect::<Vec<_>>().join("\n")
}

/// Channels and sampling rates as a key of similar files. Rates computed from times differ in the sixth
/// digit and are rounded.
pub(super) fn columns(headers: &[Header]) -> String {
    let rate = |h: &Header| h.rate.map_or_else(String::new, |rate| format!("{rate:.4e}"));
    headers.iter().map(rate).chain([signature(headers)]).collect::<Vec<_>>().join("\n")
}

/// The first line of an error, without the name of its file.
pub(super) fn short(error: &Error) -> String {
    let text = error.to_string();
    let line = text.lines().next().unwrap_or_default();
    let found = line.split_once(": ").map_or(line, |(_, rest)| rest);
    // The expected content is cut off: it helps the author of a file, not the person who sorts a folder.
    found.split("; expected ").next().unwrap_or(found).to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_come_apart_at_the_number_that_differs() {
        let all: Vec<String> = ["step_01.csv", "step_02.csv", "drop1_h450mm.wav", "drop2_h450mm.wav"]
            .map(str::to_owned)
            .to_vec();
        for (name, expected) in [
            ("step_01.csv", ["step_", ".csv"]),
            ("drop1_h450mm.wav", ["drop", "_h450mm.wav"]),
            ("a1/run2_12 Hz.csv", ["a1/run2_", " Hz.csv"]),
            ("µ7.txt", ["µ", ".txt"]),
            ("7.txt", ["", ".txt"]),
            ("record.mp3", ["record.mp3", ""]),
            ("a5/plain", ["a5/plain", ""]),
        ] {
            assert_eq!(split_at_number(name, &numbers(&all)), expected, "{name}");
        }
        assert_eq!([common("x/step_"), common("")], ["step", "series"]);
    }
}

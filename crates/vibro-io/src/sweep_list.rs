//! The list of files of a stepped-sine sweep in the thesis, and the hand-over file of its script sineswpf.
//!
//! ```text
//! 12                 number of points N
//! 400                spectral lines L: files hold L + 1 values
//! 20                 base band in Hz
//! FUP0001.DAT        N force files, one a line         hand-over file: N excitation frequencies instead,
//! …                                                    then N names of 11 characters without a separator
//! RUP0001.DAT        N response files
//! …
//! ```

use super::text::encoding;
use crate::folder::Folder;
use crate::limit::Limit;
use crate::number;
use crate::packed;
use crate::source::Source;
use std::path::{Path, PathBuf};
use vibro_record::{Error, Hint, Place, Result, pattern};

/// Files of a stepped-sine sweep.
#[derive(Debug, Clone, PartialEq)]
pub struct SweepList {
    /// Spectral lines, not counting 0 Hz.
    pub lines: usize,
    /// Base band in Hz.
    pub base_band: f64,
    /// Force files; empty for a hand-over file.
    pub force: Vec<PathBuf>,
    /// Excitation frequencies in Hz from a hand-over file; empty for a list file.
    pub excitation: Vec<f64>,
    /// Response files.
    pub response: Vec<PathBuf>,
    /// Place of each name in the list, force files first; empty if the names were not read from a list.
    pub places: Vec<Place>,
}

/// Characters of a name in a hand-over file: eight, a point, three.
const NAME: usize = 11;

/// Hint on the contents of a list file.
const HOLDS: &str = "a list holds: number of points, lines, base band in Hz, force names, response names, one a line; \
                     time traces, one file a step, go to a campaign: [[sweep]] with name, traces = \"step_*.csv\", force and response";

impl SweepList {
    /// Reads a list file or a hand-over file. Names are relative to the folder of that file.
    ///
    /// # Errors
    /// If a number or a name is missing or out of range, or a name leads outside that folder and `within`
    /// does not allow it.
    pub fn from_path(path: impl AsRef<Path>, within: &Folder) -> Result<SweepList> {
        let path = path.as_ref();
        let several = within.is_folder(path) || !within.exists(path) && path.to_string_lossy().contains('*');
        if several {
            return Err(Error::input(
                Place::file(path),
                "several files",
                "a list file, or campaign.toml#name",
            )
            .hint(HOLDS));
        }
        let source = packed::file_or_part(within, path, Limit::default())?;
        if !encoding::is_text(source.head()) {
            return Err(Error::input(Place::file(path), "binary data", "a list file of text")
                .hint(format!("{HOLDS}; of a measurement file `vibro info` says what is in it")));
        }
        let mut list = parse(path, &encoding::decode(&source.all()?))?;
        let folder = within.at(path.parent().unwrap_or(Path::new("")));
        for (name, place) in list.force.iter_mut().chain(&mut list.response).zip(&list.places) {
            *name = folder.path(name).map_err(|e| e.at(place))?;
        }
        Ok(list)
    }

    /// The list that a source holds; `None` if it is not a list, or is larger than 1 MiB (room for ten
    /// thousand points).
    pub(super) fn of(source: &Source) -> Option<SweepList> {
        let bytes = source.all().ok().filter(|_| source.len() < 1 << 20)?;
        parse(source.path(), &encoding::decode(&bytes)).ok()
    }

    /// Error that names all files that do not exist, each with its line in the list; `None` if all exist.
    pub(super) fn missing(&self, folder: &Folder) -> Option<Error> {
        let files: Vec<&PathBuf> = self.force.iter().chain(&self.response).collect();
        let missing: Vec<usize> = (0..files.len()).filter(|i| !folder.exists(files[*i])).collect();
        let place = self.places.get(*missing.first()?).cloned()?;
        let name = |i: &usize| {
            let line = self.places.get(*i).and_then(|p| p.line).unwrap_or_default();
            format!("{} (line {line})", files[*i].display())
        };
        let names: Vec<String> = missing.iter().map(name).collect();
        let (n, all, are) = (names.len(), files.len(), if names.len() == 1 { "is" } else { "are" });
        let found = format!("{n} of {all} files {are} missing: {}", names.join(", "));
        let hint = "check the folder and the spelling; on Linux upper and lower case differ";
        Some(Error::input(place, found, "every file that is named").hint(hint))
    }

    /// Number of points.
    pub fn len(&self) -> usize {
        self.response.len()
    }

    /// Whether the list has no points. A list that was read has at least one.
    pub fn is_empty(&self) -> bool {
        self.response.is_empty()
    }
}

/// Hint to name the steps of a sweep by a pattern instead of one of their files, if the folder holds
/// several.
fn steps(path: &Path) -> Option<Hint> {
    let all = pattern(path.file_name()?.to_str()?);
    let folder = path.parent().filter(|folder| *folder != Path::new("")).unwrap_or(Path::new("."));
    let names =
        std::fs::read_dir(folder).ok()?.filter_map(|entry| entry.ok()?.file_name().into_string().ok());
    let several = names.filter(|name| pattern(name) == all).nth(1).is_some();
    several.then(|| Hint::Name { wrong: path.to_owned(), meant: path.with_file_name(all) })
}

fn parse(path: &Path, text: &str) -> Result<SweepList> {
    let lines = text.lines().zip(1u64..).map(|(l, n)| (n, l.trim())).filter(|(_, l)| !l.is_empty());
    let lines: Vec<(u64, &str)> = lines.collect();
    let end = text.lines().count().max(1) as u64;
    let fault = |at: usize, found: String, expected: String| {
        let line = lines.get(at).map_or(end, |(line, _)| *line);
        Error::input(Place::line(path, line), found, expected).hint(HOLDS)
    };
    if let Some((line, first)) = lines.first().filter(|(_, first)| number::parse(first.as_bytes()).is_none())
    {
        let expected =
            "a list file, which begins with the number of points, or all steps of a sweep, one file each";
        let error = Error::input(Place::line(path, *line), format!("found {first:?}"), expected);
        return Err(error.hint(steps(path).unwrap_or(Hint::OfFile("vibro info"))));
    }
    let number = |at: usize, what: &str| {
        let line = lines.get(at).map(|(_, line)| line);
        let value = line.and_then(|l| number::parse(l.as_bytes())).filter(|v| *v > 0.0);
        let found = || line.map_or("the list ends here".to_owned(), |l| format!("found {l:?}"));
        value.ok_or_else(|| fault(at, found(), format!("the {what}, a number above 0")))
    };
    let whole = |at: usize, what: &str| match number(at, what)? {
        v if v.fract() == 0.0 && v < 1e9 => Ok(v as usize),
        v => Err(fault(at, format!("found {v}"), format!("a whole {what} below 1e9"))),
    };
    let points = whole(0, "number of points")?;
    let spectral = whole(1, "number of spectral lines")?;
    let base_band = number(2, "base band in Hz")?;
    let excitation: Vec<f64> = lines[3..].iter().map_while(|(_, l)| number::parse(l.as_bytes())).collect();
    let given = excitation.len();
    if given > 0 && given != points {
        let found = format!("found {given} excitation frequencies for {points} points");
        return Err(fault(2 + given, found, format!("{points} frequencies")));
    }
    let mut names = names_of(&lines[3 + given..], points, given == 0);
    let (force, kind) = if given == 0 { (points, "file") } else { (0, "response") };
    let wanted = force + points;
    if names.len() != wanted {
        let ends = if names.len() < wanted { "the list ends here with" } else { "found" };
        let found = format!("{ends} {} {kind} names for {points} points", names.len());
        let at = lines.len().min(4 + wanted + given) - 1;
        return Err(fault(
            at,
            found,
            format!("{wanted} names, of {force} force and {points} response files"),
        ));
    }
    if let Some((line, name)) = names.iter().find(|(_, name)| !is_name(name)) {
        let place = Place::line(path, *line);
        return Err(Error::input(place, format!("found {name:?}"), "the name of a file"));
    }
    let places = names.iter().map(|(line, _)| Place::line(path, *line)).collect();
    let files = |names: Vec<(u64, String)>| names.into_iter().map(|(_, name)| PathBuf::from(name)).collect();
    let response = files(names.split_off(force));
    Ok(SweepList { lines: spectral, base_band, force: files(names), excitation, response, places })
}

/// Names of files with their lines: one name per line, or all `points` names of a hand-over file on one
/// line.
fn names_of(lines: &[(u64, &str)], points: usize, one_a_line: bool) -> Vec<(u64, String)> {
    match lines {
        all if one_a_line => all.iter().map(|(line, name)| (*line, (*name).to_owned())).collect(),
        // The script writes names of 11 characters without a separator.
        [(line, one)] if one.chars().count() == NAME * points => {
            let characters: Vec<char> = one.chars().collect();
            characters.chunks(NAME).map(|name| (*line, name.iter().collect())).collect()
        }
        all => all.iter().flat_map(|(n, l)| l.split_whitespace().map(|name| (*n, name.to_owned()))).collect(),
    }
}

/// Whether a text may be the name of a file: it has a letter and is not a number.
fn is_name(name: &str) -> bool {
    let bytes = name.as_bytes();
    name.contains(char::is_alphabetic) && number::parse(bytes).is_none() && !number::is_missing(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(text: &str) -> Result<SweepList> {
        parse(Path::new("LIST.TXT"), text)
    }

    #[test]
    fn list_and_hand_over() {
        let list = of("2\r\n400\r\n20\r\nF1.DAT\r\nF2.DAT\r\nR1.DAT\r\nR2.DAT\r\n").unwrap();
        assert_eq!((list.len(), list.lines, list.base_band), (2, 400, 20.0));
        assert_eq!(list.response[1], Path::new("R2.DAT"));
        let hand = of("2.0000\n400.0000\n20.0000\n 5.0000\n 5.2000\nRUP0001.DATRUP0002.DAT").unwrap();
        assert_eq!(hand.excitation, [5.0, 5.2]);
        assert_eq!(hand.response[1], Path::new("RUP0002.DAT"));
    }

    #[test]
    fn complaints_name_the_line() {
        for (text, line, word) in [
            ("x\n", "line 1", "number of points"),
            ("2\n400\n0\n", "line 3", "base band"),
            ("2\n400\n20\na\nb\nc\n\n", "line 6", "the list ends here with 3 file names for 2 points"),
            ("2\n400\n20\na\nb\nc\nd\ne\n", "line 8", "5 file names"),
            ("2.5\n400\n20\n", "line 1", "whole"),
            ("1e12\n400\n20\na", "line 1", "whole"),
            ("3\n400\n20\n5\n6\nA B C", "line 5", "2 excitation"),
            ("2\n400\n20\n5\n6\nA B C", "line 6", "3 response"),
            ("1\n2\n3\n4\nNaN", "line 5", "found \"NaN\"; expected the name of a file"),
            ("1\n2\n3\nF1.DAT\n--", "line 5", "found \"--\"; expected the name of a file"),
            ("", "line 1", "number of points"),
            ("2\n400\n", "line 2", "the list ends here; expected the base band"),
        ] {
            let error = of(text).unwrap_err().to_string();
            assert!(error.contains(line) && error.contains(word), "{text:?}: {error}");
        }
    }
}

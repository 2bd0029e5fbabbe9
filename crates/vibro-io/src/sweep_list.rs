//! The thesis' list file, and the hand-over file of its script sineswpf.
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
use super::{Reader, Source, number};
use std::path::{Component, Path, PathBuf};
use vibro_record::{Error, Place, Result};

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
    /// Where the names stand, of the force files and then of the response files; none where they were not read from a list.
    pub places: Vec<Place>,
}

/// Length of a name in a hand-over file: eight characters, a point, three characters.
const NAME: usize = 11;

impl SweepList {
    /// Reads a list file or a hand-over file. Names are taken relative to its folder.
    ///
    /// # Errors
    /// If a number or a name is missing or out of range, or a name leads outside the folder and `allow_outside` is not set.
    pub fn from_path(path: impl AsRef<Path>, allow_outside: bool) -> Result<SweepList> {
        let path = path.as_ref();
        let source = Source::file(path)?;
        let bytes = source.all()?;
        if !encoding::is_text(&bytes[..bytes.len().min(4096)]) {
            return Err(Error::input(Place::file(path), "binary data", "a list file of text").hint(
                "give a list file (N, lines, base band, force names, response names) or campaign.toml#name",
            ));
        }
        let text = encoding::decode(&bytes);
        let mut list = parse(path, &text).map_err(|e| no_measurement(path, &text, e))?;
        let folder = path.parent().unwrap_or(Path::new(""));
        for (name, place) in list.force.iter_mut().chain(&mut list.response).zip(&list.places) {
            *name = inside(folder, name, allow_outside).map_err(|e| e.at(place))?;
        }
        Ok(list)
    }

    /// The list that a source holds; `None` where it is anything else, or larger than a list of ten thousand points.
    pub(super) fn of(source: &Source) -> Option<SweepList> {
        if source.len() >= 1 << 20 {
            return None;
        }
        let bytes = source.all().ok()?;
        parse(source.path(), &encoding::decode(&bytes)).ok()
    }

    /// A complaint about all files that do not exist, each with the line that names it; `None` where all exist.
    pub(super) fn missing(&self) -> Option<Error> {
        let files: Vec<&PathBuf> = self.force.iter().chain(&self.response).collect();
        let missing: Vec<usize> = (0..files.len()).filter(|i| !files[*i].exists()).collect();
        let first = *missing.first()?;
        let place = self.places.get(first).cloned().unwrap_or_else(|| Place::file(files[first]));
        let names: Vec<String> = missing
            .iter()
            .map(|i| match self.places.get(*i).and_then(|p| p.line) {
                Some(line) => format!("{} (line {line})", files[*i].display()),
                None => files[*i].display().to_string(),
            })
            .collect();
        let (count, are) = (names.len(), if names.len() == 1 { "is" } else { "are" });
        let found = format!("{count} of {} files {are} missing: {}", files.len(), names.join(", "));
        Some(
            Error::input(place, found, "every file that is named")
                .hint("check the folder and the spelling; on Linux upper and lower case differ"),
        )
    }

    /// Number of points.
    pub fn len(&self) -> usize {
        self.response.len()
    }

    /// Whether there are none; never so for a list that was read.
    pub fn is_empty(&self) -> bool {
        self.response.is_empty()
    }
}

/// `folder/name`, refused where it leads outside the folder (by `..`, an absolute name or a link), unless allowed.
///
/// # Errors
/// As said.
pub fn inside(folder: &Path, name: &Path, allow_outside: bool) -> Result<PathBuf> {
    // Lists come from DOS machines, too.
    let name = PathBuf::from(name.to_string_lossy().replace('\\', "/"));
    let joined = folder.join(&name);
    let drive = name.to_string_lossy().as_bytes().get(1) == Some(&b':');
    let climbs = name
        .components()
        .try_fold(0i32, |depth, part| match part {
            Component::Normal(_) => Some(depth + 1),
            Component::ParentDir if depth > 0 => Some(depth - 1),
            Component::CurDir => Some(depth),
            _ => None,
        })
        .is_none();
    // Only where a part of the name is a link can the file be elsewhere; asking for the real path of every file is slow.
    let linked = || {
        let mut path = folder.to_path_buf();
        let mut link = |part: Component| {
            path.push(part);
            path.symlink_metadata().is_ok_and(|m| m.file_type().is_symlink())
        };
        if !name.components().any(&mut link) {
            return false;
        }
        // What does not exist yet is judged by the deepest folder that does.
        let real = joined.ancestors().find_map(|a| a.canonicalize().ok());
        match (real, folder_or_here(folder).canonicalize()) {
            (Some(real), Ok(folder)) => !real.starts_with(folder),
            _ => true,
        }
    };
    if !allow_outside && (climbs || drive || linked()) {
        return Err(Error::usage(
            format!("the name {:?} leads outside the folder of the list", name.display().to_string()),
            "names of files beside or below the list",
        )
        .hint("move the files beside the list, or allow files outside its folder if you trust it")
        .setting("allow_outside"));
    }
    Ok(joined)
}

fn folder_or_here(folder: &Path) -> &Path {
    if folder.as_os_str().is_empty() { Path::new(".") } else { folder }
}

/// What stands in a list file.
const HOLDS: &str = "number of points, lines, base band in Hz, force names, response names, one a line";

/// What to say where a list could not be read with `error`: a measurement is a likely thing to be taken for a list.
fn no_measurement(path: &Path, text: &str, error: Error) -> Error {
    let words =
        text.lines().rfind(|l| !l.trim().is_empty()).is_none_or(|l| l.split_whitespace().all(is_name));
    match Reader::new().survey(path) {
        Ok((format, _, _)) if !words => error.hint(format!(
            "this looks like a measurement file ({}), not a list: `vibro info` says what is in it; a list holds: {HOLDS}",
            format.name()
        )),
        _ => error,
    }
}

fn parse(path: &Path, text: &str) -> Result<SweepList> {
    let mut lines = text
        .lines()
        .enumerate()
        .map(|(i, l)| (i as u64 + 1, l.trim()))
        .filter(|(_, l)| !l.is_empty())
        .peekable();
    let end = text.lines().count().max(1) as u64;
    let mut number = |what: &str| -> Result<(u64, f64)> {
        let next = lines.next();
        let value =
            next.and_then(|(line, l)| Some((line, number::parse(l.as_bytes()).filter(|v| *v > 0.0)?)));
        value.ok_or_else(|| {
            let (line, found) = next
                .map_or((end, "the list ends here".to_owned()), |(line, l)| (line, format!("found {l:?}")));
            Error::input(Place::line(path, line), found, format!("{what}, a number above 0"))
                .hint(format!("a list file holds: {HOLDS}"))
        })
    };
    let (count_line, points) = number("the number of points")?;
    let (lines_line, spectral) = number("the number of spectral lines")?;
    let (_, base_band) = number("the base band in Hz")?;
    let whole = |line: u64, v: f64, what: &str| {
        if v.fract() == 0.0 && v < 1e9 {
            Ok(v as usize)
        } else {
            Err(Error::input(
                Place::line(path, line),
                format!("found {v}"),
                format!("a whole {what} below 1e9"),
            ))
        }
    };
    let points = whole(count_line, points, "number of points")?;
    let spectral = whole(lines_line, spectral, "number of lines")?;
    let rest: Vec<(u64, &str)> = lines.collect();
    let mut list = SweepList {
        lines: spectral,
        base_band,
        force: Vec::new(),
        excitation: Vec::new(),
        response: Vec::new(),
        places: Vec::new(),
    };
    let given = rest.iter().take_while(|(_, l)| number::parse(l.as_bytes()).is_some()).count();
    if given > 0 {
        hand_over(path, points, &rest, given, &mut list)?;
    } else {
        if rest.len() != 2 * points {
            let (line, found) = match rest.get(2 * points) {
                Some(surplus) => (surplus.0, "found"),
                None => (rest.last().map_or(end, |last| last.0), "the list ends here with"),
            };
            return Err(Error::input(
                Place::line(path, line),
                format!("{found} {} file names for {points} points", rest.len()),
                format!("{} names: {points} force and {points} response files, one a line", 2 * points),
            )
            .hint("correct the number of points in the first line, or add the missing names"));
        }
        named(path, rest.iter().copied())?;
        list.places = rest.iter().map(|(line, _)| Place::line(path, *line)).collect();
        list.force = rest[..points].iter().map(|(_, name)| PathBuf::from(name)).collect();
        list.response = rest[points..].iter().map(|(_, name)| PathBuf::from(name)).collect();
    }
    Ok(list)
}

/// Refuses what cannot be the name of a file.
fn named<'a>(path: &Path, mut names: impl Iterator<Item = (u64, &'a str)>) -> Result<()> {
    names.find(|(_, name)| !is_name(name)).map_or(Ok(()), |(line, name)| {
        Err(Error::input(Place::line(path, line), format!("found {name:?}"), "the name of a file"))
    })
}

/// Whether a word may be the name of a file: it holds a letter, and is neither a number nor stands for one that is missing.
fn is_name(word: &str) -> bool {
    let bytes = word.as_bytes();
    word.contains(char::is_alphabetic) && number::parse(bytes).is_none() && !number::is_missing(bytes)
}

fn hand_over(
    path: &Path,
    points: usize,
    rest: &[(u64, &str)],
    given: usize,
    list: &mut SweepList,
) -> Result<()> {
    if given != points {
        return Err(Error::input(
            Place::line(path, rest[given - 1].0),
            format!("found {given} excitation frequencies for {points} points"),
            format!("{points} frequencies"),
        ));
    }
    list.excitation = rest[..given].iter().filter_map(|(_, l)| number::parse(l.as_bytes())).collect();
    let names: Vec<(u64, String)> = match &rest[given..] {
        // The script writes names of 11 characters without a separator.
        [(line, one)] if one.chars().count() == NAME * points => {
            let characters: Vec<char> = one.chars().collect();
            characters.chunks(NAME).map(|c| (*line, c.iter().collect())).collect()
        }
        several => {
            several.iter().flat_map(|(n, l)| l.split_whitespace().map(|name| (*n, name.to_owned()))).collect()
        }
    };
    if names.len() != points {
        let line = rest.get(given).map_or(rest[given - 1].0, |r| r.0);
        return Err(Error::input(
            Place::line(path, line),
            format!("found {} response names for {points} points", names.len()),
            format!("{points} names of {NAME} characters, or separated by blanks or lines"),
        ));
    }
    named(path, names.iter().map(|(line, name)| (*line, name.as_str())))?;
    for (line, name) in names {
        list.places.push(Place::line(path, line));
        list.response.push(PathBuf::from(name));
    }
    Ok(())
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

    #[test]
    fn names_stay_in_their_folder() {
        let ok = |name: &str| inside(Path::new("data"), Path::new(name), false).is_ok();
        assert!(ok("A.DAT") && ok("sub/A.DAT") && ok("sub/../A.DAT") && ok(r"sub\A.DAT"));
        assert!(
            !ok("../A.DAT") && !ok("/etc/passwd") && !ok(r"..\A.DAT") && !ok(r"C:\A.DAT") && !ok("a/../../b")
        );
        assert!(inside(Path::new("data"), Path::new("../A.DAT"), true).is_ok());
    }

    #[cfg(unix)]
    #[test]
    fn a_link_that_leads_outside_is_no_name_inside() {
        use std::os::unix::fs::symlink;
        let (folder, elsewhere) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
        std::fs::write(elsewhere.path().join("A.DAT"), "1").unwrap();
        std::fs::write(folder.path().join("B.DAT"), "1").unwrap();
        symlink(elsewhere.path(), folder.path().join("door")).unwrap();
        symlink(elsewhere.path().join("A.DAT"), folder.path().join("A.DAT")).unwrap();
        symlink(folder.path().join("B.DAT"), folder.path().join("C.DAT")).unwrap();
        let ok = |name: &str| inside(folder.path(), Path::new(name), false).is_ok();
        assert!(!ok("A.DAT") && !ok("door/A.DAT") && ok("B.DAT") && ok("C.DAT"));
        assert!(!ok("door/not/yet") && ok("not/yet"));
    }
}

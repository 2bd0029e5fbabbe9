//! Files that contain other files: a zip archive of files, a workbook of sheets.
//!
//! The part with at least ten times the rows of any other is read. A sheet is read as the text that a
//! spreadsheet program would export ([`sheets`]). A hidden sheet is read only if no visible sheet has a
//! table. A path as in a folder names another part: `walk.zip/Gyroscope.csv`, `walk.xlsx/Sheet 2`.

#[cfg(feature = "sheets")]
mod sheets;

use super::text::{self, LONGER};
use crate::folder::Folder;
use crate::limit::Limit;
use crate::registry::Entry;
use crate::source::Source;
use std::cmp::Reverse;
use std::path::{Path, PathBuf};
use vibro_record::units::notation::counted;
use vibro_record::{Error, Finding, Place, Result};
#[cfg(feature = "zip")]
use zip::result::ZipError;

/// First bytes of a zip archive; newer Excel workbooks and those of `OpenDocument` are such archives.
const ZIP: &[u8] = b"PK\x03\x04";
/// First bytes of a compound file; older Excel workbooks (`.xls`) are such files.
const COMPOUND: &[u8] = b"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1";

/// How a workbook is stored.
#[cfg(feature = "zip")]
#[derive(Debug, Clone, Copy)]
enum Workbook {
    /// `.xls`.
    #[cfg(feature = "sheets")]
    Compound,
    /// `.xlsx` and `.xlsm`.
    Xml,
    /// `.ods`.
    OpenDocument,
}

/// A file of an archive or a sheet of a workbook.
struct Member {
    name: String,
    source: Source,
    /// Whether the spreadsheet program hides it.
    hidden: bool,
}

impl Member {
    fn bytes(&self) -> &[u8] {
        self.source.in_memory().unwrap_or_default()
    }

    fn is_packed(&self) -> bool {
        self.bytes().starts_with(ZIP) || self.bytes().starts_with(COMPOUND)
    }

    /// Size by which parts are ranked: rows of numbers in a text, bytes of a known binary format, else 0.
    fn rows(&self) -> usize {
        if text::encoding::is_text(self.bytes()) {
            return text::count_rows(self.bytes());
        }
        if Entry::of(&self.source).is_some() { self.bytes().len() } else { 0 }
    }
}

/// Parts with their sizes by [`Member::rows`], largest first, and the number of parts larger than
/// 1/[`LONGER`] of the largest.
type Ranked = (Vec<(usize, Member)>, usize);

/// All parts of an archive or a workbook; `None` for other files.
fn ranked(source: &Source, limit: Limit) -> Result<Option<Ranked>> {
    let Some(parts) = parts(source, None, limit)? else { return Ok(None) };
    let mut parts: Vec<(usize, Member)> = parts.into_iter().map(|part| (part.rows(), part)).collect();
    if parts.iter().any(|(rows, part)| *rows > 0 && !part.hidden) {
        parts.iter_mut().filter(|(_, part)| part.hidden).for_each(|(rows, _)| *rows = 0);
    }
    parts.sort_by_key(|(rows, _)| Reverse(*rows));
    let long = parts.iter().take_while(|(rows, _)| *rows > 0 && LONGER * rows > parts[0].0).count();
    Ok(Some((parts, long)))
}

/// The part of an archive or a workbook that is read, and a note on those left out; `None` for other files.
///
/// # Errors
/// If it is damaged or encrypted, unpacks to more than the limit, or several parts are of comparable length.
pub fn main_part(source: &Source, limit: Limit) -> Result<Option<(Source, Option<Finding>)>> {
    let Some((mut parts, long)) = ranked(source, limit)? else { return Ok(None) };
    if long > 1 || long == 0 && parts.len() != 1 {
        let names = listed(parts.iter());
        let found = if long > 1 {
            format!("the longest table has less than {LONGER} times the rows of the next: {names}")
        } else {
            format!("no table of numbers: {names}")
        };
        let error = Error::input(Place::file(source.path()), found, "one table");
        return Err(match parts.first().filter(|_| long > 1) {
            Some((_, first)) => error.hint(format!("name one: {}", first.source.path().display())),
            None => error.hint(unpack(parts.iter().find(|(_, part)| part.is_packed()))),
        });
    }
    if parts[0].1.is_packed() {
        let found = format!("it holds another packed file: {}", parts[0].1.name);
        return Err(Error::input(Place::file(source.path()), found, "a table").hint(unpack(parts.first())));
    }
    let found = (parts.len() > 1).then(|| {
        let found = Finding::note("parts-left-out").name("part", parts[0].1.name.as_str());
        found.name("parts", listed(parts.iter().skip(1)))
    });
    Ok(Some((parts.swap_remove(0).1.source, found)))
}

/// Paths of the parts of comparable length if none is clearly the longest, else none.
///
/// # Errors
/// If it is damaged or encrypted, or unpacks to more than the limit.
pub fn alike(source: &Source, limit: Limit) -> Result<Vec<PathBuf>> {
    let Some((mut parts, long)) = ranked(source, limit)? else { return Ok(Vec::new()) };
    parts.truncate(if long > 1 { long } else { 0 });
    Ok(parts.into_iter().map(|(_, part)| part.source.path().to_owned()).collect())
}

fn listed<'a>(parts: impl Iterator<Item = &'a (usize, Member)>) -> String {
    let name = |part: &Member| format!("{}{}", part.name, if part.hidden { " (hidden)" } else { "" });
    let rows = |(rows, part): &(usize, Member)| match rows {
        0 => name(part),
        _ if text::encoding::is_text(part.bytes()) => {
            format!("{} ({})", name(part), counted(*rows, "row"))
        }
        _ => format!("{} ({})", name(part), counted(*rows, "byte")),
    };
    parts.map(rows).collect::<Vec<_>>().join(", ")
}

/// Hint for a file without a table: unpack it, and name the packed file inside it that may hold one.
fn unpack(packed: Option<&(usize, Member)>) -> String {
    let name = packed.map_or("the file with the samples", |(_, part)| part.name.as_str());
    format!("unpack it, and name {name}")
}

/// The source of a measurement: a file of a folder, or a part of an archive or workbook; `-` is standard
/// input.
///
/// # Errors
/// As [`Source::file`] and [`part`].
pub fn file_or_part(folder: &Folder, path: &Path, limit: Limit) -> Result<Source> {
    match folder.part(path) {
        Some((file, name)) => part(&folder.source(file)?, name, limit),
        None => folder.source(path),
    }
}

/// Reads the part with this name.
///
/// # Errors
/// As [`main_part`]; if there is no such part.
fn part(source: &Source, name: &Path, limit: Limit) -> Result<Source> {
    if let Some(part) = parts(source, Some(name), limit)?.and_then(|mut parts| parts.pop()) {
        return Ok(part.source);
    }
    let found = format!("no part of the name {:?}", name.display().to_string());
    let parts = parts(source, None, limit)?.unwrap_or_default();
    let expected = match parts.as_slice() {
        [] => "an archive or a workbook".to_owned(),
        all => format!("one of {}", all.iter().map(|part| part.name.as_str()).collect::<Vec<_>>().join(", ")),
    };
    Err(Error::input(Place::file(source.path()), found, expected))
}

/// Finding on a sheet with a column in percent. Cells formatted as percent are stored as fractions of one,
/// other cells as shown. The crate calamine, which reads sheets, does not distinguish them.
pub fn percent(source: &Source) -> Option<Finding> {
    let text = source.in_memory().filter(|_| source.is_sheet())?;
    let in_percent = |cell: &&str| {
        cell.trim_end_matches([')', ']', ' ']).ends_with('%') && !cell.contains(|c: char| c.is_ascii_digit())
    };
    let cell = str::from_utf8(text).ok()?.split(['\t', '\n']).find(in_percent)?;
    Some(Finding::doubt("sheet-in-percent").name("column", cell.trim()).without_estimate())
}

/// Whether a file is an archive or a workbook that can be unpacked.
pub fn is_packed(source: &Source) -> bool {
    cfg!(feature = "zip") && source.head().starts_with(ZIP)
        || cfg!(feature = "sheets") && source.head().starts_with(COMPOUND)
}

/// All parts that are not empty, or the one of this name; `None` if the file is neither archive nor workbook,
/// or the support for it is not compiled in.
#[cfg_attr(not(feature = "zip"), allow(clippy::unnecessary_wraps))]
fn parts(source: &Source, named: Option<&Path>, limit: Limit) -> Result<Option<Vec<Member>>> {
    #[cfg(feature = "zip")]
    if source.head().starts_with(ZIP) {
        return members(source, named, limit).map(Some);
    }
    #[cfg(feature = "sheets")]
    if source.head().starts_with(COMPOUND) {
        return sheets::of(source, Workbook::Compound, named, limit).map(Some);
    }
    let _ = (source, named, limit, ZIP, COMPOUND);
    Ok(None)
}

/// Error for an archive or a workbook that cannot be read.
#[cfg(feature = "zip")]
fn damaged(source: &Source, why: impl std::fmt::Display) -> Error {
    let hint = "unpack it with the program that wrote it, and export CSV";
    Error::input(Place::file(source.path()), format!("it cannot be unpacked: {why}"), "a whole file")
        .hint(hint)
}

/// Error for a file that a password protects.
#[cfg(feature = "zip")]
fn locked(source: &Source) -> Error {
    let error =
        Error::input(Place::file(source.path()), "it is protected by a password", "a file without one");
    error.hint("unpack it, or save it without the password")
}

/// Error for a zip archive that cannot be read.
#[cfg(feature = "zip")]
fn unreadable(source: &Source, why: ZipError) -> Error {
    match why {
        ZipError::UnsupportedArchive(ZipError::PASSWORD_REQUIRED) => locked(source),
        why => damaged(source, why),
    }
}

/// The files of a zip archive, or the sheets of a workbook stored as one.
#[cfg(feature = "zip")]
fn members(source: &Source, named: Option<&Path>, limit: Limit) -> Result<Vec<Member>> {
    use std::io::{BufReader, Read};
    let archive = zip::ZipArchive::new(BufReader::new(source.open()?));
    let mut archive = archive.map_err(|why| match why {
        // An archive ends with the list of its files, which is missing if it was cut short.
        ZipError::InvalidArchive(_) => {
            let found = "its end is missing: it is no whole archive";
            Error::input(Place::file(source.path()), found, "a whole file").hint("copy or download it again")
        }
        why => unreadable(source, why),
    })?;
    let has = |name: &str| archive.index_for_name(name).is_some();
    let book = [("xl/workbook.xml", Workbook::Xml), ("content.xml", Workbook::OpenDocument)];
    let book = book.into_iter().find(|(name, _)| has(name)).map(|(_, kind)| kind);
    let (mut parts, mut held) = (Vec::new(), 0.0);
    for i in 0..archive.len() {
        let mut member = archive.by_index(i).map_err(|why| unreadable(source, why))?;
        let name = member.name().map_err(|why| damaged(source, why))?.into_owned();
        // macOS adds hidden files and a folder `__MACOSX`.
        let own = name.split('/').any(|name| name.starts_with('.') || name == "__MACOSX");
        let other = own || named.is_some_and(|named| named != Path::new(&name));
        if !member.is_file() || book.is_none() && other {
            continue;
        }
        held += member.size() as f64;
        limit.hold(held)?;
        // The crate zip fails on a file that unpacks to more than it declares. The files of a workbook are
        // unpacked only for this check: the crate that reads sheets checks no sizes.
        let mut bytes = Vec::new();
        let unpacked = match book {
            Some(_) => std::io::copy(&mut member, &mut std::io::sink()),
            None => member.read_to_end(&mut bytes).map(|n| n as u64),
        };
        unpacked.map_err(|why| damaged(source, format!("{name}: {why}")))?;
        if !bytes.is_empty() {
            let source = Source::memory(source.path().join(&name), bytes)?;
            parts.push(Member { name, source, hidden: false });
        }
    }
    match book {
        #[cfg(feature = "sheets")]
        Some(book) => sheets::of(source, book, named, limit),
        _ => Ok(parts),
    }
}

#[cfg(all(test, feature = "zip"))]
mod tests;

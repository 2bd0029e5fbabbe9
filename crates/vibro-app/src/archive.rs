//! Zip archives: one that is dropped, and one that is saved.

use std::io::{Cursor, Read as _, Write as _};
use std::path::{Component, Path};
use vibroimpact::error::{Error, Place, Result};
use zip::result::ZipError;
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, ZipArchive, ZipWriter};

/// Most bytes to which an archive may unpack: half of what a page can hold.
const LARGEST: u64 = 1 << 30;

/// Most files of an archive.
const MOST: usize = 20_000;

/// A file of an archive: its name and its bytes.
type Member = (String, Vec<u8>);

/// Files that were left out, each with the reason.
pub(crate) type LeftOut = Vec<(String, String)>;

/// The files of an archive, and those left out with the reason.
///
/// # Errors
/// If it is damaged, has more than 20 000 files, or unpacks to more than 1 GiB.
pub(crate) fn unpacked(path: &Path, bytes: Vec<u8>) -> Result<(Vec<Member>, LeftOut)> {
    let damaged = |error: &ZipError| Error::input(Place::file(path), format!("{error}"), "a zip archive");
    let too_large = |found: String, most: String| {
        Error::input(Place::file(path), found, most).hint("unpack it, and drop only the files that you need")
    };
    let mut archive = ZipArchive::new(Cursor::new(bytes)).map_err(|e| damaged(&e))?;
    if archive.len() > MOST {
        return Err(too_large(format!("{} files", archive.len()), format!("at most {MOST}")));
    }
    let (mut members, mut left, mut room) = (Vec::new(), Vec::new(), LARGEST);
    for k in 0..archive.len() {
        let mut file = match archive.by_index(k) {
            Ok(file) if file.is_dir() => continue,
            Ok(file) => file,
            Err(error) => {
                left.push((format!("file {} of {}", k + 1, path.display()), error.to_string()));
                continue;
            }
        };
        let name = match file.name() {
            Ok(name) => name.replace('\\', "/"),
            Err(error) => {
                left.push((format!("file {} of {}", k + 1, path.display()), error.to_string()));
                continue;
            }
        };
        let inside = |part: Component<'_>| matches!(part, Component::Normal(_) | Component::CurDir);
        if !Path::new(&name).components().all(inside) {
            left.push((name, "its name leads outside the archive".to_owned()));
            continue;
        }
        let mut content = Vec::new();
        // The stated size may be a lie: what comes out is counted.
        match file.by_ref().take(room + 1).read_to_end(&mut content) {
            Ok(n) if n as u64 > room => {
                return Err(too_large("it unpacks to more than 1 GiB".to_owned(), "less".to_owned()));
            }
            Ok(n) => room -= n as u64,
            Err(error) => {
                left.push((name, error.to_string()));
                continue;
            }
        }
        members.push((name, content));
    }
    Ok((members, left))
}

/// An archive of these files.
///
/// # Errors
/// If they are more than a zip archive holds.
pub(crate) fn packed(files: impl IntoIterator<Item = Result<(String, Vec<u8>)>>) -> Result<Vec<u8>> {
    let mut archive = ZipWriter::new(Cursor::new(Vec::new()));
    let failed = |error: &dyn std::fmt::Display| Error::refused(format!("no archive: {error}"));
    let options = SimpleFileOptions::default().compression_method(CompressionMethod::Deflated);
    for file in files {
        let (name, bytes) = file?;
        archive.start_file(name, options).map_err(|e| failed(&e))?;
        archive.write_all(&bytes).map_err(|e| failed(&e))?;
    }
    Ok(archive.finish().map_err(|e| failed(&e))?.into_inner())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_archive_comes_back_as_it_was() {
        let file = |name: &str, bytes: &[u8]| Ok((name.to_owned(), bytes.to_vec()));
        let bytes = packed([file("a.csv", b"1\n"), file("b/c.csv", &vec![0; 100_000])]).unwrap();
        assert!(bytes.len() < 1000);
        let (members, left) = unpacked(Path::new("x.zip"), bytes).unwrap();
        assert_eq!(members[1], ("b/c.csv".to_owned(), vec![0; 100_000]));
        assert_eq!((members.len(), left.len()), (2, 0));
    }

    #[test]
    fn a_name_that_leads_outside_is_left_out() {
        let file = |name: &str, bytes: &[u8]| Ok((name.to_owned(), bytes.to_vec()));
        let bytes = packed([file("../a.csv", b"1\n"), file("/b.csv", &[]), file("c.csv", &[1])]).unwrap();
        let (members, left) = unpacked(Path::new("x.zip"), bytes).unwrap();
        assert_eq!(members, [("c.csv".to_owned(), vec![1])]);
        assert_eq!(left.len(), 2);
    }

    #[test]
    fn an_archive_that_unpacks_to_too_much_is_refused() {
        let mut archive = ZipWriter::new(Cursor::new(Vec::new()));
        let part = vec![0_u8; 1 << 24];
        for k in 0..65 {
            archive.start_file(format!("{k}.csv"), SimpleFileOptions::default()).unwrap();
            archive.write_all(&part).unwrap();
        }
        let bytes = archive.finish().unwrap().into_inner();
        assert!(unpacked(Path::new("x.zip"), bytes).unwrap_err().to_string().contains("1 GiB"));
        assert!(unpacked(Path::new("x.zip"), b"PK\x03\x04".to_vec()).is_err());
    }
}

//! A folder of results, each file of which appears whole or not at all.

use crate::error::{Error, Place, Result};
use std::fs;
use std::path::{Component, Path, PathBuf};

/// Folder into which results are written.
///
/// A file is written beside its place under a temporary name and then renamed, so that a reader sees the old
/// file or the new one, never a part. This holds against failures and interruptions of this program; nothing
/// is forced to the disk, so a power failure in the seconds after may still lose the new content.
#[derive(Debug)]
pub struct Output {
    folder: PathBuf,
    written: Vec<String>,
}

impl Output {
    /// A folder, made with its parents when the first file is written, so that a job that fails before leaves nothing.
    ///
    /// # Errors
    /// If a file has its name.
    pub fn new(folder: impl Into<PathBuf>) -> Result<Output> {
        let folder = folder.into();
        if folder.exists() && !folder.is_dir() {
            return Err(Error::input(Place::file(&folder), "this is a file", "a folder for results")
                .hint("name another folder"));
        }
        Ok(Output { folder, written: Vec::new() })
    }

    /// The folder.
    pub fn folder(&self) -> &Path {
        &self.folder
    }

    /// Names of the files written, in order and each once.
    pub fn written(&self) -> &[String] {
        &self.written
    }

    /// Writes a file whole; returns its path.
    ///
    /// # Errors
    /// If `name` is no plain name of a file, or the system refuses. In either case a file that had this name stays as it was, and no temporary file is left.
    pub fn write(&mut self, name: &str, bytes: impl AsRef<[u8]>) -> Result<PathBuf> {
        let path = self.place(name)?;
        let temporary = temporary_beside(&path);
        let replaced = fs::write(&temporary, bytes).and_then(|()| fs::rename(&temporary, &path));
        if let Err(error) = replaced {
            // The first failure is the one to report; a leftover that cannot be removed either has the same
            // cause.
            let _ = fs::remove_file(&temporary);
            return Err(Error::io("write", &path, error));
        }
        if !self.written.iter().any(|w| w == name) {
            self.written.push(name.to_owned());
        }
        Ok(path)
    }

    /// Path of a file in this folder, which is made.
    fn place(&self, name: &str) -> Result<PathBuf> {
        let path = self.folder.join(checked(name)?);
        fs::create_dir_all(&self.folder).map_err(|e| Error::io("make the folder", &self.folder, e))?;
        if path.is_dir() {
            return Err(unusable(name, "names a folder").hint("remove that folder or choose another name"));
        }
        Ok(path)
    }
}

/// The name as one plain part of a path. A backslash or a colon would mean something else on another system, so both are refused.
fn checked(name: &str) -> Result<&Path> {
    let path = Path::new(name);
    let parts: Vec<Component<'_>> = path.components().collect();
    if !matches!(parts[..], [Component::Normal(_)]) || name.contains(['/', '\\', ':', '\0']) {
        return Err(unusable(name, "is no plain name"));
    }
    Ok(path)
}

fn unusable(name: &str, why: &str) -> Error {
    Error::usage(format!("the output name \"{name}\" {why}"), "a name such as response.svg")
}

/// A hidden name in the same folder, hence on the same file system; the process number keeps two programs
/// apart.
fn temporary_beside(path: &Path) -> PathBuf {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    // Names may be up to 255 bytes long on common file systems: the temporary one must not be the first to
    // exceed that.
    let head: String = name.chars().take(40).collect();
    path.with_file_name(format!(".{head}.{}.part", std::process::id()))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(folder: &Path) -> Vec<String> {
        let mut names: Vec<String> =
            fs::read_dir(folder).unwrap().map(|e| e.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        names
    }

    #[test]
    fn files_are_replaced_whole_and_remembered_once_in_order() {
        let dir = tempfile::tempdir().unwrap();
        let mut out = Output::new(dir.path().join("a/b")).unwrap();
        out.write("z.txt", "one").unwrap();
        out.write("x.svg", b"<svg/>").unwrap();
        out.write("z.txt", "two").unwrap();
        assert_eq!(out.written(), ["z.txt", "x.svg"]);
        assert_eq!(fs::read_to_string(out.folder().join("z.txt")).unwrap(), "two");
        assert_eq!(names(out.folder()), ["x.svg", "z.txt"]);
    }

    #[test]
    fn names_that_lead_outside_are_refused() {
        let dir = tempfile::tempdir().unwrap();
        let mut out = Output::new(dir.path().join("in")).unwrap();
        for name in ["", ".", "..", "../x", "a/x", "/etc/x", "a\\b", "c:x", "a/", "./a", "a\0b"] {
            let error = out.write(name, "x").unwrap_err();
            assert_eq!(error.exit_code(), 2, "{name:?}");
        }
        // The folder is made for the first file only.
        assert!(names(dir.path()).is_empty() && out.written().is_empty());
    }

    #[test]
    fn a_failure_leaves_the_old_content_and_no_temporary() {
        let dir = tempfile::tempdir().unwrap();
        let mut out = Output::new(dir.path()).unwrap();
        fs::create_dir(dir.path().join("x")).unwrap();
        fs::write(dir.path().join("x/old"), "old").unwrap();
        assert!(out.write("x", "new").is_err());
        // A name that fits for the temporary file, but not for the file itself: the rename fails.
        let long = "n".repeat(300);
        let error = out.write(&long, "new").unwrap_err().to_string();
        assert!(error.contains(&long) && !error.contains(".part"), "{error}");
        assert_eq!(names(dir.path()), ["x"]);
        assert_eq!(fs::read_to_string(dir.path().join("x/old")).unwrap(), "old");
        assert!(out.written().is_empty());
    }

    #[test]
    fn a_file_in_the_place_of_a_folder_is_an_error() {
        let dir = tempfile::tempdir().unwrap();
        fs::write(dir.path().join("f"), "x").unwrap();
        assert!(Output::new(dir.path().join("f")).is_err());
        assert_eq!(fs::read_to_string(dir.path().join("f")).unwrap(), "x");
    }
}

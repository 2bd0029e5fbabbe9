//! A folder of results, whose files appear together or not at all.

use super::Medium;
use crate::error::{Error, Place, Result};
use std::fs;
use std::io::{ErrorKind, Write};
use std::path::{Component, Path, PathBuf};
use tempfile::{NamedTempFile, TempPath};

/// Folder into which results are written.
///
/// Files are written beside their places under temporary names, and get their names together in [`Output::commit`]. A program that is
/// killed before leaves the old results as they were; one that is killed in between leaves the file [`Output::INCOMPLETE`]. Nothing is
/// forced to the disk: a power failure in the seconds after may still lose the new content.
#[derive(Debug)]
pub struct Output {
    /// What its figures are drawn for.
    pub medium: Medium,
    folder: PathBuf,
    written: Vec<String>,
    /// The file of each name, closed, and removed unless it gets its name.
    files: Vec<TempPath>,
}

impl Output {
    /// The file that marks a folder in which old and new results stand side by side.
    pub const INCOMPLETE: &str = "INCOMPLETE.txt";

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
        Ok(Output { medium: Medium::default(), folder, written: Vec::new(), files: Vec::new() })
    }

    /// The folder.
    pub fn folder(&self) -> &Path {
        &self.folder
    }

    /// Names of the files written, in order and each once.
    pub fn written(&self) -> &[String] {
        &self.written
    }

    /// Writes a file, or writes it anew.
    ///
    /// # Errors
    /// If `name` is no plain name of a file, or the system refuses.
    pub fn write(&mut self, name: &str, bytes: impl AsRef<[u8]>) -> Result<()> {
        let path = self.folder.join(checked(name)?);
        fs::create_dir_all(&self.folder).map_err(|e| Error::io("make the folder", &self.folder, e))?;
        if path.is_dir() {
            return Err(unusable(name, "names a folder").hint("remove that folder or choose another name"));
        }
        if self.written.is_empty() {
            remove_leftovers(&self.folder);
        }
        let refused = |e| Error::io("write", &path, e);
        let mut file = temporary(&self.folder).map_err(refused)?;
        file.write_all(bytes.as_ref()).map_err(refused)?;
        let file = file.into_temp_path();
        if let Some(i) = self.written.iter().position(|w| w == name) {
            self.files[i] = file;
        } else {
            self.written.push(name.to_owned());
            self.files.push(file);
        }
        Ok(())
    }

    /// Gives the files their names, which it returns in the order in which they were written.
    ///
    /// # Errors
    /// If the system refuses; the folder is then marked as incomplete.
    pub fn commit(self) -> Result<Vec<String>> {
        let mark = self.folder.join(Self::INCOMPLETE);
        if self.written.len() > 1 {
            let text = "Old and new results stand side by side here: run the same command again.\n";
            fs::write(&mark, text).map_err(|e| Error::io("write", &mark, e))?;
        }
        for (name, file) in self.written.iter().zip(self.files) {
            let path = self.folder.join(name);
            file.persist(&path).map_err(|e| Error::io("write", &path, e.error))?;
        }
        if self.written.len() > 1 {
            match fs::remove_file(&mark) {
                // Another run that ended here meanwhile has removed it.
                Err(e) if e.kind() != ErrorKind::NotFound => return Err(Error::io("remove", &mark, e)),
                _ => {}
            }
        }
        Ok(self.written)
    }
}

/// A file of a hidden name in the same folder, hence on the same file system, which everybody may read who may read a new file there.
fn temporary(folder: &Path) -> std::io::Result<NamedTempFile> {
    let mut named = tempfile::Builder::new();
    named.prefix(".").suffix(PART);
    #[cfg(unix)]
    named.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    named.tempfile_in(folder)
}

/// End of the names of temporary files.
const PART: &str = ".vibro.part";

/// Removes temporary files of killed programs: those that nobody has written to for an hour.
fn remove_leftovers(folder: &Path) {
    for entry in fs::read_dir(folder).into_iter().flatten().flatten() {
        let ours = entry.file_name().to_str().is_some_and(|n| n.starts_with('.') && n.ends_with(PART));
        let written = entry.metadata().and_then(|m| m.modified());
        if ours && written.is_ok_and(|t| t.elapsed().is_ok_and(|age| age.as_secs() > 3600)) {
            // It is in nobody's way: a leftover that cannot be removed is no failure.
            let _ = fs::remove_file(entry.path());
        }
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
        let folder = out.folder().to_owned();
        assert_eq!(out.commit().unwrap(), ["z.txt", "x.svg"]);
        assert_eq!(fs::read_to_string(folder.join("z.txt")).unwrap(), "two");
        assert_eq!(names(&folder), ["x.svg", "z.txt"]);
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
        assert!(out.written().is_empty());
        // A name that no file can have: the set stands half, and the folder says so.
        let long = "n".repeat(300);
        out.write("a", "new").unwrap();
        out.write(&long, "new").unwrap();
        let error = out.commit().unwrap_err().to_string();
        assert!(error.contains(&long) && !error.contains(PART), "{error}");
        assert_eq!(names(dir.path()), [Output::INCOMPLETE, "a", "x"]);
        assert_eq!(fs::read_to_string(dir.path().join("x/old")).unwrap(), "old");
        let mut again = Output::new(dir.path()).unwrap();
        again.write("a", "newer").unwrap();
        again.write("b", "newer").unwrap();
        again.commit().unwrap();
        assert_eq!(names(dir.path()), ["a", "b", "x"]);
    }

    #[test]
    fn a_set_appears_as_one_or_leaves_the_old_one() {
        let dir = tempfile::tempdir().unwrap();
        fs::write(dir.path().join("a"), "old").unwrap();
        let mut out = Output::new(dir.path()).unwrap();
        out.write("a", "new").unwrap();
        assert_eq!(fs::read_to_string(dir.path().join("a")).unwrap(), "old");
        drop(out);
        assert_eq!(names(dir.path()), ["a"]);
        assert_eq!(fs::read_to_string(dir.path().join("a")).unwrap(), "old");
    }

    #[test]
    fn leftovers_of_killed_programs_are_removed() {
        let dir = tempfile::tempdir().unwrap();
        let day = std::time::Duration::from_secs(24 * 3600);
        for (name, age) in [(".7.0", day), (".8.1", day / 10_000), ("9.0", day)] {
            let file = fs::File::create(dir.path().join(format!("{name}{PART}"))).unwrap();
            file.set_modified(std::time::SystemTime::now() - age).unwrap();
        }
        let mut out = Output::new(dir.path()).unwrap();
        out.write("a.csv", "x").unwrap();
        out.commit().unwrap();
        assert_eq!(names(dir.path()), [".8.1.vibro.part", "9.0.vibro.part", "a.csv"]);
    }

    #[test]
    fn a_file_in_the_place_of_a_folder_is_an_error() {
        let dir = tempfile::tempdir().unwrap();
        fs::write(dir.path().join("f"), "x").unwrap();
        assert!(Output::new(dir.path().join("f")).is_err());
        assert_eq!(fs::read_to_string(dir.path().join("f")).unwrap(), "x");
    }
}

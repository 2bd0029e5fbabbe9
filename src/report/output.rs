//! A folder of results, each file of which appears whole or not at all, and a set of them together.

use crate::error::{Error, Place, Result};
use std::fs::{self, File};
use std::io::{BufWriter, Write};
use std::path::{Component, Path, PathBuf};

/// Folder into which results are written.
///
/// A file is written beside its place under a temporary name and then renamed, so that a reader sees the old
/// file or the new one, never a part. This holds against failures and interruptions of this program; nothing
/// is forced to the disk, so a power failure in the seconds after may still lose the new content.
///
/// The files of a set ([`Output::set`]) get their names together in [`Output::commit`]: a program that is killed before leaves the old
/// set as it was, and one that is killed in between leaves the file [`Output::INCOMPLETE`].
#[derive(Debug)]
pub struct Output {
    folder: PathBuf,
    written: Vec<String>,
    /// Files of a set that wait for their names: temporary and final path.
    waiting: Option<Vec<(PathBuf, PathBuf)>>,
    /// Whether leftovers of killed programs have been removed.
    swept: bool,
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
        Ok(Output { folder, written: Vec::new(), waiting: None, swept: false })
    }

    /// The file that marks a folder in which old and new results stand side by side.
    pub const INCOMPLETE: &str = "INCOMPLETE.txt";

    /// A folder whose files replace the old ones together, in [`Output::commit`].
    ///
    /// # Errors
    /// As [`Output::new`].
    pub fn set(folder: impl Into<PathBuf>) -> Result<Output> {
        let mut output = Output::new(folder)?;
        output.waiting = Some(Vec::new());
        Ok(output)
    }

    /// Gives the files of a set their names.
    ///
    /// # Errors
    /// If the system refuses; then the folder is marked as incomplete.
    pub fn commit(&mut self) -> Result<()> {
        let Some(waiting) = self.waiting.as_mut().map(std::mem::take) else { return Ok(()) };
        let mark = self.folder.join(Self::INCOMPLETE);
        if !waiting.is_empty() {
            let text = "Old and new results stand side by side here: run the same command again.\n";
            fs::write(&mark, text).map_err(|e| Error::io("write", &mark, e))?;
        }
        for (temporary, path) in &waiting {
            fs::rename(temporary, path).map_err(|e| Error::io("write", path, e))?;
        }
        match fs::remove_file(&mark) {
            Err(e) if e.kind() != std::io::ErrorKind::NotFound => Err(Error::io("remove", &mark, e)),
            _ => Ok(()),
        }
    }

    /// The folder.
    pub fn folder(&self) -> &Path {
        &self.folder
    }

    /// Names of the files written, in order and each once.
    pub fn written(&self) -> &[String] {
        &self.written
    }

    /// Writes a file whole; Returns its path.
    ///
    /// # Errors
    /// If `name` is no plain name of a file, or the system refuses. In either case a file that had this name stays as it was, and no temporary file is left.
    pub fn write(&mut self, name: &str, bytes: impl AsRef<[u8]>) -> Result<PathBuf> {
        let path = self.place(name)?;
        let temporary = temporary_beside(&path);
        let named = |()| match &mut self.waiting {
            Some(waiting) => {
                waiting.retain(|(_, known)| *known != path);
                waiting.push((temporary.clone(), path.clone()));
                Ok(())
            }
            None => fs::rename(&temporary, &path),
        };
        let replaced = begin(&temporary).and_then(|mut file| file.write_all(bytes.as_ref())).and_then(named);
        if let Err(error) = replaced {
            // The first failure is the one to report; a leftover that cannot be removed either has the same
            // cause.
            let _ = fs::remove_file(&temporary);
            return Err(Error::io("write", &path, error));
        }
        self.list(name);
        Ok(path)
    }

    /// A file of a set that is written part by part.
    ///
    /// # Errors
    /// As [`Output::write`].
    pub fn growing(&mut self, name: &str) -> Result<BufWriter<File>> {
        let path = self.place(name)?;
        let temporary = temporary_beside(&path);
        let file = begin(&temporary).map_err(|e| Error::io("write", &path, e))?;
        self.waiting.get_or_insert_default().push((temporary, path));
        self.list(name);
        Ok(BufWriter::new(file))
    }

    fn list(&mut self, name: &str) {
        if !self.written.iter().any(|w| w == name) {
            self.written.push(name.to_owned());
        }
    }

    /// Path of a file in this folder, which is made.
    fn place(&mut self, name: &str) -> Result<PathBuf> {
        let path = self.folder.join(checked(name)?);
        fs::create_dir_all(&self.folder).map_err(|e| Error::io("make the folder", &self.folder, e))?;
        if !std::mem::replace(&mut self.swept, true) {
            sweep(&self.folder);
        }
        if path.is_dir() {
            return Err(unusable(name, "names a folder").hint("remove that folder or choose another name"));
        }
        Ok(path)
    }
}

impl Drop for Output {
    /// A set that was given up leaves nothing.
    fn drop(&mut self) {
        for (temporary, _) in self.waiting.iter().flatten() {
            let _ = fs::remove_file(temporary);
        }
    }
}

/// Removes temporary files of killed programs: those that nobody has written to for an hour.
fn sweep(folder: &Path) {
    for entry in fs::read_dir(folder).into_iter().flatten().flatten() {
        let name = entry.file_name();
        let ours = name.to_str().is_some_and(|n| n.starts_with('.') && n.strip_suffix(".part").is_some());
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

/// A hidden name in the same folder, hence on the same file system; the process number keeps two programs
/// apart.
fn temporary_beside(path: &Path) -> PathBuf {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    // Names may be up to 255 bytes long on common file systems: the temporary one must not be the first to
    // exceed that.
    let head: String = name.chars().take(40).collect();
    path.with_file_name(format!(".{head}.{}.part", std::process::id()))
}

fn begin(path: &Path) -> std::io::Result<File> {
    // A leftover of a program that was killed and had this process number is ours to replace.
    let _ = fs::remove_file(path);
    File::create_new(path)
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
    fn a_growing_file_appears_when_it_is_finished() {
        let home = tempfile::tempdir().unwrap();
        let mut output = Output::set(home.path()).unwrap();
        let mut file = output.growing("rows.csv").unwrap();
        file.write_all(b"a\n").unwrap();
        file.write_all(b"b\n").unwrap();
        assert!(!home.path().join("rows.csv").exists());
        drop(file);
        output.commit().unwrap();
        assert_eq!(fs::read_to_string(home.path().join("rows.csv")).unwrap(), "a\nb\n");
        drop(Output::set(home.path()).unwrap().growing("given_up.csv").unwrap());
        assert_eq!(
            (names(home.path()), output.written()),
            (vec!["rows.csv".to_owned()], &["rows.csv".to_owned()][..])
        );
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
    fn a_set_appears_as_one_or_leaves_the_old_one() {
        let dir = tempfile::tempdir().unwrap();
        fs::write(dir.path().join("a"), "old").unwrap();
        let mut out = Output::set(dir.path()).unwrap();
        out.write("a", "new").unwrap();
        out.write("b", "first").unwrap();
        out.write("b", "new").unwrap();
        assert_eq!(fs::read_to_string(dir.path().join("a")).unwrap(), "old");
        out.commit().unwrap();
        assert_eq!(fs::read_to_string(dir.path().join("a")).unwrap(), "new");
        assert_eq!(fs::read_to_string(dir.path().join("b")).unwrap(), "new");
        assert_eq!(names(dir.path()), ["a", "b"]);
        let mut given_up = Output::set(dir.path()).unwrap();
        given_up.write("a", "never").unwrap();
        drop(given_up);
        assert_eq!(names(dir.path()), ["a", "b"]);
        assert_eq!(fs::read_to_string(dir.path().join("a")).unwrap(), "new");
    }

    #[test]
    fn leftovers_of_killed_programs_are_removed() {
        let dir = tempfile::tempdir().unwrap();
        let day = std::time::Duration::from_secs(24 * 3600);
        for (name, age) in [(".a.csv.7.part", day), (".b.csv.8.part", day / 10_000), ("c.csv.9.part", day)] {
            let file = File::create(dir.path().join(name)).unwrap();
            file.set_modified(std::time::SystemTime::now() - age).unwrap();
        }
        Output::new(dir.path()).unwrap().write("a.csv", "x").unwrap();
        assert_eq!(names(dir.path()), [".b.csv.8.part", "a.csv", "c.csv.9.part"]);
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

//! Single files that a command writes where it was told.

use crate::error::{Error, Result};
use crate::report::Output;
use std::path::{Path, PathBuf};

/// Refuses two names of one file: what is read must not be written.
pub fn apart(a: &Path, b: &Path) -> Result<()> {
    let same = match (a.canonicalize(), b.canonicalize()) {
        (Ok(a), Ok(b)) => a == b,
        _ => a == b,
    };
    if same {
        return Err(Error::usage(
            format!("{} and {} are the same file", a.display(), b.display()),
            "two files",
        )
        .hint("name another file to write"));
    }
    Ok(())
}

/// Writes a file whole, in a folder that must exist.
pub(crate) fn write_beside(path: &Path, bytes: impl AsRef<[u8]>) -> Result<PathBuf> {
    let name = path
        .file_name()
        .ok_or_else(|| Error::usage(format!("{} is no file name", path.display()), "a file"))?;
    let folder = path.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
    if !folder.is_dir() {
        return Err(Error::usage(
            format!("the folder {} does not exist", folder.display()),
            "an existing folder",
        ));
    }
    Output::new(folder)?.write(&name.to_string_lossy(), bytes)
}

//! A file of results that is written part by part.

use crate::error::{Error, Result};
use std::fs::{self, File, OpenOptions};
use std::io::{BufWriter, Write};
use std::path::PathBuf;

/// A file under a temporary name, see [`super::Output::growing`]. Given up without being finished, it is removed.
#[derive(Debug)]
pub struct Growing {
    name: String,
    temporary: PathBuf,
    path: PathBuf,
    file: Option<BufWriter<File>>,
}

impl Growing {
    pub(super) fn new(name: &str, temporary: PathBuf, path: PathBuf) -> Result<Growing> {
        // A leftover of a program that was killed and had this process number is ours to replace.
        let _ = fs::remove_file(&temporary);
        let file = OpenOptions::new().write(true).create_new(true).open(&temporary);
        let file = Some(BufWriter::new(file.map_err(|e| Error::io("write", &path, e))?));
        Ok(Growing { name: name.to_owned(), temporary, path, file })
    }

    /// Writes the next part.
    ///
    /// # Errors
    /// If the system refuses.
    pub fn push(&mut self, text: &str) -> Result<()> {
        let Some(file) = &mut self.file else { return Ok(()) };
        file.write_all(text.as_bytes()).map_err(|e| Error::io("write", &self.path, e))
    }

    pub(super) fn finish(mut self) -> Result<(String, PathBuf)> {
        let ended = match self.file.take().map(BufWriter::into_inner) {
            Some(Err(error)) => Err(error.into_error()),
            _ => fs::rename(&self.temporary, &self.path),
        };
        if let Err(error) = ended {
            let _ = fs::remove_file(&self.temporary);
            return Err(Error::io("write", &self.path, error));
        }
        Ok((self.name.clone(), self.path.clone()))
    }
}

impl Drop for Growing {
    fn drop(&mut self) {
        if self.file.take().is_some() {
            let _ = fs::remove_file(&self.temporary);
        }
    }
}

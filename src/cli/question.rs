//! A command that gives one answer, which is printed, or returned to a program.

use super::print;
use crate::analysis::{Answer, Progress};
use crate::error::Result;
use crate::read::Folder;
use crate::report::files::Names;
use std::path::{Path, PathBuf};

/// Access to files and the receiver of progress, for one answer.
pub struct Asked<'a> {
    pub folder: &'a Folder,
    pub progress: &'a dyn Progress,
}

/// The typed options of a command that gives one answer.
pub trait Question {
    /// Names of the files that are written into the folder for results.
    fn names(&self) -> Names;

    /// Folder for results, if one was typed.
    fn out(&self) -> Option<&Path>;

    /// Files that are read, which results must not replace.
    fn files(&self) -> Vec<PathBuf> {
        Vec::new()
    }

    /// Whether names in a file may lead outside its folder. A record that was typed may lie anywhere.
    fn allow_outside(&self) -> bool {
        true
    }

    /// What the progress bar shows at first.
    fn work(&self) -> &'static str {
        "samples"
    }

    /// Computes the answer.
    ///
    /// # Errors
    /// If a file cannot be read, or the data allow no answer.
    fn answer(&self, asked: &Asked<'_>) -> Result<Answer>;
}

/// Prints the answer, with a progress bar until it is there. Gives the exit code.
///
/// # Errors
/// As [`Question::answer`]; if results cannot be written.
pub fn printed(question: &dyn Question, json: bool) -> Result<u8> {
    let folder = Folder::default().allow_outside(question.allow_outside());
    question.files().iter().for_each(|file| folder.reads(file));
    let output = print::results(&folder, question.out(), question.names())?;
    let answer = |bar: &indicatif::ProgressBar| question.answer(&Asked { folder: &folder, progress: bar });
    print::answer(print::busy(json, question.work(), answer)?, output, json)
}

//! A command that gives one answer, which is printed, or returned to a program.

use super::print;
use super::study::Shared;
use crate::analysis::{Answer, Progress};
use crate::error::{Error, Result};
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

    /// The part that is asked for, as it was typed; `None` if the whole answer is.
    fn shard(&self) -> Option<&str> {
        None
    }

    /// The study of a question that can be computed in parts; its files are read through `folder`.
    ///
    /// # Errors
    /// If the study is impossible.
    fn study(&self, _folder: &Folder) -> Result<Option<Shared>> {
        Ok(None)
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
    if let Some(shard) = question.shard() {
        let study = question.study(&folder)?.ok_or_else(|| {
            let found = format!("part {shard} of one answer");
            Error::usage(found, "a Monte Carlo, whose draws are computed in parts")
                .hint("--monte-carlo 10000")
        })?;
        return study.printed(shard.parse()?, question.out(), json);
    }
    question.files().iter().for_each(|file| folder.reads(file));
    let output = print::results(&folder, question.out(), question.names())?;
    let answer = |bar: &indicatif::ProgressBar| question.answer(&Asked { folder: &folder, progress: bar });
    print::answer(print::busy(json, question.work(), answer)?, output, json)
}

//! What a program asks by the words of a command line.

use super::question::{Asked, Question};
use super::study::Shared;
use super::{CommandRow, CommandSource, campaign, command_of, complain, numbers, options, rows};
use crate::analysis::{Answer, Progress};
use crate::campaign::Reading;
use crate::error::{Error, Result};
use crate::read::Folder;
use clap::{Args, Command as Typed};

/// Answers what a program asks by the words of a command line, without `vibro`: one of [`questions`].
/// Files are opened through `folder`.
///
/// # Errors
/// If the words are no question, or the data allow no answer.
pub fn answer(words: &[String], folder: &Folder, progress: &dyn Progress) -> Result<Answer> {
    let question = question(words)?;
    let folder = &folder.clone().allow_outside(question.allow_outside());
    question.answer(&Asked { folder, progress })
}

/// The study that the words of a command line ask for, without `vibro`: its parts may be computed elsewhere.
///
/// # Errors
/// If the words are no question, or one that is not computed in parts.
pub fn study(words: &[String]) -> Result<Shared> {
    let whole = || Error::usage(format!("{} is one cell", words.join(" ")), "work in cells, such as a map");
    question(words)?.study(&Folder::default())?.ok_or_else(whole)
}

/// The question of the words of a command line.
fn question(words: &[String]) -> Result<Box<dyn Question>> {
    let unknown = || Error::usage(format!("{} asks nothing", words.join(" ")), "a command with an answer");
    let row = rows().find(|row| words.first().is_some_and(|word| word == row.name())).ok_or_else(unknown)?;
    let typed =
        options(command_of(&row)).try_get_matches_from(words).map_err(|error| complain::plain(&error))?;
    let last = std::iter::successors(Some(&typed), |at| Some(at.subcommand()?.1)).last();
    numbers(last.unwrap_or(&typed))?;
    row.question(&typed).ok_or_else(unknown)?.map_err(|error| complain::plain(&error))
}

/// Runs a campaign by the words of `vibro run`, without these two, and writes its results.
///
/// # Errors
/// If the words are none of its options, the campaign cannot be read, or results cannot be written.
pub fn run(words: &[String], progress: &dyn Progress) -> Result<campaign::RunResults> {
    of_words::<campaign::Run>("run", words)?.results(progress)
}

/// How a file is read, by words of a command line.
///
/// # Errors
/// If the words are no options for reading.
pub fn reading(words: &[String]) -> Result<Reading> {
    of_words::<Reading>("read", words)
}

/// Options of a kind by words of a command line.
fn of_words<T: Args>(name: &'static str, words: &[String]) -> Result<T> {
    let line = options(T::augment_args(Typed::new(name)));
    let words = std::iter::once(name).chain(words.iter().map(String::as_str));
    let typed = line.try_get_matches_from(words).map_err(|error| complain::plain(&error))?;
    numbers(&typed)?;
    T::from_arg_matches(&typed).map_err(|error| complain::plain(&error))
}

/// The commands that [`answer`] takes, with their options.
pub fn questions() -> Vec<Typed> {
    let asks = |row: &CommandRow| !matches!(row.source, CommandSource::Args { .. });
    rows().filter(asks).map(|row| options(command_of(&row))).collect()
}

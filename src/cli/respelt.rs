//! Rewrites the typed words before they are parsed. File name patterns that the shell did not expand are
//! expanded; renamed options are replaced, with a note.

use super::{complain, typed};
use crate::analysis::matching;
use crate::read::Folder;
use crate::record::without_unit;
use std::ffi::OsString;
use std::path::{Path, PathBuf};

/// Renamed options: command, old spelling, new spelling.
const RENAMED: [(&str, &str, &str); 8] = [
    ("drill", "--from", "--beam-from"),
    ("drill", "--fit", "--fit-duration"),
    ("drill", "--noise", "--noise-record"),
    ("precision", "--from", "--results"),
    ("response", "--band", "--peak-lines"),
    ("waterfall", "--band", "--peak-lines"),
    ("model sweep", "--rate", "--sweep-rate"),
    ("model choose", "--noise", "--noise-floor"),
];

/// Commands that take several files. For others a pattern must match a single file. `convert` takes no
/// pattern, since one of its words names the file to write.
const MULTI_FILE_COMMANDS: [&str; 2] = ["info", "restitution"];

/// Files that match a word with a pattern, in numerical order (`run2` before `run10`); the word itself if no
/// file matches. As in a shell, a hidden file needs an explicit dot.
fn matching_files(word: OsString, command: &str) -> Vec<OsString> {
    let pattern =
        word.to_str().filter(|w| w.contains(['*', '?']) && !w.starts_with('-') && !Path::new(w).exists());
    let any = Folder::default().allow_outside(true);
    let files = pattern.and_then(|pattern| matching(&any, Path::new(&pattern.replace('[', "[[]"))).ok());
    let files = files.unwrap_or_default();
    let expands =
        files.len() == 1 && command != "convert" || files.len() > 1 && MULTI_FILE_COMMANDS.contains(&command);
    if expands { files.into_iter().map(PathBuf::into_os_string).collect() } else { vec![word] }
}

/// Whether standard input, `-`, is named more than once: it can be read only once.
pub fn repeats_stdin() -> bool {
    typed::words().filter(|word| word == "-").count() > 1
}

/// Joins a number and the unit typed after it, so that the error about the unit names its option: `--height
/// 0.4 m`.
fn joined_units(mut typed: Vec<OsString>) -> Vec<OsString> {
    let is_unit =
        |unit: &str| without_unit("mass", &format!("1{unit}")).is_some() && !Path::new(unit).exists();
    let joined = |words: &[OsString]| {
        let [option, number, unit] = [0, 1, 2].map(|k| words.get(k).and_then(|word| word.to_str()));
        let (option, number, unit) = (option?, number?, unit?);
        let unit_of = option.starts_with("--") && number.parse::<f64>().is_ok() && is_unit(unit);
        unit_of.then(|| format!("{option}={number}{unit}"))
    };
    for k in (0..typed.len()).rev() {
        if let Some(word) = joined(&typed[k..]) {
            typed.splice(k..k + 3, [word.into()]);
        }
    }
    typed
}

/// The typed words with patterns expanded and current spellings.
pub fn args() -> impl Iterator<Item = OsString> {
    let typed = joined_units(typed::words().collect());
    let words = typed.iter().skip(1).filter_map(|word| word.to_str()).filter(|word| !word.starts_with('-'));
    let command = words.take(2).collect::<Vec<_>>().join(" ");
    let first = command.split(' ').next().unwrap_or_default().to_owned();
    let of = move |row: &&(&str, &str, &str)| command == row.0 || command.starts_with(&format!("{} ", row.0));
    let rows: Vec<_> = RENAMED.iter().filter(of).collect();
    // A word after an option may be its value and is not rewritten.
    let mut may_be_file = true;
    let expanded = move |word: OsString| {
        let is_option = word.to_str().is_some_and(|w| w.starts_with('-'));
        let rewritten = std::mem::replace(&mut may_be_file, !is_option);
        if rewritten { matching_files(word, &first) } else { vec![word] }
    };
    typed.into_iter().flat_map(expanded).map(move |word| {
        let (option, value) = word.to_str().and_then(|w| w.split_once('=')).unzip();
        let option = option.or(word.to_str());
        let Some((_, old, new)) = rows.iter().find(|row| option == Some(row.1)) else { return word };
        complain::line(&format!("note: {old} is {new} now; the old spelling still works"));
        value.map_or_else(|| (*new).into(), |value| format!("{new}={value}").into())
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn old_spellings_are_no_option_of_their_commands_and_new_ones_are() {
        for (command, old, new) in RENAMED {
            let all = crate::cli::command();
            let of = command.split(' ').fold(&all, |at, name| at.find_subcommand(name).unwrap());
            let has =
                |option: &str| of.get_arguments().any(|arg| arg.get_long() == option.strip_prefix("--"));
            assert!(has(new) && !has(old), "{command} {old} {new}");
        }
    }
}

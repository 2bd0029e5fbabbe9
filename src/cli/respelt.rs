//! What was typed, as the commands take it: patterns of file names become names where no shell did that, and options that once had the
//! name of another one get their own, with a note.

use super::complain;
use std::ffi::OsString;
use std::path::{Path, PathBuf};

/// Command, old and new spelling.
const OLD: [(&str, &str, &str); 8] = [
    ("drill", "--from", "--beam-from"),
    ("drill", "--fit", "--fit-duration"),
    ("drill", "--noise", "--noise-record"),
    ("precision", "--from", "--results"),
    ("response", "--band", "--peak-lines"),
    ("waterfall", "--band", "--peak-lines"),
    ("model sweep", "--rate", "--sweep-rate"),
    ("model choose", "--noise", "--noise-floor"),
];

/// The files that a pattern stands for, in the order of their numbers; another word as it is.
fn named(word: OsString) -> Vec<OsString> {
    let pattern =
        word.to_str().filter(|w| w.contains(['*', '?']) && !w.starts_with('-') && !Path::new(w).exists());
    let files = pattern.and_then(|pattern| glob::glob(pattern).ok()).into_iter().flatten().flatten();
    let mut files: Vec<OsString> = files.map(PathBuf::into_os_string).collect();
    files.sort_by(|a, b| natord::compare(&a.to_string_lossy(), &b.to_string_lossy()));
    if files.is_empty() { vec![word] } else { files }
}

/// What was typed, in the spelling of today.
pub fn args() -> impl Iterator<Item = OsString> {
    let typed: Vec<OsString> = std::env::args_os().collect();
    let words = typed.iter().skip(1).filter_map(|word| word.to_str()).filter(|word| !word.starts_with('-'));
    let command = words.take(2).collect::<Vec<_>>().join(" ");
    let of = move |row: &&(&str, &str, &str)| command == row.0 || command.starts_with(&format!("{} ", row.0));
    let rows: Vec<_> = OLD.iter().filter(of).collect();
    typed.into_iter().flat_map(named).map(move |word| {
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
        for (command, old, new) in OLD {
            let all = crate::cli::command();
            let of = command.split(' ').fold(&all, |at, name| at.find_subcommand(name).unwrap());
            let has =
                |option: &str| of.get_arguments().any(|arg| arg.get_long() == option.strip_prefix("--"));
            assert!(has(new) && !has(old), "{command} {old} {new}");
        }
    }
}

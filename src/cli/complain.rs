//! Complaints go to standard error, in one form. A closed standard error is no reason to fail.

use super::{CommandRow, print, rows};
use crate::campaign::{two, without_unit};
use crate::error::Error;
use crate::record::{Severity, nearest};
use crate::report::words::Voice;
use clap::error::{ContextKind, ContextValue, ErrorKind};
use serde_json::json;
use std::error::Error as _;
use std::io::Write;
use std::path::Path;

/// Prints an error, with `json` as an object on standard output as well, and gives its exit code.
pub fn error(error: &Error, voice: Voice, json: bool) -> u8 {
    errors(std::slice::from_ref(error), voice, json)
}

/// Prints several errors as [`error`] does one. The exit code is the largest.
pub fn errors(all: &[Error], voice: Voice, json: bool) -> u8 {
    // A hint of the crates below knows no name of the file.
    let file = std::env::args_os().skip(2).find(|word| Path::new(word).is_file());
    let spoken = |error: &Error| {
        let text = error.text_with(|key, value| voice.set(key, value));
        let text = match (text.strip_suffix(" FILE"), &file) {
            (Some(command), Some(file)) => format!("{command} {}", print::typed(Path::new(file))),
            _ => text,
        };
        let help = voice == Voice::Command && error.is_bare_usage();
        if help { format!("{text}\n  try: {} --help", typed().0) } else { text }
    };
    let texts: Vec<String> = all.iter().map(spoken).collect();
    for text in &texts {
        line(&format!("vibro: {text}"));
    }
    let code = all.iter().map(Error::exit_code).max().unwrap_or(0);
    if json {
        object(&texts.join("\n"), code);
    }
    code
}

/// Prints what can be typed where no command was, with `json` as an object on standard output as well.
pub fn nothing(commands: &str, json: bool) -> u8 {
    line(commands.trim_end());
    if json {
        object("no command", 2);
    }
    2
}

/// Prints what clap has to say: help and version are no error, anything else is wrong usage, with `json` as
/// an object on standard output as well.
pub fn usage(complaint: &clap::Error, json: bool) -> u8 {
    if !complaint.use_stderr() {
        // A closed pipe behind --help is no reason to complain.
        let _ = complaint.print();
        return 0;
    }
    if complaint.kind() == ErrorKind::DisplayHelpOnMissingArgumentOrSubcommand {
        return nothing(&complaint.to_string(), json);
    }
    error(&plain(complaint), Voice::Command, json)
}

/// The command that was typed, with its row and the names of its own commands and options.
fn typed() -> (String, Option<&'static CommandRow>, Vec<String>) {
    let words = std::env::args_os().skip(1).map(|word| word.to_string_lossy().into_owned());
    let words: Vec<String> = words.filter(|word| !word.starts_with('-')).collect();
    let row = rows().find(|row| words.first().is_some_and(|word| word == row.name()));
    let mut command = super::command();
    let mut names = vec!["vibro"];
    for word in words.iter().take(2) {
        let Some(part) = command.find_subcommand(word).cloned() else { break };
        command = part;
        names.push(word);
    }
    let parts = command.get_subcommands().map(|part| part.get_name().to_owned());
    let options = command.get_arguments().filter_map(|arg| Some(format!("--{}", arg.get_long()?)));
    (names.join(" "), row, parts.chain(options).collect())
}

/// Words of the field, and the commands that are meant by them.
const WORDS: [(&str, &str); 11] = [
    ("modes", "modal"),
    ("hammer", "modal"),
    ("frf", "modal"),
    ("fft", "spectrum"),
    ("psd", "spectrum"),
    ("sweep", "response"),
    ("drop", "restitution"),
    ("bounce", "restitution"),
    ("contact", "pulse"),
    ("report", "run"),
    ("plot", "run"),
];

/// The commands that have an option.
fn commands_with(option: &str) -> Vec<String> {
    let has = |command: &clap::Command| {
        let name = option.strip_prefix("--");
        name.is_some() && command.get_arguments().any(|arg| arg.get_long() == name)
    };
    super::command().get_subcommands().filter(|c| has(c)).map(|c| c.get_name().to_owned()).collect()
}

/// What clap complains of, in our form.
fn plain(complaint: &clap::Error) -> Error {
    let context = |kind| complaint.get(kind).map(ToString::to_string);
    let (command, row, own) = typed();
    let of =
        command.strip_prefix("vibro ").map_or_else(|| "there is".to_owned(), |name| format!("{name} has"));
    let help = format!("{command} --help");
    let argument = context(ContextKind::InvalidArg).unwrap_or_default();
    // Without clap's brackets: an option and what it takes.
    let argument = argument.replace(['<', '>', '[', ']'], "").replace("...", "");
    let option = argument.split_whitespace().next().unwrap_or_default();
    match complaint.kind() {
        ErrorKind::InvalidSubcommand => {
            let name = context(ContextKind::InvalidSubcommand).unwrap_or_default();
            let called =
                WORDS.iter().find(|(word, _)| *word == name && command == "vibro").map(|(_, own)| *own);
            let near = called.or_else(|| nearest(&name, own.iter().map(String::as_str)));
            // What was typed behind it stays.
            let behind = std::env::args_os().skip_while(|word| *word != *name).skip(1);
            let rest = || behind.map(|word| print::typed(Path::new(&word))).collect::<Vec<_>>().join(" ");
            let hint = match near {
                _ if Path::new(&name).is_file() => format!("vibro info {}", print::typed(Path::new(&name))),
                _ if Path::new(&name).is_dir() => format!("vibro run {}", print::typed(Path::new(&name))),
                Some(near) => format!("{command} {near} {}", rest()).trim_end().to_owned(),
                None => help.clone(),
            };
            Error::usage(format!("no command is called {name:?}"), "").hint(hint)
        }
        ErrorKind::MissingRequiredArgument => {
            let example = row.map(|row| format!("vibro {}", row.example));
            let example = example.filter(|example| example.starts_with(&command)).unwrap_or(help);
            Error::usage(format!("{} needs {argument}", command.trim_start_matches("vibro ")), "")
                .hint(example)
        }
        ErrorKind::UnknownArgument if Path::new(option).exists() => {
            Error::usage(format!("one file too many: {argument}"), "")
                .hint("one file at a time; for all of a folder: vibro run FOLDER")
        }
        ErrorKind::UnknownArgument => {
            let what = if option.starts_with('-') { "option" } else { "place for" };
            let others = commands_with(option);
            let expected = if others.is_empty() {
                String::new()
            } else {
                format!("an option of its own: {option} is one of {}", others.join(", "))
            };
            let near = nearest(option, own.iter().map(String::as_str)).filter(|_| others.is_empty());
            Error::usage(format!("{of} no {what} {argument}"), expected).hint(near.unwrap_or(&help))
        }
        ErrorKind::InvalidValue | ErrorKind::ValueValidation => {
            let value = context(ContextKind::InvalidValue).unwrap_or_default();
            let why = complaint.source().map(ToString::to_string).unwrap_or_default();
            value_of(&command, &argument, &value, &why, complaint.get(ContextKind::ValidValue))
        }
        _ => {
            let text = complaint.to_string();
            let first = text.lines().next().unwrap_or_default();
            Error::usage(first.trim_start_matches("error: "), "").hint(help)
        }
    }
}

/// A value that an option cannot take.
fn value_of(command: &str, argument: &str, value: &str, why: &str, known: Option<&ContextValue>) -> Error {
    let (help, option) = (format!("{command} --help"), argument.split(' ').next().unwrap_or_default());
    if value.is_empty() {
        let expected = if option.starts_with('-') { argument } else { "a name" };
        return Error::usage(format!("{option} without a value"), expected).hint(help);
    }
    let expected = NUMBERS.iter().find(|(of_std, _)| why.contains(of_std)).map(|(_, ours)| *ours);
    let names = match known {
        Some(ContextValue::Strings(names)) => names.clone(),
        _ if why.contains(" is not in ") => Vec::new(),
        _ => why.split('`').skip(3).step_by(2).map(str::to_owned).collect(),
    };
    let listed = (!names.is_empty()).then(|| format!("one of {}", names.join(", ")));
    let range = why.split_once(" is not in ").and_then(|(_, range)| range.split_once("..="));
    let range = range.map(|(low, high)| format!("a whole number from {low} to {high}"));
    let expected = expected.map(str::to_owned).or(range).or(listed).unwrap_or_else(|| why.to_owned());
    let point = value.replacen(',', ".", 1);
    let near = nearest(value, names.iter().map(String::as_str));
    let range = value.replacen([',', '-', ';'], ":", 1);
    let is_range = why.contains("':'") && two::<':'>(&range).is_ok();
    let typed = |value: &str| {
        if option.starts_with('-') { format!("{option} {value}") } else { format!("{command} {value}") }
    };
    let hint = if is_range {
        typed(&range)
    } else if value != point && expected == NUMBERS[0].1 && point.parse::<f64>().is_ok() {
        typed(&point)
    } else if let Some(number) = without_unit(option, value) {
        typed(&number.to_string())
    } else {
        near.map_or(help, typed)
    };
    Error::usage(format!("{option} is {value}"), expected).hint(hint)
}

/// What the standard library says of a value that is no number, and what a person needs to know.
const NUMBERS: [(&str, &str); 3] = [
    ("invalid float literal", "a number, such as 0.5 or 1e-3"),
    ("invalid digit found in string", "a whole number, 0 or more"),
    ("cannot parse integer from empty string", "a whole number"),
];

/// What a program reads in place of an answer.
fn object(error: &str, exit_code: u8) {
    // There is nobody left to tell of a failure to print a failure.
    let _ = print::object(json!({ "error": error, "exit_code": exit_code, "warnings": [] }));
}

/// Prints findings for a person; JSON carries them itself.
pub(crate) fn warn(findings: &[(Severity, String)]) {
    for (severity, sentence) in findings {
        line(&format!("{}: {sentence}", severity.name()));
    }
}

/// One line on standard error.
pub fn line(text: &str) {
    let _ = writeln!(std::io::stderr(), "{}", print::printable(text));
}

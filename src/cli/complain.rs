//! Errors and findings on standard error, in one form. A closed standard error is ignored.

use super::typed::words as typed_words;
use super::{CommandRow, rows, stdout};
use crate::error::{Error, Hint};
use crate::record::{Kind, Severity, nearest, typed};
use crate::report::words::{Voice, foremost};
use crate::units::notation::counted;
use clap::error::{ContextKind, ContextValue, ErrorKind};
use clap::{Arg, Command as Typed};
use serde_json::json;
use std::error::Error as _;
use std::ffi::OsString;
use std::io::Write;
use std::path::Path;

/// Prints an error, with `json` also as an object on standard output, and gives its exit code.
pub fn error(error: &Error, voice: Voice, json: bool) -> u8 {
    errors(std::slice::from_ref(error), voice, json)
}

/// Prints several errors as [`error`] does one. The exit code is the largest.
pub fn errors(all: &[Error], voice: Voice, json: bool) -> u8 {
    let spoken = |error: &Error| {
        let text = error.text_with(|key, value| voice.set(key, value), |hint| spelt(hint, error));
        let help = voice == Voice::Command && error.is_bare_usage();
        if help { format!("{text}\n  try: {} --help", TypedCommand::of_args().command) } else { text }
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

/// Prints the short list of commands where none was typed, with `json` also an object on standard output.
pub fn nothing(commands: &str, json: bool) -> u8 {
    line(commands.trim_end());
    if json {
        object("no command", 2);
    }
    2
}

/// Prints a message of clap. Help and version go to standard output; anything else is a usage error, with
/// `json` also an object on standard output.
pub fn usage(complaint: &clap::Error, json: bool) -> u8 {
    if !complaint.use_stderr() {
        // A closed pipe after --help is no error.
        let _ = complaint.print();
        return 0;
    }
    if complaint.kind() == ErrorKind::DisplayHelpOnMissingArgumentOrSubcommand {
        return nothing(&complaint.to_string(), json);
    }
    error(&plain(complaint), Voice::Command, json)
}

/// The hint of an error, with the words that were typed filled in.
fn spelt(hint: &Hint, error: &Error) -> String {
    let words = || typed_words().skip(1);
    match hint {
        Hint::OfFile(command) => match file_of(error, words().skip(1)) {
            Some(file) => format!("{command} {}", typed(file)),
            None => hint.to_string(),
        },
        Hint::Name { wrong, meant } if words().any(|word| word == *wrong) => {
            let words = words().map(|word| typed(if word == *wrong { meant.as_os_str() } else { &word }));
            format!("vibro {}", words.collect::<Vec<_>>().join(" "))
        }
        Hint::Name { meant, .. } => typed(meant),
        Hint::Words(words) => words.clone(),
    }
}

/// The typed file that an error is about; the first typed file where the error names none of them.
fn file_of(error: &Error, words: impl Iterator<Item = OsString>) -> Option<OsString> {
    let files: Vec<OsString> = words.filter(|word| Path::new(word).is_file()).collect();
    let about = |file: &&OsString| error.subject().is_some_and(|subject| Path::new(file).ends_with(subject));
    files.iter().find(about).or(files.first()).cloned()
}

/// The command that was typed.
struct TypedCommand {
    /// Full name: `vibro model orbit`.
    command: String,
    row: Option<CommandRow>,
    /// Definition of the command: subcommands and arguments.
    definition: Typed,
}

impl TypedCommand {
    fn of_args() -> TypedCommand {
        let words = typed_words().skip(1).map(|word| word.to_string_lossy().into_owned());
        let words: Vec<String> = words.filter(|word| !word.starts_with('-')).collect();
        let row = rows().find(|row| words.first().is_some_and(|word| word == row.name()));
        let mut found = TypedCommand { command: "vibro".to_owned(), row, definition: super::command() };
        for word in words.iter().take(2) {
            let Some(part) = found.definition.find_subcommand(word).cloned() else { break };
            found.definition = part;
            found.command = format!("{} {word}", found.command);
        }
        found
    }

    /// Names of the subcommands and options of the command.
    fn names(&self) -> Vec<String> {
        let parts = self.definition.get_subcommands().map(|part| part.get_name().to_owned());
        let options =
            self.definition.get_arguments().filter_map(|arg| Some(format!("--{}", arg.get_long()?)));
        parts.chain(options).collect()
    }

    /// An argument as it is typed: an option with the name of its value, or the name of a positional
    /// argument. An unknown one is returned unchanged.
    fn argument(&self, named: &str) -> String {
        let name = |arg: &Arg| arg.get_value_names().unwrap_or_default().join(" ");
        let is = |arg: &&Arg| match arg.get_long() {
            Some(long) => {
                named.split([' ', '=']).next().and_then(|word| word.strip_prefix("--")) == Some(long)
            }
            None => named.trim_matches(['<', '>', '[', ']', '.']) == name(arg),
        };
        match self.definition.get_arguments().find(is) {
            Some(arg) => {
                let long = arg.get_long().map(|long| format!("--{long} "));
                format!("{}{}", long.unwrap_or_default(), name(arg)).trim_end().to_owned()
            }
            None => named.to_owned(),
        }
    }
}

/// Terms of the field that are not names of commands, each with the command for it.
const FIELD_TERMS: [(&str, &str); 11] = [
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

/// Names of the commands that take an option.
fn commands_with(option: &str) -> Vec<String> {
    let has = |command: &clap::Command| {
        let name = option.strip_prefix("--");
        name.is_some() && command.get_arguments().any(|arg| arg.get_long() == name)
    };
    super::command().get_subcommands().filter(|c| has(c)).map(|c| c.get_name().to_owned()).collect()
}

/// Turns an error of clap into an [`Error`], by its kind and context; its text is not used.
pub fn plain(complaint: &clap::Error) -> Error {
    let context = |kind| complaint.get(kind).map(ToString::to_string).unwrap_or_default();
    let words = TypedCommand::of_args();
    let command = &words.command;
    let name = command.strip_prefix("vibro ");
    let help = format!("{command} --help");
    let arguments = |kind| -> Vec<String> {
        match complaint.get(kind) {
            Some(ContextValue::Strings(all)) => all.iter().map(|named| words.argument(named)).collect(),
            Some(ContextValue::String(named)) => vec![words.argument(named)],
            _ => Vec::new(),
        }
    };
    let argument = arguments(ContextKind::InvalidArg).join(", ");
    let value = context(ContextKind::InvalidValue);
    match complaint.kind() {
        ErrorKind::InvalidSubcommand => unknown_command(&words, &context(ContextKind::InvalidSubcommand)),
        ErrorKind::MissingRequiredArgument => {
            let example = words.row.map(|row| format!("vibro {}", row.example));
            let example = example.filter(|example| example.starts_with(command)).unwrap_or(help);
            Error::usage(format!("{} needs {argument}", name.unwrap_or(command)), "").hint(example)
        }
        ErrorKind::UnknownArgument => unknown_argument(&words, &argument),
        ErrorKind::InvalidValue | ErrorKind::ValueValidation if value.is_empty() => {
            let option = argument.split(' ').next().unwrap_or_default();
            let expected = if option.starts_with('-') { &argument } else { "a name" };
            Error::usage(format!("{option} without a value"), expected).hint(help)
        }
        ErrorKind::InvalidValue | ErrorKind::ValueValidation => {
            let kind = complaint.source().and_then(|source| source.downcast_ref::<Kind>());
            let names = match complaint.get(ContextKind::ValidValue) {
                Some(ContextValue::Strings(names)) => names.clone(),
                _ => Vec::new(),
            };
            wrong_value(command, &argument, &value, kind, &names)
        }
        ErrorKind::ArgumentConflict => {
            let other = arguments(ContextKind::PriorArg).join(", ");
            let found = if other == argument || other.is_empty() {
                format!("{argument} stands twice")
            } else {
                format!("{argument} stands beside {other}")
            };
            Error::usage(found, "one of them").hint(help)
        }
        ErrorKind::WrongNumberOfValues => {
            let found = format!("{argument}: {} value", context(ContextKind::ActualNumValues));
            Error::usage(found, context(ContextKind::ExpectedNumValues)).hint(help)
        }
        kind => Error::usage(format!("{argument} {kind}").trim_start(), "").hint(help),
    }
}

/// The error of an unknown command.
fn unknown_command(words: &TypedCommand, name: &str) -> Error {
    let TypedCommand { command, .. } = words;
    let called =
        FIELD_TERMS.iter().find(|(word, _)| *word == name && command == "vibro").map(|(_, own)| *own);
    let own = words.names();
    let near = called.or_else(|| nearest(name, own.iter().map(String::as_str)));
    // The hint keeps the arguments that were typed after the command.
    let behind = typed_words().skip_while(|word| **word != *name).skip(1);
    let rest = || behind.map(typed).collect::<Vec<_>>().join(" ");
    let hint = match near {
        _ if Path::new(name).is_file() => format!("vibro info {}", typed(name)),
        _ if Path::new(name).is_dir() => format!("vibro run {}", typed(name)),
        Some(near) => format!("{command} {near} {}", rest()).trim_end().to_owned(),
        None => format!("{command} --help"),
    };
    Error::usage(format!("no command is called {name:?}"), "").hint(hint)
}

/// The error of an argument that the command does not take.
fn unknown_argument(words: &TypedCommand, argument: &str) -> Error {
    let option = argument.split([' ', '=']).next().unwrap_or_default();
    if Path::new(argument).exists() {
        return Error::usage(format!("one file too many: {argument}"), "")
            .hint("one file at a time; for all of a folder: vibro run FOLDER");
    }
    let of = words.command.strip_prefix("vibro ").map_or("there is".to_owned(), |name| format!("{name} has"));
    let what = if option.starts_with('-') { "option" } else { "place for" };
    let others = commands_with(option);
    let expected = if others.is_empty() {
        String::new()
    } else {
        format!("an option of its own: {option} is one of {}", others.join(", "))
    };
    let own = words.names();
    let near = nearest(option, own.iter().map(String::as_str)).filter(|_| others.is_empty());
    let hint = near.map_or_else(|| format!("{} --help", words.command), str::to_owned);
    Error::usage(format!("{of} no {what} {argument}"), expected).hint(hint)
}

/// The error of a value that an argument cannot take: not of its kind, or not one of its names.
fn wrong_value(command: &str, argument: &str, value: &str, kind: Option<&Kind>, names: &[String]) -> Error {
    let option = argument.split(' ').next().unwrap_or_default();
    let meant = match kind {
        Some(kind) => kind.meant(option.trim_start_matches('-'), value),
        None => nearest(value, names.iter().map(String::as_str)).map(str::to_owned),
    };
    let hint = match meant {
        Some(meant) if option.starts_with('-') => format!("{option} {meant}"),
        Some(meant) => format!("{command} {meant}"),
        None => format!("{command} --help"),
    };
    let expected = kind.map_or_else(|| format!("one of {}", names.join(", ")), Kind::to_string);
    Error::usage(format!("{option} is {value}"), expected).hint(hint)
}

/// Prints an error as a JSON object, for programs.
fn object(error: &str, exit_code: u8) {
    // If standard output fails too, there is no way left to report it.
    let _ = stdout::object(json!({ "error": error, "exit_code": exit_code, "warnings": [] }));
}

/// Prints the findings that a person reads first, then one line with the number of the others and where all
/// findings are.
pub(crate) fn warn(findings: &[(Severity, String)], all_in: &str) {
    let (first, rest) = findings.split_at(foremost(findings));
    warn_all(first);
    if rest.is_empty() {
        return;
    }
    let of = |wanted: Severity| match rest.iter().filter(|(severity, _)| *severity == wanted).count() {
        0 => None,
        n => Some(counted(n, wanted.name())),
    };
    let more: Vec<String> = [Severity::Caution, Severity::Note].into_iter().filter_map(of).collect();
    line(&format!("and {} more; all findings: {all_in}", more.join(", ")));
}

/// Prints all findings. For output that has no other place for them.
pub(crate) fn warn_all(findings: &[(Severity, String)]) {
    for (severity, sentence) in findings {
        line(&format!("{}: {sentence}", severity.name()));
    }
}

/// Prints one line on standard error.
pub fn line(text: &str) {
    let _ = writeln!(std::io::stderr(), "{}", stdout::printable(text));
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::record::Place;
    use std::path::PathBuf;

    #[test]
    fn a_hint_names_the_file_that_the_error_is_about() {
        let folder = tempfile::tempdir().unwrap();
        let [first, second] = ["a.csv", "b.csv"].map(|name| folder.path().join(name));
        for file in [&first, &second] {
            std::fs::write(file, "1\n").unwrap();
        }
        let words = [&first, Path::new("--rate"), &second].map(|word| word.as_os_str().to_owned());
        let named = |error: &Error| file_of(error, words.clone().into_iter()).map(PathBuf::from);
        assert_eq!(named(&Error::input(Place::file(&second), "x", "")), Some(second.clone()));
        assert_eq!(named(&Error::refused("the record rings").of_record("b.csv")), Some(second));
        assert_eq!(named(&Error::refused("the record rings")), Some(first));
    }
}

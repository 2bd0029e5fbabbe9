//! Complaints go to standard error, in one form. A closed standard error is no reason to fail.

use crate::error::Error;
use crate::record::Severity;
use crate::report::words::Voice;
use clap::error::{ContextKind, ErrorKind};
use serde_json::json;
use std::io::Write;
use std::path::Path;

/// Prints an error, with `json` as an object on standard output as well, and gives its exit code.
pub fn error(error: &Error, voice: Voice, json: bool) -> u8 {
    let text = error.spoken(|key| voice.setting(key));
    line(&format!("vibro: {text}"));
    if json {
        object(&text, error.exit_code());
    }
    error.exit_code()
}

/// Prints what can be typed where no command was, with `json` as an object on standard output as well.
pub fn nothing(commands: &str, json: bool) -> u8 {
    line(commands.trim_end());
    if json {
        object("no command", 2);
    }
    2
}

/// Prints what clap has to say: help and version are no error, anything else is wrong usage, with `json` as an object on standard
/// output as well.
pub fn usage(error: &clap::Error, json: bool) -> u8 {
    if !error.use_stderr() {
        // A closed pipe behind --help is no reason to complain.
        let _ = error.print();
        return 0;
    }
    let text = NUMBERS.iter().fold(error.to_string(), |text, (of_std, ours)| text.replace(of_std, ours));
    line(text.trim_end());
    let tried = advice(error);
    if let Some(tried) = &tried {
        line(&format!("  try: {tried}"));
    }
    if json {
        let tried = tried.map_or_else(String::new, |t| format!("\n  try: {t}"));
        object(&format!("{}{tried}", text.trim().trim_start_matches("error: ")), 2);
    }
    2
}

/// What the standard library says of a value that is no number, and what a person needs to know.
const NUMBERS: [(&str, &str); 4] = [
    ("invalid float literal", "expected a number, such as 0.5 or 1e-3"),
    ("invalid digit found in string", "expected a whole number"),
    (" is not in 0..=4294967295", " is not a whole number from 0 to 4294967295"),
    ("cannot parse integer from empty string", "expected a whole number"),
];

/// What to type: a number with a decimal comma with a point, in place of an unknown word the first that is known.
fn advice(error: &clap::Error) -> Option<String> {
    let argument = |kind| error.get(kind).map(ToString::to_string);
    if error.kind() == ErrorKind::UnknownArgument
        && argument(ContextKind::InvalidArg).is_some_and(|word| Path::new(&word).exists())
    {
        return Some("one file at a time; for all of a folder: vibro run FOLDER".to_owned());
    }
    let value = error.get(ContextKind::InvalidValue)?.to_string();
    if error.to_string().contains("':'") {
        return Some(value.replacen([',', '-', ';'], ":", 1));
    }
    let point = value.replacen(',', ".", 1);
    if value != point && point.parse::<f64>().is_ok() {
        return Some(format!("a decimal point: {point}"));
    }
    let argument = error.get(ContextKind::InvalidArg)?.to_string();
    let option = argument.split(' ').next().filter(|o| o.starts_with("--"))?;
    let text = error.to_string();
    let word = text.split_once("expected one of `")?.1.split('`').next()?;
    Some(format!("{option} {word}"))
}

/// What a program reads in place of an answer.
fn object(error: &str, exit_code: u8) {
    // There is nobody left to tell of a failure to print a failure.
    let _ = super::print::object(json!({ "error": error, "exit_code": exit_code, "warnings": [] }));
}

/// Prints findings for a person; JSON carries them itself.
pub(crate) fn warn(findings: &[(Severity, String)]) {
    for (severity, sentence) in findings {
        line(&format!("{}: {sentence}", severity.name()));
    }
}

/// One line on standard error.
pub fn line(text: &str) {
    let _ = writeln!(std::io::stderr(), "{}", super::print::printable(text));
}

//! Complaints go to standard error, in one form. A closed standard error is no reason to fail.

use crate::error::Error;
use crate::record::Finding;
use crate::report::words::{Voice, sentences};
use clap::error::{ContextKind, ErrorKind};
use serde::Serialize;
use std::io::Write;

/// What a program reads in place of an answer.
#[derive(Serialize)]
struct Failure {
    error: String,
    exit_code: u8,
    warnings: [(); 0],
}

/// Prints an error, with `json` as an object on standard output as well, and gives its exit code.
pub fn error(error: &Error, voice: Voice, json: bool) -> u8 {
    let text = error.spoken(|key| voice.setting(key));
    line(&format!("vibro: {text}"));
    if json {
        object(text, error.exit_code());
    }
    error.exit_code()
}

/// Prints what clap has to say: help and version are no error, anything else is wrong usage, with `json` as an object on standard
/// output as well.
pub fn usage(error: &clap::Error, json: bool) -> u8 {
    // A closed pipe behind --help is no reason to complain.
    let _ = error.print();
    if !error.use_stderr() {
        return 0;
    }
    let tried = advice(error);
    if let Some(tried) = &tried {
        line(&format!("  try: {tried}"));
    }
    if json {
        let text = error.to_string();
        let tried = tried.map_or_else(String::new, |t| format!("\n  try: {t}"));
        object(format!("{}{tried}", text.trim().trim_start_matches("error: ")), 2);
    }
    2
}

/// The plain number in a value that has a unit behind it.
fn plain(value: &str) -> Option<String> {
    let digits = value.trim_end_matches(|c: char| !c.is_ascii_digit() && c != '.');
    let number: f64 = digits.trim().parse().ok()?;
    match value[digits.len()..].trim() {
        "" => None,
        "%" => Some(format!("a part of 1 without %: {}", number / 100.0)),
        unit => Some(format!("the number alone, {number}, in the unit that --help names, without {unit:?}")),
    }
}

/// Units by the names that values have in `--help`.
const UNITS: [(&str, &str); 8] = [
    ("<HZ>", " in Hz"),
    ("<N>", " in N"),
    ("<NS>", " in N s"),
    ("<S>", " in s"),
    ("<M>", " in m"),
    ("<KG>", " in kg"),
    ("<RAD>", " in rad"),
    ("<DB>", " in dB"),
];

/// That a number was expected, and in which unit.
fn number(error: &clap::Error) -> Option<String> {
    std::error::Error::source(error)?.downcast_ref::<std::num::ParseFloatError>()?;
    let option = error.get(ContextKind::InvalidArg)?.to_string();
    let unit = UNITS.iter().find(|u| option.ends_with(u.0)).map_or("", |u| u.1);
    Some(format!("a number{unit}, such as 0.5 or 2e-3"))
}

/// What may be tried where a number is not written as one is expected.
fn advice(error: &clap::Error) -> Option<String> {
    let said = |kind| error.get(kind).map(ToString::to_string);
    match error.kind() {
        ErrorKind::ValueValidation => {
            let value = said(ContextKind::InvalidValue)?;
            let point = value.replacen(',', ".", 1);
            if value != point && point.parse::<f64>().is_ok() {
                return Some(format!("a decimal point: {point}"));
            }
            plain(&value).or_else(|| number(error))
        }
        ErrorKind::UnknownArgument => {
            let number = said(ContextKind::InvalidArg)?;
            let is = number.strip_prefix('-')?.starts_with(|c: char| c.is_ascii_digit() || c == '.');
            is.then(|| format!("a number that is not negative: {number} stands where none can be"))
        }
        _ => None,
    }
}

fn object(error: String, exit_code: u8) {
    // There is nobody left to tell of a failure to print a failure.
    let _ = super::print::json(&Failure { error, exit_code, warnings: [] });
}

/// Prints a warning for a person; JSON carries warnings itself.
pub(crate) fn warn(sentences: &[String]) {
    for sentence in sentences {
        line(&format!("note: {sentence}"));
    }
}

/// Prints findings for a person, doubts first; JSON carries them itself.
pub fn found(findings: &[Finding]) {
    warn(&sentences(findings, Voice::Command));
}

/// One line on standard error.
pub fn line(text: &str) {
    let _ = writeln!(std::io::stderr(), "{}", super::print::printable(text));
}

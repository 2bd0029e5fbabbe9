//! Complaints go to standard error, in one form.

use crate::error::Error;

/// Prints an error and gives its exit code.
pub fn error(error: &Error) -> u8 {
    eprintln!("vibro: {error}");
    error.exit_code()
}

/// Prints what clap has to say: help and version are no error, anything else is wrong usage.
pub fn usage(error: &clap::Error) -> u8 {
    // A closed pipe behind --help is no reason to complain.
    let _ = error.print();
    u8::from(error.use_stderr()) * 2
}

/// Prints a warning for a person; JSON carries warnings itself.
pub fn warn(sentences: &[String]) {
    for sentence in sentences {
        eprintln!("note: {sentence}");
    }
}

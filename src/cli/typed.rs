//! The words that were typed, with the name of the program first.

use std::ffi::OsString;
use std::sync::{Mutex, PoisonError};

static WORDS: Mutex<Vec<OsString>> = Mutex::new(Vec::new());

/// States the words. A program that asks by [`super::answer`] has typed none.
pub fn state(words: impl IntoIterator<Item = OsString>) {
    *WORDS.lock().unwrap_or_else(PoisonError::into_inner) = words.into_iter().collect();
}

/// The words; none if nothing was typed.
pub fn words() -> impl Iterator<Item = OsString> {
    WORDS.lock().unwrap_or_else(PoisonError::into_inner).clone().into_iter()
}

//! The words that were typed, with the name of the program first.

use std::ffi::OsString;
use std::sync::OnceLock;

static WORDS: OnceLock<Vec<OsString>> = OnceLock::new();

/// States the words, once. A program that asks by [`super::answer`] has typed none.
pub fn state(words: impl IntoIterator<Item = OsString>) {
    WORDS.get_or_init(|| words.into_iter().collect());
}

/// The words; none if nothing was typed.
pub fn words() -> impl Iterator<Item = &'static OsString> {
    WORDS.get().into_iter().flatten()
}

//! Sentences of findings of reading and writing files, by code.

pub(super) const WORDS: &[(&str, &str)] = &[];

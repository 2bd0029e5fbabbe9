//! Sentences of findings of drill traces, by code.

pub(super) const WORDS: &[(&str, &str)] = &[];

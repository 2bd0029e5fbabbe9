//! Sentences of findings of modes, by code.

pub(super) const WORDS: &[(&str, &str)] = &[];

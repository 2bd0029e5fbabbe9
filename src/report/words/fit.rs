//! Sentences of findings of fits and comparisons, by code.

pub(super) const WORDS: &[(&str, &str)] = &[];

//! Sentences of findings of models and their ladder, by code.

pub(super) const WORDS: &[(&str, &str)] = &[];

//! Sentences of findings of drops and bounces, by code.

pub(super) const WORDS: &[(&str, &str)] = &[];

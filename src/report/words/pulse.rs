//! Sentences of findings of contact pulses, by code.

pub(super) const WORDS: &[(&str, &str)] = &[];

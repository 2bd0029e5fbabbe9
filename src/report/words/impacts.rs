//! Sentences of findings of impacts in traces, by code.

pub(super) const WORDS: &[(&str, &str)] = &[];

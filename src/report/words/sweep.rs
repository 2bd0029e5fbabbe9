//! Sentences of findings of sweeps, their response and resonances, by code.

pub(super) const WORDS: &[(&str, &str)] = &[];

//! Sentences of findings of spectra, filters and transfer functions, by code.

pub(super) const WORDS: &[(&str, &str)] = &[];

//! Sentences of findings of spectra, filters and transfer functions, by code.

pub(super) const WORDS: &[(&str, &str)] = &[
    (
        "lines-below-cutoff",
        "Lines below {fmin Hz} are left out, as noise divided by frequency. Set [fmin] to change that.",
    ),
    ("frf-lines-empty", "{n} of {lines} lines have no function: excitation or response is empty there."),
    (
        "frf-few-averages",
        "{averages} averages count as {independent} independent ones: the coherence is biased high. Take a longer record.",
    ),
    ("frf-low-coherence", "{n} of {lines} lines have a coherence below 0.5."),
    (
        "sine-noise-coloured",
        "The noise at {frequency.8 Hz} is {factor} times as strong as white noise; uncertainties are enlarged by that. Noise may pass for a sine there.",
    ),
    (
        "sine-line-beside",
        "Another line at {line.8 Hz}, {apart} lines from {frequency.8 Hz}, has {part %} of its amplitude; the uncertainty allows for it.",
    ),
    (
        "sine-not-alone",
        "Another line at {line.8 Hz} is {apart} lines from {frequency.8 Hz}, which has no uncertainty. Fit one more sine with [tones].",
    ),
    ("tones-only-rounding-left", "{known} of {count} tones found: nothing but rounding is left."),
    ("tones-none-above-noise", "{known} of {count} tones found: no other line stands out of the noise."),
    (
        "tones-not-parted",
        "{known} of {count} tones found: the line at {frequency.8 Hz} cannot be parted from the others, or is not steady.",
    ),
    (
        "tones-close",
        "Tones at {first.8 Hz} and {second.8 Hz} are {apart Hz} apart, below the resolution of {resolution Hz}: valid for two steady sines only.",
    ),
];

//! Sentences of findings of sweeps, their response and resonances, by code.

pub(super) const WORDS: &[(&str, &str)] = &[
    ("legacy-matrix", "This is the matrix of the script sinesw, mistakes included."),
    (
        "sweep-window-unlike",
        "The force lines differ from a {window} window by {off %}<; {better} fits to {left %}>. Amplitudes have no uncertainty. Set [window].",
    ),
    (
        "sweep-steps-repeated",
        "{n:step} {n?repeats/repeat} a file or the values of another, first steps {first} and {second}. Check the list for a repeated name.",
    ),
    (
        "sweep-below-noise",
        "{n:amplitude} {n?is/are} below 5× the noise and biased high; use the 95 % upper limits.",
    ),
    (
        "sweep-hidden-by-lines",
        "{n:response} mostly leakage, at {responses.6 Hz}, of larger lines at {lines.6 Hz}; use the upper limits.",
    ),
    (
        "sweep-below-cutoff",
        "{n:point} below the cut-off of {fmin Hz} {n?has/have} no amplitude. Lower [fmin].",
    ),
    (
        "sweep-too-few-points",
        "{n:point} in one direction {n?is/are} too few for resonances and jumps; three are needed.",
    ),
    (
        "sweep-out-of-order",
        "{n} of {steps} steps go against the direction of the sweep; jumps are judged in the order given.",
    ),
    (
        "sweep-direction-contradicted",
        "The sweep is stated to go {stated}, but its excitation frequencies go {found}.",
    ),
];

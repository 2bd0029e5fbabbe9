//! Sentences of findings of modes, by code.

pub(super) const WORDS: &[(&str, &str)] = &[
    (
        "modal-window-decay",
        "A decay of {decay 1/s} that an exponential window added is subtracted from each mode.",
    ),
    (
        "modal-unit-unknown",
        "The unit is no response over force: fitted as a receptance, with modal constants in that unit times (rad/s)².",
    ),
    (
        "modal-magnitudes-only",
        "Phases are unknown: modes are fitted to magnitudes, without uncertainty, and their modal constants have no sign.",
    ),
    ("frf-lines-missing", "{n:line} without a number left out, at {lines.6 Hz}."),
    (
        "frf-lines-impossible-coherence",
        "{n:line} with a coherence above 1 or below 0 left out, at {lines.6 Hz}.",
    ),
    ("frf-lines-low-coherence", "{n:line} with a coherence below {least} left out, at {lines.6 Hz}."),
    (
        "modal-peak-not-fitted",
        "The peak at {frequency.6 Hz} cannot be fitted. Try a band around it with [band].",
    ),
    (
        "modal-peak-unsupported",
        "The peak at {frequency.6 Hz} is not supported as a mode: ζ = {zeta} ± {std}, {unexplained %} of the peak left unexplained.",
    ),
    ("modal-peaks-of-noise", "{n:peak} of the magnitude explained by noise, at {lines.6 Hz}."),
    (
        "modal-phase-reversed",
        "Most phases rise through the peak: check the sign of the phase, and that response and force are not exchanged.",
    ),
    (
        "modal-residuals-coloured",
        "Residuals near {frequency.6 Hz} are not white (another mode, leakage, other damping). Uncertainties are enlarged by {factor}.",
    ),
    (
        "modal-leakage",
        "The mode at {frequency.6 Hz} is {bandwidth} lines wide: leakage of a Hann window biases ζ high by up to {part %}. Take longer segments.",
    ),
    (
        "modal-no-oscillation",
        "The peak at {frequency.6 Hz} is no mode: ζ = {zeta}, or it decays less than the stated exponential window.",
    ),
    (
        "modal-blow-cut-off",
        "{part %} of the response at {frequency.6 Hz} remain when a blow's record ends; the uncertainty allows for it. Set a longer [segment] or [left_at_end].",
    ),
    (
        "modal-constant-no-sign",
        "The modal constant at {frequency.6 Hz} has a phase of {phase}° and no sign. Check for a delayed response.",
    ),
    (
        "modal-two-modes",
        "Two modes explain the peak at {frequency.6 Hz} better than one (AICc lower by {ahead}); no uncertainty is given. Take finer lines.",
    ),
    (
        "modal-band-unexplained",
        "The modes found do not explain all lines from {low Hz} to {high Hz}; each is fitted around its peak. Choose narrower bands.",
    ),
    (
        "modal-band-not-fitted",
        "The modes from {low Hz} to {high Hz} could not be fitted together; each is fitted around its peak.",
    ),
    ("circle-few-lines", "{n:line} around the mode; a circle needs {needed}"),
    ("circle-not-round", "the lines lie on no circle"),
    ("half-power-few-lines", "bandwidth {bandwidth} lines: ζ biased high by up to tens of per cent"),
    ("peak-within-a-line", "within {half Hz} of a line"),
];

//! Sentences of findings of contact pulses, by code.

pub(super) const WORDS: &[(&str, &str)] = &[
    (
        "pulse-instrument-unknown",
        "The instrument's low-pass is unknown. It may move ξ by 0.1, so no uncertainty is given. Set [low_pass] and [order], or [low_pass] none.",
    ),
    (
        "pulse-corner-above-half-rate",
        "The low-pass at {corner Hz} is not below half the sampling rate of {rate Hz}: no uncertainty is given. Sample faster, or set [low_pass] none.",
    ),
    (
        "pulse-low-pass-missing",
        "The onset of the pulse does not fit a contact of spring and damper; its numbers are refused. Set the instrument's [low_pass] and [order].",
    ),
    (
        "pulse-onset-unlike",
        "The onset of the pulse does not fit a contact of spring and damper behind this low-pass; its numbers are refused. Check [low_pass] and [order].",
    ),
    (
        "pulse-near-corner",
        "The pulse lasts {duration s}, within twice the low-pass time at {corner Hz}: its shape is mostly the filter's. Check corner and order.",
    ),
    (
        "pulse-clipped",
        "{n:sample} at {level @unit} form a flat top: taken as clipped and left out of the fit.",
    ),
    ("pulse-samples-missing", "{n:sample} of the pulse {n?is/are} missing and left out of the fit."),
    (
        "pulse-baseline-short",
        "{lengths} pulse lengths are recorded before the pulse: its baseline is poorly known. Record a longer pre-trigger.",
    ),
    (
        "pulse-not-alone",
        "Another pulse of more than half the height is at {time.5 s}; the largest is analysed.",
    ),
    (
        "pulse-no-rest-after",
        "The record does not settle after the pulse (ringing or a second contact). Only samples up to the end of the pulse are fitted.",
    ),
    (
        "pulse-level-changes",
        "The level after the pulse differs from that before it: AC coupling or a second contact. The shape is distorted; no uncertainty is given.",
    ),
    ("pulse-velocity-needs-mass", "The record is a force: set [mass] for the velocity of approach."),
    (
        "pulse-no-acceleration",
        "The record is a {quantity}, not an acceleration or a force: no velocity of approach is given.",
    ),
    ("pulse-model-not-fitted", "The contact model {model} could not be fitted to the pulse."),
    (
        "pulse-gains-energy",
        "ξ = {xi} and restitution {restitution}: more energy leaves than arrives. Check for a clipped top or an uneven baseline.",
    ),
    (
        "pulse-no-inner-peak",
        "ξ = {xi} may be 1/2 or more: the force is then largest at the onset, and ξ depends on the shape of the onset.",
    ),
    ("pulse-no-damping", "ξ = {xi} is consistent with zero."),
    (
        "pulse-residuals-coloured",
        "The residuals are not white noise (model, low-pass or coloured noise). Uncertainties are enlarged by {factor}, which covers no wrong model.",
    ),
    (
        "pulse-other-model",
        "The record prefers the contact model {model} (AICc lower by {ahead}); ξ and frequency are those of spring and damper.",
    ),
    ("pulse-two-instants", "Two instants cannot test the contact model: fit the whole pulse."),
    (
        "pulse-ratio-near-zero",
        "ρ = {rho} ± {std} is consistent with 0: ξ lies between {xi} and 1, and no uncertainty is given. Fit the whole pulse.",
    ),
    ("pulse-ratio-near-half", "ρ = {rho} ± {std} is consistent with 1/2: ξ is consistent with zero."),
];

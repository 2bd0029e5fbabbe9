//! Sentences of findings of drops and bounces, by code.

pub(super) const WORDS: &[(&str, &str)] = &[
    // Drops.
    ("handling-ignored", "{n:burst} before the first large one {n?was/were} ignored as handling."),
    (
        "height-without-uncertainty",
        "R from the drop has no uncertainty without that of the height; timing alone gives {timing.2 1}. Set [height_std].",
    ),
    (
        "gravity-without-uncertainty",
        "The uncertainty of R leaves out that of the acceleration of free fall g.",
    ),
    (
        "interval-without-uncertainty",
        "One drop has no uncertainty without that of its interval. Set [interval_std], or add drops.",
    ),
    (
        "too-few-drops",
        "{n} drops are too few for an uncertainty from their scatter. Make four, or set [interval_std].",
    ),
    (
        "drops-scatter-too-much",
        "{n} drops scatter more than the stated {stated.2 s} explains, and are too few for an uncertainty. Make four.",
    ),
    (
        "struck-mass-at-rest",
        "The struck mass is assumed at rest; if it is free to move, R is too low by (m₁/m₂)(1 + R).",
    ),
    (
        "struck-mass-free",
        "R assumes the struck mass at rest. If it moves freely during the impact, R is {free.4 1}.",
    ),
    (
        "drop-biases",
        "Drag and friction bias R low; a tilt by α biases it high, by 1/√cos α with the height along the tube.",
    ),
    // Trains of bounces.
    (
        "flight-outlier",
        "Flight {flight} of train {train} takes {interval.4 s} where the others give {expected.4 s}: left out.",
    ),
    (
        "too-few-flights",
        "{n} flight times are too few for an uncertainty of R<; the stated onsets alone give {onsets.2 1}>. Record five or more.",
    ),
    (
        "trains-differ",
        "R differs between the trains, and {n} are too few for an uncertainty of its mean. Record {needed} trains.",
    ),
    (
        "flight-times-ignored",
        "The flight times after the drop are no train of bounces: ignored. Check their order.",
    ),
    (
        "flight-times-assume",
        "Flight times need neither height nor g; they assume short impacts and one R at every speed. Drag biases R low.",
    ),
    // Velocities.
    (
        "restitution-out-of-range",
        "R = {value.4} by the {method} is outside 0 to 1: left out. Check signs, masses and their order.",
    ),
    (
        "velocities-ignored",
        "The velocities give no R from 0 to 1: ignored. Check signs, masses and their order.",
    ),
    // All methods.
    ("method-not-compared", "A method without an uncertainty was not compared with the others."),
    (
        "methods-disagree",
        "Methods disagree by {ratio.2} standard uncertainties: {first} {first_value.4}, {second} {second_value.4}. None is preferred.",
    ),
];

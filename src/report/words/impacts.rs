//! Sentences of findings of impacts in traces, by code.

pub(super) const WORDS: &[(&str, &str)] = &[
    // The trace.
    ("drift-removed", "A linear drift of {slope @unit} per second was removed."),
    (
        "mains-hum-removed",
        "Mains hum of {frequency.4 Hz}, amplitude {amplitude @unit}, was removed with {harmonics:harmonic}.",
    ),
    (
        "hum-or-impacts",
        "The line at {frequency.4 Hz} is mains hum or the impacts, {impacts} a second: it was kept. A high-pass removes hum.",
    ),
    ("pulses-inverted", "The pulses point downwards: the trace was inverted."),
    ("pulses-clipped", "{n} of {of} pulses are clipped: their heights are too low."),
    (
        "sample-and-hold",
        "Each value repeats for {n:sample}: the trace was sampled at {rate.4 Hz} only. Record it at its full rate.",
    ),
    // Detection.
    (
        "low-bursts-ignored",
        "{n:burst} below {level @unit} {n?was/were} ignored; the noise is {noise @unit} rms. Lower [threshold] to count them.",
    ),
    ("pulses-cut", "{n:pulse} without a whole rising flank {n?is/are} not counted."),
    (
        "count-depends-on-ringing",
        "The count depends on the assumed decay of the ringing; it is stable over a factor of {factor.2} only. State [refractory].",
    ),
    (
        "impacts-near-noise",
        "Impacts reach {ratio.2} times the noise limit only: noise or ringing may hide some. Check the count, or state [refractory].",
    ),
    (
        "impacts-lost-in-noise",
        "Impacts exceed the noise limit by {sigmas.2} standard deviations only: some are lost, the interval has no uncertainty. Reduce the noise.",
    ),
    (
        "onset-within-sample",
        "Pulses rise within one sample: an onset has a standard uncertainty of {std.2 s}. Sample faster for a smaller one.",
    ),
    // Count and interval.
    (
        "missed-or-skipped",
        "All intervals are multiples of {interval.4 s}: {missed:impact} missed, or cycles skipped. The interval has no uncertainty; [none_missed] if none is missed.",
    ),
    (
        "count-within-scatter",
        "Intervals scatter too much to count missed impacts: their mean has no uncertainty. Set [none_missed] if none is missed.",
    ),
    (
        "intervals-drift",
        "Intervals change slowly along the record: the uncertainty of their mean may be too small. Measure longer.",
    ),
    (
        "interval-pattern",
        "Intervals repeat after {n:impact}: no impact of this pattern counts as missed or doubled.",
    ),
    ("one-interval", "Two impacts have one interval: whether it repeats is unknown."),
    (
        "impacts-missed",
        "{n:impact} {n?is/are} missing: longer intervals count as several. Set [none_missed] if none is missing.",
    ),
    ("impacts-doubled", "{n:impact} {n?follows/follow} another too soon: left out of the mean interval."),
    (
        "impacts-irregular",
        "Intervals spread by {spread.2 %} of their median: impacts are irregular, and their mean is no period.",
    ),
    // Excitation.
    (
        "reference-edges",
        "Edges of the reference channel: {missing} missing, {extra} too many. Cycles were counted as if it had all of them.",
    ),
    (
        "impacts-drift",
        "Impacts beat by {beat Hz} against {impacts}/{cycles} of the excitation ({excitation.6 Hz}): their phase drifts. Check the excitation frequency.",
    ),
    (
        "no-fraction-fits",
        "No fraction of up to 8 impacts in 8 excitation cycles fits: impacts are irregular.",
    ),
];

//! Sentences of findings of drill records and of hand-arm exposure, by code.

pub(super) const WORDS: &[(&str, &str)] = &[
    (
        "drill-velocity-scaled-twice",
        "The velocity channel is in m/s already; it is multiplied by the sensitivity {sensitivity} too. Check [sensitivity].",
    ),
    (
        "drill-edges-missing",
        "{n:reference edge} {n?is/are} missing; their turns are left out. Check the pick-up.",
    ),
    ("drill-edges-extra", "{n:false reference edge} ignored. Check the pick-up and [level]."),
    ("drill-reference-pauses", "{n:pause} of the reference without pulses; turns there are left out."),
    (
        "drill-turns-apart",
        "{n:turn} left out: a pause loses the first pulse of a turn. Only the longest stretch between pauses is used.",
    ),
    (
        "drill-edges-sharp",
        "Reference edges are known to {std s}: they rise within one sample. Sample faster for a better phase.",
    ),
    ("drill-reference-samples-missing", "{n:sample} of the reference {n?is/are} missing."),
    (
        "drill-first-pulse-unknown",
        "With {pulses} pulses a turn phase 0 is the first pulse of the record, an arbitrary one.",
    ),
    (
        "drill-faults-bridged",
        "{dropouts:drop-out} and {spikes:spike} of the velocity, {share %} of the samples; {bridged:sample} bridged by straight lines.",
    ),
    (
        "drill-samples-lost",
        "{n:sample} in drop-outs too long to bridge; {turns:turn} left out. A larger [longest_dropout] keeps them.",
    ),
    ("drill-turns-cut-off", "{n:turn} left out: cut off by an end of the record."),
    (
        "drill-over-range",
        "{n:sample} over-range, at {low m/s} or {high m/s}; speeds there are biased low. Choose a larger range.",
    ),
    ("drill-impacts-hidden", "{n:turn} without an impact, which a fault of the velocity hides."),
    (
        "drill-impacts-over-range",
        "<Group {group}: >{n} of {all:impact} over-range and left out of the means.",
    ),
    (
        "drill-impacts-over-range-biased",
        "<Group {group}: >{n} of {all:impact} over-range and left out; the means are biased low and have no uncertainty.",
    ),
    (
        "drill-all-impacts-over-range",
        "<Group {group}: >{n} of {all:impact} over-range; the means are biased low and have no uncertainty.",
    ),
    (
        "drill-drift",
        "The displacement drifts by {drift.2 m} a turn, the stroke is {stroke.2 m}; a straight line is removed. Check the velocity offset.",
    ),
    (
        "drill-no-impact",
        "No impact found: no velocity jump within {contact s} is clear. For a longer contact increase [contact].",
    ),
    ("drill-few-values", "A mean over {n} values has no uncertainty; it needs four turns and impacts."),
    (
        "drill-groups",
        "{n:group} of impacts, at phases {phases}; the means are of the strongest, at {phase}. Look at `groups`.",
    ),
    (
        "drill-not-striking",
        "<Group {group}: >No restitution: approach speed {speed.2 m/s}, scatter {scatter.2 m/s}, is consistent with zero. This mass is struck.",
    ),
    (
        "drill-approach-unclear",
        "<Group {group}: >No restitution: mean approach speed {speed.2 m/s} ± {std.2 m/s} is consistent with zero. Measure more impacts.",
    ),
    (
        "drill-restitution-impossible",
        "<Group {group}: >No restitution: {value} ± {std} lies outside 0 to 1. Check masses, direction of the beam and velocity channel.",
    ),
    (
        "drill-approach-loose",
        "<Group {group}: >The restitution has no uncertainty: the approach speed is not known within 10 %. Measure more impacts.",
    ),
    (
        "drill-phase-undirected",
        "<Group {group}: >Impacts come at all phases, or are too few to prefer one; the mean phase has no uncertainty.",
    ),
    (
        "drill-lack-of-fit",
        "<Group {group}: >Velocity {side} the impacts is no parabola, RMS residual {residual.2 m/s}: no uncertainty. Check [contact] and [fit].",
    ),
    (
        "drill-struck-mass-unknown",
        "The restitution assumes that the struck mass does not move. Set [struck_mass].",
    ),
    (
        "drill-beam-angle",
        "{share %} change of every velocity for 1° of error in [beam_angle]; no uncertainty contains it.",
    ),
    (
        "drill-sampling-limited",
        "f2 = {f2 Hz} is near the limit of the sampling, not of the motion. Sample faster.",
    ),
    ("drill-instrument-limited", "f2 = {f2 Hz} is beyond the {limit Hz} of the instrument."),
    ("drill-exponential-delay", "Exponential smoothing delays average and displacement by up to {time s}."),
    (
        "drill-smoothed",
        "Average and displacement are smoothed with a corner of {corner Hz}; impacts and bandwidth are not.",
    ),
    ("drill-below-noise-floor", "In no band is the motion {margin} dB above the noise floor."),
    ("drill-noise-floor-short", "No spectra: motion or noise is shorter than 8192 samples. Record longer."),
    (
        "drill-slow-changes",
        "Slow changes along the record ({quantities}): the uncertainties of these means may be too small. Measure longer.",
    ),
    (
        "exposure-understates-shocks",
        "W_h understates the shocks of percussive tools; crest factor and unweighted peak stand beside a_hv.",
    ),
    (
        "exposure-axes-missing",
        "{axes} of 3 axes measured: a_hv is too small, by up to 1.7 times with one axis. Measure all three.",
    ),
    (
        "exposure-slow-changes",
        "The vibration of the handle changes slowly: the uncertainty of a_hv may be too small. Measure longer.",
    ),
    (
        "exposure-record-short",
        "{duration.2 s} of the handle count for a_hv; ISO 5349-2 asks for 8 s a record and 60 s in all.",
    ),
    (
        "exposure-samples-missing",
        "{n:acceleration} of the handle missing; {counted %} of the record counts for a_hv.",
    ),
];

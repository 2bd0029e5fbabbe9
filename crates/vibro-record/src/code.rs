//! Codes of findings that one part of the program adds and another part searches for.

/// Doubts of the readers, about the times, the unit or single values of a record.
pub const READER_DOUBTS: [&str; 18] = [
    "last-number-cut-off",
    "no-closing-line",
    "decibels-overruled",
    "step-changed",
    AXIS_ROUNDED_OR_LOST,
    "axis-clock-minutes",
    "rate-decimated",
    "rates-differ",
    "head-step-assumed",
    "digits-may-be-grouped",
    "unit-head-differs",
    "unit-row-differs",
    "quantity-name-differs",
    "quantity-row-differs",
    "axis-row-differs",
    "sheet-in-percent",
    "missing-marked",
    "filled-with-zeros",
];

/// Those of the readers' doubts that are about the unit of values alone: which factor takes them to SI.
pub const UNIT_DOUBTS: [&str; 3] = ["unit-head-differs", "unit-row-differs", "sheet-in-percent"];

/// Samples are missing in a record.
pub const SAMPLES_LOST: &str = "samples-lost";
/// Times fit an even step, but also a shorter step with lost samples.
pub const AXIS_ROUNDED_OR_LOST: &str = "axis-rounded-or-lost";
/// Times or frequencies fall.
pub const AXIS_BACKWARDS: &str = "axis-backwards";
/// The unit of an axis is not stated.
pub const AXIS_UNIT_ASSUMED: &str = "axis-unit-assumed";
/// The sampling rate is taken from the head of the file.
pub const RATE_FROM_HEAD: &str = "rate-from-head";
/// The scaling of a spectrum is not stated.
pub const SCALING_UNSAID: &str = "scaling-unsaid";
/// The unit of a record is not stated.
pub const UNIT_UNSAID: &str = "unit-unsaid";
/// Full scale is taken from a comment in the file.
pub const FULL_SCALE_BY_COMMENT: &str = "full-scale-by-comment";
/// The axis of a record is not stated.
pub const ABSCISSA_UNSAID: &str = "abscissa-unsaid";
/// The head states a scale that is not applied; the finding is removed if the user states a calibration.
pub const SCALE_IN_HEAD: &str = "scale-in-head";
/// Values are levels in decibels.
pub const LEVELS_IN_DECIBELS: &str = "levels-in-decibels";
/// The response to a blow has not decayed where its record ends.
pub const RESPONSE_CUT_OFF: &str = "response-cut-off";
/// Modes were fitted to a response that has not decayed where its record ends.
pub const MODAL_BLOW_CUT_OFF: &str = "modal-blow-cut-off";
/// Pulses of a drill scatter by less than its samples resolve.
pub const DRILL_EDGES_SHARP: &str = "drill-edges-sharp";
/// The mean velocity of a turn is not 0.
pub const DRILL_MEAN_VELOCITY: &str = "drill-mean-velocity";
/// A record holds more than one pulse.
pub const PULSE_NOT_ALONE: &str = "pulse-not-alone";
/// The modes that were found do not explain a decay.
pub const DECAY_UNEXPLAINED: &str = "decay-unexplained";
/// Another event follows a decay.
pub const DECAY_CUT: &str = "decay-cut";
/// The damping of a decay changes with its amplitude.
pub const DECAY_CHANGES: &str = "decay-changes";

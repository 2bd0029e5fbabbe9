//! Sentences of findings of reading and writing files, by code.
//!
//! What holds for one record of several begins with its name.

pub(super) const WORDS: &[(&str, &str)] = &[
    // Units and scaling
    ("unit-unknown", "<{subject}: >Unit \"{unit}\" is not known: values are kept as they are. State [unit]."),
    ("unit-unsaid", "<{subject}: >The file says no unit: values are kept as they are. State [unit]."),
    ("unit-overrides-file", "<{subject}: >The file says the unit \"{file}\"; {used} was stated and is used."),
    ("unit-mended", "<{subject}: >Unit \"{unit}\" is read as \"{taken}\": a wrong code page mangled it."),
    (
        "unit-by-exponents",
        "<{subject}: >The file gives exponents of length and force only: values are SI, but the unit is not known.",
    ),
    (
        "unit-of-signal",
        "<{subject}: >Unit {unit} is that of a signal, but a {function} is squared: values are kept as they are.",
    ),
    (
        "unit-unsaid-squared",
        "<{subject}: >The file names no unit for its {function}: values are kept as they are. State [unit].",
    ),
    (
        "unit-by-data-type",
        "<{subject}: >The file names no unit and no unit system (data set 164): SI units of {type} are assumed.",
    ),
    (
        "unit-against-system",
        "<{subject}: >Unit {unit} is used; by the unit system of data set 164 values would be {ratio} times as large.",
    ),
    (
        "unit-against-type",
        "<{subject}: >The data type is {type}, but unit {unit} is that of {quantity}: the unit is used.",
    ),
    (
        "unit-against-label",
        "<{subject}: >The label is \"{label}\", but unit {unit} is that of {quantity}: the unit is used.",
    ),
    ("no-unit-factors", "Data set 164 holds no unit factors: SI units are assumed."),
    (
        "format-without-units",
        "A MAT-file holds no units: s and Hz are assumed, values are kept as they are. State [unit].",
    ),
    (
        "scaling-unsaid",
        "<{subject}: >The file does not say whether amplitudes are peak or RMS: peak is assumed where it matters.",
    ),
    (
        "scaling-unsaid-squared",
        "<{subject}: >The file does not say whether its {function} is squared RMS or squared peak.",
    ),
    (
        "function-as-spectrum",
        "<{subject}: >Function type {function} is read as a spectrum of unknown scaling.",
    ),
    (
        "function-real-only",
        "<{subject}: >The {function} is real: magnitude or one of two parts is not said. It is read as a spectrum.",
    ),
    (
        "function-over-time",
        "<{subject}: >The function type is {function}, but the abscissa is time: read as a time trace.",
    ),
    ("function-as-trace", "<{subject}: >Function type {function} is read as a trace over its abscissa."),
    (
        "spectrum-taken-for-frf",
        "<{subject}: >The file does not say that this complex spectrum is a frequency response function: it is used as one.",
    ),
    // Calibration
    (
        "uncalibrated",
        "<{subject}: >No calibration is known: values are fractions of full scale. State [unit] and [calibration].",
    ),
    (
        "beyond-full-scale",
        "<{subject}: >Values reach {max}, beyond full scale: they may be in a physical unit already.",
    ),
    ("full-scale-stated", "<{subject}: >Full scale is 1 {unit}, as stated."),
    (
        "full-scale-by-comment",
        "<{subject}: >Full scale is {factor} {unit} by a comment in the file: wrong if a program changed the level since.",
    ),
    (
        "bits-left-justified",
        "Samples of {bits:bit} stand in {bytes:byte}: they are read as left-justified, the format's rule.",
    ),
    // Abscissa
    (
        "abscissa-unsaid",
        "<{subject}: >The file does not state its abscissa: values are numbered. State [rate] or [base_band].",
    ),
    (
        "axis-kind-unsaid",
        "<{subject}: >The {column} is the abscissa, but whether time or frequency is not said. State [rate] or [base_band].",
    ),
    ("axis-unit-assumed", "The {column} has no unit: {unit} is assumed."),
    ("axis-unit-unknown", "<{subject}: >The {column} has the unknown unit \"{said}\": {unit} is assumed."),
    ("axis-angular", "<{subject}: >The {column} is an angular frequency: divided by 2π to give Hz."),
    (
        "axis-rounded",
        "The {column} has too few digits (steps {smallest @unit} to {largest @unit}): the mean step {step.6 @unit} is used.",
    ),
    (
        "axis-uneven",
        "The {column} is uneven: steps from {smallest @unit} to {largest @unit}, {long} of {n} near the largest.",
    ),
    ("axis-backwards", "The {column} does not always rise: steps from {smallest @unit} to {largest @unit}."),
    ("abscissa-filled", "{n:row} without a first value continue{n?s/} its even steps."),
    ("rows-left-out", "{n:row} without a first value {n?is/are} left out."),
    (
        "abscissa-type-against-unit",
        "<{subject}: >The abscissa's data type is {type}, but its unit {unit} is one of {quantity}: the unit is used.",
    ),
    (
        "abscissa-by-function",
        "<{subject}: >The file does not name its abscissa: {quantity} is assumed for a {function}.",
    ),
    ("abscissa-double", "<{subject}: >The abscissa has double precision, where the standard has single."),
    (
        "abscissa-of-other-length",
        "\"{variable}\" has the length of no other variable: it is read as values, not as an abscissa.",
    ),
    ("abscissa-not-rising", "\"{variable}\" does not always rise: it is read as values, not as an abscissa."),
    (
        "instants-uneven",
        "<{subject}: >The instants are uneven: there is no sampling rate. State [rate] if they should be even.",
    ),
    (
        "instants-coarse",
        "<{subject}: >The instants have too few digits to show a missing sample: the mean step {step.6 s} is used.",
    ),
    (
        "increment-impossible",
        "<{subject}: >The file says an abscissa step of {step}: values are numbered. State [rate].",
    ),
    ("time-or-frequency", "\"{variable}\" has as many values as time and as frequency: time is used."),
    // Statements against the file
    (
        "statement-overrides-file",
        "<{subject}: >The file says a {what} of {file.6} Hz; {used.6} Hz was stated and is used.",
    ),
    (
        "spectrum-read-as-trace",
        "The file states a spectrum of {band.6} Hz; a rate of {rate.6} Hz was stated: values are read as a time trace.",
    ),
    (
        "trace-read-as-spectrum",
        "The file states a sampling rate of {rate.6} Hz; a base band of {band.6} Hz was stated: values are read as a spectrum.",
    ),
    ("rate-and-band-stated", "A rate and a base band were stated: the rate is used."),
    (
        "rate-and-spectrum-in-header",
        "The file states a sampling rate of {rate.6} Hz and a spectrum: values are read as a time trace. State [base_band] for a spectrum.",
    ),
    ("header-step-differs", "The header states a step of {header}; the {column} has {step} and is used."),
    (
        "header-line-impossible",
        "<{subject}: >Header line \"{line}\" states no possible value and is ignored.",
    ),
    ("column-no-axis", "The {column} is no axis for what was stated and is ignored."),
    ("column-uneven", "The {column} is uneven; the stated step of {step} is used."),
    (
        "column-refines",
        "The {column} holds a {what} of {holds.7} Hz; {stated.7} Hz was stated: the column is used.",
    ),
    ("column-counts", "The {column} counts the values; the stated step of {step} is used."),
    ("band-unused", "<{subject}: >The stated base band is not used: the file has its own frequencies."),
    (
        "rate-overrides-step",
        "<{subject}: >The file has a step of {step.6} s; a rate of {rate.6} Hz was stated and is used.",
    ),
    (
        "rate-overrides-instants",
        "<{subject}: >The file has its own instants; a rate of {rate.6} Hz was stated and is used.",
    ),
    (
        "vector-against-rate",
        "Vector \"{variable}\" contradicts the sampling rate of {rate.6} Hz: the {used} is used.",
    ),
    // Completeness
    ("fewer-values", "<{subject}: >The header declares {declared} values; the file holds {n}."),
    (
        "fewer-lines",
        "<{subject}: >The header declares {declared} values (lines and 0 Hz); the file holds {n}.",
    ),
    (
        "lines-uncounted",
        "Are {n} values all lines? Words behind them may stand for values, and then all frequencies are wrong. State `lines: {n}` above them.",
    ),
    ("no-values-declared", "<{subject}: >The header declares no values."),
    ("missing-kept", "<{subject}: >{n:value} {n?is/are} missing and kept as missing."),
    (
        "last-number-cut-off",
        "The last number, {found}, is shorter than those above, without a line end: it may be cut off.",
    ),
    ("words-behind-values", "{n:line} behind the values {n?is/are} ignored: {lines}."),
    ("remarks-dropped", "Of {n} remarks the first {kept} are kept."),
    (
        "two-channels",
        "<{subject}: >Two columns are read as two channels. Real and imaginary part? State [complex].",
    ),
    (
        "decimal-comma-assumed",
        "There is one column: the comma is read as decimal mark. State [decimal] if it separates.",
    ),
    (
        "length-open",
        "The header leaves the length open, as a recorder does that was not stopped: all {frames} frames are read.",
    ),
    ("part-of-frame", "{bytes:byte} behind the last whole frame {bytes?is/are} ignored."),
    (
        "variable-cut-off",
        "The file is cut off in its last variable at byte {byte}<, which declares {declared} bytes>: {there} are there, and it is ignored.",
    ),
    ("variable-passed-over", "<\"{variable}\" is a >{class}: not read."),
    ("variable-empty", "\"{variable}\" is empty and is ignored."),
    ("variable-many-dimensions", "\"{variable}\" has {dimensions} dimensions and is ignored."),
    ("integers-rounded", "\"{variable}\" holds integers beyond 2^53, which are rounded."),
    // Universal files
    ("sets-passed-over", "Data sets not read: {sets}."),
    ("lines-outside", "{n:line} outside any data set {n?is/are} ignored, the first at {place}."),
    ("no-function", "The file holds no data set 58, so no record."),
    ("header-cut-short", "A data set 58 ends after {lines} of its {of} header lines and is ignored."),
    (
        "more-lines",
        "<{subject}: >Behind the {declared} declared values stand {lines} more lines before the closing -1: not read.",
    ),
    (
        "set-not-closed",
        "<{subject}: >The file ends without the closing -1 of the data set< that begins at line {line}>.",
    ),
    (
        "other-size",
        "<{subject}: >Record 7 declares {n} values ({declared} bytes); {bytes} bytes stand before the closing -1.",
    ),
    (
        "no-closing-line",
        "<{subject}: >No closing -1 stands behind the {bytes} bytes that record 7 declares: values may be wrong. Export as ASCII.",
    ),
    // Sweeps
    (
        "analyser-integration-assumed",
        "The files do not say how displacement was measured: one integration of velocity in the analyser is assumed.",
    ),
    ("peak-assumed", "The files do not name their scaling: peak amplitudes are assumed. State [scaling]."),
    ("hann-assumed", "The files do not name their window: Hann is assumed. State [window]."),
    (
        "sweep-unit-overrides-files",
        "One stored unit of the files is {factor} {file}; {used} was stated and is used.",
    ),
    ("response-unit-assumed", "No unit of the responses is known: {unit} is assumed. State [unit]."),
    (
        "decibels-overruled",
        "The file says that its values are decibels ({words}); {unit} was stated and is used.",
    ),
    ("decibels-mentioned", "The files mention decibels ({words}): values are read as linear amplitudes."),
];

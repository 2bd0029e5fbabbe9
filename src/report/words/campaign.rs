//! Sentences about a campaign as a whole, its records and its files.

pub const WORDS: &[(&str, &str)] = &[
    ("said", "{text}"),
    ("left-out", "Left out: {why}.< Try: {hint}>"),
    ("campaign-without-record", "The campaign names no file: nothing was computed."),
    ("no-record-answers", "No file allows an answer: nothing was computed."),
    ("no-modes", "No modes: {why}."),
    ("rig-left-out", "{table} does not give {keys}: the values of the thesis' rig are used."),
    ("no-mass-named", "No sweep names its mass, so nothing is overlaid on the model."),
    (
        "force-level-unknown",
        "No measured force: of several levels it is taken to belong to that of the first sweep.",
    ),
    (
        "swept-twice",
        "Same mass, direction and force as {first}: resonances and crossings are named by {first}.",
    ),
    ("uff-not-written", "{file}.uff is not written: {why}. All lines are in {file}.csv."),
    (
        "files-left-over",
        "Files in the folder of the results that this run did not write, perhaps of an earlier one: {names}< and {more} more>.",
    ),
];

//! The numbers of an answer that each doubt is about.

use serde_json::Value;

/// Where the numbers of a doubt stand in its answer.
pub enum Concern {
    /// Everywhere.
    Whole,
    /// Everywhere but at this key.
    WholeBut(&'static str),
    /// At these paths; `*` is every item of a list.
    At(&'static [&'static str]),
    /// In one item of a list, whose number at a path is the frequency of the finding, at these paths.
    Item(&'static str, &'static str, &'static [&'static str]),
    /// In the group of impacts that the finding names, or the only one, at these paths. The numbers of the
    /// first group stand beside the groups, too.
    Group(&'static [&'static str]),
    /// Nowhere, for this reason.
    Nothing(#[allow(dead_code, reason = "it is read in the table")] &'static str),
}
use Concern::{At, Group, Item, Nothing, Whole, WholeBut};

const MODEL: &str = "of a model: what it computes has no uncertainty";
const FIT: Concern = At(&["fit/parameters/*/estimate", "fit/parameters/*/interval", "fit/profile/interval"]);
const PARAMETER: Concern = Item("fit/parameters", "parameter", &["estimate", "interval"]);
const INTERVAL: Concern = At(&["interval", "frequency", "beat"]);
const MODE: Concern = Item("modes", "frequency/value", &[""]);
// Force and frequency of a step are those of its excitation.
const STEP: Concern =
    Item("points", "excitation", &["amplitude", "phase", "receptance", "harmonics", "subharmonics"]);
const VELOCITIES: Concern =
    Group(&["first_contact", "before", "after", "energy", "energy_given", "restitution"]);
// The sum of the samples of a pulse rests on no model.
const SAMPLES: Concern = WholeBut("impulse_read");
// What grows with the values of the record.
const SCALED: Concern = At(&[
    "modes/*/amplitude",
    "modes/*/modal_constant",
    "modes/*/by/*/modal_constant",
    "levels/*/amplitude",
    "tones/*/amplitude",
    "value_std",
    "initial_velocity",
    "peak",
    "peak_read",
    "impulse",
    "impulse_read",
    "fits/*/parameters/initial_velocity",
    "fits/*/parameters/peak",
    "fits/*/parameters/impulse",
    "points/*/force_std",
    "points/*/amplitude",
    "points/*/receptance",
    "points/*/harmonics",
    "points/*/subharmonics",
    "resonances/*/amplitude_std",
    "jumps/*/amplitude_before_std",
    "jumps/*/amplitude_after_std",
    "impacts/*/before_std",
    "impacts/*/after_std",
    "before",
    "after",
    "energy",
    "displacement",
    "exposure",
]);

/// Every code of a doubt.
pub const CONCERNS: [(&str, Concern); 82] = [
    ("rig-left-out", Nothing(MODEL)),
    // What most drawn records lack.
    ("plan-unanswered", At(&["decays/*/answers", "drops/*/answers"])),
    ("drill-left-out", At(&["fit/keys/*/estimate"])),
    ("decay-unexplained", MODE),
    ("decay-changes", MODE),
    (
        "drill-velocity-scaled-twice",
        At(&["impacts", "groups", "before", "after", "energy", "energy_given", "displacement"]),
    ),
    ("drill-fit-lack", At(&["fit/keys/*/estimate", "pulse_angle"])),
    ("drill-key-in-combination", Item("fit/keys", "key", &["estimate"])),
    ("drill-key-open", Item("fit/keys", "key", &["estimate"])),
    ("drill-over-range", At(&["displacement"])),
    ("drill-impacts-over-range", VELOCITIES),
    ("drill-mean-velocity", VELOCITIES),
    ("drill-restitution-impossible", Group(&["restitution"])),
    ("drill-phase-undirected", Group(&["phase"])),
    // The uncertainty of the velocity includes the bias.
    ("drill-lack-of-fit", Group(&["phase"])),
    ("drill-velocity-impossible", Group(&[""])),
    ("drill-ringing", Group(&[""])),
    ("drill-instrument-limited", Nothing("a bandwidth has no uncertainty")),
    ("last-number-cut-off", Whole),
    ("no-closing-line", Whole),
    ("decibels-overruled", Whole),
    ("axis-rounded-or-lost", Whole),
    ("axis-clock-minutes", Whole),
    ("rate-decimated", Whole),
    ("rates-differ", Whole),
    ("head-step-assumed", Whole),
    ("digits-may-be-grouped", Whole),
    ("unit-head-differs", SCALED),
    ("unit-row-differs", SCALED),
    ("quantity-row-differs", Whole),
    ("quantity-name-differs", Whole),
    ("axis-row-differs", Whole),
    ("sheet-in-percent", SCALED),
    ("missing-marked", Whole),
    ("filled-with-zeros", Whole),
    ("step-changed", Whole),
    ("prior-contradicted", FIT),
    ("bound-contradicted", FIT),
    ("least-squares-elsewhere", FIT),
    ("contact-too-long", FIT),
    ("many-outliers", FIT),
    ("lack-of-fit", FIT),
    ("too-few-residuals", FIT),
    ("motions-not-settled", FIT),
    ("least-squares-not-reached", FIT),
    ("parameter-needs-impacts", PARAMETER),
    ("parameter-at-limit", PARAMETER),
    ("parameter-in-combination", PARAMETER),
    ("parameter-too-uncertain", PARAMETER),
    ("impacts-or-echoes", INTERVAL),
    ("impacts-bounce", INTERVAL),
    // Also of a drop, whose numbers are all of its impacts.
    ("impacts-lost-in-noise", Whole),
    ("impacts-mostly-missed", INTERVAL),
    ("modal-magnitudes-only", Whole),
    ("modal-more-modes", MODE),
    ("modal-two-modes", MODE),
    ("several-motions", Nothing(MODEL)),
    ("stiffness-needed", Nothing(MODEL)),
    ("no-rung", Nothing(MODEL)),
    ("law-matters", Nothing(MODEL)),
    ("spring-beyond-force", Nothing(MODEL)),
    ("spring-curvature-matters", Nothing(MODEL)),
    ("springs-together-matter", Nothing(MODEL)),
    ("pulse-instrument-unknown", SAMPLES),
    ("pulse-corner-above-half-rate", SAMPLES),
    ("pulse-low-pass-missing", SAMPLES),
    ("pulse-onset-unlike", SAMPLES),
    ("pulse-level-changes", Whole),
    ("pulse-gains-energy", SAMPLES),
    ("pulse-unexplained", SAMPLES),
    // The other numbers are those of the model that fits better.
    ("pulse-low-pass-alone", Whole),
    ("pulse-ratio-near-zero", Whole),
    ("drop-flights-grow", Whole),
    ("methods-far-apart", Whole),
    ("methods-disagree", Whole),
    ("first-impact-unheard", Whole),
    ("spectrum-clipped", Whole),
    ("sine-unsteady", Item("tones", "frequency/value", &[""])),
    ("sine-not-alone", Item("tones", "frequency/value", &[""])),
    // Phase and receptance are ratios of two lines of one window; a jump lies between two steps.
    (
        "sweep-window-unlike",
        At(&[
            "points/*/excitation_std",
            "points/*/force_std",
            "points/*/frequency_std",
            "points/*/amplitude",
            "points/*/harmonics",
            "points/*/subharmonics",
            "resonances",
            "jumps/*/amplitude_before_std",
            "jumps/*/amplitude_after_std",
        ]),
    ),
    ("step-not-settled", STEP),
    ("step-clipped", STEP),
];

impl Concern {
    /// The numbers of a finding in its answer, with their paths.
    pub fn numbers<'a>(&self, answer: &'a Value, found: &Value) -> Vec<(String, &'a Value)> {
        let below = |path: &str, of: &'a Value, paths: &[&str]| {
            let inside = paths.iter().flat_map(|inner| select(of, inner));
            inside.map(|(inner, value)| (format!("{path}/{inner}"), value)).collect::<Vec<_>>()
        };
        match self {
            Whole => vec![(String::new(), answer)],
            WholeBut(but) => {
                let all = answer.as_object().into_iter().flatten().filter(|(key, _)| key != but);
                all.map(|(key, value)| (format!("/{key}"), value)).collect()
            }
            Nothing(_) => Vec::new(),
            At(paths) => below("", answer, paths),
            Item(list, key, paths) => {
                let (of, item) = item(answer, list, key, found);
                let mut all = below(&of, item, paths);
                all.extend(of_strongest(answer, item, found));
                all
            }
            Group(paths) => {
                let group = found["numbers"]["group"].as_f64().map_or(0, |group| group as usize);
                let mut all = below(&format!("groups/{group}"), &answer["groups"][group], paths);
                // An answer has some numbers of a group alone.
                let beside =
                    if paths == &[""] { &["phase", "before", "after", "restitution"] } else { *paths };
                all.extend(if group == 0 { below("", answer, beside) } else { Vec::new() });
                all.extend(of_impacts(answer, group, found));
                all
            }
        }
    }
}

/// The single impacts of a group whose numbers a doubt about the group is about.
fn of_impacts<'a>(answer: &'a Value, group: usize, found: &Value) -> Vec<(String, &'a Value)> {
    let velocities: &[&str] = &["first_contact_std", "before_std", "after_std"];
    let (paths, clipped): (&[&str], bool) = match found["code"].as_str() {
        Some("drill-impacts-over-range") => (velocities, true),
        Some("drill-mean-velocity") => (velocities, false),
        Some("drill-lack-of-fit") => (&["time_std", "phase_std"], false),
        Some("drill-velocity-impossible" | "drill-ringing") => (&[""], false),
        // Of means alone.
        _ => (&[], false),
    };
    let impacts = answer["impacts"].as_array().into_iter().flatten().enumerate();
    let own = impacts.filter(|(_, impact)| {
        impact["group"] == group && (!clipped || impact["clipped"] == Value::Bool(true))
    });
    let below = |(i, impact): (usize, &'a Value)| {
        let inside = paths.iter().flat_map(move |path| select(impact, path));
        inside.map(move |(at, value)| (format!("impacts/{i}/{at}"), value)).collect::<Vec<_>>()
    };
    own.flat_map(below).collect()
}

/// Levels and decrement of a decay, where the mode of the finding is the strongest. Levels of a mode that
/// changes are what it changes by.
fn of_strongest<'a>(answer: &'a Value, mode: &Value, found: &Value) -> Vec<(String, &'a Value)> {
    let size = |mode: &Value| mode["amplitude"]["value"].as_f64().unwrap_or(f64::NAN);
    let modes = answer["modes"].as_array().map_or(&[][..], Vec::as_slice);
    if answer["levels"].is_null() || modes.iter().any(|other| size(other) > size(mode)) {
        return Vec::new();
    }
    let paths: &[&str] =
        if found["code"] == "decay-changes" { &["decrement"] } else { &["decrement", "levels"] };
    paths.iter().flat_map(|path| select(answer, path)).collect()
}

/// The item of a list whose number is nearest to the frequency of a finding, or whose name is its subject.
fn item<'a>(answer: &'a Value, list: &str, key: &str, found: &Value) -> (String, &'a Value) {
    let (_, all) = select(answer, list).pop().expect(list);
    let of = |item: &'a Value| select(item, key).pop().map_or(&Value::Null, |(_, value)| value);
    let all = all.as_array().expect(list).iter().enumerate();
    let frequency = found["numbers"]["frequency"].as_f64();
    let chosen = match frequency {
        Some(frequency) => {
            let away = |item: &'a Value| (of(item).as_f64().unwrap_or(f64::INFINITY) - frequency).abs();
            all.min_by(|a, b| away(a.1).total_cmp(&away(b.1)))
        }
        None => all.into_iter().find(|(_, item)| *of(item) == found["subject"]),
    };
    let (i, item) = chosen.unwrap_or_else(|| panic!("no item of {list} for {found}"));
    (format!("{list}/{i}"), item)
}

/// The values at a path, with their own paths; none where a key is missing.
fn select<'a>(value: &'a Value, path: &str) -> Vec<(String, &'a Value)> {
    let mut all = vec![(String::new(), value)];
    for key in path.split('/').filter(|key| !key.is_empty()) {
        let inner = |(at, value): (String, &'a Value)| -> Vec<(String, &'a Value)> {
            match value {
                Value::Array(items) if key == "*" => {
                    items.iter().enumerate().map(|(i, item)| (format!("{at}/{i}"), item)).collect()
                }
                Value::Array(items) => {
                    let item = key.parse().ok().and_then(|i: usize| items.get(i));
                    item.map(|item| (format!("{at}/{key}"), item)).into_iter().collect()
                }
                _ => value.get(key).map(|value| (format!("{at}/{key}"), value)).into_iter().collect(),
            }
        };
        all = all.into_iter().flat_map(inner).collect();
    }
    all
}

/// Paths of the standard uncertainties below a value: numbers of `std` and of keys that end in `_std`. A
/// number, or a list of numbers, is one itself.
pub fn uncertainties(value: &Value) -> Vec<String> {
    let mut found = Vec::new();
    stated(value, "", true, &mut found);
    found
}

/// Uncertainties of other numbers than the doubts are about: the time of one impact by the noise of its
/// trace.
const OTHERS: [&str; 1] = ["onset_std"];

fn stated(value: &Value, path: &str, is_std: bool, found: &mut Vec<String>) {
    match value {
        Value::Number(_) if is_std => found.push(path.to_owned()),
        Value::Array(items) => {
            for (i, item) in items.iter().enumerate() {
                stated(item, &format!("{path}/{i}"), is_std, found);
            }
        }
        Value::Object(keys) => {
            // The facts of findings are no numbers of the answer.
            for (key, inner) in keys.iter().filter(|(key, _)| *key != "findings") {
                let is_std = (key == "std" || key.ends_with("_std")) && !OTHERS.contains(&key.as_str());
                stated(inner, &format!("{path}/{key}"), is_std, found);
            }
        }
        _ => {}
    }
}

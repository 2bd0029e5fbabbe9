//! Meta data of a record: what is known beside its values.

use crate::code;
use crate::units::{Quantity, Unit};
use crate::{Finding, Trace, Window};

/// One step that made a record: its name, its arguments, the version of this crate.
#[derive(Debug, Clone, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub struct Step {
    /// Name of the step, e.g. `read`, `to_si`, `integrate`.
    pub name: String,
    /// Arguments in order, as text.
    pub arguments: Vec<(String, String)>,
    /// Version of this crate.
    pub version: String,
}

impl Step {
    /// A step of this version of the crate.
    pub fn new(name: &str, arguments: &[(&str, &dyn std::fmt::Display)]) -> Step {
        Step {
            name: name.to_owned(),
            arguments: arguments.iter().map(|(k, v)| ((*k).to_owned(), v.to_string())).collect(),
            version: env!("CARGO_PKG_VERSION").to_owned(),
        }
    }

    /// The text of an argument.
    pub fn argument(&self, key: &str) -> Option<&str> {
        self.arguments.iter().find(|(name, _)| name == key).map(|(_, text)| text.as_str())
    }
}

/// Begins the identification line of UFF-58 that states the decay in 1/s of an exponential window.
pub const ADDED_DECAY: &str = "exponential window; decay in 1/s ";

/// Identification line of UFF-58, and key of a remark in CSV, for a function averaged over hammer blows.
pub const FROM_BLOWS: &str = "averaged over hammer blows";

/// Begins the identification line of UFF-58 that states the window of the segments over which a function was
/// averaged.
pub const AVERAGED_WITH: &str = "averaged over segments; window ";

/// Channel, quantity, unit, history and findings.
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Meta {
    /// Channel or record name; may be empty.
    pub name: String,
    /// Quantity that the values measure.
    pub quantity: Quantity,
    /// SI unit of the values, or an opaque unit as the file had it.
    pub unit: Unit,
    /// Number of values that the file declares, if it does.
    pub declared_n: Option<usize>,
    /// Header lines that are kept but not interpreted, as key and value (the key may be empty).
    pub notes: Vec<(String, String)>,
    /// Relative standard uncertainty of the sampling rate if instants were printed or jitter; else 0.
    pub clock: f64,
    /// Typical interval in s of the samples between which values were interpolated by cubics; 0 if none were.
    pub interpolated: f64,
    /// Half a unit in the last digit with which instants were printed, in s; 0 where they were not printed.
    pub resolution: f64,
    /// Instant 0 of the record in s since 1970, where the file counts from there; else 0.
    pub origin: f64,
    /// Findings about the values.
    pub findings: Vec<Finding>,
    /// Every step that made the record, oldest first.
    pub history: Vec<Step>,
}

impl Meta {
    /// Largest fraction of its amplitude that a sine of `frequency` in Hz loses by interpolation with
    /// cubics. The loss is largest half way between samples, where a cubic weights the two nearest samples
    /// by 9/16 and the next two by −1/16.
    pub fn lost(&self, frequency: f64) -> f64 {
        let half = std::f64::consts::PI * (frequency * self.interpolated).min(0.5);
        1.0 - (9.0 * half.cos() - (3.0 * half).cos()) / 8.0
    }

    /// Meta data of a record in `unit`, which is taken to be SI already (see [`Unit::si`]).
    pub fn new(name: impl Into<String>, unit: Unit) -> Meta {
        let (name, quantity) = (name.into(), unit.quantity());
        let (notes, findings, history) = Default::default();
        Meta {
            name,
            quantity,
            unit,
            declared_n: None,
            notes,
            clock: 0.0,
            interpolated: 0.0,
            resolution: 0.0,
            origin: 0.0,
            findings,
            history,
        }
    }

    /// Name and quantity, by which a channel is searched.
    pub fn called(&self) -> (&str, &str) {
        (&self.name, self.quantity.name())
    }

    /// Adds a finding unless it is there already.
    pub fn found(&mut self, finding: Finding) {
        if !self.findings.contains(&finding) {
            self.findings.push(finding);
        }
    }

    /// Whether there is a finding with this code.
    pub fn has(&self, code: &str) -> bool {
        self.findings.iter().any(|f| f.code == code)
    }

    /// Adds a step to the history.
    pub fn step(&mut self, name: &str, arguments: &[(&str, &dyn std::fmt::Display)]) {
        self.history.push(Step::new(name, arguments));
    }

    /// Decay in 1/s that an exponential window added to the response: from the history, or as the writers of
    /// this crate state it.
    pub fn added_decay(&self) -> Option<f64> {
        let made = self.history.iter().rev().find(|step| step.name == "exponential_window");
        let made = made.and_then(|step| step.argument("decay"));
        let line = self.notes.iter().find(|(key, _)| key == "id line 5").map(|(_, line)| line.as_str());
        let line = line.and_then(|line| line.strip_prefix(ADDED_DECAY));
        let own = format!(" of {}", self.name);
        let mut remark = self.notes.iter().filter(|(key, _)| key == "added decay");
        let remark = remark.find_map(|(_, text)| text.strip_suffix(own.as_str()));
        let text = made.or(line).or(remark)?;
        text.trim().parse().ok().filter(|decay: &f64| decay.is_finite() && *decay > 0.0)
    }

    /// Window of the segments over which a frequency response function was averaged: from the history, or as
    /// the writers of this crate state it. `None` for one that was averaged over blows.
    pub fn averaged_with(&self) -> Option<Window> {
        let made = self.history.iter().rev().find(|step| step.name == "segments");
        let made = made.and_then(|step| step.argument("window"));
        let line = self.notes.iter().find(|(key, _)| key == "id line 4").map(|(_, line)| line.as_str());
        let line = line.and_then(|line| line.strip_prefix(AVERAGED_WITH));
        let own = format!(" of {}", self.name);
        let mut remark = self.notes.iter().filter(|(key, _)| key == "averaged with");
        let remark = remark.find_map(|(_, text)| text.strip_suffix(own.as_str()));
        let name = made.or(line).or(remark)?;
        Window::from_name(name).filter(|_| !self.from_blows())
    }

    /// Whether a frequency response function was averaged over the blows of a hammer: from the history, or as
    /// the writers of this crate state it.
    pub fn from_blows(&self) -> bool {
        let said = |(key, text): &(String, String)| match key.as_str() {
            "id line 4" => text == FROM_BLOWS,
            FROM_BLOWS => text.strip_suffix(self.name.as_str()).is_some_and(|t| t.ends_with(" of ")),
            _ => false,
        };
        self.history.iter().any(|step| step.name == "blows") || self.notes.iter().any(said)
    }

    /// A number of the records of blows over which it was averaged, from the history.
    pub fn of_blows(&self, key: &str) -> Option<f64> {
        self.history.iter().rev().find(|step| step.name == "blows")?.argument(key)?.parse().ok()
    }

    /// Takes over the unit that an instrument wrote: stores its SI unit and quantity, notes the conversion in
    /// the history, and returns the factor by which the values must be multiplied. An unknown unit is kept,
    /// with a finding and factor 1.
    pub fn adopt_unit(&mut self, text: &str) -> f64 {
        let unit = Unit::parse_or_opaque(text);
        if !unit.is_known() {
            let code = if unit.is_level() { code::LEVELS_IN_DECIBELS } else { "unit-unknown" };
            self.found(Finding::caution(code).name("unit", text.trim()));
        }
        self.unit = unit.si();
        self.quantity = self.unit.quantity();
        if unit.factor() != 1.0 {
            self.step("to_si", &[("from", &unit.symbol()), ("factor", &unit.factor())]);
        }
        unit.factor()
    }

    /// Factor from stored numbers to the present values, from the history.
    pub fn factor_to_si(&self) -> f64 {
        let number = |step: &Step, key| step.argument(key).and_then(|text| text.parse::<f64>().ok());
        let to_si = |step: &Step| match step.name.as_str() {
            "to_si" => number(step, "factor"),
            "calibrate" => {
                let unit = step.argument("unit").map_or(1.0, |unit| Unit::parse_or_opaque(unit).factor());
                number(step, "factor").map(|factor| factor * unit)
            }
            _ => None,
        };
        self.history.iter().filter_map(to_si).product()
    }

    /// Replaces the unit of the stored numbers by one that is stated for this channel, and drops findings on
    /// the former unit with its steps in the history. A unit `of_file` that differs is named in a caution.
    /// Returns the factor by which the present values must be multiplied.
    pub fn restate_unit(&mut self, unit: &Unit, of_file: bool) -> f64 {
        let former = self.factor_to_si();
        let text =
            self.history.iter().find(|step| step.name == "to_si").and_then(|step| step.argument("from"));
        let file = text.unwrap_or(self.unit.symbol()).to_owned();
        let differs = Finding::caution("unit-overrides-file").name("file", file);
        let differs = differs.name("used", unit.symbol());
        let of_full_scale = self.has(Trace::UNCALIBRATED) || self.has(code::FULL_SCALE_BY_COMMENT);
        let said = of_file && self.unit.is_known() && (former != unit.factor() || self.unit != unit.si());
        self.findings.retain(|found| {
            let on_unit = [code::LEVELS_IN_DECIBELS, Trace::UNCALIBRATED, code::FULL_SCALE_BY_COMMENT];
            !found.code.starts_with("unit-") && !on_unit.contains(&&*found.code)
        });
        self.history.retain(|step| !["to_si", "calibrate"].contains(&step.name.as_str()));
        if of_full_scale {
            self.found(Finding::note("full-scale-stated").name("unit", unit.symbol()));
        } else if said {
            self.found(differs);
        }
        self.adopt_unit(unit.symbol()) / former
    }
}

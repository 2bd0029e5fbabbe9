//! What an analysis, a model or a reader reports, as data: numbers with their uncertainty, and findings about
//! them.

use crate::Doubt;
use crate::units::notation::estimate;
use serde::de::{MapAccess, Visitor};
use serde::ser::SerializeMap;
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use std::borrow::Cow;
use std::fmt::{Display, Formatter};

/// Severity of a finding.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Severity {
    /// States what was done or assumed; nothing is wrong.
    Note,
    /// A number is less certain than it looks, or was corrected; its uncertainty allows for it.
    Caution,
    /// A number may be wrong by more than any uncertainty would say: it has none.
    Doubt,
}

impl Severity {
    /// Its name, as in JSON.
    pub fn name(self) -> &'static str {
        ["note", "caution", "doubt"][self as usize]
    }
}

/// A fact of a finding: a number in SI units, several, or a name.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum Fact {
    /// A number in SI units, or a count.
    Number(f64),
    /// Several numbers in SI units.
    Numbers(Vec<f64>),
    /// A name: of a method, a unit, a channel; never a sentence.
    Name(String),
}

/// A finding as data: a code with numbers and names, without a sentence. Programs, tests and estimators read
/// the code; the report has a sentence for each code.
///
/// ```
/// use vibro_record::{Finding, Severity};
/// let hum = Finding::note("mains-hum-removed").number("frequency", 50.0).number("amplitude", 0.3);
/// let hum = hum.name("unit", "V");
/// assert_eq!((&*hum.code, hum.severity()), ("mains-hum-removed", Severity::Note));
/// assert_eq!(hum.get("frequency"), Some(50.0));
/// ```
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Finding {
    /// Stable code in kebab-case, listed in the documentation.
    pub code: Cow<'static, str>,
    /// Private, since a doubt is made with its numbers alone.
    severity: Severity,
    /// Its subject: a channel, a file, a sweep; `None` for the whole answer.
    pub subject: Option<String>,
    /// Numbers in SI units and names, in the order in which they were added.
    #[serde(rename = "numbers", serialize_with = "as_map", deserialize_with = "of_map")]
    pub facts: Vec<(Cow<'static, str>, Fact)>,
}

fn as_map<S: Serializer>(facts: &[(Cow<'static, str>, Fact)], serializer: S) -> Result<S::Ok, S::Error> {
    let mut map = serializer.serialize_map(Some(facts.len()))?;
    for (name, fact) in facts {
        map.serialize_entry(name, fact)?;
    }
    map.end()
}

fn of_map<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Vec<(Cow<'static, str>, Fact)>, D::Error> {
    struct Facts;
    impl<'de> Visitor<'de> for Facts {
        type Value = Vec<(Cow<'static, str>, Fact)>;

        fn expecting(&self, f: &mut Formatter<'_>) -> std::fmt::Result {
            f.write_str("facts by their names")
        }

        fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Self::Value, A::Error> {
            let mut facts = Vec::new();
            while let Some(fact) = map.next_entry()? {
                facts.push(fact);
            }
            Ok(facts)
        }
    }
    deserializer.deserialize_map(Facts)
}

impl Finding {
    fn new(code: &'static str, severity: Severity) -> Finding {
        Finding { code: code.into(), severity, subject: None, facts: Vec::new() }
    }

    /// A finding of what was done or assumed.
    pub fn note(code: &'static str) -> Finding {
        Finding::new(code, Severity::Note)
    }

    /// A finding that a number is less certain than it looks.
    pub fn caution(code: &'static str) -> Finding {
        Finding::new(code, Severity::Caution)
    }

    /// A doubt that a number may be wrong: a finding once it names the number, which then loses its
    /// uncertainty.
    pub fn doubt(code: &'static str) -> Doubt {
        Doubt(Finding::new(code, Severity::Doubt))
    }

    /// Severity.
    pub fn severity(&self) -> Severity {
        self.severity
    }

    /// Whether a number that it is about may be wrong by more than any uncertainty would say.
    pub fn is_doubt(&self) -> bool {
        self.severity == Severity::Doubt
    }

    /// Adds a number in SI units, or a count.
    pub fn number(mut self, name: &'static str, value: f64) -> Finding {
        self.facts.push((name.into(), Fact::Number(value)));
        self
    }

    /// Adds a count.
    pub fn count(self, name: &'static str, n: usize) -> Finding {
        self.number(name, n as f64)
    }

    /// Adds several numbers in SI units.
    pub fn numbers(mut self, name: &'static str, values: impl Into<Vec<f64>>) -> Finding {
        self.facts.push((name.into(), Fact::Numbers(values.into())));
        self
    }

    /// Adds a name.
    pub fn name(mut self, name: &'static str, text: impl Into<String>) -> Finding {
        self.facts.push((name.into(), Fact::Name(text.into())));
        self
    }

    /// Sets the subject.
    pub fn about(mut self, subject: impl Into<String>) -> Finding {
        self.subject = Some(subject.into());
        self
    }

    /// A fact by its name.
    pub fn fact(&self, name: &str) -> Option<&Fact> {
        self.facts.iter().find(|(known, _)| *known == name).map(|(_, fact)| fact)
    }

    /// A number by its name.
    pub fn get(&self, name: &str) -> Option<f64> {
        if let Fact::Number(value) = self.fact(name)? { Some(*value) } else { None }
    }

    /// Collects the findings of records, given as name and findings: a finding that all records share appears
    /// once, any other with its record as subject.
    pub fn gathered(records: &[(&str, &[Finding])]) -> Vec<Finding> {
        let everywhere = |found: &&Finding| records.iter().all(|(_, findings)| findings.contains(found));
        let first = records.first().map_or(&[][..], |(_, findings)| findings);
        let shared: Vec<&Finding> = first.iter().filter(everywhere).collect();
        let mut all: Vec<Finding> = Vec::new();
        for (i, (name, findings)) in records.iter().enumerate() {
            for finding in *findings {
                let alone = !shared.contains(&finding);
                let mut finding = finding.clone();
                if alone && !name.is_empty() {
                    finding.subject = Some((*name).to_owned());
                }
                if alone || i == 0 && !all.contains(&finding) {
                    all.push(finding);
                }
            }
        }
        all
    }
}

/// Value, standard uncertainty, unit, method, and number of samples used.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Estimate {
    /// Best value, in `unit`; NaN (null in JSON) where there is none.
    pub value: f64,
    /// Standard uncertainty, in `unit`; `None` where it is not known.
    pub std: Option<f64>,
    /// SI unit.
    pub unit: &'static str,
    /// Number of samples, spectral lines or points used.
    pub n: usize,
    /// Method of estimation.
    pub method: String,
}

impl Estimate {
    /// A value with its standard uncertainty. An uncertainty that is not finite counts as unknown.
    pub fn new(
        value: f64,
        std: Option<f64>,
        unit: &'static str,
        n: usize,
        method: impl Into<String>,
    ) -> Estimate {
        Estimate { value, std: std.filter(|s| s.is_finite()), unit, n, method: method.into() }
    }

    /// The same with a further relative standard uncertainty: that of the sampling rate, to which the value
    /// or its inverse is proportional, or the loss by interpolation.
    pub fn with_relative(mut self, relative: f64) -> Estimate {
        self.std = self.std.map(|std| std.hypot(relative * self.value));
        self
    }
}

impl Display for Estimate {
    /// The value with two digits of its uncertainty, and the unit: `5.51446 ± 0.00045 Hz`.
    fn fmt(&self, f: &mut Formatter<'_>) -> std::fmt::Result {
        f.write_str(&estimate(self.value, self.std))?;
        if matches!(self.unit, "" | "1") { Ok(()) } else { write!(f, " {}", self.unit) }
    }
}

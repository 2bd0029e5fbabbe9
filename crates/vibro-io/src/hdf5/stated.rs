//! What attributes and scalars state of the values beside them: unit, scale, rate or step, start.

use super::file::{self, Data};
use crate::assemble::Abscissa;
use crate::text;
use hdf5_reader::Attribute;
use vibro_record::{AxisKind, Values};

/// Names, in lower case and without separators: of the unit of values; of that of their abscissa, its rate, its step and its start; of a factor
/// and an offset that make values of stored integers.
const UNIT: &[&str] = &["unit", "units", "yunit", "yunits", "unitstring", "unity"];
const X_UNIT: &[&str] = &["xunit", "xunits", "unitx"];
const RATE: &[&str] =
    &["fs", "sr", "rate", "samplerate", "samplingrate", "samplefrequency", "samplingfrequency"];
const STEP: &[&str] = &[
    "dt",
    "dx",
    "deltat",
    "deltax",
    "sampletime",
    "sampleinterval",
    "samplinginterval",
    "xspacing",
    "xinc",
    "xincrement",
    "wfincrement",
];
const START: &[&str] = &["x0", "t0", "xorg", "xorigin", "xstart", "xoffset", "wfstartoffset"];
const FACTOR: &[&str] = &["scalefactor", "yinc", "yincrement"];
const OFFSET: &[&str] = &["addoffset", "yorg", "yorigin"];
/// Notes that a record takes at most: many scalars beside many datasets would fill the memory.
const MOST_NOTES: usize = 200;
/// What programs write for themselves.
const INTERNAL: &[&str] = &["class", "name", "dimensionlist", "dimensionlabels", "referencelist"];

/// Statements of a dataset, of its group and of the groups above.
#[derive(Debug, Clone, Default)]
pub struct Stated {
    pub unit: Option<String>,
    x_unit: Option<String>,
    step: Option<f64>,
    start: Option<f64>,
    factor: Option<f64>,
    offset: Option<f64>,
    pub notes: Vec<(String, String)>,
}

impl Stated {
    /// These and those of `attributes`, which are nearer.
    pub fn and(&self, attributes: &[Attribute]) -> Stated {
        let mut all = self.clone();
        for attribute in attributes {
            match file::attribute(attribute) {
                Some(Data::Texts(texts)) => all.text(&attribute.name, &texts.join(", ")),
                Some(Data::Numbers(Values::Real(values))) if values.len() == 1 => {
                    all.number(&attribute.name, values[0]);
                }
                _ => {}
            }
        }
        all
    }

    pub fn text(&mut self, name: &str, text: &str) {
        let key = key(name);
        let said = Some(text.trim().to_owned()).filter(|text| !text.is_empty());
        if UNIT.contains(&key.as_str()) {
            self.unit = said;
        } else if X_UNIT.contains(&key.as_str()) {
            self.x_unit = said;
        }
        self.note(name, &key, text.to_owned());
    }

    pub fn number(&mut self, name: &str, value: f64) {
        let (key, mut rate) = (key(name), None);
        let known = [
            (RATE, &mut rate),
            (STEP, &mut self.step),
            (START, &mut self.start),
            (FACTOR, &mut self.factor),
            (OFFSET, &mut self.offset),
        ];
        for (_, place) in known.into_iter().filter(|(names, _)| names.contains(&key.as_str())) {
            *place = Some(value);
        }
        self.step = rate.map(|rate| 1.0 / rate).or(self.step);
        self.note(name, &key, value.to_string());
    }

    fn note(&mut self, name: &str, key: &str, value: String) {
        if !INTERNAL.contains(&key) && !name.starts_with('_') {
            self.notes.retain(|(other, _)| other != name);
            self.notes.truncate(MOST_NOTES - 1);
            self.notes.push((name.to_owned(), value));
        }
    }

    /// Takes stored integers through their scale.
    pub fn scale(&self, values: &mut Values) {
        if let (Values::Real(values), true) = (values, self.factor.or(self.offset).is_some()) {
            let (factor, offset) = (self.factor.unwrap_or(1.0), self.offset.unwrap_or(0.0));
            for value in values {
                *value = *value * factor + offset;
            }
        }
    }

    /// Where the values stand, as far as that is stated; a unit that is neither of time nor of frequency states nothing.
    pub fn abscissa(&self, complex: bool) -> Abscissa {
        let kind = match &self.x_unit {
            None => Some((AxisKind::Time, 1.0)),
            unit => ["time", "frequency"].iter().find_map(|name| text::abscissa(name, unit.as_deref())),
        };
        let (kind, factor) = kind.filter(|(kind, _)| !complex || *kind != AxisKind::Time).unzip();
        let step = self.step.zip(factor);
        let even = step.map(|(step, factor)| (self.start.unwrap_or(0.0) * factor, step * factor));
        Abscissa::even(kind.unwrap_or(AxisKind::Time), even)
    }
}

fn key(name: &str) -> String {
    name.chars().filter(|c| c.is_alphanumeric()).collect::<String>().to_lowercase()
}

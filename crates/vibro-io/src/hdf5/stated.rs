//! What attributes and scalars state of the values beside them: unit, scale, rate or step, start.

use super::file::{self, Data};
use crate::assemble::Abscissa;
use crate::text;
use hdf5_reader::Attribute;
use vibro_record::{AxisKind, Values};

/// Names, in lower case and without separators: of the unit of values; of that of their abscissa, its rate, its step and its start; of a factor
/// and an offset that make values of what is stored, and of those that do so of integers alone.
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
const FACTOR: &[&str] = &["scalefactor"];
const OFFSET: &[&str] = &["addoffset"];
const FACTOR_OF_INTEGERS: &[&str] = &["yinc", "yincrement"];
const OFFSET_OF_INTEGERS: &[&str] = &["yorg", "yorigin"];
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
    scale: [Option<f64>; 2],
    scale_of_integers: [Option<f64>; 2],
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
        let ([factor, offset], [of_integers, offset_of_integers]) =
            (&mut self.scale, &mut self.scale_of_integers);
        let known = [
            (RATE, &mut rate),
            (STEP, &mut self.step),
            (START, &mut self.start),
            (FACTOR, factor),
            (OFFSET, offset),
            (FACTOR_OF_INTEGERS, of_integers),
            (OFFSET_OF_INTEGERS, offset_of_integers),
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

    /// Takes stored values through their scale.
    pub fn scale(&self, values: &mut Values, integers: bool) {
        let [factor, offset] =
            if integers && self.scale_of_integers[0].is_some() { self.scale_of_integers } else { self.scale };
        if let (Values::Real(values), true) = (values, factor.or(offset).is_some()) {
            let (factor, offset) = (factor.unwrap_or(1.0), offset.unwrap_or(0.0));
            for value in values {
                *value = *value * factor + offset;
            }
        }
    }

    /// Where the values stand, as far as that is stated; a unit that is neither of time nor of frequency states nothing.
    pub fn abscissa(&self) -> Abscissa {
        let of = |name: &str| text::abscissa(name, self.x_unit.as_deref());
        let kind = of("time").or_else(|| of("frequency")).filter(|_| self.x_unit.is_some());
        match (kind, &self.x_unit) {
            (None, Some(_)) => Abscissa::even(AxisKind::Time, None),
            (kind, _) => {
                let (kind, factor) = kind.unwrap_or((AxisKind::Time, 1.0));
                let even = self.step.map(|step| (self.start.unwrap_or(0.0) * factor, step * factor));
                Abscissa::even(kind, even)
            }
        }
    }
}

fn key(name: &str) -> String {
    name.chars().filter(|c| c.is_alphanumeric()).collect::<String>().to_lowercase()
}

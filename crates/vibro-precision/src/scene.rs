//! Scenes with a known truth, and what methods make of them.

use serde::{Deserialize, Serialize};

/// Which kind of method a scene asks.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Family {
    /// Models: a motion from a rig and its excitation.
    Models,
    /// Estimators: a quantity from samples.
    Estimators,
}

impl Family {
    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            Family::Models => "models",
            Family::Estimators => "estimators",
        }
    }
}

/// One method with one setting on one scene, measured.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Measured {
    /// Name of the method.
    pub method: String,
    /// A model's setting: step, tolerance, …; empty where it has none. Of an estimator the record it was given.
    pub setting: String,
    /// Whether it is one of this library's.
    pub ours: bool,
    /// Error, relative or in the unit that the scene names: the median of a model's, the root mean square of an estimator's over all
    /// records; none where it gave no answer.
    pub error: Option<f64>,
    /// Quartiles of the error.
    pub error_spread: Option<[f64; 2]>,
    /// Median time of one answer in ns.
    pub time_ns: f64,
    /// Quartiles of the time in ns; none where it was run once.
    pub time_spread: Option<[f64; 2]>,
    /// It gave no answer, or one that is not an answer to the scene.
    pub failed: bool,
    /// Why it failed, in a sentence.
    pub why: Option<String>,
    /// No other is both faster and more accurate, of estimators none with the same record.
    pub front: bool,
}

/// A scene with a known truth and what each method made of it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Scene {
    /// Name, short enough for a file.
    pub name: String,
    /// Which kind of method it asks.
    pub family: Family,
    /// What it is, in one sentence.
    pub says: String,
    /// What the error is, with its unit.
    pub error_of: String,
    /// Where the truth comes from.
    pub truth: String,
    /// Cramér–Rao bound of the standard deviation, in the unit of the error.
    pub bound: Option<f64>,
    /// The methods, those of one name one after another.
    pub methods: Vec<Measured>,
}

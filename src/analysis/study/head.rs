//! The head of a part: which study it belongs to, and which cells it has.

use super::Shard;
use crate::error::Result;
use crate::read::hexadecimal;
use serde::{Deserialize, Serialize};
use serde_json::Value;
use sha2::{Digest as _, Sha256};

/// What a part states of itself in its first line, as JSON.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct PartHead {
    /// Version of vibro that computes its cells.
    pub vibro: String,
    /// Digits of a SHA-256 of what exponentials, sines and the like are here: libraries of mathematics differ
    /// in the last digit, also between processors, and the motion of an impacting rig may follow.
    pub arithmetic: String,
    /// Which part of how many.
    pub shard: Shard,
    /// Number of cells of the whole study.
    pub all: u64,
    /// SHA-256 of version, arithmetic and study: equal in all parts of one study.
    pub fingerprint: String,
    /// All that determines the cells; under [`PLACE`] also where files lie, which changes nothing.
    pub study: Value,
}

/// Key of what does not belong to the identity of a study.
pub const PLACE: &str = "place";

impl PartHead {
    /// Ending of the names of parts.
    pub const ENDING: &str = ".cells";

    /// The head of a part of a study, which `study` describes and which has `all` cells.
    ///
    /// # Errors
    /// If it cannot be written as JSON.
    pub fn of(study: Value, all: u64, shard: Shard) -> Result<PartHead> {
        let (vibro, arithmetic) = (env!("CARGO_PKG_VERSION").to_owned(), arithmetic());
        let digest = Sha256::digest(format!("{vibro}\n{arithmetic}\n{}", identity(&study)));
        let fingerprint = hexadecimal(&digest.into());
        Ok(PartHead { vibro, arithmetic, shard, all, fingerprint, study })
    }

    /// Number of cells of the part.
    pub fn cells(&self) -> u64 {
        self.shard.count(self.all)
    }

    /// Name of its file. Names of one study sort by the number of the part.
    pub fn file(&self) -> String {
        let Shard { number, of } = self.shard;
        let digits = of.to_string().len();
        format!("part_{number:0digits$}_of_{of}{}", PartHead::ENDING)
    }

    /// What differs from the head of another part, with both values: `plan.cycles is 200 and not 100`. `None`
    /// if both are one part of one study, of one version and one arithmetic.
    pub fn difference(&self, other: &PartHead) -> Option<String> {
        let differs =
            |key: &str, one: &str, two: &str| (one != two).then(|| format!("{key} is {one} and not {two}"));
        let of_study = || difference("", &identity(&self.study), &identity(&other.study));
        differs("vibro", &self.vibro, &other.vibro)
            .or_else(|| {
                let found = differs("arithmetic", &self.arithmetic, &other.arithmetic);
                found.map(|found| found + ": another library of mathematics, or another processor")
            })
            .or_else(of_study)
            .or_else(|| differs("the number of cells", &self.all.to_string(), &other.all.to_string()))
            .or_else(|| differs("the part", &self.shard.to_string(), &other.shard.to_string()))
            .or_else(|| differs("the fingerprint", &self.fingerprint, &other.fingerprint))
    }
}

/// A study without its [`PLACE`].
fn identity(study: &Value) -> Value {
    let mut study = study.clone();
    if let Value::Object(keys) = &mut study {
        keys.shift_remove(PLACE);
    }
    study
}

/// The first eight digits of a SHA-256 of values of the functions that models and estimators use.
fn arithmetic() -> String {
    let functions: [fn(f64) -> f64; 12] = [
        f64::exp,
        f64::exp_m1,
        f64::ln,
        f64::ln_1p,
        f64::sin,
        f64::cos,
        f64::tan,
        f64::atan,
        f64::sinh,
        f64::atanh,
        |x| x.hypot(1.25),
        |x| x.powf(1.5),
    ];
    let mut hash = Sha256::new();
    for i in 1..500 {
        let x = f64::from(i) / 501.0;
        for function in functions {
            hash.update(function(x).to_le_bytes());
        }
        for function in &functions[..6] {
            hash.update(function(37.0 * x).to_le_bytes());
        }
    }
    hexadecimal(&hash.finalize().into())[..8].to_owned()
}

/// Longest value in a message, in characters.
const SHOWN: usize = 60;

/// The first key with two values in two descriptions.
fn difference(key: &str, one: &Value, two: &Value) -> Option<String> {
    match (one, two) {
        (Value::Object(of_one), Value::Object(of_two)) => {
            let keys = of_one.keys().chain(of_two.keys().filter(|key| !of_one.contains_key(*key)));
            keys.into_iter().find_map(|name| {
                let [one, two] = [of_one, of_two].map(|of| of.get(name).unwrap_or(&Value::Null));
                difference(&if key.is_empty() { name.clone() } else { format!("{key}.{name}") }, one, two)
            })
        }
        _ if one == two => None,
        (Value::Array(of_one), Value::Array(of_two)) if of_one.len() == of_two.len() => {
            let mut pairs = of_one.iter().zip(of_two).enumerate();
            pairs.find_map(|(i, (one, two))| difference(&format!("{key}[{i}]"), one, two))
        }
        _ => {
            let [one, two] = [one, two].map(|value| {
                let text = value.to_string();
                if text.chars().count() > SHOWN {
                    text.chars().take(SHOWN).chain("…".chars()).collect()
                } else {
                    text
                }
            });
            Some(format!("{key} is {one} and not {two}"))
        }
    }
}

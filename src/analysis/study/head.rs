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
    /// Which part of how many.
    pub shard: Shard,
    /// Number of cells of the whole study.
    pub all: u64,
    /// SHA-256 of version and study: equal in all parts of one study.
    pub fingerprint: String,
    /// All that determines the cells.
    pub study: Value,
}

impl PartHead {
    /// The head of a part of a study, which `study` describes and which has `all` cells.
    ///
    /// # Errors
    /// If it cannot be written as JSON.
    pub fn of(study: Value, all: u64, shard: Shard) -> Result<PartHead> {
        let vibro = env!("CARGO_PKG_VERSION").to_owned();
        let digest = Sha256::digest(format!("{vibro}\n{study}"));
        let fingerprint = hexadecimal(&digest.into());
        Ok(PartHead { vibro, shard, all, fingerprint, study })
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

    /// Ending of the names of parts.
    pub const ENDING: &str = ".cells";

    /// What differs from another head, with both values: `plan.cycles is 200 and not 100`. `None` if both are
    /// of one study and one version.
    pub fn difference(&self, other: &PartHead) -> Option<String> {
        if self.vibro != other.vibro {
            return Some(format!("vibro is {} and not {}", self.vibro, other.vibro));
        }
        let found = difference("", &self.study, &other.study);
        found.or_else(|| {
            let (one, two) = (&self.fingerprint, &other.fingerprint);
            (one != two).then(|| format!("the fingerprint is {one} and not {two}"))
        })
    }
}

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
        _ => (one != two).then(|| format!("{key} is {one} and not {two}")),
    }
}

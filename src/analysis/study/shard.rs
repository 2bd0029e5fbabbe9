//! Which cells of a study belong to which part.

use crate::error::{Error, Result};
use crate::math::Noise;
use serde::{Deserialize, Serialize};
use std::fmt;
use std::str::FromStr;

/// One of several parts of a study, as `3/16`.
///
/// Of each `of` cells that follow one another every part has one. Which one changes from group to group by a
/// fixed rule that repeats nothing: expensive regions of a map, and columns of it, spread over all parts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(into = "String", try_from = "String")]
pub struct Shard {
    /// Number of the part, from 1.
    pub number: u64,
    /// Number of parts.
    pub of: u64,
}

/// Largest number of parts.
const MOST: u64 = 100_000;

impl Shard {
    /// The whole study as one part.
    pub const WHOLE: Shard = Shard { number: 1, of: 1 };

    /// Numbers of its cells among `all` cells, ascending.
    pub fn cells(self, all: u64) -> impl Iterator<Item = u64> {
        let of_group =
            move |group: u64| group * self.of + (self.number - 1 + self.of - turn(group, self.of)) % self.of;
        (0..all.div_ceil(self.of)).map(of_group).filter(move |cell| *cell < all)
    }

    /// Number of its cells among `all` cells.
    pub fn count(self, all: u64) -> u64 {
        let last = all / self.of;
        last + u64::from((last * self.of..all).any(|cell| Shard::number_of(cell, self.of) == self.number))
    }

    /// Number of the part that has a cell.
    pub fn number_of(cell: u64, of: u64) -> u64 {
        (cell % of + turn(cell / of, of)) % of + 1
    }
}

/// By how much the cells of a group are turned against the parts: a number below `of` without a pattern.
fn turn(group: u64, of: u64) -> u64 {
    (Noise::from_state(group).uniform() * of as f64) as u64
}

impl fmt::Display for Shard {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}/{}", self.number, self.of)
    }
}

impl FromStr for Shard {
    type Err = Error;

    /// `I/N`, with I from 1 to N.
    fn from_str(text: &str) -> Result<Shard> {
        let parsed = text.split_once('/').and_then(|(number, of)| {
            let shard = Shard { number: number.trim().parse().ok()?, of: of.trim().parse().ok()? };
            ((1..=MOST).contains(&shard.of) && (1..=shard.of).contains(&shard.number)).then_some(shard)
        });
        parsed.ok_or_else(|| {
            Error::usage(format!("the part {text:?}"), "I/N: part I, from 1 to N, of at most 100000 parts")
                .hint("3/16")
        })
    }
}

impl From<Shard> for String {
    fn from(shard: Shard) -> String {
        shard.to_string()
    }
}

impl TryFrom<String> for Shard {
    type Error = Error;

    fn try_from(text: String) -> Result<Shard> {
        text.parse()
    }
}

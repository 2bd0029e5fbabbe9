//! Meaning of variable names: the struct that holds a variable, the vectors that it describes, and the
//! property of their abscissa that it states.
//!
//! A scalar or text in a struct or group describes all vectors in it, however deep; an attribute describes
//! its vector. A struct without vectors describes the vectors beside the struct:
//! `File_Header.SampleFrequency` describes `Channel_1_Data`, `Signal.x_values.increment` describes
//! `Signal.y_values.values`.

use crate::format::Format;
use std::collections::HashMap;

/// How a format writes names and matrices.
#[derive(Debug)]
pub struct Dialect {
    pub format: Format,
    /// Character after the name of a struct or group.
    pub separator: char,
    /// Brackets around the index of a row or column, and the first index.
    pub brackets: [char; 2],
    pub first: usize,
    /// Whether matrices are stored row after row.
    pub by_rows: bool,
    /// A matrix with more columns than this and than rows is read by rows, one channel per row. With a
    /// larger number, matrices of many channels and few samples are still read by columns.
    pub wide: u64,
    /// Whether groups and vectors have attributes. Then the unit of a group applies to all vectors in it,
    /// and notes keep their names within the group.
    pub attributes: bool,
}

/// Property of an abscissa that a scalar states.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Meaning {
    /// Sampling rate in Hz.
    Rate,
    /// Step of time in s.
    Step,
    /// Step of time or of frequency.
    Increment,
    /// First value.
    Start,
}

/// Certainty that a name has its meaning, from the highest to the lowest.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Trust {
    /// It has no other meaning.
    Sure,
    /// It usually has this meaning: a step is used with a caution, a start only beside an increment.
    Likely,
    /// `rate` may be the speed of a shaft: used from 1 kHz, if nothing more certain is stated.
    Vague,
    /// Not used unless its unit is stated, but suggested to the user.
    Offered,
}

use Meaning::{Increment, Rate, Start, Step};
use Trust::{Likely, Offered, Sure, Vague};

/// Names as returned by [`Dialect::word`], their meaning, and its certainty.
const NAMES: &[(&[&str], Meaning, Trust)] = &[
    (&["fs", "samplerate", "samplingrate", "samplefrequency", "samplingfrequency"], Rate, Sure),
    (&["dt", "ts", "deltat", "sampletime", "samplinginterval", "sampleinterval", "tinterval"], Step, Sure),
    (&["wfincrement"], Step, Sure),
    (&["increment", "xincrement", "xinc", "xspacing"], Increment, Likely),
    (&["dx", "deltax"], Increment, Offered),
    (&["t0", "tstart", "startvalue", "xstart", "xorg", "xorigin", "xoffset", "wfstartoffset"], Start, Sure),
    (&["x0"], Start, Likely),
    (&["sr"], Rate, Likely),
    (&["rate"], Rate, Vague),
];
/// Parts of names of a sampling rate, and their certainty.
const PARTS: &[(&[&str], Trust)] = &[
    (&["samplerate", "samplingrate", "samplefreq", "samplingfreq"], Likely),
    (&["sampl", "rate", "freq"], Offered),
];
/// Names of variables that hold the unit of values.
pub const UNIT: &[&str] = &["unit", "units", "yunit", "yunits", "unity", "unitstring"];
/// Names of variables that hold the unit of the abscissa of values.
pub const X_UNIT: &[&str] = &["xunit", "xunits", "unitx"];
/// Names without a meaning of their own: the name of their struct is used instead.
const CONTENTS: [&str; 3] = ["data", "values", "value"];

impl Dialect {
    /// The struct that holds a variable, with its last separator; empty for a variable outside structs.
    pub fn container<'n>(&self, name: &'n str) -> &'n str {
        name.rfind(self.separator).map_or("", |at| &name[..=at])
    }

    /// The name of a struct without its last separator.
    pub fn bare<'n>(&self, container: &'n str) -> &'n str {
        container.strip_suffix(self.separator).unwrap_or(container)
    }

    /// The last part of a name. If it is one of `CONTENTS`, the part before it without its index: `X` for
    /// `X(1).Data`.
    pub fn key<'n>(&self, name: &'n str) -> &'n str {
        let (container, last) = name.split_at(self.container(name).len());
        match container.strip_suffix(self.separator) {
            Some(outer) if CONTENTS.contains(&last.to_lowercase().as_str()) => {
                let index = outer.rfind(['(', '{']).filter(|_| outer.ends_with([')', '}']));
                self.key(&outer[..index.unwrap_or(outer.len())])
            }
            _ => last,
        }
    }

    /// The key of a name in lower case, letters and digits only.
    pub fn word(&self, name: &str) -> String {
        self.key(name).chars().filter(|c| c.is_alphanumeric()).collect::<String>().to_lowercase()
    }

    /// The property of an abscissa that a scalar of this name states, and its certainty.
    pub fn meaning(&self, name: &str) -> Option<(Meaning, Trust)> {
        let word = self.word(name);
        let named = NAMES.iter().find(|(names, ..)| names.contains(&word.as_str()));
        let part = || PARTS.iter().find(|(parts, _)| parts.iter().any(|part| word.contains(part)));
        named.map(|n| (n.1, n.2)).or_else(|| part().map(|(_, trust)| (Rate, *trust)))
    }

    /// The structs that hold a variable, innermost first; the last is the file, whose name is empty.
    pub fn structs<'n>(&self, name: &'n str) -> impl Iterator<Item = &'n str> {
        let outer = |inner: &&'n str| inner.strip_suffix(self.separator).map(|inner| self.container(inner));
        std::iter::successors(Some(self.container(name)), outer)
    }

    /// The struct whose vectors a variable describes, or the vector whose attribute it is. `vectors` are
    /// sorted.
    pub fn scope<'n>(&self, name: &'n str, vectors: &[&str]) -> &'n str {
        let of = |inside: &'n str| {
            let behind = vectors.partition_point(|vector| *vector < inside);
            let has = vectors.get(behind).is_some_and(|vector| vector.starts_with(inside));
            let vector = || vectors.binary_search(&self.bare(inside)).is_ok();
            if has { Some(inside) } else { vector().then(|| self.bare(inside)) }
        };
        self.structs(name).find_map(of).unwrap_or_default()
    }
}

/// Descriptions of vectors (scalars, notes, abscissae), by the struct or vector that they describe.
pub struct Scoped<T> {
    dialect: &'static Dialect,
    things: HashMap<String, Vec<T>>,
}

impl<T> Scoped<T> {
    pub fn of<'n>(dialect: &'static Dialect, things: impl Iterator<Item = (&'n str, T)>) -> Scoped<T> {
        let mut all = Scoped { dialect, things: HashMap::new() };
        things.for_each(|(scope, thing)| all.add(scope, thing));
        all
    }

    pub fn add(&mut self, scope: &str, thing: T) {
        self.things.entry(scope.to_owned()).or_default().push(thing);
    }

    /// The descriptions that apply to a vector, the nearest first, each with the struct or vector that it
    /// describes.
    pub fn over<'a>(&'a self, name: &'a str) -> impl Iterator<Item = (&'a str, &'a T)> {
        let scopes = std::iter::once(name).chain(self.dialect.structs(name));
        let all = scopes.filter_map(|scope| Some((scope, self.things.get(scope)?)));
        all.flat_map(|(scope, all)| all.iter().map(move |thing| (scope, thing)))
    }
}

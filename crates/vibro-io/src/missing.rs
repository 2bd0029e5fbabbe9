//! Errors and findings on missing values.

use num_complex::Complex64;
use rayon::prelude::*;
use vibro_record::units::notation::counted;
use vibro_record::{Error, Finding, Place, Result, Values, lanes};

/// Largest number of missing values whose places an error lists.
pub(super) const LISTED: usize = 8;

/// Error that refuses missing values; `found` names them.
pub(super) fn refusal(place: Place, found: impl Into<String>) -> Error {
    Error::input(place, found, "a finite number in every place")
        .hint("allow missing values to keep them as such")
        .setting(KEPT)
}

/// Whether an error refuses missing values that could be kept.
pub fn is_missing(error: &Error) -> bool {
    error.settings().any(|key| key == KEPT)
}

/// Setting that keeps missing values as such.
const KEPT: &str = "allow_missing";

/// Finding that `count` missing values were kept; `None` for 0.
pub(super) fn kept(count: usize) -> Option<Finding> {
    (count > 0).then(|| Finding::caution("missing-kept").count("n", count))
}

/// Sets values that are not finite to NaN (missing) and returns their indices.
pub(super) fn mark(values: &mut Values) -> Vec<usize> {
    fn of<T: Copy>(values: &mut [T], finite: impl Fn(&T) -> bool, gap: T) -> Vec<usize> {
        let odd: Vec<usize> = (0..values.len()).filter(|i| !finite(&values[*i])).collect();
        for i in &odd {
            values[*i] = gap;
        }
        odd
    }
    match values {
        Values::Real(values) if lanes::survey(values).finite => Vec::new(),
        Values::Real(values) => of(values, |v| v.is_finite(), f64::NAN),
        Values::Complex(values) => of(values, |v| v.is_finite(), Complex64::new(f64::NAN, f64::NAN)),
    }
}

/// Sets values of records that are not finite to NaN (missing). Unless `allowed`, they are refused, with
/// the record's name and the number of each value.
///
/// # Errors
/// If there are any and they are not `allowed`.
pub(super) fn checked<'a>(
    records: impl ParallelIterator<Item = (&'a str, &'a mut Values)>,
    allowed: bool,
) -> Result<Option<Finding>> {
    let marked: Vec<_> = records.map(|(name, values)| (name, mark(values))).collect();
    let mut missing = Missing::default();
    for (name, i) in marked.iter().flat_map(|(name, odd)| odd.iter().map(move |i| (name, i))) {
        missing.take(&Place::default(), format!("{} of {name:?}", i + 1));
    }
    Ok(kept(missing.check("value", "NaN or infinite:", allowed)?))
}

/// Missing values: how many, and where the first of them are.
#[derive(Debug, Default)]
pub(super) struct Missing {
    count: usize,
    /// Place of the first missing value.
    first: Place,
    listed: Vec<String>,
}

impl Missing {
    /// Counts a missing value at `place`, which the error lists as `listed`.
    pub fn take(&mut self, place: &Place, listed: String) {
        if self.count == 0 {
            self.first = place.clone();
        }
        self.count += 1;
        if self.listed.len() <= LISTED && self.listed.last() != Some(&listed) {
            self.listed.push(listed);
        }
    }

    /// Refuses all of them in one error made of count, `noun`, `what` and places, as in `1 missing value at
    /// 2 of "a"`. Returns their number.
    ///
    /// # Errors
    /// If there are any and they are not `allowed`.
    pub fn check(self, noun: &str, what: &str, allowed: bool) -> Result<usize> {
        if self.count == 0 || allowed {
            return Ok(self.count);
        }
        let listed = self.listed[..self.listed.len().min(LISTED)].join(", ");
        let more = if self.listed.len() > LISTED { ", …" } else { "" };
        Err(refusal(self.first, format!("{} {what} {listed}{more}", counted(self.count, noun))))
    }
}

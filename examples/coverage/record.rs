//! A record, what was done to it, and what an estimator answers of it.

use vibroimpact::measure::Estimate;

/// A kind of records.
pub struct Kind {
    pub name: &'static str,
    /// What is drawn at random, and between which limits.
    pub ranges: &'static str,
    /// Every so many records one is drawn: 1, more where the answer takes long.
    pub every: u64,
    pub draw: fn(&mut super::disturbance::Mix) -> Record,
}

/// The answers of one record.
#[derive(Default)]
pub struct Record {
    pub answers: Vec<Answer>,
    /// Answers with an uncertainty to what the record does not hold, such as a mode that is none.
    pub invented: usize,
}

/// One number that was asked of a record.
pub struct Answer {
    pub quantity: &'static str,
    pub truth: f64,
    /// Value and standard uncertainty; `None` where there is no value, or one without an uncertainty.
    pub found: Option<(f64, f64)>,
}

impl Answer {
    pub fn new(quantity: &'static str, truth: f64, found: Option<&Estimate>) -> Answer {
        Answer::of(quantity, truth, found.map(|e| (e.value, e.std)))
    }

    pub fn of(quantity: &'static str, truth: f64, found: Option<(f64, Option<f64>)>) -> Answer {
        let found = found.and_then(|(value, std)| Some((value, std?)));
        Answer { quantity, truth, found: found.filter(|(value, _)| value.is_finite()) }
    }

    /// Error in standard uncertainties.
    pub fn error(&self) -> Option<f64> {
        self.found.map(|(value, std)| (value - self.truth) / std)
    }
}

/// For each truth the index of the value found that is its own: pairs within their `reach`, the nearest (as a
/// part of it) first.
pub fn pairs(truths: &[f64], reach: &[f64], found: &[f64]) -> Vec<Option<usize>> {
    let mut near: Vec<(f64, usize, usize)> = Vec::new();
    for (i, (truth, reach)) in truths.iter().zip(reach).enumerate() {
        near.extend(found.iter().enumerate().map(|(k, f)| ((f - truth).abs() / reach, i, k)));
    }
    near.retain(|(apart, ..)| *apart <= 1.0);
    near.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut own = vec![None; truths.len()];
    for (_, i, k) in near {
        if own[i].is_none() && !own.contains(&Some(k)) {
            own[i] = Some(k);
        }
    }
    own
}

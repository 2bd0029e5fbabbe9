//! Kinds of simulated records, and the answers of an estimator beside the true values.

use vibroimpact::measure::Estimate;

/// A kind of records.
pub struct Kind {
    /// Name on the page; it also selects the seeds.
    pub name: &'static str,
    /// The properties drawn at random with their limits, as text for the page.
    pub ranges: &'static str,
    /// Divisor of the number of records to draw: 1, or more if the estimator is slow.
    pub every: u64,
    /// Draws a record, runs the estimator on it and returns its answers beside the true values.
    pub draw: fn(&mut super::disturbance::Mix) -> Record,
}

/// The answers of one record.
#[derive(Default)]
pub struct Record {
    pub answers: Vec<Answer>,
    /// Number of answers with an uncertainty for something that the record does not hold, such as a mode
    /// fitted to noise.
    pub invented: usize,
}

/// One quantity of a record: its true value and the estimator's answer.
pub struct Answer {
    /// Name of the quantity on the page.
    pub quantity: &'static str,
    pub truth: f64,
    /// Value and standard uncertainty; `None` without a value or without its uncertainty.
    pub found: Option<(f64, f64)>,
}

impl Answer {
    /// The answer of an estimate, if there is one.
    pub fn new(quantity: &'static str, truth: f64, found: Option<&Estimate>) -> Answer {
        Answer::of(quantity, truth, found.map(|e| (e.value, e.std)))
    }

    /// The answer of a value and its standard uncertainty; no answer without an uncertainty.
    pub fn of(quantity: &'static str, truth: f64, found: Option<(f64, Option<f64>)>) -> Answer {
        let found = found.and_then(|(value, std)| Some((value, std?)));
        Answer { quantity, truth, found: found.filter(|(value, _)| value.is_finite()) }
    }

    /// Error of the answer in standard uncertainties; `None` without an answer.
    pub fn error(&self) -> Option<f64> {
        self.found.map(|(value, std)| (value - self.truth) / std)
    }
}

/// Pairs each true value with a found one, at most `limits` apart. Returns the index of the found value.
/// Pairs with the smallest distance over limit are formed first; no value is in two pairs.
pub fn pairs(truths: &[f64], limits: &[f64], found: &[f64]) -> Vec<Option<usize>> {
    let mut candidates: Vec<(f64, usize, usize)> = Vec::new();
    for (i, (truth, limit)) in truths.iter().zip(limits).enumerate() {
        candidates.extend(found.iter().enumerate().map(|(k, f)| ((f - truth).abs() / limit, i, k)));
    }
    candidates.retain(|(distance, ..)| *distance <= 1.0);
    candidates.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut paired = vec![None; truths.len()];
    for (_, i, k) in candidates {
        if paired[i].is_none() && !paired.contains(&Some(k)) {
            paired[i] = Some(k);
        }
    }
    paired
}

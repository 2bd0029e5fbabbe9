//! Statistics of the answers of many records: how many there are, and how far they are from the truth.

use super::record::{Answer, Record};

/// The answers for one quantity.
#[derive(Default)]
pub struct Tally {
    /// Number of true values.
    pub asked: usize,
    /// Errors of the answers with an uncertainty, in standard uncertainties.
    pub errors: Vec<f64>,
}

impl Tally {
    /// Collects the errors of these answers.
    pub fn of<'a>(answers: impl Iterator<Item = &'a Answer>) -> Tally {
        answers.fold(Tally::default(), |mut tally, answer| {
            tally.asked += 1;
            tally.errors.extend(answer.error());
            tally
        })
    }

    /// Share of the true values that have an answer, in %.
    pub fn answered(&self) -> f64 {
        share(self.errors.len(), self.asked)
    }

    /// Share of the answers within 1.96 standard uncertainties, in %; 95 % if the uncertainties are right.
    pub fn covered(&self) -> f64 {
        share(self.errors.iter().filter(|e| e.abs() <= 1.96).count(), self.errors.len())
    }

    /// Number of answers with an error of more than `limit` standard uncertainties.
    pub fn beyond(&self, limit: f64) -> usize {
        self.errors.iter().filter(|e| e.abs() > limit).count()
    }

    /// Root mean square of the errors in standard uncertainties; 1 if the uncertainties are right.
    pub fn spread(&self) -> f64 {
        let n = self.errors.len().max(1) as f64;
        (self.errors.iter().map(|e| e * e).sum::<f64>() / n).sqrt()
    }

    /// Largest error in standard uncertainties.
    pub fn worst(&self) -> f64 {
        self.errors.iter().fold(0.0, |most, e| e.abs().max(most))
    }
}

/// Share of a part in a whole, in %; 0 if the whole is 0.
fn share(part: usize, all: usize) -> f64 {
    100.0 * part as f64 / all.max(1) as f64
}

/// Tallies the answers of these records by quantity, in the order in which the quantities are first asked.
pub fn by_quantity<'a>(records: &(impl Iterator<Item = &'a Record> + Clone)) -> Vec<(&'static str, Tally)> {
    let answers = || records.clone().flat_map(|r| &r.answers);
    let mut names: Vec<&'static str> = Vec::new();
    for answer in answers() {
        if !names.contains(&answer.quantity) {
            names.push(answer.quantity);
        }
    }
    names.into_iter().map(|name| (name, Tally::of(answers().filter(|a| a.quantity == name)))).collect()
}

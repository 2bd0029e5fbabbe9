//! What the answers of many records come to.

use super::record::{Answer, Record};

/// All that was asked for one quantity.
#[derive(Default)]
pub struct Tally {
    pub asked: usize,
    /// Errors in standard uncertainties of all that was answered.
    pub errors: Vec<f64>,
}

impl Tally {
    pub fn of<'a>(answers: impl Iterator<Item = &'a Answer>) -> Tally {
        answers.fold(Tally::default(), |mut tally, answer| {
            tally.asked += 1;
            tally.errors.extend(answer.error());
            tally
        })
    }

    pub fn answered(&self) -> f64 {
        share(self.errors.len(), self.asked)
    }

    /// Share of the answers within 1.96 standard uncertainties.
    pub fn covered(&self) -> f64 {
        share(self.errors.iter().filter(|e| e.abs() <= 1.96).count(), self.errors.len())
    }

    pub fn beyond(&self, limit: f64) -> usize {
        self.errors.iter().filter(|e| e.abs() > limit).count()
    }

    /// Standard deviation of the errors in standard uncertainties.
    pub fn spread(&self) -> f64 {
        let n = self.errors.len().max(1) as f64;
        (self.errors.iter().map(|e| e * e).sum::<f64>() / n).sqrt()
    }

    pub fn worst(&self) -> f64 {
        self.errors.iter().fold(0.0, |most, e| e.abs().max(most))
    }
}

fn share(part: usize, all: usize) -> f64 {
    100.0 * part as f64 / all.max(1) as f64
}

/// The quantities of these records in the order in which they are asked, with their answers.
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

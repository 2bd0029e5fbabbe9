//! Rehearsal of a test: what its estimator makes of drawn records.

use super::Expected;
use crate::Estimate;
use crate::chance::chi_squared_at;
use crate::mean::scatter;
use vibro_record::{Finding, Result, median};

/// Answers of an estimator to one drawn record by name, and what it found.
pub type Heard = (Vec<(String, Estimate)>, Vec<Finding>);

/// Why a drawn record has no answer.
#[derive(Debug, Clone, PartialEq)]
pub enum Refusal {
    /// Reason of the estimator that refused.
    Refused(String),
    /// Doubt that took the uncertainty away.
    Doubted(Finding),
}

/// An answer in a rehearsal.
#[derive(Debug, Clone, PartialEq)]
pub struct Rehearsed {
    /// Its name.
    pub name: String,
    /// Number of records with this answer and its uncertainty.
    pub answered: usize,
    /// Factor from the expected uncertainty to the one that drawn records show, 1 or more; `None` where most
    /// records have no answer.
    pub widening: Option<f64>,
}

/// What the estimator makes of drawn records, beside what is expected of them.
#[derive(Debug, Clone, PartialEq)]
pub struct Rehearsal {
    /// Number of drawn records.
    pub records: usize,
    /// The expected answers.
    pub answers: Vec<Rehearsed>,
    /// Why records lack an answer, each with its number of records; the most frequent first.
    pub refusals: Vec<(Refusal, usize)>,
}

/// Probability with which errors as expected would be called larger.
const FALSE_ALARM: f64 = 0.01;
/// Standard error of a median of n normal values over that of their mean, √(π/2) (Kenney & Keeping 1962).
const OF_MEDIAN: f64 = 1.2533;

impl Rehearsal {
    /// Compares what is expected with what the estimator `heard` of each drawn record.
    pub fn of(expected: &Expected, heard: &[Result<Heard>]) -> Rehearsal {
        let answers = expected.answers.iter().map(|(name, told)| {
            let own = heard.iter().flatten().filter_map(|(answers, _)| {
                let (_, answer) = answers.iter().find(|(known, _)| known == name)?;
                Some((answer.value - told.value, answer.std?))
            });
            let own: Vec<(f64, f64)> = own.collect();
            let most = 2 * own.len() > heard.len();
            let widening = told.std.filter(|_| most).map(|std| widening(std, &own));
            Rehearsed { name: name.clone(), answered: own.len(), widening }
        });
        let mut refusals: Vec<(Refusal, usize)> = Vec::new();
        for refusal in heard.iter().flat_map(|heard| missing(expected, heard)) {
            let same = |known: &Refusal| match (known, &refusal) {
                (Refusal::Doubted(a), Refusal::Doubted(b)) => a.code == b.code,
                // Reasons that differ in their numbers alone are one.
                (Refusal::Refused(a), Refusal::Refused(b)) => a
                    .split(|c: char| c.is_ascii_digit())
                    .filter(|part| part.len() > 1)
                    .eq(b.split(|c: char| c.is_ascii_digit()).filter(|part| part.len() > 1)),
                _ => false,
            };
            match refusals.iter_mut().find(|(known, _)| same(known)) {
                Some((_, n)) => *n += 1,
                None => refusals.push((refusal, 1)),
            }
        }
        refusals.sort_by_key(|(_, n)| std::cmp::Reverse(*n));
        Rehearsal { records: heard.len(), answers: answers.collect(), refusals }
    }
}

/// Why a record lacks an expected answer, or its uncertainty.
fn missing(expected: &Expected, heard: &Result<Heard>) -> Vec<Refusal> {
    let (answers, findings) = match heard {
        Ok(heard) => heard,
        Err(error) => return vec![Refusal::Refused(error.why())],
    };
    let found = |name: &String| answers.iter().find(|(known, _)| known == name).map(|(_, answer)| answer.std);
    let all: Vec<Option<Option<f64>>> = expected.answers.iter().map(|(name, _)| found(name)).collect();
    let lacks: Vec<&String> =
        expected.answers.iter().map(|(name, _)| name).filter(|name| found(name).is_none()).collect();
    let absent = (!lacks.is_empty()).then(|| {
        let names = lacks.iter().map(|name| name.replace('_', " ")).collect::<Vec<_>>().join(", ");
        Refusal::Refused(format!("no {names}"))
    });
    let doubted = all.contains(&Some(None));
    let doubts = findings.iter().filter(|finding| doubted && finding.is_doubt());
    absent.into_iter().chain(doubts.map(|doubt| Refusal::Doubted(doubt.clone()))).collect()
}

/// Factor on an expected uncertainty by errors and stated uncertainties of records: that of the median
/// statement, or of the root mean square error, where chance does not explain that it is larger.
fn widening(std: f64, own: &[(f64, f64)]) -> f64 {
    let n = own.len();
    let stated: Vec<f64> = own.iter().map(|(_, stated)| *stated).collect();
    let middle = median(&stated);
    let chance = 3.0 * OF_MEDIAN * if n > 1 { scatter(&stated) } else { middle } / (n as f64).sqrt();
    let squares: f64 = own.iter().map(|(error, _)| (error / std).powi(2)).sum();
    let larger = squares > chi_squared_at(1.0 - FALSE_ALARM, n);
    let stated = if middle - chance > std { middle / std } else { 1.0 };
    let erring = if larger { (squares / n as f64).sqrt() } else { 1.0 };
    stated.max(erring)
}

#[cfg(test)]
mod tests {
    use super::*;
    use vibro_math::Noise;
    use vibro_record::Error;

    fn expected() -> Expected {
        let mut expected = Expected::default();
        expected.put("zeta", &Estimate::new(0.02, Some(0.001), "1", 1, ""));
        expected
    }

    /// Twenty records whose errors are `factor` times those expected; `stated` is what they state.
    fn heard(factor: f64, stated: f64) -> Vec<Result<Heard>> {
        let mut noise = Noise::new(3);
        let one = |_| {
            let value = 0.02 + factor * 0.001 * noise.normal();
            Ok((vec![("zeta".to_owned(), Estimate::new(value, Some(stated), "1", 1, ""))], Vec::new()))
        };
        (0..20).map(one).collect()
    }

    #[test]
    fn records_as_expected_change_nothing() {
        let rehearsal = Rehearsal::of(&expected(), &heard(1.0, 0.001));
        assert_eq!(rehearsal.answers, [Rehearsed { name: "zeta".into(), answered: 20, widening: Some(1.0) }]);
        assert!(rehearsal.refusals.is_empty());
    }

    /// Errors of twice the expected uncertainty count as they are found; 20 of them know it to 16 %.
    #[test]
    fn larger_errors_and_larger_statements_widen() {
        let widening =
            |factor, stated| Rehearsal::of(&expected(), &heard(factor, stated)).answers[0].widening;
        assert!((widening(2.0, 0.001).unwrap() - 2.0).abs() < 0.96, "{:?}", widening(2.0, 0.001));
        assert_eq!(widening(1.0, 0.003), Some(0.003 / 0.001));
    }

    #[test]
    fn what_most_records_lack_is_not_promised() {
        let mut heard = heard(1.0, 0.001);
        for (k, one) in heard.iter_mut().enumerate() {
            if k < 9 {
                *one = Err(Error::refused("no decay is seen"));
            } else if k < 12 {
                let (answers, findings) = one.as_mut().unwrap();
                answers[0].1.std = None;
                findings.push(Finding::caution("noisy"));
            }
        }
        let rehearsal = Rehearsal::of(&expected(), &heard);
        assert_eq!(rehearsal.answers, [Rehearsed { name: "zeta".into(), answered: 8, widening: None }]);
        assert_eq!(rehearsal.refusals, [(Refusal::Refused("no decay is seen".into()), 9)]);
    }
}

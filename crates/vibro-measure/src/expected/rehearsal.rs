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
    /// What the records show beside it; `None` where most have no answer.
    pub shown: Option<Shown>,
}

/// Uncertainty that drawn records show, in units of the expected one of a record.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Shown {
    /// Standard uncertainty about the mean of many records, 1 or more.
    pub scatter: f64,
    /// Error of that mean: no number of records lowers it. 0 where chance explains it.
    pub bias: f64,
}

impl Shown {
    /// Standard uncertainty of one record in units of the expected one.
    pub fn factor(&self) -> f64 {
        self.scatter.hypot(self.bias)
    }
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
            let shown = told.std.filter(|_| most).map(|std| Shown::by(std, &own));
            Rehearsed { name: name.clone(), answered: own.len(), shown }
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

impl Shown {
    /// By errors and stated uncertainties of records of which `std` is expected. The mean error is a bias,
    /// and the median statement or the scatter of the errors counts, where chance does not explain it.
    fn by(std: f64, own: &[(f64, f64)]) -> Shown {
        let n = own.len() as f64;
        let errors: Vec<f64> = own.iter().map(|(error, _)| error / std).collect();
        let mean = errors.iter().sum::<f64>() / n;
        let about = |middle: f64| errors.iter().map(|error| (error - middle).powi(2)).sum::<f64>();
        // Of errors as large as expected, or as they scatter where that is more.
        let spread = (about(mean) / (n - 1.0).max(1.0)).sqrt().max(1.0);
        let bias =
            if mean.powi(2) * n > spread.powi(2) * chi_squared_at(1.0 - FALSE_ALARM, 1) { mean } else { 0.0 };
        let free = own.len() - usize::from(bias != 0.0 && own.len() > 1);
        let larger = about(bias) > chi_squared_at(1.0 - FALSE_ALARM, free);
        let erring = if larger { (about(bias) / free as f64).sqrt() } else { 1.0 };
        let stated: Vec<f64> = own.iter().map(|(_, stated)| stated / std).collect();
        let middle = median(&stated);
        let chance = 3.0 * OF_MEDIAN * if own.len() > 1 { scatter(&stated) } else { middle } / n.sqrt();
        // A statement covers the bias, too.
        let stated =
            if middle - chance > 1.0 { (middle * middle - bias * bias).max(1.0).sqrt() } else { 1.0 };
        Shown { scatter: stated.max(erring), bias: bias.abs() }
    }
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
        assert_eq!(
            rehearsal.answers,
            [Rehearsed { name: "zeta".into(), answered: 20, shown: Some(Shown { scatter: 1.0, bias: 0.0 }) }]
        );
        assert!(rehearsal.refusals.is_empty());
    }

    /// Errors of twice the expected uncertainty count as they are found; 20 of them know it to 16 %.
    #[test]
    fn larger_errors_and_larger_statements_widen() {
        let shown =
            |factor, stated| Rehearsal::of(&expected(), &heard(factor, stated)).answers[0].shown.unwrap();
        assert!((shown(2.0, 0.001).factor() - 2.0).abs() < 0.96, "{:?}", shown(2.0, 0.001));
        assert_eq!(shown(1.0, 0.003), Shown { scatter: 0.003 / 0.001, bias: 0.0 });
    }

    /// Records that all err by four expected uncertainties, and scatter as expected: their mean is known to
    /// 1/√20.
    #[test]
    fn a_bias_is_told_from_scatter() {
        let mut heard = heard(1.0, 0.001);
        for (answers, _) in heard.iter_mut().flatten() {
            answers[0].1.value += 0.004;
        }
        let shown = Rehearsal::of(&expected(), &heard).answers[0].shown.unwrap();
        assert_eq!(shown.scatter, 1.0);
        assert!((shown.bias - 4.0).abs() < 3.0 / 20f64.sqrt(), "{shown:?}");
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
        assert_eq!(rehearsal.answers, [Rehearsed { name: "zeta".into(), answered: 8, shown: None }]);
        assert_eq!(rehearsal.refusals, [(Refusal::Refused("no decay is seen".into()), 9)]);
    }
}

//! Methods tried on random records of which the truth is known.

use super::super::measured::{quartiles, timed};
use super::super::watched::{PATIENCE, Watched, watched};
use super::super::{Cell, Measured, Outcome};
use crate::error::Result;
use crate::math::Noise;
use crate::measure::Estimate;
use std::collections::BTreeMap;

/// What a method says.
pub struct Answer {
    /// The value.
    pub value: f64,
    /// Its standard uncertainty, where the method states one.
    pub std: Option<f64>,
    /// Why it is not to be trusted, where the method says so.
    pub doubt: Option<String>,
}

impl Answer {
    /// A number without a word.
    pub fn bare(value: f64) -> Answer {
        Answer { value, std: None, doubt: None }
    }

    /// An estimate with its warnings, of which those that only say what was done are no doubt.
    pub fn stated(estimate: &Estimate, warnings: &[String], routine: &[&str]) -> Answer {
        let doubts = |w: &&String| !routine.iter().any(|r| w.contains(r));
        Answer { value: estimate.value, std: estimate.std, doubt: warnings.iter().find(doubts).cloned() }
    }
}

/// A way to get a number from a record.
pub struct Method<D> {
    /// Name in charts.
    pub name: &'static str,
    /// Whether it is one of this library's.
    pub ours: bool,
    /// The answer to a record.
    pub estimate: fn(&D) -> Result<Answer>,
}

/// A record and what is true of it.
pub struct Case<D> {
    /// The record.
    pub data: D,
    /// The value that is asked for.
    pub truth: f64,
    /// Errors are told in parts of this: 1 for the unit itself, the truth for relative ones, a bound.
    pub unit: f64,
    /// What is allowed to an answer without an uncertainty, in the unit of the truth.
    pub tolerance: f64,
}

/// A record from random numbers.
type Make<D> = Box<dyn Fn(&mut Noise) -> Case<D>>;

/// Random records of one kind.
pub struct Kind<D> {
    /// Its name: the setting of a scene, or the scene at a border.
    pub name: String,
    /// Seed of its first record; the next have the next.
    pub seed: u64,
    /// A record from random numbers.
    pub make: Make<D>,
}

impl<D> Kind<D> {
    /// Records of this name.
    pub fn new(
        name: impl Into<String>,
        seed: u64,
        make: impl Fn(&mut Noise) -> Case<D> + 'static,
    ) -> Kind<D> {
        Kind { name: name.into(), seed, make: Box::new(make) }
    }

    fn case(&self, number: usize) -> Case<D> {
        (self.make)(&mut Noise::new(self.seed + number as u64))
    }
}

/// Records of a setting: in full, and quick.
const RECORDS: [usize; 2] = [128, 24];
/// Records of a setting that are also timed: in full, and quick.
const TIMED: [usize; 2] = [24, 5];
/// Parts of the records whose errors show how far the error scatters.
const PARTS: usize = 8;

/// Every method with every setting: the error is the root mean square over the answers, so that it compares with a standard deviation;
/// its spread are the quartiles over eighths of the records. A method that answers to fewer than half of them has failed.
pub fn measured<D>(methods: &[Method<D>], settings: &[Kind<D>], quick: bool) -> Vec<Measured> {
    let one = |method: &Method<D>, setting: &Kind<D>| {
        let (mut errors, mut times) = (vec![Vec::new(); PARTS], Vec::new());
        let mut refusals = Refusals::default();
        let records = RECORDS[usize::from(quick)];
        for number in 0..records {
            let case = setting.case(number);
            let answer = if number < TIMED[usize::from(quick)] {
                let (answer, time, _) = timed(1, quick, || (method.estimate)(&case.data));
                times.push(time);
                answer
            } else {
                (method.estimate)(&case.data)
            };
            match answer {
                Ok(answer) if answer.value.is_finite() => {
                    errors[number % PARTS].push(((answer.value - case.truth) / case.unit).powi(2));
                }
                Ok(answer) => refusals.add(answer.doubt.as_deref().unwrap_or("it gives no number")),
                Err(error) => refusals.add(error.to_string()),
            }
        }
        let root = |squares: &[f64]| (squares.iter().sum::<f64>() / squares.len() as f64).sqrt();
        let all: Vec<f64> = errors.iter().flatten().copied().collect();
        let mut parts: Vec<f64> = errors.iter().filter(|e| !e.is_empty()).map(|e| root(e)).collect();
        let failed = 2 * all.len() < records;
        let [fast, time_ns, slow] = quartiles(&mut times);
        Measured {
            method: method.name.to_owned(),
            setting: setting.name.clone(),
            ours: method.ours,
            error: (!failed).then(|| root(&all)),
            error_spread: (!failed).then(|| {
                let [low, _, high] = quartiles(&mut parts);
                [low, high]
            }),
            time_ns,
            time_spread: Some([fast, slow]),
            failed,
            why: refusals.said(records),
            front: false,
        }
    };
    methods.iter().flat_map(|m| settings.iter().map(move |s| one(m, s))).collect()
}

/// Reasons that were given for no answer: how often each, and how it was first said.
#[derive(Default)]
struct Refusals(BTreeMap<String, (usize, String)>);

impl Refusals {
    /// Digits differ from record to record and do not make another reason.
    fn add(&mut self, why: impl AsRef<str>) {
        let first = why.as_ref().lines().next().unwrap_or_default();
        let key = first.chars().filter(|c| c.is_alphabetic()).collect();
        self.0.entry(key).or_insert_with(|| (0, first.to_owned())).0 += 1;
    }

    fn said(&self, of: usize) -> Option<String> {
        let all: usize = self.0.values().map(|r| r.0).sum();
        let (_, why) = self.0.values().max_by_key(|r| r.0)?;
        Some(format!("{all} of {of} records refused: {}", why.trim_end_matches('.')))
    }
}

/// Records of a cell of the map: in full, and quick.
const TRIALS: [usize; 2] = [40, 6];
/// An answer within so many of its standard uncertainties is right.
const WITHIN: f64 = 3.0;
/// Share of normal errors that lie further off.
const OUTSIDE: f64 = 2.699_796e-3;
/// Beyond so many a single answer is wrong: of normal errors 5.7e-7 are, of the 40 of a cell one in 2.3e-5.
const FAR: f64 = 5.0;
/// A method whose errors are what it states is called wrong in fewer than this of the cells: in none of the thousand of the map, in nine of ten runs.
const CHANCE: f64 = 1e-4;

/// How many of `trials` answers may lie between [`WITHIN`] and [`FAR`]: the least number that chance exceeds in fewer than [`CHANCE`] of the cells
/// (binomial distribution).
fn outliers(trials: usize) -> usize {
    let odds = OUTSIDE / (1.0 - OUTSIDE);
    let mut term = (1.0 - OUTSIDE).powf(trials as f64);
    let mut beyond = 1.0 - term;
    let mut count = 0;
    while beyond > CHANCE && count < trials {
        term *= odds * (trials - count) as f64 / (count + 1) as f64;
        beyond -= term;
        count += 1;
    }
    count
}

/// What each method does with each kind of record at a border.
pub fn cells<D: Send + 'static>(
    border: &str,
    methods: &[Method<D>],
    kinds: &[Kind<D>],
    quick: bool,
) -> Vec<Cell> {
    let one = |method: &Method<D>, kind: &Kind<D>| {
        let (outcome, why) = judged(method, kind, TRIALS[usize::from(quick)]);
        Cell {
            method: method.name.to_owned(),
            ours: method.ours,
            border: border.to_owned(),
            scene: kind.name.clone(),
            outcome,
            why,
        }
    };
    kinds.iter().flat_map(|k| methods.iter().map(move |m| one(m, k))).collect()
}

fn judged<D: Send + 'static>(method: &Method<D>, kind: &Kind<D>, trials: usize) -> (Outcome, String) {
    let (mut right, mut between, mut worst) = (0, 0, None::<(f64, String)>);
    let (mut refusals, mut stated) = (Refusals::default(), true);
    for number in 0..trials {
        let case = kind.case(number);
        let (estimate, data) = (method.estimate, case.data);
        let answer = match watched(PATIENCE, move || estimate(&data)) {
            Watched::Done(Ok(answer)) => answer,
            Watched::Done(Err(error)) => {
                refusals.add(error.to_string());
                continue;
            }
            Watched::Crashed(why) => return (Outcome::Crashed, format!("record {number}: {why}")),
            Watched::Stalled => {
                return (Outcome::Stalled, format!("record {number}: no answer within {PATIENCE} s"));
            }
        };
        let off = (answer.value - case.truth).abs();
        if !off.is_finite() {
            refusals.add(answer.doubt.as_deref().unwrap_or("it gives no number"));
            continue;
        }
        // In standard uncertainties, or in thirds of the tolerance.
        stated &= answer.std.is_some();
        let score =
            answer.std.map_or(WITHIN * off / case.tolerance, |std| off / std.max(1e-12 * case.truth.abs()));
        match answer.doubt {
            Some(doubt) if answer.std.is_none() || score > WITHIN => refusals.add(doubt),
            _ if score <= WITHIN => right += 1,
            _ => {
                between += 1;
                if worst.as_ref().is_none_or(|w| score > w.0) {
                    let text = format!("{:.6} for {:.6}", answer.value, case.truth);
                    worst = Some((score, text));
                }
            }
        }
    }
    let measure = if stated { "3 standard uncertainties" } else { "what is allowed" };
    let part = |n: usize| format!("{n} of {trials} answers");
    match worst {
        Some((score, text)) if score > FAR || between > outliers(trials) => (
            Outcome::Wrong,
            format!(
                "{} beyond {measure} without a doubt, the worst {text}, {:.3} times as far",
                part(between),
                score / WITHIN
            ),
        ),
        _ if 2 * right >= trials => (Outcome::Right, format!("{} within {measure}", part(right))),
        _ => (Outcome::Refused, refusals.said(trials).unwrap_or_else(|| "no answer".to_owned())),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn chance_calls_a_right_method_wrong_in_fewer_than_one_cell_in_ten_thousand() {
        // P(k) of the binomial distribution by its factorials.
        let share = |n: usize, k: usize| {
            let ways = (0..k).map(|i| (n - i) as f64 / (i + 1) as f64).product::<f64>();
            ways * OUTSIDE.powf(k as f64) * (1.0 - OUTSIDE).powf((n - k) as f64)
        };
        for n in [1, 6, 40, 1000] {
            let beyond = |count: usize| (count + 1..=n).map(|k| share(n, k)).sum::<f64>();
            let count = outliers(n);
            assert!(beyond(count) < CHANCE, "{n}: {count}");
            assert!(count == 0 || beyond(count - 1) > CHANCE, "{n}: {count}");
        }
    }
}

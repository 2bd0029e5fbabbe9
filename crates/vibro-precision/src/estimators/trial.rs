//! Methods tried on random records of which the truth is known.

use super::super::measured::{quartiles, timed};
use super::super::watched::{PATIENCE, Watched, watched};
use super::super::{Cell, Measured, Outcome};
use super::rate::{OUTSIDE, WITHIN, exceeded};
use rayon::prelude::*;
use std::collections::BTreeMap;
use std::sync::Arc;
use vibro_math::Noise;
use vibro_measure::Estimate;
use vibro_record::{Finding, Result, Severity};

/// What a method says.
pub struct Answer {
    /// The value.
    pub value: f64,
    /// Its standard uncertainty, where the method states one.
    pub std: Option<f64>,
    /// Sentences on what was done, and on why the value is not to be trusted.
    pub said: Vec<String>,
}

impl Answer {
    /// A number without a word.
    pub fn bare(value: f64) -> Answer {
        Answer { value, std: None, said: Vec::new() }
    }

    /// An estimate with its findings by their codes; a doubt takes the uncertainty away.
    pub fn found(estimate: &Estimate, findings: &[Finding]) -> Answer {
        let said = |f: &Finding| match f.severity {
            Severity::Doubt => format!("{}: no uncertainty", f.code),
            Severity::Note | Severity::Caution => f.code.to_owned(),
        };
        Answer { value: estimate.value, std: estimate.std, said: findings.iter().map(said).collect() }
    }

    /// The first sentence that says that there is no uncertainty, or why.
    fn withheld(&self) -> Option<&str> {
        self.said.iter().map(String::as_str).find(|s| WITHHELD.iter().any(|word| s.contains(word)))
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
type Make<D> = Box<dyn Fn(&mut Noise) -> Case<D> + Send + Sync>;

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
        make: impl Fn(&mut Noise) -> Case<D> + Send + Sync + 'static,
    ) -> Kind<D> {
        Kind { name: name.into(), seed, make: Box::new(make) }
    }

    fn case(&self, number: usize) -> Case<D> {
        (self.make)(&mut Noise::new(self.seed + number as u64))
    }
}

/// Records of a setting: in full, and quick.
const RECORDS: [usize; 2] = [128, 8];
/// Records of a setting that are also timed: in full, and quick.
const TIMED: [usize; 2] = [24, 3];
/// Seeds from one setting of a scene to the next: each has records of its own, the same for all methods.
const APART: usize = 1_000_000;
/// Parts of the records whose errors show how far the error scatters: in full, and quick.
const PARTS: [usize; 2] = [8, 4];

/// Every method with every setting: the error is the root mean square over the answers, so that it compares with a standard deviation;
/// its spread are the quartiles over eighths of the records, quarters of the few that are quick. A method that answers to fewer than half of them has failed.
pub fn measured<D>(methods: &[Method<D>], settings: &[Kind<D>], quick: bool) -> Vec<Measured> {
    let one = |method: &Method<D>, place: usize, setting: &Kind<D>| {
        let case = |number: usize| setting.case(place * APART + number);
        let parts = PARTS[usize::from(quick)];
        let (mut errors, mut times) = (vec![Vec::new(); parts], Vec::new());
        let mut refusals = Refusals::default();
        let records = RECORDS[usize::from(quick)];
        let answered = |number: usize| {
            let case = case(number);
            let answer = (method.estimate)(&case.data);
            (answer, case.truth, case.unit)
        };
        // Times are those of an idle machine: one after another, before the records that are not timed.
        let mut answers: Vec<(Result<Answer>, f64, f64)> = (0..TIMED[usize::from(quick)])
            .map(|number| {
                let case = case(number);
                let (answer, time, _) = timed(1, quick, || (method.estimate)(&case.data));
                times.push(time);
                (answer, case.truth, case.unit)
            })
            .collect();
        answers.par_extend((answers.len()..records).into_par_iter().map(answered));
        for (number, (answer, truth, unit)) in answers.into_iter().enumerate() {
            match answer {
                Ok(answer) if answer.value.is_finite() => {
                    errors[number % parts].push(((answer.value - truth) / unit).powi(2));
                }
                Ok(answer) => refusals.add(answer.said.first().map_or("it gives no number", String::as_str)),
                Err(error) => refusals.add(error.to_string()),
            }
        }
        let root = |squares: &[f64]| (squares.iter().sum::<f64>() / squares.len() as f64).sqrt();
        let all: Vec<f64> = errors.iter().flatten().copied().collect();
        let mut scattered: Vec<f64> = errors.iter().filter(|e| !e.is_empty()).map(|e| root(e)).collect();
        let failed = 2 * all.len() < records;
        let [fast, time_ns, slow] = quartiles(&mut times);
        Measured {
            method: method.name.to_owned(),
            setting: setting.name.clone(),
            ours: method.ours,
            error: (!failed).then(|| root(&all)),
            error_spread: (!failed).then(|| {
                let [low, _, high] = quartiles(&mut scattered);
                [low, high]
            }),
            time_ns,
            time_spread: Some([fast, slow]),
            failed,
            why: refusals.said(records),
            front: false,
        }
    };
    methods.iter().flat_map(|m| settings.iter().enumerate().map(move |(place, s)| one(m, place, s))).collect()
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
/// Most cells of the map, for which the two limits that follow are made.
pub const CELLS: usize = 500;
/// Chance that anywhere in the full map a method whose errors are as it states them is called wrong: half of it by [`FAR`], half by [`outliers`].
const CHANCE: f64 = 0.01;
/// Beyond so many a single answer is wrong: of normal errors 2.0e-7 are, of the 20 000 of the full map one in 0.4 % of such maps.
const FAR: f64 = 5.2;
/// An answer of a greater standard uncertainty, in parts of what is allowed to one without, is too vague to be right.
const LOOSE: f64 = 1.0;
/// Words by which a sentence says that there is no uncertainty; one that is about an uncertainty, or about something else that is not known, withholds none.
const WITHHELD: [&str; 3] =
    ["no uncertainty", "uncertainty of the mean interval is not known", "too few for a standard uncertainty"];

/// How many of so many answers may lie between [`WITHIN`] and [`FAR`]: the least number that chance exceeds anywhere in the map less often
/// than half of [`CHANCE`].
fn outliers(judged: usize) -> usize {
    exceeded(judged, OUTSIDE, 0.5 * CHANCE / CELLS as f64)
}

/// What came of the answers of one cell.
pub struct Tried {
    /// The cell.
    pub cell: Cell,
    /// Answers that were held to the uncertainty that they state.
    pub judged: usize,
    /// Those of them that lie further off than [`WITHIN`] of it.
    pub beyond: usize,
}

/// One cell of the map, still to be asked for.
pub type Task = Box<dyn FnOnce() -> Tried + Send>;

/// What each method does with each kind of record at a border, to be run.
pub fn cells<D: Send + 'static>(
    border: &'static str,
    methods: &'static [Method<D>],
    kinds: impl IntoIterator<Item = Kind<D>>,
    quick: bool,
) -> Vec<Task> {
    let task = |method: &'static Method<D>, kind: Arc<Kind<D>>| -> Task {
        Box::new(move || {
            let Asked { outcome, why, judged, beyond } = asked(method, &kind, TRIALS[usize::from(quick)]);
            let cell = Cell {
                method: method.name.to_owned(),
                ours: method.ours,
                border: border.to_owned(),
                scene: kind.name.clone(),
                outcome,
                why,
            };
            Tried { cell, judged, beyond }
        })
    };
    let kinds = kinds.into_iter().map(Arc::new);
    kinds.flat_map(|k| methods.iter().map(move |m| task(m, Arc::clone(&k)))).collect()
}

/// What one answer is worth.
#[derive(Debug, PartialEq)]
enum Verdict {
    Right,
    Refused(String),
    /// So many times further off than what is right.
    Off(f64),
}

/// An answer that states its uncertainty is held to it, whatever it says beside: what is doubted has none. One without is a refusal where it says
/// that it has none, and else is held to what is allowed.
fn verdict(answer: &Answer, truth: f64, tolerance: f64) -> Verdict {
    let off = (answer.value - truth).abs();
    let refused = |why: &str| Verdict::Refused(why.to_owned());
    if !off.is_finite() {
        return refused(answer.said.first().map_or("it gives no number", String::as_str));
    }
    let score = match answer.std {
        None => match answer.withheld() {
            Some(why) => return refused(why),
            None => off / tolerance,
        },
        Some(std) if std > LOOSE * tolerance => {
            return Verdict::Refused(format!("its uncertainty of {std:.2e} is more than is allowed"));
        }
        Some(std) => off / (WITHIN * std.max(1e-12 * truth.abs())),
    };
    if score <= 1.0 { Verdict::Right } else { Verdict::Off(score) }
}

/// What came of the answers to records of one kind.
struct Asked {
    outcome: Outcome,
    why: String,
    judged: usize,
    beyond: usize,
}

fn asked<D: Send + 'static>(method: &Method<D>, kind: &Kind<D>, trials: usize) -> Asked {
    let broken = |outcome, why| Asked { outcome, why, judged: 0, beyond: 0 };
    let (mut right, mut off, mut worst) = (0, 0, None::<(f64, String)>);
    let (mut refusals, mut stated) = (Refusals::default(), true);
    let (mut judged, mut beyond) = (0, 0);
    for number in 0..trials {
        let Case { data, truth, tolerance, .. } = kind.case(number);
        let estimate = method.estimate;
        let answer = match watched(PATIENCE, move || estimate(&data)) {
            Watched::Done(Ok(answer)) => answer,
            Watched::Done(Err(error)) => {
                refusals.add(error.to_string());
                continue;
            }
            Watched::Crashed(why) => return broken(Outcome::Crashed, format!("record {number}: {why}")),
            Watched::Stalled => {
                return broken(Outcome::Stalled, format!("record {number}: no answer within {PATIENCE} s"));
            }
        };
        stated &= answer.std.is_some();
        let verdict = verdict(&answer, truth, tolerance);
        if answer.std.is_some() && !matches!(verdict, Verdict::Refused(_)) {
            judged += 1;
            beyond += usize::from(verdict != Verdict::Right);
        }
        match verdict {
            Verdict::Right => right += 1,
            Verdict::Refused(why) => refusals.add(why),
            Verdict::Off(score) => {
                off += 1;
                if worst.as_ref().is_none_or(|w| score > w.0) {
                    let said =
                        answer.said.first().map_or(String::new(), |s| format!(", though it says: {s}"));
                    worst = Some((
                        score,
                        format!("{:.6} for {truth:.6}, {score:.3} times as far{said}", answer.value),
                    ));
                }
            }
        }
    }
    let measure = if stated { "3 standard uncertainties" } else { "what is allowed" };
    let part = |n: usize| format!("{n} of {trials} answers");
    let (outcome, why) = match worst {
        Some((score, text)) if WITHIN * score > FAR || off > outliers(right + off) => {
            (Outcome::Wrong, format!("{} beyond {measure}, the worst {text}", part(off)))
        }
        _ if 2 * right >= trials => (Outcome::Right, format!("{} within {measure}", part(right))),
        _ => (Outcome::Refused, refusals.said(trials).unwrap_or_else(|| "no answer".to_owned())),
    };
    Asked { outcome, why, judged, beyond }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn chance_calls_a_right_method_wrong_in_fewer_than_one_map_in_a_hundred() {
        let half = 0.5 * CHANCE / CELLS as f64;
        // The normal distribution by the midpoint rule, which is off by 1e-8/24 of its curvature.
        let density = |x: f64| (-0.5 * x * x).exp() * (2.0 / std::f64::consts::PI).sqrt();
        let beyond =
            |z: f64| (0..100_000).map(|i| 1e-4 * density(z + 1e-4 * (f64::from(i) + 0.5))).sum::<f64>();
        assert!((beyond(WITHIN) / OUTSIDE - 1.0).abs() < 1e-6);
        let of_cell = |z: f64| TRIALS[0] as f64 * beyond(z);
        assert!(of_cell(FAR) < half && of_cell(FAR - 0.1) > half);
    }

    #[test]
    fn an_answer_is_held_to_its_uncertainty_whatever_it_says_beside() {
        let of = |value, std, said: &[&str]| {
            let said = said.iter().map(|s| (*s).to_owned()).collect();
            verdict(&Answer { value, std, said }, 10.0, 1.0)
        };
        let refused = |v: Verdict| matches!(v, Verdict::Refused(_));
        assert_eq!(of(10.2, Some(0.1), &["3 pulses are clipped."]), Verdict::Right);
        assert!(matches!(of(10.6, Some(0.1), &[]), Verdict::Off(score) if (score - 2.0).abs() < 1e-9));
        assert!(matches!(of(10.6, Some(0.1), &["The noise is not white."]), Verdict::Off(_)));
        assert!(matches!(
            of(10.6, Some(0.1), &["3 pulses are clipped, the uncertainty is too small."]),
            Verdict::Off(_)
        ));
        assert!(refused(of(10.0, None, &["There is no uncertainty."])) && refused(of(f64::NAN, None, &[])));
        assert_eq!(
            of(12.0, None, &["Whether it repeats is not known: the uncertainty may be too small."]),
            Verdict::Off(2.0)
        );
        // A sentence on something else withholds nothing.
        assert_eq!(of(12.0, None, &["A drift was taken away."]), Verdict::Off(2.0));
        assert_eq!(of(10.9, None, &["A drift was taken away."]), Verdict::Right);
        assert!(refused(of(
            12.0,
            None,
            &["A drift was taken away.", "Pulses are clipped: no uncertainty is stated."]
        )));
        // What is known less well than what is allowed is not right, however near it comes.
        assert!(refused(of(10.0, Some(1.1), &[])));
        assert_eq!(of(10.0, Some(0.9), &[]), Verdict::Right);
        assert_eq!((of(10.9, None, &[]), of(12.0, None, &[])), (Verdict::Right, Verdict::Off(2.0)));
    }
}

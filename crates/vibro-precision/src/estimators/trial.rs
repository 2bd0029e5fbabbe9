//! Trials of methods on random records with known truth.

use crate::{BorderQuestion, MeasuredMethod, Outcome, OutcomeWithReason, timed};
use rayon::prelude::*;
use std::borrow::Cow;
use std::sync::Arc;
use vibro_math::Noise;
use vibro_measure::Estimate;
use vibro_record::units::Unit;
use vibro_record::{Axis, Finding, Meta, Result, Trace, median};

/// Answer of a method.
pub struct EstimatorAnswer {
    /// The value.
    pub value: f64,
    /// Its standard uncertainty, where the method states one.
    pub std: Option<f64>,
    /// Code of a finding that doubts the value.
    pub doubt: Option<Cow<'static, str>>,
}

impl EstimatorAnswer {
    /// An estimate with its findings.
    pub fn found(estimate: &Estimate, findings: &[Finding]) -> EstimatorAnswer {
        let doubt = findings.iter().find(|f| f.is_doubt()).map(|f| f.code.clone());
        EstimatorAnswer { value: estimate.value, std: estimate.std, doubt }
    }
}

/// A way to estimate a value from a record, with its name in charts.
pub enum EstimationMethod<D: 'static> {
    /// An estimator of this library.
    Own(&'static str, fn(&D) -> Result<EstimatorAnswer>),
    /// Hand-written code as is common: a value without uncertainty, NaN where it finds none.
    Rival(&'static str, fn(&D) -> f64),
}

impl<D> EstimationMethod<D> {
    /// Its name, and whether it is one of this library's.
    fn name(&self) -> (&'static str, bool) {
        match *self {
            EstimationMethod::Own(name, _) => (name, true),
            EstimationMethod::Rival(name, _) => (name, false),
        }
    }

    /// The answer to a record, or the reason why there is none.
    fn answer(&self, record: &D) -> std::result::Result<EstimatorAnswer, String> {
        let answer = match self {
            EstimationMethod::Own(_, way) => {
                way(record).map_err(|error| OutcomeWithReason::from(error).why)?
            }
            EstimationMethod::Rival(_, way) => EstimatorAnswer { value: way(record), std: None, doubt: None },
        };
        if answer.value.is_finite() { Ok(answer) } else { Err("it gives no number".to_owned()) }
    }
}

/// A record and the true value.
pub struct Case<D> {
    /// The record.
    pub data: D,
    /// The value to be estimated.
    pub truth: f64,
    /// Unit in which errors are stated: 1 for the unit of the truth, the truth for relative errors, or a
    /// bound.
    pub unit: f64,
    /// Largest allowed error of an answer without an uncertainty, in the unit of the truth.
    pub tolerance: f64,
}

/// A named change of a record after it was made.
pub type Change<D> = (&'static str, fn(&mut D));

/// Makes a record from seeded noise.
type Make<D> = dyn Fn(&mut Noise) -> Case<D> + Send + Sync;

/// Random records of one kind.
pub struct Ensemble<D> {
    /// Its name: the setting of a scene, or the scene at a border.
    name: String,
    /// Seed of its first record; each further record adds 1.
    seed: u64,
    make: Box<Make<D>>,
}

impl<D: 'static> Ensemble<D> {
    /// Records of this name, made by `make` from seeded noise.
    pub fn new(
        name: impl Into<String>,
        seed: u64,
        make: impl Fn(&mut Noise) -> Case<D> + Send + Sync + 'static,
    ) -> Ensemble<D> {
        Ensemble { name: name.into(), seed, make: Box::new(make) }
    }

    /// The same, each record changed after it was made.
    pub fn changed(self, change: impl Fn(&mut D) + Send + Sync + 'static) -> Ensemble<D> {
        let Ensemble { name, seed, make } = self;
        Ensemble::new(name, seed, move |noise| {
            let mut case = make(noise);
            change(&mut case.data);
            case
        })
    }

    /// The record of this number.
    fn case(&self, number: usize) -> Case<D> {
        (self.make)(&mut Noise::new(self.seed + number as u64))
    }

    /// The record of this number where the setting has this place in its scene.
    fn case_at(&self, place: usize, number: usize) -> Case<D> {
        self.case(place * SEED_DISTANCE + number)
    }
}

/// A trace that begins at time 0.
pub fn trace(name: &str, unit: &str, step: f64, values: Vec<f64>) -> Trace {
    let meta = Meta::new(name, Unit::parse_or_opaque(unit));
    Trace { meta, axis: Axis::time(0.0, step, values.len()), values }
}

/// Replaces every value by `f` of its place in the record, from 0 to 1, and of the value.
pub fn each(trace: &mut Trace, f: impl Fn(f64, f64) -> f64) {
    let n = trace.values.len() as f64;
    trace.values.iter_mut().enumerate().for_each(|(i, v)| *v = f(i as f64 / n, *v));
}

/// Records of a setting, in a full and a quick run: more take longer, fewer scatter more.
const RECORDS: [usize; 2] = [128, 4];
/// Records of a setting that are also timed, in a full and a quick run.
const TIMED: [usize; 2] = [24, 1];
/// Distance of the seeds of two settings of a scene: each setting has its own records, the same for all
/// methods.
const SEED_DISTANCE: usize = 1_000_000;

/// A record that methods of other programs can be given as well.
pub trait Record: 'static {
    /// Its numbers.
    fn numbers(&self) -> Numbers;
}

/// Values at an even step, and what is known beside them.
pub struct Numbers {
    /// First time in s or frequency in Hz.
    pub start: f64,
    /// Distance of two values in s or Hz.
    pub step: f64,
    /// The values; of complex ones real and imaginary part in turn, of two channels one of each.
    pub values: Vec<f64>,
    /// Excitation frequency in Hz, where the methods know it.
    pub known: Option<f64>,
}

impl Record for Trace {
    fn numbers(&self) -> Numbers {
        let step = self.rate().map_or(f64::NAN, f64::recip);
        Numbers { start: 0.0, step, values: self.values.clone(), known: None }
    }
}

/// Methods of a scene with the kinds of records that they get.
pub struct Settings<D: 'static> {
    /// The methods.
    pub methods: &'static [EstimationMethod<D>],
    /// The kinds of records.
    pub settings: Vec<Ensemble<D>>,
}

/// Takes a record: name of its setting, numbers, truth and unit of the error.
pub type TakeRecord<'a> = dyn FnMut(&str, Numbers, [f64; 2]) -> Result<()> + 'a;

/// What is done with the records of a scene, of whatever type they are.
pub trait Trials {
    /// The results of the methods.
    fn measured(&self, quick: bool) -> Vec<MeasuredMethod>;

    /// Gives each record of [`measured`] to `take`.
    fn each_record(&self, quick: bool, take: &mut TakeRecord<'_>) -> Result<()>;
}

impl<D: Record> Trials for Settings<D> {
    fn measured(&self, quick: bool) -> Vec<MeasuredMethod> {
        measured(self.methods, &self.settings, quick)
    }

    fn each_record(&self, quick: bool, take: &mut TakeRecord<'_>) -> Result<()> {
        for (place, setting) in self.settings.iter().enumerate() {
            for number in 0..RECORDS[usize::from(quick)] {
                let Case { data, truth, unit, .. } = setting.case_at(place, number);
                take(&setting.name, data.numbers(), [truth, unit])?;
            }
        }
        Ok(())
    }
}

/// Measures every method on every setting. The error is the root mean square over the answers, to compare
/// with a standard deviation. A method that answers for fewer than half of the records has failed.
fn measured<D: 'static>(
    methods: &[EstimationMethod<D>],
    settings: &[Ensemble<D>],
    quick: bool,
) -> Vec<MeasuredMethod> {
    let (records, clocked) = (RECORDS[usize::from(quick)], TIMED[usize::from(quick)]);
    let measure = |method: &EstimationMethod<D>, place: usize, setting: &Ensemble<D>| {
        let case = |number: usize| setting.case_at(place, number);
        let error = |number: usize| {
            let Case { data, truth, unit, .. } = case(number);
            Ok((method.answer(&data)?.value - truth) / unit)
        };
        let answers: Vec<_> = (0..records).into_par_iter().map(error).collect();
        // Timed one after another, as on an idle machine.
        let time = |record: D| timed(1, quick, || method.answer(&record)).1;
        let times: Vec<f64> = (0..clocked).map(|number| time(case(number).data)).collect();
        let squares: Vec<f64> = answers.iter().flatten().map(|e| e * e).collect();
        let (n, refusal) = (squares.len(), answers.into_iter().find_map(std::result::Result::err));
        let why = refusal.map(|why: String| format!("{} of {records} records refused: {why}", records - n));
        let rms = (squares.iter().sum::<f64>() / n as f64).sqrt();
        let answer = if 2 * n < records { Err(String::new()) } else { Ok(rms) };
        MeasuredMethod {
            why,
            ..MeasuredMethod::new(method.name(), setting.name.clone(), median(&times), answer)
        }
    };
    methods
        .iter()
        .flat_map(|m| settings.iter().enumerate().map(move |(place, s)| measure(m, place, s)))
        .collect()
}

/// Records of a cell of the map, in a full and a quick run.
const TRIALS: [usize; 2] = [40, 6];
/// An answer within this many of its standard uncertainties is right.
const RIGHT_WITHIN: f64 = 3.0;
/// Most answers of a cell that may lie further off, in a full and a quick run. [`WRONG_BEYOND`] is the number
/// of standard uncertainties beyond which a single answer makes the method wrong. In fewer than one of 200
/// full maps of 500 cells, either limit calls a method with correct uncertainties wrong.
const OUTLIERS: [usize; 2] = [3, 2];
const WRONG_BEYOND: f64 = 5.2;

/// The questions to each method about each kind of record at a border.
pub fn questions<D: Send + 'static>(
    border: &'static str,
    methods: &'static [EstimationMethod<D>],
    kinds: impl IntoIterator<Item = Ensemble<D>>,
    quick: bool,
) -> Vec<BorderQuestion> {
    let question = |method: &'static EstimationMethod<D>, kind: Arc<Ensemble<D>>| {
        let ((method_name, ours), scene) = (method.name(), kind.name.clone());
        let answer = Box::new(move || judged(method, &kind, quick));
        BorderQuestion { method: method_name, ours, border, scene, answer }
    };
    let kinds = kinds.into_iter().map(Arc::new);
    kinds.flat_map(|k| methods.iter().map(move |m| question(m, Arc::clone(&k)))).collect()
}

/// Error of an answer over the largest allowed one, or why it counts as no answer. An answer with an
/// uncertainty may err by three standard uncertainties, even if a finding doubts it; one without may err by
/// `tolerance`. A doubted answer without uncertainty is none, and so is one whose uncertainty exceeds
/// `tolerance`.
fn relative_error(answer: &EstimatorAnswer, truth: f64, tolerance: f64) -> std::result::Result<f64, String> {
    let error = (answer.value - truth).abs();
    match (answer.std, &answer.doubt) {
        (None, Some(doubt)) => Err(format!("no uncertainty: {doubt}")),
        (None, None) => Ok(error / tolerance),
        (Some(std), _) if std > tolerance => {
            Err(format!("its uncertainty of {std:.2e} is more than is allowed"))
        }
        (Some(std), _) => Ok(error / (RIGHT_WITHIN * std.max(1e-12 * truth.abs()))),
    }
}

/// Outcome of a method on a cell's records.
fn judged<D: 'static>(method: &EstimationMethod<D>, kind: &Ensemble<D>, quick: bool) -> OutcomeWithReason {
    let trials = TRIALS[usize::from(quick)];
    // Error of each answer over the largest allowed one, and whether it states an uncertainty.
    let answer = |number: usize| {
        let Case { data, truth, tolerance, .. } = kind.case(number);
        method.answer(&data).and_then(|a| Ok((relative_error(&a, truth, tolerance)?, a.std.is_some())))
    };
    let answers: Vec<_> = (0..trials).map(answer).collect();
    let count =
        |which: fn(f64, bool) -> bool| answers.iter().flatten().filter(|(o, s)| which(*o, *s)).count();
    let (right, wrong) = (count(|off, _| off <= 1.0), count(|off, _| off > 1.0));
    let stated = [count(|_, states| states), count(|off, states| states && off > 1.0)];
    let worst = answers.iter().flatten().map(|a| a.0).fold(0.0, f64::max);
    let allowed = "what they state or is allowed";
    let found = if RIGHT_WITHIN * worst > WRONG_BEYOND || wrong > OUTLIERS[usize::from(quick)] {
        let why = format!("{wrong} of {trials} answers beyond {allowed}, the worst {worst:.3} times");
        OutcomeWithReason::new(Outcome::Wrong, why)
    } else if 2 * right >= trials {
        OutcomeWithReason::new(Outcome::Right, format!("{right} of {trials} answers within {allowed}"))
    } else {
        let refusal = answers.into_iter().find_map(std::result::Result::err);
        OutcomeWithReason::new(
            Outcome::Refused,
            refusal.unwrap_or_else(|| "too few answers are right".to_owned()),
        )
    };
    OutcomeWithReason { stated, ..found }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn chance_calls_a_right_method_wrong_in_fewer_than_one_map_in_a_hundred() {
        let half = 0.5 * 0.01 / 500.0;
        // The normal distribution by the midpoint rule with steps h = 1e-4, which errs by h²/24 of its
        // curvature.
        let density = |x: f64| (-0.5 * x * x).exp() * (2.0 / std::f64::consts::PI).sqrt();
        let beyond =
            |z: f64| (0..100_000).map(|i| 1e-4 * density(z + 1e-4 * (f64::from(i) + 0.5))).sum::<f64>();
        assert!(
            TRIALS[0] as f64 * beyond(WRONG_BEYOND) < half
                && TRIALS[0] as f64 * beyond(WRONG_BEYOND - 0.1) > half
        );
        // The binomial distribution by its factorials.
        let share = beyond(RIGHT_WITHIN);
        for (n, most) in TRIALS.into_iter().zip(OUTLIERS) {
            let at = |k: usize| {
                let ways = (0..k).map(|i| (n - i) as f64 / (i + 1) as f64).product::<f64>();
                ways * share.powf(k as f64) * (1.0 - share).powf((n - k) as f64)
            };
            let more = |most: usize| (most + 1..=n).map(at).sum::<f64>();
            assert!(more(most) < half && more(most - 1) > half, "{n}: {}", more(most));
        }
    }

    #[test]
    fn an_answer_is_held_to_its_uncertainty_whatever_is_found_beside() {
        let of = |value, std, doubt: Option<&'static str>| {
            relative_error(&EstimatorAnswer { value, std, doubt: doubt.map(Into::into) }, 10.0, 1.0)
        };
        let near = |found: std::result::Result<f64, String>, off: f64| (found.unwrap() - off).abs() < 1e-9;
        assert!(near(of(10.3, Some(0.1), None), 1.0));
        assert!(near(of(10.6, Some(0.1), Some("noise-not-white")), 2.0));
        assert!(of(10.0, None, Some("pulse-clipped")).unwrap_err().contains("pulse-clipped"));
        assert!(near(of(10.9, None, None), 0.9) && near(of(12.0, None, None), 2.0));
        // An answer less certain than `tolerance` is not right, however near the truth it is.
        assert!(of(10.0, Some(1.1), None).is_err());
        assert!(near(of(10.0, Some(0.9), None), 0.0));
    }
}

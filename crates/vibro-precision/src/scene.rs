//! Scenes with a known truth, and the error and the time of each method on them.

use serde::{Deserialize, Serialize};
use std::hint::black_box;
use std::time::Instant;
use vibro_record::median;

/// Kind of method that a scene tests.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Family {
    /// Models: a motion from a rig and its excitation.
    Models,
    /// Estimators: a quantity from samples.
    Estimators,
}

impl Family {
    /// Its name.
    pub fn name(self) -> &'static str {
        ["models", "estimators"][self as usize]
    }
}

/// One method with one setting on one scene, measured.
// Each is a key of the JSON that other programs read.
#[allow(clippy::struct_excessive_bools)]
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct MeasuredMethod {
    /// Name of the method.
    pub method: String,
    /// A model's setting: step, tolerance, …; empty where it has none. For an estimator, the record that it
    /// was given.
    pub setting: String,
    /// Whether it is one of this library's.
    pub ours: bool,
    /// Whether another program or library computes the answer; else it is code of this project, even where
    /// the method is common elsewhere.
    #[serde(default)]
    pub other_program: bool,
    /// Error, relative or in the unit that the scene names; for an estimator the root mean square over all
    /// records. `None` where it gave no answer.
    pub error: Option<f64>,
    /// Median time of one answer in ns.
    pub time_ns: f64,
    /// Whether it gave no answer, or one that does not answer the scene.
    pub failed: bool,
    /// Why it failed.
    pub why: Option<String>,
    /// Whether no other method is both faster and more accurate; estimators compete on the same record only.
    pub front: bool,
}

impl MeasuredMethod {
    /// A method of this project with its error, or the reason why it has none.
    pub(crate) fn new(
        (method, ours): (&str, bool),
        setting: String,
        time_ns: f64,
        answer: Result<f64, String>,
    ) -> MeasuredMethod {
        let (method, failed) = (method.to_owned(), answer.is_err());
        let (error, why) = (answer.as_ref().ok().copied(), answer.err());
        MeasuredMethod {
            method,
            setting,
            ours,
            other_program: false,
            error,
            time_ns,
            failed,
            why,
            front: false,
        }
    }
}

/// A scene with a known truth, and the result of each method.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct BenchmarkScene {
    /// Name, short enough for a file.
    pub name: String,
    /// Kind of method that it tests.
    pub family: Family,
    /// Its description, in one sentence.
    pub says: String,
    /// Meaning of the error, with its unit.
    pub error_of: String,
    /// Where the truth comes from.
    pub truth: String,
    /// Cramér–Rao bound of the standard deviation, in the unit of the error.
    pub bound: Option<f64>,
    /// The methods; entries of one name follow one another.
    pub methods: Vec<MeasuredMethod>,
}

/// Relative difference of two errors below which they count as equal: it comes from rounding, and no chart
/// shows it.
const TIE: f64 = 1e-3;

impl BenchmarkScene {
    /// A scene without results: its name, its description, the meaning of the error, and the origin of the
    /// truth.
    pub(crate) fn new<S: Into<String>>(family: Family, texts: [S; 4]) -> BenchmarkScene {
        let [name, says, error_of, truth] = texts.map(Into::into);
        BenchmarkScene { name, family, says, error_of, truth, bound: None, methods: Vec::new() }
    }

    /// Marks the methods than which no other is both faster and more accurate (the Pareto front); none that
    /// failed.
    ///
    /// Errors within a thousandth of each other count as equal, and the faster method is on the front. A
    /// model may choose its setting, so all its settings compete; an estimator's setting is the record, and
    /// only answers to the same record compete.
    pub(crate) fn mark_front(&mut self) {
        let beats = |a: &MeasuredMethod, b: &MeasuredMethod| match (a.error, b.error) {
            (Some(e), Some(error)) => {
                (self.family == Family::Models || a.setting == b.setting)
                    && e <= error * (1.0 + TIE)
                    && a.time_ns <= b.time_ns
                    && (e < error * (1.0 - TIE) || a.time_ns < b.time_ns)
            }
            _ => false,
        };
        let on = |m: &MeasuredMethod| m.error.is_some() && !self.methods.iter().any(|other| beats(other, m));
        let marks: Vec<bool> = self.methods.iter().map(on).collect();
        for (method, front) in self.methods.iter_mut().zip(marks) {
            method.front = front;
        }
    }
}

/// Shortest time in ns that is read from the clock: shorter answers are repeated until they fill it.
const READABLE: f64 = 20_000.0;
/// Most time in ns spent on repeats of one method on one scene, in a full and a quick run.
const SPENT: [f64; 2] = [400e6, 30e6];

/// The answer of `f`, and the median time of one run in ns over up to `repeats`. A first run warms the
/// caches; it is counted only where no time is left for another.
pub(crate) fn timed<T>(repeats: usize, quick: bool, mut f: impl FnMut() -> T) -> (T, f64) {
    let mut clock = |runs: usize| {
        let start = Instant::now();
        let mut answer = black_box(f());
        for _ in 1..runs {
            answer = black_box(f());
        }
        (answer, start.elapsed().as_secs_f64() * 1e9 / runs as f64)
    };
    let (answer, first) = clock(1);
    let runs = (READABLE / first.max(1.0)).ceil();
    let most = SPENT[usize::from(quick)] / (first * runs);
    let mut times: Vec<f64> = (0..repeats.min(most as usize)).map(|_| clock(runs as usize).1).collect();
    if times.is_empty() {
        times.push(first);
    }
    (answer, median(&times))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn marks(family: Family, methods: &[(&str, Option<f64>, f64)]) -> Vec<bool> {
        let method = |&(setting, error, time): &(&str, Option<f64>, f64)| {
            MeasuredMethod::new(("", false), setting.to_owned(), time, error.ok_or_else(String::new))
        };
        let methods = methods.iter().map(method).collect();
        let mut scene = BenchmarkScene { methods, ..BenchmarkScene::new(family, [""; 4]) };
        scene.mark_front();
        scene.methods.iter().map(|m| m.front).collect()
    }

    #[test]
    fn the_front_holds_what_nothing_beats_in_both() {
        let all = [("", Some(1e-3), 1.0), ("", Some(1e-6), 5.0), ("", Some(1e-5), 6.0), ("", None, 0.1)];
        assert_eq!(marks(Family::Models, &all), [true, true, false, false]);
    }

    #[test]
    fn of_two_errors_that_only_rounding_tells_apart_the_faster_is_on_the_front() {
        let [fast, slow] = [5.203_620_391_064_66, 5.203_620_391_064_653];
        let all = [("", Some(fast), 1.0), ("", Some(slow), 408.0), ("", Some(5.1), 408.0)];
        assert_eq!(marks(Family::Models, &all), [true, false, true]);
    }

    #[test]
    fn estimators_compete_on_the_same_record_only() {
        let all = [
            ("0 dB", Some(1e-1), 9.0),
            ("60 dB", Some(1e-6), 8.0),
            ("0 dB", Some(1e-1), 10.0),
            ("60 dB", None, 1.0),
        ];
        assert_eq!(marks(Family::Estimators, &all), [true, true, false, false]);
        assert_eq!(marks(Family::Models, &all), [false, true, false, false]);
    }

    #[test]
    fn a_run_too_short_for_the_clock_is_measured_many_at_a_time() {
        let mut runs = 0_usize;
        let (answer, median) = timed(3, true, || {
            runs += 1;
            7
        });
        assert_eq!(answer, 7);
        assert!(runs > 3 && median > 0.0, "{runs}");
    }

    #[test]
    fn a_run_longer_than_what_may_be_spent_is_run_once() {
        let mut runs = 0;
        let ((), median) = timed(20, true, || {
            runs += 1;
            std::thread::sleep(std::time::Duration::from_millis(31));
        });
        assert_eq!(runs, 1);
        assert!(median >= 31e6, "{median}");
    }
}

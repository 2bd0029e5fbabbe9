//! One method with one setting: run, timed, judged.

use super::task::Fault;
use crate::measured::{front, quartiles, timed};
use crate::{Family, Measured};

/// Repeats of an answer: in full, and quick.
const REPEATS: [usize; 2] = [15, 3];

/// What a judge says of an answer: its error, or why it is none.
pub type Verdict = Result<f64, String>;

/// The methods of a scene as they are measured.
pub struct Entries {
    quick: bool,
    share: f64,
    methods: Vec<Measured>,
}

impl Entries {
    /// None yet.
    pub fn new(quick: bool) -> Entries {
        Entries { quick, share: 1.0, methods: Vec::new() }
    }

    /// Each run gives so many answers: its time is shared by them.
    pub fn shared(self, answers: usize) -> Entries {
        Entries { share: answers as f64, ..self }
    }

    /// Runs, times and judges a method of this library.
    pub fn ours<T>(
        &mut self,
        method: &str,
        setting: &str,
        run: impl FnMut() -> Result<T, Fault>,
        judge: impl Fn(&T) -> Verdict,
    ) {
        self.several(true, method, setting, run, |told| Ok(vec![judge(told)?]));
    }

    /// The same of another method.
    pub fn rival<T>(
        &mut self,
        method: &str,
        setting: &str,
        run: impl FnMut() -> Result<T, Fault>,
        judge: impl Fn(&T) -> Verdict,
    ) {
        self.several(false, method, setting, run, |told| Ok(vec![judge(told)?]));
    }

    /// The same with several errors, whose median and quartiles are kept.
    pub fn several<T>(
        &mut self,
        ours: bool,
        method: &str,
        setting: &str,
        run: impl FnMut() -> Result<T, Fault>,
        judge: impl Fn(&T) -> Result<Vec<f64>, String>,
    ) {
        let (answer, time, spread) = timed(REPEATS[usize::from(self.quick)], self.quick, run);
        let verdict = answer.map_err(|fault| fault.to_string()).and_then(|told| judge(&told));
        let found = verdict.as_ref().ok().map(|errors| (quartiles(&mut errors.clone()), errors.len()));
        self.methods.push(Measured {
            method: method.to_owned(),
            setting: setting.to_owned(),
            ours,
            error: found.map(|f| f.0[1]),
            error_spread: found.filter(|f| f.1 > 1).map(|f| [f.0[0], f.0[2]]),
            time_ns: time / self.share,
            time_spread: spread.map(|s| s.map(|t| t / self.share)),
            failed: verdict.is_err(),
            why: verdict.err(),
            front: false,
        });
    }

    /// The methods, those on the front marked.
    pub fn done(mut self) -> Vec<Measured> {
        front(Family::Models, &mut self.methods);
        self.methods
    }
}

//! One method with one setting: run, timed, judged.

use super::task::Fault;
use crate::compare::precision::Measured;
use crate::compare::precision::measured::{front, timed};

/// Repeats of an answer: in full, and quick.
const REPEATS: [usize; 2] = [15, 3];

/// What a judge says of an answer: its error, or why it is none.
pub type Verdict = Result<f64, String>;

/// The methods of a scene as they are measured.
pub struct Entries {
    quick: bool,
    methods: Vec<Measured>,
}

impl Entries {
    /// None yet.
    pub fn new(quick: bool) -> Entries {
        Entries { quick, methods: Vec::new() }
    }

    /// Runs, times and judges a method of this library.
    pub fn ours<T>(
        &mut self,
        method: &str,
        setting: &str,
        run: impl FnMut() -> Result<T, Fault>,
        judge: impl Fn(&T) -> Verdict,
    ) {
        self.take(true, method, setting, run, judge);
    }

    /// The same of another method.
    pub fn rival<T>(
        &mut self,
        method: &str,
        setting: &str,
        run: impl FnMut() -> Result<T, Fault>,
        judge: impl Fn(&T) -> Verdict,
    ) {
        self.take(false, method, setting, run, judge);
    }

    fn take<T>(
        &mut self,
        ours: bool,
        method: &str,
        setting: &str,
        run: impl FnMut() -> Result<T, Fault>,
        judge: impl Fn(&T) -> Verdict,
    ) {
        let (answer, time_ns, time_spread) = timed(REPEATS[usize::from(self.quick)], self.quick, run);
        let verdict = answer.map_err(|fault| fault.to_string()).and_then(|told| judge(&told));
        self.methods.push(Measured {
            method: method.to_owned(),
            setting: setting.to_owned(),
            ours,
            error: verdict.as_ref().ok().copied(),
            error_spread: None,
            time_ns,
            time_spread,
            failed: verdict.is_err(),
            why: verdict.err(),
            front: false,
        });
    }

    /// The methods, those on the front marked.
    pub fn done(mut self) -> Vec<Measured> {
        front(&mut self.methods);
        self.methods
    }
}

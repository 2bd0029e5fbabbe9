//! A scene before it is measured, and the one way in which all are.

use super::rivals::Method;
use super::task::{Task, Told};
use crate::failure::Found;
use crate::scene::timed;
use crate::{Family, Measured, Scene};

/// What a judge says of the motions that are told: their error, or why there is none.
pub(super) type Verdict = Result<f64, String>;
type Judge = dyn Fn(&[Told]) -> Verdict;

/// A method with its settings.
pub(super) type Asked = (Method, &'static [f64]);

/// A scene before it is measured.
pub(super) struct Ask {
    pub name: String,
    pub says: String,
    pub error_of: &'static str,
    pub truth: String,
    /// Motions that are followed one after another; the time of one answer is the mean.
    pub tasks: Vec<Task>,
    pub methods: Vec<Asked>,
    pub judge: Box<Judge>,
}

/// Repeats of an answer: in full, and quick.
const REPEATS: [usize; 2] = [15, 3];

impl Ask {
    /// Runs, times and judges every method; `quick` with the first half of its settings.
    pub fn measured(self, quick: bool) -> Scene {
        let one = |method: &Method, setting: f64| {
            let (told, time) = timed(REPEATS[usize::from(quick)], quick, || {
                self.tasks
                    .iter()
                    .map(|task| (method.follow)(task, setting))
                    .collect::<Result<Vec<_>, Found>>()
            });
            let fault = |f: Found| format!("{}: {}", f.outcome.name(), f.why);
            let answer = told.map_err(fault).and_then(|told| (self.judge)(&told));
            let (name, setting) = ((method.name, method.ours), method.words(setting));
            Measured::new(name, setting, time / self.tasks.len() as f64, answer)
        };
        let of = |settings: &[f64]| if quick { settings.len().div_ceil(2) } else { settings.len() };
        let methods = self.methods.iter().flat_map(|(m, all)| all[..of(all)].iter().map(|s| one(m, *s)));
        Scene {
            methods: methods.collect(),
            name: self.name,
            family: Family::Models,
            says: self.says,
            error_of: self.error_of.to_owned(),
            truth: self.truth,
            bound: None,
        }
    }
}

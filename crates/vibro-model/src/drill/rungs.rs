//! Ladder of models of the impact unit, and the cheapest that is good enough.

use super::machine::Machine;
use super::run::{Course, Run, run};
use serde::{Deserialize, Serialize};
use vibro_record::Result;

/// Rung of the ladder: how much of the machine the model knows. Each has all of the one before.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Rung {
    /// No air, nothing to integrate: in every turn the piston throws the striker at its own largest speed, on
    /// bodies at rest with rigid contacts.
    Prescribed,
    /// Sealed polytropic cushion, no friction.
    Sealed,
    /// Vents and leakage.
    Vented,
    /// Friction of the seal.
    Friction,
    /// Contacts by their laws where the machine has them.
    Compliant,
}

impl Rung {
    /// All rungs, the simplest first.
    pub const ALL: [Rung; 5] =
        [Rung::Prescribed, Rung::Sealed, Rung::Vented, Rung::Friction, Rung::Compliant];

    /// Name in files and tables.
    pub const fn name(self) -> &'static str {
        match self {
            Rung::Prescribed => "prescribed",
            Rung::Sealed => "sealed",
            Rung::Vented => "vented",
            Rung::Friction => "friction",
            Rung::Compliant => "compliant",
        }
    }
}

/// A rung with its answer.
#[derive(Debug, Clone, PartialEq)]
pub struct Step {
    /// Model.
    pub rung: Rung,
    /// Its run; `None` where the model has no answer for this machine.
    pub run: Option<Run>,
    /// Reason why it has none.
    pub refused: Option<String>,
    /// Largest relative difference from the fullest rung in blow energy, energy of the bit and rate; `None`
    /// without an answer. Infinite where one of the two strikes and the other does not.
    pub error: Option<f64>,
}

/// A machine on all rungs.
#[derive(Debug, Clone, PartialEq)]
pub struct Ladder {
    /// Rungs, the simplest first; the last is the reference.
    pub steps: Vec<Step>,
    /// The cheapest rung within the tolerance; the cost is the number of integration steps.
    pub chosen: Rung,
}

/// Runs a machine on each rung, and chooses the cheapest whose error against the fullest is at most
/// `tolerance`.
///
/// # Errors
/// As [`run`], for the fullest rung.
pub fn climb(machine: &Machine, course: &Course, tolerance: f64) -> Result<Ladder> {
    let fullest = run(machine, Rung::Compliant, course)?;
    let lower = Rung::ALL.into_iter().filter(|rung| *rung != Rung::Compliant);
    let mut steps: Vec<Step> = lower
        .map(|rung| {
            let (run, refused) = match run(machine, rung, course) {
                Ok(run) => (Some(run), None),
                Err(why) => (None, Some(why.why())),
            };
            let error = run.as_ref().map(|run| error(run, &fullest));
            Step { rung, run, refused, error }
        })
        .collect();
    steps.push(Step { rung: Rung::Compliant, run: Some(fullest), refused: None, error: Some(0.0) });
    let good = steps.iter().filter(|step| step.error.is_some_and(|error| error <= tolerance));
    let cost = |step: &&Step| step.run.as_ref().map_or(usize::MAX, |run| run.steps);
    let chosen = good.min_by_key(cost).map_or(Rung::Compliant, |step| step.rung);
    Ok(Ladder { steps, chosen })
}

/// Largest relative difference of the answers.
fn error(run: &Run, reference: &Run) -> f64 {
    let answers = |run: &Run| [run.blow_energy, run.bit_energy, Some(run.rate)].map(|x| x.unwrap_or(0.0));
    let pairs = answers(run).into_iter().zip(answers(reference));
    let relative = |(a, b): (f64, f64)| if a == b { 0.0 } else { ((a - b) / b).abs() };
    // What is no number differs by more than any tolerance.
    pairs.map(relative).map(|by| if by.is_nan() { f64::INFINITY } else { by }).fold(0.0, f64::max)
}

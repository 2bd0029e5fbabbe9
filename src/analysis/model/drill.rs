//! The impact unit of a hammer drill: `vibro model drill`.

mod sweep;
mod tables;

use super::figures;
use crate::analysis::answer::Answer;
use crate::analysis::progress::Progress;
use crate::campaign::above_zero;
use crate::error::{Error, Result};
use crate::model::drill::{Course, Ladder, Machine, MachineDraft, Regime, Run, Rung, Turn, climb, run};
use crate::record::Finding;
use crate::report::files::Names;
use serde_json::{Value, json};
use std::path::PathBuf;
use sweep::Sweep;
pub use sweep::{Axis, Cell};

/// Keys of `vibro model drill`.
#[derive(Debug, Clone)]
#[cfg_attr(feature = "cli", derive(clap::Args))]
pub struct Keys {
    /// Hammer drill as a TOML file: tables drill, drill.crank, drill.cushion, drill.flow, drill.striker,
    /// drill.intermediate, drill.bit, drill.contacts [default: an invented machine with a blow of 4 J]
    #[cfg_attr(feature = "cli", arg(index = 1))]
    pub machine: Option<PathBuf>,
    /// Set a key of the drill, tables with a dot: crank.frequency=30, cushion.length=0.02
    #[cfg_attr(feature = "cli", arg(long = "set", value_name = "KEY=VALUE"))]
    pub set: Vec<String>,
    /// Turns of the crank a second, instead of crank.frequency
    pub speed: Option<f64>,
    /// Model: prescribed, sealed, vented, friction, compliant [default: the cheapest within the tolerance]
    #[cfg_attr(feature = "cli", arg(value_name = "MODEL", value_parser = crate::campaign::word::<Rung>))]
    pub rung: Option<Rung>,
    /// Relative error against the compliant model that does not matter
    #[cfg_attr(feature = "cli", arg(default_value_t = 0.02))]
    pub tolerance: f64,
    /// Turns analysed
    #[cfg_attr(feature = "cli", arg(default_value_t = 60))]
    pub turns: usize,
    /// Turns discarded before, from rest
    #[cfg_attr(feature = "cli", arg(default_value_t = 60))]
    pub settle: usize,
    /// Sweep of the speed in turns a second, each speed from rest
    #[cfg_attr(feature = "cli", arg(value_name = "LOW:HIGH:N"))]
    pub speeds: Option<String>,
    /// Second parameter of a map over the speeds, such as cushion.length=0.015:0.03:20
    #[cfg_attr(feature = "cli", arg(value_name = "KEY=LOW:HIGH:N", requires = "speeds"))]
    pub over: Option<String>,
    /// The start from rest as well: the first turns, until the striker is caught
    pub from_rest: bool,
}

/// Most turns of a run; their samples take 100 kB each.
const MOST_TURNS: usize = 1000;
/// Samples of a drawn turn.
const SAMPLES: usize = 720;
/// Turns drawn of a start.
const START_TURNS: usize = 12;

impl Keys {
    /// Names of the files in its answer.
    pub const FILES: Names =
        Names::Numbered(&["turn", "impacts", "blows", "models", "energies", "speeds", "map", "start"]);

    /// Blows, regime, forces, pressure and energies, with the ladder of models; speeds, map and start where
    /// they are asked for.
    ///
    /// # Errors
    /// If the machine or a key is impossible, or the machine cannot be followed.
    pub fn answer(&self, progress: &dyn Progress) -> Result<Answer> {
        let (machine, findings) = self.machine()?;
        let course = self.course()?;
        let speeds = self.speeds.as_deref().map(Axis::of_speeds).transpose()?;
        let over = self.over.as_deref().map(Axis::of_key).transpose()?;
        if let (Some(speeds), over) = (&speeds, &over) {
            sweep::check_work(speeds, over.as_ref(), course.turns)?;
        }
        let ladder = self.ladder(&machine, &course)?;
        let rung = self.rung.or(ladder.as_ref().map(|ladder| ladder.chosen)).unwrap_or(Rung::Compliant);
        let found = run(&machine, rung, &Course { samples: SAMPLES, ..course })?;
        let mut answer = answer_of(&machine, &found, ladder.as_ref())?;
        answer.add("", findings);
        answer.add("", doubts(&found));
        if let Some(speeds) = &speeds {
            Sweep::of(&self.draft()?, rung, &course, (speeds, over.as_ref()), progress)?
                .add_to(&mut answer)?;
        }
        if self.from_rest {
            add_start(&machine, rung, &course, &mut answer)?;
        }
        Ok(answer)
    }

    /// Keys of the machine, with those that are set.
    fn draft(&self) -> Result<MachineDraft> {
        let mut draft =
            self.machine.as_ref().map_or_else(|| Ok(MachineDraft::default()), MachineDraft::from_path)?;
        self.set.iter().try_for_each(|assignment| draft.set(assignment))?;
        above_zero("speed", self.speed)?;
        if let Some(speed) = self.speed {
            draft.put("crank.frequency", speed)?;
        }
        Ok(draft)
    }

    /// The machine, and the doubt that keys of its file are missing.
    fn machine(&self) -> Result<(Machine, Option<Finding>)> {
        let draft = self.draft()?;
        let missing = draft.left_out().join(", ");
        let doubt = Finding::doubt("drill-left-out").name("keys", &missing).without_estimate();
        Ok((draft.machine()?, (self.machine.is_some() && !missing.is_empty()).then_some(doubt)))
    }

    fn course(&self) -> Result<Course> {
        let (turns, all) = (self.turns, self.turns.saturating_add(self.settle));
        if turns == 0 || all > MOST_TURNS {
            let found = format!("{} turns to settle and {turns} to analyse", self.settle);
            let expected = format!("1 or more to analyse, {MOST_TURNS} in all");
            return Err(Error::usage(found, expected).setting("turns").setting("settle"));
        }
        if !(self.tolerance.is_finite() && self.tolerance > 0.0) {
            let found = format!("tolerance is {}", self.tolerance);
            return Err(Error::usage(found, "a finite value above 0").setting("tolerance"));
        }
        Ok(Course { judged: turns, ..Course::turns(all) })
    }

    /// All models, unless one is stated.
    fn ladder(&self, machine: &Machine, course: &Course) -> Result<Option<Ladder>> {
        if self.rung.is_some() { Ok(None) } else { climb(machine, course, self.tolerance).map(Some) }
    }
}

/// Turns that are drawn: two, unless the blows are alike.
fn drawn(run: &Run) -> &[Turn] {
    let alike = matches!(run.regime, Regime::NoBlow | Regime::EveryTurn);
    let most = if alike && tables::scatter(run).is_none_or(|part| part < 0.01) { 1 } else { 2 };
    &run.turns[run.turns.len().saturating_sub(most)..]
}

/// The answer of one run.
fn answer_of(machine: &Machine, found: &Run, ladder: Option<&Ladder>) -> Result<Answer> {
    let forces = tables::extremes(&found.turns);
    let mean = |of: fn(&Turn) -> f64| found.turns.iter().map(of).sum::<f64>() / found.turns.len() as f64;
    let (handle, damper) = (mean(|turn| turn.handle), mean(|turn| turn.damper));
    let book = tables::mean_book(&found.turns);
    let rungs = ladder.map(|ladder| {
        let step = |step: &crate::model::drill::Step| {
            json!({
                "rung": step.rung,
                "error": step.error.filter(|error| error.is_finite()),
                "steps": step.run.as_ref().map(|run| run.steps),
                "blow_energy": step.run.as_ref().and_then(|run| run.blow_energy),
                "bit_energy": step.run.as_ref().and_then(|run| run.bit_energy),
                "blow_rate": step.run.as_ref().map(|run| 60.0 * run.rate),
                "refused": step.refused,
            })
        };
        ladder.steps.iter().map(step).collect::<Vec<Value>>()
    });
    let mut answer = Answer::of(&json!({
        "machine": machine,
        "rung": found.rung,
        "rungs": rungs,
        "regime": found.regime,
        "speed": machine.crank.frequency,
        "blow_energy": found.blow_energy,
        "blow_scatter": found.blow_scatter,
        "blow_rate": 60.0 * found.rate,
        "bit_energy": found.bit_energy,
        "efficiency": tables::efficiency(found),
        "caught": found.caught.map(|turn| turn + 1),
        "blows": found.blows,
        "forces": forces,
        "handle_impulse": handle,
        "damper_impulse": damper,
        "book": book,
        "impacts": drawn(found).iter().flat_map(|turn| &turn.impacts).collect::<Vec<_>>(),
        "chatters": found.turns.iter().map(|turn| turn.chatters).sum::<usize>(),
        "turn": drawn(found).iter().flat_map(|turn| &turn.samples).collect::<Vec<_>>(),
        "wave_limits": found.wave_limits,
    }))?;
    answer.table("blows", tables::blows(machine, found));
    answer.table("impacts", tables::impacts(found));
    if let Some(forces) = &forces {
        answer.tables.push(tables::forces(forces, [handle, damper]));
    }
    answer.table("energies", tables::energies(&book));
    if let Some(ladder) = ladder {
        answer.table("models", tables::models(ladder));
    }
    if found.turns.iter().any(|turn| !turn.samples.is_empty()) {
        answer.csv("turn", &tables::turn(drawn(found)));
        answer.figure("turn", figures::drill_turn(machine, found, drawn(found)));
    }
    Ok(answer)
}

/// Findings on a run.
fn doubts(found: &Run) -> Vec<Finding> {
    let mut all: Vec<Finding> = found
        .wave_limits
        .iter()
        .map(|limit| {
            let short = Finding::caution("drill-contact-short").name("contact", limit.interface.name());
            let short = short.number("duration", limit.contact).number("travel", limit.travel);
            short.number("impedance", limit.impedance)
        })
        .collect();
    if found.regime == Regime::Irregular {
        all.push(Finding::caution("drill-blows-irregular").count("n", found.turns.len()));
    }
    if (Rung::Sealed..Rung::Compliant).contains(&found.rung) && found.blow_energy.is_some() {
        all.push(Finding::note("drill-rigid-order"));
    }
    let chatters: usize = found.turns.iter().map(|turn| turn.chatters).sum();
    if chatters > 0 {
        all.push(Finding::note("drill-chatter").count("n", chatters).count("turns", found.turns.len()));
    }
    all
}

/// Adds the first turns from rest.
fn add_start(machine: &Machine, rung: Rung, course: &Course, answer: &mut Answer) -> Result<()> {
    let course = Course { judged: course.turns, samples: SAMPLES, ..*course };
    let start = run(machine, rung, &course)?;
    let blows: Vec<Option<f64>> = start.turns.iter().map(|turn| Some(turn.blow?.energy)).collect();
    answer
        .result
        .insert("start".to_owned(), json!({ "caught": start.caught.map(|turn| turn + 1), "blows": blows }));
    answer.table("start", tables::start(&start.turns[..START_TURNS.min(start.turns.len())]));
    if rung > Rung::Prescribed {
        let drawn = &start.turns[..START_TURNS.min(start.turns.len())];
        answer.figure("start", figures::drill_start(machine, drawn, start.caught));
    }
    Ok(())
}

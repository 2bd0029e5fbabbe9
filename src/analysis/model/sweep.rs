//! Sweeps of frequency or force, the motion carried on from step to step: `vibro model sweep`.

use super::contact::{self, Contact, Moving};
use super::{Driven, SceneKeys, figures};
use crate::analysis::answer::Answer;
use crate::compare::{Named, named};
use crate::error::Result;
use crate::measure::jump::Jump;
use crate::measure::resonance::Resonance;
use crate::model::simulate::GRAZING_SPEED;
use crate::model::sweep::{Observable, Pace, Plan, Point, Swept, apart};
use crate::model::{Excitation, Rig, Simulation, State};
use crate::record::{Direction, Finding};
use crate::report::Table;
use crate::report::files::Names;
use crate::report::layout::{headed, pair, table};
use serde::Deserialize;
use serde_json::json;

/// What is asked.
#[derive(Debug, Clone)]
#[cfg_attr(feature = "cli", derive(clap::Args))]
pub struct Keys {
    /// The scene.
    #[cfg_attr(feature = "cli", command(flatten))]
    pub scene: SceneKeys,
    /// What is swept: the excitation frequency, or force, the size of the force or of the impulse
    #[cfg_attr(feature = "cli", arg(value_name = "WHAT", value_parser = crate::campaign::word::<SweptParameter>, default_value = "frequency"))]
    pub over: SweptParameter,
    /// Lower end in Hz, in N (N s for impulses) over the force
    pub from: f64,
    /// Upper end, in the same unit
    pub to: f64,
    /// Excitation frequency in Hz of a sweep of the force
    pub frequency: Option<f64>,
    /// The contact law.
    #[cfg_attr(feature = "cli", arg(help = contact::HELP, value_name = "LAW", value_parser = crate::campaign::word::<Contact>, default_value = "restitution"))]
    pub model: Contact,
    /// Direction: up, down, both
    #[cfg_attr(feature = "cli", arg(value_name = "WAY", value_parser = crate::campaign::word::<Directions>, default_value = "both"))]
    pub direction: Directions,
    /// Change the frequency continuously by this many Hz/s, instead of in steps
    #[cfg_attr(feature = "cli", arg(conflicts_with_all = ["settle", "measure"]))]
    pub sweep_rate: Option<f64>,
    /// Points: steps of a stepped sweep, readings of a continuous one
    #[cfg_attr(feature = "cli", arg(default_value_t = 221))]
    pub steps: usize,
    /// Cycles at each step before it is read
    #[cfg_attr(feature = "cli", arg(default_value_t = 100))]
    pub settle: u32,
    /// Cycles read at each step
    #[cfg_attr(feature = "cli", arg(default_value_t = 12))]
    pub measure: u32,
    /// Observable of both masses: fundamental, the amplitude at the excitation frequency; peak, half of
    /// peak-to-peak; rms, a running RMS through a low-pass of 10 rad/s
    #[cfg_attr(feature = "cli", arg(value_name = "WHAT", value_parser = crate::campaign::word::<Observable>, default_value = "fundamental"))]
    pub observable: Observable,
}

/// What is swept.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum SweptParameter {
    /// The excitation frequency.
    Frequency,
    /// The size of the force, or of the impulse.
    Force,
}

/// The ways in which it is swept.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Directions {
    /// Values rise.
    Up,
    /// Values fall.
    Down,
    /// One after the other.
    Both,
}

impl Keys {
    /// Names of the files in its answer.
    pub const FILES: Names = Names::Numbered(&["sweep", "reaction"]);

    /// The sweep with its resonances and jumps.
    ///
    /// # Errors
    /// If the scene or a key is impossible, nothing drives the rig, or a motion cannot be followed.
    pub fn answer(&self) -> Result<Answer> {
        let over_force = self.over == SweptParameter::Force;
        // The scene needs a frequency even where it is swept: any in the range.
        let frequency = if over_force { self.frequency } else { Some(self.from) };
        let Driven { scene, excitation, finding } = self.scene.driven(frequency)?;
        let pace = match self.sweep_rate {
            Some(rate) => Pace::Rate { rate, points: self.steps },
            None => Pace::Steps { points: self.steps, settle: self.settle, measure: self.measure },
        };
        let plan = Plan { from: self.from, to: self.to, pace, observable: self.observable };
        plan.check()?;
        let make = contact::motions(&scene, self.model, GRAZING_SPEED)?;
        let swept = self.swept(make, &scene.rig, &excitation, &plan)?;
        let (resonances, jumps) = if over_force { (Vec::new(), Vec::new()) } else { named(&swept) };
        let mut answer = Answer::of(&json!({
            "scene": scene,
            "observable": plan.observable,
            "up": swept.up,
            "down": swept.down,
            "resonances": resonances,
            "jumps": jumps,
        }))?;
        answer.add("", finding);
        answer.add("", contact::buffer(&scene, self.model));
        answer.add("", scattered(&swept));
        answer.tables.push(resonances_and_jumps(&resonances, &jumps));
        answer.figure("sweep", figures::sweep(&swept, &resonances, &jumps, plan.observable, over_force));
        answer.figure("reaction", figures::forces(&swept, over_force));
        answer.csv("sweep", &points(&swept));
        Ok(answer)
    }

    /// Sweeps a motion that `make` creates from an excitation, a state and a phase.
    fn swept(
        &self,
        make: impl Fn(&Excitation, State, f64) -> Result<Moving> + Sync,
        rig: &Rig,
        excitation: &Excitation,
        plan: &Plan,
    ) -> Result<Swept> {
        let directions: &[Direction] = match self.direction {
            Directions::Up => &[Direction::Up],
            Directions::Down => &[Direction::Down],
            Directions::Both => &[Direction::Up, Direction::Down],
        };
        let rest = Simulation::at_rest(rig);
        apart(directions, |direction| {
            let start = if direction == Direction::Up { plan.from } else { plan.to };
            if self.over == SweptParameter::Frequency {
                let mut motion = make(&excitation.at_frequency(start), rest, 0.0)?;
                return plan.frequency(&mut *motion, excitation.size(), direction);
            }
            let mut motion = make(&excitation.at_size(start), rest, 0.0)?;
            let frequency = excitation.frequency();
            plan.steps(&mut *motion, direction, |motion, value| {
                motion.set_excitation(&excitation.at_size(value))?;
                Ok((frequency, value))
            })
        })
    }
}

/// Largest scatter from cycle to cycle, over the amplitude, of a motion that repeats every cycle.
const REGULAR_SCATTER: f64 = 0.05;

/// Caution on the points whose cycles differ.
fn scattered(swept: &Swept) -> Option<Finding> {
    let irregular =
        |p: &&Point| p.x1_scatter > REGULAR_SCATTER * p.x1 || p.x2_scatter > REGULAR_SCATTER * p.x2;
    let n = swept.up.iter().chain(&swept.down).filter(irregular).count();
    let all = swept.up.len() + swept.down.len();
    (n > 0).then(|| Finding::caution("sweep-cycles-unlike").count("n", n).count("all", all))
}

/// Point by point, up and then down.
fn points(swept: &Swept) -> Table {
    let sides = [("up", &swept.up), ("down", &swept.down)];
    table(
        "Sweep",
        sides.into_iter().flat_map(|(name, points)| points.iter().map(move |p| (name, p))),
        &[
            ("direction", "", &|(name, _)| (*name).into()),
            ("frequency", "Hz", &|(_, p)| p.frequency.into()),
            ("force", "N", &|(_, p)| p.force.into()),
            ("x1", "m", &|(_, p)| p.x1.into()),
            ("x2", "m", &|(_, p)| p.x2.into()),
            ("x1 scatter", "m", &|(_, p)| p.x1_scatter.into()),
            ("x2 scatter", "m", &|(_, p)| p.x2_scatter.into()),
            ("peak force", "N", &|(_, p)| p.reaction.peak.into()),
            ("RMS force", "N", &|(_, p)| p.reaction.rms.into()),
            ("impulse a cycle", "N s", &|(_, p)| p.reaction.impulse.into()),
        ],
    )
}

/// Resonances and jumps of both masses.
fn resonances_and_jumps(resonances: &[Named<Resonance>], jumps: &[Named<Jump>]) -> Table {
    let head = [("mass", ""), ("direction", ""), ("kind", ""), ("frequency", "Hz"), ("amplitude", "m")];
    let mut table = headed("Resonances and jumps", &head);
    for Named { mass, direction, found } in resonances {
        let place = pair(found.frequency, found.frequency_std);
        let kind = found.kind.name().into();
        table.push([usize::from(*mass).into(), direction.name().into(), kind, place, found.amplitude.into()]);
    }
    for Named { mass, direction, found } in jumps {
        let place = pair(found.frequency, Some(found.frequency_std));
        let kind = format!("jump, {}", found.change).into();
        let after = found.amplitude_after.into();
        table.push([usize::from(*mass).into(), direction.name().into(), kind, place, after]);
    }
    table
}

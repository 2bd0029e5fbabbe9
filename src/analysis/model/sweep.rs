//! Sweeps of frequency or force, the motion carried on from step to step: `vibro model sweep`.

mod run;

use super::contact::{self, Contact, Moving};
use super::{Driven, SceneKeys, figures};
use crate::analysis::answer::Answer;
use crate::compare::{Named, named};
use crate::error::{Error, Result};
use crate::measure::jump::Jump;
use crate::measure::resonance::Resonance;
use crate::model::simulate::GRAZING_SPEED;
use crate::model::sweep::{Observable, Pace, Plan, Swept, above_floor};
use crate::model::{Rig, Simulation, State};
use crate::record::{Direction, Finding};
use crate::report::files::Names;
use crate::report::layout::{headed, pair, table};
use crate::report::{Cell, Table};
use run::{End, Leg, Range, Runs};
use serde::Deserialize;
use serde_json::json;
use std::f64::consts::TAU;

/// Keys of `vibro model sweep`.
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
    #[cfg_attr(feature = "cli", arg(help = contact::help(), value_name = "LAW", value_parser = Contact::named, default_value = "restitution"))]
    pub model: Contact,
    /// Direction: up, down, both (each from the start), up-down (down from where up ends)
    #[cfg_attr(feature = "cli", arg(value_name = "WAY", value_parser = crate::campaign::word::<Directions>, default_value = "both"))]
    pub direction: Directions,
    /// Start: displacements in m, velocities in m/s, phase of the excitation in rad; 0 is the crest of a sine
    /// and the beginning of a pulse [default: at rest, phase 0]
    #[cfg_attr(
        feature = "cli",
        arg(long, value_name = "X1,V1,X2,V2,PHASE", value_delimiter = ',', allow_hyphen_values = true, action = clap::ArgAction::Set)
    )]
    pub start: Vec<f64>,
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

/// Parameter that is swept.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum SweptParameter {
    /// The excitation frequency.
    Frequency,
    /// The size of the force, or of the impulse.
    Force,
}

/// Directions of the sweeps, and where each begins.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Directions {
    /// Values rise.
    Up,
    /// Values fall.
    Down,
    /// Both, each from the start.
    Both,
    /// Up, and then down from the state at the end of the sweep up.
    UpDown,
}

impl Directions {
    /// The sweeps: each begins at the start, and its directions continue each other.
    fn sweeps(self) -> &'static [&'static [Direction]] {
        use Direction::{Down, Up};
        match self {
            Directions::Up => &[&[Up]],
            Directions::Down => &[&[Down]],
            Directions::Both => &[&[Up], &[Down]],
            Directions::UpDown => &[&[Up, Down]],
        }
    }
}

impl Keys {
    /// Names of the files in its answer.
    pub const FILES: Names = Names::Numbered(&["sweep", "reaction", "end_up", "end_down"]);

    /// The sweep with its resonances and jumps.
    ///
    /// # Errors
    /// If the scene or a key is impossible, nothing drives the rig, or a motion cannot be followed.
    pub fn answer(&self) -> Result<Answer> {
        let over_force = self.over == SweptParameter::Force;
        // The scene needs a frequency even where it is swept: any in the range.
        let frequency = if over_force { self.frequency } else { Some(self.from) };
        let Driven { scene, excitation, findings } = self.scene.driven(frequency)?;
        let pace = match self.sweep_rate {
            Some(rate) => Pace::Rate { rate, points: self.steps },
            None => Pace::Steps { points: self.steps, settle: self.settle, measure: self.measure },
        };
        let plan = Plan { from: self.from, to: self.to, pace, observable: self.observable };
        plan.check()?;
        let start = self.start(&scene.rig)?;
        let make = contact::motions(&scene, self.model, GRAZING_SPEED)?;
        let frequency = over_force.then(|| excitation.frequency());
        let runs = Runs::of(make, start, &excitation, &plan, frequency, self.direction.sweeps())?;
        let swept = runs.swept();
        let floor = swept.floor();
        let (irregular, by_chance) = (runs.irregular(floor), runs.by_chance(floor));
        let coexisting = by_chance.as_deref().unwrap_or_default();
        let (resonances, jumps) =
            if over_force { (Vec::new(), Vec::new()) } else { named(&swept, &scene.rig) };
        let swept = swept.without_dust();
        let ends: Vec<&End> = runs.legs().map(|leg| &leg.end).collect();
        let mut answer = Answer::of(&json!({
            "scene": scene,
            "observable": plan.observable,
            "up": swept.up,
            "down": swept.down,
            "resonances": resonances,
            "jumps": jumps,
            "irregular": irregular,
            "by_chance": by_chance,
            "ends": ends,
        }))?;
        answer.add("", findings);
        answer.add("", contact::buffer(&scene, self.model));
        let all = swept.up.len() + swept.down.len();
        answer.add("", points_within(&irregular, all, "sweep-cycles-unlike"));
        answer.add("", runs.irregular_maxima(floor));
        answer.add("", points_within(coexisting, all, "sweep-start-decides"));
        answer.add("", runs.starts_failed());
        answer.add("", still(&swept, &scene.rig));
        answer.tables.push(resonances_and_jumps(&resonances, &jumps));
        if !(irregular.is_empty() && coexisting.is_empty()) {
            answer.tables.push(ranges(&irregular, coexisting, over_force, floor));
        }
        answer.tables.push(final_states(&ends, floor));
        answer.figure("sweep", figures::sweep(&swept, &resonances, &jumps, plan.observable, over_force));
        answer.figure("reaction", figures::forces(&swept, over_force));
        for Leg { direction, portrait, end, .. } in runs.legs() {
            let title =
                format!("Motion at the end of the sweep {}, {:.2} Hz", direction.name(), end.frequency);
            let figure = figures::traces(&title, portrait, scene.rig.gap);
            answer.figure(format!("end_{}", direction.name()), figure);
        }
        answer.csv("sweep", &points(&swept));
        Ok(answer)
    }

    /// State and phase (rad) at the start.
    fn start(&self, rig: &Rig) -> Result<(State, f64)> {
        match self.start[..] {
            [] => Ok((Simulation::at_rest(rig), 0.0)),
            [x1, v1, x2, v2, phase] => Ok((State { x1, v1, x2, v2 }, phase.rem_euclid(TAU))),
            _ => {
                let found = format!("{} numbers of a start", self.start.len());
                Err(Error::usage(found, "five: x1,v1,x2,v2,phase in m, m/s and rad").setting("start"))
            }
        }
    }
}

/// Caution on the points that lie in some ranges, of all points of the sweeps.
fn points_within(ranges: &[Range], all: usize, code: &'static str) -> Option<Finding> {
    let n: usize = ranges.iter().map(|range| range.points).sum();
    (n > 0).then(|| Finding::caution(code).count("n", n).count("all", all))
}

/// Note on a mass that does not move in the whole sweep.
fn still(swept: &Swept, rig: &Rig) -> Option<Finding> {
    let moves = |mass: usize| swept.up.iter().chain(&swept.down).any(|p| p.amplitudes()[mass] > 0.0);
    let mass = (0..2).find(|mass| !moves(*mass))?;
    (mass == 0 || rig.m2.is_finite()).then(|| Finding::note("sweep-mass-still").count("mass", mass + 1))
}

/// Ranges of frequency or force without one periodic motion.
fn ranges(irregular: &[Range], by_chance: &[Range], over_force: bool, floor: f64) -> Table {
    let unit = if over_force { "N" } else { "Hz" };
    let named = |what, ranges: &[Range]| ranges.iter().map(|r| (what, r.clone())).collect::<Vec<_>>();
    let all = [named("irregular or not settled", irregular), named("by chance of the start", by_chance)];
    table(
        "Ranges",
        all.concat(),
        &[
            ("direction", "", &|(_, r)| r.direction.name().into()),
            ("motion", "", &|(what, _)| (*what).into()),
            ("from", unit, &|(_, r)| r.from.into()),
            ("to", unit, &|(_, r)| r.to.into()),
            ("largest x1", "m", &|(_, r)| above_floor(r.x1, floor).into()),
            ("largest x2", "m", &|(_, r)| above_floor(r.x2, floor).into()),
        ],
    )
}

/// State at the end of each direction, from which another sweep starts.
fn final_states(ends: &[&End], floor: f64) -> Table {
    let start = |end: &&End| {
        let State { x1, v1, x2, v2 } = end.state;
        format!("--start={x1:?},{v1:?},{x2:?},{v2:?},{:?} ({})", end.phase, end.direction.name())
    };
    let continued: Vec<String> = ends.iter().map(start).collect();
    table(
        "End",
        ends,
        &[
            ("direction", "", &|end| end.direction.name().into()),
            ("frequency", "Hz", &|end| end.frequency.into()),
            ("impacts", "", &|end| end.regime.to_string().into()),
            ("masses", "", &|end| end.masses().into()),
            ("x1", "m", &|end| above_floor(end.state.x1, floor).into()),
            ("v1", "m/s", &|end| above_floor(end.state.v1, floor).into()),
            ("x2", "m", &|end| above_floor(end.state.x2, floor).into()),
            ("v2", "m/s", &|end| above_floor(end.state.v2, floor).into()),
            ("phase", "rad", &|end| end.phase.into()),
        ],
    )
    .note(format!(
        "Impacts: in so many cycles of the excitation. To continue the motion: {}.",
        continued.join(", ")
    ))
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
        // Below the floor the amplitude is set to 0.
        let after =
            if found.amplitude_after > 0.0 { found.amplitude_after.into() } else { Cell::from("still") };
        table.push([usize::from(*mass).into(), direction.name().into(), kind, place, after]);
    }
    table
}

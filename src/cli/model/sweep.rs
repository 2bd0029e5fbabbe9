//! `vibro model sweep`: up and down with the state carried on.

use super::contact;
use crate::analysis::model::{figures, tables};
use crate::cli::args::{self, Law, Over, Way};
use crate::cli::progress::Busy;
use crate::cli::{complain, print};
use crate::compare::{Named, named};
use crate::error::{Error, Result};
use crate::measure::jump::Jump;
use crate::measure::resonance::Resonance;
use crate::model::continuation::{Branch, follow};
use crate::model::sweep::{Observable, Pace, Plan, Point, Swept, apart};
use crate::model::{
    Compliant, Excitation, Motion, PeriodicOrbit, Rig, Scene, Simulation, State, orbits,
};
use crate::record::Direction;
use crate::report::{Output, files};
use serde::Serialize;
use std::fmt::Write as _;

#[derive(Serialize)]
struct Answer<'a> {
    scene: &'a Scene,
    observable: Observable,
    #[serde(flatten)]
    swept: &'a Swept,
    resonances: &'a [Named<Resonance>],
    jumps: &'a [Named<Jump>],
    #[serde(skip_serializing_if = "Vec::is_empty")]
    branches: Vec<tables::Followed>,
    warnings: &'a [String],
    files: Vec<String>,
}

pub fn run(typed: &args::ModelSweep, json: bool) -> Result<()> {
    let over_force = typed.over == Over::Force;
    // A frequency for the scene where it is swept: any within.
    let frequency = if over_force { typed.frequency } else { Some(typed.from) };
    let (scene, mut warnings) = super::scene(&typed.scene, frequency)?;
    let excitation = super::excitation(&scene)?.clone();
    if typed.branches && (over_force || !matches!(excitation, Excitation::Sine(_))) {
        return Err(Error::usage(
            "--branches without a sine or over the force",
            "--branches under a sine, over the frequency",
        ));
    }
    let plan = plan(typed);
    plan.check()?;
    let busy = Busy::with(json, "sweeping");
    let swept = sweep(&scene, &excitation, &plan, typed)?;
    drop(busy);
    let (resonances, jumps) = if over_force { (Vec::new(), Vec::new()) } else { named(&swept) };
    warnings.extend(contact::buffer(&scene, typed.model));
    warnings.extend(scattered(&swept));
    let branches = if typed.branches { branches(&scene.rig, &excitation, &plan) } else { Vec::new() };
    let mut written = Vec::new();
    if let Some(folder) = &typed.out {
        let mut output = Output::new(folder)?;
        let figure = figures::sweep(&swept, &resonances, &jumps, plan.observable, over_force, &branches);
        files::figures(&mut output, &[("sweep".to_owned(), figure)], &|| ())?;
        output.write("sweep.csv", tables::sweep(&swept).csv())?;
        if typed.branches {
            output.write("branches.csv", tables::branch_points(&branches, plan.observable).csv())?;
        }
        written = output.written().to_vec();
    }
    if json {
        return print::json(&Answer {
            scene: &scene,
            observable: plan.observable,
            swept: &swept,
            resonances: &resonances,
            jumps: &jumps,
            branches: branches.iter().map(|b| tables::followed(b, plan.observable)).collect(),
            warnings: &warnings,
            files: written,
        });
    }
    complain::warn(&warnings);
    let mut text = tables::sweep_named(&resonances, &jumps).text();
    let _ = writeln!(
        text,
        "\n{} points up, {} down: --json, or sweep.csv with --out",
        swept.up.len(),
        swept.down.len()
    );
    for file in written {
        let _ = writeln!(text, "wrote {file}");
    }
    print::text(&text)
}

fn plan(typed: &args::ModelSweep) -> Plan {
    let pace = match typed.rate {
        Some(rate) => Pace::Rate { rate, points: typed.steps },
        None => Pace::Steps { points: typed.steps, settle: typed.settle, measure: typed.measure },
    };
    let observable = match typed.observable {
        args::Observable::Fundamental => Observable::Fundamental,
        args::Observable::Peak => Observable::Peak,
        args::Observable::Rms => Observable::Rms,
    };
    Plan { from: typed.from, to: typed.to, pace, observable }
}

/// The sweep, on the contact law that is meant.
fn sweep(scene: &Scene, excitation: &Excitation, plan: &Plan, typed: &args::ModelSweep) -> Result<Swept> {
    let rig = &scene.rig;
    match typed.model {
        Law::Restitution => {
            over(|e, state, phase| Simulation::from_state(rig, e, state, phase), rig, excitation, plan, typed)
        }
        Law::KelvinVoigt | Law::Hertz | Law::HuntCrossley => {
            let law = contact::law(scene, typed.model)?;
            over(|e, state, phase| Compliant::new(rig, e, law, state, phase), rig, excitation, plan, typed)
        }
        Law::LooseMass => {
            let gap = scene.buffer.map_or(0.0, |b| b.gap);
            let law = scene.contact.map(|_| contact::law(scene, Law::KelvinVoigt)).transpose()?;
            let make = |e: &Excitation, state, phase| Compliant::loose(rig, e, gap, law, state, phase);
            over(make, rig, excitation, plan, typed)
        }
    }
}

/// The sweep of the motions that `make` makes of an excitation, a state and a phase.
fn over<M: Motion>(
    make: impl Fn(&Excitation, State, f64) -> Result<M> + Sync,
    rig: &Rig,
    excitation: &Excitation,
    plan: &Plan,
    typed: &args::ModelSweep,
) -> Result<Swept> {
    let directions: &[Direction] = match typed.direction {
        Way::Up => &[Direction::Up],
        Way::Down => &[Direction::Down],
        Way::Both => &[Direction::Up, Direction::Down],
    };
    let rest = Simulation::at_rest(rig);
    apart(directions, |direction| {
        let start = if direction == Direction::Up { plan.from } else { plan.to };
        if typed.over == Over::Frequency {
            let mut motion = make(&excitation.at_frequency(start), rest, 0.0)?;
            return plan.frequency(&mut motion, excitation.size(), direction);
        }
        let mut motion = make(&excitation.at_size(start), rest, 0.0)?;
        let frequency = excitation.frequency();
        plan.steps(&mut motion, direction, |motion, value| {
            motion.set_excitation(&excitation.at_size(value))?;
            Ok((frequency, value))
        })
    })
}

/// A point whose amplitude scatters by more than this share from cycle to cycle does not repeat every cycle.
const SCATTER: f64 = 0.05;

fn scattered(swept: &Swept) -> Option<String> {
    let irregular = |p: &&Point| p.x1_scatter > SCATTER * p.x1 || p.x2_scatter > SCATTER * p.x2;
    let all = swept.up.len() + swept.down.len();
    let n = swept.up.iter().chain(&swept.down).filter(irregular).count();
    (n > 0).then(|| {
        format!(
            "At {n} of {all} points the motion is not the same in every cycle (amplitudes differ by more than 5 %): it is \
             irregular there, has a longer period, or has not settled."
        )
    })
}

/// Every branch of motions with one impact a cycle that crosses one of some frequencies in the range.
fn branches(rig: &Rig, excitation: &Excitation, plan: &Plan) -> Vec<Branch> {
    const STARTS: u32 = 24;
    let Excitation::Sine(sine) = excitation else { return Vec::new() };
    let mut found: Vec<Branch> = Vec::new();
    for k in 0..STARTS {
        let share = (f64::from(k) + 0.5) / f64::from(STARTS);
        let here = crate::model::Sine { frequency: plan.from + share * (plan.to - plan.from), ..*sine };
        let Ok(answers) = orbits(rig, here.force, here.frequency) else { continue };
        for orbit in answers.orbits.iter().filter(|o| o.validity.exists) {
            let known = found.iter().any(|b| passes(b, here.frequency, orbit.impulse));
            if known {
                continue;
            }
            let start = [(orbit.force_phase, orbit.impulse)];
            let branch = PeriodicOrbit::near(rig, &here, 1, &start)
                .and_then(|start| follow(&start, plan.from, plan.to, 0.05));
            found.extend(branch);
        }
    }
    found
}

/// Whether a branch passes through this impulse (N s) at this frequency (Hz), within its own distance of points.
fn passes(branch: &Branch, frequency: f64, impulse: f64) -> bool {
    branch.points.windows(2).any(|pair| {
        let [a, b] = [&pair[0], &pair[1]].map(|o| (o.sine.frequency, o.beats[0].impulse));
        let inside = (a.0 - frequency) * (b.0 - frequency) <= 0.0;
        let share = (frequency - a.0) / (b.0 - a.0);
        let between = a.1 + share.clamp(0.0, 1.0) * (b.1 - a.1);
        inside && (between - impulse).abs() <= 0.02 * impulse + (b.1 - a.1).abs()
    })
}

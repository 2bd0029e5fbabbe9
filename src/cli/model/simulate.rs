//! `vibro model simulate`: a motion, event by event.

use super::contact;
use crate::analysis::model::figures;
use crate::campaign::above_zero;
use crate::cli::args::{self, Law};
use crate::cli::progress::Busy;
use crate::cli::{complain, print};
use crate::error::{Error, Result};
use crate::model::portrait::{Portrait, Sitting};
use crate::model::regime::Regime;
use crate::model::{Compliant, Impact, Motion, Scene, Simulation, State};
use crate::report::{Output, Table, files};
use serde::Serialize;
use std::fmt::Write as _;

/// Cycles that the traces show, and samples of each.
const SHOWN: u32 = 12;
const SAMPLES: u32 = 400;

#[derive(Serialize)]
struct Answer<'a> {
    scene: &'a Scene,
    impacts: &'a [Impact],
    regime: Regime,
    grazing: Option<u64>,
    chatter: u64,
    final_state: Final,
    flights: Option<u64>,
    warnings: &'a [String],
    files: &'a [String],
}

/// The end of a simulation.
#[derive(Debug, Clone, Copy, Serialize)]
struct Final {
    time: f64,
    phase: f64,
    #[serde(flatten)]
    state: State,
}

/// What a motion did in the cycles that were looked at.
struct Seen {
    portrait: Portrait,
    end: Final,
    /// Grazing impacts, where they are counted.
    grazing: Option<u64>,
    /// Stretches in closed form, with those before.
    flights: Option<u64>,
}

pub fn run(typed: &args::Simulate, json: bool) -> Result<()> {
    let (scene, mut warnings) = super::scene(&typed.scene, typed.frequency)?;
    let busy = Busy::with(json, "simulating");
    let seen = match typed.model {
        Law::Restitution => {
            let mut motion = restitution(&scene, typed)?;
            settle(&mut motion, typed)?;
            let before = motion.counts();
            let (portrait, end) = look(&mut motion, typed)?;
            let after = motion.counts();
            let grazing = Some(after.grazing - before.grazing);
            Seen { portrait, end, grazing, flights: Some(after.flights) }
        }
        Law::KelvinVoigt | Law::Hertz | Law::HuntCrossley => {
            let law = contact::law(&scene, typed.model)?;
            let start = start(&scene, typed)?;
            let excitation = super::excitation(&scene)?;
            whole(Compliant::new(&scene.rig, excitation, law, start, typed.phase)?, typed)?
        }
        Law::LooseMass => {
            let (excitation, start) = (super::excitation(&scene)?, start(&scene, typed)?);
            let gap = scene.buffer.map_or(0.0, |b| b.gap);
            let law = scene.contact.map(|_| contact::law(&scene, Law::KelvinVoigt)).transpose()?;
            let motion = Compliant::loose(&scene.rig, excitation, gap, law, start, typed.phase)?;
            whole(motion, typed)?
        }
    };
    drop(busy);
    warnings.extend(contact::buffer(&scene, typed.model));
    warnings.extend(doubts(&seen, typed));
    if typed.model == Law::Hertz && scene.rig.restitution < 1.0 {
        warnings.push(format!(
            "Hertz' contact has no losses: the rig's restitution of {} is not used.",
            scene.rig.restitution
        ));
    }
    warnings.extend(pressed(&seen, &scene));
    let mut written = Vec::new();
    if let Some(folder) = &typed.out {
        let mut output = Output::new(folder)?;
        write(&mut output, &seen.portrait, scene.rig.gap)?;
        written = output.written().to_vec();
    }
    if json {
        return print::json(&Answer {
            scene: &scene,
            impacts: &seen.portrait.impacts,
            regime: seen.portrait.pattern.regime,
            grazing: seen.grazing,
            chatter: seen.portrait.sticks,
            final_state: seen.end,
            flights: seen.flights,
            warnings: &warnings,
            files: &written,
        });
    }
    complain::warn(&warnings);
    let mut text = summary(&seen).text();
    for file in written {
        let _ = writeln!(text, "wrote {file}");
    }
    print::text(&text)
}

/// The state at the start.
fn start(scene: &Scene, typed: &args::Simulate) -> Result<State> {
    match typed.initial[..] {
        [] => Ok(Simulation::at_rest(&scene.rig)),
        [x1, v1, x2, v2] => Ok(State { x1, v1, x2, v2 }),
        _ => {
            let found = format!("--initial with {} numbers", typed.initial.len());
            Err(Error::usage(found, "four: x1,v1,x2,v2 in m and m/s"))
        }
    }
}

/// The motion with instantaneous impacts.
fn restitution(scene: &Scene, typed: &args::Simulate) -> Result<Simulation> {
    above_zero("grazing", Some(typed.grazing))?;
    let start = start(scene, typed)?;
    let motion = Simulation::from_state(&scene.rig, super::excitation(scene)?, start, typed.phase)?;
    Ok(motion.grazing_below(typed.grazing))
}

/// What a motion does whose grazing impacts are not counted.
fn whole(mut motion: impl Motion, typed: &args::Simulate) -> Result<Seen> {
    settle(&mut motion, typed)?;
    let (portrait, end) = look(&mut motion, typed)?;
    Ok(Seen { portrait, end, grazing: None, flights: None })
}

fn settle(motion: &mut impl Motion, typed: &args::Simulate) -> Result<()> {
    let end = motion.time() + f64::from(typed.settle) / motion.frequency();
    motion.advance(end, &mut |_| {})
}

fn look(motion: &mut impl Motion, typed: &args::Simulate) -> Result<(Portrait, Final)> {
    let sitting = Sitting { cycles: typed.cycles, samples: SAMPLES, shown: SHOWN };
    let portrait = Portrait::take(motion, &sitting)?;
    Ok((portrait, Final { time: motion.time(), phase: motion.phase(), state: motion.state() }))
}

/// Sentences on what is not to be relied on.
fn doubts(seen: &Seen, typed: &args::Simulate) -> Vec<String> {
    let mut doubts = Vec::new();
    let pattern = &seen.portrait.pattern;
    if let Some(grazing) = seen.grazing.filter(|n| *n > 0) {
        doubts.push(format!(
            "{grazing} of {} impacts graze, with less than {} m/s: a little more gap and there are none. What follows an impact depends on \
             such differences like their root.",
            seen.portrait.impacts.len(),
            typed.grazing
        ));
    }
    match pattern.regime {
        Regime::Irregular => doubts.push(
            "No pattern repeats: the motion is irregular, of which only statistics can be compared, or has not settled. A longer --settle shows which."
                .to_owned(),
        ),
        _ if !pattern.settled => doubts.push(format!(
            "The motion has not settled{}: give it more cycles with --settle.",
            pattern.distance.map_or_else(String::new, |d| format!(" (repetitions still differ by {d:.1e})"))
        )),
        _ => {}
    }
    doubts
}

/// A sentence on masses that touch without meeting.
fn pressed(seen: &Seen, scene: &Scene) -> Option<String> {
    let State { x1, x2, .. } = seen.end.state;
    // Apart by less than a millionth of their ways.
    let touching = scene.rig.gap + x2 - x1 <= 1e-6 * (x1.abs() + x2.abs());
    (seen.portrait.pattern.regime == Regime::NoImpact && touching).then(|| {
        "The masses stay pressed together all the time: there is no impact because they never part."
            .to_owned()
    })
}

fn summary(seen: &Seen) -> Table {
    let Portrait { impacts, pattern, sticks, .. } = &seen.portrait;
    let regime = match pattern.regime {
        Regime::Periodic { impacts, cycles } => {
            let many = |n: u32, what: &str| format!("{n} {what}{}", if n == 1 { "" } else { "s" });
            format!("{} in {}", many(impacts, "impact"), many(cycles, "cycle"))
        }
        other => other.to_string(),
    };
    let last = impacts.last();
    let mut table = Table::new("Motion")
        .column("regime", "")
        .column("impacts", "")
        .column("grazing", "")
        .column("chatter", "")
        .column("last impulse", "N s")
        .column("approach speed", "m/s")
        .column("phase", "rad");
    table.push([
        regime.into(),
        impacts.len().into(),
        seen.grazing.map(|n| n as f64).into(),
        (*sticks as usize).into(),
        last.map(|i| i.impulse).into(),
        last.map(|i| i.approach_velocity).into(),
        last.map(|i| i.phase).into(),
    ]);
    table
}

fn write(output: &mut Output, portrait: &Portrait, gap: f64) -> Result<()> {
    let figures = [
        ("traces".to_owned(), figures::traces("Traces of both masses", portrait, gap)),
        ("phase_plane".to_owned(), figures::phase_plane("Phase plane", portrait)),
        ("poincare".to_owned(), figures::poincare("Poincaré sections", portrait)),
    ];
    files::figures(output, &figures, &|| ())?;
    let states = |times: &[f64], states: &[State]| {
        let mut text = String::from("time [s],x1 [m],v1 [m/s],x2 [m],v2 [m/s]\n");
        for (t, s) in times.iter().zip(states) {
            let _ = writeln!(text, "{t:e},{:e},{:e},{:e},{:e}", s.x1, s.v1, s.x2, s.v2);
        }
        text
    };
    output.write("traces.csv", states(&portrait.time, &portrait.states))?;
    output.write("poincare.csv", states(&portrait.beginnings, &portrait.section))?;
    let mut text = String::from("time [s],phase [rad],approach speed [m/s],impulse [N s]\n");
    for i in &portrait.impacts {
        let _ = writeln!(text, "{:e},{:e},{:e},{:e}", i.time, i.phase, i.approach_velocity, i.impulse);
    }
    output.write("impacts.csv", text)?;
    Ok(())
}

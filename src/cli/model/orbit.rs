//! `vibro model orbit`: all motions with one impact a period.

use crate::cli::{args, complain, print};
use crate::error::{Error, Result};
use crate::model::orbit::orbits_over;
use crate::model::{Excitation, Orbit, Orbits, Scene};
use crate::report::Table;
use serde::Serialize;

#[derive(Serialize)]
struct Answer<'a> {
    scene: &'a Scene,
    #[serde(flatten)]
    found: &'a Orbits,
    warnings: &'a [String],
    files: Vec<String>,
}

pub fn run(typed: &args::Orbit, json: bool) -> Result<()> {
    let (scene, warnings) = super::scene(&typed.scene, typed.frequency)?;
    let Excitation::Sine(sine) = super::excitation(&scene)? else {
        return Err(Error::usage("an excitation that is no sine", "a sine"));
    };
    let found = orbits_over(&scene.rig, sine, typed.cycles)?;
    if json {
        return print::json(&Answer { scene: &scene, found: &found, warnings: &warnings, files: Vec::new() });
    }
    complain::warn(&warnings);
    print::text(&table(&found.orbits).text())
}

fn table(orbits: &[Orbit]) -> Table {
    let mut table = Table::new("Motions with one impact a period")
        .column("impulse", "N s")
        .column("approach speed", "m/s")
        .column("exists", "")
        .column("admissible", "")
        .column("stability", "");
    for orbit in orbits {
        let word = |yes: bool| if yes { "yes" } else { "no" };
        table.push([
            orbit.impulse.into(),
            orbit.approach_velocity.into(),
            word(orbit.validity.exists).into(),
            word(orbit.validity.admissible).into(),
            orbit.validity.stability.into(),
        ]);
    }
    table
}

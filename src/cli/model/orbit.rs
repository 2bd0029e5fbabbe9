//! `vibro model orbit`: all motions with one impact a period.

use super::{Judged, gap_std, judged};
use crate::analysis::model::{figures, tables};
use crate::campaign::above_zero;
use crate::cli::{args, complain, print};
use crate::error::Result;
use crate::model::{Compliance, Excitation, NoImpact, Orbits, Rig, Scene, Softened, orbits_of, softened};
use crate::report::{Output, files};
use crate::units::notation::quantity;
use serde::Serialize;
use std::fmt::Write as _;

#[derive(Serialize)]
struct Answer<'a> {
    scene: &'a Scene,
    orbits: Vec<Told<'a>>,
    no_impact: &'a NoImpact,
    contact: Option<Compliance>,
    warnings: &'a [String],
    files: Vec<String>,
}

#[derive(Serialize)]
struct Told<'a> {
    #[serde(flatten)]
    judged: Judged<'a>,
    soft: Option<Softened>,
}

pub fn run(typed: &args::Orbit, json: bool) -> Result<()> {
    above_zero("frequency", typed.frequency)?;
    let gap_std = gap_std(typed.gap_std)?;
    let (scene, mut warnings) = super::scene(&typed.scene, typed.frequency)?;
    let excitation = super::excitation(&scene)?;
    let found = orbits_of(&scene.rig, excitation, typed.cycles)?;
    let (contact, soft) = soften(&scene, excitation, &found, &mut warnings)?;
    for (i, orbit) in found.orbits.iter().enumerate() {
        let near = gap_std.filter(|std| orbit.validity.exists && orbit.validity.grazing_distance <= *std);
        if let Some(std) = near {
            warnings.push(format!(
                "Motion {} is {} from grazing, no more than the gap's uncertainty of {}: its verdicts and multipliers are not to be \
                 relied on.",
                i + 1,
                quantity(orbit.validity.grazing_distance, "m", 3),
                quantity(std, "m", 3)
            ));
        }
    }
    let mut written = Vec::new();
    if let Some(folder) = &typed.out {
        let mut output = Output::new(folder)?;
        let shown: Vec<_> =
            found.orbits.iter().enumerate().filter(|(_, orbit)| orbit.validity.exists).collect();
        let figures: Vec<_> = shown
            .iter()
            .map(|(i, orbit)| {
                (format!("orbit_{}", i + 1), figures::orbit(&format!("Motion {}", i + 1), &scene.rig, orbit))
            })
            .collect();
        files::figures(&mut output, &figures, &|| ())?;
        for (i, orbit) in shown {
            output
                .write(&format!("orbit_{}.csv", i + 1), tables::course(orbit, scene.rig.gap, 1000).csv())?;
        }
        output.write("orbits.csv", tables::orbits(&found.orbits).csv())?;
        output.write("verdicts.csv", tables::verdicts(&found.orbits, gap_std).csv())?;
        written = output.written().to_vec();
    }
    if json {
        let told = |(orbit, soft)| Told { judged: judged(orbit, gap_std), soft };
        return print::json(&Answer {
            scene: &scene,
            orbits: found.orbits.iter().zip(soft).map(told).collect(),
            no_impact: &found.no_impact,
            contact,
            warnings: &warnings,
            files: written,
        });
    }
    complain::warn(&warnings);
    let mut text = String::new();
    if found.orbits.is_empty() {
        text.push_str("There is no motion with one impact a period.\n\n");
    } else {
        let _ = write!(
            text,
            "{}\n{}\n",
            tables::orbits(&found.orbits).text(),
            tables::verdicts(&found.orbits, gap_std).text()
        );
    }
    text.push_str(&tables::no_impact(&found.no_impact).text());
    if soft.iter().any(Option::is_some) {
        let _ = write!(text, "\n{}", tables::soft(&soft).text());
    }
    for file in written {
        let _ = writeln!(text, "wrote {file}");
    }
    print::text(&text)
}

/// The contact and what it changes in each orbit; a sentence where it lasts too long for that.
fn soften(
    scene: &Scene,
    excitation: &Excitation,
    found: &Orbits,
    warnings: &mut Vec<String>,
) -> Result<(Option<Compliance>, Vec<Option<Softened>>)> {
    let none = vec![None; found.orbits.len()];
    let Some(keys) = scene.contact else { return Ok((None, none)) };
    let Some(stiffness) = keys.stiffness else {
        warnings.push("The contact has no stiffness: no correction for its duration.".to_owned());
        return Ok((None, none));
    };
    if keys.exponent.is_some_and(|n| n != 1.0) {
        warnings.push(
            "The correction for the duration of the contact knows springs only (exponent 1): none is made."
                .to_owned(),
        );
        return Ok((None, none));
    }
    let contact = Compliance::new(&scene.rig, stiffness, keys.damping)?;
    let of_rig = scene.rig.restitution;
    if (contact.restitution - of_rig).abs() > 1e-3 {
        warnings.push(format!(
            "Spring and damper of the contact make a restitution of {:.4}, the rig says {of_rig}: the correction is that of the contact's \
             restitution, the motions are those of the rig's.",
            contact.restitution
        ));
    }
    let rig = Rig { restitution: contact.restitution, ..scene.rig };
    match softened(&rig, excitation, found, &contact) {
        Ok(soft) => Ok((Some(contact), soft)),
        Err(error) => {
            warnings.push(format!("No correction for the duration of the contact: {error}"));
            Ok((Some(contact), none))
        }
    }
}

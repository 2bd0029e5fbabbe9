//! All motions with one impact a period at one frequency, and those with several that are found: `vibro model
//! orbit`.

use super::{Driven, JudgedOrbit, SceneKeys, check_gap_std, figures, pattern};
use crate::analysis::answer::Answer;
use crate::campaign::above_zero;
use crate::error::Result;
use crate::model::{
    Compliance, EnergyBalance, EnergyPoint, Excitation, NoImpact, Orbit, Orbits, Rig, Softened, orbits_of,
    search, softened,
};
use crate::record::Finding;
use crate::report::files::Names;
use crate::report::layout::table;
use crate::report::{Cell, Table};
use serde::Serialize;
use serde_json::{Value, json};

/// Keys of `vibro model orbit`.
#[derive(Debug, Clone)]
#[cfg_attr(feature = "cli", derive(clap::Args))]
pub struct Keys {
    /// The scene.
    #[cfg_attr(feature = "cli", command(flatten))]
    pub scene: SceneKeys,
    /// Excitation frequency in Hz
    pub frequency: Option<f64>,
    /// Impacts in a period
    #[cfg_attr(feature = "cli", arg(default_value_t = 1))]
    pub impacts: u32,
    /// Excitation cycles in a period
    #[cfg_attr(feature = "cli", arg(default_value_t = 1))]
    pub cycles: u32,
    /// Standard uncertainty of the gap in m: a motion nearer to grazing is not robust
    pub gap_std: Option<f64>,
}

/// Number of impulses at which the energy of a period is drawn.
const ENERGY_POINTS: usize = 400;
/// Largest of them over the larger impulse of the motions.
const BEYOND: f64 = 1.3;

impl Keys {
    /// Names of the files in its answer.
    pub const FILES: Names = Names::Numbered(&["orbits", "verdicts", "impacts", "orbit", "energy"]);

    /// The motions, each with its verdicts and figure.
    ///
    /// # Errors
    /// If the scene or a key is impossible, or nothing drives the rig.
    pub fn answer(&self) -> Result<Answer> {
        above_zero("frequency", self.frequency)?;
        check_gap_std(self.gap_std)?;
        let driven = self.scene.driven(self.frequency)?;
        if self.impacts != 1 {
            return self.several(&driven);
        }
        let Driven { scene, excitation, findings } = &driven;
        let found = orbits_of(&scene.rig, excitation, self.cycles)?;
        let mut softening = Vec::new();
        let (contact, soft) = soften(&driven, &found, &mut softening)?;
        let both = found.orbits.iter().zip(&soft);
        let listed: Vec<SoftenedOrbit> = both
            .map(|(orbit, soft)| SoftenedOrbit { orbit: JudgedOrbit::of(orbit, self.gap_std), soft })
            .collect();
        let mut answer = Answer::of(&json!({
            "scene": scene,
            "orbits": listed,
            "no_impact": found.no_impact,
            "contact": contact,
        }))?;
        answer.add("", findings);
        answer.add("", softening);
        if found.orbits.is_empty() {
            answer.add("", [Finding::note("no-orbit")]);
        }
        for (i, orbit) in (1..).zip(&found.orbits).filter(|(_, orbit)| orbit.validity.exists) {
            let distance = orbit.validity.grazing_distance;
            if let Some(std) = self.gap_std.filter(|std| distance <= *std) {
                let near = Finding::caution("verdicts-near-grazing").count("motion", i);
                answer.add("", [near.number("distance", distance).number("std", std)]);
            }
            let title = format!("Motion {i}");
            answer.figure(format!("orbit_{i}"), figures::orbit(&title, &scene.rig, orbit));
        }
        self.energy(&driven, &found.orbits, &mut answer)?;
        answer.table("orbits", orbits(&found.orbits));
        answer.table("verdicts", verdicts(&found.orbits, self.gap_std));
        answer.tables.extend([no_impact(&found.no_impact), self::soft(&soft)]);
        Ok(answer)
    }

    /// Energy over the impulse under a sine force, as figure and table.
    fn energy(&self, driven: &Driven, found: &[Orbit], answer: &mut Answer) -> Result<()> {
        let Excitation::Sine(sine) = &driven.excitation else { return Ok(()) };
        // The larger impulse comes first.
        let Some(larger) = found.first().map(|o| o.impulse).filter(|j| *j > 0.0) else { return Ok(()) };
        let balance = EnergyBalance::new(&driven.scene.rig, sine, self.cycles)?;
        let curve = balance.curve(ENERGY_POINTS, BEYOND * larger);
        let real = found.iter().filter(|orbit| orbit.validity.exists);
        let motions: Vec<(&Orbit, EnergyPoint)> =
            real.filter_map(|orbit| Some((orbit, balance.at(orbit.impulse)?))).collect();
        answer.figure("energy", figures::energy("Energy of a period", &curve, &motions));
        let table = table(
            "Energy of a period",
            &curve,
            &[
                ("impulse", "N s", &|e| e.impulse.into()),
                ("supplied", "J", &|e| e.supplied.into()),
                ("lost", "J", &|e| e.lost.into()),
            ],
        );
        answer.csv("energy", &table);
        Ok(())
    }

    /// The motions with several impacts a period that are found.
    fn several(&self, driven: &Driven) -> Result<Answer> {
        let Driven { scene, excitation, findings } = driven;
        let found = search(&scene.rig, &pattern::sine(excitation)?, self.impacts, self.cycles)?;
        let mut answer = Answer::of(&json!({
            "scene": scene,
            "orbits": found.iter().map(|o| pattern::to_json(o, self.gap_std)).collect::<Vec<Value>>(),
            "no_impact": crate::model::no_impact(&scene.rig, excitation).ok(),
        }))?;
        answer.add("", findings);
        let searched = if found.is_empty() {
            let none = Finding::note("no-orbit-found");
            none.count("impacts", self.impacts as usize).count("cycles", self.cycles as usize)
        } else {
            Finding::note("orbits-perhaps-more")
        };
        answer.add("", [searched]);
        for (i, orbit) in (1..).zip(&found) {
            let distance = orbit.validity.grazing_distance;
            if let Some(std) = self.gap_std.filter(|std| distance <= *std) {
                let near = Finding::caution("verdicts-near-grazing").count("motion", i);
                answer.add("", [near.number("distance", distance).number("std", std)]);
            }
            answer.figure(format!("orbit_{i}"), figures::pattern(&format!("Motion {i}"), orbit));
        }
        answer.table("orbits", pattern::motions(&found, self.gap_std));
        answer.table("impacts", pattern::impacts(&found));
        Ok(answer)
    }
}

/// An orbit, with its correction for the duration of contacts.
#[derive(Serialize)]
struct SoftenedOrbit<'a> {
    #[serde(flatten)]
    orbit: JudgedOrbit<'a>,
    soft: &'a Option<Softened>,
}

/// The stated contact, and the correction of each orbit for it. If a stated contact allows no correction, a
/// finding says why.
fn soften(
    driven: &Driven,
    found: &Orbits,
    findings: &mut Vec<Finding>,
) -> Result<(Option<Compliance>, Vec<Option<Softened>>)> {
    let none = vec![None; found.orbits.len()];
    let Driven { scene, excitation, .. } = driven;
    let Some(keys) = scene.contact else { return Ok((None, none)) };
    let Some(stiffness) = keys.stiffness.filter(|_| keys.exponent.is_none_or(|n| n == 1.0)) else {
        findings.push(match keys.stiffness {
            Some(_) => Finding::caution("contact-curved"),
            None => Finding::caution("contact-stiffness-missing"),
        });
        return Ok((None, none));
    };
    let contact = Compliance::new(&scene.rig, stiffness, keys.damping)?;
    let of_rig = scene.rig.restitution;
    if (contact.restitution - of_rig).abs() > 1e-3 {
        let differs = Finding::caution("contact-restitution-differs");
        findings.push(differs.number("contact", contact.restitution).number("rig", of_rig));
    }
    let rig = Rig { restitution: contact.restitution, ..scene.rig };
    let soft = softened(&rig, excitation, found, &contact).unwrap_or_else(|error| {
        findings.push(Finding::caution("contact-not-corrected").name("why", error.to_string()));
        none
    });
    Ok((Some(contact), soft))
}

/// Quantities of each motion.
fn orbits(orbits: &[Orbit]) -> Table {
    let unit = orbits.first().map_or("rad", Orbit::timing_unit);
    table(
        "Motions with one impact a period",
        orbits.iter().enumerate(),
        &[
            ("no.", "", &|(i, _)| Cell::from(i + 1)),
            ("impulse", "N s", &|(_, o)| Cell::from(o.impulse)),
            ("approach speed", "m/s", &|(_, o)| Cell::from(o.approach_velocity)),
            ("timing", unit, &|(_, o)| Cell::from(o.timing)),
            ("x1 peak to peak", "m", &|(_, o)| Cell::from(o.peak_to_peak[0])),
            ("x2 peak to peak", "m", &|(_, o)| Cell::from(o.peak_to_peak[1])),
            ("x1 fundamental", "m", &|(_, o)| Cell::from(o.fundamental[0].norm())),
            ("x2 fundamental", "m", &|(_, o)| Cell::from(o.fundamental[1].norm())),
        ],
    )
    .note("Timing: of the impact, in rad after the crest of x1 without impacts, not of the force; or in s after the impulse or the onset of the pulse.")
}

/// Validity and stability of each motion; `gap_std` is the standard uncertainty of the gap in m.
fn verdicts(orbits: &[Orbit], gap_std: Option<f64>) -> Table {
    table(
        "Verdicts",
        orbits.iter().enumerate(),
        &[
            ("no.", "", &|(i, _)| Cell::from(i + 1)),
            ("exists", "", &|(_, o)| o.validity.exists.into()),
            ("admissible", "", &|(_, o)| o.validity.admissible.into()),
            ("stability", "", &|(_, o)| match o.validity.instability {
                Some(loss) => Cell::from(format!("{}: {}", o.validity.stability(), loss.name())),
                None if o.validity.exists => Cell::from(o.validity.stability()),
                None => Cell::Missing,
            }),
            ("robust", "", &|(_, o)| gap_std.map(|std| o.robust(std)).into()),
            ("largest multiplier", "", &|(_, o)| Cell::from(o.spectral_radius())),
            ("least gap", "m", &|(_, o)| Cell::from(o.validity.min_gap)),
            ("closest approach", "m", &|(_, o)| Cell::from(o.validity.clearance)),
            ("grazing distance, first order", "m", &|(_, o)| Cell::from(o.validity.grazing_distance)),
            ("energy rule", "", &|(_, o)| o.validity.energy_rule.into()),
        ],
    )
    .note("Admissible: the masses do not pass through each other. Robust: farther from grazing than the gap is uncertain.")
}

/// The motion without impacts.
fn no_impact(motion: &NoImpact) -> Table {
    Table::new("Motion without impacts")
        .column("possible", "")
        .column("amplitude", "m")
        .column("largest x1", "m")
        .row([motion.possible.into(), motion.amplitude.into(), motion.largest.into()])
}

/// Effect of the contact duration on each motion.
fn soft(all: &[Option<Softened>]) -> Table {
    table(
        "Corrected for the contact duration",
        all.iter().enumerate().filter_map(|(i, soft)| soft.map(|s| (i, s))),
        &[
            ("no.", "", &|(i, _)| Cell::from(i + 1)),
            ("impulse", "N s", &|(_, s)| Cell::from(s.impulse)),
            ("approach speed", "m/s", &|(_, s)| Cell::from(s.approach_velocity)),
            ("change of impulse", "1", &|(_, s)| Cell::from(s.change)),
            ("in contact", "1", &|(_, s)| Cell::from(s.share)),
            ("x1 peak to peak", "m", &|(_, s)| Cell::from(s.peak_to_peak[0])),
            ("x2 peak to peak", "m", &|(_, s)| Cell::from(s.peak_to_peak[1])),
        ],
    )
}

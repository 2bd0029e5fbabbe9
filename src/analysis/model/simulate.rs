//! Simulation of a motion from impact to impact: `vibro model simulate`.

use super::contact::{self, Contact};
use super::{Driven, SceneKeys, figures};
use crate::analysis::answer::Answer;
use crate::error::{Error, Result};
use crate::model::portrait::{Portrait, PortraitOptions};
use crate::model::{HertzRebound, Law, Motion, Regime, Rig, Scene, Simulation, State};
use crate::record::Finding;
use crate::report::Table;
use crate::report::files::Names;
use crate::report::layout::table;
use crate::units::notation::counted;
use serde_json::json;

/// Keys of `vibro model simulate`.
#[derive(Debug, Clone)]
#[cfg_attr(feature = "cli", derive(clap::Args))]
pub struct Keys {
    /// The scene.
    #[cfg_attr(feature = "cli", command(flatten))]
    pub scene: SceneKeys,
    /// Excitation frequency in Hz
    pub frequency: Option<f64>,
    /// The contact law.
    #[cfg_attr(feature = "cli", arg(help = contact::help(), value_name = "LAW", value_parser = Contact::named, default_value = "restitution"))]
    pub model: Contact,
    /// Excitation cycles analysed
    #[cfg_attr(feature = "cli", arg(default_value_t = 100))]
    pub cycles: u32,
    /// Cycles discarded before, while transients decay
    #[cfg_attr(feature = "cli", arg(default_value_t = 500))]
    pub settle: u32,
    /// Displacements in m and velocities in m/s at the start [default: at rest]
    #[cfg_attr(
        feature = "cli",
        arg(long, value_name = "X1,V1,X2,V2", value_delimiter = ',', allow_hyphen_values = true)
    )]
    pub initial: Vec<f64>,
    /// Phase of the excitation's cycle at the start, in rad: 0 is the crest of a sine and the beginning of a
    /// pulse
    #[cfg_attr(feature = "cli", arg(default_value_t = 0.0))]
    pub phase: f64,
    /// Approach speed in m/s below which an impact counts as grazing
    #[cfg_attr(feature = "cli", arg(default_value_t = crate::model::simulate::GRAZING_SPEED))]
    pub grazing: f64,
}

/// Excitation cycles in the plotted traces.
const SHOWN_CYCLES: u32 = 12;
/// Samples of the traces per cycle.
const SAMPLES_PER_CYCLE: u32 = 400;

/// A motion over the analysed cycles.
struct ObservedMotion {
    portrait: Portrait,
    /// Time in s, phase in rad and state at the end.
    end: (f64, f64, State),
    /// Number of grazing impacts; `None` where the contact model does not count them.
    grazing: Option<u64>,
    /// Number of flights in closed form, transients included; `None` where the contact model has none.
    flights: Option<u64>,
}

impl Keys {
    /// Names of the files of the answer.
    pub const FILES: Names = Names::Numbered(&["traces", "phase_plane", "poincare", "reaction", "impacts"]);

    /// The motion with its impacts and its regime.
    ///
    /// # Errors
    /// If the scene or a key is invalid, the scene has no excitation, or the simulation fails.
    pub fn answer(&self) -> Result<Answer> {
        let Driven { scene, excitation, findings } = self.scene.driven(self.frequency)?;
        let start = self.start(&scene.rig)?;
        let make = contact::motions(&scene, self.model, self.grazing)?;
        let observed = self.observed(&mut *make(&excitation, start, self.phase)?)?;
        let ObservedMotion { portrait, end: (time, phase, state), grazing, flights } = &observed;
        let rebound = self.rebound(&scene, portrait);
        let State { x1, v1, x2, v2 } = state;
        let mut answer = Answer::of(&json!({
            "scene": scene,
            "impacts": portrait.impacts,
            "regime": portrait.pattern.regime,
            "reaction": portrait.reaction,
            "rebound": rebound,
            "grazing": grazing,
            "chatter": portrait.sticks,
            "final_state": { "time": time, "phase": phase, "x1": x1, "v1": v1, "x2": x2, "v2": v2 },
            "flights": flights,
        }))?;
        answer.add("", findings);
        answer.add("", contact::buffer(&scene, self.model));
        answer.add("", self.doubts(&observed, &scene.rig));
        answer.add("", unusual(&scene, rebound.as_ref()));
        answer.tables.push(summary(&observed));
        answer.tables.extend(rebound.as_ref().map(rebounding));
        answer.figure("traces", figures::traces("Traces of both masses", portrait, scene.rig.gap));
        answer.figure("phase_plane", figures::phase_plane("Phase plane", portrait));
        answer.figure("poincare", figures::poincare("Poincaré sections", portrait));
        answer.figure("reaction", figures::reaction("Force between the masses", portrait));
        answer.csv("traces", &states(&portrait.time, &portrait.states));
        answer.csv("poincare", &states(&portrait.beginnings, &portrait.section));
        answer.csv("impacts", &impacts(portrait));
        Ok(answer)
    }

    /// Free rebound of a Hertz contact at the largest approach speed; `None` for other laws and without
    /// impacts.
    fn rebound(&self, scene: &Scene, portrait: &Portrait) -> Option<HertzRebound> {
        let contact = scene.contact.filter(|_| self.model == Contact::Law(Law::hertz(1.0).form))?;
        let fastest = portrait.impacts.iter().map(|i| i.approach_velocity).max_by(f64::total_cmp)?;
        let (mass, radius) = (scene.rig.reduced_mass(), contact.relative_radius());
        Some(HertzRebound::new(contact.stiffness?, mass, fastest, radius))
    }

    /// The state at the start.
    fn start(&self, rig: &Rig) -> Result<State> {
        match self.initial[..] {
            [] => Ok(Simulation::at_rest(rig)),
            [x1, v1, x2, v2] => Ok(State { x1, v1, x2, v2 }),
            _ => {
                let found = format!("{} numbers of a state", self.initial.len());
                Err(Error::usage(found, "four: x1,v1,x2,v2 in m and m/s").setting("initial"))
            }
        }
    }

    /// Lets the transients decay for `settle` cycles, then records the motion.
    fn observed(&self, motion: &mut dyn Motion) -> Result<ObservedMotion> {
        let end = motion.time() + f64::from(self.settle) / motion.frequency();
        motion.advance(end, &mut |_| {})?;
        let before = motion.counted().map(|counts| counts.grazing);
        let options =
            PortraitOptions { cycles: self.cycles, samples: SAMPLES_PER_CYCLE, shown: SHOWN_CYCLES };
        let portrait = Portrait::take(motion, &options)?;
        let (end, counts) = ((motion.time(), motion.phase(), motion.state()), motion.counted());
        let grazing = counts.zip(before).map(|(counts, before)| counts.grazing - before);
        Ok(ObservedMotion { portrait, end, grazing, flights: counts.map(|counts| counts.flights) })
    }

    /// Findings that limit the result: grazing, irregular or unsettled motion, losses that are left out.
    fn doubts(&self, observed: &ObservedMotion, rig: &Rig) -> Vec<Finding> {
        let mut found = Vec::new();
        let pattern = &observed.portrait.pattern;
        if let Some(grazing) = observed.grazing.filter(|n| *n > 0) {
            let some = Finding::caution("impacts-grazing").number("n", grazing as f64);
            found.push(some.count("all", observed.portrait.impacts.len()).number("below", self.grazing));
        }
        if pattern.regime == Regime::Irregular {
            found.push(Finding::caution("motion-irregular"));
        } else if !pattern.settled {
            let moving = Finding::caution("motion-not-settled");
            found.push(match pattern.distance {
                Some(distance) => moving.number("distance", distance),
                None => moving,
            });
        }
        if self.model.is_lossless() && rig.restitution < 1.0 {
            found.push(Finding::caution("hertz-lossless").number("restitution", rig.restitution));
        }
        let State { x1, x2, .. } = observed.end.2;
        // A gap below a millionth of the displacements counts as closed.
        if pattern.regime == Regime::NoImpact && rig.gap + x2 - x1 <= 1e-6 * (x1.abs() + x2.abs()) {
            found.push(Finding::caution("masses-pressed"));
        }
        found
    }
}

/// The regime and the last impact, in one row.
fn summary(observed: &ObservedMotion) -> Table {
    let Portrait { impacts, pattern, sticks, reaction, .. } = &observed.portrait;
    let regime = match pattern.regime {
        Regime::Periodic { impacts, cycles } => {
            format!("{} in {}", counted(impacts as usize, "impact"), counted(cycles as usize, "cycle"))
        }
        other => other.to_string(),
    };
    let last = impacts.last();
    table(
        "Motion",
        [()],
        &[
            ("regime", "", &|()| regime.as_str().into()),
            ("impacts", "", &|()| impacts.len().into()),
            ("grazing", "", &|()| observed.grazing.map(|n| n as f64).into()),
            ("chatter", "", &|()| (*sticks as f64).into()),
            ("last impulse", "N s", &|()| last.map(|i| i.impulse).into()),
            ("approach speed", "m/s", &|()| last.map(|i| i.approach_velocity).into()),
            ("phase", "rad", &|()| last.map(|i| i.phase).into()),
            ("peak force", "N", &|()| reaction.peak.into()),
            ("RMS force", "N", &|()| reaction.rms.into()),
            ("impulse a cycle", "N s", &|()| reaction.impulse.into()),
        ],
    )
    .note("Phase: of the excitation at the last impact, after the crest of a sine force, the impulse or the onset of the pulse.")
}

/// Largest pressure over E* that metals bear: see [`HertzRebound::strain`].
const BORNE: f64 = 0.03;
/// Largest radius in m, and smallest Young's modulus in Pa, of bodies that strike each other: those beyond
/// are more likely stated in mm or in 10⁹ Pa.
const USUAL: (f64, f64) = (1.0, 1e6);

/// Cautions where the bodies of a Hertz contact yield, or a radius or a modulus looks as if it had another
/// unit.
fn unusual(scene: &Scene, rebound: Option<&HertzRebound>) -> Vec<Finding> {
    let Some(contact) = scene.contact else { return Vec::new() };
    let radius = contact.radius.into_iter().flatten().filter(|r| r.is_finite() && *r > USUAL.0);
    let odd = radius.map(|r| Finding::caution("hertz-radius").number("radius", r));
    let modulus = contact.modulus.into_iter().flatten().filter(|e| *e < USUAL.1);
    let odd = odd.chain(modulus.map(|e| Finding::caution("hertz-modulus").number("modulus", e)));
    let yields = rebound.and_then(|rebound| {
        let strain = rebound.strain().filter(|strain| *strain > BORNE)?;
        let found = Finding::caution("hertz-yields").number("pressure", rebound.pressure?);
        Some(found.number("part", strain).number("speed", rebound.speed))
    });
    odd.chain(yields).collect()
}

/// Stiffness, duration, largest force and pressure of a Hertz contact.
fn rebounding(rebound: &HertzRebound) -> Table {
    table(
        "Hertz contact",
        [rebound],
        &[
            ("stiffness", "N/m^1.5", &|r| r.stiffness.into()),
            ("reduced mass", "kg", &|r| r.mass.into()),
            ("approach speed", "m/s", &|r| r.speed.into()),
            ("largest indentation", "m", &|r| r.indentation.into()),
            ("largest force", "N", &|r| r.force.into()),
            ("duration", "s", &|r| r.duration.into()),
            ("largest pressure", "Pa", &|r| r.pressure.into()),
        ],
    )
    .note("Closed form of the fastest impact, without the forces of springs and excitation.")
}

/// Times and states, one row for each time.
fn states(times: &[f64], states: &[State]) -> Table {
    table(
        "States",
        times.iter().zip(states),
        &[
            ("time", "s", &|(t, _)| (**t).into()),
            ("x1", "m", &|(_, s)| s.x1.into()),
            ("v1", "m/s", &|(_, s)| s.v1.into()),
            ("x2", "m", &|(_, s)| s.x2.into()),
            ("v2", "m/s", &|(_, s)| s.v2.into()),
        ],
    )
}

/// Every impact, one row each.
fn impacts(portrait: &Portrait) -> Table {
    table(
        "Impacts",
        &portrait.impacts,
        &[
            ("time", "s", &|i| i.time.into()),
            ("phase", "rad", &|i| i.phase.into()),
            ("approach speed", "m/s", &|i| i.approach_velocity.into()),
            ("impulse", "N s", &|i| i.impulse.into()),
        ],
    )
}

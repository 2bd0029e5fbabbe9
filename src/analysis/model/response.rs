//! Motions with one impact a period over frequency: `vibro model response`.

mod bands;
mod draws;

pub use bands::{Band, BandPoint, Bands};
pub use draws::Draws;

use super::{Driven, JudgedOrbit, SceneKeys, check_gap_std, figures};
use crate::analysis::answer::{Answer, unwritten};
use crate::analysis::progress::Progress;
use crate::analysis::study;
use crate::campaign::above_zero;
use crate::error::Result;
use crate::model::{Excitation, Response, ResponsePoint, Rig, Uncertainty, response};
use crate::record::Finding;
use crate::report::files::Names;
use crate::report::layout::table;
use crate::report::{Cell, Table};
use num_complex::Complex64;
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};

/// Keys of `vibro model response`.
#[derive(Debug, Clone)]
#[cfg_attr(feature = "cli", derive(clap::Args))]
pub struct Keys {
    /// Rig and excitation.
    #[cfg_attr(feature = "cli", command(flatten))]
    pub scene: SceneKeys,
    /// Lowest excitation frequency in Hz
    pub from: f64,
    /// Highest excitation frequency in Hz
    pub to: f64,
    /// Number of frequencies
    #[cfg_attr(feature = "cli", arg(default_value_t = 400))]
    pub points: usize,
    /// Excitation cycles from impact to impact
    #[cfg_attr(feature = "cli", arg(default_value_t = 1))]
    pub cycles: u32,
    /// Standard uncertainty of the gap in m: a motion nearer to grazing is not robust
    pub gap_std: Option<f64>,
    /// Draw the parameters N times from [uncertainty] in the rig's file: bands that hold 95 % of the draws
    #[cfg_attr(feature = "cli", arg(value_name = "N", value_parser = crate::record::kind::whole::<u64, 100, 1_000_000>))]
    pub monte_carlo: Option<u64>,
}

impl Keys {
    /// Names of the files in its answer.
    pub const FILES: Names = Names::Numbered(&["response", "changes", "bands"]);

    /// The motions at each frequency, with the places where they appear, vanish and change; with bands if the
    /// parameters are drawn.
    ///
    /// # Errors
    /// If the scene or a key is impossible, or nothing drives the rig.
    pub fn answer(&self, progress: &dyn Progress) -> Result<Answer> {
        match self.study()? {
            Some(draws) => study::whole(&draws, progress),
            None => self.curve()?.answer(None),
        }
    }

    /// The Monte Carlo of the response; `None` if none is asked for.
    ///
    /// # Errors
    /// As [`Keys::answer`]; if no uncertainty is stated, or the number of draws is too small or too large.
    pub fn study(&self) -> Result<Option<Draws>> {
        self.monte_carlo.map(|draws| Draws::of(self.curve()?, draws)).transpose()
    }

    fn curve(&self) -> Result<Curve> {
        above_zero("from", Some(self.from))?;
        above_zero("to", Some(self.to))?;
        check_gap_std(self.gap_std)?;
        let Driven { scene, excitation, findings } = self.scene.driven(Some(self.from))?;
        let &Keys { from, to, points, cycles, gap_std, .. } = self;
        let (rig, uncertainty) = (scene.rig, scene.uncertainty);
        let scene = serde_json::to_value(scene).map_err(unwritten)?;
        Ok(Curve { scene, rig, excitation, uncertainty, from, to, points, cycles, gap_std, findings })
    }
}

/// Rig, excitation and frequencies of a response.
#[derive(Debug, Clone, Serialize, Deserialize)]
struct Curve {
    /// The scene, as answers state it.
    scene: Value,
    rig: Rig,
    excitation: Excitation,
    uncertainty: Option<Uncertainty>,
    from: f64,
    to: f64,
    points: usize,
    cycles: u32,
    gap_std: Option<f64>,
    findings: Vec<Finding>,
}

impl Curve {
    /// The response with the estimates of all parameters, and `bands` of drawn ones.
    fn answer(&self, bands: Option<&Bands>) -> Result<Answer> {
        let Curve { rig, excitation, from, to, points, cycles, .. } = self;
        let found = response(rig, excitation, *from, *to, *points, *cycles)?;
        let mut answer = Answer::of(&json!({
            "scene": self.scene,
            "points": found.points.iter().map(|p| self.point(p)).collect::<Vec<Value>>(),
            "changes": found.changes,
        }))?;
        answer.add("", &self.findings);
        let refused = found.points.iter().filter_map(|p| p.refused.as_deref());
        if let Some(why) = refused.clone().next() {
            let some = Finding::caution("frequencies-without-answer").count("n", refused.count());
            answer.add("", [some.name("why", why.trim_end_matches('.'))]);
        }
        let has_stable = |p: &&ResponsePoint| {
            p.orbits.iter().any(|o| o.validity.admissible && o.validity.stable == Some(true))
        };
        let stable =
            Finding::note("orbits-stable").count("n", found.points.iter().filter(has_stable).count());
        answer.add("", [stable.count("all", found.points.len())]);
        answer.figure("response", figures::branches("Response with one impact a period", &found, bands));
        answer.csv("response", &branches(&found));
        answer.table("changes", changes(&found));
        if let Some(bands) = bands {
            bands.add_to(&mut answer)?;
        }
        Ok(answer)
    }

    /// A point as JSON.
    fn point(&self, point: &ResponsePoint) -> Value {
        json!({
            "frequency": point.frequency,
            "orbits": point.orbits.iter().map(|o| JudgedOrbit::of(o, self.gap_std)).collect::<Vec<_>>(),
            "no_impact": point.no_impact,
            "backbone": point.backbone.as_ref().map(|o| json!({
                "impulse": o.impulse,
                "peak_to_peak": o.peak_to_peak,
                "fundamental": o.fundamental.map(Complex64::norm),
                "admissible": o.validity.admissible,
            })),
            "refused": point.refused,
        })
    }
}

/// One row for each frequency and motion that exists; solutions that are no motion are left out.
fn branches(response: &Response) -> Table {
    let rows = response.points.iter().flat_map(|p| p.orbits.iter().filter(|o| o.validity.exists));
    table(
        "Motions with one impact a period",
        rows,
        &[
            ("frequency", "Hz", &|o| Cell::from(o.frequency)),
            ("impulse", "N s", &|o| Cell::from(o.impulse)),
            ("approach speed", "m/s", &|o| Cell::from(o.approach_velocity)),
            ("x1 peak to peak", "m", &|o| Cell::from(o.peak_to_peak[0])),
            ("x2 peak to peak", "m", &|o| Cell::from(o.peak_to_peak[1])),
            ("x1 fundamental", "m", &|o| Cell::from(o.fundamental[0].norm())),
            ("x2 fundamental", "m", &|o| Cell::from(o.fundamental[1].norm())),
            ("admissible", "", &|o| o.validity.admissible.into()),
            ("stability", "", &|o| Cell::from(o.validity.stability())),
            ("largest multiplier", "", &|o| Cell::from(o.spectral_radius())),
            ("least gap", "m", &|o| Cell::from(o.validity.min_gap)),
            ("grazing distance, first order", "m", &|o| Cell::from(o.validity.grazing_distance)),
        ],
    )
}

/// Places where motions appear, vanish or change.
fn changes(response: &Response) -> Table {
    table(
        "Changes",
        &response.changes,
        &[
            ("frequency", "Hz", &|c| Cell::from(c.frequency)),
            ("change", "", &|c| Cell::from(c.kind.name())),
            ("x1 amplitude", "m", &|c| Cell::from(c.amplitude[0])),
            ("x2 amplitude", "m", &|c| Cell::from(c.amplitude[1])),
        ],
    )
}

//! One mass on a curved spring: `vibro model backbone`.

use super::{Driven, SceneKeys, figures};
use crate::analysis::answer::Answer;
use crate::error::{Error, Result};
use crate::model::{CurvePoint, CurvedResponse, Duffing, Excitation};
use crate::record::Finding;
use crate::report::files::Names;
use crate::report::layout::{Shown, table};
use crate::report::{Cell, Table};
use serde_json::json;

/// Keys of `vibro model backbone`.
#[derive(Debug, Clone)]
#[cfg_attr(feature = "cli", derive(clap::Args))]
pub struct Keys {
    /// The scene.
    #[cfg_attr(feature = "cli", command(flatten))]
    pub scene: SceneKeys,
    /// Mass that is driven, alone on its spring: 1 or 2
    #[cfg_attr(feature = "cli", arg(default_value_t = 1, value_parser = crate::record::kind::whole::<u8, 1, 2>))]
    pub mass: u8,
    /// Lowest excitation frequency in Hz
    pub from: f64,
    /// Highest excitation frequency in Hz
    pub to: f64,
    /// Number of frequencies
    #[cfg_attr(feature = "cli", arg(default_value_t = 400))]
    pub points: usize,
    /// Relative error of an amplitude by harmonic balance that does not matter
    #[cfg_attr(feature = "cli", arg(default_value_t = 0.02))]
    pub tolerance: f64,
}

/// Most frequencies whose exact motions are drawn, and whose motions are listed.
const SHOWN: usize = 30;

impl Keys {
    /// Names of the files in its answer.
    pub const FILES: Names = Names::Numbered(&["backbone", "response", "jumps"]);

    /// Response and backbone by harmonic balance, beside exact motions.
    ///
    /// # Errors
    /// If the scene or a key is impossible, the excitation is no sine, the spring is straight, or all motions
    /// are outside its domain.
    pub fn answer(&self) -> Result<Answer> {
        if !(1..=2).contains(&self.mass) {
            return Err(Error::usage(format!("mass {}", self.mass), "1 or 2").setting("mass"));
        }
        if !(self.tolerance > 0.0 && self.tolerance <= 1.0) {
            let found = format!("a tolerance of {}", self.tolerance);
            return Err(Error::usage(found, "a part above 0, up to 1").setting("tolerance"));
        }
        let Driven { scene, excitation, findings } = self.scene.driven_with_springs(Some(self.from))?;
        let Excitation::Sine(sine) = excitation else {
            let found = format!("the excitation {:?}", excitation.kind());
            return Err(Error::usage(found, "a sine: harmonic balance takes no other").setting("force"));
        };
        let duffing = Duffing::new(&scene, self.mass.into())?;
        let found = duffing.response(sine.force, self.from, self.to, self.points)?;
        let limit = Some(duffing.limit()).filter(|limit| limit.is_finite());
        let mut answer = Answer::of(&json!({
            "scene": scene, "mass": self.mass, "natural_frequency": duffing.natural_frequency(), "limit": limit,
            "points": found.points, "jumps": found.jumps, "backbone": found.backbone,
        }))?;
        answer.add("", findings);
        answer.add("", self.findings(&found, limit));
        let columns: Vec<&[CurvePoint]> = found.points.chunk_by(|a, b| a.frequency == b.frequency).collect();
        let shown = columns.iter().step_by(columns.len().div_ceil(SHOWN));
        let shown: Vec<&CurvePoint> = shown.copied().flatten().collect();
        let step = (self.to - self.from) / (self.points - 1) as f64;
        let figure = figures::backbone("Response and backbone", &found, &columns, &shown, step);
        answer.figure("backbone", figure);
        let heads: [Shown<&CurvePoint>; 7] = [
            ("frequency", "Hz", &|p| p.frequency.into()),
            ("amplitude, harmonic balance", "m", &|p| p.amplitude.into()),
            ("exact amplitude", "m", &|p| p.exact.map(|e| e.amplitude).into()),
            ("difference", "%", &|p| p.error().map(|e| 100.0 * e).into()),
            ("lag", "rad", &|p| p.lag.into()),
            ("stable", "", &|p| p.stable.into()),
            ("largest multiplier", "", &|p| p.exact.map(|e| e.spectral_radius).into()),
        ];
        answer.csv("response", &table("Response", &found.points, &heads));
        answer.tables.push(table("Response", shown, &heads));
        answer.table("backbone", backbone(&found));
        answer.table("jumps", jumps(&found));
        Ok(answer)
    }

    /// Findings on the domain of the spring and the error of harmonic balance.
    fn findings(&self, found: &CurvedResponse, limit: Option<f64>) -> Vec<Finding> {
        let all = found.points.len();
        let mut findings = Vec::new();
        if let Some(limit) = limit.filter(|_| found.beyond > 0) {
            let beyond = Finding::caution("backbone-beyond-force").count("n", found.beyond);
            findings.push(beyond.number("limit", limit));
        }
        let errors = || found.points.iter().filter_map(|p| Some((p.error()?, p.frequency)));
        let missing = all - errors().count();
        if missing > 0 {
            findings.push(Finding::caution("backbone-not-exact").count("n", missing).count("all", all));
        }
        if let Some((error, frequency)) = errors().max_by(|a, b| a.0.abs().total_cmp(&b.0.abs())) {
            let beyond = errors().filter(|(error, _)| error.abs() > self.tolerance).count();
            let found = match beyond {
                0 => Finding::note("balance-holds"),
                n => Finding::caution("balance-differs").count("n", n).count("all", all),
            };
            findings.push(found.number("error", error.abs()).number("frequency", frequency));
        }
        findings
    }
}

/// Free motion without damper.
fn backbone(found: &CurvedResponse) -> Table {
    table(
        "Backbone",
        &found.backbone,
        &[
            ("amplitude", "m", &|row| row[0].into()),
            ("frequency, harmonic balance", "Hz", &|row| row[1].into()),
            ("exact frequency", "Hz", &|row| row[2].into()),
            ("difference", "%", &|row| (100.0 * (row[1] / row[2] - 1.0)).into()),
        ],
    )
}

/// Jumps of the amplitude.
fn jumps(found: &CurvedResponse) -> Table {
    table(
        "Jumps, by harmonic balance",
        &found.jumps,
        &[
            ("frequency", "Hz", &|j| j.frequency.into()),
            ("direction", "", &|j| Cell::from(if j.rising { "up" } else { "down" })),
            ("amplitude before", "m", &|j| j.amplitude[0].into()),
            ("after", "m", &|j| j.amplitude[1].into()),
        ],
    )
}

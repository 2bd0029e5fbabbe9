//! Branches of periodic motions, followed over a parameter through folds, flips and grazing: `vibro model
//! continue`.

use super::{Driven, SceneKeys, figures, pattern};
use crate::analysis::answer::Answer;
use crate::error::{Error, Result};
use crate::model::continuation::check_range;
use crate::model::{Branch, Parameter, PeriodicOrbit, Rig, Sine, follow, orbits, search};
use crate::record::Finding;
use crate::report::files::Names;
use crate::report::layout::table;
use crate::report::{Cell, Table};
use crate::units::notation::counted;
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};

/// Keys of `vibro model continue`.
#[derive(Debug, Clone)]
#[cfg_attr(feature = "cli", derive(clap::Args))]
pub struct Keys {
    /// The scene.
    #[cfg_attr(feature = "cli", command(flatten))]
    pub scene: SceneKeys,
    /// What is varied: frequency, force, gap, restitution
    #[cfg_attr(feature = "cli", arg(value_name = "WHAT", value_parser = crate::campaign::word::<BranchParameter>, default_value = "frequency"))]
    pub over: BranchParameter,
    /// Lower end, in Hz, N, m or 1
    pub from: f64,
    /// Upper end, in the same unit
    pub to: f64,
    /// Excitation frequency in Hz; over the frequency, where the search for motions starts [default: the
    /// middle]
    pub frequency: Option<f64>,
    /// Impacts in a period
    #[cfg_attr(feature = "cli", arg(default_value_t = 1))]
    pub impacts: u32,
    /// Excitation cycles in a period
    #[cfg_attr(feature = "cli", arg(default_value_t = 1))]
    pub cycles: u32,
    /// Longest step along a branch, in rad of the impacts' phases
    #[cfg_attr(feature = "cli", arg(default_value_t = 0.05))]
    pub step: f64,
}

/// Parameter over which branches are followed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum BranchParameter {
    /// The excitation frequency.
    Frequency,
    /// The amplitude of the force.
    Force,
    /// The gap at rest.
    Gap,
    /// The restitution.
    Restitution,
}

impl From<BranchParameter> for Parameter {
    fn from(over: BranchParameter) -> Parameter {
        match over {
            BranchParameter::Frequency => Parameter::Frequency,
            BranchParameter::Force => Parameter::Force,
            BranchParameter::Gap => Parameter::Gap,
            BranchParameter::Restitution => Parameter::Restitution,
        }
    }
}

impl Keys {
    /// Names of the files in its answer.
    pub const FILES: Names = Names::Numbered(&["branches", "marks", "points"]);

    /// The branches, with their marks and ends.
    ///
    /// # Errors
    /// If the scene or a key is impossible, nothing drives the rig, or no motion is found to start from.
    pub fn answer(&self) -> Result<Answer> {
        let over = Parameter::from(self.over);
        // Checks the ends first, since the start is the middle between them.
        check_range(over, self.from, self.to, self.from)?;
        let middle =
            Some(f64::midpoint(self.from, self.to)).filter(|_| self.over == BranchParameter::Frequency);
        let Driven { scene, excitation, findings } = self.scene.driven(self.frequency.or(middle))?;
        let (rig, sine) = (scene.rig, pattern::sine(&excitation)?);
        check_range(over, self.from, self.to, over.of(&rig, &sine))?;
        let one = ones(&rig, &sine)?;
        let wanted = match (self.impacts, self.cycles) {
            (1, 1) => one.clone(),
            _ => search(&rig, &sine, self.impacts, self.cycles)?,
        };
        if wanted.is_empty() {
            return Err(self.none_at(over.of(&rig, &sine)));
        }
        let branches = self.branches(&wanted)?;
        let beside = if (self.impacts, self.cycles) == (1, 1) { Vec::new() } else { self.branches(&one)? };
        let mut answer = Answer::of(&json!({
            "scene": scene,
            "over": over,
            "branches": branches.iter().map(|b| to_json(over, b)).collect::<Vec<Value>>(),
            "one_impact": beside.iter().map(|b| to_json(over, b)).collect::<Vec<Value>>(),
        }))?;
        answer.add("", findings);
        if self.impacts > 1 || self.cycles > 1 {
            answer.add("", [Finding::note("orbits-perhaps-more")]);
        }
        answer.table("branches", summary(over, &branches));
        answer.table("marks", marks(over, &branches));
        answer.csv("points", &points(over, &branches));
        answer.figure("branches", figures::continued(over, &branches, &beside));
        Ok(answer)
    }

    /// The error that there is no motion to start from at this value.
    fn none_at(&self, value: f64) -> Error {
        let over = Parameter::from(self.over);
        let found = format!(
            "no motion with {} in {} at {} {value} {}",
            counted(self.impacts as usize, "impact"),
            counted(self.cycles as usize, "cycle"),
            over.name(),
            if over.unit() == "1" { "" } else { over.unit() }
        );
        let (where_from, setting) = match self.over {
            BranchParameter::Frequency => ("start at another frequency", "frequency"),
            BranchParameter::Force => ("start at another force", "force"),
            BranchParameter::Gap | BranchParameter::Restitution => ("start at another value", "set"),
        };
        let shown = match (self.impacts, self.cycles) {
            (1, 1) => "`vibro model response` shows where there are motions",
            _ => "`vibro model map` shows where this pattern settles",
        };
        Error::refused(found.trim_end()).hint(format!("{where_from}; {shown}")).setting(setting)
    }

    /// The branches through these motions, each once.
    fn branches(&self, starts: &[PeriodicOrbit]) -> Result<Vec<Branch>> {
        let over = Parameter::from(self.over);
        let mut found: Vec<Branch> = Vec::new();
        for start in starts {
            let passed = |branch: &Branch| {
                let value = over.of(&start.rig, &start.sine);
                branch.points.windows(2).any(|pair| {
                    let [a, b] = [0, 1].map(|i| over.of(&pair[i].rig, &pair[i].sine) - value);
                    let nearer = &pair[usize::from(a.abs() > b.abs())];
                    let guess: Vec<_> = nearer.beats.iter().map(|b| (b.phase, b.impulse)).collect();
                    a * b <= 0.0
                        && PeriodicOrbit::near(&start.rig, &start.sine, start.cycles, &guess)
                            .is_ok_and(|there| there.is(start))
                })
            };
            if !found.iter().any(passed) {
                found.push(follow(start, over, self.from, self.to, self.step)?);
            }
        }
        Ok(found)
    }
}

/// All motions with one impact a cycle.
fn ones(rig: &Rig, sine: &Sine) -> Result<Vec<PeriodicOrbit>> {
    let closed = orbits(rig, sine.force, sine.frequency)?.orbits;
    let real = closed.iter().filter(|o| o.validity.exists);
    Ok(real.filter_map(|o| PeriodicOrbit::near(rig, sine, 1, &[(o.force_phase, o.impulse)]).ok()).collect())
}

/// A point of a branch, with the value of the varied parameter.
#[derive(Serialize)]
struct BranchPoint {
    #[serde(flatten)]
    orbit: Value,
    value: f64,
}

/// A branch as JSON.
fn to_json(over: Parameter, branch: &Branch) -> Value {
    let point = |orbit: &PeriodicOrbit| BranchPoint {
        orbit: pattern::to_json(orbit, None),
        value: over.of(&orbit.rig, &orbit.sine),
    };
    let mark = |m: &crate::model::continuation::Mark| json!({ "kind": m.kind, "after": m.after, "orbit": point(&m.orbit) });
    json!({
        "points": branch.points.iter().map(point).collect::<Vec<BranchPoint>>(),
        "marks": branch.marks.iter().map(mark).collect::<Vec<Value>>(),
        "ends": branch.ends,
    })
}

/// Range and ends of each branch.
fn summary(over: Parameter, branches: &[Branch]) -> Table {
    let value = |o: &PeriodicOrbit| over.of(&o.rig, &o.sine);
    let end = |b: &Branch, i: usize| json!(b.ends[i]).as_str().unwrap_or_default().to_owned();
    table(
        "Branches",
        branches.iter().enumerate(),
        &[
            ("no.", "", &|(i, _)| Cell::from(i + 1)),
            ("points", "", &|(_, b)| b.points.len().into()),
            ("lowest", over.unit(), &|(_, b)| {
                b.points.iter().map(value).fold(f64::INFINITY, f64::min).into()
            }),
            ("highest", over.unit(), &|(_, b)| {
                b.points.iter().map(value).fold(f64::NEG_INFINITY, f64::max).into()
            }),
            ("real points", "", &|(_, b)| b.points.iter().filter(|o| o.validity.real()).count().into()),
            ("begins at", "", &|(_, b)| Cell::from(end(b, 0))),
            ("ends at", "", &|(_, b)| Cell::from(end(b, 1))),
        ],
    )
    .note("Real: admissible and stable.")
}

/// Folds, flips and other changes along the branches.
fn marks(over: Parameter, branches: &[Branch]) -> Table {
    table(
        "Changes along the branches",
        branches.iter().enumerate().flat_map(|(i, b)| b.marks.iter().map(move |m| (i, m))),
        &[
            ("no.", "", &|(i, _)| Cell::from(i + 1)),
            ("change", "", &|(_, m)| Cell::from(m.kind.name())),
            (over.name(), over.unit(), &|(_, m)| over.of(&m.orbit.rig, &m.orbit.sine).into()),
            ("x1 amplitude", "m", &|(_, m)| (m.orbit.peak_to_peak[0] / 2.0).into()),
            ("x2 amplitude", "m", &|(_, m)| (m.orbit.peak_to_peak[1] / 2.0).into()),
        ],
    )
}

/// Every point of every branch.
fn points(over: Parameter, branches: &[Branch]) -> Table {
    table(
        "Points of the branches",
        branches.iter().enumerate().flat_map(|(i, b)| b.points.iter().map(move |o| (i, o))),
        &[
            ("branch", "", &|(i, _)| Cell::from(i + 1)),
            (over.name(), over.unit(), &|(_, o)| over.of(&o.rig, &o.sine).into()),
            ("impulse a period", "N s", &|(_, o)| o.beats.iter().map(|b| b.impulse).sum::<f64>().into()),
            ("x1 peak to peak", "m", &|(_, o)| o.peak_to_peak[0].into()),
            ("x2 peak to peak", "m", &|(_, o)| o.peak_to_peak[1].into()),
            ("admissible", "", &|(_, o)| o.validity.admissible.into()),
            ("stability", "", &|(_, o)| Cell::from(o.validity.stability())),
            ("largest multiplier", "", &|(_, o)| Cell::from(o.spectral_radius())),
        ],
    )
}

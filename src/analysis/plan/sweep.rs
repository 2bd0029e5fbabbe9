//! Planned sweeps of a rig: `[[sweep]]` of a plan, with the points that tell most.

use super::instrument::Instrument;
use super::{Forecast, forecast};
use crate::analysis::model::rig_left_out;
use crate::campaign::{Campaign, KeyRange};
use crate::compare::MotionKind;
use crate::compare::design::{Aim, DesignTask, PointInformation, ReachedPoints, slopes};
use crate::compare::simulated::Pace;
use crate::error::{Error, Result};
use crate::measure::Estimate;
use crate::measure::expected::{Expected, TIED, Tie};
use crate::model::{Observable, orbits};
use crate::record::{Direction, Finding};
use serde::{Deserialize, Serialize};
use std::f64::consts::TAU;

/// A sweep, the points of it that are measured, and what is wanted.
#[derive(Debug, Clone, Default, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Guess {
    /// Lowest and highest frequency in Hz.
    from: Option<f64>,
    to: Option<f64>,
    /// Forces in N that can be set.
    forces: Vec<f64>,
    /// Direction of the sweep.
    direction: Option<Direction>,
    /// Measured points, frequency in Hz and force in N, in the order of their measurement.
    measured: Vec<(f64, f64)>,
    /// Points of an even grid that is planned.
    points: Option<usize>,
    /// Number of points to suggest.
    next: Option<usize>,
    /// What is recorded: the noise of the instrument is one of it.
    record: Recorded,
    /// Prediction that the points are for.
    predict: Option<Observable>,
    /// Its frequency in Hz, at the first of the forces.
    at: Option<f64>,
}

/// Quantity that the instrument records.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
enum Recorded {
    /// In m.
    #[default]
    Displacement,
    /// In m/s.
    Velocity,
    /// In m/s².
    Acceleration,
}

/// A suggested point.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Suggestion {
    /// Frequency in Hz.
    pub frequency: f64,
    /// Force in N.
    pub force: f64,
    /// Motion that the sweep reaches there.
    pub motion: Option<MotionKind>,
    /// Relative standard uncertainty with this point and those before it.
    pub uncertainty: Option<f64>,
}

/// Suggested points, and what they are better than.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Suggested {
    /// What is to become certain.
    pub aim: String,
    /// The points, the first to be measured first.
    pub points: Vec<Suggestion>,
    /// Uncertainty over the number of points.
    pub course: Vec<CoursePoint>,
    /// Frequency in Hz, force in N, and part by which a point there lowers the uncertainty.
    #[serde(skip)]
    pub gains: Vec<(f64, f64, f64)>,
}

/// Relative standard uncertainty with a number of points; `None` where they determine nothing.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct CoursePoint {
    /// Number of points.
    pub n: usize,
    /// With those suggested.
    pub suggested: Option<f64>,
    /// With an even grid.
    pub even: Option<f64>,
}

/// Candidates for points at each force.
const CANDIDATES: usize = 121;
/// Points that are suggested unless their number is stated.
const NEXT: usize = 3;
/// Most points in the comparison with an even grid.
const COMPARED: usize = 24;

impl Guess {
    pub const SECTION: &'static str = "sweep";
    pub const RANGES: &'static [KeyRange] = &[
        KeyRange::above_zero("Hz", &["from", "to", "at"]),
        KeyRange::above_zero("N", &["forces"]),
        KeyRange::above_zero("", &["measured"]),
        KeyRange::count(100.0, &["points", "next"]),
    ];

    /// Frequencies from low to high, in the order of the sweep, at one force.
    fn grid(&self, force: f64) -> Result<Vec<(f64, f64)>> {
        let missing = |key: &str| {
            Error::usage(format!("a [[sweep]] without {key}"), "").hint(format!("add {key} = …, in Hz"))
        };
        let (from, to) = (self.from.ok_or_else(|| missing("from"))?, self.to.ok_or_else(|| missing("to"))?);
        if from >= to {
            let found = format!("from {from} to {to} Hz");
            return Err(Error::usage(found, "the lower frequency first").setting("from"));
        }
        let step = (to - from) / (CANDIDATES - 1) as f64;
        let mut grid: Vec<(f64, f64)> = (0..CANDIDATES).map(|i| (from + step * i as f64, force)).collect();
        if self.direction == Some(Direction::Down) {
            grid.reverse();
        }
        Ok(grid)
    }

    /// Standard uncertainty in m of an amplitude at `frequency` in Hz: that of a sine fitted to the record of
    /// a step, √(S/T) with the noise density S (Kay 1993, 7.8).
    fn amplitude_std(&self, instrument: &Instrument, frequency: f64) -> Result<f64> {
        let recorder = instrument.recorder(None)?;
        let noise = (recorder.spectrum(frequency) / recorder.duration / instrument.records()).sqrt();
        Ok(noise / (TAU * frequency).powi(self.record as i32))
    }
}

/// What a sweep will tell of the rig of the plan, and the points that tell most.
///
/// # Errors
/// If a key is impossible or missing, or the rig cannot be followed.
pub fn planned(
    plan: &Campaign,
    guess: &Guess,
    instrument: &Instrument,
    number: usize,
) -> Result<(Forecast, Suggested)> {
    let without = |table: &str, such: &str| {
        Error::usage(format!("a [[sweep]] without {table}"), "").hint(format!("add {such}"))
    };
    let rig = plan.rig.ok_or_else(|| without("[rig]", "[rig] with the guessed values of the rig"))?;
    if plan.fit.parameters.is_empty() {
        return Err(without("[fit]", "[fit] with parameters = [\"gap\", \"restitution\"]"));
    }
    let stated = plan.excitation.and_then(|excitation| excitation.force);
    let forces = if guess.forces.is_empty() { stated.into_iter().collect() } else { guess.forces.clone() };
    let force =
        *forces.first().ok_or_else(|| without("a force", "forces = [0.1], in N").setting("forces"))?;
    let pace = Pace { settle: plan.model.settle, measure: plan.model.measure };
    let task = DesignTask { rig, force, fit: &plan.fit, pace };
    let mut sequences = vec![guess.measured.clone()];
    for force in &forces {
        sequences.push(guess.grid(*force)?);
    }
    let reached = ReachedPoints::of(&task, &sequences)?;
    let first = guess.measured.len();
    let places: Vec<(f64, f64)> = sequences.into_iter().flatten().collect();
    let even = |n: usize| -> Vec<usize> {
        let place = |i: usize| if n > 1 { i * (CANDIDATES - 1) / (n - 1) } else { CANDIDATES / 2 };
        (0..n).map(|i| first + place(i)).collect()
    };
    let chosen: Vec<usize> = (0..first).chain(even(guess.points.unwrap_or(0))).collect();
    let information = |instrument: &Instrument| -> Result<PointInformation> {
        guess.amplitude_std(instrument, places[first].0)?;
        let std = |frequency: f64| guess.amplitude_std(instrument, frequency).unwrap_or(f64::NAN);
        Ok(reached.information(&std))
    };
    let aim = aim(guess, &task)?;
    let now = information(instrument)?;
    let candidates: Vec<usize> = reached.candidates().into_iter().filter(|place| *place >= first).collect();
    if candidates.is_empty() {
        let why = format!("none of {} points has a motion to be fitted", places.len() - first);
        return Err(Error::refused(why)
            .hint("other frequencies or forces, or a longer [model] settle")
            .setting("from"));
    }
    let next = now.next(&chosen, &candidates, guess.next.unwrap_or(NEXT), &aim.1);
    let suggestion = |(i, place): (usize, &usize)| {
        let all = [&chosen[..], &next[..=i]].concat();
        let (frequency, force) = places[*place];
        let (motion, uncertainty) = (reached.kinds()[*place], now.uncertainty(&all, &aim.1));
        Suggestion { frequency, force, motion, uncertainty }
    };
    let points = next.iter().enumerate().map(suggestion).collect();
    let longest = now.next(&chosen, &candidates, COMPARED, &aim.1);
    let course = (1..=COMPARED).map(|n| {
        let with = |more: &[usize]| now.uncertainty(&[&chosen[..], more].concat(), &aim.1);
        CoursePoint { n: chosen.len() + n, suggested: with(&longest[..n]), even: with(&even(n)) }
    });
    let gains = now.gains(&chosen, &candidates, &aim.1);
    let gains = candidates.iter().zip(gains).map(|(place, gain)| (places[*place].0, places[*place].1, gain));
    let (course, gains) = (course.collect(), gains.collect());
    let suggested = Suggested { aim: aim.0, points, course, gains };
    // Without a point of the plan, what the suggested ones tell.
    let told = if chosen.is_empty() { next } else { chosen };
    let value = |name: &str| {
        let parameter = plan.fit.parameters.iter().find(|parameter| parameter.name() == name)?;
        let mut rig = rig;
        Some((parameter.place(&mut rig).map_or(force, |place| *place), parameter.unit()))
    };
    let expected = |instrument: &Instrument, _: &Guess| -> Result<Expected> {
        let information = information(instrument)?;
        let undetermined = || {
            let why =
                format!("{} points do not determine {} parameters", told.len(), information.parameters.len());
            Error::refused(why).hint("more points, fewer parameters in [fit], or priors")
        };
        let covariance = information.covariance(&told, false).ok_or_else(undetermined)?;
        let mut found = Expected::default();
        let names: Vec<&str> = information.parameters.iter().map(|parameter| parameter.name()).collect();
        for (i, name) in names.iter().enumerate() {
            let (value, unit) = value(name).unwrap_or((f64::NAN, ""));
            let std = covariance[(i, i)].sqrt() * value.abs();
            let method = "information of the points about the fit of `vibro compare`";
            found.put(*name, &Estimate::new(value, Some(std), unit, told.len(), method));
            for (j, other) in names.iter().enumerate().skip(i + 1) {
                let correlation = covariance[(i, j)] / (covariance[(i, i)] * covariance[(j, j)]).sqrt();
                if correlation.abs() > TIED {
                    found.ties.push(Tie { of: [(*name).to_owned(), (*other).to_owned()], correlation });
                }
            }
        }
        Ok(found)
    };
    let title = format!("Sweep {number}");
    let mut found = forecast((Guess::SECTION, title), guess, instrument, &Instrument::knobs(), &expected)?;
    let all = places.len() - first;
    let blind = Finding::note("plan-points-left-out").count("n", all - candidates.len()).count("all", all);
    found.findings.extend((candidates.len() < all).then_some(blind));
    let masses = ["m1", "m2"].map(|mass| plan.fit.parameters.iter().any(|p| p.name() == mass));
    found.findings.extend((masses == [false; 2]).then(|| Finding::note("plan-masses-known")));
    found.findings.extend(rig_left_out("[rig]", &plan.rig_left_out()));
    Ok((found, suggested))
}

/// What the points are for, in words.
fn aim(guess: &Guess, task: &DesignTask<'_>) -> Result<(String, Aim)> {
    let (observable, at) = match (guess.predict, guess.at) {
        (None, None) => return Ok(("the least certain parameter".to_owned(), Aim::Parameters)),
        (Some(observable), Some(at)) => (observable, at),
        (Some(_), None) => {
            return Err(Error::usage("predict without at", "the frequency in Hz, at = 11").setting("predict"));
        }
        (None, Some(_)) => {
            let expected = "what is predicted, predict = \"impact-speed\"";
            return Err(Error::usage("at without predict", expected).setting("at"));
        }
    };
    let value = |rig: &crate::model::Rig, force: f64| {
        let found = orbits(rig, force, at).ok()?;
        let seen = found.orbits.iter().find(|o| o.validity.admissible && o.validity.stable == Some(true))?;
        Some(observable.of_orbit(seen)[0])
    };
    let slopes = slopes(task, &value).map_err(|error| error.setting("at"))?;
    Ok((format!("{} at {at} Hz", observable.name().replace('-', " ")), Aim::Prediction(slopes)))
}

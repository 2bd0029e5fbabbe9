//! Planned records of a hammer drill: `[[drill]]` of a plan.

use super::Planned;
use super::instrument::Instrument;
use super::knob::Knob;
use crate::campaign::KeyRange;
use crate::error::{Error, Result};
use crate::measure::drill::{AngleOrigin, Beam, DrillOptions, GuessedBlows, expected, rehearse};
use crate::measure::expected::{Expected, Recorder};
use serde::Deserialize;

/// Blows of one body, and the laser that sees it.
#[derive(Debug, Clone, Copy, Default, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Guess {
    /// Blows in a second, in Hz.
    speed: Option<f64>,
    /// Velocity before a blow in m/s.
    before: Option<f64>,
    /// Velocity after it in m/s, negative for a rebound.
    after: Option<f64>,
    /// Relative standard deviation of the velocities from blow to blow.
    scatter: Option<f64>,
    /// Standard deviation in m/s of the velocity after blows of one strength.
    after_scatter: Option<f64>,
    /// Mass of the body in kg.
    mass: Option<f64>,
    /// The struck mass in kg.
    struck_mass: Option<f64>,
    /// Velocity along the beam in m/s for one unit of the record.
    sensitivity: Option<f64>,
    /// Angle of the beam in degrees.
    beam_angle: Option<f64>,
    /// What it is counted from.
    beam_from: Option<AngleOrigin>,
    /// Its standard uncertainty in degrees.
    beam_angle_std: Option<f64>,
    /// Longest contact in s.
    contact: Option<f64>,
    /// Length of the fits before and after the contact, in s.
    fit_duration: Option<f64>,
}

impl super::Guess for Guess {
    const SECTION: &'static str = "drill";
    const TITLE: &'static str = "Drill";
    const RANGES: &'static [KeyRange] = &[
        KeyRange::above_zero("m/s", &["before"]),
        KeyRange::any("m/s", &["after"]),
        KeyRange::from_zero("m/s", &["after_scatter"]),
        KeyRange::above_zero("kg", &["struck_mass"]),
        KeyRange::above_zero("", &["sensitivity"]),
        KeyRange::from_zero("°", &["beam_angle", "beam_angle_std"]).at_most(90.0),
        KeyRange::above_zero("s", &["contact", "fit_duration"]).times(),
    ];
    const COMMAND: &'static str = "drill";
    const KNOBS: &'static [Knob<Guess>] = &[
        Knob::new(
            "uncertainty of the beam angle",
            "half the uncertainty of the beam angle",
            0.5,
            |_, guess, by| guess.beam_angle_std.as_mut().map(|std| *std *= by).is_some(),
        ),
        Knob::new("length of the fits", "fits twice as long", 2.0, |_, guess, by| {
            guess.fit_duration = Some(guess.fit_duration.unwrap_or(DrillOptions::FIT) * by);
            true
        }),
    ];

    fn expected(&self, instrument: &Instrument) -> Result<Expected> {
        let recorder = instrument.recorder(None)?;
        // The beam errs alike in all records.
        let longer = instrument.records() * recorder.duration;
        expected(&self.blows()?, &Recorder { duration: longer, ..recorder })
    }

    fn rehearsal(&self, instrument: &Instrument) -> Result<Planned> {
        let (blows, recorder) = (self.blows()?, instrument.recorder(None)?);
        Ok((expected(&blows, &recorder)?, Box::new(rehearse(&blows, &recorder))))
    }
}

impl Guess {
    fn blows(&self) -> Result<GuessedBlows> {
        let missing = |key: &str, such: &str| {
            Error::usage(format!("a [[drill]] without {key}"), "").hint(format!("add {key} = {such}"))
        };
        let beam = Beam::new(
            self.beam_angle.ok_or_else(|| missing("beam_angle", "0, in degrees"))?,
            self.beam_from.ok_or_else(|| missing("beam_from", "\"axis\""))?,
        )?;
        Ok(GuessedBlows {
            rate: self.speed.ok_or_else(|| missing("speed", "45, in Hz"))?,
            before: self.before.ok_or_else(|| missing("before", "7.5, in m/s"))?,
            after: self.after.ok_or_else(|| missing("after", "-1.5, in m/s"))?,
            scatter: self.scatter.unwrap_or(0.0),
            after_scatter: self.after_scatter.unwrap_or(0.0),
            mass: self.mass,
            struck_mass: self.struck_mass,
            sensitivity: self.sensitivity.unwrap_or(1.0),
            beam,
            beam_std: self.beam_angle_std.unwrap_or(0.0),
            contact: self.contact,
            fit: self.fit_duration,
        })
    }
}

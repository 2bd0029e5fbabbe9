//! Planned contact pulses: `[[pulse]]` of a plan.

use super::Planned;
use super::instrument::Instrument;
use super::knob::Knob;
use crate::campaign::KeyRange;
use crate::error::{Error, Result};
use crate::measure::expected::Expected;
use crate::measure::pulse::{GuessedPulse, KelvinVoigt, expected, rehearse};
use serde::Deserialize;
use std::f64::consts::TAU;

/// A contact of spring and damper, and what records it.
#[derive(Debug, Clone, Copy, Default, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Guess {
    /// Damping ratio.
    xi: f64,
    /// Duration of the contact in s.
    duration: Option<f64>,
    /// Stiffness of the contact in N/m, with a mass.
    stiffness: Option<f64>,
    /// Decelerated mass in kg.
    mass: Option<f64>,
    /// Velocity of approach in m/s.
    velocity: Option<f64>,
    /// What is recorded.
    record: Quantity,
}

/// Quantity of the record.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
enum Quantity {
    /// In m/s².
    #[default]
    Acceleration,
    /// In N.
    Force,
}

impl super::Guess for Guess {
    const SECTION: &'static str = "pulse";
    const TITLE: &'static str = "Contact pulse";
    const RANGES: &'static [KeyRange] = &[
        KeyRange::from_zero("", &["xi"]),
        KeyRange::above_zero("s", &["duration"]).times(),
        KeyRange::above_zero("N/m", &["stiffness"]),
        KeyRange::above_zero("m/s", &["velocity"]),
    ];
    const COMMAND: &'static str = "pulse";
    const KNOBS: &'static [Knob<Guess>] =
        &[Knob::new("velocity of approach", "twice the velocity of approach", 2.0, |_, guess, by| {
            guess.velocity.as_mut().map(|velocity| *velocity *= by).is_some()
        })];

    fn expected(&self, instrument: &Instrument) -> Result<Expected> {
        // The record is as long as the fit needs it.
        Ok(instrument.averaged(expected(&self.contact()?, &instrument.recorder(Some(1.0))?)?))
    }

    fn rehearsal(&self, instrument: &Instrument) -> Result<Planned> {
        let (contact, recorder) = (self.contact()?, instrument.recorder(Some(1.0))?);
        Ok((expected(&contact, &recorder)?, Box::new(rehearse(&contact, &recorder))))
    }
}

impl Guess {
    fn contact(&self) -> Result<GuessedPulse> {
        let Guess { xi, mass, .. } = *self;
        let speed = self.velocity.ok_or_else(|| missing("velocity", "0.5, in m/s"))?;
        let frequency = match (self.duration, self.stiffness, mass) {
            (Some(_), Some(_), _) => {
                let both = Error::usage("both duration and stiffness", "one of them");
                return Err(both.setting("stiffness"));
            }
            (Some(duration), None, _) => KelvinVoigt::lasting(duration, xi).map(|c| c.frequency()),
            (None, Some(stiffness), Some(mass)) => Some((stiffness / mass).sqrt() / TAU),
            (None, Some(_), None) => return Err(missing("mass", "0.125, in kg")),
            (None, None, _) => return Err(missing("duration", "1e-4, in s; or stiffness and mass")),
        };
        let frequency = frequency
            .ok_or_else(|| Error::usage(format!("a damping ratio of {xi}"), "0 to below 1").setting("xi"))?;
        let force = self.record == Quantity::Force;
        Ok(GuessedPulse { xi, frequency, speed, mass, force })
    }
}

fn missing(key: &str, such: &str) -> Error {
    Error::usage(format!("a [[pulse]] without {key}"), "").hint(format!("add {key} = {such}"))
}

//! Planned drops and trains of bounces: `[[drop]]` of a plan.

use super::Planned;
use super::instrument::Instrument;
use super::knob::Knob;
use crate::campaign::KeyRange;
use crate::error::{Error, Result};
use crate::measure::expected::Expected;
use crate::measure::restitution::{GuessedDrops, LONGEST, expected, rehearse};
use serde::Deserialize;

/// Drops of one height.
#[derive(Debug, Clone, Copy, Default, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Guess {
    /// Height of the fall in m.
    height: Option<f64>,
    /// Its standard uncertainty in m.
    height_std: Option<f64>,
    /// First flight in s, instead of a height.
    first_flight: Option<f64>,
    /// Coefficient of restitution.
    restitution: Option<f64>,
    /// Impacts of a drop that are heard.
    impacts: Option<usize>,
    /// Standard uncertainty of the time of an impact, in s.
    onset_std: Option<f64>,
    /// Relative standard deviation of R from bounce to bounce.
    scatter: Option<f64>,
    /// Standard uncertainty of the contact time in s, if one will be stated.
    contact_time_std: Option<f64>,
}

/// Highest fall in m: a larger number is likely a height in mm.
const HIGHEST: f64 = 30.0;
/// Relative scatter of R from bounce to bounce where none is stated.
const SCATTER: f64 = 0.02;

impl super::Guess for Guess {
    const SECTION: &'static str = "drop";
    const TITLE: &'static str = "Drop";
    const RANGES: &'static [KeyRange] = &[
        KeyRange::above_zero("m", &["height"]).at_most(HIGHEST),
        KeyRange::from_zero("m", &["height_std"]),
        KeyRange::above_zero("s", &["first_flight"]).times(),
        KeyRange::above_zero("", &["restitution"]).within(1e-9, 1.0),
        KeyRange::count(1e3, &["impacts"]),
        KeyRange::above_zero("s", &["onset_std"]).times(),
        KeyRange::from_zero("s", &["contact_time_std"]).times(),
    ];
    const COMMAND: &'static str = "restitution";
    const KNOBS: &'static [Knob<Guess>] = &[
        Knob::new("timing noise", "half the timing noise", 0.5, |_, guess, by| {
            guess.onset_std.as_mut().map(|std| *std *= by).is_some()
        }),
        Knob::new("uncertainty of the height", "half the uncertainty of the height", 0.5, |_, guess, by| {
            guess.height_std.as_mut().map(|std| *std *= by).is_some()
        }),
        Knob::new("height", "twice the height", 2.0, |_, guess, by| {
            guess.height.as_mut().map(|height| *height *= by).is_some()
        }),
        Knob::new("contact time", "a contact time known to 0.1 ms", 0.17, |_, guess, by| {
            // Of what is assumed where none is stated.
            let stated = guess.contact_time_std.replace(by * LONGEST / 3f64.sqrt());
            stated.is_none()
        }),
    ];

    fn expected(&self, instrument: &Instrument) -> Result<Expected> {
        expected(&self.drops(instrument)?)
    }

    fn rehearsal(&self, instrument: &Instrument) -> Result<Planned> {
        let drops = self.drops(instrument)?;
        Ok((expected(&drops)?, Box::new(rehearse(&drops))))
    }
}

impl Guess {
    fn drops(&self, instrument: &Instrument) -> Result<GuessedDrops> {
        let missing = |key: &'static str, such: &str| {
            Error::usage(format!("a [[drop]] without {key}"), "").hint(format!("add {key} = {such}"))
        };
        let height = match (self.height, self.height_std) {
            (Some(height), Some(std)) => Some([height, std]),
            (Some(_), None) => return Err(missing("height_std", "0.001, in m")),
            (None, _) => None,
        };
        Ok(GuessedDrops {
            height,
            restitution: self.restitution.ok_or_else(|| missing("restitution", "0.6"))?,
            first_flight: self.first_flight,
            impacts: self.impacts.ok_or_else(|| missing("impacts", "8"))?,
            onset_std: self.onset_std.ok_or_else(|| missing("onset_std", "1e-5, in s"))?,
            scatter: self.scatter.unwrap_or(SCATTER),
            contact_time_std: self.contact_time_std,
            drops: instrument.records().round() as usize,
        })
    }
}

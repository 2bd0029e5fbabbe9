//! Planned free decays: `[[decay]]` of a plan.

use super::Planned;
use super::instrument::Instrument;
use super::knob::Knob;
use crate::campaign::KeyRange;
use crate::error::{Error, Result};
use crate::measure::decay::{GuessedMode, expected, rehearse};
use crate::measure::expected::{Expected, Recorder};
use crate::record::units::Unit;
use serde::Deserialize;

/// The modes of a decay.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Guess {
    /// The modes.
    modes: Vec<Mode>,
}

/// A mode.
#[derive(Debug, Clone, Copy, Deserialize)]
#[serde(deny_unknown_fields, expecting = "a table")]
struct Mode {
    /// Natural frequency in Hz.
    frequency: f64,
    /// Damping ratio.
    zeta: f64,
    /// Amplitude at the release, in the unit of the record.
    amplitude: f64,
}

impl super::Guess for Guess {
    const SECTION: &'static str = "decay";
    const TITLE: &'static str = "Free decay";
    const RANGES: &'static [KeyRange] = &[];
    const COMMAND: &'static str = "decay";
    const KNOBS: &'static [Knob<Guess>] =
        &[Knob::new("amplitude", "twice the amplitude", 2.0, |_, guess, by| {
            guess.modes.iter_mut().for_each(|mode| mode.amplitude *= by);
            true
        })];

    fn expected(&self, instrument: &Instrument) -> Result<Expected> {
        let (modes, recorder) = self.recorded(instrument)?;
        Ok(instrument.averaged(expected(&modes, &recorder, "")?))
    }

    fn rehearsal(&self, instrument: &Instrument) -> Result<Planned> {
        let (modes, recorder) = self.recorded(instrument)?;
        let unit = Unit::parse("1").ok_or_else(|| Error::refused("the unit of a record"))?;
        Ok((expected(&modes, &recorder, "")?, Box::new(rehearse(&modes, &recorder, unit))))
    }
}

impl Guess {
    /// The modes, and the recorder of one record.
    fn recorded(&self, instrument: &Instrument) -> Result<(Vec<GuessedMode>, Recorder)> {
        for mode in &self.modes {
            let Mode { frequency, zeta, amplitude } = *mode;
            let positive = |v: f64| v.is_finite() && v > 0.0;
            if !(positive(frequency) && positive(zeta) && zeta < 1.0 && positive(amplitude)) {
                let found = format!("a mode of {frequency} Hz, ζ {zeta} and amplitude {amplitude}");
                return Err(Error::usage(found, "numbers above 0, and zeta below 1").setting("modes"));
            }
        }
        let guessed =
            |&Mode { frequency, zeta, amplitude }: &Mode| GuessedMode { frequency, zeta, amplitude };
        let modes: Vec<GuessedMode> = self.modes.iter().map(guessed).collect();
        let slowest = modes.iter().map(|mode| mode.frequency * mode.zeta).fold(f64::INFINITY, f64::min);
        // Unless it is stated a record lasts six time constants: what follows tells nothing.
        let recorder = instrument.recorder(Some(6.0 / (std::f64::consts::TAU * slowest)))?;
        Ok((modes, recorder))
    }
}

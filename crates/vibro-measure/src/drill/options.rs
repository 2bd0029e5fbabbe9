//! What must be known of a drill's record, and how it is taken.

use super::{Beam, Edge, Smoothing};
use vibro_record::units::notation::quantity;
use vibro_record::{Error, Result};

/// More pulses in a turn than any encoder on a crank gives.
const MOST_PULSES: usize = 10_000;

/// Parameters of [`super::drill`]. There is no default for those of which a wrong guess gives a plausible wrong answer.
#[derive(Debug, Clone, PartialEq)]
pub struct DrillOptions {
    /// Velocity along the beam in m/s for one unit of the velocity channel.
    pub sensitivity: f64,
    /// The beam.
    pub beam: Beam,
    /// Pulses of the reference in a turn.
    pub pulses_per_turn: usize,
    /// Edge of the pulse that counts.
    pub edge: Edge,
    /// Level of the edge in the unit of the reference. Default: the middle of its two levels.
    pub level: Option<f64>,
    /// Mass of what is measured, in kg: gives energies.
    pub mass: Option<f64>,
    /// Mass of what it strikes, in kg, at rest before: gives the restitution.
    pub struck_mass: Option<f64>,
    /// Longest duration of a contact in s. Default 0.2 ms.
    pub contact: f64,
    /// Duration in s of the fits on both sides of a contact. Default 0.5 ms.
    pub fit: f64,
    /// Longest drop-out in s that is bridged. Default 2 ms.
    pub longest_dropout: f64,
    /// Time in s by which the velocity was recorded later than the reference, as the decoder of a vibrometer does. Default 0.
    pub delay: f64,
    /// Phases of the average. Default 720.
    pub points: usize,
    /// Of average and displacement. Default a zero-phase low-pass, see [`Smoothing::Phases`].
    pub smoothing: Smoothing,
    /// Highest frequency in Hz that the instrument passes.
    pub instrument: Option<f64>,
    /// Margin in dB by which motion must stand above the noise floor. Default 10 dB.
    pub margin: f64,
    /// Hours a day of the exposure of a hand.
    pub hours: Option<f64>,
}

impl DrillOptions {
    /// Everything that has no default; the rest takes its default.
    pub fn new(sensitivity: f64, beam: Beam, pulses_per_turn: usize, edge: Edge) -> DrillOptions {
        DrillOptions {
            sensitivity,
            beam,
            pulses_per_turn,
            edge,
            level: None,
            mass: None,
            struck_mass: None,
            contact: 0.2e-3,
            fit: 0.5e-3,
            longest_dropout: 2e-3,
            delay: 0.0,
            points: 720,
            smoothing: Smoothing::default(),
            instrument: None,
            margin: 10.0,
            hours: None,
        }
    }

    /// Checks every number.
    pub(super) fn check(&self) -> Result<()> {
        if self.sensitivity == 0.0 || !self.sensitivity.is_finite() {
            return Err(Error::usage(format!("a sensitivity of {}", self.sensitivity), "m/s a unit, not 0"));
        }
        if self.pulses_per_turn == 0 || self.pulses_per_turn > MOST_PULSES {
            let expected = format!("1 to {MOST_PULSES}");
            return Err(Error::usage(format!("{} pulses a turn", self.pulses_per_turn), expected));
        }
        if !self.delay.is_finite() {
            return Err(Error::usage(format!("a delay of {} s", self.delay), "a finite number"));
        }
        if !self.margin.is_finite() {
            return Err(Error::usage(format!("a margin of {} dB", self.margin), "a finite number"));
        }
        if let Some(h) = self.hours.filter(|h| !(*h > 0.0 && *h <= 24.0)) {
            return Err(Error::usage(
                format!("an exposure of {h} hours a day"),
                "a number above 0, at most 24",
            ));
        }
        if self.points < 2 || self.points > 100_000 {
            return Err(Error::usage(format!("an average at {} phases", self.points), "2 to 100000"));
        }
        let smoothing = match self.smoothing {
            Smoothing::LowPass(v) | Smoothing::Exponential(v) => Some(v),
            Smoothing::Phases | Smoothing::Off => None,
        };
        let numbers = [
            ("mass", self.mass),
            ("struck mass", self.struck_mass),
            ("contact time", Some(self.contact)),
            ("fit time", Some(self.fit)),
            ("longest drop-out", Some(self.longest_dropout)),
            ("smoothing", smoothing),
            ("bandwidth of the instrument", self.instrument),
        ];
        for (name, value) in numbers {
            if let Some(v) = value.filter(|v| !(v.is_finite() && *v > 0.0)) {
                return Err(Error::usage(format!("a {name} of {v}"), "a finite number above 0"));
            }
        }
        if self.struck_mass.is_some() && self.mass.is_none() {
            return Err(Error::usage("a struck mass without the mass that strikes it", "both masses"));
        }
        Ok(())
    }

    /// Checks the times that must fit into a turn of `turn` seconds.
    pub(super) fn check_turn(&self, turn: f64) -> Result<()> {
        for (name, time) in [("contact", self.contact), ("fit", self.fit)] {
            if time > 0.5 * turn {
                let why = format!(
                    "a {name} time of {time} s is longer than half a turn, {}",
                    quantity(0.5 * turn, "s", 3)
                );
                return Err(Error::refused(why)
                    .hint(format!("state --{name} in seconds; if it is right, check --pulses-per-turn")));
            }
        }
        Ok(())
    }
}

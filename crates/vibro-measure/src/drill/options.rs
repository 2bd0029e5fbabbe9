//! What must be known of a drill's record, and how it is taken.

use super::{Beam, Edge, Smoothing};
use crate::exposure::check_hours;
use vibro_record::units::notation::quantity;
use vibro_record::{Error, Result};

/// More pulses in a turn than any encoder on a crank gives.
const MOST_PULSES: usize = 10_000;
/// More phases than any record fills.
const MOST_POINTS: usize = 100_000;
/// Longest turn in samples: a few turns are kept in memory; at 100 kHz these are 40 s.
pub(super) const LONGEST_TURN: f64 = 4e6;

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
    /// Delay in s of the velocity channel against the reference, such as of a vibrometer's decoder; it is removed. Default 0.
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
        let (low_pass, smoothing) = match self.smoothing {
            Smoothing::LowPass(corner) => (Some(corner), None),
            Smoothing::Exponential(time) => (None, Some(time)),
            Smoothing::Phases | Smoothing::Off => (None, None),
        };
        let positive = [
            ("mass", self.mass),
            ("struck_mass", self.struck_mass),
            ("contact", Some(self.contact)),
            ("fit", Some(self.fit)),
            ("longest_dropout", Some(self.longest_dropout)),
            ("low_pass", low_pass),
            ("smoothing", smoothing),
            ("instrument", self.instrument),
        ];
        let above = |(key, value): (&'static str, Option<f64>)| {
            value.map(|v| (key, v, v.is_finite() && v > 0.0, "a finite number above 0"))
        };
        let finite = |v: f64| v.is_finite();
        let (pulses, points) = (self.pulses_per_turn, self.points);
        let others = [
            (
                "sensitivity",
                self.sensitivity,
                finite(self.sensitivity) && self.sensitivity != 0.0,
                "a finite number, not 0",
            ),
            ("delay", self.delay, finite(self.delay), "a finite number"),
            ("margin", self.margin, finite(self.margin), "a finite number"),
            ("pulses_per_turn", pulses as f64, (1..=MOST_PULSES).contains(&pulses), "1 to 10000"),
            ("points", points as f64, (2..=MOST_POINTS).contains(&points), "2 to 100000"),
        ];
        for (key, value, holds, expected) in others.into_iter().chain(positive.into_iter().filter_map(above))
        {
            if !holds {
                let found = format!("{} = {value}", key.replace('_', " "));
                return Err(Error::usage(found, expected).setting(key));
            }
        }
        if self.struck_mass.is_some() && self.mass.is_none() {
            let found = "a struck mass without the mass that strikes it";
            return Err(Error::usage(found, "both masses").setting("mass"));
        }
        check_hours(self.hours)
    }

    /// Checks what must fit into a turn of `turn` seconds at `rate` samples a second.
    pub(super) fn check_turn(&self, turn: f64, rate: f64) -> Result<()> {
        if turn * rate > LONGEST_TURN {
            return Err(Error::refused(format!(
                "a turn of {} is longer than {LONGEST_TURN:.0} samples",
                quantity(turn, "s", 3)
            ))
            .hint("resample the record, or check the pulses of a turn")
            .setting("pulses_per_turn"));
        }
        for (key, time) in [("contact", self.contact), ("fit", self.fit)] {
            if time > 0.5 * turn {
                let half = quantity(0.5 * turn, "s", 3);
                return Err(Error::refused(format!(
                    "a {key} time of {time} s is longer than half a turn, {half}"
                ))
                .hint("state a shorter time in seconds; if it is right, check the pulses of a turn")
                .setting(key)
                .setting("pulses_per_turn"));
            }
        }
        Ok(())
    }
}

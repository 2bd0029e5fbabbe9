//! Options for a drill's record: what must be stated, and how the record is evaluated.

use super::Edge;
use crate::exposure::check_hours;
use serde::{Deserialize, Serialize};
use vibro_record::{Error, Result};
use vibro_signal::filter::Filter;

/// Largest number of pulses in a turn: more than any encoder on a crank gives.
const MOST_PULSES: usize = 10_000;
/// Largest number of phases of the average: more than any record fills.
const MOST_POINTS: usize = 100_000;
/// Smallest cosine of the angle between beam and motion, that of 89°: there a tenth of a degree changes the
/// velocity by a tenth.
const SQUARE: f64 = 0.0175;
/// Lowest corner of the low-pass chosen from the data, over the rotation frequency, even for an average of
/// few phases. The tenth harmonic then loses (10/50)⁴ = 0.2 % of its amplitude, the stroke still less.
const HARMONICS: f64 = 50.0;
/// Highest corner over the sampling rate. Differences of samples show too little above it: at a quarter of
/// the rate a central difference gives 2/π of a slope.
const HIGHEST: f64 = 0.25;

/// Direction from which the angle of the beam is counted.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum AngleOrigin {
    /// From the normal to the motion: 90° is a beam along the motion.
    Normal,
    /// From the axis of the motion: 0° is a beam along the motion.
    Axis,
}

/// A laser beam that measures v cos α of a velocity v, α the angle between beam and motion.
///
/// ```
/// use vibro_measure::drill::{AngleOrigin, Beam};
/// assert!((Beam::new(30.0, AngleOrigin::Normal)?.factor - 2.0).abs() < 1e-12);
/// assert!((Beam::new(30.0, AngleOrigin::Axis)?.factor - 1.1547).abs() < 1e-4);
/// # Ok::<(), vibro_record::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Beam {
    /// Velocity of the motion over that along the beam, 1/cos α.
    pub factor: f64,
    /// Relative change of velocities for one degree of error in the angle: tan α · π/180.
    pub per_degree: f64,
}

impl Beam {
    /// A beam at `degrees`, counted `from` the normal or from the axis of the motion.
    ///
    /// # Errors
    /// If the angle is not between 0° and 90°, or the beam is perpendicular to the motion within 1° and
    /// measures hardly any of it.
    pub fn new(degrees: f64, from: AngleOrigin) -> Result<Beam> {
        if !(0.0..=90.0).contains(&degrees) {
            let found = format!("a beam angle of {degrees}°");
            return Err(Error::usage(found, "0° to 90°").setting("beam_angle"));
        }
        let alpha = if from == AngleOrigin::Axis { degrees } else { 90.0 - degrees }.to_radians();
        if alpha.cos() < SQUARE {
            let why = format!("a beam at {degrees}° is square to the motion: it sees no velocity");
            let hint = "check whether the angle counts from the normal or from the axis of the motion";
            return Err(Error::refused(why).hint(hint).setting("beam_from"));
        }
        Ok(Beam { factor: 1.0 / alpha.cos(), per_degree: alpha.tan() * 1f64.to_radians() })
    }
}

/// How the velocity is smoothed before it is averaged and integrated. Impacts and bandwidth always come from
/// the velocity without smoothing.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum Smoothing {
    /// A zero-phase low-pass as in [`Smoothing::LowPass`] whose corner comes from the data: the rotation
    /// frequency times half the number of phases, which is the highest frequency that the average can show.
    /// It is at least 50 times the rotation frequency, and at most a quarter of the sampling rate.
    #[default]
    Phases,
    /// None.
    Off,
    /// Butterworth low-pass of second order, forward and backward: no delay. Corner in Hz, at half the
    /// amplitude.
    LowPass(f64),
    /// Exponential smoothing with this time constant in s: delays by it.
    Exponential(f64),
}

/// Where the turns come from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum TurnsFrom {
    /// Pulses of a reference channel.
    Reference,
    /// The impacts themselves: a turn is the period of their pattern, which begins at the strongest.
    Impacts,
}

/// A smoothing and its corner in Hz.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", content = "corner", rename_all = "kebab-case")]
pub enum Corner {
    /// Butterworth low-pass of second order, forward and backward: the corner is at half the amplitude.
    ZeroPhaseLowPass(f64),
    /// First-order low-pass, forward only: the corner is at 1/√2 of the amplitude.
    Exponential(f64),
}

impl Smoothing {
    /// Kind of low-pass and corner in Hz, for an average at `points` phases of turns of `turn` seconds,
    /// `rate` samples a second; `None` without smoothing.
    ///
    /// ```
    /// use vibro_measure::drill::{Corner, Smoothing};
    /// assert_eq!(Smoothing::Phases.corner(720, 0.02, 102_400.0), Some(Corner::ZeroPhaseLowPass(18_000.0)));
    /// assert_eq!(Smoothing::Phases.corner(720, 0.02, 20_000.0), Some(Corner::ZeroPhaseLowPass(5_000.0)));
    /// ```
    pub fn corner(self, points: usize, turn: f64, rate: f64) -> Option<Corner> {
        let highest = (0.5 * points as f64).max(HARMONICS) / turn;
        match self {
            Smoothing::Off => None,
            Smoothing::Phases => Some(Corner::ZeroPhaseLowPass(highest.min(HIGHEST * rate))),
            Smoothing::LowPass(corner) => Some(Corner::ZeroPhaseLowPass(corner)),
            Smoothing::Exponential(time) => Some(Corner::Exponential(1.0 / (std::f64::consts::TAU * time))),
        }
    }
}

impl Corner {
    /// Smooths a velocity.
    pub(crate) fn smooth(self, values: &[f64], rate: f64) -> Result<Vec<f64>> {
        match self {
            Corner::ZeroPhaseLowPass(corner) => Filter::low_pass(corner, 2, rate)?.zero_phase(values),
            Corner::Exponential(corner) => {
                let mut out = values.to_vec();
                let first = values.first().copied().unwrap_or(0.0);
                Filter::smoothing(corner, rate)?.causal(&mut out, first);
                Ok(out)
            }
        }
    }
}

/// Parameters of [`super::drill`]. Parameters whose wrong guess would give a plausible wrong answer have no
/// default.
#[derive(Debug, Clone, PartialEq)]
pub struct DrillOptions {
    /// Velocity along the beam in m/s for one unit of the velocity channel.
    pub sensitivity: f64,
    /// The beam.
    pub beam: Beam,
    /// Where the turns come from. Pulses, edge, level and delay are those of a reference.
    pub turns_from: TurnsFrom,
    /// Pulses of the reference in a turn.
    pub pulses_per_turn: usize,
    /// Edge of the pulse that counts.
    pub edge: Edge,
    /// Level of the edge in the unit of the reference. Default: the middle of its two levels.
    pub level: Option<f64>,
    /// Mass of the measured part, in kg: gives energies.
    pub mass: Option<f64>,
    /// Mass of the struck part, in kg, at rest before the impact: gives the restitution.
    pub struck_mass: Option<f64>,
    /// Longest duration of a contact in s. Default 0.2 ms.
    pub contact: f64,
    /// Duration in s of the fits on both sides of a contact. Default 0.5 ms.
    pub fit: f64,
    /// Longest drop-out in s that is bridged. Default 2 ms.
    pub longest_dropout: f64,
    /// Delay in s of the velocity channel against the reference, such as of a vibrometer's decoder; it is
    /// removed. Default 0.
    pub delay: f64,
    /// Phases of the average. Default 720.
    pub points: usize,
    /// Smoothing of average and displacement. Default a zero-phase low-pass, see [`Smoothing::Phases`].
    pub smoothing: Smoothing,
    /// Highest frequency in Hz that the instrument passes.
    pub instrument: Option<f64>,
    /// Margin in dB by which the motion must exceed the noise floor. Default 10 dB.
    pub margin: f64,
    /// Exposure of a hand in hours a day.
    pub hours: Option<f64>,
    /// Relative standard uncertainty of the sampling rate. Default 0.
    pub clock: f64,
}

impl DrillOptions {
    /// Length of the fits in s where none is stated.
    pub const FIT: f64 = 0.5e-3;

    /// Lengths of a contact and of a fit beside it, in samples.
    pub(super) fn lengths(&self, rate: f64) -> (f64, f64) {
        (self.contact * rate, self.fit * rate)
    }

    /// Options from the parameters without a default; the others take their defaults.
    pub fn new(sensitivity: f64, beam: Beam, pulses_per_turn: usize, edge: Edge) -> DrillOptions {
        DrillOptions {
            sensitivity,
            beam,
            turns_from: TurnsFrom::Reference,
            pulses_per_turn,
            edge,
            level: None,
            mass: None,
            struck_mass: None,
            contact: 0.2e-3,
            fit: DrillOptions::FIT,
            longest_dropout: 2e-3,
            delay: 0.0,
            points: 720,
            smoothing: Smoothing::default(),
            instrument: None,
            margin: 10.0,
            hours: None,
            clock: 0.0,
        }
    }

    /// As [`DrillOptions::new`], of a record without a reference.
    pub fn of_impacts(sensitivity: f64, beam: Beam) -> DrillOptions {
        let turns_from = TurnsFrom::Impacts;
        DrillOptions { turns_from, ..DrillOptions::new(sensitivity, beam, 1, Edge::Rising) }
    }

    /// Checks every number.
    ///
    /// # Errors
    /// If a number is impossible; the error names the setting of the first.
    pub fn check(&self) -> Result<()> {
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
            ("instrument", self.instrument),
            ("low_pass", low_pass),
            ("smoothing", smoothing),
        ];
        let positive = positive.into_iter().filter_map(|(key, value)| Some((key, value?)));
        let positive = positive.map(|(key, v)| (key, v, v.is_finite() && v > 0.0, "a finite number above 0"));
        let (sensitivity, pulses, points) = (self.sensitivity, self.pulses_per_turn, self.points);
        let others = [
            ("sensitivity", sensitivity, sensitivity.is_normal(), "a finite number, not 0"),
            ("delay", self.delay, self.delay.is_finite(), "a finite number"),
            ("margin", self.margin, self.margin.is_finite(), "a finite number"),
            ("pulses_per_turn", pulses as f64, (1..=MOST_PULSES).contains(&pulses), "1 to 10000"),
            ("points", points as f64, (2..=MOST_POINTS).contains(&points), "2 to 100000"),
        ];
        if let Some((key, value, _, expected)) = positive.chain(others).find(|check| !check.2) {
            let found = format!("{} = {value}", key.replace('_', " "));
            return Err(Error::usage(found, expected).setting(key));
        }
        if self.struck_mass.is_some() && self.mass.is_none() {
            let found = "a struck mass without the mass that strikes it";
            return Err(Error::usage(found, "both masses").setting("mass"));
        }
        check_hours(self.hours)
    }

    /// Checks that contact and fit are no longer than half a turn of `turn` seconds.
    pub(super) fn check_turn(&self, turn: f64) -> Result<()> {
        for (key, time) in [("contact", self.contact), ("fit", self.fit)] {
            if time > 0.5 * turn {
                if self.turns_from == TurnsFrom::Impacts {
                    let why = format!("a {key} time of {time} s leaves no two turns in the record");
                    return Err(Error::refused(why).hint("state a shorter time in seconds").setting(key));
                }
                let why = format!("a {key} time of {time} s is longer than half a turn of {turn:.3e} s");
                let hint = "state a shorter time in seconds; if it is right, check the pulses of a turn";
                return Err(Error::refused(why).hint(hint).setting(key).setting("pulses_per_turn"));
            }
        }
        Ok(())
    }
}
#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_spellings_of_one_beam_agree() {
        for degrees in [0.0, 12.5, 45.0, 80.0] {
            let (a, b) = (
                Beam::new(degrees, AngleOrigin::Axis).unwrap(),
                Beam::new(90.0 - degrees, AngleOrigin::Normal).unwrap(),
            );
            // One rounding in the angle, amplified by tan 80° = 6.
            assert!((a.factor / b.factor - 1.0).abs() < 1e-14);
        }
        // 3 % per degree where the factor is 2.
        assert!((Beam::new(30.0, AngleOrigin::Normal).unwrap().per_degree - 0.0302).abs() < 1e-4);
    }

    #[test]
    fn a_square_beam_is_refused_and_an_impossible_angle_is_wrong_usage() {
        assert_eq!(Beam::new(90.0, AngleOrigin::Axis).unwrap_err().exit_code(), 1);
        assert_eq!(Beam::new(0.0, AngleOrigin::Normal).unwrap_err().exit_code(), 1);
        for bad in [-1.0, 91.0, f64::NAN] {
            assert_eq!(Beam::new(bad, AngleOrigin::Axis).unwrap_err().exit_code(), 2);
        }
    }
}

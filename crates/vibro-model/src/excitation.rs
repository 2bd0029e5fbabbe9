//! Excitation of mass 1: sines, impulses or pulses.

use super::least::{NumberRange, number};
use super::waves::MOST_SINES;
use num_complex::Complex64;
use serde::{Deserialize, Serialize};
use std::f64::consts::TAU;
use vibro_record::{Error, Result};

/// Excitation of mass 1; files name it by `kind`.
///
/// ```
/// use vibro_model::{Excitation, Sine};
/// let e: Excitation = toml::from_str("kind = \"sine\"\nforce = 0.5\nfrequency = 11.0")?;
/// assert_eq!(e, Excitation::Sine(Sine { force: 0.5, frequency: 11.0 }));
/// # Ok::<(), toml::de::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "lowercase")]
#[non_exhaustive]
pub enum Excitation {
    /// F₀ cos(ωt + θ).
    Sine(Sine),
    /// One impulse a cycle.
    Impulse(Impulses),
    /// One rectangular pulse a cycle.
    Pulse(Pulses),
    /// A sum of sines.
    Sines(Sines),
}

/// Sine force F₀ cos(ωt + θ); the phase θ is set where a motion starts.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Sine {
    /// Force amplitude F₀ in N.
    pub force: f64,
    /// Frequency in Hz.
    pub frequency: f64,
}

/// An impulse at the beginning of each cycle (phase 0).
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Impulses {
    /// Impulse F in N s.
    pub impulse: f64,
    /// Impulses a second, in Hz.
    pub frequency: f64,
}

/// A rectangular pulse that begins with each cycle (phase 0); between the pulses there is no force.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Pulses {
    /// Force during the pulse, in N.
    pub force: f64,
    /// Duration of a pulse in s, shorter than the cycle.
    pub width: f64,
    /// Pulses a second, in Hz.
    pub frequency: f64,
}

/// The sum of several sine forces.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Sines {
    /// The sines; the cycle is the period of the first one.
    pub parts: Vec<Part>,
}

/// One sine force F cos(ωt + θ) of several.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Part {
    /// Force amplitude F in N.
    pub force: f64,
    /// Frequency in Hz.
    pub frequency: f64,
    /// Phase θ at time 0 in rad.
    #[serde(default)]
    pub phase: f64,
}

impl Excitation {
    /// Checks that the numbers are possible: all finite, frequencies above 0, amplitudes of sines not
    /// negative (impulses and pulses may pull), a width above 0 and below the cycle, and one to `MOST_SINES`
    /// sines.
    ///
    /// # Errors
    /// If a number is impossible; the error names its key as a setting.
    pub fn check(&self) -> Result<()> {
        match self {
            Excitation::Sine(sine) => sine.check(),
            Excitation::Impulse(train) => {
                check("impulse", train.impulse, "N s", NumberRange::Any)?;
                check("frequency", train.frequency, "Hz", NumberRange::AboveZero)
            }
            Excitation::Pulse(train) => {
                check("force", train.force, "N", NumberRange::Any)?;
                check("frequency", train.frequency, "Hz", NumberRange::AboveZero)?;
                let cycle = 1.0 / train.frequency;
                if train.width > 0.0 && train.width < cycle {
                    return Ok(());
                }
                let expected =
                    format!("a value above 0 and below the cycle of {cycle} s at {} Hz", train.frequency);
                Err(Error::usage(format!("width is {} s", train.width), expected).setting("width"))
            }
            Excitation::Sines(Sines { parts }) => {
                if !(1..=MOST_SINES).contains(&parts.len()) {
                    let expected = format!("parts = [{{ force = …, frequency = … }}], 1 to {MOST_SINES}");
                    return Err(Error::usage(format!("{} sines", parts.len()), expected).setting("parts"));
                }
                for Part { force, frequency, phase } in parts.iter().copied() {
                    Sine { force, frequency }.check()?;
                    check("phase", phase, "rad", NumberRange::Any)?;
                }
                Ok(())
            }
        }
    }

    /// Frequency of the cycles in Hz; of several sines, that of the first. NaN without sines.
    pub fn frequency(&self) -> f64 {
        self.first().0
    }

    /// Size: the force in N of a sine, a pulse or the first of several sines; the impulse in N s.
    pub fn size(&self) -> f64 {
        self.first().1
    }

    /// Frequency and size; of several sines, those of the first one.
    fn first(&self) -> (f64, f64) {
        match self {
            Excitation::Sine(sine) => (sine.frequency, sine.force),
            Excitation::Impulse(train) => (train.frequency, train.impulse),
            Excitation::Pulse(train) => (train.frequency, train.force),
            Excitation::Sines(sines) => {
                sines.parts.first().map_or((f64::NAN, f64::NAN), |part| (part.frequency, part.force))
            }
        }
    }

    /// The same excitation at another frequency in Hz; several sines keep the ratios of their frequencies.
    pub fn at_frequency(&self, frequency: f64) -> Excitation {
        let ratio = frequency / self.frequency();
        self.changed(frequency, self.size(), |part| part.frequency *= ratio)
    }

    /// The same excitation of another size; several sines keep the ratios of their forces.
    pub fn at_size(&self, size: f64) -> Excitation {
        let ratio = size / self.size();
        self.changed(self.frequency(), size, |part| part.force *= ratio)
    }

    /// The same with another frequency and size; for several sines, `change` is applied to each.
    fn changed(&self, frequency: f64, size: f64, change: impl FnMut(&mut Part)) -> Excitation {
        let mut changed = self.clone();
        match &mut changed {
            Excitation::Sine(sine) => *sine = Sine { force: size, frequency },
            Excitation::Impulse(train) => *train = Impulses { impulse: size, frequency },
            Excitation::Pulse(train) => (train.force, train.frequency) = (size, frequency),
            Excitation::Sines(sines) => sines.parts.iter_mut().for_each(change),
        }
        changed
    }

    /// Complex amplitude in N of the force's `n`-th harmonic (n ≥ 1), with the cycle at `phase` (rad) at the
    /// start. NaN for several sines, which need not be harmonics of one cycle.
    ///
    /// Impulses F: 2F/T in every harmonic; pulses of force f and width w: (2f/T)(1 − e^{−inωw})/(inω).
    pub(super) fn harmonic(&self, n: u32, phase: f64) -> Complex64 {
        let size = match *self {
            Excitation::Sine(sine) if n == 1 => sine.force.into(),
            Excitation::Sine(_) => Complex64::ZERO,
            Excitation::Impulse(train) => (2.0 * train.impulse * train.frequency).into(),
            Excitation::Pulse(Pulses { force, width, frequency }) => {
                // 1 − e^{−2ih} = 2i sin h e^{−ih}.
                let half = f64::from(n) * TAU * frequency * width / 2.0;
                Complex64::cis(-half) * (2.0 * force * frequency * width * half.sin() / half)
            }
            Excitation::Sines(_) => f64::NAN.into(),
        };
        Complex64::cis(f64::from(n) * phase) * size
    }

    /// Name of its kind in files: `sine`, `impulse`, `pulse` or `sines`.
    pub fn kind(&self) -> &'static str {
        match self {
            Excitation::Sine(_) => "sine",
            Excitation::Impulse(_) => "impulse",
            Excitation::Pulse(_) => "pulse",
            Excitation::Sines(_) => "sines",
        }
    }
}

impl From<Sine> for Excitation {
    fn from(sine: Sine) -> Excitation {
        Excitation::Sine(sine)
    }
}

fn check(key: &'static str, value: f64, unit: &str, least: NumberRange) -> Result<()> {
    number(key, value, unit, least).map_err(|error| error.setting(key))
}

impl Sine {
    /// As [`Excitation::check`].
    ///
    /// # Errors
    /// If a number is impossible.
    pub fn check(&self) -> Result<()> {
        check("force", self.force, "N", NumberRange::Zero)?;
        check("frequency", self.frequency, "Hz", NumberRange::AboveZero)
    }

    /// Angular frequency ω in rad/s.
    pub fn omega(&self) -> f64 {
        TAU * self.frequency
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn unknown_kinds_and_keys_are_refused() {
        let text = "kind = \"sine\"\nforce = 0.5\nfrequency = 11.0\nphase = 0.1";
        assert!(toml::from_str::<Excitation>(text).unwrap_err().to_string().contains("phase"));
        assert!(toml::from_str::<Excitation>("kind = \"saw\"").unwrap_err().to_string().contains("saw"));
    }

    #[test]
    fn impossible_values_are_named() {
        for (force, frequency, start) in [
            (-1.0, 5.0, "force is -1 N"),
            (f64::NAN, 5.0, "force is NaN N"),
            (1.0, 0.0, "frequency is 0 Hz"),
            (1.0, f64::INFINITY, "frequency is inf Hz"),
        ] {
            let text = Sine { force, frequency }.check().unwrap_err().to_string();
            assert!(text.starts_with(start), "{text}");
        }
        let refused = |e: &Excitation| e.check().unwrap_err().to_string();
        let pulses = Pulses { force: 0.5, width: 0.2, frequency: 5.0 };
        assert!(refused(&Excitation::Pulse(pulses)).starts_with("width is 0.2 s"));
        assert!(Excitation::Pulse(Pulses { width: 0.199, ..pulses }).check().is_ok());
        assert!(refused(&Excitation::Sines(Sines { parts: Vec::new() })).starts_with("0 sines"));
        let part = Part { force: 0.1, frequency: 5.0, phase: 0.0 };
        assert!(Excitation::Sines(Sines { parts: vec![part; MOST_SINES] }).check().is_ok());
        let many = Excitation::Sines(Sines { parts: vec![part; MOST_SINES + 1] });
        assert!(refused(&many).starts_with("5 sines"));
        let impulse = Impulses { impulse: f64::NAN, frequency: 5.0 };
        assert!(refused(&Excitation::Impulse(impulse)).starts_with("impulse is NaN N s"));
    }

    #[test]
    fn another_frequency_keeps_the_rest() {
        let part = |frequency| Part { force: 0.1, frequency, phase: 0.3 };
        let sines = Excitation::Sines(Sines { parts: vec![part(4.0), part(6.0)] });
        assert_eq!(sines.at_frequency(8.0), Excitation::Sines(Sines { parts: vec![part(8.0), part(12.0)] }));
        let pulses = Excitation::Pulse(Pulses { force: 0.5, width: 0.01, frequency: 5.0 });
        assert_eq!((pulses.at_frequency(7.0).frequency(), pulses.kind()), (7.0, "pulse"));
    }
}

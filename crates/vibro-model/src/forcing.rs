//! The exciting force from now on: its sines, as series in time, and its clock.

use super::clock::{Clock, within};
use super::excitation::MOST_SINES;
use super::linear::{ORDER, Terms};
use super::{Excitation, Part};
use std::f64::consts::TAU;
use vibro_record::Result;

/// One sine force, with its phase now.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Tone {
    pub force: f64,
    pub frequency: f64,
    pub phase: f64,
}

impl Tone {
    #[inline]
    pub fn omega(&self) -> f64 {
        TAU * self.frequency
    }
}

/// The exciting force from now on.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Forcing {
    tones: [Option<Tone>; MOST_SINES],
    pub clock: Clock,
}

impl Forcing {
    /// The excitation in a cycle of which `phase` rad are past: a sine is F₀ cos(phase), an impulse falls on phase 0, a
    /// pulse begins there, and of several sines each is ahead by its own part of the time that the phase stands for.
    pub fn new(excitation: &Excitation, phase: f64) -> Result<Forcing> {
        let clock = Clock::new(excitation, phase)?;
        let (phase, frequency) = (clock.phase(), clock.frequency());
        let mut tones = [None; MOST_SINES];
        match excitation {
            Excitation::Sine(sine) => tones[0] = Some(Tone { force: sine.force, frequency, phase }),
            Excitation::Sines(sines) => {
                for (tone, part) in tones.iter_mut().zip(&sines.parts) {
                    let Part { force, frequency: own, phase: start } = *part;
                    let phase = (start + phase * (own / frequency)).rem_euclid(TAU);
                    *tone = Some(Tone { force, frequency: own, phase });
                }
            }
            Excitation::Impulse(_) | Excitation::Pulse(_) => {}
        }
        Ok(Forcing { tones, clock })
    }

    /// Its sines.
    #[inline]
    pub fn tones(&self) -> impl Iterator<Item = &Tone> {
        self.tones.iter().flatten()
    }

    /// Phase of the cycle in 0..2π.
    #[inline]
    pub fn phase(&self) -> f64 {
        self.clock.phase()
    }

    /// Frequency of the cycle in Hz.
    pub fn frequency(&self) -> f64 {
        self.clock.frequency()
    }

    /// Changes the frequency from now on; every phase goes on.
    pub fn set_frequency(&mut self, hz: f64) -> Result<()> {
        let before = self.frequency();
        self.clock.set_frequency(hz)?;
        for tone in self.tones.iter_mut().flatten() {
            // The first sine counts the cycles: no rounding of its frequency.
            tone.frequency = if tone.frequency == before { hz } else { tone.frequency * (hz / before) };
        }
        Ok(())
    }

    /// Goes on under another excitation of the same kind, whose phases are those of this one.
    pub fn set_excitation(&mut self, excitation: &Excitation) -> Result<()> {
        self.clock.set_excitation(excitation)?;
        let next = Forcing::new(excitation, 0.0)?;
        for (tone, next) in self.tones.iter_mut().flatten().zip(next.tones()) {
            *tone = Tone { phase: tone.phase, ..*next };
        }
        Ok(())
    }

    /// Largest angular frequency in rad/s within a smooth stretch of the force.
    pub fn fastest(&self) -> f64 {
        self.tones().map(Tone::omega).fold(0.0, f64::max)
    }

    /// The force in N at `t` seconds from now, before its next tick.
    pub fn force(&self, t: f64) -> f64 {
        self.tones().map(|tone| tone.force * (tone.phase + tone.omega() * t).cos()).sum::<f64>()
            + self.clock.constant()
    }

    /// Terms of the force in powers of time over `duration` seconds.
    #[inline]
    pub fn terms(&self, duration: f64) -> Terms {
        let mut terms = [0.0; ORDER + 1];
        for tone in self.tones() {
            let (sin, cos) = tone.phase.sin_cos();
            let (mut re, mut im) = (tone.force * cos, tone.force * sin);
            let turn = tone.omega() * duration;
            for (k, term) in terms.iter_mut().enumerate() {
                *term += re;
                let step = turn / (k + 1) as f64;
                (re, im) = (-step * im, step * re);
            }
        }
        terms[0] += self.clock.constant();
        terms
    }

    /// Lets `t` seconds pass, at most up to the next tick.
    #[inline]
    pub fn pass(&mut self, t: f64) {
        for tone in self.tones.iter_mut().flatten() {
            tone.phase = within(tone.phase + tone.omega() * t);
        }
        self.clock.advance(t);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Sine, Sines};

    #[test]
    fn the_series_is_the_force() {
        let parts = vec![
            Part { force: 0.3, frequency: 5.0, phase: 0.4 },
            Part { force: 0.2, frequency: 7.5, phase: -2.0 },
        ];
        let drive = Forcing::new(&Excitation::Sines(Sines { parts }), 1.0).unwrap();
        let duration = 1.0 / drive.fastest();
        let terms = drive.terms(duration);
        for part in [0.0, 0.3, 1.0] {
            let sum = terms.iter().rev().fold(0.0, |sum, term| sum * part + term);
            let t = part * duration;
            // Phase 1 of the first sine's cycle is 1/ω₁ seconds.
            let past = t + 1.0 / (TAU * 5.0);
            let plain = 0.3 * (TAU * 5.0 * past + 0.4).cos() + 0.2 * (TAU * 7.5 * past - 2.0).cos();
            // Truncation 1/19!, rounding of angles below 10 rad.
            assert!((sum - plain).abs() < 0.5 * 16.0 * f64::EPSILON, "{sum} {plain}");
            assert!((drive.force(t) - plain).abs() < 0.5 * 16.0 * f64::EPSILON);
        }
    }

    #[test]
    fn a_change_of_frequency_makes_no_step_and_impossible_ones_are_refused() {
        let mut drive = Forcing::new(&Excitation::Sine(Sine { force: 0.5, frequency: 5.0 }), 0.3).unwrap();
        drive.pass(0.123);
        let (force, phase) = (drive.force(0.0), drive.phase());
        drive.set_frequency(9.0).unwrap();
        assert_eq!((drive.force(0.0), drive.phase(), drive.frequency()), (force, phase, 9.0));
        for hz in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            assert!(drive.set_frequency(hz).is_err(), "{hz}");
        }
        assert_eq!(drive.frequency(), 9.0);
        assert!(Forcing::new(&Excitation::Sine(Sine { force: 0.5, frequency: 5.0 }), f64::NAN).is_err());
    }
}

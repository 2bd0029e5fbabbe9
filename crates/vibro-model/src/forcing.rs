//! The exciting force as series in time, and its clock.

use super::clock::{Clock, Tick, within};
use super::linear::{ORDER, Terms};
use super::{Excitation, Part};
use std::f64::consts::TAU;
use vibro_record::Result;

/// One sine force, with its phase now.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Tone {
    force: f64,
    omega: f64,
    phase: f64,
}

/// The exciting force from now on.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Forcing {
    tones: Vec<Tone>,
    clock: Clock,
}

impl Forcing {
    /// The excitation in a cycle of which `phase` rad are past: a sine is F₀ cos(phase), an impulse falls on phase 0, a
    /// pulse begins there, and of several sines each is ahead by its own part of the time that the phase stands for.
    pub fn new(excitation: &Excitation, phase: f64) -> Result<Forcing> {
        let clock = Clock::new(excitation, phase)?;
        let (phase, frequency) = (clock.phase(), clock.frequency());
        let tone = |p: &Part| {
            let start = (p.phase + phase * (p.frequency / frequency)).rem_euclid(TAU);
            Tone { force: p.force, omega: TAU * p.frequency, phase: start }
        };
        let tones = match excitation {
            Excitation::Sine(sine) => vec![Tone { force: sine.force, omega: TAU * frequency, phase }],
            Excitation::Sines(sines) => sines.parts.iter().map(tone).collect(),
            Excitation::Impulse(_) | Excitation::Pulse(_) => Vec::new(),
        };
        Ok(Forcing { tones, clock })
    }

    /// Phase of the cycle in 0..2π.
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
        for tone in &mut self.tones {
            // The first sine counts the cycles: no rounding of its frequency.
            tone.omega = if tone.omega == TAU * before { TAU * hz } else { tone.omega * (hz / before) };
        }
        Ok(())
    }

    /// Goes on under another excitation of the same kind, whose phases are those of this one.
    pub fn set_excitation(&mut self, excitation: &Excitation) -> Result<()> {
        self.clock.set_excitation(excitation)?;
        let next = Forcing::new(excitation, 0.0)?;
        for (tone, next) in self.tones.iter_mut().zip(next.tones) {
            *tone = Tone { phase: tone.phase, ..next };
        }
        Ok(())
    }

    /// Largest angular frequency in rad/s within a smooth stretch of the force.
    pub fn fastest(&self) -> f64 {
        self.tones.iter().map(|t| t.omega).fold(0.0, f64::max)
    }

    /// The force in N at `t` seconds from now, before its next tick.
    pub fn force(&self, t: f64) -> f64 {
        self.tones.iter().map(|tone| tone.force * (tone.phase + tone.omega * t).cos()).sum::<f64>()
            + self.steady()
    }

    /// Terms of the force in powers of time over `duration` seconds.
    #[inline]
    pub fn terms(&self, duration: f64) -> Terms {
        let mut terms = [0.0; ORDER + 1];
        for tone in &self.tones {
            let (sin, cos) = tone.phase.sin_cos();
            let (mut re, mut im) = (tone.force * cos, tone.force * sin);
            let turn = tone.omega * duration;
            for (k, term) in terms.iter_mut().enumerate() {
                *term += re;
                let step = turn / (k + 1) as f64;
                (re, im) = (-step * im, step * re);
            }
        }
        terms[0] += self.steady();
        terms
    }

    fn steady(&self) -> f64 {
        self.clock.constant()
    }

    /// As [`Clock::next`].
    pub fn next(&self, span: f64, end: f64) -> (f64, Option<Tick>) {
        self.clock.next(span, end)
    }

    /// Lets `t` seconds pass, at most up to the next tick.
    pub fn pass(&mut self, t: f64) {
        for tone in &mut self.tones {
            tone.phase = within(tone.phase + tone.omega * t);
        }
        self.clock.advance(t);
    }

    /// Does what is due now.
    pub fn tick(&mut self, tick: Tick) {
        self.clock.tick(tick);
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

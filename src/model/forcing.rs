//! The exciting force as a motion meets it: series in time, and the times at which it jumps.

use super::linear::{ORDER, Terms};
use super::motion::Event;
use super::{Excitation, Part};
use crate::error::{Error, Result};
use std::f64::consts::TAU;

/// One sine force, with its phase now.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Tone {
    force: f64,
    omega: f64,
    phase: f64,
}

/// What happens once a cycle.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Jumps {
    None,
    /// An impulse in N s; `due` where it falls on the very start.
    Kick {
        impulse: f64,
        due: bool,
    },
    /// A force in N for a width in s from the cycle's beginning; `on` while it acts.
    Pulse {
        force: f64,
        width: f64,
        on: bool,
    },
}

/// The exciting force from now on.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Forcing {
    excitation: Excitation,
    tones: Vec<Tone>,
    jumps: Jumps,
    omega: f64,
    phase: f64,
}

impl Forcing {
    /// The excitation in a cycle of which `phase` rad are past: a sine is F₀ cos(phase), an impulse falls on phase 0, a
    /// pulse begins there, and of several sines each is ahead by its own part of the time that the phase stands for.
    pub fn new(excitation: &Excitation, phase: f64) -> Result<Forcing> {
        excitation.check()?;
        if !phase.is_finite() {
            return Err(Error::usage(format!("phase is {phase} rad"), "a finite value"));
        }
        let omega = TAU * excitation.frequency();
        let phase = phase.rem_euclid(TAU);
        let tone = |p: &Part| {
            let own = TAU * p.frequency;
            Tone { force: p.force, omega: own, phase: (p.phase + phase * (own / omega)).rem_euclid(TAU) }
        };
        let (tones, jumps) = match excitation {
            Excitation::Sine(sine) => (vec![Tone { force: sine.force, omega, phase }], Jumps::None),
            Excitation::Sines(sines) => (sines.parts.iter().map(tone).collect(), Jumps::None),
            Excitation::Impulse(i) => (Vec::new(), Jumps::Kick { impulse: i.impulse, due: phase == 0.0 }),
            Excitation::Pulse(p) => {
                let on = phase < p.width * omega;
                (Vec::new(), Jumps::Pulse { force: p.force, width: p.width, on })
            }
        };
        Ok(Forcing { excitation: excitation.clone(), tones, jumps, omega, phase })
    }

    /// Phase of the cycle in 0..2π.
    pub fn phase(&self) -> f64 {
        self.phase
    }

    /// Frequency of the cycle in Hz.
    pub fn frequency(&self) -> f64 {
        self.excitation.frequency()
    }

    /// Changes the frequency from now on; every phase goes on.
    pub fn set_frequency(&mut self, hz: f64) -> Result<()> {
        let excitation = self.excitation.at_frequency(hz);
        excitation.check()?;
        let ratio = hz / self.frequency();
        for tone in &mut self.tones {
            tone.omega *= ratio;
        }
        self.omega = TAU * hz;
        self.excitation = excitation;
        Ok(())
    }

    /// Largest angular frequency in rad/s within a smooth stretch of the force.
    pub fn fastest(&self) -> f64 {
        self.tones.iter().map(|t| t.omega).fold(0.0, f64::max)
    }

    /// The force in N at `t` seconds from now, before its next jump.
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
        match self.jumps {
            Jumps::Pulse { force, on: true, .. } => force,
            _ => 0.0,
        }
    }

    /// Seconds to the next jump.
    pub fn next_jump(&self) -> f64 {
        let rest = || ((TAU - self.phase) / self.omega).max(0.0);
        match self.jumps {
            Jumps::None => f64::INFINITY,
            Jumps::Kick { due: true, .. } => 0.0,
            Jumps::Kick { .. } | Jumps::Pulse { on: false, .. } => rest(),
            Jumps::Pulse { width, on: true, .. } => (width - self.phase / self.omega).max(0.0),
        }
    }

    /// Lets `t` seconds pass, at most up to the next jump.
    pub fn pass(&mut self, t: f64) {
        let turn = |phase: f64, omega: f64| {
            let phase = phase + omega * t;
            // A jump at the end of the cycle is taken before the next cycle begins.
            if phase < TAU { phase } else { phase.rem_euclid(TAU) }
        };
        for tone in &mut self.tones {
            tone.phase = turn(tone.phase, tone.omega);
        }
        self.phase = match self.jumps {
            Jumps::None => turn(self.phase, self.omega),
            // Stays below 2π until the jump has been made.
            _ => (self.phase + self.omega * t).min(TAU),
        };
    }

    /// Makes the jump that is due now: its impulse in N s and what to call it.
    pub fn jump(&mut self) -> (f64, Event) {
        match &mut self.jumps {
            Jumps::None => (0.0, Event::Switch),
            Jumps::Kick { impulse, due } => {
                *due = false;
                self.phase = 0.0;
                (*impulse, Event::Kick)
            }
            Jumps::Pulse { on, .. } => {
                if !*on {
                    self.phase = 0.0;
                }
                *on = !*on;
                (0.0, Event::Switch)
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::{Impulses, Pulses, Sine, Sines};

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
    fn jumps_come_once_a_cycle() {
        let pulses = Pulses { force: 0.5, width: 0.01, frequency: 5.0 };
        let mut drive = Forcing::new(&Excitation::Pulse(pulses), 0.0).unwrap();
        let mut times = Vec::new();
        let mut time = 0.0;
        for _ in 0..4 {
            let wait = drive.next_jump();
            time += wait;
            times.push(time);
            drive.pass(wait);
            assert_eq!(drive.jump(), (0.0, Event::Switch));
        }
        for (found, expected) in times.iter().zip([0.01, 0.2, 0.21, 0.4]) {
            assert!((found - expected).abs() < 1e-15, "{times:?}");
        }
        let impulses = Impulses { impulse: 0.009, frequency: 5.0 };
        let mut drive = Forcing::new(&Excitation::Impulse(impulses), 0.0).unwrap();
        assert_eq!(drive.next_jump(), 0.0);
        assert_eq!(drive.jump(), (0.009, Event::Kick));
        assert!((drive.next_jump() - 0.2).abs() < 1e-16);
        drive.pass(0.05);
        drive.set_frequency(10.0).unwrap();
        // Three quarters of a cycle are left.
        assert!((drive.next_jump() - 0.075).abs() < 1e-16);
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

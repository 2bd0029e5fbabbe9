//! Excitation under way: the phases of its sines, and when its next impulse or step of force is due.

use super::excitation::MOST_SINES;
use super::receptance::receptance;
use super::waves::Waves;
use super::{Excitation, Rig, Sine, Steady};
use crate::error::{Error, Result};
use num_complex::Complex64;
use std::f64::consts::TAU;

/// 2π less [`TAU`].
const TAU_REST: f64 = 2.449_293_598_294_706_4e-16;

/// What an excitation does at an instant.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Tick {
    /// An impulse in N s.
    Kick(f64),
    /// A pulse begins.
    On,
    /// A pulse ends.
    Off,
}

/// What is repeated once a cycle.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Train {
    /// One sine, whose phase is that of the cycle.
    Sine,
    /// Several sines, each with its own phase.
    Sines,
    /// An impulse in N s.
    Impulses(f64),
    /// A force in N for a time in s.
    Pulses { force: f64, width: f64 },
}

/// A sine under way.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Line {
    force: f64,
    frequency: f64,
    omega: f64,
    phase: f64,
    /// F L₁(iω), of mass 1 alone, in m, and its modulus.
    alone: Complex64,
    amplitude: f64,
    /// F L(iω) of both masses together, in m; not finite where they are driven at their undamped resonance.
    together: Complex64,
}

/// An excitation under way.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Drive {
    lines: [Option<Line>; MOST_SINES],
    train: Train,
    /// Cycles a second.
    frequency: f64,
    phase: f64,
    /// Rest of the pulse under way in s; 0 where there is none.
    left: f64,
    /// Whether the cycle's beginning is still to come at phase 0.
    due: bool,
}

impl Drive {
    /// Excitation of `rig` at `phase` of its cycle; each of several sines has its own phase at phase 0 and has gone on since.
    pub fn new(rig: &Rig, excitation: &Excitation, phase: f64) -> Result<Drive> {
        rig.check()?;
        excitation.check()?;
        let frequency = excitation.frequency();
        let phase = phase.rem_euclid(TAU);
        // The remainder of a tiny negative phase rounds to 2π.
        let phase = if phase < TAU { phase } else { 0.0 };
        let mut drive = Drive {
            lines: [None; MOST_SINES],
            train: Train::Sine,
            frequency,
            phase,
            left: 0.0,
            due: phase == 0.0,
        };
        match excitation {
            Excitation::Sine(sine) => drive.lines[0] = Some(Line::new(rig, sine, phase)?),
            Excitation::Sines(sines) => {
                if sines.parts.len() > MOST_SINES {
                    let found = format!("{} sines", sines.parts.len());
                    return Err(Error::usage(found, format!("no more than {MOST_SINES}")));
                }
                drive.train = Train::Sines;
                for (line, part) in drive.lines.iter_mut().zip(&sines.parts) {
                    let sine = Sine { force: part.force, frequency: part.frequency };
                    let start = part.phase + phase * part.frequency / frequency;
                    *line = Some(Line::new(rig, &sine, start.rem_euclid(TAU))?);
                }
            }
            Excitation::Impulse(impulses) => drive.train = Train::Impulses(impulses.impulse),
            Excitation::Pulse(pulses) => {
                let (force, width) = (pulses.force, pulses.width);
                drive.train = Train::Pulses { force, width };
                if !drive.due {
                    drive.left = (width - phase / (TAU * frequency)).max(0.0);
                }
            }
        }
        Ok(drive)
    }

    /// Phase of the cycle in 0..2π.
    pub fn phase(&self) -> f64 {
        self.phase
    }

    /// Cycles a second in Hz.
    pub fn frequency(&self) -> f64 {
        self.frequency
    }

    /// Goes on at another frequency of the cycle in Hz; several sines keep the ratios of theirs.
    pub fn set_frequency(&mut self, rig: &Rig, frequency: f64) -> Result<()> {
        Sine { force: 0.0, frequency }.check()?;
        if let Train::Pulses { width, .. } = self.train
            && width * frequency >= 1.0
        {
            let found = format!("pulses of {width} s at {frequency} Hz");
            return Err(Error::usage(found, "a width below the cycle"));
        }
        let ratio = frequency / self.frequency;
        let mut lines = self.lines;
        for line in lines.iter_mut().flatten() {
            // The first sine counts the cycles: no rounding of its frequency.
            let own = if line.frequency == self.frequency { frequency } else { line.frequency * ratio };
            *line = Line::new(rig, &Sine { force: line.force, frequency: own }, line.phase)?;
        }
        (self.lines, self.frequency) = (lines, frequency);
        Ok(())
    }

    /// Force in N that is constant up to the next tick.
    pub fn constant(&self) -> f64 {
        match self.train {
            Train::Pulses { force, .. } if self.left > 0.0 => force,
            _ => 0.0,
        }
    }

    /// Forced motion of mass 1 alone from now on.
    #[inline]
    pub fn alone(&self) -> Waves {
        let mut waves = Waves::default();
        for line in self.lines.iter().flatten() {
            waves.add(line.alone * turn(line.phase), line.omega, line.amplitude);
        }
        waves
    }

    /// Forced motion of both masses together from now on.
    pub fn together(&self) -> Waves {
        let mut waves = Waves::default();
        for line in self.lines.iter().flatten() {
            waves.add(line.together * turn(line.phase), line.omega, line.together.norm());
        }
        waves
    }

    /// Seconds to the next tick, and what it does; infinite where there is none.
    #[inline]
    pub fn next(&self) -> (f64, Option<Tick>) {
        let (whole, begin) = match self.train {
            Train::Sine | Train::Sines => return (f64::INFINITY, None),
            Train::Impulses(impulse) => (self.whole(), Tick::Kick(impulse)),
            Train::Pulses { .. } => (self.whole(), Tick::On),
        };
        if self.left > 0.0 && self.left < whole { (self.left, Some(Tick::Off)) } else { (whole, Some(begin)) }
    }

    /// Seconds to the beginning of the next cycle.
    fn whole(&self) -> f64 {
        if self.due { 0.0 } else { (TAU - self.phase) / (TAU * self.frequency) }
    }

    /// Goes on by `dt` seconds, no further than to the next tick.
    #[inline]
    pub fn advance(&mut self, dt: f64) {
        for line in self.lines.iter_mut().flatten() {
            line.phase = within(line.phase + line.omega * dt);
        }
        match (&self.train, &self.lines[0]) {
            (Train::Sine, Some(line)) => {
                self.phase = line.phase;
                return;
            }
            (Train::Sine | Train::Sines, _) => {
                self.phase = within(self.phase + TAU * self.frequency * dt);
                return;
            }
            _ => {}
        }
        // The cycle ends by its tick.
        self.phase = (self.phase + TAU * self.frequency * dt).min(TAU.next_down());
        if dt > 0.0 {
            self.due = false;
        }
        self.left = (self.left - dt).max(0.0);
    }

    /// Does what is due now.
    pub fn tick(&mut self, tick: Tick) {
        if tick == Tick::Off {
            self.left = 0.0;
            return;
        }
        (self.phase, self.due) = (0.0, false);
        if let Train::Pulses { width, .. } = self.train {
            self.left = width;
        }
    }
}

impl Line {
    fn new(rig: &Rig, sine: &Sine, phase: f64) -> Result<Line> {
        let steady = Steady::new(rig, sine)?;
        let (m, c, k) = (rig.m1 + rig.m2, rig.c1 + rig.c2, rig.k1 + rig.k2);
        Ok(Line {
            force: sine.force,
            frequency: sine.frequency,
            omega: steady.omega,
            phase,
            alone: steady.response,
            amplitude: steady.amplitude(),
            together: receptance(m, c, k, steady.omega) * sine.force,
        })
    }
}

/// e^{iφ}.
#[inline]
fn turn(phase: f64) -> Complex64 {
    let (sin, cos) = crate::math::cis::sin_cos(phase);
    Complex64::new(cos, sin)
}

/// A phase of 0 or more within 0..2π.
#[inline]
fn within(phase: f64) -> f64 {
    if phase < TAU {
        return phase;
    }
    let turns = (phase / TAU).floor();
    let rest = (phase - turns * TAU) - turns * TAU_REST;
    if (0.0..TAU).contains(&rest) { rest } else { phase.rem_euclid(TAU) }
}

//! Excitation under way, as closed forms take it: the forced motion under its sines, and its clock.

pub(super) use super::clock::Tick;
use super::clock::{Clock, within};
use super::excitation::MOST_SINES;
use super::receptance::receptance;
use super::waves::Waves;
use super::{Excitation, Rig, Sine, Steady, scales};
use num_complex::Complex64;
use std::f64::consts::TAU;
use vibro_record::Result;

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
    /// F L(iω) of both masses together, in m; not finite where they are driven at their undamped resonance. Against a wall, F in N.
    together: Complex64,
}

/// An excitation under way.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Drive {
    lines: [Option<Line>; MOST_SINES],
    /// Whether there is one sine, whose phase is that of the cycle.
    single: bool,
    clock: Clock,
}

impl Drive {
    /// Excitation of `rig` at `phase` of its cycle; each of several sines has its own phase at phase 0 and has gone on since.
    pub fn new(rig: &Rig, excitation: &Excitation, phase: f64) -> Result<Drive> {
        scales::check(rig, excitation)?;
        let clock = Clock::new(excitation, phase)?;
        let single = matches!(excitation, Excitation::Sine(_));
        let mut drive = Drive { lines: [None; MOST_SINES], single, clock };
        match excitation {
            Excitation::Sine(sine) => drive.lines[0] = Some(Line::new(rig, sine, clock.phase())?),
            Excitation::Sines(sines) => {
                for (line, part) in drive.lines.iter_mut().zip(&sines.parts) {
                    let sine = Sine { force: part.force, frequency: part.frequency };
                    let start = part.phase + clock.phase() * part.frequency / clock.frequency();
                    *line = Some(Line::new(rig, &sine, start.rem_euclid(TAU))?);
                }
            }
            Excitation::Impulse(_) | Excitation::Pulse(_) => {}
        }
        Ok(drive)
    }

    /// Phase of the cycle in 0..2π.
    #[inline]
    pub fn phase(&self) -> f64 {
        self.clock.phase()
    }

    /// Cycles a second in Hz.
    pub fn frequency(&self) -> f64 {
        self.clock.frequency()
    }

    /// Goes on at another frequency of the cycle in Hz; several sines keep the ratios of theirs.
    pub fn set_frequency(&mut self, rig: &Rig, frequency: f64) -> Result<()> {
        let (mut clock, mut lines) = (self.clock, self.lines);
        let before = clock.frequency();
        clock.set_frequency(frequency)?;
        for line in lines.iter_mut().flatten() {
            // The first sine counts the cycles: no rounding of its frequency.
            let own =
                if line.frequency == before { frequency } else { line.frequency * (frequency / before) };
            *line = Line::new(rig, &Sine { force: line.force, frequency: own }, line.phase)?;
        }
        (self.lines, self.clock) = (lines, clock);
        Ok(())
    }

    /// Goes on under another excitation of the same kind, whose phases are those of this one.
    pub fn set_excitation(&mut self, rig: &Rig, excitation: &Excitation) -> Result<()> {
        let mut clock = self.clock;
        clock.set_excitation(excitation)?;
        let mut next = Drive::new(rig, excitation, 0.0)?;
        for (line, before) in next.lines.iter_mut().zip(&self.lines) {
            if let (Some(line), Some(before)) = (line, before) {
                line.phase = before.phase;
            }
        }
        *self = Drive { clock, ..next };
        Ok(())
    }

    /// Force in N that is constant up to the next tick.
    #[inline]
    pub fn constant(&self) -> f64 {
        self.clock.constant()
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

    /// Forced motion of both masses together from now on, in m; against a wall the sine forces in N.
    pub fn together(&self) -> Waves {
        let mut waves = Waves::default();
        for line in self.lines.iter().flatten() {
            waves.add(line.together * turn(line.phase), line.omega, line.together.norm());
        }
        waves
    }

    /// As [`Clock::next`].
    #[inline]
    pub fn next(&self, span: f64, end: f64) -> (f64, Option<Tick>) {
        self.clock.next(span, end)
    }

    /// Goes on by `dt` seconds, no further than to the next tick.
    #[inline]
    pub fn advance(&mut self, dt: f64) {
        self.clock.advance(dt);
        if let (true, Some(line)) = (self.single, &mut self.lines[0]) {
            line.phase = self.clock.phase();
            return;
        }
        for line in self.lines.iter_mut().flatten() {
            line.phase = within(line.phase + line.omega * dt);
        }
    }

    /// Does what is due now.
    pub fn tick(&mut self, tick: Tick) {
        self.clock.tick(tick);
    }
}

impl Line {
    fn new(rig: &Rig, sine: &Sine, phase: f64) -> Result<Line> {
        let steady = Steady::new(rig, sine)?;
        let compliance = if rig.has_wall() {
            Complex64::ONE
        } else {
            receptance(rig.m1 + rig.m2, rig.c1 + rig.c2, rig.k1 + rig.k2, steady.omega)
        };
        Ok(Line {
            force: sine.force,
            frequency: sine.frequency,
            omega: steady.omega,
            phase,
            alone: steady.response,
            amplitude: steady.amplitude(),
            together: compliance * sine.force,
        })
    }
}

/// e^{iφ}.
#[inline]
fn turn(phase: f64) -> Complex64 {
    let (sin, cos) = vibro_math::cis::sin_cos(phase);
    Complex64::new(cos, sin)
}

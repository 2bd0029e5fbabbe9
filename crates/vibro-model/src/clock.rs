//! The clock of an excitation: where in its cycle it is, and when its next impulse or step of force is due.

use super::scales::{Least, number};
use super::{Excitation, Sine};
use std::f64::consts::TAU;
use vibro_record::{Error, Result};

/// 2π less [`TAU`].
const TAU_REST: f64 = 2.449_293_598_294_706_4e-16;

/// Part of a cycle to which the clock is known after thousands of flights: a few hundred roundings of the phase.
const KNOWN: f64 = 1e-12;

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
    /// So many sines.
    Sines(usize),
    /// An impulse in N s.
    Impulses(f64),
    /// A force in N for a time in s.
    Pulses { force: f64, width: f64 },
}

/// Where an excitation is in its cycle.
///
/// At phase 0, and only there, the cycle's impulse or pulse is still to come; once it has come the phase is above 0, if only by the
/// least number there is. So a phase tells whether it is to come, and a motion that starts again from its phase has it once.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Clock {
    train: Train,
    /// Cycles a second.
    frequency: f64,
    phase: f64,
    /// Rest of the pulse under way in s; 0 where there is none.
    left: f64,
}

impl Clock {
    /// The clock of an excitation at `phase` (rad).
    pub fn new(excitation: &Excitation, phase: f64) -> Result<Clock> {
        excitation.check()?;
        number("phase", phase, "rad", Least::Any)?;
        let frequency = excitation.frequency();
        let phase = phase.rem_euclid(TAU);
        // The remainder of a tiny negative phase rounds to 2π.
        let phase = if phase < TAU { phase } else { 0.0 };
        let (train, left) = match excitation {
            Excitation::Sine(_) => (Train::Sines(1), 0.0),
            Excitation::Sines(sines) => (Train::Sines(sines.parts.len()), 0.0),
            Excitation::Impulse(impulses) => (Train::Impulses(impulses.impulse), 0.0),
            Excitation::Pulse(pulses) => {
                let (force, width) = (pulses.force, pulses.width);
                let left = if phase == 0.0 { 0.0 } else { (width - phase / (TAU * frequency)).max(0.0) };
                (Train::Pulses { force, width }, left)
            }
        };
        Ok(Clock { train, frequency, phase, left })
    }

    /// Phase of the cycle in 0..2π.
    #[inline]
    pub fn phase(&self) -> f64 {
        self.phase
    }

    /// Cycles a second in Hz.
    pub fn frequency(&self) -> f64 {
        self.frequency
    }

    /// Goes on at another frequency in Hz; a pulse under way keeps its width.
    pub fn set_frequency(&mut self, frequency: f64) -> Result<()> {
        Sine { force: 0.0, frequency }.check()?;
        if let Train::Pulses { width, .. } = self.train
            && width * frequency >= 1.0
        {
            let found = format!("pulses of {width} s at {frequency} Hz");
            return Err(Error::usage(found, "a width below the cycle"));
        }
        self.frequency = frequency;
        Ok(())
    }

    /// Goes on under another excitation of the same kind; a pulse under way keeps its width.
    pub fn set_excitation(&mut self, excitation: &Excitation) -> Result<()> {
        let Clock { train, frequency, .. } = Clock::new(excitation, 0.0)?;
        match (self.train, train) {
            (Train::Sines(before), Train::Sines(after)) if before == after => {}
            (Train::Impulses(_), Train::Impulses(_)) | (Train::Pulses { .. }, Train::Pulses { .. }) => {}
            _ => {
                let found = format!("a change of the excitation to {}", excitation.kind());
                return Err(Error::usage(found, "one of the same kind, with as many sines"));
            }
        }
        (self.train, self.frequency) = (train, frequency);
        Ok(())
    }

    /// Force in N that is constant up to the next tick.
    #[inline]
    pub fn constant(&self) -> f64 {
        match self.train {
            Train::Pulses { force, .. } if self.left > 0.0 => force,
            _ => 0.0,
        }
    }

    /// Seconds to the next tick in a motion of `span` seconds up to the time `end`, and what it does; infinite where there is none.
    ///
    /// What falls on the end, as closely as time and phase are known, is left to what follows: a cycle begins with its impulse.
    #[inline]
    pub fn next(&self, span: f64, end: f64) -> (f64, Option<Tick>) {
        let begin = match self.train {
            Train::Sines(_) => return (f64::INFINITY, None),
            Train::Impulses(impulse) => Tick::Kick(impulse),
            Train::Pulses { .. } => Tick::On,
        };
        let whole = if self.phase == 0.0 { 0.0 } else { (TAU - self.phase) / (TAU * self.frequency) };
        let (wait, tick) =
            if self.left > 0.0 && self.left < whole { (self.left, Tick::Off) } else { (whole, begin) };
        let known = KNOWN / self.frequency + 4.0 * f64::EPSILON * end.abs();
        if wait + known < span { (wait, Some(tick)) } else { (f64::INFINITY, None) }
    }

    /// Goes on by `dt` seconds, no further than to the next tick, which stays to come.
    #[inline]
    pub fn advance(&mut self, dt: f64) {
        let phase = self.phase + TAU * self.frequency * dt;
        if let Train::Sines(_) = self.train {
            self.phase = within(phase);
            return;
        }
        if self.phase > 0.0 {
            self.phase = phase.min(TAU.next_down());
        }
        if self.left > 0.0 {
            self.left = (self.left - dt).max(f64::MIN_POSITIVE);
        }
    }

    /// Does what is due now.
    pub fn tick(&mut self, tick: Tick) {
        if tick == Tick::Off {
            self.left = 0.0;
            return;
        }
        self.phase = f64::MIN_POSITIVE;
        if let Train::Pulses { width, .. } = self.train {
            self.left = width;
        }
    }
}

/// A phase of 0 or more within 0..2π.
#[inline]
pub(super) fn within(phase: f64) -> f64 {
    if phase < TAU {
        return phase;
    }
    let turns = (phase / TAU).floor();
    let rest = (phase - turns * TAU) - turns * TAU_REST;
    if (0.0..TAU).contains(&rest) { rest } else { phase.rem_euclid(TAU) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Impulses, Pulses};

    /// Goes through the next `n` ticks and says when they come.
    fn times(clock: &mut Clock, n: usize) -> Vec<(f64, Tick)> {
        let mut time = 0.0;
        (0..n)
            .map(|_| {
                let (wait, tick) = clock.next(f64::INFINITY, 0.0);
                clock.advance(wait);
                clock.tick(tick.unwrap());
                time += wait;
                (time, tick.unwrap())
            })
            .collect()
    }

    #[test]
    fn ticks_come_once_a_cycle() {
        let pulses = Pulses { force: 0.5, width: 0.01, frequency: 5.0 };
        let mut clock = Clock::new(&Excitation::Pulse(pulses), 0.0).unwrap();
        let expected = [(0.0, Tick::On), (0.01, Tick::Off), (0.2, Tick::On), (0.21, Tick::Off)];
        for ((time, tick), (at, what)) in times(&mut clock, 4).into_iter().zip(expected) {
            assert!((time - at).abs() < 1e-15 && tick == what, "{time} {at}");
        }
        let impulses = Excitation::Impulse(Impulses { impulse: 0.009, frequency: 5.0 });
        let mut clock = Clock::new(&impulses, 0.0).unwrap();
        for ((time, tick), at) in times(&mut clock, 3).into_iter().zip([0.0, 0.2, 0.4]) {
            assert!((time - at).abs() < 1e-15 && tick == Tick::Kick(0.009), "{time} {at}");
        }
        clock.advance(0.05);
        clock.set_frequency(10.0).unwrap();
        // Three quarters of a cycle are left.
        assert!((clock.next(f64::INFINITY, 0.0).0 - 0.075).abs() < 1e-16);
    }

    #[test]
    fn a_start_at_its_phase_has_every_impulse_once() {
        let impulses = Excitation::Impulse(Impulses { impulse: 0.009, frequency: 5.0 });
        let mut clock = Clock::new(&impulses, 0.0).unwrap();
        // What falls on the end of a motion is left to what follows.
        assert_eq!(clock.next(0.0, 0.0), (f64::INFINITY, None));
        times(&mut clock, 1);
        assert_eq!(Clock::new(&impulses, clock.phase()).unwrap(), clock);
        assert_eq!(clock.next(0.2, 0.2), (f64::INFINITY, None));
        clock.advance(0.2);
        assert_eq!(Clock::new(&impulses, clock.phase()).unwrap(), clock);
        let (wait, tick) = clock.next(0.2, 0.4);
        assert!(wait < 1e-15 && tick == Some(Tick::Kick(0.009)), "{wait}");
    }

    #[test]
    fn a_pulse_under_way_keeps_its_width() {
        let pulses = Pulses { force: 0.5, width: 0.01, frequency: 5.0 };
        let mut clock = Clock::new(&Excitation::Pulse(pulses), 0.0).unwrap();
        times(&mut clock, 1);
        clock.advance(0.004);
        clock.set_frequency(20.0).unwrap();
        let louder = Excitation::Pulse(Pulses { force: 2.0, frequency: 20.0, ..pulses });
        clock.set_excitation(&louder).unwrap();
        let (wait, tick) = clock.next(f64::INFINITY, 0.0);
        assert!((wait - 0.006).abs() < 1e-17 && tick == Some(Tick::Off) && clock.constant() == 2.0);
        assert!(clock.set_frequency(100.0).is_err());
        assert!(clock.set_excitation(&Sine { force: 1.0, frequency: 5.0 }.into()).is_err());
    }
}

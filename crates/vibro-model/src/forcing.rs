//! State of the excitation during a motion: its sines as time series, the phase of its cycle, and its next
//! impulse or step.

use super::excitation::{Excitation, Part, Pulses, Sine};
use super::least::{NumberRange, number};
use super::linear::{ORDER, Terms};
use super::waves::MOST_SINES;
use std::f64::consts::TAU;
use std::mem::discriminant;
use vibro_record::{Error, Result};

/// 2π − [`TAU`]: the rounding error of the constant.
const TAU_ERROR: f64 = 2.449_293_598_294_706_4e-16;

/// Error of the phase in cycles after thousands of flights: several thousand roundings.
const PHASE_ERROR: f64 = 1e-12;

/// Sudden change of an excitation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Tick {
    /// An impulse in N s.
    Kick(f64),
    /// A pulse begins.
    On,
    /// A pulse ends.
    Off,
}

/// The part of the force that comes once a cycle.
#[derive(Debug, Clone, Copy, PartialEq)]
enum ForceTrain {
    /// None: the force is smooth.
    None,
    /// An impulse in N s.
    Impulses(f64),
    /// A force in N that lasts `width` (s).
    Pulses { force: f64, width: f64 },
}

/// One sine force: amplitude in N, frequency in Hz, present phase in rad.
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

/// State of the excitation from now on.
///
/// At phase exactly 0 the impulse or pulse of the cycle has not yet been applied. When it is applied, the
/// phase becomes the smallest number above 0. So a simulation that starts again from a stored phase
/// applies it exactly once.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Forcing {
    tones: [Option<Tone>; MOST_SINES],
    train: ForceTrain,
    /// Frequency of the cycle in Hz.
    pub frequency: f64,
    /// Phase of the cycle in 0..2π.
    pub phase: f64,
    /// Remaining time in s of the present pulse; 0 between pulses.
    pulse_left: f64,
}

impl Forcing {
    /// The excitation at `phase` (rad) of its cycle: a sine is F₀ cos(phase), an impulse or the start of a
    /// pulse is at phase 0. Several sines advance from their own phases by the time `phase`/ω₁ of the first
    /// one.
    pub fn new(excitation: &Excitation, phase: f64) -> Result<Forcing> {
        excitation.check()?;
        number("phase", phase, "rad", NumberRange::Any)?;
        let frequency = excitation.frequency();
        let phase = phase.rem_euclid(TAU);
        // For a tiny negative phase, rem_euclid rounds to 2π.
        let phase = if phase < TAU { phase } else { 0.0 };
        let tones = [None; MOST_SINES];
        let mut forcing = Forcing { tones, train: ForceTrain::None, frequency, phase, pulse_left: 0.0 };
        match excitation {
            Excitation::Sine(sine) => {
                forcing.tones[0] = Some(Tone { force: sine.force, frequency, phase });
            }
            Excitation::Sines(sines) => {
                for (tone, part) in forcing.tones.iter_mut().zip(&sines.parts) {
                    let Part { force, frequency: own, phase: start } = *part;
                    let phase = (start + phase * (own / frequency)).rem_euclid(TAU);
                    *tone = Some(Tone { force, frequency: own, phase });
                }
            }
            Excitation::Impulse(impulses) => forcing.train = ForceTrain::Impulses(impulses.impulse),
            Excitation::Pulse(Pulses { force, width, .. }) => {
                forcing.train = ForceTrain::Pulses { force: *force, width: *width };
                if phase > 0.0 {
                    forcing.pulse_left = (width - phase / (TAU * frequency)).max(0.0);
                }
            }
        }
        Ok(forcing)
    }

    /// The sines of the force.
    #[inline]
    pub fn tones(&self) -> impl Iterator<Item = &Tone> {
        self.tones.iter().flatten()
    }

    /// Changes the frequency from now on; all phases are continuous, and the present pulse keeps its width.
    pub fn set_frequency(&mut self, hz: f64) -> Result<()> {
        Sine { force: 0.0, frequency: hz }.check()?;
        if let ForceTrain::Pulses { width, .. } = self.train
            && width * hz >= 1.0
        {
            let found = format!("pulses of {width} s at {hz} Hz");
            return Err(Error::usage(found, "a width below the cycle"));
        }
        let before = std::mem::replace(&mut self.frequency, hz);
        for tone in self.tones.iter_mut().flatten() {
            // The first sine gets the exact frequency, since it counts the cycles.
            tone.frequency = if tone.frequency == before { hz } else { tone.frequency * (hz / before) };
        }
        Ok(())
    }

    /// Changes to another excitation of the same kind; the phases continue, and the present pulse keeps its
    /// width.
    pub fn set_excitation(&mut self, excitation: &Excitation) -> Result<()> {
        let mut next =
            Forcing { phase: self.phase, pulse_left: self.pulse_left, ..Forcing::new(excitation, 0.0)? };
        if discriminant(&self.train) != discriminant(&next.train)
            || self.tones().count() != next.tones().count()
        {
            let found = format!("a change of the excitation to {}", excitation.kind());
            return Err(Error::usage(found, "one of the same kind, with as many sines"));
        }
        for (next, tone) in next.tones.iter_mut().flatten().zip(self.tones()) {
            next.phase = tone.phase;
        }
        *self = next;
        Ok(())
    }

    /// Largest angular frequency in rad/s of the smooth force.
    pub fn fastest(&self) -> f64 {
        self.tones().map(Tone::omega).fold(0.0, f64::max)
    }

    /// Constant part of the force in N until the next tick.
    #[inline]
    pub fn constant(&self) -> f64 {
        match self.train {
            ForceTrain::Pulses { force, .. } if self.pulse_left > 0.0 => force,
            _ => 0.0,
        }
    }

    /// Force in N, `t` seconds from now, if no tick comes before.
    pub fn force(&self, t: f64) -> f64 {
        self.tones().map(|tone| tone.force * (tone.phase + tone.omega() * t).cos()).sum::<f64>()
            + self.constant()
    }

    /// Taylor terms of the force in N over `duration` seconds: their sum is the force at its end.
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
        terms[0] += self.constant();
        terms
    }

    /// Time in s to the next tick in a motion of `span` seconds up to the time `end`, and the tick; infinite
    /// and `None` without one.
    ///
    /// A tick at `end`, within the errors of time and phase, belongs to the next motion: a cycle begins with
    /// its impulse.
    #[inline]
    pub fn next(&self, span: f64, end: f64) -> (f64, Option<Tick>) {
        let begin = match self.train {
            ForceTrain::None => return (f64::INFINITY, None),
            ForceTrain::Impulses(impulse) => Tick::Kick(impulse),
            ForceTrain::Pulses { .. } => Tick::On,
        };
        let whole = if self.phase == 0.0 { 0.0 } else { (TAU - self.phase) / (TAU * self.frequency) };
        let (wait, tick) = if self.pulse_left > 0.0 && self.pulse_left < whole {
            (self.pulse_left, Tick::Off)
        } else {
            (whole, begin)
        };
        let time_error = PHASE_ERROR / self.frequency + 4.0 * f64::EPSILON * end.abs();
        if wait + time_error < span { (wait, Some(tick)) } else { (f64::INFINITY, None) }
    }

    /// Advances by `t` seconds, at most to the next tick. It does not apply this tick.
    #[inline]
    pub fn pass(&mut self, t: f64) {
        for tone in self.tones.iter_mut().flatten() {
            tone.phase = within(tone.phase + tone.omega() * t);
        }
        let phase = self.phase + TAU * self.frequency * t;
        if self.train == ForceTrain::None {
            self.phase = within(phase);
        } else if self.phase > 0.0 {
            self.phase = phase.min(TAU.next_down());
        }
        if self.pulse_left > 0.0 {
            self.pulse_left = (self.pulse_left - t).max(f64::MIN_POSITIVE);
        }
    }

    /// Applies a tick that has been reached.
    pub fn tick(&mut self, tick: Tick) {
        if tick == Tick::Off {
            self.pulse_left = 0.0;
            return;
        }
        self.phase = f64::MIN_POSITIVE;
        if let ForceTrain::Pulses { width, .. } = self.train {
            self.pulse_left = width;
        }
    }
}

/// Reduces a phase of 0 or more to 0..2π.
#[inline]
fn within(phase: f64) -> f64 {
    if phase < TAU {
        return phase;
    }
    let turns = (phase / TAU).floor();
    let rest = (phase - turns * TAU) - turns * TAU_ERROR;
    if (0.0..TAU).contains(&rest) { rest } else { phase.rem_euclid(TAU) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::excitation::{Impulses, Pulses, Sine, Sines};

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
        let (force, phase) = (drive.force(0.0), drive.phase);
        drive.set_frequency(9.0).unwrap();
        assert_eq!((drive.force(0.0), drive.phase, drive.frequency), (force, phase, 9.0));
        for hz in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            assert!(drive.set_frequency(hz).is_err(), "{hz}");
        }
        assert_eq!(drive.frequency, 9.0);
        assert!(Forcing::new(&Excitation::Sine(Sine { force: 0.5, frequency: 5.0 }), f64::NAN).is_err());
    }

    /// Passes through the next `n` ticks and returns their times in s.
    fn times(clock: &mut Forcing, n: usize) -> Vec<(f64, Tick)> {
        let mut time = 0.0;
        (0..n)
            .map(|_| {
                let (wait, tick) = clock.next(f64::INFINITY, 0.0);
                clock.pass(wait);
                clock.tick(tick.unwrap());
                time += wait;
                (time, tick.unwrap())
            })
            .collect()
    }

    #[test]
    fn ticks_come_once_a_cycle() {
        let pulses = Pulses { force: 0.5, width: 0.01, frequency: 5.0 };
        let mut clock = Forcing::new(&Excitation::Pulse(pulses), 0.0).unwrap();
        let expected = [(0.0, Tick::On), (0.01, Tick::Off), (0.2, Tick::On), (0.21, Tick::Off)];
        for ((time, tick), (at, what)) in times(&mut clock, 4).into_iter().zip(expected) {
            assert!((time - at).abs() < 1e-15 && tick == what, "{time} {at}");
        }
        let impulses = Excitation::Impulse(Impulses { impulse: 0.009, frequency: 5.0 });
        let mut clock = Forcing::new(&impulses, 0.0).unwrap();
        for ((time, tick), at) in times(&mut clock, 3).into_iter().zip([0.0, 0.2, 0.4]) {
            assert!((time - at).abs() < 1e-15 && tick == Tick::Kick(0.009), "{time} {at}");
        }
        clock.pass(0.05);
        clock.set_frequency(10.0).unwrap();
        // Three quarters of the cycle remain.
        assert!((clock.next(f64::INFINITY, 0.0).0 - 0.075).abs() < 1e-16);
    }

    #[test]
    fn a_start_at_its_phase_has_every_impulse_once() {
        let impulses = Excitation::Impulse(Impulses { impulse: 0.009, frequency: 5.0 });
        let mut clock = Forcing::new(&impulses, 0.0).unwrap();
        // A tick at the end of a motion belongs to the next one.
        assert_eq!(clock.next(0.0, 0.0), (f64::INFINITY, None));
        times(&mut clock, 1);
        assert_eq!(Forcing::new(&impulses, clock.phase).unwrap(), clock);
        assert_eq!(clock.next(0.2, 0.2), (f64::INFINITY, None));
        clock.pass(0.2);
        assert_eq!(Forcing::new(&impulses, clock.phase).unwrap(), clock);
        let (wait, tick) = clock.next(0.2, 0.4);
        assert!(wait < 1e-15 && tick == Some(Tick::Kick(0.009)), "{wait}");
    }

    #[test]
    fn a_pulse_under_way_keeps_its_width() {
        let pulses = Pulses { force: 0.5, width: 0.01, frequency: 5.0 };
        let mut clock = Forcing::new(&Excitation::Pulse(pulses), 0.0).unwrap();
        times(&mut clock, 1);
        clock.pass(0.004);
        clock.set_frequency(20.0).unwrap();
        let louder = Excitation::Pulse(Pulses { force: 2.0, frequency: 20.0, ..pulses });
        clock.set_excitation(&louder).unwrap();
        let (wait, tick) = clock.next(f64::INFINITY, 0.0);
        assert!((wait - 0.006).abs() < 1e-17 && tick == Some(Tick::Off) && clock.constant() == 2.0);
        assert!(clock.set_frequency(100.0).is_err());
        assert!(clock.set_excitation(&Sine { force: 1.0, frequency: 5.0 }.into()).is_err());
    }
}

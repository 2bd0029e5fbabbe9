//! What an orbit knows of its excitation.

use crate::{Excitation, Impulses, Pulses, Sine};
use num_complex::Complex64;
use std::f64::consts::TAU;

/// Excitation of an orbit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Drive {
    /// Nothing: a free motion.
    None,
    /// A sine force of this amplitude in N.
    Sine(f64),
    /// An impulse in N s.
    Impulse(f64),
    /// A force in N for a width in s.
    Pulse(f64, f64),
}

impl Drive {
    /// The excitation at `frequency` (Hz); `None` of a free motion.
    pub fn excitation(&self, frequency: f64) -> Option<Excitation> {
        Some(match *self {
            Drive::None => return None,
            Drive::Sine(force) => Excitation::Sine(Sine { force, frequency }),
            Drive::Impulse(impulse) => Excitation::Impulse(Impulses { impulse, frequency }),
            Drive::Pulse(force, width) => Excitation::Pulse(Pulses { force, width, frequency }),
        })
    }

    /// Complex amplitude in N of the force's `n`-th harmonic (n ≥ 1) at `frequency` (Hz), the cycle being at `phase` (rad) at time 0.
    ///
    /// Impulses F have 2F/T in every harmonic; pulses (2f/T)(1 − e^{−inωw})/(inω).
    pub fn harmonic(&self, n: u32, frequency: f64, phase: f64) -> Complex64 {
        let turn = Complex64::cis(f64::from(n) * phase);
        match *self {
            Drive::None => Complex64::ZERO,
            Drive::Sine(force) => {
                if n == 1 {
                    turn * force
                } else {
                    Complex64::ZERO
                }
            }
            Drive::Impulse(impulse) => turn * (2.0 * impulse * frequency),
            Drive::Pulse(force, width) => {
                let half = f64::from(n) * TAU * frequency * width / 2.0;
                // 1 − e^{−2ih} = 2i sin h e^{−ih}.
                turn * Complex64::cis(-half) * (2.0 * force * frequency * width * half.sin() / half)
            }
        }
    }
}

//! Excitation during a simulation in closed form: its state, and the forced motion under its sines.

use super::excitation::{Excitation, Sine};
use super::forcing::Forcing;
use super::rig::Rig;
use super::scales;
use super::steady::Steady;
use super::waves::MOST_SINES;
use super::waves::Waves;
use num_complex::Complex64;
use vibro_record::Result;

/// Forced response to one sine force, at phase 0.
#[derive(Debug, Clone, Copy, PartialEq)]
struct SineResponse {
    /// F L₁(iω) in m, the response of mass 1 alone, and its modulus.
    alone: Complex64,
    amplitude: f64,
    /// F L(iω) in m, the response of both masses together; not finite where they are driven at their undamped
    /// resonance. Against a wall, F in N.
    together: Complex64,
}

/// State of an excitation, with the forced responses to its sines.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Drive {
    pub forcing: Forcing,
    lines: [Option<SineResponse>; MOST_SINES],
}

impl Drive {
    /// Excitation of `rig` at `phase` (rad) of its cycle; at phase 0 each of several sines has its own phase.
    pub fn new(rig: &Rig, excitation: &Excitation, phase: f64) -> Result<Drive> {
        scales::check(rig, excitation)?;
        Drive::with(rig, Forcing::new(excitation, phase)?)
    }

    fn with(rig: &Rig, forcing: Forcing) -> Result<Drive> {
        let mut lines = [None; MOST_SINES];
        for (line, tone) in lines.iter_mut().zip(forcing.tones()) {
            let steady = Steady::new(rig, &Sine { force: tone.force, frequency: tone.frequency })?;
            let compliance = rig.joined().map_or(Complex64::ONE, |both| both.receptance(steady.omega));
            let (alone, amplitude) = (steady.response, steady.amplitude());
            *line = Some(SineResponse { alone, amplitude, together: compliance * tone.force });
        }
        Ok(Drive { forcing, lines })
    }

    /// Lets `change` act on the force, and computes the forced responses again.
    pub fn change(&mut self, rig: &Rig, change: impl FnOnce(&mut Forcing) -> Result<()>) -> Result<()> {
        let mut forcing = self.forcing;
        change(&mut forcing)?;
        *self = Drive::with(rig, forcing)?;
        Ok(())
    }

    /// Forced motion of mass 1 alone from now on.
    #[inline]
    pub fn alone(&self) -> Waves {
        self.waves(|line| (line.alone, line.amplitude))
    }

    /// Forced motion of both masses together from now on, in m; against a wall the sine forces in N.
    pub fn together(&self) -> Waves {
        self.waves(|line| (line.together, line.together.norm()))
    }

    #[inline]
    fn waves(&self, of: impl Fn(&SineResponse) -> (Complex64, f64)) -> Waves {
        let mut waves = Waves::default();
        for (line, tone) in self.lines.iter().flatten().zip(self.forcing.tones()) {
            let (response, amplitude) = of(line);
            let (sin, cos) = vibro_math::cis::sin_cos(tone.phase);
            waves.add(response * Complex64::new(cos, sin), tone.omega(), amplitude);
        }
        waves
    }
}

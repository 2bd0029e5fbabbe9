//! One turn of the crank: impacts, blow, energies, impulses and the state at even angles.

use super::machine::Interface;
use serde::Serialize;
use vibro_math::border;

/// Impact of two bodies.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Impact {
    /// Time in s since the start, of the first touch.
    pub time: f64,
    /// Duration in s of the contact; 0 for a rigid impact.
    pub duration: f64,
    /// Interface that closes.
    pub interface: Interface,
    /// Velocities in m/s just before, in the direction of a blow: the body behind, the body in front. The
    /// ground has the velocity 0.
    pub before: [f64; 2],
    /// Velocities in m/s just after.
    pub after: [f64; 2],
    /// Energy in J lost by the relative motion: ½M(w² − w'²) with the reduced mass M.
    pub lost: f64,
}

impl Impact {
    /// Time in s at which the bodies part.
    pub fn end(&self) -> f64 {
        self.time + self.duration
    }
}

/// Blow of the striker.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Blow {
    /// Time in s since the start.
    pub time: f64,
    /// Velocity in m/s of the striker just before.
    pub speed: f64,
    /// Energy ½mv² in J of the striker just before.
    pub energy: f64,
    /// Energy ½mv² in J of the bit after it has first parted from the intermediate piston; `None` if that
    /// does not strike the bit in the same turn.
    pub bit_energy: Option<f64>,
}

/// Energy book of a turn, in J. Changes are those from the turn's start to its end.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
pub struct Book {
    /// Work of the piston on the air, against ambient pressure.
    pub piston: f64,
    /// Change of the kinetic energy of striker, intermediate piston and bit.
    pub kinetic: f64,
    /// Change of their potential energy in the field of gravity.
    pub potential: f64,
    /// Change of the elastic energy of contacts.
    pub elastic: f64,
    /// Change of the energy that the air gives by polytropic expansion to ambient pressure.
    pub air: f64,
    /// Loss at rigid impacts.
    pub impacts: f64,
    /// Loss in compliant contacts and in the damper.
    pub contacts: f64,
    /// Loss in the seal.
    pub seal: f64,
    /// Loss by flow through leakage and vents: −∂E/∂p of the air's energy times the pressure that flows in.
    pub flow: f64,
    /// Work of the piston less all other entries; it shows the error of the integration.
    pub residual: f64,
}

/// State of the machine at an instant.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Sample {
    /// Angle θ of the crank in rad since top dead centre.
    pub angle: f64,
    /// Position of the driving piston in m.
    pub piston: f64,
    /// Positions of striker, intermediate piston and bit in m.
    pub positions: [f64; 3],
    /// Their velocities in m/s.
    pub velocities: [f64; 3],
    /// Pressure of the cushion in Pa.
    pub pressure: f64,
    /// Mass of the air in the cushion in kg.
    pub gas: f64,
    /// Force in N on the housing towards the bit, without the impulses of rigid impacts.
    pub handle: f64,
    /// Force in N on the damper, without the impulses of rigid impacts.
    pub damper: f64,
}

/// Smallest and largest values over a turn, without the impulses of rigid impacts.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Extremes {
    /// Force in N on the housing towards the bit.
    pub handle: [f64; 2],
    /// Force in N on the damper.
    pub damper: [f64; 2],
    /// Pressure in Pa of the cushion.
    pub pressure: [f64; 2],
}

impl Extremes {
    pub(super) const NONE: [f64; 2] = [f64::INFINITY, f64::NEG_INFINITY];

    /// Extremes of both.
    pub fn with(&self, other: &Extremes) -> Extremes {
        let both = |a: [f64; 2], b: [f64; 2]| [a[0].min(b[0]), a[1].max(b[1])];
        Extremes {
            handle: both(self.handle, other.handle),
            damper: both(self.damper, other.damper),
            pressure: both(self.pressure, other.pressure),
        }
    }
}

impl Default for Extremes {
    fn default() -> Extremes {
        Extremes { handle: Extremes::NONE, damper: Extremes::NONE, pressure: Extremes::NONE }
    }
}

/// A turn of the crank, from one top dead centre to the next.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct Turn {
    /// Impacts that end in this turn, in the order of their ends.
    pub impacts: Vec<Impact>,
    /// Chatters that were completed: rebounds too small to follow, summed as a geometric series.
    pub chatters: usize,
    /// Blow of the turn: the impact of the fastest striker, if it is faster than the driving piston ever is.
    /// A slower one is a landing of a striker that follows the piston. [`Run::blows`](super::Run::blows)
    /// counts blows about top dead centre once.
    pub blow: Option<Blow>,
    /// Energies.
    pub book: Book,
    /// Impulse in N s on the housing towards the bit, with the impulses of rigid impacts.
    pub handle: f64,
    /// Impulse in N s on the damper, with the impulses of rigid impacts.
    pub damper: f64,
    /// Extremes of forces and pressure.
    pub extremes: Extremes,
    /// Momentum in kg m/s of striker, intermediate piston and bit at its end.
    pub momentum: f64,
    /// States at even angles; the number is that of [`Course::samples`](super::Course::samples).
    pub samples: Vec<Sample>,
    /// Positions in m of striker, intermediate piston and bit at its end.
    #[serde(skip)]
    pub end: [f64; 3],
}

/// Longest contact in s that a measurement takes for an impact.
const LONGEST: f64 = 0.2e-3;

impl Turn {
    /// An impact as if it took no time, as a measured velocity shows it: at the instant at which half of the
    /// change has come, with the velocities before and after continued to it along straight lines. By the
    /// samples of the turn, which began at the time `began` (s) and lasted `period` (s); where they do not
    /// hold the contact and half of its duration before and after it, as it is.
    #[must_use]
    pub fn at_once(&self, impact: &Impact, began: f64, period: f64) -> Impact {
        let is_short = impact.duration > 0.0 && impact.duration <= LONGEST;
        let seen = is_short.then(|| self.instant_of(impact, began, period)).flatten();
        seen.unwrap_or(*impact)
    }

    fn instant_of(&self, impact: &Impact, began: f64, period: f64) -> Option<Impact> {
        let (half, step) = (0.5 * impact.duration, period / self.samples.len() as f64);
        let velocity = |body: usize, time: f64| {
            let at = (time - began) / step;
            let pair = self.samples.get(at.floor() as usize..at.floor() as usize + 2)?;
            let [v, w] = [pair[0].velocities[body], pair[1].velocities[body]];
            (at >= 0.0).then_some(v + at.fract() * (w - v))
        };
        let mut seen = Impact { duration: 0.0, ..*impact };
        for (side, body) in impact.interface.bodies().into_iter().enumerate() {
            let Some(body) = body else { continue };
            seen.before[side] = 2.0 * impact.before[side] - velocity(body, impact.time - half)?;
            seen.after[side] = 2.0 * impact.after[side] - velocity(body, impact.end() + half)?;
            let middle = 0.5 * (seen.before[side] + seen.after[side]);
            let is_before = |time: f64| {
                velocity(body, time).is_some_and(|v| (v < middle) == (seen.before[side] < middle))
            };
            seen.time = border(impact.time, impact.end(), is_before);
        }
        Some(seen)
    }

    /// Blow among impacts in the order of their ends: the fastest striker, if it reaches `least` (m/s).
    /// Masses in kg.
    pub(super) fn blow_among(impacts: &[Impact], least: f64, striker: f64, bit: f64) -> Option<Blow> {
        let of = |interface| impacts.iter().filter(move |impact| impact.interface == interface);
        let fastest = of(Interface::Striker).max_by(|a, b| a.before[0].total_cmp(&b.before[0]));
        let blow = fastest.filter(|blow| blow.before[0] >= least)?;
        let first = of(Interface::Bit).find(|impact| impact.end() >= blow.time).map(Impact::end);
        let bit_energy = first.map(|end| {
            let same = of(Interface::Bit).filter(|impact| impact.end() == end && impact.end() >= blow.time);
            same.map(|impact| 0.5 * bit * impact.after[1].powi(2)).fold(0.0, f64::max)
        });
        let speed = blow.before[0];
        Some(Blow { time: blow.time, speed, energy: 0.5 * striker * speed * speed, bit_energy })
    }
}

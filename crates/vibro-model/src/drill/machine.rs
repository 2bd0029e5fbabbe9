//! Impact unit of a hammer drill: its dimensions, masses and contacts.

use super::crank::Crank;
use super::cushion::Cushion;
use super::flow::{Flow, Vent};
use crate::law::Law;
use crate::least::{NumberRange, number};
use vibro_record::{Error, Result};

/// Largest ratio of two masses.
const MOST_RATIO: f64 = 1e6;

/// Speed of sound in a steel rod in m/s.
pub const SOUND_SPEED: f64 = 5100.0;

/// Impact unit: crank, piston, air cushion, striker, intermediate piston, bit, damper.
///
/// Positions are along the axis in m, positive towards the bit. Piston and striker have their origin where
/// the cushion is L₀ long. Striker and intermediate piston touch where their positions are equal, so do
/// intermediate piston and bit.
#[derive(Debug, Clone, PartialEq)]
pub struct Machine {
    /// Drive of the piston.
    pub crank: Crank,
    /// Air between piston and striker.
    pub cushion: Cushion,
    /// Openings of the cushion.
    pub flow: Flow,
    /// Striker.
    pub striker: Striker,
    /// Mass of the intermediate piston in kg.
    pub intermediate: f64,
    /// Bit.
    pub bit: Bit,
    /// Position in m at which the striker meets the intermediate piston at rest on the bit.
    pub strike: f64,
    /// Way in m of the intermediate piston from there back to its buffer in the housing.
    pub travel: f64,
    /// Way in m of the bit from there to the damper.
    pub clearance: f64,
    /// Contacts in the order of [`Interface::ALL`].
    pub contacts: [Contact; 4],
    /// Acceleration in m/s² by gravity towards the bit: g cos β, 9.81 for a machine that drills downwards.
    pub gravity: f64,
}

/// Striker and its seal.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Striker {
    /// Mass in kg.
    pub mass: f64,
    /// Coulomb friction of the seal in N.
    pub friction: f64,
    /// Viscous friction of the seal in N s/m.
    pub damping: f64,
}

/// Bit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bit {
    /// Mass in kg.
    pub mass: f64,
    /// Length in m, for the travel time of waves.
    pub length: f64,
}

impl Bit {
    /// Time in s in which a wave travels along the bit and back.
    pub fn travel_time(&self) -> f64 {
        2.0 * self.length / SOUND_SPEED
    }

    /// Impedance cρA = cm/l of the bit in N s/m: force over velocity while waves have not returned.
    pub fn impedance(&self) -> f64 {
        SOUND_SPEED * self.mass / self.length
    }
}

/// Contact of two bodies.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Contact {
    /// Restitution R of a rigid impact.
    pub restitution: f64,
    /// Law of the contact that gives way, where it is known. The damper is one where it has a law, on every
    /// rung; the other contacts are compliant on the rung [`Rung::Compliant`](super::Rung::Compliant).
    pub law: Option<Law>,
}

impl Contact {
    /// Rigid contact with a restitution.
    pub const fn rigid(restitution: f64) -> Contact {
        Contact { restitution, law: None }
    }
}

/// Interface between two bodies, or a body and the ground.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Interface {
    /// Striker and intermediate piston.
    Striker,
    /// Intermediate piston and bit.
    Bit,
    /// Bit and damper, or rock.
    Damper,
    /// Intermediate piston and its buffer in the housing.
    Buffer,
}

impl Interface {
    /// All interfaces, in the order in which a blow passes them.
    pub const ALL: [Interface; 4] =
        [Interface::Striker, Interface::Bit, Interface::Damper, Interface::Buffer];
}

impl Machine {
    /// A machine with a blow of 4 J at 45 turns a second that drills downwards; the dimensions are invented,
    /// the masses are those of the thesis' rig.
    ///
    /// ```
    /// use vibro_model::drill::{Course, Machine, Regime, Rung, run};
    /// let run = run(&Machine::example(), Rung::Friction, &Course::turns(40))?;
    /// assert_eq!(run.regime, Regime::EveryTurn);
    /// # Ok::<(), vibro_record::Error>(())
    /// ```
    pub fn example() -> Machine {
        // Hunt–Crossley: with α = 0.035 s/m, R is 0.86 at 7.5 m/s.
        let contact = Contact { restitution: 0.8, law: Some(Law::curved(2e10, 1.5, 0.035)) };
        Machine {
            crank: Crank { radius: 0.0113, rod: 0.065, frequency: 45.0 },
            cushion: Cushion {
                area: 7.9e-4,
                length: 0.0215,
                dead_volume: 1.2e-7,
                exponent: 1.3,
                ambient: 101_325.0,
                temperature: 293.15,
            },
            flow: Flow {
                leakage: 8.7e-10,
                critical_ratio: 0.5,
                vents: vec![Vent { position: 0.009, area: 0.0 }, Vent { position: 0.013, area: 1.6e-6 }],
            },
            striker: Striker { mass: 0.14, friction: 2.0, damping: 0.55 },
            intermediate: 0.28,
            bit: Bit { mass: 0.43, length: 0.3 },
            strike: 0.0202,
            travel: 0.0055,
            clearance: 0.0,
            contacts: [
                contact,
                contact,
                Contact { restitution: 0.3, law: Some(Law::spring(2.4e5, 1060.0)) },
                Contact::rigid(0.4),
            ],
            gravity: 9.81,
        }
    }

    /// The same machine at another speed in turns per second.
    pub fn at_speed(mut self, frequency: f64) -> Machine {
        self.crank.frequency = frequency;
        self
    }

    /// Checks that the numbers are possible.
    ///
    /// # Errors
    /// If one is not; the error names it.
    pub fn check(&self) -> Result<()> {
        self.crank.check()?;
        self.cushion.check()?;
        self.flow.check()?;
        for (name, mass) in [
            ("striker", self.striker.mass),
            ("intermediate piston", self.intermediate),
            ("bit", self.bit.mass),
        ] {
            number(&format!("mass of the {name}"), mass, "kg", NumberRange::AboveZero)?;
        }
        // Impulses pass the chain by the ratios of its masses.
        let masses = [self.striker.mass, self.intermediate, self.bit.mass];
        let (least, most) = masses.iter().fold((f64::INFINITY, 0.0f64), |(a, b), m| (a.min(*m), b.max(*m)));
        if most > MOST_RATIO * least {
            let found = format!("masses from {least} kg to {most} kg");
            return Err(Error::usage(found, "masses within a factor of a million"));
        }
        number("seal friction", self.striker.friction, "N", NumberRange::Zero)?;
        number("seal damping", self.striker.damping, "N s/m", NumberRange::Zero)?;
        number("bit length", self.bit.length, "m", NumberRange::AboveZero)?;
        number("strike position", self.strike, "m", NumberRange::Any)?;
        number("travel of the intermediate piston", self.travel, "m", NumberRange::AboveZero)?;
        number("clearance of the bit", self.clearance, "m", NumberRange::Zero)?;
        number("gravity along the axis", self.gravity, "m/s²", NumberRange::Any)?;
        for contact in &self.contacts {
            number("restitution", contact.restitution, "", NumberRange::Part)?;
            contact.law.map_or(Ok(()), |law| law.check())?;
        }
        if self.cushion.length + self.strike <= 0.0 {
            let found = format!("strike position is {} m", self.strike);
            return Err(Error::usage(found, "a position in front of the piston at top dead centre"));
        }
        Ok(())
    }
}

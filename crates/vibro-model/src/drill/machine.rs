//! Impact unit of a hammer drill: its dimensions, masses and contacts.

use super::chain::BODIES;
use super::contact::{Contact, contacts};
use super::crank::Crank;
use super::cushion::Cushion;
use super::flow::{Flow, Vent};
use crate::law::Law;
use serde::{Deserialize, Serialize};

/// Speed of sound in a steel rod in m/s.
pub const SOUND_SPEED: f64 = 5100.0;

/// Impact unit: crank, piston, air cushion, striker, intermediate piston, bit, damper.
///
/// Positions are along the axis in m, positive towards the bit. Piston and striker have their origin where
/// the cushion is L₀ long. Striker and intermediate piston touch where their positions are equal, so do
/// intermediate piston and bit.
///
/// As TOML, a table `[drill]` whose keys have the names of the fields; those that are left out are the
/// example's ([`MachineDraft`](super::MachineDraft)).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields, expecting = "a table")]
pub struct Machine {
    /// Drive of the piston.
    pub crank: Crank,
    /// Air between piston and striker.
    pub cushion: Cushion,
    /// Openings of the cushion.
    pub flow: Flow,
    /// Striker.
    pub striker: Striker,
    /// Intermediate piston.
    pub intermediate: Intermediate,
    /// Bit.
    pub bit: Bit,
    /// Contacts in the order of [`Interface::ALL`].
    #[serde(with = "contacts")]
    pub contacts: [Contact; 4],
    /// Acceleration in m/s² by gravity towards the bit: g cos β, 9.81 for a machine that drills downwards.
    pub gravity: f64,
}

impl Default for Machine {
    fn default() -> Machine {
        Machine::example()
    }
}

/// Striker and its seal.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields, expecting = "a table")]
pub struct Striker {
    /// Mass in kg.
    pub mass: f64,
    /// Coulomb friction of the seal in N.
    pub friction: f64,
    /// Viscous friction of the seal in N s/m.
    pub damping: f64,
    /// Position in m at which it meets the intermediate piston at rest on the bit.
    pub strike: f64,
}

impl Default for Striker {
    fn default() -> Striker {
        Machine::example().striker
    }
}

/// Intermediate piston.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields, expecting = "a table")]
pub struct Intermediate {
    /// Mass in kg.
    pub mass: f64,
    /// Way in m from its rest on the bit back to its buffer in the housing.
    pub travel: f64,
}

impl Default for Intermediate {
    fn default() -> Intermediate {
        Machine::example().intermediate
    }
}

/// Bit.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields, expecting = "a table")]
pub struct Bit {
    /// Mass in kg.
    pub mass: f64,
    /// Length in m, for the travel time of waves.
    pub length: f64,
    /// Way in m from its rest to the damper.
    pub clearance: f64,
}

impl Default for Bit {
    fn default() -> Bit {
        Machine::example().bit
    }
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

/// Interface between two bodies, or a body and the ground.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "kebab-case")]
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

    /// Numbers of the bodies behind and in front (0: striker, 1: intermediate piston, 2: bit); the ground has
    /// none.
    pub const fn bodies(self) -> [Option<usize>; 2] {
        BODIES[self as usize]
    }

    /// Both sides, in the direction of a blow.
    pub const fn name(self) -> &'static str {
        match self {
            Interface::Striker => "striker on intermediate piston",
            Interface::Bit => "intermediate piston on bit",
            Interface::Damper => "bit on damper",
            Interface::Buffer => "intermediate piston on buffer",
        }
    }
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
                leakage: 8e-10,
                critical_ratio: 0.5,
                vents: vec![Vent { position: 0.009, area: 0.0 }, Vent { position: 0.013, area: 1.6e-6 }],
            },
            striker: Striker { mass: 0.14, friction: 2.0, damping: 0.55, strike: 0.0202 },
            intermediate: Intermediate { mass: 0.28, travel: 0.007 },
            bit: Bit { mass: 0.43, length: 0.3, clearance: 0.0 },
            contacts: [
                contact,
                contact,
                Contact { restitution: 0.3, law: Some(Law::spring(2.4e5, 1060.0)) },
                Contact::rigid(0.15),
            ],
            gravity: 9.81,
        }
    }

    /// The same machine at another speed in turns per second.
    pub fn at_speed(mut self, frequency: f64) -> Machine {
        self.crank.frequency = frequency;
        self
    }
}

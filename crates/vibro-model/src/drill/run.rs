//! Run of a machine over many turns: regime, blow energy, rate, findings.

use super::machine::{Interface, Machine};
use super::motion::Motion;
use super::rungs::Rung;
use super::turn::{Blow, Turn};
use crate::least::{NumberRange, number};
use vibro_record::{Error, Result};

/// Most turns of a run: half a minute of work.
const MOST_TURNS: usize = 100_000;

/// State of the bodies at the start, with the piston at top dead centre and the air at ambient pressure; a
/// sealed cushion has ambient pressure at its origin.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Start {
    /// Positions of striker, intermediate piston and bit in m.
    pub positions: [f64; 3],
    /// Their velocities in m/s.
    pub velocities: [f64; 3],
}

impl Start {
    /// All at rest in contact: the striker lies on the intermediate piston.
    pub fn rest(machine: &Machine) -> Start {
        Start { positions: [machine.strike; 3], velocities: [0.0; 3] }
    }
}

/// How long a run lasts, and what is kept of it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Course {
    /// Number of turns of the crank.
    pub turns: usize,
    /// Turns at the end of the run that are kept and judged; earlier ones settle.
    pub judged: usize,
    /// States that are kept of each judged turn, at even angles.
    pub samples: usize,
    /// Relative error of an integration step, at least 1e-14.
    pub tolerance: f64,
    /// Start; `None` for [`Start::rest`].
    pub start: Option<Start>,
}

impl Course {
    /// This many turns from rest, of which the last half is judged.
    pub fn turns(turns: usize) -> Course {
        Course { turns, judged: turns.div_ceil(2), samples: 0, tolerance: 1e-9, start: None }
    }
}

/// Pattern of the blows over the judged turns.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Regime {
    /// No blow.
    NoBlow,
    /// A blow in every turn.
    EveryTurn,
    /// A blow in every second turn.
    EverySecondTurn,
    /// Another pattern, or none.
    Irregular,
}

/// Contact that is shorter than a wave takes along the bit and back: the bit is no rigid mass in it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WaveLimit {
    /// Interface of the bit.
    pub interface: Interface,
    /// Duration in s of the shortest contact.
    pub contact: f64,
    /// Travel time in s of a wave along the bit and back.
    pub travel: f64,
    /// Impedance of the bit in N s/m, which takes the place of its mass.
    pub impedance: f64,
}

/// Run of a machine.
#[derive(Debug, Clone, PartialEq)]
pub struct Run {
    /// Model.
    pub rung: Rung,
    /// Judged turns.
    pub turns: Vec<Turn>,
    /// Pattern of the blows in them.
    pub regime: Regime,
    /// First turn of the run with a blow, from 0: the striker is caught before. `None` if it never is.
    pub caught: Option<usize>,
    /// Mean energy ½mv² in J of the striker before a blow; `None` without a blow.
    pub blow_energy: Option<f64>,
    /// Standard deviation in J of the blow energy over the judged turns.
    pub blow_scatter: Option<f64>,
    /// Mean energy in J of the bit after a blow; `None` where no blow reaches it in its turn.
    pub bit_energy: Option<f64>,
    /// Blows per second.
    pub rate: f64,
    /// Contacts too short for a rigid bit. Rigid impacts have no duration and are not judged.
    pub wave_limits: Vec<WaveLimit>,
    /// Integration steps of all turns: the cost.
    pub steps: usize,
}

/// Runs a machine on a rung of the ladder.
///
/// # Errors
/// If a number of the machine is impossible, bodies overlap at the start, the striker strikes the piston, or
/// chatter without loss needs more events than can be followed.
pub fn run(machine: &Machine, rung: Rung, course: &Course) -> Result<Run> {
    number("tolerance", course.tolerance, "", NumberRange::AboveZero)?;
    if course.turns == 0 || course.turns > MOST_TURNS || course.judged == 0 {
        let found = format!("{} turns, {} judged", course.turns, course.judged);
        return Err(Error::usage(found, format!("1 to {MOST_TURNS} turns, and 1 or more judged")));
    }
    let start = course.start.unwrap_or_else(|| Start::rest(machine));
    if rung == Rung::Prescribed {
        return thrown(machine, course);
    }
    let mut motion = Motion::new(machine, rung, &start, course.tolerance)?;
    let first = course.turns.saturating_sub(course.judged);
    let (mut caught, mut turns) = (None, Vec::new());
    for index in 0..course.turns {
        let judged = index >= first;
        let turn = motion.turn(if judged { course.samples } else { 0 })?;
        if turn.blow.is_some() {
            caught = caught.or(Some(index));
        }
        if judged {
            turns.push(turn);
        }
    }
    Ok(judged(machine, rung, turns, caught, motion.steps))
}

/// The blow at the largest speed of the piston, in every turn, on bodies at rest.
fn thrown(machine: &Machine, course: &Course) -> Result<Run> {
    let speed = machine.crank.at(machine.crank.fastest())[1];
    let start = Start { velocities: [speed, 0.0, 0.0], ..Start::rest(machine) };
    let turn = Motion::new(machine, Rung::Prescribed, &start, course.tolerance)?.take_turn();
    let turns = (0..course.judged.min(course.turns)).map(|_| turn.clone()).collect();
    Ok(judged(machine, Rung::Prescribed, turns, Some(0), 0))
}

/// Answers from the judged turns.
fn judged(machine: &Machine, rung: Rung, turns: Vec<Turn>, caught: Option<usize>, steps: usize) -> Run {
    let blows: Vec<Blow> = turns.iter().filter_map(|turn| turn.blow).collect();
    let energies: Vec<f64> = blows.iter().map(|blow| blow.energy).collect();
    let bit: Vec<f64> = blows.iter().filter_map(|blow| blow.bit_energy).collect();
    let blow_energy = mean(&energies);
    let scatter = |mean: f64| {
        let squares: f64 = energies.iter().map(|energy| (energy - mean).powi(2)).sum();
        (squares / energies.len() as f64).sqrt()
    };
    Run {
        rung,
        regime: regime(&turns),
        caught,
        blow_energy,
        blow_scatter: blow_energy.map(scatter),
        bit_energy: mean(&bit),
        rate: blows.len() as f64 / (turns.len() as f64 * machine.crank.period()),
        wave_limits: wave_limits(machine, &turns),
        steps,
        turns,
    }
}

fn mean(values: &[f64]) -> Option<f64> {
    (!values.is_empty()).then(|| values.iter().sum::<f64>() / values.len() as f64)
}

fn regime(turns: &[Turn]) -> Regime {
    let blow = |turn: &Turn| turn.blow.is_some();
    if !turns.iter().any(blow) {
        Regime::NoBlow
    } else if turns.iter().all(blow) {
        Regime::EveryTurn
    } else if turns.windows(2).all(|pair| blow(&pair[0]) != blow(&pair[1])) {
        Regime::EverySecondTurn
    } else {
        Regime::Irregular
    }
}

fn wave_limits(machine: &Machine, turns: &[Turn]) -> Vec<WaveLimit> {
    let (travel, impedance) = (machine.bit.travel_time(), machine.bit.impedance());
    let shortest = |interface: Interface| {
        let impacts = turns.iter().flat_map(|turn| &turn.impacts);
        let timed = impacts.filter(|impact| impact.interface == interface && impact.duration > 0.0);
        let contact = timed.map(|impact| impact.duration).reduce(f64::min)?;
        (contact < travel).then_some(WaveLimit { interface, contact, travel, impedance })
    };
    [Interface::Bit, Interface::Damper].into_iter().filter_map(shortest).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn regimes_are_named_by_the_turns_with_a_blow() {
        let of = |pattern: &str| {
            let blow = Blow { time: 0.0, speed: 7.5, energy: 4.0, bit_energy: None };
            let turn = |mark: char| Turn { blow: (mark == 'x').then_some(blow), ..Turn::default() };
            regime(&pattern.chars().map(turn).collect::<Vec<_>>())
        };
        assert_eq!(of("----"), Regime::NoBlow);
        assert_eq!(of("xxxx"), Regime::EveryTurn);
        assert_eq!((of("x-x-"), of("-x-x-")), (Regime::EverySecondTurn, Regime::EverySecondTurn));
        assert_eq!((of("x--x"), of("xx-x")), (Regime::Irregular, Regime::Irregular));
    }
}

//! Run of a machine over many turns: regime, blow energy, rate, findings.

use super::machine::{Interface, Machine};
use super::motion::Motion;
use super::rungs::Rung;
use super::turn::{Blow, Impact, Turn};
use crate::least::{NumberRange, number};
use serde::Serialize;
use std::f64::consts::TAU;
use vibro_math::cis::sin_cos;
use vibro_record::{Error, Result};

/// Most turns of a run: half a minute of work.
const MOST_TURNS: usize = 100_000;

/// Most integration steps of a run, and further ones of each turn; an ordinary turn takes some hundred.
const MOST_STEPS: [usize; 2] = [100_000, 5000];

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
        Start { positions: [machine.striker.strike; 3], velocities: [0.0; 3] }
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
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize)]
#[serde(rename_all = "kebab-case")]
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

impl Regime {
    /// All regimes.
    pub const ALL: [Regime; 4] =
        [Regime::NoBlow, Regime::EveryTurn, Regime::EverySecondTurn, Regime::Irregular];

    /// Name in tables and figures.
    pub const fn name(self) -> &'static str {
        match self {
            Regime::NoBlow => "no blow",
            Regime::EveryTurn => "a blow every turn",
            Regime::EverySecondTurn => "a blow every second turn",
            Regime::Irregular => "irregular",
        }
    }
}

/// Contact that is shorter than a wave takes along the bit and back: the bit is no rigid mass in it.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
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
    /// Blows, one for each turn counted from half a turn before their mean phase, with the turns without:
    /// blows that jitter across top dead centre are one a turn.
    pub blows: Vec<Option<Blow>>,
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
    motion.most_steps = MOST_STEPS[0] + MOST_STEPS[1] * course.turns;
    let first = course.turns.saturating_sub(course.judged);
    let (mut caught, mut turns) = (None, Vec::new());
    for index in 0..course.turns {
        let judged = index >= first;
        let turn = motion.turn(judged.then_some(course.samples))?;
        if turn.blow.is_some() {
            caught = caught.or(Some(index));
        }
        if judged {
            turns.push(turn);
        }
    }
    let blows = blows(machine, first, &turns);
    Ok(judged(machine, rung, turns, blows, caught, motion.steps))
}

/// The blow at the largest speed of the piston, in every turn, on bodies at rest.
fn thrown(machine: &Machine, course: &Course) -> Result<Run> {
    let speed = machine.crank.top_speed();
    let start = Start { velocities: [speed, 0.0, 0.0], ..Start::rest(machine) };
    let turn = Motion::new(machine, Rung::Prescribed, &start, course.tolerance)?.take_turn();
    let turns: Vec<Turn> = (0..course.judged.min(course.turns)).map(|_| turn.clone()).collect();
    let blows = turns.iter().map(|turn| turn.blow).collect();
    Ok(judged(machine, Rung::Prescribed, turns, blows, Some(0), 0))
}

/// Answers from the judged turns.
fn judged(
    machine: &Machine,
    rung: Rung,
    turns: Vec<Turn>,
    blows: Vec<Option<Blow>>,
    caught: Option<usize>,
    steps: usize,
) -> Run {
    let struck = || blows.iter().flatten();
    let energies: Vec<f64> = struck().map(|blow| blow.energy).collect();
    let bit: Vec<f64> = struck().filter_map(|blow| blow.bit_energy).collect();
    let blow_energy = mean(&energies);
    let scatter = |mean: f64| {
        let squares: f64 = energies.iter().map(|energy| (energy - mean).powi(2)).sum();
        (squares / energies.len() as f64).sqrt()
    };
    Run {
        rung,
        regime: regime(&blows),
        caught,
        blow_energy,
        blow_scatter: blow_energy.map(scatter),
        bit_energy: mean(&bit),
        rate: energies.len() as f64 / (blows.len() as f64 * machine.crank.period()),
        blows,
        wave_limits: wave_limits(machine, &turns),
        steps,
        turns,
    }
}

fn mean(values: &[f64]) -> Option<f64> {
    (!values.is_empty()).then(|| values.iter().sum::<f64>() / values.len() as f64)
}

/// Blow of each whole turn among `turns`, the first of which is number `first` of the run. A turn is counted
/// from half a turn before the mean phase of the blows where that is near top dead centre.
fn blows(machine: &Machine, first: usize, turns: &[Turn]) -> Vec<Option<Blow>> {
    let own = || turns.iter().map(|turn| turn.blow);
    let place = |time: f64| time / machine.crank.period() - first as f64;
    let vectors = own().flatten().map(|blow| sin_cos(TAU * place(blow.time)));
    let (sin, cos) = vectors.fold((0.0, 0.0), |(a, b), (sin, cos)| (a + sin, b + cos));
    if cos <= 0.0 {
        return own().collect();
    }
    let begin = sin.atan2(cos) / TAU - 0.5;
    let impacts: Vec<Impact> = turns.iter().flat_map(|turn| &turn.impacts).copied().collect();
    let (least, striker, bit) = (machine.crank.top_speed(), machine.striker.mass, machine.bit.mass);
    let blow = |turn: usize| {
        let from = turn as f64 + begin;
        let within = |impact: &&Impact| (from..from + 1.0).contains(&place(impact.time));
        let own: Vec<Impact> = impacts.iter().filter(within).copied().collect();
        Turn::blow_among(&own, least, striker, bit)
    };
    // The turns begin before the first one's top dead centre, or end behind the last one's.
    (1..turns.len()).map(blow).collect()
}

fn regime(blows: &[Option<Blow>]) -> Regime {
    if blows.iter().all(Option::is_none) {
        Regime::NoBlow
    } else if blows.iter().all(Option::is_some) {
        Regime::EveryTurn
    } else if blows.windows(2).all(|pair| pair[0].is_some() != pair[1].is_some()) {
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
            regime(&pattern.chars().map(|mark| (mark == 'x').then_some(blow)).collect::<Vec<_>>())
        };
        assert_eq!(of("----"), Regime::NoBlow);
        assert_eq!(of("xxxx"), Regime::EveryTurn);
        assert_eq!((of("x-x-"), of("-x-x-")), (Regime::EverySecondTurn, Regime::EverySecondTurn));
        assert_eq!((of("x--x"), of("xx-x")), (Regime::Irregular, Regime::Irregular));
    }

    #[test]
    fn blows_that_jitter_across_top_dead_centre_are_one_a_turn() {
        let machine = Machine::example();
        let period = machine.crank.period();
        // Ends of the judged turns 3 to 8: blows 2 % of a turn before or behind them.
        let times = [2.98, 4.02, 4.98, 5.98, 7.02, 8.02].map(|place| place * period);
        let turn = |index: usize| {
            let within = times.iter().filter(|time| (**time / period).floor() == index as f64);
            let impacts: Vec<Impact> = within
                .map(|time| Impact {
                    time: *time,
                    duration: 0.0,
                    interface: Interface::Striker,
                    before: [7.0, 0.0],
                    after: [0.0, 3.0],
                    lost: 0.0,
                })
                .collect();
            let blow = Turn::blow_among(&impacts, machine.crank.top_speed(), 0.14, 0.43);
            Turn { impacts, blow, ..Turn::default() }
        };
        let turns: Vec<Turn> = (3..8).map(turn).collect();
        assert!(
            turns.iter().any(|turn| turn.blow.is_none()) && turns.iter().any(|turn| turn.impacts.len() == 2)
        );
        let found = blows(&machine, 3, &turns);
        assert_eq!((found.len(), regime(&found)), (4, Regime::EveryTurn));
    }
}

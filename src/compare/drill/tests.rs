use super::*;
use crate::compare::fit::Unidentified;
use crate::math::Noise;
use crate::measure::drill::{AngleOrigin, Beam, DrillOptions, Edge, Slices, drill};
use crate::model::drill::{Machine, Run, run};
use rayon::prelude::*;

/// Standard deviation of the noise in m/s.
const NOISE: f64 = 0.02;
/// Turns of a record.
const TURNS: usize = 30;
/// Turns until a motion is settled: a disturbance decays by a fifth in each.
const SETTLED: usize = 30;
/// Instants of a sample at which the motion is known.
const FINE: usize = 16;

/// The motion from which records at a rate (Hz) are drawn.
fn motion(machine: &Machine, rate: f64) -> Run {
    let samples = FINE * (rate / machine.crank.frequency) as usize;
    let course = Course { judged: 1, samples, ..Course::turns(SETTLED + 1) };
    run(machine, Rung::Friction, &course).unwrap()
}

/// A run of one body under a laser, with the pulse of the crank at `pulse` turns after top dead centre.
fn record(machine: &Machine, motion: &Run, body: usize, (rate, pulse): (f64, f64), seed: u64) -> Body {
    let turn = &motion.turns[0].samples;
    let (speed, mut noise) = (machine.crank.frequency, Noise::new(seed));
    let angle = |i: usize| i as f64 / rate * speed + 0.3;
    let n = (TURNS as f64 * rate / speed) as usize;
    let velocity: Vec<f64> = (0..n)
        .map(|i| {
            let at = (angle(i) + pulse).fract() * turn.len() as f64;
            turn[at as usize % turn.len()].velocities[body] + NOISE * noise.normal()
        })
        .collect();
    // Rises over four samples, by which the edge is known between two of them.
    let rise = |part: f64| (part * rate / speed / 4.0 + 0.5).clamp(0.0, 1.0);
    let pulse: Vec<f64> = (0..n)
        .map(|i| {
            let part = (angle(i) + 0.5).fract() - 0.5;
            rise(part) - rise(part - 0.1)
        })
        .collect();
    let options = DrillOptions::new(1.0, Beam::new(0.0, AngleOrigin::Axis).unwrap(), 1, Edge::Rising);
    let masses = [machine.striker.mass, machine.intermediate.mass, machine.bit.mass];
    let options = DrillOptions { mass: Some(masses[body]), ..options };
    let found = drill(&Slices { rate, channels: vec![&velocity, &pulse] }, &options, None).unwrap();
    Body::of(BODIES[body], BODIES[body], &options, &found)
}

fn entry(fit: &[&str], pulse_angle: Option<f64>) -> DrillModelEntry {
    DrillModelEntry {
        file: "drill.toml".into(),
        rung: Some(Rung::Friction),
        pulse_angle,
        fit: fit.iter().map(|key| (*key).to_owned()).collect(),
        calibration: Some(0.0),
        settle: Some(SETTLED),
    }
}

/// The example with a buffer nearer and harder, by which its rigid motion settles in [`SETTLED`] turns.
fn stated() -> MachineDraft {
    let mut draft =
        MachineDraft::from_toml(include_str!("../../../examples/hammer_drill/drill.toml")).unwrap();
    let other =
        [("intermediate.travel", 0.0055), ("contacts.buffer.restitution", 0.4), ("flow.leakage", 8.7e-10)];
    for (key, value) in other {
        draft.put(key, value).unwrap();
    }
    draft
}

/// A machine that differs from the stated one.
fn truth() -> Machine {
    let mut machine = stated().machine().unwrap();
    machine.cushion.length *= 1.01;
    machine.flow.leakage *= 1.2;
    machine.striker.friction *= 1.5;
    machine.contacts[0].restitution = 0.75;
    machine
}

const KEYS: [&str; 4] =
    ["cushion.length", "flow.leakage", "striker.friction", "contacts.striker.restitution"];

/// Deviations of all fitted keys from the truth in standard uncertainties, for records of striker and bit.
fn deviations(draws: u64) -> Vec<f64> {
    let (machine, angle) = (truth(), 20.0);
    let motion = motion(&machine, 25e3);
    let entry = entry(&KEYS, Some(angle));
    let of_draw = |draw: u64| -> Vec<f64> {
        let seed = |body: usize| 10 * draw + body as u64 + 1;
        let run = |body: usize| record(&machine, &motion, body, (25e3, angle / 360.0), seed(body));
        let bodies = [0, 2].map(run);
        let bodies: Vec<&Body> = bodies.iter().collect();
        let chain = Chain::of(&bodies).unwrap();
        let found = drill_comparison(&stated(), &entry, &bodies, &chain).unwrap();
        let fit = found.fit.unwrap();
        println!("{draw}: chi²/ν {:.3}, widened {:.3}", fit.reduced_chi_squared, fit.widened);
        let off = |key: &FittedKey| {
            let (truth, std) = (machine.value(&key.key).unwrap(), key.estimate.std);
            println!("  {} {} ± {std:?}, {:?}, true {truth}", key.key, key.estimate.value, key.reason);
            (key.estimate.value - truth) / std.unwrap_or(f64::NAN)
        };
        fit.keys.iter().map(off).collect()
    };
    (0..draws).into_par_iter().flat_map_iter(of_draw).collect()
}

#[test]
fn a_drill_comes_back_from_its_turn() {
    let off = deviations(2);
    assert!(off.len() == 8 && off.iter().all(|z| z.abs() < 5.0), "{off:?}");
}

#[test]
#[ignore = "Monte Carlo: cargo test --release -- --ignored"]
fn ten_drills_come_back_within_their_uncertainties() {
    let off = deviations(10);
    let square = off.iter().map(|z| z * z).sum::<f64>() / off.len() as f64;
    println!("mean square {square:.2}: {off:?}");
    // 40 deviations, four of each draw: their mean square is 1 ± √(2/40) = 0.22 where they are independent.
    assert!(off.iter().all(|z| z.abs() < 5.0) && (0.1..2.0).contains(&square), "{square} {off:?}");
}

#[test]
fn keys_that_act_alike_are_named() {
    let (machine, run) = (truth(), (25e3, 0.1));
    let motion = motion(&machine, run.0);
    let bodies = [0usize, 2].map(|body| record(&machine, &motion, body, run, 40 + body as u64));
    let bodies: Vec<&Body> = bodies.iter().collect();
    let chain = Chain::of(&bodies).unwrap();
    // The bit alone shows only the speed of the blow of what drives the striker.
    let entry = entry(&["flow.leakage", "striker.friction"], None);
    let found = drill_comparison(&stated(), &entry, &bodies[1..], &chain).unwrap();
    let keys = found.fit.unwrap().keys;
    for key in &keys {
        assert_eq!((key.reason, key.estimate.std), (Some(Unidentified::Combination), None), "{keys:?}");
    }
    let named = found.findings.iter().filter(|finding| finding.code == "drill-key-in-combination");
    assert_eq!(named.count(), 3);
}

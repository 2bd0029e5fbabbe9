//! Records of a vibrometer and of a pulse pick-up on the crank: runs of the striker, the intermediate piston
//! and the bit of the modelled machine, whose speed, leakage, friction and blow vary from turn to turn.

use super::noise::ShiftedNoise;
use vibro_model::drill::{Impact, Interface, Machine, MachineDraft, Motion, Rung, Start};
use vibro_record::Result;

/// Sampling rate in Hz.
pub const RATE: f64 = 102_400.0;
/// Relative standard deviations from turn to turn: of the speed, of leakage and friction, of the damping in
/// the contacts.
const SPEED_SCATTER: f64 = 0.004;
const SEAL_SCATTER: f64 = 0.03;
const CONTACT_SCATTER: f64 = 0.05;
/// Turns from rest before a record begins.
const SETTLING: usize = 40;
/// Standard deviation of the vibrometer's noise in V: 6 mm/s along the beam, at 2 m/s per volt.
const NOISE: f64 = 0.003;

/// One impact of the striker.
#[derive(Debug, Clone, Copy)]
pub struct Struck {
    /// Time in s at which half of the velocity has changed.
    pub time: f64,
    /// Number of the turn, from 0.
    #[allow(dead_code, reason = "the table of the truth has it")]
    pub turn: usize,
    /// Phase in turns after top dead centre.
    pub phase: f64,
    /// Velocity in m/s before the impact, continued to that time.
    pub before: f64,
    /// Velocity in m/s after the impact, continued back to it.
    pub after: f64,
}

/// Channels in volts, and the true impacts of the striker.
pub struct Record {
    /// Velocity of the body, 4 m/s per volt.
    pub velocity: Vec<f64>,
    /// Signal of the crank's pick-up, with a pulse of 4 V at each top dead centre.
    pub pulse: Vec<f64>,
    /// Impacts during the record.
    pub impacts: Vec<Struck>,
    /// Number of drop-outs of the velocity.
    #[allow(dead_code, reason = "tests count them")]
    pub dropouts: usize,
}

/// The machine of the runs.
///
/// # Errors
/// None: `TRUTH.toml` is one.
pub fn machine() -> Result<Machine> {
    MachineDraft::from_toml(include_str!("TRUTH.toml"))?.machine()
}

/// Time, position and velocity.
type Knot = [f64; 3];

/// Velocity at the time `t` (s) between two knots: the slope of the cubic through both with their velocities.
fn between([t0, x0, v0]: Knot, [t1, x1, v1]: Knot, t: f64) -> f64 {
    let s = (t - t0) / (t1 - t0);
    let mean = (x1 - x0) / (t1 - t0);
    v0 + s * (v1 - v0) + 6.0 * s * (1.0 - s) * (mean - 0.5 * (v0 + v1))
}

/// A run of a body (0: striker, 1: intermediate piston, 2: bit) of `seconds` s, the same every time.
///
/// # Errors
/// None for these machines: those of the model.
pub fn run(body: usize, seconds: f64) -> Result<Record> {
    let seed = 10 * body as u64 + 1;
    let mean = machine()?;
    let mut noise = ShiftedNoise::new(seed);
    let mut motion = Motion::new(&mean, Rung::Compliant, &Start::rest(&mean), 1e-9)?;
    for _ in 0..SETTLING {
        motion.turn(None)?;
    }
    let count = (seconds * RATE) as usize;
    let (mut velocity, mut impacts) = (Vec::with_capacity(count), Vec::new());
    // The recording begins during the first turn, so that its top dead centre is before it.
    let (mut edges, mut last) = (vec![-noise.uniform() * mean.crank.period()], None);
    // The model counts its time from rest.
    let rest = edges[0] - SETTLING as f64 * mean.crank.period();
    while velocity.len() < count {
        let mut machine = mean.clone();
        let mut vary = |value: &mut f64, scatter: f64| *value *= 1.0 + scatter * noise.normal();
        vary(&mut machine.crank.frequency, SPEED_SCATTER);
        vary(&mut machine.flow.leakage, SEAL_SCATTER);
        vary(&mut machine.striker.friction, SEAL_SCATTER);
        let laws = machine.contacts.iter_mut().filter_map(|contact| contact.law.as_mut());
        laws.for_each(|law| vary(&mut law.damping, CONTACT_SCATTER));
        motion.change(&machine)?;
        let (turn, begun, period) = (edges.len() - 1, edges[edges.len() - 1], machine.crank.period());
        let samples = (2.0 * RATE * period).ceil();
        let course = motion.turn(Some(samples as usize))?;
        for (i, sample) in course.samples.iter().enumerate() {
            let time = begun + i as f64 / samples * period;
            let knot = [time, sample.positions[body], sample.velocities[body]];
            while let Some(last) = last.filter(|_| velocity.len() < count) {
                let t = velocity.len() as f64 / RATE;
                if t >= time {
                    break;
                }
                velocity.push(between(last, knot, t));
            }
            last = Some(knot);
        }
        let struck = |impact: &Impact| {
            let Impact { time, before, after, .. } = course.at_once(impact, begun - rest, period);
            let time = rest + time;
            Struck { time, turn, phase: (time - begun) / period, before: before[0], after: after[0] }
        };
        let own = course.impacts.iter().filter(|impact| impact.interface == Interface::Striker);
        let within = |impact: &Struck| (0.0..count as f64 / RATE).contains(&impact.time);
        impacts.extend(own.map(struck).filter(within));
        edges.push(begun + period);
    }
    let (mut laser, mut pick_up) = (ShiftedNoise::new(seed + 1), ShiftedNoise::new(seed + 2));
    // The beam at 60° to the axis measures half of the velocity; divided by 2 m/s per volt, this is 0.25.
    let mut volts: Vec<f64> = velocity.into_iter().map(|v| 0.25 * v + NOISE * laser.normal()).collect();
    let pulse = pulse(&edges, count).into_iter().map(|p| 4.0 * p + 0.3 + 0.01 * pick_up.normal()).collect();
    let dropouts = drop_out(&mut volts, &mut ShiftedNoise::new(seed + 3));
    Ok(Record { velocity: volts, pulse, impacts, dropouts })
}

/// Noise of the vibrometer in V over this many seconds, with the machine at rest.
pub fn still(seconds: f64) -> Vec<f64> {
    let mut laser = ShiftedNoise::new(6);
    (0..(seconds * RATE) as usize).map(|_| NOISE * laser.normal()).collect()
}

/// `count` samples of a signal with one pulse from 0 to 1 per turn. The pulse rises within a few samples at
/// the top dead centre and lasts a tenth of a turn.
fn pulse(edges: &[f64], count: usize) -> Vec<f64> {
    let rise = |samples: f64| 0.5 + 0.5 * (samples / 3.0).tanh();
    let mut k = 0;
    (0..count)
        .map(|i| {
            let t = i as f64 / RATE;
            while edges.get(k + 2).is_some_and(|e| t > 0.5 * (edges[k + 1] + e)) {
                k += 1;
            }
            let near = [k, k + 1].into_iter().filter_map(|j| Some((edges.get(j)?, edges.get(j + 1)?)));
            near.map(|(a, b)| rise((t - a) * RATE) - rise((t - a - 0.1 * (b - a)) * RATE)).sum()
        })
        .collect()
}

/// Sets the signal to 0 for 0.1 to 1 ms about three times a second, as a decoder does when the laser signal
/// is lost. Returns the number of drop-outs.
fn drop_out(volts: &mut [f64], noise: &mut ShiftedNoise) -> usize {
    let (mut at, mut count) = (3000, 0);
    while at + 500 < volts.len() {
        let length = 10 + (90.0 * noise.uniform()) as usize;
        volts[at..at + length].fill(0.0);
        count += 1;
        at += 10_000 + (50_000.0 * noise.uniform()) as usize;
    }
    count
}

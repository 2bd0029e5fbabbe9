//! Synthesises records of a vibrometer and of a pulse pick-up on the crank: runs of the striker, the
//! intermediate piston and the bit.

use super::noise::ShiftedNoise;
use super::stroke::{Machine, Struck};

/// Sampling rate in Hz.
pub const RATE: f64 = 102_400.0;
/// Mass of the striker in kg.
pub const STRIKER: f64 = 0.14;
/// Mass of the intermediate piston in kg.
pub const PISTON: f64 = 0.28;
/// Mass of the bit in kg.
pub const BIT: f64 = 0.43;
/// Restitution between striker and intermediate piston, which rests before.
pub const RESTITUTION: f64 = 0.64;
/// Restitution between intermediate piston and bit, which rests before.
pub const RESTITUTION_OF_BIT: f64 = 0.8;
/// Time in s from the middle of the first contact to that of the second.
pub const CROSSING: f64 = 1.6e-3;

/// Channels in volts, and the true impacts.
pub struct Record {
    /// Velocity of the striker, 4 m/s per volt.
    pub striker: Vec<f64>,
    /// Signal of the crank's pick-up, with a pulse of 4 V at each top dead centre.
    pub pulse: Vec<f64>,
    /// Impacts during the record.
    pub impacts: Vec<Struck>,
    /// Number of drop-outs of the striker's channel.
    #[allow(dead_code, reason = "tests count them")]
    pub dropouts: usize,
}

/// Standard deviation of the vibrometer's noise in V: 6 mm/s along the beam, at 2 m/s per volt.
const NOISE: f64 = 0.003;

/// 47.3 impacts per second, each at 0.62 of a turn after top dead centre, at 7.5 m/s and with a contact of
/// 60 µs.
fn machine() -> Machine {
    Machine {
        speed: 47.3,
        speed_scatter: 0.004,
        phase: 0.62,
        phase_scatter: 0.004,
        before: 7.5,
        before_scatter: 0.02,
        // Velocity of the striker after an impact divided by that before it, by balance of momentum.
        rebound: (STRIKER - RESTITUTION * PISTON) / (STRIKER + PISTON),
        rebound_scatter: 0.01,
        contact: 6e-5,
    }
}

/// A record of the striker of `seconds` s, the same every time.
pub fn record(seconds: f64) -> Record {
    let machine = machine();
    let count = (seconds * RATE) as usize;
    let run = machine.run(seconds, &mut ShiftedNoise::new(1));
    let (mut striker_noise, mut pick_up_noise) = (ShiftedNoise::new(2), ShiftedNoise::new(4));
    // The beam at 60° to the axis measures half of the velocity; divided by 2 m/s per volt, this is 0.25.
    let mut striker: Vec<f64> =
        run.velocity(RATE, count).iter().map(|v| 0.25 * v + NOISE * striker_noise.normal()).collect();
    let pulse =
        run.pulse(RATE, count).iter().map(|p| 4.0 * p + 0.3 + 0.01 * pick_up_noise.normal()).collect();
    let dropouts = drop_out(&mut striker, &mut ShiftedNoise::new(5));
    let during_record = |t: f64| (0.0..count as f64 / RATE).contains(&t);
    Record {
        striker,
        pulse,
        impacts: run.impacts.into_iter().filter(|i| during_record(i.time)).collect(),
        dropouts,
    }
}

/// Noise of the vibrometer in V over this many seconds, with the machine at rest.
pub fn still(seconds: f64) -> Vec<f64> {
    let mut laser = ShiftedNoise::new(6);
    (0..(seconds * RATE) as usize).map(|_| NOISE * laser.normal()).collect()
}

/// A run of another body of the same machine, in volts: its velocity, and the pulse of the crank. `seed`
/// distinguishes runs, `moved` gives the velocity in m/s.
fn other_run(seconds: f64, seed: u64, moved: impl Fn(&mut [f64], &Struck, f64)) -> [Vec<f64>; 2] {
    let machine = machine();
    let count = (seconds * RATE) as usize;
    let run = machine.run(seconds, &mut ShiftedNoise::new(seed));
    let (mut laser, mut pick_up) = (ShiftedNoise::new(seed + 1), ShiftedNoise::new(seed + 2));
    let mut velocity = vec![0.0; count];
    for impact in &run.impacts {
        moved(&mut velocity, impact, machine.contact);
    }
    let pulse = run.pulse(RATE, count).iter().map(|p| 4.0 * p + 0.3 + 0.01 * pick_up.normal()).collect();
    [velocity.iter().map(|v| 0.25 * v + NOISE * laser.normal()).collect(), pulse]
}

/// Part of a contact of this duration (s) that is over at `t` (s) from its middle, as half a sine.
fn rise(t: f64, contact: f64) -> f64 {
    0.5 + 0.5 * (std::f64::consts::PI * (t / contact).clamp(-0.5, 0.5)).sin()
}

/// Adds a velocity (m/s) of the time (s) since `from` (s), to `until` (s) after it.
fn add(velocity: &mut [f64], from: f64, until: f64, of: impl Fn(f64) -> f64) {
    let first = (from * RATE).ceil().max(0.0) as usize;
    let last = ((from + until) * RATE).max(0.0) as usize;
    for (i, v) in velocity.iter_mut().enumerate().take(last).skip(first) {
        *v += of(i as f64 / RATE - from);
    }
}

/// Velocity in m/s that the intermediate piston gains of an impact of the striker.
fn gained(impact: &Struck) -> f64 {
    STRIKER * (impact.before - impact.after) / PISTON
}

/// Run of the intermediate piston: the striker drives it, the bit throws it back, and it returns to its place
/// within the turn.
pub fn piston(seconds: f64) -> [Vec<f64>; 2] {
    // Velocity behind the second impact over that before, and time constant in s of the way back.
    let (thrown, time) = (1.0 - (1.0 + RESTITUTION_OF_BIT) * BIT / (PISTON + BIT), 2.5e-3);
    // e^(−s)(1 + κs) has the integral 1 + κ: so much goes back the way of the crossing.
    let back = -CROSSING / (thrown * time) - 1.0;
    other_run(seconds, 11, |velocity, impact, contact| {
        let begun = impact.time - 0.5 * contact;
        add(velocity, begun, 0.0205, |t| {
            let (first, second) = (t - 0.5 * contact, t - 0.5 * contact - CROSSING);
            let s = second.max(0.0) / time;
            let returning = thrown * (-s).exp() * (1.0 + back * s);
            gained(impact) * (rise(first, contact) + (returning - 1.0) * rise(second, contact))
        });
    })
}

/// Run of the bit: the intermediate piston drives it, and it returns to its place as a critically damped
/// oscillator of time constant 2 ms.
pub fn bit(seconds: f64) -> [Vec<f64>; 2] {
    other_run(seconds, 21, |velocity, impact, contact| {
        let step = (1.0 + RESTITUTION_OF_BIT) * PISTON / (PISTON + BIT) * gained(impact);
        add(velocity, impact.time + CROSSING - 0.5 * contact, 0.02, |t| {
            let t = t - 0.5 * contact;
            let elapsed = t.max(0.0) / 2e-3;
            step * rise(t, contact) * (1.0 - elapsed) * (-elapsed).exp()
        });
    })
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

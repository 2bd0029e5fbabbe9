//! Synthesises a record of a vibrometer and of a pulse pick-up on the crank.

use super::noise::ShiftedNoise;
use super::stroke::{Machine, Struck};

/// Sampling rate in Hz.
pub const RATE: f64 = 102_400.0;
/// Mass of the striker in kg.
pub const STRIKER: f64 = 0.14;
/// Mass of the bit in kg.
pub const BIT: f64 = 0.43;
/// Restitution between striker and bit.
pub const RESTITUTION: f64 = 0.45;

/// Channels in volts, with the true impacts.
pub struct Record {
    /// Velocity of the striker, as voltage.
    pub striker: Vec<f64>,
    /// Velocity of the bit, as voltage.
    pub bit: Vec<f64>,
    /// Pulse at top dead centre.
    pub pulse: Vec<f64>,
    /// Impacts within the record.
    pub impacts: Vec<Struck>,
    /// Drop-outs of the striker's channel.
    #[allow(dead_code, reason = "tests count them")]
    pub dropouts: usize,
}

/// Noise of the vibrometer in V: 6 mm/s along the beam, at 2 m/s a volt.
const NOISE: f64 = 0.003;

/// A record of `seconds`, the same every time.
pub fn record(seconds: f64) -> Record {
    // Balance of momentum with a bit at rest: the striker keeps (m − R M)/(m + M) of its velocity.
    let rebound = (STRIKER - RESTITUTION * BIT) / (STRIKER + BIT);
    let machine = Machine {
        speed: 47.3,
        speed_scatter: 0.004,
        phase: 0.62,
        phase_scatter: 0.004,
        before: 7.5,
        before_scatter: 0.02,
        rebound,
        rebound_scatter: 0.01,
        contact: 6e-5,
    };
    let count = (seconds * RATE) as usize;
    let run = machine.run(seconds, &mut ShiftedNoise::new(1));
    let (mut laser, mut second, mut pick_up) =
        (ShiftedNoise::new(2), ShiftedNoise::new(3), ShiftedNoise::new(4));
    // The beam sees half of the motion; 2 m/s a volt.
    let mut striker: Vec<f64> =
        run.velocity(RATE, count).iter().map(|v| 0.25 * v + NOISE * laser.normal()).collect();
    let bit = bit(&run.impacts, count, machine.contact)
        .iter()
        .map(|v| 0.25 * v + NOISE * second.normal())
        .collect();
    let pulse = run.pulse(RATE, count).iter().map(|p| 4.0 * p + 0.3 + 0.01 * pick_up.normal()).collect();
    let dropouts = drop_out(&mut striker, &mut ShiftedNoise::new(5));
    let inside = |t: f64| (0.0..count as f64 / RATE).contains(&t);
    Record {
        striker,
        bit,
        pulse,
        impacts: run.impacts.into_iter().filter(|i| inside(i.time)).collect(),
        dropouts,
    }
}

/// Noise of the vibrometer with the machine at rest.
pub fn still(seconds: f64) -> Vec<f64> {
    let mut laser = ShiftedNoise::new(6);
    (0..(seconds * RATE) as usize).map(|_| NOISE * laser.normal()).collect()
}

/// Velocity of the bit in m/s. It takes the momentum that the striker loses, and returns to its place with a
/// time constant of 2 ms.
fn bit(impacts: &[Struck], count: usize, contact: f64) -> Vec<f64> {
    let mut velocity = vec![0.0; count];
    for impact in impacts {
        let gained = STRIKER * (impact.before - impact.after) / BIT;
        let first = ((impact.time - 0.5 * contact) * RATE).ceil().max(0.0) as usize;
        for (i, v) in velocity.iter_mut().enumerate().skip(first).take((0.02 * RATE) as usize) {
            let t = i as f64 / RATE - impact.time;
            let mix = 0.5 + 0.5 * (std::f64::consts::PI * (t / contact).min(0.5)).sin();
            let back = t.max(0.0) / 2e-3;
            *v += gained * mix * (1.0 - back) * (-back).exp();
        }
    }
    velocity
}

/// Loses the laser signal for 0.1 to 1 ms about three times a second: the decoder then gives 0. Returns the
/// number of drop-outs.
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

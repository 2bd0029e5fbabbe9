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

/// Channels in volts, and the true impacts.
pub struct Record {
    /// Velocity of the striker, 4 m/s per volt.
    pub striker: Vec<f64>,
    /// Velocity of the bit, 4 m/s per volt.
    pub bit: Vec<f64>,
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

/// A record of `seconds` s, the same every time.
pub fn record(seconds: f64) -> Record {
    // Velocity of the striker after an impact divided by that before it, by balance of momentum with the bit
    // at rest: (m − R M)/(m + M), with the mass m of the striker, M of the bit.
    let rebound = (STRIKER - RESTITUTION * BIT) / (STRIKER + BIT);
    // 47.3 impacts per second, each at 0.62 of a turn after top dead centre, at 7.5 m/s and with a contact
    // of 60 µs.
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
    let (mut striker_noise, mut bit_noise, mut pick_up_noise) =
        (ShiftedNoise::new(2), ShiftedNoise::new(3), ShiftedNoise::new(4));
    // The beam at 60° to the axis measures half of the velocity; divided by 2 m/s per volt, this is 0.25.
    let mut striker: Vec<f64> =
        run.velocity(RATE, count).iter().map(|v| 0.25 * v + NOISE * striker_noise.normal()).collect();
    let bit = bit(&run.impacts, count, machine.contact)
        .iter()
        .map(|v| 0.25 * v + NOISE * bit_noise.normal())
        .collect();
    let pulse =
        run.pulse(RATE, count).iter().map(|p| 4.0 * p + 0.3 + 0.01 * pick_up_noise.normal()).collect();
    let dropouts = drop_out(&mut striker, &mut ShiftedNoise::new(5));
    let during_record = |t: f64| (0.0..count as f64 / RATE).contains(&t);
    Record {
        striker,
        bit,
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

/// Velocity of the bit in m/s. It gains the momentum that the striker loses, as half a sine during the
/// contact. Then it returns to its place as a critically damped oscillator of time constant 2 ms, for 20 ms.
fn bit(impacts: &[Struck], count: usize, contact: f64) -> Vec<f64> {
    let mut velocity = vec![0.0; count];
    for impact in impacts {
        let velocity_step = STRIKER * (impact.before - impact.after) / BIT;
        let first = ((impact.time - 0.5 * contact) * RATE).ceil().max(0.0) as usize;
        for (i, v) in velocity.iter_mut().enumerate().skip(first).take((0.02 * RATE) as usize) {
            let t = i as f64 / RATE - impact.time;
            let rise = 0.5 + 0.5 * (std::f64::consts::PI * (t / contact).min(0.5)).sin();
            let elapsed = t.max(0.0) / 2e-3;
            *v += velocity_step * rise * (1.0 - elapsed) * (-elapsed).exp();
        }
    }
    velocity
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

//! Recordings of the drop test: a ball that falls down a tube onto a plate, an accelerometer on the plate,
//! and a contact trace of the shaken rig.
//!
//! - `DROP01.CSV` … `DROP05.CSV`: drops from 0.57 m, recorded until after the second impact;
//! - `BOUNCE.CSV`: one longer record with a train of bounces;
//! - `CONTACT.DAT`: a contact trace sampled at 2.56 × 50 Hz, one impact in two cycles of 11.2 Hz, with mains
//!   hum;
//! - `TRUTH.csv`: the values from which the recordings are made.

use super::Sink;
use super::noise::near_normal;
use std::f64::consts::TAU;
use std::fmt::Write as _;
use vibro_math::Noise;
use vibro_record::Result;

/// Height of the drops in m.
pub const HEIGHT: f64 = 0.57;
/// Mean restitution of the drops; it scatters from drop to drop.
pub const RESTITUTION: f64 = 0.2112;
/// Restitution of the ball in the train of bounces, which bounces for longer.
pub const LIVELY: f64 = 0.62;
/// Excitation frequency of the contact trace in Hz; it has an impact every two cycles.
pub const EXCITATION: f64 = 11.2;
/// Gravitational acceleration in m/s².
const GRAVITY: f64 = 9.806_65;
/// Sampling rate of the accelerometer in Hz: low, so that the files stay small.
const RATE: f64 = 5000.0;

/// Times in s and speeds in m/s of the impacts of a ball that falls from [`HEIGHT`] at time 0.
fn bounces(restitution: f64, impacts: usize) -> Vec<(f64, f64)> {
    let mut speed = (2.0 * GRAVITY * HEIGHT).sqrt();
    let mut time = speed / GRAVITY;
    let mut found = Vec::new();
    for _ in 0..impacts {
        found.push((time, speed));
        speed *= restitution;
        time += 2.0 * speed / GRAVITY;
    }
    found
}

/// Acceleration of the plate in m/s² as CSV text over `seconds`, from the time `from` (s) on. Each of the
/// `impacts` (time in s, speed in m/s) is a pulse of 0.6 ms, followed by a decaying ringing at 1300 Hz.
fn plate(impacts: &[(f64, f64)], from: f64, seconds: f64, seed: u64) -> String {
    let mut noise = Noise::from_state(seed);
    let mut text = String::from("time (s),acceleration (m/s²)\n");
    for i in 0..(seconds * RATE) as usize {
        let t = from + i as f64 / RATE;
        let mut a = 2.0 * near_normal(&mut noise);
        for (at, speed) in impacts {
            let x = t - at;
            if (0.0..0.6e-3).contains(&x) {
                a += 400.0 * speed * (TAU * x / 1.2e-3).sin();
            } else if x >= 0.6e-3 {
                let y = x - 0.6e-3;
                a -= 120.0 * speed * (-y / 2e-3).exp() * (TAU * 1300.0 * y).sin();
            }
        }
        let _ = writeln!(text, "{:.4},{a:.1}", i as f64 / RATE);
    }
    text
}

/// Contact trace in volts with mains hum, one value a line without a header, as the analyser wrote it; and
/// its number of impacts.
fn contact(seed: u64) -> (String, usize) {
    let (rate, n) = (128.0, 1024);
    let mut noise = Noise::from_state(seed);
    let length = f64::from(n) / rate;
    let times: Vec<f64> =
        (0..n).map(|k| 0.05 + 2.0 * f64::from(k) / EXCITATION).take_while(|t| *t < length - 0.05).collect();
    let mut text = String::new();
    for i in 0..n {
        let t = f64::from(i) / rate;
        let mut v = 0.02 * near_normal(&mut noise) + 0.6 * (TAU * 50.02 * t + 0.7).sin();
        for at in &times {
            let x = (t - at) * rate;
            if x > -8.0 {
                v += (-x * x / 1.8).exp();
                if x > 0.0 {
                    v += 0.4 * (-x / 2.0).exp() * (1.9 * x).sin();
                }
            }
        }
        let _ = writeln!(text, "{v:14.6e}");
    }
    (text, times.len())
}

/// All files, as name and content.
pub fn all() -> Vec<(String, String)> {
    let mut files = Vec::new();
    let mut scatter = Noise::from_state(7);
    for drop in 1..=5 {
        // Restitution scatters by 2 % from drop to drop.
        let r = RESTITUTION * (1.0 + 0.02 * near_normal(&mut scatter));
        files.push((format!("DROP{drop:02}.CSV"), plate(&bounces(r, 2), 0.3, 0.2, 100 + drop)));
    }
    let train = bounces(LIVELY, 6);
    files.push(("BOUNCE.CSV".to_owned(), plate(&train, 0.25, 1.12, 200)));
    let (text, impacts) = contact(300);
    files.push(("CONTACT.DAT".to_owned(), text));
    let truth = format!(
        "quantity,value,unit\nheight,{HEIGHT},m\nrestitution of the drops (mean; 2 % scatter),{RESTITUTION},\nrestitution of the bouncing ball,{LIVELY},\nexcitation of the contact trace,{EXCITATION},Hz\nimpacts in the contact trace,{impacts},\nimpact frequency,{},Hz\n",
        EXCITATION / 2.0
    );
    files.push(("TRUTH.csv".to_owned(), truth));
    files
}

/// Writes all files.
///
/// # Errors
/// Those of `sink`.
pub fn recordings(sink: &mut Sink<'_>) -> Result<()> {
    all().iter().try_for_each(|(name, text)| sink(name, text.as_bytes()))
}

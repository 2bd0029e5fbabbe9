//! Simulated records of a microphone near a body that bounces in a room: contact noise, ringing of the
//! plate, echoes, reverberation, mains hum, a voice.
//!
//! Written from acoustics alone, independent of the estimators.

use std::f64::consts::TAU;
use vibro_math::Noise;

/// Sampling rate in Hz.
pub const RATE: f64 = 24_000.0;
/// Standard acceleration of free fall in m/s².
const GRAVITY: f64 = 9.806_65;

/// How difficult the records of a room are.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Room {
    /// Echoes up to 25 %, a quiet voice in one record of ten.
    Ordinary,
    /// Echoes up to 50 %, a voice in four records of ten, up to as loud as the impacts.
    Hard,
    /// As an ordinary room; bodies that hardly bounce, and the sound of the release in half of the drops.
    Dull,
}

/// One series of drops of one body from one height.
#[derive(Debug, Clone)]
pub struct Drops {
    /// True coefficient of restitution.
    pub restitution: f64,
    /// Stated height in m, and its standard uncertainty.
    pub height: (f64, f64),
    /// Duration of a contact in s, where it is stated.
    pub contact: Option<f64>,
    /// One record a drop, at [`RATE`].
    pub records: Vec<Vec<f64>>,
}

/// What the records of a series share: the sound of an impact and the room.
struct Sound {
    /// Decay time of the contact noise in s; then frequency in Hz, decay time in s and relative amplitude of
    /// the plate's ringing.
    noise: f64,
    ring: (f64, f64, f64),
    /// Delay in s and relative amplitude of each echo.
    echoes: Vec<(f64, f64)>,
    /// Decay time in s and relative amplitude of the reverberation.
    tail: (f64, f64),
}

fn log(noise: &mut Noise, low: f64, high: f64) -> f64 {
    low * (high / low).powf(noise.uniform())
}

impl Room {
    /// The series of a seed.
    pub fn drops(self, seed: u64) -> Drops {
        let noise = &mut Noise::new(0x0D09 + seed);
        let [least, most] = if self == Room::Dull { [0.12, 0.5] } else { [0.4, 0.93] };
        let (r, height, height_std) =
            (noise.between(least, most), log(noise, 0.1, 1.0), log(noise, 3e-4, 2e-3));
        let contact = log(noise, 5e-5, 1e-3);
        let scatter = if noise.uniform() < 0.5 { log(noise, 5e-4, 0.01) } else { 0.0 };
        let count = noise.between(1.0, 9.0) as usize;
        let most = noise.between(3.0, 10.0) as usize;
        let sound = self.sound(noise);
        let (hum, white) = (log(noise, 1e-4, 0.02), log(noise, 3e-4, 0.01));
        let (voices, loudest) = match self {
            Room::Ordinary | Room::Dull => (0.1, 0.1),
            Room::Hard => (0.4, 1.0),
        };
        let mut records = Vec::new();
        for _ in 0..count {
            let mut speed = (2.0 * GRAVITY * height).sqrt();
            let (first, mut t) = (speed, noise.between(0.2, 0.6));
            let mut strikes = Vec::new();
            while strikes.len() < most && speed > 0.02 * first {
                strikes.push((t, speed / first));
                speed *= (r * (1.0 + scatter * noise.normal())).min(0.999);
                t += contact + 2.0 * speed / GRAVITY;
            }
            let mut values = vec![0.0; ((t + 0.3) * RATE) as usize];
            for (at, speed) in &strikes {
                sound.strike(noise, &mut values, *at, *speed);
            }
            if noise.uniform() < voices {
                let loud = log(noise, 0.02, loudest);
                voice(noise, &mut values, loud);
            }
            if noise.uniform() < 0.15 {
                // A hand or a latch before the fall.
                let (at, part) = (strikes[0].0 - noise.between(0.08, 0.19), log(noise, 0.02, 0.3));
                sound.strike(noise, &mut values, at, part);
            }
            if self == Room::Dull && noise.uniform() < 0.5 {
                let fall = (2.0 * height / GRAVITY).sqrt();
                let (at, part) = (strikes[0].0 - fall + 0.003 * noise.normal(), log(noise, 0.03, 0.6));
                sound.strike(noise, &mut values, at.max(0.0), part);
            }
            let phase = noise.uniform();
            for (i, v) in values.iter_mut().enumerate() {
                let mains = TAU * (50.02 * i as f64 / RATE + phase);
                *v += white * noise.normal() + hum * (mains.sin() + 0.3 * (3.0 * mains).sin());
                *v = (*v * 8192.0).round() / 8192.0;
            }
            records.push(values);
        }
        let shown = height + height_std * noise.normal();
        let contact = Some(contact).filter(|_| noise.uniform() < 0.5);
        Drops { restitution: r, height: (shown, height_std), contact, records }
    }

    fn sound(self, noise: &mut Noise) -> Sound {
        let largest = if self == Room::Hard { 0.5 } else { 0.25 };
        let echoes = (0..noise.between(0.0, 5.0) as usize)
            .map(|_| (log(noise, 1e-3, 0.04), log(noise, 0.01, largest)))
            .collect();
        let (f, zeta) = (log(noise, 300.0, 5000.0), log(noise, 0.004, 0.1));
        let ring =
            (f, 1.0 / (TAU * f * zeta), if noise.uniform() < 0.5 { noise.between(0.05, 1.0) } else { 0.0 });
        let tail = (log(noise, 0.03, 0.1), log(noise, 0.001, 0.03));
        Sound { noise: log(noise, 3e-4, 4e-3), ring, echoes, tail }
    }
}

impl Sound {
    /// Adds an impact at the time `at` in s, with `speed` over that of the first one. Pressure grows as the
    /// speed to the power 1.1 and scatters by a sixth.
    fn strike(&self, noise: &mut Noise, values: &mut [f64], at: f64, speed: f64) {
        let loud = speed.powf(1.1) * (noise.normal() / 6.0).exp();
        let lasts = (12.0 * self.noise.max(self.ring.1).max(self.tail.0 / 3.0)).min(0.5);
        let direct: Vec<f64> = (0..(lasts * RATE) as usize)
            .map(|i| {
                let t = i as f64 / RATE;
                let attack = 1.0 - (-t / 1e-4).exp();
                let (f, decay, part) = self.ring;
                let rings = part * (TAU * f * t).sin() * (-t / decay).exp();
                let tail = self.tail.1 * (-t / self.tail.0).exp() * f64::from(u8::from(t > 5e-3));
                let burst = noise.normal() * (0.5 * attack * (-t / self.noise).exp() + tail);
                loud * (burst + rings)
            })
            .collect();
        for (delay, part) in [(0.0, 1.0)].iter().chain(&self.echoes) {
            let first = ((at + delay) * RATE).ceil() as usize;
            for (v, d) in values.iter_mut().skip(first).zip(&direct) {
                *v += part * d;
            }
        }
    }
}

/// Adds syllables of a voice: harmonics of 90 to 250 Hz that rise and fall within 0.08 to 0.3 s.
fn voice(noise: &mut Noise, values: &mut [f64], loud: f64) {
    let length = values.len() as f64 / RATE;
    let mut at = noise.between(0.0, length);
    for _ in 0..noise.between(1.0, 5.0) as usize {
        let (lasts, pitch) = (noise.between(0.08, 0.3), noise.between(90.0, 250.0));
        let parts: Vec<f64> = (1..20).map(|k| noise.uniform() / f64::from(k)).collect();
        let first = (at * RATE) as usize;
        for (i, v) in values.iter_mut().skip(first).take((lasts * RATE) as usize).enumerate() {
            let t = i as f64 / RATE;
            let wave: f64 =
                parts.iter().zip(1..).map(|(p, k)| p * (TAU * pitch * f64::from(k) * t).sin()).sum();
            *v += loud * (TAU * 0.5 * t / lasts).sin() * wave;
        }
        at += lasts + noise.between(0.02, 0.3);
    }
}

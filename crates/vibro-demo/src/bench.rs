//! Recordings of the example bench: a mass on a spring, shaken at random and released, and a contact pulse.
//!
//! - `BENCH.CSV`: force and velocity of 0.125 kg on a spring and a damper (60 Hz, ζ = 0.02), 4 s at 1024 Hz;
//! - `DECAY.CSV`: displacement of the same mass, deflected by 2 mm and released at 0.25 s, 2 s at 512 Hz;
//! - `PULSE.CSV`: deceleration in a contact of spring and damper (500 Hz, ζ = 0.2), 4 ms at 50 kHz;
//! - `FILTERED.CSV`: the same pulse after a Butterworth low-pass of order 2 at 2 kHz;
//! - `TRUTH.csv`: the values from which the recordings are made.

use super::Sink;
use super::noise::LinearNoise;
use std::f64::consts::TAU;
use std::fmt::Write as _;
use vibro_record::Result;

/// Mass on the spring in kg.
const MASS: f64 = 0.125;
/// Natural frequency of the mass on its spring in Hz.
const FREQUENCY: f64 = 60.0;
/// Damping ratio of the mass on its spring.
const ZETA: f64 = 0.02;
/// Natural frequency of the contact in Hz.
const CONTACT: f64 = 500.0;
/// Damping ratio of the contact.
const XI: f64 = 0.2;
/// Corner frequency in Hz of the low-pass of `FILTERED.CSV`.
const CORNER: f64 = 2000.0;
/// Integration steps per sample of `BENCH.CSV`.
const STEPS: u32 = 64;

/// `BENCH.CSV`: a random force and the velocity of the mass.
fn bench(noise: &mut LinearNoise) -> String {
    let (w, step) = (TAU * FREQUENCY, 1.0 / 1024.0 / f64::from(STEPS));
    let (mut x, mut v, mut force, mut last_raw) = (0.0, 0.0, 0.0, 0.0);
    let mut text = String::from("time [s],force [N],velocity [m/s]\n");
    for i in 0..4096 {
        let shown = v + 1e-4 * noise.next();
        // Writing to a string cannot fail.
        let _ = writeln!(text, "{:.10},{force:.6},{shown:.7}", f64::from(i) / 1024.0);
        // The mean of two values shifts most of the force's power below a quarter of the sampling rate. So
        // the force is nearly a straight line between samples.
        let raw = 2.0 * noise.next();
        let next = 0.5 * (raw + last_raw);
        last_raw = raw;
        for k in 0..STEPS {
            let f = force + (next - force) * f64::from(k) / f64::from(STEPS);
            v += step * (f / MASS - 2.0 * ZETA * w * v - w * w * x);
            x += step * v;
        }
        force = next;
    }
    text
}

/// `DECAY.CSV`: displacement of the released mass.
fn decay(noise: &mut LinearNoise) -> String {
    let mut text = String::from("time [s],displacement [mm]\n");
    let w = TAU * FREQUENCY;
    let damped = w * (1.0 - ZETA * ZETA).sqrt();
    for i in 0..1024 {
        let time = f64::from(i) / 512.0;
        let t = (time - 0.25).max(0.0);
        let x = 2.0 * (-ZETA * w * t).exp() * ((damped * t).cos() + ZETA * w / damped * (damped * t).sin());
        let _ = writeln!(text, "{time:.9},{:.5}", x + 0.01 * noise.next());
    }
    text
}

/// Contact force in N on a unit mass with an approach speed of 1 m/s, `t` (s) after the first touch.
fn contact(t: f64) -> f64 {
    let w = TAU * CONTACT;
    let damped = w * (1.0 - XI * XI).sqrt();
    let x = (-XI * w * t).exp() * (damped * t).sin() / damped;
    let v = (-XI * w * t).exp() * (damped * t).cos() - XI * w * x;
    let force = w * w * x + 2.0 * XI * w * v;
    if t > 0.0 && t < 0.5 * TAU / w && force > 0.0 { force } else { 0.0 }
}

/// `FILTERED.CSV`: the pulse F after the low-pass, y″ + √2 Ω y′ + Ω² y = Ω² F, integrated in small steps.
fn filtered(noise: &mut LinearNoise) -> String {
    let mut text = String::from("time [s],acceleration [m/s²]\n");
    let (w, parts) = (TAU * CORNER, 2000);
    let step = 1.0 / 50_000.0 / f64::from(parts);
    let (mut y, mut slope) = (0.0, 0.0);
    for i in 0..200 {
        let _ = writeln!(text, "{:.6},{:.3}", f64::from(i) / 50_000.0, y + 3.0 * noise.next());
        for k in 0..parts {
            let t = (f64::from(i) - 50.3) / 50_000.0 + (f64::from(k) + 0.5) * step;
            slope += step * (w * w * (contact(t) - y) - 2f64.sqrt() * w * slope);
            y += step * slope;
        }
    }
    text
}

/// `PULSE.CSV`: the pulse of a contact that begins 50.3 samples after the start.
fn pulse(noise: &mut LinearNoise) -> String {
    let mut text = String::from("time [s],acceleration [m/s²]\n");
    for i in 0..200 {
        let t = (f64::from(i) - 50.3) / 50_000.0;
        let shown = contact(t) + 3.0 * noise.next();
        let _ = writeln!(text, "{:.6},{shown:.3}", f64::from(i) / 50_000.0);
    }
    text
}

/// Writes all files.
pub fn recordings(sink: &mut Sink<'_>) -> Result<()> {
    let mut noise = LinearNoise(20);
    let truth = format!(
        "what,value,unit\nfrequency of the mass,{FREQUENCY},Hz\nits damping ratio,{ZETA},1\nits mass,{MASS},kg\n\
         frequency of the contact,{CONTACT},Hz\nits damping ratio,{XI},1\n"
    );
    sink("BENCH.CSV", bench(&mut noise).as_bytes())?;
    sink("PULSE.CSV", pulse(&mut noise).as_bytes())?;
    sink("FILTERED.CSV", filtered(&mut noise).as_bytes())?;
    sink("DECAY.CSV", decay(&mut noise).as_bytes())?;
    sink("TRUTH.csv", truth.as_bytes())
}

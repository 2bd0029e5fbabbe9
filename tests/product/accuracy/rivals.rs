//! Coverage of all results of a pulse besides ξ and frequency: stiffness, damping, velocity from a force,
//! and the parameters of Hertz and Hunt–Crossley contacts, which are integrated here.

use super::draws::Draws;
use super::noise::Noise;
use super::pulse::{Case, trace};
use super::score::Score;
use std::collections::BTreeMap;
use std::f64::consts::TAU;
use vibroimpact::measure::pulse::{Instrument, LowPass, PulseOptions, PulseResult, pulse};
use vibroimpact::record::{Meta, Trace};
use vibroimpact::units::Unit;

const CASES: u64 = 300;

/// Adds stiffness, damping, initial velocity and onset; each error counts in units of its own uncertainty.
fn add(scores: &mut BTreeMap<&'static str, Score>, found: &PulseResult, case: &Case, mass: f64) {
    let omega = TAU * case.frequency;
    let velocity = found.initial_velocity.as_ref().expect("an acceleration or a force and a mass");
    for (name, estimate, truth) in [
        ("stiffness", found.stiffness.as_ref().expect("a mass"), mass * omega * omega),
        ("damping", found.damping.as_ref().expect("a mass"), 2.0 * case.xi * mass * omega),
        ("initial velocity", velocity, case.velocity.abs()),
        ("onset", &found.fits[0].parameters["onset"], case.onset),
    ] {
        scores.entry(name).or_default().own(estimate, truth);
    }
    let force = found.fits[0].parameters["initial_velocity"].value;
    assert!(velocity.value.is_nan() || (force.abs() - velocity.value).abs() <= 1e-12 * velocity.value);
}

fn judge(draws: Draws, what: &str, scores: &BTreeMap<&'static str, Score>) {
    for (name, score) in scores {
        score.judge(draws, &format!("{what}, {name} (against its own uncertainty)"), 1.3);
    }
}

/// The record as a force in N on a mass in kg.
fn force(values: &[f64], dt: f64, mass: f64) -> Trace {
    let meta = Meta::new("force", Unit::parse("N").expect("a unit"));
    Trace { meta, ..trace(values.iter().map(|v| mass * v).collect(), dt) }
}

fn what_follows_from_a_pulse_and_a_mass(draws: Draws) {
    let mut scores = BTreeMap::new();
    println!("seeds 3000 to {}", 3000 + draws.of(CASES));
    for seed in 3000..3000 + draws.of(CASES) {
        let mut noise = Noise::new(seed);
        let (case, mass) = (Case::within(&mut noise, (0.08, 0.4)), noise.between(0.05, 5.0));
        let first = (case.onset / case.dt).ceil() as usize;
        let clean = case.plain(&case.parameters(), first);
        let values: Vec<f64> = clean.iter().map(|v| v + case.sigma * noise.normal()).collect();
        let options = PulseOptions { instrument: Instrument::Flat, mass: Some(mass) };
        let found =
            pulse(&force(&values, case.dt, mass), &options).unwrap_or_else(|e| panic!("seed {seed}: {e}"));
        add(&mut scores, &found, &case, mass);
    }
    judge(draws, "pulse with a mass", &scores);
}

fn what_follows_from_a_pulse_behind_a_low_pass(draws: Draws) {
    let mut scores = BTreeMap::new();
    println!("seeds 4000 to {}", 4000 + draws.of(CASES));
    for seed in 4000..4000 + draws.of(CASES) {
        let mut noise = Noise::new(seed);
        let (case, mass) = (Case::within(&mut noise, (0.08, 0.35)), noise.between(0.05, 5.0));
        // Corners at which the jump of the force stays visible; lower ones are tested with their bounds in
        // `pulse`.
        let (corner, order) = (case.frequency * noise.between(3.0, 6.0), 1 + (seed % 3) as usize);
        let clean = case.filtered(&case.parameters(), corner, order);
        let values: Vec<f64> = clean.iter().map(|v| v + case.sigma * noise.normal()).collect();
        let instrument = Instrument::LowPass(LowPass::new(corner, order).unwrap());
        let options = PulseOptions { instrument, mass: Some(mass) };
        let found =
            pulse(&force(&values, case.dt, mass), &options).unwrap_or_else(|e| panic!("seed {seed}: {e}"));
        add(&mut scores, &found, &case, mass);
    }
    judge(draws, "pulse with a mass behind a low-pass", &scores);
}

/// Integrates z″ = −z^{3/2}(1 + α z′) with z(0) = 0 and z′(0) = 1 by Runge–Kutta, up to the next z = 0.
/// Returns −z″ at every step, the time of the end, and −z′ there, which is the restitution.
fn losses(alpha: f64, step: f64) -> (Vec<f64>, f64, f64) {
    let force = |z: f64, v: f64| z.max(0.0).powf(1.5) * (1.0 + alpha * v);
    let (mut z, mut v) = (0.0, 1.0);
    let mut all = vec![0.0];
    loop {
        let (a, b) = (v, -force(z, v));
        let (c, d) = (v + step / 2.0 * b, -force(z + step / 2.0 * a, v + step / 2.0 * b));
        let (e, f) = (v + step / 2.0 * d, -force(z + step / 2.0 * c, v + step / 2.0 * d));
        let (g, h) = (v + step * f, -force(z + step * e, v + step * f));
        let next = z + step / 6.0 * (a + 2.0 * c + 2.0 * e + g);
        if next <= 0.0 {
            let end = (all.len() - 1) as f64 * step + z / -v;
            all.push(0.0);
            return (all, end, -v);
        }
        v += step / 6.0 * (b + 2.0 * d + 2.0 * f + h);
        z = next;
        all.push(force(z, v));
    }
}

/// Tests the parameters of a rival model: 1 is the contact of Hertz (α = 0), 2 that of Hunt and Crossley
/// with losses α between `alphas`.
fn rival(model: usize, from: u64, alphas: (f64, f64), draws: Draws) {
    const STEP: f64 = 1.0 / 512.0;
    let mut scores: BTreeMap<&str, Score> = BTreeMap::new();
    println!("seeds {from} to {}", from + draws.of(CASES));
    for seed in from..from + draws.of(CASES) {
        let mut noise = Noise::new(seed);
        let alpha = if model == 1 { 0.0 } else { noise.between(alphas.0, alphas.1) };
        let (shape, end, restitution) = losses(alpha, STEP);
        let duration = noise.between(2e-5, 5e-4);
        let dt = duration / noise.between(16.0, 60.0);
        let velocity = noise.between(0.5, 8.0) * if noise.between(0.0, 1.0) < 0.5 { -1.0 } else { 1.0 };
        let onset = 2.3 * duration + noise.between(0.0, dt);
        let scale = duration / end;
        let height = velocity.abs() / scale;
        let (base, sigma) = (noise.between(-0.3, 0.3) * height, height * noise.between(0.003, 0.02));
        let values: Vec<f64> = (0..(5.8 * duration / dt) as usize)
            .map(|i| {
                let place = (i as f64 * dt - onset) / scale / STEP;
                let at = place.max(0.0) as usize;
                let inside = place >= 0.0 && at + 1 < shape.len();
                let v =
                    if inside { shape[at] + (place - at as f64) * (shape[at + 1] - shape[at]) } else { 0.0 };
                base + velocity / scale * v + sigma * noise.normal()
            })
            .collect();
        let found = pulse(&trace(values, dt), &PulseOptions { instrument: Instrument::Flat, mass: None })
            .unwrap_or_else(|e| panic!("seed {seed}, alpha {alpha}: {e}"));
        let Some(fit) = found.fits.iter().find(|f| f.model.name() == ["", "hertz", "hunt-crossley"][model])
        else {
            panic!("seed {seed}: {:?}", found.findings);
        };
        let truths = [
            ("onset", onset),
            ("baseline", base),
            ("initial_velocity", velocity.abs()),
            ("duration", duration),
            ("alpha", alpha),
            ("restitution", restitution),
        ];
        for (name, truth) in truths.iter().take(if model == 1 { 4 } else { 6 }) {
            scores.entry(name).or_default().own(&fit.parameters[name], *truth);
        }
    }
    judge(draws, ["", "contact of Hertz", "contact of Hunt and Crossley"][model], &scores);
}

fn the_contact_of_hertz(draws: Draws) {
    rival(1, 6000, (0.0, 0.0), draws);
}

fn the_contact_of_hunt_and_crossley(draws: Draws) {
    rival(2, 7000, (0.05, 1.0), draws);
}

/// 4 cases of each kind, run with every test.
mod few {
    use super::Draws;

    #[test]
    fn what_follows_from_a_pulse_and_a_mass() {
        super::what_follows_from_a_pulse_and_a_mass(Draws::Few);
    }

    #[test]
    fn what_follows_from_a_pulse_behind_a_low_pass() {
        super::what_follows_from_a_pulse_behind_a_low_pass(Draws::Few);
    }

    #[test]
    fn the_contact_of_hertz() {
        super::the_contact_of_hertz(Draws::Few);
    }

    #[test]
    fn the_contact_of_hunt_and_crossley() {
        super::the_contact_of_hunt_and_crossley(Draws::Few);
    }
}

/// All cases, run with `--ignored`.
mod all {
    use super::Draws;

    #[test]
    #[ignore = "Monte Carlo: cargo test --release -- --ignored"]
    fn what_follows_from_a_pulse_and_a_mass() {
        super::what_follows_from_a_pulse_and_a_mass(Draws::All);
    }

    #[test]
    #[ignore = "Monte Carlo: cargo test --release -- --ignored"]
    fn what_follows_from_a_pulse_behind_a_low_pass() {
        super::what_follows_from_a_pulse_behind_a_low_pass(Draws::All);
    }

    #[test]
    #[ignore = "Monte Carlo: cargo test --release -- --ignored"]
    fn the_contact_of_hertz() {
        super::the_contact_of_hertz(Draws::All);
    }

    #[test]
    #[ignore = "Monte Carlo: cargo test --release -- --ignored"]
    fn the_contact_of_hunt_and_crossley() {
        super::the_contact_of_hunt_and_crossley(Draws::All);
    }
}

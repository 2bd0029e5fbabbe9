//! Speed of simulated motions: with impacts, with chatter, under impulses and several sines, and in a
//! sweep.

use criterion::{Criterion, criterion_group, criterion_main};
use std::f64::consts::{FRAC_PI_2, TAU};
use std::hint::black_box;
use vibroimpact::model::{Chirp, Motion, Part, Rig, Simulation, Sine, Sines, State};
use vibroimpact::model::{Excitation, Impulses};

/// Motion from rest under F₀ sin ωt at ν = 2.1: 1098 impacts in 100 s.
fn clapping() -> Simulation {
    let rig = Rig::thesis();
    let frequency = 2.1 * (rig.k1 / rig.m1).sqrt() / TAU;
    Simulation::from_state(&rig, &Sine { force: 0.5, frequency }, State::REST, -FRAC_PI_2).unwrap()
}

/// Masses pressed together by 0.5 mm: chatter, sticking and release in each cycle of 2.4 Hz.
fn chattering() -> Simulation {
    let rig = Rig { gap: -5e-4, ..Rig::thesis() };
    let frequency = 0.45 * (rig.k1 / rig.m1).sqrt() / TAU;
    let start = State { x1: -2e-3, ..State::REST };
    Simulation::from_state(&rig, &Sine { force: 0.35, frequency }, start, -FRAC_PI_2).unwrap()
}

fn flight(c: &mut Criterion) {
    let follow = |motion: &Simulation, until: f64| {
        let mut motion = motion.clone();
        motion.run(black_box(until), |_| {}).unwrap();
        motion.state()
    };
    let motion = clapping();
    c.bench_function("clapping, 100 s, 1098 impacts", |b| b.iter(|| follow(&motion, 100.0)));
    let motion = chattering();
    c.bench_function("chatter and sticking, 100 s", |b| b.iter(|| follow(&motion, 100.0)));
    let rig = Rig::thesis();
    let train = Excitation::Impulse(Impulses { impulse: 0.009, frequency: 5.7 });
    let motion = Simulation::new(&rig, &train).unwrap();
    c.bench_function("impulses, 100 s", |b| b.iter(|| follow(&motion, 100.0)));
    let part = |force, frequency| Part { force, frequency, phase: 0.3 };
    let parts = vec![part(0.3, 11.0), part(0.1, 7.0), part(0.1, 3.0), part(0.05, 1.0)];
    let motion = Simulation::new(&rig, &Excitation::Sines(Sines { parts })).unwrap();
    c.bench_function("four sines, 100 s", |b| b.iter(|| follow(&motion, 100.0)));
    let motion = Simulation::new(&rig, &Sine { force: 0.1, frequency: 3.0 }).unwrap();
    c.bench_function("sweep from 3 to 5 Hz at 0.02 Hz/s", |b| {
        b.iter(|| {
            let mut motion = motion.clone();
            Chirp::new(0.02).advance(&mut motion, black_box(100.0), &mut |_| {}).unwrap();
            motion.state()
        });
    });
}

criterion_group!(benches, flight);
criterion_main!(benches);

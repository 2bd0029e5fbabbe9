//! Speed of the models: `cargo bench -p vibro-bench --bench model`.

use criterion::{Criterion, criterion_group, criterion_main};
use std::hint::black_box;
use vibroimpact::model::{Excitation, Impulses, Rig, Sine, orbits, orbits_of, response};

fn orbit(c: &mut Criterion) {
    let rig = Rig::thesis();
    // Computes both roots; the root with J > 0 is a real motion.
    c.bench_function("orbit, sine", |b| b.iter(|| orbits(black_box(&rig), 0.5, black_box(11.0))));
    let impulses = Excitation::Impulse(Impulses { impulse: 0.009, frequency: 4.0 });
    c.bench_function("orbit, impulses", |b| b.iter(|| orbits_of(black_box(&rig), &impulses, 1)));
}

fn responses(c: &mut Criterion) {
    let rig = Rig::thesis();
    let sine = Excitation::Sine(Sine { force: 0.5, frequency: 1.0 });
    c.bench_function("response, 1000 frequencies", |b| {
        b.iter(|| response(black_box(&rig), &sine, 3.0, 14.0, 1000, 1));
    });
}

criterion_group!(benches, orbit, responses);
criterion_main!(benches);

//! Speed of the models: `cargo bench -p vibro-bench --bench model`.

use criterion::{Criterion, criterion_group, criterion_main};
use std::hint::black_box;
use vibroimpact::model::drill::{Course, Machine, Rung, run};
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

/// 200 turns of the example at full speed; the last half of the turns is judged.
fn drill(c: &mut Criterion) {
    let (machine, course) = (Machine::example(), Course::turns(200));
    for rung in [Rung::Friction, Rung::Compliant] {
        let name = format!("drill, 200 turns, {}", rung.name());
        c.bench_function(&name, |b| b.iter(|| run(black_box(&machine), rung, &course)));
    }
}

criterion_group!(benches, orbit, responses, drill);
criterion_main!(benches);

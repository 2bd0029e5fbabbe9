//! Speed of averaged spectra, compared with the Fourier transforms alone.
//!
//! `cargo bench -p vibro-bench --bench welch`

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use rayon::prelude::*;
use std::hint::black_box;
use vibroimpact::read::Reader;
use vibroimpact::record::Traces;
use vibroimpact::record::{Axis, Meta, Record, Trace, Window};
use vibroimpact::signal::fft::Transform;
use vibroimpact::signal::segment::Segments;
use vibroimpact::signal::welch::Welch;
use vibroimpact::units::Unit;
use vibroimpact::write::{Storage, Target};

const N: usize = 4_000_000;
const LENGTH: usize = 8192;

fn welch(c: &mut Criterion) {
    let values: Vec<f64> =
        (0..N as u64).map(|i| ((i * 7919 + i * i % 1013) % 2003) as f64 / 2003.0).collect();
    let meta = Meta::new("noise", Unit::opaque("V"));
    let trace = Trace { meta, axis: Axis::time(0.0, 1e-5, N), values };
    let segments = Segments { length: LENGTH, hop: LENGTH / 2 };
    let welch = Welch { segments, window: Window::Hann, detrend: true };
    let mut group = c.benchmark_group("welch/4 million samples");
    group.throughput(Throughput::Elements(N as u64)).sample_size(20);
    let transform = Transform::new(LENGTH);
    group.bench_function("bare transforms on all cores", |b| {
        b.iter(|| {
            (0..segments.count(N))
                .into_par_iter()
                .for_each_init(|| transform.workspace(), |work, _| transform.run(black_box(work)));
        });
    });
    group.bench_function("from memory", |b| {
        b.iter_batched(
            || Traces::from_memory(vec![trace.clone()]),
            |traces| welch.average(&mut traces?, false, |_| ()),
            criterion::BatchSize::LargeInput,
        );
    });
    let folder = std::env::temp_dir().join("vibroimpact-bench-welch.wav");
    let mut bytes = Vec::new();
    let written = Target::Wav.write(&[Record::Trace(trace.clone())], Storage::default(), &mut bytes);
    if written.is_ok() && std::fs::write(&folder, bytes).is_ok() {
        group.bench_function("from a wave file of 64-bit floats", |b| {
            b.iter(|| welch.average(&mut Reader::new().stream(black_box(&folder))?, false, |_| ()));
        });
        let _ = std::fs::remove_file(&folder);
    }
    group.finish();
}

criterion_group!(benches, welch);
criterion_main!(benches);

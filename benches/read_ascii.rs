//! Reading text of numbers, against reading its bytes.
//!
//! `cargo bench --bench read_ascii` makes a 5-million-line file in the temporary folder and removes it again.

use criterion::{Criterion, criterion_group, criterion_main};
use std::fmt::Write as _;
use std::hint::black_box;
use vibroimpact::read::Reader;

fn column(lines: usize) -> String {
    let mut text = String::with_capacity(lines * 14);
    let mut state = 1u64;
    for _ in 0..lines {
        // Knuth's MMIX generator: any spread of digits will do.
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        let value = (state >> 11) as f64 / (1u64 << 53) as f64 * 2.0 - 1.0;
        let _ = writeln!(text, "{:>13}", format!("{value:.6e}"));
    }
    text
}

fn bench(c: &mut Criterion) {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join("five_million_lines.txt");
    std::fs::write(&path, column(5_000_000)).expect("room for 70 MB");
    let mut group = c.benchmark_group("ascii");
    group.sample_size(20);
    group.bench_function("5M lines: bytes only", |b| b.iter(|| std::fs::read(black_box(&path))));
    group.bench_function("5M lines: parsed", |b| b.iter(|| Reader::new().from_path(black_box(&path))));
    let spectra: Vec<_> = (0..1000)
        .map(|i| {
            let path = folder.path().join(format!("S{i:04}.DAT"));
            std::fs::write(&path, column(801)).expect("room for 12 MB");
            path
        })
        .collect();
    group.bench_function("1000 spectra of 801 lines", |b| {
        b.iter(|| Reader::new().base_band(Some(20.0)).from_paths(black_box(&spectra)));
    });
    group.finish();
}

criterion_group!(benches, bench);
criterion_main!(benches);

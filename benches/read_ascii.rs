//! Speed of reading numbers from text, compared with reading the bytes only.
//!
//! `cargo bench -p vibro-bench --bench read_ascii` makes a 5-million-line file in the temporary folder and
//! removes it again.

use criterion::{Criterion, criterion_group, criterion_main};
use std::fmt::Write as _;
use std::hint::black_box;
use vibroimpact::math::Noise;
use vibroimpact::read::Reader;

/// How the numbers are printed.
#[derive(Clone, Copy)]
enum Style {
    /// C's `%13.6e`: all lines have the same length.
    Padded,
    /// C's `%.6e`: a minus sign makes a line longer.
    Exponent,
    /// Nine decimals.
    Decimal,
}

/// Numbers between −1 and 1, one a line.
fn column(lines: usize, style: Style) -> String {
    let mut text = String::with_capacity(lines * 14);
    let mut noise = Noise::new(1);
    for _ in 0..lines {
        let value = noise.between(-1.0, 1.0);
        let printed = format!("{value:.6e}");
        let (mantissa, exponent) = printed.split_once('e').unwrap_or((&printed, "0"));
        let exponent: i32 = exponent.parse().unwrap_or(0);
        let sign = if exponent < 0 { '-' } else { '+' };
        let width = if matches!(style, Style::Padded) { 9 } else { 0 };
        let _ = match style {
            Style::Decimal => writeln!(text, "{value:.9}"),
            _ => writeln!(text, "{mantissa:>width$}e{sign}{:02}", exponent.abs()),
        };
    }
    text
}

fn bench(c: &mut Criterion) {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let mut group = c.benchmark_group("ascii");
    group.sample_size(20);
    for (name, style) in
        [("padded", Style::Padded), ("exponent", Style::Exponent), ("decimal", Style::Decimal)]
    {
        let path = folder.path().join(name);
        std::fs::write(&path, column(5_000_000, style)).expect("room for 70 MB");
        group.bench_function(format!("5M lines, {name}: bytes only"), |b| {
            b.iter(|| std::fs::read(black_box(&path)));
        });
        group.bench_function(format!("5M lines, {name}: parsed"), |b| {
            b.iter(|| Reader::new().from_path(black_box(&path)));
        });
    }
    let spectra: Vec<_> = (0..1000)
        .map(|i| {
            let path = folder.path().join(format!("S{i:04}.DAT"));
            std::fs::write(&path, column(801, Style::Padded)).expect("room for 12 MB");
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

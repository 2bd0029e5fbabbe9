//! Speed of reading measurement files of other people's instruments, from path to records.
//!
//! `cargo bench -p vibro-bench --bench read` needs `../shared/data` beside the project; without it the groups
//! are skipped.

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use std::hint::black_box;
use std::path::{Path, PathBuf};
use vibroimpact::read::Reader;

/// A folder of `../shared/data`; prints a line and returns `None` if it is absent.
fn data(folder: &str) -> Option<PathBuf> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/data").join(folder);
    if !path.is_dir() {
        eprintln!("skipped: ../shared/data is absent");
        return None;
    }
    Some(path)
}

/// Reads and surveys one file.
fn file(c: &mut Criterion, group: &str, path: &Path) {
    let name = path.file_name().map_or_else(String::new, |n| n.to_string_lossy().into_owned());
    let mut group = c.benchmark_group(format!("{group}/{name}"));
    if let Ok(info) = path.metadata() {
        group.throughput(Throughput::Bytes(info.len()));
    }
    group.bench_function("bytes only", |b| b.iter(|| std::fs::read(black_box(path))));
    group.bench_function("read", |b| b.iter(|| Reader::new().from_path(black_box(path))));
    group.bench_function("survey", |b| b.iter(|| Reader::new().survey(black_box(path))));
    group.finish();
}

fn uff(c: &mut Criterion) {
    let Some(folder) = data("uff") else { return };
    for name in [
        "Sample_UFF58_ascii.uff",
        "Sample_UFF58b_bin.uff",
        "commercial_58b_wrong_crlf.uff",
        "dataset58_case8_ascii.unv",
        "dataset58_case8_binary.unv",
    ] {
        file(c, "uff", &folder.join(name));
    }
}

criterion_group!(benches, uff);
criterion_main!(benches);

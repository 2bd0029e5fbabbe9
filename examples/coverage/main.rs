//! How often a stated uncertainty covers the truth: simulates records of every kind with random
//! disturbances, whose true values only the generator knows, and compares the answers of the estimators
//! with them.
//!
//! `cargo run --release --example coverage [-- RECORDS]` takes RECORDS records of each kind, 1000 unless
//! stated, and writes `docs/coverage.md`. `-- RECORDS --rows KIND` prints only the rows of this kind and
//! writes nothing. `-- RECORDS --worst KIND` writes nothing, either: it prints the kind's three worst
//! records of each quantity with their disturbances, and its coverage below and above the median size of
//! each disturbance. Record number n is the same in every run.

mod decays;
mod disturbance;
mod drills;
mod drops;
mod handles;
mod modes;
mod pulses;
mod record;
#[path = "../../crates/vibro-measure/src/restitution/room.rs"]
mod room;
mod steps;
mod sweeps;
mod tally;
mod tones;

use disturbance::Mix;
use rayon::prelude::*;
use record::{Kind, Record};
use std::fmt::Write as _;
use tally::{Tally, by_quantity};
use vibroimpact::record::{Axis, Meta, Trace};
use vibroimpact::units::Unit;

/// Draws the records that the command line asks for, and prints or writes their coverage.
fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let count = arguments.first().map_or(Ok(1000), |n| n.parse())?;
    let kinds_of = |option: &str| {
        let name = arguments.iter().position(|a| a == option).and_then(|i| arguments.get(i + 1))?;
        Some(kinds().into_iter().filter(|k| k.name.starts_with(name)).collect::<Vec<_>>())
    };
    if let Some(kinds) = kinds_of("--worst") {
        for kind in kinds {
            print!("{}", worst_records(kind, &draw(kind, count)));
        }
        return Ok(());
    }
    if let Some(kinds) = kinds_of("--rows") {
        for kind in kinds {
            print!("{}", table_rows(kind, &draw(kind, count)));
        }
        return Ok(());
    }
    let mut table = String::from(TABLE);
    let mut ranges = String::from(RANGES);
    for kind in kinds() {
        let lines = table_rows(kind, &draw(kind, count));
        print!("{lines}");
        table += &lines;
        writeln!(ranges, "- **{}**: {}.", kind.name, kind.ranges)?;
    }
    let head = HEAD.replace("RECORDS", &count.to_string());
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/docs/coverage.md");
    Ok(std::fs::write(path, format!("{head}\n{table}\n{ranges}"))?)
}

/// Beginning of the page; `RECORDS` is replaced by their number.
const HEAD: &str = "# Coverage
How often a stated uncertainty holds the truth: RECORDS records of each kind, fewer where an answer takes long, each with its own mix of disturbances. The truth is what made the record.
`cargo run --release --example coverage` writes this page; its generators know nothing of the estimators.

- **asked**: numbers that the records hold. **answered**: given with an uncertainty; all others are refused, not found, or doubted, and count no further.
- **within 1.96**: share of the answers whose error is below 1.96 standard uncertainties; 95 % if uncertainties are right. **spread**: root mean square of error over uncertainty, 1 if they are right.
- **largest**: largest error over uncertainty. **beyond 4**: answers that are wrong by more than 4 uncertainties.
- **invented**: answers, in all records together, to what no record holds, such as a mode that is none.
";

/// Head of the table.
const TABLE: &str = "| kind of record | quantity | asked | answered | doubted | within 1.96 | spread | largest | beyond 4 | invented |
|---|---|---|---|---|---|---|---|---|---|
";

/// Heading over the ranges of each kind.
const RANGES: &str = "## What is drawn
Sizes are drawn evenly on a logarithmic scale. Each of the disturbances is in half of the records, unless a share is stated.

";

/// All kinds of records, in the order of the page.
fn kinds() -> Vec<&'static Kind> {
    [
        sweeps::KINDS,
        steps::KINDS,
        decays::KINDS,
        modes::KINDS,
        tones::KINDS,
        drops::KINDS,
        pulses::KINDS,
        drills::KINDS,
        handles::KINDS,
    ]
    .into_iter()
    .flatten()
    .collect()
}

/// Draws `count`/`every` records of a kind, each with its own seed. The seeds depend on the name of the
/// kind alone, so a new kind does not change the records of the others.
fn draw(kind: &Kind, count: u64) -> Vec<(Mix, Record)> {
    let seed =
        kind.name.bytes().fold(0, |seed: u64, byte| seed.wrapping_mul(0x0100_0193) ^ u64::from(byte)) << 20;
    (0..count / kind.every)
        .into_par_iter()
        .map(|i| {
            let mut mix = Mix::new(seed + i);
            let record = (kind.draw)(&mut mix);
            (mix, record)
        })
        .collect()
}

/// A time trace with a sampling rate in Hz.
fn trace(unit: &str, rate: f64, values: Vec<f64>) -> Trace {
    let unit = Unit::parse(unit).unwrap_or_else(Unit::none);
    Trace { meta: Meta::new("record", unit), axis: Axis::time(0.0, 1.0 / rate, values.len()), values }
}

/// Rows of the page for a kind, one a quantity.
fn table_rows(kind: &Kind, drawn: &[(Mix, Record)]) -> String {
    let records = drawn.iter().map(|(_, record)| record);
    let invented: usize = records.clone().map(|r| r.invented).sum();
    let mut lines = String::new();
    for (i, (quantity, tally)) in by_quantity(&records).into_iter().enumerate() {
        let (name, invented) = if i == 0 { (kind.name, invented.to_string()) } else { ("", String::new()) };
        let answered = tally.answered();
        // Writing to a string cannot fail.
        let _ = writeln!(
            lines,
            "| {name} | {quantity} | {} | {answered:.0} % | {:.0} % | {:.1} % | {:.2} | {:.1} | {} | {invented} |",
            tally.asked,
            100.0 - answered,
            tally.covered(),
            tally.spread(),
            tally.worst(),
            tally.beyond(4.0),
        );
    }
    lines
}

/// For each quantity: the three records with the largest errors and their disturbances; then, for each
/// disturbance, the coverage of the records with a smaller and with a larger size of it.
fn worst_records(kind: &Kind, drawn: &[(Mix, Record)]) -> String {
    let mut text = format!("# {}\n{}", kind.name, table_rows(kind, drawn));
    let mut names: Vec<&str> =
        drawn.iter().flat_map(|(mix, _)| mix.named.iter().map(|(name, _)| *name)).collect();
    names.sort_unstable();
    names.dedup();
    for (quantity, _) in by_quantity(&drawn.iter().map(|(_, record)| record)) {
        let _ = writeln!(text, "## {quantity}");
        let mut errors: Vec<(f64, usize)> = Vec::new();
        for (i, (_, record)) in drawn.iter().enumerate() {
            let asked = record.answers.iter().filter(|a| a.quantity == quantity);
            errors.extend(asked.filter_map(record::Answer::error).map(|e| (e, i)));
        }
        errors.sort_by(|a, b| b.0.abs().total_cmp(&a.0.abs()));
        for (error, i) in errors.iter().take(3) {
            let named: Vec<String> =
                drawn[*i].0.named.iter().map(|(n, size)| format!("{n} {size:.4}")).collect();
            let _ = writeln!(text, "record {i}: {error:+.1} standard uncertainties; {}", named.join(", "));
        }
        for name in &names {
            let size = |mix: &Mix| mix.named.iter().find(|(n, _)| n == name).map_or(0.0, |(_, size)| *size);
            let mut sizes: Vec<f64> = drawn.iter().map(|(mix, _)| size(mix)).collect();
            sizes.sort_by(f64::total_cmp);
            // The median size divides the records. Where the median is also the largest size, the next
            // smaller one does, so that neither part is empty.
            let largest = sizes[sizes.len() - 1];
            let median = sizes[..=sizes.len() / 2].iter().rfind(|s| **s < largest).unwrap_or(&largest);
            let tally = |above: bool| {
                let part = drawn.iter().filter(|(mix, _)| (size(mix) > *median) == above);
                Tally::of(part.flat_map(|(_, r)| &r.answers).filter(|a| a.quantity == quantity))
            };
            let (below, above) = (tally(false), tally(true));
            let _ = writeln!(
                text,
                "{name:>26} up to {median:<10.4}: {:5.1} % of {:5}, {:3} beyond 4; above: {:5.1} % of {:5}, {:3} beyond 4",
                below.covered(),
                below.errors.len(),
                below.beyond(4.0),
                above.covered(),
                above.errors.len(),
                above.beyond(4.0),
            );
        }
    }
    text
}

//! Times printed with few digits, rounded or truncated, drawn with seeds: the rate is within its
//! uncertainty, and lost samples are detected.

use vibro_io::Reader;
use vibro_math::Noise;
use vibro_record::{Finding, Record, Trace};

/// A clock, and which of its samples are printed.
#[derive(Debug)]
struct Drawn {
    rate: f64,
    /// One unit in the last digit in s, and the decimals that print it.
    digit: f64,
    decimals: usize,
    cut_off: bool,
    phase: f64,
    /// Standard deviation of the instants, as a fraction of a step.
    jitter: f64,
    kept: Vec<usize>,
}

impl Drawn {
    fn new(seed: u64, jitter: bool, lost: usize) -> Drawn {
        let mut noise = Noise::new(seed);
        let rate = 50.0 * 100f64.powf(noise.uniform());
        let rate = match seed % 4 {
            0 => rate.round(),
            1 => 50.0 * (rate / 50.0).round(),
            _ => rate,
        };
        let (digit, decimals) = [(1e-3, 3), (1e-4, 4), (1e-6, 6)][(seed / 4 % 3) as usize];
        let n = noise.between(400.0, 6000.0) as usize;
        let mut kept: Vec<usize> = (0..n).collect();
        for _ in 0..lost {
            kept.remove(noise.between(1.0, (kept.len() - 1) as f64) as usize);
        }
        let jitter = if jitter { noise.between(0.002, 0.03) } else { 0.0 };
        Drawn { rate, digit, decimals, cut_off: seed.is_multiple_of(2), phase: noise.uniform(), jitter, kept }
    }

    fn text(&self) -> String {
        let mut noise = Noise::new(self.kept.len() as u64);
        let mut row = |i: &usize| {
            let t = self.phase + (*i as f64 + self.jitter * noise.normal()) / self.rate;
            let digits = t / self.digit;
            let t = self.digit * if self.cut_off { digits.floor() } else { digits.round() };
            format!("{t:.*},{:.6}\n", self.decimals, (0.1 * *i as f64).sin())
        };
        "time (s),a (m/s^2)\n".to_owned() + &self.kept.iter().map(&mut row).collect::<String>()
    }

    fn read(&self, reader: &Reader) -> (Trace, Vec<Finding>) {
        let read = reader.from_reader("a.csv", self.text().as_bytes());
        let mut read = read.unwrap_or_else(|why| panic!("{self:?}: {why}"));
        let found = read.all_findings();
        let Record::Trace(trace) = read.records.remove(0) else { panic!("no trace") };
        (trace, found)
    }

    /// Deviation of the rate in standard uncertainties.
    fn off(&self, trace: &Trace) -> f64 {
        let rate = trace.rate().expect("even");
        (rate / self.rate - 1.0).abs() / trace.meta.clock
    }

    fn short(&self) -> String {
        let Drawn { rate, digit, cut_off, jitter, kept, .. } = self;
        format!("{rate} Hz in {digit} s, cut off: {cut_off}, jitter {jitter:.3}, {} rows", kept.len())
    }
}

fn is_lost(found: &[Finding]) -> bool {
    found.iter().any(|found| found.code == "samples-lost")
}

const SEEDS: u64 = 480;

#[test]
fn the_rate_of_a_printed_clock_lies_within_its_uncertainty() {
    let mut wrong = Vec::new();
    for seed in 1..=SEEDS {
        let drawn = Drawn::new(seed, false, 0);
        let (trace, found) = drawn.read(&Reader::new());
        if trace.rate().is_none() {
            wrong.push(format!("{seed}: {}: {found:?}", drawn.short()));
        } else if drawn.off(&trace) > 1.01 * 3f64.sqrt() {
            // The true rate is equally likely anywhere within the rounding, so it is at most √3 standard
            // uncertainties off. The factor 1.01 covers the rounding of printed decimals to doubles.
            wrong.push(format!("{seed}: {}: off by {:.2}", drawn.short(), drawn.off(&trace)));
        }
    }
    assert!(wrong.is_empty(), "{} faults:\n{}", wrong.len(), wrong.join("\n"));
}

#[test]
fn the_rate_of_a_printed_clock_that_jitters_lies_within_its_uncertainty() {
    let (mut wrong, mut doubted) = (Vec::new(), 0);
    for seed in 1..=SEEDS {
        let drawn = Drawn::new(seed, true, 0);
        let (trace, found) = drawn.read(&Reader::new());
        if trace.rate().is_none() {
            // If the digit is longer than half a step and nearly a multiple of it, the printed times drift
            // by one digit, as after a lost sample.
            let close = drawn.digit * drawn.rate > 0.5;
            doubted += 1;
            if !close {
                wrong.push(format!("{seed}: {}: {found:?}", drawn.short()));
            }
        } else if drawn.off(&trace) > 3.0 {
            wrong.push(format!("{seed}: {}: off by {:.2}", drawn.short(), drawn.off(&trace)));
        }
    }
    assert!(wrong.is_empty(), "{} faults:\n{}", wrong.len(), wrong.join("\n"));
    assert!(doubted * 20 < SEEDS, "{doubted}");
}

#[test]
fn lost_samples_of_a_printed_clock_are_seen_or_within_the_uncertainty() {
    let mut wrong = Vec::new();
    for seed in 1..=SEEDS {
        let drawn = Drawn::new(seed, seed.is_multiple_of(5), 1 + (seed % 3) as usize);
        let (trace, found) = drawn.read(&Reader::new());
        if trace.rate().is_some() {
            let hidden = drawn.digit * drawn.rate > 0.5;
            if !hidden || drawn.off(&trace) > 3.0 {
                wrong.push(format!("{seed}: {}: silent, off by {:.2}", drawn.short(), drawn.off(&trace)));
            }
            continue;
        }
        if !is_lost(&found) {
            wrong.push(format!("{seed}: {}: {found:?}", drawn.short()));
            continue;
        }
        let number = found.iter().find_map(|found| found.get("longest")).expect("a number") as usize;
        let (part, _) = drawn.read(&Reader::new().stretch(Some(number)));
        if drawn.off(&part) > 3.0 {
            wrong.push(format!("{seed}: {}: stretch off by {:.2}", drawn.short(), drawn.off(&part)));
        }
    }
    assert!(wrong.is_empty(), "{} faults:\n{}", wrong.len(), wrong.join("\n"));
}

/// Samples every 0.625 and 0.4 ms printed in whole milliseconds: no single step shows a lost sample.
#[test]
fn lost_samples_shorter_than_a_digit_are_seen() {
    for (rate, n) in [(1600.0, 2000), (2500.0, 2000), (800.0, 1000), (612.0, 1000)] {
        for lost in [100, 500, n - 100] {
            for cut_off in [false, true] {
                let kept = (0..n).filter(|i| *i != lost).collect();
                let drawn = Drawn { rate, digit: 1e-3, decimals: 3, cut_off, phase: 0.0, jitter: 0.0, kept };
                let (trace, found) = drawn.read(&Reader::new());
                assert!(trace.rate().is_none() && is_lost(&found), "{}: {found:?}", drawn.short());
            }
        }
    }
}

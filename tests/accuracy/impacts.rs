//! Impact times and intervals against their bounds.

use crate::noise::Noise;
use vibroimpact::measure::impacts::{ImpactsOptions, Shape, impacts, interval};
use vibroimpact::record::{Axis, Meta, Trace};
use vibroimpact::units::Unit;

const CASES: u64 = 400;

/// A contact closes within a millisecond and opens slowly; time in samples at 5 kHz.
fn pulse(x: f64) -> f64 {
    let rise = 0.5 * (1.0 + (x / 2.0).tanh());
    rise * (-(x.max(0.0) / 20.0).powi(2)).exp()
}

fn trace(noise: &mut Noise, at: &[f64], heights: &[f64], n: usize, sigma: f64) -> Trace {
    let values = (0..n)
        .map(|i| {
            let clean: f64 = at.iter().zip(heights).map(|(t, h)| h * pulse(i as f64 - t)).sum();
            clean + sigma * noise.normal()
        })
        .collect();
    Trace { meta: Meta::new("contact", Unit::parse("V").unwrap()), axis: Axis::time(0.0, 1.0, n), values }
}

/// Cramér–Rao bound of the time of one pulse of unknown height in white noise: σ² over the information that is left
/// beside the height, from slopes by central differences.
fn bound(at: f64, height: f64, sigma: f64) -> f64 {
    let (mut tt, mut th, mut hh) = (0.0, 0.0, 0.0);
    for i in -200..400 {
        let x = f64::from(i) - at;
        let (slope, s) = (-height * (pulse(x + 1e-4) - pulse(x - 1e-4)) / 2e-4, pulse(x));
        tt += slope * slope;
        th += slope * s;
        hh += s * s;
    }
    (sigma * sigma * hh / (tt * hh - th * th)).sqrt()
}

#[test]
fn onset_times_reach_their_bound() {
    let (sigma, per_record) = (0.03, 20);
    let known = Shape::known(pulse, -12.0..45.0, 0.5).unwrap();
    for (name, shape, limit) in [("known shape", Some(known), 1.3), ("average of the record", None, 1.3)] {
        let (mut sum, mut squares, mut inside, mut n) = (0.0, 0.0, 0, 0);
        let options = ImpactsOptions { shape, hum: false, ..ImpactsOptions::default() };
        for seed in 0..CASES / per_record {
            let mut noise = Noise::new(1000 + seed);
            let at: Vec<f64> = (0..per_record).map(|k| 100.0 + 150.0 * k as f64 + noise.uniform()).collect();
            let heights: Vec<f64> = at.iter().map(|_| 0.8 + 0.4 * noise.uniform()).collect();
            let found = impacts(&trace(&mut noise, &at, &heights, 3200, sigma), &options).unwrap();
            assert_eq!(found.n, at.len(), "seed {seed}: {:?}", found.warnings);
            // An average knows no origin: what is common to a record is taken out, with its one degree of freedom.
            let off: Vec<f64> = found.times.iter().zip(&at).map(|(a, b)| a - b).collect();
            let common =
                if options.shape.is_none() { off.iter().sum::<f64>() / off.len() as f64 } else { 0.0 };
            let free = if options.shape.is_none() { off.len() as f64 / (off.len() - 1) as f64 } else { 1.0 };
            for ((o, at), h) in off.iter().zip(&at).zip(&heights) {
                let score = (o - common) * free.sqrt() / bound(at.fract(), *h, sigma);
                sum += score;
                squares += score * score;
                inside += usize::from((o - common).abs() < 1.96 * found.onset_std.unwrap() * free.sqrt());
                n += 1;
            }
        }
        let n = f64::from(n);
        let (bias, ratio) = (sum / n, (squares / n).sqrt());
        println!(
            "impact onset, {name}: {n} cases, seeds 1000.., std/bound {ratio:.3}, bias/bound {bias:.3}, 95 % coverage {:.1} %",
            100.0 * inside as f64 / n
        );
        assert!(ratio < limit, "{name}: {ratio}");
        // 400 cases scatter the mean by 0.05.
        assert!(bias.abs() < 0.2, "{name}: {bias}");
        assert!((0.92..=0.98).contains(&(inside as f64 / n)), "{name}: {inside} of {n}");
    }
}

#[test]
fn intervals_are_covered_under_onset_noise_and_under_jitter() {
    // Onset noise, jitter, and their efficient standard uncertainties of T for n impacts.
    let n = 60;
    let line = 12f64.sqrt() / (n as f64 * (n * n - 1) as f64).sqrt();
    let mean = 1.0 / ((n - 1) as f64).sqrt();
    let cases = [
        ("onset noise", 0.02, 0.0, Some(0.02 * line)),
        ("jitter", 0.0, 0.02, Some(0.02 * mean)),
        ("both", 0.02, 0.02, None),
    ];
    for (name, onset, jitter, best) in cases {
        let (mut inside, mut squares) = (0, 0.0);
        let total = 3 * CASES;
        for seed in 0..total {
            let mut noise = Noise::new(50_000 + seed);
            let mut phase = 0.0;
            let times: Vec<f64> = (0..n)
                .map(|k| {
                    phase += if k > 0 { 1.0 + jitter * noise.normal() } else { 0.0 };
                    phase + onset * noise.normal()
                })
                .collect();
            let found = interval(&times, &(0..n).collect::<Vec<_>>()).unwrap();
            inside += usize::from((found.mean - 1.0).abs() < 1.96 * found.std);
            squares += (found.mean - 1.0).powi(2);
        }
        let coverage = inside as f64 / total as f64;
        let std = (squares / total as f64).sqrt();
        let ratio = best.map_or(f64::NAN, |b| std / b);
        println!(
            "mean interval, {name}: {total} cases, seeds 50000.., std/best {ratio:.3}, 95 % coverage {:.1} %",
            100.0 * coverage
        );
        // 1200 cases scatter the coverage by 0.6 %.
        assert!((0.92..=0.98).contains(&coverage), "{name}: {coverage}");
        assert!(best.is_none() || ratio < 1.3, "{name}: {ratio}");
    }
}

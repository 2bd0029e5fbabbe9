//! Frequency and amplitude of a sine in white and in coloured noise.

use super::draws::Draws;
use super::noise::Noise;
use std::f64::consts::TAU;
use vibroimpact::measure::tones::{sine, tones};
use vibroimpact::record::{Axis, Meta, Trace};
use vibroimpact::units::Unit;

const CASES: u64 = 1000;
const SEED: u64 = 0x51e;
const RATE: f64 = 1024.0;

/// Root mean square and mean of the errors in units of the bound, and coverage of the 95 % intervals.
struct Reached {
    ratio: f64,
    bias: f64,
    coverage: f64,
}

/// Statistics of frequency and amplitude over random cases at this signal-to-noise ratio in dB, and the
/// number of records without a visible line.
fn reached(decibel: f64, draws: Draws) -> ([Reached; 2], usize) {
    let mut random = Noise::new(SEED);
    let eta = 10f64.powf(decibel / 10.0);
    let mut errors = [Vec::new(), Vec::new()];
    let mut inside = [0, 0];
    let mut refused = 0;
    for _ in 0..draws.of(CASES) {
        let n = random.between(200.0, 600.0) as usize;
        // At least four lines from 0 Hz and from half the sampling rate: nearer, the mirror image of the
        // sine changes the bound.
        let f = random.between(4.0, n as f64 / 2.0 - 4.0) * RATE / n as f64;
        let (amplitude, phase) = (random.between(0.5, 2.0), random.between(0.0, TAU));
        let sigma = amplitude / (2.0 * eta).sqrt();
        let values = (0..n)
            .map(|i| amplitude * (TAU * f * i as f64 / RATE + phase).cos() + 0.3 + sigma * random.normal())
            .collect();
        let meta = Meta::new("sine", Unit::parse("m/s").unwrap());
        let trace = Trace { meta, axis: Axis::time(0.0, 1.0 / RATE, n), values };
        let Ok(found) = sine(&trace, None) else {
            refused += 1;
            continue;
        };
        let n = n as f64;
        // Kay 1993, eq. 3.41, for a real sine.
        let bounds = [RATE / TAU * (12.0 / (eta * n * (n * n - 1.0))).sqrt(), amplitude / (n * eta).sqrt()];
        let tone = &found.tones[0];
        let estimates = [(&tone.frequency, f), (&tone.amplitude, amplitude)];
        for (k, (estimate, truth)) in estimates.into_iter().enumerate() {
            let error = estimate.value - truth;
            errors[k].push(error / bounds[k]);
            inside[k] += usize::from(error.abs() < draws.reach() * estimate.std.unwrap());
        }
    }
    let figures = [0, 1].map(|k| {
        let count = errors[k].len() as f64;
        Reached {
            ratio: (errors[k].iter().map(|e| e * e).sum::<f64>() / count).sqrt(),
            bias: errors[k].iter().sum::<f64>() / count,
            coverage: inside[k] as f64 / count,
        }
    });
    (figures, refused)
}

fn frequency_and_amplitude_reach_the_bound(draws: Draws) {
    println!("seed {SEED:#x}, {} records of 200 to 600 samples a line", draws.of(CASES));
    for decibel in [60.0, 40.0, 30.0, 20.0, 10.0, 5.0, 0.0, -5.0, -10.0] {
        let (figures, refused) = reached(decibel, draws);
        for (name, r) in ["frequency", "amplitude"].iter().zip(&figures) {
            println!(
                "{decibel:>4} dB {name}: std {:.3} of the bound, bias {:+.3} of it, coverage {:.1} %, {refused} refused",
                r.ratio,
                r.bias,
                100.0 * r.coverage
            );
        }
        // Below 20 dB the figures are only printed: at −10 dB some noise lines exceed the line of the sine.
        if decibel >= 20.0 {
            assert_eq!(refused, 0);
            for r in &figures {
                // Over 1000 cases ratio, bias and coverage scatter by 0.022, 0.032 and 0.007.
                let near = r.ratio < 1.1 && r.bias.abs() < 0.1;
                assert!(near || draws == Draws::Few, "{decibel} dB: {} {}", r.ratio, r.bias);
                assert!(draws.part(0.92..=0.98).contains(&r.coverage), "{decibel} dB: {}", r.coverage);
            }
        }
    }
}

#[test]
fn two_sines_are_parted_with_uncertainties_that_cover() {
    const PAIRS: usize = 400;
    let mut random = Noise::new(0x2_70e5);
    let (mut inside, mut count, mut fewer) = ([0usize; 3], 0usize, 0usize);
    for _ in 0..PAIRS {
        let n = random.between(300.0, 600.0) as usize;
        let line = RATE / n as f64;
        let f1 = random.between(8.0, n as f64 / 2.0 - 20.0) * line;
        let f2 = f1 + random.between(2.0, 10.0) * line;
        let truth = [
            (f1, random.between(0.5, 2.0), random.between(-3.0, 3.0)),
            (f2, random.between(0.5, 2.0), random.between(-3.0, 3.0)),
        ];
        let sigma = random.between(0.02, 0.2);
        let values = (0..n)
            .map(|i| {
                let t = i as f64 / RATE;
                let sines: f64 = truth.iter().map(|(f, a, p)| a * (TAU * f * t + p).cos()).sum();
                sines - 0.7 + sigma * random.normal()
            })
            .collect();
        let meta = Meta::new("sines", Unit::parse("m/s").unwrap());
        let found = tones(&Trace { meta, axis: Axis::time(0.0, 1.0 / RATE, n), values }, 2).unwrap();
        if found.tones.len() < 2 {
            fewer += 1;
            continue;
        }
        for (f, a, p) in truth {
            let off = |tone: &&vibroimpact::measure::tones::Tone| (tone.frequency.value - f).abs();
            let tone = found.tones.iter().min_by(|a, b| off(a).total_cmp(&off(b))).unwrap();
            let turn = (tone.phase.value - p + 3.0 * TAU / 2.0).rem_euclid(TAU) - TAU / 2.0;
            let errors = [
                (tone.frequency.value - f, &tone.frequency),
                (tone.amplitude.value - a, &tone.amplitude),
                (turn, &tone.phase),
            ];
            count += 1;
            for (k, (error, estimate)) in errors.into_iter().enumerate() {
                inside[k] += usize::from(error.abs() < 1.96 * estimate.std.unwrap());
            }
        }
    }
    let covered = inside.map(|n| n as f64 / count as f64);
    println!(
        "two sines 2 to 10 lines apart: coverage {covered:?} of {count}, {fewer} of {PAIRS} pairs not parted"
    );
    // The coverage of 800 sines scatters by 0.008.
    assert!(covered.iter().all(|c| (0.92..=0.98).contains(c)), "{covered:?}");
    assert!(fewer * 100 <= PAIRS, "{fewer}");
}

/// One sine at 3 to 8 Hz in noise y(i) = 0.95 y(i − 1) + e(i). The density of this noise is there up to 39
/// times that of white noise of the same variance.
fn coloured_noise_is_counted_where_the_sine_is(draws: Draws) {
    let records = draws.of(600) as usize;
    let seed = 0xc0_104e;
    let mut random = Noise::new(seed);
    let (mut inside, mut stated, mut silent) = ([[0usize; 2]; 2], [0usize; 2], 0);
    for _ in 0..records {
        let n = random.between(2000.0, 4000.0) as usize;
        let (f, amplitude, phase) = (random.between(3.0, 8.0), 1.0, random.between(0.0, TAU));
        // The amplitude is twice the standard deviation of the noise, so the line always stands out.
        let sigma = 0.5 * (1.0f64 - 0.95 * 0.95).sqrt();
        let mut y = 0.5 * random.normal();
        let values = (0..n)
            .map(|i| {
                y = 0.95 * y + sigma * random.normal();
                amplitude * (TAU * f * i as f64 / RATE + phase).cos() + y
            })
            .collect();
        let meta = Meta::new("sine", Unit::parse("m/s").unwrap());
        let trace = Trace { meta, axis: Axis::time(0.0, 1.0 / RATE, n), values };
        let one = sine(&trace, None).unwrap();
        let several = tones(&trace, 1).unwrap();
        // A doubt takes the uncertainty, and nothing is said of one that is larger for the noise.
        let has_std = [&one, &several].iter().any(|found| found.tones[0].frequency.std.is_some());
        let mut findings = one.findings.iter().chain(&several.findings);
        silent += usize::from(has_std && !findings.any(|f| f.code == "sine-noise-coloured"));
        let of_tones = (&several.tones[0].frequency, &several.tones[0].amplitude);
        for (k, (frequency, size)) in
            [(&one.tones[0].frequency, &one.tones[0].amplitude), of_tones].into_iter().enumerate()
        {
            let (Some(f_std), Some(size_std)) = (frequency.std, size.std) else { continue };
            stated[k] += 1;
            inside[k][0] += usize::from((frequency.value - f).abs() < draws.reach() * f_std);
            inside[k][1] += usize::from((size.value - amplitude).abs() < draws.reach() * size_std);
        }
    }
    let covered = [0, 1].map(|k| inside[k].map(|n| n as f64 / stated[k] as f64));
    println!(
        "seed {seed:#x}: sine in noise of 0.95: coverage {covered:?}, {stated:?} stated, {silent} of {records} do not say so"
    );
    // One of 10⁴ noise lines looks like a second sine, some more where the density is steep: then no
    // uncertainty is stated, in at most 2 % of the records.
    assert!(stated.iter().all(|n| *n >= records * 98 / 100), "{stated:?}");
    // The coverage of 600 cases scatters by 0.009. The density is that of a process whose coefficient is
    // known to a tenth of 1 − 0.95.
    assert!(covered.iter().flatten().all(|c| draws.part(0.92..=0.98).contains(c)), "{covered:?}");
    assert!(silent == 0, "{silent}");
}

/// 4 cases of each kind, run with every test.
mod few {
    use super::Draws;

    #[test]
    fn frequency_and_amplitude_reach_the_bound() {
        super::frequency_and_amplitude_reach_the_bound(Draws::Few);
    }

    #[test]
    fn coloured_noise_is_counted_where_the_sine_is() {
        super::coloured_noise_is_counted_where_the_sine_is(Draws::Few);
    }
}

/// All cases, run with `--ignored`.
mod all {
    use super::Draws;

    #[test]
    #[ignore = "Monte Carlo: cargo test --release -- --ignored"]
    fn frequency_and_amplitude_reach_the_bound() {
        super::frequency_and_amplitude_reach_the_bound(Draws::All);
    }

    #[test]
    #[ignore = "Monte Carlo: cargo test --release -- --ignored"]
    fn coloured_noise_is_counted_where_the_sine_is() {
        super::coloured_noise_is_counted_where_the_sine_is(Draws::All);
    }
}

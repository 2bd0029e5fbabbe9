//! Scatter of averaged spectra, and displacements by integration in the time domain.

use super::noise::Noise;
use num_complex::Complex64;
use std::f64::consts::TAU;
use vibroimpact::record::Traces;
use vibroimpact::record::{Axis, Meta, Scaling, Trace, Window};
use vibroimpact::signal::integrate::{InTime, in_time};
use vibroimpact::signal::segment::Segments;
use vibroimpact::signal::spectrum::{averaged, scatter};
use vibroimpact::signal::welch::Welch;
use vibroimpact::units::Unit;

const SEED: u64 = 0x5bec;
const LENGTH: usize = 64;

fn trace(unit: &str, rate: f64, values: Vec<f64>) -> Trace {
    let meta = Meta::new("laser", Unit::parse(unit).unwrap());
    Trace { meta, axis: Axis::time(0.0, 1.0 / rate, values.len()), values }
}

/// Share of lines of white noise whose 95 % interval holds the true level.
fn coverage(averages: usize, scaling: Scaling, random: &mut Noise) -> f64 {
    let (mut inside, mut lines, rate) = (0usize, 0usize, 1000.0);
    // White noise of variance 1 has a density of 2/rate. Hann is 1.5 lines wide, so a line has the power
    // 2·1.5/N.
    let power: f64 = 2.0 * 1.5 / LENGTH as f64;
    let truth = match scaling {
        Scaling::Psd => 2.0 / rate,
        Scaling::Power => power,
        Scaling::Rms => power.sqrt(),
        _ => (2.0 * power).sqrt(),
    };
    for _ in 0..200 {
        let segments = Segments::new(LENGTH, 0.5).unwrap();
        let n = LENGTH + (averages - 1) * segments.hop;
        let record = trace("m/s", rate, (0..n).map(|_| random.normal()).collect());
        let meta = record.meta.clone();
        let welch = Welch { segments, window: Window::Hann, detrend: true };
        let found = welch.average(&mut Traces::from_memory(vec![record]).unwrap(), false, |_| ()).unwrap();
        let values = averaged(&found, 0, &meta, Window::Hann, scaling).unwrap().values.magnitudes();
        let part = scatter(&found, scaling);
        // Removing the mean lowers the lines beside 0 Hz, and the line at half the rate has half the level.
        for k in 3..LENGTH / 2 {
            inside += usize::from((values[k] - truth).abs() < 1.96 * part[k] * values[k]);
            lines += 1;
        }
    }
    inside as f64 / lines as f64
}

#[test]
fn the_scatter_of_lines_holds_the_truth() {
    let mut random = Noise::new(SEED);
    println!("seed {SEED:#x}, 200 records a line");
    for averages in [20, 50, 100] {
        for scaling in [Scaling::Power, Scaling::Psd, Scaling::Peak, Scaling::Rms] {
            let found = coverage(averages, scaling, &mut random);
            println!("{averages} averages, {scaling:?}: {:.1} %", 100.0 * found);
            // A sum of squares is not normal: its gamma distribution gives 92.4 % for powers of 19 segments
            // and 94.5 % for 95; amplitudes lie between. Of 6000 lines two thirds are independent: the
            // coverage scatters by 0.4 %.
            assert!((0.912..=0.98).contains(&found), "{averages} {scaling:?}: {found}");
        }
    }
}

/// Velocity with offset, drift and noise: the displacement is right within 1 % anywhere in the stated band.
#[test]
fn displacements_are_right_within_the_stated_band() {
    let (rate, n) = (2048.0, 20_480usize);
    let mut random = Noise::new(SEED);
    println!("seed {SEED:#x}");
    let how = InTime { times: 1, corner: 2.0, order: 4, period: None };
    let flat = trace("m/s", rate, (0..n).map(|i| (0.1 * i as f64).cos()).collect());
    let [low, high] = in_time(&flat, &how).unwrap().band;
    let mut worst = 0.0f64;
    for case in 0..200 {
        // Uniform in the logarithm over the band.
        let f = low * (high / low).powf(random.uniform());
        let omega = TAU * f;
        let (phase, amplitude) = (TAU * random.uniform(), 1e-3 * omega);
        let (offset, drift) = (random.between(-2.0, 2.0), random.between(-2.0, 2.0));
        let noise = random.between(0.0, 0.01);
        let values = (0..n)
            .map(|i| {
                let t = i as f64 / rate;
                let rest = offset + drift * i as f64 / n as f64 + noise * random.normal();
                amplitude * ((omega * t + phase).cos() + rest)
            })
            .collect();
        let found = in_time(&trace("m/s", rate, values), &InTime { period: Some(1.0 / f), ..how }).unwrap();
        let edge = (found.edge * rate) as usize;
        // Amplitude by projection between the edges, over whole periods.
        let inner = (((n - 2 * edge) as f64 * f / rate).floor() / f * rate).round() as usize;
        let sine = (edge..edge + inner)
            .map(|i| found.trace.values[i] * Complex64::cis(-omega * i as f64 / rate))
            .sum::<Complex64>()
            * (2.0 / inner as f64);
        let truth = Complex64::from_polar(1e-3, phase - 0.25 * TAU);
        let error = (sine / truth - 1.0).norm();
        worst = worst.max(error);
        assert!(error < 0.01, "case {case}: {f} Hz, offset {offset}, drift {drift}, noise {noise}: {error}");
    }
    println!("{low:.2} to {high:.2} Hz, largest error {:.2} %", 100.0 * worst);
}

use super::*;
use crate::record::{Axis, Meta};
use crate::units::Unit;

/// Normal deviates from a 64-bit mix of a counter (splitmix, Steele et al. 2014) and the polar form of Box and Muller.
pub struct Noise(u64);

impl Noise {
    pub fn new(seed: u64) -> Noise {
        Noise(seed)
    }

    pub fn uniform(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
    }

    pub fn normal(&mut self) -> f64 {
        (-2.0 * (1.0 - self.uniform()).ln()).sqrt() * (std::f64::consts::TAU * self.uniform()).cos()
    }
}

fn trace(values: Vec<f64>, rate: f64) -> Trace {
    Trace {
        meta: Meta::new("contact", Unit::parse("V").unwrap()),
        axis: Axis::time(0.0, 1.0 / rate, values.len()),
        values,
    }
}

/// Decaying pulses at `times`, with a flank of about three samples.
fn pulses(times: &[f64], n: usize, rate: f64, sigma: f64) -> Trace {
    let mut noise = Noise::new(11);
    let values = (0..n)
        .map(|i| {
            let t = i as f64 / rate;
            let pulse = |x: f64| if x > 0.0 { (1.0 - (-x / 1e-3).exp()) * (-x / 4e-3).exp() } else { 0.0 };
            sigma * noise.normal() + times.iter().map(|at| pulse(t - at)).sum::<f64>()
        })
        .collect();
    trace(values, rate)
}

#[test]
fn a_regular_train_with_one_missed_and_one_doubled() {
    let mut times: Vec<f64> = (0..40).map(|k| 0.05 + 0.1 * f64::from(k)).collect();
    times.remove(20);
    times.insert(30, 0.05 + 0.1 * 31.0 - 0.07);
    times.sort_by(f64::total_cmp);
    let found = impacts(&pulses(&times, 4200, 1000.0, 0.005), &ImpactsOptions::default()).unwrap();
    assert_eq!((found.n, found.missed, found.doubled, found.regular), (40, 1, 1, true), "{found:?}");
    // σ_t = 5e-3/(slope of 150/s) = 3e-5 s, so a line through 40 points has u = 3e-5·√(12/40³) = 4e-7 s; four of these.
    assert!((found.interval.value - 0.1).abs() < 2e-6, "{found:?}");
}

#[test]
fn impacts_of_every_second_cycle_keep_their_phase() {
    let f = 15.0;
    let times: Vec<f64> = (0..30).map(|k| (2.0 * f64::from(k) + 1.25) / f).collect();
    let rate = 2000.0;
    let mut options = ImpactsOptions { excitation: Some(f), ..ImpactsOptions::default() };
    let trace = pulses(&times, 8500, rate, 0.002);
    let stated = impacts(&trace, &options).unwrap();
    assert_eq!(stated.per_cycle, Some(PerCycle { impacts: 1, cycles: 2 }));
    options.reference =
        Some((0..8500).map(|i| (std::f64::consts::TAU * f * f64::from(i) / rate).sin()).collect());
    options.excitation = None;
    let measured = impacts(&trace, &options).unwrap();
    assert_eq!(measured.per_cycle, stated.per_cycle);
    assert!((measured.excitation.unwrap() - f).abs() < 1e-4);
    for found in [stated, measured] {
        // Half height is passed within 1 ms = 0.015 cycles of the onset.
        // The first edge decides which of two cycles counts as the first.
        assert!((found.phases[0].mean.fract() - 0.25).abs() < 0.016, "{:?}", found.phases);
        assert!(found.regular);
    }
}

#[test]
fn pulses_that_point_downwards_are_turned() {
    let times: Vec<f64> = (0..10).map(|k| 0.05 + 0.1 * f64::from(k)).collect();
    let mut trace = pulses(&times, 1100, 1000.0, 0.005);
    trace.values.iter_mut().for_each(|v| *v = 2.0 - *v);
    let found = impacts(&trace, &ImpactsOptions::default()).unwrap();
    assert_eq!(found.n, 10);
    assert!(found.warnings.iter().any(|w| w.contains("downwards")), "{:?}", found.warnings);
}

#[test]
fn clipped_pulses_are_said() {
    let times: Vec<f64> = (0..10).map(|k| 0.05 + 0.1 * f64::from(k)).collect();
    let mut trace = pulses(&times, 1100, 1000.0, 0.005);
    trace.values.iter_mut().for_each(|v| *v = v.min(0.3));
    let found = impacts(&trace, &ImpactsOptions::default()).unwrap();
    assert_eq!(found.n, 10);
    assert!(found.warnings.iter().any(|w| w.contains("10 of 10 pulses are clipped")), "{:?}", found.warnings);
}

#[test]
fn what_holds_no_impacts_is_refused() {
    let refused = |trace: &Trace| impacts(trace, &ImpactsOptions::default()).unwrap_err();
    assert!(refused(&trace(vec![1.0; 100], 100.0)).to_string().contains("equal"));
    let mut one = pulses(&[0.3], 1000, 1000.0, 0.005);
    assert!(refused(&one).to_string().contains("1 impact was found"));
    one.values[7] = f64::NAN;
    assert!(refused(&one).to_string().contains("missing"));
    let mut noise = Noise::new(5);
    let quiet = trace((0..5000).map(|_| noise.normal()).collect(), 1000.0);
    assert!(refused(&quiet).to_string().contains("0 impacts"), "{}", refused(&quiet));
    let mut unknown = pulses(&[0.1, 0.2], 400, 1000.0, 0.005);
    unknown.axis = Axis::index(400);
    let error = refused(&unknown);
    assert!(error.to_string().contains("--base-band") && error.exit_code() == 2, "{error}");
    let one_edge = ImpactsOptions {
        reference: Some((0..400).map(|i| f64::from(i / 200)).collect()),
        ..ImpactsOptions::default()
    };
    let error = impacts(&pulses(&[0.1, 0.2], 400, 1000.0, 0.005), &one_edge).unwrap_err();
    assert!(error.to_string().contains("1 rising edge:"), "{error}");
}

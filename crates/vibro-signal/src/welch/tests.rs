use super::*;
use crate::spectrum;
use vibro_record::units::Unit;
use vibro_record::{Axis, Meta, Scaling, Trace};

const RATE: f64 = 512.0;

fn trace(name: &str, values: Vec<f64>) -> Trace {
    let meta = Meta::new(name, Unit::parse("m/s").unwrap());
    Trace { meta, axis: Axis::time(0.0, 1.0 / RATE, values.len()), values }
}

/// The two sequences of `fixtures/spectra/make.py`.
fn records() -> Vec<Trace> {
    let x: Vec<f64> = (0..700).map(|i| f64::from((i * i * 7 + 3 * i) % 101) / 50.0 + 0.25).collect();
    let y = (0..700).map(|i| f64::from((i * i * 5 + 11 * i) % 89) / 40.0 + 0.5 * x[i as usize]).collect();
    vec![trace("x", x), trace("y", y)]
}

fn reference(name: &str) -> Vec<f64> {
    let all = include_str!("../../../../fixtures/spectra/reference.csv");
    let line = all.lines().find_map(|line| line.strip_prefix(name)?.strip_prefix(',')).unwrap();
    line.split(',').map(|c| c.parse().unwrap()).collect()
}

fn averages(traces: Vec<Trace>, length: usize, overlap: f64, window: Window) -> Result<Averages> {
    let welch = Welch { segments: Segments::new(length, overlap)?, window, detrend: true };
    welch.average(&mut Traces::from_memory(traces)?, true, |_| ())
}

/// Both sides have the rounding of some 20 segments' lines, the largest of order one.
fn close(found: &[f64], expected: &[f64], scale: f64) {
    assert_eq!(found.len(), expected.len());
    for (k, (a, b)) in found.iter().zip(expected).enumerate() {
        assert!((a - b).abs() < 1e-13 * scale, "line {k}: {a} against {b}");
    }
}

#[test]
fn agrees_with_scipy() {
    for window in Window::ALL {
        let averages = averages(records(), 64, 0.5, window).unwrap();
        assert_eq!(averages.count, 20);
        for scaling in [Scaling::Psd, Scaling::Power] {
            let found = spectrum::averaged(&averages, 0, &records()[0].meta, window, scaling).unwrap();
            let expected = reference(&format!("{} 64 {}", scaling.name(), window.name()));
            // The line at 0 Hz is NaN: the mean is subtracted.
            assert!(found.values.magnitude(0).is_nan());
            close(&found.values.magnitudes()[1..], &expected[1..], 1.0);
        }
        let sums = reference(&format!("sums {}", window.name()));
        close(&[averages.sum, averages.squares], &sums[..2], 64.0);
    }
    // An odd length with three quarters of overlap: no line at half the sampling rate.
    let odd = averages(records(), 63, 0.75, Window::Hann).unwrap();
    let found = spectrum::averaged(&odd, 0, &records()[0].meta, Window::Hann, Scaling::Psd).unwrap();
    close(&found.values.magnitudes()[1..], &reference("psd 63 hann")[1..], 1.0);
}

#[test]
fn products_agree_with_scipy() {
    let averages = averages(records(), 64, 0.5, Window::Hann).unwrap();
    let (re, im) = (reference("cross real"), reference("cross imaginary"));
    for (k, z) in averages.cross[0].iter().enumerate() {
        let sides = if k == 0 || k == 32 { 1.0 } else { 2.0 };
        let z = z * (sides / (RATE * averages.squares));
        assert!((z - Complex64::new(re[k], im[k])).norm() < 1e-13, "line {k}");
    }
}

/// Batches, groups and cores must not affect the result: more segments than one group, compared with one
/// segment after another.
#[test]
fn long_records_are_averaged_like_short_ones() {
    let n = 300_001;
    let values: Vec<f64> =
        (0..n as u64).map(|i| ((i * 7919 + i * i % 1013) % 2003) as f64 / 1000.0).collect();
    let found = averages(vec![trace("x", values.clone())], 1000, 0.5, Window::Hann).unwrap();
    let (w, transform) = (window::samples(Window::Hann, 1000), Transform::new(1000));
    let (mut sum, mut count) = (vec![0.0; 501], 0);
    for segment in values.windows(1000).step_by(500) {
        let mean = segment.iter().sum::<f64>() / 1000.0;
        let lines =
            transform.forward(&segment.iter().zip(&w).map(|(v, w)| (v - mean) * w).collect::<Vec<_>>());
        sum.iter_mut().zip(lines).for_each(|(s, x)| *s += x.norm_sqr());
        count += 1;
    }
    assert_eq!((found.count, count), (599, 599));
    for (a, s) in found.auto[0].iter().zip(sum) {
        // The 599 positive summands are added in another order.
        assert!((a * 599.0 / s - 1.0).abs() < 599.0 * f64::EPSILON);
    }
}

#[test]
fn overlapping_segments_are_not_independent() {
    let w = window::samples(Window::Hann, 4096);
    // Hann windows with half overlap have a squared correlation of 1/36, so a large number of segments
    // counts as 1/(1 + 2/36) of it.
    let many = effective(&w, 2048, 10_000) / 10_000.0;
    assert!((many - 1.0 / (1.0 + 2.0 / 36.0)).abs() < 1e-5, "{many}");
    assert_eq!(effective(&w, 4096, 50), 50.0);
    assert_eq!(effective(&w, 2048, 1), 1.0);
}

#[test]
fn records_without_a_spectrum_are_refused() {
    let error = |traces: Vec<Trace>| averages(traces, 64, 0.5, Window::Hann).unwrap_err().to_string();
    assert!(error(vec![trace("x", vec![1.0; 63])]).contains("63 samples: not one segment of 64"));
    assert!(error(vec![trace("x", vec![1.5; 640])]).contains("constant at 1.5"));
    let mut gap = records();
    gap[1].values[500] = f64::NAN;
    assert!(error(gap).contains("sample 500 of channel \"y\" is missing"));
}

#[test]
fn progress_counts_samples() {
    let mut seen = Vec::new();
    let welch = Welch { segments: Segments::new(64, 0.5).unwrap(), window: Window::Hann, detrend: true };
    let mut traces = Traces::from_memory(records()).unwrap();
    welch.average(&mut traces, false, |n| seen.push(n)).unwrap();
    assert_eq!(seen.last(), Some(&700));
}

#[test]
fn a_mean_that_is_kept_is_the_line_at_zero() {
    let welch = Welch { segments: Segments::new(64, 0.5).unwrap(), window: Window::Hann, detrend: false };
    let values: Vec<f64> =
        (0..640).map(|i| 5.0 + (std::f64::consts::TAU * f64::from(i) / 8.0).cos()).collect();
    let averages = welch.average(&mut Traces::from_memory(vec![trace("x", values)]).unwrap(), false, |_| ());
    let found = spectrum::averaged(
        &averages.unwrap(),
        0,
        &Meta::new("x", Unit::parse("m/s").unwrap()),
        Window::Hann,
        Scaling::Peak,
    );
    let found = found.unwrap().values.magnitudes();
    // A sum over 64 samples of order five.
    assert!((found[0] - 5.0).abs() < 1e-12 && (found[8] - 1.0).abs() < 1e-12, "{found:?}");
}

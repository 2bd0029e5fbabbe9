use super::*;

/// Third-octave centres and weighting factors of ISO 5349-1:2001, table A.2.
const TABLE: [(i32, f64); 25] = [
    (6, 0.375),
    (7, 0.545),
    (8, 0.727),
    (9, 0.873),
    (10, 0.951),
    (11, 0.958),
    (12, 0.896),
    (13, 0.782),
    (14, 0.647),
    (15, 0.519),
    (16, 0.411),
    (17, 0.324),
    (18, 0.256),
    (19, 0.202),
    (20, 0.160),
    (21, 0.127),
    (22, 0.101),
    (23, 0.0799),
    (24, 0.0634),
    (25, 0.0503),
    (26, 0.0398),
    (27, 0.0314),
    (28, 0.0245),
    (29, 0.0186),
    (30, 0.0135),
];

fn steady(rate: f64, f: f64) -> f64 {
    // The slowest pole settles with e^(−π·6.31/0.71·t), to nothing after 2 s; whole periods follow.
    let settle = (2.0 * rate) as usize;
    let n = ((20.0 * f).round().max(20.0) / f * rate).round() as usize;
    let values: Vec<f64> = (0..settle + n).map(|i| (TAU * f * i as f64 / rate).sin()).collect();
    let values = weighted(&values, rate).unwrap();
    (2.0 * values[settle..].iter().map(|y| y * y).sum::<f64>() / n as f64).sqrt()
}

#[test]
fn the_formula_gives_the_table_of_the_standard() {
    for (band, factor) in TABLE {
        let w = weighting(10f64.powf(f64::from(band) / 10.0)).norm();
        // The table has three digits: half of the last one is up to 0.4 %.
        assert!((w / factor - 1.0).abs() < 0.004, "{band}: {w} {factor}");
    }
}

#[test]
fn the_filter_follows_the_formula_at_third_octave_centres() {
    for band in (6..=31).step_by(5) {
        let f = 10f64.powf(f64::from(band) / 10.0);
        let truth = weighting(f).norm();
        // The bilinear transform bends frequencies by (πf/rate)²/3: 0.05 % at 1 kHz, three octaves of slope
        // at most; a period that is no whole number of samples adds 1/(2n).
        assert!((steady(102_400.0, f) / truth - 1.0).abs() < 2e-3, "{f}");
    }
    // At low rates it stays within the tolerance of the standard, 11 % between 10 Hz and 500 Hz.
    assert!((steady(8_000.0, 500.0) / weighting(500.0).norm() - 1.0).abs() < 0.05);
}

#[test]
fn three_axes_and_half_a_day() {
    let rate = 6_000.0;
    let axis = |amplitude: f64| -> Vec<f64> {
        (0..60_000).map(|i| amplitude * (TAU * 100.0 * f64::from(i) / rate).sin()).collect()
    };
    let exposure = exposure(rate, &[&axis(30.0), &axis(40.0), &axis(0.0)], Some(2.0)).unwrap();
    let truth = 50.0 / 2f64.sqrt() * weighting(100.0).norm();
    // The warped formula at 100 Hz of 6 kHz: (π·100/6000)²/3 = 0.1 %.
    assert!((exposure.a_hv.value / truth - 1.0).abs() < 1.5e-3, "{} {truth}", exposure.a_hv.value);
    assert!((exposure.a8.unwrap().value - 0.5 * exposure.a_hv.value).abs() < 1e-12);
    assert!((exposure.unweighted_peak - 40.0).abs() < 0.03);
    // √2, and 60 samples a period: the largest lies within 1 − cos(π/60) = 0.14 % of the crest.
    assert!((exposure.crest_factor / 2f64.sqrt() - 1.0).abs() < 2e-3, "{}", exposure.crest_factor);
    assert_eq!(exposure.findings, [Finding::note("exposure-understates-shocks")]);
}

#[test]
fn an_offset_changes_nothing_that_vibrates() {
    let rate = 6_000.0;
    let wave: Vec<f64> = (0..60_000).map(|i| 30.0 * (TAU * 100.0 * f64::from(i) / rate).sin()).collect();
    let of = |values: &[f64]| exposure(rate, &[values], None).unwrap();
    let plain = of(&wave);
    let offset = of(&wave.iter().map(|v| v + 500.0).collect::<Vec<f64>>());
    // Roundings of 500 beside 30; the transient of the first sample has decayed to e⁻¹⁴.
    assert!((offset.a_hv.value / plain.a_hv.value - 1.0).abs() < 1e-9);
    assert!((offset.crest_factor / plain.crest_factor - 1.0).abs() < 1e-9);
    assert!((offset.unweighted_peak / plain.unweighted_peak - 1.0).abs() < 1e-9);
}

#[test]
fn what_cannot_be_exposed_is_refused() {
    assert!(weighted(&[0.0; 100], 3000.0).is_err());
    let why = |values: &[f64], hours| exposure(1e4, &[values], hours).unwrap_err();
    assert!(why(&[], None).to_string().contains("settles"));
    let still = vec![3.0; 10_000];
    let error = why(&still, None);
    assert!(error.exit_code() == 1 && error.to_string().contains("does not vibrate"), "{error}");
    assert_eq!(exposure(1e4, &[], None).unwrap_err().exit_code(), 2);
    assert_eq!(why(&still, Some(30.0)).exit_code(), 2);
    let lost = why(&[1.0, f64::NAN, 2.0, f64::NAN], None);
    assert!(lost.exit_code() == 1 && lost.to_string().contains("2 accelerations"), "{lost}");
}

#[test]
fn a_short_record_has_a_finding() {
    let rate = 6_000.0;
    let duration = |seconds: i32| {
        let values: Vec<f64> =
            (0..6_000 * seconds).map(|i| (TAU * 100.0 * f64::from(i) / rate).sin()).collect();
        let found = exposure(rate, &[&values], None).unwrap().findings;
        found.iter().find(|f| f.code == "exposure-record-short")?.get("duration")
    };
    // Half a second settles the weighting.
    assert_eq!((duration(3), duration(9)), (Some(2.5), None));
}

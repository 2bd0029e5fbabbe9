use super::*;
use vibro_math::Oscillator;

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

/// Amplitude that a sine of amplitude 1 has after the weighting, by its mean square over whole periods.
fn steady(rate: f64, f: f64) -> f64 {
    // The slowest pole settles with e^(−π·6.31/0.71·t), to e⁻²⁰ after 0.7 s; whole periods follow.
    let settle = (0.7 * rate) as usize;
    let n = ((2.0 * f).round() / f * rate).round() as usize;
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

/// The table of tolerances in docs/weighting.md: its rows have the nominal centre, the weighting, both
/// tolerances in per cent, and the deviation at each sampling rate.
#[test]
fn the_weighting_keeps_its_tolerances_at_every_third_octave_centre_and_rate() {
    let rates = [5_120.0, 6_400.0, 8_192.0, 12_800.0, 25_600.0, 51_200.0];
    let document = include_str!("../../../../docs/weighting.md");
    let head = rates.map(|rate| format!(" {rate:.0} Hz |")).concat();
    let (_, table) = document.split_once(&head).expect("the table has these sampling rates");
    let rows: Vec<Vec<f64>> = table.lines().skip(2).map_while(numbers).collect();
    assert_eq!(rows.len(), 24);
    for (band, row) in (8..=31).zip(rows) {
        let f = 10f64.powf(f64::from(band) / 10.0);
        let truth = weighting(f).norm();
        // The nominal centre is rounded to 1 %, and the weighting to three digits.
        assert!((row[0] / f - 1.0).abs() < 0.015 && (row[1] / truth - 1.0).abs() < 0.004, "{row:?}");
        for (rate, stated) in rates.into_iter().zip(&row[4..]) {
            let deviation = 100.0 * (steady(rate, f) / truth - 1.0);
            // The whole periods do not end on a sample: the sum is off by 1/2n with n = 2 s · rate, 0.005 %.
            // The second term is half of the last digit in the document.
            assert!((deviation - stated).abs() < 0.005 + 0.005, "{f} {rate}: {deviation}");
            assert!(deviation < row[2] && deviation > row[3], "{f} {rate}");
        }
    }
}

/// The numbers of a row of a table.
fn numbers(row: &str) -> Option<Vec<f64>> {
    let cells = row.trim().strip_prefix('|')?.strip_suffix('|')?.split('|');
    cells.map(|cell| cell.trim().replace('−', "-").parse().ok()).collect()
}

/// Slow reference: the sections of the weighting as differential equations, integrated with 64 steps a
/// sample.
#[test]
fn a_shock_is_weighted_as_by_the_differential_equation() {
    let (rate, fine) = (6_400.0, 64);
    let shock =
        |t: f64| if t > 1.0 { 1e3 * (-(t - 1.0) / 4e-3).exp() * ((t - 1.0) / 4e-3).powi(3) } else { 0.0 };
    let n = 2 * 6_400;
    let values: Vec<f64> = (0..n).map(|i| shock(f64::from(i) / rate)).collect();
    let h = 1.0 / (rate * f64::from(fine));
    let mut signal: Vec<f64> = (0..n * fine).map(|i| shock(f64::from(i) * h)).collect();
    let [w1, w2] = BAND.map(|f| TAU * f);
    let w3 = TAU * TRANSITION;
    // Output b₀x + b₁x′ + b₂x″ of x″ + (w/Q)x′ + w²x = input.
    for (w, q, [b0, b1, b2]) in [
        (w1, BAND_Q, [0.0, 0.0, 1.0]),
        (w2, BAND_Q, [w2 * w2, 0.0, 0.0]),
        (w3, TRANSITION_Q, [w3 * w3, w3, 0.0]),
    ] {
        let oscillator = Oscillator::new(1.0, w / q, w * w);
        let (mut x, mut v) = (0.0, 0.0);
        for sample in &mut signal {
            // Half a step free, the push of a step, half a step free: second order in h.
            (x, v) = oscillator.free(x, v, 0.5 * h);
            v += *sample * h;
            (x, v) = oscillator.free(x, v, 0.5 * h);
            let second = *sample - w / q * v - w * w * x;
            *sample = b0 * x + b1 * v + b2 * second;
        }
    }
    let found = weighted(&values, rate).unwrap();
    let largest = found.iter().fold(0.0, |top: f64, v| top.max(v.abs()));
    for (i, v) in found.iter().enumerate() {
        let slow = signal[i * fine as usize];
        // The reference lags by half a step at each section, 1.5 h; the slope is below twice the largest
        // value over a millisecond.
        assert!((v - slow).abs() < 3.0 * h * 1e3 * largest, "{i}: {v} {slow} {largest}");
    }
}

#[test]
fn three_axes_and_half_a_day() {
    let rate = 6_000.0;
    let axis = |amplitude: f64| -> Vec<f64> {
        (0..60_000).map(|i| amplitude * (TAU * 100.0 * f64::from(i) / rate).sin()).collect()
    };
    let exposure = exposure(rate, &[&axis(30.0), &axis(40.0), &axis(0.0)], Some(2.0)).unwrap();
    let truth = 50.0 / 2f64.sqrt() * weighting(100.0).norm();
    // Two errors remain: the transient after half a second, e⁻¹⁴, and the faded mirror image after the end.
    assert!((exposure.a_hv.value / truth - 1.0).abs() < 1e-4, "{} {truth}", exposure.a_hv.value);
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

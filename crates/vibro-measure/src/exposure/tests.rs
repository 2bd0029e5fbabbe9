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
    let mut weighting = Weighting::new(rate).unwrap();
    // The slowest pole settles with e^(−π·6.31/0.71·t): after 2 s nothing of it is left; whole periods follow.
    let settle = (2.0 * rate) as usize;
    let n = ((20.0 * f).round().max(20.0) / f * rate).round() as usize;
    let mut values: Vec<f64> = (0..settle + n).map(|i| (TAU * f * i as f64 / rate).sin()).collect();
    weighting.apply(&mut values);
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
        // The bilinear transform bends frequencies by (πf/rate)²/3: 0.05 % at 1 kHz, three octaves of slope at most; a
        // period that is no whole number of samples adds 1/(2n).
        assert!((steady(102_400.0, f) / truth - 1.0).abs() < 2e-3, "{f}");
    }
    // At low rates it stays within the tolerance of the standard, 11 % between 10 Hz and 500 Hz.
    assert!((steady(8_000.0, 500.0) / weighting(500.0).norm() - 1.0).abs() < 0.05);
}

#[test]
fn three_axes_and_half_a_day() {
    let rate = 6_000.0;
    let axis = |amplitude: f64| {
        let mut handle = Handle::new(rate).unwrap();
        let values: Vec<f64> =
            (0..60_000).map(|i| amplitude * (TAU * 100.0 * f64::from(i) / rate).sin()).collect();
        values.chunks(777).for_each(|b| handle.push(b));
        handle
    };
    let handles = [axis(30.0), axis(40.0), axis(0.0)];
    let exposure = exposure(&handles, Some(2.0)).unwrap();
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
fn an_offset_and_missing_samples_change_nothing_that_vibrates() {
    let rate = 6_000.0;
    let wave: Vec<f64> = (0..60_000).map(|i| 30.0 * (TAU * 100.0 * f64::from(i) / rate).sin()).collect();
    let of = |values: &[f64]| {
        let mut handle = Handle::new(rate).unwrap();
        values.chunks(777).for_each(|b| handle.push(b));
        exposure(&[handle], None).unwrap()
    };
    let plain = of(&wave);
    let offset = of(&wave.iter().map(|v| v + 500.0).collect::<Vec<f64>>());
    // Roundings of 500 beside 30, and what is left of the offset's start, e⁻¹⁴ of what the first sample differs by: nothing.
    assert!((offset.a_hv.value / plain.a_hv.value - 1.0).abs() < 1e-9);
    assert!((offset.crest_factor / plain.crest_factor - 1.0).abs() < 1e-9);
    assert!((offset.unweighted_peak / plain.unweighted_peak - 1.0).abs() < 1e-9);
    // A sample that is lost at a zero crossing of the wave, and a record that begins late.
    let mut gap: Vec<f64> = wave.iter().map(|v| v + 500.0).collect();
    gap[..900].fill(f64::NAN);
    gap[9000] = f64::NAN;
    let gap = of(&gap);
    assert!((gap.unweighted_peak / plain.unweighted_peak - 1.0).abs() < 1e-3);
    assert!((gap.a_hv.value / plain.a_hv.value - 1.0).abs() < 1e-3, "{}", gap.a_hv.value);
    assert_eq!(missing(&gap), Some(901.0));
}

#[test]
fn what_is_missing_is_in_no_mean() {
    let rate = 6_000.0;
    let wave: Vec<f64> = (0..360_000).map(|i| 30.0 * (TAU * 100.0 * f64::from(i) / rate).sin()).collect();
    let of = |from: usize, to: usize| {
        let mut values = wave.clone();
        values[from..to].fill(f64::NAN);
        let mut handle = Handle::new(rate).unwrap();
        values.chunks(777).for_each(|b| handle.push(b));
        exposure(&[handle], None)
    };
    let whole = of(0, 0).unwrap();
    // 2.9 s of a minute, behind the half second at its beginning, then at its beginning and at its end. Some hundred periods are left:
    // a part of a period at each end of a stretch is 1/60 of a hundredth of a per cent.
    for (from, to) in [(60_000, 77_401), (0, 17_401), (342_599, 360_000)] {
        let gap = of(from, to).unwrap();
        assert!((gap.a_hv.value / whole.a_hv.value - 1.0).abs() < 1e-4, "{from}: {}", gap.a_hv.value);
        assert!((gap.crest_factor / whole.crest_factor - 1.0).abs() < 1e-4, "{from}: {}", gap.crest_factor);
        assert_eq!(missing(&gap), Some(17_401.0));
        assert!(gap.a_hv.n < whole.a_hv.n && gap.a_hv.n >= 55, "{:?}", gap.a_hv);
    }
    // Half of it is too much, wherever it is; so is a gap in every half second.
    for (from, to) in [(0, 180_000), (180_000, 360_000), (90_000, 270_000)] {
        let why = of(from, to).unwrap_err();
        assert!(why.exit_code() == 1 && why.to_string().contains("50.0 %"), "{why}");
    }
    let mut handle = Handle::new(rate).unwrap();
    let often: Vec<f64> =
        wave.iter().enumerate().map(|(i, v)| if i % 2500 == 0 { f64::NAN } else { *v }).collect();
    handle.push(&often);
    assert!(exposure(&[handle], None).unwrap_err().to_string().contains("settles"));
}

#[test]
fn gaps_of_two_axes_leave_the_seconds_of_both_in_step() {
    let rate = 6_000.0;
    // Both rise from second to second alike: their sum is twice one of them, and so is its scatter.
    let axis = |lost: usize| {
        let mut handle = Handle::new(rate).unwrap();
        let mut values: Vec<f64> = (0..120_000)
            .map(|i| (30.0 + f64::from(i / 6000)) * (TAU * 100.0 * f64::from(i) / rate).sin())
            .collect();
        values[lost..lost + 600].fill(f64::NAN);
        handle.push(&values);
        handle
    };
    let both = exposure(&[axis(30_000), axis(60_000)], None).unwrap();
    // Of 19 whole seconds a gap of 0.1 s and the half second behind it take one or two.
    assert!((15..=17).contains(&both.a_hv.n) && both.axes.iter().all(|a| a.n > both.a_hv.n), "{both:?}");
}

#[test]
fn what_cannot_be_exposed_is_refused() {
    assert!(Weighting::new(3000.0).is_err());
    let mut still = Handle::new(1e4).unwrap();
    assert!(exposure(std::slice::from_ref(&still), None).unwrap_err().to_string().contains("settles"));
    still.push(&vec![3.0; 10_000]);
    let error = exposure(std::slice::from_ref(&still), None).unwrap_err();
    assert!(error.exit_code() == 1 && error.to_string().contains("does not vibrate"), "{error}");
    assert_eq!(exposure(&[], None).unwrap_err().exit_code(), 2);
    assert_eq!(exposure(&[still], Some(30.0)).unwrap_err().exit_code(), 2);
}

#[test]
fn a_short_record_has_a_finding() {
    let rate = 6_000.0;
    let duration = |seconds: i32| {
        let mut handle = Handle::new(rate).unwrap();
        let values: Vec<f64> =
            (0..6_000 * seconds).map(|i| (TAU * 100.0 * f64::from(i) / rate).sin()).collect();
        handle.push(&values);
        let found = exposure(&[handle], None).unwrap().findings;
        found.iter().find(|f| f.code == "exposure-record-short")?.get("duration")
    };
    // Half a second settles the weighting.
    assert_eq!((duration(3), duration(9)), (Some(2.5), None));
}

/// Number of missing samples by the findings.
fn missing(exposure: &Exposure) -> Option<f64> {
    exposure.findings.iter().find(|f| f.code == "exposure-samples-missing")?.get("n")
}

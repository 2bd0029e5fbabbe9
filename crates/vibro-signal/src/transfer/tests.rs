use super::*;
use crate::filter::Filter;
use crate::segment::Segments;
use crate::welch::Welch;
use vibro_math::Noise;
use vibro_record::units::Quantity;
use vibro_record::{Trace, Traces, Window};

const RATE: f64 = 1000.0;

/// Uniform with variance 1.
fn draw(noise: &mut Noise) -> f64 {
    (noise.uniform() - 0.5) * 12f64.sqrt()
}

fn white(noise: &mut Noise, n: usize) -> Vec<f64> {
    (0..n).map(|_| draw(noise)).collect()
}

fn measured(columns: [(&str, Vec<f64>); 2], length: usize) -> Result<(Averages, Vec<Meta>)> {
    let traces = columns.map(|(unit, values)| Trace {
        meta: Meta::new(unit, Unit::parse_or_opaque(unit)),
        axis: Axis::time(0.0, 1.0 / RATE, values.len()),
        values,
    });
    let metas = traces.iter().map(|t| t.meta.clone()).collect();
    let welch = Welch { segments: Segments::new(length, 0.5)?, window: Window::Hann, detrend: true };
    let averages = welch.average(&mut Traces::from_memory(traces.to_vec())?, true, |_| ())?;
    Ok((averages, metas))
}

/// A system that lags: a low-pass, with a negative phase and a known response in closed form.
#[test]
fn a_lagging_system_has_its_magnitude_and_a_negative_phase() {
    let filter = Filter::low_pass(60.0, 2, RATE).unwrap();
    let force = white(&mut Noise::new(3), 60_000);
    let mut velocity = force.clone();
    filter.causal(&mut velocity, 0.0);
    let (averages, metas) = measured([("N", force), ("m/s", velocity)], 1024).unwrap();
    for estimator in [Estimator::H1, Estimator::H2, Estimator::Hv] {
        let found = transfer(&averages, 1, &metas, estimator).unwrap();
        assert_eq!((found.frf.meta.quantity, found.frf.meta.unit.symbol()), (Quantity::Mobility, "(m/s)/N"));
        assert_eq!((found.frf.axis.start(), found.frf.values.len()), (RATE / 1024.0, 512));
        for k in 10..200 {
            let truth = filter.response(found.frf.axis.at(k));
            // At the start of a segment the filter still responds to earlier force: for some 5 ms of 1 s,
            // where the window is small.
            assert!((found.frf.values[k] / truth - 1.0).norm() < 0.02, "{estimator:?} line {k}");
            assert!(found.frf.values[k].arg() < 0.0);
            assert!(found.coherence[k] > 0.999);
        }
    }
}

#[test]
fn noise_lowers_h1_or_raises_h2_and_hv_lies_between() {
    let mut noise = Noise::new(5);
    let x = white(&mut noise, 400_000);
    // Noise of half the power: added to the excitation, then to the response of a gain of 2.
    let clean: Vec<f64> = x.iter().map(|v| 2.0 * v).collect();
    let half = 0.5f64.sqrt();
    let noisy: Vec<f64> = x.iter().map(|v| v + half * draw(&mut noise)).collect();
    let mean = |columns, estimator| {
        let (averages, metas) = measured(columns, 256).unwrap();
        let found = transfer(&averages, 1, &metas, estimator).unwrap();
        let lines = &found.frf.values[4..120];
        lines.iter().map(|h| h.re).sum::<f64>() / lines.len() as f64
    };
    let excitation = |e| mean([("N", noisy.clone()), ("m", clean.clone())], e);
    // 3000 averages over 116 lines: the means scatter by 1e-3 at most.
    assert!((excitation(Estimator::H1) - 2.0 / 1.5).abs() < 0.01);
    assert!((excitation(Estimator::H2) - 2.0).abs() < 0.01);
    assert!((excitation(Estimator::Hv) - 2.0 / 1.5f64.sqrt()).abs() < 0.01);
    let response: Vec<f64> = clean.iter().map(|v| v + 2.0 * half * draw(&mut noise)).collect();
    let (h1, h2) = (Estimator::H1, Estimator::H2);
    assert!((mean([("N", x.clone()), ("m", response.clone())], h1) - 2.0).abs() < 0.01);
    assert!((mean([("N", x), ("m", response)], h2) - 3.0).abs() < 0.02);
}

#[test]
fn coherence_agrees_with_scipy() {
    let x: Vec<f64> = (0..700).map(|i| f64::from((i * i * 7 + 3 * i) % 101) / 50.0 + 0.25).collect();
    let y = (0..700).map(|i| f64::from((i * i * 5 + 11 * i) % 89) / 40.0 + 0.5 * x[i as usize]).collect();
    let (averages, metas) = measured([("N", x), ("m", y)], 64).unwrap();
    let found = transfer(&averages, 1, &metas, Estimator::H1).unwrap();
    let all = include_str!("../../../../fixtures/spectra/reference.csv");
    let line = all.lines().find_map(|line| line.strip_prefix("coherence,")).unwrap();
    let expected: Vec<f64> = line.split(',').skip(1).map(|c| c.parse().unwrap()).collect();
    assert_eq!(expected.len(), found.coherence.len());
    for (a, b) in found.coherence.iter().zip(expected) {
        assert!((a - b).abs() < 1e-12);
    }
    // Random error of Bendat & Piersol, with the independent averages less one.
    let (k, n) = (9, averages.effective - 1.0);
    let g = found.coherence[k];
    let error = (1.0 - g).sqrt() / (g.sqrt() * (2.0 * n).sqrt());
    assert!((found.magnitude_std[k] / found.frf.values[k].norm() / error - 1.0).abs() < 1e-12);
    assert!((found.phase_std[k].sin() / error - 1.0).abs() < 1e-12);
}

#[test]
fn one_average_has_no_coherence_and_an_empty_excitation_is_refused() {
    let x = white(&mut Noise::new(1), 100);
    let (averages, metas) = measured([("N", x.clone()), ("m", x.clone())], 100).unwrap();
    let one = transfer(&averages, 1, &metas, Estimator::H1).unwrap();
    assert!(one.coherence.is_empty() && one.phase_std.iter().all(|std| std.is_nan()));
    assert!(one.frf.values.iter().all(|h| (h - 1.0).norm() < 1e-12));
    assert!(measured([("N", vec![0.0; 400]), ("m", vec![1.0; 400])], 64).is_err());
    // Two segments that share half of their samples count as less than two.
    let (averages, metas) = measured([("N", x.clone()), ("m", x.clone())], 66).unwrap();
    assert_eq!(averages.count, 2);
    let error = transfer(&averages, 1, &metas, Estimator::H1).unwrap_err().to_string();
    assert!(error.contains("2 segments count as 1.9"), "{error}");
    let (averages, metas) = measured([("N", x.clone()), ("m", x)], 32).unwrap();
    assert!(transfer(&averages, 2, &metas, Estimator::H1).is_err());
    assert!(transfer(&averages, 0, &metas, Estimator::H1).is_err());
    let few = transfer(&averages, 1, &metas, Estimator::H1).unwrap();
    assert!(few.findings[0].code == "frf-few-averages", "{:?}", few.findings);
}

#[test]
fn equal_units_give_a_ratio() {
    let meta = |unit| Meta::new("a", Unit::parse_or_opaque(unit));
    assert_eq!(named(&meta("m"), &meta("m")).unit.symbol(), "1");
    assert_eq!(named(&meta("N"), &meta("m/s²")).quantity, Quantity::Accelerance);
    assert_eq!(named(&meta("N"), &meta("m")).quantity, Quantity::Receptance);
}

#[test]
fn mobility_becomes_receptance_only_when_asked() {
    let x = white(&mut Noise::new(9), 4000);
    let (averages, metas) = measured([("N", x.clone()), ("m/s", x)], 256).unwrap();
    let mobility = transfer(&averages, 1, &metas, Estimator::H1).unwrap();
    assert_eq!(mobility.frf.meta.quantity, Quantity::Mobility);
    let receptance = mobility.clone().integrated(1, 20.0).unwrap();
    assert_eq!(
        (receptance.frf.meta.quantity, receptance.frf.meta.unit.symbol()),
        (Quantity::Receptance, "m/N")
    );
    let (f, gone) = (receptance.frf.axis.at(0), mobility.coherence.len() - receptance.coherence.len());
    assert!(f >= 20.0 && mobility.frf.axis.at(gone - 1) < 20.0);
    let expected = mobility.frf.values[gone] / Complex64::new(0.0, TAU * f);
    assert!((receptance.frf.values[0] / expected - 1.0).norm() < 1e-14);
    assert_eq!(receptance.coherence[0], mobility.coherence[gone]);
}

/// A multisine: only its own lines are excited, and only these have a function.
#[test]
fn lines_without_excitation_have_no_function() {
    let sines = |scale: f64| -> Vec<f64> {
        let value = |i: usize| -> f64 {
            [10, 30, 47].iter().map(|k| (TAU * f64::from(*k) * i as f64 / 100.0).cos()).sum()
        };
        (0..1000).map(|i| scale * value(i)).collect()
    };
    let columns = [("N", sines(1.0)), ("m", sines(3.0))];
    let (mut averages, metas) = measured(columns, 100).unwrap();
    // Removes rounding from the lines that are not excited.
    for (k, x) in averages.auto[0].iter_mut().enumerate() {
        if ![9, 10, 11, 29, 30, 31, 46, 47, 48].contains(&k) {
            *x = 0.0;
        }
    }
    let found = transfer(&averages, 1, &metas, Estimator::H1).unwrap();
    for (i, (h, coherence)) in found.frf.values.iter().zip(&found.coherence).enumerate() {
        let k = i + 1;
        if [10, 30, 47].iter().any(|sine| k.abs_diff(*sine) <= 1) {
            assert!((h - 3.0).norm() < 1e-9, "line {k}: {h}");
        } else {
            assert!(h.re.is_nan() && h.im.is_nan() && coherence.is_nan(), "line {k}: {h} {coherence}");
            assert!(found.magnitude_std[i].is_nan() && found.phase_std[i].is_nan());
        }
    }
    assert!(
        found.findings.iter().any(|f| f.code == "frf-lines-empty" && f.get("n") == Some(41.0)),
        "{:?}",
        found.findings
    );
}

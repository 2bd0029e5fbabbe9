//! Faint responses: how often the truth lies below its upper limit.

use super::*;
use crate::measure::synthetic::{LINES, Normal, spectrum};
use crate::record::{Axis, Meta, Scaling, Spectrum, Values};
use crate::units::Unit;
use num_complex::Complex64;

/// A response to a given excitation.
fn step(name: &str, excitation: f64, window: Window, lines: Vec<f64>) -> SweepPoint {
    SweepPoint {
        force_path: None,
        response_path: name.into(),
        force: Vec::new(),
        given: Some(excitation),
        response: Spectrum {
            meta: Meta::new("response", Unit::parse_or_opaque("m/s")),
            axis: Axis::frequency(0.0, 1.0, LINES),
            values: Values::Real(lines),
            scaling: Scaling::Peak,
            window: Some(window),
            enbw: None,
        },
    }
}

fn sweep(points: Vec<SweepPoint>) -> Sweep {
    Sweep {
        name: "faint".into(),
        direction: None,
        mass: None,
        axis: Axis::frequency(0.0, 1.0, LINES),
        analyser_integrated: 0,
        points,
        doubts: Vec::new(),
    }
}

#[test]
fn upper_limits_cover_the_truth() {
    let mut normal = Normal(0xfa17);
    for window in [Window::Rectangular, Window::Hann, Window::FlatTop] {
        // Signal to noise from 0 to 14 dB: truth in units of the noise of a line.
        let truth: Vec<f64> = (0..500).map(|_| 10f64.powf(0.7 * normal.uniform())).collect();
        let points = truth
            .iter()
            .map(|a| {
                let sine = Complex64::from_polar(*a, std::f64::consts::TAU * normal.uniform());
                step("response", 80.3, window, spectrum(window, &[(80.3, sine)], 1.0, &mut normal))
            })
            .collect();
        let sweep = sweep(points);
        let found = response(&sweep, &ResponseOptions::default()).unwrap();
        let (mut limited, mut missed) = (0, 0);
        for (point, truth) in found.points.iter().zip(&truth) {
            let Some(limit) = point.upper_limit else { continue };
            limited += 1;
            assert!(limit > point.amplitude.value, "{window:?}: {limit} {:?}", point.amplitude);
            if limit < *truth {
                missed += 1;
            }
        }
        println!("{window:?}: {limited} limits, {missed} missed");
        assert!(limited > 250, "{window:?}: {limited}");
        // At most 5 % of 500, and twice the binomial standard deviation √(500·0.05·0.95) = 4.9: 93 %.
        assert!(missed <= 35, "{window:?}: {missed} of {limited}");
        let said = |w: &String| w.contains(&format!("{limited} amplitude(s) do not stand out"));
        assert!(found.warnings.iter().any(said), "{:?}", found.warnings);
    }
}

#[test]
fn harmonics_in_the_noise_have_a_limit_and_no_others() {
    let mut normal = Normal(0x0bde);
    let (n, window) = (400, Window::Hann);
    for (second, limits) in [(0.0, 0.99), (2.0, 0.7), (30.0, 0.0)] {
        let points = (0..n)
            .map(|_| {
                let phase = Complex64::cis(std::f64::consts::TAU * normal.uniform());
                let sines = [(40.3, Complex64::new(200.0, 0.0)), (80.6, second * phase)];
                step("response", 40.3, window, spectrum(window, &sines, 1.0, &mut normal))
            })
            .collect();
        let found = response(&sweep(points), &ResponseOptions::default()).unwrap();
        let orders: Vec<&Harmonic> = found.points.iter().map(|p| &p.harmonics[0]).collect();
        let limited: Vec<f64> = orders.iter().filter_map(|h| h.upper_limit).collect();
        let missed = limited.iter().filter(|l| **l < second).count();
        println!("{second}: {} limits, {missed} missed", limited.len());
        // Noise alone reaches five standard deviations once in 3e5 times.
        assert!(limited.len() as f64 >= limits * f64::from(n) && (limits > 0.0 || limited.is_empty()));
        // 5 % of 400, and twice the binomial standard deviation of 4.4.
        assert!(missed <= 28, "{second}: {missed}");
    }
}

#[test]
fn a_file_that_is_named_twice_is_told() {
    let point = |name: &str, height: f64| {
        let lines = (0..LINES).map(|k| if k == 80 { height } else { 0.01 * height }).collect();
        step(name, 80.0, Window::Hann, lines)
    };
    let told = |points: Vec<SweepPoint>| {
        let found = response(&sweep(points), &ResponseOptions::default()).unwrap();
        found.warnings.into_iter().find(|w| w.contains("may stand twice"))
    };
    assert_eq!(told(vec![point("a", 1.0), point("b", 2.0), point("c", 3.0)]), None);
    assert!(told(vec![point("a", 1.0), point("b", 2.0), point("a", 1.0)]).unwrap().contains("1 and 3"));
    // A copy under another name.
    assert!(told(vec![point("a", 1.0), point("b", 2.0), point("c", 2.0)]).unwrap().contains("2 and 3"));
}

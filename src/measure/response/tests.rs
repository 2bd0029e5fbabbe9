//! Faint responses: how often the truth lies below its upper limit.

use super::*;
use crate::measure::synthetic::{LINES, Normal, spectrum};
use crate::record::{Axis, Meta, Scaling, Spectrum, Values};
use crate::units::Unit;
use num_complex::Complex64;

#[test]
fn upper_limits_cover_the_truth() {
    let mut normal = Normal(0xfa17);
    for window in [Window::Rectangular, Window::Hann, Window::FlatTop] {
        // Signal to noise from 0 to 14 dB: truth in units of the noise of a line.
        let truth: Vec<f64> = (0..500).map(|_| 10f64.powf(0.7 * normal.uniform())).collect();
        let axis = Axis::frequency(0.0, 1.0, LINES);
        let points = truth
            .iter()
            .map(|a| {
                let sine = Complex64::from_polar(*a, std::f64::consts::TAU * normal.uniform());
                SweepPoint {
                    force_path: None,
                    response_path: "response".into(),
                    force: Vec::new(),
                    given: Some(80.3),
                    response: Spectrum {
                        meta: Meta::new("response", Unit::parse_or_opaque("m/s")),
                        axis: axis.clone(),
                        values: Values::Real(spectrum(window, &[(80.3, sine)], 1.0, &mut normal)),
                        scaling: Scaling::Peak,
                        window: Some(window),
                        enbw: None,
                    },
                }
            })
            .collect();
        let sweep = Sweep {
            name: "faint".into(),
            direction: None,
            mass: None,
            axis,
            analyser_integrated: 0,
            points,
            doubts: Vec::new(),
        };
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

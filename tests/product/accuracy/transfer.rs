//! Confidence band of a frequency response function.

use super::noise::Noise;
use vibroimpact::record::Traces;
use vibroimpact::record::{Axis, Meta, Trace, Window};
use vibroimpact::signal::segment::Segments;
use vibroimpact::signal::transfer::{Estimator, transfer};
use vibroimpact::signal::welch::Welch;
use vibroimpact::units::Unit;

const SEED: u64 = 0xf2f;
const LENGTH: usize = 64;
const GAIN: f64 = 2.0;

/// Coverage of the 95 % intervals of magnitude and of phase, and number of lines. Noise of `noise` times
/// the power of the signal is added where the estimator expects it: to the response (H1), the excitation
/// (H2) or both (Hv).
fn coverage(
    estimator: Estimator,
    (averages, overlap, noise): (usize, f64, f64),
    random: &mut Noise,
) -> (f64, f64, usize) {
    let (mut magnitude, mut phase, mut lines) = (0usize, 0usize, 0usize);
    for _ in 0..200 {
        let segments = Segments::new(LENGTH, overlap).unwrap();
        let n = LENGTH + (averages - 1) * segments.hop;
        let signal: Vec<f64> = (0..n).map(|_| random.normal()).collect();
        let mut with = |gain: f64, noisy: bool| -> Vec<f64> {
            let noise = if noisy { noise.sqrt() } else { 0.0 };
            signal.iter().map(|v| gain * (v + noise * random.normal())).collect()
        };
        let (force, response) =
            (with(1.0, estimator != Estimator::H1), with(GAIN, estimator != Estimator::H2));
        let traces = [("N", force), ("m", response)].map(|(unit, values)| Trace {
            meta: Meta::new(unit, Unit::parse(unit).unwrap()),
            axis: Axis::time(0.0, 1e-3, n),
            values,
        });
        let metas: Vec<Meta> = traces.iter().map(|t| t.meta.clone()).collect();
        let mut traces = Traces::from_memory(traces.to_vec()).unwrap();
        let welch = Welch { segments, window: Window::Hann, detrend: true };
        let found =
            transfer(&welch.average(&mut traces, true, |_| ()).unwrap(), 1, &metas, estimator).unwrap();
        // Neighbouring lines are correlated by the window, but each counts. The outermost lines are left
        // out, since they are partly real.
        for k in (3..LENGTH / 2 - 3).filter(|k| found.magnitude_std[*k].is_finite()) {
            let h = found.frf.values[k];
            magnitude += usize::from((h.norm() - GAIN).abs() < 1.96 * found.magnitude_std[k]);
            phase += usize::from(h.arg().abs() < 1.96 * found.phase_std[k]);
            lines += 1;
        }
    }
    (magnitude as f64 / lines as f64, phase as f64 / lines as f64, lines)
}

#[test]
fn the_band_holds_the_truth() {
    let mut random = Noise::new(SEED);
    println!("seed {SEED:#x}, 200 records a line");
    let many = [(20, 0.5, 0.1), (50, 0.5, 1.0), (100, 0.5, 0.01)];
    let h1 = [(10, 0.0, 0.1), (10, 0.0, 1.0), (20, 0.5, 0.5)].into_iter().chain(many);
    let cases = h1
        .map(|case| (Estimator::H1, case))
        .chain(many.map(|case| (Estimator::H2, case)))
        .chain(many.map(|case| (Estimator::Hv, case)));
    for (estimator, case) in cases {
        let (averages, overlap, noise) = case;
        let (magnitude, phase, lines) = coverage(estimator, case, &mut random);
        println!(
            "{estimator:?}, {averages} averages, overlap {overlap}, noise {noise}: magnitude {:.1} %, phase {:.1} % of {lines} lines",
            100.0 * magnitude,
            100.0 * phase
        );
        // Of 5200 lines two thirds are independent: a coverage of 95 % scatters by 0.4 %.
        assert!((0.92..=0.98).contains(&magnitude) && (0.92..=0.98).contains(&phase));
    }
}

//! Hand-arm exposure of handles with known vibration.

use super::draws::Draws;
use super::score::Score;
use crate::drill::noise::ShiftedNoise;
use vibroimpact::measure::exposure::{exposure, weighting};

const CASES: u64 = 240;
const RATE: f64 = 6_400.0;
/// Frequency of the vibration in Hz.
const TONE: f64 = 100.0;
/// Time between two knots of the amplitude in s.
const KNOT: f64 = 0.5;

/// Values m at the knots of a slowly varying amplitude 1 + m, which is linear between knots. They have the
/// standard deviation `scatter` and a correlation of `rho` from one knot to the next.
fn knots(count: usize, scatter: f64, rho: f64, noise: &mut ShiftedNoise) -> Vec<f64> {
    let mut m = scatter * noise.normal();
    (0..count)
        .map(|_| {
            m = rho * m + scatter * (1.0 - rho * rho).sqrt() * noise.normal();
            m
        })
        .collect()
}

fn uncertainties_of_an_exposure_are_true(draws: Draws) {
    let mut axis = [Score::default(), Score::default(), Score::default()];
    let (mut total, mut daily) = (Score::default(), Score::default());
    for seed in 1..=draws.of(CASES) {
        let mut noise = ShiftedNoise::new(seed);
        let seconds = 20.0 + 40.0 * noise.uniform();
        // `common` is 0 for independent axes and 1 for axes that vary together.
        let (common, rho) = (noise.uniform(), 0.5 * noise.uniform());
        let scatter = 0.1 + 0.1 * noise.uniform();
        let count = (seconds / KNOT) as usize + 2;
        let shared = knots(count, scatter, rho, &mut noise);
        // Mean square of 1 + m. At a share s of the way between two knots, m has the variance (1 − s)² + s²
        // + 2s(1 − s)ρ times scatter²; the average of the factor is 2/3 + ρ/3.
        let square = 1.0 + scatter * scatter * (2.0 + rho) / 3.0;
        let mut handles = Vec::new();
        let mut truths = Vec::new();
        for _ in 0..3 {
            let amplitude = 5.0 + 20.0 * noise.uniform();
            let own = knots(count, scatter, rho, &mut noise);
            let offset = 100.0 * noise.normal();
            let values: Vec<f64> = (0..(seconds * RATE) as usize)
                .map(|i| {
                    let at = i as f64 / RATE / KNOT;
                    let (k, s) = (at as usize, at.fract());
                    let part = |m: &[f64]| (1.0 - s) * m[k] + s * m[k + 1];
                    let m = common.sqrt() * part(&shared) + (1.0 - common).sqrt() * part(&own);
                    // A period has 64 samples, so the phase is exact.
                    let angle = std::f64::consts::TAU * (i % 64) as f64 / 64.0;
                    offset + amplitude * (1.0 + m) * angle.sin()
                })
                .collect();
            handles.push(values);
            // At 100 Hz the digital weighting differs from the formula by at most (π·100/6400)²/3 = 0.08 %,
            // a tenth of the smallest uncertainty here.
            truths.push(0.5 * amplitude * amplitude * square * weighting(TONE).norm_sqr());
        }
        let handles: Vec<&[f64]> = handles.iter().map(Vec::as_slice).collect();
        let found = exposure(RATE, &handles, Some(2.0)).unwrap();
        let truth = truths.iter().sum::<f64>().sqrt();
        for ((score, estimate), truth) in axis.iter_mut().zip(&found.axes).zip(&truths) {
            score.add(estimate, truth.sqrt(), 1.0);
        }
        total.add(&found.a_hv, truth, 1.0);
        daily.add(found.a8.as_ref().unwrap(), 0.5 * truth, 1.0);
    }
    println!("seeds 1 to {}", draws.of(CASES));
    axis.iter().zip(["axis 1", "axis 2", "axis 3"]).for_each(|(score, name)| score.covers(draws, name));
    total.covers(draws, "a_hv");
    daily.covers(draws, "A(8)");
}

/// 4 cases, run with every test.
mod few {
    use super::Draws;

    #[test]
    fn uncertainties_of_an_exposure_are_true() {
        super::uncertainties_of_an_exposure_are_true(Draws::Few);
    }
}

/// All cases, run with `--ignored`.
mod all {
    use super::Draws;

    #[test]
    #[ignore = "Monte Carlo: cargo test --release -- --ignored"]
    fn uncertainties_of_an_exposure_are_true() {
        super::uncertainties_of_an_exposure_are_true(Draws::All);
    }
}

use super::*;
use crate::math::Noise;

/// The rig of the example, and what is fitted to it.
fn example() -> (Rig, FitEntry) {
    let parameters =
        ["gap", "restitution", "k1", "k2"].map(|name| FitEntry::parameter(name).unwrap()).to_vec();
    let fit = FitEntry { parameters, calibration: Some(0.002), ..FitEntry::default() };
    (Rig { restitution: 0.9, ..Rig::thesis() }, fit)
}

/// Fewer cycles than by default, for quick tests.
const PACE: Pace = Pace { settle: 120, measure: 36 };
/// Noise of an amplitude in m.
const NOISE: f64 = 3e-6;
const FORCE: f64 = 0.1;

/// Frequencies in Hz from which points are chosen.
fn candidates(n: usize) -> Vec<(f64, f64)> {
    (0..n).map(|i| (4.5 + 8.0 * i as f64 / (n - 1) as f64, FORCE)).collect()
}

fn reached(rig: Rig, fit: &FitEntry, points: &[(f64, f64)]) -> ReachedPoints {
    ReachedPoints::of(&DesignTask { rig, force: FORCE, fit, pace: PACE }, &[points.to_vec()]).unwrap()
}

/// Measures the points `chosen` of a true rig: noise of each amplitude, and errors of the calibrations, which
/// all points share.
fn measured(truth: &ReachedPoints, chosen: &[usize], std: f64, noise: &mut Noise) -> Data {
    let mut data = truth.data.clone();
    data.steps = chosen.iter().map(|point| truth.data.steps[*point].clone()).collect();
    data.sequences = vec![(0..chosen.len()).collect()];
    let mut part = || data.calibration * noise.normal();
    let (factors, slopes, force) = ([part(), part()], [part(), part()], part());
    let (low, high) = super::super::range(data.steps.iter().map(|step| step.frequency));
    for (step, point) in data.steps.iter_mut().zip(chosen) {
        let Some(kind) = truth.kinds[*point] else { continue };
        let shows = truth.base.shows(kind, step.force * (1.0 + force), step.frequency);
        let along = if high > low { (2.0 * step.frequency - low - high) / (high - low) } else { 0.0 };
        for (mass, reading) in step.readings.iter_mut().enumerate() {
            let Some(reading) = reading else { continue };
            (reading.std, reading.amplitude) =
                (std, shows[mass] * (1.0 + factors[mass] + slopes[mass] * along) + std * noise.normal());
            reading.upper_limit = (reading.amplitude < CLEAR * std).then_some(CLEAR * std);
        }
    }
    data
}

/// The parameters that the least squares of `vibro compare` give for points of known motions: the best of
/// several starts around `from`.
fn fitted(data: &Data, kinds: Vec<Option<MotionKind>>, from: &Setting, unknowns: &[Unknown]) -> Setting {
    let mut problem = Problem::new(data, from, unknowns.to_vec()).of(kinds);
    let u = problem.coordinates(from);
    problem.weigh(&u);
    let mut noise = Noise::new(77);
    let mut moved = |i: i32, u: &f64| u * if i == 0 { 1.0 } else { 1.0 + 0.02 * noise.normal() };
    let starts: Vec<Vec<f64>> = (0..8).map(|i| u.iter().map(|u| moved(i, u)).collect()).collect();
    let minima = starts.iter().filter_map(|start| problem.solve(start).ok());
    let sum = |residuals: &[f64]| residuals.iter().map(|r| r * r).sum::<f64>();
    let best = minima.min_by(|a, b| sum(&a.residuals).total_cmp(&sum(&b.residuals))).unwrap();
    problem.setting(&best.parameters)
}

/// Root mean square errors of fits to drawn points, over the predicted uncertainties.
fn ratios(draws: u64) -> Vec<f64> {
    let (rig, fit) = example();
    let points = candidates(24);
    let truth = reached(rig, &fit, &points);
    let chosen: Vec<usize> = (0..points.len()).collect();
    let covariance = truth.information(&|_| NOISE).covariance(&chosen, false).unwrap();
    let mut squares = vec![0.0; truth.unknowns.len()];
    for seed in 0..draws {
        let mut noise = Noise::new(300 + seed);
        for _ in 0..16 {
            noise.normal();
        }
        let data = measured(&truth, &chosen, NOISE, &mut noise);
        let found = fitted(&data, truth.kinds.clone(), &truth.base, &truth.unknowns);
        for (sum, unknown) in squares.iter_mut().zip(&truth.unknowns) {
            *sum += (found.get(unknown.parameter) / truth.base.get(unknown.parameter)).ln().powi(2);
        }
    }
    let ratio = |(i, sum): (usize, &f64)| (sum / draws as f64 / covariance[(i, i)]).sqrt();
    let ratios: Vec<f64> = squares.iter().enumerate().map(ratio).collect();
    println!("rig, {:?}: {ratios:.3?} of {draws} sweeps", fit.parameters);
    ratios
}

/// The root mean square of 200 errors is known to 5 %.
#[test]
#[ignore = "Monte Carlo: cargo test --release -- --ignored"]
fn parameters_of_a_rig_scatter_as_predicted() {
    assert!(ratios(200).iter().all(|ratio| (ratio - 1.0).abs() < 0.2));
}

/// The root mean square of 8 errors exceeds 2.2 times its expectation in one of 10⁹ cases (χ² of 8).
#[test]
fn parameters_of_a_few_sweeps_scatter_as_predicted() {
    assert!(ratios(8).iter().all(|ratio| *ratio < 2.2));
}

/// Numbers of points until all parameters are known to 0.4 %: suggested points of a test that is planned anew
/// after each, and points of the even grid from which on no finer one is worse. The true rig differs from the
/// guess by 3 % in each parameter.
fn points_needed(seed: u64) -> (usize, usize) {
    let (noise, target, aim) = (1e-5, 0.004, &Aim::Parameters);
    let (guess, mut fit) = example();
    let mut normal = Noise::new(seed);
    for _ in 0..16 {
        normal.normal();
    }
    let mut part = || 1.0 + 0.03 * normal.normal();
    let (gap, k1, k2) = (guess.gap * part(), guess.k1 * part(), guess.k2 * part());
    let restitution = (0.9 * part()).min(0.97);
    // What is known of the rig before the test.
    for parameter in &fit.parameters {
        let value = Setting { rig: guess, force: FORCE }.get(*parameter);
        fit.prior.insert(*parameter, [value, 0.03 * value]);
    }
    let places = candidates(81);
    let truth = reached(Rig { gap, k1, k2, restitution, ..guess }, &fit, &places);
    let (mut now, mut chosen): (ReachedPoints, Vec<usize>) = (reached(guess, &fit, &places), Vec::new());
    let known = |now: &ReachedPoints, chosen: &[usize]| {
        now.information(&|_| noise).uncertainty(chosen, aim).is_some_and(|uncertainty| uncertainty <= target)
    };
    while !known(&now, &chosen) && chosen.len() < 60 {
        chosen.extend(now.information(&|_| noise).next(&chosen, &now.candidates(), 1, aim));
        if chosen.len() >= 3 {
            let data = measured(&truth, &chosen, noise, &mut Noise::new(1000 + seed));
            let kinds = chosen.iter().map(|point| truth.kinds[*point]).collect();
            let found = fitted(&data, kinds, &now.base, &now.unknowns);
            now = reached(found.rig, &fit, &places);
        }
    }
    let value = |setting: &Setting, unknown: &Unknown| setting.get(unknown.parameter).ln();
    let errors =
        now.unknowns.iter().map(|unknown| (value(&now.base, unknown) - value(&truth.base, unknown)).abs());
    let error = errors.fold(0.0, f64::max);
    let enough = |n: &usize| {
        let grid = reached(truth.base.rig, &fit, &candidates(*n));
        known(&grid, &(0..*n).collect::<Vec<_>>())
    };
    let coarse = (2..60).rev().find(|n| !enough(n)).unwrap_or(1);
    let first = (2..60).find(enough);
    let n = chosen.len();
    println!(
        "rig {seed}: {n} suggested points, {first:?} to {} of an even grid, error {error:.4}",
        coarse + 1
    );
    // Four parameters, each known to the target or better: none errs by five of it.
    assert!(error < 5.0 * target, "{seed}: {error}");
    (n, coarse + 1)
}

/// Setting and criterion were chosen on the first five rigs; the others are fresh. Their median is 8 points
/// against 19; the worst rig takes 10 against 19.
#[test]
#[ignore = "Monte Carlo: cargo test --release -- --ignored"]
fn suggested_points_are_half_of_an_even_grid() {
    let needed: Vec<(usize, usize)> = (0..20).map(points_needed).collect();
    let more = needed.iter().filter(|(suggested, even)| 2 * suggested > *even).count();
    assert!(more <= 1, "{needed:?}");
    assert!(needed.iter().all(|(suggested, even)| 20 * suggested <= 11 * even), "{needed:?}");
}

/// Two parameters that only their product shows: the prediction is certain, the parameters are not; and the
/// best next point is the one that tells them apart.
#[test]
fn the_next_point_tells_apart() {
    let row = |a: f64, b: f64| vec![DVector::from_vec(vec![a, b])];
    let information = PointInformation {
        points: vec![row(10.0, 10.0), row(10.0, 10.0), row(5.0, -5.0)],
        priors: vec![0.0, 0.0],
        columns: 2,
        parameters: vec![Parameter::K1, Parameter::K2],
    };
    assert!(information.covariance(&[0, 1], false).is_none());
    assert_eq!(information.next(&[0], &[0, 1, 2], 1, &Aim::Parameters), [2]);
    let sum = Aim::Prediction(DVector::from_vec(vec![1.0, 1.0]));
    assert_eq!(information.next(&[0], &[1, 2], 1, &sum), [1]);
    // a + b = 0 ± 0.1 and a − b = 0 ± 0.2: each 0.5·√(0.01 + 0.04).
    let std = information.uncertainty(&[0, 2], &Aim::Parameters).unwrap();
    assert!((std - 0.5 * 0.05f64.sqrt()).abs() < 1e-12, "{std}");
}

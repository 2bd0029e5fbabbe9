use super::*;
use crate::scene::Springs;

/// The thesis' mass 1 (k 135 N/m) on a spring of this cubic coefficient in N/m³, with damping in N s/m.
fn mass(cubic: f64, damping: f64) -> Duffing {
    let mut scene = Scene { springs: Some(Springs { cubic1: cubic, cubic2: 0.0 }), ..Scene::thesis() };
    scene.rig.c1 = damping;
    Duffing::new(&scene, 1).unwrap()
}

#[test]
fn the_exact_free_period_is_that_of_its_integral() {
    // T = 4∫dx/v over a quarter; with x = A sin θ and v from the energy, T = 4∫₀^{π/2} dθ √(m/(k +
    // ½k₃A²(1 + sin²θ))). The trapezoidal rule of this smooth periodic function converges exponentially.
    for (cubic, amplitude) in [(1e7, 1e-3), (1e7, 0.1), (-1e7, 2.1e-3), (-1e7, 1e-6)] {
        let duffing = mass(cubic, 0.1);
        let added = cubic * amplitude * amplitude;
        let n = 64;
        let rate = |i: usize| {
            let sin = (TAU * i as f64 / n as f64).sin();
            (0.125 / (135.0 + 0.5 * added * (1.0 + sin * sin))).sqrt()
        };
        let period = TAU * (0..n).map(rate).sum::<f64>() / n as f64;
        let [balance, exact] = duffing.free(amplitude);
        assert!((exact * period - 1.0).abs() < 1e-14, "{cubic} {amplitude}: {exact} {period}");
        // To first order harmonic balance shifts the frequency by 3k₃A²/8k; it is too high by the stated
        // bounds.
        let small = added.abs() / 135.0;
        let shift = balance / duffing.natural_frequency() - 1.0;
        assert!((shift - 3.0 * added / (8.0 * 135.0)).abs() < 0.1 * small * small, "{shift}");
        let error = balance / exact - 1.0;
        assert!((-1e-15..if cubic > 0.0 { 0.0223 } else { 0.0024 }).contains(&error), "{error}");
    }
}

#[test]
fn every_motion_solves_the_balance_and_has_its_stability() {
    // Random masses, forces and frequencies: the sign changes of the cubic over A², on a grid from 1 µm
    // to 98 m, are all its roots.
    let mut noise = vibro_math::Noise::new(20_261_129);
    let mut three = 0;
    for _ in 0..100 {
        let cubic = 1e7 * (noise.uniform() - 0.5);
        let (duffing, force) = (mass(cubic, 0.4 * noise.uniform()), 0.3 * noise.uniform());
        let sine = Sine { force, frequency: 3.0 + 5.0 * noise.uniform() };
        let omega = sine.omega();
        let work = |a: f64| {
            let e = 135.0 + 0.75 * cubic * a * a - 0.125 * omega * omega;
            (e * e + (duffing.body.damping * omega).powi(2)) * a * a - force * force
        };
        let found = duffing.balanced(&sine);
        for (x, stable) in &found {
            let a = x.norm();
            assert!(work(a * (1.0 - 1e-9)) * work(a * (1.0 + 1e-9)) < 0.0, "{a}");
            assert_eq!(*stable, work(a * (1.0 + 1e-9)) > 0.0);
        }
        let grid: Vec<f64> = (0..46_000).map(|i| work(1e-6 * (4e-4 * f64::from(i)).exp())).collect();
        let roots = grid.windows(2).filter(|pair| pair[0] < 0.0 && pair[1] >= 0.0).count();
        let falls = grid.windows(2).filter(|pair| pair[0] >= 0.0 && pair[1] < 0.0).count();
        assert_eq!(found.len(), roots + falls);
        three += usize::from(found.len() == 3);
    }
    assert!(three > 6, "{three}");
}

#[test]
fn shooting_is_right_where_the_motion_is_known() {
    // Nearly without curvature the motion is the linear one, and the multipliers have the modulus
    // e^{−cT/2m}.
    let (linear, sine) = (mass(1e-3, 0.1), Sine { force: 0.3, frequency: 4.0 });
    let known = linear.body.receptance(sine.omega()).norm() * 0.3;
    let found = linear.shoot(&sine, linear.balanced(&sine)[0].0).unwrap();
    assert!((found.amplitude / known - 1.0).abs() < 1e-9, "{found:?} {known}");
    assert!((found.spectral_radius / (-0.1_f64 / (2.0 * 0.125 * 4.0)).exp() - 1.0).abs() < 1e-9);
    // A tiny force keeps the free motion without damper at its exact frequency; F₀/A of the spring's
    // force shifts the amplitude by a like part.
    for cubic in [1e7, -4e6] {
        let free = mass(cubic, 0.0);
        let [_, exact] = free.free(2e-3);
        let tiny = Sine { force: 1e-6, frequency: exact };
        let found = free.shoot(&tiny, Complex64::from(2e-3)).unwrap();
        assert!((found.amplitude / 2e-3 - 1.0).abs() < 1e-4, "{found:?}");
        assert!((found.spectral_radius - 1.0).abs() < 1e-2);
    }
}

#[test]
fn both_criteria_of_stability_agree_and_the_jumps_lie_between() {
    for cubic in [2e7, -1e7] {
        let found = mass(cubic, 0.1).response(5e-3, 4.0, 7.0, 120).unwrap();
        let compared = found.points.iter().filter(|p| p.error().is_some_and(|e| e.abs() < 0.02));
        let agree = compared.clone().filter(|p| p.stable == (p.exact.unwrap().spectral_radius < 1.0)).count();
        // At a jump both are on their border.
        assert!(compared.clone().count() >= agree && compared.count() <= agree + 2, "{agree}");
        assert!(agree > 120, "{agree}");
        let [a, b] = found.jumps[..] else { panic!("{:?}", found.jumps) };
        // A hardening spring jumps down with rising frequency, beyond the frequency of the other jump.
        let (up, down) = if cubic > 0.0 { (b, a) } else { (a, b) };
        assert!(up.rising == (cubic > 0.0) && down.rising != up.rising, "{found:?}");
        assert!(up.amplitude[0] > up.amplitude[1] && down.amplitude[0] < down.amplitude[1]);
    }
}

#[test]
fn the_domain_is_kept() {
    let soft = mass(-1e7, 0.1);
    // √(k/3|k₃|) = √(135/3e7).
    assert!((soft.limit() - 2.121_320_343_559_643e-3).abs() < 1e-17);
    let found = soft.response(0.1, 3.0, 8.0, 50).unwrap();
    assert!(found.beyond > 0 && found.points.iter().all(|p| p.amplitude <= soft.limit()));
    let text = soft.response(50.0, 3.0, 3.5, 5).unwrap_err().to_string();
    assert!(text.contains("largest force"), "{text}");
    assert!(Duffing::new(&Scene::thesis(), 2).unwrap_err().to_string().contains("spring 2 is straight"));
}

//! Resonances, jumps and crossings of curves whose answer is known.

use super::*;
use crate::crossing::crossings;
use crate::jump::jump;
use num_complex::Complex64;

fn points(f: &[f64], a: &[f64], std: &[f64]) -> Vec<Point> {
    f.iter().zip(a).zip(std).map(|((f, a), std)| (*f, *a, *std)).collect()
}

fn jumps(f: &[f64], a: &[f64], std: &[f64], direction: Direction) -> Vec<Jump> {
    crate::jump::jumps(&points(f, a, std), &[], direction)
}

fn resonances(f: &[f64], a: &[f64], std: &[f64], jumps: &[Jump], mass: Option<u8>) -> Vec<Resonance> {
    super::resonances(&points(f, a, std), jumps, mass)
}

#[test]
fn a_mass_that_moves_alone_does_not_clap() {
    let resonance = |f, a, kind: ResonanceKind| Resonance {
        frequency: f,
        frequency_std: None,
        amplitude: a,
        amplitude_std: None,
        kind,
        at_jump: false,
    };
    let first = vec![
        resonance(5.5, 10.0, ResonanceKind::Resonance),
        resonance(7.5, 0.1, ResonanceKind::Antiresonance),
        resonance(10.6, 2.0, ResonanceKind::Resonance),
    ];
    let second = vec![resonance(5.5, 9.0, ResonanceKind::Resonance)];
    let curve = |above| vec![(4.0, 1.0, 0.0), (5.5, 9.0, 0.0), (9.0, above, 0.0), (13.0, above, 0.0)];
    for (above, expected) in [(1e-6, ResonanceKind::Resonance), (1.0, ResonanceKind::Clapping)] {
        let of = |mass, curve, resonances: &Vec<Resonance>| NamedCurve {
            mass: Some(mass),
            direction: Direction::Up,
            curve,
            jumps: Vec::new(),
            resonances: resonances.clone(),
        };
        let mut both = [of(1, curve(1.0), &first), of(2, curve(above), &second)];
        name_modes(&mut both);
        let [first, second] = both.map(|c| c.resonances);
        assert_eq!((first[0].kind, first[2].kind), (ResonanceKind::Grazing, expected));
        assert_eq!(second[0].kind, ResonanceKind::Grazing);
    }
}

#[test]
fn curves_cross_where_their_logarithms_do() {
    // e^f against e^(10−f): they cross at 5.
    let up = curve(0.0, f64::exp);
    let down = curve(0.3, |f| (10.0 - f).exp());
    let found = crossings(up, down, &[]);
    assert_eq!(found.len(), 1);
    assert!((found[0].frequency - 5.0).abs() < 1e-12 && !found[0].second_above, "{found:?}");
}

/// Eleven points 1 Hz apart, with an uncertainty of 1 %.
fn curve(start: f64, height: impl Fn(f64) -> f64) -> Vec<(f64, f64, f64)> {
    (0..11).map(|i| start + f64::from(i)).map(|f| (f, height(f), 0.01 * height(f))).collect()
}

#[test]
fn the_uncertainty_of_a_crossing_is_how_the_amplitudes_move_it() {
    // Each amplitude is moved on its own by its uncertainty of 1 %; over this the logarithm is linear to 1
    // %.
    for offset in [0.0, 0.3, 0.7] {
        let curves = [curve(0.05, f64::exp), curve(offset, |f| (9.8 - 0.3 * f).exp())];
        let found = crossings(curves[0].clone(), curves[1].clone(), &[]);
        let mut variance = 0.0;
        for which in [0, 1] {
            for i in 0..11 {
                let mut moved = curves.clone();
                moved[which][i].1 += moved[which][i].2;
                let [first, second] = moved;
                variance += (crossings(first, second, &[])[0].frequency - found[0].frequency).powi(2);
            }
        }
        let std = found[0].frequency_std.unwrap();
        assert!((std / variance.sqrt() - 1.0).abs() < 0.02, "{offset}: {std} {}", variance.sqrt());
    }
    let unknown: Vec<_> = curve(0.0, f64::exp).iter().map(|p| (p.0, p.1, f64::NAN)).collect();
    let found = crossings(unknown, curve(0.3, |f| (10.0 - f).exp()), &[]);
    assert_eq!(found[0].frequency_std, None);
}

#[test]
fn a_crossing_at_a_jump_is_as_uncertain_as_the_jump() {
    let f: Vec<f64> = (0..11).map(f64::from).collect();
    let a: Vec<f64> = f.iter().map(|f| if *f < 5.5 { 1.0 } else { 9.0 }).collect();
    let jumps = jumps(&f, &a, &[0.01; 11], Direction::Up);
    let jumping = f.iter().zip(&a).map(|(f, a)| (*f, *a, 0.01)).collect();
    let found = crossings(jumping, curve(0.0, |_| 2.0), &jumps);
    // Between 5 and 6 Hz, as the jump.
    assert_eq!((found[0].frequency, found[0].frequency_std), (5.5, Some(1.0 / f64::sqrt(12.0))));
    assert_eq!((jumps[0].frequency, Some(jumps[0].frequency_std)), (5.5, found[0].frequency_std));
    assert_eq!((jumps[0].amplitude_before_std, jumps[0].amplitude_after_std), (Some(0.01), Some(0.01)));
}

#[test]
fn a_crossing_beside_a_jump_keeps_its_place_however_the_frequencies_of_the_masses_differ() {
    // Steps of 0.5 Hz. The second curve jumps after the point at 6.515 Hz + offset; the first has no jump.
    let grid = |offset: f64| (0..8).map(move |i| 4.515 + 0.5 * f64::from(i) + offset);
    for offset in [0.0, 1e-9, -1e-9, 0.25, 0.25 + 1e-9, 0.25 - 1e-9, -0.25, -0.1] {
        // They cross at 6.05 on straight lines in the logarithm; after the jump the second lies above, or
        // below.
        for (behind, expected) in [(2.0, vec![6.05]), (-2.0, vec![6.05, 6.765 + offset])] {
            let first: Vec<_> = grid(0.0).map(|f| (f, (6.05 - f).exp(), 1e-3)).collect();
            let height = |f: f64| f - 6.05 + if f > 6.6 + offset { 2.0 * behind } else { 0.0 };
            let second: Vec<_> = grid(offset).map(|f| (f, height(f).exp(), 1e-3)).collect();
            let jump = jump([second[4], second[5]], Direction::Up);
            let found = crossings(first, second, &[jump]);
            let frequencies: Vec<f64> = found.iter().map(|c| c.frequency).collect();
            // After a fall by four the curves meet again at 8.05, where both reach that far.
            let frequencies: Vec<f64> = frequencies.into_iter().filter(|f| *f < 7.6).collect();
            assert_eq!(frequencies.len(), expected.len(), "{offset} {behind}: {found:?}");
            for (found, expected) in frequencies.iter().zip(&expected) {
                // Rounding over a nanohertz: 1e-16/1e-9 of it at worst.
                assert!((found - expected).abs() < 1e-9, "{offset} {behind}: {frequencies:?}");
            }
            if let Some(at_jump) = found.get(1).filter(|c| c.frequency < 7.6) {
                let std = 0.5 / f64::sqrt(12.0);
                assert!((at_jump.frequency_std.unwrap() - std).abs() < 1e-12, "{offset}: {at_jump:?}");
            }
            assert!(found[0].frequency_std.unwrap() < 0.01, "{offset}: {found:?}");
        }
    }
}

#[test]
fn a_hardening_peak_ends_in_a_drop() {
    let f: Vec<f64> = (0..12).map(|i| 8.0 + 0.3 * f64::from(i)).collect();
    let a: Vec<f64> = f.iter().map(|f| if *f < 10.6 { 1.0 + (f - 8.0) } else { 0.8 }).collect();
    let jumps = jumps(&f, &a, &[0.01; 12], Direction::Up);
    assert_eq!(jumps.len(), 1);
    assert_eq!((jumps[0].change, jumps[0].from), ("drop", f[8]));
    let peaks = resonances(&f, &a, &[0.01; 12], &jumps, None);
    assert_eq!(peaks.len(), 1);
    assert!(peaks[0].at_jump && peaks[0].frequency == f[8]);
}

#[test]
fn a_coarse_sweep_of_a_linear_resonance_has_no_jump() {
    for q in [5.0, 20.0, 50.0, 150.0] {
        for n in [10, 20, 40, 100] {
            for offset in 0..25 {
                let f: Vec<f64> = (0..n)
                    .map(|i| 4.0 + 4.0 * (f64::from(i) + f64::from(offset) / 25.0) / f64::from(n))
                    .collect();
                let a: Vec<f64> =
                    f.iter().map(|f| 1.0 / (1.0 - (f / 5.6f64).powi(2)).hypot(f / 5.6 / q)).collect();
                let std = vec![1e-6; f.len()];
                // With a second mode at 6.5 Hz, and with a zero between them or without, the phase shows no
                // jump either.
                for second in [0.0, 0.3, -0.3] {
                    let motion: Vec<Complex64> = f
                        .iter()
                        .map(|f| oscillator(*f, 5.6, 0.5 / q) + second * oscillator(*f, 6.5, 0.5 / q))
                        .collect();
                    let a: Vec<f64> = motion.iter().map(|h| h.norm()).collect();
                    let turned = crate::jump::jumps(&points(&f, &a, &std), &motion, Direction::Up);
                    let alone = jumps(&f, &a, &std, Direction::Up);
                    assert_eq!(
                        turned.len(),
                        alone.len(),
                        "Q {q}, {n} points, {offset}, {second}: {turned:?}"
                    );
                }
                let found = jumps(&f, &a, &std, Direction::Up);
                assert!(found.is_empty(), "Q {q}, {n} points, {offset}: {found:?}");
            }
        }
    }
}

/// Receptance of an oscillator of stiffness 1.
fn oscillator(f: f64, natural: f64, zeta: f64) -> Complex64 {
    let r = f / natural;
    Complex64::new(1.0 - r * r, 2.0 * zeta * r).inv()
}

/// A mass that strikes a stop moves as if on a stiffer spring. Near its resonance without the stop it no
/// longer reaches the stop. There the amplitude is at most halved, and the curve falls steeply afterwards
/// anyway, but the phase reverses.
#[test]
fn a_motion_that_turns_round_within_a_step_has_jumped() {
    let f: Vec<f64> = (16..27).map(f64::from).collect();
    let motion: Vec<Complex64> =
        f.iter().map(|f| oscillator(*f, if *f < 23.5 { 26.0 } else { 22.0 }, 0.03)).collect();
    let a: Vec<f64> = motion.iter().map(|h| h.norm()).collect();
    let curve = points(&f, &a, &[1e-4; 11]);
    assert!(crate::jump::jumps(&curve, &[], Direction::Up).is_empty());
    let found = NamedCurve::new(curve, &motion, Direction::Up, None);
    assert_eq!(found.jumps.iter().map(|j| (j.from, j.to)).collect::<Vec<_>>(), [(23.0, 24.0)]);
    assert!(found.resonances.iter().all(|r| r.at_jump), "{:?}", found.resonances);
    // A sweep that ends right after the jump.
    let found = NamedCurve::new(points(&f[..9], &a[..9], &[1e-4; 9]), &motion[..9], Direction::Up, None);
    assert_eq!(found.jumps.iter().map(|j| (j.from, j.to)).collect::<Vec<_>>(), [(23.0, 24.0)]);
}

#[test]
fn a_smooth_resonance_is_no_jump() {
    let f: Vec<f64> = (0..40).map(|i| 4.0 + 0.1 * f64::from(i)).collect();
    let a: Vec<f64> = f.iter().map(|f| 1.0 / (1.0 - (f / 5.6f64).powi(2)).hypot(0.04 * f / 5.6)).collect();
    assert!(jumps(&f, &a, &[1e-3; 40], Direction::Up).is_empty());
    let peaks = resonances(&f, &a, &[1e-3; 40], &[], None);
    assert_eq!(peaks.len(), 1);
    assert!((peaks[0].frequency - 5.6).abs() < 0.02, "{peaks:?}");
}

#[test]
fn noise_has_no_resonances_and_no_jumps() {
    // Alternating values whose differences are three standard deviations.
    let f: Vec<f64> = (0..20).map(f64::from).collect();
    let a: Vec<f64> = (0..20).map(|i| if i % 2 == 0 { 4.0 } else { 1.0 }).collect();
    assert!(resonances(&f, &a, &[1.0; 20], &[], None).is_empty());
    assert!(jumps(&f, &a, &[1.0; 20], Direction::Up).is_empty());
    assert!(!resonances(&f, &a, &[0.1; 20], &[], None).is_empty());
}

/// Receptance of two modes at 5 and 9 Hz with 1 % damping; the second counts `weight` times.
fn two_modes(f: f64, weight: f64) -> f64 {
    let mode = |f0: f64| Complex64::new(f0 * f0 - f * f, 0.02 * f0 * f).inv();
    (mode(5.0) + weight * mode(9.0)).norm()
}

#[test]
fn a_zero_is_an_antiresonance_and_a_sum_of_tails_a_minimum() {
    let f: Vec<f64> = (0..57).map(|i| 4.0 + 0.1 * f64::from(i)).collect();
    for (size, mass, expected) in [
        // Modal constants of the same sign: a zero lies between the modes, for either mass.
        (1.0, None, ResonanceKind::Antiresonance),
        (0.2, Some(2), ResonanceKind::Antiresonance),
        (1.0, Some(1), ResonanceKind::Antiresonance),
        // Opposite signs: no zero between the modes.
        (-0.2, None, ResonanceKind::Minimum),
        (-1.0, Some(2), ResonanceKind::Minimum),
        (-5.0, Some(2), ResonanceKind::Minimum),
    ] {
        let a: Vec<f64> = f.iter().map(|f| two_modes(*f, size)).collect();
        let std: Vec<f64> = a.iter().map(|a| 1e-4 * a).collect();
        let found = resonances(&f, &a, &std, &[], mass);
        let kinds: Vec<ResonanceKind> = found.iter().map(|r| r.kind).collect();
        assert_eq!(kinds, [ResonanceKind::Resonance, expected, ResonanceKind::Resonance], "{size} {mass:?}");
    }
}

#[test]
fn a_minimum_in_the_noise_lies_between_what_stands_out() {
    let f: Vec<f64> = (0..11).map(f64::from).collect();
    let a = [4.0, 9.0, 6.0, 3.0, 0.1, 0.02, 0.07, 2.0, 5.0, 8.0, 3.0];
    let std = [0.1; 11];
    let found = resonances(&f, &a, &std, &[], Some(1));
    let minimum = found.iter().find(|r| r.kind == ResonanceKind::Antiresonance).unwrap();
    // The minimum is point 5; points 3 and 7 differ from it by more than noise.
    assert_eq!((minimum.frequency, minimum.frequency_std), (5.0, Some(2.0 / f64::sqrt(3.0))));
    assert_eq!((minimum.amplitude, minimum.amplitude_std), (0.02, Some(0.1)));
    // Faint points up to the edge of the curve, or after a jump, are no minima.
    assert!(
        resonances(&f[..7], &a[..7], &std[..7], &[], Some(1))
            .iter()
            .all(|r| r.kind == ResonanceKind::Resonance)
    );
    let jump = jump([(3.0, 3.0, 0.1), (4.0, 0.1, 0.1)], Direction::Up);
    assert!(resonances(&f, &a, &std, &[jump], Some(1)).iter().all(|r| r.kind == ResonanceKind::Resonance));
}

/// Downward sweep: mass 2 begins to move at 5.5 Hz. There the amplitude of mass 1 falls by less than a jump
/// needs on its own, or does not change.
#[test]
fn where_one_mass_jumps_the_other_does_if_its_slopes_do_not_tell() {
    let f: Vec<f64> = (0..11).map(f64::from).collect();
    let second: Vec<_> = f.iter().map(|f| (*f, if *f < 5.5 { 9.0 } else { 1e-3 }, 1e-3)).collect();
    let down = |c: &[(f64, f64, f64)]| {
        let of = |g: fn(&(f64, f64, f64)) -> f64| c.iter().rev().map(g).collect::<Vec<f64>>();
        jumps(&of(|p| p.0), &of(|p| p.1), &of(|p| p.2), Direction::Down)
    };
    for (fall, expected) in [(0.8, 1), (0.2, 1), (0.0, 0), (0.02, 0)] {
        let noise = |f: f64| 0.005 * (7.0 * f).sin();
        let first: Vec<_> = f
            .iter()
            .map(|f| (*f, 3.0 - 0.1 * f - if *f < 5.5 { fall } else { 0.0 } + noise(*f), 0.01))
            .collect();
        let of = |mass, curve: &[Point]| NamedCurve {
            mass: Some(mass),
            direction: Direction::Down,
            curve: curve.to_vec(),
            jumps: down(curve),
            resonances: Vec::new(),
        };
        let mut found = [of(1, &first), of(2, &second)];
        assert_eq!((found[0].jumps.len(), found[1].jumps.len()), (0, 1), "{fall}");
        name_modes(&mut found);
        assert_eq!((found[0].jumps.len(), found[1].jumps.len()), (expected, 1), "{fall}");
        for jump in &found[0].jumps {
            assert_eq!((jump.from, jump.to, jump.change), (6.0, 5.0, "drop"));
        }
    }
}

/// A mode of ζ 0.05 in 25 steps over four bandwidths whose force changes by 1 % from step to step, while each
/// amplitude is known to 0.01 %: over 400 sweeps the error of the top is as large as the stated uncertainty,
/// within a quarter. (The scatter of nine points is known to about 30 % once and to 2 % over 400 sweeps; the
/// order of the polynomial adds up to a fifth.)
#[test]
fn a_force_that_changes_from_step_to_step_is_in_the_uncertainty_of_the_top() {
    let mut random = vibro_math::Noise::new(17);
    let (own, zeta) = (10.0, 0.05);
    let f: Vec<f64> = (0..25).map(|k| own + f64::from(k - 12) / 6.0 * zeta * own * 2.0).collect();
    let top = own * f64::sqrt(1.0 - 2.0 * zeta * zeta);
    let square = |_| {
        let a: Vec<f64> = f
            .iter()
            .map(|f| (1.0 + 0.01 * random.normal()) / (own * own - f * f).hypot(2.0 * zeta * own * f))
            .collect();
        let std: Vec<f64> = a.iter().map(|a| 1e-4 * a).collect();
        let found = resonances(&f, &a, &std, &[], None);
        let error = |r: &Resonance| (r.frequency - top).abs();
        let nearest = found.iter().min_by(|a, b| error(a).total_cmp(&error(b))).unwrap();
        (error(nearest) / nearest.frequency_std.unwrap()).powi(2)
    };
    let spread = ((0..400).map(square).sum::<f64>() / 400.0).sqrt();
    assert!((0.75..1.25).contains(&spread), "{spread}");
}

#[test]
fn nothing_in_short_curves() {
    assert!(resonances(&[1.0], &[1.0], &[0.0], &[], None).is_empty());
    assert!(jumps(&[1.0], &[1.0], &[0.0], Direction::Up).is_empty());
}

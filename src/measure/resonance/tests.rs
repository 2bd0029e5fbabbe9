//! Resonances, jumps and crossings of curves whose answer is known.

use super::*;

#[test]
fn a_mass_that_moves_alone_does_not_clap() {
    let resonance = |f, a, kind: &str| Resonance {
        frequency: f,
        frequency_std: None,
        amplitude: a,
        amplitude_std: None,
        kind: kind.into(),
        at_jump: false,
    };
    let mut first = vec![
        resonance(5.5, 10.0, "resonance"),
        resonance(7.5, 0.1, "antiresonance"),
        resonance(10.6, 2.0, "resonance"),
    ];
    let mut second = vec![resonance(5.5, 9.0, "resonance")];
    let curve = |above| vec![(4.0, 1.0, 0.0), (5.5, 9.0, 0.0), (9.0, above, 0.0), (13.0, above, 0.0)];
    for (above, expected) in [(1e-6, "resonance"), (1.0, "clapping")] {
        first[2].kind = "resonance".into();
        first[0].kind = "resonance".into();
        let direction = Direction::Up;
        name_modes(&mut [
            NamedCurve { mass: 1, direction, curve: curve(1.0), jumps: Vec::new(), resonances: &mut first },
            NamedCurve {
                mass: 2,
                direction,
                curve: curve(above),
                jumps: Vec::new(),
                resonances: &mut second,
            },
        ]);
        assert_eq!((first[0].kind.as_str(), first[2].kind.as_str()), ("grazing", expected));
        assert_eq!(second[0].kind, "grazing");
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

/// Eleven points one apart, of 1 % uncertainty.
fn curve(start: f64, height: impl Fn(f64) -> f64) -> Vec<(f64, f64, f64)> {
    (0..11).map(|i| start + f64::from(i)).map(|f| (f, height(f), 0.01 * height(f))).collect()
}

#[test]
fn the_uncertainty_of_a_crossing_is_how_the_amplitudes_move_it() {
    // Each amplitude moved on its own by its uncertainty: linear to 1 % of itself, as the logarithm is.
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
fn a_hardening_peak_ends_in_a_drop() {
    let f: Vec<f64> = (0..12).map(|i| 8.0 + 0.3 * f64::from(i)).collect();
    let a: Vec<f64> = f.iter().map(|f| if *f < 10.6 { 1.0 + (f - 8.0) } else { 0.8 }).collect();
    let jumps = jumps(&f, &a, &[0.01; 12], Direction::Up);
    assert_eq!(jumps.len(), 1);
    assert_eq!((jumps[0].change, jumps[0].from), ("drop", f[8]));
    let peaks = resonances(&f, &a, &[0.01; 12], &jumps);
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
                let found = jumps(&f, &a, &vec![1e-6; f.len()], Direction::Up);
                assert!(found.is_empty(), "Q {q}, {n} points, {offset}: {found:?}");
            }
        }
    }
}

#[test]
fn a_smooth_resonance_is_no_jump() {
    let f: Vec<f64> = (0..40).map(|i| 4.0 + 0.1 * f64::from(i)).collect();
    let a: Vec<f64> = f.iter().map(|f| 1.0 / (1.0 - (f / 5.6f64).powi(2)).hypot(0.04 * f / 5.6)).collect();
    assert!(jumps(&f, &a, &[1e-3; 40], Direction::Up).is_empty());
    let peaks = resonances(&f, &a, &[1e-3; 40], &[]);
    assert_eq!(peaks.len(), 1);
    assert!((peaks[0].frequency - 5.6).abs() < 0.02, "{peaks:?}");
}

#[test]
fn noise_has_no_resonances_and_no_jumps() {
    // Alternating values whose differences are three standard deviations.
    let f: Vec<f64> = (0..20).map(f64::from).collect();
    let a: Vec<f64> = (0..20).map(|i| if i % 2 == 0 { 4.0 } else { 1.0 }).collect();
    assert!(resonances(&f, &a, &[1.0; 20], &[]).is_empty());
    assert!(jumps(&f, &a, &[1.0; 20], Direction::Up).is_empty());
    assert!(!resonances(&f, &a, &[0.1; 20], &[]).is_empty());
}

#[test]
fn nothing_in_short_curves() {
    assert!(resonances(&[1.0], &[1.0], &[0.0], &[]).is_empty());
    assert!(jumps(&[1.0], &[1.0], &[0.0], Direction::Up).is_empty());
}

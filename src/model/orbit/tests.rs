//! Orbits against their own conditions, their energy balance, other computations of them, and golden numbers.

use super::*;
use crate::model::Simulation;

/// ν = ω/Ω₁ to a frequency in Hz.
fn at(rig: &Rig, nu: f64) -> f64 {
    nu * (rig.k1 / rig.m1).sqrt() / TAU
}

/// Rigs, forces and frequency ratios from light to over-critical damping.
fn scenes() -> Vec<(Rig, f64, f64, u32)> {
    let t = Rig::thesis();
    let mut scenes = Vec::new();
    for rig in [
        t,
        Rig { c1: 0.0, c2: 0.0, restitution: 1.0, ..t },
        Rig { c1: 8.3, c2: 0.2, restitution: 0.4, ..t },
        Rig { c1: 1.0, c2: 9.0, restitution: 0.0, gap: -2e-4, ..t },
    ] {
        for nu in [0.83, 1.13, 1.71, 2.03, 2.61] {
            scenes.push((rig, 0.5, nu, 1));
            scenes.push((rig, 3.0, nu, 2));
        }
    }
    scenes
}

fn each(mut check: impl FnMut(&Rig, f64, &Orbit)) {
    let mut count = 0;
    for (rig, force, nu, cycles) in scenes() {
        let sine = Sine { force, frequency: at(&rig, nu) };
        for orbit in &orbits_over(&rig, &sine, cycles).unwrap().orbits {
            check(&rig, force, orbit);
            count += 1;
        }
    }
    assert!(count > 50, "{count} orbits");
}

/// Size of the terms that add up to the displacements, for rounding.
fn scale(orbit: &Orbit) -> f64 {
    let [x1, x2] = orbit.peak_to_peak;
    x1 + x2 + orbit.motion.noise() / f64::EPSILON
}

#[test]
fn both_masses_meet_and_part_as_the_impact_law_says() {
    each(|rig, _, orbit| {
        let (before, after) = (orbit.before_impact(), orbit.state(0.0));
        let omega = TAU * orbit.frequency;
        let (length, speed) =
            (64.0 * f64::EPSILON * scale(orbit), 64.0 * f64::EPSILON * scale(orbit) * omega.max(60.0));
        assert!((rig.gap + before.x2 - before.x1).abs() < length);
        assert!((before.x1 - after.x1).abs() < length && (before.x2 - after.x2).abs() < length);
        assert!((before.approach() - orbit.approach_velocity).abs() < speed);
        assert!((after.approach() + rig.restitution * before.approach()).abs() < speed);
        assert!((rig.m1 * (after.v1 - before.v1) + orbit.impulse).abs() < rig.m1 * speed);
        assert!((rig.m2 * (after.v2 - before.v2) - orbit.impulse).abs() < rig.m2 * speed);
    });
}

#[test]
fn work_of_the_force_is_what_dampers_and_impact_take() {
    each(|rig, force, orbit| {
        let (n, period) = (2000_u32, orbit.period());
        let omega = TAU * orbit.frequency;
        // Simpson on an even number of panels.
        let (mut work, mut loss) = (0.0, 0.0);
        for i in 0..=n {
            let t = period * f64::from(i) / f64::from(n);
            let s = orbit.motion.state(t);
            let weight = if i == 0 || i == n { 1.0 } else { 2.0 * f64::from(1 + i % 2) };
            let panel = weight * period / f64::from(3 * n);
            work += panel * force * (omega * t + orbit.force_phase).cos() * s.v1;
            loss += panel * (rig.c1 * s.v1.powi(2) + rig.c2 * s.v2.powi(2));
        }
        let v = orbit.approach_velocity;
        let impact = rig.reduced_mass() * (1.0 - rig.restitution.powi(2)) * v * v / 2.0;
        // Simpson: (T/180)h⁴ f⁗, with frequencies up to the fast decay of the over-critical scene, 96/s (twice that in
        // the square of the velocity), and power up to (force + damping) × speed.
        let top = orbit.peak_to_peak[0].max(orbit.peak_to_peak[1]) * 100.0;
        let power = top * (force + 10.0 * top);
        let step = period / f64::from(n);
        let tolerance = period / 180.0 * (step * 192.0).powi(4) * power + 1e-13 * power;
        assert!((work - loss - impact).abs() < tolerance, "{work} {loss} {impact} {tolerance}");
    });
}

#[test]
fn fundamentals_are_the_dft_of_the_trace() {
    each(|_, _, orbit| {
        let (n, omega) = (4096_u32, TAU * orbit.frequency);
        let mut sums = [Complex64::ZERO; 2];
        for i in 0..n {
            let t = orbit.period() * f64::from(i) / f64::from(n);
            let s = orbit.state(t);
            let wave = Complex64::cis(-omega * t) * (2.0 / f64::from(n));
            sums[0] += wave * s.x1;
            sums[1] += wave * s.x2;
        }
        // A kink of J/m in slope: harmonics fall like 2J/(T m (nω₁)²), and those near multiples of 4096 fold.
        let kink = 2.0 * orbit.impulse.abs() * orbit.period() / (0.094 * TAU * TAU);
        let tolerance = 4.0 * kink / f64::from(n).powi(2) + 1e-15;
        for (sum, exact) in sums.iter().zip(orbit.fundamental) {
            assert!((sum - exact).norm() < tolerance, "{sum} {exact} {tolerance}");
        }
    });
}

#[test]
fn multipliers_have_the_determinant_of_dampers_and_impact() {
    each(|rig, _, orbit| {
        let Some(multipliers) = orbit.multipliers else { return };
        let [b1, b2] = rig.oscillators().map(|o| o.decay());
        let expected = rig.restitution.powi(2) * (-2.0 * (b1 + b2) * orbit.period()).exp();
        let product: Complex64 = multipliers.iter().product();
        // ε times the square of the monodromy's size, about 100 for accelerations over approach speeds here.
        assert!((product - expected).norm() < 1e-16 * 1e4, "{product} {expected}");
    });
}

#[test]
fn multipliers_are_those_of_a_disturbed_simulation() {
    // Central differences of the simulated map over one period, from half way between two impacts.
    let rig = Rig::thesis();
    let frequency = at(&rig, 2.1);
    let orbit = orbits(&rig, 0.5, frequency).unwrap().orbits[0];
    let half = orbit.period() / 2.0;
    let phase = orbit.force_phase + TAU / 2.0;
    let start = orbit.state(half);
    let fly = |d: [f64; 4]| {
        let state =
            State { x1: start.x1 + d[0], v1: start.v1 + d[1], x2: start.x2 + d[2], v2: start.v2 + d[3] };
        let sine = Sine { force: 0.5, frequency };
        let mut motion = Simulation::from_state(&rig, &sine, state, phase).unwrap();
        motion.run(orbit.period(), |_| {}).unwrap();
        let s = motion.state();
        [s.x1, s.v1, s.x2, s.v2]
    };
    let h = 1e-7;
    let mut map = nalgebra::Matrix4::zeros();
    for column in 0..4 {
        // Velocities are about Ω times displacements.
        let step = if column % 2 == 0 { h } else { h * 33.0 };
        let mut d = [0.0; 4];
        d[column] = step;
        let (up, down) = (fly(d), fly(d.map(|v| -v)));
        for row in 0..4 {
            map[(row, column)] = (up[row] - down[row]) / (2.0 * step);
        }
    }
    let found = floquet::multipliers(&map).unwrap();
    for (a, b) in found.iter().zip(orbit.multipliers.unwrap()) {
        // Third derivatives of the map times h², relative to the gap scale: about (1e-7/1e-3)².
        assert!((a - b).norm() < 1e-6, "{a} {b}");
    }
}

#[test]
fn golden_numbers_of_the_clapping_scene() {
    // 0.5 N, R 0.7, ν 2.1. Impulses by arithmetic with 40 digits from the formulas for (C, P, J).
    let rig = Rig::thesis();
    let found = orbits(&rig, 0.5, at(&rig, 2.1)).unwrap();
    let [first, second] = [found.orbits[0], found.orbits[1]];
    // ν goes through a frequency in Hz and back, three roundings, and J changes by some 30 % per percent of ν.
    let tolerance = 100.0 * f64::EPSILON;
    assert!((first.impulse / 0.026_238_325_207_374_714 - 1.0).abs() < tolerance, "{:.17}", first.impulse);
    assert!((second.impulse / -0.008_944_428_353_726_752 - 1.0).abs() < tolerance);
    let expected = [-0.970_287_19, -0.944_010_47, 0.832_533_01, 0.542_278_39];
    for (m, e) in first.multipliers.unwrap().iter().zip(expected) {
        // Printed to 8 digits.
        assert!((m - e).norm() < 0.6e-8, "{m} {e}");
    }
    let product: Complex64 = first.multipliers.unwrap().iter().product();
    assert!((product - 0.413_524_143_627_467_14).norm() < 1e-13);
    assert!(first.validity.exists && first.validity.admissible && first.validity.stable == Some(true));
    assert!(!second.validity.exists && second.multipliers.is_none());
}

#[test]
fn golden_losses_of_stability() {
    let rig = Rig { restitution: 1.0, ..Rig::thesis() };
    // A flip, printed as −1.326.
    let flip = orbits(&rig, 0.9, at(&rig, 1.2)).unwrap().orbits[0];
    let m = flip.multipliers.unwrap()[0];
    assert!((m - Complex64::new(-1.326, 0.0)).norm() < 6e-4, "{m}");
    assert!(flip.validity.exists && flip.validity.stable == Some(false));
    // A pair outside the circle, printed as 0.389 ± 1.047i.
    let pair = orbits(&rig, 0.05, at(&rig, 1.3)).unwrap().orbits[0];
    let m = pair.multipliers.unwrap();
    assert!(
        (m[0] - Complex64::new(0.389, 1.047)).norm() < 1e-3 && (m[1] - m[0].conj()).norm() < 1e-12,
        "{m:?}"
    );
    // Passes through the other mass by 6.2 mm.
    let deep = orbits(&Rig::thesis(), 0.5, at(&rig, 0.8)).unwrap().orbits[0];
    assert!((deep.validity.min_gap + 6.2e-3).abs() < 0.05e-3 && !deep.validity.admissible);
}

/// Without losses the multipliers come in pairs z, 1/z: z⁴ − az³ + bz² − az + 1 with w = z + 1/z from w² − aw + b − 2. All lie on the
/// circle where both w are real and within ±2; else one lies outside. None is ever stable.
#[test]
fn a_rig_without_losses_is_neutral_or_unstable() {
    let rig = Rig { c1: 0.0, c2: 0.0, restitution: 1.0, ..Rig::thesis() };
    let (mut neutral, mut unstable) = (0, 0);
    for force in [0.02, 0.1, 0.5, 3.0] {
        for i in 0..300 {
            let nu = 0.7031 + 0.0067 * f64::from(i);
            for orbit in &orbits(&rig, force, at(&rig, nu)).unwrap().orbits {
                let Some(m) = orbit.multipliers else { continue };
                let a: f64 = m.iter().map(|z| z.re).sum();
                let b = (0..4)
                    .flat_map(|i| (0..i).map(move |j| (i, j)))
                    .map(|(i, j)| (m[i] * m[j]).re)
                    .sum::<f64>();
                let root = a * a - 4.0 * (b - 2.0);
                let w = [-1.0, 1.0].map(|sign| f64::midpoint(a, sign * root.max(0.0).sqrt()));
                let outermost = w[0].abs().max(w[1].abs());
                let place = format!("{force} N, ν {nu}: {m:?}");
                // The margin is far above the rounding of a and b, far below what separates the two.
                if root > 1e-6 && outermost < 2.0 - 1e-6 {
                    assert_eq!(
                        (orbit.validity.stable, orbit.validity.stability),
                        (None, "neutral"),
                        "{place}"
                    );
                    neutral += 1;
                } else if root < -1e-6 || outermost > 2.0 + 1e-6 {
                    assert_eq!(orbit.validity.stable, Some(false), "{place}");
                    unstable += 1;
                }
                assert_ne!(orbit.validity.stable, Some(true), "{place}");
            }
        }
    }
    println!("{neutral} neutral, {unstable} unstable");
    assert!(neutral > 50 && unstable > 50, "{neutral} {unstable}");
}

#[test]
fn the_clapping_peak_is_where_it_was_found() {
    // Independent: largest impact speed 0.46903 m/s at ν 2.00992.
    let rig = Rig::thesis();
    let speed = |nu: f64| orbits(&rig, 0.5, at(&rig, nu)).unwrap().orbits[0].approach_velocity;
    let top =
        (0..400).map(|i| 1.99 + f64::from(i) * 1e-4).max_by(|a, b| speed(*a).total_cmp(&speed(*b))).unwrap();
    assert!((top - 2.009_92).abs() < 1e-4, "{top}");
    assert!((speed(top) - 0.469_03).abs() < 1e-5);
}

#[test]
fn grazing_distance_is_the_change_of_gap_that_grazes() {
    // The positive root vanishes at Δ = A where C > 0, as at ν = 1: near there the first-order distance is A − Δ.
    let rig = Rig::thesis();
    let frequency = at(&rig, 1.0);
    let amplitude = orbits(&rig, 0.1, frequency).unwrap().no_impact.amplitude;
    let near = Rig { gap: amplitude * (1.0 - 1e-5), ..rig };
    let orbit = orbits(&near, 0.1, frequency).unwrap().orbits[0];
    let expected = amplitude * 1e-5;
    // What second order leaves is some tens of times the relative distance, because C is small against P/ω.
    assert!((orbit.validity.grazing_distance / expected - 1.0).abs() < 100.0 * 1e-5, "{:?}", orbit.validity);
    assert!(!orbit.validity.robust(2.0 * expected));
}

#[test]
fn the_verdict_on_contacts_is_that_of_the_contact_search() {
    let (mut clear, mut pierced) = (0, 0);
    each(|rig, _, orbit| {
        // Without rebound the search would start at rest on the contact.
        if rig.restitution == 0.0 || orbit.impulse <= 0.0 {
            return;
        }
        let second = orbit.motion.first_contact(orbit.period() * (1.0 - 1e-9));
        assert_eq!(orbit.validity.admissible, second.is_none(), "{orbit:?}");
        if second.is_none() { clear += 1 } else { pierced += 1 }
    });
    assert!(clear > 5 && pierced > 5, "{clear} {pierced}");
}

#[test]
fn no_force_and_undamped_resonance_have_no_orbit() {
    assert!(orbits(&Rig::thesis(), 0.0, 5.0).is_err());
    assert!(orbits(&Rig::thesis(), f64::NAN, 5.0).is_err());
    assert!(orbits(&Rig::thesis(), 0.5, 0.0).is_err());
    let tuned = Rig { m2: 1.0, k2: TAU * TAU, c2: 0.0, ..Rig::thesis() };
    let text = orbits(&tuned, 0.5, 1.0).unwrap_err().to_string();
    assert!(text.contains("without a damper"), "{text}");
}

use super::*;
use crate::orbit::orbits;
use crate::regime;
use crate::regime::Regime;
use crate::simulate::Simulation;

#[test]
fn one_impact_a_cycle_is_the_closed_form() {
    let mut seen = 0;
    for (force, frequency, restitution) in
        [(0.5, 11.0, 0.7), (0.5, 5.6, 0.7), (0.9, 8.0, 1.0), (0.2, 10.4, 0.9), (0.5, 12.5, 0.3)]
    {
        let rig = Rig { restitution, ..Rig::thesis() };
        for orbit in orbits(&rig, force, frequency).unwrap().orbits {
            if orbit.impulse <= 0.0 {
                continue;
            }
            let guess = (orbit.force_phase + 0.02, orbit.impulse * 1.03);
            let found = PeriodicOrbit::near(&rig, &Sine { force, frequency }, 1, &[guess]).unwrap();
            let beat = found.beats[0];
            // Both solve the same two equations. A rounding of a few ε of the gap or the amplitude,
            // whichever is larger, changes J relatively by that rounding over the grazing distance.
            let amplified =
                rig.gap.max(orbit.fundamental[0].norm()) / orbit.validity.grazing_distance.max(1e-9);
            let tolerance = 1e-12_f64.max(64.0 * f64::EPSILON * amplified);
            assert!((beat.impulse / orbit.impulse - 1.0).abs() < tolerance, "{beat:?} {orbit:?}");
            assert!((beat.phase - orbit.force_phase).abs() < tolerance, "{beat:?} {orbit:?}");
            assert!((found.fundamental[0] - orbit.fundamental[0]).norm() < tolerance * 0.01);
            assert!((found.peak_to_peak[1] - orbit.peak_to_peak[1]).abs() < tolerance * 0.1);
            let (a, b) = (&found.validity, &orbit.validity);
            assert_eq!((a.exists, a.admissible, a.stable), (b.exists, b.admissible, b.stable), "{orbit:?}");
            assert!((a.grazing_distance / b.grazing_distance - 1.0).abs() < 1e-6, "{a:?} {b:?}");
            let (m, n) = (found.spectral_radius().unwrap(), orbit.spectral_radius().unwrap());
            assert!((m / n - 1.0).abs() < 1e-7, "{m} {n}");
            seen += 1;
        }
    }
    assert!(seen >= 5, "{seen}");
}

#[test]
fn patterns_that_simulations_settle_on_are_found() {
    let mut seen = Vec::new();
    for (force, restitution) in [(0.5, 0.7), (0.9, 0.8), (0.3, 0.6)] {
        for k in 0..60 {
            let frequency = 2.0 + 0.35 * f64::from(k);
            let (rig, sine) = (Rig { restitution, ..Rig::thesis() }, Sine { force, frequency });
            let mut motion = Simulation::new(&rig, &sine).unwrap();
            // A simulation that ends with an error, such as too many impacts in a cycle, is skipped.
            let Ok(found) = regime(&mut motion, 1500, 200) else { continue };
            let Regime::Periodic { impacts, cycles } = found.regime else { continue };
            if found.distance.unwrap() > 1e-9 || (impacts, cycles) == (1, 1) {
                continue;
            }
            let orbit = PeriodicOrbit::from_strikes(&rig, &sine, cycles, &found.strikes).unwrap();
            for (beat, strike) in orbit.beats.iter().zip(&found.strikes) {
                // The last two repetitions differ by at most 1e-9. The remaining transient is larger, the
                // nearer the largest multiplier is to 1; up to 1e-6 is allowed.
                assert!((beat.impulse - strike.impulse).abs() < 1e-6 * strike.impulse, "{beat:?} {strike:?}");
            }
            assert!(orbit.validity.exists && orbit.validity.admissible, "{orbit:?}");
            assert_ne!(orbit.validity.stable, Some(false), "{orbit:?}");
            // det M = R^{2p} exp(−2(b₁ + b₂)T); the eigenvalues are those of a matrix that differs by a few
            // ε‖M‖.
            let [b1, b2] = rig.oscillators().map(|o| o.decay());
            let expected = restitution.powi(2 * impacts as i32) * (-2.0 * (b1 + b2) * orbit.period()).exp();
            let det = orbit.multipliers.unwrap().iter().product::<Complex64>();
            let scale = orbit.monodromy.unwrap().norm().powi(4).max(1.0);
            assert!((det - expected).norm() < 1e-13 * scale, "{det} {expected}");
            // After a period the state is that of the start.
            let (a, b) = (orbit.state(0.0), orbit.state(orbit.period() * (1.0 - 1e-15)));
            assert!((a.x1 - b.x1).abs() < 1e-12, "{a:?} {b:?}");
            seen.push((impacts, cycles));
        }
    }
    println!("{seen:?}");
    seen.sort_unstable();
    seen.dedup();
    assert!(seen.len() >= 3, "{seen:?}");
}

#[test]
fn a_motion_over_several_periods_is_brought_to_one() {
    let (rig, sine) = (Rig { restitution: 0.5, ..Rig::thesis() }, Sine { force: 0.5, frequency: 10.0 });
    let orbit = orbits(&rig, 0.5, 10.0).unwrap().orbits.remove(0);
    let thrice: Vec<_> =
        (0..3).map(|i| (orbit.force_phase + TAU * f64::from(i), orbit.impulse * 1.001)).collect();
    let found = PeriodicOrbit::near(&rig, &sine, 3, &thrice).unwrap();
    assert_eq!((found.impacts(), found.cycles), (3, 3));
    let cubed = found.spectral_radius().unwrap();
    let found = found.shortest().unwrap();
    assert_eq!((found.impacts(), found.cycles), (1, 1));
    assert!((found.spectral_radius().unwrap().powi(3) / cubed - 1.0).abs() < 1e-9);
}

#[test]
fn what_is_not_there_is_refused() {
    let (rig, sine) = (Rig::thesis(), Sine { force: 0.01, frequency: 20.0 });
    assert!(PeriodicOrbit::near(&rig, &sine, 1, &[(0.0, 1e-3)]).is_err());
    assert!(PeriodicOrbit::near(&rig, &sine, 0, &[(0.0, 1e-3)]).is_err());
    assert!(PeriodicOrbit::near(&rig, &sine, 1, &[]).is_err());
    assert!(PeriodicOrbit::near(&rig, &sine, 1, &[(f64::NAN, 1e-3)]).is_err());
}

use super::*;
use crate::{Orbit, Rig, Sine, orbits};
use std::f64::consts::TAU;

fn one(rig: &Rig, force: f64, frequency: f64) -> PeriodicOrbit {
    let orbit = orbits(rig, force, frequency).unwrap().orbits.remove(0);
    PeriodicOrbit::near(rig, &Sine { force, frequency }, 1, &[(orbit.force_phase, orbit.impulse)]).unwrap()
}

#[test]
fn the_branch_of_one_impact_a_cycle_is_the_closed_form_through_its_folds() {
    let mut folds = 0;
    for (force, frequency, restitution) in [(0.5, 11.0, 0.7), (0.05, 6.8, 1.0), (0.1, 6.0, 0.9)] {
        let rig = Rig { restitution, ..Rig::thesis() };
        let branch = follow(&one(&rig, force, frequency), 3.0, 20.0, 0.05).unwrap();
        for point in &branch.points {
            let beat = point.beats[0];
            if beat.impulse < 1e-9 {
                continue;
            }
            let closed = orbits(&rig, force, point.sine.frequency).unwrap().orbits;
            let off = |o: &Orbit| (o.impulse / beat.impulse - 1.0).abs();
            let off = closed.iter().map(off).fold(f64::INFINITY, f64::min);
            // Newton's last step is below 1e-10 and squares; near a fold roundings are enlarged by the sensitivity.
            let amplified = 1.0 + point.peak_to_peak[0] / point.validity.grazing_distance.max(1e-12);
            assert!(off < 1e-12 * amplified, "{off} {beat:?} at {}", point.sine.frequency);
        }
        // Folds are where the closed form gains or loses both roots.
        for fold in branch.marks.iter().filter(|m| m.kind == Loss::Fold) {
            let f = fold.orbit.sine.frequency;
            let roots = |f: f64| orbits(&rig, force, f).unwrap().orbits.len();
            assert_ne!(roots(f * (1.0 - 1e-9)), roots(f * (1.0 + 1e-9)), "{f}");
            folds += 1;
        }
    }
    assert!(folds > 1, "{folds}");
}

#[test]
fn losses_of_stability_are_marked_where_multipliers_pass_the_circle() {
    // Golden: F₀ 0.9 N, R 1, ν 1.2 has the multiplier −1.326; F₀ 0.05 N, R 1, ν 1.3 the pair 0.389 ± 1.047i.
    let rig = Rig { restitution: 1.0, ..Rig::thesis() };
    let at = |nu: f64| nu * (rig.k1 / rig.m1).sqrt() / TAU;
    for (force, nu, kind) in [(0.9, 1.2, Loss::Flip), (0.05, 1.3, Loss::NeimarkSacker)] {
        let branch = follow(&one(&rig, force, at(nu)), at(1.02), at(2.6), 0.03).unwrap();
        let marks: Vec<_> = branch.marks.iter().filter(|m| m.kind == kind).collect();
        assert!(!marks.is_empty());
        for mark in marks {
            let multipliers = mark.orbit.multipliers.unwrap();
            let near = multipliers.iter().map(|m| match kind {
                Loss::Flip => (m + 1.0).norm(),
                _ => (m.norm() - 1.0).abs(),
            });
            assert!(near.fold(1.0, f64::min) < 1e-6, "{multipliers:?}");
        }
    }
}

#[test]
fn bad_requests_are_refused() {
    let rig = Rig::thesis();
    let start = one(&rig, 0.5, 11.0);
    for (low, high, step) in [(11.5, 20.0, 0.05), (0.0, 20.0, 0.05), (1.0, f64::NAN, 0.05), (1.0, 20.0, 0.0)]
    {
        assert!(follow(&start, low, high, step).is_err());
    }
}

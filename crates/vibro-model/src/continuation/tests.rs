use super::*;
use crate::excitation::Sine;
use crate::orbit::{Orbit, orbits};
use crate::rig::Rig;
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
        let branch = follow(&one(&rig, force, frequency), Parameter::Frequency, 3.0, 20.0, 0.05).unwrap();
        for point in &branch.points {
            let beat = point.beats[0];
            if beat.impulse < 1e-9 {
                continue;
            }
            let closed = orbits(&rig, force, point.sine.frequency).unwrap().orbits;
            let off = |o: &Orbit| (o.impulse / beat.impulse - 1.0).abs();
            let off = closed.iter().map(off).fold(f64::INFINITY, f64::min);
            // Newton's last step is below 1e-10, and the error after it is the square of that. Near a fold
            // and near grazing, the rounding of the amplitude changes J relatively by up to
            // amplitude/grazing distance.
            let amplified = 1.0 + point.peak_to_peak[0] / point.validity.grazing_distance.max(1e-12);
            assert!(off < 1e-12 * amplified, "{off} {beat:?} at {}", point.sine.frequency);
        }
        // At a fold the closed form gains or loses both roots.
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
    // Reference values: multiplier −1.326 for F₀ 0.9 N, R 1, ν 1.2; pair 0.389 ± 1.047i for F₀ 0.05 N, R 1, ν
    // 1.3.
    let rig = Rig { restitution: 1.0, ..Rig::thesis() };
    let at = |nu: f64| nu * (rig.k1 / rig.m1).sqrt() / TAU;
    for (force, nu, kind) in [(0.9, 1.2, Loss::Flip), (0.05, 1.3, Loss::NeimarkSacker)] {
        let branch =
            follow(&one(&rig, force, at(nu)), Parameter::Frequency, at(1.02), at(2.6), 0.03).unwrap();
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
        assert!(follow(&start, Parameter::Frequency, low, high, step).is_err());
    }
}

#[test]
fn branches_over_force_gap_and_restitution_are_the_closed_form() {
    let rig = Rig { restitution: 0.9, ..Rig::thesis() };
    let start = one(&rig, 0.5, 10.5);
    for (over, low, high) in
        [(Parameter::Force, 0.02, 2.0), (Parameter::Gap, -2e-3, 8e-3), (Parameter::Restitution, 0.0, 1.0)]
    {
        let branch = follow(&start, over, low, high, 0.05).unwrap();
        assert!(branch.points.len() > 8, "{over:?}");
        for point in branch.points.iter().filter(|p| p.beats[0].impulse > 1e-9) {
            let beat = point.beats[0];
            let closed = orbits(&point.rig, point.sine.force, 10.5).unwrap().orbits;
            let off = |o: &Orbit| (o.impulse / beat.impulse - 1.0).abs();
            let off = closed.iter().map(off).fold(f64::INFINITY, f64::min);
            // Amplification as for the branch over frequency.
            let amplified = 1.0 + point.peak_to_peak[0] / point.validity.grazing_distance.max(1e-12);
            assert!(off < 1e-12 * amplified, "{over:?} {off} {beat:?}");
        }
        // Roots appear and vanish at folds; where the branch ends by grazing, the impulse of a root passes
        // through zero.
        for fold in branch.marks.iter().filter(|m| m.kind == Loss::Fold) {
            let roots = |share: f64| {
                let (mut rig, mut sine) = (fold.orbit.rig, fold.orbit.sine);
                match over {
                    Parameter::Force => sine.force *= share,
                    other => *other.place(&mut rig).unwrap() *= share,
                }
                orbits(&rig, sine.force, sine.frequency).unwrap().orbits.len()
            };
            assert_ne!(roots(1.0 - 1e-9), roots(1.0 + 1e-9), "{over:?}");
        }
        let values = branch.points.iter().map(|p| over.of(&p.rig, &p.sine));
        let (least, most) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), v| (a.min(v), b.max(v)));
        assert!(least >= low - 1e-9 && most <= high + 1e-9, "{over:?} {least} {most}");
    }
}

#[test]
fn the_published_impact_oscillator_grazes_where_its_stop_touches() {
    // Example 15.2 of "Recipes for Continuation" (H. Dankowicz, F. Schilder 2013), in COCO's folder of the
    // toolbox hspo: ẍ + 0.1ẋ + x = A cos t with a stop at 1 and restitution 0.8. Published: its first
    // solution, A = 1, leaves the stop with −1.36 at the phase 0.076. Its family over A ends where it grazes:
    // there the linear amplitude A/0.1 equals the distance to the stop.
    let rig =
        Rig { m1: 1.0, m2: f64::INFINITY, k1: 1.0, k2: 1.0, c1: 0.1, c2: 0.0, gap: 1.0, restitution: 0.8 };
    let start = one(&rig, 1.0, 1.0 / TAU);
    let beat = start.beats[0];
    // Tolerance: half of the last published digit.
    assert!((0.8 * beat.approach_velocity - 1.36).abs() < 0.005, "{beat:?}");
    assert!(((beat.phase + 1.0).rem_euclid(TAU) - 1.0 - 0.076).abs() < 0.005, "{beat:?}");
    assert!(start.validity.real(), "{:?}", start.validity);
    let branch = follow(&start, Parameter::Force, 0.01, 1.0, 0.05).unwrap();
    let grazing: Vec<_> = branch.marks.iter().filter(|m| m.kind == Loss::Grazing).collect();
    let own = grazing.iter().map(|m| (m.orbit.sine.force / 0.1 - 1.0).abs()).fold(1.0, f64::min);
    // Located by bisection to 1e-11 of a step; ω = 2π/2π to rounding.
    assert!(own < 1e-6, "{own} {:?}", branch.ends);
}

#[test]
fn two_impacts_in_two_cycles_turn_back_where_one_impact_flips() {
    // Between the two flips of the motion with one impact a cycle there is a motion of twice the period. Its
    // branch is closed: it passes through its two impacts in either order.
    let rig = Rig { restitution: 0.9, ..Rig::thesis() };
    let sine = Sine { force: 0.9, frequency: 6.3 };
    let start = crate::search(&rig, &sine, 2, 2).unwrap().remove(0);
    let double = follow(&start, Parameter::Frequency, 5.0, 8.0, 0.05).unwrap();
    let single = follow(&one(&rig, 0.9, 6.3), Parameter::Frequency, 5.0, 8.0, 0.05).unwrap();
    let of = |branch: &Branch| {
        let flips = branch.marks.iter().filter(|m| m.kind == Loss::Flip);
        let mut all: Vec<f64> = flips.map(|m| m.orbit.sine.frequency).collect();
        all.sort_by(f64::total_cmp);
        all
    };
    let (double, single) = (of(&double), of(&single));
    assert!(double.len() == 2 && single.len() >= 2, "{double:?} {single:?}");
    for flip in double {
        let off = single.iter().map(|f| (f / flip - 1.0).abs()).fold(1.0, f64::min);
        // The branch turns back with zero slope: where the halves of the period differ by at most 1e-2, the
        // relative error of the flip's frequency is that squared.
        assert!(off < 1e-4, "{flip} {single:?}");
    }
}

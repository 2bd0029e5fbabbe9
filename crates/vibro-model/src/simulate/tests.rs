use super::*;
use crate::excitation::Sine;
use crate::orbit::orbits;
use crate::portrait::Samples;
use std::f64::consts::{FRAC_PI_2, TAU};

mod bounds;
mod energy;
mod settle;
mod wall;

fn scene_b() -> Simulation {
    let rig = Rig::thesis();
    let frequency = 2.1 * (rig.k1 / rig.m1).sqrt() / TAU;
    Simulation::from_state(&rig, &Sine { force: 0.5, frequency }, State::REST, -FRAC_PI_2).unwrap()
}

#[test]
fn a_start_from_rest_meets_its_golden_impacts() {
    // Number, time (s) and approach speed (m/s), in 40-digit arithmetic (Newton's method on the same
    // equations of motion), cut to 17 digits.
    let golden = [
        (1_u16, 0.030_744_282_246_676_34, 0.078_330_829_224_466_23),
        (2, 0.144_162_776_471_947_4, 0.147_727_906_853_932_83),
        (3, 0.237_270_475_783_159_57, 0.233_773_950_612_516_77),
        (22, 1.970_065_574_977_416, 0.283_306_967_791_457_3),
        (1098, 99.932_500_537_538_15, 0.287_669_247_580_228_4),
    ];
    let mut motion = scene_b();
    let mut impacts = Vec::new();
    motion.run(100.0, |leg| impacts.extend(leg.impact())).unwrap();
    for (number, time, speed) in golden {
        let impact = impacts[usize::from(number) - 1];
        // Times are summed without loss. Rounding of the gap (terms up to 10 mm) over the speed gives 1e-17
        // s, of the phase over ω 3e-18 s. These errors are amplified before they decay, and add up over the
        // 33 impacts that correspond to a multiplier of 0.97.
        let tolerance: f64 = if time < 2.0 { 1e-14 } else { 1e-12 };
        assert!((impact.time - time).abs() < tolerance, "{number}: {:.17} {time:.17}", impact.time);
        // Accelerations reach 20 m/s²; the error of the speed comes from the phase, not from the summed
        // times.
        let error = impact.approach_velocity - speed;
        assert!(
            error.abs() < 20.0 * f64::EPSILON * (1.0 + 0.5 * f64::from(number)),
            "{number}: {:.17} {speed:.17}",
            impact.approach_velocity
        );
    }
}

#[test]
fn it_settles_on_the_closed_form_orbit() {
    let mut motion = scene_b();
    // The largest multiplier of this orbit is 0.9703: its transient is below 1e-16 after 1250 periods of
    // 0.091 s.
    motion.run(150.0, |_| {}).unwrap();
    let mut last = None;
    motion.run(150.2, |leg| last = leg.impact().or(last)).unwrap();
    let orbit = orbits(motion.rig(), 0.5, motion.frequency()).unwrap().orbits.remove(0);
    let impact = last.unwrap();
    // Rounding of a state near 10 mm, amplified by 1/(1 − 0.97).
    let tolerance = 16.0 * f64::EPSILON / 0.03;
    assert!((impact.impulse / orbit.impulse - 1.0).abs() < 100.0 * tolerance, "{impact:?}");
    assert!((impact.phase - orbit.force_phase).abs() < 100.0 * tolerance, "{impact:?}");
}

#[test]
fn energy_of_a_flight_balances() {
    // The work of the force minus the losses of the dampers is the change of energy, integrated over each
    // leg.
    let rig = Rig { c1: 0.4, ..Rig::thesis() };
    let sine = Sine { force: 0.5, frequency: 9.0 };
    let mut motion = Simulation::new(&rig, &sine).unwrap();
    let energy = |s: State| {
        (rig.m1 * s.v1.powi(2) + rig.k1 * s.x1.powi(2) + rig.m2 * s.v2.powi(2) + rig.k2 * s.x2.powi(2)) / 2.0
    };
    let (mut put_in, mut largest) = (0.0, 0.0_f64);
    let mut phase = motion.phase();
    for _ in 0..100 {
        let leg = motion.fly(1e3).unwrap();
        // Composite Gauss–Legendre with three points on 512 panels of 0.4 ms: sixth order, error below
        // (0.4e-3 · 114/s)⁶/2e6 = 5e-15 of the energy.
        let panel = leg.duration / 512.0;
        let power = |t: f64| {
            let s = leg.state(t);
            sine.force * (sine.omega() * t + phase).cos() * s.v1
                - rig.c1 * s.v1.powi(2)
                - rig.c2 * s.v2.powi(2)
        };
        let node = 0.6_f64.sqrt() / 2.0;
        put_in += (0..512)
            .map(|i| {
                let middle = (f64::from(i) + 0.5) * panel;
                panel / 18.0
                    * (5.0 * power(middle - node * panel)
                        + 8.0 * power(middle)
                        + 5.0 * power(middle + node * panel))
            })
            .sum::<f64>();
        let impact = leg.impact().unwrap();
        put_in -=
            rig.reduced_mass() * (1.0 - rig.restitution.powi(2)) * impact.approach_velocity.powi(2) / 2.0;
        phase = motion.phase();
        largest = largest.max(energy(motion.state()));
    }
    // 51200 panels, each rounded to a few ε of the energy exchanged.
    assert!((put_in - energy(motion.state())).abs() < 51_200.0 * 4.0 * f64::EPSILON * largest);
}

#[test]
fn samples_do_not_depend_on_how_the_motion_is_cut() {
    let (mut whole, mut cut) = (scene_b(), scene_b());
    let follow = |motion: &mut Simulation, n: u32| {
        let until = motion.time() + f64::from(n) * 1e-3;
        let (mut samples, mut impacts) = (Samples::new(motion.time(), 1e-3, until), 0);
        motion
            .advance(until, &mut |piece| {
                samples.take(&piece);
                impacts += usize::from(matches!(piece.event, Event::Impact(_)));
            })
            .unwrap();
        (samples.states, impacts)
    };
    let (states, impacts) = follow(&mut whole, 3000);
    let (mut pieces, mut met) = (Vec::new(), 0);
    for n in [1, 7, 992, 2000] {
        let (states, impacts) = follow(&mut cut, n);
        pieces.extend(states);
        met += impacts;
    }
    assert_eq!((states.len(), impacts), (3000, met));
    for (a, b) in states.iter().zip(&pieces) {
        // Four more restarts of flights, each with some roundings of 10 mm and 0.5 m/s.
        assert!((a.x1 - b.x1).abs() < 1e-14 && (a.v2 - b.v2).abs() < 1e-12, "{a:?} {b:?}");
    }
}

#[test]
fn a_change_of_frequency_makes_no_step() {
    let mut motion = scene_b();
    motion.run(0.7, |_| {}).unwrap();
    let (state, phase, time) = (motion.state(), motion.phase(), motion.time());
    motion.set_frequency(6.0).unwrap();
    assert_eq!((motion.state(), motion.phase(), motion.time()), (state, phase, time));
    assert!(motion.set_frequency(-1.0).is_err());
    assert_eq!(motion.frequency(), 6.0);
    let leg = motion.fly(0.7).unwrap();
    assert_eq!(leg.duration, 0.0);
}

/// Scene C: at rest the masses are pressed together (gap −0.5 mm); at the start x₁ − x₂ = −2 mm.
fn scene_c() -> Simulation {
    let rig = Rig { gap: -5e-4, ..Rig::thesis() };
    let frequency = 0.45 * (rig.k1 / rig.m1).sqrt() / TAU;
    let start = State { x1: -2e-3, ..State::REST };
    Simulation::from_state(&rig, &Sine { force: 0.35, frequency }, start, -FRAC_PI_2).unwrap()
}

#[test]
fn chatter_ends_in_sticking_and_release() {
    // Reference values in 40-digit arithmetic.
    let golden = [
        (Event::Stick, 0.152_721_089_353_360_45),
        (Event::Release, 0.220_247_418_265_660_51),
        (Event::Stick, 0.574_521_373_816_090_7),
    ];
    let mut motion = scene_c();
    let mut found = Vec::new();
    motion
        .run(0.6, |leg| {
            if matches!(leg.event, Event::Stick | Event::Release) {
                found.push((leg.event, leg.start + leg.duration));
            }
            if let Some(impact) = leg.impact() {
                assert!(impact.approach_velocity > 0.0);
            }
        })
        .unwrap();
    assert_eq!(found.len(), 3, "{found:?}");
    for ((event, time), (expected, golden)) in found.iter().zip(&golden) {
        assert_eq!(event, expected);
        // Displacements near 2 mm are rounded to 1e-18 m. This shifts the last computed impacts, at 1e-7 m/s,
        // by 1e-11 s, and the end of the chatter by (1 + R)/(1 − R) = 5.7 times as much.
        assert!((time - golden).abs() < 1e-10, "{event:?} {time:.17} {golden:.17}");
    }
    assert_eq!(motion.counts().sticks, 2);
}

#[test]
fn impossible_starts_and_times_are_refused() {
    let rig = Rig::thesis();
    let sine = Sine { force: 0.5, frequency: 5.0 };
    let overlapping = State { x1: 2e-3, ..State::REST };
    assert!(Simulation::from_state(&rig, &sine, overlapping, 0.0).is_err());
    assert!(Simulation::from_state(&rig, &sine, State::REST, f64::NAN).is_err());
    assert!(Simulation::new(&Rig { restitution: 2.0, ..rig }, &sine).is_err());
    let mut motion = Simulation::new(&rig, &sine).unwrap();
    assert!(motion.fly(f64::NAN).is_err() && motion.fly(-1.0).is_err());
}

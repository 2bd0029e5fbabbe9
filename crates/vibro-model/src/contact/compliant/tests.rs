use super::*;
use crate::contact::conversion;
use crate::excitation::{Impulses, Pulses, Sine};
use crate::impact::Impact;
use crate::law::samples;
use crate::motion::Event;
use crate::motion::{Motion, Piece};
use crate::simulate::Simulation;
use std::cell::Cell;
use std::path::Path;
use vibro_math::border;
use vibro_math::runge_kutta::{Dop853, Integrator, Tolerance};

fn sine(force: f64, frequency: f64) -> Excitation {
    Excitation::Sine(Sine { force, frequency })
}

const LAWS: [Law; 5] = [
    Law::spring(1e5, 15.0),
    Law::spring(1e5, 0.0),
    Law::spring(1e4, 60.0),
    Law::hertz(1e8),
    Law::curved(1e8, 1.5, 0.6),
];

#[test]
fn thirty_contacts_agree_with_arithmetic_of_forty_digits() {
    let file =
        Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fixtures/reference/contact/kelvin_voigt.csv");
    let text = std::fs::read_to_string(file).unwrap();
    let rows: Vec<Vec<f64>> =
        text.lines().skip(1).map(|l| l.split(',').map(|v| v.parse().unwrap()).collect()).collect();
    assert_eq!(rows.len(), 30);
    let mut motion = Compliant::new(&Rig::thesis(), &sine(0.5, 11.0), LAWS[0], State::REST, 0.0).unwrap();
    let (mut parts, mut found) = (Vec::new(), Vec::new());
    let last = rows[29][2] + 1e-3;
    motion
        .advance(last, &mut |piece| match piece.event {
            Event::Part => parts.push(piece.start + piece.duration),
            Event::Impact(impact) => found.push((impact, piece.start + piece.duration)),
            _ => {}
        })
        .unwrap();
    assert_eq!((found.len(), parts.len()), (30, 30));
    let mut worst = 0.0_f64;
    for ((row, (impact, back)), part) in rows.iter().zip(&found).zip(&parts) {
        for (time, expected) in [(impact.time, row[0]), (*part, row[1]), (*back, row[2])] {
            worst = worst.max((time - expected).abs());
        }
        // Rounding of displacements of 10 mm, amplified some hundredfold by the contacts, over speeds of 0.1
        // m/s. The requirement is 1e-9 s.
        assert!(worst < 1e-13, "{worst:e} at {}", row[0]);
        assert!((impact.approach_velocity - row[3]).abs() < 1e-12, "{impact:?} {}", row[3]);
        assert!((impact.impulse / row[4] - 1.0).abs() < 1e-12, "{impact:?} {}", row[4]);
    }
    println!("worst time {worst:e} s");
}

/// Compares the energy with the work of the force minus the losses in dampers and contact, both integrated
/// over each piece.
fn check_balance(law: Law, rig: &Rig, seconds: f64) {
    let (force, frequency) = (0.5, 9.0);
    let mut motion = Compliant::new(rig, &sine(force, frequency), law, State::REST, 0.0).unwrap();
    let wall = rig.m2.is_infinite();
    let kinetic2 = |v: f64| if wall { 0.0 } else { rig.m2 * v * v / 2.0 };
    let energy = |s: State| {
        rig.m1 * s.v1.powi(2) / 2.0
            + kinetic2(s.v2)
            + f64::midpoint(rig.k1 * s.x1.powi(2), rig.k2 * s.x2.powi(2))
    };
    let (mut put_in, mut through, mut taken, mut impacts) = (0.0, 0.0, 0.0, Vec::new());
    let (touching, mut back_and_forth) = (Cell::new(false), 0.0);
    let mut visit = |piece: Piece<'_>| {
        // Power, by Gauss–Legendre with three points on each of 64 panels. A contact absorbs its force times
        // δ̇.
        let panel = piece.duration / 64.0;
        let node = 0.6_f64.sqrt() / 2.0;
        for i in 0..64 {
            for (place, weight) in [(-node, 5.0), (0.0, 8.0), (node, 5.0)] {
                let t = (f64::from(i) + 0.5 + place) * panel;
                let s = piece.path.state(t);
                let drive = force * (std::f64::consts::TAU * frequency * (piece.start + t)).cos();
                let depth = s.x1 - s.x2 - rig.gap;
                let contact =
                    if touching.get() { law.force(depth, s.approach()) * s.approach() } else { 0.0 };
                let power = drive * s.v1 - rig.c1 * s.v1.powi(2) - rig.c2 * s.v2.powi(2) - contact;
                put_in += weight / 18.0 * panel * power;
                through += weight / 18.0 * panel * (power.abs() + contact.abs());
                taken += weight / 18.0 * panel * contact;
                back_and_forth += weight / 18.0 * panel * contact.abs();
            }
        }
        match piece.event {
            Event::Touch => touching.set(true),
            Event::Part => touching.set(false),
            Event::Impact(impact) => {
                touching.set(false);
                impacts.push(impact);
            }
            _ => {}
        }
    };
    motion.advance(seconds, &mut visit).unwrap();
    while touching.get() {
        motion.advance(motion.time() + 1e-3, &mut visit).unwrap();
    }
    assert!(impacts.len() > 5, "{law:?}: {} impacts", impacts.len());
    let error = (put_in - energy(motion.state())).abs();
    assert!(error < 1e-10 * through, "{law:?}: {error:e} of {through:e}");
    // A contact without losses takes no energy.
    let elastic = law.damping == 0.0;
    assert_eq!(taken.abs() < 1e-10 * back_and_forth, elastic, "{law:?} {taken} {back_and_forth}");
}

#[test]
fn energy_balances_in_every_law() {
    for law in LAWS.into_iter().chain(samples()) {
        check_balance(law, &Rig::thesis(), 2.0);
        check_balance(law, &Rig { m2: f64::INFINITY, ..Rig::thesis() }, 2.0);
    }
}

/// The first impacts of a motion.
fn impacts(mut motion: impl Motion, count: usize) -> Vec<Impact> {
    let mut found = Vec::new();
    while found.len() < count {
        let until = motion.time() + 0.1;
        motion
            .advance(until, &mut |piece| {
                if let Event::Impact(impact) = piece.event {
                    found.push(impact);
                }
            })
            .unwrap();
    }
    found.truncate(count);
    found
}

#[test]
fn a_stiff_contact_approaches_the_rebound() {
    let rig = Rig::thesis();
    let drive = Sine { force: 0.5, frequency: 11.0 };
    let mut simulation = Simulation::new(&rig, &drive).unwrap();
    let mut hard = Vec::new();
    simulation.run(1.0, |leg| hard.extend(leg.impact())).unwrap();
    let mut before = f64::INFINITY;
    for stiffness in [1e6, 1e8, 1e10, 1e12] {
        let law = Law::kelvin_voigt(stiffness, rig.restitution, rig.reduced_mass()).unwrap();
        let soft = impacts(Compliant::new(&rig, &Excitation::Sine(drive), law, State::REST, 0.0).unwrap(), 8);
        let off = soft
            .iter()
            .zip(&hard)
            .map(|(s, h)| (s.approach_velocity - h.approach_velocity).abs())
            .fold(0.0, f64::max);
        // The difference is proportional to the contact's duration, which falls as 1/√k: tenfold for a
        // hundredfold stiffness.
        assert!(off < before / 5.0, "{stiffness}: {off} after {before}");
        // The forces outside the contact accelerate the masses by less than 20 m/s² during it.
        let lasts = conversion::duration(
            conversion::damping_ratio(rig.restitution).unwrap(),
            stiffness,
            rig.reduced_mass(),
        );
        let tolerance = 20.0 * lasts / hard[0].approach_velocity;
        assert!((soft[0].impulse / hard[0].impulse - 1.0).abs() < tolerance, "{stiffness}");
        before = off;
    }
    assert!(before < 1e-4, "{before}");
}

#[test]
fn an_isolated_contact_has_its_restitution_and_duration() {
    // Springs and dampers are so weak that only the contact acts.
    let rig = Rig { k1: 1e-12, k2: 1e-12, c1: 0.0, c2: 0.0, gap: 0.0, ..Rig::thesis() };
    let (mass, speed) = (rig.reduced_mass(), 0.3);
    let start = State { x1: -1e-3, v1: speed, ..State::REST };
    let rebound = |law: Law| {
        let mut motion = Compliant::new(&rig, &sine(0.0, 1.0), law, start, 0.0).unwrap();
        let (mut found, mut ends) = (None, 0.0);
        motion
            .advance(0.1, &mut |piece| match piece.event {
                Event::Impact(impact) => {
                    found = Some(impact);
                    ends = if ends == 0.0 { piece.start + piece.duration } else { ends };
                }
                Event::Part => ends = piece.start + piece.duration,
                _ => {}
            })
            .unwrap();
        let s = motion.state();
        (-s.approach() / speed, ends - found.unwrap().time, found.unwrap())
    };
    for r in [1.0, 0.9, 0.5, 0.2, 0.05] {
        let (found, duration, impact) = rebound(Law::kelvin_voigt(1e5, r, mass).unwrap());
        // The springs change the speed by 1e-12 N/m · 30 mm · 0.1 s/m₁ = 2e-14 m/s; integrated contacts have
        // relative errors of 1e-13 a step.
        assert!((found - r).abs() < 1e-11, "{r} {found}");
        let expected = conversion::duration(conversion::damping_ratio(r).unwrap(), 1e5, mass);
        assert!((duration - expected).abs() < 1e-12, "{r} {duration} {expected}");
        assert!((impact.impulse - mass * (1.0 + r) * speed).abs() < 1e-12, "{r}");
        for exponent in [1.0, 1.3, 1.5] {
            let law = Law::hunt_crossley(1e7, exponent, r, speed).unwrap();
            let (found, _, impact) = rebound(law);
            assert!((found - r).abs() < 1e-11, "{r} {exponent} {found}");
            assert!((impact.impulse - mass * (1.0 + r) * speed).abs() < 1e-12);
        }
    }
    let (found, duration, _) = rebound(Law::hertz(1e8));
    assert!((found - 1.0).abs() < 1e-11);
    // The contact ends where δ falls through 0 at the speed v: an error of 1e-13 of the largest δ, over v.
    assert!((duration / conversion::hertz_duration(1e8, mass, speed) - 1.0).abs() < 1e-11);
}

#[test]
fn hertz_agrees_with_a_plain_integration() {
    // Reference: the same equations with all forces, integrated from the beginning of a contact.
    let rig = Rig::thesis();
    let law = Law::hertz(1e8);
    let start = State { x1: 1e-3, v1: 0.4, x2: 0.0, v2: 0.1 };
    let mut motion = Compliant::new(&rig, &sine(0.5, 11.0), law, start, 0.3).unwrap();
    let omega = std::f64::consts::TAU * 11.0;
    let f = |t: f64, y: &[f64; 4]| {
        let push = law.force(y[0] - y[2] - rig.gap, y[1] - y[3]);
        let drive = 0.5 * (omega * t + 0.3).cos();
        [
            y[1],
            (drive - rig.k1 * y[0] - rig.c1 * y[1] - push) / rig.m1,
            y[3],
            (push - rig.k2 * y[2] - rig.c2 * y[3]) / rig.m2,
        ]
    };
    let tolerance = Tolerance { relative: 1e-14, floor: [1e-4, 0.3, 1e-4, 0.3] };
    let mut plain = Integrator::<Dop853, 4>::new(f, 0.0, [1e-3, 0.4, 0.0, 0.1], 1e-7, tolerance);
    while plain.time() < 0.02 {
        plain.step(f, 0.02).unwrap();
    }
    motion.advance(0.02, &mut |_| {}).unwrap();
    let s = motion.state();
    // Some hundred steps with errors of 1e-13 each.
    for (found, expected) in [s.x1, s.v1, s.x2, s.v2].iter().zip(plain.y()) {
        assert!((found - expected).abs() < 1e-11, "{s:?} {:?}", plain.y());
    }
}

#[test]
fn a_wall_is_a_very_heavy_mass() {
    let wall = Rig { m2: f64::INFINITY, ..Rig::thesis() };
    let heavy = Rig { m2: 1e12, k2: 1e6, ..Rig::thesis() };
    for law in [LAWS[0], LAWS[3]] {
        let first = impacts(Compliant::new(&wall, &sine(0.5, 9.0), law, State::REST, 0.0).unwrap(), 10);
        let second = impacts(Compliant::new(&heavy, &sine(0.5, 9.0), law, State::REST, 0.0).unwrap(), 10);
        for (a, b) in first.iter().zip(&second) {
            // The heavy mass moves by J t/m₂ = 1e-13 m, amplified from impact to impact.
            assert!((a.time - b.time).abs() < 1e-9, "{a:?} {b:?}");
        }
    }
    let off = State { x2: 1e-3, ..State::REST };
    assert!(Compliant::new(&wall, &sine(0.5, 9.0), LAWS[0], off, 0.0).is_err());
}

#[test]
fn pressed_masses_stay_together_until_they_part() {
    // Gap −0.5 mm: at rest the springs press the masses together, and under a small force they stay so.
    let rig = Rig { gap: -5e-4, ..Rig::thesis() };
    for law in LAWS.into_iter().chain(samples()) {
        // Equilibrium: both springs and the contact have the same force.
        let mut depth = 0.0;
        let mut start = State::REST;
        for _ in 0..50 {
            let force = (5e-4 - depth) / (1.0 / rig.k1 + 1.0 / rig.k2);
            depth = border(0.0, 5e-4, |depth| law.force(depth, 0.0) < force);
            start = State { x1: -force / rig.k1, x2: force / rig.k2, ..State::REST };
        }
        let mut motion = Compliant::new(&rig, &sine(1e-3, 5.0), law, start, 0.0).unwrap();
        let mut states = Vec::new();
        motion
            .advance(2.0, &mut |piece| {
                states.push(piece.path.state(piece.duration));
            })
            .unwrap();
        assert!(states.iter().all(|s| s.x1 - s.x2 > rig.gap), "{law:?}");
    }
}

#[test]
fn kicks_and_pulses_change_the_momentum() {
    let rig = Rig { gap: 1.0, c1: 0.0, ..Rig::thesis() };
    let omega = (rig.k1 / rig.m1).sqrt();
    let kick = Excitation::Impulse(Impulses { impulse: 0.01, frequency: 4.0 });
    let mut motion = Compliant::new(&rig, &kick, LAWS[0], State::REST, 0.0).unwrap();
    let mut kicks = 0;
    motion.advance(0.3, &mut |piece| kicks += usize::from(piece.event == Event::Kick)).unwrap();
    assert_eq!(kicks, 2);
    let v = 0.01 / rig.m1;
    let exact = v / omega * ((omega * 0.3).sin() + (omega * 0.05).sin());
    assert!((motion.state().x1 - exact).abs() < 1e-15, "{:?} {exact}", motion.state());
    let pulse = Excitation::Pulse(Pulses { force: 1.0, width: 0.01, frequency: 4.0 });
    let mut motion = Compliant::new(&rig, &pulse, LAWS[0], State::REST, 0.0).unwrap();
    let mut switches = 0;
    motion.advance(0.2, &mut |piece| switches += usize::from(piece.event == Event::Switch)).unwrap();
    // The pulse begins and ends.
    assert_eq!(switches, 2);
    // (F/k)(cos ω(t − w) − cos ωt).
    let exact = ((omega * 0.19).cos() - (omega * 0.2).cos()) / rig.k1;
    assert!((motion.state().x1 - exact).abs() < 1e-15, "{:?} {exact}", motion.state());
}

#[test]
fn cutting_a_motion_changes_nothing_and_impossible_ones_are_refused() {
    let rig = Rig::thesis();
    for law in LAWS.into_iter().chain(samples()) {
        let make = || Compliant::new(&rig, &sine(0.5, 11.0), law, State::REST, 0.0).unwrap();
        let (mut whole, mut cut) = (make(), make());
        whole.advance(1.0, &mut |_| {}).unwrap();
        for i in 1..=1000 {
            cut.advance(f64::from(i) * 1e-3, &mut |_| {}).unwrap();
        }
        let (a, b) = (whole.state(), cut.state());
        assert_eq!(whole.time(), cut.time());
        // Interrupted contacts are integrated with other steps, each with an error of 1e-13.
        assert!((a.x1 - b.x1).abs() < 1e-11 && (a.v2 - b.v2).abs() < 1e-9, "{law:?} {a:?} {b:?}");
        assert!(whole.advance(0.5, &mut |_| {}).is_err());
        assert!(whole.advance(f64::NAN, &mut |_| {}).is_err());
        assert!(whole.advance(1e12, &mut |_| {}).is_err());
        assert!(whole.set_frequency(0.0).is_err());
    }
    let new = |rig: &Rig, law, state| Compliant::new(rig, &sine(0.5, 11.0), law, state, 0.0);
    assert!(new(&rig, Law::hertz(0.0), State::REST).is_err());
    assert!(new(&Rig { m1: -1.0, ..rig }, LAWS[0], State::REST).is_err());
    assert!(new(&Rig { k1: 0.0, ..rig }, LAWS[0], State::REST).is_err());
    assert!(new(&rig, LAWS[0], State { x1: f64::NAN, ..State::REST }).is_err());
}

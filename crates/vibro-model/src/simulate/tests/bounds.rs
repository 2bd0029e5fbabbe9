//! The work of a simulation is bounded for any input; masses that rest, press or part do not stop time.

use super::*;
use crate::excitation::{Impulses, Pulses};

#[test]
fn a_thousand_million_cycles_are_refused_at_once() {
    let mut motion = scene_b();
    let text = motion.run(1e9 / motion.frequency(), |_| {}).unwrap_err().to_string();
    assert!(text.contains("1.000e9 cycles"), "{text}");
    assert_eq!(motion.time(), 0.0);
}

#[test]
fn zeno_scenes_take_bounded_work() {
    // Restitutions and gaps with accumulating impacts, contact at rest, or masses pressed together.
    for restitution in [0.0, 1e-9, 0.1, 0.5, 0.9, 0.99, 0.999, 1.0] {
        for gap in [0.0, -1e-4, -5e-4, 1e-9] {
            let rig = Rig { restitution, gap, c1: 0.4, c2: 0.4, ..Rig::thesis() };
            for (force, frequency) in [(0.35, 2.3), (0.01, 5.0), (0.5, 9.0), (0.0, 1.0)] {
                let mut motion = Simulation::new(&rig, &Sine { force, frequency }).unwrap();
                motion.run(10.0, |leg| assert!(leg.duration >= 0.0)).unwrap();
                let flights = motion.counts().flights;
                // Each impact reduces the speed by R, from 1 m/s to rounding, 1e-9 m/s, at most some times a
                // cycle. Without loss, bounces between two phases of pressing become rarer as their speed
                // grows.
                assert!(flights < 2_000_000, "{rig:?} {force} N: {flights} flights");
                assert_eq!(motion.time(), 10.0);
                let State { x1, x2, .. } = motion.state();
                assert!(x1 - x2 - gap < 1e-15, "overlap in {rig:?}");
            }
        }
    }
}

#[test]
fn masses_pressed_together_at_rest_stay_so() {
    let rig = Rig { gap: -5e-4, ..Rig::thesis() };
    // The contact force is k₁k₂·0.5 mm/(k₁ + k₂) = 0.033 N.
    let mut motion = Simulation::new(&rig, &Sine { force: 0.0, frequency: 5.0 }).unwrap();
    assert_eq!(motion.hold, Hold::Together);
    motion.run(3.0, |leg| assert_eq!(leg.event, Event::Reached)).unwrap();
    let at_rest = rig.k2 * rig.gap / (rig.k1 + rig.k2);
    assert!((motion.state().x1 - at_rest).abs() < 1e-18 && motion.state().v1.abs() < 1e-17);
    // A force too small to lift mass 1 off: the contact force varies by less than 0.033 N.
    let mut motion = Simulation::new(&rig, &Sine { force: 0.004, frequency: 2.0 }).unwrap();
    motion.run(30.0, |leg| assert_eq!(leg.event, Event::Reached)).unwrap();
    assert_eq!(motion.hold, Hold::Together);
}

#[test]
fn a_release_is_followed_by_a_free_flight() {
    // After each release the gap opens like t³: neither rounding nor interruptions may cause the next
    // impact.
    for cut in [1e-12, 1e-9, 1e-6, 1e-4, 1.0] {
        let mut motion = scene_c();
        let (mut released, mut checked) = (None, 0);
        while motion.time() < 3.0 {
            let until = if released.is_some() { motion.time() + cut } else { 3.0 };
            let leg = motion.fly(until.min(3.0)).unwrap();
            let end = leg.start + leg.duration;
            match leg.event {
                Event::Release => released = Some(end),
                Event::Impact(impact) => {
                    if let Some(from) = released.take() {
                        assert!(end - from > 1e-2 && impact.approach_velocity > 1e-3, "{from} {impact:?}");
                        checked += 1;
                    }
                }
                Event::Reached if end - released.unwrap_or(end) > 300.0 * cut => {
                    // After enough interruptions, continues to the impact.
                    let leg = motion.fly(4.0).unwrap();
                    assert!(leg.impact().unwrap().approach_velocity > 1e-3);
                    released = None;
                    checked += 1;
                }
                _ => {}
            }
        }
        assert!(checked >= 3, "{checked}");
    }
}

#[test]
fn kicks_and_steps_part_what_is_pressed_together() {
    let rig = Rig { gap: -5e-4, c1: 0.4, c2: 0.4, ..Rig::thesis() };
    let events = |excitation: Excitation| {
        let mut motion = Simulation::new(&rig, &excitation).unwrap();
        let mut events = Vec::new();
        motion.run(0.19, |leg| events.push(leg.event)).unwrap();
        events
    };
    // A pull parts the masses; a push causes an impact at once: J = M(1 + R)F/m₁.
    let pulled = events(Excitation::Impulse(Impulses { impulse: -0.004, frequency: 5.0 }));
    assert!(pulled[0] == Event::Kick && matches!(pulled[1], Event::Impact(i) if i.time > 1e-3), "{pulled:?}");
    let pushed = events(Excitation::Impulse(Impulses { impulse: 0.004, frequency: 5.0 }));
    let Event::Impact(first) = pushed[1] else { panic!("{pushed:?}") };
    let expected = rig.reduced_mass() * (1.0 + rig.restitution) * 0.004 / rig.m1;
    // A velocity of 0.03 m/s, with a rounding of each product.
    assert!((first.impulse / expected - 1.0).abs() < 1e-14 && first.time < 1e-15, "{first:?}");
    // A step of P changes the contact force of 0.033 N at once by Pm₂/(m₁ + m₂): −0.2 N parts the masses,
    // −0.01 N does not.
    let strong = events(Excitation::Pulse(Pulses { force: -0.2, width: 0.05, frequency: 5.0 }));
    assert_eq!(strong[..2], [Event::Switch, Event::Release], "{strong:?}");
    let weak = events(Excitation::Pulse(Pulses { force: -0.01, width: 0.05, frequency: 5.0 }));
    assert_eq!(weak[0], Event::Switch);
    assert!(!weak.contains(&Event::Release), "{weak:?}");
}

#[test]
fn a_start_at_a_phase_is_a_start_under_way() {
    // Continues a motion after half a cycle, and compares it with one started at phase π in the same state.
    for excitation in [
        Excitation::Impulse(Impulses { impulse: 0.009, frequency: 5.7 }),
        Excitation::Pulse(Pulses { force: 0.5, width: 0.12, frequency: 5.7 }),
    ] {
        let mut whole = Simulation::new(&Rig::thesis(), &excitation).unwrap();
        let half = 0.5 / 5.7;
        whole.run(half, |_| {}).unwrap();
        let mut later =
            Simulation::from_state(&Rig::thesis(), &excitation, whole.state(), whole.phase()).unwrap();
        whole.run(half + 0.3, |_| {}).unwrap();
        later.run(0.3, |_| {}).unwrap();
        let (a, b) = (whole.state(), later.state());
        // Times near 0.4 s are rounded to 1e-16 s, at speeds below 1 m/s, over a few impacts.
        assert!((a.x1 - b.x1).abs() < 1e-14 && (a.v2 - b.v2).abs() < 1e-13, "{a:?} {b:?}");
    }
}

#[test]
fn grazing_is_counted() {
    // The linear motion grazes at ν 2.168715614919 for 0.5 N: slightly below, mass 1 touches at very low
    // speed.
    let rig = Rig::thesis();
    let frequency = 2.168_715_614 * (rig.k1 / rig.m1).sqrt() / TAU;
    let sine = Sine { force: 0.5, frequency };
    let steady = crate::Steady::new(&rig, &sine).unwrap();
    let forced = steady.response;
    // Start on the linear motion, half a cycle before its crest.
    let phase = -forced.arg() + TAU / 2.0;
    let state = State { x1: -forced.norm(), ..State::REST };
    let mut motion = Simulation::from_state(&rig, &sine, state, phase).unwrap();
    let leg = motion.fly(1.0).unwrap();
    let impact = leg.impact().unwrap();
    assert!(impact.approach_velocity < GRAZING_SPEED, "{impact:?}");
    assert_eq!(motion.counts().grazing, 1);
    let mut strict = Simulation::from_state(&rig, &sine, state, phase).unwrap().grazing_below(1e-9);
    strict.fly(1.0).unwrap();
    assert_eq!(strict.counts().grazing, 0);
}

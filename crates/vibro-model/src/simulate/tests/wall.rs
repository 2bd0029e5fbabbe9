//! Mass 2 as a wall: the limit of a huge mass on a huge spring, and masses pressed against it.

use crate::excitation::{Excitation, Pulses, Sine};
use crate::flow::State;
use crate::motion::Event;
use crate::motion::Motion;
use crate::rig::Rig;
use crate::simulate::Simulation;

const WALL: Rig =
    Rig { m1: 0.125, m2: f64::INFINITY, k1: 135.0, k2: 0.0, c1: 0.1, c2: 0.0, gap: 1e-4, restitution: 0.2 };

/// Events other than impacts with their times (s), and the last state.
fn events(rig: &Rig, excitation: &Excitation, until: f64) -> (Vec<(Event, f64)>, State) {
    let mut motion = Simulation::new(rig, excitation).unwrap();
    let mut found = Vec::new();
    motion
        .run(until, |leg| {
            let event = match leg.event {
                Event::Impact(_) => return,
                other => other,
            };
            found.push((event, leg.start + leg.duration));
        })
        .unwrap();
    (found, motion.state())
}

#[test]
fn a_mass_pressed_against_a_wall_is_let_go_where_the_force_is_that_of_its_spring() {
    for restitution in [0.0, 0.2, 0.7] {
        for gap in [1e-4, 0.0, -1e-3] {
            let rig = Rig { gap, restitution, ..WALL };
            let sine = Sine { force: 0.5, frequency: 0.8 };
            let (found, state) = events(&rig, &sine.into(), 5.0);
            let releases: Vec<f64> = found.iter().filter(|e| e.0 == Event::Release).map(|e| e.1).collect();
            // Release where F cos ωt = k₁Δ.
            let first = (rig.k1 * gap / sine.force).acos() / sine.omega();
            assert_eq!(releases.len(), 4, "{gap} {restitution}: {found:?}");
            for (n, time) in releases.iter().enumerate() {
                let exact = first + n as f64 / sine.frequency;
                // Rounding of a force of 0.5 N that falls at 2.5 N/s.
                assert!((time - exact).abs() < 1e-14, "{gap} {restitution}: {time} {exact}");
            }
            assert_eq!((state.x2, state.v2), (0.0, 0.0));
        }
    }
}

#[test]
fn a_wall_is_the_limit_of_a_huge_mass_on_a_huge_spring() {
    for excitation in [
        Excitation::Sine(Sine { force: 0.5, frequency: 0.8 }),
        Excitation::Pulse(Pulses { force: 0.5, width: 0.5, frequency: 0.8 }),
    ] {
        for gap in [1e-4, -1e-3] {
            let rig = Rig { gap, ..WALL };
            let huge = Rig { m2: 1e9, k2: 1e10, ..rig };
            let ((ours, a), (theirs, b)) = (events(&rig, &excitation, 3.0), events(&huge, &excitation, 3.0));
            assert_eq!(ours.len(), theirs.len(), "{gap} {ours:?} {theirs:?}");
            for (one, other) in ours.iter().zip(&theirs) {
                // The huge spring moves by F/k₂ = 5e-11 m (7e-9 N of the other spring), and its force is
                // rounded to 8εk₂Δ = 2e-8 N, where the contact force falls at 2.5 N/s.
                assert!(one.0 == other.0 && (one.1 - other.1).abs() < 1e-7, "{one:?} {other:?}");
            }
            assert!((a.x1 - b.x1).abs() < 1e-7 && (a.v1 - b.v1).abs() < 1e-5, "{a:?} {b:?}");
        }
    }
}

#[test]
fn a_wall_stays_where_it_is() {
    let sine = Sine { force: 0.5, frequency: 0.8 };
    for state in [State { x2: 0.01, ..State::REST }, State { v2: 0.01, ..State::REST }] {
        let text = Simulation::from_state(&WALL, &sine, state, 0.0).unwrap_err().to_string();
        assert!(text.starts_with("mass 2 is a wall"), "{text}");
    }
    let pressed = Rig { gap: -1e-3, k2: f64::NAN, ..WALL };
    assert_eq!(Simulation::at_rest(&pressed), State { x1: -1e-3, ..State::REST });
}

#[test]
fn a_pulse_that_ends_within_a_chatter_lets_go_at_once() {
    let rig = Rig { restitution: 0.7, ..WALL };
    let pulse = |width| Excitation::Pulse(Pulses { force: 0.5, width, frequency: 0.5 });
    // A chatter with a computed end, under a pulse that continues.
    let mut motion = Simulation::new(&rig, &pulse(1.9)).unwrap();
    let mut within = None;
    motion
        .run(1.8, |leg| {
            if leg.event == Event::Stick && leg.duration > 1e-9 && within.is_none() {
                within = Some((leg.start, leg.duration));
            }
        })
        .unwrap();
    let (start, duration) = within.unwrap();
    let end = start + 0.5 * duration;
    // After the pulse the spring pulls mass 1 off the wall.
    let mut motion = Simulation::new(&rig, &pulse(end)).unwrap();
    let mut found = Vec::new();
    motion.run(end + duration, |leg| found.push((leg.event, leg.start + leg.duration))).unwrap();
    let n = found.iter().position(|e| e.0 == Event::Switch && e.1 > 0.0).unwrap();
    assert!((found[n].1 - end).abs() < 1e-15, "{found:?}");
    // Nothing presses mass 1 any more: there is no lasting contact, and no later release.
    let rests = |e: &(Event, f64)| matches!(e.0, Event::Stick | Event::Release);
    assert!(!found[n + 1..].iter().any(rests), "{:?}", &found[n..]);
}

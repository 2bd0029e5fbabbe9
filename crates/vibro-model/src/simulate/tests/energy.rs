//! Energy balance under every kind of excitation, with and without lasting contact.

use super::*;
use crate::excitation::{Impulses, Part, Pulses, Sines};

/// Energy of both masses and springs in J.
fn energy(rig: &Rig, s: &State) -> f64 {
    (rig.m1 * s.v1.powi(2) + rig.k1 * s.x1.powi(2) + rig.m2 * s.v2.powi(2) + rig.k2 * s.x2.powi(2)) / 2.0
}

/// Follows a motion to `until` (s) and compares the energy from force, dampers, impacts and kicks with the
/// change of energy; returns the events.
fn balance(mut motion: Simulation, force: impl Fn(f64) -> f64, kick: f64, until: f64) -> Vec<Event> {
    let rig = *motion.rig();
    let start = energy(&rig, &motion.state());
    let (mut put_in, mut passed) = (0.0, start);
    let mut events = Vec::new();
    loop {
        let before = motion.state();
        let leg = motion.fly(until).unwrap();
        // Composite Gauss-Legendre with three points on 128 panels.
        let panel = leg.duration / 128.0;
        // Sixth order: the error (h·ω)⁷ of a leg is below 1e-13 of its energy for legs shorter than a period
        // of the fastest term.
        assert!(leg.duration < 0.5);
        let node = 0.6_f64.sqrt() / 2.0;
        let mut quadrature = |power: &dyn Fn(f64) -> f64| {
            let sum: f64 = (0..128)
                .map(|i| {
                    let middle = (f64::from(i) + 0.5) * panel;
                    panel / 18.0
                        * (5.0 * power(middle - node * panel)
                            + 8.0 * power(middle)
                            + 5.0 * power(middle + node * panel))
                })
                .sum();
            put_in += sum;
            passed += sum.abs();
        };
        quadrature(&|t| force(leg.start + t) * leg.state(t).v1);
        quadrature(&|t| -rig.c1 * leg.state(t).v1.powi(2) - rig.c2 * leg.state(t).v2.powi(2));
        match leg.event {
            Event::Impact(impact) => {
                let lost = 1.0 - rig.restitution.powi(2);
                put_in -= rig.reduced_mass() * lost * impact.approach_velocity.powi(2) / 2.0;
                // The last bounces of a chatter are not simulated: their energy is lost as well.
                let after = motion.state().approach();
                if after == 0.0 {
                    put_in -= rig.reduced_mass() * (rig.restitution * impact.approach_velocity).powi(2) / 2.0;
                }
            }
            Event::Kick => {
                let v = leg.state(leg.duration).v1;
                put_in += kick * v + kick * kick / (2.0 * rig.m1);
                passed += (kick * v).abs();
            }
            _ => {}
        }
        // A leg starts where the previous one ended.
        let first = leg.state(0.0);
        assert!((first.x1 - before.x1).abs() < 1e-15 && (first.v2 - before.v2).abs() < 1e-14);
        events.push(leg.event);
        if leg.event == Event::Reached {
            break;
        }
    }
    let error = put_in - (energy(&rig, &motion.state()) - start);
    assert!(error.abs() < 1e-10 * passed, "{error:e} J of {passed:e} J over {} events", events.len());
    events
}

fn count(events: &[Event], is: impl Fn(&Event) -> bool) -> usize {
    events.iter().filter(|e| is(e)).count()
}

fn impact(event: &Event) -> bool {
    matches!(event, Event::Impact(_))
}

/// Rigs that bounce, that stick at the first impact, and that chatter.
fn rigs() -> [Rig; 4] {
    let rig = Rig { c1: 0.4, ..Rig::thesis() };
    [
        rig,
        Rig { restitution: 0.0, ..rig },
        Rig { gap: -5e-4, restitution: 0.5, ..rig },
        Rig { gap: 0.0, restitution: 0.9, ..rig },
    ]
}

#[test]
fn energy_balances_under_one_and_several_sines() {
    let (mut sticks, mut impacts) = (0, 0);
    for rig in rigs() {
        for frequency in [2.3, 5.0, 9.0] {
            let sine = Sine { force: 0.5, frequency };
            let force = |t: f64| 0.5 * (TAU * frequency * t).cos();
            let events = balance(Simulation::new(&rig, &sine).unwrap(), force, 0.0, 8.0);
            sticks += count(&events, |e| *e == Event::Stick);
            impacts += count(&events, impact);
        }
        let parts = vec![
            Part { force: 0.3, frequency: 4.1, phase: 0.4 },
            Part { force: 0.2, frequency: 7.3, phase: -2.0 },
            Part { force: 0.1, frequency: 11.0, phase: 0.0 },
            Part { force: 0.05, frequency: 1.0, phase: 3.0 },
        ];
        let force =
            |t: f64| -> f64 { parts.iter().map(|p| p.force * (TAU * p.frequency * t + p.phase).cos()).sum() };
        let sines = Excitation::Sines(Sines { parts: parts.clone() });
        let events = balance(Simulation::new(&rig, &sines).unwrap(), force, 0.0, 8.0);
        sticks += count(&events, |e| *e == Event::Stick);
        impacts += count(&events, impact);
    }
    assert!(sticks > 20 && impacts > 500, "{sticks} {impacts}");
}

#[test]
fn energy_balances_under_impulses() {
    let (mut sticks, mut impacts) = (0, 0);
    for rig in rigs() {
        for (impulse, frequency) in [(0.009, 5.7), (-0.005, 4.1), (0.02, 3.3)] {
            let train = Excitation::Impulse(Impulses { impulse, frequency });
            let events = balance(Simulation::new(&rig, &train).unwrap(), |_| 0.0, impulse, 8.0);
            // One kick at the start, then one a cycle.
            assert_eq!(count(&events, |e| *e == Event::Kick), 1 + (8.0 * frequency) as usize);
            sticks += count(&events, |e| *e == Event::Stick);
            impacts += count(&events, impact);
        }
    }
    assert!(sticks > 20 && impacts > 300, "{sticks} {impacts}");
}

#[test]
fn energy_balances_under_pulses() {
    let (mut sticks, mut impacts) = (0, 0);
    for rig in rigs() {
        for (force, width, frequency) in [(0.5, 0.01, 5.7), (0.8, 0.1, 3.0), (-0.4, 0.05, 4.1)] {
            let train = Excitation::Pulse(Pulses { force, width, frequency });
            let on = |t: f64| if (t * frequency).fract() < width * frequency { force } else { 0.0 };
            let events = balance(Simulation::new(&rig, &train).unwrap(), on, 0.0, 8.05);
            assert_eq!(
                count(&events, |e| *e == Event::Switch),
                1 + (8.05 * frequency) as usize + ((8.05 - width) * frequency) as usize + 1
            );
            sticks += count(&events, |e| *e == Event::Stick);
            impacts += count(&events, impact);
        }
    }
    assert!(sticks > 20 && impacts > 300, "{sticks} {impacts}");
}

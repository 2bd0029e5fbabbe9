use super::*;
use crate::excitation::Sine;
use crate::rig::Rig;
use crate::simulate::Simulation;

fn of(rig: &Rig, force: f64, frequency: f64, settle: u32, cycles: u32) -> Pattern {
    let mut motion = Simulation::new(rig, &Sine { force, frequency }).unwrap();
    regime(&mut motion, settle, cycles).unwrap()
}

#[test]
fn one_impact_a_cycle_none_and_a_doubled_pattern_are_told_apart() {
    let rig = Rig::thesis();
    let one = of(&rig, 0.5, 11.0, 1500, 64);
    assert_eq!(one.regime, Regime::Periodic { impacts: 1, cycles: 1 });
    assert!(one.settled && one.strikes.len() == 1, "{one:?}");
    // A = 0.01/(0.125·(2π·20)² − 135) = 5 µm is below the gap.
    assert_eq!(of(&rig, 0.01, 20.0, 100, 64).regime, Regime::NoImpact);
    // Reference: for F₀ 0.9 N, R 1, ν 1.2 one impact a cycle is unstable by a flip (multiplier −1.33).
    let frequency = 1.2 * (rig.k1 / rig.m1).sqrt() / TAU;
    let flipped = of(&Rig { restitution: 1.0, ..rig }, 0.9, frequency, 1500, 200);
    assert_ne!(flipped.regime, Regime::Periodic { impacts: 1, cycles: 1 }, "{flipped:?}");
}

#[test]
fn a_pattern_is_named_while_it_still_settles() {
    // Scene B: the largest multiplier is −0.9703, so over 100 cycles differences fall only to 5 %.
    let rig = Rig::thesis();
    let frequency = 2.1 * (rig.k1 / rig.m1).sqrt() / TAU;
    let found = of(&rig, 0.5, frequency, 120, 100);
    assert_eq!(found.regime, Regime::Periodic { impacts: 1, cycles: 1 });
    assert!(!found.settled && found.distance.unwrap() > SAME, "{found:?}");
}

/// The largest multipliers at 11.2 Hz are −0.957 ± 0.061i: impacts alternate about one, and their difference
/// beats with a period of 49 cycles, longer than a third of the cycles watched.
#[test]
fn impacts_that_alternate_ever_less_are_one() {
    for settle in [120, 180, 240, 300] {
        let found = of(&Rig::thesis(), 0.5, 11.2, settle, 60);
        assert_eq!(found.regime, Regime::Periodic { impacts: 1, cycles: 1 }, "{settle}: {found:?}");
    }
}

#[test]
fn differences_that_do_not_fall_are_no_pattern() {
    // Phases of a logistic map at 4 (chaotic), and of a circle map with an irrational rotation.
    let mut watch =
        Watch::new(&Simulation::new(&Rig::thesis(), &Sine { force: 0.5, frequency: 1.0 }).unwrap());
    let strike = |i: u32, phase: f64| Strike {
        time: f64::from(i),
        phase,
        before: State { v1: 1.0, ..State::REST },
        impulse: 1.0,
        approach_velocity: 1.0,
    };
    let mut x = 0.3_f64;
    for i in 0..300 {
        x = 4.0 * x * (1.0 - x);
        watch.strikes.push_back(strike(i, x));
    }
    watch.now = 300.0;
    assert_eq!(watch.pattern().regime, Regime::Irregular);
    watch.strikes.clear();
    for i in 0..300 {
        watch.strikes.push_back(strike(i, 1.0 + 1e-3 * (f64::from(i) * 2.0_f64.sqrt()).sin()));
    }
    assert_eq!(watch.pattern().regime, Regime::Irregular);
    // Two alternating values, 1e-5 apart, are a pattern of two; if they approach each other, a pattern of
    // one.
    for (shrink, impacts) in [(1.0_f64, 2), (0.97, 1)] {
        watch.strikes.clear();
        for i in 0..300_i32 {
            let size = 1e-5 * 2.0_f64.powf(if shrink < 1.0 { 5.0 } else { 0.0 }) * shrink.powi(i);
            let side = if i % 2 == 0 { 1.0 } else { -1.0 };
            watch.strikes.push_back(strike(i as u32, 1.0 + TAU * size * side));
        }
        let expected = Regime::Periodic { impacts, cycles: impacts };
        assert_eq!(watch.pattern().regime, expected, "{shrink}");
    }
}

#[test]
fn a_regime_is_a_word_and_a_pattern_its_two_numbers() {
    let pattern = Regime::Periodic { impacts: 3, cycles: 2 };
    assert_eq!(pattern.to_string(), "3/2");
    assert_eq!(Regime::Chatter { cycles: Some(2) }.to_string(), "chatter/2");
    assert_eq!(serde_json::to_string(&pattern).unwrap(), r#"{"impacts":3,"cycles":2}"#);
    assert_eq!(serde_json::to_string(&Regime::Irregular).unwrap(), r#""irregular""#);
}

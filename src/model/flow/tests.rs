use super::*;
use crate::model::{Rig, Sine};

/// splitmix64, uniform in 0..1.
fn uniform(seed: &mut u64) -> f64 {
    *seed = seed.wrapping_add(0x9E37_79B9_7F4A_7C15);
    let mut z = *seed;
    z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    ((z ^ (z >> 31)) >> 11) as f64 * f64::powi(2.0, -53)
}

fn random(seed: &mut u64) -> Flight {
    let c = [0.0, 0.1, 1.0, 8.3, 30.0][(uniform(seed) * 5.0) as usize];
    let rig = Rig { c1: c, c2: uniform(seed), gap: 8e-3 * uniform(seed), ..Rig::thesis() };
    let sine = Sine { force: 0.5 * uniform(seed), frequency: 2.0 + 14.0 * uniform(seed) };
    let mut signed = |scale: f64| scale * (2.0 * uniform(seed) - 1.0);
    let (x1, v1, v2, phase) = (signed(3e-3), signed(0.2), signed(0.2), signed(3.1));
    // Start at contact or a little apart.
    let x2 = x1 - rig.gap + signed(1e-3).max(0.0);
    let steady = Steady::new(&rig, &sine).unwrap();
    Flight::new(rig.oscillators(), &steady, rig.gap, &State { x1, v1, x2, v2 }, phase)
}

#[test]
fn a_flight_obeys_its_equation_of_motion() {
    // Central differences of the state against the forces: m ẍ + c ẋ + k x = F₀ cos(ωt + θ).
    let rig = Rig { c1: 0.8, ..Rig::thesis() };
    let sine = Sine { force: 0.5, frequency: 9.0 };
    let steady = Steady::new(&rig, &sine).unwrap();
    let start = State { x1: 1e-3, v1: -0.1, x2: 2e-3, v2: 0.3 };
    let flight = Flight::new(rig.oscillators(), &steady, rig.gap, &start, 0.7);
    let again = flight.state(0.0);
    assert!((again.x1 - start.x1).abs() < 1e-17 && (again.v1 - start.v1).abs() < 1e-16);
    assert_eq!((again.x2, again.v2), (start.x2, start.v2));
    let h = 1e-5;
    for t in [0.01, 0.05, 0.2, 1.0] {
        let (before, here, after) = (flight.state(t - h), flight.state(t), flight.state(t + h));
        let [_, a1, _, a2] = flight.rate(t);
        // Truncation h²/6 · ω³v (ω up to 57 rad/s, v up to 0.5 m/s), rounding ε v/h.
        let tolerance = h * h / 6.0 * 57_f64.powi(3) * 0.5 + f64::EPSILON * 0.5 / h;
        assert!(((after.v1 - before.v1) / (2.0 * h) - a1).abs() < tolerance);
        assert!(((after.x2 - before.x2) / (2.0 * h) - here.v2).abs() < tolerance);
        let force = 0.5 * (sine.omega() * t + 0.7).cos();
        // Rounding of terms up to 0.5 N.
        assert!((rig.m1 * a1 + rig.c1 * here.v1 + rig.k1 * here.x1 - force).abs() < 1e-14);
        assert!((rig.m2 * a2 + rig.c2 * here.v2 + rig.k2 * here.x2).abs() < 1e-14);
    }
}

#[test]
fn the_curvature_bound_is_never_exceeded() {
    let mut seed = 11;
    for _ in 0..50 {
        let flight = random(&mut seed);
        for order in 0..2 {
            let bound = flight.bounded(Signal::Gap, order, 0.0).curvature;
            for i in 0..500 {
                let next = flight.bounded(Signal::Gap, order + 1, f64::from(i) * 1e-3);
                assert!(next.slope.abs() <= bound * (1.0 + 1e-12));
                assert!(
                    flight.bounded(Signal::Gap, order, f64::from(i) * 1e-3).curvature
                        <= bound * (1.0 + 1e-12)
                );
            }
        }
    }
}

#[test]
fn no_contact_is_missed_in_random_flights() {
    // Dense sampling as the oracle: 20 µs apart, where the gap's frequencies are below 16 Hz.
    let (mut seed, duration, dt) = (2_024, 0.5, 2e-5);
    let (mut hits, mut free) = (0, 0);
    for run in 0..400 {
        let flight = random(&mut seed);
        let found = flight.first_contact(duration);
        // A start at contact belongs to the impact before if the masses part.
        let from = u32::from(
            flight.gap(0.0).abs() < flight.noise() && flight.bounded(Signal::Gap, 0, 0.0).slope > 0.0,
        );
        let sampled = (from..=25_000_u32).map(|i| f64::from(i) * dt).find(|t| flight.gap(*t) <= 0.0);
        match (found, sampled) {
            (Some(t), Some(s)) => {
                // Never later than the first sample in contact; earlier by more than one sample only if the gap
                // opened again in between.
                assert!(t <= s, "flight {run}: {t} {s}");
                let dipped = (0..=25_000).map(|i| f64::from(i) * dt).find(|s| *s >= t).map(|s| flight.gap(s));
                assert!(s - t <= dt || dipped.is_some_and(|g| g > 0.0), "flight {run}: {t} {s}");
                hits += 1;
            }
            (None, None) => free += 1,
            // Sampling may miss a dip between two samples, the search may not miss a sampled contact.
            (Some(_), None) => hits += 1,
            (None, Some(s)) => panic!("flight {run}: contact at {s} was missed"),
        }
        if let Some(t) = found {
            let slope = flight.bounded(Signal::Gap, 0, t).slope;
            // Rounding of the gap, and of the time times the speed.
            let tolerance = 4.0 * flight.noise() + f64::EPSILON * duration * slope.abs();
            assert!(flight.gap(t).abs() <= tolerance, "flight {run}: gap {} at {t}", flight.gap(t));
        }
    }
    assert!(hits > 100 && free > 20, "{hits} contacts, {free} free flights: both kinds must occur");
}

#[test]
fn ranges_hold_every_sample_and_no_more() {
    let mut seed = 5;
    for _ in 0..100 {
        let flight = random(&mut seed);
        for signal in [Signal::Gap, Signal::X1, Signal::X2] {
            let (low, high) = flight.range(signal, 0.3);
            let samples = (0..=30_000).map(|i| flight.bounded(signal, 0, f64::from(i) * 1e-5).value);
            let (mut least, mut most) = (f64::INFINITY, f64::NEG_INFINITY);
            for value in samples {
                least = least.min(value);
                most = most.max(value);
            }
            // A crest between two samples is missed by at most M(5 µs)²/2.
            let missed = flight.bounded(signal, 0, 0.0).curvature * 5e-6_f64.powi(2) / 2.0 + flight.noise();
            let rounding = 2.0 * flight.noise();
            assert!(low <= least + rounding && least - low <= missed, "{low} {least}");
            assert!(high >= most - rounding && high - most <= missed, "{high} {most}");
        }
    }
}

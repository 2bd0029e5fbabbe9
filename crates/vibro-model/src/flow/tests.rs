//! Flights in closed form against their equation of motion and against contacts found by dense sampling.

use super::*;
use crate::excitation::Sine;
use crate::rig::Rig;
use crate::steady::Steady;
use num_complex::Complex64;
use std::f64::consts::TAU;
use vibro_math::Noise;

/// Flight from `state`, the force being F₀ cos(ωt + `phase`), across a rest gap `gap` in m.
pub(crate) fn flight(rig: &Rig, steady: &Steady, gap: f64, state: &State, phase: f64) -> Flight {
    let mut waves = Waves::default();
    waves.add(steady.response * Complex64::cis(phase), steady.omega, steady.amplitude());
    Flight::with(rig.oscillators(), waves, 0.0, gap, state)
}

/// Time in s of the first contact within `duration` (s).
pub(crate) fn first_contact(flight: &Flight, duration: f64) -> Option<f64> {
    flight.land(duration).map(|landing| landing.time)
}

fn random(noise: &mut Noise) -> Flight {
    let c = [0.0, 0.1, 1.0, 8.3, 30.0][(noise.uniform() * 5.0) as usize];
    let rig = Rig { c1: c, c2: noise.uniform(), gap: 8e-3 * noise.uniform(), ..Rig::thesis() };
    let sine = Sine { force: 0.5 * noise.uniform(), frequency: 2.0 + 14.0 * noise.uniform() };
    let mut signed = |scale: f64| scale * (2.0 * noise.uniform() - 1.0);
    let (x1, v1, v2, phase) = (signed(3e-3), signed(0.2), signed(0.2), signed(3.1));
    // Start at contact or a little apart.
    let x2 = x1 - rig.gap + signed(1e-3).max(0.0);
    let steady = Steady::new(&rig, &sine).unwrap();
    flight(&rig, &steady, rig.gap, &State { x1, v1, x2, v2 }, phase)
}

#[test]
fn a_flight_obeys_its_equation_of_motion() {
    // Central differences of the state against the forces: m ẍ + c ẋ + k x = F₀ cos(ωt + θ).
    let rig = Rig { c1: 0.8, ..Rig::thesis() };
    let sine = Sine { force: 0.5, frequency: 9.0 };
    let steady = Steady::new(&rig, &sine).unwrap();
    let start = State { x1: 1e-3, v1: -0.1, x2: 2e-3, v2: 0.3 };
    let flight = flight(&rig, &steady, rig.gap, &start, 0.7);
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
    let mut noise = Noise::new(11);
    for _ in 0..50 {
        let flight = random(&mut noise);
        let (bounds, _) = flight.limits(0.0);
        for i in 0..500 {
            let t = f64::from(i) * 1e-3;
            let [[_, _, a1, j1, s1, _], [_, _, a2, j2, s2, _]] = flight.series(t);
            let (later, _) = flight.limits(t);
            for (size, later, bound) in [
                (a2 - a1, later.curvature, bounds.curvature),
                (j2 - j1, later.jerk, bounds.jerk),
                (s2 - s1, later.snap, bounds.snap),
            ] {
                assert!(size.abs() <= later * (1.0 + 1e-12) && later <= bound * (1.0 + 1e-12));
            }
        }
    }
}

/// Plain oracle: the gap as a sum of complex exponentials with the roots of each oscillator's characteristic
/// equation.
struct Exponentials {
    gap: f64,
    terms: Vec<(Complex64, Complex64)>,
}

impl Exponentials {
    fn of(rig: &Rig, sine: &Sine, start: &State, phase: f64) -> Exponentials {
        let omega = TAU * sine.frequency;
        let i = Complex64::i();
        let forced =
            Complex64::from_polar(sine.force, phase) / (rig.k1 - rig.m1 * omega * omega + i * rig.c1 * omega);
        let mut terms = vec![(-forced, i * omega)];
        let mut free = |sign: f64, m: f64, c: f64, k: f64, x: f64, v: f64| {
            let root = Complex64::new(c * c - 4.0 * m * k, 0.0).sqrt();
            let (p, q) = ((-c + root) / (2.0 * m), (-c - root) / (2.0 * m));
            // x = A e^{pt} + B e^{qt} with A + B = x, pA + qB = v.
            let a = (v - q * x) / (p - q);
            terms.extend([(sign * a, p), (sign * (x - a), q)]);
        };
        let (x, v) = (forced.re, (i * omega * forced).re);
        free(-1.0, rig.m1, rig.c1, rig.k1, start.x1 - x, start.v1 - v);
        free(1.0, rig.m2, rig.c2, rig.k2, start.x2, start.v2);
        Exponentials { gap: rig.gap, terms }
    }

    /// Gap, its rate and its acceleration.
    fn at(&self, t: f64) -> [f64; 3] {
        let mut sum = [self.gap, 0.0, 0.0];
        for (amplitude, rate) in &self.terms {
            let mut z = amplitude * (rate * t).exp();
            for term in &mut sum {
                *term += z.re;
                z *= rate;
            }
        }
        sum
    }

    /// Bound on the rounding error of a gap in m up to time `t`: a few ε of each term and of its exponent.
    fn noise(&self, t: f64) -> f64 {
        let term = |(a, rate): &(Complex64, Complex64)| a.norm() * (4.0 + (rate * t).norm());
        f64::EPSILON * (self.gap + self.terms.iter().map(term).sum::<f64>())
    }

    /// Index of the first sample with a closed gap, among those at `from`·dt to `last`·dt.
    fn first_closed(&self, dt: f64, from: usize, last: usize) -> Option<usize> {
        // From sample to sample each term is multiplied by a constant, which saves the exponentials.
        let mut terms: Vec<_> = self.terms.iter().map(|(a, rate)| (*a, (rate * dt).exp())).collect();
        (0..=last).find(|i| {
            let gap = self.gap + terms.iter().map(|(z, _)| z.re).sum::<f64>();
            for (z, turn) in &mut terms {
                *z *= *turn;
            }
            *i >= from && gap <= 0.0
        })
    }
}

#[test]
fn no_contact_is_missed_or_invented_in_ten_thousand_flights() {
    // Dense sampling as the oracle: samples 50 µs apart, and frequencies of the gap below 16 Hz.
    let (mut noise, duration, dt) = (Noise::new(2_024), 0.5, 5e-5);
    let (mut hits, mut misses, mut between) = (0, 0, 0);
    for run in 0..10_000 {
        let c = [0.0, 0.1, 1.0, 8.3, 30.0][(noise.uniform() * 5.0) as usize];
        let rig = Rig { c1: c, c2: noise.uniform(), gap: 8e-3 * noise.uniform(), ..Rig::thesis() };
        let sine = Sine { force: 0.5 * noise.uniform(), frequency: 2.0 + 14.0 * noise.uniform() };
        let mut signed = |scale: f64| scale * (2.0 * noise.uniform() - 1.0);
        let (x1, v1, v2, phase) = (signed(3e-3), signed(0.2), signed(0.2), signed(3.1));
        // One in two starts at contact.
        let start = State { x1, v1, x2: x1 - rig.gap + signed(1e-3).max(0.0), v2 };
        let steady = Steady::new(&rig, &sine).unwrap();
        let flight = flight(&rig, &steady, rig.gap, &start, phase);
        let oracle = Exponentials::of(&rig, &sine, &start, phase);
        let noise = oracle.noise(duration);
        // A start at contact with parting masses belongs to the impact before and is not counted.
        let from = usize::from(oracle.at(0.0)[0].abs() < noise && start.approach() < 0.0);
        let found = first_contact(&flight, duration);
        let sampled = oracle.first_closed(dt, from, 10_000).map(|i| i as f64 * dt);
        if let Some(t) = found {
            // It is a contact: the gap is zero there and closing.
            let [gap, rate, acceleration] = oracle.at(t);
            assert!(gap.abs() < noise && rate < 1e-12 * acceleration.abs(), "flight {run}: {gap:e} at {t}");
            // It is the first: the gap is open at all samples before.
            assert!(sampled.is_none_or(|s| s >= t - 1e-13), "flight {run}: {t} {sampled:?}");
            hits += 1;
            // Contacts between two samples, which sampling alone misses.
            between += u32::from(sampled.is_none_or(|s| s > t + dt));
        } else {
            assert_eq!(sampled, None, "flight {run}: a contact was missed");
            misses += 1;
        }
    }
    println!("{hits} contacts, {misses} flights without, {between} between two samples");
    assert!(hits > 3000 && misses > 500, "{hits} contacts, {misses} without: both kinds must occur");
}

#[test]
fn hairbreadth_misses_and_touches_are_told_apart() {
    // Newton's method on the oracle's rate finds the smallest gap. The rest gap is then shifted until the
    // smallest gap is between ±1e-4 m and ±1e-12 m.
    let mut noise = Noise::new(7);
    let mut count = 0;
    while count < 300 {
        let rig = Rig { c1: 0.3 * noise.uniform(), c2: noise.uniform(), gap: 0.05, ..Rig::thesis() };
        let sine = Sine { force: 0.5 * noise.uniform(), frequency: 2.0 + 14.0 * noise.uniform() };
        let mut signed = |scale: f64| scale * (2.0 * noise.uniform() - 1.0);
        let start = State { x1: signed(3e-3), v1: signed(0.2), x2: signed(3e-3), v2: signed(0.2) };
        let phase = signed(3.1);
        let oracle = Exponentials::of(&rig, &sine, &start, phase);
        let (dt, last) = (1e-4, 5000_u32);
        let gap = |i: u32| oracle.at(f64::from(i) * dt)[0];
        let lowest = (0..=last).min_by(|a, b| gap(*a).total_cmp(&gap(*b))).unwrap();
        if lowest < 10 || lowest > last - 10 {
            continue;
        }
        let mut t = f64::from(lowest) * dt;
        for _ in 0..8 {
            let [_, rate, acceleration] = oracle.at(t);
            t -= rate / acceleration;
        }
        let [smallest, ..] = oracle.at(t);
        // Skips flights that would start with an overlap after the shift.
        if oracle.at(0.0)[0] - smallest < 2e-4 {
            continue;
        }
        let steady = Steady::new(&rig, &sine).unwrap();
        for exponent in 4..=12 {
            let distance = 10_f64.powi(-exponent);
            for sign in [1.0, -1.0] {
                let moved = rig.gap - smallest + sign * distance;
                let flight = flight(&rig, &steady, moved, &start, phase);
                // The duration ends at the last sample, at least ten samples after the smallest gap.
                let found = first_contact(&flight, f64::from(last) * dt);
                assert_eq!(found.is_some(), sign < 0.0, "{sign}·1e-{exponent} m: {found:?}");
                if let Some(found) = found {
                    let gap = oracle.at(found)[0] + (moved - rig.gap);
                    assert!(gap.abs() < oracle.noise(found) && found <= t, "{gap:e} at {found}, {t}");
                }
            }
        }
        count += 1;
    }
}

/// Flight that begins at contact, parting at `w` (m/s) against a pressing force, as in a chatter.
fn chatter(noise: &mut Noise, w: f64) -> Flight {
    let c = [0.0, 0.1, 8.3][(noise.uniform() * 3.0) as usize];
    let rig = Rig { c1: c, c2: noise.uniform(), gap: -1e-3, ..Rig::thesis() };
    let sine = Sine { force: 0.02 * noise.uniform(), frequency: 2.0 + 14.0 * noise.uniform() };
    let mut signed = |scale: f64| scale * (2.0 * noise.uniform() - 1.0);
    let (common, phase) = (signed(5e-3), signed(3.1));
    let x1 = -5e-4 + signed(5e-5);
    let start = State { x1, v1: common, x2: x1 - rig.gap, v2: common + w };
    let steady = Steady::new(&rig, &sine).unwrap();
    flight(&rig, &steady, rig.gap, &start, phase)
}

#[test]
fn short_flights_land_where_the_closed_form_is_at_contact_and_not_before() {
    let mut noise = Noise::new(8);
    // The longest flights need a series of twenty terms, whose error bound does not always suffice.
    for (w, least) in [(1e-6, 200), (1e-5, 200), (1e-4, 200), (5e-4, 200), (2e-3, 150), (5e-3, 50)] {
        let mut followed = 0;
        for _ in 0..200 {
            let flight = chatter(&mut noise, w);
            let [_, a1, _, a2] = flight.rate(0.0);
            assert!(a1 > a2, "seed 8: the springs press");
            let rounding = 0.25 * flight.noise();
            let Some(landing) = flight.hop(1.0, rounding) else { continue };
            followed += 1;
            // Tolerance: rounding of the gap in closed form, whose slope at the landing is at least w/2.
            let off = flight.gap(landing.time).abs();
            assert!(off <= 4.0 * flight.noise(), "seed 8, {w}: {off:e}");
            let (there, state) = (flight.state(landing.time), landing.state);
            assert!((there.x1 - state.x1).abs() <= 4.0 * flight.noise());
            // Tolerance of the speeds: that of the displacements times the fastest rate, 250 rad/s, and the
            // rounding of the speeds themselves.
            let slack = 250.0 * flight.noise() + 4.0 * f64::EPSILON * (state.v1.abs() + state.v2.abs() + 0.1);
            let apart = [there.v1 - state.v1, there.v2 - state.v2];
            assert!(
                apart.iter().all(|d| d.abs() <= slack),
                "seed 8, {w}, {:e} s: {apart:?}, {slack:e}",
                landing.time
            );
            for i in 1..50 {
                let gap = flight.gap(landing.time * f64::from(i) / 50.0);
                assert!(gap > -flight.noise(), "seed 8, {w}: {gap:e} before the landing");
            }
            assert!(flight.hop(0.9 * landing.time, rounding).is_none(), "it lands later");
        }
        assert!(
            followed >= least,
            "seed 8: {followed} of 200 flights at {w} m/s are followed by their series"
        );
    }
}

#[test]
fn the_series_is_silent_where_it_proves_nothing() {
    let mut noise = Noise::new(9);
    let mut rounding = 0.0;
    for _ in 0..50 {
        let flight = chatter(&mut noise, 1e-3);
        rounding = 0.25 * flight.noise();
        // No landing by the series: a long flight, one that begins apart, one towards the other mass; below,
        // one without a pressing force.
        assert!(chatter(&mut noise, 0.2).hop(1.0, rounding).is_none());
        assert!(Flight { gap: flight.gap + 1e-9, ..flight }.hop(1.0, rounding).is_none());
        assert!(chatter(&mut noise, -1e-3).hop(1.0, rounding).is_none());
    }
    let rig = Rig { gap: 1e-3, ..Rig::thesis() };
    let steady = Steady::new(&rig, &Sine { force: 1e-3, frequency: 5.0 }).unwrap();
    let start = State { x1: 5e-4, v1: 0.0, x2: -5e-4, v2: 1e-3 };
    let pulled = flight(&rig, &steady, rig.gap, &start, 0.0);
    assert!(pulled.rate(0.0)[1] < pulled.rate(0.0)[3]);
    assert!(pulled.hop(1.0, rounding).is_none());
}

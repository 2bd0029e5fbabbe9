//! Simulations of random rigs from rest, compared with the closed form and its verdicts.

use super::*;
use crate::orbit::Orbit;
use crate::orbit::orbits;
use vibro_math::Noise;

fn random(noise: &mut Noise) -> (Rig, Sine) {
    let mut between = |low: f64, high: f64| low + (high - low) * noise.uniform();
    let rig = Rig {
        m1: between(0.05, 0.3),
        m2: between(0.05, 0.3),
        k1: between(50.0, 300.0),
        k2: between(50.0, 300.0),
        c1: between(0.05, 1.0),
        c2: between(0.05, 1.0),
        gap: between(0.0, 3e-3),
        restitution: between(0.2, 0.95),
    };
    let frequency = between(0.5, 3.0) * rig.natural_frequencies()[0];
    (rig, Sine { force: between(0.1, 1.0), frequency })
}

/// Follows `motion` for `cycles` and returns the impulses (N s) of the next eight cycles.
fn last(motion: &mut Simulation, cycles: f64) -> Vec<f64> {
    let period = 1.0 / motion.frequency();
    motion.run(motion.time() + cycles * period, |_| {}).unwrap();
    let mut impulses = Vec::new();
    motion.run(motion.time() + 8.0 * period, |leg| impulses.extend(leg.impact().map(|i| i.impulse))).unwrap();
    impulses
}

fn on(orbit: &Orbit, impulses: &[f64]) -> bool {
    (7..=9).contains(&impulses.len()) && impulses.iter().all(|j| (j / orbit.impulse - 1.0).abs() < 1e-9)
}

#[test]
fn two_hundred_random_rigs_settle_where_the_closed_form_is_real_and_nowhere_else() {
    let mut noise = Noise::new(20_250);
    let (mut settled, mut elsewhere, mut not) = (0, 0, 0);
    while settled + elsewhere < 200 || not < 200 {
        let (rig, sine) = random(&mut noise);
        let found = orbits(&rig, sine.force, sine.frequency).unwrap();
        let is_real = |o: &&Orbit| o.validity.admissible && o.validity.stable == Some(true);
        let real: Vec<&Orbit> = found.orbits.iter().filter(is_real).collect();
        let mut motion = Simulation::new(&rig, &sine).unwrap();
        match real[..] {
            [orbit] if !found.no_impact.possible => {
                let radius = orbit.spectral_radius().unwrap();
                // A disturbance must decay to 1e-12 within some thousand cycles; close to grazing or to a
                // stability limit it does not.
                if radius > 0.99 || orbit.validity.grazing_distance < 1e-5 {
                    continue;
                }
                let cycles = 300.0 - 28.0 / radius.ln();
                let from_rest = last(&mut motion, cycles);
                if on(orbit, &from_rest) {
                    settled += 1;
                    continue;
                }
                // From rest another motion is reached: a start near the orbit must still settle on it.
                elsewhere += 1;
                let mut state = orbit.state(orbit.period() / 2.0);
                state.v2 += 1e-6;
                let phase = orbit.force_phase + TAU / 2.0;
                let mut near = Simulation::from_state(&rig, &sine, state, phase).unwrap();
                let impulses = last(&mut near, cycles);
                assert!(on(orbit, &impulses), "{rig:?} {sine:?}: {} for {impulses:?}", orbit.impulse);
            }
            [] => {
                // No orbit is real: the motion from rest does not settle on any.
                not += 1;
                let impulses = last(&mut motion, 1000.0);
                for orbit in found.orbits.iter().filter(|o| o.validity.exists) {
                    assert!(!on(orbit, &impulses), "{rig:?} {sine:?}: on {:?}", orbit.validity);
                }
            }
            _ => {}
        }
    }
    println!("{settled} settled, {elsewhere} on another motion from rest, {not} without a real orbit");
    assert!(elsewhere * 5 < settled, "{elsewhere} of {settled}");
}

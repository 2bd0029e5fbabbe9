//! Orbits in limiting cases: a wall as mass 2, no losses, contacts with a duration.

use super::*;
use crate::excitation::{Impulses, Pulses};
use crate::motion::{Event, Motion};
use crate::simulate::Simulation;
use vibro_math::bisected;

/// Frequency in Hz at the frequency ratio ν = ω/Ω₁.
fn at(rig: &Rig, nu: f64) -> f64 {
    nu * (rig.k1 / rig.m1).sqrt() / TAU
}

fn wall() -> Rig {
    Rig { m2: f64::INFINITY, ..Rig::thesis() }
}

#[test]
fn an_impact_oscillator_without_losses_has_its_textbook_impulse() {
    // Undamped, R = 1: x = A cos ωt at φ = 0 or π, minus J times the Green's function cot(πΩ/ω)/(2mΩ), so
    // J = 2mΩ tan(πΩ/ω)(±|A| − Δ).
    let rig = Rig { c1: 0.0, restitution: 1.0, ..wall() };
    let natural = (rig.k1 / rig.m1).sqrt();
    for nu in [0.7, 1.3, 1.72, 2.4] {
        let omega = nu * natural;
        let amplitude = (0.3 / (rig.k1 - rig.m1 * omega * omega)).abs();
        let found = orbits(&rig, 0.3, omega / TAU).unwrap();
        let mut expected = [amplitude, -amplitude]
            .map(|a| 2.0 * rig.m1 * natural * (std::f64::consts::PI / nu).tan() * (a - rig.gap));
        expected.sort_by(|a, b| b.total_cmp(a));
        for (orbit, expected) in found.orbits.iter().zip(expected) {
            // Rounding of πΩ/ω, amplified by the tangent, and of A near resonance.
            assert!((orbit.impulse / expected - 1.0).abs() < 1e-13, "{} {expected}", orbit.impulse);
            assert_eq!(
                (orbit.state(0.03).x2, orbit.peak_to_peak[1], orbit.fundamental[1].norm()),
                (0.0, 0.0, 0.0)
            );
        }
        assert_eq!(found.orbits.len(), 2);
    }
}

#[test]
fn a_very_heavy_mass_is_a_wall() {
    for (restitution, nu) in [(0.7, 1.4), (0.5, 1.7), (0.9, 2.2)] {
        let wall = Rig { restitution, ..wall() };
        let frequency = at(&wall, nu);
        let heavy = Rig { m2: 1e9, k2: 1e9 * 900.0, c2: 1e8, ..wall };
        let (a, b) = (orbits(&wall, 0.5, frequency).unwrap(), orbits(&heavy, 0.5, frequency).unwrap());
        for (a, b) in a.orbits.iter().zip(&b.orbits) {
            // Mass ratio 1e-10, amplified by the sensitivity of J to the mass.
            assert!((a.impulse / b.impulse - 1.0).abs() < 1e-8, "{} {}", a.impulse, b.impulse);
            assert_eq!(a.validity.admissible, b.validity.admissible);
            let Some(m) = a.multipliers else { continue };
            // Two multipliers of the wall, which are 0, and two of the mass, with the product R²e^{−2bT}.
            assert_eq!((m[2].norm(), m[3].norm()), (0.0, 0.0));
            let b1 = wall.oscillators()[0].decay();
            let expected = restitution.powi(2) * (-2.0 * b1 * a.period()).exp();
            assert!((m[0] * m[1] - expected).norm() < 1e-12, "{m:?}");
        }
    }
}

/// The last impact of a simulation under `excitation` after `settle` seconds.
fn settled(rig: &Rig, excitation: &Excitation, start: State, phase: f64, settle: f64) -> crate::Impact {
    let mut motion = Simulation::from_state(rig, excitation, start, phase).unwrap();
    let mut last = None;
    motion
        .advance(settle, &mut |piece| {
            if let Event::Impact(impact) = piece.event {
                last = Some(impact);
            }
        })
        .unwrap();
    last.unwrap()
}

#[test]
fn simulations_stay_on_stable_orbits_of_every_excitation() {
    let mut counts = [0; 4];
    for nu in [0.83, 1.05, 1.3, 1.6, 1.9, 2.05, 2.3] {
        for (i, rig) in [Rig::thesis(), wall()].iter().enumerate() {
            let frequency = at(rig, nu);
            for (k, excitation) in [
                Excitation::Impulse(Impulses { impulse: 0.009, frequency }),
                Excitation::Pulse(Pulses { force: 0.9, width: 0.01, frequency }),
            ]
            .iter()
            .enumerate()
            {
                for cycles in [1, 2] {
                    for orbit in orbits_of(rig, excitation, cycles).unwrap().orbits {
                        let radius = orbit.spectral_radius().unwrap_or(9.0);
                        if !orbit.validity.admissible
                            || radius > 0.97
                            || orbit.validity.grazing_distance < 1e-5
                        {
                            continue;
                        }
                        // Starts near the middle of the period with a small disturbance, which shrinks to
                        // 0.97^(800/2) = 5e-6 of itself.
                        let half = orbit.period() * 0.47;
                        let mut start = orbit.state(half);
                        start.v1 += 1e-6;
                        let phase = orbit.force_phase + TAU * f64::from(cycles) * 0.47;
                        let impact = settled(rig, excitation, start, phase, 800.0 / frequency);
                        // Rounding of some 10 mm and 1 m/s, amplified by 1/(1 − 0.97) and by the reciprocal
                        // of the speed.
                        assert!(
                            (impact.impulse / orbit.impulse - 1.0).abs() < 1e-10,
                            "{excitation:?} {cycles}: {impact:?} {orbit:?}"
                        );
                        counts[2 * i + k] += 1;
                    }
                }
            }
        }
    }
    println!("{counts:?}");
    assert!(counts.iter().all(|c| *c > 1), "{counts:?}");
}

#[test]
fn the_backbone_is_the_limit_of_small_losses_and_forces() {
    let rig = Rig::thesis();
    let mut met = 0;
    for nu in [1.02, 1.06, 1.8, 1.95, 2.05] {
        let frequency = at(&rig, nu);
        let Some(free) = backbone(&rig, frequency).unwrap() else { continue };
        met += 1;
        // With small losses and a force that balances them, both roots are near the free motion, and their
        // mean equals it to second order.
        let slight = Rig { c1: 0.0, c2: 0.0, restitution: 1.0, ..rig };
        let pair = orbits(&slight, 1e-7, frequency).unwrap().orbits;
        let middle = f64::midpoint(pair[0].impulse, pair[1].impulse);
        assert!((middle / free.impulse - 1.0).abs() < 1e-9, "ν {nu}: {middle} {}", free.impulse);
        // The masses meet, and the impact only reverses their relative speed.
        let (before, after) = (free.before_impact(), free.state(0.0));
        assert!(
            (rig.gap + after.x2 - after.x1).abs() < 1e-15
                && (before.approach() + after.approach()).abs() < 1e-13
        );
        let reduced = rig.reduced_mass();
        assert!((free.approach_velocity * 2.0 * reduced - free.impulse).abs() < 1e-15);
        assert!(free.fundamental[0].norm() > 0.0);
    }
    assert!(met >= 3, "{met}");
    // Against a wall J = −2mΩΔ tan(πΩ/ω), between Ω and 2Ω.
    let wall = wall();
    let natural = (wall.k1 / wall.m1).sqrt();
    for nu in [0.9, 1.2, 1.9, 2.1] {
        let expected = -2.0 * wall.m1 * natural * wall.gap * (std::f64::consts::PI / nu).tan();
        match backbone(&wall, at(&wall, nu)).unwrap() {
            Some(free) => assert!((free.impulse / expected - 1.0).abs() < 1e-13),
            None => assert!(expected <= 0.0),
        }
    }
    assert!(backbone(&rig, -1.0).is_err() && backbone(&rig, 1e-9).is_err());
}

/// Reference: the rig with a contact of spring and damper that cannot pull, by fourth-order Runge–Kutta steps
/// that end at touch and release.
struct Slow<'a> {
    rig: &'a Rig,
    contact: Compliance,
    force: f64,
    omega: f64,
    phase: f64,
    time: f64,
    state: [f64; 4],
    touching: bool,
}

impl Slow<'_> {
    fn push(&self, s: [f64; 4]) -> f64 {
        self.contact.stiffness * (s[0] - s[2] - self.rig.gap) + self.contact.damping * (s[1] - s[3])
    }

    fn rate(&self, t: f64, s: [f64; 4]) -> [f64; 4] {
        let push = if self.touching { self.push(s) } else { 0.0 };
        let drive = self.force * (self.omega * t + self.phase).cos();
        let rig = self.rig;
        [
            s[1],
            (drive - push - rig.c1 * s[1] - rig.k1 * s[0]) / rig.m1,
            s[3],
            (push - rig.c2 * s[3] - rig.k2 * s[2]) / rig.m2,
        ]
    }

    fn step(&self, h: f64) -> [f64; 4] {
        let (t, s) = (self.time, self.state);
        let to = |k: [f64; 4], h: f64| std::array::from_fn(|i| s[i] + h * k[i]);
        let k1 = self.rate(t, s);
        let k2 = self.rate(t + h / 2.0, to(k1, h / 2.0));
        let k3 = self.rate(t + h / 2.0, to(k2, h / 2.0));
        let k4 = self.rate(t + h, to(k3, h));
        std::array::from_fn(|i| s[i] + h / 6.0 * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i]))
    }

    /// One step, which ends at touch or release; returns the approach speed at a touch.
    fn go(&mut self, h: f64) -> Option<f64> {
        // The quantity whose zero ends the step: the gap, or the contact force.
        let height = |s: [f64; 4]| if self.touching { self.push(s) } else { self.rig.gap + s[2] - s[0] };
        let (start, end) = (height(self.state), height(self.step(h)));
        if end >= 0.0 || start < 0.0 || (start == 0.0 && !self.touching) {
            (self.state, self.time) = (self.step(h), self.time + h);
            return None;
        }
        let (_, event) = bisected(0.0, h, 40, |part| height(self.step(part)) >= 0.0);
        (self.state, self.time) = (self.step(event), self.time + event);
        self.touching = !self.touching;
        self.touching.then(|| self.state[1] - self.state[3])
    }
}

#[test]
fn a_contact_that_lasts_is_corrected_for() {
    let rig = Rig::thesis();
    for (nu, stiffness) in
        [(2.1, 1e6), (2.1, 2e5), (2.1, 1e5), (1.9, 1e5), (2.05, 2e5), (1.05, 3e4), (1.05, 3e5), (1.3, 1e5)]
    {
        let excitation = Excitation::Sine(Sine { force: 0.5, frequency: at(&rig, nu) });
        let found = orbits_of(&rig, &excitation, 1).unwrap();
        let orbit = &found.orbits[0];
        let contact = Compliance::new(&rig, stiffness, None).unwrap();
        assert!((contact.restitution - 0.7).abs() < 1e-14);
        let soft = softened(&rig, &excitation, &found, &contact).unwrap()[0].unwrap();
        let (period, start) = (orbit.period(), orbit.state(0.3 * orbit.period()));
        let mut motion = Slow {
            rig: &rig,
            contact,
            force: 0.5,
            omega: TAU * orbit.frequency,
            phase: orbit.force_phase,
            time: 0.3 * period,
            state: [start.x1, start.v1, start.x2, start.v2],
            touching: false,
        };
        let mut speed = 0.0;
        while motion.time < 250.0 * period {
            speed = motion.go(2e-5).unwrap_or(speed);
        }
        let (plain, corrected) =
            (orbit.approach_velocity / speed - 1.0, soft.approach_velocity / speed - 1.0);
        println!(
            "ν {nu}, {:.2} % in contact: off by {:.2} % without and {:.3} % with the correction",
            100.0 * soft.share,
            100.0 * plain,
            100.0 * corrected
        );
        // The remaining error is of second order in the share in contact, amplified like the first-order one.
        assert!(corrected.abs() < plain.abs().max(0.1) * 3.0 * soft.share + 1e-4, "{plain} {corrected}");
    }
    // Contacts that last too long are refused.
    let excitation = Excitation::Sine(Sine { force: 0.5, frequency: at(&rig, 2.1) });
    let found = orbits_of(&rig, &excitation, 1).unwrap();
    let contact = Compliance::new(&rig, 5e3, None).unwrap();
    assert!(
        softened(&rig, &excitation, &found, &contact).unwrap_err().to_string().contains("% of the period")
    );
    assert!(Compliance::new(&rig, 0.0, None).is_err() && Compliance::new(&rig, 1e5, Some(f64::NAN)).is_err());
    assert!(Compliance::new(&rig, 1e5, Some(1e9)).is_err());
    assert!(Compliance::new(&Rig { restitution: 0.1, ..rig }, 1e5, None).is_err());
}

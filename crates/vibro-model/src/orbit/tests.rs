//! Tests of orbits against their own conditions, their energy balance, other methods of computation, and
//! reference values.

use super::*;
use crate::excitation::{Impulses, Pulses, Sines};
use crate::floquet;
use crate::motion::Motion;
use crate::simulate::Simulation;

/// Frequency in Hz at the frequency ratio ν = ω/Ω₁.
fn at(rig: &Rig, nu: f64) -> f64 {
    nu * (rig.k1 / rig.m1).sqrt() / TAU
}

/// Rigs, excitations and frequency ratios from light to over-critical damping.
fn scenes() -> Vec<(Rig, Excitation, u32)> {
    let t = Rig::thesis();
    let mut scenes = Vec::new();
    for rig in [
        t,
        Rig { c1: 0.0, c2: 0.0, restitution: 1.0, ..t },
        Rig { c1: 8.3, c2: 0.2, restitution: 0.4, ..t },
        Rig { c1: 1.0, c2: 9.0, restitution: 0.0, gap: -2e-4, ..t },
    ] {
        for nu in [0.83, 1.13, 1.71, 2.03, 2.61] {
            let frequency = at(&rig, nu);
            let sine = |force| Excitation::Sine(Sine { force, frequency });
            let train = |impulse| Excitation::Impulse(Impulses { impulse, frequency });
            let pulses = |force, width| Excitation::Pulse(Pulses { force, width, frequency });
            scenes.push((rig, sine(0.5), 1));
            scenes.push((rig, sine(3.0), 2));
            scenes.push((rig, train(0.02), 1));
            scenes.push((rig, train(-0.05), 3));
            scenes.push((rig, pulses(1.0, 0.02), 1));
            scenes.push((rig, pulses(-1.5, 0.04), 2));
        }
    }
    scenes
}

fn each(mut check: impl FnMut(&Rig, &Excitation, &Orbit)) {
    let mut counts = [0; 3];
    for (rig, excitation, cycles) in scenes() {
        for orbit in &orbits_of(&rig, &excitation, cycles).unwrap().orbits {
            check(&rig, &excitation, orbit);
            counts[["sine", "impulse", "pulse"].iter().position(|k| *k == excitation.kind()).unwrap()] += 1;
        }
    }
    assert!(counts.iter().all(|c| *c > 40), "{counts:?} orbits");
}

/// Size in m of the terms that add up to the displacements; rounding is relative to it.
fn scale(orbit: &Orbit) -> f64 {
    let [x1, x2] = orbit.peak_to_peak;
    x1 + x2 + orbit.course.noise() / f64::EPSILON
}

#[test]
fn both_masses_meet_and_part_as_the_impact_law_says() {
    each(|rig, _, orbit| {
        let (before, after) = (orbit.before_impact(), orbit.state(0.0));
        let omega = TAU * orbit.frequency;
        let (length, speed) =
            (64.0 * f64::EPSILON * scale(orbit), 64.0 * f64::EPSILON * scale(orbit) * omega.max(60.0));
        assert!((rig.gap + before.x2 - before.x1).abs() < length);
        assert!((before.x1 - after.x1).abs() < length && (before.x2 - after.x2).abs() < length);
        assert!((before.approach() - orbit.approach_velocity).abs() < speed);
        assert!((after.approach() + rig.restitution * before.approach()).abs() < speed);
        assert!((rig.m1 * (after.v1 - before.v1) + orbit.impulse).abs() < rig.m1 * speed);
        assert!((rig.m2 * (after.v2 - before.v2) - orbit.impulse).abs() < rig.m2 * speed);
    });
}

#[test]
fn work_of_the_force_is_what_dampers_and_impact_take() {
    each(|rig, excitation, orbit| {
        // Simpson's rule has an error of (hβ)⁴/180 of the integral, with β = 192/s for the square of the
        // fastest decay and a step h below 0.1 ms.
        let n = 10_000_u32;
        let omega = TAU * orbit.frequency;
        let (mut work, mut loss, mut put_in, mut before) = (0.0, 0.0, 0.0, None::<State>);
        let mut start = 0.0;
        for (duration, stretch) in &orbit.course.stretches {
            let duration = *duration;
            // The work of an impulse is F(v⁻ + v⁺)/2.
            if let (Excitation::Impulse(train), Some(before)) = (excitation, before) {
                put_in += train.impulse * f64::midpoint(before.v1, stretch.state(0.0).v1);
            }
            // The work of a constant force is force times displacement.
            let force = stretch.rest * rig.k1;
            put_in += force * (stretch.state(duration).x1 - stretch.state(0.0).x1);
            // Simpson on an even number of panels.
            for i in 0..=n {
                let t = duration * f64::from(i) / f64::from(n);
                let s = stretch.state(t);
                let weight = if i == 0 || i == n { 1.0 } else { 2.0 * f64::from(1 + i % 2) };
                let panel = weight * duration / f64::from(3 * n);
                if let Excitation::Sine(sine) = excitation {
                    work += panel * sine.force * (omega * (start + t) + orbit.force_phase).cos() * s.v1;
                }
                loss += panel * (rig.c1 * s.v1.powi(2) + rig.c2 * s.v2.powi(2));
            }
            before = Some(stretch.state(duration));
            start += duration;
        }
        let v = orbit.approach_velocity;
        let impact = rig.reduced_mass() * (1.0 - rig.restitution.powi(2)) * v * v / 2.0;
        // 1e-10 of the energies exchanged; or of the stored energy, where nothing is lost.
        let turned = loss.abs() + impact.abs() + put_in.abs() + work.abs();
        let stored = rig.k1 * orbit.peak_to_peak[0].powi(2) + rig.k2 * orbit.peak_to_peak[1].powi(2);
        let balance = work + put_in - loss - impact;
        assert!(balance.abs() < 1e-10 * (turned + stored), "{work} {put_in} {loss} {impact}: {orbit:?}");
    });
}

#[test]
fn lines_are_the_dft_of_the_trace() {
    each(|rig, excitation, orbit| {
        let n = 4096_u32;
        // Impacts and impulses make kinks of J/m and F/m in the velocity: harmonics fall like 2J/(T m ω²),
        // and those near multiples of 4096 alias; steps of the acceleration contribute less.
        let kick = match excitation {
            Excitation::Impulse(train) => train.impulse.abs() * f64::from(orbit.cycles),
            Excitation::Pulse(pulse) => pulse.force.abs() * pulse.width * f64::from(orbit.cycles),
            _ => 0.0,
        };
        let kink = 2.0 * (orbit.impulse.abs() + kick) * orbit.period() / (0.094 * TAU * TAU);
        let tolerance = 4.0 * kink / f64::from(n).powi(2) + 1e-15;
        for line in [1, orbit.cycles, 2 * orbit.cycles, 7] {
            let omega = TAU * f64::from(line) / orbit.period();
            let mut sums = [Complex64::ZERO; 2];
            for i in 0..n {
                let t = orbit.period() * f64::from(i) / f64::from(n);
                let s = orbit.state(t);
                let wave = Complex64::cis(-omega * t) * (2.0 / f64::from(n));
                sums[0] += wave * s.x1;
                sums[1] += wave * s.x2;
            }
            for (sum, exact) in sums.iter().zip(orbit.line(line)) {
                assert!(
                    (sum - exact).norm() < tolerance,
                    "{line} {sum} {exact} {tolerance}: {rig:?} {excitation:?}"
                );
            }
        }
        assert_eq!(orbit.line(orbit.cycles), orbit.fundamental);
    });
}

#[test]
fn peaks_and_gaps_are_those_of_a_dense_trace() {
    each(|rig, _, orbit| {
        let n = 4000_u32;
        let (mut ends, mut least) = ([(f64::INFINITY, f64::NEG_INFINITY); 2], f64::INFINITY);
        let mut speed = 0.0_f64;
        for i in 0..=n {
            let s = orbit.course.state(orbit.period() * f64::from(i) / f64::from(n));
            for (end, x) in ends.iter_mut().zip([s.x1, s.x2]) {
                *end = (end.0.min(x), end.1.max(x));
            }
            least = least.min(rig.gap + s.x2 - s.x1);
            speed = speed.max(s.v1.abs() + s.v2.abs());
        }
        // A corner is at most half a step away from a sample.
        let missed = speed * orbit.period() / f64::from(n) + 1e-12 * scale(orbit);
        for (exact, (low, high)) in orbit.peak_to_peak.iter().zip(ends) {
            assert!(
                *exact >= high - low - 1e-12 * scale(orbit) && exact - (high - low) < missed,
                "{orbit:?}"
            );
        }
        let found = orbit.validity.min_gap;
        assert!(
            found <= least.min(0.0) + 1e-9 * scale(orbit) && least.min(0.0) - found < missed,
            "{found} {least}: {orbit:?}"
        );
    });
}

#[test]
fn pulses_are_impulses_summed() {
    // The steady motion under a pulse is the integral of the Green's function over it: 10-point
    // Gauss–Legendre in 8 parts of the pulse. The error, below (Ωh)²⁰/20! for parts of the length h, is far
    // below rounding.
    let nodes = [
        (0.148_874_338_981_631_2, 0.295_524_224_714_752_87),
        (0.433_395_394_129_247_2, 0.269_266_719_309_996_35),
        (0.679_409_568_299_024_4, 0.219_086_362_515_982_04),
        (0.865_063_366_688_984_5, 0.149_451_349_150_580_6),
        (0.973_906_528_517_171_7, 0.066_671_344_308_688_14),
    ];
    for c in [0.0, 0.1, 2.0, 2.0 * f64::sqrt(135.0 * 0.125), 20.0] {
        let oscillator = vibro_math::Oscillator::new(0.125, c, 135.0);
        let cycle = 0.17;
        let green = crate::Green::new(0.125, oscillator, cycle).unwrap();
        for width in [1e-6, 1e-3, 0.02, 0.16] {
            let (force, omega) = (0.3, f64::sqrt(135.0 / 0.125));
            let response = PulseResponse::pulse(0.125, oscillator, cycle, force, width).unwrap();
            for at in [width, width + 1e-3, 0.5 * (width + cycle), cycle * (1.0 - 1e-12)] {
                let (mut x, mut v) = (0.0, 0.0);
                for part in 0..8 {
                    let half = width / 16.0;
                    let middle = (2.0 * f64::from(part) + 1.0) * half;
                    for (node, weight) in nodes.iter().flat_map(|(n, w)| [(*n, *w), (-*n, *w)]) {
                        let (gx, gv) = green.at(at - (middle + node * half));
                        x += force * weight * half * gx;
                        v += force * weight * half * gv;
                    }
                }
                let [y, dy, _] = response.at(at);
                // Rounding of the Green's function, amplified near resonance (1 − e^{−bT} ≥ 0.06 here;
                // undamped sin λT/2 = 0.3).
                let size = force * width / 0.125 * 1e3 * f64::EPSILON;
                assert!(
                    (y - x).abs() * omega < size && (dy - v).abs() < size,
                    "c {c} w {width} at {at}: {y} {x}, {dy} {v}"
                );
            }
            // The motion is continuous at both ends of the pulse.
            let [start, end] = [response.at(0.0), response.at(cycle * (1.0 - 1e-15))];
            let loss = 64.0 * f64::EPSILON * (force / 135.0 + force * width / (0.125 * omega));
            assert!((start[0] - end[0]).abs() < loss && (start[1] - end[1]).abs() < loss * omega);
            let [before, after] = [response.at(width * (1.0 - 1e-15)), response.at(width)];
            assert!((before[0] - after[0]).abs() < loss && (before[1] - after[1]).abs() < loss * omega);
            assert!((before[2] - after[2] - force / 0.125).abs() < loss * omega * omega);
        }
    }
}

#[test]
fn a_vanishing_pulse_is_an_impulse() {
    let rig = Rig::thesis();
    for nu in [0.83, 1.05, 2.05] {
        let frequency = at(&rig, nu);
        let train =
            orbits_of(&rig, &Excitation::Impulse(Impulses { impulse: 0.02, frequency }), 1).unwrap().orbits;
        assert!(!train.is_empty());
        let mut last = None;
        for width in [1e-3, 1e-4] {
            let pulse = Pulses { force: 0.02 / width, width, frequency };
            let mut pulses = orbits_of(&rig, &Excitation::Pulse(pulse), 1).unwrap().orbits;
            // Where an impulse makes G of `train::orbits` jump across zero, a short pulse makes it pass
            // through zero: an extra orbit with its impact during the pulse.
            pulses.retain(|orbit| orbit.timing > width);
            assert_eq!(train.len(), pulses.len(), "ν {nu}");
            let mut error = 0.0_f64;
            for (a, b) in train.iter().zip(&pulses) {
                error = error.max((a.impulse / b.impulse - 1.0).abs());
                error = error.max((a.timing - (b.timing - width / 2.0)).abs() * frequency);
                assert_eq!((a.validity.exists, a.validity.stable), (b.validity.exists, b.validity.stable));
            }
            // The pulse is symmetric about its middle: it differs from the impulse in second order.
            assert!(error < 10.0 * (width * TAU * frequency).powi(2) * 10.0, "ν {nu} w {width}: {error}");
            if let Some(last) = last {
                assert!(error < last / 50.0, "ν {nu}: {last} then {error}");
            }
            last = Some(error);
        }
    }
}

/// At a fold (G′ = 0) two orbits meet: orbits that break the energy rule have a real multiplier beyond +1.
#[test]
fn what_breaks_the_energy_rule_is_unstable_by_a_fold() {
    let (mut broken, mut kept, mut lost) = (0, 0, 0);
    for restitution in [0.2, 0.7, 1.0] {
        let rig = Rig { restitution, ..Rig::thesis() };
        for i in 0..240 {
            let frequency = at(&rig, 0.7031 + 0.0083 * f64::from(i));
            for excitation in [
                Excitation::Sine(Sine { force: 0.1, frequency }),
                Excitation::Sine(Sine { force: 0.9, frequency }),
                Excitation::Impulse(Impulses { impulse: 0.009, frequency }),
                Excitation::Pulse(Pulses { force: 0.5, width: 0.01, frequency }),
            ] {
                for orbit in
                    orbits_of(&rig, &excitation, 1).unwrap().orbits.iter().filter(|o| o.impulse > 0.0)
                {
                    let v = &orbit.validity;
                    if v.energy_rule {
                        kept += 1;
                        lost += usize::from(v.stable == Some(false));
                    } else {
                        broken += 1;
                        let m = orbit.multipliers.unwrap();
                        assert_eq!(v.stable, Some(false), "{orbit:?}");
                        assert!(m.iter().any(|z| z.im == 0.0 && z.re > 1.0), "{orbit:?}");
                    }
                }
            }
        }
    }
    println!("{broken} break the rule, all unstable; of {kept} that keep it {lost} are unstable");
    assert!(broken > 100 && lost > 100, "{broken} {lost} {kept}");
}

#[test]
fn multipliers_have_the_determinant_of_dampers_and_impact() {
    each(|rig, _, orbit| {
        let Some(multipliers) = orbit.multipliers else { return };
        let [b1, b2] = rig.oscillators().map(|o| o.decay());
        let expected = rig.restitution.powi(2) * (-2.0 * (b1 + b2) * orbit.period()).exp();
        let product: Complex64 = multipliers.iter().product();
        // ε times the square of the monodromy's norm, which grows like the accelerations over the approach
        // speed.
        let (before, after) = orbit.course.rates();
        let size = floquet::monodromy(rig, orbit.period(), &before, &after).0.norm();
        let tolerance = f64::max(1e-12, 64.0 * f64::EPSILON * size * size);
        assert!((product - expected).norm() < tolerance, "{product} {expected} {tolerance}");
    });
}

#[test]
fn multipliers_are_those_of_a_disturbed_simulation() {
    // Central differences of the simulated map over one period, starting half-way between two impacts.
    let rig = Rig::thesis();
    let frequency = at(&rig, 2.1);
    let orbit = orbits(&rig, 0.5, frequency).unwrap().orbits.remove(0);
    let half = orbit.period() / 2.0;
    let phase = orbit.force_phase + TAU / 2.0;
    let start = orbit.state(half);
    let fly = |d: [f64; 4]| {
        let state =
            State { x1: start.x1 + d[0], v1: start.v1 + d[1], x2: start.x2 + d[2], v2: start.v2 + d[3] };
        let sine = Sine { force: 0.5, frequency };
        let mut motion = Simulation::from_state(&rig, &sine, state, phase).unwrap();
        motion.run(orbit.period(), |_| {}).unwrap();
        let s = motion.state();
        [s.x1, s.v1, s.x2, s.v2]
    };
    let h = 1e-7;
    let mut map = nalgebra::Matrix4::zeros();
    for column in 0..4 {
        // Velocities are about Ω times displacements.
        let step = if column % 2 == 0 { h } else { h * 33.0 };
        let mut d = [0.0; 4];
        d[column] = step;
        let (up, down) = (fly(d), fly(d.map(|v| -v)));
        for row in 0..4 {
            map[(row, column)] = (up[row] - down[row]) / (2.0 * step);
        }
    }
    let found = floquet::multipliers(&map).unwrap();
    for (a, b) in found.iter().zip(orbit.multipliers.unwrap()) {
        // Error: third derivatives of the map times h², relative to the gap: about (1e-7/1e-3)².
        assert!((a - b).norm() < 1e-6, "{a} {b}");
    }
}

#[test]
fn golden_numbers_of_the_clapping_scene() {
    // 0.5 N, R 0.7, ν 2.1. Impulses from the formulas for (C, P, J) in 40-digit arithmetic.
    let rig = Rig::thesis();
    let found = orbits(&rig, 0.5, at(&rig, 2.1)).unwrap();
    let [first, second] = [&found.orbits[0], &found.orbits[1]];
    // ν is converted to a frequency in Hz and back, with three roundings, and J changes by some 30 % per
    // percent of ν.
    let tolerance = 100.0 * f64::EPSILON;
    assert!((first.impulse / 0.026_238_325_207_374_714 - 1.0).abs() < tolerance, "{:.17}", first.impulse);
    assert!((second.impulse / -0.008_944_428_353_726_752 - 1.0).abs() < tolerance);
    let expected = [-0.970_287_19, -0.944_010_47, 0.832_533_01, 0.542_278_39];
    for (m, e) in first.multipliers.unwrap().iter().zip(expected) {
        // The reference has 8 digits.
        assert!((m - e).norm() < 0.6e-8, "{m} {e}");
    }
    let product: Complex64 = first.multipliers.unwrap().iter().product();
    assert!((product - 0.413_524_143_627_467_14).norm() < 1e-13);
    assert!(first.validity.exists && first.validity.admissible && first.validity.stable == Some(true));
    assert!(!second.validity.exists && second.multipliers.is_none());
}

#[test]
fn golden_losses_of_stability() {
    let rig = Rig { restitution: 1.0, ..Rig::thesis() };
    // A flip; reference value −1.326.
    let flip = orbits(&rig, 0.9, at(&rig, 1.2)).unwrap().orbits.remove(0);
    let m = flip.multipliers.unwrap()[0];
    assert!((m - Complex64::new(-1.326, 0.0)).norm() < 6e-4, "{m}");
    assert!(flip.validity.exists && flip.validity.stable == Some(false) && flip.validity.energy_rule);
    assert_eq!(flip.validity.instability, Some(Loss::Flip));
    // A pair outside the circle; reference value 0.389 ± 1.047i.
    let pair = orbits(&rig, 0.05, at(&rig, 1.3)).unwrap().orbits.remove(0);
    let m = pair.multipliers.unwrap();
    assert!(
        (m[0] - Complex64::new(0.389, 1.047)).norm() < 1e-3 && (m[1] - m[0].conj()).norm() < 1e-12,
        "{m:?}"
    );
    assert_eq!(pair.validity.instability, Some(Loss::NeimarkSacker));
    // Passes through the other mass by 6.2 mm (reference value).
    let deep = orbits(&Rig::thesis(), 0.5, at(&rig, 0.8)).unwrap().orbits.remove(0);
    assert!((deep.validity.min_gap + 6.2e-3).abs() < 0.05e-3 && !deep.validity.admissible);
}

/// Without losses the multipliers come in pairs z, 1/z: roots of z⁴ − az³ + bz² − az + 1, with w = z + 1/z a
/// root of w² − aw + b − 2. All z lie on the unit circle if both w are real and within ±2; otherwise one lies
/// outside. Such a motion is never stable.
#[test]
fn a_rig_without_losses_is_neutral_or_unstable() {
    let rig = Rig { c1: 0.0, c2: 0.0, restitution: 1.0, ..Rig::thesis() };
    let (mut neutral, mut unstable) = (0, 0);
    for force in [0.02, 0.1, 0.5, 3.0] {
        for i in 0..300 {
            let nu = 0.7031 + 0.0067 * f64::from(i);
            for orbit in &orbits(&rig, force, at(&rig, nu)).unwrap().orbits {
                let Some(m) = orbit.multipliers else { continue };
                let a: f64 = m.iter().map(|z| z.re).sum();
                let b = (0..4)
                    .flat_map(|i| (0..i).map(move |j| (i, j)))
                    .map(|(i, j)| (m[i] * m[j]).re)
                    .sum::<f64>();
                let root = a * a - 4.0 * (b - 2.0);
                let w = [-1.0, 1.0].map(|sign| f64::midpoint(a, sign * root.max(0.0).sqrt()));
                let outermost = w[0].abs().max(w[1].abs());
                let place = format!("{force} N, ν {nu}: {m:?}");
                // The margin is far above the rounding of a and b, and far below the distance between both
                // cases.
                if root > 1e-6 && outermost < 2.0 - 1e-6 {
                    assert_eq!(
                        (orbit.validity.stable, orbit.validity.stability()),
                        (None, "neutral"),
                        "{place}"
                    );
                    neutral += 1;
                } else if root < -1e-6 || outermost > 2.0 + 1e-6 {
                    assert_eq!(orbit.validity.stable, Some(false), "{place}");
                    unstable += 1;
                }
                assert_ne!(orbit.validity.stable, Some(true), "{place}");
            }
        }
    }
    println!("{neutral} neutral, {unstable} unstable");
    assert!(neutral > 50 && unstable > 50, "{neutral} {unstable}");
}

#[test]
fn the_clapping_peak_is_where_it_was_found() {
    // From an independent calculation: largest impact speed 0.46903 m/s at ν 2.00992.
    let rig = Rig::thesis();
    let speed = |nu: f64| orbits(&rig, 0.5, at(&rig, nu)).unwrap().orbits[0].approach_velocity;
    let top =
        (0..400).map(|i| 1.99 + f64::from(i) * 1e-4).max_by(|a, b| speed(*a).total_cmp(&speed(*b))).unwrap();
    assert!((top - 2.009_92).abs() < 1e-4, "{top}");
    assert!((speed(top) - 0.469_03).abs() < 1e-5);
}

#[test]
fn grazing_distance_is_the_change_of_gap_that_grazes() {
    // The positive root vanishes at Δ = A where C > 0, as at ν = 1. Close to it, the first-order distance is
    // A − Δ.
    let rig = Rig::thesis();
    let frequency = at(&rig, 1.0);
    let amplitude = orbits(&rig, 0.1, frequency).unwrap().no_impact.amplitude;
    let near = Rig { gap: amplitude * (1.0 - 1e-5), ..rig };
    let orbit = orbits(&near, 0.1, frequency).unwrap().orbits.remove(0);
    let expected = amplitude * 1e-5;
    // The second-order error is some tens of times the relative distance, because C is small against P/ω.
    assert!((orbit.validity.grazing_distance / expected - 1.0).abs() < 100.0 * 1e-5, "{:?}", orbit.validity);
    assert!(!orbit.robust(2.0 * expected));
}

#[test]
fn a_motion_that_a_little_more_gap_makes_unstable_is_not_robust() {
    // To first order its impact grazes at a gap 38 mm wider, but it is already unstable at a gap 1.6 mm wider
    // (found by solving at gaps 0.01 mm apart).
    let rig =
        Rig { m1: 0.5, m2: 1.0, k1: 3e4, k2: 8e4, c1: 10.0, c2: 20.0, restitution: 0.5, ..Rig::thesis() };
    let orbit = orbits(&rig, 30.0, 45.0).unwrap().orbits.remove(0);
    assert!(orbit.validity.real() && orbit.validity.grazing_distance > 0.03);
    let lost = (1..200)
        .map(|i| 1e-5 * f64::from(i))
        .find(|more| {
            let wider = Rig { gap: rig.gap + more, ..rig };
            !orbits(&wider, 30.0, 45.0).unwrap().orbits[0].validity.real()
        })
        .unwrap();
    assert!(orbit.robust(0.0) && orbit.robust(0.3 * lost), "{lost}");
    assert!(!orbit.robust(1.01 * lost) && !orbit.robust(2.0 * lost), "{lost}");
}

#[test]
fn the_verdict_on_contacts_is_that_of_the_contact_search() {
    let (mut clear, mut pierced) = (0, 0);
    each(|rig, excitation, orbit| {
        let Excitation::Sine(sine) = excitation else { return };
        // Without rebound the search for contacts would begin with the masses at rest against each other.
        if rig.restitution == 0.0 || orbit.impulse <= 0.0 {
            return;
        }
        let steady = Steady::new(rig, sine).unwrap();
        let flight = crate::flow::tests::flight(rig, &steady, rig.gap, &orbit.state(0.0), orbit.force_phase);
        let second = crate::flow::tests::first_contact(&flight, orbit.period() * (1.0 - 1e-9));
        assert_eq!(orbit.validity.admissible, second.is_none(), "{orbit:?}");
        if second.is_none() { clear += 1 } else { pierced += 1 }
    });
    assert!(clear > 5 && pierced > 5, "{clear} {pierced}");
}

#[test]
fn no_force_and_undamped_resonance_have_no_orbit() {
    assert!(orbits(&Rig::thesis(), 0.0, 5.0).is_err());
    assert!(orbits(&Rig::thesis(), f64::NAN, 5.0).is_err());
    assert!(orbits(&Rig::thesis(), 0.5, 0.0).is_err());
    let tuned = Rig { m2: 1.0, k2: TAU * TAU, c2: 0.0, ..Rig::thesis() };
    let text = orbits(&tuned, 0.5, 1.0).unwrap_err().to_string();
    assert!(text.contains("without a damper"), "{text}");
    let rig = Rig::thesis();
    let train =
        |impulse, frequency| orbits_of(&rig, &Excitation::Impulse(Impulses { impulse, frequency }), 1);
    assert!(train(0.0, 5.0).is_err() && train(0.1, f64::NAN).is_err());
    assert!(orbits_of(&rig, &Excitation::Sines(Sines { parts: Vec::new() }), 1).is_err());
    let tuned = Rig { c1: 0.0, m1: 1.0, k1: TAU * TAU, ..rig };
    assert!(orbits_of(&tuned, &Excitation::Impulse(Impulses { impulse: 0.1, frequency: 0.5 }), 1).is_err());
    // Unbounded work is refused.
    let text =
        orbits_of(&rig, &Sine { force: 0.5, frequency: 5.0 }.into(), 1_000_000_000).unwrap_err().to_string();
    assert!(text.contains("swings"), "{text}");
    assert!(train(0.1, 1e-9).is_err() && orbits(&rig, 0.5, 1e-9).is_err());
    assert!(orbits_of(&rig, &Sine { force: 0.5, frequency: 5.0 }.into(), 0).is_err());
}

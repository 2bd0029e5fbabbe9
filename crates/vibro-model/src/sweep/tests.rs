use super::*;
use crate::contact::Compliant;
use crate::excitation::{Excitation, Pulses, Sine};
use crate::flow::State;
use crate::law::Law;
use crate::orbit::{orbits, orbits_of};
use crate::rig::Rig;
use crate::scene::Buffer;
use crate::simulate::Simulation;

fn both<M: Motion + Clone + Sync>(
    plan: &Plan,
    motion: &M,
    force: f64,
    directions: &[Direction],
) -> Result<Swept> {
    apart(directions, |direction| plan.frequency(&mut motion.clone(), force, direction))
}

const BOTH: [Direction; 2] = [Direction::Up, Direction::Down];

/// The contact of the thesis: c₃ = 0.1 N s/m on k₃ = 1e5 N/m, so ζ = c₃/2√(k₃M) and
/// R = exp(−ζ(π − 2 asin ζ)/√(1 − ζ²)).
fn thesis() -> Rig {
    let rig = Rig::thesis();
    let zeta = 0.1 / (2.0 * (1e5 * rig.reduced_mass()).sqrt());
    let angle = std::f64::consts::PI - 2.0 * zeta.asin();
    Rig { restitution: (-zeta * angle / (1.0 - zeta * zeta).sqrt()).exp(), ..rig }
}

fn highest(points: &[Point], from: f64, to: f64) -> Point {
    let inside = points.iter().filter(|p| (from..=to).contains(&p.frequency));
    *inside.max_by(|a, b| a.x1.total_cmp(&b.x1)).unwrap()
}

#[test]
fn the_thesis_sweep_has_its_peaks() {
    let pace = Pace::Rate { rate: 0.02, points: 2200 };
    let plan = Plan { from: 3.0, to: 14.0, pace, observable: Observable::Rms };
    let motion = Simulation::new(&thesis(), &Sine { force: 0.1, frequency: 3.0 }).unwrap();
    let swept = both(&plan, &motion, 0.1, &BOTH).unwrap();
    // Thesis, with a compliant contact: 5.58 and 10.59 Hz up, only 5.44 Hz down. With rigid impacts the upper
    // peak is slightly higher: without the time in contact (2.3 ms) the cycle is shorter by that, up to 10.85
    // Hz.
    assert!((highest(&swept.up, 3.0, 8.0).frequency - 5.58).abs() < 0.05);
    let clapping = highest(&swept.up, 8.0, 14.0);
    assert!((10.5..10.9).contains(&clapping.frequency), "{clapping:?}");
    assert!((highest(&swept.down, 3.0, 14.0).frequency - 5.44).abs() < 0.1);
    // In the sweep down there is only the linear response near the upper peak.
    let down = highest(&swept.down, 8.5, 14.0);
    assert!(down.x1 < 0.2 * clapping.x1, "{down:?} {clapping:?}");
}

/// Peaks of an independent simulation of the thesis' sweeps (continuous, 0.02 Hz/s, running RMS). Sine 0.1 N:
/// 5.58 and 10.59 Hz up, only 5.44 Hz down. Pulse 0.5 N of 10 ms: 5.58 and 10.71 Hz up with a sub-harmonic
/// peak near 2.81 Hz, 5.42 Hz down. Loose mass under 0.1 N (spring and damper in compression only, beyond 1
/// mm): 4.66 and 10.23 Hz up.
#[test]
fn the_thesis_contact_that_gives_way_has_the_known_peaks() {
    let rig = Rig::thesis();
    let law = Law::spring(1e5, 0.1);
    let pace = Pace::Rate { rate: 0.02, points: 2200 };
    let plan = |from: f64| Plan { from, to: 14.0, pace, observable: Observable::Rms };
    let sine = |frequency| Excitation::Sine(Sine { force: 0.1, frequency });
    let swept = apart(&BOTH, |direction| {
        let start = if direction == Direction::Up { 3.0 } else { 14.0 };
        let mut motion = Compliant::new(&rig, &sine(start), law, State::REST, 0.0)?;
        plan(3.0).frequency(&mut motion, 0.1, direction)
    })
    .unwrap();
    let tops = |swept: &Swept| {
        [highest(&swept.up, 4.0, 8.0), highest(&swept.up, 8.0, 14.0), highest(&swept.down, 4.0, 14.0)]
            .map(|p| p.frequency)
    };
    println!("sine: {:?}", tops(&swept));
    let [grazing, clapping, down] = tops(&swept);
    assert!((grazing - 5.58).abs() < 0.05 && (clapping - 10.59).abs() < 0.1 && (down - 5.44).abs() < 0.1);
    // The sweep starts at 3 Hz, as in the thesis: between 6 and 7.5 Hz the motion is irregular, and the start
    // decides whether the impacts persist (2 of 6 starts from 1.5 to 1.6 Hz do not reach the clapping
    // branch). The sub-harmonic peak is below 3 Hz.
    let pulses = |frequency| {
        let pulses = Excitation::Pulse(Pulses { force: 0.5, width: 0.01, frequency });
        Compliant::new(&rig, &pulses, law, State::REST, 0.0)
    };
    let swept = apart(&BOTH, |direction| {
        let mut motion = pulses(if direction == Direction::Up { 3.0 } else { 14.0 })?;
        plan(3.0).frequency(&mut motion, 0.5, direction)
    })
    .unwrap();
    let low = Plan { to: 4.0, ..plan(1.5) };
    let below = low.frequency(&mut pulses(1.5).unwrap(), 0.5, Direction::Up).unwrap();
    let below = highest(&below, 2.3, 3.3).frequency;
    println!("pulse: {:?}, below {below}", tops(&swept));
    let [grazing, clapping, down] = tops(&swept);
    assert!((grazing - 5.58).abs() < 0.05 && (clapping - 10.71).abs() < 0.1 && (down - 5.42).abs() < 0.1);
    assert!((below - 2.81).abs() < 0.05, "{below}");
    let mut loose =
        Compliant::loose(&rig, &sine(3.0), Buffer::thesis(), Some(law), State::REST, 0.0).unwrap();
    let up = plan(3.0).frequency(&mut loose, 0.1, Direction::Up).unwrap();
    let [grazing, clapping] = [highest(&up, 3.0, 8.0), highest(&up, 8.0, 14.0)];
    println!("loose: {grazing:?} {clapping:?}");
    // The motion is irregular around the lower peak: two starts of the independent simulation differ by 0.04
    // Hz.
    assert!((grazing.frequency - 4.66).abs() < 0.1 && (clapping.frequency - 10.23).abs() < 0.05);
}

#[test]
fn a_settled_step_is_the_closed_form() {
    let rig = Rig { restitution: 0.5, ..Rig::thesis() };
    for (observable, read) in [(Observable::Fundamental, 0), (Observable::Peak, 1)] {
        let pace = Pace::Steps { points: 5, settle: 600, measure: 4 };
        let plan = Plan { from: 9.0, to: 11.0, pace, observable };
        let motion = Simulation::new(&rig, &Sine { force: 0.5, frequency: 9.0 }).unwrap();
        for point in both(&plan, &motion, 0.5, &[Direction::Up]).unwrap().up {
            let orbit = orbits(&rig, 0.5, point.frequency).unwrap().orbits.remove(0);
            assert_eq!(orbit.validity.stable, Some(true));
            let expected = match read {
                0 => orbit.fundamental.map(num_complex::Complex64::norm),
                _ => orbit.peak_to_peak.map(|x| x / 2.0),
            };
            // 32 samples a cycle: errors of 3e-6 and 4e-6 of the amplitude in the leading term, plus those of
            // the harmonics.
            for (found, expected) in [point.x1, point.x2].into_iter().zip(expected) {
                assert!((found / expected - 1.0).abs() < 1e-5, "{observable:?} {found} {expected}");
            }
            assert!(point.x1_scatter < 1e-6 * point.x1);
            // The phase errs by as much as the amplitudes, in rad.
            let phase = (orbit.fundamental[1] / orbit.fundamental[0]).arg();
            let off = (point.relative_phase.unwrap() - phase).abs();
            assert!(off.min(TAU - off) < 1e-5, "{point:?} {phase}");
            assert!(point.is_regular(0.0));
        }
    }
}

#[test]
fn the_running_rms_of_a_linear_motion_is_its_amplitude() {
    // x² = A²/2 (1 + cos 2ωt): the low-pass reduces the term 2ω by 10/√(100 + 4ω²), to 4 % at 20 Hz. The mean
    // of the root over whole cycles is then lower than √(mean) by that squared over 16.
    let rig = Rig { c1: 1.0, ..Rig::thesis() };
    let pace = Pace::Steps { points: 3, settle: 200, measure: 10 };
    let plan = Plan { from: 20.0, to: 22.0, pace, observable: Observable::Rms };
    let motion = Simulation::new(&rig, &Sine { force: 0.5, frequency: 20.0 }).unwrap();
    for point in both(&plan, &motion, 0.5, &[Direction::Up]).unwrap().up {
        let [l1, _] = rig.receptances(TAU * point.frequency);
        let ripple = LOW_PASS / (2.0 * TAU * point.frequency).hypot(LOW_PASS);
        let expected = 0.5 * l1.norm() / 2.0_f64.sqrt() * (1.0 - ripple * ripple / 16.0);
        assert!((point.x1 / expected - 1.0).abs() < 1e-5, "{} {expected}", point.x1);
        assert_eq!(point.x2, 0.0);
    }
}

#[test]
fn a_slow_rate_follows_the_steps_and_ends_in_phase() {
    let rig = Rig { restitution: 0.5, ..Rig::thesis() };
    let pace = Pace::Rate { rate: 0.002, points: 20 };
    let plan = Plan { from: 9.9, to: 10.1, pace, observable: Observable::Fundamental };
    let mut motion = Simulation::new(&rig, &Sine { force: 0.5, frequency: 9.9 }).unwrap();
    let points = plan.frequency(&mut motion, 0.5, Direction::Up).unwrap();
    for point in &points[5..] {
        let orbit = orbits(&rig, 0.5, point.frequency).unwrap().orbits.remove(0);
        // The motion lags by its settling time of about 2 s: 0.004 Hz, over which the amplitude changes by
        // less than 1 %.
        assert!((point.x1 / orbit.fundamental[0].norm() - 1.0).abs() < 0.01, "{point:?}");
    }
    // (10.1² − 9.9²)/2·0.002 = 1000 whole cycles.
    let end = motion.phase();
    assert!(end.min(TAU - end) < 1e-9, "{end}");
}

#[test]
fn the_force_is_swept_like_the_frequency() {
    let rig = Rig { restitution: 0.5, ..Rig::thesis() };
    let plan = Plan {
        from: 0.3,
        to: 0.6,
        pace: Pace::Steps { points: 4, settle: 600, measure: 2 },
        observable: Observable::Fundamental,
    };
    let start = Simulation::new(&rig, &Sine { force: 0.3, frequency: 10.0 }).unwrap();
    let swept = apart(&[Direction::Down], |direction| {
        plan.steps(&mut start.clone(), direction, |motion, force| {
            let sine = Sine { force, frequency: 10.0 };
            motion.set_excitation(&Excitation::Sine(sine))?;
            Ok((10.0, force))
        })
    });
    let down = swept.unwrap().down;
    assert_eq!(down.iter().map(|p| p.force).fold(f64::INFINITY, f64::min), 0.3);
    for point in down {
        let orbit = orbits(&rig, point.force, 10.0).unwrap().orbits.remove(0);
        assert!((point.x2 / orbit.fundamental[1].norm() - 1.0).abs() < 1e-5, "{point:?}");
    }
}

#[test]
fn impossible_sweeps_are_refused() {
    let steps = Pace::Steps { points: 10, settle: 10, measure: 1 };
    let good = Plan { from: 3.0, to: 14.0, pace: steps, observable: Observable::Peak };
    assert!(good.check().is_ok());
    for (plan, word) in [
        (Plan { from: 14.0, to: 3.0, ..good }, "between 14 and 3"),
        (Plan { from: f64::NAN, ..good }, "NaN"),
        (Plan { from: -1.0, ..good }, "-1"),
        (Plan { pace: Pace::Steps { points: 1, settle: 1, measure: 1 }, ..good }, "1 points"),
        (Plan { pace: Pace::Steps { points: 10, settle: 1_000_000_000, measure: 1 }, ..good }, "more than"),
        (Plan { pace: Pace::Rate { rate: 0.0, points: 9 }, ..good }, "rate of 0"),
        (Plan { pace: Pace::Rate { rate: 1e-9, points: 9 }, ..good }, "more than"),
    ] {
        let text = plan.check().unwrap_err().to_string();
        assert!(text.contains(word), "{text}");
    }
    // The simulation refuses a frequency of 0.
    let mut motion = Simulation::new(&Rig::thesis(), &Sine { force: 0.1, frequency: 3.0 }).unwrap();
    assert!(Plan { from: 0.0, ..good }.frequency(&mut motion, 0.1, Direction::Up).is_err());
}

/// Under slow pulses the masses swing many times a cycle: the line at the excitation frequency is small
/// beside the whole motion, and must still be read exactly. Reference: the line of the force, 2F/π sin(πw/T),
/// times the receptance.
#[test]
fn slow_pulses_are_read_like_fast_ones() {
    let rig = Rig::thesis();
    let (force, width) = (0.05, 0.01);
    for frequency in [0.2, 0.3, 0.5, 1.0, 7.0] {
        let pulses = Excitation::Pulse(Pulses { force, width, frequency });
        let read = |observable| {
            let mut motion = Simulation::new(&rig, &pulses).unwrap();
            let pace = Pace::Steps { points: 2, settle: (60.0 * frequency) as u32, measure: 4 };
            let plan = Plan { from: frequency, to: frequency * (1.0 + 1e-9), pace, observable };
            plan.frequency(&mut motion, force, Direction::Up).unwrap()[1]
        };
        let omega = TAU * frequency;
        let line = 2.0 * force / std::f64::consts::PI * (omega * width / 2.0).sin();
        let expected = line * rig.receptances(omega)[0].norm();
        let (found, peak) = (read(Observable::Fundamental), read(Observable::Peak).x1);
        // After 60 s e^{−24} of the transient remains; the gauge's error is 3e-6 of the largest displacement.
        assert!((found.x1 - expected).abs() < 1e-5 * peak, "{frequency} Hz: {found:?} {expected} {peak}");
        let exact = orbits_of(&rig, &pulses, 1).unwrap().no_impact.amplitude;
        assert!((peak / exact - 1.0).abs() < 1e-5, "{frequency} Hz: {peak} {exact}");
    }
}

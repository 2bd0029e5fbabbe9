use super::*;
use crate::excitation::Sine;
use crate::motion::{Event, Motion};
use vibro_math::runge_kutta::{Dop853, Integrator, Tolerance};

fn sine(force: f64, frequency: f64) -> Excitation {
    Excitation::Sine(Sine { force, frequency })
}

/// A buffer whose damper always acts.
const ALWAYS: Buffer = Buffer { gap: 2e-3, damper_always: true };

#[test]
fn a_loose_mass_drifts_freely_and_swings_back_by_half_a_period() {
    // At 10 mm/s mass 1 drifts 1 mm until it meets mass 2, and also 1 mm to the thesis' buffer.
    let rig = Rig::thesis();
    for (v1, event) in [(0.01, "Impact"), (-0.01, "Switch")] {
        let start = State { v1, ..State::REST };
        let mut motion = Compliant::loose(&rig, &sine(0.0, 5.0), Buffer::thesis(), None, start, 0.0).unwrap();
        let mut times = Vec::new();
        motion
            .advance(0.2, &mut |piece| {
                if format!("{:?}", piece.event).starts_with(event) {
                    times.push(piece.start + piece.duration);
                }
            })
            .unwrap();
        assert!((times[0] - 0.1).abs() < 1e-15, "{times:?}");
        if event == "Switch" {
            let b = rig.c1 / (2.0 * rig.m1);
            let half = std::f64::consts::PI / (rig.k1 / rig.m1 - b * b).sqrt();
            assert!((times[1] - times[0] - half).abs() < 1e-15, "{times:?}");
            // It returns with the speed of the damped half swing, and keeps it: no force acts on it.
            assert!((motion.state().v1 - 0.01 * (-b * half).exp()).abs() < 1e-16, "{:?}", motion.state());
        }
    }
}

#[test]
fn a_loose_mass_drifts_with_its_damper_only() {
    // x = vτ(1 − e^{−t/τ}), τ = m₁/c₁, until it meets mass 2 at 1 mm.
    let rig = Rig::thesis();
    let start = State { v1: 0.01, ..State::REST };
    let mut motion = Compliant::loose(&rig, &sine(0.0, 5.0), ALWAYS, None, start, 0.0).unwrap();
    let mut met = None;
    motion
        .advance(0.2, &mut |piece| {
            if let Event::Impact(impact) = piece.event {
                met.get_or_insert(impact.time);
            }
        })
        .unwrap();
    let tau = rig.m1 / rig.c1;
    let expected = -tau * (1.0 - 1e-3 / (0.01 * tau)).ln();
    assert!((met.unwrap() - expected).abs() < 1e-15, "{met:?} {expected}");
    // In the other direction it meets its spring after 2 mm.
    let start = State { v1: -0.01, ..State::REST };
    let mut motion = Compliant::loose(&rig, &sine(0.0, 5.0), ALWAYS, None, start, 0.0).unwrap();
    let mut switches = Vec::new();
    motion
        .advance(0.5, &mut |piece| {
            if piece.event == Event::Switch {
                switches.push(piece.start + piece.duration);
            }
        })
        .unwrap();
    let expected = -tau * (1.0 - 2e-3 / (0.01 * tau)).ln();
    assert_eq!(switches.len(), 2);
    assert!((switches[0] - expected).abs() < 1e-15, "{switches:?} {expected}");
    // It leaves the spring where the compression is zero again, half a period of the damped oscillator later.
    let b = rig.c1 / (2.0 * rig.m1);
    let half = std::f64::consts::PI / (rig.k1 / rig.m1 - b * b).sqrt();
    assert!((switches[1] - switches[0] - half).abs() < 1e-15, "{switches:?}");
}

#[test]
fn all_four_modes_agree_with_a_plain_integration() {
    for damper_always in [false, true] {
        agrees(Buffer { gap: 5e-4, damper_always });
    }
}

fn agrees(buffer: Buffer) {
    let rig = Rig::thesis();
    let (k3, c3, force, omega) = (1e4, 5.0, 0.3, std::f64::consts::TAU * 5.0);
    let law = Law::spring(k3, c3);
    let mut motion = Compliant::loose(&rig, &sine(force, 5.0), buffer, Some(law), State::REST, 0.3).unwrap();
    let (mut touches, mut switches) = (0, 0);
    motion
        .advance(1.0, &mut |piece| {
            touches += usize::from(piece.event == Event::Touch);
            switches += usize::from(piece.event == Event::Switch);
        })
        .unwrap();
    assert!(touches > 3 && switches > 3, "{touches} contacts, {switches} switches");
    let f = |t: f64, y: &[f64; 4]| {
        let push = law.force(y[0] - y[2] - rig.gap, y[1] - y[3]);
        let compressed = y[0] < -buffer.gap;
        let spring = if compressed { rig.k1 * (y[0] + buffer.gap) } else { 0.0 };
        let damper = if compressed || buffer.damper_always { rig.c1 * y[1] } else { 0.0 };
        let drive = force * (omega * t + 0.3).cos();
        [
            y[1],
            (drive - spring - damper - push) / rig.m1,
            y[3],
            (push - rig.k2 * y[2] - rig.c2 * y[3]) / rig.m2,
        ]
    };
    let tolerance = Tolerance { relative: 1e-14, floor: [1e-3, 0.1, 1e-3, 0.1] };
    let mut plain = Integrator::<Dop853, 4>::new(f, 0.0, [0.0; 4], 1e-4, tolerance);
    while plain.time() < 1.0 {
        plain.step(f, 1.0).unwrap();
    }
    let s = motion.state();
    for (found, expected) in [s.x1, s.v1, s.x2, s.v2].iter().zip(plain.y()) {
        // Some thousand steps of 1e-14, and kinks within steps, which the error estimate limits to 1e-14.
        assert!((found - expected).abs() < 1e-10, "{s:?} {:?}", plain.y());
    }
}

#[test]
fn the_upward_sweep_has_its_resonance_where_the_thesis_has() {
    // Contact of the thesis: 1e5 N/m with a damper of 0.1 N s/m; 0.1 N, 0.02 Hz/s in steps of 1 ms. In an
    // independent integration (Runge–Kutta of fourth order, 10 µs) the running RMS through a 10 rad/s
    // low-pass is largest at 4.62 to 4.66 Hz: the motion is irregular there, so this depends on the start.
    let law = Law::spring(1e5, 0.1);
    let mut motion =
        Compliant::loose(&Rig::thesis(), &sine(0.1, 3.0), Buffer::thesis(), Some(law), State::REST, 0.0)
            .unwrap();
    let (mut square, mut peak) = (0.0, (0.0, 0.0));
    let steps = 150_000;
    for i in 0..steps {
        let hz = 3.0 + 3.0 * f64::from(i) / f64::from(steps);
        motion.set_frequency(hz).unwrap();
        motion.advance(f64::from(i + 1) * 1e-3, &mut |_| {}).unwrap();
        square += 1e-3 * 10.0 * (motion.state().v1.powi(2) - square);
        if square > peak.0 {
            peak = (square, hz);
        }
    }
    assert!((peak.1 - 4.64).abs() < 0.07, "peak at {} Hz", peak.1);
}

#[test]
fn chatter_and_cuts_do_not_stop_a_loose_mass() {
    // Interrupted every millisecond, with a changing frequency: contacts with mass 2 begin and end many
    // times.
    let rig = Rig { restitution: 0.2, ..Rig::thesis() };
    let mut motion =
        Compliant::loose(&rig, &sine(0.1, 3.0), Buffer::thesis(), None, State::REST, 0.0).unwrap();
    let (mut sticks, mut releases) = (0, 0);
    for i in 0..20_000 {
        motion.set_frequency(3.0 + f64::from(i) * 2e-5).unwrap();
        motion
            .advance(f64::from(i + 1) * 1e-3, &mut |piece| {
                sticks += usize::from(piece.event == Event::Stick);
                releases += usize::from(piece.event == Event::Release);
            })
            .unwrap();
        let s = motion.state();
        assert!(s.x1 - s.x2 - 1e-3 < 1e-15, "overlap at {} s", motion.time());
    }
    assert!(sticks > 3 && sticks - releases <= 1, "{sticks} {releases}");
}

#[test]
fn impossible_ones_are_refused() {
    let rig = Rig::thesis();
    let new = |rig: &Rig, gap, state| {
        let buffer = Buffer { gap, ..Buffer::thesis() };
        Compliant::loose(rig, &sine(0.1, 5.0), buffer, None, state, 0.0)
    };
    for gap in [-1e-3, f64::NAN, f64::INFINITY] {
        let text = new(&rig, gap, State::REST).unwrap_err().to_string();
        assert!(text.starts_with("buffer gap is"), "{text}");
    }
    assert!(new(&rig, 0.0, State { x1: 2e-3, ..State::REST }).is_err());
    assert!(new(&Rig { m1: 0.0, ..rig }, 0.0, State::REST).is_err());
    let hertz = Law::hertz(1e8);
    assert!(
        Compliant::loose(&rig, &sine(0.1, 5.0), Buffer::thesis(), Some(hertz), State::REST, 0.0).is_err()
    );
}

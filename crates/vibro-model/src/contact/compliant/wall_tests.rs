use super::*;
use crate::excitation::Sine;

#[test]
fn sticking_and_release_come_when_they_should() {
    // Scene C: gap −0.5 mm, force 0.35 N sin ωt at ν = 0.45, x₁ = −2 mm at the start. The expected times
    // come from an independent computation.
    let rig = Rig { gap: -5e-4, ..Rig::thesis() };
    let frequency = 0.45 * (rig.k1 / rig.m1).sqrt() / std::f64::consts::TAU;
    let sine = Excitation::Sine(Sine { force: 0.35, frequency });
    let start = State { x1: -2e-3, ..State::REST };
    let phase = -std::f64::consts::FRAC_PI_2;
    let mut motion = Compliant::start(&rig, &sine, None, None, start, phase).unwrap();
    let mut found = Vec::new();
    motion
        .advance(0.65, &mut |piece| {
            if matches!(piece.event, Event::Stick | Event::Release) {
                found.push((piece.event, piece.start + piece.duration));
            }
        })
        .unwrap();
    let expected = [
        (Event::Stick, 0.152_721_089_353_360_45),
        (Event::Release, 0.220_247_418_265_660_51),
        (Event::Stick, 0.574_521_373_816_090_7),
    ];
    assert_eq!(found.len(), 3, "{found:?}");
    for ((event, time), (kind, golden)) in found.iter().zip(expected) {
        assert_eq!(*event, kind);
        // The last rebounds, below 1e-9 m/s, are left out: 2·1e-9/(a(1 − R)) s.
        assert!((time - golden).abs() < 2e-8, "{event:?} {time}");
    }
    assert!((found[1].1 - expected[1].1).abs() < 1e-9, "{found:?}");
}

#[test]
fn rebounds_are_those_of_the_closed_form_flights() {
    use crate::simulate::Simulation;
    let rig = Rig::thesis();
    let sine = Sine { force: 0.5, frequency: 11.0 };
    let mut plain = Vec::new();
    Simulation::new(&rig, &sine).unwrap().run(2.0, |leg| plain.extend(leg.impact())).unwrap();
    let mut found = Vec::new();
    let mut motion = Compliant::start(&rig, &Excitation::Sine(sine), None, None, State::REST, 0.0).unwrap();
    motion
        .advance(2.0, &mut |piece| {
            if let Event::Impact(impact) = piece.event {
                found.push(impact);
            }
        })
        .unwrap();
    assert_eq!(found.len(), plain.len());
    for (a, b) in found.iter().zip(&plain) {
        // Roundings of times up to 2 s and of displacements of 10 mm, over 20 impacts.
        assert!((a.time - b.time).abs() < 1e-13, "{a:?} {b:?}");
        assert!((a.impulse / b.impulse - 1.0).abs() < 1e-11, "{a:?} {b:?}");
    }
}

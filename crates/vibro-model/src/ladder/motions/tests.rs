use super::{Answer, CurrentMotion, DrivenScene, Followed, MotionReader, Motions};
use crate::contact::Compliant;
use crate::excitation::{Excitation, Sine};
use crate::flow::State;
use crate::ladder::tests::fastest;
use crate::ladder::{Choice, Model, Need, Question, choose};
use crate::motion::Motion;
use crate::observable::Observable;
use crate::rig::Rig;
use crate::scene::{ContactKeys, Scene};
use crate::simulate::Simulation;
use std::f64::consts::TAU;
use vibro_math::runge_kutta::{Dop853, Integrator, Tolerance};
use vibro_record::{Direction, Fact};

fn asked(restitution: f64, force: f64, frequency: f64, history: Option<Direction>) -> Choice {
    let scene = Scene {
        rig: Rig { restitution, ..Rig::thesis() },
        excitation: Some(Excitation::Sine(Sine { force, frequency })),
        contact: Some(ContactKeys { stiffness: Some(1e9), ..ContactKeys::default() }),
        buffer: None,
        springs: None,
        uncertainty: None,
    };
    let question = Question { history, ..Question::new(Observable::Fundamental) };
    choose(&scene, frequency, &question).unwrap()
}

/// Choice for the thesis' rig by its impact speed, without a history.
fn speeds(restitution: f64, force: f64, frequency: f64, stiffness: f64) -> Choice {
    let scene = Scene {
        rig: Rig { restitution, ..Rig::thesis() },
        excitation: Some(Excitation::Sine(Sine { force, frequency })),
        contact: Some(ContactKeys { stiffness: Some(stiffness), ..ContactKeys::default() }),
        buffer: None,
        springs: None,
        uncertainty: None,
    };
    choose(&scene, frequency, &Question::new(Observable::ImpactSpeed)).unwrap()
}

/// Number of impacts in the second half of the last of `stations` (Hz, cycles), by numerical integration
/// from rest through all stations.
fn impacts_at_the_end(rig: &Rig, force: f64, stations: &[(f64, f64)]) -> usize {
    let mut y = [0.0; 4];
    let mut phase = 0.0;
    let mut counted = 0;
    for (i, (frequency, cycles)) in stations.iter().enumerate() {
        let omega = TAU * frequency;
        let rate = |t: f64, y: &[f64; 4]| {
            [
                y[1],
                (force * (omega * t + phase).cos() - rig.k1 * y[0] - rig.c1 * y[1]) / rig.m1,
                y[3],
                (-rig.k2 * y[2] - rig.c2 * y[3]) / rig.m2,
            ]
        };
        let floor = [rig.gap, rig.gap * omega, rig.gap, rig.gap * omega];
        let tolerance = Tolerance { relative: 1e-10, floor };
        let (until, mut now) = (cycles / frequency, 0.0);
        while now < until {
            let mut plain = Integrator::<Dop853, 4>::new(|t, y| rate(now + t, y), 0.0, y, 1e-4, tolerance);
            let mut hit = None;
            while hit.is_none() && now + plain.time() < until {
                let start = plain.time();
                let step = plain.step(|t, y| rate(now + t, y), until - now).unwrap();
                y = *plain.y();
                hit = step.first_fall(&[-1.0, 0.0, 1.0, 0.0], rig.gap).map(|t| (start + t, step.at(t)));
            }
            let Some((t, before)) = hit else { break };
            now += t;
            y = before;
            // Rounding may leave an overlap, so the masses are put just apart.
            y[0] = y[2] + rig.gap * (1.0 - 1e-12);
            let impulse = (1.0 + rig.restitution) * (y[1] - y[3]).max(0.0) / (1.0 / rig.m1 + 1.0 / rig.m2);
            y[1] -= impulse / rig.m1;
            y[3] += impulse / rig.m2;
            counted += usize::from(i + 1 == stations.len() && now > until / 2.0);
        }
        phase = (phase + TAU * cycles).rem_euclid(TAU);
    }
    counted
}

#[test]
fn impacts_that_a_rising_frequency_keeps_are_followed() {
    // At 6.8 Hz every orbit with one impact a cycle is unstable, and the motion without impacts is possible
    // and reached from rest; but in a sweep up from 5.5 Hz, where the masses must meet, the impacts persist.
    let rig = Rig { restitution: 0.7, ..Rig::thesis() };
    let mut stations: Vec<(f64, f64)> = (0..13).map(|i| (5.5 + 0.1 * f64::from(i), 60.0)).collect();
    stations.push((6.8, 600.0));
    let lasting = impacts_at_the_end(&rig, 0.05, &stations);
    assert!(lasting > 200, "{lasting}");
    assert_eq!(impacts_at_the_end(&rig, 0.05, &[(6.8, 600.0)]), 0);
    let up = asked(0.7, 0.05, 6.8, Some(Direction::Up));
    assert!(up.chosen.is_some_and(|m| m >= Model::Restitution), "{:?}", up.findings);
    assert!(!up.rung(Model::Linear).valid);
    // A sweep down starts where there are no impacts.
    assert_eq!(asked(0.7, 0.05, 6.8, Some(Direction::Down)).chosen, Some(Model::Linear));
    // Without a history the motion is not determined.
    let open = asked(0.7, 0.05, 6.8, None);
    assert_eq!((open.chosen, open.needs.as_slice()), (None, &[Need::History][..]));
    assert!(open.motions.iter().any(|m| !m.stable));
    assert_eq!(open.findings[0].code, "several-motions");
    assert!(open.findings[0].fact("unstable").is_some());
}

#[test]
fn a_motion_that_repeats_nothing_is_on_no_orbit() {
    // The motion has nearly the impact speed and amplitudes of an orbit (largest multiplier 1.0000), but is
    // not periodic.
    let choice = asked(0.98, 0.1, 7.0, Some(Direction::Up));
    let closed = choice.rung(Model::ClosedForm);
    assert!(!closed.valid && closed.reasons.iter().any(|r| r.code == "other-motion"), "{closed:?}");
    // The answers agree within the tolerance, so only the comparison of states tells the motions apart.
    let (orbit, motion) = (closed.answer.unwrap(), choice.rung(Model::Restitution).answer.unwrap());
    assert!((orbit[0] / motion[0] - 1.0).abs() < 0.02, "{orbit:?} {motion:?}");
    assert!(choice.chosen != Some(Model::ClosedForm));
    // A motion on an orbit is recognised.
    let on = asked(0.98, 0.5, 10.98, None);
    assert!(on.rung(Model::ClosedForm).valid, "{:?}", on.findings);
}

#[test]
fn impacts_that_alternate_ever_less_are_no_second_motion() {
    let choice = asked(Rig::thesis().restitution, 0.5, 11.2, None);
    let patterns: Vec<String> = choice.motions.iter().map(|m| m.pattern.to_string()).collect();
    assert_eq!((patterns, choice.chosen), (vec!["1/1".to_owned()], Some(Model::ClosedForm)));
}

/// Number of impacts of the thesis' rig in 240 cycles, after 3000 cycles from a state at phase 0.
fn impacts_from(restitution: f64, force: f64, frequency: f64, state: State) -> usize {
    let rig = Rig { restitution, ..Rig::thesis() };
    let mut motion = Simulation::from_state(&rig, &Sine { force, frequency }, state, 0.0).unwrap();
    motion.run(3000.0 / frequency, |_| {}).unwrap();
    let mut impacts = 0;
    motion
        .run(motion.time() + 240.0 / frequency, |leg| impacts += usize::from(leg.impact().is_some()))
        .unwrap();
    impacts
}

#[test]
fn motions_that_strike_less_than_once_a_cycle_are_warned_of() {
    // There is no motion with one impact a cycle, and from rest there are no impacts. At 32.98 Hz an orbit of
    // 4 cycles is stable; at 12.97 Hz and at ν 2.6 an orbit of 2 cycles is unstable by a flip, and patterns
    // of 8 and of 4 cycles lie around it.
    let state = State { x1: -4e-3, v1: 0.3, x2: -1e-3, v2: -0.2 };
    assert!(impacts_from(0.7, 0.3, 12.9701, state) > 100);
    for (restitution, force, frequency, pattern) in
        [(0.9, 0.6, 32.9769, "1/4"), (0.7, 0.3, 12.9701, "4/8"), (0.7, 0.3, 13.5986, "2/4")]
    {
        assert_eq!(impacts_from(restitution, force, frequency, State::REST), 0);
        let open = asked(restitution, force, frequency, None);
        // The answer is the motion from rest, without impacts.
        assert_eq!((open.chosen, open.needs.len()), (Some(Model::Linear), 0), "{:?}", open.findings);
        let patterns: Vec<(String, bool)> =
            open.motions.iter().map(|m| (m.pattern.to_string(), m.rare)).collect();
        assert_eq!(patterns[..2], [("no impact".to_owned(), false), (pattern.to_owned(), true)]);
        let rare = open.findings.iter().find(|f| f.code == "rare-motions").unwrap();
        let named = rare.fact("motions");
        assert!(matches!(named, Some(Fact::Name(all)) if all.contains(pattern)), "{named:?}");
        let fell = asked(restitution, force, frequency, Some(Direction::Down));
        assert_eq!(fell.chosen, Some(Model::Linear), "{:?}", fell.findings);
    }
    // The search for other motions is reported, once.
    let linear = asked(0.7, 0.05, 13.5986, None);
    assert_eq!(linear.chosen, Some(Model::Linear));
    let searched = ["other-motions-searched", "search-cut"];
    assert_eq!(linear.findings.iter().filter(|f| searched.contains(&f.code.as_ref())).count(), 1);
}

#[test]
fn a_contact_that_leads_from_rest_to_another_motion_asks_for_the_history() {
    let rig = Rig {
        m1: 0.19582,
        m2: 0.38351,
        k1: 3661.2,
        k2: 3952.9,
        c1: 1.3178,
        c2: 6.312,
        gap: 0.188_32e-3,
        restitution: 0.98,
    };
    let excitation = Excitation::Sine(Sine { force: 3.3475, frequency: 17.196 });
    let scene = Scene {
        rig,
        excitation: Some(excitation.clone()),
        contact: Some(ContactKeys { stiffness: Some(529_320.0), ..ContactKeys::default() }),
        buffer: None,
        springs: None,
        uncertainty: None,
    };
    let question = Question { tolerance: 0.002, ..Question::new(Observable::HalfPeakToPeak) };
    let open = choose(&scene, 17.196, &question).unwrap();
    assert_eq!((open.chosen, open.needs.as_slice()), (None, &[Need::History][..]), "{:?}", open.findings);
    let soft = open.motions.last().unwrap();
    assert_eq!((soft.model, soft.pattern.to_string().as_str()), (Model::KelvinVoigt, "1/1"));
    // Reference: largest and smallest of 2000 samples of x₁ over one cycle, 2000 cycles after a start from
    // rest.
    let law = scene.spring(529_320.0).unwrap();
    let mut motion = Compliant::new(&rig, &excitation, law, State::REST, 0.0).unwrap();
    motion.advance(2000.0 / 17.196, &mut |_| {}).unwrap();
    let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
    for _ in 0..2000 {
        let next = motion.time() + 1.0 / 17.196 / 2000.0;
        motion.advance(next, &mut |_| {}).unwrap();
        let x = motion.state().x1;
        (low, high) = (low.min(x), high.max(x));
    }
    assert!((soft.answer[0] / ((high - low) / 2.0) - 1.0).abs() < 1e-4, "{} {low} {high}", soft.answer[0]);
    assert!((open.motions[0].answer[0] / soft.answer[0] - 1.0).abs() > 0.2);
}

#[test]
fn one_motion_is_read_alike_from_wherever_it_starts() {
    // If cycles began at the phase of an impact, as at a start near an orbit, one cycle could hold both
    // impacts of 2/2, or other impacts of 5/6.
    for (restitution, frequency, cycles, pattern) in
        [(0.97, 5.85, 2, "2/2"), (0.9, 13.700_000_000_000_001, 6, "5/6")]
    {
        let rig = Rig { restitution, ..Rig::thesis() };
        let mut motion = Simulation::new(&rig, &Sine { force: 0.9, frequency }).unwrap();
        motion.run(6000.0 / frequency, |_| {}).unwrap();
        let fastest = fastest(&mut motion, cycles);
        let mean = fastest.iter().sum::<f64>() / fastest.len() as f64;
        // The reading takes the fastest impact of each cycle: with cycles that began elsewhere, it would
        // count some impacts too often.
        assert!(fastest.iter().any(|v| v / mean > 1.1), "{fastest:?}");
        let choice = speeds(restitution, 0.9, frequency, 1e8);
        let [only] = choice.motions.as_slice() else { panic!("{:?}", choice.motions) };
        // Settled to 2 % of the tolerance of 2 %.
        assert_eq!(only.pattern.to_string(), pattern);
        assert!((only.answer[0] / mean - 1.0).abs() < 4e-4, "{only:?} {mean}");
        assert!(choice.chosen.is_some() && choice.followed.is_some_and(|f| f.states == f.of));
    }
}

#[test]
fn a_motion_known_with_impacts_at_once_is_not_listed_again_with_a_contact_that_gives_way() {
    for (frequency, stiffness, pattern) in [(13.2, 1e7, "4/6"), (12.0, 1e8, "irregular")] {
        let open = speeds(0.9, 0.5, frequency, stiffness);
        assert_eq!(open.needs, [Need::History]);
        let patterns: Vec<String> = open.motions.iter().map(|m| m.pattern.to_string()).collect();
        assert_eq!(patterns, ["no impact", pattern]);
    }
}

#[test]
fn a_motion_that_a_contact_comes_to_from_rest_is_not_rare() {
    let scene = Scene { rig: Rig { restitution: 0.7, ..Rig::thesis() }, ..Scene::thesis() };
    let excitation = Excitation::Sine(Sine { force: 0.3, frequency: 13.5986 });
    let question = Question::new(Observable::ImpactSpeed);
    let stage = DrivenScene { scene: &scene, excitation: &excitation, question: &question };
    let mut motions = Motions::new(&stage).unwrap();
    let rare = |motions: &Motions| motions.known.iter().map(|m| m.rare).collect::<Vec<_>>();
    assert_eq!((rare(&motions), &motions.on), (vec![false, true], &CurrentMotion::Free));
    // Reading of a compliant contact that reaches the rare motion from rest.
    let state = State { x1: -4e-3, v1: 0.3, x2: -1e-3, v2: -0.2 };
    let mut motion = Simulation::from_state(&scene.rig, &excitation, state, 0.0).unwrap();
    let from_rest = MotionReader::new(&scene.rig, 13.5986, &question).read(&mut motion).unwrap();
    assert_eq!(from_rest.regime, motions.known[1].pattern);
    motions.differs(&Answer::exact([0.0; 2]), &from_rest, Model::KelvinVoigt, &question);
    assert_eq!((rare(&motions), &motions.on), (vec![false, false], &CurrentMotion::Open));
}

#[test]
fn states_that_were_not_followed_are_counted() {
    // With little damping a motion takes thousands of cycles to settle.
    let at = |damping: f64| {
        let rig = Rig { c1: damping, c2: damping, restitution: 0.98, ..Rig::thesis() };
        let excitation = Some(Excitation::Sine(Sine { force: 0.9, frequency: 9.0 }));
        let contact = Some(ContactKeys { stiffness: Some(1e8), ..ContactKeys::default() });
        let scene = Scene { rig, excitation, contact, buffer: None, springs: None, uncertainty: None };
        choose(&scene, 9.0, &Question::new(Observable::Fundamental)).unwrap()
    };
    let short = at(1e-3);
    let Followed { states, of } = short.followed.unwrap();
    assert!(states > 0 && states < of && short.needs.is_empty(), "{states} {of}");
    let cut = short.findings.iter().find(|f| f.code == "search-cut").unwrap();
    assert_eq!((cut.get("states"), cut.get("of")), (Some(f64::from(states)), Some(f64::from(of))));
    let all = at(0.1);
    assert!(all.followed.is_some_and(|f| f.states == f.of));
    assert!(all.findings.iter().all(|f| f.code != "search-cut"));
}

//! Failure map of the models: scenes at the borders of their domain, and the outcome of each method there.

use super::check;
use super::rivals::{self as by, Method};
use super::scenes::{at, grazing_task, task_c};
use super::task::{Log, Task};
use super::truth::{motion, settled};
use crate::{BorderQuestion, FailureMap, Family, Outcome, OutcomeWithReason};
use std::f64::consts::TAU;
use std::sync::Arc;
use vibro_math::bisected;
use vibro_model::{Rig, Sine, Steady};
use vibro_record::Result;
use vibro_record::units::notation::quantity;

/// A scene at a border of the domain of the models.
struct Border {
    /// The border, such as `grazing`.
    name: &'static str,
    /// The scene, such as `reached by 1 µm`.
    scene: String,
    task: Task,
    goal: Goal,
}

/// The question to a method at a border.
#[derive(Clone, Copy, PartialEq)]
enum Goal {
    /// What are the impacts and rests of the motion?
    Motion,
    /// What are the impacts and rests of the motion, for methods with a soft contact?
    Contact,
    /// Is there an impact, and when? Its time in s; `None` for no impact.
    First(Option<f64>),
    /// What are the periodic orbits?
    Orbits,
    /// What is the approach speed at the end?
    Speed,
}

/// The kind of motion that a method can compute.
#[derive(Clone, Copy, PartialEq)]
enum Ability {
    /// Periodic orbits with rigid impacts.
    Orbits,
    /// Periodic orbits with a contact of the task's stiffness.
    SoftOrbits,
    /// Any motion, with rigid impacts.
    Follow,
    /// Any motion, with a contact of the task's stiffness.
    FollowSoft,
}

/// Largest number of cycles for methods other than ours: with more they would take minutes.
const MOST_RIVAL_CYCLES: f64 = 1e4;

/// Methods in the order of the figure, each with its setting and its ability. The stiff spring of 1e8 N/m
/// counts as a rigid impact: it is in contact for 0.07 % of the period.
const METHODS: &[(Method, f64, Ability)] = &[
    (by::CLOSED, 0.0, Ability::Orbits),
    (Method { name: "soft-corrected form", ..by::SOFT }, 0.0, Ability::SoftOrbits),
    (by::FLIGHTS, 0.0, Ability::Follow),
    (by::KELVIN_VOIGT, 0.0, Ability::FollowSoft),
    (by::EULER, 1e3, Ability::Follow),
    (by::RK4_LOOP, 1e3, Ability::Follow),
    (by::MOREAU, 1e3, Ability::Follow),
    (by::RK45_ENDS, 1e-6, Ability::Follow),
    (by::DOP853_RESTS, 1e-9, Ability::Follow),
    #[cfg(feature = "diffsol")]
    (by::TSIT45_RESTS, 1e-9, Ability::Follow),
    (by::ROUGH_SPRING, 1e8, Ability::Follow),
    (by::RK45_CONTACT, 1e-6, Ability::FollowSoft),
];

/// Six cycles at ν = ω/Ω₁ = 2.1 under 0.5 N from x₁ = −1 mm.
fn six_cycles(rig: Rig) -> Task {
    let frequency = at(&Rig::thesis(), 2.1);
    Task { start: [-1e-3, 0.0, 0.0, 0.0], most: 100_000, ..Task::sine(rig, 0.5, frequency, 6.0 / frequency) }
}

/// The task of scene C over its first two chatters, with this restitution.
fn chatter(restitution: f64) -> Task {
    let task = task_c();
    Task { rig: Rig { restitution, ..task.rig }, until: 1.2, most: 100_000, rests: false, ..task }
}

/// Largest restitution at which the first chatter ends in rest, by bisection: above it the masses are
/// released while they still bounce.
fn onset() -> f64 {
    // The first release is at 0.25 s whatever R is, the next chatter begins after 0.4 s.
    let rests = |r| motion(&Task { until: 0.3, ..chatter(r) }, None).is_ok_and(|log| !log.sticks.is_empty());
    bisected(0.7, 0.9, 20, rests).0
}

/// All scenes at all borders; with `quick` the long runs have fewer cycles.
fn borders(quick: bool) -> Result<Vec<Border>> {
    let thesis = Rig::thesis();
    let mut all = Vec::new();
    let mut add = |name, scene: String, task, goal| all.push(Border { name, scene, task, goal });
    for depth in [1e-3, 1e-6, 1e-9, 1e-12, -1e-12, -1e-9, -1e-6, -1e-3] {
        let (task, time) = grazing_task(depth, 1)?;
        let words = if depth > 0.0 { "reached" } else { "missed" };
        add("grazing", format!("{words} by {}", quantity(depth.abs(), "m", 1)), task, Goal::First(time));
    }
    // The amplitude of the forced motion alone is the gap times 1 + `excess`.
    let plain = six_cycles(thesis);
    let unit = Steady::new(&thesis, &Sine { force: 1.0, frequency: plain.frequency })?.amplitude();
    for excess in [1e-3, 1e-9, -1e-9, -1e-3] {
        let task = Task { force: thesis.gap / unit * (1.0 + excess), ..plain };
        let sign = if excess > 0.0 { '+' } else { '−' };
        add("grazing orbit", format!("amplitude over gap 1 {sign} {:.0e}", excess.abs()), task, Goal::Orbits);
    }
    for (name, restitution) in
        [("0", 0.0), ("1e-9", 1e-9), ("0.01", 0.01), ("0.99", 0.99), ("1 − 1e-6", 1.0 - 1e-6), ("1", 1.0)]
    {
        add("restitution", format!("R {name}"), six_cycles(Rig { restitution, ..thesis }), Goal::Motion);
    }
    for (name, part) in
        [("none", 0.0), ("1e-9 of critical", 1e-9), ("critical", 1.0), ("100 times critical", 100.0)]
    {
        let critical = |m: f64, k: f64| 2.0 * part * (m * k).sqrt();
        let rig = Rig { c1: critical(thesis.m1, thesis.k1), c2: critical(thesis.m2, thesis.k2), ..thesis };
        // Enough force to cross the gap.
        let task = Task { force: 0.5 * (1.0 + 20.0 * part), ..six_cycles(rig) };
        add("damping", name.to_owned(), task, Goal::Motion);
    }
    for gap in [1e-6, 1e-12, 0.0, -1e-12, -1e-6, -5e-4] {
        add("gap", quantity(gap, "m", 1), six_cycles(Rig { gap, ..thesis }), Goal::Motion);
    }
    for ratio in [1e-3, 1e-1, 1e1, 1e3] {
        let scale = ratio * thesis.m1 / thesis.m2;
        let rig = Rig { m2: thesis.m2 * scale, k2: thesis.k2 * scale, c2: thesis.c2 * scale, ..thesis };
        add("mass ratio", format!("m₂/m₁ {ratio:.0e}"), six_cycles(rig), Goal::Motion);
    }
    // The contact lasts 0.07 to 7 % of the period.
    for stiffness in [1e8, 1e5, 1e4] {
        add("soft contact", format!("{stiffness:.0e} N/m"), Task { stiffness, ..plain }, Goal::Contact);
    }
    let pair = ((thesis.k1 + thesis.k2) / (thesis.m1 + thesis.m2)).sqrt() / TAU;
    let [first, second] = thesis.natural_frequencies();
    for (name, frequency) in [("mass 1", first), ("mass 2", second), ("both together", pair)] {
        for (dampers, c) in [("", 0.1), (", no dampers", 0.0)] {
            let rig = Rig { c1: c, c2: c, ..thesis };
            let task = Task { frequency, until: 6.0 / frequency, ..six_cycles(rig) };
            add("resonance", format!("{name}{dampers}"), task, Goal::Motion);
        }
    }
    for restitution in [0.3, 0.7, 0.9, 0.95] {
        add("chatter", format!("R {restitution}"), chatter(restitution), Goal::Motion);
    }
    let onset = onset();
    for (sign, beside) in [('−', -1e-3), ('+', 1e-3)] {
        let scene = format!("R {onset:.4} {sign} 1e-3, where rest begins");
        add("chatter", scene, chatter(onset + beside), Goal::Motion);
    }
    for cycles in if quick { &[1e3][..] } else { &[1e4, 1e6] } {
        let task = Task { until: cycles / plain.frequency, most: 200_000_000, ..plain };
        add("long runs", format!("{cycles:.0e} cycles"), task, Goal::Speed);
    }
    Ok(all)
}

/// The true answer at a border, with rigid impacts or with a contact; `None` where it is not known.
fn truth(border: &Border, soft: bool) -> Option<Log> {
    let task = &border.task;
    let contact = soft.then(|| task.spring());
    match border.goal {
        // No damper in a contact gives R = 0: with every damper the masses rebound.
        _ if soft && task.rig.restitution == 0.0 => None,
        Goal::Motion | Goal::Contact => motion(task, contact).ok(),
        Goal::Speed => Some(Log::of([(0.0, settled(task, contact, check::SETTLED).ok()??.speed())])),
        Goal::First(time) => Some(Log::of(time.map(|t| (t, 0.0)))),
        Goal::Orbits => None,
    }
}

/// The outcome of each method at each border; with `quick` the long runs have fewer cycles.
///
/// # Errors
/// If a scene cannot be built.
pub fn failures(quick: bool) -> Result<FailureMap> {
    let mut questions = Vec::new();
    for border in borders(quick)? {
        let truths = [false, true].map(|soft| truth(&border, soft));
        let shared = Arc::new((border, truths));
        for (method, setting, can) in METHODS {
            let (border, shared) = (&shared.0, Arc::clone(&shared));
            questions.push(BorderQuestion {
                method: method.name,
                ours: method.ours,
                border: border.name,
                scene: border.scene.clone(),
                answer: Box::new(move || {
                    let truth = shared.1[usize::from(*can == Ability::FollowSoft)].as_ref();
                    judged(method, *setting, *can, &shared.0, truth).unwrap_or_else(|fault| fault)
                }),
            });
        }
    }
    Ok(FailureMap::answered(Family::Models, questions))
}

/// Judges the answer of a method at a border.
fn judged(
    method: &Method,
    setting: f64,
    can: Ability,
    border: &Border,
    truth: Option<&Log>,
) -> std::result::Result<OutcomeWithReason, OutcomeWithReason> {
    let task = &border.task;
    let not_asked = |why: &str| Ok(OutcomeWithReason::new(Outcome::NotAsked, why));
    match (can, border.goal) {
        (Ability::Orbits | Ability::Follow, Goal::Contact)
        | (Ability::Orbits | Ability::SoftOrbits, Goal::First(_))
        | (Ability::Follow | Ability::FollowSoft, Goal::Orbits) => {
            return not_asked("it answers another question");
        }
        (_, Goal::Speed) if !method.ours && task.until * task.frequency > MOST_RIVAL_CYCLES => {
            return not_asked("it would take minutes; fewer cycles are asked of it");
        }
        (Ability::Orbits, Goal::Motion | Goal::Orbits) => return check::closed_form(task),
        (Ability::SoftOrbits, _) => return check::corrected(task),
        _ => {}
    }
    let log = (method.follow)(task, setting)?;
    let Some(truth) = truth else {
        return not_asked("no truth: there is no such motion, or it does not settle");
    };
    Ok(match border.goal {
        Goal::First(_) => check::first(&log, truth, task),
        Goal::Speed => check::speed(&log, truth),
        _ => check::motion(&log, truth, task),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::models::ours;

    /// The map allows every method the same error; the library itself promises a smaller one.
    #[test]
    fn exact_motions_are_exact_wherever_they_answer() {
        let (mut compared, mut refused) = ([0; 2], Vec::new());
        for border in borders(true).unwrap() {
            if !matches!(border.goal, Goal::Motion | Goal::Contact) {
                continue;
            }
            let place = format!("{} {}", border.name, border.scene);
            for (which, method) in [by::FLIGHTS, by::KELVIN_VOIGT].into_iter().enumerate() {
                let Ok(log) = (method.follow)(&border.task, 0.0) else {
                    refused.push((which, place.clone()));
                    continue;
                };
                let truth = truth(&border, which == 1).unwrap();
                // Impacts slower than 1e-3 m/s are left out: they depend on what each method treats as rest.
                let fast = |t: &Log| {
                    t.impacts
                        .iter()
                        .copied()
                        .filter(|i| i.1 > 1e-3 && i.0 < border.task.until - 1e-6)
                        .collect::<Vec<_>>()
                };
                let (fast_log, fast_truth) = (fast(&log), fast(&truth));
                assert_eq!(fast_log.len(), fast_truth.len(), "{place}");
                for (a, b) in fast_log.iter().zip(&fast_truth) {
                    // The truth's own 2e-13 s (see its tests), enlarged tenfold by near misses.
                    assert!((a.0 - b.0).abs() < 1e-11, "{place}: {a:?} {b:?}");
                    // In 1e-11 s accelerations of up to 1e3 m/s² after a contact change a speed by up to
                    // 1e-8 m/s.
                    assert!((a.1 - b.1).abs() < 1e-8, "{place}: {a:?} {b:?}");
                    compared[which] += 1;
                }
                assert_eq!(
                    log.sticks.len(),
                    truth.sticks.len(),
                    "{place}: {:?} {:?}",
                    log.sticks,
                    truth.sticks
                );
                for (a, b) in log.sticks.iter().zip(&truth.sticks) {
                    // The truth's own 1e-10 s at the ends of a chatter (see its tests), and the effect of the
                    // dampers' rates c/m on the part that it sums as a series, up to 1e-6 s.
                    let rig = border.task.rig;
                    let allowed = 1e-9 + 1e-12 * (rig.c1 / rig.m1).max(rig.c2 / rig.m2);
                    let apart = |i: usize| (a[i].min(border.task.until) - b[i].min(border.task.until)).abs();
                    assert!(apart(0) < allowed && apart(1) < allowed, "{place}: {a:?} {b:?}");
                }
            }
        }
        // No damper gives R = 0; a resonance without dampers has no forced motion, which exact flights need.
        assert_eq!(refused, [(1, "restitution R 0".into()), (0, "resonance mass 1, no dampers".into())]);
        assert!(compared.iter().all(|n| *n > 200), "{compared:?}");
    }

    #[test]
    fn a_method_that_misses_an_impact_is_wrong_and_one_without_a_truth_is_not_asked() {
        let border = borders(true).unwrap().into_iter().find(|b| b.goal == Goal::Motion).unwrap();
        let truth = truth(&border, false);
        let without = |t: &Task, _: f64| {
            let mut log = ours::flights(t)?;
            log.impacts.remove(1);
            Ok(log)
        };
        let outcome = |method: &Method, truth: Option<&Log>| {
            judged(method, 0.0, Ability::Follow, &border, truth).unwrap().outcome
        };
        assert_eq!(outcome(&Method { follow: without, ..by::FLIGHTS }, truth.as_ref()), Outcome::Wrong);
        assert_eq!(outcome(&by::FLIGHTS, truth.as_ref()), Outcome::Right);
        assert_eq!(outcome(&by::FLIGHTS, None), Outcome::NotAsked);
    }
}

//! Each method at each border.

use super::borders::{Asks, Border, borders};
use super::check::{self, Found};
use super::corrected::corrected;
use super::ours;
#[cfg(feature = "diffsol")]
use super::rivals::{Diffsol, impacts};
use super::rivals::{Events, Kind, Loop, Spring, events, marched, moreau, penalty};
use super::scene_b::spring;
use super::task::{Fault, Task, Told};
use super::truth;
use crate::watched::{PATIENCE, Watched, watched};
use crate::{Cell, FailureMap, Family, Outcome};
use vibro_model::contact::conversion::damping_ratio;
use vibro_model::orbits;
use vibro_record::Result;

/// How a method follows a motion.
type Follow = fn(&Task) -> std::result::Result<Told, Fault>;

/// What a method can be asked.
#[derive(Clone, Copy)]
enum Can {
    /// Motions that repeat.
    Orbits,
    /// The same with a contact of the task's stiffness.
    SoftOrbits,
    /// Any motion, with impacts at once.
    Follow(Follow),
    /// Any motion, with that contact.
    FollowSoft(Follow),
}

/// Stiffness in N/m of the spring that stands for an impact at once: in contact for 0.07 % of the period.
const STIFF: f64 = 1e8;
/// Cycles beyond which other methods are not asked: they would take minutes.
const LONG: f64 = 1e4;

/// Methods in the order of the picture, whether they are this library's, and what they can.
const METHODS: &[(&str, bool, Can)] = &[
    ("closed form", true, Can::Orbits),
    ("soft-corrected form", true, Can::SoftOrbits),
    ("exact flights", true, Can::Follow(ours::flights)),
    ("exact Kelvin–Voigt", true, Can::FollowSoft(kelvin_voigt)),
    ("Euler loop", false, Can::Follow(|t| marched(t, Loop::Euler, 1000.0))),
    ("RK4 loop", false, Can::Follow(|t| marched(t, Loop::Rk4, 1000.0))),
    ("Moreau time stepping", false, Can::Follow(|t| moreau(t, 1000.0))),
    ("RK45, sign test", false, Can::Follow(|t| events(t, &Events::ends(Kind::Rk45(1e-6))))),
    (
        "DOP853, rule for rest",
        false,
        Can::Follow(|t| events(t, &Events::dense(Kind::Dop853(1e-9)).sticking(1e-5))),
    ),
    #[cfg(feature = "diffsol")]
    ("diffsol TSIT45, rule for rest", false, Can::Follow(|t| impacts(t, Diffsol::Tsit45(1e-9), Some(1e-5)))),
    ("stiff spring, RK45", false, Can::Follow(|t| penalty(t, &spring(&t.rig, STIFF), Kind::Rk45(1e-6)))),
    (
        "RK45 through the contact",
        false,
        Can::FollowSoft(|t| penalty(t, &spring(&t.rig, t.stiffness), Kind::Rk45(1e-6))),
    ),
];

fn kelvin_voigt(task: &Task) -> std::result::Result<Told, Fault> {
    damping_ratio(task.rig.restitution)?;
    let contact = spring(&task.rig, task.stiffness);
    // A contact that gives way is told when it is over: the motion is followed for longer, and what began too late left out.
    let mut told = ours::kelvin_voigt(&Task { until: task.until + 3.0 * task.cycle(), ..*task }, &contact)?;
    told.impacts.retain(|i| i.0 < task.until);
    told.sticks.retain(|rest| rest[0] < task.until);
    Ok(told)
}

/// What is true at a border, for impacts at once or for a contact; the reason where it is not known.
#[derive(Debug, Clone)]
enum Truth {
    Motion(std::result::Result<Told, String>),
    /// Approach speed in m/s of the motion that repeats.
    Speed(std::result::Result<f64, String>),
    /// Time in s of the first impact, or never.
    First(Option<f64>),
    /// The definition is checked.
    Orbit,
}

impl Truth {
    fn new(border: &Border, contact: Option<&Spring>) -> Truth {
        let task = &border.task;
        if contact.is_some() && task.rig.restitution == 0.0 {
            return Truth::Motion(Err("no damper of a contact stops a rebound altogether".to_owned()));
        }
        match border.asks {
            Asks::Motion | Asks::Contact => Truth::Motion(truth::motion(task, contact)),
            Asks::Cycles(_) => {
                Truth::Speed(truth::settled(task, contact, check::SETTLED).and_then(|found| {
                    found.map(|r| r.speed()).ok_or_else(|| "the motion does not settle".to_owned())
                }))
            }
            Asks::First(time) => Truth::First(time),
            Asks::Orbit => Truth::Orbit,
        }
    }
}

/// Asks every method at every border.
///
/// # Errors
/// If a scene cannot be built.
pub fn failures(quick: bool) -> Result<FailureMap> {
    let mut cells = Vec::new();
    for border in borders(quick)? {
        let contact = spring(&border.task.rig, border.task.stiffness);
        let [rigid, soft] = [None, Some(&contact)].map(|contact| Truth::new(&border, contact));
        for &(method, ours, can) in METHODS {
            let truth = if matches!(can, Can::FollowSoft(_) | Can::SoftOrbits) { &soft } else { &rigid };
            let (own, truth) = (border.clone(), truth.clone());
            let answer = watched(PATIENCE, move || ask(can, ours, &own, &truth));
            let (outcome, why) = match answer {
                Watched::Done(Ok(found)) => found,
                Watched::Done(Err(Fault::Refused(why))) => (Outcome::Refused, why),
                Watched::Done(Err(Fault::Stalled(why))) => (Outcome::Stalled, why),
                Watched::Crashed(why) => (Outcome::Crashed, why),
                Watched::Stalled => (Outcome::Stalled, format!("no answer within {PATIENCE} s")),
            };
            cells.push(Cell {
                method: method.to_owned(),
                ours,
                border: border.name.to_owned(),
                scene: border.scene.clone(),
                outcome,
                why,
            });
        }
    }
    Ok(FailureMap { family: Family::Models, cells })
}

/// What a method makes of a border.
fn ask(can: Can, ours: bool, border: &Border, truth: &Truth) -> std::result::Result<Found, Fault> {
    let task = &border.task;
    let not_asked = |why: &str| Ok((Outcome::NotAsked, why.to_owned()));
    let no_truth = |why: &str| not_asked(&format!("no truth: {why}"));
    let follow = match (can, border.asks) {
        (Can::Orbits | Can::Follow(_), Asks::Contact) => {
            return not_asked("asked is a contact, and its impacts have no duration");
        }
        (Can::Orbits, Asks::Motion | Asks::Orbit) => return check::closed_form(task),
        (Can::SoftOrbits, Asks::Motion | Asks::Contact | Asks::Orbit | Asks::Cycles(_)) => {
            return corrected(task);
        }
        (Can::Orbits, Asks::Cycles(_)) => {
            let found = orbits(&task.rig, task.force, task.frequency)?;
            let told = found.orbits.first().map_or(f64::NAN, |o| o.approach_velocity);
            return match truth {
                Truth::Speed(Ok(truth)) => Ok(check::speed(told, *truth)),
                Truth::Speed(Err(why)) => no_truth(why),
                _ => not_asked("there is no speed to be compared"),
            };
        }
        (Can::Orbits | Can::SoftOrbits, Asks::First(_)) => {
            return not_asked("it knows motions that repeat, and no first impact");
        }
        (Can::Follow(_) | Can::FollowSoft(_), Asks::Orbit) => {
            return not_asked("asked are the motions that exist, and it follows one");
        }
        (_, Asks::Cycles(cycles)) if !ours && cycles > LONG => {
            return not_asked("it would take minutes; fewer cycles are asked of it");
        }
        (Can::Follow(follow) | Can::FollowSoft(follow), _) => follow,
    };
    let told = follow(task)?;
    match truth {
        Truth::Motion(Ok(truth)) => Ok(check::motion(&told, truth, task)),
        Truth::Speed(Ok(truth)) => Ok(match told.impacts.last() {
            Some(last) => check::speed(last.1, *truth),
            None => check::wrong("no impacts".to_owned()),
        }),
        Truth::First(time) => Ok(check::first(&told, *time, task)),
        Truth::Motion(Err(why)) | Truth::Speed(Err(why)) => no_truth(why),
        Truth::Orbit => not_asked("asked are the motions that exist, and it follows one"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The map allows every method the same; what the library's own promise is tighter.
    #[test]
    fn exact_motions_are_exact_wherever_they_answer() {
        let (mut compared, mut refused) = ([0; 2], Vec::new());
        for border in borders(true).unwrap() {
            if !matches!(border.asks, Asks::Motion | Asks::Contact) {
                continue;
            }
            let place = format!("{} {}", border.name, border.scene);
            let contact = spring(&border.task.rig, border.task.stiffness);
            let follow: [(Follow, Option<&Spring>); 2] =
                [(ours::flights, None), (kelvin_voigt, Some(&contact))];
            for (which, (follow, contact)) in follow.into_iter().enumerate() {
                let Ok(told) = follow(&border.task) else {
                    refused.push((which, place.clone()));
                    continue;
                };
                let truth = truth::motion(&border.task, contact).unwrap();
                // Impacts slower than 1e-3 m/s are told apart by what each method calls rest.
                let fast = |t: &Told| {
                    t.impacts
                        .iter()
                        .copied()
                        .filter(|i| i.1 > 1e-3 && i.0 < border.task.until - 1e-6)
                        .collect::<Vec<_>>()
                };
                let (fast_told, fast_truth) = (fast(&told), fast(&truth));
                assert_eq!(fast_told.len(), fast_truth.len(), "{place}");
                for (a, b) in fast_told.iter().zip(&fast_truth) {
                    // The truth's own 2e-13 s (its tests), enlarged tenfold by impacts that are nearly missed.
                    assert!((a.0 - b.0).abs() < 1e-11, "{place}: {a:?} {b:?}");
                    // In that time accelerations, up to 1e3 m/s² behind a contact, change a speed by 1e-8 m/s.
                    assert!((a.1 - b.1).abs() < 1e-8, "{place}: {a:?} {b:?}");
                    compared[which] += 1;
                }
                assert_eq!(
                    told.sticks.len(),
                    truth.sticks.len(),
                    "{place}: {:?} {:?}",
                    told.sticks,
                    truth.sticks
                );
                for (a, b) in told.sticks.iter().zip(&truth.sticks) {
                    // The truth's own 1e-10 s at the ends of a chatter (its tests), and what the dampers' rates c/m change in what
                    // it leaves to a series, up to 1e-6 s.
                    let rig = border.task.rig;
                    let allowed = 1e-9 + 1e-12 * (rig.c1 / rig.m1).max(rig.c2 / rig.m2);
                    let apart = |i: usize| (a[i].min(border.task.until) - b[i].min(border.task.until)).abs();
                    assert!(apart(0) < allowed && apart(1) < allowed, "{place}: {a:?} {b:?}");
                }
            }
        }
        // No damper gives R = 0, and a resonance without dampers has no forced motion that a flight could be told by.
        assert_eq!(refused, [(1, "restitution R 0".into()), (0, "resonance mass 1, no dampers".into())]);
        assert!(compared.iter().all(|n| *n > 200), "{compared:?}");
    }

    #[test]
    fn a_method_that_misses_an_impact_is_wrong_and_one_that_is_not_asked_says_why() {
        let border = borders(true).unwrap().into_iter().find(|b| b.asks == Asks::Motion).unwrap();
        let truth = Truth::new(&border, None);
        let without = |t: &Task| {
            let mut told = ours::flights(t)?;
            told.impacts.remove(1);
            Ok(told)
        };
        assert_eq!(ask(Can::Follow(without), true, &border, &truth).unwrap().0, Outcome::Wrong);
        assert_eq!(ask(Can::Follow(ours::flights), true, &border, &truth).unwrap().0, Outcome::Right);
        let unknown = Truth::Motion(Err("nobody knows".to_owned()));
        let found = ask(Can::Follow(ours::flights), true, &border, &unknown).unwrap();
        assert_eq!(found, (Outcome::NotAsked, "no truth: nobody knows".to_owned()));
    }
}

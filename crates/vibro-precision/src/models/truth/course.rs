//! From event to event.

use super::super::task::{Spring, Task};
use super::mode::{Guard, Instant, Mode, Row, SIZE};
use std::f64::consts::TAU;

/// Rebounds in m/s below which masses that press each other come to rest; what is left of the chatter is a geometric series of
/// flights, and takes 2w/(a(1 − R)).
const SLOWEST: f64 = 1e-7;

/// What is met on the way, at a time in s.
pub enum Met {
    /// The masses meet, with their state before.
    Impact(f64, [f64; 4]),
    /// They come to rest against each other.
    Stick(f64),
    /// They are released, or part behind a contact.
    Release(f64),
}

/// A rig's motion with impacts at once or with a contact.
pub struct Course {
    task: Task,
    pub apart: Mode,
    /// At rest against each other, or in contact.
    held: Mode,
    compliant: bool,
    /// The gap closes.
    closes: Guard,
    /// It opens again behind a contact that no longer pushes.
    parts: Guard,
    /// The contact no longer pushes.
    eases: Guard,
    /// It pushes again.
    pushes: Guard,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Stage {
    Apart,
    /// As they meet: the impact has been shown, and not yet happened.
    Meeting,
    Held,
    /// The contact does not push, the masses still overlap.
    Eased,
}

/// A place on the way.
pub struct Place {
    at: Instant,
    stage: Stage,
}

impl Course {
    /// The motion of `task` with impacts at once, or with a `contact`.
    pub fn new(task: &Task, contact: Option<&Spring>) -> Course {
        let rig = &task.rig;
        let apart = Mode::new(task, &[0.0; SIZE], f64::INFINITY);
        let force: Row = match contact {
            Some(c) => [c.stiffness, c.damping, -c.stiffness, -c.damping, 0.0, 0.0, -c.stiffness * rig.gap],
            // The force that keeps both accelerations alike.
            None => apart.rate(&[0.0, 1.0, 0.0, -1.0, 0.0, 0.0, 0.0]).map(|a| rig.reduced_mass() * a),
        };
        // The force turns round within half a turn of the contact: eight steps see each of its signs.
        let held = Mode::new(task, &force, contact.map_or(f64::INFINITY, |c| c.alone / 8.0));
        let gap = [-1.0, 0.0, 1.0, 0.0, 0.0, 0.0, rig.gap];
        Course {
            task: *task,
            compliant: contact.is_some(),
            closes: Guard::new(&apart, gap),
            parts: Guard::new(&apart, gap.map(|w| -w)),
            eases: Guard::new(&held, force),
            pushes: Guard::new(&apart, force.map(|w| -w)),
            apart,
            held,
        }
    }

    /// Apart in this state, where the force's phase is that (rad).
    pub fn free(&self, phase: f64, y: &[f64; 4]) -> Place {
        Place { at: self.apart.instant(phase / (TAU * self.task.frequency), y), stage: Stage::Apart }
    }

    /// As they meet in this state.
    pub fn meeting(&self, phase: f64, before: &[f64; 4]) -> Place {
        Place { stage: Stage::Meeting, ..self.free(phase, before) }
    }

    /// Follows the motion to what is met next, if anything is up to `until`; the exciting force is F₀ cos ωt.
    pub fn next(&self, place: &mut Place, until: f64) -> Option<Met> {
        loop {
            let (mode, guards): (&Mode, &[&Guard]) = match place.stage {
                Stage::Apart => (&self.apart, &[&self.closes]),
                Stage::Held => (&self.held, &[&self.eases]),
                Stage::Eased => (&self.apart, &[&self.parts, &self.pushes]),
                Stage::Meeting => match self.meet(place) {
                    Some(met) => return Some(met),
                    None => continue,
                },
            };
            let (which, at) = mode.next(guards, place.at, until)?;
            place.at = at;
            match (place.stage, which) {
                (Stage::Apart, _) => {
                    place.stage = Stage::Meeting;
                    return Some(Met::Impact(at.0, std::array::from_fn(|i| at.1[i])));
                }
                (Stage::Held, _) if self.compliant => place.stage = Stage::Eased,
                (Stage::Held, _) => {
                    // The gap opens like the cube of time: a ten-thousandth of a cycle passes unwatched, until it is more than rounding.
                    place.at.1[0] = at.1[2] + self.task.rig.gap;
                    place.at = self.apart.after(place.at, 1e-4 * self.task.cycle());
                    place.stage = Stage::Apart;
                    return Some(Met::Release(at.0));
                }
                (Stage::Eased, 0) => {
                    place.stage = Stage::Apart;
                    return Some(Met::Release(at.0));
                }
                _ => place.stage = Stage::Held,
            }
        }
    }

    /// What follows from meeting; something is met where the masses come to rest.
    fn meet(&self, place: &mut Place) -> Option<Met> {
        place.stage = if self.compliant { Stage::Held } else { Stage::Apart };
        if self.compliant {
            return None;
        }
        let (rig, (t, y)) = (&self.task.rig, place.at);
        // m₁v₁ + m₂v₂ = const, (v₁ − v₂)⁺ = −R(v₁ − v₂)⁻.
        let common = (rig.m1 * y[1] + rig.m2 * y[3]) / (rig.m1 + rig.m2);
        let back = -rig.restitution * (y[1] - y[3]);
        place.at.1[1] = common + rig.m2 / (rig.m1 + rig.m2) * back;
        place.at.1[3] = common - rig.m1 / (rig.m1 + rig.m2) * back;
        let pressed = self.eases.value(&place.at.1) / rig.reduced_mass();
        if pressed <= 0.0 || -back >= SLOWEST || rig.restitution == 1.0 {
            return None;
        }
        let chatter = -2.0 * back / (pressed * (1.0 - rig.restitution));
        let together = self.held.instant(t, &[y[0], common, y[0] - rig.gap, common]);
        (place.at, place.stage) = (self.held.after(together, chatter), Stage::Held);
        Some(Met::Stick(t + chatter))
    }
}

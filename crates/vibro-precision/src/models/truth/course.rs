//! From event to event.

use std::f64::consts::PI;

use super::super::rivals::Spring;
use super::super::task::Task;
use super::guard::Guard;
use super::mode::{DEEPEST, Mode, Row, SIZE};

/// Rebounds in m/s below which masses that press each other come to rest; what is left of the chatter is a geometric series of
/// flights, and takes 2w/(a(1 − R)).
const SLOWEST: f64 = 1e-7;
/// Events before there is no truth.
const MOST: usize = 1_000_000;

/// What is met on the way.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Met {
    /// The masses meet: time in s and state before.
    Impact(f64, [f64; 4]),
    /// They come to rest against each other.
    Stick(f64),
    /// They are released, or part behind a contact.
    Release(f64),
}

/// Where a motion begins.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Start {
    /// Apart.
    Free([f64; 4]),
    /// As they meet.
    Meeting([f64; 4]),
}

/// A rig's motion with impacts at once or with a contact.
#[derive(Debug, Clone)]
pub struct Course {
    task: Task,
    apart: Mode,
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
    Held,
    /// The contact does not push, the masses still overlap.
    Eased,
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
        let half = |c: &Spring| PI * (rig.reduced_mass() / c.stiffness).sqrt();
        let held = Mode::new(task, &force, contact.map_or(f64::INFINITY, |c| half(c) / 8.0));
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

    /// The mode without contact.
    pub fn apart(&self) -> &Mode {
        &self.apart
    }

    /// Follows the motion from time 0, at which the force is F₀ cos(phase), to `until` or until `visit` says no.
    ///
    /// # Errors
    /// If more impacts come than can be followed.
    pub fn run(
        &self,
        phase: f64,
        start: Start,
        until: f64,
        visit: &mut dyn FnMut(&Met) -> bool,
    ) -> Result<(), String> {
        let (mut t, mut stage) = (0.0, Stage::Apart);
        let mut y = match start {
            Start::Free(y) => y,
            Start::Meeting(before) => {
                let Some(met) = self.meet(phase, t, before, visit) else { return Ok(()) };
                (t, stage) = (met.0, met.2);
                met.1
            }
        };
        for _ in 0..MOST {
            let guards: &[Guard] = match stage {
                Stage::Apart => &[self.closes],
                Stage::Held => &[self.eases],
                Stage::Eased => &[self.parts, self.pushes],
            };
            let mode = if stage == Stage::Held { &self.held } else { &self.apart };
            let Some((which, time, at)) = next(mode, guards, phase, t, y, until) else { return Ok(()) };
            (t, y) = (time, at);
            stage = match (stage, which) {
                (Stage::Apart, _) => {
                    if !visit(&Met::Impact(t, y)) {
                        return Ok(());
                    }
                    let Some(met) = self.meet(phase, t, y, visit) else { return Ok(()) };
                    (t, y) = (met.0, met.1);
                    met.2
                }
                (Stage::Held, _) if self.compliant => Stage::Eased,
                (Stage::Held, _) => {
                    if !visit(&Met::Release(t)) {
                        return Ok(());
                    }
                    // The gap opens like the cube of time: a ten-thousandth of a cycle passes unwatched, until it is more than rounding.
                    let short = 1e-4 * self.task.cycle();
                    y[0] = y[2] + self.task.rig.gap;
                    y = self.apart.after(phase, t, y, short);
                    t += short;
                    Stage::Apart
                }
                (Stage::Eased, 0) => {
                    if !visit(&Met::Release(t)) {
                        return Ok(());
                    }
                    Stage::Apart
                }
                (Stage::Eased, _) => Stage::Held,
            };
        }
        Err(format!("more than {MOST} events up to {t:.6} s"))
    }

    /// What follows from meeting at `t` with `y`: nothing where `visit` wants no more.
    fn meet(
        &self,
        phase: f64,
        t: f64,
        mut y: [f64; 4],
        visit: &mut dyn FnMut(&Met) -> bool,
    ) -> Option<(f64, [f64; 4], Stage)> {
        if self.compliant {
            return Some((t, y, Stage::Held));
        }
        let rig = &self.task.rig;
        // m₁v₁ + m₂v₂ = const, (v₁ − v₂)⁺ = −R(v₁ − v₂)⁻.
        let common = (rig.m1 * y[1] + rig.m2 * y[3]) / (rig.m1 + rig.m2);
        let back = -rig.restitution * (y[1] - y[3]);
        y[1] = common + rig.m2 / (rig.m1 + rig.m2) * back;
        y[3] = common - rig.m1 / (rig.m1 + rig.m2) * back;
        let pressed = self.eases.value(&self.held.coordinates(phase, t, &y)) / rig.reduced_mass();
        if pressed <= 0.0 || -back >= SLOWEST || rig.restitution == 1.0 {
            return Some((t, y, Stage::Apart));
        }
        let chatter = -2.0 * back / (pressed * (1.0 - rig.restitution));
        let together = self.held.after(phase, t, [y[0], common, y[0] - rig.gap, common], chatter);
        visit(&Met::Stick(t + chatter)).then_some((t + chatter, together, Stage::Held))
    }
}

/// The first guard that falls to zero, when, and the state there; steps begin short, and are doubled one after another.
fn next(
    mode: &Mode,
    guards: &[Guard],
    phase: f64,
    start: f64,
    y: [f64; 4],
    until: f64,
) -> Option<(usize, f64, [f64; 4])> {
    let (mut t, mut level) = (start, DEEPEST);
    let mut at = mode.coordinates(phase, t, &y);
    while t < until {
        let end = t + mode.duration(level);
        let then = mode.coordinates(phase, end, &mode.step(level, &at));
        let fallen = guards.iter().enumerate().filter_map(|(i, guard)| {
            let (after, y) = guard.fall(mode, phase, level, t, [&at, &then])?;
            Some((i, t + after, y))
        });
        if let Some(first) = fallen.min_by(|a, b| a.1.total_cmp(&b.1)) {
            return Some(first);
        }
        (t, at, level) = (end, then, level.saturating_sub(1));
    }
    None
}

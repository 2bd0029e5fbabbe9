//! Effects of events on the stage of a contact, on the velocities, and on the spring of mass 1.

use super::compliant::{Compliant, ContactStage, Mark};
use super::still::Still;
use crate::forcing::Tick;
use crate::impact::Impact;
use crate::motion::{Event, Piece};

/// Separation speed in m/s below which pressed masses stay together after a rebound, which ends a chatter.
/// The rebounds left out would last 2·1e-9/(a(1 − R)) s in total, at a pressing acceleration a in m/s². A
/// larger limit leaves out more of them.
const REST_SPEED: f64 = 1e-9;

impl Compliant {
    /// Applies `mark` to the contact stage, the velocities or the spring of mass 1, and returns the event to
    /// report.
    pub(super) fn mark(&mut self, mark: Mark) -> Event {
        match mark {
            Mark::Meets if self.law.is_none() => self.rebound(),
            Mark::Meets => {
                self.touch();
                Event::Touch
            }
            // Without a damper the force falls to zero just where the indentation does.
            Mark::ForceEnds if self.indentation() > 0.0 && self.modes.contact_force.weights[1] != 0.0 => {
                self.stage = ContactStage::Released;
                Event::Part
            }
            Mark::ForceReturns => {
                self.stage = ContactStage::Touching;
                Event::Touch
            }
            Mark::ForceEnds | Mark::Separates => {
                self.stage = ContactStage::Apart;
                Event::Impact(self.impact)
            }
            Mark::LetsGo => {
                self.stage = ContactStage::Apart;
                self.slack = self.rounding();
                Event::Release
            }
            Mark::SpringActs | Mark::SpringFree => {
                self.spring_acts = mark == Mark::SpringActs;
                // The damper's force may jump, and with it the stage of the contact.
                self.find_stage();
                Event::Switch
            }
        }
    }

    /// The impact that begins at the present state, with its impulse still 0.
    fn met(&self) -> Impact {
        let (time, phase) = (self.time, self.drive.phase);
        Impact { time, phase, approach_velocity: self.state.approach(), impulse: 0.0 }
    }

    pub(super) fn touch(&mut self) {
        self.stage = ContactStage::Touching;
        self.impact = self.met();
        self.within.begin(self.impact.approach_velocity.abs());
    }

    fn rebound(&mut self) -> Event {
        let met = self.met();
        let impulse = self.rig.exchange() * met.approach_velocity;
        self.slack = 0.0;
        self.state = self.rig.struck(self.state, impulse);
        Event::Impact(Impact { impulse, ..met })
    }

    /// Lets the masses move together after a rebound that is too slow to part them against the force that
    /// presses them together.
    pub(super) fn come_to_rest(&mut self, visit: &mut dyn FnMut(Piece<'_>)) {
        if self.law.is_some() || -self.state.approach() >= REST_SPEED {
            return;
        }
        let pressing = self.modes.pressing(self.spring_acts);
        let force = self.drive.force(0.0);
        let w = pressing.weights;
        let s = &self.state;
        let size = (w[0] * s.x1).abs() + (w[2] * s.x2).abs() + (pressing.force * force).abs();
        if pressing.value(s, force) <= 64.0 * f64::EPSILON * size {
            self.slack = self.rounding();
            return;
        }
        let common = self.rig.common_speed(s);
        (self.state.v1, self.state.v2) = (common, common);
        self.stage = ContactStage::Together;
        let end = Still(self.state);
        visit(Piece { start: self.time, duration: 0.0, path: &end, event: Event::Stick });
    }

    /// Applies an event of the excitation: a kick or a step of force.
    pub(super) fn tick(&mut self, tick: Tick) -> Event {
        self.drive.tick(tick);
        let event = match tick {
            Tick::Kick(impulse) => {
                self.state.v1 += impulse / self.rig.masses()[0];
                Event::Kick
            }
            Tick::On | Tick::Off => Event::Switch,
        };
        self.find_stage();
        event
    }

    /// Updates the stage of the contact after a jump of the force or of a velocity.
    pub(super) fn find_stage(&mut self) {
        let pulls = self.modes.contact_force.value(&self.state, 0.0) < 0.0;
        match self.stage {
            ContactStage::Touching if pulls && !self.integrates() => self.stage = ContactStage::Released,
            ContactStage::Released if !pulls => self.stage = ContactStage::Touching,
            ContactStage::Together => {
                let force = self.drive.force(0.0);
                let pressed = self.modes.pressing(self.spring_acts).value(&self.state, force) > 0.0;
                if !pressed || self.state.approach() != 0.0 {
                    self.stage = ContactStage::Apart;
                }
            }
            _ => {}
        }
    }
}

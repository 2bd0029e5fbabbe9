//! Events that change a simulated motion at an instant: impacts, masses that come to rest against each other,
//! kicks and steps of the excitation.

use super::{Hold, Simulation};
use crate::flow::State;
use crate::forcing::Tick;
use crate::impact::Impact;
use crate::motion::Event;
use crate::stick::Press;
use std::f64::consts::TAU;
use vibro_record::Result;

/// Approach speed in m/s below which the end of a chatter is searched: at higher speeds the impacts do not
/// yet follow one another closely enough.
const CHATTER_SPEED: f64 = 1e-3;
/// The same limit relative to the scale of the speeds. A bounce at 6e-8 of this scale, √(16ε), rises no
/// higher than the rounding error of the gap and counts as rest.
const CHATTER_SPEED_RATIO: f64 = 1e-7;

impl Simulation {
    /// Applies the impact law to the present state, which is at contact.
    #[inline]
    pub(super) fn collide(&mut self) -> Result<Impact> {
        let approach = self.state.approach();
        let impulse = self.exchange * approach;
        self.state = self.rig.struck(self.state, impulse);
        self.hold = Hold::Apart;
        if approach < CHATTER_SPEED.max(self.grazing_speed).max(CHATTER_SPEED_RATIO * self.speed_scale())
            || self.rig.restitution == 0.0
        {
            self.end_chatter(approach)?;
        }
        Ok(Impact { time: self.time, phase: self.drive.forcing.phase, approach_velocity: approach, impulse })
    }

    /// Scale of the speeds in m/s: the velocities, and ω times the displacements and the forced amplitude.
    #[inline]
    fn speed_scale(&self) -> f64 {
        let State { x1, v1, x2, v2 } = self.state;
        let displacement = x1.abs() + x2.abs() + self.drive.alone().amplitude;
        v1.abs() + v2.abs() + TAU * self.drive.forcing.frequency * displacement
    }

    /// Decides after an impact whether the masses come to rest together, at once or after a chatter.
    fn end_chatter(&mut self, approach: f64) -> Result<()> {
        let press = Press::of(&self.flight());
        if press.acceleration <= 0.0 && approach < self.grazing_speed {
            self.counts.grazing += 1;
        }
        let separation = self.rig.restitution * approach;
        if separation == 0.0 || press.acceleration > 0.0 && press.is_rest(separation) {
            return self.rest();
        }
        if press.acceleration > 0.0
            && let Some(duration) = press.accumulation(&self.rig, separation)
        {
            let pair = self.pair()?;
            // The chatter ends in rest only if the masses are pressed together until its end.
            if pair.force(0.0).value > 0.0 && pair.release(duration).is_none() {
                self.state = pair.state(0.0);
                self.hold = Hold::Settling(duration);
                self.counts.sticks += 1;
            }
        }
        Ok(())
    }

    /// Decides, for masses at contact without relative motion, whether they stay together.
    pub(super) fn rest(&mut self) -> Result<()> {
        let pair = self.pair()?;
        let (force, noise) = (pair.force(0.0), pair.noise());
        self.state = pair.state(0.0);
        if force.value > noise || force.value >= -noise && force.slope > 0.0 {
            self.hold = Hold::Settling(0.0);
            self.counts.sticks += 1;
        } else {
            self.hold = Hold::Parting;
        }
        Ok(())
    }

    /// Applies an event of the excitation: a kick changes the velocity of mass 1, a step changes the force.
    pub(super) fn tick(&mut self, tick: Tick) -> Result<Event> {
        self.drive.forcing.tick(tick);
        if let Tick::Kick(impulse) = tick {
            self.state.v1 += impulse / self.rig.masses()[0];
            if impulse != 0.0 {
                self.hold = Hold::Apart;
            }
            return Ok(Event::Kick);
        }
        self.look_again()?;
        Ok(Event::Switch)
    }

    /// Decides after a step of the force whether the masses stay together, part, or are apart.
    pub(super) fn look_again(&mut self) -> Result<()> {
        if let Hold::Settling(_) = self.hold {
            // The remaining bounces of the chatter are negligible: it ends now, in rest or in parting.
            self.counts.sticks -= 1;
            return self.rest();
        }
        if self.hold == Hold::Parting {
            // The new force may press masses together that have only begun to part.
            let flight = self.flight();
            if flight.gap(0.0) > 16.0 * flight.noise() {
                self.hold = Hold::Apart;
            } else {
                self.rest()?;
            }
        }
        Ok(())
    }
}

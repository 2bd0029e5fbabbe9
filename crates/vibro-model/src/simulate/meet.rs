//! Impacts, rests and kicks: what changes a simulated motion at an instant.

use super::{Hold, Simulation};
use crate::flow::State;
use crate::forcing::Tick;
use crate::impact::Impact;
use crate::motion::Event;
use crate::stick::Press;
use std::f64::consts::TAU;
use vibro_record::Result;

/// Approach speed in m/s below which the end of a chatter is looked for; above it, impacts do not yet
/// accumulate closely enough.
const SLOW: f64 = 1e-3;
/// The same over the speeds of the masses: a bounce at 6e-8 of them, √(16ε), rises no higher than the
/// rounding of the gap, which is rest.
const SLOW_PART: f64 = 1e-7;

impl Simulation {
    /// Exchanges momentum in the present state, which is at contact.
    #[inline]
    pub(super) fn collide(&mut self) -> Result<Impact> {
        let approach = self.state.approach();
        let impulse = self.exchange * approach;
        self.state = self.rig.struck(self.state, impulse);
        self.hold = Hold::Apart;
        if approach < SLOW.max(self.grazing_speed).max(SLOW_PART * self.speed())
            || self.rig.restitution == 0.0
        {
            self.end_chatter(approach)?;
        }
        Ok(Impact { time: self.time, phase: self.drive.forcing.phase, approach_velocity: approach, impulse })
    }

    /// Scale of the speeds in m/s: of velocities, and of displacements times ω, those under the force too.
    #[inline]
    fn speed(&self) -> f64 {
        let State { x1, v1, x2, v2 } = self.state;
        let way = x1.abs() + x2.abs() + self.drive.alone().amplitude;
        v1.abs() + v2.abs() + TAU * self.drive.forcing.frequency * way
    }

    /// Looks after an impact whether the masses come to rest against each other, at once or after a chatter.
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
            && let Some(left) = press.accumulation(&self.rig, separation)
        {
            let pair = self.pair()?;
            // The masses must be pressed together all the time.
            if pair.force(0.0).value > 0.0 && pair.release(left).is_none() {
                self.state = pair.state(0.0);
                self.hold = Hold::Settling(left);
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

    /// Does what the excitation does now.
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

    /// Finds how the masses are to each other once the force has stepped.
    pub(super) fn look_again(&mut self) -> Result<()> {
        if let Hold::Settling(_) = self.hold {
            // What is left of the chatter is far below the masses' ways: it ends now, in rest or in parting.
            self.counts.sticks -= 1;
            return self.rest();
        }
        if self.hold == Hold::Parting {
            // The new force may press again what has only begun to part.
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

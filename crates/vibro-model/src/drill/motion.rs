//! Motion of the impact unit from event to event.

use super::chain::{Chain, STUCK};
use super::flow::FlowRegime;
use super::machine::{Interface, Machine};
use super::plant::{GAS, PRESSURE, Plant, SIZE, Stage, Vector, Watch, halves};
use super::run::Start;
use super::rungs::Rung;
use super::turn::{Book, Extremes, Impact, Sample, Turn};
use crate::least::{NumberRange, number};
use std::f64::consts::TAU;
use vibro_math::border;
use vibro_math::runge_kutta::{Dop853, Integrator, Step, Tolerance};
use vibro_record::units::notation::significant;
use vibro_record::{Error, Result};

/// Gap in m that counts as touching: some hundred roundings of a position.
const TOUCH: f64 = 1e-14;
/// Relative velocity in m/s that counts as none: a thousand roundings of a velocity.
pub(super) const NO_SPEED: f64 = 1e-12;
/// Way in m that completed chatters may leave out. Rebounds from a separation at w against an acceleration a
/// last 2w/(a(1 − R)) in total, and lift the bodies by w²/2a; their product with w bounds the way left out.
const CHATTER_WAY: f64 = 1e-13;
/// Overlap in m that is no contact after bodies have parted from rest, and gap in m that is none in a
/// compliant contact.
pub(super) const PARTING: f64 = 1e-13;
/// Most events in a turn, and most impacts in one instant.
const MOST_EVENTS: usize = 20_000;
const MOST_SWEEPS: usize = 2_000;
/// Instants of a step at which a force of a curved contact is looked at.
const LOOKS: usize = 8;
/// Nodes and weights on 0 to 1 of the quadrature of Gauss with four nodes, exact for a step's polynomial.
const GAUSS: [(f64, f64); 4] = [
    (0.069_431_844_202_973_71, 0.173_927_422_568_726_93),
    (0.330_009_478_207_571_87, 0.326_072_577_431_273_07),
    (0.669_990_521_792_428_1, 0.326_072_577_431_273_07),
    (0.930_568_155_797_026_3, 0.173_927_422_568_726_93),
];

/// A machine in motion, turn by turn from top dead centre, where its numbers may change.
///
/// ```
/// use vibro_model::drill::{Machine, Motion, Rung, Start};
/// let mut machine = Machine::example();
/// let mut motion = Motion::new(&machine, Rung::Friction, &Start::rest(&machine), 1e-9)?;
/// for frequency in [45.0, 44.9, 45.2] {
///     machine.crank.frequency = frequency;
///     motion.change(&machine)?;
///     assert_eq!(motion.turn(Some(100))?.samples.len(), 100);
/// }
/// # Ok::<(), vibro_record::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct Motion {
    plant: Plant,
    rung: Rung,
    y: Vector,
    /// Time in s at which the present turn began, and since then.
    began: f64,
    time: f64,
    next_step: f64,
    tolerance: Tolerance<SIZE>,
    /// First touch of each compliant contact: time since the start, velocities, and the step before.
    touched: [(f64, [f64; 2], f64); 4],
    /// Accepted steps so far, and the most that may be.
    pub(super) steps: usize,
    pub(super) most_steps: usize,
    turn: Turn,
}

impl Motion {
    /// A machine on a rung, with steps of this relative error.
    ///
    /// # Errors
    /// If a number of the machine or the start is impossible, or bodies overlap.
    pub fn new(machine: &Machine, rung: Rung, start: &Start, relative: f64) -> Result<Motion> {
        machine.check()?;
        for value in start.positions.iter().chain(&start.velocities) {
            number("position or velocity at the start", *value, "", NumberRange::Any)?;
        }
        let mut plant = Plant::new(machine, rung);
        let mut y = [0.0; SIZE];
        y[..3].copy_from_slice(&start.positions);
        y[3..6].copy_from_slice(&start.velocities);
        let m = &plant.machine;
        let speed = TAU * m.crank.frequency * m.crank.radius;
        for (k, interface) in Interface::ALL.into_iter().enumerate() {
            let gap = plant.chain.gap(k, &halves(&y)[0]);
            if gap < -TOUCH && plant.laws[k].is_none() {
                let found =
                    format!("{interface:?}: bodies overlap by {} m at the start", significant(-gap, 3));
                return Err(Error::usage(found, "positions without overlap of rigid bodies"));
            }
        }
        let volume = plant.volume(0.0, &y);
        if volume.is_nan() || volume <= 0.0 {
            return Err(Error::usage("a striker behind the piston", "a start in front of the piston"));
        }
        // A sealed cushion keeps the air that it has at its origin.
        let sealed = m.flow.is_sealed();
        y[PRESSURE] = if sealed { m.cushion.sealed_pressure(volume) } else { m.cushion.ambient };
        y[GAS] = m.cushion.gas(m.cushion.ambient, if sealed { m.cushion.rest_volume() } else { volume });
        let way = 2.0 * m.crank.radius;
        let floor = [way, way, way, speed, speed, speed, m.cushion.ambient, y[GAS]];
        plant.stretch = m.flow.stretch(y[0]);
        plant.flow = m.flow.regime(y[PRESSURE], m.cushion.ambient);
        let mut motion = Motion {
            next_step: 1e-3 * m.crank.period(),
            plant,
            rung,
            y,
            began: 0.0,
            time: 0.0,
            tolerance: Tolerance { relative, floor },
            touched: [(0.0, [0.0; 2], 0.0); 4],
            steps: 0,
            most_steps: usize::MAX,
            turn: Turn::default(),
        };
        motion.collide()?;
        Ok(motion)
    }

    /// State; see [`SIZE`].
    #[cfg(test)]
    pub(super) fn state(&self) -> &Vector {
        &self.y
    }

    /// Time in s since the start.
    fn now(&self) -> f64 {
        self.began + self.time
    }

    /// Follows a whole turn; `samples` states at even angles are kept. With `None` impulses, extremes and
    /// the energies that pass are not computed either.
    ///
    /// # Errors
    /// If the striker strikes the driving piston, or a chatter without loss cannot be followed.
    pub fn turn(&mut self, samples: Option<usize>) -> Result<Turn> {
        let (before, air) = (self.energies(), self.stored_air());
        self.fly(samples)?;
        let after = self.energies();
        let [kinetic, potential, elastic] = std::array::from_fn(|i| after[i] - before[i]);
        let air = self.stored_air() - air;
        let mut turn = self.take_turn();
        let Book { piston, impacts, contacts, seal, flow, .. } = turn.book;
        let residual = piston - kinetic - potential - elastic - air - impacts - contacts - seal - flow;
        turn.book =
            Book { piston, kinetic, potential, elastic, air, impacts, contacts, seal, flow, residual };
        [turn.end, _] = halves(&self.y);
        self.began += self.plant.machine.crank.period();
        self.time = 0.0;
        Ok(turn)
    }

    /// The turn so far, with its blow and momentum; the next begins.
    pub(super) fn take_turn(&mut self) -> Turn {
        let mut turn = std::mem::take(&mut self.turn);
        let (crank, [striker, .., bit]) = (self.plant.machine.crank, self.plant.chain.masses);
        turn.blow = Turn::blow_among(&turn.impacts, crank.top_speed(), striker, bit);
        let [_, v] = halves(&self.y);
        turn.momentum = v.iter().zip(&self.plant.chain.masses).map(|(v, mass)| v * mass).sum();
        turn
    }

    /// Goes on with another machine of the same masses and gaps: position and speed of the driving piston are
    /// the same at top dead centre.
    ///
    /// # Errors
    /// If a number of the machine is impossible, or a mass or a gap is another.
    pub fn change(&mut self, machine: &Machine) -> Result<()> {
        machine.check()?;
        let mut plant = Plant::new(machine, self.rung);
        if plant.chain != self.plant.chain {
            return Err(Error::usage("another mass or gap", "those of the machine that moves"));
        }
        (plant.stages, plant.slack) = (self.plant.stages, self.plant.slack);
        plant.stretch = machine.flow.stretch(self.y[0]);
        plant.flow = machine.flow.regime(self.y[PRESSURE], machine.cushion.ambient);
        self.plant = plant;
        self.settle(None)
    }

    /// Kinetic, potential and elastic energy in J.
    fn energies(&self) -> [f64; 3] {
        let [x, v] = halves(&self.y);
        let chain = &self.plant.chain;
        let weighted: f64 = x.iter().zip(&chain.masses).map(|(x, mass)| x * mass).sum();
        [chain.kinetic(&v), -self.plant.machine.gravity * weighted, self.plant.elastic(&self.y)]
    }

    fn stored_air(&self) -> f64 {
        self.plant.machine.cushion.stored(self.y[PRESSURE], self.plant.volume(self.time, &self.y))
    }

    /// Integrates to the end of the turn, from event to event.
    fn fly(&mut self, samples: Option<usize>) -> Result<()> {
        let period = self.plant.machine.crank.period();
        for _ in 0..MOST_EVENTS {
            let (y, plant) = (self.y, &self.plant);
            let rate = |t: f64, y: &Vector| plant.rate(plant.machine.crank.at(t), y);
            let mut integrator =
                Integrator::<Dop853, SIZE>::new(rate, self.time, y, self.next_step, self.tolerance);
            let mut event = None;
            while event.is_none() && self.time < period {
                let crank = self.plant.machine.crank;
                let step = integrator.forced_step(|t| crank.at(t), |x, y| self.plant.rate(x, y), period)?;
                self.steps += 1;
                if self.steps > self.most_steps {
                    return Err(too_many("integration steps", self.most_steps, self.now()));
                }
                event = self.first_event(&step);
                let duration = event.map_or(step.duration, |(t, _)| t);
                if let Some(samples) = samples {
                    self.record(&step, duration, samples);
                }
                self.y = step.at(duration);
                self.time = if event.is_none() { integrator.time() } else { step.start + duration };
                let rate = integrator.rate();
                let bound = self.plant.step_bound(&self.y, rate, self.tolerance.relative);
                integrator.limit_step(bound);
                self.next_step = integrator.next_step();
                if self.plant.volume(self.time, &self.y) <= self.plant.machine.cushion.dead_volume {
                    let now = significant(self.now(), 6);
                    return Err(Error::refused(format!("at {now} s the striker strikes the driving piston"))
                        .hint("check leakage and vents: the air cushion must keep them apart"));
                }
            }
            let Some((_, watch)) = event else { return Ok(()) };
            self.apply(watch)?;
            // Another contact may push on.
            let rate = self.plant.rate(self.plant.machine.crank.at(self.time), &self.y);
            let bound = self.plant.step_bound(&self.y, &rate, self.tolerance.relative);
            self.next_step = self.next_step.min(bound);
        }
        Err(too_many("events in a turn", MOST_EVENTS, self.now()))
    }

    /// First event in a step, with its time in s since the start of the step.
    fn first_event(&self, step: &Step<SIZE>) -> Option<(f64, Watch)> {
        let mut first: Option<(f64, Watch)> = None;
        let reach = step.reach();
        for (watch, line) in &self.plant.watches {
            // Most borders are out of reach; rounding is far below a hundredth of the reach.
            let change: f64 = line.weights.iter().zip(&reach).map(|(w, reach)| w.abs() * reach).sum();
            if line.value(&self.y) > 1.01 * change && !self.plant.is_curved(*watch) {
                continue;
            }
            let time = if self.plant.is_curved(*watch) {
                self.curved_fall(*watch, step)
            } else {
                let mut weights = [0.0; SIZE];
                weights[..line.weights.len()].copy_from_slice(&line.weights);
                step.first_fall(&weights, line.offset)
            };
            if let Some(t) = time.filter(|t| first.is_none_or(|(sooner, _)| *t < sooner)) {
                first = Some((t, *watch));
            }
        }
        first
    }

    /// Fall of a holding force that depends on a curved contact, in the polynomial of the step. It is looked
    /// for at [`LOOKS`] instants: a contact lasts some twenty steps, so that it is smooth between them.
    fn curved_fall(&self, watch: Watch, step: &Step<SIZE>) -> Option<f64> {
        let reserve = |t: f64| match watch {
            Watch::Slips(direction) => {
                self.plant.machine.striker.friction + direction * self.plant.hold(STUCK, &step.at(t))
            }
            Watch::Pulls(k) => self.plant.hold(k, &step.at(t)),
            _ => 0.0,
        };
        let look = |i: usize| step.duration * i as f64 / LOOKS as f64;
        let fallen = (1..=LOOKS).find(|i| reserve(look(*i)) < 0.0)?;
        Some(border(look(fallen - 1), look(fallen), |t| reserve(t) >= 0.0))
    }

    /// Adds impulses and samples of a step up to `duration` (s).
    fn record(&mut self, step: &Step<SIZE>, duration: f64, samples: usize) {
        for (node, weight) in GAUSS {
            let y = step.at(node * duration);
            let (handle, damper) =
                (self.plant.handle_force(&y), self.plant.contact_force(Interface::Damper as usize, &y));
            let turn = &mut self.turn;
            turn.handle += weight * duration * handle;
            turn.damper += weight * duration * damper;
            let book = &mut turn.book;
            let sums = [&mut book.piston, &mut book.seal, &mut book.contacts, &mut book.flow];
            let crank = self.plant.machine.crank.at(step.start + node * duration);
            for (sum, power) in sums.into_iter().zip(self.plant.powers(crank, &y)) {
                *sum += weight * duration * power;
            }
            let here = Extremes { handle: [handle; 2], damper: [damper; 2], pressure: [y[PRESSURE]; 2] };
            turn.extremes = turn.extremes.with(&here);
        }
        let period = self.plant.machine.crank.period();
        while self.turn.samples.len() < samples {
            let part = self.turn.samples.len() as f64 / samples as f64;
            let at = part * period - step.start;
            if at > duration {
                break;
            }
            let y = step.at(at.max(0.0));
            let [positions, velocities] = halves(&y);
            self.turn.samples.push(Sample {
                angle: TAU * part,
                piston: self.plant.machine.crank.at(part * period)[0],
                positions,
                velocities,
                pressure: y[PRESSURE],
                gas: y[GAS],
                handle: self.plant.handle_force(&y),
                damper: self.plant.contact_force(Interface::Damper as usize, &y),
            });
        }
    }

    /// Applies an event to the state and the equations.
    fn apply(&mut self, watch: Watch) -> Result<()> {
        let both = |k: usize, y: &Vector| Chain::both(k, &halves(y)[1]);
        match watch {
            Watch::Meets(k) if self.plant.laws[k].is_none() => return self.collide(),
            Watch::Meets(k) => {
                self.touched[k] = (self.now(), both(k, &self.y), self.next_step);
                self.plant.stages[k] = Stage::Pushing;
                self.next_step =
                    self.next_step.min(self.plant.first_step(k, &self.y, self.tolerance.relative));
            }
            Watch::Separates(k) => {
                self.plant.stages[k] = Stage::Apart;
                let ((time, before, step), after) = (self.touched[k], both(k, &self.y));
                // Without the contact the motion is as smooth as before it.
                self.next_step = self.next_step.max(step);
                let square = |v: &[f64; 2]| (v[0] - v[1]).powi(2);
                let lost = 0.5 * (square(&before) - square(&after)) / self.plant.chain.compliance(k);
                let duration = self.now() - time;
                let interface = Interface::ALL[k];
                self.turn.impacts.push(Impact { time, duration, interface, before, after, lost });
            }
            Watch::ForceEnds(k) => self.plant.stages[k] = Stage::Released,
            Watch::ForceReturns(k) => self.plant.stages[k] = Stage::Pushing,
            Watch::Pulls(k) => return self.settle(Some(k)),
            Watch::Stops => {
                self.y[3] = 0.0;
                return self.settle(None);
            }
            Watch::Slips(direction) => {
                self.plant.slip = direction;
                return self.settle(Some(STUCK));
            }
            Watch::Flows(regime) => {
                let from = std::mem::replace(&mut self.plant.flow, regime);
                if [from, regime].contains(&FlowRegime::Even) {
                    // The flow is steep beside the regime of even pressures, and as good as linear in it.
                    let (step, old) = (self.plant.even_step(self.time, &self.y), self.next_step);
                    self.next_step = if regime == FlowRegime::Even { old.max(step) } else { old.min(step) };
                }
            }
            Watch::Vents(stretch) => self.plant.stretch = stretch,
        }
        self.settle(None)
    }

    fn touches(&self, k: usize) -> bool {
        let gap = self.plant.chain.gap(k, &halves(&self.y)[0]);
        match self.plant.stages[k] {
            Stage::Held => true,
            Stage::Apart => self.plant.laws[k].is_none() && gap <= TOUCH + 2.0 * self.plant.slack[k],
            _ => false,
        }
    }

    /// Rigid impacts of all touching bodies, one after another, until none approach.
    fn collide(&mut self) -> Result<()> {
        let [_, mut v] = halves(&self.y);
        for sweep in 0.. {
            let mut any = false;
            for (k, interface) in Interface::ALL.into_iter().enumerate() {
                if !self.touches(k) || Chain::approach(k, &v) <= NO_SPEED {
                    continue;
                }
                any = true;
                let before = Chain::both(k, &v);
                let restitution = self.plant.machine.contacts[k].restitution;
                let impulse = Chain::approach(k, &v) / self.plant.chain.compliance(k) * (1.0 + restitution);
                let lost = self.plant.chain.strike(k, restitution, &mut v);
                let after = Chain::both(k, &v);
                match interface {
                    Interface::Damper => self.turn.damper += impulse,
                    Interface::Buffer => self.turn.handle -= impulse,
                    _ => {}
                }
                self.turn.book.impacts += lost;
                let (time, duration) = (self.now(), 0.0);
                self.turn.impacts.push(Impact { time, duration, interface, before, after, lost });
                self.plant.slack[k] = 0.0;
            }
            if !any {
                break;
            }
            if sweep > MOST_SWEEPS {
                return Err(too_many("impacts in one instant", MOST_SWEEPS, self.now()));
            }
        }
        self.y[3..6].copy_from_slice(&v);
        self.settle(None)
    }

    /// Decides by the balance of forces which touching bodies stay together and whether the striker sticks,
    /// and makes the equations anew. `released` is a constraint that has just given way.
    fn settle(&mut self, released: Option<usize>) -> Result<()> {
        let [x, v] = halves(&self.y);
        let friction = self.plant.machine.striker.friction;
        let touching: [bool; 4] = std::array::from_fn(|k| self.touches(k));
        let separation: [f64; 4] = std::array::from_fn(|k| -Chain::approach(k, &v));
        let held = self.plant.kept();
        for (k, speed) in separation.into_iter().enumerate() {
            // Faster rebounds are followed; a chatter ends far below.
            let slow = (-NO_SPEED..1e-3).contains(&speed);
            if self.plant.laws[k].is_none() {
                let stays = slow && touching[k] && released != Some(k);
                self.plant.stages[k] = if stays { Stage::Held } else { Stage::Apart };
            }
        }
        self.plant.stuck = false;
        if friction == 0.0 {
            self.plant.slip = 0.0;
        } else if v[0].abs() > NO_SPEED {
            self.plant.slip = v[0].signum();
        } else if released != Some(STUCK) {
            (self.plant.stuck, self.plant.slip) = (true, 0.0);
        }
        loop {
            if !self.plant.assemble() {
                // The striker stands on bodies that cannot move, or the chain is wedged.
                if !std::mem::take(&mut self.plant.stuck) {
                    self.plant.stages[Interface::Buffer as usize] = Stage::Apart;
                }
                continue;
            }
            // The constraint that is furthest from holding gives way.
            let mut worst: (f64, Option<usize>) = (0.0, None);
            for k in (0..4).filter(|k| self.plant.stages[*k] == Stage::Held) {
                let force = self.plant.hold(k, &self.y);
                let pressing = force * self.plant.chain.compliance(k);
                let loss = 1.0 - self.plant.machine.contacts[k].restitution;
                let lift = separation[k].max(0.0).powi(2) - CHATTER_WAY * loss * pressing;
                // Rebounds count from their speed, forces from their sign.
                let excess = if separation[k] > NO_SPEED { lift } else { -pressing };
                if excess > worst.0 {
                    worst = (excess, Some(k));
                }
            }
            if let Some(k) = worst.1 {
                self.plant.stages[k] = Stage::Apart;
                continue;
            }
            if self.plant.stuck {
                let force = self.plant.hold(STUCK, &self.y);
                // A little less: where it has just begun to slip, rounding must not stop it.
                if force.abs() > (1.0 - 1e-9) * friction {
                    (self.plant.stuck, self.plant.slip) = (false, -force.signum());
                    continue;
                }
            }
            break;
        }
        let (after, impulses) = self.plant.projected(&v);
        self.turn.book.impacts += self.plant.chain.kinetic(&v) - self.plant.chain.kinetic(&after);
        let kept = self.plant.kept();
        for k in 0..4 {
            self.turn.chatters += usize::from(kept[k] && !held[k]);
            if touching[k] && !kept[k] && separation[k].abs() <= NO_SPEED {
                // Rounding must not close a gap that opens from rest.
                self.plant.slack[k] = PARTING - self.plant.chain.gap(k, &x).min(0.0);
            }
        }
        self.turn.damper += impulses[Interface::Damper as usize];
        self.turn.handle -= impulses[Interface::Buffer as usize] + impulses[STUCK];
        self.y[3..6].copy_from_slice(&after);
        if friction != 0.0 && (after[0] - v[0]).abs() > NO_SPEED {
            // The seal follows the velocity that the striker has now.
            return self.settle(None);
        }
        // Slack changes the borders.
        self.plant.assemble();
        Ok(())
    }
}

fn too_many(what: &str, most: usize, time: f64) -> Error {
    Error::refused(format!("more than {most} {what}, at {} s", significant(time, 6)))
        .hint("give the impacts some loss (restitution below 1), or choose a higher speed")
}

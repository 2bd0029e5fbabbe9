//! Any motion of the rig with a compliant contact, or with a mass 1 that is loose on its spring. The motion
//! is followed from event to event: exactly in linear modes, by integration in contacts that are not linear.

use super::modes::Modes;
use super::still::Still;
use super::within::Within;
use crate::excitation::Excitation;
use crate::flow::State;
use crate::forcing::Forcing;
use crate::forcing::Tick;
use crate::impact::Impact;
use crate::law::Law;
use crate::least::{NumberRange, number};
use crate::linear::{Linear, Quantity, QuantityCourse};
use crate::motion::{Event, Motion, Path, Piece};
use crate::rig::Rig;
use crate::scales;
use crate::scene::Buffer;
use vibro_record::{Error, Result};

/// Most pieces of linear motion in one call: some minutes of work. An integrated piece counts as ten.
const MOST_WORK: f64 = 1e9;
/// Largest number of events in a row at the same time; with more the simulation stops with an error.
const MOST_AT_ONCE: u32 = 1000;

/// Stage of a contact.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum ContactStage {
    /// Apart.
    Apart,
    /// In contact, with a force that pushes.
    Touching,
    /// The force has fallen to zero while the surfaces are still indented.
    Released,
    /// Moving together, pressed, after rigid impacts whose rebounds have died away.
    Together,
}

/// Event at which a watched quantity, such as the gap or the contact force, falls to zero.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Mark {
    Meets,
    ForceEnds,
    ForceReturns,
    Separates,
    LetsGo,
    SpringActs,
    SpringFree,
}

/// A motion with a compliant contact or a loose mass 1: its present state and its excitation.
///
/// Flights and Kelvin–Voigt contacts are linear modes, exact to rounding; Hertz and Hunt–Crossley contacts
/// are integrated with a relative error of 1e-13 a step. The rig's restitution is not used: the contact law
/// determines the rebound. Mass 2 may be a wall (m₂ infinite): the impact oscillator.
///
/// Pieces end with `Touch` where the surfaces meet, with `Part` where the force falls to zero while the
/// surfaces are still indented (the damper slows their return), with `Touch` again where the force returns
/// before they separate, and with `Impact` once they do. The impact has the time, phase and approach speed of
/// the first touch, and the whole impulse. Long stretches are split into pieces that end with `Reached`.
#[derive(Debug, Clone, PartialEq)]
pub struct Compliant {
    pub(super) rig: Rig,
    /// `None` for rigid impacts with the rig's restitution.
    pub(super) law: Option<Law>,
    loose: bool,
    pub(super) modes: Modes,
    pub(super) drive: Forcing,
    pub(super) within: Within,
    pub(super) time: f64,
    pub(super) state: State,
    pub(super) stage: ContactStage,
    pub(super) spring_acts: bool,
    /// The present contact, with the impulse in N s that it has transferred so far.
    pub(super) impact: Impact,
    /// Overlap in m that does not count as contact after masses at rest against each other have parted: it
    /// is of the order of rounding.
    pub(super) slack: f64,
}

impl Compliant {
    /// A motion that starts from `state` at time 0 and `phase` (rad) of the excitation's cycle. The masses
    /// may be pressed into each other.
    ///
    /// # Errors
    /// If a parameter is impossible, or the state or the phase is not finite.
    pub fn new(rig: &Rig, excitation: &Excitation, law: Law, state: State, phase: f64) -> Result<Compliant> {
        Compliant::start(rig, excitation, Some(law), None, state, phase)
    }

    /// A motion with a loose mass 1. Its contact with mass 2 is a spring and a damper, or a rigid impact with
    /// the rig's restitution.
    ///
    /// The spring and damper of mass 1 are a buffer on its side away from mass 2, `gap` (m) from its rest
    /// position: the force on mass 1 is −k₁(x₁ + gap) − c₁v₁ for x₁ < −gap and none elsewhere, or −c₁v₁
    /// there with [`Buffer::damper_always`]. Pieces end with `Switch` where the buffer begins or ceases to
    /// act. With rigid impacts they also end with `Impact`, with `Stick` where the masses have chattered to
    /// rest against each other, and with `Release` where they cease to move together.
    ///
    /// ```
    /// use vibro_model::{Buffer, Compliant, Event, Excitation, Motion, Rig, Sine, State};
    /// let sine = Excitation::Sine(Sine { force: 0.1, frequency: 4.5 });
    /// let mut motion = Compliant::loose(&Rig::thesis(), &sine, Buffer::thesis(), None, State::REST, 0.0)?;
    /// let mut switches = 0;
    /// motion.advance(2.0, &mut |piece| switches += usize::from(piece.event == Event::Switch))?;
    /// assert!(switches > 4);
    /// # Ok::<(), vibro_record::Error>(())
    /// ```
    ///
    /// # Errors
    /// If a parameter is impossible, the state or the phase is not finite, the masses overlap without a law,
    /// or the law is not Kelvin–Voigt.
    pub fn loose(
        rig: &Rig,
        excitation: &Excitation,
        buffer: Buffer,
        law: Option<Law>,
        state: State,
        phase: f64,
    ) -> Result<Compliant> {
        if law.is_some_and(|law| !law.is_linear()) {
            let expected =
                "rebounds at once or a Kelvin–Voigt contact: the other laws are for masses on their springs";
            return Err(Error::usage("a loose mass with a contact law that is not linear", expected));
        }
        number("buffer gap", buffer.gap, "m", NumberRange::Zero)?;
        Compliant::start(rig, excitation, law, Some(buffer), state, phase)
    }

    fn start(
        rig: &Rig,
        excitation: &Excitation,
        law: Option<Law>,
        buffer: Option<Buffer>,
        state: State,
        phase: f64,
    ) -> Result<Compliant> {
        scales::check(rig, excitation)?;
        rig.check_start(&state, phase)?;
        law.map_or(Ok(()), |law| law.check())?;
        let modes = Modes::new(rig, law, buffer);
        let mut motion = Compliant {
            rig: *rig,
            law,
            loose: buffer.is_some(),
            within: Within::new(rig, law, modes.reduced_mass),
            drive: Forcing::new(excitation, phase)?,
            time: 0.0,
            state,
            stage: ContactStage::Apart,
            spring_acts: buffer.is_none() || modes.compression.value(&state, 0.0) > 0.0,
            impact: Impact::default(),
            slack: 0.0,
            modes,
        };
        if motion.indentation() > motion.rounding() / 2.0 {
            if law.is_none() {
                return Err(rig.overlap(&state));
            }
            motion.touch();
            motion.find_stage();
        }
        Ok(motion)
    }

    /// Whether contacts are integrated, because their force is not linear.
    pub(crate) fn integrates(&self) -> bool {
        self.within.law.is_some()
    }

    pub(super) fn indentation(&self) -> f64 {
        self.modes.indentation.value(&self.state, 0.0)
    }

    /// Rounding of the indentation in m.
    pub(super) fn rounding(&self) -> f64 {
        8.0 * f64::EPSILON * (self.state.x1.abs() + self.state.x2.abs() + self.rig.gap.abs())
    }

    fn mode(&self) -> &Linear {
        let by_spring = match self.stage {
            ContactStage::Apart | ContactStage::Released => &self.modes.apart,
            ContactStage::Touching => &self.modes.pushing,
            ContactStage::Together => &self.modes.together,
        };
        &by_spring[usize::from(self.spring_acts)]
    }

    /// Computes one piece; returns whether the motion has reached the time `until` (s).
    fn piece(&mut self, until: f64, visit: &mut dyn FnMut(Piece<'_>)) -> Result<bool> {
        let remaining = until - self.time;
        let due = self.drive.next(remaining, until);
        let near = remaining.min(due.0);
        if self.stage == ContactStage::Touching && self.integrates() {
            if near <= 0.0 {
                return Ok(self.pass(&Still(self.state), 0.0, None, due, until, visit));
            }
            let mode = &self.modes.apart[usize::from(self.spring_acts)];
            let step = self.within.step(mode, &self.drive, &self.state, near)?;
            let fall = self.within.first_fall(&step);
            let duration = fall.unwrap_or(step.duration);
            self.impact.impulse += step.at(duration)[4];
            return Ok(self.pass(&step, duration, fall.map(|_| Mark::Separates), due, until, visit));
        }
        let mode = self.mode();
        let longest = 1.0 / mode.rate.max(self.drive.fastest());
        let span = near.min(longest);
        let force = self.drive.terms(span);
        let taylor = mode.fly(&self.state, &force, span);
        let mut first: Option<(f64, Mark)> = None;
        let read = |quantity: &Quantity| taylor.read(quantity, &force);
        let mut watch = |course: &QuantityCourse, mark: Mark| {
            if let Some(t) = course.first_fall()
                && first.is_none_or(|(earlier, _)| t < earlier)
            {
                first = Some((t, mark));
            }
        };
        let modes = &self.modes;
        match self.stage {
            ContactStage::Apart => {
                let mut gap = modes.indentation.times(-1.0);
                gap.offset += self.slack;
                watch(&read(&gap), Mark::Meets);
            }
            ContactStage::Touching => watch(&read(&modes.contact_force), Mark::ForceEnds),
            ContactStage::Released => {
                watch(&read(&modes.indentation), Mark::Separates);
                watch(&read(&modes.contact_force.times(-1.0)), Mark::ForceReturns);
            }
            ContactStage::Together => watch(&read(&modes.pressing(self.spring_acts)), Mark::LetsGo),
        }
        if self.loose && self.spring_acts {
            watch(&read(&modes.compression), Mark::SpringFree);
        } else if self.loose {
            watch(&read(&modes.compression.times(-1.0)), Mark::SpringActs);
        }
        let duration = first.map_or(span, |(t, _)| t);
        if self.stage == ContactStage::Touching {
            self.impact.impulse += read(&self.modes.contact_force).integral(duration);
        }
        Ok(self.pass(&taylor, duration, first.map(|(_, mark)| mark), due, until, visit))
    }

    /// Advances along `path` by `duration` seconds, and applies the mark or the event of the excitation
    /// there; returns whether `until` was reached.
    fn pass(
        &mut self,
        path: &dyn Path,
        duration: f64,
        mark: Option<Mark>,
        (wait, tick): (f64, Option<Tick>),
        until: f64,
        visit: &mut dyn FnMut(Piece<'_>),
    ) -> bool {
        let start = self.time;
        self.state = path.state(duration);
        self.drive.pass(duration);
        let whole = mark.is_none() && duration == until - start;
        self.time = if whole { until } else { start + duration };
        let event = match (mark, tick) {
            (Some(mark), _) => self.mark(mark),
            (None, Some(tick)) if duration == wait => self.tick(tick),
            _ => Event::Reached,
        };
        visit(Piece { start, duration, path, event });
        if self.stage == ContactStage::Apart && matches!(event, Event::Impact(_)) {
            self.come_to_rest(visit);
        }
        whole && event == Event::Reached
    }
}

impl Motion for Compliant {
    fn rig(&self) -> &Rig {
        &self.rig
    }

    fn time(&self) -> f64 {
        self.time
    }

    fn state(&self) -> State {
        self.state
    }

    fn phase(&self) -> f64 {
        self.drive.phase
    }

    fn frequency(&self) -> f64 {
        self.drive.frequency
    }

    fn set_frequency(&mut self, hz: f64) -> Result<()> {
        self.drive.set_frequency(hz)
    }

    fn set_excitation(&mut self, excitation: &Excitation) -> Result<()> {
        self.drive.set_excitation(excitation)?;
        self.find_stage();
        Ok(())
    }

    fn law(&self) -> Option<Law> {
        self.law
    }

    fn advance(&mut self, until: f64, visit: &mut dyn FnMut(Piece<'_>)) -> Result<()> {
        scales::check_time(self.time, until)?;
        let fastest = self.modes.apart[1].rate.max(self.drive.fastest());
        let (mut at_once, mut last) = (0, f64::NAN);
        let mut work = (until - self.time) * fastest.max(self.drive.frequency);
        while work <= MOST_WORK && at_once <= MOST_AT_ONCE {
            if self.piece(until, visit)? {
                return Ok(());
            }
            work += if self.stage == ContactStage::Touching && self.integrates() { 10.0 } else { 1.0 };
            at_once = if self.time == last { at_once + 1 } else { 0 };
            last = self.time;
        }
        Err(Error::refused(format!(
            "from {} s to {until} s the motion has more pieces than one call computes",
            self.time
        ))
        .hint("ask for less time at once, or for a softer contact"))
    }
}

#[cfg(test)]
mod tests;

#[cfg(test)]
mod wall_tests;

#[cfg(test)]
mod loose_tests;

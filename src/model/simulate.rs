//! Any motion of the rig under a sine force, event by event: exact flights between guaranteed contacts.
//!
//! Nothing is integrated in steps. Each flight is a closed form; it ends at the first root of the gap; the impact
//! changes the velocities; the next flight starts from the state found there, so errors do not grow with a flight's
//! length. The force's phase is kept within 2π and runs on when the frequency is changed.

use super::{Event, Flight, Motion, Path, Piece, Rig, Sine, State, Steady};
use crate::error::{Error, Result};
use crate::math::Oscillator;
use serde::Serialize;
use std::f64::consts::TAU;

/// Approach speed in m/s below which a chattering pair of masses counts as stuck together. All impacts down to it are
/// computed; in a chatter those below it would take 2·[`REST_SPEED`]/a(1 − R) seconds more, a being the pressing
/// acceleration.
pub const REST_SPEED: f64 = 1e-9;

/// One impact.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Impact {
    /// Time in s.
    pub time: f64,
    /// Phase in 0..2π of the force F₀ cos(ωt + θ).
    pub phase: f64,
    /// Approach speed v₁ − v₂ in m/s.
    pub approach_velocity: f64,
    /// Impulse in N s.
    pub impulse: f64,
}

/// One flight of a simulated motion and the impact that ended it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Leg {
    /// Time in s of its start.
    pub start: f64,
    /// Duration in s.
    pub duration: f64,
    /// The motion.
    pub flight: Flight,
    /// The impact at its end; `None` where the flight was still under way when it was asked to end.
    pub impact: Option<Impact>,
}

/// Displacements, velocities and impacts over an interval of time.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Recorded {
    /// State at each sampling time; at an impact, the state after it.
    pub states: Vec<State>,
    /// Impacts in order.
    pub impacts: Vec<Impact>,
}

/// A simulated motion: where it is now, and what drives it on.
///
/// ```
/// use vibroimpact::model::{Rig, Simulation, Sine};
/// let mut motion = Simulation::new(&Rig::thesis(), &Sine { force: 0.5, frequency: 11.0 })?;
/// motion.run(20.0, |_| {})?;
/// let mut impacts = 0;
/// motion.run(21.0, |leg| impacts += usize::from(leg.impact.is_some()))?;
/// assert_eq!(impacts, 11);
/// # Ok::<(), vibroimpact::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Simulation {
    rig: Rig,
    sine: Sine,
    steady: Steady,
    oscillators: [Oscillator; 2],
    /// M(1 + R).
    exchange: f64,
    time: f64,
    phase: f64,
    state: State,
}

impl Simulation {
    /// Both masses at rest at time 0, the force at phase 0 (its crest).
    ///
    /// # Errors
    /// If a parameter is impossible, mass 1 is undamped and driven at resonance, or the gap at rest is negative.
    pub fn new(rig: &Rig, sine: &Sine) -> Result<Simulation> {
        Simulation::from_state(rig, sine, State::REST, 0.0)
    }

    /// A motion that starts from `state` at time 0, the force being F₀ cos(ωt + `phase`).
    ///
    /// # Errors
    /// As [`Simulation::new`], and if the state is not finite or the masses overlap in it.
    pub fn from_state(rig: &Rig, sine: &Sine, state: State, phase: f64) -> Result<Simulation> {
        let steady = Steady::new(rig, sine)?;
        let State { x1, v1, x2, v2 } = state;
        if ![x1, v1, x2, v2, phase].iter().all(|v| v.is_finite()) {
            return Err(Error::usage(
                format!("initial state {x1}, {v1}, {x2}, {v2} with phase {phase}"),
                "finite values",
            ));
        }
        let overlap = x1 - x2 - rig.gap;
        // A state left behind by an impact overlaps by its rounding.
        if overlap > 4.0 * f64::EPSILON * (x1.abs() + x2.abs() + rig.gap.abs()) {
            return Err(Error::usage(
                format!("the masses overlap by {overlap} m at the start"),
                "x1 − x2 of at most the gap; give an initial state in which they are apart",
            ));
        }
        Ok(Simulation {
            rig: *rig,
            sine: *sine,
            steady,
            oscillators: rig.oscillators(),
            exchange: rig.reduced_mass() * (1.0 + rig.restitution),
            time: 0.0,
            phase: phase.rem_euclid(TAU),
            state,
        })
    }

    /// Time in s.
    pub fn time(&self) -> f64 {
        self.time
    }

    /// State now; after an impact, if one happens now.
    pub fn state(&self) -> State {
        self.state
    }

    /// Phase in 0..2π of the force now.
    pub fn phase(&self) -> f64 {
        self.phase
    }

    /// The rig.
    pub fn rig(&self) -> &Rig {
        &self.rig
    }

    /// The force.
    pub fn sine(&self) -> Sine {
        self.sine
    }

    /// Changes the frequency (Hz) from now on; phase, state and time go on without a step.
    ///
    /// # Errors
    /// If the frequency is impossible, or mass 1 is undamped and would be driven at resonance.
    pub fn set_frequency(&mut self, frequency: f64) -> Result<()> {
        let sine = Sine { frequency, ..self.sine };
        self.steady = Steady::new(&self.rig, &sine)?;
        self.sine = sine;
        Ok(())
    }

    /// Flies to the first impact, or to the time `until` if that comes before. Does not allocate.
    ///
    /// # Errors
    /// If `until` is not finite or in the past, or the masses come to rest against each other: sticking is not modelled here.
    pub fn fly(&mut self, until: f64) -> Result<Leg> {
        let remaining = until - self.time;
        if !(remaining.is_finite() && remaining >= 0.0) {
            return Err(Error::usage(
                format!("a flight until {until} s from {} s", self.time),
                "a finite time that is not in the past",
            ));
        }
        let flight = Flight::new(self.oscillators, &self.steady, self.rig.gap, &self.state, self.phase);
        let contact = flight.first_contact(remaining);
        let duration = contact.unwrap_or(remaining);
        let leg = Leg { start: self.time, duration, flight, impact: None };
        self.time = if contact.is_some() { self.time + duration } else { until };
        self.phase = (self.phase + self.steady.omega * duration).rem_euclid(TAU);
        self.state = flight.state(duration);
        let impact = contact.map(|_| self.collide()).transpose()?;
        Ok(Leg { impact, ..leg })
    }

    /// Exchanges momentum in the present state, which is at contact.
    fn collide(&mut self) -> Result<Impact> {
        let approach = self.state.approach();
        let impulse = self.exchange * approach;
        self.state.v1 -= impulse / self.rig.m1;
        self.state.v2 += impulse / self.rig.m2;
        if approach < REST_SPEED && self.pressing() >= 0.0 {
            return Err(Error::refused(format!(
                "at {} s the masses have chattered to rest against each other (impacts below {REST_SPEED} m/s): \
                 from there they move together, which this model does not follow",
                self.time
            ))
            .hint("raise the restitution or the force, or move the frequency"));
        }
        Ok(Impact { time: self.time, phase: self.phase, approach_velocity: approach, impulse })
    }

    /// Acceleration in m/s² with which free flight would press the masses together from the present state.
    fn pressing(&self) -> f64 {
        let flight = Flight::new(self.oscillators, &self.steady, self.rig.gap, &self.state, self.phase);
        let [_, a1, _, a2] = flight.rate(0.0);
        a1 - a2
    }

    /// Flies on until the time `until`, showing each leg.
    ///
    /// # Errors
    /// As [`Simulation::fly`].
    pub fn run(&mut self, until: f64, mut visit: impl FnMut(&Leg)) -> Result<()> {
        loop {
            let leg = self.fly(until)?;
            visit(&leg);
            if leg.impact.is_none() {
                return Ok(());
            }
        }
    }

    /// Flies on for `n` intervals of `interval` seconds and takes the state at the start of each.
    ///
    /// # Errors
    /// As [`Simulation::fly`].
    pub fn record(&mut self, interval: f64, n: usize) -> Result<Recorded> {
        let start = self.time;
        let mut recorded = Recorded { states: Vec::with_capacity(n), impacts: Vec::new() };
        self.run(start + n as f64 * interval, |leg| {
            let end = leg.start + leg.duration;
            while recorded.states.len() < n {
                let time = start + recorded.states.len() as f64 * interval;
                // A sample at the very end belongs to what follows: to the state after the impact.
                if time >= end {
                    break;
                }
                recorded.states.push(leg.flight.state((time - leg.start).max(0.0)));
            }
            recorded.impacts.extend(leg.impact);
        })?;
        Ok(recorded)
    }
}

impl Path for Flight {
    fn state(&self, t: f64) -> State {
        Flight::state(self, t)
    }
}

impl Motion for Simulation {
    fn time(&self) -> f64 {
        self.time
    }

    fn state(&self) -> State {
        self.state
    }

    fn phase(&self) -> f64 {
        self.phase
    }

    fn frequency(&self) -> f64 {
        self.sine.frequency
    }

    fn set_frequency(&mut self, hz: f64) -> Result<()> {
        Simulation::set_frequency(self, hz)
    }

    fn advance(&mut self, until: f64, visit: &mut dyn FnMut(Piece<'_>)) -> Result<()> {
        self.run(until, |leg| {
            let event = leg.impact.map_or(Event::Reached, Event::Impact);
            visit(Piece { start: leg.start, duration: leg.duration, path: &leg.flight, event });
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::orbits;
    use std::f64::consts::FRAC_PI_2;

    fn scene_b() -> Simulation {
        let rig = Rig::thesis();
        let frequency = 2.1 * (rig.k1 / rig.m1).sqrt() / TAU;
        Simulation::from_state(&rig, &Sine { force: 0.5, frequency }, State::REST, -FRAC_PI_2).unwrap()
    }

    #[test]
    fn a_start_from_rest_meets_its_golden_impacts() {
        // Number, time and approach speed by arithmetic with 40 digits (Newton on the same equations of motion), cut to 17.
        let golden = [
            (1_u16, 0.030_744_282_246_676_34, 0.078_330_829_224_466_23),
            (2, 0.144_162_776_471_947_4, 0.147_727_906_853_932_83),
            (3, 0.237_270_475_783_159_57, 0.233_773_950_612_516_77),
            (22, 1.970_065_574_977_416, 0.283_306_967_791_457_3),
            (1098, 99.932_500_537_538_15, 0.287_669_247_580_228_4),
        ];
        let mut motion = scene_b();
        let mut impacts = Vec::new();
        motion.run(100.0, |leg| impacts.extend(leg.impact)).unwrap();
        for (number, time, speed) in golden {
            let impact = impacts[usize::from(number) - 1];
            // Adding the flights' durations rounds the time by ε/2 of it at each impact; roundings of the gap (terms up to
            // 10 mm) over the speed are enlarged before they decay, by less than ten.
            let tolerance = f64::EPSILON * (1.0 + 0.5 * f64::from(number) * time);
            assert!((impact.time - time).abs() < tolerance, "{number}: {:.17} {time:.17}", impact.time);
            // Accelerations reach 20 m/s²; the speed does not suffer from the sum of times, but from the phase's.
            let error = impact.approach_velocity - speed;
            assert!(
                error.abs() < 20.0 * f64::EPSILON * (1.0 + 0.5 * f64::from(number)),
                "{number}: {:.17} {speed:.17}",
                impact.approach_velocity
            );
        }
    }

    #[test]
    fn it_settles_on_the_closed_form_orbit() {
        let mut motion = scene_b();
        // The slowest multiplier of this orbit is 0.9703: below 1e-16 after 1250 periods of 0.091 s.
        motion.run(150.0, |_| {}).unwrap();
        let mut last = None;
        motion.run(150.2, |leg| last = leg.impact.or(last)).unwrap();
        let orbit = orbits(motion.rig(), 0.5, motion.sine().frequency).unwrap().orbits[0];
        let impact = last.unwrap();
        // Rounding of a state near 10 mm, enlarged by 1/(1 − 0.97).
        let tolerance = 16.0 * f64::EPSILON / 0.03;
        assert!((impact.impulse / orbit.impulse - 1.0).abs() < 100.0 * tolerance, "{impact:?}");
        assert!((impact.phase - orbit.force_phase).abs() < 100.0 * tolerance, "{impact:?}");
    }

    #[test]
    fn energy_of_a_flight_balances() {
        // Work of the force less loss in the dampers is the change of energy, by quadrature of each leg.
        let rig = Rig { c1: 0.4, ..Rig::thesis() };
        let sine = Sine { force: 0.5, frequency: 9.0 };
        let mut motion = Simulation::new(&rig, &sine).unwrap();
        let energy = |s: State| {
            (rig.m1 * s.v1.powi(2) + rig.k1 * s.x1.powi(2) + rig.m2 * s.v2.powi(2) + rig.k2 * s.x2.powi(2))
                / 2.0
        };
        let (mut put_in, mut largest) = (0.0, 0.0_f64);
        let mut phase = motion.phase();
        for _ in 0..100 {
            let leg = motion.fly(1e3).unwrap();
            // Composite Gauss-Legendre with three points on 512 panels of 0.4 ms: sixth order, error below
            // (0.4e-3 · 114/s)⁶/2e6 = 5e-15 of the energy.
            let panel = leg.duration / 512.0;
            let power = |t: f64| {
                let s = leg.flight.state(t);
                sine.force * (sine.omega() * t + phase).cos() * s.v1
                    - rig.c1 * s.v1.powi(2)
                    - rig.c2 * s.v2.powi(2)
            };
            let node = 0.6_f64.sqrt() / 2.0;
            put_in += (0..512)
                .map(|i| {
                    let middle = (f64::from(i) + 0.5) * panel;
                    panel / 18.0
                        * (5.0 * power(middle - node * panel)
                            + 8.0 * power(middle)
                            + 5.0 * power(middle + node * panel))
                })
                .sum::<f64>();
            let impact = leg.impact.unwrap();
            put_in -=
                rig.reduced_mass() * (1.0 - rig.restitution.powi(2)) * impact.approach_velocity.powi(2) / 2.0;
            phase = motion.phase();
            largest = largest.max(energy(motion.state()));
        }
        // 51200 panels, each rounded to a few ε of the energy that passes through.
        assert!((put_in - energy(motion.state())).abs() < 51_200.0 * 4.0 * f64::EPSILON * largest);
    }

    #[test]
    fn samples_do_not_depend_on_how_the_motion_is_cut() {
        let (mut whole, mut cut) = (scene_b(), scene_b());
        let recorded = whole.record(1e-3, 3000).unwrap();
        let mut pieces = Recorded::default();
        for n in [1, 7, 992, 2000] {
            let piece = cut.record(1e-3, n).unwrap();
            pieces.states.extend(piece.states);
            pieces.impacts.extend(piece.impacts);
        }
        assert_eq!(recorded.states.len(), 3000);
        assert_eq!(recorded.impacts.len(), pieces.impacts.len());
        for (a, b) in recorded.states.iter().zip(&pieces.states) {
            // Four more re-anchorings, each a few roundings of 10 mm and 0.5 m/s.
            assert!((a.x1 - b.x1).abs() < 1e-14 && (a.v2 - b.v2).abs() < 1e-12, "{a:?} {b:?}");
        }
    }

    #[test]
    fn a_change_of_frequency_makes_no_step() {
        let mut motion = scene_b();
        motion.run(0.7, |_| {}).unwrap();
        let (state, phase, time) = (motion.state(), motion.phase(), motion.time());
        motion.set_frequency(6.0).unwrap();
        assert_eq!((motion.state(), motion.phase(), motion.time()), (state, phase, time));
        assert!(motion.set_frequency(-1.0).is_err());
        assert_eq!(motion.sine().frequency, 6.0);
        let leg = motion.fly(0.7).unwrap();
        assert_eq!(leg.duration, 0.0);
    }

    #[test]
    fn sticking_is_refused_with_its_time() {
        // Pressed together at rest: gap −0.5 mm, x₁ − x₂ = −2 mm at the start. Independent number: impacts accumulate
        // at T∞ = 0.15272108935336045 s.
        let rig = Rig { gap: -5e-4, ..Rig::thesis() };
        let frequency = 0.45 * (rig.k1 / rig.m1).sqrt() / TAU;
        let start = State { x1: -2e-3, ..State::REST };
        let mut motion =
            Simulation::from_state(&rig, &Sine { force: 0.35, frequency }, start, -FRAC_PI_2).unwrap();
        let mut count = 0;
        let text = motion.run(1.0, |_| count += 1).unwrap_err().to_string();
        assert!(text.contains("chattered to rest"), "{text}");
        // Speeds fall to R = 0.7 of the one before, from about 0.05 m/s to 1e-9: some 50 impacts.
        assert!((40..60).contains(&count), "{count}");
        // What was left out lasts 2w/(a(1 − R)) with w below 1e-9 m/s and a of the order of 1 m/s².
        assert!((motion.time() - 0.152_721_089_353_360_45).abs() < 1e-8, "{}", motion.time());
    }

    #[test]
    fn impossible_starts_and_times_are_refused() {
        let rig = Rig::thesis();
        let sine = Sine { force: 0.5, frequency: 5.0 };
        let overlapping = State { x1: 2e-3, ..State::REST };
        assert!(Simulation::from_state(&rig, &sine, overlapping, 0.0).is_err());
        assert!(Simulation::from_state(&rig, &sine, State::REST, f64::NAN).is_err());
        assert!(Simulation::new(&Rig { gap: -1e-3, ..rig }, &sine).is_err());
        assert!(Simulation::new(&Rig { restitution: 2.0, ..rig }, &sine).is_err());
        let mut motion = Simulation::new(&rig, &sine).unwrap();
        assert!(motion.fly(f64::NAN).is_err() && motion.fly(-1.0).is_err());
    }
}

//! Search for motions with p impacts in q cycles, stable or not, from close returns of simulations.

use super::PeriodicOrbit;
use crate::excitation::{Excitation, Sine};
use crate::impact::Impact;
use crate::ladder::starts;
use crate::motion::{Event, Motion};
use crate::orbit::check_not_zero;
use crate::rig::Rig;
use crate::simulate::Simulation;
use std::f64::consts::TAU;
use vibro_record::{Error, Result, sort_by_number};

/// Cycles simulated from each start state.
const CYCLES: f64 = 200.0;
/// Most close returns of each start from which Newton's method is tried.
const TRIES: usize = 60;
/// Largest number of impacts and of cycles in a period.
pub const MOST: u32 = 32;
/// Motions are the same if phases (rad) and impulses (relative) differ by less than this.
const SAME: f64 = 1e-6;

/// Motions with `impacts` impacts in `cycles` cycles, the largest impulse first; those with a shorter period
/// are left out.
///
/// Simulations from rest and from other states are searched for p successive impacts that take nearly q
/// cycles (close returns; D. Auerbach et al. 1987); Newton's method starts from them. The search also finds
/// unstable motions, but does not prove that it has found all.
///
/// # Errors
/// If a parameter is impossible, nothing drives the rig, or the number of impacts or of cycles is 0 or above
/// 32.
pub fn search(rig: &Rig, sine: &Sine, impacts: u32, cycles: u32) -> Result<Vec<PeriodicOrbit>> {
    for (key, count) in [("impacts", impacts), ("cycles", cycles)] {
        if !(1..=MOST).contains(&count) {
            let hint = if count == 0 { 1 } else { MOST };
            let error = Error::usage(format!("{count} {key} in a period"), format!("1 to {MOST}"));
            return Err(error.hint(hint.to_string()).setting(key));
        }
    }
    check_not_zero(sine.force)?;
    let excitation = Excitation::Sine(*sine);
    let rest = (Simulation::at_rest(rig), 0.0);
    let mut found: Vec<PeriodicOrbit> = Vec::new();
    for (state, phase) in std::iter::once(rest).chain(starts(rig, &excitation)) {
        let mut motion = Simulation::from_state(rig, &excitation, state, phase)?;
        let mut all: Vec<Impact> = Vec::new();
        let passed = motion.advance(CYCLES / sine.frequency, &mut |piece| {
            if let Event::Impact(impact) = piece.event {
                all.push(impact);
            }
        });
        if let Err(error) = passed
            && all.is_empty()
        {
            return Err(error);
        }
        let p = impacts as usize;
        let late = |w: &[Impact]| ((w[p].time - w[0].time) * sine.frequency - f64::from(cycles)).abs();
        let mut near: Vec<&[Impact]> = all.windows(p + 1).filter(|w| late(w) < 0.25).collect();
        sort_by_number(&mut near, |w| late(w));
        // The closest returns, and others evenly from the rest.
        let step = (near.len() / (TRIES / 2)).max(1);
        let others = near.iter().skip(TRIES / 2).step_by(step).take(TRIES / 2);
        for window in near.iter().take(TRIES / 2).chain(others) {
            let guess: Vec<_> = window[..p]
                .iter()
                .map(|i| (window[0].phase + TAU * sine.frequency * (i.time - window[0].time), i.impulse))
                .collect();
            let new = PeriodicOrbit::near(rig, sine, cycles, &guess).ok();
            let new = new.filter(|o| o.validity.exists && o.is_shortest());
            if let Some(new) = new.filter(|o| !found.iter().any(|other| o.is(other))) {
                found.push(new);
            }
        }
    }
    let largest = |o: &PeriodicOrbit| o.beats.iter().map(|b| b.impulse).fold(0.0, f64::max);
    sort_by_number(&mut found, |a| -largest(a));
    Ok(found)
}

impl PeriodicOrbit {
    /// Whether it is the same motion as another under the same force, with any impact as the first.
    pub fn is(&self, other: &PeriodicOrbit) -> bool {
        let p = self.beats.len();
        let near = |a: f64, b: f64| (a - b + 0.5 * TAU).rem_euclid(TAU) - 0.5 * TAU;
        self.cycles == other.cycles
            && other.beats.len() == p
            && (0..p).any(|turn| {
                (0..p).all(|i| {
                    let (a, b) = (self.beats[i], other.beats[(i + turn) % p]);
                    near(a.phase, b.phase).abs() < SAME
                        && (a.impulse - b.impulse).abs() < SAME * a.impulse.abs()
                        && (a.interval - b.interval).abs() * self.sine.omega() < SAME
                })
            })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::orbit::orbits;

    #[test]
    fn one_impact_in_one_or_more_cycles_is_the_closed_form() {
        let rig = Rig::thesis();
        for (force, frequency, cycles) in [(0.5, 11.0, 1), (0.1, 5.5, 1), (0.5, 13.0, 1), (0.3, 16.0, 2)] {
            let sine = Sine { force, frequency };
            let found = search(&rig, &sine, 1, cycles).unwrap();
            let closed = crate::orbits_of(&rig, &Excitation::Sine(sine), cycles).unwrap().orbits;
            for orbit in &found {
                let near = |o: &crate::Orbit| (o.impulse / orbit.beats[0].impulse - 1.0).abs() < 1e-9;
                assert!(closed.iter().any(near), "{orbit:?}");
            }
            // Real orbits are attractors, and are found from some start.
            let real = closed.iter().filter(|o| o.validity.real()).count();
            assert!(
                found.iter().filter(|o| o.validity.real()).count() == real,
                "{force} {frequency} {cycles}"
            );
        }
    }

    /// The bound on the rounding of five factors was the product of their norms, and hid a multiplier of
    /// 1.06.
    #[test]
    fn an_unstable_motion_of_many_impacts_is_not_neutral() {
        let (gap, restitution) = (0.001_248_322_147_651_006_7, 0.55);
        let rig = Rig { m1: 0.35, m2: 0.9, k1: 12_000.0, k2: 30_000.0, c1: 4.0, c2: 12.0, gap, restitution };
        let sine = Sine { force: 12.0, frequency: 15.678_391_959_798_995 };
        let found = search(&rig, &sine, 5, 5).unwrap();
        let growing = found.iter().filter(|orbit| orbit.spectral_radius().is_some_and(|r| r > 1.01));
        let stable: Vec<Option<bool>> = growing.map(|orbit| orbit.validity.stable).collect();
        assert!(!stable.is_empty() && stable.iter().all(|stable| *stable == Some(false)), "{stable:?}");
    }

    #[test]
    fn behind_a_flip_there_are_two_impacts_in_two_cycles() {
        // Reference value: F₀ 0.9 N, R 1, ν 1.2 has the multiplier −1.326: one impact a cycle is unstable
        // there.
        let rig = Rig { restitution: 0.9, ..Rig::thesis() };
        let unit = rig.natural_frequencies()[0];
        let mut seen = 0;
        for nu in [1.15, 1.2, 1.25] {
            let sine = Sine { force: 0.9, frequency: nu * unit };
            let one = &orbits(&rig, sine.force, sine.frequency).unwrap().orbits;
            let found = search(&rig, &sine, 2, 2).unwrap();
            for orbit in &found {
                assert_eq!((orbit.impacts(), orbit.cycles), (2, 2));
                // It is not one impact a cycle, counted twice.
                assert!(one.iter().all(|o| (o.impulse - orbit.beats[0].impulse).abs() > 1e-6 * o.impulse));
                // A simulation from just after the first impact has only the second one within the period.
                let start = orbit.state(0.0);
                let mut motion = Simulation::from_state(&rig, &sine, start, orbit.beats[0].phase).unwrap();
                let mut impacts = 0;
                let end = orbit.period() * (1.0 - 1e-9);
                motion
                    .advance(end, &mut |p| impacts += u32::from(matches!(p.event, Event::Impact(_))))
                    .unwrap();
                if orbit.validity.admissible {
                    assert_eq!(impacts, 1, "{orbit:?}");
                    seen += 1;
                }
            }
            for (i, a) in found.iter().enumerate() {
                assert!(found[..i].iter().all(|b| !a.is(b)));
            }
        }
        assert!(seen > 0);
        let sine = Sine { force: 0.9, frequency: 6.0 };
        assert!(search(&rig, &sine, 0, 1).is_err() && search(&rig, &sine, 1, 33).is_err());
    }
}

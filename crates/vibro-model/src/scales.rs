//! Limits of rigs and excitations for computation in double precision.
//!
//! Phases have the relative rounding ε = 2.2e-16. After n swings of a mass the error of its phase is 2πnε;
//! half of all digits, √ε, are left for n ≤ 1/(2π√ε) = 1.07e7. A flight is searched for contacts at each
//! swing, so this also bounds the work of a cycle.

use super::excitation::Excitation;
use super::parameter::Parameter;
use super::rig::Rig;
use std::f64::consts::TAU;
use vibro_record::units::notation::significant;
use vibro_record::{Error, Result};

/// Largest value in SI units, and reciprocal of the smallest other than 0: no formula here multiplies more
/// than six values of a rig, its excitation or its motion, so products stay within 10^±308.
const LARGEST: f64 = 1e50;
/// Most swings, or decays by e, of a mass in an excitation cycle: about half of the digits of its phase are
/// left.
const MOST_SWINGS: f64 = 1e7;
/// Most impacts and other events in a cycle, or in a swing where that is shorter. A chatter with R = 0.996
/// takes 36/(1 − R) = 9000 impacts until its speeds fall to ε of the first. A million events take a second.
pub(super) const MOST_EVENTS: f64 = 1e4;
/// Fewest swings in which a motion can settle: with a damping ratio of 1 %, transients fall to e⁻¹.
const SWINGS: f64 = 16.0;
/// Most swings of a mass over which the closed forms of a curve are searched: about ten seconds, with the
/// search for the frequencies of its changes.
const MOST_SEARCHED: f64 = 3e5;
/// Swings in a period whose search takes no longer than the rest of a closed form.
const FEW_SWINGS: f64 = 100.0;

/// Checks that a rig and its excitation are possible, and that their motion can be computed in double
/// precision.
///
/// # Errors
/// If a value is impossible, or outside 1e-50 to 1e50 in SI units and not 0; if a mass swings, or its damper
/// slows it, more than ten million times in a cycle.
pub(super) fn check(rig: &Rig, excitation: &Excitation) -> Result<()> {
    excitation.check()?;
    check_values(rig, [excitation.size(), excitation.frequency()])?;
    check_swings(rig, excitation.frequency(), MOST_SWINGS)
}

/// Checks that the values of a rig, and the values `beside`, are possible, and are 0 or within 1e-50 to 1e50
/// in SI units.
///
/// # Errors
/// If one is not.
pub(super) fn check_values<const N: usize>(rig: &Rig, beside: [f64; N]) -> Result<()> {
    rig.check()?;
    let own = Parameter::of_rig().filter(|p| *p != Parameter::Restitution).filter_map(|p| p.counting(rig));
    check_sizes(own.chain(beside))
}

/// Checks that values are 0 or within 1e-50 to 1e50 in SI units.
///
/// # Errors
/// If one is not.
pub(super) fn check_sizes(mut values: impl Iterator<Item = f64>) -> Result<()> {
    let in_range = |value: f64| value == 0.0 || (LARGEST.recip()..=LARGEST).contains(&value.abs());
    if let Some(value) = values.find(|value| !in_range(*value)) {
        return Err(Error::refused(format!(
            "a value of {value:e}: products of such values leave the range of numbers"
        ))
        .hint("give 0, or a size between 1e-50 and 1e50 in SI units"));
    }
    Ok(())
}

/// Checks that a motion can settle within `most` cycles of `frequency` (Hz): the faster mass makes at least
/// [`SWINGS`] swings in them.
///
/// # Errors
/// If it does not.
pub(super) fn check_slow(rig: &Rig, frequency: f64, most: f64) -> Result<()> {
    let natural = rig.natural_frequencies().into_iter().filter(|f| f.is_finite()).fold(0.0, f64::max);
    let highest = natural * most / SWINGS;
    if frequency <= highest {
        return Ok(());
    }
    let (f, natural) = (significant(frequency, 3), significant(natural, 3));
    let found = format!(
        "{f} Hz is too far above the natural frequency of {natural} Hz: {most} cycles hold no {SWINGS} swings"
    );
    Err(Error::refused(found).hint(format!("give a frequency up to {} Hz", significant(highest, 2))))
}

/// Checks that the closed forms of `points` points can be computed in reasonable time: each is searched for
/// contacts at every swing of a mass, a million a second.
///
/// # Errors
/// If they cannot.
pub(super) fn check_points(rig: &Rig, frequency: f64, cycles: u32, points: usize) -> Result<()> {
    let natural = rig.natural_frequencies().into_iter().filter(|f| f.is_finite()).fold(0.0, f64::max);
    let each = f64::from(cycles) * natural / frequency;
    let swings = points as f64 * each;
    if each <= FEW_SWINGS || swings <= MOST_SEARCHED {
        return Ok(());
    }
    let (all, at, natural) = (significant(swings, 2), significant(frequency, 3), significant(natural, 3));
    let found = format!(
        "{all} swings of a mass of {natural} Hz over cycles of {at} Hz: more than {MOST_SEARCHED} are not searched"
    );
    Err(Error::refused(found).hint("ask for fewer points; a fixed mass 2 is m2=inf").setting("points"))
}

/// Checks that no mass swings, or is slowed by its damper by e, more than `most` times in a cycle of
/// `frequency` (Hz).
///
/// # Errors
/// If one does.
pub(super) fn check_swings(rig: &Rig, frequency: f64, most: f64) -> Result<()> {
    let swings = rig.oscillators().map(|o| o.omega2().sqrt().max(o.decay()) / (TAU * frequency));
    for (mass, swings) in ["mass 1", "mass 2"].into_iter().zip(swings) {
        if swings > most {
            return Err(Error::refused(format!(
                "{mass} swings or slows {} times in a cycle of {} Hz: more than {most:.0e} are not followed",
                significant(swings, 3),
                significant(frequency, 3)
            ))
            .hint("give a higher frequency, a larger mass or a smaller stiffness; a fixed mass 2 has an infinite m2"));
        }
    }
    Ok(())
}

/// Checks that a motion can go on from `now` to `until` (s).
///
/// # Errors
/// If `until` is not finite, or in the past.
pub(super) fn check_time(now: f64, until: f64) -> Result<()> {
    if until.is_finite() && until >= now {
        return Ok(());
    }
    let found = format!("a motion until {until} s from {now} s");
    Err(Error::usage(found, "a finite time that is not in the past"))
}

/// Checks that `cycles` of the excitation can be computed in reasonable time: 1e8 cycles take about a minute.
///
/// # Errors
/// If it cannot.
pub(super) fn check_work(cycles: f64) -> Result<()> {
    if cycles <= 1e8 {
        return Ok(());
    }
    Err(Error::refused(format!(
        "{cycles:.3e} cycles of the excitation: more than 1e8 are not computed at a time"
    ))
    .hint("ask for less time, fewer points or cells, or fewer cycles of each"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::excitation::{Impulses, Sine};
    use crate::ladder;
    use crate::map;
    use crate::observable::Observable;
    use crate::orbit::orbits_of;
    use crate::response;
    use crate::scene::Scene;
    use crate::simulate::Simulation;

    const SINE: Sine = Sine { force: 0.5, frequency: 11.0 };

    #[test]
    fn what_numbers_cannot_hold_is_refused_at_once() {
        let t = Rig::thesis();
        for (rig, name) in [
            (Rig { gap: 1e-300, ..t }, "a value of 1e-300"),
            (Rig { gap: -1e60, ..t }, "a value of -1e60"),
            (Rig { m2: 1e-30, ..t }, "mass 2 swings"),
            (Rig { k2: 1e30, restitution: 1e-30, ..t }, "mass 2 swings"),
            (Rig { c1: 1e30, ..t }, "mass 1 swings or slows"),
        ] {
            let said = Simulation::new(&rig, &SINE).unwrap_err().to_string();
            assert!(said.starts_with(name), "{said}");
            assert!(orbits_of(&rig, &SINE.into(), 1).is_err(), "{name}");
        }
        let blow = Excitation::Impulse(Impulses { impulse: 1e150, frequency: 1.0 });
        let said = response(&t, &blow, 5.0, 15.0, 50, 1).unwrap_err().to_string();
        assert!(said.starts_with("a value of 1e150"), "{said}");
    }

    #[test]
    fn what_numbers_can_hold_is_computed() {
        let t = Rig::thesis();
        // A stiff mass 2, a wall whose other values do not count, a small gap, no damping, a strong force.
        let wall = Rig { m2: f64::INFINITY, k2: 0.0, c2: f64::NAN, ..t };
        for rig in [Rig { k2: 1e12, ..t }, wall, Rig { gap: 1e-40, ..t }, Rig { c1: 0.0, c2: 0.0, ..t }] {
            let mut motion = Simulation::new(&rig, &SINE).unwrap();
            motion.run(1.0, |_| {}).unwrap();
        }
    }

    #[test]
    fn a_chatter_of_any_size_comes_to_its_end() {
        // Displacements, speeds and forces scale together: 2e12 times the force across 2e12 times the gap
        // gives the same motion.
        let pattern = |scale: f64| {
            let rig = Rig { gap: 5e-16 * scale, restitution: 0.1, ..Rig::thesis() };
            let sine = Sine { force: 0.5 * scale, frequency: 6.11 };
            let mut motion = Simulation::new(&rig, &sine).unwrap();
            crate::regime(&mut motion, 100, 60).unwrap().regime
        };
        assert_eq!(pattern(2e12), pattern(1.0));
        let plan = map::Plan {
            rig: Rig::thesis(),
            excitation: Excitation::Sine(Sine { force: 9.2e18, frequency: 11.0 }),
            x: "frequency:5:15:4".parse().unwrap(),
            y: "restitution:0.1:0.9:3".parse().unwrap(),
            cycles: 200,
        };
        plan.check().unwrap();
        assert!((0..plan.cells()).all(|number| plan.cell(number).regime.is_some()));
    }

    #[test]
    fn what_would_take_minutes_is_refused_by_the_scales_of_the_rig() {
        let t = Rig::thesis();
        let said = |rig: Rig| response(&rig, &SINE.into(), 5.0, 15.0, 400, 1).unwrap_err().to_string();
        assert!(said(Rig { gap: 1e-300, ..t }).starts_with("a value of 1e-300"));
        // √(1e12/0.094)/2π = 519 kHz: 400 points × 104 000 swings in a cycle of 5 Hz.
        let many = said(Rig { k2: 1e12, ..t });
        assert!(many.starts_with("4.2×10⁷ swings of a mass of 519000 Hz"), "{many}");
        let question = ladder::Question::new(Observable::Fundamental);
        let scene = Scene { excitation: Some(SINE.into()), ..Scene::thesis() };
        // 192 000 cycles hold 16 swings of mass 2, of 5.873 Hz, up to 70.5 kHz.
        assert!(ladder::choose(&scene, 7e4, &question).is_ok());
        for frequency in [7.1e4, 4_294_967_296.0] {
            let fast = ladder::choose(&scene, frequency, &question).unwrap_err().to_string();
            assert!(fast.contains("too far above the natural frequency of 5.87 Hz"), "{fast}");
            assert!(fast.contains("up to 70000 Hz"), "{fast}");
        }
    }

    #[test]
    fn bounces_without_loss_end_at_any_force() {
        // Displacements, speeds and forces scale together: 2e20 times the force is the same motion as a gap
        // 2e20 times smaller.
        let rig = Rig { restitution: 1.0, c1: 0.0, c2: 0.0, ..Rig::thesis() };
        let flights = |gap: f64, force: f64| {
            let mut motion = Simulation::new(&Rig { gap, ..rig }, &Sine { force, frequency: 11.0 }).unwrap();
            motion.run(20.0 / 11.0, |_| {}).unwrap();
            motion.counts().flights
        };
        assert_eq!(flights(1e-3, 1e20), flights(5e-24, 0.5));
        // At forces between these there may be more bounces (50 000 a cycle) than the 10 000 that are
        // followed.
        let mut motion = Simulation::new(&rig, &Sine { force: 1e13, frequency: 11.0 }).unwrap();
        let said = motion.run(20.0 / 11.0, |_| {}).unwrap_err().to_string();
        assert!(said.starts_with("more than 200000 impacts"), "{said}");
    }

    #[test]
    fn masses_pressed_together_need_no_stiffness() {
        let rig = Rig { gap: -1e-3, ..Rig::thesis() };
        let question = ladder::Question::new(Observable::Fundamental);
        let scene = |force| Scene {
            rig,
            excitation: Some(Excitation::Sine(Sine { force, frequency: 11.0 })),
            ..Scene::thesis()
        };
        let said = ladder::choose(&scene(0.0), 11.0, &question).unwrap_err().to_string();
        assert!(said.starts_with("nothing drives"), "{said}");
        let choice = ladder::choose(&scene(0.01), 11.0, &question).unwrap();
        assert_eq!(choice.chosen, Some(ladder::Model::Restitution));
        // Together they are one oscillator: F/|k₁ + k₂ − (m₁ + m₂)ω² + i(c₁ + c₂)ω|.
        let omega = TAU * 11.0;
        let stiffness = rig.k1 + rig.k2 - (rig.m1 + rig.m2) * omega * omega;
        let expected = 0.01 / stiffness.hypot((rig.c1 + rig.c2) * omega);
        assert!((choice.answer().unwrap()[0] / expected - 1.0).abs() < 4e-4);
    }
}

//! Resonances and jumps of a simulated sweep, named by the phase between the masses.

use crate::model::Rig;
use crate::model::sweep::{Point, Swept, above_floor, in_phase};
use serde::Serialize;
use vibro_measure::jump::Jump;
use vibro_measure::resonance::{NamedCurve, Resonance, ResonanceKind, name_modes_by_phase, share_jumps};
use vibro_record::Direction;

/// A resonance or jump on the curve of one mass.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Named<T> {
    /// 1 excited, 2 passive.
    pub mass: u8,
    /// Direction of the sweep.
    pub direction: Direction,
    /// The resonance or jump.
    #[serde(flatten)]
    pub found: T,
}

/// Resonances and jumps of a simulated frequency sweep, of both masses and directions.
///
/// The scatter from cycle to cycle counts as the uncertainty of a point: otherwise irregular ranges would
/// be full of peaks. Irregular motion, a transient of the start and a mass at rest have no resonance.
pub fn named(swept: &Swept, rig: &Rig) -> (Vec<Named<Resonance>>, Vec<Named<Jump>>) {
    let sides = [(&swept.up, Direction::Up), (&swept.down, Direction::Down)];
    let mut curves: Vec<NamedCurve> = sides
        .into_iter()
        .filter(|(points, _)| points.len() > 2)
        .flat_map(|(points, direction)| [1, 2].map(|mass| curve(points, mass, direction)))
        .collect();
    share_jumps(&mut curves);
    let side = |direction| if direction == Direction::Up { &swept.up } else { &swept.down };
    let floor = swept.floor();
    for NamedCurve { direction, resonances, jumps, .. } in &mut curves {
        let points = side(*direction);
        resonances.retain(|r| r.amplitude > floor && is_settled(points, r.frequency, floor, rig));
        jumps.retain(|j| j.amplitude_before.max(j.amplitude_after) > floor);
        for jump in jumps {
            jump.amplitude_before = above_floor(jump.amplitude_before, floor);
            jump.amplitude_after = above_floor(jump.amplitude_after, floor);
        }
    }
    name_modes_by_phase(&mut curves, |direction, frequency| {
        let points = side(direction);
        points[nearest(points, frequency)].relative_phase.map(in_phase)
    });
    let mut all = (Vec::new(), Vec::new());
    for NamedCurve { mass, direction, resonances, jumps, .. } in curves {
        let mass = mass.unwrap_or_default();
        let tops = resonances.into_iter().filter(|r| r.kind != ResonanceKind::Minimum);
        all.0.extend(tops.map(|found| Named { mass, direction, found }));
        all.1.extend(jumps.into_iter().map(|found| Named { mass, direction, found }));
    }
    all
}

/// Index of the point nearest to a frequency in Hz.
fn nearest(points: &[Point], frequency: f64) -> usize {
    let off = |i: &usize| (points[*i].frequency - frequency).abs();
    (0..points.len()).min_by(|a, b| off(a).total_cmp(&off(b))).unwrap_or(0)
}

/// Number of time constants after which a transient of the start counts as decayed: to 1/e³, 5 %.
const DECAYS: f64 = 3.0;
/// Largest share of a sweep's duration that a transient of the start may take: without damping it never
/// decays.
const LONGEST_START: f64 = 0.05;

/// Whether the motion at a frequency (Hz) is periodic, and no transient of the start. Points after a jump
/// may be
/// unsettled: the point itself must be regular, and most of the five around it.
fn is_settled(points: &[Point], frequency: f64, floor: f64, rig: &Rig) -> bool {
    let at = nearest(points, frequency);
    let around = &points[at.saturating_sub(2)..(at + 3).min(points.len())];
    let regular = around.iter().filter(|p| p.is_regular(floor)).count();
    let decay = (rig.c1 / rig.m1).min(rig.c2 / rig.m2) / 2.0;
    let all = points.last().map_or(0.0, |p| p.time);
    let start = (DECAYS / decay).min(LONGEST_START * all);
    points[at].is_regular(floor) && 2 * regular > around.len() && points[at].time > start
}

/// The curve of one mass in one direction.
fn curve(points: &[Point], mass: u8, direction: Direction) -> NamedCurve {
    let read = |p: &Point| match mass {
        1 => (p.frequency, p.x1, p.x1_scatter),
        _ => (p.frequency, p.x2, p.x2_scatter),
    };
    NamedCurve::new(points.iter().map(read).collect(), &[], direction, Some(mass))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::sweep::{Observable, Pace, Plan, apart};
    use crate::model::{Rig, Simulation, Sine};

    /// The upward sweep of the thesis has a peak of each kind: 5.58 Hz where the masses begin to meet,
    /// 10.59 Hz where they clap.
    #[test]
    fn the_peaks_of_the_thesis_are_named() {
        let pace = Pace::Rate { rate: 0.02, points: 2200 };
        let plan = Plan { from: 3.0, to: 14.0, pace, observable: Observable::Rms };
        let motion = Simulation::new(&Rig::thesis(), &Sine { force: 0.1, frequency: 3.0 }).unwrap();
        let swept = apart(&[Direction::Up], |up| plan.frequency(&mut motion.clone(), 0.1, up)).unwrap();
        let (resonances, _) = named(&swept, &Rig::thesis());
        let named = |kind, range: std::ops::Range<f64>| {
            resonances
                .iter()
                .any(|r| r.mass == 1 && r.found.kind == kind && range.contains(&r.found.frequency))
        };
        assert!(named(ResonanceKind::Grazing, 5.48..5.68), "{resonances:?}");
        // Further up the masses clap, on whichever branch the sweep reaches.
        assert!(named(ResonanceKind::Clapping, 8.0..11.2), "{resonances:?}");
    }
}

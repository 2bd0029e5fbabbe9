//! Resonances and jumps of a simulated sweep, named by the rules for a measured one.

use crate::model::sweep::{Point, Swept};
use serde::Serialize;
use vibro_measure::jump::Jump;
use vibro_measure::resonance::{NamedCurve, Resonance, ResonanceKind, name_modes};
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
/// be full of peaks.
pub fn named(swept: &Swept) -> (Vec<Named<Resonance>>, Vec<Named<Jump>>) {
    let sides = [(&swept.up, Direction::Up), (&swept.down, Direction::Down)];
    let mut curves: Vec<NamedCurve> = sides
        .into_iter()
        .filter(|(points, _)| points.len() > 2)
        .flat_map(|(points, direction)| [1, 2].map(|mass| curve(points, mass, direction)))
        .collect();
    name_modes(&mut curves);
    let mut all = (Vec::new(), Vec::new());
    for NamedCurve { mass, direction, resonances, jumps, .. } in curves {
        let mass = mass.unwrap_or_default();
        let tops = resonances.into_iter().filter(|r| r.kind != ResonanceKind::Minimum);
        all.0.extend(tops.map(|found| Named { mass, direction, found }));
        all.1.extend(jumps.into_iter().map(|found| Named { mass, direction, found }));
    }
    all
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
        let (resonances, _) = named(&swept);
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

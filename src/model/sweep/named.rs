//! Resonances and jumps of a sweep, by the rules that name those of a measured one.

use super::{Point, Swept};
use crate::measure::jump::{Jump, jumps};
use crate::measure::resonance::{NamedCurve, Resonance, name_modes, resonances};
use crate::record::Direction;
use serde::Serialize;

/// Something found on the curve of one mass.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Named<T> {
    /// 1 excited, 2 passive.
    pub mass: u8,
    /// Direction of the sweep.
    pub direction: Direction,
    /// What was found.
    #[serde(flatten)]
    pub found: T,
}

/// Resonances and jumps of a sweep of the frequency, both masses and directions together.
///
/// The scatter from cycle to cycle counts as the uncertainty of a point, so that irregular stretches are not full of peaks.
pub fn named(swept: &Swept) -> (Vec<Named<Resonance>>, Vec<Named<Jump>>) {
    let sides = [(&swept.up, Direction::Up), (&swept.down, Direction::Down)];
    let mut curves: Vec<Found> = sides
        .into_iter()
        .filter(|(points, _)| points.len() > 2)
        .flat_map(|(points, direction)| [1, 2].map(|mass| Found::on(points, mass, direction)))
        .collect();
    let mut named: Vec<NamedCurve<'_>> = curves
        .iter_mut()
        .map(|c| NamedCurve {
            mass: c.mass,
            direction: c.direction,
            curve: c.curve.clone(),
            jumps: &mut c.jumps,
            resonances: &mut c.resonances,
        })
        .collect();
    name_modes(&mut named);
    let mut all = (Vec::new(), Vec::new());
    for Found { mass, direction, resonances, jumps, .. } in curves {
        let tops = resonances.into_iter().filter(|r| r.kind != "minimum");
        all.0.extend(tops.map(|found| Named { mass, direction, found }));
        all.1.extend(jumps.into_iter().map(|found| Named { mass, direction, found }));
    }
    all
}

/// One mass in one direction.
struct Found {
    mass: u8,
    direction: Direction,
    curve: Vec<(f64, f64, f64)>,
    jumps: Vec<Jump>,
    resonances: Vec<Resonance>,
}

impl Found {
    fn on(points: &[Point], mass: u8, direction: Direction) -> Found {
        let read = |p: &Point| match mass {
            1 => (p.frequency, p.x1, p.x1_scatter),
            _ => (p.frequency, p.x2, p.x2_scatter),
        };
        let mut curve: Vec<_> = points.iter().map(read).collect();
        let column = |curve: &[(f64, f64, f64)], of: fn(&(f64, f64, f64)) -> f64| -> Vec<f64> {
            curve.iter().map(of).collect()
        };
        let [f, a, s]: [fn(&(f64, f64, f64)) -> f64; 3] = [|p| p.0, |p| p.1, |p| p.2];
        let jumps = jumps(&column(&curve, f), &column(&curve, a), &column(&curve, s), direction);
        curve.sort_by(|a, b| a.0.total_cmp(&b.0));
        let resonances =
            resonances(&column(&curve, f), &column(&curve, a), &column(&curve, s), &jumps, Some(mass));
        Found { mass, direction, curve, jumps, resonances }
    }
}

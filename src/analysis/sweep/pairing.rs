//! Sweeps that belong together: both masses, both directions, one level of force.

use crate::compare::{Forcing, levels};
use crate::measure::crossing::crossings;
use crate::measure::resonance::{NamedCurve, deepest, name_modes};
use crate::measure::response::Response;
use crate::record::{Direction, Finding, sort_by_number};
use crate::report::words::About;
use serde::Serialize;
use std::mem::take;

/// A crossing of the curves of both masses.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Crossing {
    /// Direction of the two sweeps.
    pub direction: Direction,
    /// Median force of the sweep of mass 1 in N, where the campaign has several levels of force.
    pub force: Option<f64>,
    /// Frequency in Hz.
    pub frequency: f64,
    /// Its standard uncertainty in Hz.
    pub frequency_std: Option<f64>,
    /// The mass that moves more above it.
    pub larger_above: u8,
}

/// Median force amplitude of a sweep in N.
fn median_force(response: &Response) -> Option<f64> {
    Forcing::measured(response).map(|f| f.median())
}

/// Excitation frequency, amplitude and its standard uncertainty.
fn curve(response: &Response) -> Vec<(f64, f64, f64)> {
    let points = response.points.iter();
    points.map(|p| (p.excitation, p.amplitude.value, p.amplitude.std.unwrap_or(f64::NAN))).collect()
}

/// Indices of the sweeps at each level of force.
fn by_level<'a>(responses: impl Iterator<Item = &'a Response>) -> Vec<Vec<usize>> {
    levels(&responses.map(median_force).collect::<Vec<_>>())
}

/// Names the resonances of sweeps (grazing, clapping, …), separately at each level of force.
pub(super) fn name(responses: &mut [&mut Response]) {
    for level in by_level(responses.iter().map(|r| &**r)) {
        let members = responses.iter_mut().enumerate().filter(|(i, _)| level.contains(i));
        let mut members: Vec<&mut Response> =
            members.map(|(_, r)| &mut **r).filter(|r| r.mass.is_some() && r.direction.is_some()).collect();
        let curves = members.iter_mut().filter_map(|r| {
            let mut curve = curve(r);
            sort_by_number(&mut curve, |a| a.0);
            let (jumps, resonances) = (take(&mut r.jumps), take(&mut r.resonances));
            Some(NamedCurve { mass: r.mass, direction: r.direction?, curve, jumps, resonances })
        });
        let mut curves: Vec<NamedCurve> = curves.collect();
        name_modes(&mut curves);
        for (response, curve) in members.into_iter().zip(curves) {
            (response.jumps, response.resonances) = (curve.jumps, curve.resonances);
        }
    }
}

/// The first sweep of a mass in a direction.
fn first_sweep<'a>(responses: &[&'a Response], mass: u8, direction: Direction) -> Option<&'a Response> {
    responses.iter().copied().find(|r| r.mass == Some(mass) && r.direction == Some(direction))
}

/// The antiresonance of mass 1, up and down, at the first level of force.
pub(super) fn antiresonances(responses: &[Response]) -> [Option<f64>; 2] {
    let all: Vec<&Response> = responses.iter().collect();
    [Direction::Up, Direction::Down]
        .map(|direction| first_sweep(&all, 1, direction).and_then(|r| deepest(&r.resonances)))
}

/// Crossings of both masses, in each direction at each level of force.
pub(super) fn all_crossings(responses: &[Response]) -> Vec<Crossing> {
    let levels = by_level(responses.iter());
    let mut found = Vec::new();
    for level in &levels {
        let members: Vec<&Response> = level.iter().filter_map(|i| responses.get(*i)).collect();
        for direction in [Direction::Up, Direction::Down] {
            let pair = first_sweep(&members, 1, direction).zip(first_sweep(&members, 2, direction));
            let Some((excited, passive)) = pair else { continue };
            let force = median_force(excited).filter(|_| levels.len() > 1);
            let jumps = [excited.jumps.as_slice(), &passive.jumps].concat();
            found.extend(crossings(curve(excited), curve(passive), &jumps).into_iter().map(|c| Crossing {
                direction,
                force,
                frequency: c.frequency,
                frequency_std: c.frequency_std,
                larger_above: if c.second_above { 2 } else { 1 },
            }));
        }
    }
    found
}

/// Cautions on further sweeps of one mass, direction and level of force: naming and crossings use the first
/// only.
pub(super) fn swept_twice(responses: &[Response]) -> Vec<About> {
    let mut found = Vec::new();
    for level in by_level(responses.iter()) {
        let members: Vec<&Response> = level.iter().filter_map(|i| responses.get(*i)).collect();
        for (i, r) in members.iter().enumerate() {
            let Some((mass, direction)) = r.mass.zip(r.direction) else { continue };
            if let Some(earlier) = first_sweep(&members[..i], mass, direction) {
                let finding = Finding::caution("swept-twice").name("first", format!("{:?}", earlier.name));
                found.push((r.name.clone(), finding));
            }
        }
    }
    found
}

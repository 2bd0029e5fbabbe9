//! One periodic motion: traces of both masses and their phase plane.

use super::motion::roomy;
use crate::model::{Orbit, Rig, State};
use crate::report::layout::{lettered, line, points};
use crate::report::{AxisSpec, Figure, Ink, Marker, Plot, Stroke};

/// Samples of a period.
const POINTS: usize = 800;

/// Both masses over two periods, x₂ counted from the rest of x₁'s contact face, so that the curves meet at the impacts; velocities over
/// displacements beside it.
pub fn orbit(title: &str, rig: &Rig, orbit: &Orbit) -> Figure {
    let at = |i: usize| orbit.period() * i as f64 / POINTS as f64;
    let states: Vec<(f64, State)> =
        (0..=2 * POINTS).map(|i| (i as f64 / POINTS as f64, orbit.state(at(i)))).collect();
    let ends: Vec<f64> = states.iter().flat_map(|(_, s)| [1e3 * s.x1, 1e3 * s.x2]).collect();
    let axis = AxisSpec::new("Time in periods from impact to impact", "").limits(0.0, 2.0);
    let plot = Plot::new(axis, AxisSpec::new("Displacement", "mm")).title("displacements");
    let second = states.iter().map(|(t, s)| (*t, 1e3 * (s.x2 + rig.gap)));
    let plot = line(plot, "gap + x₂", second, Ink::Nth(1), Stroke::Solid);
    let plot = line(plot, "x₁", states.iter().map(|(t, s)| (*t, 1e3 * s.x1)), Ink::Nth(0), Stroke::Solid);
    let met = 1e3 * orbit.before_impact().x1;
    let impacts = [0.0, 1.0, 2.0].map(|t| (t, met));
    let traces = points(plot, "impact", impacts, Ink::Black, Marker::OpenCircle);
    let x = roomy(AxisSpec::new("Displacement from rest", "mm"), &ends);
    let mut plane = Plot::new(x, AxisSpec::new("Velocity", "m/s")).title("phase plane");
    for (i, name) in ["x₁", "x₂"].into_iter().enumerate() {
        let of = |s: State| if i == 0 { (1e3 * s.x1, s.v1) } else { (1e3 * s.x2, s.v2) };
        let (before, after) = (orbit.before_impact(), orbit.state(0.0));
        let period = (0..POINTS).map(|k| orbit.state(at(k))).chain([before]);
        plane = line(plane, "", [of(before), of(after)], Ink::Nth(i), Stroke::Dotted);
        plane = line(plane, name, period.map(of), Ink::Nth(i), Stroke::Solid);
    }
    let v = &orbit.validity;
    let verdict = match (v.exists, v.admissible, v.instability) {
        (false, ..) => "It does not exist: the masses would have to pull.".to_owned(),
        (_, false, _) => format!(
            "It is impossible: the masses would pass through each other by {:.3} mm.",
            -1e3 * v.min_gap
        ),
        (.., Some(loss)) => format!("It is unstable ({}).", loss.name()),
        _ => format!("It is possible and {}.", v.stability.name()),
    };
    let figure = Figure::double(title).columns(2).panel(traces).panel(plane);
    lettered(figure.caption(format!(
        "Motion with one impact a period at {:.4} Hz, impact speed {:.4} m/s. Left, the masses touch where the curves meet; right, dotted: \
         the impact. {verdict}",
        orbit.frequency, orbit.approach_velocity
    )))
}

//! One periodic motion: traces of both masses and their phase plane.

use crate::model::{Orbit, Rig};
use crate::report::layout::lettered;
use crate::report::{AxisSpec, Figure, Ink, Marker, Plot, Series, Stroke};

/// Samples of a period.
const POINTS: usize = 800;

/// Both masses over two periods, x₂ counted from the rest of x₁'s contact face, so that the curves meet at the impacts; velocities over
/// displacements beside it.
pub fn orbit(title: &str, rig: &Rig, orbit: &Orbit) -> Figure {
    let period = orbit.period();
    let (mut time, mut first, mut second) = (Vec::new(), Vec::new(), Vec::new());
    for i in 0..=2 * POINTS {
        let s = orbit.state(period * i as f64 / POINTS as f64);
        time.push(i as f64 / POINTS as f64);
        first.push(1e3 * s.x1);
        second.push(1e3 * (s.x2 + rig.gap));
    }
    let impacts = [0.0, 1.0, 2.0];
    let met = 1e3 * orbit.before_impact().x1;
    let traces = Plot::new(
        AxisSpec::new("Time in periods from impact to impact", "").limits(0.0, 2.0),
        AxisSpec::new("Displacement", "mm"),
    )
    .title("displacements")
    .with(Series::line("gap + x₂", time.clone(), second).ink(Ink::Nth(1)).stroke(Stroke::Solid))
    .with(Series::line("x₁", time, first).ink(Ink::Nth(0)).stroke(Stroke::Solid))
    .with(Series::points("impact", impacts, [met; 3]).ink(Ink::Black).marker(Marker::OpenCircle));

    let mut ends = (f64::INFINITY, f64::NEG_INFINITY);
    for x in first_two(orbit, period) {
        ends = (ends.0.min(x), ends.1.max(x));
    }
    // Room beside the curves.
    let room = 0.05 * (ends.1 - ends.0);
    let x = AxisSpec::new("Displacement from rest", "mm").limits(ends.0 - room, ends.1 + room);
    let mut plane = Plot::new(x, AxisSpec::new("Velocity", "m/s")).title("phase plane");
    for (i, name) in ["x₁", "x₂"].into_iter().enumerate() {
        let of = |t: f64| {
            let s = if t < period { orbit.state(t) } else { orbit.before_impact() };
            if i == 0 { (1e3 * s.x1, s.v1) } else { (1e3 * s.x2, s.v2) }
        };
        let (x, v): (Vec<f64>, Vec<f64>) =
            (0..=POINTS).map(|k| of(period * k as f64 / POINTS as f64)).unzip();
        let (before, after) = (of(period), of(0.0));
        plane = plane
            .with(
                Series::line("", [before.0, after.0], [before.1, after.1])
                    .ink(Ink::Nth(i))
                    .stroke(Stroke::Dotted),
            )
            .with(Series::line(name, x, v).ink(Ink::Nth(i)).stroke(Stroke::Solid));
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

/// Both displacements over a period, in mm.
fn first_two(orbit: &Orbit, period: f64) -> impl Iterator<Item = f64> + '_ {
    (0..=POINTS).flat_map(move |i| {
        let s = orbit.state(period * i as f64 / POINTS as f64);
        [1e3 * s.x1, 1e3 * s.x2]
    })
}

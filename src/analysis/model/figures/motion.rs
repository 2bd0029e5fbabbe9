//! A simulated motion: traces of both masses, the phase plane, and Poincaré sections; one periodic motion.

use crate::model::portrait::Portrait;
use crate::model::{Orbit, PeriodicOrbit, Rig, State};
use crate::report::layout::{lettered, line, points};
use crate::report::{AxisSpec, Figure, Ink, Legend, Marker, Plot, Stroke};

/// Names and series of both masses.
const MASSES: [(&str, usize); 2] = [("excited mass", 0), ("passive mass", 1)];

/// Displacement in mm and velocity in m/s of a mass.
fn place(state: &State, mass: usize) -> (f64, f64) {
    [(1e3 * state.x1, state.v1), (1e3 * state.x2, state.v2)][mass]
}

/// Displacements over time, both from the plane in which the masses meet, and velocities.
pub fn traces(title: &str, portrait: &Portrait, gap: f64) -> Figure {
    let axis = || AxisSpec::new("Time", "s");
    let mut displacement = Plot::new(axis(), AxisSpec::new("Displacement", "mm")).legend(Legend::Above);
    let mut velocity = Plot::new(axis(), AxisSpec::new("Velocity", "m/s")).legend(Legend::Hidden);
    for (name, mass) in MASSES {
        let look = (Ink::Nth(mass), [Stroke::Solid, Stroke::Dashed][mass]);
        let label = ["excited mass x₁", "passive mass x₂ + gap"][mass];
        let states = || portrait.time.iter().zip(&portrait.states);
        let moved = states().map(|(t, s)| (*t, place(s, mass).0 + 1e3 * gap * mass as f64));
        displacement = line(displacement, label, moved, look.0, look.1);
        velocity = line(velocity, name, states().map(|(t, s)| (*t, place(s, mass).1)), look.0, look.1);
    }
    lettered(
        Figure::double(title).height(120.0).shared_x().panel(displacement).panel(velocity).caption(
            "(a) Displacements, that of the passive mass moved by the gap: the masses meet where the lines do. (b) Velocities.",
        ),
    )
}

/// Force between the masses over the last cycles, if contacts have a duration, and the impulse of each
/// impact.
pub fn reaction(title: &str, portrait: &Portrait) -> Figure {
    let from = portrait.time.first().copied().unwrap_or(f64::NEG_INFINITY);
    let time = || AxisSpec::new("Time", "s");
    let mut figure = Figure::double(title).height(if portrait.force.is_empty() { 70.0 } else { 120.0 });
    if let [first, .., last] = portrait.force[..] {
        // From contact to contact the force is zero.
        let mut course = vec![(from.min(first.0), 0.0)];
        for pair in portrait.force.windows(2) {
            course.push(pair[0]);
            let step = portrait.time.get(1).map_or(0.0, |t| t - from);
            if pair[1].0 - pair[0].0 > step {
                course.extend([(pair[0].0, 0.0), (pair[1].0, 0.0)]);
            }
        }
        course.push(last);
        let plot = Plot::new(time(), AxisSpec::new("Force", "N")).legend(Legend::Hidden);
        figure = figure.shared_x().panel(line(plot, "", course, Ink::Nth(0), Stroke::Solid));
    }
    let impacts = portrait.impacts.iter().filter(|i| i.time >= from).map(|i| (i.time, i.impulse));
    let plot = Plot::new(time(), AxisSpec::new("Impulse", "N s")).legend(Legend::Hidden);
    let plot = points(plot, "", impacts, Ink::Nth(0), Marker::Circle);
    lettered(
        figure
            .panel(plot)
            .caption("Force between the masses where contacts last, and impulse of each impact."),
    )
}

/// Samples with the states before and after each impact between them.
fn with_impacts(portrait: &Portrait) -> Vec<State> {
    let mut jumps = portrait.jumps.iter().peekable();
    let mut all = Vec::with_capacity(portrait.states.len() + 2 * portrait.jumps.len());
    for (time, state) in portrait.time.iter().zip(&portrait.states) {
        while let Some((_, before, after)) = jumps.next_if(|j| j.0 <= *time) {
            all.extend([*before, *after]);
        }
        all.push(*state);
    }
    all
}

/// An axis over these values with 10 % of room at both ends, no finer than 1 % of the largest value:
/// rounding errors of a repeating motion then appear as one point.
fn with_room(axis: AxisSpec, values: &[f64]) -> AxisSpec {
    let (low, high) =
        values.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), v| (a.min(*v), b.max(*v)));
    let width = (high - low).max(0.01 * high.abs().max(low.abs()));
    if !(width.is_finite() && width > 0.0) {
        return axis;
    }
    let middle = f64::midpoint(low, high);
    axis.limits(middle - 0.6 * width, middle + 0.6 * width)
}

/// Axes of velocity over displacement with room around these places.
fn plane(places: &[(f64, f64)]) -> Plot {
    let (x, v): (Vec<f64>, Vec<f64>) = places.iter().copied().unzip();
    Plot::new(
        with_room(AxisSpec::new("Displacement", "mm"), &x),
        with_room(AxisSpec::new("Velocity", "m/s"), &v),
    )
}

/// Velocity over displacement of each mass.
pub fn phase_plane(title: &str, portrait: &Portrait) -> Figure {
    let states = with_impacts(portrait);
    let mut figure = Figure::double(title).columns(2);
    for (name, mass) in MASSES {
        let places: Vec<(f64, f64)> = states.iter().map(|s| place(s, mass)).collect();
        let plot = plane(&places).title(name).legend(Legend::Hidden);
        figure = figure.panel(line(plot, "", places, Ink::Nth(mass), Stroke::Thin));
    }
    lettered(figure.caption("Phase plane of each mass over the last cycles; an impact is a vertical step."))
}

/// States once a cycle, and approach speed over phase at the impacts.
pub fn poincare(title: &str, portrait: &Portrait) -> Figure {
    let places = |mass| portrait.section.iter().map(move |s| place(s, mass));
    let mut section = plane(&places(0).chain(places(1)).collect::<Vec<_>>()).legend(Legend::Above);
    for (name, mass) in MASSES {
        let marker = [Marker::Circle, Marker::Square][mass];
        section = points(section, name, places(mass), Ink::Nth(mass), marker);
    }
    let struck = portrait.impacts.iter().map(|i| (i.phase.to_degrees(), i.approach_velocity));
    let speeds: Vec<f64> = portrait.impacts.iter().map(|i| i.approach_velocity).collect();
    let phase = AxisSpec::new("Phase of the excitation at the impact", "°").limits(0.0, 360.0);
    let impacts = Plot::new(phase, with_room(AxisSpec::new("Approach speed", "m/s"), &speeds));
    let impacts = points(impacts, "", struck, Ink::Nth(0), Marker::Circle).legend(Legend::Hidden);
    lettered(
        Figure::double(title)
            .columns(2)
            .panel(section)
            .panel(impacts)
            .caption("(a) Poincaré section: both masses at the beginning of each cycle of the excitation. (b) The impacts. A motion that repeats itself is a few points."),
    )
}

/// Number of samples of a period.
const PERIOD_SAMPLES: usize = 800;

/// Both masses over two periods, x₂ measured from the rest position of mass 1's contact face, so that the
/// curves meet at the impacts; velocities over displacements beside it.
pub fn orbit(title: &str, rig: &Rig, orbit: &Orbit) -> Figure {
    let at = |i: usize| orbit.period() * i as f64 / PERIOD_SAMPLES as f64;
    let states: Vec<(f64, State)> =
        (0..=2 * PERIOD_SAMPLES).map(|i| (i as f64 / PERIOD_SAMPLES as f64, orbit.state(at(i)))).collect();
    let ends: Vec<f64> = states.iter().flat_map(|(_, s)| [1e3 * s.x1, 1e3 * s.x2]).collect();
    let axis = AxisSpec::new("Time in periods from impact to impact", "").limits(0.0, 2.0);
    let plot = Plot::new(axis, AxisSpec::new("Displacement", "mm")).title("displacements");
    let second = states.iter().map(|(t, s)| (*t, 1e3 * (s.x2 + rig.gap)));
    let plot = line(plot, "gap + x₂", second, Ink::Nth(1), Stroke::Solid);
    let plot = line(plot, "x₁", states.iter().map(|(t, s)| (*t, 1e3 * s.x1)), Ink::Nth(0), Stroke::Solid);
    let meeting_place = 1e3 * orbit.before_impact().x1;
    let impacts = [0.0, 1.0, 2.0].map(|t| (t, meeting_place));
    let traces = points(plot, "impact", impacts, Ink::Black, Marker::OpenCircle);
    let x = with_room(AxisSpec::new("Displacement from rest", "mm"), &ends);
    let mut plane = Plot::new(x, AxisSpec::new("Velocity", "m/s")).title("phase plane");
    for (i, name) in ["x₁", "x₂"].into_iter().enumerate() {
        let of = |s: State| if i == 0 { (1e3 * s.x1, s.v1) } else { (1e3 * s.x2, s.v2) };
        let (before, after) = (orbit.before_impact(), orbit.state(0.0));
        let period = (0..PERIOD_SAMPLES).map(|k| orbit.state(at(k))).chain([before]);
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
        _ => format!("It is possible and {}.", v.stability()),
    };
    let figure = Figure::double(title).columns(2).panel(traces).panel(plane);
    lettered(figure.caption(format!(
        "Motion with one impact a period at {:.4} Hz, impact speed {:.4} m/s. Left, the masses touch where the curves meet; right, dotted: \
         the impact. {verdict}",
        orbit.frequency, orbit.approach_velocity
    )))
}

/// Both masses over a period with several impacts, x₂ measured from the rest position of mass 1's contact
/// face.
pub fn pattern(title: &str, orbit: &PeriodicOrbit) -> Figure {
    let at = |i: usize| orbit.period() * i as f64 / PERIOD_SAMPLES as f64;
    let states: Vec<(f64, State)> = (0..=PERIOD_SAMPLES).map(|i| (at(i), orbit.state(at(i)))).collect();
    let plot =
        Plot::new(AxisSpec::new("Time after the first impact", "s"), AxisSpec::new("Displacement", "mm"));
    let second = states.iter().map(|(t, s)| (*t, 1e3 * (s.x2 + orbit.rig.gap)));
    let plot = line(plot, "gap + x₂", second, Ink::Nth(1), Stroke::Solid);
    let plot = line(plot, "x₁", states.iter().map(|(t, s)| (*t, 1e3 * s.x1)), Ink::Nth(0), Stroke::Solid);
    let first = orbit.beats.first().map_or(0.0, |b| b.phase);
    let impacts = orbit.beats.iter().map(|b| (b.phase - first) / orbit.sine.omega());
    let impact_places: Vec<_> = impacts.map(|t| (t, 1e3 * orbit.state(t).x1)).collect();
    let plot = points(plot, "impact", impact_places, Ink::Black, Marker::OpenCircle);
    let v = &orbit.validity;
    let verdict = match (v.admissible, v.instability) {
        (false, _) => "impossible: the masses would pass through each other".to_owned(),
        (_, Some(loss)) => format!("unstable ({})", loss.name()),
        _ => v.stability().to_owned(),
    };
    Figure::double(title).panel(plot).caption(format!(
        "Motion with {} impacts in {} cycles at {:.4} Hz: {verdict}.",
        orbit.beats.len(),
        orbit.cycles,
        orbit.sine.frequency
    ))
}

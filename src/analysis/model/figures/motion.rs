//! A simulated motion: traces of both masses, the phase plane, and Poincaré sections.

use crate::model::State;
use crate::model::portrait::Portrait;
use crate::report::layout::lettered;
use crate::report::{AxisSpec, Figure, Ink, Legend, Marker, Plot, Series, Stroke};

/// Displacements over time, both from the plane in which the masses meet, and velocities.
pub fn traces(title: &str, portrait: &Portrait, gap: f64) -> Figure {
    let time = &portrait.time;
    let of = |value: fn(&State) -> f64| -> Vec<f64> { portrait.states.iter().map(value).collect() };
    let shifted: Vec<f64> = portrait.states.iter().map(|s| 1e3 * (s.x2 + gap)).collect();
    let axis = || AxisSpec::new("Time", "s");
    let line = |name: &str, y: Vec<f64>, nth: usize| {
        let stroke = if nth == 0 { Stroke::Solid } else { Stroke::Dashed };
        Series::line(name, time.clone(), y).ink(Ink::Nth(nth)).stroke(stroke)
    };
    let displacement = Plot::new(axis(), AxisSpec::new("Displacement", "mm"))
        .with(line("excited mass x₁", of(|s| 1e3 * s.x1), 0))
        .with(line("passive mass x₂ + gap", shifted, 1))
        .legend(Legend::Above);
    let velocity = Plot::new(axis(), AxisSpec::new("Velocity", "m/s"))
        .with(line("excited mass", of(|s| s.v1), 0))
        .with(line("passive mass", of(|s| s.v2), 1))
        .legend(Legend::Hidden);
    lettered(
        Figure::double(title).height(120.0).shared_x().panel(displacement).panel(velocity).caption(
            "(a) Displacements, that of the passive mass moved by the gap: the masses meet where the lines do. (b) Velocities.",
        ),
    )
}

/// Samples with the states before and after each impact between them.
fn whole(portrait: &Portrait) -> Vec<State> {
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

/// An axis over these values with a tenth of room at both ends, and not finer than a hundredth of the largest: what repeats is a point, not
/// its roundings.
fn roomy(axis: AxisSpec, values: &[f64]) -> AxisSpec {
    let (low, high) =
        values.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), v| (a.min(*v), b.max(*v)));
    let width = (high - low).max(0.01 * high.abs().max(low.abs()));
    if !(width.is_finite() && width > 0.0) {
        return axis;
    }
    let middle = f64::midpoint(low, high);
    axis.limits(middle - 0.6 * width, middle + 0.6 * width)
}

/// Velocity over displacement of each mass.
pub fn phase_plane(title: &str, portrait: &Portrait) -> Figure {
    let states = whole(portrait);
    let plot = |name: &str, nth: usize, x: fn(&State) -> f64, v: fn(&State) -> f64| {
        let (xs, vs): (Vec<f64>, Vec<f64>) = states.iter().map(|s| (1e3 * x(s), v(s))).unzip();
        Plot::new(
            roomy(AxisSpec::new("Displacement", "mm"), &xs),
            roomy(AxisSpec::new("Velocity", "m/s"), &vs),
        )
        .title(name)
        .with(Series::line("", xs, vs).ink(Ink::Nth(nth)).stroke(Stroke::Thin))
        .legend(Legend::Hidden)
    };
    lettered(
        Figure::double(title)
            .columns(2)
            .panel(plot("excited mass", 0, |s| s.x1, |s| s.v1))
            .panel(plot("passive mass", 1, |s| s.x2, |s| s.v2))
            .caption("Phase plane of each mass over the last cycles; an impact is a vertical step."),
    )
}

/// States once a cycle, and approach speed over phase at the impacts.
pub fn poincare(title: &str, portrait: &Portrait) -> Figure {
    let points = |name: &str, nth: usize, x: fn(&State) -> f64, v: fn(&State) -> f64| {
        let (xs, vs): (Vec<f64>, Vec<f64>) = portrait.section.iter().map(|s| (1e3 * x(s), v(s))).unzip();
        let marker = if nth == 0 { Marker::Circle } else { Marker::Square };
        Series::points(name, xs, vs).ink(Ink::Nth(nth)).marker(marker)
    };
    let both = |of: fn(&State) -> [f64; 2]| portrait.section.iter().flat_map(of).collect::<Vec<f64>>();
    let displacement = roomy(AxisSpec::new("Displacement", "mm"), &both(|s| [1e3 * s.x1, 1e3 * s.x2]));
    let velocity = roomy(AxisSpec::new("Velocity", "m/s"), &both(|s| [s.v1, s.v2]));
    let section = Plot::new(displacement, velocity)
        .with(points("excited mass", 0, |s| s.x1, |s| s.v1))
        .with(points("passive mass", 1, |s| s.x2, |s| s.v2))
        .legend(Legend::Above);
    let (phase, speed): (Vec<f64>, Vec<f64>) =
        portrait.impacts.iter().map(|i| (i.phase.to_degrees(), i.approach_velocity)).unzip();
    let impacts = Plot::new(
        AxisSpec::new("Phase of the excitation at the impact", "°").limits(0.0, 360.0),
        roomy(AxisSpec::new("Approach speed", "m/s"), &speed),
    )
    .with(Series::points("", phase, speed).ink(Ink::Nth(0)).marker(Marker::Circle))
    .legend(Legend::Hidden);
    lettered(
        Figure::double(title)
            .columns(2)
            .panel(section)
            .panel(impacts)
            .caption("(a) Poincaré section: both masses at the beginning of each cycle of the excitation. (b) The impacts. A motion that repeats itself is a few points."),
    )
}

//! Sweeps of a model: both masses, up and down, with jumps and branches.

use crate::analysis::model::tables::{FollowedPoint, followed};
use crate::compare::Named;
use crate::measure::jump::Jump;
use crate::measure::resonance::{Resonance, ResonanceKind};
use crate::model::continuation::Branch;
use crate::model::sweep::{Observable, Point, Swept};
use crate::record::Direction;
use crate::report::layout::lettered;
use crate::report::{AxisSpec, Figure, Ink, Marker, Plot, Series, Stroke};

/// Excited mass above, passive mass below, over frequency or force.
pub fn sweep(
    swept: &Swept,
    resonances: &[Named<Resonance>],
    jumps: &[Named<Jump>],
    observable: Observable,
    over_force: bool,
    branches: &[Branch],
) -> Figure {
    let mut figure = Figure::double("Sweep").height(160.0).shared_x();
    for mass in [1_u8, 2] {
        figure = figure.panel(plot(swept, resonances, jumps, observable, over_force, branches, mass));
    }
    let mut caption =
        String::from("Motion of the model with its state carried on from step to step; crosses are jumps.");
    if !branches.is_empty() {
        caption.push_str(
            " Grey: motions with one impact a cycle, stable as lines, unstable as dashes; dots where the masses would pass \
             through each other.",
        );
    }
    lettered(figure.caption(caption))
}

fn plot(
    swept: &Swept,
    resonances: &[Named<Resonance>],
    jumps: &[Named<Jump>],
    observable: Observable,
    over_force: bool,
    branches: &[Branch],
    mass: u8,
) -> Plot {
    let quantity = match observable {
        Observable::Fundamental => "Amplitude at the excitation frequency",
        Observable::Peak => "Half peak-to-peak",
        Observable::Rms => "Running RMS",
    };
    let x =
        if over_force { AxisSpec::new("Force", "N") } else { AxisSpec::new("Excitation frequency", "Hz") };
    let name = if mass == 1 { "excited mass" } else { "passive mass" };
    let mut plot = Plot::new(x, AxisSpec::new(quantity, "m")).title(name);
    for branch in branches {
        for series in ranges(&followed(branch, observable).points, mass) {
            plot = plot.with(series);
        }
    }
    let along = |p: &Point| if over_force { p.force } else { p.frequency };
    let height = |p: &Point| if mass == 1 { p.x1 } else { p.x2 };
    for (name, points, ink, stroke) in [
        ("sweeping up", &swept.up, Ink::Nth(0), Stroke::Solid),
        ("sweeping down", &swept.down, Ink::Nth(1), Stroke::Dashed),
    ] {
        if !points.is_empty() {
            let (x, y): (Vec<f64>, Vec<f64>) = points.iter().map(|p| (along(p), height(p))).unzip();
            plot = plot.with(Series::line(name, x, y).ink(ink).stroke(stroke));
        }
    }
    for (direction, ink) in [(Direction::Up, Ink::Nth(0)), (Direction::Down, Ink::Nth(1))] {
        let own = jumps.iter().filter(|j| j.mass == mass && j.direction == direction);
        let (x, y): (Vec<f64>, Vec<f64>) = own
            .flat_map(|j| [(j.found.from, j.found.amplitude_before), (j.found.to, j.found.amplitude_after)])
            .unzip();
        if !x.is_empty() {
            plot = plot.with(Series::points("", x, y).marker(Marker::Cross).ink(ink));
        }
    }
    for r in resonances.iter().filter(|r| r.mass == mass) {
        if matches!(r.found.kind, ResonanceKind::Grazing | ResonanceKind::Clapping) {
            let text = format!("{} {:.2} Hz, {}", r.found.kind.name(), r.found.frequency, r.direction.name());
            plot = plot.note(text, r.found.frequency, r.found.amplitude);
        }
    }
    plot
}

/// Stretches of a branch: stable, unstable, and those on which the masses would pass through each other.
fn ranges(points: &[FollowedPoint], mass: u8) -> Vec<Series> {
    let stroke = |p: &FollowedPoint| match (p.admissible, p.stable) {
        (false, _) => Stroke::Dotted,
        (true, Some(false)) => Stroke::Dashed,
        (true, _) => Stroke::Thin,
    };
    let mut series = Vec::new();
    let mut from = 0;
    while from < points.len() {
        let kind = stroke(&points[from]);
        let same = points[from..].iter().take_while(|p| stroke(p) == kind).count();
        // To the first point of the next stretch, so that the curve has no holes.
        let to = (from + same + 1).min(points.len());
        let height = |p: &FollowedPoint| if mass == 1 { p.x1 } else { p.x2 };
        let (x, y): (Vec<f64>, Vec<f64>) = points[from..to].iter().map(|p| (p.frequency, height(p))).unzip();
        series.push(Series::line("", x, y).ink(Ink::Grey).stroke(kind));
        from += same;
    }
    series
}

//! Sweeps of a model: both masses, up and down, with jumps and branches.

use super::super::sweep::read;
use crate::compare::Named;
use crate::measure::jump::Jump;
use crate::measure::resonance::{Resonance, ResonanceKind};
use crate::model::PeriodicOrbit;
use crate::model::continuation::Branch;
use crate::model::sweep::{Observable, Point, Swept};
use crate::record::Direction;
use crate::report::layout::{lettered, line, points};
use crate::report::{AxisSpec, Figure, Ink, Marker, Plot, Stroke};

/// Excited mass above, passive mass below, over frequency or force.
pub fn sweep(
    swept: &Swept,
    resonances: &[Named<Resonance>],
    jumps: &[Named<Jump>],
    observable: Observable,
    over_force: bool,
    branches: &[Branch],
) -> Figure {
    let quantity = match observable {
        Observable::Fundamental => "Amplitude at the excitation frequency",
        Observable::Peak => "Half peak-to-peak",
        Observable::Rms => "Running RMS",
    };
    let (over, unit) = if over_force { ("Force", "N") } else { ("Excitation frequency", "Hz") };
    let mut figure = Figure::double("Sweep").height(160.0).shared_x();
    for (mass, name) in [(0, "excited mass"), (1, "passive mass")] {
        let mut plot = Plot::new(AxisSpec::new(over, unit), AxisSpec::new(quantity, "m")).title(name);
        for branch in branches {
            plot = followed(plot, branch, |o| (o.sine.frequency, read(o, observable)[mass]));
        }
        let place = |p: &Point| (if over_force { p.force } else { p.frequency }, [p.x1, p.x2][mass]);
        for (name, direction, points, ink, stroke) in [
            ("sweeping up", Direction::Up, &swept.up, Ink::Nth(0), Stroke::Solid),
            ("sweeping down", Direction::Down, &swept.down, Ink::Nth(1), Stroke::Dashed),
        ] {
            plot = line(plot, name, points.iter().map(place), ink, stroke);
            let own = jumps.iter().filter(|j| usize::from(j.mass) == mass + 1 && j.direction == direction);
            let ends = own.map(|j| &j.found);
            let ends = ends.flat_map(|j| [(j.from, j.amplitude_before), (j.to, j.amplitude_after)]);
            plot = self::points(plot, "", ends, ink, Marker::Cross);
        }
        let named = |r: &&Named<Resonance>| {
            let kind = r.found.kind;
            usize::from(r.mass) == mass + 1
                && matches!(kind, ResonanceKind::Grazing | ResonanceKind::Clapping)
        };
        for Named { direction, found, .. } in resonances.iter().filter(named) {
            let text = format!("{} {:.2} Hz, {}", found.kind.name(), found.frequency, direction.name());
            plot = plot.note(text, found.frequency, found.amplitude);
        }
        figure = figure.panel(plot);
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

/// Adds the stretches of a branch: stable, unstable, and those on which the masses would pass through each other.
fn followed(mut plot: Plot, branch: &Branch, place: impl Fn(&PeriodicOrbit) -> (f64, f64)) -> Plot {
    let stroke = |o: &PeriodicOrbit| match (o.validity.admissible, o.validity.stable) {
        (false, _) => Stroke::Dotted,
        (true, Some(false)) => Stroke::Dashed,
        (true, _) => Stroke::Thin,
    };
    let mut from = 0;
    for same in branch.points.chunk_by(|a, b| stroke(a) == stroke(b)) {
        // To the first point of the next stretch, so that the curve has no holes.
        let to = from + same.len();
        let stretch = branch.points[from..].iter().take(same.len() + 1);
        plot = line(plot, "", stretch.map(&place), Ink::Grey, stroke(&same[0]));
        from = to;
    }
    plot
}

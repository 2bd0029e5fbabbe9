//! Sweeps of a model: both masses, up and down, with jumps.

use crate::compare::Named;
use crate::measure::jump::Jump;
use crate::measure::resonance::{Resonance, ResonanceKind};
use crate::model::Reaction;
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
        let place = |p: &Point| (if over_force { p.force } else { p.frequency }, [p.x1, p.x2][mass]);
        for (name, direction, points, ink, stroke) in [
            ("sweeping up", Direction::Up, &swept.up, Ink::Nth(0), Stroke::Solid),
            ("sweeping down", Direction::Down, &swept.down, Ink::Nth(1), Stroke::Dashed),
        ] {
            plot = line(plot, name, points.iter().map(place), ink, stroke);
            let of_curve =
                jumps.iter().filter(|j| usize::from(j.mass) == mass + 1 && j.direction == direction);
            let ends = of_curve.map(|j| &j.found);
            let ends = ends.flat_map(|j| [(j.from, j.amplitude_before), (j.to, j.amplitude_after)]);
            plot = self::points(plot, "", ends, ink, Marker::Cross);
        }
        let is_labelled = |r: &&Named<Resonance>| {
            let kind = r.found.kind;
            usize::from(r.mass) == mass + 1
                && matches!(kind, ResonanceKind::Grazing | ResonanceKind::Clapping)
        };
        for Named { direction, found, .. } in resonances.iter().filter(is_labelled) {
            let text = format!("{} {:.2} Hz, {}", found.kind.name(), found.frequency, direction.name());
            plot = plot.note(text, found.frequency, found.amplitude);
        }
        figure = figure.panel(plot);
    }
    lettered(
        figure.caption("Motion of the model with its state carried on from step to step; crosses are jumps."),
    )
}

/// The force between the masses over frequency or force: its peak and RMS, if contacts have a duration, and
/// the impulse a cycle.
pub fn forces(swept: &Swept, over_force: bool) -> Figure {
    let (over, unit) = if over_force { ("Force", "N") } else { ("Excitation frequency", "Hz") };
    // Contacts with a duration have a force; instantaneous impacts have an impulse only.
    let has_force = swept.up.iter().chain(&swept.down).any(|p| p.reaction.peak.is_some());
    let mut figure =
        Figure::double("Force between the masses").height(if has_force { 170.0 } else { 70.0 }).shared_x();
    for (i, (label, size)) in [("Peak force", "N"), ("RMS force", "N"), ("Impulse a cycle", "N s")]
        .into_iter()
        .enumerate()
        .skip(if has_force { 0 } else { 2 })
    {
        let value = |r: &Reaction| [r.peak, r.rms, r.impulse][i];
        let mut plot = Plot::new(AxisSpec::new(over, unit), AxisSpec::new(label, size));
        for (name, points, ink, stroke) in [
            ("sweeping up", &swept.up, Ink::Nth(0), Stroke::Solid),
            ("sweeping down", &swept.down, Ink::Nth(1), Stroke::Dashed),
        ] {
            let at = |p: &Point| Some((if over_force { p.force } else { p.frequency }, value(&p.reaction)?));
            plot = line(plot, name, points.iter().filter_map(at), ink, stroke);
        }
        figure = figure.panel(plot);
    }
    lettered(
        figure.caption("Force with which the masses push each other, over the cycles read at each point."),
    )
}

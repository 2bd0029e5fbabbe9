//! Energy of a period over the impulse.

use crate::model::{EnergyPoint, Orbit};
use crate::report::layout::{line, points};
use crate::report::{AxisSpec, Figure, Ink, Marker, Plot, Stroke};

/// Energy supplied and lost over the impulse, with the motions where both are equal.
pub fn energy(title: &str, curve: &[EnergyPoint], motions: &[(&Orbit, EnergyPoint)]) -> Figure {
    let over = |of: fn(&EnergyPoint) -> f64| curve.iter().map(move |e| (e.impulse, of(e)));
    let mut plot = Plot::new(AxisSpec::new("Impulse", "N s"), AxisSpec::new("Energy of a period", "J"));
    plot = line(plot, "supplied by the force", over(|e| e.supplied), Ink::Nth(0), Stroke::Solid);
    plot = line(plot, "lost in dampers and impact", over(|e| e.lost), Ink::Nth(1), Stroke::Dashed);
    let kinds =
        [(true, "stable and admissible", Marker::Circle), (false, "other motions", Marker::OpenCircle)];
    for (real, name, marker) in kinds {
        let of_kind = motions.iter().filter(|(orbit, _)| orbit.validity.real() == real);
        let places: Vec<(f64, f64)> = of_kind.map(|(_, e)| (e.impulse, e.supplied)).collect();
        if !places.is_empty() {
            plot = points(plot, name, places, Ink::Black, marker);
        }
    }
    Figure::double(title).height(85.0).panel(plot).caption(
        "Energy of a period over the impulse, where the masses meet at the gap. The curves cross at the motions that satisfy the impact law, too. Where the loss is the steeper one, a disturbed impulse returns, as far as the energy tells.",
    )
}

//! The force of sweeps over frequency.

use super::response::{look, rank};
use crate::measure::response::Response;
use crate::report::{AxisSpec, Figure, Plot, Series, Stroke};

/// Amplitude of the force over excitation frequency; `None` where no sweep has its force. At a resonance the
/// force of a shaker drops, since the structure moves along with it.
pub fn force(title: &str, responses: &[Response]) -> Option<Figure> {
    let forces = responses.iter().flat_map(|r| &r.points).filter_map(|p| p.force);
    let largest = forces.filter(|force| force.is_finite()).fold(0.0, f64::max);
    // From 0, so that a steady force is a level line and not its own scatter; with room for its markers.
    let y = AxisSpec::new("Force amplitude", "N").limits(0.0, 1.06 * largest);
    let mut plot = Plot::new(AxisSpec::new("Excitation frequency", "Hz"), y);
    for (i, response) in responses.iter().enumerate() {
        let known = response.points.iter().filter_map(|p| Some((p.excitation, p.force?, p.force_std)));
        let points: Vec<(f64, f64, Option<f64>)> = known.filter(|(_, force, _)| force.is_finite()).collect();
        if points.is_empty() {
            continue;
        }
        let (f, force): (Vec<f64>, Vec<f64>) = points.iter().map(|(f, force, _)| (*f, *force)).unzip();
        let std: Vec<f64> = points.iter().map(|(.., std)| std.unwrap_or(0.0)).collect();
        let (marker, ink) = look(response, rank(responses, i));
        let measured = Series::points(response.name.clone(), f, force).y_error(std).ink(ink);
        plot = plot.with(Series { marker, ..measured }.stroke(Stroke::Thin));
    }
    let caption = "Amplitude of the force at the excitation frequency. Bars: one standard uncertainty, where larger than the marker.";
    (!plot.series.is_empty())
        .then(|| Figure::double(format!("Force, {title}")).height(60.0).panel(plot).caption(caption))
}

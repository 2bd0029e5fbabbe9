//! Contact pulses: samples and models, and what the models leave.

use super::response::capital;
use crate::measure::pulse::PulseResult;
use crate::report::{AxisSpec, Figure, Ink, Marker, Plot, Series, Stroke};

/// The pulse with the models fitted to it, and their residuals below; `None` where no record was fitted.
pub fn pulse(title: &str, result: &PulseResult) -> Option<Figure> {
    let picture = result.picture.as_ref()?;
    let (quantity, unit) = (&picture.quantity.0, picture.quantity.1.as_str());
    let start = picture.samples.first().map_or(0.0, |s| s.0);
    let x = || AxisSpec::new("Time", "s");
    let mut above = Plot::new(x(), AxisSpec::new(capital(quantity), unit));
    for (fitted, name, marker) in [(true, "samples", Marker::OpenCircle), (false, "left out", Marker::Cross)]
    {
        let (t, v): (Vec<f64>, Vec<f64>) =
            picture.samples.iter().filter(|s| s.2 == fitted).map(|s| (s.0 - start, s.1)).unzip();
        if !t.is_empty() {
            above = above.with(Series::points(name, t, v).marker(marker).ink(Ink::Grey));
        }
    }
    let mut below = Plot::new(x(), AxisSpec::new("Residual", unit)).legend(crate::report::Legend::Hidden);
    for (i, curve) in picture.curves.iter().enumerate() {
        let stroke = [Stroke::Solid, Stroke::Dashed, Stroke::DashDot][i % 3];
        let shifted = |points: &[(f64, f64)]| -> (Vec<f64>, Vec<f64>) {
            points.iter().map(|p| (p.0 - start, p.1)).unzip()
        };
        let name = match curve.model {
            "kelvin-voigt" => "spring and damper",
            "hertz" => "Hertz",
            _ => "Hunt and Crossley",
        };
        let (t, v) = shifted(&curve.points);
        above = above.with(Series::line(name, t, v).ink(Ink::Nth(i)).stroke(stroke));
        let (t, r) = shifted(&curve.residuals);
        below = below.with(Series::line(name, t, r).ink(Ink::Nth(i)).stroke(stroke));
    }
    Some(
        Figure::double(title)
            .height(110.0)
            .shared_x()
            .panel(above)
            .panel(below)
            .caption("Contact pulse with the models fitted to it, and what they leave; time from the beginning of the figure."),
    )
}

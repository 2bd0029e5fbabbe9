//! Contact pulses: samples and models, and what the models leave.

use super::lettered;
use super::response::capital;
use crate::measure::pulse::PulseResult;
use crate::report::{AxisSpec, Figure, Ink, Marker, Plot, Series, Stroke};

/// Samples from which on single markers would hide the models.
const DENSE: usize = 120;

/// The pulse with the models fitted to it, and their residuals below; `None` where no record was fitted.
pub fn pulse(title: &str, result: &PulseResult) -> Option<Figure> {
    let picture = result.picture.as_ref()?;
    let (quantity, unit) = (&picture.quantity.0, picture.quantity.1.as_str());
    // Time counts from the onset of the contact that was fitted.
    let onset = result.fits.first().and_then(|f| f.parameters.get("onset")).map(|e| e.value);
    let start = onset.or(picture.samples.first().map(|s| s.0)).unwrap_or(0.0);
    let ends = picture.samples.first().zip(picture.samples.last());
    let (from, to) = ends.map_or((0.0, 1.0), |(a, b)| (a.0 - start, b.0 - start));
    let x = || AxisSpec::new("Time after the onset", "s").limits(from, to);
    let mut above = Plot::new(x(), AxisSpec::new(capital(quantity), unit));
    for (fitted, name, marker) in [(true, "samples", Marker::OpenCircle), (false, "left out", Marker::Cross)]
    {
        let (t, v): (Vec<f64>, Vec<f64>) =
            picture.samples.iter().filter(|s| s.2 == fitted).map(|s| (s.0 - start, s.1)).unzip();
        if !t.is_empty() {
            // Markers lie over lines; many samples are a line, under the models, with gaps where samples are left out.
            let series = if fitted && t.len() > DENSE {
                let gaps = |s: &(f64, f64, bool)| (s.0 - start, if s.2 { s.1 } else { f64::NAN });
                let (t, v): (Vec<f64>, Vec<f64>) = picture.samples.iter().map(gaps).unzip();
                Series::line(name, t, v).stroke(Stroke::Solid)
            } else {
                Series::points(name, t, v).marker(marker)
            };
            above = above.with(series.ink(Ink::Grey));
        }
    }
    let mut below = Plot::new(x(), AxisSpec::new("Residual", unit)).legend(crate::report::Legend::Hidden);
    // The answer's model last, over the others.
    for (i, curve) in picture.curves.iter().enumerate().rev() {
        let stroke = if i == 0 { Stroke::Solid } else { Stroke::Thin };
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
        let inside: Vec<(f64, f64)> =
            curve.residuals.iter().copied().filter(|r| (from..=to).contains(&(r.0 - start))).collect();
        let (t, r) = shifted(&inside);
        below = below.with(Series::line(name, t, r).ink(Ink::Nth(i)).stroke(stroke));
    }
    Some(
        lettered(Figure::double(title).height(110.0).shared_x().panel(above).panel(below)).caption(format!(
            "Contact pulse with the models fitted to it (a), and what they leave (b); the contact of spring and damper begins at {start:.6e} s of the record."
        )),
    )
}

//! Contact pulses: samples, fitted models and residuals.

use crate::measure::pulse::{ContactModel, PulseResult};
use crate::report::layout::{lettered, value_axis};
use crate::report::{AxisSpec, Figure, Ink, Marker, Plot, Series, Stroke};
use crate::units::notation::significant;

/// Number of samples from which single markers would hide the models.
const DENSE: usize = 120;

/// The pulse with the models fitted to it, and their residuals below; `None` where no record was fitted.
pub fn pulse(title: &str, result: &PulseResult) -> Option<Figure> {
    let picture = result.picture.as_ref()?;
    let (quantity, unit) = (&picture.quantity.0, picture.quantity.1.as_str());
    // Time counts from the onset of the contact that was fitted.
    let onset = result.fits.first().and_then(|f| f.parameters.get("onset")).map(|e| e.value);
    let onset = onset.filter(|v| v.is_finite());
    let (from, to) = (picture.samples.first()?.0, picture.samples.last()?.0);
    let start = onset.unwrap_or(from);
    let label = if onset.is_some() { "Time after the onset" } else { "Time after the first sample shown" };
    let x = || AxisSpec::new(label, "s").limits(from - start, to - start);
    // Many samples are drawn as a line; the model over it is dashed, so that the line stays visible.
    let dense = picture.samples.iter().filter(|s| s.2).count() > DENSE;
    let rejected = if result.xi.value.is_finite() { "" } else { " (rejected)" };
    let mut above = Plot::new(x(), value_axis(quantity, unit));
    for (fitted, name, marker) in [(true, "samples", Marker::OpenCircle), (false, "left out", Marker::Cross)]
    {
        let (t, v): (Vec<f64>, Vec<f64>) =
            picture.samples.iter().filter(|s| s.2 == fitted).map(|s| (s.0 - start, s.1)).unzip();
        if !t.is_empty() {
            // Markers lie over lines; many samples are a line, under the models, with gaps where samples are
            // left out.
            let series = if fitted && dense {
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
        let stroke = match (i, dense) {
            (0, false) => Some(Stroke::Solid),
            (0, true) => Some(Stroke::Dashed),
            _ => None,
        };
        let shifted = |points: &[(f64, f64)]| -> (Vec<f64>, Vec<f64>) {
            points.iter().map(|p| (p.0 - start, p.1)).unzip()
        };
        let of_linear = if curve.model == ContactModel::KelvinVoigt { rejected } else { "" };
        let name = format!("{}{of_linear}", curve.model.words());
        let (t, v) = shifted(&curve.points);
        above = above.with(Series { stroke, ..Series::line(name, t, v).ink(Ink::Nth(i)) });
        let inside: Vec<(f64, f64)> =
            curve.residuals.iter().copied().filter(|r| (from..=to).contains(&r.0)).collect();
        let (t, r) = shifted(&inside);
        let stroke = (i == 0).then_some(Stroke::Solid);
        below = below.with(Series { stroke, ..Series::line("", t, r).ink(Ink::Nth(i)) });
    }
    let begins = if onset.is_some() { "the contact of spring and damper" } else { "what is shown" };
    let at = significant(start, 4);
    Some(lettered(Figure::double(format!("Pulse, {title}")).height(110.0).shared_x().panel(above).panel(below)).caption(format!(
        "Contact pulse with the models fitted to it (a), and the residuals (b); {begins} begins at {at} s of the record."
    )))
}

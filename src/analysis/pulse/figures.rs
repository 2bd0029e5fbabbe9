//! Contact pulses: samples and models, and what the models leave.

use crate::measure::pulse::{ContactModel, PulseResult};
use crate::report::layout::capital;
use crate::report::layout::lettered;
use crate::report::{AxisSpec, Figure, Ink, Marker, Plot, Series, Stroke};
use crate::units::notation::significant;

/// Samples from which on single markers would hide the models.
const DENSE: usize = 120;

/// The pulse with the models fitted to it, and their residuals below; `None` where no record was fitted.
pub fn pulse(title: &str, result: &PulseResult) -> Option<Figure> {
    let picture = result.picture.as_ref()?;
    let (quantity, unit) = (&picture.quantity.0, picture.quantity.1.as_str());
    // Time counts from the onset of the contact that was fitted.
    let onset = result
        .fits
        .first()
        .and_then(|f| f.parameters.get("onset"))
        .map(|e| e.value)
        .filter(|v| v.is_finite());
    let start = onset.or(picture.samples.first().map(|s| s.0)).unwrap_or(0.0);
    let ends = picture.samples.first().zip(picture.samples.last());
    let (from, to) = ends.map_or((0.0, 1.0), |(a, b)| (a.0 - start, b.0 - start));
    let label = if onset.is_some() { "Time after the onset" } else { "Time after the first sample shown" };
    let x = || AxisSpec::new(label, "s").limits(from, to);
    // A model under the line of many samples must leave that line to be seen.
    let dense = picture.samples.iter().filter(|s| s.2).count() > DENSE;
    let rejected = if result.xi.value.is_finite() { "" } else { " (rejected)" };
    let mut above = Plot::new(x(), AxisSpec::new(capital(quantity), unit));
    for (fitted, name, marker) in [(true, "samples", Marker::OpenCircle), (false, "left out", Marker::Cross)]
    {
        let (t, v): (Vec<f64>, Vec<f64>) =
            picture.samples.iter().filter(|s| s.2 == fitted).map(|s| (s.0 - start, s.1)).unzip();
        if !t.is_empty() {
            // Markers lie over lines; many samples are a line, under the models, with gaps where samples are left out.
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
            (0, false) => Stroke::Solid,
            (0, true) => Stroke::Dashed,
            _ => Stroke::Thin,
        };
        let shifted = |points: &[(f64, f64)]| -> (Vec<f64>, Vec<f64>) {
            points.iter().map(|p| (p.0 - start, p.1)).unzip()
        };
        let name = match curve.model {
            ContactModel::KelvinVoigt => format!("spring and damper{rejected}"),
            ContactModel::Hertz => "Hertz".to_owned(),
            ContactModel::HuntCrossley => "Hunt and Crossley".to_owned(),
        };
        let (t, v) = shifted(&curve.points);
        above = above.with(Series::line(name, t, v).ink(Ink::Nth(i)).stroke(stroke));
        let inside: Vec<(f64, f64)> =
            curve.residuals.iter().copied().filter(|r| (from..=to).contains(&(r.0 - start))).collect();
        let (t, r) = broken(shifted(&inside));
        let stroke = if i == 0 { Stroke::Solid } else { Stroke::Thin };
        below = below.with(Series::line("", t, r).ink(Ink::Nth(i)).stroke(stroke));
    }
    let begins = if onset.is_some() {
        format!("the contact of spring and damper begins at {} s of the record", significant(start, 7))
    } else {
        format!("what is shown begins at {} s of the record; no answer is stated", significant(start, 7))
    };
    Some(lettered(Figure::double(title).height(110.0).shared_x().panel(above).panel(below)).caption(format!(
        "Contact pulse with the models fitted to it (a), and what they leave (b); {begins}."
    )))
}

/// Breaks a line where samples are left out.
fn broken((t, v): (Vec<f64>, Vec<f64>)) -> (Vec<f64>, Vec<f64>) {
    let step = t.windows(2).map(|w| w[1] - w[0]).fold(f64::INFINITY, f64::min);
    let (mut times, mut values): (Vec<f64>, Vec<f64>) = (Vec::new(), Vec::new());
    for (t, v) in t.into_iter().zip(v) {
        if let Some(before) = times.last().filter(|before| t - **before > 1.5 * step) {
            times.push(f64::midpoint(*before, t));
            values.push(f64::NAN);
        }
        times.push(t);
        values.push(v);
    }
    (times, values)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_breaks_where_samples_are_left_out() {
        let (t, v) = broken((vec![0.0, 1.0, 4.0, 5.0], vec![1.0, 2.0, 3.0, 4.0]));
        assert_eq!(t, [0.0, 1.0, 2.5, 4.0, 5.0]);
        assert!(v[2].is_nan() && v[3] == 3.0);
    }
}

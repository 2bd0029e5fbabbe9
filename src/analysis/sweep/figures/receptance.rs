//! Receptance of sweeps: Bode and Nyquist.

use crate::measure::response::{Receptance, Response};
use crate::report::layout::lettered;
use crate::report::{AxisSpec, Figure, Ink, Plot, Series, Stroke};
use num_complex::Complex64;

/// Points of a receptance in the order of frequency.
fn points(response: &Response) -> Vec<(f64, Receptance)> {
    let known = response.points.iter().filter_map(|p| Some((p.excitation, p.receptance?)));
    let mut known: Vec<(f64, Receptance)> = known.collect();
    known.sort_by(|a, b| a.0.total_cmp(&b.0));
    known
}

/// Magnitude (logarithmic) and phase of the receptances over frequency, and their imaginary over their real part; `None` where no
/// sweep has a phase.
pub fn receptance(title: &str, responses: &[Response]) -> Option<Figure> {
    let known: Vec<(&Response, Vec<(f64, Receptance)>)> =
        responses.iter().map(|r| (r, points(r))).filter(|(_, points)| !points.is_empty()).collect();
    if known.is_empty() {
        return None;
    }
    let frequency = || AxisSpec::new("Excitation frequency", "Hz");
    let mut above = Plot::new(frequency(), AxisSpec::new("Receptance", "m/N").log());
    let mut phase = Plot::new(frequency(), AxisSpec::new("Phase", "°").limits(-180.0, 180.0));
    let mut nyquist = Plot::new(AxisSpec::new("Re", "m/N"), AxisSpec::new("Im", "m/N"));
    for (i, (response, points)) in known.iter().enumerate() {
        let ink = Ink::Nth(i);
        let values: Vec<Complex64> = points.iter().map(|(_, r)| Complex64::new(r.re, r.im)).collect();
        let std: Vec<f64> = points.iter().map(|(_, r)| r.std.unwrap_or(0.0)).collect();
        let f: Vec<f64> = points.iter().map(|(f, _)| *f).collect();
        let size: Vec<f64> = values.iter().map(|v| v.norm()).collect();
        let measured = Series::points(response.name.clone(), f.clone(), size).y_error(std);
        above = above.with(measured.ink(ink).stroke(Stroke::Thin));
        let degrees: Vec<f64> = values.iter().map(|v| v.arg().to_degrees()).collect();
        phase = phase.with(Series::points("", f, degrees).ink(ink));
        let (re, im): (Vec<f64>, Vec<f64>) = values.iter().map(|v| (v.re, v.im)).unzip();
        nyquist = nyquist.with(Series::points("", re, im).ink(ink).stroke(Stroke::Thin));
    }
    let caption = "Displacement over force at the excitation frequency, and its course in the complex plane. Bars: one standard \
        uncertainty, where larger than the marker.";
    Some(lettered(
        Figure::double(title).height(170.0).panel(above).panel(phase).panel(nyquist).caption(caption),
    ))
}

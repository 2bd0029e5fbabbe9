//! Receptance of sweeps: Bode and Nyquist.

use super::response::{look, rank};
use crate::measure::response::{Receptance, Response};
use crate::record::sort_by_number;
use crate::report::layout::lettered;
use crate::report::{AxisSpec, Figure, Plot, Series, Stroke};
use num_complex::Complex64;

/// Points of a receptance by rising frequency; a missing value breaks the line at a jump.
fn points(response: &Response) -> Vec<(f64, Receptance)> {
    let measured = response.points.iter().filter_map(|p| Some((p.excitation, p.receptance?)));
    let mut measured: Vec<(f64, Receptance)> = measured.collect();
    sort_by_number(&mut measured, |a| a.0);
    let jumps = |a: f64, b: f64| response.jumps.iter().any(|j| (j.frequency - a) * (j.frequency - b) < 0.0);
    let gap = (f64::NAN, Receptance { re: f64::NAN, im: f64::NAN, std: None });
    let mut broken: Vec<(f64, Receptance)> = Vec::new();
    for point in measured {
        let before = broken.last().copied();
        broken.extend(before.filter(|before| jumps(before.0, point.0)).map(|_| gap));
        broken.push(point);
    }
    broken
}

/// Factor from m/N to µm/N, the unit of both axes of the plane.
const MICRO: f64 = 1e6;
/// Width of a panel over its height.
const ASPECT: f64 = 2.9;

/// Limits of a plane that holds all points, with the same scale on both axes.
fn equal_scales(points: &[(f64, f64)]) -> [(f64, f64); 2] {
    let middle_and_half = |coordinate: fn(&(f64, f64)) -> f64| {
        let ends = points
            .iter()
            .map(coordinate)
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(v), h.max(v)));
        (f64::midpoint(ends.0, ends.1), 0.55 * (ends.1 - ends.0))
    };
    let [(re, right), (im, up)] = [middle_and_half(|p| p.0), middle_and_half(|p| p.1)];
    let half = up.max(right / ASPECT).max(f64::MIN_POSITIVE);
    [(re - ASPECT * half, re + ASPECT * half), (im - half, im + half)]
}

/// Magnitude (logarithmic) and phase of the receptances over frequency, and their imaginary over their real
/// part; `None` where no sweep has a phase.
pub fn receptance(title: &str, responses: &[Response]) -> Option<Figure> {
    let all = responses.iter().enumerate().map(|(i, r)| (r, rank(responses, i), points(r)));
    let with_phase: Vec<(&Response, usize, Vec<_>)> = all.filter(|(.., points)| !points.is_empty()).collect();
    if with_phase.is_empty() {
        return None;
    }
    let frequency = || AxisSpec::new("Excitation frequency", "Hz");
    let mut above = Plot::new(frequency(), AxisSpec::new("Receptance", "m/N").log());
    let mut phase = Plot::new(frequency(), AxisSpec::new("Phase", "°").limits(-180.0, 180.0));
    let plane =
        with_phase.iter().flat_map(|(.., points)| points.iter().map(|(_, r)| (MICRO * r.re, MICRO * r.im)));
    let [re, im] = equal_scales(&plane.collect::<Vec<_>>());
    let mut nyquist = Plot::new(
        AxisSpec::new("Re", "µm/N").limits(re.0, re.1),
        AxisSpec::new("Im", "µm/N").limits(im.0, im.1),
    );
    for (response, rank, points) in &with_phase {
        let (marker, ink) = look(response, *rank);
        let marked = |series: Series| Series { marker, ..series.ink(ink) };
        let values: Vec<Complex64> = points.iter().map(|(_, r)| Complex64::new(r.re, r.im)).collect();
        let std: Vec<f64> = points.iter().map(|(_, r)| r.std.unwrap_or(0.0)).collect();
        let f: Vec<f64> = points.iter().map(|(f, _)| *f).collect();
        let size: Vec<f64> = values.iter().map(|v| v.norm()).collect();
        let measured = Series::points(response.name.clone(), f.clone(), size).y_error(std);
        above = above.with(marked(measured).stroke(Stroke::Thin));
        let degrees: Vec<f64> = values.iter().map(|v| v.arg().to_degrees()).collect();
        phase = phase.with(marked(Series::points("", f, degrees)));
        let (re, im): (Vec<f64>, Vec<f64>) = values.iter().map(|v| (MICRO * v.re, MICRO * v.im)).unzip();
        nyquist = nyquist.with(marked(Series::points("", re, im)).stroke(Stroke::Thin));
    }
    let caption = "Displacement over force at the excitation frequency, and its course in the complex plane. Bars: one standard \
        uncertainty, where larger than the marker.";
    Some(lettered(
        Figure::double(format!("Receptance, {title}"))
            .height(220.0)
            .panel(above)
            .panel(phase)
            .panel(nyquist)
            .caption(caption),
    ))
}

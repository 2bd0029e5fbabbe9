//! Response curves: every mass and direction, with uncertainties and named resonances.

use crate::measure::jump::Jump;
use crate::measure::resonance::{Resonance, ResonanceKind};
use crate::measure::response::Response;
use crate::record::Direction;
use crate::report::layout::{capital, lettered};
use crate::report::{AxisSpec, Figure, Ink, Marker, Plot, Series, Stroke};

/// Amplitude over excitation frequency, linear above and logarithmic below.
pub fn response(title: &str, responses: &[Response]) -> Figure {
    let mut linear = plot(responses, false);
    let factor = responses.first().map_or(1.0, |r| shown(r.unit).0);
    for (text, f, a) in names(responses) {
        linear = linear.note(text, f, factor * a);
    }
    let figure = Figure::double(format!("Response, {title}"))
        .height(160.0)
        .shared_x()
        .panel(linear)
        .panel(plot(responses, true).again());
    lettered(figure.caption(format!("Amplitude at the excitation frequency. {MARKS}")))
}

/// Amplitude of all sweeps over excitation frequency, on a linear or logarithmic axis.
fn plot(responses: &[Response], log: bool) -> Plot {
    let first = responses.first();
    let quantity = first.map_or("Amplitude", |r| r.quantity);
    let label = format!("{} amplitude", capital(quantity));
    let (factor, unit) = first.map_or((1.0, ""), |r| shown(r.unit));
    let y = AxisSpec::new(label, unit);
    let x = AxisSpec::new("Excitation frequency", "Hz");
    let limits = log_limits(responses.iter()).map(|(low, high)| (low * factor, high * factor));
    let y = match limits {
        Some((low, high)) if log => y.log().limits(low, high),
        // Room for markers at zero.
        Some((_, high)) => y.limits(-0.03 * high, f64::NAN),
        None => y,
    };
    let mut plot = Plot::new(x, y);
    for (i, response) in responses.iter().enumerate() {
        let rank_here = rank(responses, i);
        let same = |(k, r): &(usize, &Response)| {
            r.direction == response.direction && rank(responses, *k) == rank_here
        };
        let jumps: Vec<&Jump> =
            responses.iter().enumerate().filter(same).flat_map(|(_, r)| &r.jumps).collect();
        let [measured, faint] = series(response, rank_here, &jumps, limits.filter(|_| log));
        plot = plot.with(faint).with(measured.stroke(Stroke::Thin));
    }
    plot
}

/// Caption below figures of measured points.
pub(super) const MARKS: &str = "Bars: one standard uncertainty, where larger than the marker. \
    Downward triangles: upper limits of amplitudes below the noise; at the lower edge, the limit is off the scale.";

/// Limits of a logarithmic axis that shows all points above the noise floor with their uncertainties, the
/// lower ends down to a quarter of the amplitude. Without such points, limits that show the upper limits.
pub(super) fn log_limits<'a>(responses: impl Iterator<Item = &'a Response>) -> Option<(f64, f64)> {
    let (mut above_noise, mut upper_limits) = (Vec::new(), Vec::new());
    for point in responses.flat_map(|r| &r.points) {
        if let Some(limit) = point.upper_limit {
            upper_limits.push(limit);
        } else {
            let (a, std) = (point.amplitude.value, point.amplitude.std.unwrap_or(0.0));
            above_noise.extend([(a - std).max(a / 4.0), a + std]);
        }
    }
    let all = if above_noise.is_empty() { upper_limits } else { above_noise };
    let all = all.into_iter().filter(|a| *a > 0.0);
    let (low, high) = all.fold((f64::INFINITY, 0.0f64), |(l, h), a| (l.min(a), h.max(a)));
    (low <= high).then_some((low / 2.0, high * 2.0))
}

/// Number of earlier sweeps of the same mass and direction: usually the index of the level of force.
pub(super) fn rank(responses: &[Response], i: usize) -> usize {
    let kind = |r: &Response| (r.mass, r.direction);
    let earlier = responses.iter().take(i);
    responses.get(i).map_or(0, |sweep| earlier.filter(|r| kind(r) == kind(sweep)).count())
}

/// Measured points and upper limits of one curve. Its colour is by mass and `rank`, its marker by mass
/// (circles or squares) and direction (filled or open). The line is broken at `jumps` of either mass and at
/// points below the noise floor. Upper limits below a logarithmic `axis` are drawn at its lower edge.
pub(super) fn series(
    response: &Response,
    rank: usize,
    jumps: &[&Jump],
    axis: Option<(f64, f64)>,
) -> [Series; 2] {
    let (mut x, mut y, mut std) = (Vec::new(), Vec::new(), Vec::new());
    let (mut limit_frequencies, mut limits) = (Vec::new(), Vec::new());
    let (factor, _) = shown(response.unit);
    // Centre of a triangle that stands on the lower edge, 2 % up the axis.
    let edge = axis.map_or(0.0, |(low, high)| low * (high / low).powf(0.02));
    for (i, point) in response.points.iter().enumerate() {
        let limit = point.upper_limit;
        if let Some(limit) = limit {
            limit_frequencies.push(point.excitation);
            limits.push((factor * limit).max(edge));
        }
        x.push(point.excitation);
        y.push(if limit.is_some() { f64::NAN } else { factor * point.amplitude.value });
        std.push(factor * point.amplitude.std.unwrap_or(0.0));
        let next = response.points.get(i + 1).map_or(f64::NAN, |p| p.excitation);
        let between = |f: f64| (f - point.excitation) * (f - next) < 0.0;
        if jumps.iter().any(|j| between(j.frequency)) {
            x.push(f64::NAN);
            y.push(f64::NAN);
            std.push(0.0);
        }
    }
    let (marker, ink) = look(response, rank);
    let measured = Series { marker, ..Series::points(response.name.clone(), x, y).y_error(std) };
    let limits = Series::points("", limit_frequencies, limits).marker(Marker::Limit);
    [measured, limits].map(|series| series.ink(ink))
}

/// Marker and colour of a sweep, the same in all figures; without a known mass the marker goes with the
/// colour.
pub(super) fn look(response: &Response, rank: usize) -> (Option<Marker>, Ink) {
    let down = response.direction == Some(Direction::Down);
    let marker = match (response.mass, down) {
        (Some(2), false) => Some(Marker::FilledSquare),
        (Some(2), true) => Some(Marker::Square),
        (Some(_), false) => Some(Marker::Circle),
        (_, true) => Some(Marker::OpenCircle),
        (None, false) => None,
    };
    (marker, Ink::Nth(response.mass.map_or(rank, |mass| 2 * rank + usize::from(mass.saturating_sub(1)))))
}

/// The unit in which motion is shown, and the factor from SI: the same on every axis.
pub(super) fn shown(unit: &str) -> (f64, &str) {
    match unit {
        "m" => (1e3, "mm"),
        "m/s" => (1e3, "mm/s"),
        other => (1.0, other),
    }
}

/// Names of resonances, each at its largest amplitude; one name where both directions agree.
fn names(responses: &[Response]) -> Vec<(String, f64, f64)> {
    let mut found: Vec<(String, Vec<&str>, f64, f64)> = Vec::new();
    for response in responses {
        let Some(direction) = response.direction.map(Direction::name) else { continue };
        let is_labelled = |r: &&Resonance| matches!(r.kind, ResonanceKind::Grazing | ResonanceKind::Clapping);
        for r in response.resonances.iter().filter(is_labelled) {
            let text = format!("{} {:.2} Hz", r.kind.name(), r.frequency);
            let Some(known) = found.iter_mut().find(|f| f.0 == text) else {
                found.push((text, vec![direction], r.frequency, r.amplitude));
                continue;
            };
            if !known.1.contains(&direction) {
                known.1.push(direction);
            }
            if known.3 < r.amplitude {
                (known.2, known.3) = (r.frequency, r.amplitude);
            }
        }
    }
    let name = |(text, directions, f, a): (String, Vec<&str>, _, _)| {
        (format!("{text}, {}", directions.join(" and ")), f, a)
    };
    found.into_iter().map(name).collect()
}

//! Speed against accuracy.

use crate::compare::precision::{Family, Measured, Scene};
use crate::report::{AxisSpec, Figure, Ink, Legend, Marker, Plot, Series, Stroke};

/// Markers in turn.
const MARKERS: [Marker; 6] = [
    Marker::Circle,
    Marker::Square,
    Marker::Triangle,
    Marker::Diamond,
    Marker::FilledSquare,
    Marker::OpenCircle,
];

/// Room of a row of crosses in parts of the decades of the errors.
const ROW: f64 = 0.05;

/// Error over time of every method of a scene, one line a method through its settings; what failed stands as crosses at the
/// upper edge, each method in a row of its own and with its name beside the frame.
pub fn precision(scene: &Scene) -> Figure {
    let errors = scene.methods.iter().filter_map(error).chain(scene.bound);
    let (low, high) = errors.fold((f64::INFINITY, 0.0_f64), |(low, high), e| (low.min(e), high.max(e)));
    let (low, high) = if low <= high { (low, high) } else { (1e-3, 1.0) };
    let floor = 10f64.powf((0.7 * low).log10().floor());
    let top = high.log10().ceil();
    let lines = lines(scene);
    let failing = lines.iter().filter(|l| l.1.iter().any(|m| error(m).is_none())).count() as f64;
    let row = ROW * (top - floor.log10()).max(1.0);
    let edge = 10f64.powf(top + row * failing);
    let times = scene.methods.iter().map(|m| 1e-9 * m.time_ns);
    let (first, last) = times.fold((f64::INFINITY, 0.0_f64), |(low, high), t| (low.min(t), high.max(t)));
    let (first, last) = (0.6 * first, 1.7 * last);
    let (first, last) = if first < last { (first, last) } else { (1e-6, 1.0) };
    let label = if scene.error_of.is_empty() { "Error" } else { &scene.error_of };
    let mut plot = Plot::new(
        AxisSpec::new("Time of one answer", "s").log().limits(first, last),
        AxisSpec::new(capital(label), "").log().limits(floor, edge),
    )
    .legend(Legend::Right);
    if let Some(bound) = scene.bound {
        plot = plot.with(Series::horizontal("Cramér–Rao bound", bound));
    }
    let front = stairs(scene, edge, last);
    if !front.0.is_empty() {
        plot =
            plot.with(Series::line("Pareto front", front.0, front.1).ink(Ink::Grey).stroke(Stroke::Dotted));
    }
    // This library's methods are black, the others coloured: six colours, and another form when they come round.
    let (mut own, mut others) = (0, 0);
    let mut crosses = Vec::new();
    for (name, methods) in lines {
        let ours = methods.iter().any(|m| m.ours);
        let (ink, marker, stroke) = if ours {
            own += 1;
            (Ink::Black, MARKERS[(own - 1) % MARKERS.len()], Stroke::Solid)
        } else {
            others += 1;
            let turn = others - 1;
            (Ink::Nth(turn % 6), MARKERS[(turn + 1 + turn / 6) % MARKERS.len()], Stroke::Thin)
        };
        let (x, y): (Vec<f64>, Vec<f64>) =
            methods.iter().filter_map(|m| Some((1e-9 * m.time_ns, error(m)?))).unzip();
        if !x.is_empty() {
            plot = plot.with(Series::points(name, x, y).ink(ink).marker(marker).stroke(stroke));
        }
        let x: Vec<f64> = methods.iter().filter(|m| error(m).is_none()).map(|m| 1e-9 * m.time_ns).collect();
        if !x.is_empty() {
            let place = 10f64.powf(top + row * (crosses.len() as f64 + 0.5));
            let y = vec![place; x.len()];
            crosses.push(Series::points(format!("× {name}"), x, y).ink(ink).marker(Marker::Cross));
        }
    }
    // The legend names them from above as they stand.
    for series in crosses.into_iter().rev() {
        plot = plot.with(series);
    }
    let bound = if scene.bound.is_some() { " Level line: Cramér–Rao bound." } else { "" };
    let kind = match scene.family {
        Family::Models => "model",
        Family::Estimators => "estimator",
    };
    Figure::double(format!("Speed against accuracy: {}", scene.name)).height(95.0).panel(plot).caption(format!(
        "{} Each line is a {kind}, each point one of its settings, black those of this library: lower is more accurate, further left is faster. Dotted: nothing \
         lies below and left of it. Crosses at the upper edge gave no answer, each method in a row of its own, from above as in the list. Truth: {}.{bound}",
        scene.says, scene.truth
    ))
}

/// Error that can be drawn: an answer without any counts as rounding.
fn error(m: &Measured) -> Option<f64> {
    m.error.filter(|e| !m.failed && e.is_finite()).map(|e| e.abs().max(1e-17))
}

/// The methods with their settings, in their order.
fn lines(scene: &Scene) -> Vec<(&str, Vec<&Measured>)> {
    let mut lines: Vec<(&str, Vec<&Measured>)> = Vec::new();
    for m in &scene.methods {
        match lines.iter_mut().find(|l| l.0 == m.method) {
            Some(line) => line.1.push(m),
            None => lines.push((&m.method, vec![m])),
        }
    }
    lines
}

/// The border of what has been reached: down from the upper edge at the fastest, along to the most accurate, and on.
fn stairs(scene: &Scene, edge: f64, last: f64) -> (Vec<f64>, Vec<f64>) {
    let mut front: Vec<(f64, f64)> = scene
        .methods
        .iter()
        .filter(|m| m.front)
        .filter_map(|m| Some((1e-9 * m.time_ns, error(m)?)))
        .collect();
    front.sort_by(|a, b| a.0.total_cmp(&b.0));
    let (mut x, mut y, mut above) = (Vec::new(), Vec::new(), edge);
    for (time, error) in front {
        x.extend([time, time]);
        y.extend([above, error]);
        above = error;
    }
    if !x.is_empty() {
        x.push(last);
        y.push(above);
    }
    (x, y)
}

fn capital(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or_else(String::new, |first| first.to_uppercase().chain(letters).collect())
}

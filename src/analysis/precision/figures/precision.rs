//! Speed against accuracy.

use crate::compare::precision::{Family, Measured, Scene};
use crate::report::layout::capital;
use crate::report::{AxisSpec, Figure, Ink, Legend, Marker, Plot, Series, Stroke};
use crate::units::notation::typeset;

/// Markers in turn.
const MARKERS: [Marker; 6] = [
    Marker::Circle,
    Marker::Square,
    Marker::Triangle,
    Marker::Diamond,
    Marker::FilledSquare,
    Marker::OpenCircle,
];

/// Crosses of what failed, in turn.
const CROSSES: [Marker; 3] = [Marker::Cross, Marker::Saltire, Marker::Star];

/// Room of a row of crosses in parts of the decades of the errors.
const ROW: f64 = 0.05;

/// What of the plane is seen, and the rows of crosses over it.
struct View {
    times: [f64; 2],
    floor: f64,
    /// The decade from which the rows begin.
    top: f64,
    /// Height of a row in decades.
    row: f64,
    edge: f64,
}

impl View {
    fn of(scene: &Scene, lines: &[(&str, Vec<&Measured>)]) -> View {
        let span = |values: &mut dyn Iterator<Item = f64>, none: [f64; 2]| {
            let (low, high) =
                values.fold((f64::INFINITY, 0.0_f64), |(low, high), v| (low.min(v), high.max(v)));
            if low <= high { [low, high] } else { none }
        };
        let errors = span(&mut scene.methods.iter().filter_map(error).chain(scene.bound), [1e-3, 1.0]);
        let [first, last] = span(&mut scene.methods.iter().map(|m| 1e-9 * m.time_ns), [1e-6, 1.0]);
        let floor = (0.7 * errors[0]).log10().floor();
        let top = errors[1].log10().ceil();
        let row = ROW * (top - floor).max(1.0);
        let failing = lines.iter().filter(|l| l.1.iter().any(|m| error(m).is_none())).count() as f64;
        let (floor, edge) = (10f64.powf(floor), 10f64.powf(top + row * failing));
        View { times: [0.6 * first, 1.7 * last], floor, top, row, edge }
    }

    /// Place of the crosses of the `nth` method that failed, from below.
    fn crosses(&self, nth: usize) -> f64 {
        10f64.powf(self.top + self.row * (nth as f64 + 0.5))
    }

    /// Whether two points are so close that they share their letters.
    fn shares(&self, (x, y): (f64, f64), other: (f64, f64)) -> bool {
        let parts = |a: f64, b: f64, [low, high]: [f64; 2]| (a / b).log10().abs() / (high / low).log10();
        parts(x, other.0, self.times) < SHARED[0] && parts(y, other.1, [self.floor, self.edge]) < SHARED[1]
    }
}

/// Error over time of every method of a scene, one line a method; what failed stands as crosses at the upper edge, each method in a
/// row of its own. Points of models are their settings; those of estimators are kinds of records, which letters name.
pub fn precision(scene: &Scene) -> Figure {
    let lines = lines(scene);
    let view = View::of(scene, &lines);
    let [first, last] = view.times;
    let label = if scene.error_of.is_empty() { "Error" } else { &scene.error_of };
    let mut plot = Plot::new(
        AxisSpec::new("Time of one answer", "s").log().limits(first, last),
        AxisSpec::new(capital(label), "").log().limits(view.floor, view.edge),
    )
    .legend(Legend::Right);
    if let Some(bound) = scene.bound {
        plot = plot.with(Series::horizontal("Cramér–Rao bound", bound));
    }
    if scene.family == Family::Models {
        let front = stairs(scene, view.edge, last);
        if !front.0.is_empty() {
            plot = plot
                .with(Series::line("Pareto front", front.0, front.1).ink(Ink::Grey).stroke(Stroke::Dotted));
        }
    }
    // This library's methods are black, the others coloured: six colours, and another form when they come round.
    let (mut own, mut others) = (0, 0);
    let (mut crosses, mut named) = (Vec::new(), Vec::new());
    for (name, methods) in lines {
        let ours = methods.iter().any(|m| m.ours);
        let (ink, marker, cross, stroke) = if ours {
            own += 1;
            let turn = own - 1;
            (Ink::Black, MARKERS[turn % MARKERS.len()], CROSSES[turn % CROSSES.len()], Stroke::Solid)
        } else {
            let nth = |list: &[&str]| list.iter().position(|known| *known == name);
            let turn = nth(&OFTEN).or_else(|| Some(TURNS - 1 - nth(&OPTIONAL)?)).unwrap_or_else(|| {
                others += 1;
                OFTEN.len() + others - 1
            });
            let round = turn / 6;
            (
                Ink::Nth(turn % 6),
                MARKERS[(turn + 1 + round) % MARKERS.len()],
                CROSSES[round % CROSSES.len()],
                Stroke::Thin,
            )
        };
        let row = view.crosses(crosses.len());
        let place = |m: &&Measured| (1e-9 * m.time_ns, error(m).unwrap_or(row));
        let (failed, reached): (Vec<&Measured>, Vec<_>) = methods.iter().partition(|m| error(m).is_none());
        if !reached.is_empty() {
            let (x, y): (Vec<f64>, Vec<f64>) = reached.iter().map(place).unzip();
            plot = plot.with(Series::points(name, x, y).ink(ink).marker(marker).stroke(stroke));
        }
        if !failed.is_empty() {
            let (x, y): (Vec<f64>, Vec<f64>) = failed.iter().map(place).unzip();
            crosses.push(Series::points(format!("{name}: failed"), x, y).ink(ink).marker(cross));
        }
        named.push(methods.into_iter().map(|m| (place(&m), m)).collect());
    }
    if !crosses.is_empty() {
        plot = plot.with(Series::horizontal("above: failed", 10f64.powf(view.top)));
    }
    // The legend names them from above as they stand.
    for series in crosses.into_iter().rev() {
        plot = plot.with(series);
    }
    let (points, front) = match scene.family {
        Family::Models => {
            ("a model, each point one of its settings", "Dotted: nothing lies below and left of it.")
        }
        Family::Estimators => {
            plot = lettered(plot, scene, &view, named);
            (
                "an estimator, each point a kind of record, named by its letter",
                "Capital letters: no other is both faster and more accurate on the same records.",
            )
        }
    };
    let bound = if scene.bound.is_some() { " Level line: Cramér–Rao bound." } else { "" };
    Figure::double(format!("Speed against accuracy: {}", typeset(&scene.name))).height(95.0).panel(plot).caption(format!(
        "{} Each line is {points}, black those of this library: lower is more accurate, further left is faster. {front} Crosses at the upper edge \
         have failed, each method in a row of its own, from above as in the list. Truth: {}.{bound}",
        scene.says, scene.truth
    ))
}

/// Methods of other kinds that stand in several charts: each has one colour and form in all of them.
const OFTEN: [&str; 8] = [
    "Euler loop",
    "RK4 loop",
    "Moreau time stepping",
    "RK4, sign test",
    "RK45, sign test",
    "RK45, dense events",
    "DOP853, dense events",
    "stiff spring, RK45",
];

/// Methods that only some builds have: their colours and forms are the last ones, so that no other method has different ones without
/// them.
const OPTIONAL: [&str; 2] = ["diffsol TSIT45, sign test", "diffsol BDF, sign test"];

/// Pairs of a colour and a form.
const TURNS: usize = 6 * MARKERS.len();

/// Distance within which points of a line share their letters, in parts of the width and of the height.
const SHARED: [f64; 2] = [0.025, 0.03];

/// Names the record of each point by a letter, a capital on the front of that record.
fn lettered(mut plot: Plot, scene: &Scene, view: &View, lines: Vec<Vec<((f64, f64), &Measured)>>) -> Plot {
    let mut records: Vec<&str> = Vec::new();
    for m in &scene.methods {
        if !records.contains(&m.setting.as_str()) {
            records.push(&m.setting);
        }
    }
    if !(2..=26).contains(&records.len()) {
        return plot;
    }
    let letter = |m: &Measured| {
        let place = records.iter().position(|r| *r == m.setting).unwrap_or_default();
        char::from(if m.front { b'A' } else { b'a' } + place as u8)
    };
    for line in lines {
        let mut named: Vec<((f64, f64), String)> = Vec::new();
        for (at, m) in line {
            match named.iter_mut().find(|n| view.shares(at, n.0)) {
                Some(there) => there.1.push(letter(m)),
                None => named.push((at, letter(m).to_string())),
            }
        }
        for ((time, error), letters) in named {
            plot = plot.note(letters, time, error);
        }
    }
    let entry = |letter: u8, says: &str| {
        Series::points(typeset(says), [], []).marker(Marker::Letter(letter.into())).ink(Ink::Black)
    };
    for (letter, record) in (b'a'..).zip(&records) {
        plot = plot.with(entry(letter, record));
    }
    plot.with(entry(b'A', "capital: Pareto front"))
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::{Panel, Shape};

    fn measured(method: &str, setting: &str, error: Option<f64>, front: bool) -> Measured {
        Measured {
            method: method.into(),
            setting: setting.into(),
            ours: false,
            error,
            error_spread: None,
            time_ns: 1e3,
            time_spread: None,
            failed: error.is_none(),
            why: None,
            front,
        }
    }

    fn scene(family: Family, methods: Vec<Measured>) -> Scene {
        Scene {
            name: "scene".into(),
            family,
            says: "A scene.".into(),
            error_of: "error".into(),
            truth: "known".into(),
            bound: None,
            methods,
        }
    }

    fn plot(family: Family) -> Plot {
        let methods = vec![
            measured("one", "0 dB", Some(1e-2), true),
            measured("one", "20 dB", Some(1.001e-2), false),
            measured("one", "40 dB", Some(1e-6), true),
            measured("other", "20 dB", None, false),
        ];
        match precision(&scene(family, methods)).panels.remove(0) {
            Panel::Plot(plot) => plot,
            _ => panic!("a plot"),
        }
    }

    #[test]
    fn letters_name_the_records_of_estimators_together_where_they_meet() {
        let plot = plot(Family::Estimators);
        let notes: Vec<&str> = plot.notes.iter().map(|n| n.text.as_str()).collect();
        assert_eq!(notes, ["Ab", "C", "b"]);
        let names: Vec<&str> = plot.series.iter().map(|s| s.name.as_str()).collect();
        let list =
            ["one", "above: failed", "other: failed", "0 dB", "20 dB", "40 dB", "capital: Pareto front"];
        assert_eq!(names, list);
    }

    #[test]
    fn models_have_their_front_as_a_line() {
        let plot = plot(Family::Models);
        assert!(plot.notes.is_empty());
        assert!(plot.series.iter().any(|s| s.name == "Pareto front"));
    }

    /// Colour and form of the crosses of each method that failed.
    fn crosses(methods: &[(&str, bool)]) -> Vec<(Ink, Option<Marker>)> {
        let failing = |&(name, ours): &(&str, bool)| Measured { ours, ..measured(name, "", None, false) };
        let methods = methods.iter().map(failing).collect();
        let Panel::Plot(plot) = precision(&scene(Family::Models, methods)).panels.remove(0) else {
            panic!("a plot")
        };
        let form = |s: &Series| (s.shape == Shape::Points).then_some((s.ink, s.marker));
        plot.series.iter().filter_map(form).collect()
    }

    /// As many as a chart may have: all that stand in several charts, four of its own, two added, two of ours.
    #[test]
    fn what_failed_is_told_apart() {
        let own = [("exact", true), ("closed form", true)];
        let here = ["one", "two", "three", "four", "added", "added, too"].map(|name| (name, false));
        let methods: Vec<_> = OFTEN.map(|name| (name, false)).into_iter().chain(own).chain(here).collect();
        let found = crosses(&methods);
        assert_eq!(found.len(), methods.len());
        let twice = |i: usize| found[..i].contains(&found[i]);
        assert!(!(0..found.len()).any(twice), "{found:?}");
    }

    #[test]
    fn crosses_stand_above_all_errors() {
        let plot = plot(Family::Models);
        let heights = |name: &str| plot.series.iter().rfind(|s| s.name == name).unwrap().y.clone();
        assert!(heights("other: failed")[0] > 1e-2, "{:?}", heights("other: failed"));
        assert!(heights("one").iter().all(|y| *y < heights("other: failed")[0]));
    }
}

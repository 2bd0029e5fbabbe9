//! Speed against accuracy.

use crate::figure::Shape;
use crate::precision::{BenchmarkScene, Family, MeasuredMethod};
use crate::record::sort_by_number;
use crate::report::layout::capital;
use crate::report::{AxisSpec, Figure, Ink, Legend, Marker, Plot, Series, Stroke};
use crate::units::notation::typeset;

/// Markers of methods, in turn.
const MARKERS: [Marker; 6] = {
    use Marker::{Circle, Diamond, FilledSquare, OpenCircle, Square, Triangle};
    [Circle, Square, Triangle, Diamond, FilledSquare, OpenCircle]
};

/// Crosses of failed methods, in turn.
const CROSSES: [Marker; 3] = [Marker::Cross, Marker::Saltire, Marker::Star];

/// Methods not of this library that appear in several charts, with the same colour and marker in all. The
/// last ones exist only in some builds.
const RECURRING: [&str; 10] = [
    "Euler loop",
    "RK4 loop",
    "Moreau time stepping",
    "RK4, sign test",
    "RK45, sign test",
    "RK45, dense events",
    "DOP853, dense events",
    "stiff spring, RK45",
    "diffsol TSIT45, sign test",
    "diffsol BDF, sign test",
];

/// Groups of methods by the origin of their code: headings in the legend.
const GROUPS: [&str; 3] = ["Methods of vibro", "Common methods, coded in vibro", "Other programs"];

/// Index of the group of a method in [`GROUPS`].
pub fn group(m: &MeasuredMethod) -> usize {
    match m {
        MeasuredMethod { ours: true, .. } => 0,
        MeasuredMethod { other_program: false, .. } => 1,
        _ => 2,
    }
}

/// Height of a row of crosses, as a share of the decades that the errors span.
const ROW_HEIGHT: f64 = 0.05;

/// Distance within which points of a line share their letters, as a share of the width and height of the
/// chart.
const SAME_PLACE: [f64; 2] = [0.025, 0.03];

/// Visible part of the plane: decades of time in s and of the error, and above them a row of crosses for
/// each method that failed.
struct View {
    times: [f64; 2],
    /// Lower and upper limit of the errors.
    floor: f64,
    top: f64,
    /// Height of a row of crosses.
    row: f64,
    /// Upper edge, above all rows.
    edge: f64,
}

impl View {
    /// The view that holds all points of a scene, with rows for `failing` methods.
    fn of(scene: &BenchmarkScene, failing: usize) -> View {
        let span = |values: &mut dyn Iterator<Item = f64>, none: [f64; 2]| {
            let (low, high) = values
                .map(f64::log10)
                .fold((f64::INFINITY, f64::NEG_INFINITY), |s, v| (s.0.min(v), s.1.max(v)));
            if low <= high { [low, high] } else { none }
        };
        let errors = span(&mut scene.methods.iter().filter_map(error).chain(scene.bound), [-3.0, 0.0]);
        let [first, last] = span(&mut scene.methods.iter().map(seconds), [-6.0, 0.0]);
        let (floor, top) = ((errors[0] - 0.15).floor(), errors[1].ceil());
        let row = ROW_HEIGHT * (top - floor).max(1.0);
        View { times: [first - 0.22, last + 0.23], floor, top, row, edge: top + row * failing as f64 }
    }

    /// Whether two points are so close that they share their letters.
    fn shares(&self, a: (f64, f64), b: (f64, f64)) -> bool {
        let near = |a: f64, b: f64, span: f64, part: f64| (a / b).log10().abs() < part * span;
        near(a.0, b.0, self.times[1] - self.times[0], SAME_PLACE[0])
            && near(a.1, b.1, self.edge - self.floor, SAME_PLACE[1])
    }
}

/// Error over time of every method of a scene, one line a method. Failed answers are crosses at the upper
/// edge, each method in a row of its own. The points of models are settings; those of estimators are kinds
/// of records, named by letters.
pub fn chart(scene: &BenchmarkScene) -> Figure {
    let mut lines: Vec<&[MeasuredMethod]> = scene.methods.chunk_by(|a, b| a.method == b.method).collect();
    lines.sort_by_key(|line| group(&line[0]));
    let view = View::of(scene, lines.iter().filter(|l| l.iter().any(|m| error(m).is_none())).count());
    let power = |decades: f64| 10f64.powf(decades);
    let [first, last] = view.times.map(power);
    let label = if scene.error_of.is_empty() { "Error" } else { &scene.error_of };
    let mut plot = Plot::new(
        AxisSpec::new("Time of one answer", "s").log().limits(first, last),
        AxisSpec::new(capital(label), "").log().limits(power(view.floor), power(view.edge)),
    )
    .legend(Legend::Right);
    if let Some(bound) = scene.bound {
        plot = plot.with(Series::horizontal("Cramér–Rao bound", bound));
    }
    if scene.family == Family::Models && scene.methods.iter().any(|m| m.front) {
        let (x, y) = stairs(scene, power(view.edge), last);
        plot = plot.with(Series::line("Pareto front", x, y).ink(Ink::Grey).stroke(Stroke::Dotted));
    }
    let (mut ours_count, mut others) = (0, RECURRING.len());
    let (mut crosses, mut named) = (Vec::new(), Vec::new());
    let mut last_group = None;
    for line in lines {
        let group = group(&line[0]);
        if last_group.replace(group) != Some(group) {
            let has_tolerances = group == 2 && scene.methods.iter().any(|m| tolerance(m).is_some());
            let with = if has_tolerances { ", with tolerances" } else { "" };
            plot = plot.with(Series::heading(format!("{}{with}", GROUPS[group])));
        }
        let name = line[0].method.as_str();
        let recurring = RECURRING.iter().position(|known| *known == name);
        let count = if line[0].ours { &mut ours_count } else { &mut others };
        let number = recurring.unwrap_or(*count);
        *count += usize::from(recurring.is_none());
        let LineStyle { ink, marker, cross, stroke } = LineStyle::of(&line[0], number);
        let row = power(view.top + view.row * (crosses.len() as f64 + 0.5));
        let place = |m: &MeasuredMethod| (seconds(m), error(m).unwrap_or(row));
        let points = |name: String, failed: bool| {
            let members = line.iter().filter(|m| error(m).is_none() == failed);
            let (x, y): (Vec<f64>, Vec<f64>) = members.map(place).unzip();
            (!x.is_empty()).then(|| Series::points(name, x, y).ink(ink))
        };
        if let Some(reached) = points(name.to_owned(), false) {
            plot = plot.with(reached.marker(marker).stroke(stroke));
        }
        let failed = points(format!("{name}: failed"), true);
        crosses.extend(failed.map(|f| f.marker(cross)));
        named.push(line.iter().map(|m| (place(m), m)).collect());
    }
    if !crosses.is_empty() {
        plot =
            plot.with(Series::horizontal("above: failed", power(view.top))).with(Series::heading("Failed"));
    }
    // The legend lists the rows of crosses from the top.
    plot = crosses.into_iter().rev().fold(plot, Plot::with);
    let plot = match scene.family {
        Family::Models => with_tolerances(plot, named),
        Family::Estimators => with_letters(plot, scene, &view, named),
    };
    // Room for all names beside the frame.
    let names = plot.series.iter().filter(|s| s.shape != Shape::Horizontal).count();
    let height = (3.9 * names as f64 + 8.0).max(95.0);
    let figure = Figure::double(format!("Speed against accuracy: {}", typeset(&scene.name)));
    figure.height(height).panel(plot).caption(caption(scene))
}

/// How the points and the line of a method are drawn.
struct LineStyle {
    ink: Ink,
    marker: Marker,
    /// Marker of failed answers.
    cross: Marker,
    stroke: Stroke,
}

impl LineStyle {
    /// Methods of this library are black, others coloured, other programs dashed. After six colours the
    /// marker changes.
    fn of(method: &MeasuredMethod, number: usize) -> LineStyle {
        let round = number / 6;
        let (ink, marker, cross, stroke) = if method.ours {
            (Ink::Black, number, number, Stroke::Solid)
        } else {
            let stroke = if method.other_program { Stroke::Dashed } else { Stroke::Thin };
            (Ink::Nth(number % 6), number + 1 + round, round, stroke)
        };
        let (marker, cross) = (MARKERS[marker % MARKERS.len()], CROSSES[cross % CROSSES.len()]);
        LineStyle { ink, marker, cross, stroke }
    }
}

/// Caption: the meaning of lines, letters and crosses.
fn caption(scene: &BenchmarkScene) -> String {
    let (points, front) = match scene.family {
        Family::Models => (
            "a model, each point one of its settings",
            "Dotted: nothing lies below and left of it. Numbers: tolerances of other programs.",
        ),
        Family::Estimators => (
            "an estimator, each point a kind of record, named by its letter",
            "Capital letters: no other is both faster and more accurate on the same records.",
        ),
    };
    let bound = if scene.bound.is_some() { " Level line: Cramér–Rao bound." } else { "" };
    format!(
        "{} Each line is {points}. Black: methods of this library. Thin: common methods, coded in this project. Dashed: other programs. Lower is \
         more accurate, further left is faster. {front} Crosses at the upper edge have failed, each method in a row of its own, from above as in the list. Truth: {}.{bound}",
        scene.says, scene.truth
    )
}

/// Tolerance of another program, if it has one and gave an answer.
fn tolerance(m: &MeasuredMethod) -> Option<&str> {
    let number = m.setting.strip_prefix("tolerance ")?;
    (m.other_program && error(m).is_some() && number.parse::<f64>().is_ok()).then_some(number)
}

/// Writes the tolerance beside the points of other programs.
fn with_tolerances(plot: Plot, lines: Vec<Vec<((f64, f64), &MeasuredMethod)>>) -> Plot {
    let with_tolerance = lines.into_iter().flatten().filter_map(|(at, m)| Some((at, tolerance(m)?)));
    with_tolerance.fold(plot, |plot, ((x, y), number)| plot.note(typeset(number), x, y))
}

/// Names the record of each point by a letter, a capital on the Pareto front of that record.
fn with_letters(
    mut plot: Plot,
    scene: &BenchmarkScene,
    view: &View,
    lines: Vec<Vec<((f64, f64), &MeasuredMethod)>>,
) -> Plot {
    let mut records: Vec<&str> = Vec::new();
    for m in &scene.methods {
        if !records.contains(&m.setting.as_str()) {
            records.push(&m.setting);
        }
    }
    if !(2..=26).contains(&records.len()) {
        return plot;
    }
    let letter = |m: &MeasuredMethod| {
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
        plot = named.into_iter().fold(plot, |plot, ((x, y), letters)| plot.note(letters, x, y));
    }
    plot = plot.with(Series::heading("Records"));
    for (letter, says) in ('a'..).zip(records).chain([('A', "capital: Pareto front")]) {
        plot =
            plot.with(Series::points(typeset(says), [], []).marker(Marker::Letter(letter)).ink(Ink::Black));
    }
    plot
}

/// Time of an answer in s.
fn seconds(m: &MeasuredMethod) -> f64 {
    1e-9 * m.time_ns
}

/// Error as drawn: at least 1e-17, since an exact answer has no place on a logarithmic axis.
fn error(m: &MeasuredMethod) -> Option<f64> {
    m.error.filter(|e| e.is_finite()).map(|e| e.abs().max(1e-17))
}

/// Pareto front as steps: down from the upper edge at the fastest, along to the most accurate, and on to
/// the right edge.
fn stairs(scene: &BenchmarkScene, edge: f64, last: f64) -> (Vec<f64>, Vec<f64>) {
    let members = scene.methods.iter().filter(|m| m.front);
    let mut front: Vec<(f64, f64)> = members.filter_map(|m| Some((seconds(m), error(m)?))).collect();
    sort_by_number(&mut front, |a| a.0);
    let (mut x, mut y, mut above) = (Vec::new(), Vec::new(), edge);
    for (time, error) in front {
        x.extend([time, time]);
        y.extend([above, error]);
        above = error;
    }
    x.push(last);
    y.push(above);
    (x, y)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::Panel;

    fn measured(method: &str, setting: &str, error: Option<f64>, front: bool) -> MeasuredMethod {
        MeasuredMethod {
            method: method.into(),
            setting: setting.into(),
            ours: false,
            other_program: false,
            error,
            time_ns: 1e3,
            failed: error.is_none(),
            why: None,
            front,
        }
    }

    fn scene(family: Family, methods: Vec<MeasuredMethod>) -> BenchmarkScene {
        BenchmarkScene {
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
        match chart(&scene(family, methods)).panels.remove(0) {
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
        let list = [
            "Common methods, coded in vibro",
            "one",
            "above: failed",
            "Failed",
            "other: failed",
            "Records",
            "0 dB",
            "20 dB",
            "40 dB",
            "capital: Pareto front",
        ];
        assert_eq!(names, list);
    }

    #[test]
    fn the_legend_says_whose_code_a_method_is() {
        let methods = vec![
            measured("RK45", "tolerance 1e-6", Some(1e-2), true),
            MeasuredMethod { ours: true, ..measured("exact", "", Some(1e-9), true) },
            MeasuredMethod {
                other_program: true,
                ..measured("Peer 1.0", "tolerance 1e-6", Some(1e-3), true)
            },
            MeasuredMethod { other_program: true, ..measured("Peer 1.0", "tolerance 1e-9", None, true) },
            MeasuredMethod { other_program: true, ..measured("Peer 2.0", "step 1 ms", Some(1e-4), true) },
        ];
        let Panel::Plot(plot) = chart(&scene(Family::Models, methods)).panels.remove(0) else {
            panic!("a plot")
        };
        let names: Vec<&str> = plot.series.iter().map(|s| s.name.as_str()).collect();
        let list = [
            "Pareto front",
            "Methods of vibro",
            "exact",
            "Common methods, coded in vibro",
            "RK45",
            "Other programs, with tolerances",
            "Peer 1.0",
            "Peer 2.0",
            "above: failed",
            "Failed",
            "Peer 1.0: failed",
        ];
        assert_eq!(names, list);
        let dashed = |s: &&Series| s.stroke == Some(Stroke::Dashed);
        assert_eq!(plot.series.iter().filter(dashed).count(), 2);
        // A tolerance is written only where another program gave an answer.
        let notes: Vec<&str> = plot.notes.iter().map(|n| n.text.as_str()).collect();
        assert_eq!(notes, ["10⁻⁶"]);
    }

    #[test]
    fn models_have_their_front_as_a_line() {
        let plot = plot(Family::Models);
        assert!(plot.notes.is_empty());
        assert!(plot.series.iter().any(|s| s.name == "Pareto front"));
    }

    /// Colour and marker of each method that failed.
    fn crosses(methods: &[(&str, bool)]) -> Vec<(Ink, Option<Marker>)> {
        let failing =
            |&(name, ours): &(&str, bool)| MeasuredMethod { ours, ..measured(name, "", None, false) };
        let methods = methods.iter().map(failing).collect();
        let Panel::Plot(plot) = chart(&scene(Family::Models, methods)).panels.remove(0) else {
            panic!("a plot")
        };
        let form = |s: &Series| (s.shape == Shape::Points).then_some((s.ink, s.marker));
        plot.series.iter().filter_map(form).collect()
    }

    /// The largest number of methods in a chart: all that appear in several charts, four of its own, two
    /// added, two of this library.
    #[test]
    fn what_failed_is_told_apart() {
        let own = [("exact", true), ("closed form", true)];
        let here = ["one", "two", "three", "four", "added", "added, too"].map(|name| (name, false));
        let methods: Vec<_> =
            RECURRING.map(|name| (name, false)).into_iter().chain(own).chain(here).collect();
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

//! Tables of a plan.

use super::sweep::{Suggested, Suggestion};
use super::{Change, Forecast};
use crate::compare::MotionKind;
use crate::measure::Estimate;
use crate::measure::expected::Tie;
use crate::report::layout::{headed, pair, table};
use crate::report::{Cell, Table};

/// The answers of a test as planned, and after each change, the best change first.
pub fn forecast(forecast: &Forecast) -> Table {
    let head = headed(&forecast.title, &[("test", ""), ("uncertainty left", "%")]);
    let column = |table: Table, (name, answer): &(String, Estimate)| table.column(words(name), answer.unit);
    let table = forecast.answers.iter().fold(head, column);
    let cells = |answers: &[(String, Estimate)]| {
        let cell = |(name, _): &(String, Estimate)| {
            let found = answers.iter().find(|(known, _)| known == name);
            found.map_or(Cell::Missing, |(_, answer)| pair(answer.value, answer.std))
        };
        forecast.answers.iter().map(cell).collect::<Vec<Cell>>()
    };
    let row = |table: Table, change: &Change| {
        let left = Cell::from(percent(change.factor));
        table.row([Cell::from(change.what.clone()), left].into_iter().chain(cells(&change.answers)))
    };
    let planned = [Cell::from("as planned"), Cell::from("100")];
    let table = table.row(planned.into_iter().chain(cells(&forecast.answers)));
    let table = forecast.changes.iter().fold(table, row);
    let ties: Vec<String> = forecast.ties.iter().map(tied).collect();
    if ties.is_empty() { table } else { table.note(format!("Told apart badly: {}.", ties.join("; "))) }
}

fn tied(tie: &Tie) -> String {
    let [first, second] = &tie.of;
    format!("{} and {} (correlation {:.3})", words(first), words(second), tie.correlation)
}

/// The name of an answer as words.
pub fn words(name: &str) -> String {
    name.replace('_', " ").replace("xi", "damping ratio ξ").replace("zeta", "damping ratio ζ")
}

fn percent(factor: f64) -> String {
    format!("{:.0}", 100.0 * factor)
}

/// All answers of all tests, for a CSV file.
pub fn all(forecasts: &[Forecast]) -> Table {
    let columns = [
        ("test", ""),
        ("change", ""),
        ("answer", ""),
        ("unit", ""),
        ("value", ""),
        ("std", ""),
        ("method", ""),
    ];
    let mut table = headed("Plan", &columns);
    for forecast in forecasts {
        let planned = ("as planned", &forecast.answers);
        let changes = forecast.changes.iter().map(|change| (change.what.as_str(), &change.answers));
        for (change, answers) in std::iter::once(planned).chain(changes) {
            for (name, answer) in answers {
                table.push([
                    Cell::from(forecast.title.clone()),
                    Cell::from(change),
                    Cell::from(name.clone()),
                    Cell::from(answer.unit),
                    Cell::from(answer.value),
                    answer.std.into(),
                    Cell::from(answer.method.clone()),
                ]);
            }
        }
    }
    table
}

/// The points that are suggested for a sweep.
pub fn points(title: &str, suggested: &Suggested) -> Table {
    let motion = |point: &Suggestion| match point.motion {
        Some(MotionKind::Impacting) => Cell::from("one impact a cycle"),
        Some(_) => Cell::from("no impact"),
        None => Cell::Missing,
    };
    let left = |point: &Suggestion| Cell::from(point.uncertainty.map(|part| 100.0 * part));
    let table = table(
        format!("{title}: next points"),
        &suggested.points,
        &[
            ("frequency", "Hz", &|point| point.frequency.into()),
            ("force", "N", &|point| point.force.into()),
            ("motion", "", &|point| motion(point)),
            ("uncertainty then", "%", &|point| left(point)),
        ],
    );
    table.note(format!("Uncertainty: relative standard uncertainty of {}.", suggested.aim))
}

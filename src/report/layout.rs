//! Parts of tables and figures that several analyses use.

use super::{AxisSpec, Cell, Figure, Ink, Marker, Panel, Plot, Series, Stroke, Table};
use crate::measure::Estimate;

/// A column: name, unit, and the cell for an item.
pub type Shown<'a, T> = (&'a str, &'a str, &'a dyn Fn(&T) -> Cell);

/// A table without rows.
pub fn headed(title: impl Into<String>, columns: &[(&str, &str)]) -> Table {
    columns.iter().fold(Table::new(title), |table, (name, unit)| table.column(*name, *unit))
}

/// A table with one row for each item.
pub fn table<T>(
    title: impl Into<String>,
    items: impl IntoIterator<Item = T>,
    columns: &[Shown<'_, T>],
) -> Table {
    let head = columns.iter().fold(Table::new(title), |table, c| table.column(c.0, c.1));
    items.into_iter().fold(head, |table, item| table.row(columns.iter().map(|c| c.2(&item))))
}

/// A title, followed by the name of the record if it has one.
pub fn titled(what: &str, name: &str) -> String {
    if name.is_empty() { what.to_owned() } else { format!("{what}, {name}") }
}

/// A value with its standard uncertainty.
pub fn pair(value: f64, std: Option<f64>) -> Cell {
    Cell::Estimate { value, std }
}

/// A phase in rad as one in degrees.
pub fn degrees(phase: &Estimate) -> Cell {
    pair(phase.value.to_degrees(), phase.std.map(f64::to_degrees))
}

/// Adds a line through points to a plot; nothing without points.
pub fn line(
    plot: Plot,
    name: &str,
    places: impl IntoIterator<Item = (f64, f64)>,
    ink: Ink,
    stroke: Stroke,
) -> Plot {
    let (x, y): (Vec<f64>, Vec<f64>) = places.into_iter().unzip();
    if x.is_empty() { plot } else { plot.with(Series::line(name, x, y).ink(ink).stroke(stroke)) }
}

/// Adds markers at points to a plot; nothing without points.
pub fn points(
    plot: Plot,
    name: &str,
    places: impl IntoIterator<Item = (f64, f64)>,
    ink: Ink,
    marker: Marker,
) -> Plot {
    let (x, y): (Vec<f64>, Vec<f64>) = places.into_iter().unzip();
    if x.is_empty() { plot } else { plot.with(Series::points(name, x, y).ink(ink).marker(marker)) }
}

/// Puts (a), (b), … before the titles of plots, if a figure has several.
pub fn lettered(mut figure: Figure) -> Figure {
    if figure.panels.len() > 1 {
        for (letter, panel) in ('a'..='z').zip(&mut figure.panels) {
            if let Panel::Plot(plot) = panel {
                plot.title.insert_str(0, &format!("({letter}) "));
            }
        }
    }
    figure
}

/// Axis of the values of a record: its quantity and unit. A sound file has neither: its values are parts of
/// full scale.
pub fn value_axis(quantity: &str, unit: &str) -> AxisSpec {
    match (quantity, unit) {
        ("other", "FS") => AxisSpec::new("Signal, part of full scale", ""),
        ("other", _) => AxisSpec::new("Signal", unit),
        _ => AxisSpec::new(capital(quantity), unit),
    }
}

/// A text with a capital first letter.
pub fn capital(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or_else(String::new, |c| c.to_uppercase().chain(letters).collect())
}

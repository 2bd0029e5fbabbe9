//! Tables of results: the same content for the terminal, for CSV and for the page.

use super::column::{Formatted, largest, power};
use super::{Cell, Column};
use crate::units::notation::{labelled, scaled_unit};
use crate::write::csv::begins_formula;
use serde::{Deserialize, Serialize};
use std::fmt::Write;
use vibro_figure::escaped;

/// Rows of results under named columns.
///
/// Numbers are given in SI units. In the terminal and on the page a column takes a prefix where that makes it
/// readable (`Amplitude (mm)`) and estimates are rounded to two digits of their uncertainty; as CSV every
/// number has full precision and its SI unit.
///
/// ```
/// use vibroimpact::report::{Cell, Table};
/// let table = Table::new("Resonances")
///     .column("Kind", "")
///     .column("Frequency", "Hz")
///     .row(["grazing".into(), Cell::Estimate { value: 5.583_1, std: Some(0.012_3) }])
///     .row(["clapping".into(), 10.59.into()]);
/// assert!(table.text().contains("5.583 ± 0.012"));
/// assert!(table.csv().starts_with("Kind,Frequency (Hz),Frequency std (Hz)\n"));
/// ```
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Table {
    /// What the table shows.
    pub title: String,
    /// Names and units of the columns.
    pub columns: Vec<Column>,
    /// Rows, each with a cell for every column; a row that is too short ends with missing cells.
    pub rows: Vec<Vec<Cell>>,
    /// Explanation of its terms, shown below it.
    pub note: String,
}

impl Table {
    /// A table without columns.
    pub fn new(title: impl Into<String>) -> Table {
        Table { title: title.into(), ..Table::default() }
    }

    /// Adds a column.
    pub fn column(mut self, name: impl Into<String>, unit: impl Into<String>) -> Table {
        self.columns.push(Column { name: name.into(), unit: unit.into() });
        self
    }

    /// Adds an explanation of its terms below it.
    pub fn note(self, note: impl Into<String>) -> Table {
        Table { note: note.into(), ..self }
    }

    /// Adds a row.
    pub fn row(mut self, cells: impl IntoIterator<Item = Cell>) -> Table {
        self.push(cells);
        self
    }

    /// Adds a row in place, for use in a loop.
    pub fn push(&mut self, cells: impl IntoIterator<Item = Cell>) {
        self.rows.push(cells.into_iter().collect());
    }

    /// As text for the terminal: columns separated by blanks, words left-aligned, numbers aligned at their
    /// decimal points.
    pub fn text(&self) -> String {
        let columns: Vec<Vec<String>> = self.formatted().iter().map(Formatted::aligned).collect();
        let mut out = String::new();
        if columns.is_empty() {
            return out;
        }
        if !self.title.is_empty() {
            let _ = writeln!(out, "{}", self.title);
        }
        for row in self.lines(&columns, "  ") {
            // ASCII hyphen instead of a typographic minus, so that numbers can be pasted into other
            // programs.
            let _ = writeln!(out, "{}", row.trim_end().replace('\u{2212}', "-"));
        }
        if !self.note.is_empty() {
            let _ = writeln!(out, "{}", self.note);
        }
        out
    }

    /// As CSV (RFC 4180): full precision, empty cells for missing numbers, and a column `… std` after each
    /// column with uncertainties.
    pub fn csv(&self) -> String {
        let number = |value: Option<f64>| value.map_or_else(String::new, exact);
        let shown = |cell: &Cell| match cell {
            Cell::Text(text) => quoted(text),
            cell => number(cell.value()),
        };
        let mut columns: Vec<Vec<String>> = Vec::new();
        for (i, Column { name, unit }) in self.columns.iter().enumerate() {
            let head = |name: &str| std::iter::once(quoted(&labelled(name, unit)));
            columns.push(head(name).chain(self.cells(i).map(shown)).collect());
            if self.cells(i).any(|c| c.std().is_some()) {
                let stds = self.cells(i).map(|c| number(c.std()));
                columns.push(head(&format!("{name} std")).chain(stds).collect());
            }
        }
        self.lines(&columns, ",").map(|line| line + "\n").collect()
    }

    /// Head and rows of these columns, each joined to one line.
    fn lines(&self, columns: &[Vec<String>], between: &str) -> impl Iterator<Item = String> {
        (0..=self.rows.len()).map(move |line| {
            let cells: Vec<&str> = columns.iter().filter_map(|c| c.get(line).map(String::as_str)).collect();
            cells.join(between)
        })
    }

    /// As HTML: a `table` element with the title as caption.
    pub fn html(&self) -> String {
        let columns = self.formatted();
        if columns.is_empty() {
            return String::new();
        }
        let csv = self.csv();
        let rows: Vec<String> = csv.lines().map(escaped).collect();
        let mut out = format!("<div class=\"table\"><table data-csv=\"{}\">\n", rows.join("\n"));
        if !self.title.is_empty() {
            let _ = writeln!(out, "<caption>{}</caption>", escaped(&self.title));
        }
        let class = |c: &Formatted| if c.numeric { " class=\"number\"" } else { "" };
        let _ = write!(out, "<thead><tr>");
        for column in &columns {
            let _ = write!(out, "<th scope=\"col\"{}>{}</th>", class(column), escaped(&column.head));
        }
        let _ = writeln!(out, "</tr></thead>\n<tbody>");
        for line in 0..self.rows.len() {
            let _ = write!(out, "<tr>");
            for column in &columns {
                let cell = column.cells.get(line).map_or("", String::as_str);
                // On a narrow page a line may end before the sign, not behind it.
                let _ = write!(out, "<td{}>{}</td>", class(column), escaped(cell).replace("± ", "±&nbsp;"));
            }
            let _ = writeln!(out, "</tr>");
        }
        let _ = writeln!(out, "</tbody></table></div>");
        if !self.note.is_empty() {
            let _ = writeln!(out, "<p class=\"note\">{}</p>", escaped(&self.note));
        }
        out
    }

    /// The same table with its first columns only.
    pub fn leading(mut self, columns: usize) -> Table {
        self.columns.truncate(columns);
        self.rows.iter_mut().for_each(|row| row.truncate(columns));
        self
    }

    /// Its heads, then its rows, as a page shows them: without columns that hold nothing.
    pub fn in_words(&self) -> Vec<Vec<String>> {
        let columns = self.formatted();
        let heads = columns.iter().map(|column| column.head.clone()).collect();
        let row = |line: usize| columns.iter().map(|column| column.cells[line].clone()).collect();
        std::iter::once(heads).chain((0..self.rows.len()).map(row)).collect()
    }

    /// Cells of a column, missing where a row is too short.
    fn cells(&self, column: usize) -> impl Iterator<Item = &Cell> {
        self.rows.iter().map(move |row| row.get(column).unwrap_or(&Cell::Missing))
    }

    /// The columns with values as text.
    fn formatted(&self) -> Vec<Formatted> {
        let mut columns: Vec<(&Column, Vec<&Cell>)> =
            self.columns.iter().enumerate().map(|(i, c)| (c, self.cells(i).collect())).collect();
        // A column without values is omitted.
        let filled =
            |cell: &&Cell| matches!(cell, Cell::Text(text) if !text.is_empty()) || cell.value().is_some();
        columns.retain(|(_, cells)| cells.is_empty() || cells.iter().any(filled));
        let shown = |(column, cells): &(&Column, Vec<&Cell>)| {
            // Upper limits take the power of ten of the first column of their unit, whose missing values
            // they
            // replace.
            let limited_column =
                |c: &&(&Column, Vec<&Cell>)| c.0.unit == column.unit && column.name == "upper limit";
            let (scale_of, values) =
                columns.iter().find(limited_column).map_or((*column, cells), |(c, v)| (*c, v));
            let own = power(scale_of, values);
            // Beside intervals in ms a spread of 0.55 ms is compared more easily than one of 550 µs.
            let beside = columns.iter().filter(|c| c.0.unit == column.unit).map(|(c, v)| power(c, v));
            let larger =
                beside.filter(|power| *power == own + 3 && largest(values) >= 0.1 * 10f64.powi(*power));
            Formatted::new(column, cells, larger.max().unwrap_or(own))
        };
        let mut formatted: Vec<Formatted> = columns.iter().map(shown).collect();
        for i in 1..columns.len() {
            let ((number, values), (unit, units)) = (&columns[i - 1], &columns[i]);
            if unit.name == "unit" && number.unit.is_empty() {
                let rows = values.iter().zip(units);
                let in_units = rows.map(|(value, unit)| in_own_unit(&number.name, value, unit));
                (formatted[i - 1].cells, formatted[i].cells) = in_units.unzip();
            }
        }
        formatted
    }
}

/// A number of a row that has a unit of its own, and that unit, with the prefix that makes it readable.
fn in_own_unit(name: &str, value: &Cell, unit: &Cell) -> (String, String) {
    let unit = if let Cell::Text(unit) = unit { unit.as_str() } else { "" };
    let column = Column { name: name.to_owned(), unit: unit.to_owned() };
    let power = power(&column, &[value]);
    (Formatted::new(&column, &[value], power).cells.concat(), scaled_unit(unit, power))
}

/// The shortest decimal that reads back as the same number.
fn exact(value: f64) -> String {
    if value.abs() >= 1e15 || value != 0.0 && value.abs() < 1e-4 {
        format!("{value:e}")
    } else {
        value.to_string()
    }
}

/// A field of CSV: quoted where its characters need it, with an apostrophe before what a spreadsheet takes
/// for a formula.
fn quoted(text: &str) -> String {
    let text = if begins_formula(text) { format!("'{text}") } else { text.to_owned() };
    if text.contains(['"', ',', '\n', '\r']) { format!("\"{}\"", text.replace('"', "\"\"")) } else { text }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn resonances() -> Table {
        Table::new("Resonances")
            .column("Kind", "")
            .column("Frequency", "Hz")
            .column("Amplitude", "m")
            .column("Impacts", "")
            .row([
                "grazing".into(),
                estimated(5.583_1, 0.012_3),
                estimated(0.004_213, 0.000_041),
                56usize.into(),
            ])
            .row(["clapping, up".into(), estimated(10.59, 0.1), Cell::Missing, 107usize.into()])
            .row(["none".into(), 7.49.into(), 0.000_35.into()])
    }

    fn estimated(value: f64, std: f64) -> Cell {
        Cell::Estimate { value, std: Some(std) }
    }

    #[test]
    fn the_terminal_shows_rounded_values_in_readable_units_under_each_other() {
        let expected = "\
Resonances
Kind          Frequency (Hz)  Amplitude (mm)  Impacts
grazing        5.583 ± 0.012   4.213 ± 0.041       56
clapping, up  10.59 ± 0.10     –                  107
none           7.49            0.35                 –
";
        assert_eq!(resonances().text(), expected);
    }

    #[test]
    fn csv_keeps_every_digit_and_quotes_what_needs_it() {
        let csv = resonances().csv();
        let lines: Vec<&str> = csv.lines().collect();
        assert_eq!(
            lines[0],
            "Kind,Frequency (Hz),Frequency std (Hz),Amplitude (m),Amplitude std (m),Impacts"
        );
        assert_eq!(lines[1], "grazing,5.5831,0.0123,0.004213,4.1e-5,56");
        assert_eq!(lines[2], "\"clapping, up\",10.59,0.1,,,107");
        assert_eq!(lines[3], "none,7.49,,3.5e-4,,".replace("3.5e-4", "0.00035"));
        let formula =
            Table::new("").column("=1+1", "").row(["@x".into()]).row(["-".into()]).row(["＝x".into()]).csv();
        assert_eq!(formula, "'=1+1\n'@x\n-\n'＝x\n");
        let third = Table::new("").column("a", "m").row([(1.0f64 / 3.0).into()]).csv();
        assert_eq!(third.lines().nth(1).unwrap().parse::<f64>().unwrap(), 1.0 / 3.0);
    }

    #[test]
    fn a_column_without_values_is_not_shown_and_a_limit_has_the_unit_of_its_amplitude() {
        let table = Table::new("").column("amplitude", "m").column("off", "Hz").column("upper limit", "m");
        let text = table.row([estimated(2e-3, 1e-5), Cell::Missing, 2e-5.into()]).text();
        assert!(text.starts_with("amplitude (mm)  upper limit (mm)\n"), "{text}");
    }

    #[test]
    fn columns_of_one_unit_share_its_power_of_ten_where_that_costs_no_digit() {
        let table = Table::new("").column("interval", "s").column("spread", "s").column("onset", "s");
        let text = table.row([estimated(0.083_336, 3e-5), 550e-6.into(), estimated(3.1e-6, 1e-7)]).text();
        let line = text.lines().nth(1).unwrap_or_default();
        assert!(text.trim_start().starts_with("interval (ms)  spread (ms)   onset (µs)"), "{text}");
        assert!(line.starts_with("83.336 ± 0.030         0.55  3.10 ± 0.10"), "{text}");
    }

    #[test]
    fn markup_in_cells_is_only_text() {
        let table = Table::new("<b>").column("a & b", "m").row(["<script>".into()]);
        let html = table.html();
        assert!(html.contains("&lt;script&gt;") && html.contains("a &amp; b") && html.contains("&lt;b&gt;"));
        assert!(!html.contains("<script") && !html.contains("<b>"));
    }

    #[test]
    fn numbers_that_differ_in_size_keep_their_digits() {
        let table = Table::new("").column("error", "1").row([2e-12.into()]).row([0.031_25.into()]).text();
        assert!(table.contains("2.0000×10⁻¹²") && table.contains("0.031250"), "{table}");
    }

    #[test]
    fn a_measured_value_of_unknown_uncertainty_has_few_digits() {
        let of = |values: &[f64]| {
            let cells = values.iter().map(|value| [Cell::Estimate { value: *value, std: None }]);
            let text = cells.fold(Table::new("").column("a", "Hz"), Table::row).text();
            text.lines().skip(1).map(|line| line.trim().to_owned()).collect::<Vec<_>>()
        };
        assert_eq!(of(&[0.119_54]), ["0.12"]);
        assert_eq!(of(&[2099.8]), ["2100"]);
        assert_eq!(of(&[10.02, 10.04]), ["10.02", "10.04"]);
    }

    #[test]
    fn nothing_and_infinity_are_shown_as_such() {
        let table =
            Table::new("").column("a", "m").row([f64::NAN.into()]).row([f64::INFINITY.into()]).row([]);
        let text = table.text();
        let cells: Vec<&str> = text.lines().skip(1).map(str::trim).collect();
        assert_eq!(cells, ["–", "∞", "–"]);
        assert_eq!(table.csv(), "a (m)\n\ninf\n\n");
    }
}

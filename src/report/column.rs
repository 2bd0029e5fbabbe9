//! A column of a table, and the alignment of its cells.

use super::Cell;
use crate::units::notation::{
    decimals_needed, engineering, estimate, fixed, labelled, scaled_unit, significant,
};
use serde::{Deserialize, Serialize};
use std::collections::BTreeSet;

/// Head of a column.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct Column {
    /// Quantity.
    pub name: String,
    /// Unit of the numbers; empty or `1` for none.
    pub unit: String,
}

/// A column as text.
pub(super) struct Formatted {
    pub head: String,
    pub cells: Vec<String>,
    pub numeric: bool,
}

/// The power of ten that divides all numbers of a column, by the largest of `cells`.
pub(super) fn power(column: &Column, cells: &[&Cell]) -> i32 {
    // Angles and percentages are not scaled. Counts and other numbers without a unit are not either, since
    // the head has no unit to show the scale; such a number keeps its own power of ten.
    let unscaled =
        matches!(column.unit.as_str(), "°" | "rad" | "%" | "" | "1" | "FS") || column.unit.starts_with("dB");
    if unscaled { 0 } else { engineering(largest(cells)) }
}

/// Largest magnitude of cells.
pub(super) fn largest(cells: &[&Cell]) -> f64 {
    let values = cells.iter().filter_map(|c| c.value()).filter(|v| v.is_finite());
    values.map(f64::abs).fold(0.0, f64::max)
}

impl Formatted {
    /// Writes the cells of a column, divided by 10^`power`: estimates with two digits of their uncertainty;
    /// the others with common decimals, numbers to five significant digits and measured values without an
    /// uncertainty to three to five.
    pub fn new(column: &Column, cells: &[&Cell], power: i32) -> Formatted {
        let scale = 10f64.powi(-power);
        let without_std = |kind: fn(&Cell) -> bool| -> Vec<f64> {
            let values = cells.iter().filter(|c| c.std().is_none() && kind(c)).filter_map(|c| c.value());
            values.filter(|v| v.is_finite()).map(|v| v * scale).collect()
        };
        let numbers = without_std(|cell| matches!(cell, Cell::Number(_)));
        let measured = without_std(|cell| matches!(cell, Cell::Estimate { .. }));
        // Significant digits and decimals of each kind.
        let number_format = (5, common_decimals(&numbers, 5));
        let digits = distinguishing_digits(&measured);
        let measured_format = (digits, common_decimals(&measured, digits));
        let written = |cell: &&Cell| match (cell, cell.value()) {
            (Cell::Text(text), _) => text.clone(),
            (_, None) => "–".to_owned(),
            (Cell::Estimate { std: Some(std), .. }, Some(value)) if cell.std().is_some() => {
                uncertain(value * scale, std * scale)
            }
            (_, Some(value)) if column.unit == "%" => percentage(value),
            (_, Some(value)) => {
                match if matches!(cell, Cell::Number(_)) { number_format } else { measured_format } {
                    (_, Some(decimals)) if value.is_finite() => fixed(value * scale, decimals),
                    (digits, _) => significant(value * scale, digits),
                }
            }
        };
        Formatted {
            head: labelled(&column.name, &scaled_unit(&column.unit, power)),
            cells: cells.iter().map(written).collect(),
            numeric: !cells.iter().any(|c| matches!(c, Cell::Text(_))),
        }
    }

    /// Head and cells, padded to one width.
    pub fn aligned(&self) -> Vec<String> {
        let count = |text: &str| text.chars().count();
        // Characters before the decimal point, by which the cells are aligned.
        let whole = |text: &str| text.find(['.', ' ', '×']).map_or(count(text), |at| count(&text[..at]));
        let point = self.cells.iter().map(|c| whole(c)).max().unwrap_or(0);
        let lead = |cell: &String| if self.numeric { point - whole(cell) } else { 0 };
        let cells: Vec<String> = self.cells.iter().map(|c| format!("{}{c}", " ".repeat(lead(c)))).collect();
        let width = cells.iter().map(|c| count(c)).chain([count(&self.head)]).max().unwrap_or(0);
        let block = cells.iter().map(|c| count(c)).max().unwrap_or(0);
        let indent = if self.numeric { " ".repeat(width - block) } else { String::new() };
        let head =
            if self.numeric { format!("{:>width$}", self.head) } else { format!("{:<width$}", self.head) };
        let rows = cells.iter().map(|c| format!("{:<width$}", format!("{indent}{c}")));
        std::iter::once(head).chain(rows).collect()
    }
}

/// Significant digits of measured values without an uncertainty: three, or up to five where that
/// distinguishes them.
fn distinguishing_digits(values: &[f64]) -> usize {
    let distinct = |digits| values.iter().map(|v| significant(*v, digits)).collect::<BTreeSet<_>>().len();
    (3..5).find(|digits| distinct(*digits) == distinct(5)).unwrap_or(5)
}

/// Decimals that show the largest value with `digits` significant digits, fewer where all values are round.
/// `None` where small values would lose their digits.
fn common_decimals(values: &[f64], digits: usize) -> Option<usize> {
    let sizes = || values.iter().map(|v| v.abs()).filter(|v| *v > 0.0);
    let (smallest, largest) = (sizes().fold(f64::INFINITY, f64::min), sizes().fold(0.0, f64::max));
    if largest == 0.0 {
        return Some(0);
    }
    let needed = values.iter().map(|v| decimals_needed(*v, digits)).max().unwrap_or(0);
    let room = digits as i32 - 1 - largest.log10().floor() as i32;
    let decimals = needed.min(usize::try_from(room.max(0)).unwrap_or(0));
    // The smallest value keeps two digits.
    let kept = smallest * 10f64.powi(decimals as i32) >= 10.0 || decimals == needed;
    (kept && (1e-3..1e9).contains(&largest)).then_some(decimals)
}

/// A value with two digits of its uncertainty. It has no power of ten of its own, since the column has one.
fn uncertain(value: f64, std: f64) -> String {
    match usize::try_from(1 - std.log10().floor() as i32) {
        Ok(decimals) if (1e-6..0.1).contains(&std) && value.abs() < 0.1 => {
            format!("{} ± {}", fixed(value, decimals), fixed(std, decimals))
        }
        _ => estimate(value, Some(std)),
    }
}

/// A percentage has three significant digits at most, and no power of ten.
fn percentage(value: f64) -> String {
    if value.abs() < 1e-3 && value != 0.0 { "< 0.001".to_owned() } else { significant(value, 3) }
}

#[cfg(test)]
mod tests {
    use super::common_decimals;

    #[test]
    fn decimals_are_common_where_no_small_number_loses_its_digits() {
        assert_eq!(common_decimals(&[60.0, 7.0], 5), Some(0));
        assert_eq!(common_decimals(&[5.5, 7.49, 11.1], 5), Some(2));
        assert_eq!(common_decimals(&[1e-9, 1.0 / 3.0], 5), None);
        assert_eq!(common_decimals(&[], 5), Some(0));
    }
}

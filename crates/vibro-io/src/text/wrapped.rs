//! Reads one series printed over several columns, row after row, as PEER's AT2 files and other Fortran
//! programs print it.

use super::decoded::Text;
use super::dialect::Dialect;
use super::encoding;
use super::lines::{Line, fields};
use crate::held::Held;
use crate::number;
use vibro_record::{Error, Result};

/// Most rows that are compared to detect whether they continue each other.
const LOOK: usize = 100_000;
/// Fewest rows for that comparison.
const FEWEST: usize = 12;

/// All values, row after row; `None` if the text holds anything else.
///
/// # Errors
/// If the text cannot be read.
pub fn flat(text: &Text, dialect: &Dialect) -> Result<Option<Vec<f64>>> {
    let bytes = text.source.all()?;
    let whole = encoding::decode(&bytes);
    let mut values = Vec::new();
    for line in dialect.rows(whole.trim_end_matches('\u{1a}')).filter(|line| line.remark.is_none()) {
        for (_, field) in fields(line.text, dialect.separator).unwrap_or_default() {
            match number::parse_with(field.as_bytes(), dialect.decimal) {
                Some(value) => values.push(value),
                None if field.is_empty() => {}
                None => return Ok(None),
            }
        }
    }
    Ok(Some(values))
}

/// Whether all rows but the last are full, the last is shorter but has its line end, and the first column
/// does not always rise, so that it is no abscissa.
pub fn ends_short(text: &Text, dialect: &Dialect) -> bool {
    let Ok(bytes) = text.source.all() else { return false };
    let whole = encoding::decode(&bytes);
    let count = |line: &Line| {
        let cells = fields(line.text, dialect.separator).unwrap_or_default();
        let first = number::parse_with(cells.first()?.1.as_bytes(), dialect.decimal)?;
        let all = cells.iter().filter(|(_, cell)| !cell.is_empty());
        let numbers = all.clone().all(|(_, c)| number::parse_with(c.as_bytes(), dialect.decimal).is_some());
        numbers.then_some((all.count(), first))
    };
    let rows = dialect.rows(whole.trim_end_matches('\u{1a}')).filter(|l| l.remark.is_none() && !l.is_blank());
    let Some(rows) = rows.map(|line| count(&line)).collect::<Option<Vec<(usize, f64)>>>() else {
        return false;
    };
    let Some(((last, _), full)) = rows.split_last() else { return false };
    let ended = whole.ends_with(['\n', '\r', '\u{1a}']);
    let falls = full.windows(2).any(|w| w[1].1 <= w[0].1);
    dialect.columns > 2
        && ended
        && falls
        && *last < dialect.columns
        && full.iter().all(|row| row.0 == dialect.columns)
}

/// Whether the columns look like one series printed row after row. Then the steps from one value to the
/// next, also into the next row, are smaller on average than the steps down a column.
pub fn continues(columns: &[Held]) -> bool {
    let columns: Vec<&[f64]> = columns.iter().map(Held::reals).collect();
    if columns.len() < 3 || columns[0].len() < FEWEST {
        // More than 12 values in a single line are one series.
        return columns.len() > FEWEST && columns[0].len() == 1;
    }
    let rows = columns[0].len().min(LOOK);
    let last = columns.len() - 1;
    let step = |a: f64, b: f64| (b - a).abs();
    // The first quarter of the rows is left out, since it may hold numbers that describe the series.
    let from = 1 + rows / 4;
    let within = columns.windows(2).flat_map(|w| (from..rows).map(|i| step(w[0][i], w[1][i])));
    let over = (from..rows).map(|i| step(columns[last][i - 1], columns[0][i]));
    let down = columns.iter().flat_map(|c| (from..rows).map(|i| step(c[i - 1], c[i])));
    let (within, over, down) = (mean(within), mean(over), mean(down));
    // Channels that change slowly about one level have smaller steps down a column than along a row.
    within > 0.0 && over < 2.0 * within && within < 0.7 * down && over < 0.7 * down
}

/// Whether there are at least three columns and the first does not always rise, so that it is no abscissa.
pub fn no_abscissa(columns: &[Held]) -> bool {
    let first = columns.first().filter(|_| columns.len() > 2).map(Held::reals);
    first.is_some_and(|first| first.windows(2).any(|w| w[1] <= w[0]))
}

fn mean(steps: impl Iterator<Item = f64>) -> f64 {
    let (sum, n) = steps.fold((0.0, 0usize), |(sum, n), step| (sum + step, n + 1));
    sum / n as f64
}

/// Error that asks whether the columns are channels or one series.
pub fn question(columns: usize) -> Error {
    let found =
        format!("{columns} columns that may continue each other, and nothing says that they are channels");
    Error::usage(found, "channels, or one series row after row")
        .hint("say that the rows continue each other, or that each column is a channel")
        .setting("wrapped")
        .setting("columns")
}

#[cfg(test)]
mod tests {
    use super::*;
    use vibro_math::Noise;
    use vibro_record::Values;

    /// `n` columns of 200 rows, filled row after row.
    fn columns(n: usize, value: impl Fn(usize) -> f64) -> Vec<Held> {
        (0..n).map(|c| Values::Real((0..200).map(|i| value(n * i + c)).collect()).into()).collect()
    }

    #[test]
    fn a_series_is_told_from_channels() {
        assert!(continues(&columns(5, |i| (0.05 * i as f64).sin())));
        assert!(continues(&columns(8, |i| (0.02 * i as f64).sin() + 0.3 * (0.11 * i as f64).cos())));
        // No series: three axes of one motion at different levels; a sine and its harmonics; noise.
        let channel = |i: usize| (0.05 * (i / 3) as f64 + (i % 3) as f64).sin() + 0.2 * (i % 3) as f64;
        assert!(!continues(&columns(3, channel)));
        assert!(!continues(&columns(4, |i| (0.05 * (i / 4) as f64 * (1 + i % 4) as f64).sin())));
        let mut noise = Noise::new(3);
        let drawn: Vec<f64> = (0..1000).map(|_| noise.normal()).collect();
        assert!(!continues(&columns(5, |i| drawn[i])));
        assert!(!continues(&columns(2, |i| (0.05 * i as f64).sin())));
    }
}

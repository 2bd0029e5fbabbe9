//! Findings on the values of a text: scale factors that are not applied, repeated rows, sample-and-hold,
//! marks of missing values, zero padding.

use super::column::Column;
use super::header::Stated;
use crate::held::Held;
use vibro_record::code;
use vibro_record::{Axis, AxisKind, Finding, Values};

/// Magnitudes by which programs mark missing values. The last is the fill value of netCDF.
const MISSING_MARKS: [f64; 11] =
    [999.0, 9999.0, 99_999.0, 999_999.0, 9_999_999.0, 1e20, 1e30, 1e35, 1e36, 1e38, 9.969_209_968_386_869e36];

/// Whether the largest magnitude of a column of which only a summary is held may mark missing values.
pub fn may_be_marked(held: &Held) -> bool {
    let Held::Summary(ends) = held else { return false };
    ends.largest().is_some_and(|(_, size)| MISSING_MARKS.contains(&size))
}

/// A missing-value mark is at least 10 times all other magnitudes; a measured 999 has neighbours of its
/// size.
const FAR: f64 = 10.0;

/// Zero padding: at least 32 zeros and 2 % of all values; fewer may end a record by chance.
const FEWEST_ZEROS: usize = 32;
const FILLING: f64 = 0.02;

/// Largest share of zeros before the padding; a coarsely quantised signal has more.
const RARE: f64 = 0.01;

/// Fewest runs of equal values that show sample-and-hold.
const FEWEST_RUNS: usize = 20;

/// Smallest share of rows that repeat the row before, when a sensor is read faster than it measures.
const REPEATS: f64 = 0.05;

/// Cautions on the value columns of a text over `axis`, whose header states `stated`.
pub fn of(table: &[Column], axis: &Axis, stated: &Stated, is_table: bool) -> Vec<Finding> {
    let mut found = Vec::new();
    let signal = table.iter().any(Column::may_be_signal);
    let scales = stated.scales.iter().filter(|scale| signal || !scale.of_signal);
    let scales: Vec<&str> = scales.map(|scale| scale.said.as_str()).collect();
    if !scales.is_empty() {
        found.push(Finding::caution(code::SCALE_IN_HEAD).name("scale", scales.join(", ")));
    }
    let even: Vec<String> = table.iter().filter(|column| column.rises_evenly()).map(Column::label).collect();
    if !even.is_empty() {
        found.push(Finding::caution("columns-rise-evenly").name("columns", even.join(", ")));
    }
    let without = table.iter().filter(|column| column.name.unit.is_none()).count();
    if let Some(unit) = stated.unit.as_deref().filter(|_| is_table && without > 1) {
        found.push(Finding::caution("unit-for-all").name("unit", unit).count("n", without));
    }
    if let Some((n, all)) = repeats(table) {
        found.push(Finding::caution("rows-repeat").count("n", n).count("all", all));
    }
    let filled = table.iter().filter_map(|column| Some((column.label(), column.filled_with_zeros()?)));
    found.extend(filled.map(|(label, n)| {
        let filled = Finding::doubt("filled-with-zeros").name("column", label).count("n", n);
        match &axis.kind {
            AxisKind::Time => filled.number("end", axis.at(axis.len().saturating_sub(n))),
            _ => filled,
        }
        .without_estimate()
    }));
    let held = table.iter().filter_map(|column| Some((column.held()?, column.label())));
    let held: Vec<(usize, String)> = held.collect();
    for of_length in held.chunk_by(|a, b| a.0 == b.0) {
        let labels: Vec<&str> = of_length.iter().map(|(_, label)| label.as_str()).collect();
        let held = Finding::caution("values-held").count("n", of_length[0].0);
        found.push(held.name("columns", labels.join(", ")));
    }
    found
}

impl Column {
    /// Rows per measured value (sample-and-hold), where 95 % of the runs of equal values have the median
    /// length (±1 above 2 rows). The sensor is slower than the rows. A coarsely quantised signal is
    /// excluded: most of its steps equal the smallest one.
    fn held(&self) -> Option<usize> {
        let values = self.values.first_values();
        let runs: Vec<&[f64]> = values.chunk_by(|a, b| a == b).collect();
        let inner = runs.get(1..runs.len().saturating_sub(1)).filter(|inner| inner.len() >= FEWEST_RUNS)?;
        let mut lengths: Vec<usize> = inner.iter().map(|run| run.len()).collect();
        lengths.sort_unstable();
        let n = lengths[lengths.len() / 2];
        let alike = lengths.iter().filter(|length| length.abs_diff(n) <= usize::from(n > 2)).count();
        let steps: Vec<f64> = inner.windows(2).map(|w| (w[1][0] - w[0][0]).abs()).collect();
        let smallest = steps.iter().copied().fold(f64::INFINITY, f64::min);
        let large = steps.iter().filter(|step| **step > 2.0 * smallest).count();
        (n > 1 && 20 * alike >= 19 * lengths.len() && 2 * large > steps.len()).then_some(n)
    }

    /// The missing-value mark, such as −9999, and its count. It is at least [`FAR`] times all other
    /// magnitudes and less than half of the values.
    fn missing_mark(&self) -> Option<(f64, usize)> {
        let values = self.reals();
        let is_mark = |v: &&f64| MISSING_MARKS.contains(&v.abs());
        let mark = *values.iter().find(is_mark)?;
        let others = values.iter().filter(|v| **v != mark && v.is_finite());
        let largest = others.fold(f64::NEG_INFINITY, |largest: f64, v| largest.max(v.abs()));
        let n = values.iter().filter(|v| **v == mark).count();
        (2 * n < values.len() && FAR * largest <= mark.abs()).then_some((mark, n))
    }

    /// The finding on marks of missing values, which become missing (NaN) where that is allowed.
    pub fn take_marks(&mut self, allow_missing: bool) -> Option<Finding> {
        let (mark, n) = self.missing_mark()?;
        let facts = [("mark", mark), ("n", n as f64)];
        if !allow_missing {
            let found = Finding::doubt("missing-marked").name("column", self.label());
            return Some(facts.iter().fold(found, |found, (k, v)| found.number(k, *v)).without_estimate());
        }
        if let Some(Values::Real(values)) = self.values.values_mut() {
            values.iter_mut().filter(|v| **v == mark).for_each(|v| *v = f64::NAN);
        }
        let found = Finding::caution("marks-as-missing").name("column", self.label());
        Some(facts.iter().fold(found, |found, (k, v)| found.number(k, *v)))
    }

    /// Number of zeros that pad the end of the column; hardly any value before them is 0.
    fn filled_with_zeros(&self) -> Option<usize> {
        let values = self.reals();
        let n = values.iter().rev().take_while(|v| **v == 0.0).count();
        let before = &values[..values.len() - n];
        let zeros = before.iter().filter(|v| **v == 0.0).count();
        let fills = n >= FEWEST_ZEROS && FILLING * values.len() as f64 <= n as f64;
        (fills && before.len() >= FEWEST_ZEROS && zeros as f64 <= RARE * before.len() as f64).then_some(n)
    }
}

/// Number of rows that equal the row before in all columns, and number of rows compared. `None` unless over
/// 90 % of them are single, between rows that differ: a motion at rest or coarse quantisation repeats many
/// rows in succession.
fn repeats(table: &[Column]) -> Option<(usize, usize)> {
    let measured = table.iter().filter(|column| !column.rises());
    let columns: Vec<&[f64]> = measured.map(|column| column.values.first_values()).collect();
    let n = columns.iter().map(|values| values.len()).min().filter(|n| columns.len() > 1 && *n > 100)?;
    let again = |i: usize| columns.iter().all(|values| values[i] == values[i - 1]);
    let all = (1..n).filter(|i| again(*i)).count();
    let alone = (2..n - 1).filter(|i| again(*i) && !again(i - 1) && !again(i + 1)).count();
    (all as f64 > REPEATS * n as f64 && 10 * alone > 9 * all && 2 * all < n).then_some((all, n))
}

//! Headlines of a report: the main numbers of each kind of record.

use crate::record::Finding;
use crate::report::layout::{Shown, table};
use crate::report::{Cell, Table};

/// Largest number of rows of a headline.
const MOST_ROWS: usize = 10;

/// Name of the last column.
const REMARK: &str = "remark";

/// Main numbers of a record, one row an item.
pub fn headline<T>(title: &str, items: impl IntoIterator<Item = T>, columns: &[Shown<'_, T>]) -> Table {
    remarked(title, items, columns, &|_| "")
}

/// As [`headline`], with a remark on each item.
pub fn remarked<T>(
    title: &str,
    items: impl IntoIterator<Item = T>,
    columns: &[Shown<'_, T>],
    remark: &dyn Fn(&T) -> &'static str,
) -> Table {
    let remark_of = |item: &T| Cell::from(remark(item));
    table(title, items, &[columns, &[(REMARK, "", &remark_of)]].concat())
}

/// The headline with the name of its record as first column. If a finding is a doubt, the remark of each
/// row points to it.
pub fn of_record<'a>(
    mut headline: Table,
    name: &str,
    findings: impl IntoIterator<Item = &'a Finding>,
) -> Table {
    let doubtful = findings.into_iter().any(Finding::is_doubt);
    let column = Table::new("").column("record", "").columns;
    headline.columns.splice(0..0, column);
    for row in &mut headline.rows {
        if doubtful {
            row.pop();
            row.push("see the doubt".into());
        }
        row.insert(0, name.into());
    }
    headline
}

/// The headlines that have rows, cut to their first rows.
pub fn shortened(headlines: &[Table]) -> Vec<Table> {
    let short = |table: &Table| {
        let mut table = table.clone();
        let more = table.rows.len().saturating_sub(MOST_ROWS);
        table.rows.truncate(MOST_ROWS);
        if more == 0 { table } else { table.note(format!("{more} more below.")) }
    };
    headlines.iter().filter(|table| !table.rows.is_empty()).map(short).collect()
}

//! Tables of restitution.

use crate::measure::restitution::Restitution;
use crate::report::layout::headed;
use crate::report::{Cell, Table};

/// Restitution by every method, one row a method.
pub fn restitution(name: &str, found: &Restitution) -> Table {
    let columns = [("name", ""), ("method", ""), ("R", ""), ("samples", ""), ("how", "")];
    let mut table = headed("Coefficient of restitution", &columns);
    for way in &found.by {
        table.push([
            Cell::from(name),
            Cell::from(way.method),
            Cell::from(&way.restitution),
            Cell::from(way.restitution.n),
            Cell::from(way.restitution.method.as_str()),
        ]);
    }
    if found.agree == Some(false) {
        table.push([
            Cell::from(name),
            Cell::from("together"),
            Cell::Missing,
            Cell::Missing,
            Cell::from("the methods disagree"),
        ]);
    }
    table
}

/// Whether the methods agree, and the scatter of the drops by a bootstrap; `None` for one method alone.
pub fn agreement(found: &Restitution) -> Option<Table> {
    let together = match found.agree {
        _ if found.by.len() < 2 => "one method",
        Some(true) => "agree",
        Some(false) => "disagree",
        None => "cannot be compared: one has no uncertainty",
    };
    let table =
        headed("Agreement of the methods", &[("methods", ""), ("standard uncertainty by bootstrap", "1")])
            .row([Cell::from(together), Cell::from(found.bootstrap_std)]);
    (found.by.len() > 1 || found.bootstrap_std.is_some()).then_some(table)
}

//! Modes as tables.

use crate::measure::modal::ModalResult;
use crate::report::layout::headed;
use crate::report::words::{Voice, sentence};
use crate::report::{Cell, Table};

/// Modes of a frequency response function, one row a mode.
pub fn modes(name: &str, result: &ModalResult) -> Table {
    let columns = [
        ("record", ""),
        ("frequency", "Hz"),
        ("damping ratio", "1"),
        ("modal constant", "1/kg"),
        ("phase", "°"),
        ("stiffness", "N/m"),
        ("from", "Hz"),
        ("to", "Hz"),
        ("lines", ""),
        ("method", ""),
    ];
    let mut table = headed("Modes", &columns);
    for mode in &result.modes {
        table.push([
            Cell::from(name),
            Cell::from(&mode.frequency),
            Cell::from(&mode.zeta),
            Cell::from(&mode.modal_constant),
            mode.phase.as_ref().map_or(Cell::Missing, Cell::from),
            mode.stiffness.as_ref().map_or(Cell::Missing, Cell::from),
            Cell::Number(mode.lines.0),
            Cell::Number(mode.lines.1),
            Cell::from(mode.lines.2),
            Cell::from(mode.method.as_str()),
        ]);
    }
    table
}

/// What each method gives for each mode.
pub(crate) fn modal_methods(result: &ModalResult) -> Table {
    let columns = [
        ("method", ""),
        ("frequency", "Hz"),
        ("damping ratio", "1"),
        ("modal constant", "1/kg"),
        ("note", ""),
    ];
    let mut table = headed("By method", &columns);
    for by in result.modes.iter().flat_map(|m| &m.by) {
        table.push([
            Cell::from(by.method),
            Cell::from(&by.frequency),
            by.zeta.as_ref().map_or(Cell::Missing, Cell::from),
            by.modal_constant.as_ref().map_or(Cell::Missing, Cell::from),
            Cell::from(by.note.as_ref().map_or_else(String::new, |n| sentence(n, Voice::Campaign))),
        ]);
    }
    table
}

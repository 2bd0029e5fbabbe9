//! Modes as tables.

use crate::measure::modal::{ModalResult, OrderedPole};
use crate::report::layout::table;
use crate::report::words::{Voice, sentence};
use crate::report::{Cell, Table};

/// Modes of a frequency response function, one row a mode.
pub fn modes(name: &str, result: &ModalResult) -> Table {
    table(
        "Modes",
        &result.modes,
        &[
            ("record", "", &|_| Cell::from(name)),
            ("frequency", "Hz", &|m| Cell::from(&m.frequency)),
            ("damping ratio", "1", &|m| Cell::from(&m.zeta)),
            ("modal constant", unit_of_constants(result), &|m| Cell::from(&m.modal_constant)),
            ("phase", "°", &|m| m.phase.as_ref().into()),
            ("stiffness", "N/m", &|m| m.stiffness.as_ref().into()),
            ("from", "Hz", &|m| Cell::Number(m.lines.0)),
            ("to", "Hz", &|m| Cell::Number(m.lines.1)),
            ("lines", "", &|m| Cell::from(m.lines.2)),
            ("method", "", &|m| Cell::from(m.method.as_str())),
        ],
    )
}

/// Unit of the modal constants.
fn unit_of_constants(result: &ModalResult) -> &'static str {
    result.modes.first().map_or("1/kg", |mode| mode.modal_constant.unit)
}

/// Results of each method for each mode.
pub(crate) fn modal_methods(result: &ModalResult) -> Table {
    let note = |note: &Option<_>| note.as_ref().map_or_else(String::new, |n| sentence(n, Voice::Campaign));
    table(
        "Modes by method",
        result.modes.iter().flat_map(|m| &m.by),
        &[
            ("method", "", &|by| Cell::from(by.method)),
            ("frequency", "Hz", &|by| Cell::from(&by.frequency)),
            ("damping ratio", "1", &|by| by.zeta.as_ref().into()),
            ("modal constant", unit_of_constants(result), &|by| by.modal_constant.as_ref().into()),
            ("note", "", &|by| Cell::from(note(&by.note))),
        ],
    )
}

/// Poles of a stabilisation diagram, one row a pole.
pub(crate) fn poles(poles: &[OrderedPole]) -> Table {
    let stays = |pole: &OrderedPole| match pole {
        OrderedPole { damping_stays: true, .. } => "frequency and damping",
        OrderedPole { frequency_stays: true, .. } => "frequency",
        _ => "",
    };
    table(
        "Poles of models of rising order",
        poles,
        &[
            ("order", "", &|pole| Cell::from(pole.order)),
            ("frequency", "Hz", &|pole| Cell::Number(pole.frequency)),
            ("damping ratio", "1", &|pole| Cell::Number(pole.zeta)),
            ("stays", "", &|pole| Cell::from(stays(pole))),
        ],
    )
}

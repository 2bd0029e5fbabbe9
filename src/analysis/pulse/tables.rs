//! Contact pulses as tables.

use crate::measure::Estimate;
use crate::measure::pulse::PulseResult;
use crate::report::layout::{headed, table};
use crate::report::{Cell, Table};
use std::collections::BTreeMap;

fn named(what: &str, title: &str) -> String {
    if title.is_empty() { what.to_owned() } else { format!("{what}, {title}") }
}

/// What a pulse says, one row a quantity, in SI units.
pub fn pulse(title: &str, result: &PulseResult) -> Table {
    let known = |e: &Option<Estimate>| e.as_ref().map_or(Cell::Missing, Cell::from);
    table(
        named("Contact", title),
        [result],
        &[
            ("damping ratio", "1", &|r| Cell::from(&r.xi)),
            ("frequency", "Hz", &|r| Cell::from(&r.frequency)),
            ("duration", "s", &|r| Cell::from(&r.duration)),
            ("restitution", "1", &|r| Cell::from(&r.restitution)),
            ("initial velocity", "m/s", &|r| known(&r.initial_velocity)),
            ("stiffness", "N/m", &|r| known(&r.stiffness)),
            ("damping", "N s/m", &|r| known(&r.damping)),
        ],
    )
}

/// The models that were fitted to the pulse.
pub fn pulse_fits(title: &str, result: &PulseResult) -> Table {
    let columns = [("model", ""), ("RMS residual", ""), ("AICc", ""), ("whiteness p", ""), ("samples", "")];
    let all = result.fits.iter().flat_map(|f| &f.parameters);
    let parameters: BTreeMap<&str, &str> = all.map(|(name, e)| (*name, e.unit)).collect();
    let own = |table: Table, (name, unit): (&&str, &&str)| table.column(name.replace('_', " "), *unit);
    let mut table = parameters.iter().fold(headed(named("Models", title), &columns), own);
    for fit in &result.fits {
        let whiteness = match fit.whiteness {
            Some(p) if p < 1e-6 => Cell::from("< 1e-6"),
            p => Cell::from(p),
        };
        let known = [
            Cell::from(fit.model.name()),
            Cell::Number(fit.residual),
            Cell::Number(fit.aicc),
            whiteness,
            Cell::from(fit.n),
        ];
        let own = parameters.keys().map(|name| fit.parameters.get(name).map_or(Cell::Missing, Cell::from));
        table.push(known.into_iter().chain(own));
    }
    table
}

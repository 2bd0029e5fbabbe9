//! Contact pulses as tables.

use crate::measure::pulse::PulseResult;
use crate::report::layout::headed;
use crate::report::{Cell, Table};
use std::collections::BTreeMap;

/// What a pulse says, one row a quantity, in SI units.
pub fn pulse(title: &str, result: &PulseResult) -> Table {
    let named = if title.is_empty() { "Contact".to_owned() } else { format!("Contact, {title}") };
    let columns = [
        ("damping ratio", "1"),
        ("frequency", "Hz"),
        ("duration", "s"),
        ("restitution", "1"),
        ("initial velocity", "m/s"),
        ("stiffness", "N/m"),
        ("damping", "N s/m"),
    ];
    let mut table = headed(named, &columns);
    let cell = |e: &Option<crate::measure::Estimate>| e.as_ref().map_or(Cell::Missing, Cell::from);
    table.push([
        Cell::from(&result.xi),
        Cell::from(&result.frequency),
        Cell::from(&result.duration),
        Cell::from(&result.restitution),
        cell(&result.initial_velocity),
        cell(&result.stiffness),
        cell(&result.damping),
    ]);
    table
}

/// The models that were fitted to the pulse.
pub fn pulse_fits(title: &str, result: &PulseResult) -> Table {
    let named = if title.is_empty() { "Models".to_owned() } else { format!("Models, {title}") };
    let columns = [("model", ""), ("RMS residual", ""), ("AICc", ""), ("whiteness p", ""), ("samples", "")];
    let parameters: BTreeMap<&str, (String, &str)> = result
        .fits
        .iter()
        .flat_map(|f| &f.parameters)
        .map(|(name, e)| (*name, (name.replace('_', " "), e.unit)))
        .collect();
    let more = parameters.values().map(|(heading, unit)| (heading.as_str(), *unit));
    let columns: Vec<(&str, &str)> = columns.into_iter().chain(more).collect();
    let mut table = headed(named, &columns);
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

//! Contact pulses as tables.

use super::headed;
use crate::measure::pulse::PulseResult;
use crate::report::{Cell, Table};

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
    let columns = [
        ("model", ""),
        ("RMS residual", ""),
        ("AICc", ""),
        ("whiteness p", ""),
        ("samples", ""),
        ("parameters", ""),
    ];
    let mut table = headed(named, &columns);
    for fit in &result.fits {
        let parameters: Vec<String> = fit
            .parameters
            .iter()
            .map(|(name, e)| match e.std {
                Some(std) => {
                    format!(
                        "{name} {:.5e} ± {:.1e} {}",
                        e.value,
                        std,
                        if e.unit == "1" { "" } else { e.unit }
                    )
                }
                None => format!("{name} {:.5e}", e.value),
            })
            .map(|text| text.trim_end().to_owned())
            .collect();
        table.push([
            Cell::from(fit.model),
            Cell::Number(fit.residual),
            Cell::Number(fit.aicc),
            Cell::from(fit.whiteness),
            Cell::from(fit.n),
            Cell::from(parameters.join(", ")),
        ]);
    }
    table
}

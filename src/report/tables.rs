//! Results as tables: for the terminal, for CSV, for the report.

mod modal;
mod pulse;

pub use modal::{modal_methods, modes};
pub use pulse::{pulse, pulse_fits};

use super::job::Results;
use super::{Cell, Table};
use crate::compare::Overlay;
use crate::compare::prediction::Kind;
use crate::measure::response::Response;

fn pair(value: f64, std: Option<f64>) -> Cell {
    Cell::Estimate { value, std }
}

fn headed(title: impl Into<String>, columns: &[(&str, &str)]) -> Table {
    columns.iter().fold(Table::new(title), |table, (name, unit)| table.column(*name, *unit))
}

/// Point by point, what fits a page: excitation, force, response.
pub fn curve(response: &Response) -> Table {
    let columns = [
        ("excitation", "Hz"),
        ("force", "N"),
        ("response at", "Hz"),
        ("amplitude", response.unit),
        ("largest at", "Hz"),
    ];
    let mut table = headed(format!("Response, {}", response.name), &columns);
    for p in &response.points {
        table.push([
            pair(p.excitation, p.excitation_std),
            Cell::from(p.force),
            pair(p.frequency, p.frequency_std),
            Cell::from(&p.amplitude),
            if p.largest_elsewhere { Cell::Number(p.largest_at) } else { Cell::from("excitation") },
        ]);
    }
    table
}

/// Point by point with harmonics and sub-harmonics, for files.
pub fn response(response: &Response) -> Table {
    let unit = response.unit;
    let mut columns = vec![
        ("excitation".to_owned(), "Hz"),
        ("force".to_owned(), "N"),
        ("response at".to_owned(), "Hz"),
        ("amplitude".to_owned(), unit),
    ];
    if let Some(first) = response.points.first() {
        let orders = first.harmonics.iter().chain(&first.subharmonics);
        columns.extend(orders.map(|h| (format!("order {}", h.order), unit)));
    }
    columns.push(("largest at".to_owned(), "Hz"));
    let columns: Vec<(&str, &str)> = columns.iter().map(|(n, u)| (n.as_str(), *u)).collect();
    let mut table = headed(format!("Response, {}", response.name), &columns);
    for p in &response.points {
        let mut row = vec![
            pair(p.excitation, p.excitation_std),
            Cell::from(p.force),
            pair(p.frequency, p.frequency_std),
            Cell::from(&p.amplitude),
        ];
        row.extend(p.harmonics.iter().chain(&p.subharmonics).map(|h| Cell::from(&h.amplitude)));
        row.push(if p.largest_elsewhere { Cell::Number(p.largest_at) } else { Cell::from("excitation") });
        table.push(row);
    }
    table
}

/// Resonances and antiresonances.
pub fn resonances(responses: &[Response]) -> Table {
    let unit = responses.first().map_or("", |r| r.unit);
    let columns =
        [("sweep", ""), ("kind", ""), ("frequency", "Hz"), ("amplitude", unit), ("ends in a jump", "")];
    let mut table = headed("Resonances", &columns);
    for response in responses {
        for r in &response.resonances {
            table.push([
                Cell::from(response.name.as_str()),
                Cell::from(r.kind.as_str()),
                pair(r.frequency, r.frequency_std),
                pair(r.amplitude, r.amplitude_std),
                Cell::from(if r.at_jump { "yes" } else { "no" }),
            ]);
        }
    }
    table
}

/// Jumps.
pub fn jumps(responses: &[Response]) -> Table {
    let unit = responses.first().map_or("", |r| r.unit);
    let columns =
        [("sweep", ""), ("change", ""), ("from", "Hz"), ("to", "Hz"), ("before", unit), ("after", unit)];
    let mut table = headed("Jumps", &columns);
    for response in responses {
        for j in &response.jumps {
            table.push([
                Cell::from(response.name.as_str()),
                Cell::from(j.change),
                Cell::Number(j.from),
                Cell::Number(j.to),
                Cell::Number(j.amplitude_before),
                Cell::Number(j.amplitude_after),
            ]);
        }
    }
    table
}

/// Measured against predicted, point by point.
pub fn pairs(overlay: &Overlay) -> Table {
    let columns = [
        ("sweep", ""),
        ("mass", ""),
        ("direction", ""),
        ("frequency", "Hz"),
        ("measured", "m"),
        ("predicted", "m"),
        ("residual", "m"),
        ("motion", ""),
    ];
    let mut table = headed("Measured against predicted", &columns);
    for p in &overlay.pairs {
        table.push([
            Cell::from(p.sweep.as_str()),
            Cell::from(usize::from(p.mass)),
            Cell::from(p.direction.name()),
            Cell::Number(p.frequency),
            Cell::from(&p.measured),
            Cell::from(p.predicted),
            Cell::from(p.residual),
            Cell::from(match p.motion {
                Some(Kind::Impacting) => "impacting",
                Some(Kind::Free) => "free",
                None => "not predicted",
            }),
        ]);
    }
    table
}

/// Measured against predicted resonances.
pub fn peaks(overlay: &Overlay) -> Table {
    let columns = [
        ("sweep", ""),
        ("kind", ""),
        ("measured", "Hz"),
        ("predicted", "Hz"),
        ("off by", "Hz"),
        ("measured", "m"),
        ("predicted", "m"),
        ("off by", "%"),
    ];
    let mut table = headed("Resonances against the model", &columns);
    for p in &overlay.peaks {
        table.push([
            Cell::from(p.sweep.as_str()),
            Cell::from(p.kind.as_str()),
            Cell::from(&p.measured_frequency),
            Cell::from(p.predicted_frequency),
            Cell::from(p.frequency_difference),
            Cell::from(&p.measured_amplitude),
            Cell::from(p.predicted_amplitude),
            Cell::from(p.amplitude_difference.map(|d| 100.0 * d)),
        ]);
    }
    table
}

/// How well each sweep is predicted.
pub fn scores(overlay: &Overlay) -> Table {
    let columns = [
        ("sweep", ""),
        ("points predicted", ""),
        ("not predicted", ""),
        ("median deviation", "%"),
        ("RMS deviation", "m"),
    ];
    let mut table = headed("Agreement with the model", &columns);
    for s in &overlay.scores {
        table.push([
            Cell::from(s.sweep.as_str()),
            Cell::from(s.n),
            Cell::from(s.without),
            Cell::from(s.median_relative.map(|r| 100.0 * r)),
            Cell::from(s.rms),
        ]);
    }
    table
}

/// The tables that a person wants first, empty ones left out.
pub fn summary(results: &Results) -> Vec<Table> {
    let mut tables = vec![resonances(&results.responses), jumps(&results.responses)];
    if let Some(overlay) = &results.overlay {
        tables.push(peaks(overlay));
        tables.push(scores(overlay));
    }
    tables.push(modes(results.frf.iter().map(|f| (f.name.as_str(), &f.modal))));
    for found in &results.pulses {
        tables.push(pulse(&found.name, &found.result));
        tables.push(pulse_fits(&found.name, &found.result));
    }
    tables.retain(|t| !t.rows.is_empty());
    tables
}

//! Results as tables: for the terminal, for CSV, for the report.

mod cycles;
mod drill;
mod fit;
mod impacts;
mod ladder;
mod modal;
mod model;
mod precision;
mod pulse;
mod spectral;
mod sweep;

pub use cycles::{drill_cycles_head, drill_cycles_row};
pub use drill::{drill, drill_average, drill_impacts};
pub use fit::{fit_points, fit_rungs, fitted};
pub use impacts::{impact_times, impacts, restitution};
pub use ladder::{chosen, climbed, motions, rungs, sensitivity, stretches, summaries, where_chosen, why};
pub use modal::{modal_methods, modes};
pub use model::{branches, changes, course, no_impact, orbits, soft, verdicts};
pub use precision::{borders, failures, precision, scene};
pub use pulse::{pulse, pulse_fits};
pub use spectral::{spectra, tones};
pub use sweep::{Followed, FollowedMark, FollowedPoint, branch_points, followed, sweep, sweep_named};

use super::job::Results;
use super::{Cell, Column, Table};
use crate::compare::{Kind, Overlay};
use crate::measure::response::{Response, ResponsePoint};

/// A column: name, unit, and what it shows of an item.
type Shown<'a, T> = (&'a str, &'a str, &'a dyn Fn(&T) -> Cell);

/// No rows yet.
fn headed(title: impl Into<String>, columns: &[(&str, &str)]) -> Table {
    columns.iter().fold(Table::new(title), |table, (name, unit)| table.column(*name, *unit))
}

/// One row an item.
fn table<T>(title: impl Into<String>, items: impl IntoIterator<Item = T>, columns: &[Shown<'_, T>]) -> Table {
    let head = columns.iter().fold(Table::new(title), |table, c| table.column(c.0, c.1));
    items.into_iter().fold(head, |table, item| table.row(columns.iter().map(|c| c.2(&item))))
}

fn pair(value: f64, std: Option<f64>) -> Cell {
    Cell::Estimate { value, std }
}

/// Point by point, what fits a page: excitation, force, response, and a limit where an amplitude is faint.
pub fn curve(response: &Response) -> Table {
    let mut table = points(response);
    if response.points.iter().all(|p| p.upper_limit.is_none()) {
        table.columns.pop();
        for row in &mut table.rows {
            row.pop();
        }
    }
    table
}

fn points(response: &Response) -> Table {
    table(
        format!("Response, {}", response.name),
        &response.points,
        &[
            ("excitation", "Hz", &|p| pair(p.excitation, p.excitation_std)),
            ("force", "N", &|p| p.force.map_or(Cell::Missing, |force| pair(force, p.force_std))),
            ("response at", "Hz", &|p| pair(p.frequency, p.frequency_std)),
            ("amplitude", response.unit, &|p| Cell::from(&p.amplitude)),
            ("largest at", "Hz", &|p| {
                if p.largest_elsewhere { Cell::Number(p.largest_at) } else { Cell::from("excitation") }
            }),
            ("upper limit", response.unit, &|p| Cell::from(p.upper_limit)),
        ],
    )
}

/// Point by point with harmonics and sub-harmonics, for files.
pub fn response(response: &Response) -> Table {
    let mut table = points(response);
    let before = table.columns.len() - 2;
    let orders = |p: &ResponsePoint| p.harmonics.iter().chain(&p.subharmonics).cloned().collect::<Vec<_>>();
    let heads = response.points.first().map(orders).unwrap_or_default();
    let heads =
        heads.iter().flat_map(|h| ["", " upper limit"].map(|what| format!("order {}{what}", h.order)));
    let heads = heads.map(|name| Column { name, unit: response.unit.to_owned() });
    drop(table.columns.splice(before..before, heads));
    for (row, point) in table.rows.iter_mut().zip(&response.points) {
        let cells = orders(point).into_iter().flat_map(|h| match h.upper_limit {
            // Noise is no amplitude.
            Some(limit) => [Cell::Missing, Cell::Number(limit)],
            None => [Cell::from(&h.amplitude), Cell::Missing],
        });
        drop(row.splice(before..before, cells));
    }
    table
}

/// Resonances and antiresonances.
pub fn resonances(responses: &[Response]) -> Table {
    let unit = responses.first().map_or("", |r| r.unit);
    table(
        "Resonances",
        responses.iter().flat_map(|sweep| sweep.resonances.iter().map(move |r| (sweep, r))),
        &[
            ("sweep", "", &|(sweep, _)| Cell::from(sweep.name.as_str())),
            ("kind", "", &|(_, r)| Cell::from(r.kind.name())),
            ("frequency", "Hz", &|(_, r)| pair(r.frequency, r.frequency_std)),
            ("amplitude", unit, &|(_, r)| pair(r.amplitude, r.amplitude_std)),
            ("ends in a jump", "", &|(_, r)| Cell::from(if r.at_jump { "yes" } else { "no" })),
        ],
    )
}

/// Jumps.
pub fn jumps(responses: &[Response]) -> Table {
    let unit = responses.first().map_or("", |r| r.unit);
    table(
        "Jumps",
        responses.iter().flat_map(|sweep| sweep.jumps.iter().map(move |j| (sweep, j))),
        &[
            ("sweep", "", &|(sweep, _)| Cell::from(sweep.name.as_str())),
            ("change", "", &|(_, j)| Cell::from(j.change.name())),
            ("at", "Hz", &|(_, j)| pair(j.frequency, Some(j.frequency_std))),
            ("before", unit, &|(_, j)| pair(j.amplitude_before, j.amplitude_before_std)),
            ("after", unit, &|(_, j)| pair(j.amplitude_after, j.amplitude_after_std)),
        ],
    )
}

/// Measured against predicted, point by point.
pub fn pairs(overlay: &Overlay) -> Table {
    table(
        "Measured against predicted",
        &overlay.pairs,
        &[
            ("sweep", "", &|p| Cell::from(p.sweep.as_str())),
            ("mass", "", &|p| Cell::from(usize::from(p.mass))),
            ("direction", "", &|p| Cell::from(p.direction.name())),
            ("frequency", "Hz", &|p| Cell::Number(p.frequency)),
            ("force", "N", &|p| Cell::Number(p.force)),
            ("measured", "m", &|p| Cell::from(&p.measured)),
            ("predicted", "m", &|p| Cell::from(p.predicted)),
            ("residual", "m", &|p| Cell::from(p.residual)),
            ("scatter of the prediction", "m", &|p| Cell::from(p.scatter)),
            ("predicted by", "", &|p| Cell::from(p.model.name())),
            ("impacts/cycles", "", &|p| Cell::from(p.regime.as_deref().unwrap_or("-"))),
            ("predicted motion", "", &|p| {
                Cell::from(match p.motion {
                    Some(Kind::Impacting) => "impacting",
                    Some(Kind::Free) => "free",
                    Some(Kind::Pattern) => "another pattern",
                    Some(Kind::Irregular) => "irregular",
                    None => "not predicted",
                })
            }),
        ],
    )
}

/// Measured against predicted resonances; a difference is as uncertain as what was measured.
pub fn peaks(overlay: &Overlay) -> Table {
    let difference = |value: Option<f64>, std: Option<f64>| value.map_or(Cell::Missing, |v| pair(v, std));
    table(
        "Resonances against the model",
        &overlay.peaks,
        &[
            ("sweep", "", &|p| Cell::from(p.sweep.as_str())),
            ("kind", "", &|p| Cell::from(p.kind.name())),
            ("measured", "Hz", &|p| Cell::from(&p.measured_frequency)),
            ("predicted", "Hz", &|p| Cell::from(p.predicted_frequency)),
            ("off by", "Hz", &|p| difference(p.frequency_difference, p.measured_frequency.std)),
            ("measured", "m", &|p| Cell::from(&p.measured_amplitude)),
            ("predicted", "m", &|p| Cell::from(p.predicted_amplitude)),
            ("off by", "%", &|p| {
                let std = p.measured_amplitude.std.zip(p.predicted_amplitude).map(|(s, a)| 100.0 * s / a);
                difference(p.amplitude_difference.map(|d| 100.0 * d), std)
            }),
        ],
    )
}

/// How well each sweep is predicted.
pub fn scores(overlay: &Overlay) -> Table {
    table(
        "Agreement with the model",
        &overlay.scores,
        &[
            ("sweep", "", &|s| Cell::from(s.sweep.as_str())),
            ("points predicted", "", &|s| Cell::from(s.n)),
            ("not predicted", "", &|s| Cell::from(s.without)),
            ("too faint", "", &|s| Cell::from(s.faint)),
            ("median deviation", "%", &|s| Cell::from(s.median_relative.map(|r| 100.0 * r))),
            ("largest deviation", "%", &|s| Cell::from(s.max_relative.map(|r| 100.0 * r))),
            ("at", "Hz", &|s| Cell::from(s.max_at)),
            ("RMS deviation", "m", &|s| Cell::from(s.rms)),
        ],
    )
}

/// The tables that a person wants first, empty ones left out.
pub fn summary(results: &Results) -> Vec<Table> {
    let mut tables = vec![resonances(&results.responses), jumps(&results.responses)];
    if let Some(overlay) = &results.overlay {
        tables.push(peaks(overlay));
        tables.push(scores(overlay));
        tables.push(climbed(overlay));
    }
    tables.extend(results.fit.iter().flat_map(|fit| [fitted(fit), fit_rungs(fit)]));
    let records: Vec<_> = results.spectra.iter().map(|s| (s.result.name.as_str(), &s.result)).collect();
    tables.push(spectra(&records));
    tables.push(tones(&records));
    tables.push(modes(results.frf.iter().map(|f| (f.name.as_str(), &f.modal))));
    for found in &results.pulses {
        tables.push(pulse(&found.name, &found.result));
        tables.push(pulse_fits(&found.name, &found.result));
    }
    let drills: Vec<_> = results.drill.iter().map(|d| (d.name.as_str(), &d.drill)).collect();
    tables.push(drill(&drills));
    let trains: Vec<_> = results.impacts.iter().map(|r| (r.name.clone(), &r.impacts)).collect();
    tables.push(impacts(&trains));
    let drops: Vec<_> = results.drops.iter().map(|r| (r.name.clone(), &r.restitution)).collect();
    tables.push(restitution(&drops));
    tables.retain(|t| !t.rows.is_empty());
    tables
}

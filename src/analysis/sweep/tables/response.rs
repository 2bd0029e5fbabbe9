//! Tables of responses: point by point, resonances, jumps.

use crate::measure::response::{Response, ResponsePoint};
use crate::report::layout::{pair, table};
use crate::report::{Cell, Column, Table};

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
            ("change", "", &|(_, j)| Cell::from(j.change)),
            ("at", "Hz", &|(_, j)| pair(j.frequency, Some(j.frequency_std))),
            ("before", unit, &|(_, j)| pair(j.amplitude_before, j.amplitude_before_std)),
            ("after", unit, &|(_, j)| pair(j.amplitude_after, j.amplitude_after_std)),
        ],
    )
}

//! Tables of sweeps, and of sweeps against the model.

use crate::analysis::headline::{headline, remarked};
use crate::compare::{Fit, MotionKind, Overlay};
use crate::measure::response::{Response, ResponsePoint};
use crate::report::layout::{pair, table};
use crate::report::{Cell, Column, Table};

/// Index of the column with upper limits in a curve.
const LIMIT_COLUMN: usize = 6;

/// Points of a response, with columns that fit a page: excitation, force, response, and the upper limit of
/// an amplitude below the noise floor.
pub fn curve(response: &Response) -> Table {
    let shown = table(
        format!("Response, {}", response.name),
        &response.points,
        &[
            ("excitation frequency", "Hz", &|p| pair(p.excitation, p.excitation_std)),
            ("force", "N", &|p| p.force.map(|force| pair(force, p.force_std)).into()),
            ("response frequency", "Hz", &|p| pair(p.frequency, p.frequency_std)),
            ("amplitude", response.unit, &|p| Cell::from(&p.amplitude)),
            ("phase", "°", &|p| {
                p.phase.as_ref().map(|p| pair(p.value.to_degrees(), p.std.map(f64::to_degrees))).into()
            }),
            ("strongest line at", "Hz", &|p| p.largest_elsewhere.then_some(p.largest_at).into()),
            ("upper limit", response.unit, &|p| p.upper_limit.into()),
        ],
    );
    if response.points.iter().any(|p| p.largest_elsewhere) { shown.note(STRONGEST) } else { shown }
}

/// Explanation of the column "strongest line at".
const STRONGEST: &str = "Strongest line at: this line of the spectrum is stronger than that of the excitation, as of a resonance, a harmonic or hum.";

/// Points of a response with receptance, harmonics and sub-harmonics, for files.
pub fn response(response: &Response) -> Table {
    let mut table = curve(response);
    for (name, part) in [("receptance re", 0), ("receptance im", 1)] {
        table.columns.push(Column { name: name.to_owned(), unit: "m/N".to_owned() });
        for (row, point) in table.rows.iter_mut().zip(&response.points) {
            row.push(point.receptance.map(|r| pair([r.re, r.im][part], r.std)).into());
        }
    }
    // Before the columns on the strongest line and the limit.
    let before = LIMIT_COLUMN - 1;
    let orders = |p: &ResponsePoint| p.harmonics.iter().chain(&p.subharmonics).cloned().collect::<Vec<_>>();
    let heads = response.points.first().map(orders).unwrap_or_default();
    let heads =
        heads.iter().flat_map(|h| ["", " upper limit"].map(|what| format!("order {}{what}", h.order)));
    let heads = heads.map(|name| Column { name, unit: response.unit.to_owned() });
    drop(table.columns.splice(before..before, heads));
    for (row, point) in table.rows.iter_mut().zip(&response.points) {
        let cells = orders(point).into_iter().flat_map(|h| match h.upper_limit {
            // Below the noise floor only the upper limit is given.
            Some(limit) => [Cell::Missing, Cell::Number(limit)],
            None => [Cell::from(&h.amplitude), Cell::Missing],
        });
        drop(row.splice(before..before, cells));
    }
    table
}

/// Explanation of the kinds of resonances, a line each.
const KINDS: &str = "Resonance: a peak of the amplitude, from the points around it. For modes fitted to all points with their phase, add a table [[frf]].\nGrazing: both masses move in phase and touch lightly.\nClapping: both masses move in antiphase and strike head on.\nAntiresonance: the minimum of the excited mass between resonances, or a deep one of another mass.\nMinimum: an antiresonance if the phase rises there by 180°; the amplitude alone does not show it.";

/// Resonances and antiresonances.
pub fn resonances(responses: &[Response]) -> Table {
    let unit = responses.first().map_or("", |r| r.unit);
    let all = || responses.iter().flat_map(|s| &s.resonances);
    let found = |line: &&str| all().any(|r| line.to_lowercase().starts_with(r.kind.name()));
    let words: Vec<&str> = KINDS.lines().filter(found).collect();
    table(
        "Resonances",
        responses.iter().flat_map(|sweep| sweep.resonances.iter().map(move |r| (sweep, r))),
        &[
            ("sweep", "", &|(sweep, _)| Cell::from(sweep.name.as_str())),
            ("kind", "", &|(_, r)| Cell::from(r.kind.name())),
            ("frequency", "Hz", &|(_, r)| pair(r.frequency, r.frequency_std)),
            ("amplitude", unit, &|(_, r)| pair(r.amplitude, r.amplitude_std)),
            ("ends in a jump", "", &|(_, r)| r.at_jump.into()),
        ],
    )
    .note(words.join(" "))
}

/// The resonances of one sweep, for the head of a report.
pub fn named_peaks(response: &Response) -> Table {
    remarked(
        "Resonances",
        &response.resonances,
        &[
            ("kind", "", &|r| Cell::from(r.kind.name())),
            ("frequency", "Hz", &|r| pair(r.frequency, r.frequency_std)),
            ("amplitude", response.unit, &|r| pair(r.amplitude, r.amplitude_std)),
        ],
        &|r| if r.at_jump { "ends in a jump" } else { "" },
    )
}

/// The jumps of one sweep, for the head of a report.
pub fn jumped(response: &Response) -> Table {
    headline(
        "Jumps",
        &response.jumps,
        &[
            ("change", "", &|j| Cell::from(j.change)),
            ("frequency", "Hz", &|j| pair(j.frequency, Some(j.frequency_std))),
        ],
    )
}

/// Agreement with the model, sweep by sweep, for the head of a report.
pub fn agreement(overlay: &Overlay) -> Table {
    let percent = |part: Option<f64>| Cell::from(part.map(|part| 100.0 * part));
    table(
        "Agreement with the model",
        &overlay.scores,
        &[
            ("sweep", "", &|s| s.sweep.as_str().into()),
            ("points compared", "", &|s| s.n.saturating_sub(s.faint).into()),
            ("median deviation", "%", &|s| percent(s.median_relative)),
            ("largest", "%", &|s| percent(s.max_relative)),
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
            ("kind", "", &|(_, j)| Cell::from(j.change)),
            ("jump at", "Hz", &|(_, j)| pair(j.frequency, Some(j.frequency_std))),
            ("amplitude before", unit, &|(_, j)| pair(j.amplitude_before, j.amplitude_before_std)),
            ("amplitude after", unit, &|(_, j)| pair(j.amplitude_after, j.amplitude_after_std)),
        ],
    )
}

/// Measured against predicted, point by point.
pub fn pairs(overlay: &Overlay) -> Table {
    table(
        "Measured against predicted",
        &overlay.pairs,
        &[
            ("sweep", "", &|p| p.sweep.as_str().into()),
            ("mass", "", &|p| usize::from(p.mass).into()),
            ("direction", "", &|p| p.direction.name().into()),
            ("frequency", "Hz", &|p| Cell::Number(p.frequency)),
            ("force", "N", &|p| Cell::Number(p.force)),
            ("measured", "m", &|p| Cell::from(&p.measured)),
            ("predicted", "m", &|p| p.predicted.into()),
            ("residual", "m", &|p| p.residual.into()),
            ("scatter of the prediction", "m", &|p| p.scatter.into()),
            ("predicted by", "", &|p| p.model.name().into()),
            ("impacts/cycles", "", &|p| p.regime.as_deref().unwrap_or("-").into()),
            ("predicted motion", "", &|p| {
                Cell::from(match p.motion {
                    Some(MotionKind::Impacting) => "impacting",
                    Some(MotionKind::Free) => "free",
                    Some(MotionKind::Pattern) => "another pattern",
                    Some(MotionKind::Irregular) => "irregular",
                    None => "no prediction",
                })
            }),
        ],
    )
}

/// Measured against predicted resonances; a difference has the uncertainty of the measured value.
pub fn peaks(overlay: &Overlay) -> Table {
    let difference = |value: Option<f64>, std| Cell::from(value.map(|v| pair(v, std)));
    table(
        "Resonances against the model",
        &overlay.peaks,
        &[
            ("sweep", "", &|p| p.sweep.as_str().into()),
            ("kind", "", &|p| p.kind.name().into()),
            ("measured frequency", "Hz", &|p| Cell::from(&p.measured_frequency)),
            ("predicted frequency", "Hz", &|p| p.predicted_frequency.into()),
            ("difference", "Hz", &|p| difference(p.frequency_difference, p.measured_frequency.std)),
            ("measured amplitude", "m", &|p| Cell::from(&p.measured_amplitude)),
            ("predicted amplitude", "m", &|p| p.predicted_amplitude.into()),
            ("difference", "%", &|p| {
                let std = p.measured_amplitude.std.zip(p.predicted_amplitude).map(|(s, a)| 100.0 * s / a);
                difference(p.amplitude_difference.map(|d| 100.0 * d), std)
            }),
        ],
    )
}

/// Agreement of each sweep with the model.
pub fn scores(overlay: &Overlay) -> Table {
    table(
        "Agreement with the model",
        &overlay.scores,
        &[
            ("sweep", "", &|s| s.sweep.as_str().into()),
            ("points compared", "", &|s| (s.n - s.faint).into()),
            ("no prediction", "", &|s| s.without.into()),
            ("below noise (not compared)", "", &|s| s.faint.into()),
            ("median deviation", "%", &|s| s.median_relative.map(|r| 100.0 * r).into()),
            ("largest deviation", "%", &|s| s.max_relative.map(|r| 100.0 * r).into()),
            ("largest deviation at", "Hz", &|s| s.max_at.into()),
            ("RMS deviation", "m", &|s| s.rms.into()),
        ],
    )
}

/// Fitted parameters in SI units without prefixes, since each row has its own unit.
pub fn fitted(fit: &Fit) -> Table {
    // Six significant digits: rows of different units have no common number of decimals.
    let six = |value: f64| format!("{value:.5e}").parse::<f64>().unwrap_or(value).to_string();
    let end = |interval: Option<[f64; 2]>, side: usize| Cell::from(interval.map(|i| six(i[side])));
    table(
        "Fitted parameters",
        &fit.parameters,
        &[
            ("parameter", "", &|p| p.parameter.name().into()),
            ("unit", "", &|p| p.estimate.unit.into()),
            ("start", "", &|p| p.start.into()),
            ("found", "", &|p| pair(p.estimate.value, p.estimate.std)),
            ("95 % from", "", &|p| end(p.interval, 0)),
            ("95 % to", "", &|p| end(p.interval, 1)),
            ("determined by", "", &|p| {
                Cell::from(match (p.identifiable, p.rests_on_prior) {
                    _ if fit.doubt.is_some() => "not determined: the fit is in doubt",
                    (false, _) => "not determined by these points",
                    (true, true) => "its prior value",
                    (true, false) => "the measured points",
                })
            }),
        ],
    )
}

/// Points of the fit.
pub fn fit_points(fit: &Fit) -> Table {
    table(
        "Points of the fit",
        &fit.points,
        &[
            ("sweep", "", &|p| p.sweep.as_str().into()),
            ("mass", "", &|p| usize::from(p.mass).into()),
            ("frequency", "Hz", &|p| p.frequency.into()),
            ("measured", "m", &|p| p.measured.into()),
            ("fitted", "m", &|p| p.fitted.into()),
            ("residual", "std", &|p| p.residual.into()),
        ],
    )
}

/// Models with their errors at points held out.
pub fn fit_rungs(fit: &Fit) -> Table {
    let percent = |value: Option<f64>| Cell::from(value.map(|v| 100.0 * v));
    table(
        "Models compared on points kept back",
        &fit.rungs,
        &[
            ("model", "", &|r| r.model.into()),
            ("parameters", "", &|r| r.parameters.len().into()),
            ("hold-out error", "%", &|r| percent(r.held_out)),
            ("its standard error", "%", &|r| percent(r.held_out_std)),
            ("AICc", "", &|r| r.aicc.into()),
            ("residuals white (p)", "", &|r| r.whiteness.into()),
            ("chosen", "", &|r| Cell::from(if r.chosen { "yes" } else { "" })),
        ],
    )
    .note("Residuals white (p): probability that white noise shows as much serial correlation. A small p means that the model lacks something.")
}

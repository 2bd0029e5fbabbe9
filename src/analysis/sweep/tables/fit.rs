//! Tables of a fit.

use crate::compare::Fit;
use crate::report::layout::{pair, table};
use crate::report::{Cell, Table};

/// Parameters found; each with its own unit, so in SI units as they are.
pub fn fitted(fit: &Fit) -> Table {
    // Each row has its own unit, so no common number of decimals would do.
    let six = |value: f64| format!("{value:.5e}").parse::<f64>().unwrap_or(value).to_string();
    let end = |interval: Option<[f64; 2]>, side: usize| {
        interval.map_or(Cell::Missing, |i| Cell::from(six(i[side])))
    };
    table(
        "Parameters found",
        &fit.parameters,
        &[
            ("parameter", "", &|p| Cell::from(p.parameter.name())),
            ("unit", "", &|p| Cell::from(p.estimate.unit)),
            ("start", "", &|p| Cell::from(p.start)),
            ("found", "", &|p| pair(p.estimate.value, p.estimate.std)),
            ("from", "", &|p| end(p.interval, 0)),
            ("to (95 %)", "", &|p| end(p.interval, 1)),
            ("determined by", "", &|p| {
                Cell::from(match (p.identifiable, p.rests_on_prior) {
                    _ if fit.doubt.is_some() => "–: the answer is in doubt",
                    (false, _) => "–: not identifiable",
                    (true, true) => "its prior",
                    (true, false) => "the points",
                })
            }),
        ],
    )
}

/// Point by point.
pub fn fit_points(fit: &Fit) -> Table {
    table(
        "Points of the fit",
        &fit.points,
        &[
            ("sweep", "", &|p| Cell::from(p.sweep.as_str())),
            ("mass", "", &|p| Cell::from(usize::from(p.mass))),
            ("frequency", "Hz", &|p| Cell::from(p.frequency)),
            ("measured", "m", &|p| Cell::from(p.measured)),
            ("fitted", "m", &|p| Cell::from(p.fitted)),
            ("residual", "std", &|p| Cell::from(p.residual)),
        ],
    )
}

/// Models by what they predict of points held out.
pub(crate) fn fit_rungs(fit: &Fit) -> Table {
    let percent = |value: Option<f64>| Cell::from(value.map(|v| 100.0 * v));
    table(
        "Models by hold-out error",
        &fit.rungs,
        &[
            ("model", "", &|r| Cell::from(r.model.name())),
            ("parameters", "", &|r| Cell::from(r.parameters.len())),
            ("error", "%", &|r| percent(r.held_out)),
            ("standard error", "%", &|r| percent(r.held_out_std)),
            ("AICc", "", &|r| Cell::from(r.aicc)),
            ("white with p", "", &|r| Cell::from(r.whiteness)),
            ("chosen", "", &|r| Cell::from(if r.chosen { "yes" } else { "" })),
        ],
    )
}

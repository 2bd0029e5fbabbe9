//! Tables of an overlay: measured against predicted.

use crate::compare::{Kind, Overlay};
use crate::report::layout::{pair, table};
use crate::report::{Cell, Table};

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

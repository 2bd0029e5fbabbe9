//! Maps of regime and stability over two parameters.

use crate::error::Result;
use crate::model::Regime;
use crate::model::map::{Cell, MapAxis};
use crate::report::layout::{capital, lettered};
use crate::report::{AxisSpec, Figure, Heatmap, Legend, Plot};
use ndarray::Array2;

/// Number of patterns with a colour of their own, the most frequent ones.
const COLOURED_PATTERNS: usize = 3;

/// Regimes by colour, and the spectral radius, beside each other: both axes with the values that are drawn,
/// the number of cells of each regime, and the cells that are drawn.
///
/// # Errors
/// As [`Heatmap::new`].
pub fn regimes(
    [(of_x, x), (of_y, y)]: [(&MapAxis, &[f64]); 2],
    counts: &[(Regime, usize)],
    rows: &[Vec<Cell>],
) -> Result<Figure> {
    let matrix = |value: &dyn Fn(&Cell) -> f64| {
        Array2::from_shape_fn((y.len(), x.len()), |(row, column)| {
            rows.get(row).map_or(f64::NAN, |cells| value(&cells[column]))
        })
    };
    let patterns = counts.iter().map(|c| c.0).filter(|r| matches!(r, Regime::Periodic { .. }));
    let coloured: Vec<Regime> = patterns.take(COLOURED_PATTERNS).collect();
    let names: Vec<String> = coloured.iter().map(Regime::to_string).collect();
    let others = ["other patterns", "irregular or not settled", "chatter", "no impact"];
    let names: Vec<&str> = names.iter().map(String::as_str).chain(others).collect();
    let regime = matrix(&|c| c.regime.map_or(f64::NAN, |r| class(&coloured, r) as f64));
    let radius = matrix(&|c| c.spectral_radius.unwrap_or(f64::NAN));
    let axis = |axis: &MapAxis| {
        let (name, unit) = (axis.key.name(), axis.key.unit());
        // A name of two characters, such as k1, is a symbol and stays as it is.
        AxisSpec::new(if name.len() == 2 { name.to_owned() } else { capital(name) }, unit)
    };
    let plot = |title: &str| Plot::new(axis(of_x), axis(of_y)).title(title);
    let scale = AxisSpec::new("Spectral radius", "").limits(f64::NAN, 1.0);
    let figure = Figure::double("Regimes")
        .columns(2)
        .panel(
            plot("regime (impacts/cycles)")
                .heatmap(Heatmap::classes(x, y, &regime, &names)?)
                .legend(Legend::Above),
        )
        .panel(plot("stability").heatmap(Heatmap::new(x, y, &radius, scale)?))
        .caption(
            "Motion from rest. (a) Its pattern of impacts, told by comparing states at impact. (b) Largest modulus of the Floquet \
             multipliers over the period of the pattern; white where there is none.",
        );
    Ok(lettered(figure))
}

/// Regimes with the number of their cells, the most frequent first.
pub(in crate::analysis::model) fn counted(
    counts: impl Iterator<Item = (Regime, usize)>,
) -> Vec<(Regime, usize)> {
    let mut counts: Vec<(Regime, usize)> = counts.collect();
    counts.sort_by(|a, b| b.1.cmp(&a.1).then_with(|| a.0.to_string().cmp(&b.0.to_string())));
    counts
}

/// Index of the colour of a regime; `coloured` are the patterns with a colour of their own.
fn class(coloured: &[Regime], regime: Regime) -> usize {
    coloured.iter().position(|r| *r == regime).unwrap_or(match regime {
        Regime::Periodic { .. } => coloured.len(),
        Regime::Irregular => coloured.len() + 1,
        Regime::Chatter { .. } => coloured.len() + 2,
        Regime::NoImpact => coloured.len() + 3,
    })
}
